# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# DE10-Lite: the clock, and what has none.
create_clock -name clk -period 20.000 [get_ports clk_i]
derive_clock_uncertainty
set_false_path -from [get_ports {usb_rxd_i rs485_rxd_i button_n_i[*]}]
set_false_path -to [get_ports {usb_txd_o rs485_txd_o rs485_de_o led_o[*]}]
