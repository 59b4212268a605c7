# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_auto_line alone: what it finds, what the core hears, when it lets go.  A tick is a clock of 1 MHz."""

from itertools import pairwise

import cocotb
from harness.line import now, record
from harness.unit import CLOCK_PS, clocks, settle, start
from harness.wave import encode
from protocol import frames
from protocol.defs import FORMATS

ADDRESS = 17
FRAME = frames.adu(ADDRESS, frames.read(3, 1, 2))
OTHER = frames.adu(5, frames.read(3, 1, 2))


class Line:
    """Drives rxd_i and records rxd_o."""

    def __init__(self, dut):
        self.dut, self.edges = dut, []
        self.forget()
        cocotb.start_soon(record(dut.rxd_o, self.edges))

    def forget(self):
        """`out` begins now."""
        self.edges[:] = [(now(), int(self.dut.rxd_o.value))]

    @property
    def out(self):
        """Levels of rxd_o, one a clock."""
        levels = []
        for (begin, level), (end, _) in pairwise([*self.edges, (now(), None)]):
            levels += [level] * round((end - begin) / CLOCK_PS)
        return levels

    async def clock(self, count=1):
        await clocks(self.dut, count)
        await settle()

    async def send(self, frame, bit, fmt, silence=40):
        """A frame with whole clocks a bit, and so many bits of silence."""
        wave, passed = encode(frame, fmt, bit), 0
        for time, level in wave.edges:
            await self.clock(time - passed)
            self.dut.rxd_i.value, passed = level, time
        await self.clock(wave.end - passed + silence * bit)

    async def work(self, count=6000):
        """Time to decode in every format."""
        await self.clock(count)

    def found(self):
        dut = self.dut
        return int(dut.locked_o.value), int(dut.bit_time_o.value), int(dut.format_o.value)


async def begin(dut, **inputs):
    await start(dut, rxd=1, idle=1, snap=1, address=ADDRESS, **inputs)
    line = Line(dut)
    await line.clock(50)
    line.forget()
    return line


def runs(levels):
    """Lengths of the runs of equal levels."""
    out = []
    for place, level in enumerate(levels):
        if place and level == levels[place - 1]:
            out[-1] += 1
        else:
            out.append(1)
    return out


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMATS), bit=[52, 104])
async def frame_is_found_and_played_as_it_was(dut, fmt, bit):
    line = await begin(dut)
    await line.send(FRAME, bit, fmt, 12)
    assert set(line.out) == {1}, "the core hears what it cannot understand"
    await line.work(6000 + 140 * bit)
    assert line.found() == (1, bit, fmt.code)
    wave = encode(FRAME, fmt, bit)
    sent = [b[0] - a[0] for a, b in zip(wave.edges, wave.edges[1:], strict=False)]
    heard = runs(line.out)[1:-1]
    assert len(heard) == len(sent)
    assert all(abs(a - b) <= 2 for a, b in zip(heard, sent, strict=True)), f"{heard} for {sent}"


@cocotb.test()
async def frame_for_another_is_not_played(dut):
    line = await begin(dut)
    await line.send(OTHER, 52, FORMATS[0])
    await line.work(20000)
    assert line.found() == (1, 52, 0)
    assert set(line.out) == {1}
    line.forget()
    dut.idle_i.value = 0  # the core receives it
    await line.send(FRAME, 52, FORMATS[0], 1)
    assert runs(line.out)[1:-1] == runs([1, *line.out])[1:-1] and 0 in line.out, "locked, but the core hears nothing"


@cocotb.test()
async def mask_opens_a_block_of_addresses(dut):
    line = await begin(dut, mask=0x03)
    await line.send(frames.adu(ADDRESS ^ 2, frames.read(3, 1, 2)), 52, FORMATS[0])
    await line.work(20000)
    assert 0 in line.out


@cocotb.test()
@cocotb.parametrize(offset=[-3, -1, 0, 1, 3], snap=[0, 1])
async def rate_within_two_percent_is_drawn_to_the_standard_one(dut, offset, snap):
    line = await begin(dut)
    dut.snap_i.value = snap
    await line.send(OTHER, 104 + offset, FORMATS[0])
    await line.work()
    drawn = snap and abs(offset) <= 2
    assert line.found() == (1, 104 if drawn else 104 + offset, 0)


@cocotb.test()
async def settings_change_only_while_the_core_rests(dut):
    line = await begin(dut)
    dut.idle_i.value = 0
    before = line.found()
    await line.send(OTHER, 52, FORMATS[0])
    await line.work()
    assert line.found() == before
    dut.idle_i.value = 1
    await line.work()
    assert line.found() == (1, 52, 0)


