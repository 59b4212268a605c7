# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_line alone: frames from the pin to the engine's side, answers back, spikes, silences, late answers.

The bench is the engine: a frame RAM in Python and a verdict when the test wants one.
"""

import random

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer, with_timeout
from harness import wave
from harness.line import drive, now, record, wait_until
from harness.unit import CLOCK_PS, clocks, start, strobe
from protocol import frames
from protocol.defs import FORMAT_BY_NAME

OWN, OTHER = 17, 18
REQUEST = frames.adu(OWN, frames.read(3, 5, 1))
ANSWER = bytes([OWN, 3, 2, 0x12, 0x34])
SETTINGS = (  # name, width, default
    ("address", 8, OWN),
    ("bit_time", 16, 8),
    ("format", 2, 0),
    ("broadcast", 1, 1),
    ("gap_count_only", 1, 0),
    ("strict", 1, 0),
    ("drop_late", 1, 0),
    ("response_delay", 12, 0),
    ("stall_limit", 16, 0),
    ("de_lead", 4, 0),
    ("de_tail", 4, 0),
    ("bit_fraction", 4, 0),
)
EVENTS = ("frame", "parity", "framing", "overrun", "crc", "short", "long", "gap")
SEND, QUIET, RESTART = 1, 2, 4


def settings(**given):
    """The vector settings_i."""
    value = place = 0
    for name, width, default in SETTINGS:
        value |= given.pop(name, default) << place
        place += width
    assert not given, f"no such settings: {sorted(given)}"
    return value


class Room:
    """The module, the pins and the engine's side of it."""

    @classmethod
    async def start(cls, dut, fmt="8E1", bit_time=8, silent=True, **given):
        self = cls()
        self.dut, self.fmt = dut, FORMAT_BY_NAME[fmt]
        self.bit = round((bit_time + given.get("bit_fraction", 0) / 16) * CLOCK_PS)
        self.rng = random.Random(1)
        self.t35 = round(3.5 * self.fmt.length * self.bit)
        self.ram, self.cursor, self.count = bytearray(512), 0, 0
        self.events, self.verdicts, self.edges, self.drive = [], [], [], []
        self.given = {"format": self.fmt.code, "bit_time": bit_time, **given}
        await start(dut, rxd=1, settings=settings(**self.given))
        for handle, strobes, act in (
            (dut.ram_do_o, 0xF, self._frame_ram),
            (dut.events_o, 0xFF, self._happens),
            (dut.frame_o, 0b01101, self._judged),
        ):
            cocotb.start_soon(self._strobes(handle, strobes, act))
        for handle, log in ((dut.txd_o, self.edges), (dut.de_o, self.drive)):
            cocotb.start_soon(record(handle, log))
        if silent:
            await self.silence()
        return self

    async def _strobes(self, handle, strobes, act):
        """Call act(value) at the end of each clock in which one of the strobes is high."""
        while True:
            if not int(handle.value) & strobes:
                await handle.value_change
            await ReadOnly()
            value = int(handle.value)
            if value & strobes:
                await RisingEdge(self.dut.clk_i)
                assert not (int(self.dut.de_o.value) and int(self.dut.rx_active_o.value)), "receives while it drives"
                act(value)
            else:
                await handle.value_change

    def _frame_ram(self, what):
        open_, look, store, next_ = (what >> n & 1 for n in range(4))
        if open_:
            self.cursor = self.count = 0
        if look:
            self.cursor = 0
        if store:
            self.ram[self.cursor] = int(self.dut.rx_byte_o.value)
            self.cursor, self.count = self.cursor + 1, self.count + 1
        if next_:
            self.cursor, self.count = self.cursor + 1, self.count - 1
        self._show()

    def _show(self):
        self.dut.frame_byte_i.value, self.dut.count_i.value = self.ram[self.cursor], self.count

    def _happens(self, what):
        self.events += [name for n, name in enumerate(EVENTS) if what >> n & 1]

    def _judged(self, what):
        if what & 1:
            self.verdicts.append(("good", now(), bytes(self.ram[: self.count]), bool(what & 2)))
        if what & 4:
            self.verdicts.append(("foreign", now()))
        if what & 8:
            self.verdicts.append(("bad", now()))

    async def silence(self, bits=4):
        """t3.5 and some bits."""
        await Timer(self.t35 + round(bits * self.bit), "ps")

    async def play(self, edges, end):
        await drive(edges, self.dut.rxd_i.set, end)

    async def send(self, line, spikes=(), **how):
        """Characters, at any phase to the clock; returns the end of the last stop bit."""
        await Timer(self.rng.randrange(1, CLOCK_PS), "ps")
        sent = wave.encode(line, self.fmt, self.bit, **how)
        await self.play(wave.with_spikes(sent.edges, spikes) if spikes else sent.edges, sent.end)
        return now()

    async def noise(self, stop, period, width):
        """Low spikes of `width` bits, one every `period` bits, while `stop` is empty."""
        while not stop:
            self.dut.rxd_i.value = 0
            await Timer(round(width * self.bit), "ps")
            self.dut.rxd_i.value = 1
            await Timer(round((period - width) * self.bit), "ps")

    async def verdict(self, what):
        """The engine's word."""
        await RisingEdge(self.dut.clk_i)
        await Timer(1, "ps")
        self.dut.verdict_i.value = what
        await RisingEdge(self.dut.clk_i)
        await Timer(1, "ps")
        self.dut.verdict_i.value = 0

    async def answer(self, data=ANSWER):
        """Put an answer into the frame RAM and send it."""
        self.ram[: len(data)] = data
        self.cursor, self.count = 0, len(data)
        self._show()
        self.edges.clear(), self.drive.clear()
        await clocks(self.dut, 2)
        await self.verdict(SEND)

    async def until_sent(self, most=600):
        """When sending_o has fallen; the bytes that were on the line."""
        if int(self.dut.sending_o.value):
            await with_timeout(FallingEdge(self.dut.sending_o), most * self.bit, "ps")
        return wave.decode(self.edges, self.fmt, self.bit).data if self.edges else b""

    def take(self):
        """Verdicts since the last call."""
        seen, self.verdicts = self.verdicts, []
        return seen


