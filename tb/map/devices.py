# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Devices for the tests of the generated RTL, made without a map file."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from modbus_map.model import WIDTHS, Device, EnumItem, File, Identity, Line, Point  # noqa: E402

READS = {"coils": 1, "discrete_inputs": 2, "holding_registers": 3, "input_registers": 4}


def point(table, at, name, kind_of_value="", **fields):
    """A point with the defaults of the map file."""
    is_bit = table in ("coils", "discrete_inputs")
    kind_of_value = kind_of_value or ("bool" if is_bit else "u16")
    text = kind_of_value.startswith("string")
    width = 1 if is_bit else (int(kind_of_value[7:-1]) + 1) // 2 if text else WIDTHS[kind_of_value]
    written = table in ("coils", "holding_registers")
    access = fields.pop("access", "rw" if written else "ro")
    count = fields.setdefault("count", 1)
    fields.setdefault("kind", "register" if access != "ro" else "wire")
    fields.setdefault("resets", (0,) * count)
    fields.setdefault("is_array", count > 1)
    fields["enum"] = tuple(EnumItem(raw, raw, f"e{raw}", f"E{raw}") for raw in fields.pop("enum", ()))
    return Point(table=table, at=at, name=name, type=kind_of_value, width=width, access=access, **fields)


def functions_of(points, files=(), more=()):
    """The function codes that a map with these points needs."""
    codes = {READS[p.table] for p in points}
    if any(p.writable and p.table == "coils" for p in points):
        codes |= {5, 15}
    if any(p.writable and p.table == "holding_registers" for p in points):
        codes |= {6, 16}
    if files:
        codes |= {20, 21}
    return tuple(sorted(codes | set(more)))


def device(name, points, functions=None, more=(), files=(), **fields):
    """A device of these points."""
    fields = {
        "title": name,
        "version": "1.0.0",
        "doc": "",
        "identity": Identity(),
        "line": Line(address=17, baud=19200),
        "word_order": "big",
        "core": (),
        **fields,
    }
    codes = tuple(functions) if functions else functions_of(points, files, more)
    return Device(
        name=name, points=tuple(points), functions=codes, functions_auto=functions is None, files=tuple(files), **fields
    )


def relay_box():
    """The first example of the documents."""
    return device(
        "relay_box",
        [
            point("coils", 0, "relay", count=4, doc="Relays, 1 closes"),
            point("discrete_inputs", 0, "door_open"),
            point("input_registers", 0, "temperature", "i16", unit="°C", scale=0.1),
            point("holding_registers", 0, "limit", "i16", minimum=0, maximum=800, resets=(450,)),
        ],
        more=(43,),
        identity=Identity("Acme", "RB-4", "V1.0"),
    )


def small_drive():
    """Every kind of point: pairs, quads, floats, enums, arrays, memory, freeze, both word orders."""
    return device(
        "small_drive",
        [
            point("coils", 0, "run", strobe=True),
            point("coils", 1, "fault_reset", access="wo"),
            point("coils", 2, "direction", resets=(1,)),
            point("coils", 16, "capture"),
            point("discrete_inputs", 100, "limit_switch", count=5),
            point("discrete_inputs", 107, "ready"),
            point("input_registers", 0, "speed", "f32"),
            point("input_registers", 2, "position", "i64"),
            point("input_registers", 6, "current", "u16", count=3),
            point("input_registers", 9, "torque", "i32", word_order="little"),
            point("input_registers", 20, "energy", "u64", freeze="capture"),
            point("input_registers", 24, "power", "i16", freeze="capture"),
            point("input_registers", 30, "version", "u32", kind="constant", resets=(0x00010203,)),
            point(
                "holding_registers",
                0,
                "setpoint",
                "f32",
                minimum=0xC0000000,
                maximum=0x40000000,
                strobe=True,
            ),
            point("holding_registers", 2, "ramp", "u32", resets=(1000,), minimum=10, maximum=100000),
            point("holding_registers", 4, "mode", "u16", enum=(0, 1, 4), resets=(1,)),
            point("holding_registers", 5, "level", "u16", enum=(0, 1, 2, 3)),
            point("holding_registers", 6, "trim", "i16", count=4, minimum=0xFF9C, maximum=100),
            point("holding_registers", 10, "target", "i64", word_order="little", strobe=True),
            point("holding_registers", 14, "offset", "i32", word_order="little", minimum=-5 & 0xFFFFFFFF, maximum=5),
            point("holding_registers", 16, "serial", "u16", access="ro"),
            point("holding_registers", 17, "key", "u16", access="wo"),
            point("holding_registers", 100, "curve", "u16", count=100, kind="memory", resets=tuple(range(100))),
        ],
        files=[File(4, "log", 20, "ro"), File(9, "notes", 7, "rw")],
        functions=(1, 2, 3, 4, 5, 6, 15, 16, 20, 21, 22, 23),
    )
