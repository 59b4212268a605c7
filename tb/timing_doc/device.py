# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""timing_top, compiled, as a Python object that counts clock cycles."""

import bisect
import ctypes
import math
from dataclasses import dataclass
from pathlib import Path

import models
from harness import wave
from harness.runner import sources
from protocol.defs import F8E1

HERE = Path(__file__).resolve().parent
UNIT = 1000  # wave.encode counts in thousandths of a clock here
OWN = 17  # the address of timing_top

# Bits of watch_o, lowest first
SIGNALS = (
    "txd de rx_active frame write grant_req grant_ack wb_cyc wb_stb wb_we wb_ack host_ack host_err "
    "parity framing overrun crc short long gap grant_write"
).split()
BIT = {name: 1 << place for place, name in enumerate(SIGNALS)}
ERRORS = ("parity", "framing", "overrun", "crc", "short", "long", "gap")
JUDGED = sum(BIT[name] for name in ("frame", *ERRORS))


def mask(names):
    """The bits of some signals, named in a string or a sequence."""
    return sum(BIT[name] for name in (names.split() if isinstance(names, str) else names))


def library(**parameters):
    """Path of the shared library of timing_top with `parameters`; raises models.BuildError."""
    files, folders = sources()
    files = [*files, HERE / "timing_top.v"]
    return models.compiled(models.Model("timing_top", HERE / "harness.cpp", files, folders, parameters))


class Setup(ctypes.Structure):
    """The run-time inputs."""

    _fields_ = [
        (name, ctypes.c_uint32)
        for name in "bit_time format response_delay stall_limit de_lead de_tail strict_turnaround".split()
    ]


class Peek(ctypes.Structure):
    """The outputs in one clock."""

    _fields_ = [
        (name, ctypes.c_uint32)
        for name in ("watch grant_space grant_first grant_last exception wb_adr wb_write wb_read host_dat").split()
    ]

    def __getattr__(self, name):
        if name in BIT:
            return int(bool(self.watch & BIT[name]))
        raise AttributeError(name)


@dataclass
class Log:
    """Changes of watch_o: clocks and values; the first entry is the state at the begin."""

    when: list
    what: list

    def edges(self, name):
        """[(clock, level), ...] of one signal, changes only."""
        bit, out = BIT[name], []
        for place in range(1, len(self.when)):
            level = bool(self.what[place] & bit)
            if level != bool(self.what[place - 1] & bit):
                out.append((self.when[place], int(level)))
        return out

    def rises(self, name):
        """Clocks in which a signal becomes 1."""
        return [time for time, level in self.edges(name) if level]

    def falls(self, name):
        """Clocks in which a signal becomes 0."""
        return [time for time, level in self.edges(name) if not level]

    def at(self, name, time):
        """Level of a signal in a clock."""
        place = bisect.bisect_right(self.when, time) - 1
        return int(bool(self.what[place] & BIT[name]))


class Device:
    """One drop-in with its line."""

    ROOM = 200_000  # changes that are recorded

    def __init__(self, **parameters):
        self.lib = lib = ctypes.CDLL(str(library(**parameters)))
        lib.device_new.restype = ctypes.c_void_p
        lib.device_now.restype = ctypes.c_uint64
        lib.device_run.restype = ctypes.c_int64
        self.handle = ctypes.c_void_p(lib.device_new())
        self._when, self._what = (ctypes.c_uint64 * self.ROOM)(), (ctypes.c_uint32 * self.ROOM)()
        self.fmt, self.bit_time = F8E1, 8

    @property
    def now(self):
        """The clock that is now."""
        return self.lib.device_now(self.handle)

    def setup(self, bit_time, fmt=F8E1, **inputs):
        """Set the run-time inputs; what is not named is 0. Then reset and silence."""
        self.fmt, self.bit_time = fmt, bit_time
        self.lib.device_setup(self.handle, ctypes.byref(Setup(bit_time=bit_time, format=fmt.code, **inputs)))
        self.reset()

    def reset(self, silence=None):
        """Reset, then silence long enough for t3.5 in character times (or so many clocks)."""
        self.lib.device_reset(self.handle, 1)
        self.run(2)
        self.lib.device_reset(self.handle, 0)
        self.run(40 * self.bit_time if silence is None else silence)

    def run(self, clocks, edges=(), stop=0, log=0):
        """Run so many clocks, or to the clock that shows a signal of mask `stop`; the Log of mask `log`.

        `edges`: (clock from now, level) of rxd.
        """
        begin = self.now
        times = (ctypes.c_int64 * len(edges))(*[begin + time for time, _ in edges])
        levels = (ctypes.c_uint8 * len(edges))(*[level for _, level in edges])
        found = self.lib.device_run(
            self.handle,
            ctypes.c_int64(len(edges)),
            times,
            levels,
            ctypes.c_uint64(begin + math.ceil(clocks)),
            ctypes.c_uint32(stop),
            ctypes.c_uint32(log),
            ctypes.c_int64(self.ROOM if log else 0),
            self._when,
            self._what,
        )
        assert found < self.ROOM, "more changes than there is room for"
        return Log(list(self._when[:found]), list(self._what[:found]))

    def wave(self, line, offset=0.0, phase=0.0, spikes=()):
        """(edges in clocks, clock of the end) of a line (as wave.encode takes it).

        `phase`: clocks from the begin to the first start bit; `spikes`: (begin, width) in clocks.
        """
        sent = wave.encode(line, self.fmt, self.bit_time * UNIT, offset)
        edges = sent.edges
        if spikes:
            edges = wave.with_spikes(edges, [(b * UNIT, w * UNIT) for b, w in spikes])
        return [(math.floor(t / UNIT + phase), level) for t, level in edges], sent.end / UNIT + phase

    def request(self, frame, wait, stop=0, log=0, **how):
        """Send a frame and run for `wait` clocks beyond its end (or to `stop`).

        Returns (clock in which the last stop bit has ended, Log from the begin of the frame on).
        """
        edges, end = self.wave(frame, **how)
        begin = self.now
        found = self.run(end + wait, edges, stop, log)
        return begin + end, found

    def peek(self):
        """The outputs in the clock that is now."""
        out = Peek()
        self.lib.device_peek(self.handle, ctypes.byref(out))
        return out

    def host(self, cyc=0, stb=0, we=0, address=0, data=0):
        """Set the host port's inputs."""
        self.lib.device_host(self.handle, cyc, stb, we, address, data)
