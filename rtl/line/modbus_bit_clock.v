// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bit_clock - divides a bit into four quarters, exactly N clocks a bit for any N from 8 up.
//
// Receiver, transmitter and all timers share this one divider: the line is half duplex.
// A quarter lasts N / 4 clocks, rounded up or down so that four of them make N.
//
// restart_i makes the next clock the first of a new bit.  quarter_stb_o and bit_stb_o are high in the last clock of
// a quarter and of a bit.  Below 8 clocks a bit the strobes are not spaced as promised; nothing locks up.

`default_nettype none

module modbus_bit_clock (
  input  wire        clk_i,
  input  wire [15:0] bit_time_i,     // clocks per bit, 8..65535
  input  wire        restart_i,      // strobe: a bit begins in the next clock
  output wire        quarter_stb_o,  // strobe: a quarter ends
  output wire [1:0]  quarter_o,      // level : which one, 0..3
  output wire        bit_stb_o       // strobe: the bit ends
);

  reg [13:0] clocks_q   = 14'd2;     // clock of this quarter, the first is 2: one ahead of the comparison, one of the strobe
  reg [1:0]  quarter_q  = 2'd0;
  reg        extended_q = 1'b0;
  reg        stb_q      = 1'b0;

  // The two low bits of N are paid out as extra clocks: two in the middle quarters, which keeps a receiver's three
  // looks a full quarter apart and the second one in the middle; one at the end.
  wire extend = (quarter_q == 2'd3) ? bit_time_i[0] : (quarter_q != 2'd0) & bit_time_i[1];
  // Counting up from below, the first number with all the bits of N / 4 is N / 4 itself.
  wire full   = &(clocks_q | ~bit_time_i[15:2]);
  wire ends   = full & (extended_q | ~extend);

  always @(posedge clk_i) begin
    stb_q      <= ends & ~restart_i & ~stb_q;
    extended_q <= full & extend & ~restart_i & ~stb_q;
    if (restart_i || stb_q) clocks_q <= 14'd2;
    else if (!full)         clocks_q <= clocks_q + 14'd1;
    if (restart_i)  quarter_q <= 2'd0;
    else if (stb_q) quarter_q <= quarter_q + 2'd1;
  end

  assign quarter_stb_o = stb_q;
  assign quarter_o     = quarter_q;
  assign bit_stb_o     = stb_q & (quarter_q == 2'd3);

endmodule

`default_nettype wire
