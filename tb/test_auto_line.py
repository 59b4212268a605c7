# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_auto_line beside the core, compiled, against masters of any rate and format: docs/auto_line.md."""

import random
import shutil

import pytest
from auto_line.lab import CLK_HZ, FORMATS, NOISE_HZ, OWN, RATES, Device, Master, clock_for, request
from auto_line.measure import SEED, changed_rate, fits_two, foreign, hides, noise
from harness.volume import IS_FULL, volume
from protocol import frames

pytestmark = pytest.mark.skipif(not shutil.which("verilator"), reason="verilator is not installed")
FAST = (230400, 115200, 57600, 38400, *([19200] if IS_FULL else []))


class Devices(dict):
    """A device for each clock, made when it is asked for."""

    def __missing__(self, hz):
        return self.setdefault(hz, Device(hz))


@pytest.fixture(scope="module")
def devices():
    made = Devices()
    yield made
    for one in made.values():
        one.close()


@pytest.fixture(scope="module")
def device(devices):
    return devices[CLK_HZ]


def first_answer(master, rng, first=None, most=4):
    """How many requests until the first answer."""
    for number in range(1, most + 1):
        if master.ask(first or request(rng)):
            return number
        first = None
    return most + 1


@pytest.mark.parametrize("fmt", FORMATS, ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("rate", RATES)
def test_first_request_is_answered(devices, rate, fmt):
    """At power-up anywhere in the traffic.  A frame that fits two formats may cost a request, and one that is hidden.

    With the first format the first start is at 12 MHz whatever the rate, the others have the clock for volume.
    """
    rng = random.Random(SEED + rate + fmt.code)
    for start in range(volume("random starts of the automatic line") // 36):
        device = devices[clock_for(rate) if start or fmt != FORMATS[0] else CLK_HZ]
        device.reset()
        master, hidden = Master(device, rate, fmt, rng), False
        silence = 40 + 100 * rng.random() + 0.00175 * rate
        if rng.random() < 0.7:
            before = request(rng)
            skipped = (0.01 + 0.98 * rng.random()) * 10 * len(before)
            hidden = hides(before, fmt, skipped, silence)
            master.send(before, skip_bits=skipped)
        device.rest(silence / rate)
        first = request(rng)
        number, found = first_answer(master, rng, first), device.state()
        most = 1 + (fits_two(first) or hidden)
        assert number <= most, f"request {number} was the first answered: {frames.text(first)}, {found}"
        if number == 1 and not fits_two(first):
            assert (found.locked, found.format) == (1, fmt.code)
            assert found.bit_time == (device.hz + rate // 2) // rate


def test_frame_for_another_slave_locks(device):
    rng = random.Random(SEED)
    for rate in FAST:
        for fmt in FORMATS:
            device.reset()
            master = Master(device, rate, fmt, rng)
            while fits_two(frame := foreign(5, rng)):
                pass
            counted = device.state().frames
            assert not master.ask(frame)
            assert (device.state().locked, device.state().format) == (1, fmt.code)
            assert device.state().frames == counted, "a frame for another slave was played to the core"
            assert master.ask(request(rng))


def test_each_request_is_counted_once(device):
    """Neither the frame that locks nor those behind it reach the core twice."""
    rng = random.Random(SEED)
    for rate in FAST:
        device.reset()
        master = Master(device, rate, FORMATS[0], rng)
        before = device.state().frames
        for number in range(1, 6):
            assert master.ask(request(rng))
            assert device.state().frames - before == number


def test_broadcast_that_locks_is_obeyed(device):
    rng = random.Random(SEED)
    device.reset()
    master = Master(device, 19200, FORMATS[0], rng)
    before = device.state().frames
    master.send(frames.adu(0, frames.write_registers(0, [1, 2])))
    device.rest(0.05)
    assert device.state().locked and device.state().frames == before + 1


def test_changed_rate_is_found_within_two_frames(device):
    found = changed_rate(device, volume("changes of the rate"), rates=FAST)
    assert set(found) <= {1, 2}, f"frames until the next answer: {dict(found)}"


def test_noise_does_not_lock(devices):
    count = volume("frame times of noise")
    locks = noise(devices[CLK_HZ if count <= 10_000 else NOISE_HZ], count)
    # Four formats are tried for each frame, so the check field lets four of 65536 pass at most.
    assert locks <= 3 + 8 * count // 65536, f"{locks} times in {count} frame times"


FAULTS = ({"offset": 0.02}, {"offset": -0.02}, {"skew": 0.03}, {"jitter": 0.05}, {"gap": 1.0})


@pytest.mark.parametrize("faults", FAULTS, ids=str)
def test_line_faults_are_stood(device, faults):
    """A rate off by 2 %, edges that are late, idle bits between characters; skew may cost a request."""
    rng = random.Random(SEED)
    for rate in FAST:
        for fmt in FORMATS:
            device.reset()
            master = Master(device, rate, fmt, rng, **faults)
            first = request(rng)
            spent = first_answer(master, rng, first)
            assert spent <= 1 + (fits_two(first) or "skew" in faults), f"{rate} {fmt.name}: request {spent}"


def test_break_ends_the_lock(device):
    rng = random.Random(SEED)
    device.reset()
    master = Master(device, 19200, FORMATS[0], rng)
    assert first_answer(master, rng) <= 2
    assert master.ask(request(rng)) and device.state().locked
    device.rest(0.02, level=0)
    device.rest(0.02)
    assert not device.state().locked
    assert first_answer(master, rng) <= 2


def test_own_echo_is_not_taken_for_a_request(device):
    """A transceiver that hears itself."""
    rng = random.Random(SEED)
    device.echo(True)
    try:
        for rate in FAST:
            device.reset()
            master = Master(device, rate, FORMATS[0], rng)
            before = device.state().frames
            for number in range(1, 5):
                assert master.ask(request(rng))
                assert device.state().frames - before == number
    finally:
        device.echo(False)


def test_registers_tell_what_was_found(device):
    """Input registers 0 to 2 of the example: bit time, format, locked."""
    rng = random.Random(SEED)
    for fmt in FORMATS:
        device.reset()
        master = Master(device, 9600, fmt, rng)
        assert first_answer(master, rng) <= 2
        request_of_all = frames.adu(OWN, frames.read(4, 0, 3))
        master.send(request_of_all)
        answer = master.answer()
        assert frames.check(answer) and frames.unpack_words(answer[3:-2]) == [device.hz // 9600, fmt.code, 1]


@pytest.mark.parametrize("rate", [1300, 14400, 28800, 31250, 62500, 76800])
def test_other_rates_are_taken_as_measured(devices, rate):
    rng, device = random.Random(SEED), devices[clock_for(rate)]
    for fmt in FORMATS:
        device.reset()
        master = Master(device, rate, fmt, rng)
        first = request(rng)
        assert first_answer(master, rng, first) <= 1 + fits_two(first)
        assert abs(device.state().bit_time * rate / device.hz - 1) < 0.03


def test_long_frames_need_a_longer_memory():
    """With 2^12 words every request is decoded; with 2^8 a longer one is left alone and a short one locks."""
    rng = random.Random(SEED)
    long = frames.adu(OWN, frames.write_registers(0, [rng.getrandbits(16) for _ in range(123)]))
    for bits, answered in ((8, False), (12, True)):
        device = Device(RUN_BITS=bits)
        device.reset()
        master = Master(device, 115200, FORMATS[0], rng)
        assert master.ask(long) == answered
        assert master.ask(request(rng))
        assert master.ask(long)
        device.close()


def test_several_bad_frames_end_the_lock():
    """BAD_FRAMES = 3: two bad frames in a row do not, a good one between them starts the count again."""
    rng = random.Random(SEED)
    device = Device(BAD_FRAMES=3)
    device.reset()
    master = Master(device, 115200, FORMATS[0], rng)
    assert master.ask(request(rng)) or master.ask(request(rng))
    bad = frames.bad_crc(frames.adu(OWN, frames.read(3, 0, 1)))
    for _ in range(2):
        for _ in range(2):
            assert not master.ask(bad) and device.state().locked
        assert master.ask(request(rng))
    for _ in range(3):
        assert device.state().locked
        assert not master.ask(bad)
    assert not device.state().locked
    device.close()
