# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What docs/auto_line.md says of modbus_auto_line: requests until the first answer, a changed rate, noise."""

import itertools
import random
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial

from harness import wave
from protocol import frames

from .lab import FORMATS, OWN, RATES, Device, Master, clock_for, request, start

SEED = 1
MOST = 4  # requests that are tried


def fits_two(frame):
    """Is a frame the same on the line in 8N2 and in 8E1 or 8O1: do all bytes have the same parity?"""
    return len({bin(byte).count("1") & 1 for byte in frame}) == 1


def hides(frame, fmt, skip_bits, silence_bits):
    """May the end of a frame, heard from a bit on, hide the frame behind it?

    The silence that ends a frame is 32 times its shortest run, at most.  The end of one character may have long runs
    only; it looks like a slow frame that has not ended yet.  Behind a bit that was cut, which looks fast, the
    frame comes in pieces, and the last of them may be its last run.
    """
    edges = wave.encode(frame, fmt, 1).edges
    missed = [level for time, level in edges if time < skip_bits]
    heard = [time for time, _ in edges if time >= skip_bits]
    if missed and not missed[-1]:
        heard = [skip_bits, *heard]  # it is low already
    runs = [end - begin for begin, end in itertools.pairwise(heard)]
    return bool(runs) and silence_bits < 32 * (runs[-1] if runs[0] < 1 else min(runs))


def starts(each, seed=SEED, rates=RATES):
    """{(rate, format name): Counter of requests until the first answer} of so many random starts for each."""
    pairs = [(rate, fmt) for rate in sorted(rates) for fmt in FORMATS]  # the slowest, which take longest, first
    with ProcessPoolExecutor() as pool:
        found = pool.map(partial(_starts_of, each=each, seed=seed), pairs)
        return {(rate, fmt.name): counter for (rate, fmt), counter in zip(pairs, found)}


def _starts_of(pair, each, seed):
    """The Counter of a rate and format, with a device and random numbers of its own."""
    rate, fmt = pair
    rng, device = random.Random(seed + rate + fmt.code), Device(clock_for(rate))
    found = Counter(start(device, rate, fmt, rng) for _ in range(each))
    device.close()
    return found


def changed_rate(device, changes, seed=SEED, rates=RATES):
    """Counter of frames until the lock is right again behind a change of rate or format (MOST + 1: never)."""
    rng, found = random.Random(seed), Counter()
    before = None
    device.reset()
    for _ in range(changes):
        rate, fmt = before or (rng.choice(rates), rng.choice(FORMATS))
        master = Master(device, rate, fmt, rng)
        for _ in range(3):  # settle
            master.ask(request(rng))
        while (rate, fmt) == (master.rate, master.fmt):
            rate, fmt = rng.choice(rates), rng.choice(FORMATS)
        device.rest(0.01 + 100 / min(rate, master.rate))
        master = Master(device, rate, fmt, rng)
        number = 1
        while not master.ask(request(rng)) and number <= MOST:
            device.rest(0.01 + 50 / rate)
            number += 1
        found[number] += 1
        before = rate, fmt
    return found


def noise(device, frames_of_noise, seed=SEED, rate=115200, bytes_each=8):
    """How often noise for so many frame times locked."""
    device.reset()
    before = device.state().locks
    bit = 1 / rate
    rng = random.Random(seed)
    left = frames_of_noise * bytes_each * 11 * bit
    while left > 0:
        span = min(left, 0.5)
        shortest = bit * rng.choice((0.05, 0.5, 0.9, 1))
        longest, silence = shortest * rng.choice((1.2, 4, 9)), rng.choice((20, 40, 200)) * bit
        device.noise(span, shortest, longest, silence, rng.getrandbits(32))
        left -= span
    return device.state().locks - before


def foreign(address, rng):
    """A good frame for another slave."""
    return frames.adu(address, request(rng)[1:-2])


__all__ = ["OWN", "changed_rate", "fits_two", "foreign", "hides", "noise", "starts"]
