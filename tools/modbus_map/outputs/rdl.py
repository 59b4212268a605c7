# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.rdl: SystemRDL with the properties of modbus_udp.rdl, which it holds too, so that it stands alone."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap

from modbus_map import dump
from modbus_map.model import SPACES, Device, Point

PROPERTIES = Path(__file__).resolve().parents[1] / "rdl" / "modbus_udp.rdl"
TABLE_BYTES = 0x20000
TITLES = {
    "coils": "Coils",
    "discrete_inputs": "Discrete inputs",
    "input_registers": "Input registers",
    "holding_registers": "Holding registers",
}
WORDS = frozenset(
    """
    abstract accesstype addressingtype addrmap alias all boolean bothedge bit compact component constraint
    componentwidth default encode enum external false field fullalign hw inside internal level longint mem na
    negedge nonsticky number onreadtype onwritetype posedge property r rclr ref reg regalign regfile rset ruser rw
    rw1 signal string struct sw this true type unsigned w w1 wclr woclr woset wot wr wset wuser wzc wzs wzt
    """.split()
)


def encoded(text: str) -> str:
    """A text that SystemRDL, its preprocessors and this program read alike."""
    return "".join(quote(c) if c in '"\\`<>%\n\r\t' or ord(c) < 32 or c in "\x7f\x85\u2028\u2029" else c for c in text)


def name_of(name: str) -> str:
    """A name, escaped where SystemRDL has the word for itself."""
    return f"\\{name}" if name.lower() in WORDS else name


def flow(value: Any) -> str:
    """A mapping or a value as one line of YAML."""
    yaml = YAML()
    yaml.width = 1 << 30
    yaml.default_flow_style = True
    yaml.allow_unicode = True
    out = io.StringIO()
    yaml.dump(dump.quoted(value), out)
    return out.getvalue().removesuffix("\n").removesuffix("\n...")


def generate(device: Device) -> dict[str, str]:
    """NAME.rdl"""
    properties = PROPERTIES.read_text(encoding="utf-8")
    guarded = properties.split("\n\n", 1)[1]
    lines = [
        f"// {one_line(device.title)} {one_line(device.version)}: made by `modbus map` from {device.source or 'a map'}",
        "",
        "`ifndef MODBUS_UDP_RDL",
        "`define MODBUS_UDP_RDL",
        guarded.rstrip(),
        "`endif",
        "",
        f"addrmap {name_of(device.name)} {{",
        f'  name = "{encoded(device.title)}";',
    ]
    if device.doc:
        lines.append(f'  desc = "{encoded(device.doc)}";')
    head = dump.tree(device)
    empty = [table for table in device.zero_gaps if not device.table(table)]  # they have no regfile
    rest = CommentedMap((k, v) for k, v in head.items() if k in empty or k not in (*SPACES, "fifos", "device"))
    lines += [f'  modbus_device = "{encoded(flow(rest))}";', "  default regwidth = 16;", "  default accesswidth = 16;"]
    for table, points in device.tables():
        lines += ["", "  regfile {", f'    name = "{TITLES[table]}";', f'    modbus_table = "{table}";']
        if table in device.zero_gaps:
            lines.append('    modbus_gaps = "zero";')
        for point in points:
            lines += ["", *_register(point, device)]
        lines.append(f"  }} {table} @ 0x{SPACES[table] * TABLE_BYTES:X};")
    lines.append("};")
    return {f"{device.name}.rdl": "\n".join(lines) + "\n"}


def one_line(text: str) -> str:
    """A text for a comment."""
    return re.sub(r"[\s`<>%\\]+", " ", text).strip()


def _register(point: Point, device: Device) -> list[str]:
    given = {} if point.fifo else dump.point(point, device)
    lines = ["    reg {"]
    if point.doc:
        lines.append(f'      desc = "{encoded(point.doc)}";')
        lines.append(f'      modbus_doc = "{encoded(point.doc)}";')
    bits = 16 if point.is_string or point.is_bit else point.bits
    if bits != 16:
        lines.append(f"      regwidth = {bits};")
    lines.append(f'      modbus_type = "{encoded(point.type)}";')
    if point.is_array:
        lines.append(f"      modbus_count = {point.count};")
    for key in ("kind", "access", "word_order", "freeze"):
        if key in given:
            lines.append(f'      modbus_{key} = "{given[key]}";')
    for key in ("reset", "min", "max", "enum", "unit", "scale", "offset"):
        if key in given:
            lines.append(f'      modbus_{key} = "{encoded(flow(given[key]) if key != "unit" else given[key])}";')
    if point.strobe:
        lines.append("      modbus_strobe = true;")
    if point.fifo:
        lines.append(f"      modbus_fifo = {point.count - 1};")
    lines.append(f"      modbus_index = {device.points.index(point)};")
    lines += _fields(point)
    array = ""
    if point.is_string:
        array = f"[{point.count}][{point.width}]" if point.is_array else f"[{point.width}]"
    elif point.is_array:
        array = f"[{point.count}]"
    lines.append(f"    }} {name_of(point.name)}{array} @ 0x{2 * point.at:X};")
    return lines


def _fields(point: Point) -> list[str]:
    software = {"rw": "rw", "ro": "r", "wo": "w"}[point.access]
    hardware = {"register": "r", "wire": "w", "memory": "rw", "constant": "r"}[point.kind]
    if point.kind == "constant":
        software = "r"
    lines: list[str] = []
    width = 16 if point.is_string else point.bits
    common = f"sw = {software}; hw = {hardware};"
    if point.enum:
        lines.append("      enum values_e {")
        for item in point.enum:
            label = encoded(item.label)
            lines.append(f'        {item.ident}_{item.raw} = {max(width, 1)}\'h{item.raw:X} {{ name = "{label}"; }};')
        lines.append("      };")
    if point.fields:
        for part in point.fields:
            reset = (point.reset & part.mask) >> part.low
            place = f"{name_of(part.name)}[{part.high}:{part.low}]"
            lines.append(f"      field {{ {common} reset = {part.width}'h{reset:X}; }} {place};")
        return lines
    reset = (
        ""
        if point.is_string or point.kind == "wire" or len(set(point.resets)) > 1
        else f" reset = {width}'h{point.reset:X};"
    )
    encode = " encode = values_e;" if point.enum else ""
    lines.append(f"      field {{ {common}{reset}{encode} }} value[{width - 1}:0];")
    return lines
