# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Devices that the outputs are tested with, made without a map file."""

from modbus_map.model import BitField, Device, EnumItem, Identity, Line, Point


def device(name, points, **more):
    """A device with all read and write functions."""
    facts = {
        "title": name.replace("_", " ").capitalize(),
        "version": "1.0.0",
        "doc": "",
        "identity": Identity("Acme", "X", "V1"),
        "line": Line(17, 19200, "8E1"),
        "word_order": "big",
        "functions": (1, 2, 3, 4, 5, 6, 15, 16),
        "functions_auto": True,
        "core": (),
    } | more
    return Device(name=name, points=tuple(points), **facts)


def signed(number, bits=16):
    """The bit pattern of a number."""
    return number & ((1 << bits) - 1)


RELAY_BOX = device(
    "relay_box",
    [
        Point("coils", 0, "relay", "bool", 1, 4, True, "rw", "register", (0,) * 4, doc="Relays, 1 closes"),
        Point("discrete_inputs", 0, "door_open", "bool", 1),
        Point("input_registers", 0, "temperature", "i16", 1, unit="°C", scale=0.1),
        Point(
            "holding_registers", 0, "limit", "i16", 1, 1, False, "rw", "register", (450,), 0, 800, unit="°C", scale=0.1
        ),
    ],
)

HOSTILE = 'a "b" <script>alert(1)</script> | & \\ */ ``` ${x} # é {{ }} [l](u) --'

EVERYTHING = device(
    "drive",
    [
        Point("coils", 0, "run", "bool", 1, 1, False, "rw", "register", (1,), strobe=True),
        Point("coils", 1, "freeze_all", "bool", 1, 1, False, "wo", "register"),
        Point("coils", 2, "alarms", "bool", 1, 11, True, "rw", "register", (0,) * 11),
        Point("discrete_inputs", 5, "ready", "bool", 1, 3, True),
        Point("input_registers", 0, "speed", "i32", 2, unit="rpm", scale=0.01, freeze="freeze_all"),
        Point("input_registers", 2, "energy", "u64", 4, unit="kWh", scale=0.001, word_order="little"),
        Point("input_registers", 6, "torque", "f32", 2, unit="Nm"),
        Point("input_registers", 8, "torques", "f32", 2, 2, True, unit="Nm", word_order="little"),
        Point("input_registers", 12, "power", "f64", 4, scale=2.5, offset=-1.25),
        Point("input_registers", 16, "heat", "u16", 1, unit="°C", offset=-40.0),
        Point(
            "input_registers", 100, "status", "bits", 1, fields=(BitField("on", 0, 0), BitField("mode", 5, 4)),
            doc=HOSTILE,
        ),
        Point("input_registers", 101, "position", "i64", 4, word_order="little"),
        Point(
            "holding_registers", 0, "mode", "u16", 1, 1, False, "rw", "register", (1,),
            enum=(EnumItem(0, 0, "off", "OFF"), EnumItem(1, 1, "on now", "ON_NOW"), EnumItem(7, 7, "7th", "V7TH")),
        ),
        Point("holding_registers", 1, "ramp", "u32", 2, 1, False, "rw", "register", (5000,), 0, 60000, unit="s",
              scale=0.001, word_order="little"),
        Point("holding_registers", 3, "tag", "string<9>", 5, 1, False, "rw", "register",
              (int.from_bytes(b"pump".ljust(10, b"\0"), "big"),)),
        Point("holding_registers", 8, "gains", "i16", 1, 3, True, "rw", "register", (1, 2, signed(-3)), scale=0.5),
        Point("holding_registers", 11, "command", "u16", 1, 1, False, "wo", "register", (0,), strobe=True),
        Point("holding_registers", 12, "setpoint", "f32", 2, 1, False, "rw", "register", (0x3FC00000,)),
        Point("holding_registers", 200, "curve", "i16", 1, 100, True, "rw", "memory", (0,) * 100),
    ],
    title=HOSTILE,
    doc=HOSTILE,
)  # fmt: skip

SAMPLES = {  # numbers that the outputs must decode alike
    "speed": [0, 123456, -123456, -(1 << 31), (1 << 31) - 1],
    "energy": [0, 1, 123456789012, (1 << 40) + 1],
    "torque": [0.0, 1.5, -3.25e7],
    "torques": [0.5, -1.5],
    "power": [0.0, 1e100, -2.5],
    "heat": [0, 40, 65535],
    "status": [0, 0x31],
    "position": [0, -1, -(1 << 63), (1 << 63) - 1, 0x0123456789ABCDEF],
    "mode": [0, 1, 7],
    "ramp": [0, 1, 59999],
    "tag": ["", "pump", "123456789"],
    "gains": [-32768, 0, 32767],
    "setpoint": [1.5, -0.125],
    "curve": [-5, 7],
}
