# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# Arty A7-35T or -100T.  Pins as in Arty-A7-35-Master.xdc of Digilent.
create_clock -name clk -period 10.000 [get_ports clk_i]

set_property -dict {PACKAGE_PIN E3 IOSTANDARD LVCMOS33} [get_ports {clk_i}]

# USB serial: the FT2232HQ
set_property -dict {PACKAGE_PIN A9 IOSTANDARD LVCMOS33 PULLUP TRUE} [get_ports {usb_rxd_i}]
set_property -dict {PACKAGE_PIN D10 IOSTANDARD LVCMOS33} [get_ports {usb_txd_o}]

# RS-485 transceiver on Pmod JA, pins 1 2 3
set_property -dict {PACKAGE_PIN G13 IOSTANDARD LVCMOS33 PULLUP TRUE} [get_ports {rs485_rxd_i}]
set_property -dict {PACKAGE_PIN B11 IOSTANDARD LVCMOS33} [get_ports {rs485_txd_o}]
set_property -dict {PACKAGE_PIN A11 IOSTANDARD LVCMOS33 PULLDOWN TRUE} [get_ports {rs485_de_o}]

set_property -dict {PACKAGE_PIN H5 IOSTANDARD LVCMOS33} [get_ports {led_o[0]}]
set_property -dict {PACKAGE_PIN J5 IOSTANDARD LVCMOS33} [get_ports {led_o[1]}]
set_property -dict {PACKAGE_PIN T9 IOSTANDARD LVCMOS33} [get_ports {led_o[2]}]
set_property -dict {PACKAGE_PIN T10 IOSTANDARD LVCMOS33} [get_ports {led_o[3]}]
set_property -dict {PACKAGE_PIN F6 IOSTANDARD LVCMOS33} [get_ports {led_alive_o}]

set_property -dict {PACKAGE_PIN D9 IOSTANDARD LVCMOS33} [get_ports {button_i[0]}]
set_property -dict {PACKAGE_PIN C9 IOSTANDARD LVCMOS33} [get_ports {button_i[1]}]
set_property -dict {PACKAGE_PIN B9 IOSTANDARD LVCMOS33} [get_ports {button_i[2]}]
set_property -dict {PACKAGE_PIN B8 IOSTANDARD LVCMOS33} [get_ports {button_i[3]}]

# What has no clock has no timing: the serial line and the buttons end in synchronisers.
set_false_path -from [get_ports {usb_rxd_i rs485_rxd_i button_i[*]}]
set_false_path -to [get_ports {usb_txd_o rs485_txd_o rs485_de_o led_o[*] led_alive_o}]

# The configuration bank of the board
set_property CFGBVS VCCO [current_design]
set_property CONFIG_VOLTAGE 3.3 [current_design]
