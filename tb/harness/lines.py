# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Lines of characters with something wrong in them, for Line.send and the model alike."""

from protocol.defs import T15_CHARACTERS, T35_CHARACTERS


def with_gap(frame, place, gap):
    """`frame` with a silence of `gap` characters before byte `place`."""
    return [(byte, gap if i == place else 0, None) for i, byte in enumerate(frame)]


def with_error(frame, place, error):
    """`frame` with a parity or framing error in byte `place`."""
    return [(byte, 0, error if i == place else None) for i, byte in enumerate(frame)]


def scaled(tb, gap):
    """A gap given for 1.5 / 3.5 characters, where the floors make them longer."""
    t15, t35 = tb.slave.config.t15, tb.slave.config.t35
    if gap <= T15_CHARACTERS:
        return gap / T15_CHARACTERS * t15
    if gap >= T35_CHARACTERS:
        return gap / T35_CHARACTERS * t35
    between = (gap - T15_CHARACTERS) / (T35_CHARACTERS - T15_CHARACTERS)
    return t15 + between * (t35 - t15)
