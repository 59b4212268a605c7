# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A Device back to the text of a map file. Reading it gives the same Device."""

from __future__ import annotations

import io
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.scalarstring import SingleQuotedScalarString

from modbus_map.model import TABLES, Device, Point, exact_of

SIGNS = ("?", ":", "-")


def text(device: Device) -> str:
    """The map file of a device: what is a default is left out."""
    yaml = YAML()
    yaml.width = 110
    yaml.allow_unicode = True
    yaml.indent(mapping=2, sequence=4, offset=2)
    out = io.StringIO()
    yaml.dump(quoted(tree(device)), out)
    return out.getvalue()


def quoted(node: Any) -> Any:
    """The tree with texts in quotes that begin with a sign which a reader takes for YAML's own inside of braces."""
    if isinstance(node, str):
        return SingleQuotedScalarString(node) if node[:1] in SIGNS else node
    for key in node if isinstance(node, dict) else range(len(node)) if isinstance(node, list) else ():
        node[key] = quoted(node[key])
    return node


def tree(device: Device) -> CommentedMap:
    """The same as plain mappings and lists."""
    top = CommentedMap(device=device.name)
    if device.title != device.name:
        top["title"] = device.title
    top["version"] = device.version
    if device.doc:
        top["doc"] = device.doc
    if identity := _identity(device):
        top["identity"] = identity
    line = CommentedMap(address=device.line.address, baud=device.line.baud, format=device.line.format)
    if device.line.run_time:
        line["run_time"] = True
    top["line"] = _flow(line)
    if device.word_order != "big":
        top["word_order"] = device.word_order
    if not device.functions_auto:
        top["functions"] = _flow_list(list(device.functions))
    if device.core:
        top["core"] = _flow(CommentedMap(device.core))
    if device.files:
        top["files"] = [_flow(_file(file)) for file in device.files]
    for key in _order(device):
        points = [p for p in device.points if (p.fifo if key == "fifos" else p.table == key and not p.fifo)]
        items: list[Any] = []
        if key in device.zero_gaps:
            items.append(_flow(CommentedMap(gaps="zero")))
        items += [_flow(_fifo(p) if p.fifo else point(p, device)) for p in points]
        if items:
            top[key] = items
    return top


def _order(device: Device) -> list[str]:
    """The lists in the order in which the device has its points: the ports follow it."""
    order: list[str] = []
    for point in device.points:
        key = "fifos" if point.fifo else point.table
        if key not in order:
            order.append(key)
    return order + [table for table in TABLES if table not in order]


def _flow(mapping: CommentedMap) -> CommentedMap:
    mapping.fa.set_flow_style()
    return mapping


def _flow_list(values: list[Any]) -> CommentedSeq:
    made = CommentedSeq(values)
    made.fa.set_flow_style()
    return made


def _identity(device: Device) -> CommentedMap:
    given, made = device.identity, CommentedMap()
    for key in ("vendor", "product", "revision", "url", "name", "model", "application"):
        if text := getattr(given, key):
            made[key] = text
    if given.private:
        made["private"] = _flow(CommentedMap(given.private))
    for key in ("server_id", "additional_data"):
        if octets := getattr(given, key):
            made[key] = _flow_list(list(octets))
    level = 0x83 if given.private else 0x82 if any((given.url, given.name, given.model, given.application)) else 0x81
    if given.conformity != level:
        made["conformity"] = given.conformity
    return made


def _file(file: Any) -> CommentedMap:
    made = CommentedMap(number=file.number, name=file.name, records=file.records)
    if file.access != "rw":
        made["access"] = file.access
    if file.doc:
        made["doc"] = file.doc
    return made


def _fifo(point: Point) -> CommentedMap:
    made = CommentedMap(at=point.at, name=point.name, depth=point.count - 1)
    if point.doc:
        made["doc"] = point.doc
    return made


def point(point: Point, device: Device) -> CommentedMap:
    """A point as an item of its table's list."""
    made = CommentedMap(at=point.at, name=point.name)
    if point.type not in ("bool", "u16"):
        made["type"] = point.type
    elif point.type == "u16" and point.fields:
        made["type"] = "u16"
    if point.is_array:
        made["count"] = point.count
    made["kind"] = point.kind
    if not point.table.endswith("inputs") and point.table != "input_registers":
        made["access"] = point.access
    if point.kind == "constant" or any(point.resets):
        same = len(set(point.resets)) == 1
        made["reset"] = value_of(point, point.reset) if same else _flow_list([value_of(point, r) for r in point.resets])
    elif point.is_limited and point.writable and not point.accepts(0):
        made["reset"] = value_of(point, 0)
    low, high = (point.minimum, point.maximum) if point.scale > 0 else (point.maximum, point.minimum)
    if low is not None:
        made["min"] = value_of(point, low)
    if high is not None:
        made["max"] = value_of(point, high)
    if point.enum:
        made["enum"] = _flow(CommentedMap((item.number, item.label) for item in point.enum))
    if point.fields:
        fields = ((f.name, f.low if f.width == 1 else f"{f.high}..{f.low}") for f in point.fields)
        made["bits"] = _flow(CommentedMap(fields))
    if point.unit:
        made["unit"] = point.unit
    if point.scale != 1.0:
        made["scale"] = _plain(point.scale)
    if point.offset != 0.0:
        made["offset"] = _plain(point.offset)
    if point.width > 1 and not point.is_string and point.word_order != device.word_order:
        made["word_order"] = point.word_order
    if point.strobe:
        made["strobe"] = True
    if point.freeze:
        made["freeze"] = point.freeze
    if point.doc:
        made["doc"] = point.doc
    return made


def value_of(point: Point, raw: int) -> Any:
    """The value of a raw value, such that reading it gives that raw value."""
    number = point.number(raw)
    if isinstance(number, str):
        return number
    if point.is_float or not point.is_scaled:
        exact = number * point.scale + point.offset if point.is_scaled else number
        return _plain(exact) if isinstance(exact, float) else exact
    exact_value = number * exact_of(point.scale) + exact_of(point.offset)
    if exact_value.denominator == 1:
        return int(exact_value)
    return float(exact_value)


def _plain(number: float) -> Any:
    return int(number) if float(number).is_integer() and abs(number) < 1e15 else float(number)
