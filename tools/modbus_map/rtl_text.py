# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Small pieces of Verilog text."""

from __future__ import annotations

COLUMNS = 100


def bits(width: int) -> str:
    """`[7:0]`; nothing for one bit."""
    return f"[{width - 1}:0]" if width > 1 else ""


def literal(width: int, value: int) -> str:
    """A sized number: decimal up to 16 bits, hexadecimal above."""
    return f"{width}'d{value}" if width <= 16 else f"{width}'h{value:0{(width + 3) // 4}X}"


def slice_of(name: str, width: int, high: int, low: int) -> str:
    """Bits of a signal of `width` bits; the name alone for all of them."""
    if width == high - low + 1:
        return name
    return f"{name}[{high}:{low}]" if high > low else f"{name}[{high}]"


def lines_of(words: list[str], room: int) -> list[str]:
    """The words in lines, as many on a line as there is room for."""
    lines, line = [], ""
    for word in words:
        if line and len(line) + len(word) > room:
            lines.append(line)
            line = ""
        line += (" " if line else "") + word
    return [*lines, line] if line else lines


def listed(items: list[str], end: str = "") -> list[str]:
    """The items with commas between them, and `end` behind the last."""
    return [item + ("," if n + 1 < len(items) else end) for n, item in enumerate(items)]


def fill(labels: list[str], behind: str) -> list[str]:
    """The labels of a row of a case."""
    lines = lines_of(listed(labels), COLUMNS - 30)
    return [*lines[:-1], lines[-1] + behind] if lines else []


def packed(items: list[str], end: str, indent: str) -> list[str]:
    """Connections; behind the last one stands `end`."""
    return [indent + line for line in lines_of(listed(items, end), COLUMNS + 8)]


def aligned(ports: list[tuple[str, str, str, str]]) -> list[str]:
    """Port declarations of (direction, range, name, comment), in columns; without a comma behind the last."""
    span = max(6, *(len(p[1]) for p in ports))
    name = max(len(p[2]) for p in ports) + 1
    lines = []
    for n, (direction, width, port, comment) in enumerate(ports):
        comma = "," if n + 1 < len(ports) else ""
        line = f"  {direction} {width:<{span}} {port + comma:<{name}}"
        lines.append(f"{line}  // {comment}".rstrip() if comment else line.rstrip())
    return lines
