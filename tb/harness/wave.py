# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Characters to line levels over time and back, exact to the picosecond, without a simulator.

A wave is a list of (time, level): the line has `level` from `time` on.  Times are integers in
picoseconds from the start of the wave; an idle line is 1.
"""

from dataclasses import dataclass, field

from protocol.model import characters

IDLE, START = 1, 0


def parity_bit(byte, fmt):
    """The parity bit of `byte` in `fmt`, which has parity."""
    return (bin(byte).count("1") & 1) ^ (fmt.parity == "odd")


def bits(character, fmt):
    """[level, ...] of one character, start bit first; a faulty stop bit is followed by one bit of 1."""
    out = [START] + [(character.byte >> i) & 1 for i in range(fmt.data_bits)]
    if fmt.parity:
        out.append(parity_bit(character.byte, fmt) ^ (character.error == "parity"))
    elif character.error == "parity":
        raise ValueError(f"{fmt.name} has no parity bit to spoil")
    if character.error == "framing":
        return out + [START] * fmt.stops + [IDLE]
    return out + [IDLE] * fmt.stops


@dataclass
class Wave:
    """What the line does: edges, begin of each character, end of the last stop bit (ps)."""

    edges: list = field(default_factory=list)
    starts: list = field(default_factory=list)
    end: int = 0


def encode(line, fmt, bit_ps, offset=0.0, jitter=None):
    """The wave of `line` (bytes or (byte, gap, error)).

    `bit_ps` is the nominal bit; the sender's bits are longer by the fraction `offset`.  Gaps are in
    nominal characters.  `jitter`, if given, is called for each edge and adds picoseconds to it.
    """
    wave, time, level = Wave(), 0.0, IDLE
    sent_bit = bit_ps * (1 + offset)
    for place, character in enumerate(characters(line)):
        if place:
            time += character.gap * fmt.length * bit_ps
        wave.starts.append(round(time))
        for bit in bits(character, fmt):
            if bit != level:
                wave.edges.append((round(time + (jitter() if jitter else 0)), bit))
                level = bit
            time += sent_bit
    wave.end = round(time)
    return wave


def low(duration_ps):
    """A line held low: a break, or a spike that becomes one."""
    duration_ps = round(duration_ps)
    return Wave([(0, START), (duration_ps, IDLE)], [0], duration_ps)


def with_spikes(edges, spikes, idle=IDLE):
    """`edges` with the line inverted during each (begin, width) of `spikes`, in ps."""
    toggles = []
    level = idle
    for time, new in edges:
        if new != level:
            toggles.append(time)
            level = new
    for begin, width in spikes:
        toggles += [round(begin), round(begin + width)]
    out, level = [], idle
    for time in sorted(toggles):
        level ^= 1
        if out and out[-1][0] == time:
            out.pop()
        else:
            out.append((time, level))
    return out


class LineError(AssertionError):
    """What was on the line is no clean sequence of characters."""


@dataclass
class Decoded:
    """Characters taken off the line: bytes, start of the first, end of the last stop bit (ps)."""

    data: bytes
    start: int
    end: int


def decode(edges, fmt, bit_ps, slack=0):
    """Characters that must follow each other without a gap, every edge at most `slack` ps off the bit grid.

    Raises LineError with the reason.  `edges` begins with the first falling edge.
    """
    if not edges or edges[0][1] != START:
        raise LineError(f"the answer does not begin with a start bit: {edges[:2]}")
    origin = edges[0][0]
    levels, level = [], IDLE
    for place, (time, new) in enumerate(edges):
        slots = (time - origin + slack) // bit_ps
        rest = time - origin - slots * bit_ps
        if rest > slack:
            raise LineError(f"edge {place} is {rest / bit_ps:.3f} bits off the grid of bit times")
        levels += [level] * (slots - len(levels))
        level = new
    if level != IDLE:
        raise LineError("the line stays low")
    length = fmt.length
    levels += [IDLE] * (-len(levels) % length)
    data = bytearray()
    for begin in range(0, len(levels), length):
        one = levels[begin : begin + length]
        where = f"character {begin // length}"
        if one[0] != START:
            raise LineError(f"{where} does not follow without a gap (or a stop bit is too long)")
        byte = sum(bit << i for i, bit in enumerate(one[1 : 1 + fmt.data_bits]))
        if fmt.parity and one[1 + fmt.data_bits] != parity_bit(byte, fmt):
            raise LineError(f"{where} ({byte:02X}) has wrong {fmt.parity} parity")
        if any(bit != IDLE for bit in one[length - fmt.stops :]):
            raise LineError(f"{where} ({byte:02X}) has a low stop bit")
        data.append(byte)
    return Decoded(bytes(data), origin, origin + len(levels) * bit_ps)