def kinds(verdicts):
    return [v[0] for v in verdicts]


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), bit_time=[8, 11, 17])
async def request_and_answer(dut, fmt, bit_time):
    room = await Room.start(dut, fmt, bit_time)
    for _ in range(3):
        end = await room.send(REQUEST)
        await room.silence()
        ((kind, time, data, broadcast),) = room.take()
        assert (kind, data, broadcast) == ("good", REQUEST, False)
        assert end + room.t35 <= time <= end + room.t35 + 12 * CLOCK_PS, "t3.5 is not exact"
        assert not int(dut.idle_o.value)
        await room.answer()
        assert await room.until_sent() == frames.sealed(ANSWER)
    assert room.events == ["frame"] * 3
    await clocks(dut, 2)
    assert int(dut.idle_o.value)


@cocotb.test()
async def verdicts_of_all_kinds(dut):
    room = await Room.start(dut)
    write = frames.write_register(5, 1)
    for line, kind, event in (
        (frames.adu(OTHER, write), "foreign", "frame"),
        (frames.adu(0, write), "good", "frame"),
        (frames.bad_crc(REQUEST), "bad", "crc"),
        (REQUEST[:3], "bad", "short"),
        (bytes(257), "bad", "long"),
        ([(byte, 0, "parity" if i == 3 else None) for i, byte in enumerate(REQUEST)], "bad", "parity"),
        ([(byte, 0, "framing" if i == 3 else None) for i, byte in enumerate(REQUEST)], "bad", "framing"),
    ):
        room.events.clear()
        await room.send(line)
        await room.silence()
        seen = room.take()
        assert kinds(seen) == [kind] and event in room.events, f"{line}: {seen} {room.events}"
        if kind == "good":
            assert seen[0][3], "address 0 is a broadcast"
            await room.verdict(QUIET)
        await clocks(dut, 3)
        assert int(dut.idle_o.value), "not idle behind a frame"


# ------------------------------------------------------------------ spikes

TRAINS = [(0.31, 0.13), (0.51, 0.24), (0.99, 0.2), (1.0, 0.2), (1.37, 0.24), (2.2, 0.1)]  # period, width in bits


@cocotb.test()
@cocotb.parametrize(train=TRAINS, bit_time=[16, 50])
async def spikes_do_not_stretch_silence(dut, train, bit_time):
    """t3.5 passes behind a request whatever spikes there are."""
    room = await Room.start(dut, bit_time=bit_time)
    for _ in range(2):
        end = await room.send(REQUEST)
        stop = []
        noise = cocotb.start_soon(room.noise(stop, *train))
        await room.silence(2)
        stop.append(True)
        await noise
        seen = room.take()
        assert kinds(seen) == ["good"], f"{seen} {room.events}"
        assert end + room.t35 <= seen[0][1] <= end + room.t35 + 12 * CLOCK_PS, (
            f"t3.5 is {(seen[0][1] - end - room.t35) / room.bit:.2f} bits late"
        )
        await room.verdict(QUIET)
        await room.silence()


