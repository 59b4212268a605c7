# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What several outputs need: names, blocks of a request, numbers as text."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from modbus_map.model import READ_FUNCTION, Device, Point, exact_of, is_bit_table

MOST_BITS, MOST_REGISTERS = 2000, 125  # of one read request
MOST_WRITTEN_BITS, MOST_WRITTEN = 1968, 123  # of one write request
TABLE_TITLES = {
    "coils": "Coils",
    "discrete_inputs": "Discrete inputs",
    "input_registers": "Input registers",
    "holding_registers": "Holding registers",
}


@dataclass(frozen=True)
class Block:
    """Addresses that one request reads: whole items, without a gap that would be refused."""

    table: str
    at: int
    size: int
    items: tuple[tuple[Point, int], ...]  # (point, item)


def most_of_protocol(table: str, write: bool = False) -> int:
    """Items that one request may have, whatever the device."""
    if is_bit_table(table):
        return MOST_WRITTEN_BITS if write else MOST_BITS
    return MOST_WRITTEN if write else MOST_REGISTERS


def most(device: Device, table: str, write: bool = False) -> int:
    """Items that one request may have: what the protocol allows, or fewer if the map says so (`core`)."""
    name = f"MAX_{'WRITE' if write else 'READ'}_{'BITS' if is_bit_table(table) else 'REGISTERS'}"
    return min(most_of_protocol(table, write), device.core_parameter(name))


def blocks(device: Device, most_registers: int = MOST_REGISTERS) -> list[Block]:
    """The fewest requests that read all that can be read; neighbours are joined, an item is never cut.

    A table whose gaps read as zero is still read without its gaps: they cost time on the line.
    """
    made = []
    for table, points in device.tables():
        if not device.has_function(READ_FUNCTION[table]):
            continue
        limit = most(device, table)
        limit = limit if is_bit_table(table) else min(limit, most_registers)
        open_: list[tuple[Point, int]] = []
        at = end = 0
        for point in points:
            for item in range(point.count if point.readable else 0):
                first = point.at + item * point.width
                if open_ and (first != end or first + point.width - at > limit):
                    made.append(Block(table, at, end - at, tuple(open_)))
                    open_ = []
                if not open_:
                    at = first
                open_.append((point, item))
                end = first + point.width
        if open_:
            made.append(Block(table, at, end - at, tuple(open_)))
    return made


def item_name(point: Point, item: int) -> str:
    """The name of an item: that of the point, with its index if it is an array."""
    return f"{point.name}_{item}" if point.is_array else point.name


def item_doc(point: Point, item: int) -> str:
    """A readable name: `Motor current`, `Relay 2`."""
    text = point.name.replace("_", " ").capitalize()
    return f"{text} {item}" if point.is_array else text


def camel(name: str) -> str:
    """RelayBox of relay_box."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def decimal(number: float | Fraction) -> str:
    """A number as people write it: 45, 0.1, 1e-07."""
    value = float(number)
    return str(int(value)) if value.is_integer() and abs(value) < 1e16 else repr(value)


def decimals(point: Point) -> int:
    """Digits behind the point that a scaled value needs; 3 for a float."""
    if point.is_float:
        return 3
    for digits in range(13):
        if all((exact_of(n) * 10**digits).denominator == 1 for n in (point.scale, point.offset)):
            return digits
    return 12


def scaled(point: Point, number: int | float | str) -> Fraction | float:
    """A number in the point's unit."""
    if point.is_float:
        return float(number) * point.scale + point.offset
    return Fraction(number) * exact_of(point.scale) + exact_of(point.offset)


def has_names(point: Point) -> bool:
    """True if values are shown by the names of `enum`: it names numbers, so a scaled point has none."""
    return bool(point.enum) and not point.is_scaled and not point.is_float and not point.is_string


def shown(point: Point, raw: int) -> str:
    """A raw value as a manual prints it, without its unit."""
    if has_names(point) and (label := point.label(raw)):
        return f"{point.number(raw)} ({label})"
    value = point.value(raw)
    if isinstance(value, str):
        return f'"{value}"' if value else ""
    if point.is_float or not point.is_scaled or isinstance(value, int):
        return decimal(value) if value == value and abs(value) != float("inf") else str(value)
    return f"{value:.{decimals(point)}f}"


def span(point: Point) -> str:
    """What may be written, as a manual prints it; nothing if there is no limit."""
    if point.minimum is None and point.maximum is None:
        return "listed values" if point.enum_is_limit else ""
    low = shown(point, point.minimum) if point.minimum is not None else "least"
    high = shown(point, point.maximum) if point.maximum is not None else "greatest"
    return f"{low} to {high}"


def comment(text: str) -> str:
    """A text that is safe in a one-line comment of any language: one line, and no end of a C comment."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split()).rstrip("\\")
