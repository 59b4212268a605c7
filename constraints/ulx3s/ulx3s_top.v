// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// ulx3s_top - the demonstration of modbus_board on an ULX3S (ECP5 85k, 25 MHz).

`default_nettype none

module ulx3s_top #(
  parameter integer CLK_HZ = 25000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [7:0] led_o,                   // coils 0 to 6; 7: a master talks to us
  input  wire [5:0] button_i,                // FIRE1, FIRE2, UP, DOWN, LEFT, RIGHT: discrete inputs 0 to 5
  input  wire       button_n_i,              // PWR: discrete input 6
  output wire       wifi_gpio0_o             // 1: the ESP32 starts its own program and leaves the FPGA alone
);

  wire txd;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(7), .BUTTONS(7)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(led_o[6:0]), .buttons_i({~button_n_i, button_i}), .alive_o(led_o[7])
  );

  assign usb_txd_o    = txd;
  assign rs485_txd_o  = txd;
  assign wifi_gpio0_o = 1'b1;

endmodule

`default_nettype wire
