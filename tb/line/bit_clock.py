# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_bit_clock: exactly N clocks a bit, quarters rounded, restart at any clock."""

import cocotb
from harness.unit import clocks, settle, start, strobe


async def quarters(dut, count):
    """Lengths in clocks of the next `count` quarters, from the first clock of a bit on, and the bit strobes."""
    lengths, bits, length = [], [], 0
    while len(lengths) < count:
        await settle()
        length += 1
        if int(dut.quarter_stb_o.value):
            assert int(dut.quarter_o.value) == len(lengths) % 4, "a quarter has a wrong number"
            bits.append(int(dut.bit_stb_o.value))
            lengths.append(length)
            length = 0
        else:
            assert not int(dut.bit_stb_o.value)
        await clocks(dut)
    return lengths, bits


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 9, 10, 11, 12, 13, 15, 16, 17, 31, 100, 434, 1023, 5208, 65535])
async def bit_lasts_exactly_so_many_clocks(dut, bit_time):
    await start(dut, bit_time=bit_time)
    await strobe(dut, restart=1)
    whole = 1 if bit_time > 1000 else 5
    lengths, bits = await quarters(dut, 4 * whole)
    for number in range(whole):
        its = lengths[4 * number : 4 * number + 4]
        assert sum(its) == bit_time, f"quarters of {its} clocks"
        assert min(its) == its[0] == bit_time // 4 and max(its) <= bit_time // 4 + 1, f"quarters of {its} clocks"
    assert bits == [0, 0, 0, 1] * whole, "the bit strobe comes with the last quarter alone"


@cocotb.test()
async def restart_makes_the_next_clock_the_first(dut):
    """At every clock of a bit; held, it keeps the bit from beginning."""
    await start(dut, bit_time=11)
    for clock in range(24):
        await strobe(dut, restart=1)
        await clocks(dut, clock)
        dut.restart_i.value = 1
        await clocks(dut, 1 + clock % 3)
        dut.restart_i.value = 0
        assert await quarters(dut, 4) == ([2, 3, 3, 3], [0, 0, 0, 1]), f"restarted at clock {clock}"


@cocotb.test()
async def illegal_bit_times_do_not_lock_up(dut):
    for bit_time in range(8):
        await start(dut, bit_time=bit_time)
        seen = 0
        for _ in range(80):
            await settle()
            seen += int(dut.bit_stb_o.value)
            await clocks(dut)
        assert seen >= 4, f"{bit_time} clocks a bit: {seen} bits in 80 clocks"


@cocotb.test()
async def bit_time_may_change_at_any_clock(dut):
    rng = await start(dut, bit_time=8)
    for _ in range(40):
        dut.bit_time_i.value = rng.choice((8, 9, 17, 100, 500))
        await clocks(dut, rng.randrange(1, 300))
    dut.bit_time_i.value = 8
    seen = 0
    for _ in range(700):
        await settle()
        seen += int(dut.bit_stb_o.value)
        await clocks(dut)
    assert seen > 15, "a count of the old bit time has not ended"
