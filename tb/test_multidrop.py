# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many slaves on one two-wire line, their driver enables resolved."""

from conftest import FULL
from mbrtu.build import NO_FLOORS, function_mask
from mbrtu.defs import DIAGNOSTIC_FUNCTIONS, FC
from mbrtu.runner import run

PLAIN = (FC.READ_COILS, FC.READ_HOLDINGS, FC.WRITE_COIL, FC.WRITE_REGISTER, FC.WRITE_COILS, FC.WRITE_REGISTERS)
BUILD = {
    **NO_FLOORS,
    "TABLE_COUNT": 8,
    "DIAGNOSED_EVERY": 4,
    "PLAIN_CODES": function_mask(PLAIN),
    "DIAGNOSED_CODES": function_mask((*PLAIN, *DIAGNOSTIC_FUNCTIONS)),
}


NODES = 32 if FULL else 8  # a clock of 32 cores is slow; tb/differential has 32 of them compiled


def test_one_line(record_property, seed):
    env = {"BENCH_SEED": str(seed), "BENCH_COUNT": "60" if FULL else "12"}
    run(record_property, "icarus", "multidrop_bench", "multidrop.one_line", {**BUILD, "NODES": NODES}, env)
