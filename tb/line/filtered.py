# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_line with GLITCH_FILTER = 3 and BIT_FRACTIONS = 1: frames at fractional bit times, spikes at every place."""

import cocotb
from cocotb.triggers import FallingEdge
from harness import wave
from harness.unit import CLOCK_PS
from protocol import frames

from .line import ANSWER, QUIET, REQUEST, Room, kinds

FILTER = 3  # clocks
SHORT = frames.sealed(bytes([17, 0xA5]))


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
        await FallingEdge(dut.sending_o)
        grid = [(time - room.edges[0][0]) / room.bit for time, _ in room.edges]
        off = max(abs(place - round(place)) for place in grid) * room.bit / CLOCK_PS
        assert off <= (0.51 if fraction else 0.01), f"an edge is {off:.2f} clocks off"
        snapped = [(round(place), level) for place, (_, level) in zip(grid, room.edges, strict=True)]
        assert wave.decode(snapped, room.fmt, 1).data == frames.sealed(ANSWER)


@cocotb.test()
async def filtered_spikes_are_harmless_at_every_place(dut):
    room = await Room.start(dut, bit_time=16)
    for place in range(0, 46 * 16, 5):
        await room.send(SHORT, spikes=[(place * CLOCK_PS, (FILTER - 0.1) * CLOCK_PS)])
        await room.silence()
        assert kinds(room.take()) == ["good"], f"spike at clock {place}: {room.events[-3:]}"
        await room.verdict(QUIET)


@cocotb.test()
@cocotb.parametrize(offset=[-0.02, 0, 0.02])
async def spike_across_the_first_sample_of_a_start_bit_does_not_move_the_character(dut, offset):
    """The sender is off as well.  The start bit's edge has passed the filter before the spike begins."""
    room = await Room.start(dut, bit_time=32)
    room.bit = round(32 * CLOCK_PS * (1 + offset))
    for character in range(4):
        for place in range(FILTER + 2, 16):
            spike = (11 * character * room.bit + place * CLOCK_PS, (FILTER - 0.1) * CLOCK_PS)
            await room.send(SHORT, spikes=[spike])
            await room.silence()
            assert kinds(room.take()) == ["good"], f"character {character}, clock {place}: {room.events[-3:]}"
            await room.verdict(QUIET)
