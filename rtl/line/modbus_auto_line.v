// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_auto_line - finds bit time and format of a line by itself, beside the core.
//
//   rxd_i -> modbus_sync -> modbus_glitch_filter --+--------------------------> rxd_o -> core
//                                                  +-> runs -> modbus_run_ram --^ (a frame played again)
//
// The length of every run of equal levels of a frame goes into a memory, whoever sends it.  Not locked, the core hears
// nothing: when the line is silent the shortest run is taken for a bit, drawn to a standard rate if snap_i says so,
// and the runs are decoded in each format, a clock a half bit.  The check field judges.  With a good frame, for whatever
// address, bit time and format go to the core, and a frame that is for it is played to it as it came: so the very
// frame that showed the rate is answered.
//
// Locked, rxd_o is the line, and the core judges: frame_stb_i is its event of a good frame.  A frame that it does not
// call good, or does not even notice, is a bad one; BAD_FRAMES of them in a row, or a break, end the lock.  The frame
// that ended it is decoded at once, so a new rate is found in the frame that shows it.
//
// 8E1 or 8O1 and 8N2 are the same on the line as long as all parity bits are 1.  Then locked_o stays low: each frame is
// decoded and played, the formats that fit take turns, behind a reset first the one with parity, and the first frame
// that fits one of them alone locks.
//
// Time is counted in ticks, 32 to the bit of TOP_BAUD.  The slowest rate has 192 times its bit.  Settings change only
// while idle_i is high.  A frame of more runs than the memory has words is not decoded.

`default_nettype none
`include "modbus_defs.vh"

