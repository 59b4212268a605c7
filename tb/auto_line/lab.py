# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A compiled modbus_example_auto and a master with a rate, a format and faults of its own."""

import ctypes
from dataclasses import dataclass
from pathlib import Path

import models
from harness.runner import sources
from protocol import frames
from protocol.defs import FC, FORMATS

HARNESS = Path(__file__).resolve().parent / "harness.cpp"
RATES = (1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400)
CLK_HZ = 12_000_000
SLOW_HZ, SLOW_RATE = 1_500_000, 9600  # clock of a device for volume, up to this rate: an eighth of the time to simulate
NOISE_HZ = 3_000_000  # for long noise: 26 clocks a bit at 115200 baud
OWN = 17
PATIENCE_BITS = 600  # of a master, beyond the fixed part
PATIENCE_S = 0.020
T35_BITS, T35_S = 40, 0.00175  # silence between two frames


def clock_for(rate):
    """The clock of a device for volume at a rate."""
    return SLOW_HZ if rate <= SLOW_RATE else CLK_HZ


def library(**parameters):
    """Path of the shared library of the example with `parameters`; raises models.BuildError."""
    files, folders = sources()
    given = {"CLK_HZ": CLK_HZ, "ADDRESS": OWN, **parameters}
    return models.compiled(models.Model("modbus_example_auto", HARNESS, files, folders, given))


@dataclass
class Found:
    """What the device tells."""

    locked: int
    format: int
    bit_time: int
    frames: int
    locks: int


class Device:
    """One device; time is in its clocks.  `hz` of them are a second."""

    def __init__(self, hz=CLK_HZ, **parameters):
        self.lib = lib = ctypes.CDLL(str(library(CLK_HZ=hz, **parameters)))
        lib.auto_new.restype = ctypes.c_void_p
        lib.auto_now.restype = ctypes.c_double
        self.hz = hz
        self.handle = ctypes.c_void_p(lib.auto_new())

    def close(self):
        """Free the model."""
        self.lib.auto_free(self.handle)

    def state(self):
        """A Found."""
        state = (ctypes.c_uint64 * 5)()
        self.lib.auto_state(self.handle, state)
        return Found(state[0], state[1], state[2], state[3], state[4])

    def reset(self):
        """One clock of reset, then the silence that the core must see."""
        self.lib.auto_reset(self.handle)
        self.rest(0.002)

    def rest(self, seconds, level=1):
        """The line has this level for so long."""
        self.lib.auto_rest(self.handle, ctypes.c_double(seconds * self.hz), level)

    def echo(self, on):
        """Does the device hear what it sends?"""
        self.lib.auto_echo(self.handle, int(on))

    def noise(self, seconds, shortest, longest, silence, seed):
        """Runs of random length between two times in seconds, now and then a silence."""
        times = (ctypes.c_double(time * self.hz) for time in (seconds, shortest, longest, silence))
        self.lib.auto_noise(self.handle, *times, ctypes.c_uint32(seed))


class Master:
    """A master on the line of a Device: rate in bits per second, a Format, faults in fractions of a bit."""

    def __init__(self, device, rate, fmt, rng, offset=0.0, skew=0.0, jitter=0.0, gap=0.0):
        self.device, self.rate, self.fmt, self.rng = device, rate, fmt, rng
        self.bit = device.hz / rate * (1 + offset)
        self.skew, self.jitter, self.gap = skew, jitter, gap

    def send(self, frame, skip_bits=0.0):
        """Put a frame on the line; its first `skip_bits` are not heard."""
        d = self.device
        bits = (skip_bits * self.bit, self.skew * self.bit, self.jitter * self.bit)
        times = map(ctypes.c_double, (self.rng.random(), self.gap, *bits))
        bit = ctypes.c_double(self.bit)
        data = (ctypes.c_uint8 * len(frame)).from_buffer_copy(frame)
        seed = ctypes.c_uint32(self.rng.getrandbits(32))
        d.lib.auto_send(d.handle, data, len(frame), bit, self.fmt.code, *times, seed)

    def answer(self, patience_bits=PATIENCE_BITS, patience_s=PATIENCE_S):
        """The bytes of an answer, b"" for silence, None for one that is not of this rate and format."""
        d = self.device
        data, begin = (ctypes.c_uint8 * 300)(), ctypes.c_double()
        patience = ctypes.c_double(patience_bits * self.bit + patience_s * d.hz)
        count = d.lib.auto_answer(
            d.handle, ctypes.c_double(self.bit), self.fmt.code, patience, data, 300, ctypes.byref(begin)
        )
        return None if count < 0 else bytes(data[:count])

    def silence(self):
        """The shortest silence between two frames."""
        self.device.rest(T35_BITS / self.rate + T35_S)

    def ask(self, frame, **how):
        """Send a request; was a whole answer to it understood?"""
        self.send(frame, **how)
        answer = self.answer(PATIENCE_BITS + 12 * len(frame))
        self.silence()
        return bool(answer) and frames.check(answer) and answer[0] == frame[0] and answer[1] & 0x7F == frame[1]


def request(rng, longest=20):
    """Any request for OWN of at most `longest` bytes that is answered, be it by an exception."""
    word = lambda: rng.choice((0, 1, 0xFFFF, rng.getrandbits(16), rng.randrange(16)))  # noqa: E731
    while True:
        kind = rng.randrange(8)
        if kind < 3:
            pdu = bytes([rng.choice((1, 2, 3, 4, 3, 4))]) + frames.pack_words([word(), rng.randrange(1, 126)])
        elif kind == 3:
            pdu = bytes([rng.choice((5, 6, 6))]) + frames.pack_words([word(), word()])
        elif kind == 4:
            pdu = frames.write_registers(word(), [word() for _ in range(rng.randrange(1, 8))])
        elif kind == 5:
            pdu = frames.mask_write(word(), word(), word())
        elif kind == 6:
            pdu = rng.choice((bytes([FC.REPORT_SERVER_ID]), frames.device_identification(1)))
        else:
            pdu = bytes([rng.randrange(0x20, 0x28)]) + bytes(rng.getrandbits(8) for _ in range(rng.randrange(0, 12)))
        frame = frames.adu(OWN, pdu)
        if len(frame) <= longest:
            return frame


def start(device, rate, fmt, rng, most=4, **faults):
    """Switch on somewhere in the traffic of a master; how many requests until the first answer (most + 1: none)."""
    device.reset()
    master = Master(device, rate, fmt, rng, **faults)
    before = request(rng)
    if rng.random() < 0.7:  # in the middle of a request, else in a pause
        master.send(before, skip_bits=rng.random() * 10 * len(before))
    device.rest(T35_S + (T35_BITS + rng.random() * 100) / rate)
    for number in range(1, most + 1):
        if master.ask(request(rng)):
            return number
        device.rest(rng.random() * 50 / rate)
    return most + 1


__all__ = ["CLK_HZ", "FORMATS", "OWN", "RATES", "Device", "Found", "Master", "clock_for", "request", "start"]
