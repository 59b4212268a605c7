# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_glitch_filter: a pulse of up to CLOCKS clocks is not seen, a longer one keeps its length."""

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, settle, start

CLOCKS = PARAMETERS.get("CLOCKS", 3)


async def seen(dut, width, level):
    """Clocks for which the output has the level of a pulse of that width, and when it begins."""
    dut.level_i.value = level
    length, begins = 0, None
    for clock in range(4 * CLOCKS + width + 8):
        if clock == width:
            dut.level_i.value = 1 - level
        await clocks(dut)
        await settle()
        if int(dut.level_o.value) == level:
            begins = clock + 1 if begins is None else begins
            length += 1
    return length, begins


@cocotb.test()
@cocotb.parametrize(level=[0, 1])
async def only_pulses_above_the_limit_pass(dut, level):
    await start(dut, level=1 - level)
    await clocks(dut, 3 * CLOCKS + 4)
    for width in range(1, CLOCKS + 1):
        assert await seen(dut, width, level) == (0, None), f"{width} clocks"
    for width in (CLOCKS + 1, CLOCKS + 2, 20):
        assert await seen(dut, width, level) == (width, CLOCKS + 1), f"{width} clocks"


@cocotb.test()
async def pulses_do_not_add_up(dut):
    await start(dut, level=1)
    await clocks(dut, 3 * CLOCKS)
    for _ in range(20):
        assert await seen(dut, CLOCKS, 0) == (0, None)
