// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_frame_ram - the one buffer that holds a request and then its answer, with its cursor and its count.
//
// 256 bytes, inferred as block RAM.  byte_o is always the byte under the cursor (the read address is the
// cursor's next value).  The four users take turns: receiver, dispatch, data access,
// transmitter.  An answer is written over its request: address and function code already stand where they belong,
// and the answers of the write functions are the head of the request itself.
//
// count_o: characters received so far, then request bytes not yet consumed, then bytes of the answer.

`default_nettype none

module modbus_frame_ram (
  input  wire       clk_i,

  input  wire       point_i,      // strobe: cursor to point_at_i
  input  wire [3:0] point_at_i,
  input  wire       step_i,       // strobe: cursor + 1
  input  wire       clear_i,      // strobe: count to 0
  input  wire       up_i,         // strobe: count + 1
  input  wire       down_i,       // strobe: count - 1

  input  wire       write_i,      // strobe: data_i to the byte under the cursor
  input  wire [7:0] data_i,
  output wire [7:0] byte_o,       // level : byte under the cursor
  output wire [3:0] cursor_o,     // level : low four bits
  output wire [8:0] count_o
);

  (* no_rw_check *) reg [7:0] memory [0:255];   // no byte is read in the clock that writes it
  reg [7:0] byte_q;
  reg [7:0] cursor_q = 8'd0;
  reg [8:0] count_q = 9'd0;

  wire [7:0] cursor_d = point_i ? {4'd0, point_at_i} : cursor_q + {7'd0, step_i};

  always @(posedge clk_i) begin
    if (write_i) memory[cursor_q] <= data_i;
    byte_q   <= memory[cursor_d];
    cursor_q <= cursor_d;
    if (clear_i) count_q <= 9'd0;
    else         count_q <= count_q + {{8{down_i}}, down_i | up_i};
  end

  assign byte_o   = byte_q;
  assign cursor_o = cursor_q[3:0];
  assign count_o  = count_q;

endmodule

`default_nettype wire
