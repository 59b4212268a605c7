# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a board's LEDs and buttons stand for, as its README says."""

# top -> (LEDs by coil, the alive LED, buttons by discrete input), each (port, bit or None, active level)
PINS = {
    "icebreaker_top": (
        [*(("led_o", i, 1) for i in range(5)), ("led_red_n_o", None, 0)],
        ("led_green_n_o", None, 0),
        [("button_n_i", None, 0), *(("button_i", i, 1) for i in range(3))],
    ),
    "hx8k_top": ([("led_o", i, 1) for i in range(7)], ("led_o", 7, 1), [("button_n_i", i, 0) for i in range(2)]),
    "ulx3s_top": (
        [("led_o", i, 1) for i in range(7)],
        ("led_o", 7, 1),
        [*(("button_i", i, 1) for i in range(6)), ("button_n_i", None, 0)],
    ),
    "tangnano9k_top": (
        [("led_n_o", i, 0) for i in range(5)],
        ("led_n_o", 5, 0),
        [("button_n_i", i, 0) for i in range(2)],
    ),
    "arty_a7_top": (
        [("led_o", i, 1) for i in range(4)],
        ("led_alive_o", None, 1),
        [("button_i", i, 1) for i in range(4)],
    ),
    "de10_lite_top": ([("led_o", i, 1) for i in range(9)], ("led_o", 9, 1), [("button_n_i", i, 0) for i in range(2)]),
}
