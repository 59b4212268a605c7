# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Draw the first transaction of a bridge trace as SVG: rxd, txd, de, the bytes, and t3.5.

Everything is measured from the edges of the trace; nothing is drawn from what should have happened.
"""

from dataclasses import dataclass
from html import escape

PARITY_BITS = {0: 1, 1: 1, 2: 0, 3: 0}  # by format code of the core: 8E1 8O1 8N2 8N1
STOP_BITS = {0: 1, 1: 1, 2: 2, 3: 1}
NAMES = {0: "8E1", 1: "8O1", 2: "8N2", 3: "8N1"}

WIDTH, LEFT, RIGHT = 1480, 64, 24
INK, GREY, GRID = "#1f2933", "#6b7785", "#dfe4ea"
MASTER, SLAVE, DRIVE, WAIT = "#1769aa", "#1b7f4b", "#b3541e", "#fff3d6"
SWING = 26  # height of a wave


@dataclass
class Trace:
    """Pin levels over time: rows of (cycle, rxd, txd, de)."""

    clock_hz: int
    bit_time: int
    format: int
    t35: int
    rows: list

    @property
    def character(self):
        """Bits in one character."""
        return 9 + PARITY_BITS[self.format] + STOP_BITS[self.format]

    def ms(self, cycles):
        """Clock cycles in milliseconds."""
        return cycles * 1000 / self.clock_hz

    def edges(self, pin):
        """(cycle, level) where pin 1 (rxd), 2 (txd) or 3 (de) changes, its first level included."""
        found = []
        for row in self.rows:
            if not found or row[pin] != found[-1][1]:
                found.append((row[0], row[pin]))
        return found

    def characters(self, pin):
        """(first cycle, byte) of each character, sampled in the middle of its bits."""
        edges = self.edges(pin)
        found, busy_until = [], 0

        def level(cycle):
            return [value for at, value in edges if at <= cycle][-1]

        for cycle, value in edges:
            if value == 0 and cycle >= busy_until:
                middle = cycle + self.bit_time // 2
                byte = sum(level(middle + (1 + i) * self.bit_time) << i for i in range(8))
                found.append((cycle, byte))
                busy_until = cycle + (self.character - 1) * self.bit_time
        return found


def load(path):
    """Read a trace that the bridge wrote."""
    with open(path, encoding="ascii") as file:
        head = file.readline().split()[1:]
        setup = {k: int(v) for k, v in zip(head[::2], head[1::2])}
        rows = [tuple(map(int, line.split())) for line in file if not line.startswith("#")]
    return Trace(setup["clock_hz"], setup["bit_time"], setup["format"], setup["t35"], rows)


def fields(frame, asked):
    """(bytes, name) of the fields of a request or answer of function 03; one nameless field for others."""
    if asked and frame[1] == 3:
        return [(1, f"slave {frame[0]}"), (1, "read"), (2, f"from {frame[2] << 8 | frame[3]}"),
                (2, f"{frame[4] << 8 | frame[5]} registers"), (2, "CRC")]  # fmt: skip
    if frame[1] == 3:
        words = [(2, str(frame[i] << 8 | frame[i + 1])) for i in range(3, len(frame) - 2, 2)]
        return [(1, f"slave {frame[0]}"), (1, "read"), (1, f"{frame[2]} bytes"), *words, (2, "CRC")]
    return [(len(frame), "")]


class Picture:
    """SVG elements, and the place of a cycle on the paper."""

    def __init__(self, trace, first, last, height):
        self.trace, self.first, self.height = trace, first, height
        self.scale = (WIDTH - LEFT - RIGHT) / (last - first)
        self.out = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}"'
            f' height="{height}" font-family="DejaVu Sans, Helvetica, Arial, sans-serif">',
            f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
        ]

    def x(self, cycle):
        """Where a cycle is on the paper."""
        return LEFT + (cycle - self.first) * self.scale

    def text(self, x, y, what, size=12, fill=INK, anchor="middle", extra=""):
        """Words at a place."""
        self.out.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{fill}" text-anchor="{anchor}"{extra}>'
            f"{escape(what)}</text>"
        )

    def line(self, x1, y1, x2, y2, stroke=GREY, width=1.0, extra=""):
        """A straight line."""
        self.out.append(
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{stroke}"'
            f' stroke-width="{width}"{extra}/>'
        )

    def box(self, x1, x2, y, height, fill, stroke="none", extra=""):
        """A rectangle."""
        self.out.append(
            f'<rect x="{x1:.1f}" y="{y:.1f}" width="{x2 - x1:.1f}" height="{height}" fill="{fill}"'
            f' stroke="{stroke}"{extra}/>'
        )

    def wave(self, name, pin, last, y, colour):
        """A pin's level from the left to the right end."""
        edges = self.trace.edges(pin)
        level = [value for at, value in edges if at <= self.first][-1]

        def height(value):
            return y + (0 if value else SWING)

        path = [f"M{self.x(self.first):.1f} {height(level):.1f}"]
        for at, value in edges:
            if self.first < at < last:
                path.append(f"H{self.x(at):.1f}V{height(value):.1f}")
        path.append(f"H{self.x(last):.1f}")
        self.out.append(
            f'<path d="{"".join(path)}" fill="none" stroke="{colour}" stroke-width="1.4" stroke-linejoin="round"/>'
        )
        self.text(LEFT - 12, y + SWING / 2 + 5, name, 14, colour, "end", ' font-weight="bold"')

    def frame(self, characters, asked, y, colour):
        """The bytes of a frame as boxes, their fields below or above in words."""
        length = self.trace.character * self.trace.bit_time
        for cycle, byte in characters:
            x1, x2 = self.x(cycle), self.x(cycle + length)
            self.box(x1 + 0.8, x2 - 0.8, y, 24, colour, extra=' rx="3" fill-opacity="0.12"')
            self.text((x1 + x2) / 2, y + 17, f"{byte:02X}", 14, colour, extra=' font-weight="bold"')
        starts = [cycle for cycle, _ in characters]
        at = 0
        for count, name in fields([byte for _, byte in characters], asked):
            x1, x2 = self.x(starts[at]) + 2, self.x(starts[at + count - 1] + length) - 2
            self.line(x1, y - 7, x2, y - 7, colour, 1.2)
            self.text((x1 + x2) / 2, y - 13, name, 11.5, colour)
            at += count

    def span(self, from_cycle, to_cycle, y, colour=INK):
        """A double arrow between two moments."""
        x1, x2 = self.x(from_cycle), self.x(to_cycle)
        self.line(x1, y, x2, y, colour, 1.2)
        for x, step in ((x1, 6), (x2, -6)):
            self.out.append(f'<path d="M{x:.1f} {y}l{step} -3.5v7z" fill="{colour}"/>')


