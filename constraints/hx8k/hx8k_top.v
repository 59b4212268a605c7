// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// hx8k_top - the demonstration of modbus_board on the iCE40-HX8K breakout board (12 MHz).
//
// The board has no buttons: two pins of header J3 with pull-ups, pressed while wired to ground.

`default_nettype none

module hx8k_top #(
  parameter integer CLK_HZ = 12000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [7:0] led_o,                   // coils 0 to 6; 7: a master talks to us
  input  wire [1:0] button_n_i               // discrete inputs 0 and 1
);

  wire txd;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(7), .BUTTONS(2)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(led_o[6:0]), .buttons_i(~button_n_i), .alive_o(led_o[7])
  );

  assign usb_txd_o   = txd;
  assign rs485_txd_o = txd;

endmodule

`default_nettype wire
