# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The whole slave in cocotb: which build runs which topics, on which simulator."""

import re

import pytest
from conftest import FULL
from differential import bench as compiled
from harness.build import NO_FLOORS, REFERENCE, config_parameters, function_mask, table_parameters
from harness.runner import run
from protocol import vectors
from protocol.defs import ALL_FUNCTIONS, CONFORMITIES, DIAGNOSTIC_FUNCTIONS, FC, FILE_FUNCTIONS, Space

SLAVE, IO, CORE = "slave_bench", "io_bench", "core_bench"
DROP_IN, DROP_IN_IO = "modbus_rtu_slave", "modbus_rtu_slave_io"
PDM = "modbus_pdm_meter"

FAST = {**REFERENCE, **NO_FLOORS}  # the live device's map; t1.5 and t3.5 in characters only
MAPPED = {
    **NO_FLOORS,
    **table_parameters(
        {
            Space.COILS: (300, 2100),
            Space.DISCRETES: (65000, 536),  # ends at 65535
            Space.INPUTS: (1, 125),
            Space.HOLDINGS: (1000, 300),
        }
    ),
    "READ_ONLY_BASE": 1200,
    "READ_ONLY_COUNT": 20,
}
WHOLE = {**NO_FLOORS, **table_parameters(dict.fromkeys(list(Space)[:4], (0, 65536)))}
SMALL = {
    **NO_FLOORS,
    **table_parameters(
        {
            Space.COILS: (0, 1),
            Space.DISCRETES: (0, 0),  # no such table
            Space.INPUTS: (65535, 1),
            Space.HOLDINGS: (7, 2),
        }
    ),
    "FUNCTION_CODES": function_mask(
        (
            FC.READ_COILS,
            FC.READ_DISCRETES,
            FC.READ_HOLDINGS,
            FC.READ_INPUTS,
            FC.WRITE_REGISTER,
            FC.WRITE_COILS,
            FC.WRITE_REGISTERS,
        )
    ),
}
ASCII = {**FAST, "ASCII_MODE": 1, "CLK_HZ": 1_000_000, "ASCII_TIMEOUT_MS": 1}  # the time-out is 1000 clocks
ASCII_FLOORS = {**REFERENCE, "ASCII_MODE": 1, "CLK_HZ": 1_000_000, "ASCII_TIMEOUT_MS": 2}
LIMITED = {
    **FAST,
    "MAX_READ_BITS": 37,
    "MAX_WRITE_BITS": 29,
    "MAX_READ_REGISTERS": 50,
    "MAX_WRITE_REGISTERS": 60,
    "RW_MAX_READ": 10,
    "RW_MAX_WRITE": 7,
}
METER = {**FAST, "MAX_READ_REGISTERS": 50, "MAX_WRITE_REGISTERS": 60}
SLOW_CLOCK = {**REFERENCE, "CLK_HZ": 1_000_000, "ALIVE_TIMEOUT_MS": 20}
OVERLAID = {**NO_FLOORS, "OVERLAY": 1, "HOLDING_COUNT": 12, "READ_ONLY_BASE": 10, "READ_ONLY_COUNT": 1}
IO_MAPPED = {
    **NO_FLOORS,
    **table_parameters(
        {
            Space.COILS: (100, 19),
            Space.DISCRETES: (7, 33),
            Space.INPUTS: (65530, 6),
            Space.HOLDINGS: (400, 12),
        }
    ),
}
# The example's own codes, built-in ones that it passes, one that nobody has
EXAMPLE_USER = {
    **NO_FLOORS,
    "USER_CODES": function_mask(
        (0x41, 0x42, 0x64, FC.READ_HOLDINGS, FC.WRITE_REGISTER, FC.READ_EXCEPTION_STATUS, FC.DIAGNOSTICS, 0x6E)
    ),
    "WORK_CLOCKS": 2000,
}
PDM_REGISTERS = {**NO_FLOORS, "DI_COUNT": 0, "DO_COUNT": 0, "EVENT_DEPTH": 4}
PDM_WIDE = {**NO_FLOORS, "DI_COUNT": 19, "DO_COUNT": 9, "SETTING_COUNT": 300, "MEASURED_COUNT": 2}
# Each setting of the drop-ins other than its default
SET = {
    **NO_FLOORS,
    "CLK_HZ": 1_000_000,
    "BAUD": 62_500,
    "ADDRESS": 247,
    "FORMAT": 3,
    "BROADCAST": 0,
    "GAP_COUNT_ONLY": 1,
    "STRICT_TURNAROUND": 1,
    "RESPONSE_DELAY": 5,
    "DE_LEAD": 3,
    "DE_TAIL": 2,
}
# The words are input registers 13 to 20, coil 6 clears them
HEALTH = {
    **NO_FLOORS,
    **table_parameters(
        {Space.COILS: (4, 5), Space.DISCRETES: (0, 0), Space.INPUTS: (10, 11), Space.HOLDINGS: (10, 12)}
    ),
    "CLK_HZ": 16_000,
    "BAUD": 1000,
    "ADDRESS": 17,
    "LINE_HEALTH": 1,
    "HEALTH_COIL": 6,
}
# 9.77 clocks a bit
FRACTION = {**NO_FLOORS, "CLK_HZ": 12_000_000, "BAUD": 1_228_800, "BIT_FRACTIONS": 1, "GLITCH_FILTER": 2}
QUICK = {**NO_FLOORS, "CLK_HZ": 2_000_000, "BAUD": 250_000}
IO_READ_ONLY = {**IO_MAPPED, "READ_ONLY_BASE": 404, "READ_ONLY_COUNT": 2}


