# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A device under test with clock, reset, configuration, line, host port and model side by side."""

import dataclasses
import json
import os
import random
from collections import Counter

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge, Timer
from protocol.defs import ASCII_FORMATS, ERRORS, F8E1, RESTARTED, Space
from protocol.frames import text
from protocol.model import Slave, characters, split

from . import build
from .host import HostPort
from .line import Line, now
from .readout import Readout

CLOCK_PS = 20_000
TOP = os.environ.get("BENCH_TOP", "slave_bench")
PARAMETERS = json.loads(os.environ.get("BENCH_PARAMETERS", "{}"))
PORTS_ONLY = bool(os.environ.get("BENCH_PORTS_ONLY"))  # a netlist: nothing inside has a name
PATIENCE_CLOCKS = 30_000  # for an answer that must come
PROCESSING_CLOCKS = 250  # from t3.5 to the answer of a short request, whatever the bit time
STRAGGLER_BITS = 16  # a character that began in the last moment of a noise

# Inputs that rest at 0 until something drives them.
AT_REST = (
    *(f"host_{name}_i" for name in ("cyc", "stb", "we", "adr", "dat")),
    *(f"status_{name}_i" for name in ("stb", "adr")),
    *(f"user_{name}_i" for name in ("adr", "dat", "put", "done", "pass", "exception")),
    "discretes_i",
    "inputs_i",
)

_dirty = set()  # items of the device that an earlier test left other than 0


@dataclasses.dataclass
class Setup:
    """The run-time inputs; names are those of the ports without _i. `fmt` may be given by a format's name."""

    address: int = 17
    bit_time: int = 8
    fmt: object = F8E1
    broadcast_en: int = 1
    gap_count_only: int = 0
    strict_turnaround: int = 0
    drop_late: int = 0
    response_delay: int = 0
    stall_limit: int = 0
    de_lead: int = 0
    de_tail: int = 0
    bit_fraction: int = 0
    ascii: int = 0
    ascii_extra: int = 0
    busy: int = 0
    write_lock: int = 0
    failure: int = 0
    exception_status: int = 0
    run_indicator: int = 1
    diagnostic: int = 0

    def __post_init__(self):
        if isinstance(self.fmt, str):
            self.fmt = ASCII_FORMATS[self.fmt]


