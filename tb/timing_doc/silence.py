# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Where t1.5 and t3.5 end."""

import math

from protocol.defs import F8E1

from .device import ERRORS, JUDGED, mask
from .lab import CLK_HZ, number, t15, t35, table
from .receiver import SHORT, first_true


def silences(lab):
    """Table `silence`: t1.5 and t3.5 as the device sees them."""
    rows = []
    for baud, floors in ((9600, 1), (19200, 1), (38400, 1), (115200, 1), (115200, 0)):
        device = lab(0, floors)
        bit_time = round(CLK_HZ / baud)
        device.setup(bit_time)
        want15, want35 = t15(bit_time, F8E1, floors), t35(bit_time, F8E1, floors)
        bit_end = 2 * bit_time
        quarter = bit_time // 4
        base15, base35 = math.ceil(want15) - bit_time, math.ceil(want35) - bit_time
        floor15, floor35 = want15 > 16.5 * bit_time, want35 > 38.5 * bit_time
        device.reset(want35 + bit_end)
        found15 = base15 + first_true(
            lambda x, args=(device, base15, want35): spoils(args[0], args[1] + x, args[2]),
            bit_end,
            bit_time - 2 * quarter + 2 if floor15 else bit_time - quarter,
        )
        found35 = base35 + first_true(
            lambda x, args=(device, base35, want35): two_frames(args[0], args[1] + x, args[2]),
            bit_end,
            bit_time - 2 * quarter + 21 if floor35 else bit_time - quarter,
        )
        end, log = device.request(SHORT, want35 + bit_time, log=mask("frame"))
        ended = log.rises("frame")[0] - end
        rows.append(
            [baud, "on" if floors else "0", bit_time]
            + [number(want15), number(found15), f"{(found15 - want15) / bit_time:+.2f}"]
            + [number(want35), number(ended), number(ended - want35)]
            + [number(found35), f"{(found35 - want35) / bit_time:+.2f}"]
        )
    return {
        "silence": table(
            ["baud", "floors", "clocks per bit", "t1.5", "shortest gap that spoils", "bits off",
             "t3.5", "frame ends after", "clocks late", "shortest gap between frames", "bits off"], rows,
        )
    }  # fmt: skip


def gapped(device, line, place, clocks):
    """(edges, end) of a line with a silence of so many clocks before character `place`."""
    one, end = device.wave(line[:place])
    two, last = device.wave(line[place:], phase=end + clocks)
    return one + two, last


def spoils(device, clocks, silence):
    """True if a frame with so many clocks of silence in it is discarded for the gap."""
    edges, end = gapped(device, SHORT, 2, clocks)
    log = device.run(end + silence + device.bit_time, edges, log=JUDGED)
    return bool(log.rises("gap"))


def two_frames(device, clocks, silence):
    """True if two frames with so many clocks between them are both heard as good."""
    edges, end = gapped(device, SHORT + SHORT, len(SHORT), clocks)
    log = device.run(end + silence + device.bit_time, edges, log=JUDGED)
    return len(log.rises("frame")) == 2 and not any(log.rises(name) for name in ERRORS)
