# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_sync: idle from power-up, two clocks late, nothing lost."""

import cocotb
from cocotb.triggers import Timer
from harness.unit import clocks, settle, start


@cocotb.test()
async def idle_from_power_up(dut):
    dut.async_i.value = 1
    await Timer(1, "ns")
    assert int(dut.sync_o.value) == 1


@cocotb.test()
async def two_clocks_late(dut):
    rng = await start(dut, async_=1)
    dut.async_i.value = 1
    await clocks(dut, 4)
    history = [1, 1]
    for _ in range(100):
        level = rng.getrandbits(1)
        dut.async_i.value = level
        history.append(level)
        await clocks(dut)
        await settle()
        assert int(dut.sync_o.value) == history[-2]