module modbus_auto_line #(
  parameter integer CLK_HZ        = 50000000,    // clk_i in hertz
  parameter integer MIN_BAUD      = 1200,        // the slowest rate that can be found: CLK_HZ / 65535 or more
  // Nine standard rates of 32 bits, the fastest first, 0: none.  230400 115200 57600 38400 19200 9600 4800 2400 1200
  parameter [287:0] RATES = 288'h00038400_0001C200_0000E100_00009600_00004B00_00002580_000012C0_00000960_000004B0,
  parameter integer RUN_BITS      = 8,           // 2^RUN_BITS words for runs and table, 8..12
  parameter integer BAD_FRAMES       = 1,           // bad frames in a row that end the lock, 1..255
  parameter integer GLITCH_FILTER = 0            // clocks: a shorter pulse on rxd_i is not seen, 0..255
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1

  // Core
  output wire        rxd_o,
  input  wire        de_i,                       // level : the core drives the line
  input  wire        idle_i,                     // level : settings may change
  input  wire        frame_stb_i,                // strobe: bit MB_EVENT_FRAME of events_o
  output wire [15:0] bit_time_o,                 // for MB_SET_BIT_TIME, clocks
  output wire [1:0]  format_o,                   // for MB_SET_FORMAT

  // Choices
  input  wire        snap_i,                     // level : 1 a rate within 2 % of a standard one is taken for that
  input  wire [7:0]  address_i,                  // level : frames for this address and for 0 are played to the core
  input  wire [7:0]  mask_i,                     // level : bits of the address that do not count

  output wire        locked_o                    // level : bit time and format are found
);

  generate
    if (CLK_HZ < 1000 || MIN_BAUD < 1 || CLK_HZ / 65536 >= MIN_BAUD || CLK_HZ / 16 < MIN_BAUD) begin : gen_clock
      ERROR_modbus_auto_line_MIN_BAUD_from_CLK_HZ_by_65536_to_CLK_HZ_by_16 illegal_parameter ();
    end
    if (BAD_FRAMES < 1 || BAD_FRAMES > 255) begin : gen_bad_frames
      ERROR_modbus_auto_line_BAD_FRAMES_from_1_to_255 illegal_parameter ();
    end
    if (RUN_BITS < 8 || RUN_BITS > 12) begin : gen_runs
      ERROR_modbus_auto_line_RUN_BITS_from_8_to_12 illegal_parameter ();
    end
  endgenerate

  // A tick is the shortest power of two of clocks that makes a bit of MIN_BAUD 6144 ticks or less: ten of them, and 5 %,
  // are below the longest run that is told from silence.
  localparam integer MAX_CLOCKS = CLK_HZ / ((MIN_BAUD < 1) ? 1 : MIN_BAUD);
  localparam integer PACE = (MAX_CLOCKS <= 6144) ? 0 : (MAX_CLOCKS <= 12288) ? 1 : (MAX_CLOCKS <= 24576) ? 2 :
                            (MAX_CLOCKS <= 49152) ? 3 : 4;          // the power

  localparam integer AW = RUN_BITS;
  localparam [13:0] LONGEST = 14'h3FFF;
  localparam [15:0] SHORT   = 16'd64;   // bit time of no rate, but legal

  // One state at a time; none: the line rests.
  reg record_q = 1'b0;               // the runs of a frame are recorded
  reg behind_q = 1'b0;               // silence behind it: what does the core say?
  reg snap_q   = 1'b0;               // the shortest run is compared with the table
  reg judge_q  = 1'b0;               // the runs are decoded, in one format after the other
  reg play_q   = 1'b0;               // the core hears the frame

  reg          locked_q = 1'b0;
  reg [1:0]    format_q = `MB_FORMAT_8N2;
  reg [15:0]   bit_time_q = SHORT;

  // ------------------------------------------------------------------ line and ticks

  wire rxd_sync, rxd;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd_sync));

  modbus_glitch_filter #(.CLOCKS(GLITCH_FILTER)) u_filter (.clk_i(clk_i), .level_i(rxd_sync), .level_o(rxd));

  reg  [3:0] pace_q = 4'd0;
  reg        tick_q = 1'b0;
  wire [4:0] paced = {1'b0, pace_q} + (5'd16 >> PACE);
  always @(posedge clk_i) {tick_q, pace_q} <= paced;

  // ------------------------------------------------------------------ memory

  reg  [AW-1:0] place_q = {AW{1'b0}};
  reg  [15:0]   count_q;                 // ticks of the run on the line
  wire [15:0]   word;
  wire          write;

  // The table is the last 64 words.
  modbus_run_ram #(.ADDRESS_BITS(AW), .CLK_HZ(CLK_HZ), .PACE(PACE), .RATES(RATES)) u_runs (
    .clk_i(clk_i), .address_i({place_q[AW-1:6] | {AW-6{snap_q}}, place_q[5:0]}), .write_i(write), .write_dat_i(count_q),
    .read_o(word)
  );

  // What is left of a run, in halves of a tick, and the divisor: twice the shortest run, a bit, or one tick
  reg  [16:0] rest_q = 17'd0;
  reg  [13:0] bit_q;                 // set when a frame begins
  wire        less;
  wire [16:0] reduced;
  assign {less, reduced} = {1'b0, rest_q} - {4'd0, bit_q};
  wire        nothing = (rest_q[16:2] == 15'd0);                    // one tick or none

  // ------------------------------------------------------------------ runs of the frame on the line

  reg  wrote_q = 1'b0, read_q = 1'b0, shorter_q = 1'b0;             // clocks behind a run that is written
  reg  ending_q = 1'b0;              // it was the silence behind the frame
  reg  spoiled_q = 1'b0;             // the frame cannot be decoded

  wire level   = place_q[0];         // of the run that is recorded; the first is low
  wire free    = record_q & ~wrote_q & ~read_q & ~ending_q;
  wire longest = &count_q[15:10];                // above 10 bits of the slowest rate
  wire turn    = free & (rxd != level);
  wire silence = free & rxd & level & (longest | (~bit_q[13] & ~bit_q[12] & (count_q[15:8] >= bit_q[11:4])));
  wire stores  = turn | silence;
  wire marks   = record_q & ending_q & shorter_q;           // a run of no length is the end
  wire is_break = free & ~rxd & longest;
  // A good frame has at least eight runs; less is a spike.
  wire no_frame = spoiled_q | (place_q[AW-1:3] == {AW-3{1'b0}});
  wire in_table = &place_q[AW-1:6];
  assign write = (stores | marks) & ~in_table;

  // ------------------------------------------------------------------ what becomes of it

  wire failed  = behind_q & locked_q & idle_i & ~frame_stb_i;
  wire enough, judge;

  generate
    if (BAD_FRAMES == 1) begin : gen_at_once
      assign enough = failed;
    end else begin : gen_bad
      localparam W = $clog2(BAD_FRAMES);
      reg [W-1:0] bad_q = {W{1'b0}};             // bad frames in a row
      assign enough = failed & (bad_q == BAD_FRAMES[W-1:0] - 1'b1);
      always @(posedge clk_i) begin
        if (failed) bad_q <= bad_q + 1'b1;
        if (frame_stb_i || !locked_q) bad_q <= {W{1'b0}};
      end
    end
  endgenerate

  assign judge = (behind_q & ~locked_q & idle_i) | enough;
  wire drop    = (marks & no_frame) | (behind_q & frame_stb_i) | (failed & ~enough);

  // ------------------------------------------------------------------ decoder and player

  reg        wait_q = 1'b0;          // the first word is on its way
  reg        fresh_q = 1'b0;         // the next word is not there yet
  reg        half_q = 1'b0;          // second half of a bit
  reg  [3:0] number_q = 4'd0;        // of the bit in the character
  reg  [3:0] chars_q = 4'd0;         // a one for each of the first four characters that is behind
  reg        parity_q = 1'b0;
  reg        ours_q = 1'b0, all_q = 1'b0;        // the first one is the address
  reg  [1:0] try_q = 2'd0;           // the format that is tried
  reg        even_q = 1'b0, odd_q = 1'b0;        // 8E1, 8O1 fits; not both, but 8N2 may too

  wire decodes = judge_q | play_q;
  wire ended   = decodes & fresh_q & nothing;
  wire used_up = play_q ? nothing : less;
  wire running = decodes & ~wait_q & (judge_q | tick_q);
  wire step    = running & ~used_up;
  wire load    = running & used_up & ~fresh_q;
  wire value   = ~place_q[0];        // the next word is already addressed
  wire take    = step & ~half_q & judge_q;

  // Data bits have the numbers 1 to 8: bit 7 is at 0.
  wire [7:0] address = {address_i[6:0], address_i[7]};
  wire [7:0] mask    = {mask_i[6:0], mask_i[7]};

  wire first      = (number_q == 4'd0);
  wire tail       = number_q[3] & (number_q[1] | number_q[0]);      // 9 and 10
  wire data_bit   = ~first & ~tail;
  wire is_parity  = number_q[0] & ~try_q[1];
  wire wrong      = take & tail & (is_parity ? parity_q ^ value : ~value);
  wire last       = tail & (&try_q | number_q[1]);
  wire crc_zero, crc_bit;

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(wait_q), .shift_i(take & data_bit), .feed_i(1'b1), .data_i(value),
    .bit_o(crc_bit), .zero_o(crc_zero)
  );
  wire unused = crc_bit;

  wire over    = (judge_q & ended) | wrong;
  wire fits    = first & crc_zero & chars_q[3];
  wire accept  = over & try_q[1] & (even_q | odd_q | fits);
  wire give_up = over & (&try_q) & ~fits;
  wire again   = over & ~accept & ~give_up;
  wire parity_fits = even_q | odd_q;
  wire none_fits   = fits & ~try_q[0];           // at the third try
  wire two_fit     = parity_fits & none_fits;
  // Where two fit they take turns.
  wire       takes_none = ~parity_fits | (none_fits & ~format_q[1]);
  wire [1:0] chosen     = {takes_none, takes_none ? ~parity_fits & ~none_fits : odd_q};

  wire fetch     = snap_q & ~fresh_q & ~wait_q;
  wire looks     = snap_q & fresh_q;
  wire snapped   = snap_q & place_q[6];
  wire begin_try = snapped | again;
  wire played    = play_q & ended;
  wire for_us    = ours_q | all_q;
  // A level that falls begins a frame, also while another one is decoded or played.
  wire begins    = ~rxd & ~record_q;
  wire forget    = begins | drop | give_up | played | (accept & ~for_us) | de_i | rst_i;

  // The table, a word in two clocks: place_q is already one ahead.
  reg  hit_q = 1'b0;
  wire exact = looks & (place_q[1:0] == 2'd3) & hit_q;

  // The shortest run in clocks; more than 65535 is not found
  // verilator lint_off UNUSED
  wire [18:0] measured = ({5'd0, bit_q} << PACE) >> 1;
  // verilator lint_on UNUSED

  always @(posedge clk_i) begin
    // The line
    wrote_q   <= stores;
    read_q    <= wrote_q;
    shorter_q <= read_q;
    ending_q  <= record_q & (ending_q | silence) & ~marks;
    if (tick_q) count_q <= count_q + 16'd1;
    if (stores || ending_q || !record_q) count_q <= 16'd1;         // the tick that is shared
    spoiled_q <= record_q & (spoiled_q | is_break | in_table);
    locked_q  <= accept ? ~two_fit : locked_q & ~is_break & ~enough & ~rst_i;

    // The place in the memory
    fresh_q <= load | fetch;
    wait_q  <= judge | begin_try | accept;
    if (read_q || load || fetch) place_q <= place_q + {{AW-1{1'b0}}, 1'b1};
    if (judge || begin_try || accept || forget) place_q <= {AW{1'b0}};

    // What is divided
    if (read_q || load || fetch) rest_q <= {word, 1'b0};
    else if (step) rest_q <= reduced;
    if (wait_q) rest_q <= 17'd0;
    if ((shorter_q && less) || snapped || accept)
      bit_q <= (({14{shorter_q}} & rest_q[13:0]) | ({14{~shorter_q & ~accept}} & {1'b0, bit_q[13:1]}) |
                {12'd0, accept, 1'b0});
    if (forget) bit_q <= LONGEST;
    if (looks) hit_q <= place_q[0] ? less : hit_q & ~less & snap_i;

    // The characters
    half_q <= ~load & (half_q ^ step);
    if (take) number_q <= number_q + 4'd1;
    if ((take && (first ? value : last)) || wait_q) number_q <= 4'd0;
    if (take) parity_q <= first ? try_q[0] : parity_q ^ value;
    if (take && data_bit && ~chars_q[0]) begin
      ours_q <= ours_q & ((value == address[number_q[2:0]]) | mask[number_q[2:0]]);
      all_q  <= all_q & ~value;
    end
    if (take && last) chars_q <= {chars_q[2:0], 1'b1};
    if (wait_q) begin
      chars_q  <= 4'd0;
      ours_q   <= 1'b1;
      all_q    <= 1'b1;
    end

    // The formats
    if (over) try_q <= try_q + 2'd1;
    if (over && fits && !try_q[0]) even_q <= 1'b1;
    if (over && fits && try_q[0])  odd_q  <= 1'b1;
    if (judge) begin
      try_q <= 2'd0;
      {even_q, odd_q} <= 2'd0;
    end

    // What is found; the core takes nothing in while this changes
    if (judge || exact) bit_time_q <= judge ? measured[15:0] : rest_q[16:1];
    if (rst_i) bit_time_q <= SHORT;      // the core does not wait for t3.5 of a rate that was
    // A reset leaves none with parity: where two fit, that comes first.
    format_q <= (accept ? chosen : format_q) | {rst_i, 1'b0};

    // The state
    record_q <= (record_q & ~marks) | begins;
    behind_q <= (behind_q & ~judge) | marks;
    snap_q   <= (snap_q & ~snapped) | judge;
    judge_q  <= (judge_q & ~accept) | snapped;
    play_q   <= play_q | accept;
    if (forget) {behind_q, snap_q, judge_q, play_q} <= 4'd0;
    if (drop || de_i || rst_i) record_q <= 1'b0;
  end

  // ------------------------------------------------------------------ to the core

  reg rxd_q = 1'b1;
  always @(posedge clk_i)
    rxd_q <= play_q ? value | ended : rxd | ~locked_q;

  assign rxd_o      = rxd_q;
  assign bit_time_o = bit_time_q;
  assign format_o   = format_q;
  assign locked_o   = locked_q;

`ifdef FORMAL
  // Line, memory and check field are cut off: whatever they say, the core hears the line or what was recorded, its
  // settings change while it hears rest, and the table is never written.
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);

  always @(posedge clk_i) if (f_past) begin
    assert (record_q + behind_q + snap_q + judge_q + play_q <= 1);
    if (snap_q || judge_q) assert (!locked_q);
    if (write) assert (record_q && !snap_q && !(&place_q[AW-1:6]));
    if (snap_q) assert (place_q[AW-1:6] == 0 || place_q[6]);
    if (!$past(rst_i)) begin
      // What the core hears
      if (!$past(play_q)) assert (rxd_o == ($past(rxd) | !$past(locked_q)));
      if ($past(ended)) assert (rxd_o || !$past(play_q));
      if (!$past(play_q) && play_q) assert ($past(judge_q && (ours_q || all_q)));
      // Settings
      if ($past(f_past) && !$past(rst_i, 2) && !$stable(bit_time_o)) assert ($past(snap_q | (behind_q & idle_i)) && !locked_q);
      if ($past(f_past) && !$past(rst_i, 2) && !$stable(format_o)) assert ($past(judge_q & over));
      // Locked by a good frame alone, for one format alone; not longer than it is to be
      if (locked_q && !$past(locked_q))
        assert ($past(judge_q && (fits || even_q || odd_q)) && !($past(even_q | odd_q) && $past(fits & try_q == 2'd2)));
      if ($past(enough | is_break)) assert (!locked_q);
      if ($past(locked_q) && !locked_q) assert ($past(behind_q & idle_i & !frame_stb_i | is_break));
    end
    if (de_i && $past(de_i)) assert (!record_q && !behind_q && !play_q);
    cover (behind_q && place_q == 10);
    cover (snap_q);
  end
`endif

endmodule

`default_nettype wire
