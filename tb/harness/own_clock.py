# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Makes cocotb's Clock one of main.cpp: the runner names this module before the tests of a model of Verilator.

A clock of another signal than clk_i of the top, or of another form than half high and half low, stays cocotb's.
"""

import ctypes

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import Event
from cocotb.utils import get_sim_steps

OWN = ctypes.CDLL(None).bench_clock
ANY_CLOCK = Clock.start


def start(self, start_high=True):
    """Like Clock.start."""
    plain = start_high and self._task is None and 2 * self.period_high == self.period and self.signal._name == "clk_i"
    if not plain or not OWN(ctypes.c_uint64(get_sim_steps(self.period, self.unit))):
        return ANY_CLOCK(self, start_high)

    async def until_stopped():
        try:
            await Event().wait()
        finally:
            OWN(ctypes.c_uint64(0))

    self._task = cocotb.start_soon(until_stopped())
    return self._task


Clock.start = start
