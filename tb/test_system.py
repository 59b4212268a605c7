# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The whole slave in cocotb: which build runs which topics, on which simulator."""

import pytest
from mbrtu.build import NO_FLOORS, REFERENCE, function_mask, table_parameters
from mbrtu.defs import FC, Space
from mbrtu.runner import run

SLAVE, IO, CORE = "modbus_rtu_slave", "modbus_rtu_slave_io", "modbus_rtu_core"

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
IO_READ_ONLY = {**IO_MAPPED, "READ_ONLY_BASE": 404, "READ_ONLY_COUNT": 2}

# name: (top, parameters, cocotb modules, names of cocotb tests or None for all)
SUITES = {
    "vectors": (SLAVE, FAST, "vectors_at_pins", None),
    "vectors_meter": (SLAVE, METER, "vectors_at_pins", None),
    "line_faults": (SLAVE, FAST, "line_faults", None),
    "line_faults_floors": (SLAVE, SLOW_CLOCK, "line_faults", "gap|after_reset|right_after|truncated"),
    "functions_mapped": (SLAVE, MAPPED, "functions", None),
    "functions_whole": (SLAVE, WHOLE, "functions", "address_limits|write_quantity|mask|takes|read_write|share"),
    "functions_small": (SLAVE, SMALL, "functions", None),
    "functions_limited": (SLAVE, LIMITED, "functions", "limits|read_write"),
    "options": (SLAVE, FAST, "options", None),
    "options_timeout": (SLAVE, SLOW_CLOCK, "options", "alive|delay"),
    "options_mapped": (SLAVE, MAPPED, "options", "host"),
    "overlay": (SLAVE, OVERLAID, "overlay", None),
    "speed": (SLAVE, FAST, "speed", "^(?!.*19200)"),
    "speed_floors": (SLAVE, SLOW_CLOCK, "speed", "silences"),
    "timing": (SLAVE, REFERENCE, "timing", None),
    "io": (IO, NO_FLOORS, "io_bank", None),
    "io_mapped": (IO, IO_MAPPED, "io_bank", None),
    "io_functions": (IO, IO_MAPPED, "functions", "address_limits|write_quantity|mask|order|broadcast"),
    "io_read_only": (IO, IO_READ_ONLY, "functions", "read_only|lock"),
    "core_bus": (CORE, NO_FLOORS, "core_bus", None),
    "random": (SLAVE, MAPPED, "random_requests", None),
}
# Verilator takes some ten seconds for each build, so it runs a selection.
ON_VERILATOR = ("line_faults", "speed", "options", "core_bus")
RUNS = [("verilator", name) for name in ON_VERILATOR] + [("icarus", name) for name in SUITES]


@pytest.mark.parametrize("sim,suite", RUNS, ids=[f"{sim}-{name}" for sim, name in RUNS])
def test_system(record_property, sim, suite, seed):
    top, parameters, module, only = SUITES[suite]
    run(record_property, sim, top, f"system.{module}", parameters, {"BENCH_SEED": str(seed)}, only, suite)
