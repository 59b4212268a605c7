// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_sync - the only door for an asynchronous input.
//
// Two flip-flops, two clocks of latency, idle level 1 from power-up.  Constrain the path into
// meta_q as asynchronous; nothing else in the core looks at the pin.

`default_nettype none

module modbus_sync (
  input  wire clk_i,
  input  wire async_i,       // any time
  output wire sync_o         // level, two clocks late
);

  (* ASYNC_REG = "TRUE" *) reg meta_q = 1'b1;
  (* ASYNC_REG = "TRUE" *) reg sync_q = 1'b1;

  always @(posedge clk_i) begin
    meta_q <= async_i;
    sync_q <= meta_q;
  end

  assign sync_o = sync_q;

endmodule

`default_nettype wire
