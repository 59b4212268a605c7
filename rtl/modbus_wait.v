// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_wait - counts bit times up to a limit: response delay, driver lead and tail, bank stall in turn.

`default_nettype none

module modbus_wait (
  input  wire        clk_i,
  input  wire        bit_stb_i,
  input  wire        clear_i,        // level : begin again at 0
  input  wire [15:0] limit_i,        // bit times
  output wire        over_o          // level : the limit is reached; with limit 0 at once
);

  reg [15:0] bits_q = 16'd0;

  assign over_o = ~(bits_q < limit_i);      // a limit tied to 0 leaves nothing of the counter

  always @(posedge clk_i) begin
    if (clear_i)                   bits_q <= 16'd0;
    else if (bit_stb_i && !over_o) bits_q <= bits_q + 16'd1;
  end

endmodule

`default_nettype wire
