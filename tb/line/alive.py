# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_alive: rises with a frame, falls within the last millisecond of the time-out, holds on."""

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, settle, start, strobe

MS = PARAMETERS["CLK_HZ"] // 1000
TIMEOUT = PARAMETERS["TIMEOUT_MS"]


async def alive(dut):
    await settle()
    return int(dut.alive_o.value)


@cocotb.test()
async def falls_when_its_time_is_over(dut):
    rng = await start(dut)
    assert await alive(dut) == 0
    for _ in range(8):
        await clocks(dut, rng.randrange(2 * MS))
        await strobe(dut, frame_stb=1)
        assert await alive(dut) == 1
        if not TIMEOUT:
            await clocks(dut, 50 * MS)
            assert await alive(dut) == 1
            continue
        clock = 0
        while clock < (TIMEOUT + 2) * MS and await alive(dut):
            await clocks(dut)
            clock += 1
        assert (TIMEOUT - 1) * MS - 2 <= clock <= TIMEOUT * MS + 2, f"fell after {clock} clocks of {TIMEOUT * MS}"


@cocotb.test()
async def frames_keep_it_up(dut):
    await start(dut)
    await strobe(dut, frame_stb=1)
    for _ in range(12):
        await clocks(dut, max(1, (TIMEOUT - 1) * MS - 4))
        assert await alive(dut) == 1
        await strobe(dut, frame_stb=1)
    await strobe(dut, rst=1)
    assert await alive(dut) == 0
    await clocks(dut, (TIMEOUT + 2) * MS)
    assert await alive(dut) == 0