def example(name):
    """The build that a printed example needs."""
    vector = next(v for v in vectors.playable() if v["id"] == name)
    return {**FAST, **config_parameters(vectors.build_items(vector))}


def identity(**items):
    """A build with these fields of the model's Config: objects as {id: text or length}, conformity, ..."""
    objects = {
        i: value.encode() if isinstance(value, str) else bytes(33 + (i + place) % 90 for place in range(value))
        for i, value in items.pop("objects").items()
    }
    return {**FAST, **config_parameters({"objects": objects, **items})}


WHO = {0: "Works", 1: "P-17", 2: "V2", 3: "http://x", 5: "Model", 6: "app", 0x80: "a", 0x81: 30, 0xFF: "last"}
OBJECTS = {
    f"identity_{conformity:02X}": identity(objects=WHO, conformity=conformity, device_id_limit=64)
    for conformity in CONFORMITIES
}
CONFORMITY_TESTS = {"identity_01": "once|alone|not_there", "identity_83": None}
# An answer of 253 bytes: 7, then an object of 2 + 100, and 144 are left.
SEGMENTS = {
    "identity_fits": identity(objects={0: 100, 1: 142, 2: "V1"}, server_id=b"\x01\x02"),
    "identity_below": identity(objects={0: 100, 1: 141, 2: "V1"}, server_id=bytes(range(1, 17))),
    "identity_above": identity(
        objects={0: 100, 1: 143, 2: 1, 0x80: 244, 0x90: 244},
        conformity=0x83,
        server_id=bytes(range(0xF0, 0x100)),
        additional_data=bytes(range(234)),
    ),
    # the longest answer of 11H
    "identity_longest": identity(objects={0: 1}, server_id=b"\x11", additional_data=bytes(range(1, 250))),
    # the first three end at the limit
    "identity_small": identity(objects={0: 8, 1: 8, 2: 2, 3: 1, 4: 9, 6: 18}, conformity=0x82, device_id_limit=31),
}

# Those for users by the standard, one without a name, one at each end, and some that are built in.
USER_CODES = (1, *range(65, 73), *range(100, 111), 0x09, 127, *(FC.READ_HOLDINGS, FC.WRITE_REGISTERS))
USED = {**FAST, "USER_CODES": function_mask((*USER_CODES, FC.DIAGNOSTICS, FC.READ_DEVICE_ID))}


EVERYTHING = {**MAPPED, "FILE_COUNT": 3, "FILE_RECORDS": 140, "USER_CODES": function_mask((3, 65, 66, 110))}


def only(*codes, **parameters):
    """A build with these functions."""
    return {**FAST, "FUNCTION_CODES": function_mask(codes), **parameters}


def without(*codes, **parameters):
    """A build with all functions but these."""
    return only(*ALL_FUNCTIONS - set(codes), **parameters)


