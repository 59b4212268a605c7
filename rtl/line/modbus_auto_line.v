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
// call good, or does not even notice, is a bad one; release_i of them in a row, or a break, end the lock.  The frame
// that ended it is decoded at once, so a new rate is found in the frame that shows it.
//
// 8E1 or 8O1 and 8N2 are the same on the line as long as all parity bits are 1.  Then locked_o stays low: each frame is
// decoded and played, the formats that fit take turns, and the first frame that fits one of them alone locks.
//
// Time is counted in ticks, 32 to the bit of TOP_BAUD.  The slowest rate has 192 times its bit.  Settings change only
// while idle_i is high.  A frame of more runs than the memory has words is not decoded.

`default_nettype none
`include "modbus_defs.vh"

module modbus_auto_line #(
  parameter integer CLK_HZ        = 50000000,    // clk_i in hertz, from 32 * TOP_BAUD to below 256 * TOP_BAUD
  parameter integer TOP_BAUD      = 230400,      // the fastest rate that can be found
  parameter integer RUN_BITS      = 8,           // 2^RUN_BITS words for runs and table, 8..12
  parameter integer BIT_FRACTIONS = 0,           // that of the core
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
  output wire [3:0]  fraction_o,                 // for MB_SET_BIT_FRACTION
  output wire [1:0]  format_o,                   // for MB_SET_FORMAT

  // Choices
  input  wire        snap_i,                     // level : 1 a rate within 2 % of a standard one is taken for that
  input  wire [3:0]  release_i,                  // level : bad frames in a row that end the lock, 1..15
  input  wire [7:0]  address_i,                  // level : frames for this address and for 0 are played to the core
  input  wire [7:0]  mask_i,                     // level : bits of the address that do not count

  output wire        locked_o                    // level : bit time and format are found
);

  generate
    if (TOP_BAUD < 1200 || TOP_BAUD > 500000 || CLK_HZ / 32 < TOP_BAUD || CLK_HZ / 256 >= TOP_BAUD) begin : gen_clock
      ERROR_modbus_auto_line_CLK_HZ_from_32_to_256_times_TOP_BAUD illegal_parameter ();
    end
    if (RUN_BITS < 8 || RUN_BITS > 12) begin : gen_runs
      ERROR_modbus_auto_line_RUN_BITS_from_8_to_12 illegal_parameter ();
    end
  endgenerate

  // CLK_HZ / TICK_HZ, 1 to 8, without a term above 32 bits.
  localparam integer TICK_HZ   = 32 * TOP_BAUD;
  localparam integer PACE_BITS = 12;
  localparam integer CLK_UNITS = CLK_HZ / 4096;                                // 4096 is 2^PACE_BITS
  localparam integer PACE      = (TICK_HZ + CLK_UNITS / 2) / CLK_UNITS;        // of 4096 in a clock
  // Clocks a tick in units of 2^-13: what is left of the division is divided again.
  localparam integer CLOCKS    = CLK_HZ / TICK_HZ;
  localparam integer REST      = CLK_HZ % TICK_HZ;
  localparam integer SCALE     = CLOCKS * 8192 + (REST / 64 * 8192 + TICK_HZ / 128) / (TICK_HZ / 64);
  // Rounds the bit time to a clock, or to a sixteenth of one
  localparam [15:0]  HALF      = (BIT_FRACTIONS != 0) ? 16'd256 : 16'd4096;

  localparam integer AW = RUN_BITS;
  localparam [AW-1:0] TABLE = -36;
  localparam [AW-5:0] NO_ROOM = -3;              // the upper bits of a word just below the table

  localparam [2:0] ST_LISTEN = 3'd0, ST_SNAP = 3'd1, ST_JUDGE = 3'd2, ST_TUNE = 3'd3, ST_SCALE = 3'd4, ST_PLAY = 3'd5;
  localparam [13:0] LONGEST = 14'h3FFF;

  reg [2:0]    state_q = ST_LISTEN;
  reg          locked_q = 1'b0;
  reg [1:0]    format_q = `MB_FORMAT_8N2;        // the first try is 8E1
  reg [15:0]   bit_time_q = HALF;
  reg [3:0]    fraction_q = 4'd0;

  // ------------------------------------------------------------------ line and ticks

  wire rxd_sync, rxd;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd_sync));

  modbus_glitch_filter #(.CLOCKS(GLITCH_FILTER)) u_filter (.clk_i(clk_i), .level_i(rxd_sync), .level_o(rxd));

  reg  [PACE_BITS-1:0] pace_q = {PACE_BITS{1'b0}};
  reg                  tick_q = 1'b0;
  always @(posedge clk_i) {tick_q, pace_q} <= {1'b0, pace_q} + PACE[PACE_BITS:0];

  // ------------------------------------------------------------------ memory

  reg  [AW-1:0] place_q = {AW{1'b0}};
  reg  [15:0]   count_q = 16'd0;                 // ticks of the run on the line
  wire [15:0]   word;
  wire          write;

  modbus_run_ram #(.ADDRESS_BITS(AW), .TOP_BAUD(TOP_BAUD)) u_runs (
    .clk_i(clk_i), .address_i(place_q), .write_i(write), .write_dat_i(count_q), .read_o(word)
  );

  // What is left of a run, in halves of a tick, and the divisor: twice the shortest run, a bit, or one tick
  reg  [16:0] rest_q = 17'd0;
  reg  [13:0] bit_q = LONGEST;
  wire        less;
  wire [16:0] reduced;
  assign {less, reduced} = {1'b0, rest_q} - {4'd0, bit_q};
  wire        nothing = (rest_q[16:2] == 15'd0);                    // one tick or none

  // ------------------------------------------------------------------ runs of the frame on the line

  reg  begun_q = 1'b0;               // a frame is recorded
  reg  wrote_q = 1'b0, read_q = 1'b0, shorter_q = 1'b0;             // clocks behind a run that is written
  reg  ending_q = 1'b0;              // it was the silence behind the frame
  reg  complete_q = 1'b0;            // the frame is recorded
  reg  spoiled_q = 1'b0;             // it cannot be decoded
  reg  good_q = 1'b0;                // the core has called it good
  reg  [3:0] bad_q = 4'd0;           // bad frames in a row

  wire listen  = (state_q == ST_LISTEN);
  wire level   = place_q[0];         // of the run that is recorded; the first is low
  wire free    = begun_q & ~complete_q & ~wrote_q & ~read_q & ~ending_q;
  wire longest = &count_q;
  wire turn    = free & (rxd != level);
  wire silence = free & rxd & level & (longest | ({2'd0, count_q[15:4]} >= bit_q));
  wire stores  = turn | silence;
  wire marks   = ending_q & shorter_q;           // a run of no length is the end
  assign write = (stores | marks) & ~spoiled_q;

  // ------------------------------------------------------------------ what becomes of it

  // A good frame has at least eight runs; less is a spike.
  wire no_frame = spoiled_q | (place_q[AW-1:3] == {AW-3{1'b0}});
  wire failed  = complete_q & locked_q & idle_i & ~good_q & ~no_frame;
  wire enough  = failed & (&(bad_q | ~release_i));
  wire judge   = complete_q & listen & ~no_frame & (~locked_q | enough);
  wire drop    = complete_q & listen & (no_frame | (locked_q & (good_q | (failed & ~enough))));

  // ------------------------------------------------------------------ decoder and player

  reg  [1:0] wait_q = 2'd0;          // the first word is on its way
  reg        fresh_q = 1'b0;         // the next word is not there yet
  reg        half_q = 1'b0;          // second half of a bit
  reg  [3:0] number_q = 4'd0;        // of the bit in the character; steps of the scaling
  reg  [2:0] chars_q = 3'd0;         // characters, not above 4
  reg        parity_q = 1'b0;
  reg        ours_q = 1'b0, all_q = 1'b0;        // the first one is the address
  reg  [1:0] try_q = 2'd0, tries_q = 2'd0;       // format that is tried, how many before it
  reg  [1:0] chosen_q = 2'd0;
  reg        found_q = 1'b0, again_q = 1'b0;     // a format fits, a second one
  reg        halved_q = 1'b0;        // no run was a single bit: half of the shortest one is tried

  wire judging = (state_q == ST_JUDGE);
  wire playing = (state_q == ST_PLAY);
  wire decodes = judging | playing;
  wire ended   = decodes & fresh_q & nothing;
  wire pace    = judging | tick_q;
  wire used_up = playing ? nothing : less;
  wire running = decodes & ~wait_q[0] & ~wait_q[1] & ~ended & pace;
  wire step    = running & ~used_up;
  wire load    = (decodes & wait_q[1]) | (running & used_up & ~fresh_q);
  wire value   = ~place_q[0];        // the next word is already addressed
  wire take    = step & ~half_q & judging;

  wire has_parity = ~try_q[1];
  wire ten_bits   = &try_q;
  wire first      = (number_q == 4'd0);
  wire tail       = number_q[3] & (number_q[1] | number_q[0]);      // 9 and 10
  wire is_parity  = tail & number_q[0] & has_parity;
  wire data_bit   = ~first & ~tail;
  wire wrong      = take & tail & (is_parity ? parity_q ^ value : ~value);
  wire last       = tail & (ten_bits | number_q[1]);
  wire crc_zero, crc_bit;

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(wait_q[0]), .shift_i(take & data_bit), .feed_i(1'b1), .data_i(value),
    .bit_o(crc_bit), .zero_o(crc_zero)
  );
  wire unused = crc_bit;

  wire over    = judging & (ended | wrong);
  wire fits    = first & crc_zero & chars_q[2];
  wire third   = tries_q[1] & ~tries_q[0];
  wire fourth  = &tries_q;
  wire accept  = over & ((third & (found_q | fits)) | (fourth & fits));
  wire shrink  = over & fourth & ~fits & ~halved_q;
  wire give_up = over & fourth & ~fits & halved_q;
  wire [1:0] next_try = (third & ~found_q & ~fits) ? 2'd3 : try_q[1] ? 2'd0 : try_q + 2'd1;
  wire again   = over & ~accept & ~give_up;

  wire snapping  = (state_q == ST_SNAP);
  wire fetch     = snapping & ~fresh_q & ~wait_q[0] & place_q[AW-1];
  wire snapped   = snapping & ~fresh_q & ~place_q[AW-1];
  wire scaling   = (state_q == ST_SCALE);
  wire scaled    = scaling & (number_q == 4'd12);
  wire begin_try = snapped | again;
  wire tune      = (state_q == ST_TUNE) & idle_i;
  wire played    = playing & ended;
  wire for_us    = ours_q | all_q;
  // A level that falls while a frame is decoded or played begins another one.
  wire breaks_in = ~rxd & (complete_q | ~listen) & ~scaling;
  wire begins    = (listen & ~begun_q & ~rxd) | breaks_in;
  wire forget    = begins | drop | give_up | played | (scaled & ~for_us) | de_i | rst_i;

  // The table, a word in two clocks
  reg  above_q = 1'b0, hit_q = 1'b0;
  wire looks = snapping & fresh_q;
  wire snaps = looks & (place_q[1:0] == 2'd3) & hit_q;

  always @(posedge clk_i) begin
    // The line
    wrote_q   <= stores;
    read_q    <= wrote_q;
    shorter_q <= read_q;
    if (silence) ending_q <= 1'b1;
    if (marks) {ending_q, complete_q} <= 2'b01;
    if (tick_q && !longest) count_q <= count_q + 16'd1;
    if (stores || ending_q || !begun_q || begins) count_q <= 16'd0;
    if (place_q[AW-1:4] == NO_ROOM) spoiled_q <= spoiled_q | read_q;
    if (free && !rxd && longest) begin
      spoiled_q <= 1'b1;
      locked_q  <= 1'b0;
    end
    if (frame_stb_i) begin
      good_q <= 1'b1;
      bad_q  <= 4'd0;
    end
    if (failed && listen) bad_q <= bad_q + 4'd1;
    if (enough && listen) begin
      locked_q <= 1'b0;
      bad_q    <= 4'd0;
    end

    // The place in the memory
    fresh_q <= load | fetch;
    wait_q  <= {wait_q[0], judge | begin_try | scaled};
    if (read_q || load || fetch) place_q <= place_q + {{AW-1{1'b0}}, 1'b1};
    if (judge) place_q <= TABLE;
    if (begin_try || scaled || forget) place_q <= {AW{1'b0}};

    // What is divided
    if (read_q || load || fetch) rest_q <= {word, 1'b0};
    else if (step) rest_q <= reduced;
    if ((shorter_q && less) || snaps) bit_q <= rest_q[13:0];
    if (snapped || shrink || scaling) bit_q <= {scaling & first, bit_q[13:1]};
    if (forget) bit_q <= LONGEST;
    if (looks) above_q <= less;
    if (looks) hit_q <= above_q & ~less & snap_i;

    // The characters
    half_q <= ~load & (half_q ^ step);
    if (take) begin
      number_q <= (first ? value : last) ? 4'd0 : number_q + 4'd1;
      parity_q <= first ? try_q[0] : parity_q ^ value;
      if (data_bit && chars_q == 3'd0) begin
        ours_q <= ours_q & ((value == address_i[number_q[2:0] - 3'd1]) | mask_i[number_q[2:0] - 3'd1]);
        all_q  <= all_q & ~value;
      end
      if (last && !chars_q[2]) chars_q <= chars_q + 3'd1;
    end
    if (wait_q[0]) begin
      number_q <= 4'd0;
      chars_q  <= 3'd0;
      ours_q   <= 1'b1;
      all_q    <= 1'b1;
    end
    if (scaling) number_q <= number_q + 4'd1;
    if (tune) number_q <= 4'd0;

    // The formats
    if (over) begin
      tries_q <= tries_q + 2'd1;
      try_q   <= next_try;
      if (fits) begin
        found_q <= 1'b1;
        again_q <= found_q;
        if (!found_q) chosen_q <= try_q;
      end
    end
    if (snapped || shrink) tries_q <= 2'd0;
    if (shrink) halved_q <= 1'b1;
    if (judge) begin
      try_q    <= format_q[1] ? 2'd0 : format_q + 2'd1;
      found_q  <= 1'b0;
      again_q  <= 1'b0;
      halved_q <= 1'b0;
    end

    // What is found: bit_q times the clocks of a tick, lowest bit first
    if (scaling)
      {bit_time_q, fraction_q} <= {{1'b0, bit_time_q} + (bit_q[0] ? {SCALE[16:0]} : 17'd0), fraction_q[3:1]};
    if (tune) begin
      {bit_time_q, fraction_q} <= {HALF, 4'd0};
      format_q <= chosen_q;
      locked_q <= ~again_q;
    end

    // The state
    case (state_q)
      // Runs are recorded.
      ST_LISTEN: if (judge) state_q <= ST_SNAP;
      // The line is silent.  The shortest run is compared with the table.
      ST_SNAP: if (snapped) state_q <= ST_JUDGE;
      // The runs are decoded, in one format after the other.
      ST_JUDGE: if (accept) state_q <= ST_TUNE; else if (give_up) state_q <= ST_LISTEN;
      // A frame is good: wait until the core can take new settings.
      ST_TUNE: if (tune) state_q <= ST_SCALE;
      // The bit time is worked out.
      ST_SCALE: if (scaled) state_q <= for_us ? ST_PLAY : ST_LISTEN;
      // The core hears the frame.
      ST_PLAY: if (played) state_q <= ST_LISTEN;
      default: state_q <= ST_LISTEN;
    endcase

    if (forget) begin
      begun_q    <= begins;
      wrote_q    <= 1'b0;
      read_q     <= 1'b0;
      ending_q   <= 1'b0;
      complete_q <= 1'b0;
      spoiled_q  <= 1'b0;
      good_q     <= 1'b0;
      wait_q     <= 2'd0;
      state_q    <= ST_LISTEN;
    end
    if (de_i) begun_q <= 1'b0;
    if (rst_i) begin
      begun_q  <= 1'b0;
      locked_q <= 1'b0;
      bad_q    <= 4'd0;
    end
  end

  // ------------------------------------------------------------------ to the core

  reg rxd_q = 1'b1;
  always @(posedge clk_i) rxd_q <= playing ? value | ended | wait_q[0] | wait_q[1] : rxd | ~locked_q | ~listen;

  assign rxd_o      = rxd_q;
  assign bit_time_o = bit_time_q;
  assign fraction_o = (BIT_FRACTIONS != 0) ? fraction_q : 4'd0;
  assign format_o   = format_q;
  assign locked_o   = locked_q;

endmodule

`default_nettype wire
