# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Clock, reset and strobe watching for tests that count clock cycles."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge, Timer

CLOCK_PS = 20_000


async def start(dut, **inputs):
    """Set every input (default 0), start the clock, reset for three clocks if there is a reset."""
    for handle in dut:
        if handle._name.endswith("_i") and handle._name != "clk_i":
            handle.value = inputs.get(handle._name.removesuffix("_i"), 0)
    Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
    if hasattr(dut, "rst_i"):
        dut.rst_i.value = 1
        await clocks(dut, 3)
        dut.rst_i.value = 0
    await clocks(dut, 1)
    return random.Random(1)


async def clocks(dut, count=1):
    """Wait for clock edges; returns just after the last. `start`'s clock does not pause: many are one wait."""
    if count > 2:
        await RisingEdge(dut.clk_i)
        await Timer((count - 2) * CLOCK_PS + CLOCK_PS // 2, "ps")
        count = 1
    for _ in range(count):
        await RisingEdge(dut.clk_i)


async def settle():
    """Let the outputs follow the inputs within this clock."""
    await Timer(1, "ns")


async def strobe(dut, **inputs):
    """Drive inputs for one clock, then 0."""
    for name, value in inputs.items():
        getattr(dut, f"{name}_i").value = value
    await clocks(dut)
    for name in inputs:
        getattr(dut, f"{name}_i").value = 0


def watch(dut, name, values=(), bit=0):
    """A list that gets a tuple of `values` each clock in which strobe `name`_o, or this bit of it, is high."""
    seen = []
    it, others = getattr(dut, f"{name}_o"), [getattr(dut, f"{v}_o") for v in values]

    async def task():
        while True:
            if not int(it.value) >> bit & 1:
                await it.value_change
            await RisingEdge(dut.clk_i)
            if int(it.value) >> bit & 1:
                seen.append(tuple(int(other.value) for other in others))

    cocotb.start_soon(task())
    return seen


async def quiet_point():
    """The end of this time step, for reading only."""
    await ReadOnly()