OPTIONAL = (0x07, *sorted(DIAGNOSTIC_FUNCTIONS), 0x11, *sorted(FILE_FUNCTIONS), 0x18, 0x2B)
LEFT_OUT = {
    **{f"without_{code:02X}": without(code) for code in OPTIONAL},
    "without_diagnostics": without(*DIAGNOSTIC_FUNCTIONS),
    "only_03": only(FC.READ_HOLDINGS),
    "only_08": only(FC.DIAGNOSTICS),
    "only_basic": only(*range(1, 7), FC.WRITE_COILS, FC.WRITE_REGISTERS),
    "only_03_used": only(FC.READ_HOLDINGS, USER_CODES=function_mask((3, 4, 7, 8, 65, 127))),
    "without_diagnostics_used": without(*DIAGNOSTIC_FUNCTIONS, USER_CODES=function_mask((8, 0x0B, 65))),
}
LEFT_OUT_TESTS = {
    **dict.fromkeys(("without_08", "without_diagnostics", "only_08"), "each|counted"),
    **dict.fromkeys((name for name in LEFT_OUT if name.endswith("_used")), "user"),
}

# name: (top, parameters, cocotb modules, names of cocotb tests or None for all)
SUITES = {
    "power_up": (SLAVE, FAST, "power_up", "without_a_reset"),
    "power_up_io": (IO, NO_FLOORS, "power_up", "without_a_reset"),
    "power_up_short_05": (SLAVE, FAST, "power_up", "short/code=5$"),
    "power_up_short_15": (SLAVE, FAST, "power_up", "short/code=21$"),
    "smoke": (SLAVE, FAST, "smoke", None),
    "smoke_io": (IO, IO_MAPPED, "smoke", None),
    "vectors": (SLAVE, FAST, "vectors_at_pins", None),
    "vectors_meter": (SLAVE, METER, "vectors_at_pins", None),
    "vectors_984": (SLAVE, example("S000-FIG32-33-984"), "vectors_at_pins", None),
    "vectors_identity": (SLAVE, example("V11B3-6.21-ONE"), "vectors_at_pins", None),
    "vectors_segments": (SLAVE, example("V11B3-6.21-TWO-1"), "vectors_at_pins", None),
    "line_faults": (SLAVE, FAST, "line_faults", None),
    "line_faults_floors": (SLAVE, SLOW_CLOCK, "line_faults", "gap|after_reset|right_after|truncated"),
    "functions_mapped": (SLAVE, MAPPED, "functions", None),
    "functions_whole": (SLAVE, WHOLE, "functions", "address_limits|write_quantity|mask|takes|read_write|share"),
    "functions_small": (SLAVE, SMALL, "functions", None),
    "functions_limited": (SLAVE, LIMITED, "functions", "limits|read_write"),
    "options": (SLAVE, FAST, "options", None),
    "options_timeout": (SLAVE, SLOW_CLOCK, "options", "alive|delay"),
    "options_mapped": (SLAVE, MAPPED, "options", "host"),
    "host_inputs": (SLAVE, FAST, "host_inputs", None),
    "overlay": (SLAVE, OVERLAID, "overlay", None),
    "speed": (SLAVE, FAST, "speed", "^(?!.*19200)"),
    "speed_floors": (SLAVE, SLOW_CLOCK, "speed", "silences"),
    "timing": (SLAVE, REFERENCE, "timing", None),
    "io": (IO, NO_FLOORS, "io_bank", None),
    "drop_in": (DROP_IN, QUICK, "drop_in", None),
    "drop_in_set": (DROP_IN, SET, "drop_in", None),
    "drop_in_921600": (
        DROP_IN_IO,
        {**NO_FLOORS, "CLK_HZ": 12_000_000, "BAUD": 921_600, "BIT_FRACTIONS": 1},
        "drop_in",
        "rate",
    ),
    "drop_in_1000000": (DROP_IN, {**NO_FLOORS, "CLK_HZ": 27_000_000, "BAUD": 1_000_000}, "drop_in", "rate"),
    "drop_in_fraction": (DROP_IN, FRACTION, "drop_in", None),
    "drop_in_8n2": (DROP_IN, {**QUICK, "FORMAT": 2}, "drop_in", "settings"),
    "drop_in_io": (DROP_IN_IO, QUICK, "drop_in", None),
    "health_registers": (DROP_IN_IO, HEALTH, "health_registers", None),
    "drop_in_io_set": (DROP_IN_IO, SET, "drop_in", None),
    "io_mapped": (IO, IO_MAPPED, "io_bank", None),
    "io_functions": (IO, IO_MAPPED, "functions", "address_limits|write_quantity|mask|order|broadcast"),
    "io_read_only": (IO, IO_READ_ONLY, "functions", "read_only|lock"),
    "diagnostics_counters": (SLAVE, FAST, "diagnostics_counters", None),
    "diagnostics_modes": (SLAVE, FAST, "diagnostics_modes", None),
    **{name: (SLAVE, build, "identity", CONFORMITY_TESTS.get(name, "once|alone")) for name, build in OBJECTS.items()},
    **{name: (SLAVE, build, "identity", "in_order/code=3|server_id") for name, build in SEGMENTS.items()},
    "files": (SLAVE, FAST, "files", None),
    "files_ten": (SLAVE, {**FAST, "FILE_COUNT": 10, "FILE_RECORDS": 8}, "files", "order_of|record_limits|port"),
    "files_long": (SLAVE, {**FAST, "FILE_COUNT": 6, "FILE_RECORDS": 10000}, "files", "record_limits|port"),
    "fifo": (SLAVE, MAPPED, "fifo", None),
    "fifo_whole": (SLAVE, WHOLE, "fifo", "end_of"),
    "core_files": (CORE, NO_FLOORS, "core_files", None),
    "user_port": (SLAVE, USED, "user_port", None),
    **{
        f"left_out_{name}": (SLAVE, build, "left_out", LEFT_OUT_TESTS.get(name, "each"))
        for name, build in LEFT_OUT.items()
    },
    "left_out_no_files": (SLAVE, NO_FLOORS, "left_out", "each"),
    "left_out_io": (IO, IO_MAPPED, "left_out", "each|counted"),
    "core_bus": (CORE, NO_FLOORS, "core_bus", None),
    "core_wide": (CORE, {**NO_FLOORS, "BITS_PER_BEAT": 16}, "core_bus", None),
    "core_wide_checks": (CORE, {**NO_FLOORS, "BITS_PER_BEAT": 16, "CHECK_WRITES": 1}, "core_checks", None),
    "functions_wide": (SLAVE, {**MAPPED, "BITS_PER_BEAT": 16}, "functions", "coil|bit|align|order|share|lock"),
    "io_read_back": (IO, {**IO_MAPPED, "READ_BACK_RAM": 1}, "io_bank", None),
    "io_wide": (IO, {**IO_MAPPED, "BITS_PER_BEAT": 16}, "io_bank", None),
    "host_wide": (SLAVE, {**MAPPED, "BITS_PER_BEAT": 16}, "options", "tearing|any_time|every_table|needs_no_memory"),
    "core_checks": (CORE, {**NO_FLOORS, "CHECK_WRITES": 1}, "core_checks", None),
    "core_checked_bus": (CORE, {**NO_FLOORS, "CHECK_WRITES": 1}, "core_bus", "in_order|stall_limit_on|longest_lists"),
    "ram_checked": (SLAVE, {**FAST, "CHECK_WRITES": 1}, "functions", "write|mask"),
    "io_checked": (IO, {**NO_FLOORS, "CHECK_WRITES": 1}, "io_bank", None),
    "ascii_mode": (SLAVE, ASCII, "ascii_mode", None),
    "ascii_mode_floors": (SLAVE, ASCII_FLOORS, "ascii_mode", "ends_the_frame"),
    "random": (SLAVE, EVERYTHING, "random_requests", None),
    "example_user": ("example_bench", EXAMPLE_USER, "example_user", None),
    "pdm_meter": (PDM, NO_FLOORS, "pdm_meter", None),
    "pdm_meter_standard": (PDM, {**NO_FLOORS, "EVENT_RECORD": 0}, "pdm_meter", "printed|random|host"),
    "pdm_meter_registers": (PDM, PDM_REGISTERS, "pdm_meter", "printed|random|other|record"),
    "pdm_meter_wide": (PDM, PDM_WIDE, "pdm_meter", "inputs|relays|settings|reset"),
}
# Played in Icarus alone: short, or about levels that are unknown.
ON_ICARUS = (
    *("power_up", "power_up_io", "power_up_short_05", "power_up_short_15"),
    *("vectors_984", "vectors_identity", "vectors_segments", "drop_in_921600", "drop_in_8n2"),
    *("fifo_whole", "left_out_no_files", "left_out_only_basic"),
    *(f"left_out_without_{code:02X}" for code in OPTIONAL if code != FC.DIAGNOSTICS),
    "left_out_without_diagnostics_used",
)
# Builds that differ from others in a code, a size or one setting: played with FULL=1 only.
LIKE_OTHERS = (
    *(f"left_out_without_{code:02X}" for code in OPTIONAL),
    *("left_out_only_08", "left_out_only_basic", "left_out_without_diagnostics", "left_out_without_diagnostics_used"),
    *("files_long", "drop_in_1000000", "drop_in_8n2", "drop_in_io_set", "core_checked_bus"),
    *("core_wide_checks", "pdm_meter_wide"),
)
# Volume that needs nothing but the line, the host port and settings, without a simulator between: the fastest.
# suite: regular expression of the tests, or None for all
ON_COMPILED = {
    "smoke": None,
    "functions_mapped": None,
    "functions_small": None,
    "functions_whole": None,
    "functions_limited": None,
    "functions_wide": None,
    **dict.fromkeys((*OBJECTS, *SEGMENTS)),
    "files": None,
    "files_ten": None,
    "fifo": None,
    "host_inputs": "changes_its_mind",
    "timing": None,
    "ascii_mode": "^(?!.*(ends_the_frame|late_answers|breaks|reset_sets))",
    "ram_checked": None,
    "left_out_only_03": None,
    "overlay": None,
    "vectors": "example_plays",
    "line_faults": "gap|(parity|framing)_error|long|truncated|short|single_bit|swapped|others|own_(address|echo)",
    "options": "response_delay|lead_and_tail|change_while_idle|data_bit_0",
    "speed": "every_format|over_the_longest|other_formats|silence_limits",
    "diagnostics_counters": "^(?!.*(wrap|overrun_flag))",
    "diagnostics_modes": "listen_only|normal_mode|sub_functions",
}
# What Verilator plays of a suite beside or instead of what stands above, where that is not the rest.
PART_ON_VERILATOR = {
    "identity_03": "once",
    "core_wide": "in_order|longest_lists|at_random|burst|second_range|reset_releases",
    "options_mapped": "host_port_reaches|core_waits",
    "ascii_mode": "ends_the_frame|late_answers|breaks|reset_sets|printed",
}
# What Icarus, which takes thirty times as long, plays beside Verilator, for unknown levels: suite: regular expression.
BESIDE_VERILATOR = {
    "smoke": "exceptions|broadcast|t35",
    "line_faults": "after_reset|behind_reset.*8E1|defined|during_the_answer",
    "core_bus": "reset_releases|in_order|second_range",
    "vectors": "example_plays/vector=[0-3]$",
    "diagnostics_modes": "answers_at_once",
}
WHOLE_ON_COMPILED = {name for name, tests in ON_COMPILED.items() if tests is None}
ELSEWHERE = {*ON_ICARUS, *WHOLE_ON_COMPILED - PART_ON_VERILATOR.keys()}
PLAYED = [name for name in SUITES if FULL or name not in LIKE_OTHERS]
RUNS = [
    *(("verilator", name) for name in PLAYED if name not in ELSEWHERE),
    *(("compiled", name) for name in PLAYED if name in ON_COMPILED),
    *(("icarus", name) for name in PLAYED if FULL or name in {*ON_ICARUS, *BESIDE_VERILATOR}),
]


