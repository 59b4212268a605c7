// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// uart_bench - receiver and transmitter with synchroniser and CRC unit, as in modbus_line.

`default_nettype none

module uart_bench (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        seven_i,
  input  wire        enable_i,
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        idle_o,
  output wire        receiving_o,
  output wire        start_stb_o,
  output wire        char_stb_o,
  output wire [7:0]  data_o,
  output wire        parity_error_o,
  output wire        framing_error_o,
  input  wire        clear_i,    // strobe: CRC to its start value
  input  wire        valid_i,
  input  wire [7:0]  data_i,
  input  wire        check_i,
  output wire        ready_o,
  output wire        sending_o,
  output wire        begin_stb_o,
  output wire        bit_stb_o,
  output wire        bit_o
);

  wire rxd, feed, check_bit;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd));

  modbus_uart u_uart (
    .clk_i(clk_i), .rst_i(rst_i), .bit_time_i(bit_time_i), .fraction_i(4'd0), .format_i(format_i), .seven_i(seven_i),
    .enable_i(enable_i), .rxd_i(rxd), .txd_o(txd_o), .idle_o(idle_o),
    .receiving_o(receiving_o), .start_stb_o(start_stb_o), .char_stb_o(char_stb_o), .data_o(data_o),
    .parity_error_o(parity_error_o), .framing_error_o(framing_error_o),
    .valid_i(valid_i), .data_i(data_i), .check_i(check_i), .ready_o(ready_o), .sending_o(sending_o),
    .begin_stb_o(begin_stb_o), .bit_stb_o(bit_stb_o), .bit_o(bit_o), .feed_o(feed), .check_bit_i(check_bit)
  );

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(clear_i), .shift_i(bit_stb_o), .feed_i(feed), .data_i(bit_o),
    .bit_o(check_bit), .zero_o()
  );

endmodule

`default_nettype wire
