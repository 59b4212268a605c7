# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""test_NAME.py: a cocotb bench of the generated top that stands alone beside NAME.v and NAME.f.

Helpers and tests are the same for each device: the text of testbench_runtime.py. Between its two parts stands the
table of points, with values around each limit that the master may write and may not.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from modbus_map.model import ITEMS, READ_FUNCTION, Device, Point
from modbus_map.outputs.shared import most

RUNTIME = Path(__file__).with_name("testbench_runtime.py")
REGISTERS = "holding_registers"


def generate(device: Device) -> dict[str, str]:
    """The one file."""
    text = RUNTIME.read_text(encoding="utf-8")
    head = text.split("# ---- head, copied from here\n")[1].split("# ---- head ends\n")[0]
    body = text.split("# ---- body, copied from here\n")[1]
    return {f"test_{device.name}.py": "\n".join([*opening(device), head.rstrip("\n"), *table(device), body])}


def opening(device: Device) -> list[str]:
    """What the file is, and how it is run."""
    name, source = device.name, f" from {device.source}" if device.source else ""
    return [
        f'"""Tests of {name}: every point, its limits and its rights, at the pins. Made{source} by modbus map.',
        "",
        "It needs cocotb 2 and Icarus Verilog (SIM=verilator takes Verilator). MODBUS_RTU is the folder of the core:",
        "",
        f"    MODBUS_RTU=/path/to/the/core python test_{name}.py",
        '"""',
        "",
    ]


def table(device: Device) -> list[str]:
    """The facts of the device."""
    line, setting = device.line, device.core_parameter
    free = {name: free_addresses(device, name) for name in READ_FUNCTION if device.table(name)}
    files = [(file.number, file.records, file.access) for file in device.files]
    lines = [
        "",
        f'NAME = "{device.name}"',
        f"ADDRESS, FORMAT, RUN_TIME = {line.address}, {line.format_number}, {line.run_time}",
        f"BROADCAST = {bool(setting('BROADCAST'))}",
        f"FUNCTIONS = {device.functions!r}",
        f"MOST_READ, MOST_WRITE = {most(device, REGISTERS)}, {most(device, REGISTERS, True)}  # registers of one request",
        f"T35_MIN_US, RESPONSE_DELAY = {setting('T35_MIN_US')}, {setting('RESPONSE_DELAY')}",
        "POINTS = [",
        *(f"    {line_of(point)}," for point in device.points),
        "]",
        "# Addresses next to the points where nothing is, and tables in which they read 0",
        f"FREE: dict[str, tuple[int, ...]] = {free!r}",
        f"ZERO_GAPS: tuple[str, ...] = {tuple(sorted(device.zero_gaps))!r}",
        f"FILES: list[tuple[int, int, str]] = {files!r}  # number, records, access",
    ]
    return lines


def line_of(point: Point) -> str:
    """A point in the table; what is as usual is left out."""
    facts = [f'"{point.name}"', f'"{point.table}"', str(point.at)]
    usual = {"width": 1, "count": 1, "kind": "register", "access": "rw", "little": False, "strobe": False}
    usual |= {"freeze": "", "fifo": False}
    values: dict[str, object] = {key: getattr(point, key) for key in usual if key != "little"}
    values["little"] = point.word_order == "little" and point.width > 1
    facts += [f"{key}={value!r}".replace("'", '"') for key, value in values.items() if value != usual[key]]
    if len(set(point.resets)) == 1 and point.count > 1:
        facts.append(f"resets=({shown(point, point.reset)},) * {point.count}")
    elif point.resets != (0,):
        facts.append(f"resets={several(point, point.resets)}")
    if point.writable:
        good, bad = values_around(point)
        facts.append(f"good={several(point, good)}")
        facts += [f"bad={several(point, bad)}"] if bad else []
    return f"Point({', '.join(facts)})"


def shown(point: Point, raw: int) -> str:
    """A bit pattern: small ones as people count."""
    return str(raw) if raw < 1 << 15 else f"0x{raw:0{point.bits // 4}X}"


def several(point: Point, values: Iterable[int]) -> str:
    items = [shown(point, raw) for raw in values]
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def next_to(point: Point, raw: int) -> list[int]:
    """A value with its neighbours: the numbers below and above, as far as the type has them."""
    top, ones = 1 << (point.bits - 1), (1 << point.bits) - 1
    if point.is_float:
        line = raw ^ ones if raw & top else raw | top  # in this order floats are whole numbers
        near = [n for n in (line - 1, line, line + 1) if 0 <= n <= ones]
        return [n ^ top if n & top else n ^ ones for n in near]
    number = int(point.number(raw))
    least, most = point.number_range()
    return [n & ones for n in (number - 1, number, number + 1) if least <= n <= most]


def values_around(point: Point) -> tuple[list[int], list[int]]:
    """(raw values that may be written, that may not): all edges of the limits, or a few patterns without limits."""
    ones = (1 << point.bits) - 1
    if point.is_bit:
        return [1, 0], []
    patterns = [int("5AC3" * point.width, 16), ones, sum(n + 1 << 16 * n for n in range(point.width)), 0]
    if not point.is_limited:
        return patterns, []
    edges = [raw for raw in (point.minimum, point.maximum) if raw is not None] + [item.raw for item in point.enum]
    found = list(dict.fromkeys(near for raw in edges for near in next_to(point, raw)))
    if point.is_float:
        infinity = 0x7F800000 if point.bits == 32 else 0x7FF << 52
        found += [infinity, infinity | 1 << (point.bits - 1), infinity | 1]  # the last is no number
    found += [raw for raw in patterns if raw not in found]
    found += [raw for raw in point.resets if raw not in found]
    return [raw for raw in found if point.accepts(raw)], [raw for raw in found if not point.accepts(raw)]


def free_addresses(device: Device, name: str) -> tuple[int, ...]:
    """The addresses before and behind the points of a table that no point covers."""
    points = device.table(name)
    near = {address for point in points for address in (point.at - 1, point.last + 1) if 0 <= address < ITEMS}
    return tuple(sorted(address for address in near if device.at(name, address) is None))
