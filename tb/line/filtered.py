# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_line with GLITCH_FILTER = 3 and BIT_FRACTIONS = 1: frames at fractional bit times, spikes at every place."""

import cocotb
from harness.unit import CLOCK_PS
from protocol import frames

from .line import ANSWER, QUIET, REQUEST, Room, kinds

FILTER = 3  # clocks


@cocotb.test()
@cocotb.parametrize(bit_time=[13, 16], fraction=[0, 5, 12, 15])
async def request_and_answer_at_a_fractional_bit_time(dut, bit_time, fraction):
    """The sender keeps the exact rate; the answer is decoded at the exact rate."""
    room = await Room.start(dut, bit_time=bit_time, bit_fraction=fraction)
    for _ in range(2):
        await room.send(REQUEST)
        await room.silence()
        assert kinds(room.take()) == ["good"], f"{room.events}"
        await room.answer()
        await room.until_sent()
        grid = [(time - room.edges[0][0]) / room.bit for time, _ in room.edges]
        off = max(abs(place - round(place)) for place in grid) * room.bit / CLOCK_PS
        assert off <= 0.51 * (1 + (fraction != 0)), f"an edge is {off:.2f} clocks off"
        length = (len(ANSWER) + 2) * room.fmt.length
        assert length - 3 <= grid[-1] <= length, f"the answer has {grid[-1]:.2f} bits"


@cocotb.test()
@cocotb.parametrize(offset=[-0.02, 0, 0.02])
async def filtered_spikes_are_harmless_at_every_place(dut, offset):
    """Also across the first sample of a start bit, and with a sender that is off as well."""
    room = await Room.start(dut, bit_time=16)
    short = frames.sealed(bytes([17, 3]))
    room.bit = round(16 * CLOCK_PS * (1 + offset))
    for place in range(0, 46 * 16, 5):
        await room.send(short, spikes=[(place * CLOCK_PS, (FILTER - 0.1) * CLOCK_PS)])
        await room.silence()
        assert kinds(room.take()) == ["good"], f"spike at clock {place}: {room.events}"
        await room.verdict(QUIET)
