# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The designs that are measured: three profiles, each with its banks, and the options of the largest."""

from __future__ import annotations

import re

FIXED_LINE = {  # 8E1, 115200 baud at 50 MHz, address 17, everything optional off
    "address_i": 17,
    "bit_time_i": 434,
    "format_i": 0,
    "broadcast_en_i": 1,
    "gap_count_only_i": 0,
    "strict_turnaround_i": 0,
    "drop_late_i": 0,
    "response_delay_i": 0,
    "stall_limit_i": 0,
    "de_lead_i": 0,
    "de_tail_i": 0,
    "ascii_i": 0,
    "eight_bits_i": 0,
    "ascii_extra_i": 0,
    "busy_i": 0,
    "write_lock_i": 0,
    "failure_i": 0,
    "exception_status_i": 0,
    "run_indicator_i": 1,
    "diagnostic_i": 0,
    "status_stb_i": 0,
    "status_adr_i": 0,
    "user_adr_i": 0,
    "user_put_i": 0,
    "user_dat_i": 0,
    "user_done_i": 0,
    "user_pass_i": 0,
    "user_exception_i": 0,
}
USER_OFF = {port: value for port, value in FIXED_LINE.items() if port.startswith("user_")}
# `basic` sets address, rate and format at run time; the options are tied as most boards tie them.
OPTIONS_OFF = {port: value for port, value in FIXED_LINE.items() if port not in ("address_i", "bit_time_i", "format_i")}
# Outputs that stay open with these banks: what a device of plain signals has no use for.
OPEN = re.compile(r"^(user|status)_\w+_o$|^(listen_only|write_file)_o$")
LEFT_OPEN = ("io",)

# What this core aims at: (profile, bank) -> logic cells and MHz on the HX8K, MHz on the ECP5.
AIMS = {
    ("minimal", "ram"): (550, 130, 140),
    ("minimal", "io"): (720, 125, 140),
    ("basic", "ram"): (610, 130, 140),
    ("full", "ram"): (1130, 112, 125),
}

# profile -> bank -> (parameters, ties).  The function codes of `basic` are 01-06 0F 10; `full` has all, with the
# tables of the live device where they are in RAM.
MINIMAL = {
    "MAX_BIT_TIME": str(FIXED_LINE["bit_time_i"]),
    "FUNCTION_CODES": "128'h00010048",
    "COIL_COUNT": "0",
    "DISCRETE_COUNT": "0",
    "INPUT_COUNT": "8",
    "HOLDING_COUNT": "8",
}
BASIC_CODES = "128'h0001807E"
PROFILES: dict[str, dict[str, tuple[dict[str, str], dict[str, int]]]] = {
    "minimal": {"io": (MINIMAL, FIXED_LINE), "ram": (MINIMAL, FIXED_LINE)},
    "basic": {
        "ram": (
            {
                "FUNCTION_CODES": BASIC_CODES,
                "COIL_COUNT": "64",
                "DISCRETE_COUNT": "64",
                "INPUT_COUNT": "64",
                "HOLDING_COUNT": "64",
            },
            OPTIONS_OFF,
        ),
        "io": ({"FUNCTION_CODES": BASIC_CODES}, OPTIONS_OFF),
    },
    "full": {
        "ram": (
            {
                "COIL_COUNT": "1024",
                "DISCRETE_COUNT": "2048",
                "INPUT_COUNT": "1024",
                "HOLDING_COUNT": "2048",
                "FILE_COUNT": "4",
                "FILE_RECORDS": "256",
            },
            USER_OFF,
        ),
        "io": ({}, USER_OFF),
    },
}
PROFILE_NOTES = {
    "minimal": "03 06 10, 8 holding + 8 input registers; address, rate and format tied",
    "basic": "01-06 0F 10; address, rate and format set at run time",
    "full": "every function code, counters, event log, identity; options set at run time",
}
# Where every cell goes is shown of these.
SHOWN = (("full", "ram"), ("basic", "ram"), ("minimal", "io"))

# What an option costs: `full` with the RAM bank without it.  Option -> (function codes that go, other parameters)
# An option of the I/O bank is against `full` with that.
OPTIONS: dict[str, tuple[tuple[int, ...], dict[str, str]]] = {
    "07: exception status": ((0x07,), {}),
    "08: diagnostics": ((0x08,), {}),
    "08 0B 0C: diagnostics, counters, event log, listen-only": ((0x08, 0x0B, 0x0C), {}),
    "11: server id": ((0x11,), {}),
    "2B: device identification": ((0x2B,), {}),
    "11 2B: identity": ((0x11, 0x2B), {}),
    "14 15: file records and their RAM": ((0x14, 0x15), {"FILE_COUNT": "0"}),
    "16: mask write": ((0x16,), {}),
    "17: read/write multiple": ((0x17,), {}),
    "18: FIFO": ((0x18,), {}),
}
USER_OPTION = "user functions 65 to 72"
# What `full` does not have: option -> parameters that add it
ADDED: dict[str, dict[str, str]] = {
    USER_OPTION: {"USER_CODES": "128'h000000000000000001FE0000000000000000"},
    "`ASCII_MODE` = 1": {"ASCII_MODE": "1"},
    "`BIT_FRACTIONS` = 1": {"BIT_FRACTIONS": "1"},
    "`GLITCH_FILTER` = 6": {"GLITCH_FILTER": "6"},
    "`UNIT_SET` with two further addresses": {"UNIT_SET": "248'hC0000"},
    "`BITS_PER_BEAT` = 16": {"BITS_PER_BEAT": "16"},
    "`CHECK_WRITES` = 1": {"CHECK_WRITES": "1"},
    "I/O bank: holding registers read back from a RAM": {"READ_BACK_RAM": "1"},
}
BASES = {"": "ram", "I/O bank": "io"}  # what options are compared with: `full` with this bank
ALL_CODES = 0x0000080001F399FE


def base_of(option: str) -> str:
    """The name in BASES of what an option is compared with."""
    return next(name for name in sorted(BASES, reverse=True) if option.startswith(name))


def option_designs() -> dict[str, tuple[str, dict[str, str], dict[str, int]]]:
    """{option: (bank, parameters, ties)} of `full` without it, of ADDED with it; BASES are `full` itself."""
    designs = {name: (bank, *PROFILES["full"][bank]) for name, bank in BASES.items()}
    bank, parameters, ties = designs[""]
    for option, (codes, others) in OPTIONS.items():
        mask = ALL_CODES & ~sum(1 << code for code in codes)
        designs[option] = (bank, {**parameters, "FUNCTION_CODES": f"128'h{mask:X}", **others}, ties)
    without_user = {port: value for port, value in ties.items() if port not in USER_OFF}
    for option, others in ADDED.items():
        bank, parameters, ties = designs[base_of(option)]
        designs[option] = (bank, {**parameters, **others}, without_user if option == USER_OPTION else ties)
    return designs
