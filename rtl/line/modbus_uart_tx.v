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

  // What the bit on the line is: known a clock after it began, long before it ends
  reg  data_bits_q = 1'b0;         // a data bit follows
  reg  parity_next_q = 1'b0;       // the parity bit follows
  reg  last_q = 1'b0;              // nothing follows

  wire step   = busy_q & bit_stb_i;
  wire ends   = step & last_q;
  wire take   = valid_i & ready_o;
  wire serial = check_q ? check_bit_i : data_q[0];

  assign ready_o   = ~busy_q | ends;
  assign bit_stb_o = step & data_bits_q;
  assign bit_o     = serial;
  assign feed_o    = ~check_q;
  assign restart_o = valid_i & ~busy_q;
  assign txd_o     = txd_q;

  always @(posedge clk_i) begin
    data_bits_q   <= (index_q < BIT_DATA_LAST);
    parity_next_q <= (index_q == BIT_DATA_LAST) & has_parity;
    last_q        <= (index_q == index_last);
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
      end else if (parity_next_q) begin
        txd_q <= parity_q;
      end
      if (ends) busy_q <= 1'b0;
    end
    if (rst_i) begin
      busy_q  <= 1'b0;
      txd_q   <= 1'b1;
    end
  end

`ifdef FORMAL
  reg       f_past = 1'b0;
  reg [7:0] f_data = 8'd0;           // the character as it was handed over
  reg       f_check = 1'b0;
  integer   f_i;
  reg       f_parity;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (take) begin
      f_data  <= data_i;
      f_check <= check_i;
    end
  end

  always @* begin
    f_parity = is_odd;
    for (f_i = 0; f_i < 8; f_i = f_i + 1) if (f_i < index_q) f_parity = f_parity ^ f_data[f_i];
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past && $past(busy_q | take)) assume ($stable(format_i));
  // A bit lasts three clocks or more, also the first.
  always @(posedge clk_i) if (f_past) assume (!bit_stb_i || !($past(bit_stb_i) || $past(take) || f_young));
  reg f_young = 1'b0;
  always @(posedge clk_i) f_young <= bit_stb_i | take;

  always @(posedge clk_i) if (f_past) begin
    assert (check_q == f_check || !busy_q);
    if (!busy_q) assert (txd_o);                                     // rests at 1
    if (busy_q) begin
      assert (index_q <= index_last);
      if (index_q == 4'd0) assert (!txd_o);                          // start bit
      if (!f_check && index_q < 4'd9) begin
        assert (data_q == (f_data >> index_q));
        assert (parity_q == f_parity);
        if (index_q != 4'd0) assert (txd_o == f_data[index_q - 4'd1]);
      end
      if (!f_check && index_q == 4'd9 && has_parity) assert (txd_o == (^f_data ^ is_odd));
      if (index_q > 4'd9 || (index_q == 4'd9 && !has_parity)) assert (txd_o);   // stop bits
    end
    if (!$past(rst_i) && $past(take)) assert (busy_q && index_q == 4'd0);
    // Back to back: the stop bit of one is followed by the start bit of the next.
    cover (busy_q && index_q == 4'd0 && $past(busy_q) && f_data == 8'hA5);
  end
`endif

endmodule

`default_nettype wire
