# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Frame receiver: the state machine of V1.02 figure 14 and its verdicts, without a line."""

import cocotb
from harness.steps import NUMBERS
from harness.unit import clocks, settle, start, strobe, watch
from protocol.defs import ERRORS

T15, T35 = 5, 12  # clocks of silence in this bench
VERDICT = 6  # clocks, at least: cursor to the first byte, look at it, decide whose it is


class Receiver:
    """The module with a counting RAM and a line timer around it."""

    @classmethod
    async def start(cls, dut, silence=True, **inputs):
        self = cls()
        self.dut = dut
        usual = {"crc_zero": 1, "t15": 1, "address": 17, "byte": 17, "half": 1, "whole": 1}
        self.rng = await start(dut, **usual | inputs)
        self.count, self.stored = 0, 0
        self.seen = {error: watch(dut, "events", bit=NUMBERS[f"EVENT_{error.upper()}"]) for error in ERRORS}
        self.seen["good_stb"] = watch(dut, "good_stb")
        cocotb.start_soon(self._ram())
        if silence:
            await self.gap(T35)
        return self

    async def _ram(self):
        while True:
            await clocks(self.dut)
            if int(self.dut.open_stb_o.value):
                self.count = self.stored = 0
            elif int(self.dut.store_stb_o.value):
                self.count = min(self.count + 1, 511)
                self.stored += 1
            self.dut.count_i.value = self.count

    async def character(self, **errors):
        """One character: start, then the end with its errors."""
        await strobe(self.dut, start_stb=1)
        self.dut.t15_i.value = self.dut.t35_i.value = 0
        await clocks(self.dut, 3)
        await strobe(self.dut, char_stb=1, **{f"{e}_error": 1 for e, on in errors.items() if on})
        await clocks(self.dut, 2)

    async def gap(self, silence):
        """Silence of so many clocks, seen by the timer."""
        for clock in range(silence):
            await clocks(self.dut)
            self.dut.t15_i.value = int(clock + 1 >= T15)
            self.dut.t35_i.value = int(clock + 1 >= T35)
        await clocks(self.dut, VERDICT)

    async def frame(self, length, crc_zero=1, gap_at=None, parity_at=None, framing_at=None):
        """A whole frame and its verdict: the set of strobes that rose."""
        for seen in self.seen.values():
            seen.clear()
        self.dut.crc_zero_i.value = crc_zero
        for place in range(length):
            if place and place == gap_at:
                await self.gap(T15 + 2)
            await self.character(parity=place == parity_at, framing=place == framing_at)
        await self.gap(T35)
        await settle()
        assert all(len(seen) <= 1 for seen in self.seen.values()), "a strobe rose twice"
        return {name for name, seen in self.seen.items() if seen}

    async def done(self, answered=0):
        """The frame was dealt with: nothing to send, or an answer that goes out."""
        if not answered:
            await strobe(self.dut, quiet=1)
        else:
            await self.send()
            await clocks(self.dut, 20)
            await strobe(self.dut, sent=1)
            self.dut.sending_i.value = 0
        await clocks(self.dut, 2)

    async def send(self):
        """The engine has an answer: whether it may go out."""
        self.dut.send_i.value = 1
        await settle()
        goes = int(self.dut.send_stb_o.value)
        await clocks(self.dut)
        self.dut.send_i.value = 0
        self.dut.sending_i.value = goes
        return goes


GOOD = {"good_stb"}


@cocotb.test()
async def length_limits(dut):
    """3 is too short, 4 and 256 are frames, 257 is too long; nothing beyond 256 is stored."""
    rx = await Receiver.start(dut)
    for length, verdict in (
        (1, {"short"}),
        (3, {"short"}),
        (4, GOOD),
        (255, GOOD),
        (256, GOOD),
        (257, {"long"}),
        (300, {"long"}),
    ):
        seen = await rx.frame(length)
        assert seen - {"overrun"} == verdict, f"{length} characters: {seen}"
        assert rx.stored <= 256, f"{rx.stored} of {length} characters stored"
        if verdict == GOOD:
            assert rx.stored == length
            await rx.done()
            await rx.gap(T35)


@cocotb.test()
async def crc_is_blamed_only_alone(dut):
    rx = await Receiver.start(dut)
    assert await rx.frame(8, crc_zero=0) == {"crc"}
    assert await rx.frame(3, crc_zero=0) == {"short"}
    assert await rx.frame(8, crc_zero=0, parity_at=2) == {"parity"}
    assert await rx.frame(8, crc_zero=0, framing_at=7) == {"framing"}
    assert await rx.frame(8, crc_zero=0, gap_at=4) - {"short"} == {"gap"}
    assert await rx.frame(8) == GOOD


