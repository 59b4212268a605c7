# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the receiver takes: where it looks, mismatch of rates, spikes."""

import random

from protocol import frames

from .device import ERRORS, JUDGED
from .lab import BIT_115200, FEW, OTHER, t35, table


def quick(device, line, **how):
    """True if the first verdict about a frame is good; stops there and resets."""
    wait = t35(device.bit_time, device.fmt, False) + 12 * device.bit_time + 60
    _, _ = device.request(line, wait, stop=JUDGED, **how)
    peek = device.peek()
    good = bool(peek.frame) and not any(getattr(peek, name) for name in ERRORS)
    device.reset()
    return good


def mismatch(lab):
    """Table `baud`: the largest mismatch at which every frame of 256 bytes came through."""
    device, rng, rows = lab(), random.Random(1), []
    body = [bytes([0] * 254), bytes([0xFF] * 254), rng.randbytes(254)]
    long_frames = [frames.sealed(bytes([OTHER]) + data[1:]) for data in body]
    for bit_time in (8, FEW, 100):
        device.setup(bit_time)
        tried = long_frames if bit_time < 100 else long_frames[2:]
        phases = (0, 0.5) if bit_time < 100 else (0,)

        def works(permille, tried=tried, phases=phases):
            return all(
                quick(device, frame, offset=permille / 1000, phase=1 + phase) for frame in tried for phase in phases
            )

        wanted, limits = (2 if bit_time < 16 else 4), []
        for sign in (1, -1):
            good = 0
            for step in (10, 1):
                while good < 100 and works(sign * (good + step)):
                    good += step
            limits.append(good / 10)
        met = "yes" if min(limits) >= wanted else "no"
        rows.append([bit_time, *(f"{limit:.1f} %" for limit in limits), f"{wanted} %", met])
    return {
        "baud": table(["clocks per bit", "sender slower by up to", "sender faster by up to", "wanted", "met"], rows)
    }


SHORT = frames.sealed(bytes([OTHER, 0xA5]))


def looks(lab):
    """Table `looks`: the clocks of a bit in which the line is looked at."""
    device, rows = lab(), []
    place = 11 + 4  # the fourth data bit of the second character: 0 in A5, its neighbours 1 and 0
    for bit_time in (8, 9, 10, 11, FEW, 100, BIT_115200):
        device.setup(bit_time)
        begin = place * bit_time

        def broken(*spikes, begin=begin):
            """The line inverted in these (first, count) clocks of the bit: is the bit lost?"""
            return not quick(device, SHORT, phase=1, spikes=[(begin + b, w) for b, w in spikes])

        # Inverted up to the second look the bit is lost.  With the second look taken, either other one will do.
        second = first_true(lambda x, lost=broken: lost((0, x + 1)), bit_time)
        first = first_true(lambda x, lost=broken, two=second: lost((0, x + 1), (two, 1)), second)
        third = second + first_true(lambda x, lost=broken, two=second: lost((two, 1), (two + 1, x)), bit_time - second)
        rows.append([bit_time, *(f"{x} to {x + 1}" for x in (first, second, third)),
                     ", ".join(f"{(x + 0.5) / bit_time:.3f}" for x in (first, second, third))])  # fmt: skip
    head = ["clocks per bit", "first look", "second", "third", "mean, in bit times"]
    return {"looks": table(head, rows)}


def first_true(test, limit, guess=None):
    """The smallest x from 0 on for which the monotonic `test` holds; a good `guess` saves time."""
    low, high = -1, limit
    if guess is not None and 0 <= guess < limit:
        if test(guess):
            high = guess
            if guess and not test(guess - 1):
                low = guess - 1
        else:
            low = guess
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if test(middle) else (middle, high)
    return high


def spikes(lab):
    """Table `spikes`: the widest spike that changed nothing, wherever it was."""
    device, rows = lab(), []
    for bit_time, step in ((8, 1), (FEW, 3), (100, 13)):
        device.setup(bit_time)
        span = 46 * bit_time
        widest = 0
        for width in range(1 if bit_time < 100 else 24, bit_time):
            # from a bit before the frame to a bit behind it
            places = range(2, span, step)
            if not all(quick(device, SHORT, phase=1 + bit_time, spikes=[(at - bit_time, width)]) for at in places):
                break
            widest = width
        rows.append([bit_time, len(places), widest, f"{widest / bit_time:.3f}"])
    return {"spikes": table(["clocks per bit", "places tried", "widest harmless spike, clocks", "in bit times"], rows)}


def spikes_and_mismatch(lab):
    """Table `spiked`: the widest spike that changed nothing while the sender's rate is off as well."""
    device, rows = lab(), []
    offsets = (0.02, 0.01, 0, -0.01, -0.02)
    for bit_time, step in ((8, 1), (FEW, 1), (32, 3), (100, 7)):
        device.setup(bit_time)
        places = range(2, 46 * bit_time, step)
        found = []
        for offset in offsets:
            width = bit_time // 4
            while width and not all(
                quick(device, SHORT, phase=1 + bit_time, offset=offset, spikes=[(at - bit_time, width)])
                for at in places
            ):
                width -= 1
            found.append(f"{width} ({width / bit_time:.2f})" if width else "none")
        rows.append([bit_time, *found])
    head = [f"sender {abs(o):.0%} {'slower' if o > 0 else 'faster'}" if o else "exact rate" for o in offsets]
    return {"spiked": table(["clocks per bit", *head], rows)}