@cocotb.test()
@cocotb.parametrize(train=TRAINS, delay=[1, 20])
async def spikes_do_not_hold_the_response_delay(dut, train, delay):
    room = await Room.start(dut, bit_time=50, response_delay=delay)
    await room.send(REQUEST)
    await room.silence()
    stop = []
    noise = cocotb.start_soon(room.noise(stop, *train))
    began = now()
    await room.answer()
    await RisingEdge(dut.de_o)
    late = (now() - began) / room.bit - delay
    stop.append(True)
    await noise
    assert 0 <= late <= 0.5, f"a delay of {delay} bits lasts {late:.2f} bits more"
    assert await room.until_sent() == frames.sealed(ANSWER)


@cocotb.test()
@cocotb.parametrize(train=TRAINS, limit=[2, 10, 100])
async def spikes_do_not_hold_the_stall_limit(dut, train, limit):
    room = await Room.start(dut, bit_time=50, stall_limit=limit)
    await room.send(REQUEST)
    await room.silence()
    stop = []
    noise = cocotb.start_soon(room.noise(stop, *train))
    dut.bank_waits_i.value = 1
    began = now()
    await RisingEdge(dut.stall_o)
    bits = (now() - began) / room.bit
    stop.append(True)
    await noise
    assert limit - 1 <= bits <= limit + 0.2, f"stalled after {bits:.2f} bits, limit {limit}"
    dut.bank_waits_i.value = 0
    await clocks(dut, 3)
    assert not int(dut.stall_o.value)


@cocotb.test()
async def no_stall_limit_is_for_ever(dut):
    room = await Room.start(dut)
    dut.bank_waits_i.value = 1
    for _ in range(300):
        await Timer(room.bit, "ps")
        assert not int(dut.stall_o.value)


@cocotb.test()
@cocotb.parametrize(train=TRAINS)
async def request_behind_a_foreign_frame_and_spikes_is_heard(dut, train):
    """4 characters behind it, as on a clean line."""
    room = await Room.start(dut, bit_time=50)
    foreign = frames.adu(OTHER, frames.read(3, 0, 1))
    for _ in range(3):
        await room.send(foreign)
        stop = []
        noise = cocotb.start_soon(room.noise(stop, *train))
        await Timer(round((4 * 11 - 2) * room.bit), "ps")
        stop.append(True)
        await noise
        await Timer(2 * room.bit, "ps")
        await room.send(REQUEST)
        await room.silence()
        assert kinds(room.take()) == ["foreign", "good"], f"{room.events}"
        await room.verdict(QUIET)
        await room.silence()


# ------------------------------------------------------------------ silence without a character before it


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), margin=[-1.2, 0.7])
async def reset_asks_for_exactly_t35(dut, fmt, margin):
    """A request that begins this many bits behind t3.5 is heard or not."""
    room = await Room.start(dut, fmt, 16, silent=False)
    for _ in range(3):
        await strobe(dut, rst=1)
        await Timer(round(room.t35 + margin * room.bit), "ps")
        await room.send(REQUEST)
        await room.silence()
        assert kinds(room.take()) == (["good"] if margin > 0 else [])
        await room.verdict(QUIET)


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), tail=[0, 7, 15], margin=[-1.2, 0.7])
async def strict_turnaround_counts_from_the_last_stop_bit(dut, fmt, tail, margin):
    """Not from the end of the driver tail."""
    room = await Room.start(dut, fmt, 16, strict=1, de_tail=tail)
    await room.send(REQUEST)
    await room.silence()
    room.take()
    await room.answer()
    await FallingEdge(dut.txd_o)
    await Timer(1, "ps")
    stop_bit = room.edges[0][0] + (len(ANSWER) + 2) * room.fmt.length * room.bit
    await wait_until(stop_bit + room.t35 + margin * room.bit)
    await room.send(REQUEST)
    await room.silence()
    assert kinds(room.take()) == (["good"] if margin > 0 else [])