@cocotb.test()
async def every_error_in_every_place(dut):
    rx = await Receiver.start(dut)
    for place in range(6):
        assert await rx.frame(6, parity_at=place) == {"parity"}
        assert await rx.frame(6, framing_at=place) == {"framing"}
        if place:
            assert (await rx.frame(6, gap_at=place)) - {"short"} == {"gap"}
    assert await rx.frame(6, parity_at=1, framing_at=4) == {"parity", "framing"}
    assert await rx.frame(6) == GOOD, "a flag outlived its frame"


@cocotb.test()
async def gap_can_be_only_counted(dut):
    rx = await Receiver.start(dut, gap_count_only=1)
    assert await rx.frame(6, gap_at=3) == {"gap", "good_stb"}
    assert rx.stored == 6
    await rx.done()
    await rx.gap(T35)
    assert await rx.frame(6, gap_at=3, crc_zero=0) - {"crc"} == {"gap"}


@cocotb.test()
async def after_reset_silence_comes_first(dut):
    rx = await Receiver.start(dut, silence=False)
    assert await rx.frame(8) == set(), "characters before the first t3.5 are no frame"
    assert await rx.frame(8) == GOOD


@cocotb.test()
@cocotb.parametrize(strict=[0, 1])
async def behind_an_answer(dut, strict):
    """The next request may follow at once, or with strict turnaround after t3.5."""
    rx = await Receiver.start(dut, strict=strict)
    assert await rx.frame(8) == GOOD
    dut.t15_i.value = dut.t35_i.value = 0  # we were driving
    await rx.done(answered=1)
    seen = await rx.frame(8)
    assert seen == (set() if strict else GOOD), seen
    if not strict:
        await rx.done(answered=1)
    await rx.gap(T35)
    assert await rx.frame(8) == GOOD


@cocotb.test()
async def characters_during_the_work_are_ignored(dut):
    """Without an answer the line must then be silent for t3.5 before the next frame."""
    rx = await Receiver.start(dut)
    assert await rx.frame(8) == GOOD
    for _ in range(5):
        await rx.character()
    assert rx.count == 8, "a character during the work was stored"
    await rx.done()
    rx.seen["good_stb"].clear()
    await rx.character()
    await rx.gap(T35)
    assert not rx.seen["good_stb"], "the rest of something was taken for a frame"
    assert await rx.frame(8) == GOOD


@cocotb.test()
async def answer_goes_out_only_in_the_work(dut):
    rx = await Receiver.start(dut)
    assert not await rx.send(), "an answer to nothing"
    await rx.character()
    assert not await rx.send(), "an answer inside a frame"
    assert await rx.frame(7) == GOOD
    assert await rx.send()
    assert not await rx.send(), "a second answer"


@cocotb.test()
async def nothing_ends_the_work_while_an_answer_is_on_its_way(dut):
    """Neither quiet nor restart; a frame heard meanwhile is not received."""
    rx = await Receiver.start(dut)
    assert await rx.frame(8) == GOOD
    dut.sending_i.value = await rx.send()
    for word in ("quiet", "restart"):
        await strobe(dut, **{word: 1})
        await rx.gap(T35)
        assert int(dut.idle_o.value) == 0
        await rx.character()
        assert int(dut.active_o.value) == 0, f"receives after {word} while the answer goes out"
    await strobe(dut, sent=1)
    dut.sending_i.value = 0
    await rx.gap(T35)
    assert int(dut.idle_o.value) == 1
    assert await rx.frame(8) == GOOD


@cocotb.test()
@cocotb.parametrize(drop=[0, 1])
async def late_answer_may_be_dropped(dut, drop):
    """Then only t3.5 of silence makes the next frame heard."""
    rx = await Receiver.start(dut, drop_late=drop)
    assert await rx.frame(8) == GOOD
    assert int(dut.drop_o.value) == 0
    dut.t15_i.value = dut.t35_i.value = 0
    await rx.character()
    assert int(dut.drop_o.value) == drop
    assert await rx.send()
    if drop:
        rx.seen["overrun"].clear()
        await strobe(dut, dropped=1)
        dut.sending_i.value = 0
        await clocks(dut, 2)
        assert len(rx.seen["overrun"]) == 1
        assert int(dut.drop_o.value) == 0, "outlives its frame"
        assert await rx.frame(8) == set(), "heard before t3.5"
        assert await rx.frame(8) == GOOD


@cocotb.test()
async def activity_is_shown(dut):
    rx = await Receiver.start(dut)
    assert int(dut.active_o.value) == 0
    await rx.character()
    assert int(dut.active_o.value) == 1
    await rx.gap(T35)
    await settle()
    assert int(dut.active_o.value) == 0


@cocotb.test()
async def reset_in_every_state(dut):
    rx = await Receiver.start(dut)
    for state in range(3):
        if state:
            await rx.character()
        if state == 2:
            for _ in range(4):
                await rx.character()
            await rx.gap(T35)
        await strobe(dut, rst=1)
        dut.t15_i.value = dut.t35_i.value = 0
        assert await rx.frame(8) == set(), "heard before t3.5"
        assert await rx.frame(8) == GOOD
        await rx.done()
        await rx.gap(T35)
