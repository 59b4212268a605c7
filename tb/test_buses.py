# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The bus sides in cocotb with Icarus: the core as a master, a CPU at the RAM bank, two masters in one SoC."""

import pytest
from mbrtu.build import NO_FLOORS, REFERENCE
from mbrtu.runner import run

MASTER, SLAVE = "bus_master_bench", "axil_slave_bench"
MAPPED = {**NO_FLOORS, **REFERENCE}
# Places that no table begins at: nothing of an address is a constant.
SCATTERED = {
    **MAPPED,
    "COIL_AT": 0x40000004,
    "DISCRETE_AT": 0x80001FFC,
    "INPUT_AT": 0xFFFF8000,
    "HOLDING_AT": 0x12345678,
    "FILE_AT": 0x7FFFFFF0,
}

# name: (top, parameters, cocotb module, names of cocotb tests or None for all)
SUITES = {
    "axil_master": (MASTER, {**MAPPED, "AXIL": 1}, "master", None),
    "axil_master_scattered": (MASTER, {**SCATTERED, "AXIL": 1}, "master", "waits/odds=0.3|files|tables"),
    "wishbone_master": (MASTER, {**MAPPED, "AXIL": 0}, "master", None),
    "axil_slave": (SLAVE, MAPPED, "slave", None),
    "wishbone_host": ("modbus_rtu_slave", MAPPED, "slave", None),
    "soc_axil": ("modbus_example_soc_axil", NO_FLOORS, "soc", None),
    "soc_wishbone": ("modbus_example_soc_wb", NO_FLOORS, "soc", None),
}


@pytest.mark.parametrize("suite", SUITES)
def test_buses(record_property, suite, seed):
    top, parameters, module, only = SUITES[suite]
    run(record_property, "icarus", top, f"buses.{module}", parameters, {"BENCH_SEED": str(seed)}, only, suite)
