# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_line_health alone: what it counts, the largest gap of a good frame, the master's bit time in permille."""

import cocotb
from cocotb.triggers import Timer
from harness.unit import CLOCK_PS, settle, start, strobe
from harness.wave import encode
from protocol import frames
from protocol.defs import FORMATS

BIT = 100  # clocks
FRAME, PARITY, FRAMING, CRC, GAP = 0, 1, 2, 4, 7  # bits of events_i
SPIKES, PARITIES, FRAMINGS, CRCS, GAPS, BREAKS, LARGEST, PERMILLE, HUNDREDS = range(9)


async def clocks(dut, count):
    """So many clocks, by time: a simulation without a wake-up for each."""
    if count:
        await Timer(count * CLOCK_PS, "ps")


async def begin(dut, fmt=FORMATS[0]):
    rng = await start(dut, rxd=1, bit_time=BIT, format=fmt.code)
    await clocks(dut, 20)
    return rng


async def health(dut):
    await settle()
    value = int(dut.health_o.value)
    return [value >> 16 * n & 0xFFFF for n in range(9)]


async def send(dut, line, fmt=FORMATS[0], event=FRAME, offset=0.0):
    """Characters at the pin, silence, then the core's verdict."""
    wave, now = encode(line, fmt, BIT, offset), 0
    for time, level in wave.edges:
        await clocks(dut, time - now)
        dut.rxd_i.value, now = level, time
    await clocks(dut, wave.end - now + 40 * BIT)
    if event is not None:
        await strobe(dut, events=1 << event)
        dut.events_i.value = 0
    await clocks(dut, 5)


def any_frame(rng, count=24):
    return frames.sealed(rng.randbytes(count))


@cocotb.test()
async def events_are_counted(dut):
    rng = await begin(dut)
    for times, (event, place) in enumerate(((PARITY, PARITIES), (FRAMING, FRAMINGS), (CRC, CRCS), (GAP, GAPS)), 1):
        for _ in range(times):
            await send(dut, any_frame(rng, 2), event=event)
        assert (await health(dut))[place] == times
    assert (await health(dut))[PARITIES : BREAKS + 1] == [1, 2, 3, 4, 0]
    await strobe(dut, clear=1)
    assert await health(dut) == [0] * 9


@cocotb.test()
async def only_runs_below_a_quarter_of_a_bit_are_spikes(dut):
    await begin(dut)
    for width, more in ((1, 1), (24, 1), (25, 0), (60, 0)):
        before = (await health(dut))[SPIKES]
        dut.rxd_i.value = 0
        await clocks(dut, width)
        dut.rxd_i.value = 1
        await clocks(dut, 20 * BIT)
        assert (await health(dut))[SPIKES] == before + more, f"{width} clocks"


@cocotb.test()
async def a_break_is_counted_once(dut):
    await begin(dut)
    for width, total in ((11 * BIT, 0), (13 * BIT, 1), (50 * BIT, 2)):
        dut.rxd_i.value = 0
        await clocks(dut, width)
        dut.rxd_i.value = 1
        await clocks(dut, 20 * BIT)
        assert (await health(dut))[BREAKS] == total


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMATS))
async def largest_gap_of_good_frames_is_kept(dut, fmt):
    rng = await begin(dut, fmt)
    for gap, event, largest in ((0, FRAME, 0), (0.5, FRAME, 0.5), (0.3, FRAME, 0.5), (1.4, CRC, 0.5), (1.2, FRAME, 1.2)):
        data = any_frame(rng, 4)
        line = [(byte, gap if place == 2 else 0.0, None) for place, byte in enumerate(data)]
        await send(dut, line, fmt, event)
        quarters = (await health(dut))[LARGEST]
        assert abs(quarters - largest * fmt.length * 4) <= 2, f"{quarters / 4} bits for {largest * fmt.length}"


@cocotb.test()
@cocotb.parametrize(offset=[-0.03, -0.01, 0, 0.005, 0.03], fmt=[FORMATS[0], FORMATS[3]])
async def bit_time_of_the_master_in_permille(dut, offset, fmt):
    rng = await begin(dut, fmt)
    for _ in range(6):
        await send(dut, any_frame(rng), fmt, offset=offset)
    found = await health(dut)
    permille = found[PERMILLE] - (found[PERMILLE] >> 15 << 16)
    assert found[HUNDREDS] >= 10 and found[HUNDREDS] % 10 == 0
    assert abs(permille - 1000 * offset) <= 3, f"{permille} for {1000 * offset}"
    assert found[:LARGEST] == [0] * LARGEST


@cocotb.test()
async def own_answers_are_not_measured(dut):
    rng = await begin(dut)
    dut.de_i.value = 1
    for _ in range(6):
        await send(dut, any_frame(rng), offset=0.03, event=None)
    assert await health(dut) == [0] * 9
