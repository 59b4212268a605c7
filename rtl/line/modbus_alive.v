// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_alive - tells whether a master talks to us: for outputs that must fall to a safe state when it does not.
//
// alive_o rises with a good frame for us (broadcast included) and falls TIMEOUT_MS after the last one, up to
// 1 ms earlier (a millisecond is rounded up to whole clocks).  The request need not succeed: one that is answered with
// an exception, or not at all in listen-only mode, counts too.  With TIMEOUT_MS = 0 alive_o stays high from the first
// frame on and the timer costs nothing.

`default_nettype none

module modbus_alive #(
  parameter integer CLK_HZ     = 50000000,
  parameter integer TIMEOUT_MS = 0            // milliseconds, 0..16777215
) (
  input  wire clk_i,
  input  wire rst_i,
  input  wire frame_stb_i,            // strobe: a good frame for us
  output wire alive_o
);

  generate
    if (CLK_HZ < 1000 || TIMEOUT_MS < 0 || TIMEOUT_MS > 16777215) begin : gen_illegal
      ERROR_modbus_alive_CLK_HZ_from_1000_and_TIMEOUT_MS_below_2_to_24 illegal_parameter ();
    end
  endgenerate

  reg  alive_q = 1'b0;
  wire expired;

  always @(posedge clk_i) begin
    if (expired)     alive_q <= 1'b0;
    if (frame_stb_i) alive_q <= 1'b1;
    if (rst_i)       alive_q <= 1'b0;
  end

  assign alive_o = alive_q;

  generate
    if (TIMEOUT_MS == 0) begin : gen_for_ever
      assign expired = 1'b0;
    end else begin : gen_timer
      localparam MS_CLOCKS = (CLK_HZ + 999) / 1000;
      localparam CW = $clog2(MS_CLOCKS + 1), MW = $clog2(TIMEOUT_MS + 1);
      reg [CW-1:0] clocks_q = {CW{1'b0}};
      reg [MW-1:0] left_q = {MW{1'b0}};
      wire ms = (clocks_q == MS_CLOCKS[CW-1:0] - 1'b1);
      assign expired = ms & (left_q == {{MW-1{1'b0}}, 1'b1});
      always @(posedge clk_i) begin
        clocks_q <= ms ? {CW{1'b0}} : clocks_q + 1'b1;
        if (frame_stb_i)              left_q <= TIMEOUT_MS[MW-1:0];
        else if (ms && left_q != {MW{1'b0}}) left_q <= left_q - 1'b1;
      end
    end
  endgenerate

endmodule

`default_nettype wire