@cocotb.test()
async def restart_asks_for_silence(dut):
    """Also with no answer; while an answer is on its way it is not obeyed."""
    room = await Room.start(dut)
    await room.verdict(RESTART)
    await room.send(REQUEST)
    await room.silence()
    assert not room.take(), "heard without t3.5"
    await room.send(REQUEST)
    await room.silence()
    assert kinds(room.take()) == ["good"]
    await room.answer()
    await room.verdict(RESTART)
    assert await room.until_sent() == frames.sealed(ANSWER)
    await room.send(REQUEST)
    await room.silence()
    assert kinds(room.take()) == ["good"]


# ------------------------------------------------------------------ late answers


@cocotb.test()
@cocotb.parametrize(drop=[0, 1])
async def late_answer(dut, drop):
    """The master has asked again while the bank was slow."""
    room = await Room.start(dut, drop_late=drop)
    for how in ("before", "none", "before"):
        await room.send(REQUEST)
        await room.silence()
        assert kinds(room.take()) == ["good"]
        room.events.clear()
        if how == "before":
            await room.send(REQUEST)
        await room.answer()
        seen = await room.until_sent()
        dropped = bool(drop) and how == "before"
        assert seen == (b"" if dropped else frames.sealed(ANSWER)), f"{how}: {seen.hex()}"
        assert bool(room.drive) != dropped, "driver enable"
        assert room.events == (["overrun"] if how == "before" else [])
        await room.silence()
        assert not room.take()
        await room.send(REQUEST)
        await room.silence()
        assert kinds(room.take()) == ["good"], "not heard after t3.5"
        await room.verdict(QUIET)


@cocotb.test()
async def character_in_the_response_delay_drops_the_answer(dut):
    """At once: the next request may come before the delay would have ended."""
    room = await Room.start(dut, drop_late=1, response_delay=300)
    await room.send(REQUEST)
    await room.silence()
    room.take()
    await room.answer()
    await Timer(20 * room.bit, "ps")
    assert int(dut.sending_o.value)
    await room.send(b"\x55")
    assert not int(dut.sending_o.value), "still waits to answer"
    await room.silence()
    await room.send(REQUEST)
    await room.silence()
    assert kinds(room.take()) == ["good"] and not room.drive and not room.edges


@cocotb.test()
async def spikes_do_not_drop_an_answer(dut):
    room = await Room.start(dut, bit_time=16, drop_late=1, response_delay=40)
    await room.send(REQUEST)
    await room.silence()
    stop = []
    noise = cocotb.start_soon(room.noise(stop, 1.3, 0.24))
    await Timer(30 * room.bit, "ps")
    await room.answer()
    await RisingEdge(dut.de_o)
    stop.append(True)
    await noise
    assert await room.until_sent() == frames.sealed(ANSWER)


# ------------------------------------------------------------------ the engine's word at odd moments


@cocotb.test()
async def verdicts_out_of_turn_do_no_harm(dut):
    """SEND without a frame, in the middle of a reception, twice; QUIET while an answer is on its way."""
    room = await Room.start(dut)
    await room.verdict(SEND)
    await clocks(dut, 40)
    assert not int(dut.sending_o.value) and not room.drive, "an answer to nothing"
    sender = cocotb.start_soon(room.send(REQUEST))
    await Timer(30 * room.bit, "ps")
    await room.verdict(SEND)
    await room.verdict(QUIET)
    await sender
    await room.silence()
    assert kinds(room.take()) == ["good"] and not room.drive
    await room.answer()
    await room.verdict(QUIET)
    await room.verdict(SEND)
    assert await room.until_sent() == frames.sealed(ANSWER)
    await clocks(dut, 300)
    assert len(room.drive) == 2, "sent twice"


@cocotb.test()
async def idle_covers_character_frame_work_and_answer(dut):
    room = await Room.start(dut, response_delay=20, de_tail=5)
    assert int(dut.idle_o.value)
    sender = cocotb.start_soon(room.send(REQUEST))
    await Timer(room.bit, "ps")
    while not sender.done():
        await Timer(room.bit // 2, "ps")
        assert not int(dut.idle_o.value), "idle inside a frame"
    await Timer(room.t35 // 2, "ps")
    assert not int(dut.idle_o.value), "idle before the frame is judged"
    await Timer(room.t35, "ps")
    assert not int(dut.idle_o.value), "idle while the engine works"
    await room.answer()
    await room.until_sent()
    await clocks(dut, 2)
    assert int(dut.idle_o.value) and not int(dut.de_o.value)
