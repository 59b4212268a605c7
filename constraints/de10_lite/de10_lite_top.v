// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// de10_lite_top - the demonstration of modbus_board on a DE10-Lite (MAX 10, 50 MHz).
//
// The board has no USB serial: a second receiver, for a 3.3 V serial adapter, is beside the RS-485 pins.

`default_nettype none

module de10_lite_top #(
  parameter integer CLK_HZ = 50000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [9:0] led_o,                   // LEDR0 to LEDR8: coils 0 to 8; LEDR9: a master talks to us
  input  wire [1:0] button_n_i               // KEY0, KEY1: discrete inputs 0 and 1
);

  wire txd;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(9), .BUTTONS(2)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(led_o[8:0]), .buttons_i(~button_n_i), .alive_o(led_o[9])
  );

  assign usb_txd_o   = txd;
  assign rs485_txd_o = txd;

endmodule

`default_nettype wire
