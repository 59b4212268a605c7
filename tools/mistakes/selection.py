# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What is tried against a mistake, and in which order."""

# What is tried, in this order; the quickest that notices most comes first:
# (suite of test_modules.py, test_system.py or test_buses.py, regular expression of its cocotb tests), or the compiled
# slave and how many requests of random traffic it gets. A module alone is left out when the mistake is in none of its
# files.
COMPILED = "random traffic"
MODULES_ALONE = {
    "crc16": ("modbus_crc16.v",),
    "bit_clock": ("modbus_bit_clock.v",),
    "bit_clock_fractions": ("modbus_bit_clock.v",),
    "glitch_filter": ("modbus_glitch_filter.v",),
    "uart_receiving": ("modbus_uart.v",),
    "uart_sending": ("modbus_uart.v", "modbus_crc16.v"),
    "line_timer_characters": ("modbus_line_timer.v",),
    "line_waits": ("modbus_line_timer.v",),
    "frame_rx": ("modbus_frame_rx.v",),
    "frame_tx": ("modbus_frame_tx.v",),
    "line": ("modbus_line.v", "modbus_frame_rx.v", "modbus_frame_tx.v", "modbus_line_timer.v", "modbus_uart.v"),
    "ascii": ("modbus_ascii.v",),
    "bank_guard": ("modbus_bank_guard.v",),
    "bank_guard_whole": ("modbus_bank_guard.v",),
    "bank_guard_overlay": ("modbus_bank_guard.v",),
    "bank_ram": ("modbus_bank_ram.v",),
    "bank_ram_checks": ("modbus_bank_ram.v",),
    "bank_io": ("modbus_bank_io.v",),
    "auto_line": ("modbus_auto_line.v", "modbus_run_ram.v"),
    "line_health": ("modbus_line_health.v", "modbus_health_ram.v"),
    "example_units": ("modbus_units.v", "modbus_example_units.v"),
    "sequencer": ("modbus_sequencer.v",),
    "range": ("modbus_range.v",),
    "burst": ("modbus_burst.v",),
    "range_wide": ("modbus_range.v",),
    "burst_wide": ("modbus_burst.v",),
    "bank_ram_wide": ("modbus_bank_ram.v", "modbus_bank_lanes.v"),
    "bank_ram_wide_beside": ("modbus_bank_ram.v",),
    "bank_io_read_back": ("modbus_bank_io.v",),
    "bank_io_wide": ("modbus_bank_io.v", "modbus_bank_lanes.v"),
    "program": ("modbus_program.v", "modbus_routines_tables.vh"),
    "frame_ram": ("modbus_frame_ram.v",),
    "diagnostics": ("modbus_diagnostics.v",),
}
# Suites of test_buses.py, and the files that they alone are about.
BUSES = {
    "axil_master": ("modbus_axil_master.v",),
    "axil_slave": ("modbus_axil_slave.v",),
    "soc_axil": ("modbus_axil_master.v", "modbus_example_soc_axil.v"),
    "host_map_wishbone": ("modbus_host_map.v",),
    "host_map_reads_only": ("modbus_host_map.v",),
    "host_map_left_out": ("modbus_host_map.v",),
    "soc_wishbone": ("modbus_example_soc_wb.v",),
}
SELECTION = [
    *((suite, None) for suite in MODULES_ALONE),
    ("power_up", None),
    (COMPILED, 2000),
    ("functions_mapped", "single_coil|byte_count|length_is_exact|unsupp|mask|broadcast|lock|read_only|order|share"),
    ("functions_mapped", "address_limits|align|read_write|limits.*code=(3|15|16)"),
    (
        "line_faults",
        "gap=(1.2|2.0).count_only|add_up|parity|framing|second_stop|long_frames|truncated|short_frames|swapped|traffic"
        "|own_|breaks|right_after|during|after_reset",
    ),
    (
        "ascii_mode",
        "parity|framing|gap_above|do_not_add|colon|cr_in|long_frames|delimiter|ends_the_frame|stop_bits"
        "|every_format.*fmt=[04]",
    ),
    ("options", "delay=(0|7)$|tail=6|tearing|any_time|every_table|needs_no_memory|late_answer.*drop=1"),
    ("core_bus", "wait=(0|7)$|code=(4|10)$|second_range|past|stall|busy|no_access|in_order"),
    ("speed", "case=(0|16|24)$|to_the_bit"),
    ("core_checks", "checked_once.*wait=0|refused.*code=3|broadcast"),
    ("ram_checked", "write|mask"),
    ("identity_01", None),
    ("identity_82", None),
    ("identity_small", None),
    ("identity_above", "in_order"),
    ("fifo", None),
    ("user_port", None),
    ("core_files", "waits$|wait=0|refused|error|stall|longest|busy"),
    ("diagnostics_counters", None),
    ("diagnostics_modes", None),
    ("files", None),
    ("health_registers", None),
    *((suite, None) for suite in BUSES),
]
# What is tried first for a mistake in a file, since it is about that file.
IDENTITY = ("identity_small", "identity_above", "identity_01", "identity_82")
FIRST = {
    "modbus_ascii.v": ("ascii", "ascii_mode"),
    "modbus_frame_rx.v": ("frame_rx", "line", "ascii_mode"),
    "modbus_line.v": ("line", "ascii_mode", "line_faults"),
    "modbus_engine.v": ("core_checks", "user_port"),
    "modbus_routines_data.vh": ("core_checks", "functions_mapped"),
    "modbus_identity.v": IDENTITY,
    "modbus_routines_identity.vh": IDENTITY,
    "modbus_routines_files.vh": ("files", "core_files", "fifo"),
    "modbus_routines_diagnostics.vh": ("diagnostics_modes", "diagnostics_counters"),
    "modbus_rtu_slave_io.v": ("health_registers",),
    "modbus_diagnostics.v": ("diagnostics", "diagnostics_counters", "diagnostics_modes"),
    "modbus_bank_guard.v": ("bank_guard", "functions_mapped"),
    "modbus_bank_ram.v": ("functions_mapped", "files", "options"),
}
# The tests of tb/map that are tried against a mistake in the map compiler, and which are first for a file.
COMPILER_TESTS = (
    "test_model",
    "test_diagnostics",
    "test_c_header",
    "test_manual",
    "test_tags",
    "test_client",
    "test_vhdl_output",
    "test_random_maps",
    "test_testbench",
    "test_live",
)
COMPILER_FIRST = {
    "rtl_bank.py": "test_random_maps",
    "rtl_plan.py": "test_random_maps",
    "verilog.py": "test_testbench",
    "checks.py": "test_diagnostics",
    "csv_door.py": "test_diagnostics",
    "c_header.py": "test_c_header",
    "client_runtime.py": "test_client",
    "model.py": "test_manual",
    "tags.py": "test_tags",
    "node_red.py": "test_tags",
    "vhdl.py": "test_vhdl_output",
    "live.py": "test_live",
}
