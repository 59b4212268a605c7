# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_wait: bit times to the bit, N-1, N, N+1."""

import cocotb
from harness.unit import clocks, settle, start, strobe


async def bits(dut, count):
    """So many bit strobes, a few clocks apart."""
    for _ in range(count):
        await strobe(dut, bit_stb=1)
        await clocks(dut, 2)
    await settle()


@cocotb.test()
@cocotb.parametrize(limit=[0, 1, 2, 7, 300])
async def over_after_exactly_so_many_bits(dut, limit):
    await start(dut, limit=limit, clear=1)
    await clocks(dut, 2)
    dut.clear_i.value = 0
    await clocks(dut, 1)
    await bits(dut, max(0, limit - 1))
    assert int(dut.over_o.value) == int(limit == 0), f"over after {limit - 1} of {limit}"
    await bits(dut, 1)
    assert int(dut.over_o.value) == 1
    await bits(dut, 5)
    assert int(dut.over_o.value) == 1, "over does not last"
    await strobe(dut, clear=1)
    await settle()
    assert int(dut.over_o.value) == 0
    await clocks(dut, 1)
    await settle()
    assert int(dut.over_o.value) == int(limit == 0)


@cocotb.test()
async def longest_limit(dut):
    async def strobes(count):
        """So many bit strobes as close as they may be."""
        for _ in range(count):
            dut.bit_stb_i.value = 1
            await clocks(dut, 1)
            dut.bit_stb_i.value = 0
            await clocks(dut, 1)
        await settle()

    await start(dut, limit=65535, clear=1)
    await clocks(dut, 1)
    dut.clear_i.value = 0
    await strobes(65534)
    assert int(dut.over_o.value) == 0
    await strobes(1)
    assert int(dut.over_o.value) == 1
    await strobes(3)
    assert int(dut.over_o.value) == 1, "the counter has wrapped"
