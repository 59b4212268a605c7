// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// icebreaker_top - the demonstration of modbus_board on an iCEBreaker (iCE40 UP5K, 12 MHz).

`default_nettype none

module icebreaker_top #(
  parameter integer CLK_HZ = 12000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [4:0] led_o,                   // LED1 to LED5 of the snap-off board: coils 0 to 4
  output wire       led_red_n_o,             // coil 5
  output wire       led_green_n_o,           // a master talks to us
  input  wire [2:0] button_i,                // BTN1 to BTN3 of the snap-off board: discrete inputs 1 to 3
  input  wire       button_n_i               // BTN_N, on the board itself: discrete input 0
);

  wire [5:0] leds;
  wire       txd, alive;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(6), .BUTTONS(4)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(leds), .buttons_i({button_i, ~button_n_i}), .alive_o(alive)
  );

  assign usb_txd_o     = txd;
  assign rs485_txd_o   = txd;
  assign led_o         = leds[4:0];
  assign led_red_n_o   = ~leds[5];
  assign led_green_n_o = ~alive;

endmodule

`default_nettype wire
