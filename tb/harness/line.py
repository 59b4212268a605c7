# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The serial line around a device under test in cocotb: drives rxd_i, records txd_o and de_o.

Time is counted in picoseconds (the simulators run with a precision of 1 ps); nothing here waits
for clock edges, so a simulation costs one wake-up per level change.
"""

from dataclasses import dataclass

import cocotb
from cocotb.triggers import Event, First, Timer
from cocotb.utils import get_sim_time

from . import wave
from .wave import LineError


def now():
    """Simulation time in ps."""
    return int(get_sim_time("ps"))


async def wait_until(time):
    """Wait for the absolute `time` (ps); returns at once if it has passed."""
    left = round(time) - now()
    if left > 0:
        await Timer(left, "ps")


async def drive(edges, put, end=None):
    """Call `put(level)` for each of `edges`, times in ps from now that only grow; returns at `end`, if one is given."""
    passed = 0
    for time, level in edges:
        if (time := round(time)) > passed:
            await Timer(time - passed, "ps")
            passed = time
        put(level)
    if end is not None and (time := round(end)) > passed:
        await Timer(time - passed, "ps")


async def record(pin, log):
    """Append (time in ps, level) to `log` whenever a pin changes."""
    while True:
        await pin.value_change
        log.append((now(), int(pin.value)))


@dataclass
class Answer:
    """One transmission of the device: bytes and times in ps."""

    data: bytes
    start: int  # first start bit
    end: int  # end of the last stop bit
    de_rise: int
    de_fall: int


class Line:
    """One device's serial side.

    `bit_ps`, `slack_ps` and `fmt` may be changed while the line is idle.  The device's edges are at most `slack_ps`
    off their exact place.  With `echo` what the device sends comes back on its receiver, as on a two-wire bus whose
    receiver stays enabled.
    """

    def __init__(self, dut, bit_ps, fmt, rng):
        self.dut, self.bit_ps, self.fmt, self.rng = dut, bit_ps, fmt, rng
        self.echo, self.slack_ps = False, 0
        self._master, self._tx_edges = wave.IDLE, []
        self._txd, self._de_rise = wave.IDLE, None
        self.answers, self.finished = [], Event()
        self.stray = []  # edges of txd while de was low
        dut.rxd_i.value = wave.IDLE
        cocotb.start_soon(self._watch_txd())
        cocotb.start_soon(self._watch_de())

    # -------------------------------------------------------------- towards the device

    def _drive(self, level):
        self._master = level
        self._update()

    def _update(self):
        self.dut.rxd_i.value = self._master & (self._txd if self.echo else 1)

    async def play(self, edges):
        """Drive (time, level) edges, times in ps from now."""
        await drive(edges, self._drive)

    async def send(self, line, offset=0.0, jitter=0.0, spikes=(), phase=None):
        """Send characters; returns the time at which the last stop bit ends.

        offset: the sender's bits are longer by this fraction; jitter: each edge moves by up to
        this many bits either way; spikes: (begin, width) in bits from the first start bit, may
        lie after the frame; phase: ps to wait first (default: random within a bit).
        """
        if phase is None:
            phase = self.rng.randrange(self.bit_ps)
        await Timer(phase + 1, "ps")
        reach = jitter * self.bit_ps
        sent = wave.encode(
            line,
            self.fmt,
            self.bit_ps,
            offset,
            (lambda: self.rng.uniform(-reach, reach)) if jitter else None,
        )
        begin, edges = now(), sent.edges
        if jitter:
            edges = [(max(0, time), level) for time, level in edges]
        if spikes:
            scaled = [(b * self.bit_ps, w * self.bit_ps) for b, w in spikes]
            edges = wave.with_spikes(edges, scaled)
        late = [e for e in edges if e[0] > sent.end]
        await self.play([e for e in edges if e[0] <= sent.end])
        await wait_until(begin + sent.end)
        if late:
            cocotb.start_soon(self.play([(time - sent.end, level) for time, level in late]))
        return begin + sent.end

    async def hold_low(self, bit_times):
        """A break (or a short spike) of `bit_times`; returns the time at which it ends."""
        await self.play(wave.low(bit_times * self.bit_ps).edges)
        return now()

    # -------------------------------------------------------------- from the device

    async def _watch_txd(self):
        while True:
            await self.dut.txd_o.value_change
            level = int(self.dut.txd_o.value)
            if level == self._txd:
                continue
            self._txd = level
            self._tx_edges.append((now(), level))
            if self.echo:
                self._update()

    async def _watch_de(self):
        while True:
            await self.dut.de_o.value_change
            if int(self.dut.de_o.value):
                if self._de_rise is None:
                    self._de_rise = now()
            elif self._de_rise is not None:
                await Timer(1, "ps")  # let an edge of txd in this very moment be recorded first
                self._collect(now() - 1)

    def _collect(self, fall):
        edges, self._tx_edges = self._tx_edges, []
        rise, self._de_rise = self._de_rise, None
        try:
            got = wave.decode(edges, self.fmt, self.bit_ps, self.slack_ps)
            if not rise <= got.start or not got.end <= fall + self.slack_ps:
                raise LineError(f"de high {rise}..{fall} ps does not cover the answer {got.start}..{got.end}")
            answer = Answer(got.data, got.start, got.end, rise, fall)
        except LineError as error:
            answer = error
        self.answers.append(answer)
        self.finished.set()

    @property
    def driving(self):
        """True while de_o is high."""
        return self._de_rise is not None

    async def answer(self, patience):
        """The next answer, or None if de_o has not risen `patience` ps from now.

        Raises LineError if what was sent is not clean (a gap, a bit of wrong length, parity, stop
        bits, de not covering it).
        """
        deadline = now() + round(patience)
        while not self.answers:
            if not self.driving and now() >= deadline:
                if self._tx_edges:
                    raise LineError("txd moves while de is low")
                return None
            self.finished.clear()
            left = max(deadline - now(), self.bit_ps)
            await First(self.finished.wait(), Timer(left, "ps"))
        answer = self.answers.pop(0)
        if isinstance(answer, LineError):
            raise answer
        return answer

    async def answer_begins(self, patience):
        """Time of the next start bit on txd_o, or None after `patience` ps."""
        self._tx_edges.clear()
        await First(self.dut.txd_o.value_change, Timer(round(patience), "ps"))
        await Timer(1, "ps")
        return self._tx_edges[0][0] if self._tx_edges else None

    def forget(self):
        """Drop whatever was recorded, after a reset in the middle of an answer."""
        self._tx_edges.clear()
        self.answers.clear()
        self._de_rise = None
