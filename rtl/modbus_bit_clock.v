// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bit_clock - divides a bit into four quarters, exactly N clocks a bit for any N from 8 up.
//
// Receiver, transmitter and all timers share this one divider: the line is half duplex.
// Quarter k lasts floor((N + k) / 4) clocks, so four of them make N without a fraction lost.
//
// restart_i begins a new bit; the clock in which it is high is the bit's first.  A transmitter raises it in
// the first clock of its start bit, a receiver in the clock in which it first sees the line low.  (The
// edge came up to one clock before that, so a receiver's looks are centred on a clock's width.)
//
// Below 8 clocks a bit the strobes are not spaced as promised; nothing locks up.

`default_nettype none

module modbus_bit_clock (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [15:0] bit_time_i,     // clocks per bit, 8..65535
  input  wire        restart_i,      // strobe: a bit begins
  output wire        quarter_stb_o,  // strobe: a quarter ends
  output wire [1:0]  quarter_o,      // level : which one, 0..3
  output wire        bit_stb_o       // strobe: the bit ends
);

  localparam [13:0] FIRST = 14'd1, RESTARTED = 14'd2;

  reg [13:0] clocks_q  = FIRST;
  reg [1:0]  quarter_q = 2'd0;
  reg        extended_q = 1'b0;

  // The two low bits of N are paid out as one extra clock in quarters 3, 2, 1 as needed.
  wire extend  = (quarter_q == 2'd3) ? |bit_time_i[1:0] :
                 (quarter_q == 2'd2) ?  bit_time_i[1]   :
                 (quarter_q == 2'd1) & (&bit_time_i[1:0]);
  wire at_end  = (clocks_q == bit_time_i[15:2]);

  assign quarter_stb_o = at_end & (extended_q | ~extend);
  assign quarter_o     = quarter_q;
  assign bit_stb_o     = quarter_stb_o & (quarter_q == 2'd3);

  always @(posedge clk_i) begin
    extended_q <= 1'b0;
    if (rst_i || restart_i) begin
      clocks_q  <= RESTARTED;
      quarter_q <= 2'd0;
    end else if (quarter_stb_o) begin
      clocks_q  <= FIRST;
      quarter_q <= quarter_q + 2'd1;
    end else if (at_end) begin
      extended_q <= 1'b1;
    end else begin
      clocks_q <= clocks_q + 14'd1;
    end
  end

endmodule

`default_nettype wire
