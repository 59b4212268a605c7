# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The compiled slave as a Python object: builds the shared library and calls it by ctypes."""

import ctypes
from dataclasses import dataclass
from pathlib import Path

import models
from harness import build
from harness.runner import sources
from protocol.defs import COUNTER_ADDRESS, ERRORS, EX, LOG_ADDRESS, Space, bus_address
from protocol.model import characters

HERE = Path(__file__).resolve().parent
STROBES, MAX_WRITES, MAX_ANSWER = len(ERRORS) + 1, 40, 520
FAULTS = {None: 0, "parity": 1, "framing": 2}  # these and the next as in sim/line.h
LINE_FAULTS = {
    -1: "an edge off the grid of bit times",
    -2: "a gap between two characters",
    -3: "wrong parity",
    -4: "a low stop bit",
    -5: "de_o does not cover the answer",
    -6: "txd_o moves while de_o is low",
}


def library(parameters, harness=HERE / "harness.cpp"):
    """Path of the shared library of slave_bench with `parameters` behind the C functions of `harness`.

    Raises models.BuildError.
    """
    given = build.for_simulator("verilator", parameters)
    return models.compiled(models.Model("slave_bench", harness, *sources(), given))


class Setup(ctypes.Structure):
    """The run-time inputs."""

    _fields_ = [
        (name, ctypes.c_uint32)
        for name in (
            "address bit_time format broadcast_en gap_count_only strict_turnaround response_delay stall_limit "
            "de_lead de_tail busy write_lock failure exception_status run_indicator diagnostic "
            "ascii eight_bits ascii_extra"
        ).split()
    ]


class _Outcome(ctypes.Structure):
    _fields_ = [
        ("answer_bytes", ctypes.c_int32),
        ("strobes", ctypes.c_uint32 * STROBES),
        ("write_count", ctypes.c_int32),
        ("writes", ctypes.c_uint32 * MAX_WRITES),
        ("write_last", ctypes.c_uint32 * MAX_WRITES),
        ("write_file", ctypes.c_uint32 * MAX_WRITES),
        ("latency", ctypes.c_int64),
        ("lead", ctypes.c_int64),
        ("tail", ctypes.c_int64),
        ("answer", ctypes.c_uint8 * MAX_ANSWER),
    ]


@dataclass
class Outcome:
    """What one transfer did: answer bytes (None: silence), strobe counts, writes, times in clocks."""

    answer: bytes | None
    errors: dict
    good: int
    writes: list
    latency: int
    lead: int
    tail: int


class LineError(AssertionError):
    """The answer is not clean on the line."""


class Device:
    """One compiled slave."""

    def __init__(self, path):
        lib = ctypes.CDLL(str(path))
        lib.device_new.restype = ctypes.c_void_p
        lib.device_host.restype = lib.device_counter.restype = ctypes.c_int32
        lib.device_state.restype = ctypes.c_uint32
        lib.device_xfer.argtypes = [
            ctypes.c_void_p,
            ctypes.c_int,
            ctypes.c_char_p,
            ctypes.c_void_p,
            ctypes.c_char_p,
            ctypes.c_double,
            ctypes.c_uint32,
            ctypes.c_void_p,
        ]
        self._lib, self._handle = lib, ctypes.c_void_p(lib.device_new())
        self._out = _Outcome()
        self.character = 0  # clocks
        self.bit_time = 0

    def close(self):
        self._lib.device_free(self._handle)

    def setup(self, fmt, bit_time, **inputs):
        """Set the run-time inputs; what is not named is 0."""
        self.bit_time, self.character = bit_time, fmt.length * bit_time
        setup = Setup(bit_time=bit_time, format=fmt.code, eight_bits=int(fmt.data_bits == 8), **inputs)
        self._lib.device_setup(self._handle, ctypes.byref(setup))

    def later(self, clocks, fmt, bit_time, **inputs):
        """The run-time inputs as they shall be so many clocks after the end of the next line that is sent."""
        setup = Setup(bit_time=bit_time, format=fmt.code, eight_bits=int(fmt.data_bits == 8), **inputs)
        self._lib.device_later(self._handle, ctypes.c_uint32(clocks), ctypes.byref(setup))

    def reset(self):
        self._lib.device_reset(self._handle)

    def idle(self, clocks):
        self._lib.device_idle(self._handle, ctypes.c_uint32(round(clocks)))

    def noise(self, clocks):
        """Alternating levels from 0 on, each for so many clocks."""
        array = (ctypes.c_uint32 * len(clocks))(*clocks)
        self._lib.device_noise(self._handle, len(clocks), array)

    def host(self, space, item, write=None):
        """Host port access; the value, or None for err."""
        value = self._lib.device_host(self._handle, bus_address(space, item), int(write is not None), write or 0)
        assert value != -2, "the host port does not answer"
        return None if value < 0 else value

    def counter(self, address):
        """A word of the counter port."""
        value = self._lib.device_counter(self._handle, address)
        assert value >= 0, "the counter port does not answer"
        return value

    def counters(self):
        """All counters by name."""
        return {name: self.counter(address) for name, address in COUNTER_ADDRESS.items()}

    def state(self):
        """(listen-only, entries of the log, diagnostic register)."""
        value = self._lib.device_state(self._handle)
        return bool(value >> 23), value >> 16 & 0x7F, value & 0xFFFF

    def log(self):
        """The event log, newest first."""
        return [self.counter(LOG_ADDRESS + i) for i in range(self.state()[1])]

    def transfer(self, line, patience, offset=0.0):
        """Send a line; Outcome. Raises LineError if the answer is not clean."""
        sent = characters(line)
        count, out = len(sent), self._out
        gaps = (ctypes.c_uint32 * count)(*[round(c.gap * self.character) for c in sent])
        self._lib.device_xfer(
            self._handle,
            count,
            bytes(c.byte for c in sent),
            gaps,
            bytes(FAULTS[c.error] for c in sent),
            offset,
            round(patience),
            ctypes.byref(out),
        )
        if out.answer_bytes < 0:
            raise LineError(LINE_FAULTS[out.answer_bytes])
        writes = [
            (Space(out.writes[i] >> 16), out.writes[i] & 0xFFFF, out.write_last[i])
            + ((out.write_file[i],) if out.writes[i] >> 16 == Space.FILES else ())
            for i in range(out.write_count)
        ]
        return Outcome(
            bytes(out.answer[: out.answer_bytes]) if out.answer_bytes else None,
            dict(zip(ERRORS, out.strobes)),
            out.strobes[STROBES - 1],
            writes,
            out.latency,
            out.lead,
            out.tail,
        )


MOST_ANSWER_DATA = 252
KINDS = 4  # of behaviour, by the first data byte


def user_answer(pdu):
    """What the user in harness.cpp makes of a request, in the terms of Slave.user."""
    what = pdu[1] if len(pdu) > 1 else 0
    kind = what % KINDS
    if kind == 0:
        return None
    if kind == KINDS - 1 and what >> 2 & 15:
        return what >> 2 & 15
    data = b""
    if kind == 1:
        data = pdu[:0:-1]
    elif kind == 2 and len(pdu) > 2:
        data = bytes(i ^ 0x5A for i in range(pdu[2]))
    return EX.FAILURE if len(data) > MOST_ANSWER_DATA else pdu[:1] + data
