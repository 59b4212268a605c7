# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The clock of a simulation: that of main.cpp, where this is the simulator's program, else cocotb's."""

import ctypes

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import Event
from cocotb.utils import get_sim_steps


def start(clk_i, period_ps):
    """Start `clk_i` of the top with a rising edge now; the end of the test stops it."""
    own = getattr(ctypes.CDLL(None), "bench_clock", None)
    if own is None or not own(ctypes.c_uint64(get_sim_steps(period_ps, "ps"))):
        Clock(clk_i, period_ps, "ps", impl="gpi").start()
        return

    async def until_the_end():
        try:
            await Event().wait()
        finally:
            own(ctypes.c_uint64(0))

    cocotb.start_soon(until_the_end())