def chosen(sim, suite):
    """Regular expression of a suite's tests on a simulator; Icarus plays all with FULL=1."""
    every, compiled_part = SUITES[suite][3], ON_COMPILED.get(suite)
    if sim == "compiled":
        return compiled_part or every
    if sim == "icarus":
        return every if FULL else BESIDE_VERILATOR.get(suite, every)
    rest = f"^(?!.*({compiled_part})).*({every or ''})" if compiled_part else every
    return PART_ON_VERILATOR.get(suite, rest)


@pytest.mark.parametrize("sim,suite", RUNS, ids=[f"{sim}-{name}" for sim, name in RUNS])
def test_system(record_property, sim, suite, seed):
    top, parameters, module, _ = SUITES[suite]
    only = chosen(sim, suite)
    if sim == "compiled":
        assert top == compiled.TOP, f"{suite} is about {top}, the compiled slave is {compiled.TOP}"
        return compiled.run(record_property, f"system.{module}", parameters, only)
    run(record_property, sim, top, f"system.{module}", parameters, {"BENCH_SEED": str(seed)}, only, suite)


def test_nothing_of_a_suite_is_left_out():
    """What the compiled slave does not play of a suite, a simulator plays."""
    for suite in (name for name in ON_COMPILED if name in PLAYED):
        tests = [test.fullname for test in compiled.tests_of(f"system.{SUITES[suite][2]}")]
        played = [re.compile(chosen(sim, suite) or "") for sim, name in RUNS if name == suite and sim != "icarus"]
        missing = [n for n in tests if re.search(SUITES[suite][3] or "", n) and not any(p.search(n) for p in played)]
        assert not missing, f"{suite}: {missing}"
