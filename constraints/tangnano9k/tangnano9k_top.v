// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// tangnano9k_top - the demonstration of modbus_board on a Tang Nano 9K (Gowin GW1NR-9C, 27 MHz).

`default_nettype none

module tangnano9k_top #(
  parameter integer CLK_HZ = 27000000,
  parameter integer BAUD   = 19200
) (
  input  wire       clk_i,
  input  wire       usb_rxd_i,
  output wire       usb_txd_o,
  input  wire       rs485_rxd_i,
  output wire       rs485_txd_o,
  output wire       rs485_de_o,
  output wire [5:0] led_n_o,                 // coils 0 to 4; 5: a master talks to us
  input  wire [1:0] button_n_i               // S1, S2: discrete inputs 0 and 1
);

  wire [4:0] leds;
  wire       txd, alive;

  modbus_board #(.CLK_HZ(CLK_HZ), .BAUD(BAUD), .LEDS(5), .BUTTONS(2)) u_board (
    .clk_i(clk_i), .usb_rxd_i(usb_rxd_i), .rs485_rxd_i(rs485_rxd_i), .txd_o(txd), .de_o(rs485_de_o),
    .leds_o(leds), .buttons_i(~button_n_i), .alive_o(alive)
  );

  assign usb_txd_o   = txd;
  assign rs485_txd_o = txd;
  assign led_n_o     = ~{alive, leds};

endmodule

`default_nettype wire
