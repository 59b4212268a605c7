# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Each module alone, in cocotb: which module, with which parameters, by which tests, in which simulator."""

import pytest
from conftest import FULL
from harness.build import table_parameters
from harness.runner import run
from protocol.defs import Space

TABLES = table_parameters(
    {
        Space.COILS: (300, 2100),
        Space.DISCRETES: (65000, 536),
        Space.INPUTS: (0, 0),
        Space.HOLDINGS: (1000, 300),
    }
)
IO_TABLES = table_parameters(
    {Space.COILS: (101, 39), Space.DISCRETES: (7, 33), Space.INPUTS: (65530, 6), Space.HOLDINGS: (400, 12)}
)
SMALL_TABLES = table_parameters(  # bits fit into the block of the registers
    {Space.COILS: (300, 90), Space.DISCRETES: (65000, 70), Space.INPUTS: (5, 3), Space.HOLDINGS: (1000, 60)}
)
OVERLAID = {"OVERLAY": 1, "HOLDING_COUNT": 12, "READ_ONLY_BASE": 5, "READ_ONLY_COUNT": 2}
SOME_READ_ONLY = {"READ_ONLY_BASE": 1100, "READ_ONLY_COUNT": 20}

# name: (top, parameters, cocotb module)
MODULES = {
    "sync": ("modbus_sync", {}, "line.sync"),
    "bit_clock": ("modbus_bit_clock", {}, "line.bit_clock"),
    "bit_clock_fractions": ("modbus_bit_clock", {"BIT_FRACTIONS": 1}, "line.bit_clock_fractions"),
    "glitch_filter": ("modbus_glitch_filter", {"CLOCKS": 3}, "line.glitch_filter"),
    "line_filtered": (
        "modbus_line",
        {"CLK_HZ": 1_000_000, "T15_MIN_US": 0, "T35_MIN_US": 0, "BIT_FRACTIONS": 1, "GLITCH_FILTER": 3},
        "line.filtered",
    ),
    "uart_receiving": ("uart_bench", {}, "line.uart_receiving"),
    "uart_sending": ("uart_bench", {}, "line.uart_sending"),
    "crc16": ("modbus_crc16", {}, "line.crc16"),
    "line_timer_characters": ("modbus_line_timer", {"T15_CLOCKS": 0, "T35_CLOCKS": 0}, "line.line_timer"),
    "line_timer_floors": ("modbus_line_timer", {"T15_CLOCKS": 301, "T35_CLOCKS": 777}, "line.line_timer"),
    "line_timer_between": ("modbus_line_timer", {"T15_CLOCKS": 10, "T35_CLOCKS": 400}, "line.line_timer"),
    "frame_rx": ("modbus_frame_rx", {}, "line.frame_rx"),
    "line_waits": ("modbus_line_timer", {"T15_CLOCKS": 0, "T35_CLOCKS": 0}, "line.line_waits"),
    "frame_tx": ("modbus_frame_tx", {}, "line.frame_tx"),
    "line": ("modbus_line", {"CLK_HZ": 1_000_000, "T15_MIN_US": 0, "T35_MIN_US": 0}, "line.line"),
    "ascii": ("modbus_ascii", {}, "line.ascii"),
    "alive": ("modbus_alive", {"CLK_HZ": 20_000, "TIMEOUT_MS": 7}, "line.alive"),
    "alive_2_ms": ("modbus_alive", {"CLK_HZ": 20_000, "TIMEOUT_MS": 2}, "line.alive"),
    "alive_for_ever": ("modbus_alive", {"CLK_HZ": 20_000, "TIMEOUT_MS": 0}, "line.alive"),
    "auto_line": ("modbus_auto_line", {"CLK_HZ": 1_000_000, "MIN_BAUD": 1000}, "line.auto_line"),
    "line_health": ("modbus_line_health", {}, "line.line_health"),
    "program": ("modbus_program", {}, "engine.program"),
    "sequencer": ("modbus_sequencer", {"USER_CODES": 1 << 65}, "engine.sequencer"),
    "range": ("modbus_range", {}, "engine.range"),
    "burst": ("modbus_burst", {}, "engine.burst"),
    "range_wide": ("modbus_range", {"BITS_PER_BEAT": 16}, "engine.range"),
    "burst_wide": ("modbus_burst", {"BITS_PER_BEAT": 16}, "engine.burst"),
    "frame_ram": ("modbus_frame_ram", {}, "engine.frame_ram"),
    "diagnostics": ("modbus_diagnostics", {}, "engine.diagnostics"),
    "bank_guard": ("modbus_bank_guard", {**TABLES, **SOME_READ_ONLY}, "bank.bank_guard"),
    "bank_guard_whole": (
        "modbus_bank_guard",
        {**table_parameters(dict.fromkeys(list(Space)[:4], (0, 65536))), "READ_ONLY_COUNT": 65536},
        "bank.bank_guard",
    ),
    "bank_guard_overlay": ("modbus_bank_guard", OVERLAID, "bank.bank_guard"),
    "bank_ram": ("modbus_bank_ram", TABLES, "bank.bank_bus"),
    "bank_ram_checks": ("modbus_bank_ram", {**TABLES, "CHECK_WRITES": 1}, "bank.bank_bus"),
    "bank_io": ("modbus_bank_io", {}, "bank.bank_bus"),
    "example_units": (
        "modbus_example_units",
        {"CLK_HZ": 1_000_000, "BIT_TIME": 16, "T15_MIN_US": 0, "T35_MIN_US": 0},
        "examples.example_units",
    ),
    "bank_ram_wide": ("modbus_bank_ram", {**TABLES, "BITS_PER_BEAT": 16}, "bank.bank_bus"),
    "bank_ram_wide_beside": ("modbus_bank_ram", {**SMALL_TABLES, "BITS_PER_BEAT": 16}, "bank.bank_bus"),
    "bank_io_read_back": ("modbus_bank_io", {**IO_TABLES, "READ_BACK_RAM": 1}, "bank.bank_bus"),
    "bank_io_read_back_one": ("modbus_bank_io", {"HOLDING_COUNT": 1, "READ_BACK_RAM": 1}, "bank.bank_bus"),
    "bank_io_wide": ("modbus_bank_io", {**IO_TABLES, "BITS_PER_BEAT": 16}, "bank.bank_bus"),
    "example_user": ("modbus_example_user", {"WORK_CLOCKS": 300}, "examples.example_user"),
    "pdm_record": ("modbus_pdm_record", {"DEPTH": 32}, "examples.pdm_record"),
    "pdm_record_4": ("modbus_pdm_record", {"DEPTH": 4}, "examples.pdm_record"),
}


# Those that take Icarus long; it plays them with FULL=1.
ON_VERILATOR = "line line_filtered line_waits uart_receiving uart_sending auto_line line_health example_units".split()
RUNS = [
    *(("verilator", name) for name in ON_VERILATOR),
    *(("icarus", name) for name in MODULES if FULL or name not in ON_VERILATOR),
]


@pytest.mark.parametrize("sim,name", RUNS, ids=["-".join(one) for one in RUNS])
def test_module(record_property, sim, name):
    top, parameters, module = MODULES[name]
    run(record_property, sim, top, module, parameters, own=f"module_{name}")
