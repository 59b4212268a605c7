// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_frame_ram - the one buffer that holds a request and then its answer, with its cursor and its count.
//
// 256 bytes, with HAS_UPPER 512, inferred as block RAM.  byte_o is always the byte under the cursor (the read address
// is the cursor's next value), or with peek_i the byte at peek_at_i.  Its users take turns: receiver, sequencer, burst,
// user, transmitter.  An answer is written over its request: address and function code already stand where they belong,
// and the answers of the write functions are the head of the request itself.  Where that cannot be (an answer longer
// than what it is made from) it has the upper half.
//
// count_o: characters received so far, then request bytes not yet consumed, then bytes of the answer.
// With HAS_CONTEXT a second pair of cursor and count is kept, to return to or to swap with.

`default_nettype none

module modbus_frame_ram #(
  parameter integer HAS_UPPER   = 1,
  parameter integer HAS_CONTEXT = 1
) (
  input  wire       clk_i,

  input  wire       point_i,      // strobe: cursor to point_at_i
  input  wire [4:0] point_at_i,   // {upper half, place}
  input  wire       step_i,       // strobe: cursor + 1
  input  wire       clear_i,      // strobe: count to 0
  input  wire       up_i,         // strobe: count + 1
  input  wire       down_i,       // strobe: count - 1
  input  wire       keep_i,       // strobe: cursor and count are kept
  input  wire       recall_i,     // strobe: back to those kept; with keep_i: swapped
  input  wire       peek_i,       // level : byte_o is the byte at peek_at_i of the lower half
  input  wire [7:0] peek_at_i,

  input  wire       write_i,      // strobe: data_i to the byte under the cursor
  input  wire [7:0] data_i,
  output wire [7:0] byte_o,       // level : byte under the cursor
  output wire [3:0] cursor_o,     // level : low four bits
  output wire [8:0] count_o,
  output wire [8:0] kept_count_o
);

  localparam integer W = (HAS_UPPER != 0) ? 9 : 8;

  (* no_rw_check *) reg [7:0] memory [0:(1<<W)-1];   // no byte is read in the clock that writes it
  reg [7:0] byte_q;
  reg [8:0] cursor_q = 9'd0;
  reg [8:0] count_q = 9'd0;

  // A request may end before the byte that a step takes next: that byte is no X in a simulation.
  integer i;
  initial for (i = 0; i < (1 << W); i = i + 1) memory[i] = 8'd0;

  wire [8:0] kept_cursor, kept_count;
  wire       recall = (HAS_CONTEXT != 0) & recall_i;
  wire       upper  = (HAS_UPPER != 0) & point_at_i[4];
  // The sum means nothing while a place is pointed at; written so, a counter that can be loaded takes one cell a bit.
  wire [8:0] next   = cursor_q + {{8{point_i}}, 1'b1};
  wire [8:0] moved  = point_i ? {upper, 4'd0, point_at_i[3:0]} : step_i ? next : cursor_q;
  wire [8:0] cursor_d = recall ? kept_cursor : moved;
  wire [8:0] read_at  = peek_i ? {1'b0, peek_at_i} : cursor_d;

  always @(posedge clk_i) begin
    if (write_i) memory[cursor_q[W-1:0]] <= data_i;
    byte_q   <= memory[read_at[W-1:0]];
    cursor_q <= {(HAS_UPPER != 0) & cursor_d[8], cursor_d[7:0]};
    if (clear_i)     count_q <= 9'd0;
    else if (recall) count_q <= kept_count;
    else             count_q <= count_q + {{8{down_i}}, down_i | up_i};
  end

  generate
    if (HAS_CONTEXT != 0) begin : gen_context
      reg [8:0] kept_cursor_q, kept_count_q;
      always @(posedge clk_i)
        if (keep_i) begin
          kept_cursor_q <= cursor_q;
          kept_count_q  <= count_q;
        end
      assign kept_cursor = kept_cursor_q;
      assign kept_count  = kept_count_q;
    end else begin : gen_no_context
      wire unused = keep_i;
      assign kept_cursor = 9'd0;
      assign kept_count  = 9'd0;
    end
  endgenerate

  generate
    if (HAS_UPPER == 0) begin : gen_one_half
      wire unused = read_at[8];
    end
  endgenerate

  assign byte_o       = byte_q;
  assign cursor_o     = cursor_q[3:0];
  assign count_o      = count_q;
  assign kept_count_o = kept_count;

endmodule

`default_nettype wire
