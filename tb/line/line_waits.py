# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Waits of modbus_line_timer: bit times to the bit, N-1, N, N+1; characters do not disturb them."""

import cocotb
from harness.unit import clocks, settle, start, strobe

BIT = 9  # clocks
LATE = 3  # clocks from the end of the last bit to the output


async def begin(dut, limit, **inputs):
    """Begin a wait of whole bits; the next clock is the first."""
    await start(dut, bit_time=BIT, wait_clear=1, **inputs)
    dut.wait_limit_i.value = limit
    await clocks(dut, 5)
    await strobe(dut, wait_stb=1)
    dut.wait_clear_i.value = 0


async def measured(dut, most):
    """Clocks until the limit is reached."""
    for clock in range(1, most):
        await clocks(dut)
        await settle()
        if int(dut.wait_over_o.value):
            return clock
    return None


@cocotb.test()
@cocotb.parametrize(limit=[0, 1, 2, 7, 15, 16, 300])
async def wait_is_over_after_exactly_so_many_bits(dut, limit):
    await begin(dut, limit)
    clock = await measured(dut, (limit + 2) * BIT)
    assert clock is not None and limit * BIT <= clock <= limit * BIT + LATE, f"{clock} clocks, {limit} bits"
    await clocks(dut, 5 * BIT)
    await settle()
    assert int(dut.wait_over_o.value) == 1, "the output does not last"
    await strobe(dut, wait_clear=1)
    await settle()
    assert int(dut.wait_over_o.value) == 0
    if limit:
        clock = await measured(dut, (limit + 2) * BIT)
        assert (limit - 1) * BIT <= clock <= limit * BIT + LATE, "the count was not cleared"


@cocotb.test()
@cocotb.parametrize(limit=[0, 3, 15])
async def short_wait_ignores_the_upper_bits(dut, limit):
    await begin(dut, 0xABC0 | limit, wait_short=1)
    clock = await measured(dut, 40 * BIT)
    assert clock is not None and limit * BIT <= clock <= limit * BIT + LATE


@cocotb.test()
async def characters_do_not_stop_a_wait(dut):
    """Nor do they stretch it: the master talks while the answer waits."""
    rng = await start(dut)
    for _ in range(8):
        await begin(dut, 60)
        clock, late = 0, None
        while late is None and clock < 80 * BIT:
            dut.receiving_i.value = rng.getrandbits(1)
            for _ in range(rng.randrange(1, 30)):
                await clocks(dut)
                await settle()
                clock += 1
                if late is None and int(dut.wait_over_o.value):
                    late = clock
        assert late is not None and 60 * BIT <= late <= 60 * BIT + LATE, f"{late} clocks"
        dut.receiving_i.value = 0


@cocotb.test()
async def longest_limit(dut):
    await start(dut, bit_time=8, wait_clear=1, wait_limit=65535)
    await strobe(dut, wait_stb=1)
    dut.wait_clear_i.value = 0
    await clocks(dut, 65534 * 8 + 4)
    assert int(dut.wait_over_o.value) == 0
    await clocks(dut, 8)
    assert int(dut.wait_over_o.value) == 1
    await clocks(dut, 30)
    assert int(dut.wait_over_o.value) == 1, "the counter has wrapped"
