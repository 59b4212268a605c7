# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many slaves on one two-wire line, their drivers resolved in Verilog: levels 0, 1, and neither."""

from conftest import FULL
from harness.build import NO_FLOORS, function_mask
from harness.runner import run
from protocol.defs import DIAGNOSTIC_FUNCTIONS, FC

PLAIN = (FC.READ_COILS, FC.READ_HOLDINGS, FC.WRITE_COIL, FC.WRITE_REGISTER, FC.WRITE_COILS, FC.WRITE_REGISTERS)
BUILD = {
    **NO_FLOORS,
    "TABLE_COUNT": 8,
    "DIAGNOSED_EVERY": 2,
    "PLAIN_CODES": function_mask(PLAIN),
    "DIAGNOSED_CODES": function_mask((*PLAIN, *DIAGNOSTIC_FUNCTIONS)),
}


NODES = 32 if FULL else 4  # a clock of 32 cores takes long; multidrop/test_thirty_two.py has them compiled


def test_one_line(record_property, seed):
    env = {"BENCH_SEED": str(seed), "BENCH_COUNT": "60" if FULL else "10"}
    run(record_property, "icarus", "multidrop_bench", "multidrop.one_line", {**BUILD, "NODES": NODES}, env)