def draw(trace_path, svg_path, title):
    """Draw the first request and its answer."""
    trace = load(trace_path)
    length = trace.character * trace.bit_time
    driven = [at for at, _ in trace.edges(3)][1:3]  # de rises, de falls
    asked = [c for c in trace.characters(1) if c[0] < driven[0]]
    answered = [c for c in trace.characters(2) if driven[0] <= c[0] < driven[1]]
    end, begin = asked[-1][0] + length, answered[0][0]
    margin = length // 2
    first, last = asked[0][0] - margin, driven[1] + margin

    height = 424
    picture = Picture(trace, first, last, height)
    top, bottom = 62, 372
    picture.box(picture.x(end), picture.x(end + trace.t35), top, bottom - top, WAIT)

    # Time, in milliseconds from the first start bit.
    zero = asked[0][0]
    step = 1 if trace.ms(last - first) <= 30 else 5
    for ms in range(0, int(trace.ms(last - zero)) + 1, step):
        x = picture.x(zero + ms * trace.clock_hz / 1000)
        picture.line(x, top, x, bottom, GRID)
        picture.text(x, bottom + 16, f"{ms}", 11, GREY)
    picture.text(WIDTH - RIGHT, bottom + 34, "milliseconds", 11, GREY, "end")

    picture.text(LEFT, 26, title, 17, INK, "start", ' font-weight="bold"')
    baud = trace.clock_hz / trace.bit_time
    picture.text(
        LEFT, 46, f"{baud:.0f} baud, {NAMES[trace.format]}; from the pins of the running RTL", 12, GREY, "start"
    )

    picture.frame(asked, True, 96, MASTER)
    picture.wave("rxd", 1, last, 134, MASTER)
    picture.frame(answered, False, 212, SLAVE)
    picture.wave("txd", 2, last, 250, SLAVE)
    picture.wave("de", 3, last, 316, DRIVE)

    middle = picture.x(end + trace.t35 / 2)
    picture.span(end, end + trace.t35, 190)
    picture.text(middle, 184, f"t3.5 = {trace.ms(trace.t35):.3f} ms", 12)
    picture.text(middle, 208, f"answer after {trace.ms(begin - end):.3f} ms", 12, SLAVE)
    picture.line(picture.x(begin), 196, picture.x(begin), 316 + SWING, SLAVE, 1, ' stroke-dasharray="3 3"')
    picture.text(
        LEFT,
        bottom + 34,
        f"request {len(asked)} bytes, {trace.ms(end - zero):.2f} ms;  answer {len(answered)} bytes,"
        f" {trace.ms(answered[-1][0] + length - begin):.2f} ms",
        12,
        INK,
        "start",
    )
    picture.out.append("</svg>")
    with open(svg_path, "w", encoding="utf-8") as file:
        file.write("\n".join(picture.out) + "\n")