class Bench(HostPort, Readout):
    """Everything a test touches. `await Bench.start(dut, **setup)`; `setup` are fields of Setup.

    `in_step` is False once a test has driven the line without the model: what the device has counted and
    logged is then no longer known, until the next reset.
    """

    def __init__(self, dut, seed):
        self.dut, self.rng = dut, random.Random(seed)
        self.setup = Setup()
        self.strobes, self.writes = Counter(), []
        self.touched = _dirty  # items that are no longer 0
        self.line = Line(dut, self.setup.bit_time * CLOCK_PS, self.setup.fmt, self.rng)
        self.slave = Slave(build.model_config(TOP, PARAMETERS))
        self.has_host = hasattr(dut, "host_cyc_i")
        self.longest_latency = 0.0
        self.in_step, self._playing_both = True, False
        self.line.play = self._noted(self.line.play)

    @classmethod
    async def start(cls, dut, seed=1, **setup):
        """Clock, inputs, reset; returns when the line has been silent for t3.5."""
        if hasattr(dut, "bench"):  # a compiled model has its own: differential/bench.py
            return await dut.bench(seed, **setup)
        if not now():
            await Timer(1, "ps")  # the nets of a netlist have no level at time 0 yet
        bench = cls(dut, seed)
        for port in AT_REST:
            if hasattr(dut, port):
                getattr(dut, port).value = 0
        dut.rst_i.value = 1
        bench.apply(**setup)
        Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
        for name in (*(f"err_{e}" for e in ERRORS), "frame_stb"):
            if hasattr(dut, f"{name}_o"):  # a SoC keeps them inside; then `query`, not `both`
                cocotb.start_soon(bench._count(name))
        if hasattr(dut, "write_stb_o"):
            cocotb.start_soon(bench._watch_writes())
        await bench.reset()
        await bench.silence()
        await bench.clean()
        if hasattr(dut, "holdings_o"):
            for space in (Space.COILS, Space.HOLDINGS):
                base, count = bench.slave.config.tables[space]
                for key in ((space, base + i) for i in range(count)):
                    bench.slave.memory[key] = await bench.read_back(key)
        return bench

    async def _count(self, name):
        handle = getattr(self.dut, f"{name}_o")
        key = name.removeprefix("err_").removesuffix("_stb")
        while True:
            await RisingEdge(handle)
            await ReadOnly()
            self.strobes[key] += int(handle.value)

    async def _watch_writes(self):
        dut = self.dut
        while True:
            await RisingEdge(dut.write_stb_o)
            await ReadOnly()
            while int(dut.write_stb_o.value):  # each clock of it is a write
                space = Space(int(dut.write_space_o.value))
                pulse = (space, int(dut.write_first_o.value), int(dut.write_last_o.value))
                if space == Space.FILES:
                    pulse += (int(dut.write_file_o.value),)
                self.writes.append(pulse)
                await RisingEdge(dut.clk_i)
                await ReadOnly()

    def _noted(self, play):
        """`play` of the line, noting what the model does not hear of."""

        async def noted(edges):
            self.in_step &= self._playing_both
            await play(edges)

        return noted

    # -------------------------------------------------------------- configuration and time

    def apply(self, **setup):
        """Change run-time inputs, of the device and of the model."""
        self.setup = dataclasses.replace(self.setup, **setup)
        if hasattr(self.dut, "eight_bits_i"):
            self.dut.eight_bits_i.value = int(self.setup.fmt.data_bits == 8)
        for name, value in dataclasses.asdict(self.setup).items():
            port = "format" if name == "fmt" else name
            if hasattr(self.dut, f"{port}_i"):
                code = self.setup.fmt.code if name == "fmt" else value
                getattr(self.dut, f"{port}_i").value = code
        self._settled(PARAMETERS)

    def _settled(self, parameters):
        """Line, model and silences follow the set-up of a build with `parameters`."""
        self.line.bit_ps, self.line.fmt = round(self.bit_clocks * CLOCK_PS), self.setup.fmt
        self.line.slack_ps = CLOCK_PS // 2 if self.setup.bit_fraction else 0
        config = self.slave.config
        config.address = self.setup.address
        config.broadcast = bool(self.setup.broadcast_en)
        config.gap_count_only = bool(self.setup.gap_count_only)
        slave = self.slave
        slave.busy, slave.write_lock = bool(self.setup.busy), bool(self.setup.write_lock)
        slave.failure, slave.exception_status = self.setup.failure, self.setup.exception_status
        slave.run_indicator, slave.diagnostic_bits = bool(self.setup.run_indicator), self.setup.diagnostic
        t15, t35 = build.silences(parameters, self.setup.fmt, self.bit_clocks)
        if self.setup.ascii:  # silences count for nothing, but for the time-out
            t15 = t35 = 0
        self.timeout = build.ascii_timeout(parameters, self.setup.ascii_extra) * CLOCK_PS
        config.timeout = self.timeout / CLOCK_PS / self.character
        self.t15, self.t35 = t15 * CLOCK_PS, t35 * CLOCK_PS
        config.t15, config.t35 = t15 / self.character, t35 / self.character

    @property
    def bit(self):
        """Nominal bit time in ps."""
        return self.line.bit_ps

    @property
    def bit_clocks(self):
        """Bit time in clock cycles."""
        fraction = self.setup.bit_fraction
        return self.setup.bit_time + fraction / 16 if fraction else self.setup.bit_time

    @property
    def character(self):
        """Character time in clock cycles."""
        return self.setup.fmt.length * self.bit_clocks

    async def reset(self, clocks=4):
        """Hold rst_i for some clocks. Released, the line must be silent before anything is heard."""
        self.dut.rst_i.value = 1
        await Timer(clocks * CLOCK_PS, "ps")
        await RisingEdge(self.dut.clk_i)
        self.dut.rst_i.value = 0
        self.line.forget()
        self.slave.reset()
        self.in_step = True

    async def silence(self, bits=4):
        """t3.5 and some bits more."""
        await Timer(round(self.t35 + bits * self.bit), "ps")

    async def clocks(self, count):
        """Wait for clock cycles."""
        if count:
            await Timer(count * CLOCK_PS, "ps")

    # -------------------------------------------------------------- one request

    async def query(self, line, patience=None, **how):
        """Send `line` and take the answer (Answer or None); `how` goes to Line.send.

        `patience` in ps beyond t3.5; default long enough for any answer.
        """
        self.sent = await self.line.send(line, **how)
        if patience is None:
            patience = PATIENCE_CLOCKS * CLOCK_PS + self.setup.response_delay * self.bit
        return await self.line.answer(self.t35 + patience)

    async def query_while(self, line, clock, **setup):
        """`query`, with run-time inputs that change so many clocks after t3.5 has passed behind `line`."""

        async def change():
            await Timer(round(self.t35) + clock * CLOCK_PS, "ps")
            self.apply(**setup)

        self.sent = await self.line.send(line)
        cocotb.start_soon(change())
        return await self.line.answer(self.t35 + PATIENCE_CLOCKS * CLOCK_PS)

    async def send(self, line, **how):
        """Send `line` and stay in step: the caller tells the model what is heard of it. The end's time in ps."""
        self._playing_both = True
        self.sent = await self.line.send(line, **how)
        self._playing_both = False
        return self.sent

    async def both(self, line, patience=None, note="", timing=True, listen=True, **how):
        """Play `line` to model and device and compare: answer, strobes, writes, answer's timing.

        A silence of t3.5 inside `line` makes several frames of it; only the last may be answered.
        After a restart the line is left silent until the device listens again, if `listen`.
        Returns the answer bytes (None: silence).
        """
        self.strobes.clear()
        self.writes.clear()
        must, may, good, written, expected = set(), set(), 0, [], None
        hear = self.slave.hear if self.setup.ascii else self.slave.request
        for piece in [line] if self.setup.ascii else split(line, self.slave.config.t35):
            assert expected is None, "the bench cannot send while the device answers"
            assert not self.slave.ambiguous, "the bench cannot settle what came before the last silence"
            expected = hear(piece)
            must |= self.slave.errors
            may |= self.slave.allowed
            good += self.slave.good
            written += self.slave.written
            self.touched |= self.slave.touched
        if patience is None and expected is None:
            long = good and len(line) > 24  # a broadcast that may take its time
            patience = 6 * self.bit + (PROCESSING_CLOCKS if good else 64) * CLOCK_PS if not long else None
        self._playing_both = True
        got = await self.query(line, patience, **how)
        self._playing_both = False
        data, self.last_answer = got and got.data, got
        if self.slave.ambiguous:
            self.slave.adopt(bool(self.strobes["long"]))
        shown = f"{note} {text([c.byte for c in characters(line)])}"
        assert data == expected, f"{shown}: expected {text(expected)}, seen {text(data)}"
        if hasattr(self.dut, "frame_stb_o"):  # a drop-in keeps them inside
            self._compare_strobes(shown, must, may, good)
        if hasattr(self.dut, "write_stb_o"):
            assert self.writes == written, f"{shown}: expected write pulses {written}, seen {self.writes}"
        if got and timing:
            self._check_timing(got, shown)
        if listen and self.slave.log and self.slave.log[0] == RESTARTED:
            await self.silence()
        return data

    def _compare_strobes(self, shown, must, may, good):
        seen = {e for e in ERRORS if self.strobes[e]}
        assert must <= seen <= must | may, (
            f"{shown}: expected strobes {sorted(must)} (allowed {sorted(may)}), seen {sorted(seen)}"
        )
        assert self.strobes["frame"] == good, (
            f"{shown}: frame_stb_o rose {self.strobes['frame']} times, {good} frames are good"
        )

    def latency(self, answer):
        """Bits from the end of t3.5 to the answer's first start bit."""
        return (answer.start - self.sent - self.t35) / self.bit

    def _check_timing(self, answer, shown):
        latency = self.latency(answer) - self.setup.response_delay
        self.longest_latency = max(self.longest_latency, latency)
        assert latency >= 0, f"{shown}: the answer starts {-latency:.2f} bits before t3.5"
        lead = (answer.start - answer.de_rise) / self.bit
        tail = (answer.de_fall - answer.end) / self.bit
        slack = self.line.slack_ps / self.bit
        assert self.setup.de_lead - slack <= lead <= self.setup.de_lead + 1 + slack, (
            f"{shown}: de leads by {lead:.2f} bits, set to {self.setup.de_lead}"
        )
        assert self.setup.de_tail - slack <= tail <= self.setup.de_tail + 1 + slack, (
            f"{shown}: de stays {tail:.2f} bits, set to {self.setup.de_tail}"
        )

    async def finish(self):
        """Nothing may come after the last answer; the line is at rest; memory, counters, log are the model's.

        The next test begins with cleared memory.
        """
        extra = await self.line.answer(self.t35 + 64 * self.bit)
        assert extra is None, f"an answer nobody asked for: {text(extra.data)}"
        assert int(self.dut.txd_o.value) == 1, "txd_o is low at rest"
        assert int(self.dut.de_o.value) == 0, "de_o is high at rest"
        for port in ("frame_stb_o", "write_stb_o", *(f"err_{e}_o" for e in ERRORS)):
            if hasattr(self.dut, port):
                assert int(getattr(self.dut, port).value) == 0, f"{port} is high at rest"
        if self.has_host or hasattr(self.dut, "holdings_o"):
            await self.compare(sorted(self.touched))
        if self.in_step and hasattr(self.dut, "status_stb_i"):
            await self.compare_counters("at the end")

    async def clean(self):
        """Set what earlier tests have written to 0, as after power-up."""
        if self.has_host:
            for key in sorted(_dirty):
                await self.host(*key, write=0)
        _dirty.clear()
