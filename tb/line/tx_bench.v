// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// tx_bench - transmitter with its bit clock and the CRC unit, as in the core.

`default_nettype none

module tx_bench (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        clear_i,    // strobe: CRC to its start value
  input  wire        valid_i,
  input  wire [7:0]  data_i,
  input  wire        check_i,
  output wire        ready_o,
  output wire        txd_o
);

  wire restart, bit_stb, crc_stb, crc_bit, feed, check_bit;

  modbus_bit_clock u_bit_clock (
    .clk_i(clk_i), .bit_time_i(bit_time_i), .restart_i(rst_i | restart),
    .quarter_stb_o(), .quarter_o(), .bit_stb_o(bit_stb)
  );

  modbus_uart_tx u_uart_tx (
    .clk_i(clk_i), .rst_i(rst_i), .format_i(format_i), .restart_o(restart), .bit_stb_i(bit_stb),
    .valid_i(valid_i), .data_i(data_i), .check_i(check_i), .ready_o(ready_o),
    .bit_stb_o(crc_stb), .bit_o(crc_bit), .feed_o(feed), .check_bit_i(check_bit), .txd_o(txd_o)
  );

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(clear_i), .shift_i(crc_stb), .feed_i(feed), .data_i(crc_bit),
    .bit_o(check_bit), .zero_o()
  );

endmodule

`default_nettype wire
