// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_line_health - what a service engineer asks about a line: eight words, counted and measured beside the core.
//
// | Word | Holds                                                                                            |
// |------|--------------------------------------------------------------------------------------------------|
// | 0    | glitches: the line at rest fell and was high again within half a bit                             |
// | 1    | breaks: the line was low for longer than a character                                             |
// | 2    | frames with a wrong parity bit                                                                   |
// | 3    | frames with a stop bit of 0                                                                      |
// | 4    | frames in which the check field alone is wrong                                                   |
// | 5    | frames with a gap above t1.5                                                                     |
// | 6    | largest gap inside a good frame since the words were cleared, in thousandths of a character      |
// | 7    | bit time of the sender of the last good frame, in thousandths of ours; 0: no good frame yet      |
//
// Words 0 to 5 stop at 65535, word 6 at 13336 or a few more.  clear_i or rst_i sets all words to 0 within 64 clocks; what
// happens meanwhile may not be counted.  An event is in its word after at most 64 clocks; the same one again before
// that may not count.
//
// Time between the beginnings of two start bits is counted in thousandths of a character of ours.  The shortest of a
// good frame is word 7: 1020 is a sender whose bits are 2 % longer than ours.  A sender with a gap behind every
// character shows more, by its smallest gap.  The longest less 1000 is the gap.  With a bit time below 104 clocks it is
// counted in tens; below 10 clocks it is not measured.  The sixteenths of MB_SET_BIT_FRACTION do not count.
//
// What is on the line while de_i is high is neither counted nor measured.  Good and bad are what the core says
// (events_o), of every frame that it receives (MODBUS over Serial Line V1.02, 2.5.1); the line is only heard.
//
// Read port: stb_i and adr_i stay until ack_o, which comes one or two clocks later, or behind what is being written: up
// to 14 clocks, up to 34 while the words are cleared.  dat_o holds the word in that clock alone.

`default_nettype none
`include "modbus_defs.vh"