@cocotb.test()
async def frame_that_the_core_does_not_call_good_ends_the_lock(dut):
    line = await begin(dut)
    await line.send(OTHER, 52, FORMATS[0])
    await line.work()
    dut.idle_i.value = 0
    await line.send(OTHER, 52, FORMATS[0])
    dut.frame_stb_i.value = 1
    await line.clock()
    dut.frame_stb_i.value, dut.idle_i.value = 0, 1
    await line.work()
    assert line.found() == (1, 52, 0)
    await line.send(frames.bad_crc(OTHER), 52, FORMATS[0])
    await line.work()
    assert not line.found()[0]
    await line.send(OTHER, 104, FORMATS[3])
    await line.work()
    assert line.found() == (1, 104, 3)


@cocotb.test()
async def new_rate_is_found_in_the_frame_that_ends_the_lock(dut):
    line = await begin(dut)
    await line.send(OTHER, 52, FORMATS[0])
    await line.work()
    await line.send(OTHER, 104, FORMATS[1])
    await line.work(12000)
    assert line.found() == (1, 104, 1)


@cocotb.test()
async def spikes_and_short_frames_do_not_end_the_lock(dut):
    line = await begin(dut)
    await line.send(OTHER, 52, FORMATS[0])
    await line.work()
    for width in (1, 2, 3, 4, 20, 52):
        dut.rxd_i.value = 0
        await line.clock(width)
        dut.rxd_i.value = 1
        await line.work()
    assert line.found() == (1, 52, 0)


@cocotb.test()
async def wrong_frames_do_not_lock(dut):
    line = await begin(dut)
    for frame in (frames.bad_crc(OTHER), OTHER[:-1], frames.sealed(b"\x05"), frames.sealed(b"")):
        await line.send(frame, 52, FORMATS[0])
        await line.work(10000)
        assert not line.found()[0], frames.text(frame)


@cocotb.test()
async def formats_that_both_fit_take_turns(dut):
    """All bytes have an odd parity: the same in 8E1 and 8N2. Behind a reset 8E1 comes first."""
    line = await begin(dut)
    frame = next(
        f
        for f in (frames.adu(1, bytes([7, n, m])) for n in range(256) for m in range(256))
        if all(bin(byte).count("1") & 1 for byte in f)
    )
    for begun in range(2):
        taken = []
        for _ in range(3):
            await line.send(frame, 52, FORMATS[0])
            await line.work()
            taken.append(line.found())
        assert taken == [(0, 52, 0), (0, 52, 2), (0, 52, 0)], f"{begun}: {taken}"
        dut.rst_i.value = 1
        await line.clock(2)
        dut.rst_i.value = 0
        await line.clock(50)
    await line.send(OTHER, 52, FORMATS[2])
    await line.work()
    assert line.found() == (1, 52, 2)


@cocotb.test()
async def frame_with_more_runs_than_words_is_left_alone(dut):
    line = await begin(dut)
    await line.send(frames.adu(5, bytes([3]) + b"\x55" * 30), 52, FORMATS[0])
    await line.work(30000)
    assert not line.found()[0]
    await line.send(OTHER, 52, FORMATS[0])
    await line.work()
    assert line.found() == (1, 52, 0)


@cocotb.test()
async def own_answer_is_not_recorded(dut):
    line = await begin(dut)
    dut.de_i.value = 1
    await line.send(FRAME, 52, FORMATS[0])
    dut.de_i.value = 0
    await line.work(30000)
    assert not line.found()[0] and set(line.out) == {1}


@cocotb.test()
async def driving_ends_what_is_played(dut):
    """The core answers something else: it must not hear the rest of a frame that it did not get from the line."""
    line = await begin(dut)
    await line.send(FRAME, 52, FORMATS[0], 12)
    for _ in range(100):
        await line.clock(100)
        if 0 in line.out:
            break
    assert 0 in line.out, "not played"
    dut.de_i.value = 1
    await line.clock(5)
    dut.de_i.value = 0
    line.forget()
    await line.clock(20000)
    assert set(line.out) == {1}, "played on"


@cocotb.test()
async def reset_and_break_end_the_lock(dut):
    line = await begin(dut)
    for end in ("reset", "break"):
        await line.send(OTHER, 52, FORMATS[0])
        await line.work()
        assert line.found()[0]
        dut.rst_i.value, dut.rxd_i.value = int(end == "reset"), int(end != "break")
        await line.clock(66000 if end == "break" else 1)
        dut.rst_i.value, dut.rxd_i.value = 0, 1
        await line.clock(70)
        assert not line.found()[0], end
        await line.work(70000)
