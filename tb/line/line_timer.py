# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Line timer: t1.5 and t3.5 of each format to the quarter bit, the floors to the clock.

Silence counts from the end of the last stop bit; the receiver falls idle at the middle of the first.
"""

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, settle, start
from protocol.defs import FORMAT_BY_NAME, T15_CHARACTERS, T35_CHARACTERS

QUARTER = 2  # clocks: 8 clocks a bit
T15_CLOCKS, T35_CLOCKS = PARAMETERS.get("T15_CLOCKS", 37500), PARAMETERS.get("T35_CLOCKS", 87500)
SLACK = 3 * QUARTER  # clocks between the verdict and the exact end, never before it


async def run_quarters(dut):
    """The bit clock, without end."""
    while True:
        dut.quarter_stb_i.value = 0
        await clocks(dut, QUARTER - 1)
        dut.quarter_stb_i.value = 1
        await clocks(dut)


async def measured(dut, most):
    """Clocks from the fall of busy to t15 and t35."""
    await clocks(dut, 4 * QUARTER + 1)
    dut.busy_i.value = 0
    t15 = t35 = None
    for clock in range(1, most):
        await clocks(dut)
        await settle()
        if t15 is None and int(dut.t15_o.value):
            t15 = clock
        if int(dut.t35_o.value):
            t35 = clock
            break
    return t15, t35


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def silence_is_measured_from_the_last_stop_bit(dut, fmt):
    fmt = FORMAT_BY_NAME[fmt]
    await start(dut, format=fmt.code, busy=1)
    cocotb.start_soon(run_quarters(dut))
    bit = 4 * QUARTER
    rest = bit // 2 + (fmt.stops - 1) * bit
    for _ in range(2):
        seen = await measured(dut, 4 * fmt.length * bit + 4 * T35_CLOCKS)
        for name, got, factor, floor in (
            ("t1.5", seen[0], T15_CHARACTERS, T15_CLOCKS),
            ("t3.5", seen[1], T35_CHARACTERS, T35_CLOCKS),
        ):
            wanted = rest + max(factor * fmt.length * bit, floor)
            assert wanted <= got <= wanted + SLACK, f"{name}: {got} clocks, wanted {wanted}"
        dut.busy_i.value = 1
        await clocks(dut, 2)
        await settle()
        assert not int(dut.t35_o.value), "t3.5 outlives the next character"


@cocotb.test()
async def gaps_do_not_add_up(dut):
    """A character begins the count anew, however often."""
    fmt = FORMAT_BY_NAME["8E1"]
    await start(dut, format=fmt.code, busy=1)
    cocotb.start_soon(run_quarters(dut))
    short = round(max(T15_CHARACTERS * fmt.length * 4 * QUARTER, T15_CLOCKS))
    for _ in range(6):
        dut.busy_i.value = 1
        await clocks(dut, 20)
        dut.busy_i.value = 0
        for _ in range(short):
            await clocks(dut)
            assert not int(dut.t15_o.value) and not int(dut.t35_o.value)


@cocotb.test()
async def silence_lasts_until_a_character(dut):
    fmt = FORMAT_BY_NAME["8N1"]
    await start(dut, format=fmt.code, busy=1)
    cocotb.start_soon(run_quarters(dut))
    await measured(dut, 4 * fmt.length * 4 * QUARTER + 4 * T35_CLOCKS)
    for _ in range(3 * 256 * QUARTER):
        await clocks(dut)
        await settle()
        assert int(dut.t35_o.value) and int(dut.t15_o.value), "a counter has wrapped"
