# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The compiled devices, and what all measurements share: times, numbers, tables."""

from protocol.defs import F8E1

from .device import Device

BUILDS = {
    "basic": {"FULL": 0, "MORE": 0},
    "full": {"FULL": 1, "MORE": 0},
    "more": {"FULL": 1, "MORE": 1},
    "wide": {"FULL": 1, "MORE": 0, "WIDE": 1},
}
CLK_HZ = 50_000_000
BIT_115200 = 434  # clocks per bit at 115200 baud
FEW = 16  # clocks per bit of the fast links
FLOOR_T15, FLOOR_T35 = CLK_HZ * 750 // 1_000_000, CLK_HZ * 1750 // 1_000_000
OTHER = 99  # another slave's address: the frame is judged and not answered
WORDS = [(0x1357 * i + 0x2468) & 0xFFFF for i in range(125)]
BITS = [(i // 3) & 1 for i in range(2000)]


def t15(bit_time, fmt=F8E1, floors=True):
    """t1.5 in clocks."""
    return max(1.5 * fmt.length * bit_time, FLOOR_T15 if floors else 0)


def t35(bit_time, fmt=F8E1, floors=True):
    """t3.5 in clocks."""
    return max(3.5 * fmt.length * bit_time, FLOOR_T35 if floors else 0)


def number(value):
    """A count with a separator for thousands; fractions with what they need."""
    if abs(value - round(value)) < 1e-9:
        return f"{round(value):,}".replace(",", " ")
    return f"{value:,.2f}".replace(",", " ")


def table(head, rows, left=1):
    """A Markdown table; the first `left` columns are text."""
    mark = ["---"] * left + ["--:"] * (len(head) - left)
    lines = [head, mark, *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


class Lab:
    """The compiled devices, each made when it is first wanted.

    `every`: starts of an answer are measured in devices too that only show what others have shown.
    """

    def __init__(self, every=True):
        self.every, self._made = every, {}

    def __call__(self, io=0, floors=0, build="full"):
        key = (io, floors, build)
        if key not in self._made:
            self._made[key] = Device(IO=io, FLOORS=floors, **BUILDS[build])
        return self._made[key]


# ------------------------------------------------------------------ start of the answer
