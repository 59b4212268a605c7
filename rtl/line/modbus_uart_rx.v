// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_uart_rx - one character from the line: 8E1, 8O1, 8N2 or 8N1.
//
// Each bit is looked at 1/4, 1/2 and 3/4 through; two equal looks decide it.  The first two mostly agree, so
// the stop bit is judged at its middle and the next start bit may come early (a fast sender).
// The looks are centred on the clock in which the edge may have fallen.  A spike shorter than 1/4 bit spoils at most one look.  A start bit that is high again
// after 1/4 bit, or by majority, was a spike: nothing is reported.
//
// After a framing error (first stop bit low) or a break the line must go high before the next start bit
// counts.  The second stop bit is not checked (an 8N1 sender is understood by an 8N2 receiver).
//
// Handshake: start_stb_o one clock after a start bit is confirmed; bit_stb_o one clock after each data
// bit; char_stb_o one clock after the stop bit is decided, errors and data_o valid with it.
// busy_o is high from the confirmed start bit to the decided stop bit, and through a break.

`default_nettype none
`include "modbus_defs.vh"

module modbus_uart_rx (
  input  wire       clk_i,
  input  wire       rst_i,

  // Line
  input  wire       enable_i,        // level : 0 makes the receiver deaf
  input  wire [1:0] format_i,
  input  wire       rxd_i,           // level : synchronised

  // Bit clock
  output wire       restart_o,       // strobe: a start bit may have begun
  input  wire       quarter_stb_i,
  input  wire [1:0] quarter_i,

  // Characters
  output wire       start_stb_o,     // strobe: a start bit was confirmed
  output wire       bit_stb_o,       // strobe: a data bit, for the CRC
  output wire       bit_o,
  output wire       char_stb_o,      // strobe: a character is complete
  output wire [7:0] data_o,
  output wire       parity_error_o,  // level : with char_stb_o
  output wire       framing_error_o, // level : with char_stb_o
  output wire       busy_o           // level : a character is on the line
);

  localparam [1:0] ST_IDLE = 2'd0, ST_START = 2'd1, ST_BITS = 2'd2, ST_BREAK = 2'd3;
  localparam [3:0] BIT_PARITY = 4'd9;

  wire has_parity = ~format_i[1];
  wire is_odd     =  format_i[0];
  wire [3:0] bit_stop = has_parity ? BIT_PARITY + 4'd1 : BIT_PARITY;

  reg [1:0] state_q = ST_IDLE, state_d;
  reg [3:0] index_q = 4'd0;          // 0 start, 1..8 data, then parity, stop
  reg       line_q = 1'b1;           // the line one clock ago: an edge is seen half a clock late on average
  reg       first_q = 1'b1;          // the look at 1/4
  reg       decided_q = 1'b0;
  reg [7:0] data_q = 8'h00;
  reg       parity_q = 1'b0;
  reg       start_stb_q = 1'b0, bit_stb_q = 1'b0, char_stb_q = 1'b0;
  reg       framing_error_q = 1'b0, parity_error_q = 1'b0;

  // Which quarter and which bit it is, known a clock after they began
  reg  second_q = 1'b0, third_q = 1'b0;              // this quarter ends with the look that may decide, or must
  reg  is_stop_q = 1'b0, is_parity_q = 1'b0;

  // Whichever look completes the majority has the majority's value.
  wire decide   = quarter_stb_i & (third_q | (second_q & line_q == first_q));
  wire confirm  = (state_q == ST_START) & decide & ~line_q;
  wire take_bit = (state_q == ST_BITS) & decide;
  wire finish   = take_bit & is_stop_q;
  // The start bit behind a fast sender's stop bit may fall in the very clock in which that is decided.
  wire begin_char = ((state_q == ST_IDLE) | (finish & line_q)) & enable_i & ~rxd_i;

  always @* begin
    state_d = state_q;
    case (state_q)
      // The line rests at 1.
      ST_IDLE: if (begin_char) state_d = ST_START;
      // It has fallen: a start bit, or a spike.
      ST_START: begin
        if (confirm) state_d = ST_BITS;
        else if (decide || (quarter_stb_i && quarter_i == 2'd0 && rxd_i)) state_d = ST_IDLE;
      end
      // Data, parity and stop bits pass.
      ST_BITS: if (finish) state_d = begin_char ? ST_START : line_q ? ST_IDLE : ST_BREAK;
      // The stop bit was 0: wait for the line to rest.
      ST_BREAK: if (rxd_i) state_d = ST_IDLE;
    endcase
    if (!enable_i) state_d = ST_IDLE;
  end

  always @(posedge clk_i) begin
    second_q    <= ~decided_q & (quarter_i == 2'd1);
    third_q     <= ~decided_q & (quarter_i == 2'd2);
    is_stop_q   <= (index_q == bit_stop);
    is_parity_q <= has_parity & (index_q == BIT_PARITY);

    line_q      <= rxd_i;
    start_stb_q <= confirm & enable_i;
    bit_stb_q   <= take_bit & ~is_stop_q & ~is_parity_q;
    char_stb_q  <= finish & enable_i;
    if (finish) begin
      framing_error_q <= ~line_q;
      parity_error_q  <= has_parity & parity_q;
    end

    if (quarter_stb_i) begin
      if (quarter_i == 2'd0) first_q <= line_q;
      decided_q <= (decided_q | decide) & (quarter_i != 2'd3);
      if (quarter_i == 2'd3) index_q <= index_q + 4'd1;
    end
    if (take_bit && !is_stop_q) begin
      parity_q <= parity_q ^ line_q;
      if (!is_parity_q) data_q <= {line_q, data_q[7:1]};
    end
    if (begin_char) begin
      index_q   <= 4'd0;
      decided_q <= 1'b0;
      parity_q  <= is_odd;
    end

    state_q <= state_d;
    if (rst_i) begin
      state_q     <= ST_IDLE;
      start_stb_q <= 1'b0;
      char_stb_q  <= 1'b0;
    end
  end

  assign restart_o       = begin_char;
  assign start_stb_o     = start_stb_q;
  assign bit_stb_o       = bit_stb_q;
  assign bit_o           = data_q[7];
  assign char_stb_o      = char_stb_q;
  assign data_o          = data_q;
  assign parity_error_o  = parity_error_q;
  assign framing_error_o = framing_error_q;
  assign busy_o          = state_q[1];

`ifdef FORMAL
  reg       f_past = 1'b0;
  reg [3:0] f_bits = 4'd0;           // data bits since the start bit
  reg       f_parity = 1'b0;         // over them

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (start_stb_o)    {f_bits, f_parity} <= {4'd0, is_odd};
    else if (bit_stb_o) {f_bits, f_parity} <= {f_bits + 4'd1, f_parity ^ bit_o};
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) begin
    assume ($stable(format_i) || state_q == ST_IDLE);
    // The bit clock counts quarters and begins anew where we ask for it.
    if ($past(restart_o))          assume (quarter_i == 2'd0 && !quarter_stb_i);
    else if ($past(quarter_stb_i)) assume (quarter_i == $past(quarter_i) + 2'd1);
    else                           assume ($stable(quarter_i));
    assume (!$past(quarter_stb_i) || !quarter_stb_i);
  end

  wire [3:0] f_index_bits = (index_q == 4'd0) ? 4'd0 : (index_q > 4'd9) ? 4'd8 : index_q - 4'd1;

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (state_q == ST_BITS) begin
      assert (index_q <= bit_stop);
      if (index_q == 4'd0) assert (decided_q);
      if (!start_stb_o && !bit_stb_o)
        assert (f_bits == f_index_bits + ((decided_q && index_q != 4'd0 && index_q < 4'd9) ? 4'd1 : 4'd0));
    end
    if (state_q == ST_START) assert (index_q == 4'd0 && !decided_q);
    if (char_stb_o) assert (f_bits == 4'd8);                         // never a shorter or longer one
    if (char_stb_o) assert (framing_error_o ? state_q == ST_BREAK || !busy_o : !busy_o || state_q == ST_BREAK);
    assert (!(start_stb_o && char_stb_o));
    if (!$past(enable_i)) assert (!busy_o && !start_stb_o && !char_stb_o);   // deaf
    cover (char_stb_o && data_o == 8'hA5 && !framing_error_o && !parity_error_o);
    cover (char_stb_o && framing_error_o);
    cover (state_q == ST_IDLE && $past(state_q) == ST_START);        // a spike
  end
`endif

endmodule

`default_nettype wire
