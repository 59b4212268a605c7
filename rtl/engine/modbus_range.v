// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_range - one range of items: first address, quantity, last address, and what is wrong with them.
//
// A field of the request comes byte by byte, high byte first, with a strobe each.  The last address follows first address
// and quantity a clock later, but stands still while a burst moves the first address on.  past_end_o: the range passes
// FFFFH, or record 270FH in the space of files.  It comes with the last address; with HAS_FILES one clock behind it, and
// two for a record.  With HAS_FILES also the file number and the length of a file answer.
// With BITS_PER_BEAT = 16 a beat of bits is the part of the range in one word of 16 addresses.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_range #(
  parameter integer HAS_BITS     = 1,        // coils or discrete inputs are reachable
  parameter integer HAS_WORDS    = 1,        // registers are reachable
  parameter integer HAS_LITERALS = 1,        // addresses and quantities that are not in the request
  parameter integer HAS_FILES    = 1,
  parameter integer BITS_PER_BEAT = 1        // 1 or 16
) (
  input  wire        clk_i,

  // Sequencer
  input  wire [`MB_RANGE_DO_WIDTH-1:0] do_i,         // strobes, MB_DO_*
  input  wire [10:0] argument_i,     // level : MB_ARG_ROOM, MB_ARG_LITERAL
  input  wire [2:0]  space_i,        // level
  input  wire [7:0]  byte_i,
  input  wire [8:0]  count_i,        // bytes left behind the first data byte, for the byte count
  output wire [`MB_FOUND_WIDTH-1:0] found_o,         // levels, MB_FOUND_*
  output wire        past_end_o,     // level
  output wire [7:0]  length_o,       // level : length byte of a file group

  // Burst
  input  wire        moving_i,       // level : a burst is under way
  input  wire        next_i,         // strobe: a beat is through
  output wire        at_last_o,      // level : the beat from first_o on is the last one

  output wire [15:0] first_o,
  output wire [15:0] last_o,
  output wire [15:0] file_o
);

  reg [15:0] first_q;
  reg [15:0] quantity_less_one_q = 16'd0;     // quantity - 1: what the last address and the byte count need; no X in a sum
  reg [15:0] last_q;
  reg        past_ffff_q, in_limit_q, fit_q;

  wire words = (HAS_BITS == 0) || (HAS_WORDS != 0 && space_i[2:1] != 2'b00);
  wire [3:0] lanes = {4{BITS_PER_BEAT != 1 && !words}};     // address bits within one beat
  wire [7:0] bytes_less_one = words ? {quantity_less_one_q[6:0], 1'b1} : quantity_less_one_q[10:3];

  wire        set_first = (HAS_LITERALS != 0) & do_i[`MB_DO_FIRST];
  wire        set_less  = (HAS_LITERALS != 0) & do_i[`MB_DO_LESS];
  wire        set_address = do_i[`MB_DO_ADDRESS] | set_first;
  wire        less_one    = do_i[`MB_DO_LESS_ONE];

  // A literal has the high byte 0.
  wire [7:0]  given = (set_first | set_less) ? argument_i[`MB_ARG_LITERAL] : byte_i;
  // The sum means nothing while an address is set; written so, a counter that can be loaded takes one cell a bit.
  wire [15:0] next_first = {first_q[15:4], first_q[3:0] | lanes} + {{15{set_address}}, 1'b1};

  wire        above_limit;
  // verilator lint_off UNUSED
  wire [10:0] excess;
  // verilator lint_on UNUSED
  assign {above_limit, excess} = {1'b0, quantity_less_one_q[10:0]} + {1'b0, argument_i[`MB_ARG_ROOM]};

  always @(posedge clk_i) begin
    if (set_address || next_i) first_q <= set_address ? {first_q[7:0], given} : next_first;
    if (set_first)             first_q[15:8] <= 8'd0;

    if (do_i[`MB_DO_QUANTITY] || set_less)
      quantity_less_one_q <= {quantity_less_one_q[7:0], given} + {16{less_one}};
    if (set_less)                          quantity_less_one_q[15:8] <= 8'd0;
    if (do_i[`MB_DO_ONE] || set_first)     quantity_less_one_q <= 16'd0;

    if (!moving_i) {past_ffff_q, last_q} <= {1'b0, first_q} + {1'b0, quantity_less_one_q};

    in_limit_q <= (quantity_less_one_q[15:11] == 5'd0) & ~above_limit;
    fit_q      <= (count_i == {1'b0, bytes_less_one});
  end

  generate
    if (HAS_FILES != 0) begin : gen_files
      // A read answers with 2 + 2 x quantity bytes a group.  Words of a group: 1 and the quantity.  Counted from 5, more
      // than 122 (F5H bytes) in all show in bit 7.
      localparam [7:0] NO_GROUP = 8'd5;
      reg [15:0] file_q = 16'd0;
      reg        past_record_q, past_end_q;
      reg [7:0]  words_q;
      wire [6:0] quantity = quantity_less_one_q[6:0] + 7'd1;
      wire [7:0] total;
      wire       unused;
      assign {total, unused} = {words_q, 1'b1} + {1'b0, quantity, 1'b1};
      always @(posedge clk_i) begin
        if (do_i[`MB_DO_FILE]) file_q <= {file_q[7:0], byte_i};
        // 2710H or more
        past_record_q <= last_q[15] | last_q[14] |
                         (last_q[13] & (last_q[12] | last_q[11] | ((last_q[10:8] == 3'd7) & (last_q[7:4] != 4'd0))));
        past_end_q <= past_ffff_q | (past_record_q & (space_i == `MB_SPACE_FILES));
        if (do_i[`MB_DO_NO_GROUP])   words_q <= NO_GROUP;
        else if (do_i[`MB_DO_GROUP]) words_q <= total;
      end
      assign file_o     = file_q;
      assign past_end_o = past_end_q;
      assign found_o[`MB_FOUND_TOO_LONG] = words_q[7];
      assign length_o   = {quantity, 1'b1};
    end else begin : gen_no_files
      wire unused = &{1'b0, do_i, space_i};
      assign file_o     = 16'd0;
      assign past_end_o = past_ffff_q;
      assign found_o[`MB_FOUND_TOO_LONG] = 1'b0;
      assign length_o   = 8'd0;
    end
  endgenerate

  assign found_o[`MB_FOUND_IN_LIMIT] = in_limit_q;
  assign found_o[`MB_FOUND_FIT]      = fit_q;
  assign at_last_o = (BITS_PER_BEAT == 1) ? (first_q == last_q)
                   : (first_q[15:4] == last_q[15:4]) & ((first_q[3:0] == last_q[3:0]) | lanes[0]);
  assign first_o   = first_q;
  assign last_o    = last_q;

`ifdef FORMAL
  // The range that the fields give, kept beside in full width
  reg        f_past = 1'b0;
  reg [16:0] f_last;                 // exact last address, FFFFH passed or not
  reg [1:0]  f_settled = 2'd0;       // first address and quantity stand still for so long
  wire       f_change = set_address | next_i | do_i[`MB_DO_QUANTITY] | set_less | do_i[`MB_DO_ONE];

  always @(posedge clk_i) begin
    f_past    <= 1'b1;
    f_last    <= {1'b0, first_q} + {1'b0, quantity_less_one_q};
    f_settled <= f_change | moving_i ? 2'd0 : (f_settled == 2'd3) ? 2'd3 : f_settled + 2'd1;
  end

  always @* if (next_i) assume (moving_i);

  always @(posedge clk_i) if (f_past) begin
    // The last address is exact and never wraps unnoticed.
    if (f_settled != 2'd0) begin
      assert (last_q == f_last[15:0] && past_ffff_q == f_last[16]);
      assert (f_last[16] || last_q >= first_q);
    end
    if (f_settled == 2'd3 && HAS_FILES != 0)
      assert (past_end_o == (f_last[16] || ($past(space_i) == `MB_SPACE_FILES && f_last > 17'h0270F)));
    // The limit is exact: quantity - 1 below the highest quantity, which ROOM names.
    if ($past(f_settled) != 2'd0 && $past(argument_i[10:0]) != 11'd0)
      assert (found_o[`MB_FOUND_IN_LIMIT] ==
              ($past({1'b0, quantity_less_one_q}) < 17'd2048 - {6'd0, $past(argument_i[10:0])}));
    if ($past(moving_i)) assert ($stable(last_q) && $stable(past_ffff_q));
    if ($past(!set_address && !next_i)) assert ($stable(first_q));
    if ($past(next_i && !set_address))
      assert (first_q == ((BITS_PER_BEAT == 1 || $past(words)) ? $past(first_q) + 16'd1
                                                               : {$past(first_q[15:4]) + 12'd1, 4'd0}));
    assert (at_last_o == ((BITS_PER_BEAT == 1 || words) ? first_q == last_q : first_q / 16 == last_q / 16));
    cover (f_settled == 2'd3 && past_end_o && !f_last[16]);
    cover (found_o[`MB_FOUND_IN_LIMIT] && last_q == 16'hFFFF);
  end
`endif

endmodule

`default_nettype wire
