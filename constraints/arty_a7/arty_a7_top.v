// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// arty_a7_top - the demonstration of modbus_board on an Arty A7 (Artix-7, 100 MHz).

`default_nettype none

module arty_a7_top #(
  parameter integer CLK_HZ = 100000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [3:0] led_o,                   // LD4 to LD7: coils 0 to 3
  output wire       led_alive_o,             // green of LD0: a master talks to us
  input  wire [3:0] button_i                 // BTN0 to BTN3: discrete inputs 0 to 3
);

  wire txd;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(4), .BUTTONS(4)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(led_o), .buttons_i(button_i), .alive_o(led_alive_o)
  );

  assign usb_txd_o   = txd;
  assign rs485_txd_o = txd;

endmodule

`default_nettype wire
