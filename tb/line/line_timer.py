# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Silences of modbus_line_timer: t1.5 and t3.5 of each format to the half bit, the floors to the clock.

Silence counts from the end of the last stop bit; the receiver falls idle at the middle of the first.
"""

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, settle, start, strobe
from protocol.defs import FORMAT_BY_NAME, T15_CHARACTERS, T35_CHARACTERS

BIT = 8  # clocks
T15_CLOCKS, T35_CLOCKS = PARAMETERS.get("T15_CLOCKS", 37500), PARAMETERS.get("T35_CLOCKS", 87500)
SLACK = 5  # clocks between the exact end and the verdict, never before it


async def begin(dut, fmt, **inputs):
    await start(dut, format=fmt.code, bit_time=BIT, wait_clear=1, **inputs)
    await clocks(dut, 13)


async def measured(dut, most):
    """Clocks from here to t15 and t35."""
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


def check(fmt, seen, rest):
    for name, got, factor, floor in (
        ("t1.5", seen[0], T15_CHARACTERS, T15_CLOCKS),
        ("t3.5", seen[1], T35_CHARACTERS, T35_CLOCKS),
    ):
        wanted = rest + max(factor * fmt.length * BIT, floor)
        assert got is not None and wanted <= got <= wanted + SLACK, f"{name}: {got} clocks, wanted {wanted}"


def most(fmt):
    return 4 * fmt.length * BIT + 4 * T35_CLOCKS + 100


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def silence_is_measured_from_the_last_stop_bit(dut, fmt):
    fmt = FORMAT_BY_NAME[fmt]
    await begin(dut, fmt, receiving=1)
    for _ in range(2):
        dut.receiving_i.value = 0
        check(fmt, await measured(dut, most(fmt)), BIT // 2 + (fmt.stops - 1) * BIT)
        dut.receiving_i.value = 1
        await clocks(dut, 2)
        await settle()
        assert not int(dut.t35_o.value), "t3.5 outlives the next character"
        await clocks(dut, 11)


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), cause=["rst", "restart", "sending"])
async def where_no_character_came_nothing_is_counted_off(dut, fmt, cause):
    """Reset, a restart of silence and our own last stop bit: silence begins there and then."""
    fmt = FORMAT_BY_NAME[fmt]
    await begin(dut, fmt)
    for phase in (0, 3, 7):
        await clocks(dut, 40 + phase)
        handle = getattr(dut, f"{cause}_i")
        handle.value = 1
        await clocks(dut, 1 if cause == "restart" else 20)
        handle.value = 0
        check(fmt, await measured(dut, most(fmt)), 0)


@cocotb.test()
async def gaps_do_not_add_up(dut):
    """A character begins the count anew, however often."""
    fmt = FORMAT_BY_NAME["8E1"]
    await begin(dut, fmt, receiving=1)
    short = round(max(T15_CHARACTERS * fmt.length * BIT, T15_CLOCKS))
    for _ in range(6):
        dut.receiving_i.value = 1
        await clocks(dut, 20)
        dut.receiving_i.value = 0
        for _ in range(short):
            await clocks(dut)
            assert not int(dut.t15_o.value) and not int(dut.t35_o.value)


@cocotb.test()
async def silence_lasts_until_a_character(dut):
    fmt = FORMAT_BY_NAME["8N1"]
    await begin(dut, fmt, receiving=1)
    dut.receiving_i.value = 0
    await measured(dut, most(fmt))
    for _ in range(3 * 256 * BIT // 2):
        await clocks(dut)
        await settle()
        assert int(dut.t35_o.value) and int(dut.t15_o.value), "a counter has wrapped"


@cocotb.test()
async def driving_is_no_silence(dut):
    """Not in the clock in which it begins, and not while it lasts."""
    fmt = FORMAT_BY_NAME["8E1"]
    await begin(dut, fmt)
    await measured(dut, most(fmt))
    await clocks(dut)
    dut.sending_i.value = 1
    for _ in range(3 * most(fmt) // 2):
        await settle()
        assert not int(dut.t35_o.value)
        await clocks(dut)


@cocotb.test()
async def wait_does_not_disturb_the_silence(dut):
    """A bank's waits come and go at any clock."""
    fmt = FORMAT_BY_NAME["8N2"]
    await begin(dut, fmt, receiving=1)
    dut.wait_limit_i.value = 9

    async def bank():
        while True:
            await strobe(dut, wait_clear=1)
            await clocks(dut, 3)

    cocotb.start_soon(bank())
    dut.receiving_i.value = 0
    seen = await measured(dut, most(fmt))
    check(fmt, seen, BIT // 2 + BIT)
