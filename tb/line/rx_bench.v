// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// rx_bench - receiver with its synchroniser and bit clock, as in the core.

`default_nettype none

module rx_bench (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        enable_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        rxd_i,
  output wire        start_stb_o,
  output wire        bit_stb_o,
  output wire        bit_o,
  output wire        char_stb_o,
  output wire [7:0]  data_o,
  output wire        parity_error_o,
  output wire        framing_error_o,
  output wire        busy_o
);

  wire       rxd, restart, quarter_stb;
  wire [1:0] quarter;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd));

  modbus_bit_clock u_bit_clock (
    .clk_i(clk_i), .bit_time_i(bit_time_i), .restart_i(rst_i | restart),
    .quarter_stb_o(quarter_stb), .quarter_o(quarter), .bit_stb_o()
  );

  modbus_uart_rx u_uart_rx (
    .clk_i(clk_i), .rst_i(rst_i), .enable_i(enable_i), .format_i(format_i), .rxd_i(rxd),
    .restart_o(restart), .quarter_stb_i(quarter_stb), .quarter_i(quarter),
    .start_stb_o(start_stb_o), .bit_stb_o(bit_stb_o), .bit_o(bit_o), .char_stb_o(char_stb_o), .data_o(data_o),
    .parity_error_o(parity_error_o), .framing_error_o(framing_error_o), .busy_o(busy_o)
  );

endmodule

`default_nettype wire
