# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many slaves on one two-wire line, their drivers resolved in Verilog: levels 0, 1, and neither."""

from harness.build import NO_FLOORS, function_mask
from harness.runner import run
from harness.volume import volume
from protocol.defs import DIAGNOSTIC_FUNCTIONS, FC

PLAIN = (FC.READ_COILS, FC.READ_HOLDINGS, FC.WRITE_COIL, FC.WRITE_REGISTER, FC.WRITE_COILS, FC.WRITE_REGISTERS)
BUILD = {
    **NO_FLOORS,
    "TABLE_COUNT": 8,
    "DIAGNOSED_EVERY": 2,
    "PLAIN_CODES": function_mask(PLAIN),
    "DIAGNOSED_CODES": function_mask((*PLAIN, *DIAGNOSTIC_FUNCTIONS)),
}


# A clock of many cores takes long; multidrop/test_thirty_two.py has 32 of them compiled.
NODES = volume("slaves on one line in a simulator")


def test_one_line(record_property, seed):
    env = {"BENCH_SEED": str(seed), "BENCH_COUNT": str(volume("requests to them"))}
    run(record_property, "icarus", "multidrop_bench", "multidrop.one_line", {**BUILD, "NODES": NODES}, env)
