// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_wait - counts bit times up to a limit: response delay, driver lead and tail, bank stall in turn.

`default_nettype none

module modbus_wait (
  input  wire        clk_i,
  input  wire        bit_stb_i,      // strobe: a bit ends; not in two clocks in a row
  input  wire        clear_i,        // level : begin again at 0
  input  wire [15:0] limit_i,        // bit times
  output wire        over_o          // level : the limit is reached, a clock later; with limit 0 a clock behind clear_i
);

  reg [15:0] bits_q = 16'd0;
  reg        over_q = 1'b0;                  // in a register: the comparison is long
  // Counting up from 0, the first number with all the bits of the limit is the limit itself.  A limit tied to 0
  // leaves nothing of the counter.
  wire       over   = &(bits_q | ~limit_i);

  always @(posedge clk_i) begin
    over_q <= over & ~clear_i;
    if (clear_i)                 bits_q <= 16'd0;
    else if (bit_stb_i && !over_q) bits_q <= bits_q + 16'd1;
  end

  assign over_o = over_q;

endmodule

`default_nettype wire