module modbus_line_health #(
  parameter integer MAX_BIT_TIME = 65535         // no bit time is above it, 8..65535
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high
  input  wire        clear_i,                    // strobe: all words to 0

  // Line and core
  input  wire        rxd_i,                      // asynchronous, idle 1: the pin that the core has
  input  wire        de_i,                       // level : de_o of the core
  input  wire        rx_active_i,                // level : rx_active_o of the core
  input  wire [`MB_EVENTS_WIDTH-1:0]   events_i,         // events_o of the core
  input  wire [`MB_SETTINGS_WIDTH-1:0] settings_i,       // settings_i of the core

  // Words
  input  wire        stb_i,                      // level until ack_o
  input  wire [2:0]  adr_i,
  output wire [15:0] dat_o,                      // valid with ack_o
  output wire        ack_o
);

  generate
    if (MAX_BIT_TIME < 8 || MAX_BIT_TIME > 65535) begin : gen_illegal
      ERROR_modbus_line_health_MAX_BIT_TIME_from_8_to_65535 illegal_parameter ();
    end
  endgenerate

  localparam integer BW = (MAX_BIT_TIME < 128) ? 8 : $clog2(MAX_BIT_TIME + 1);  // a step takes 8 bits
  localparam integer NW = 14;                    // bits of a distance
  localparam [15:0] MINUS_CHARACTER = 16'd64536; // -1000

  wire [15:0]   set_bit_time = settings_i[`MB_SET_BIT_TIME];
  wire [BW-1:0] bit_time     = set_bit_time[BW-1:0];
  wire ten_bits = (settings_i[`MB_SET_FORMAT] == `MB_FORMAT_8N1) |
                  (settings_i[`MB_SET_ASCII] & ~settings_i[`MB_SET_EIGHT_BITS]);
  wire fine     = (|bit_time[BW-1:7]) | (&bit_time[6:5] & (bit_time[4] | bit_time[3]));    // 104 and more
  wire unused   = &{1'b0, settings_i, events_i, set_bit_time};

  // ------------------------------------------------------------------ start bits, glitches, breaks

  wire rxd_sync;
  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd_sync));

  reg  [NW-1:0] time_q = {NW{1'b0}};             // since the start bit began, in thousandths of a character
  reg  line_q  = 1'b1;
  reg  low_q   = 1'b0;                           // low since the start bit began
  reg  half_q  = 1'b0;                           // time_q has passed half a bit
  reg  whole_q = 1'b0;                           // time_q has passed the last bit that may fall
  reg  spike_q = 1'b0;                           // what began last was no start bit
  reg  valid_q = 1'b0;                           // it is the second character of a frame or a later one

  wire line      = rxd_sync | de_i;
  wire begins    = line_q & ~line & (whole_q | spike_q);
  wire glitch    = low_q & line & ~half_q;
  wire is_break  = low_q & time_q[10];
  // A bit later the start bit is one, and the frame has not ended before it.
  wire confirmed = valid_q & time_q[7];

  always @(posedge clk_i) begin
    line_q  <= line;
    low_q   <= begins | (low_q & ~line & ~is_break);
    half_q  <= ~begins & (half_q | &time_q[5:4]);
    whole_q <= ~begins & (whole_q | &time_q[9:7]);
    spike_q <= glitch | (spike_q & ~begins);
    valid_q <= rx_active_i & (begins ? ~spike_q : valid_q & ~glitch & ~time_q[7]);
  end

  // ------------------------------------------------------------------ thousandths of a character

  // Every clock takes 1000 / 11 or 1000 / 10, on average, from what is left of the bit time; when nothing is left, a
  // thousandth is over, and the next one begins.  Below 104 clocks it is a tenth of that, and ten thousandths at a time.
  // The first one counts when it begins.
  reg  [BW:0] left_q = {BW+1{1'b0}};             // less 1
  reg  [3:0]  turn_q = 4'd0;
  wire        last_turn = turn_q[3] & turn_q[1];
  wire signed [7:0] step = fine ? (ten_bits ? -8'sd100 : last_turn ? -8'sd90 : -8'sd91)
                                : (ten_bits | last_turn ? -8'sd10 : -8'sd9);
  wire        tick = left_q[BW];
  wire [BW:0] less = {{BW-7{1'b1}}, step};
  wire [BW:0] more = {1'b0, bit_time} + less;
  wire        held = &time_q[NW-1:NW-3];     // 14336 and more

  always @(posedge clk_i) begin
    left_q <= left_q + (tick ? more : less);
    turn_q <= last_turn ? 4'd0 : turn_q + 4'd1;
    if (tick && !held) time_q <= time_q + {{NW-4{1'b0}}, ~fine, 1'b0, ~fine, fine};
    if (begins || rst_i) begin
      left_q <= {BW+1{1'b1}};
      turn_q <= 4'd0;
      time_q <= {NW{1'b0}};
    end
  end

  // ------------------------------------------------------------------ what has happened

  // One round of 16 places, two clocks each: the word is read, then written.
  reg  [4:0] round_q = 5'd0;
  wire [3:0] place   = round_q[4:1];
  wire       second  = round_q[0];
  wire       turns   = &round_q;                 // last clock of a round

  reg  [5:0] happened_q = 6'd0, count_q = 6'd0;  // until the round begins; in this round, that of this place first
  reg        measured_q = 1'b0, measure_q = 1'b0;        // a distance between characters
  reg        good_q     = 1'b0, keep_q    = 1'b0;        // a good frame
  reg        cleared_q  = 1'b0, clear_q   = 1'b0;
  reg        first_q    = 1'b1;                  // no distance of this frame yet

  wire [5:0] happens = {events_i[`MB_EVENT_GAP], events_i[`MB_EVENT_CRC], events_i[`MB_EVENT_FRAMING],
                        events_i[`MB_EVENT_PARITY], is_break, glitch};

  always @(posedge clk_i) begin
    round_q    <= round_q + 5'd1;
    happened_q <= happens | (happened_q & ~{6{turns}});
    measured_q <= confirmed | (measured_q & ~turns);
    good_q     <= events_i[`MB_EVENT_FRAME] | (good_q & ~turns);
    cleared_q  <= clear_i | rst_i | (cleared_q & ~turns);
    if (second) count_q <= turns ? happened_q : {1'b0, count_q[5:1]};
    if (turns) begin
      measure_q <= measured_q;
      keep_q    <= good_q;
      clear_q   <= cleared_q;
    end
    first_q <= ~rx_active_i | clear_q | (first_q & ~(measure_q & turns));
  end

  // ------------------------------------------------------------------ words

  // | Place    | Word       | With               | What                                                    |
  // |----------|------------|--------------------|---------------------------------------------------------|
  // | 0 to 5   | the same   | count_q[0]         | one more                                                |
  // | 8        | 8          | measure_q          | longest distance in this frame                          |
  // | 10       | 10         | measure_q          | shortest                                                |
  // | 12       | 8          | keep_q             | goes, less a character, to distance_q                   |
  // | 13       | 6          | keep_q             | largest gap                                             |
  // | 14       | 10         | keep_q             | goes to distance_q                                      |
  // | 15       | 7          | keep_q             | bit time                                                |
  wire in_frame = place[3] & ~place[2];
  wire behind   = place[3] & place[2];
  wire fetches  = behind & ~place[0];
  wire stores   = behind & place[0];
  wire [3:0] word_of_place = stores ? {3'b011, place[1]} : {place[3], place[2] & ~place[3], place[1:0]};

  wire [15:0] word;
  reg  [NW-1:0] distance_q;
  reg         ack_q = 1'b0;

  // One adder: word + 1, word - distance, word - 1000; when a word is replaced, its carry still compares.
  wire        replaces = clear_q | in_frame | stores;
  wire [15:0] operand  = replaces ? {16{clear_q}} | ~{{16-NW{1'b0}}, distance_q}
                                  : {16{fetches & ~place[1]}} & MINUS_CHARACTER;
  wire        not_less;                          // carry: word >= distance, word >= 1000, word = 65535
  wire [15:0] sum;
  assign {not_less, sum} = {1'b0, word} + {1'b0, operand} + {16'd0, ~fetches};
  wire [15:0] new_word = replaces ? ~operand : sum;

  wire active  = behind ? keep_q : in_frame ? measure_q & ~place[0] : count_q[0];
  wire agrees  = in_frame ? first_q | (not_less == place[1]) : behind ? place[0] & (place[1] | ~not_less) : ~not_less;
  wire write   = second & (clear_q | (active & agrees));
  wire fetch   = second & keep_q & fetches;

  modbus_health_ram u_ram (
    .clk_i(clk_i), .write_i(write), .write_adr_i(word_of_place), .write_dat_i(new_word),
    .read_adr_i(second ? {1'b0, adr_i} : word_of_place), .word_o(word)
  );

  always @(posedge clk_i) begin
    ack_q <= stb_i & second & ~write;
    if (fetch) distance_q <= sum[NW-1:0];
    if (fetch && !place[1] && !not_less) distance_q <= {NW{1'b0}};
    if (begins && rx_active_i) distance_q <= time_q;
  end

  assign dat_o = word;
  assign ack_o = ack_q;

`ifdef FORMAL
  // The line is free, and so are the events.
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);
  always @* assume (bit_time >= 10);
  always @(posedge clk_i) if (f_past) begin
    assume ($stable(settings_i));
    if ($past(stb_i && !ack_o)) assume (stb_i && $stable(adr_i));
  end

  (* anyconst *) reg [2:0] f_word;               // any counter
  always @* assume (f_word < 3'd6);
  wire [7:0] f_happens = {2'b00, happens}, f_waits = {2'b00, happened_q};
  wire [15:0] f_counted = {10'd0, count_q};
  reg       f_new = 1'b0, f_old = 1'b0;          // it has happened in this round, in the last one
  wire      f_turn = second & ({1'b0, f_word} == place);       // its place in the round
  wire      f_counts = f_turn & count_q[0] & ~clear_q;
  reg       f_good_new = 1'b0, f_good = 1'b0;    // a good frame in this round, in the last one

  always @(posedge clk_i) begin
    f_new  <= f_happens[f_word] | (f_new & ~turns);
    if (turns) f_old <= f_new;
    f_good_new <= events_i[`MB_EVENT_FRAME] | (f_good_new & ~turns);
    if (turns) f_good <= f_good_new;
  end

  always @(posedge clk_i) if (f_past) begin
    // Each event counts, once, in the round behind it; a counter only goes up by one, and never over.
    if (f_turn) assert (count_q[0] == f_old);
    assert (f_waits[f_word] == f_new && good_q == f_good_new && keep_q == f_good);
    assert ((count_q >> (place < 4'd6 ? 4'd6 - place : 4'd0)) == 6'd0);
    if (place <= {1'b0, f_word}) assert (f_counted[{1'b0, f_word} - place] == f_old);
    if (write && word_of_place == {1'b0, f_word}) begin
      assert (clear_q || f_counts);
      assert (clear_q ? new_word == 16'd0 : new_word == word + 16'd1 && word != 16'hFFFF);
    end
    if (f_counts && word != 16'hFFFF) assert (write);
    // The largest gap only grows; the bit time needs a good frame.
    if (write && word_of_place == 4'd6) assert (clear_q ? new_word == 16'd0 : f_good && new_word > word);
    if (write && word_of_place == 4'd7) assert (clear_q ? new_word == 16'd0 : f_good);
    // What is written belongs to what was read; the host gets its word, and soon.
    if (second) assert ($past(word_of_place) == word_of_place && !$past(write));
    if (ack_o) assert ($past(second && !write && stb_i) && $stable(adr_i));
    assert (ack_o == $past(second && stb_i && !write));
    // Time goes on, and what has passed half a bit is no glitch.
    assert (half_q || time_q < 64);
    if (!$past(begins | rst_i)) assert (time_q >= $past(time_q));
    assert (!(glitch && is_break));
    cover (f_counts && write);
    cover (ack_o && clear_q);
  end
`endif

endmodule

`default_nettype wire
