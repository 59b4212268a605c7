// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_uart_tx - one character out: 8E1, 8O1, 8N2 or 8N1, back to back for as long as valid_i stays high.
//
// A character is taken in the clock in which valid_i and ready_o are high; its start bit begins in the
// next.  ready_o is high while idle and in the very last clock of a stop bit, so a waiting character follows
// without an idle bit (MODBUS over Serial Line V1.02 allows 1.5 characters; there are none).
// With check_i the eight bits come from check_bit_i instead of data_i: the CRC unit sends itself.

`default_nettype none
`include "modbus_defs.vh"

module modbus_uart_tx (
  input  wire       clk_i,
  input  wire       rst_i,
  input  wire [1:0] format_i,

  // Bit clock
  output wire       restart_o,    // strobe: the next clock is the first of a start bit after idle
  input  wire       bit_stb_i,

  // Characters
  input  wire       valid_i,
  input  wire [7:0] data_i,
  input  wire       check_i,      // level : with valid_i, send check bits
  output wire       ready_o,

  // CRC unit
  output wire       bit_stb_o,    // strobe: a data or check bit begins
  output wire       bit_o,        // level : its value
  output wire       feed_o,       // level : 1 data, 0 check bits
  input  wire       check_bit_i,

  // Line
  output wire       txd_o
);

  localparam [3:0] BIT_DATA_LAST = 4'd8;

  wire       has_parity = ~format_i[1];
  wire       is_odd     =  format_i[0];
  wire [3:0] index_last = (format_i == `MB_FORMAT_8N1) ? 4'd9 : 4'd10;

  reg       busy_q = 1'b0, check_q = 1'b0, parity_q = 1'b0;
  reg       txd_q = 1'b1;
  reg [3:0] index_q = 4'd0;        // bit now on the line: 0 start, 1..8 data, parity or stop, stop
  reg [7:0] data_q = 8'h00;

  wire step   = busy_q & bit_stb_i;
  wire ends   = step & (index_q == index_last);
  wire take   = valid_i & ready_o;
  wire serial = check_q ? check_bit_i : data_q[0];

  assign ready_o   = ~busy_q | ends;
  assign bit_stb_o = step & (index_q < BIT_DATA_LAST);
  assign bit_o     = serial;
  assign feed_o    = ~check_q;
  assign restart_o = valid_i & ~busy_q;
  assign txd_o     = txd_q;

  always @(posedge clk_i) begin
    if (take) begin
      busy_q   <= 1'b1;
      index_q  <= 4'd0;
      data_q   <= data_i;
      check_q  <= check_i;
      parity_q <= is_odd;
      txd_q    <= 1'b0;
    end else if (step) begin
      index_q <= index_q + 4'd1;
      txd_q   <= 1'b1;
      if (bit_stb_o) begin
        data_q   <= {1'b0, data_q[7:1]};
        parity_q <= parity_q ^ serial;
        txd_q    <= serial;
      end else if (index_q == BIT_DATA_LAST && has_parity) begin
        txd_q <= parity_q;
      end
      if (ends) busy_q <= 1'b0;
    end
    if (rst_i) begin
      busy_q  <= 1'b0;
      txd_q   <= 1'b1;
    end
  end

endmodule

`default_nettype wire
