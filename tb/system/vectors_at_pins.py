# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every printed example of the implemented functions, at the pins with RTU timing."""

import cocotb
from mbrtu import bench, build, vectors

LIMITS_BUILT = {
    field: bench.PARAMETERS[name] for name, field in build.LIMIT_PARAMETERS.items() if name in bench.PARAMETERS
}


def belongs(vector):
    """A vector that overrides a limit belongs to the build that has it, the others to the plain one."""
    wanted = vectors.limits(vector)
    return bool(wanted) == bool(LIMITS_BUILT) and wanted.items() <= LIMITS_BUILT.items()


CASES = [v for v in vectors.playable() if belongs(v)]


@cocotb.test()
@cocotb.parametrize(vector=[v["id"] for v in CASES])
async def printed_example_plays(dut, vector):
    case = next(v for v in CASES if v["id"] == vector)
    tb = await bench.Bench.start(dut, address=case["slave_address"], bit_time=16)
    for key, value in vectors.contents(case["preconditions"]):
        await tb.preset(key, value)
    seen = await tb.both(vectors.frame(case["request"]))
    assert seen == vectors.frame(case["expected_response"]), f"printed {case['expected_response']}"
    for key, value in vectors.contents(case["postconditions"]):
        held = await tb.read_back(key)
        assert held == value, f"{key}: printed {value:04X}, holds {held}"
    await tb.finish()
