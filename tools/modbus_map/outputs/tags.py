# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""tags/: the map for Telegraf, Home Assistant, Node-RED, modpoll, W3C Web of Things and MBMap.

What a format cannot say is left out: a point that cannot be read, a string in reversed words, and so on. The page
docs/map_outputs.md lists it.
"""

from __future__ import annotations

import csv
import io
import json
from typing import Any

from modbus_map.model import READ_FUNCTION, Device, Point
from modbus_map.outputs import node_red, shared

PORT = "/dev/ttyUSB0"
TELEGRAF_REGISTERS = {
    "coils": "coil", "discrete_inputs": "discrete", "holding_registers": "holding", "input_registers": "input",
}  # fmt: skip
TELEGRAF_TYPES = {
    "u16": "UINT16", "bits": "UINT16", "i16": "INT16", "u32": "UINT32", "i32": "INT32", "u64": "UINT64",
    "i64": "INT64", "f32": "FLOAT32", "f64": "FLOAT64",
}  # fmt: skip
HA_TYPES = {k: v.lower() for k, v in TELEGRAF_TYPES.items()}
HA_INPUT = {"holding_registers": "holding", "input_registers": "input"}
WOT_TYPES = {
    "bool": "xsd:boolean", "u16": "xsd:unsignedShort", "bits": "xsd:unsignedShort", "i16": "xsd:short",
    "u32": "xsd:unsignedInt", "i32": "xsd:int", "u64": "xsd:unsignedLong", "i64": "xsd:long", "f32": "xsd:float",
    "f64": "xsd:double",
}  # fmt: skip
WOT_ENTITY = {
    "coils": "Coil", "discrete_inputs": "DiscreteInput", "holding_registers": "HoldingRegister",
    "input_registers": "InputRegister",
}  # fmt: skip
MODPOLL_MOST = 123  # registers of a poll


def _quoted(text: str) -> str:
    """A string that JSON, YAML and TOML read alike: ASCII, escaped."""
    return json.dumps(text.replace("\x7f", ""), ensure_ascii=True)


def _readable(device: Device) -> list[Point]:
    return [
        p for _, points in device.tables() for p in points if p.readable and device.has_function(READ_FUNCTION[p.table])
    ]


def _text_reversed(point: Point) -> bool:
    return point.is_string and point.word_order == "little" and point.width > 1


# ---------------------------------------------------------------- Telegraf


def telegraf(device: Device) -> str:
    """inputs.modbus in its request style; a processor adds offsets, which the plugin does not know."""
    line = device.line
    lines = [
        f"# {shared.comment(device.title)} {shared.comment(device.version)}: made from the map file",
        "[[inputs.modbus]]",
        f"  name = {_quoted(device.name)}",
        f'  controller = "file://{PORT}"',
        f"  baud_rate = {line.baud}",
        "  data_bits = 8",
        f'  parity = "{line.parity}"',
        f"  stop_bits = {line.stop_bits}",
        '  transmission_mode = "RTU"',
        '  timeout = "1s"',
        '  configuration_type = "request"',
    ]
    groups: dict[tuple[str, str], list[tuple[Point, int]]] = {}
    for point in _readable(device):
        if not _text_reversed(point):
            little = point.word_order == "little" and point.width > 1
            group = groups.setdefault((point.table, "CDAB" if little else "ABCD"), [])
            group += [(point, item) for item in range(point.count)]
    offsets = {}
    for (table, order), group in groups.items():
        for items in _within(group, shared.most(device, table)):
            lines += ["", "  [[inputs.modbus.request]]", f"    slave_id = {line.address}"]
            if table.endswith("registers"):
                lines.append(f'    byte_order = "{order}"')
            lines += [
                f'    register = "{TELEGRAF_REGISTERS[table]}"',
                f"    measurement = {_quoted(device.name)}",
                "    fields = [",
            ]
            for point, item in items:
                lines.append(f"      {{{', '.join(_telegraf_field(point, item))}}},")
                if point.offset:
                    offsets[shared.item_name(point, item)] = point.offset
            lines.append("    ]")
    if offsets:
        rows = ", ".join(f'"{name}": {float(offset)!r}' for name, offset in offsets.items())
        lines += [
            "",
            "[[processors.starlark]]",
            f"  namepass = [{_quoted(device.name)}]",
            "  source = '''",
            f"offsets = {{{rows}}}",
            "",
            "def apply(metric):",
            "    for name in offsets:",
            "        if name in metric.fields:",
            "            metric.fields[name] = metric.fields[name] + offsets[name]",
            "    return metric",
            "'''",
        ]
    return "\n".join(lines) + "\n"


def _within(group: list[tuple[Point, int]], most: int) -> list[list[tuple[Point, int]]]:
    """Items by address, cut where one request would fetch more than `most`. The plugin joins no two requests."""
    made: list[list[tuple[Point, int]]] = []
    first = 0
    for point, item in sorted(group, key=lambda one: one[0].addresses(one[1])[0]):
        addresses = point.addresses(item)
        if point.width > most:
            continue
        if not made or addresses[-1] - first >= most:
            made.append([])
            first = addresses[0]
        made[-1].append((point, item))
    return made


def _telegraf_field(point: Point, item: int) -> list[str]:
    facts = [f"address={point.addresses(item)[0]}", f'name="{shared.item_name(point, item)}"']
    if point.is_string:
        facts += ['type="STRING"', f"length={point.width}"]
    elif not point.is_bit:
        facts.append(f'type="{TELEGRAF_TYPES[point.type]}"')
        if point.scale != 1.0:
            facts += [f"scale={float(point.scale)!r}", 'output="FLOAT64"']
        elif point.offset:
            facts.append('output="FLOAT64"')
    return facts


# ---------------------------------------------------------------- Home Assistant


def home_assistant(device: Device) -> str:
    """The modbus integration: switches, binary sensors, sensors."""
    line = device.line
    lines = [
        f"# {shared.comment(device.title)} {shared.comment(device.version)}: made from the map file",
        "modbus:",
        f"  - name: {_quoted(device.name)}",
        "    type: serial",
        "    method: rtu",
        f"    port: {PORT}",
        f"    baudrate: {line.baud}",
        "    bytesize: 8",
        f"    parity: {line.parity}",
        f"    stopbits: {line.stop_bits}",
    ]
    groups: dict[str, list[list[tuple[str, Any]]]] = {"binary_sensors": [], "sensors": [], "switches": []}
    for _, points in device.tables():
        for point in points:
            read = point.readable and device.has_function(READ_FUNCTION[point.table])
            for item in range(point.count):
                entity: list[tuple[str, Any]] = [
                    ("name", f"{device.name.replace('_', ' ')} {shared.item_name(point, item).replace('_', ' ')}"),
                    ("unique_id", f"{device.name}_{shared.item_name(point, item)}"),
                    ("device_address", line.address),
                    ("address", point.addresses(item)[0]),
                ]
                if point.table == "coils" and point.writable and device.has_function(5):
                    groups["switches"].append(
                        entity + [("write_type", "coil")] + ([("verify", {"input_type": "coil"})] if read else [])
                    )
                elif read and point.is_bit:
                    kind = "coil" if point.table == "coils" else "discrete_input"
                    groups["binary_sensors"].append(entity + [("input_type", kind)])
                elif read and not _text_reversed(point):
                    groups["sensors"].append(entity + _sensor(point))
    for kind, entities in groups.items():
        if entities:
            lines.append(f"    {kind}:")
        for entity in entities:
            mark = "- "
            for key, value in entity:
                if isinstance(value, dict):
                    lines.append(f"      {mark}{key}:")
                    lines += [f"          {name}: {text}" for name, text in value.items()]
                else:
                    text = _quoted(value) if isinstance(value, str) and not value.replace("_", "").isalnum() else value
                    lines.append(f"      {mark}{key}: {text}")
                mark = "  "
    return "\n".join(lines) + "\n"


def _sensor(point: Point) -> list[tuple[str, Any]]:
    entity: list[tuple[str, Any]] = [("input_type", HA_INPUT[point.table])]
    if point.is_string:
        return entity + [("data_type", "string"), ("count", point.width)]
    entity.append(("data_type", HA_TYPES[point.type]))
    if point.word_order == "little" and point.width > 1:
        entity.append(("swap", "word"))
    if point.scale != 1.0:
        entity.append(("scale", float(point.scale)))
    if point.offset:
        entity.append(("offset", float(point.offset)))
    entity.append(("precision", shared.decimals(point)))
    if point.unit:
        entity.append(("unit_of_measurement", f" {point.unit} ".strip()))
    if not point.enum and not point.fields:
        entity.append(("state_class", "measurement"))
    return entity


# ---------------------------------------------------------------- modpoll


def modpoll(device: Device) -> str:
    """The configuration of the Python modpoll: device, poll and ref rows. It knows no offset: the unit says it."""
    rows: list[list[Any]] = [["device", device.name, device.line.address]]
    for block in shared.blocks(device, MODPOLL_MOST):
        kind = {1: "coil", 2: "discrete_input", 3: "holding_register", 4: "input_register"}[READ_FUNCTION[block.table]]
        if kind in ("coil", "discrete_input"):
            for point in dict.fromkeys(point for point, _ in block.items):
                items = [item for p, item in block.items if p is point]
                for first in range(items[0], items[-1] + 1, 8):  # a reference holds eight
                    size = min(8, items[-1] + 1 - first)
                    rows.append(["poll", kind, point.at + first, size, "BE_BE"])
                    rows.append(["ref", shared.item_name(point, first), point.at + first, "bool8", "r"])
            continue
        for little in (False, True):
            part = [(p, k) for p, k in block.items if (p.word_order == "little" and p.width > 1) == little]
            part = [(p, k) for p, k in part if not _text_reversed(p)]
            if part:
                rows.append(["poll", kind, block.at, block.size, "BE_LE" if little else "BE_BE"])
            for point, item in part:
                rows += _references(point, item)
    made = io.StringIO()
    csv.writer(made, lineterminator="\n").writerows(rows)
    return made.getvalue()


def _references(point: Point, item: int) -> list[list[Any]]:
    kind = f"string{2 * point.width}" if point.is_string else HA_TYPES[point.type]
    unit = " ".join(point.unit.split())
    if point.offset:
        unit = f"{unit} (add {shared.decimal(point.offset)})".strip()
    row: list[Any] = [
        "ref",
        shared.item_name(point, item),
        point.addresses(item)[0],
        kind,
        "rw" if point.writable else "r",
        unit,
    ]
    rows = [row + ([float(point.scale)] if point.scale != 1.0 else [])]
    rows += [
        ["ref", f"{shared.item_name(point, item)}.{part.name}", f"{point.addresses(item)[0]}:{part.low}", "bool", "r"]
        for part in point.fields
        if part.width == 1
    ]
    return rows


# ---------------------------------------------------------------- Web of Things


def web_of_things(device: Device) -> str:
    """A Thing Description 1.1 with the Modbus binding; values are numbers before scale and offset, which stand beside."""
    properties: dict[str, Any] = {}
    for table, points in device.tables():
        for point in points:
            read = point.readable and device.has_function(READ_FUNCTION[table])
            write = point.writable
            limits = [shared.most(device, table)] * read + [shared.most(device, table, True)] * write
            items = min(limits, default=0) // point.width
            if not items and read:  # written in no request, but read
                write, items = False, shared.most(device, table) // point.width
            for first in range(0, point.count, items) if items else ():
                name, part = _wot_property(device, point, first, min(items, point.count - first), read, write)
                properties[name] = part
    thing = {
        "@context": [
            "https://www.w3.org/2022/wot/td/v1.1",
            {
                "modv": "https://www.w3.org/2019/wot/modbus#",
                "xsd": "http://www.w3.org/2001/XMLSchema#",
                "map": "urn:modbus-map:",
            },
        ],
        "id": f"urn:modbus-map:device:{device.name}",
        "title": device.title or device.name,
        **({"description": device.doc} if device.doc else {}),
        "version": {"instance": device.version or "0"},
        "base": "modbus+tcp://127.0.0.1:502",
        "securityDefinitions": {"none": {"scheme": "nosec"}},
        "security": ["none"],
        "properties": properties,
    }
    return json.dumps(thing, indent=2, ensure_ascii=False) + "\n"


def _wot_property(
    device: Device, point: Point, first: int, count: int, read: bool, write: bool
) -> tuple[str, dict[str, Any]]:
    """(name, description) of `count` items of a point: all of them, or as many as a request may have."""
    one = _wot_schema(point)
    whole = count == point.count
    title = shared.item_doc(point, 0).removesuffix(" 0") if point.is_array else shared.item_doc(point, 0)
    schema = {"type": "array", "items": one, "minItems": count, "maxItems": count} if point.is_array else one
    form: dict[str, Any] = {
        "href": f"/{device.line.address}/{point.addresses(first)[0]}?quantity={count * point.width}",
        "op": [*(["readproperty"] if read else []), *(["writeproperty"] if write else [])],
        "contentType": "application/octet-stream",
        "modv:entity": WOT_ENTITY[point.table],
        "modv:type": "xsd:string" if point.is_string else WOT_TYPES[point.type],
        "modv:zeroBasedAddressing": True,
    }
    if point.width > 1:
        form["modv:mostSignificantByte"] = True
        form["modv:mostSignificantWord"] = point.word_order == "big"
    return point.name if whole else f"{point.name}_{first}", {
        "title": title if whole else f"{title} {first} to {first + count - 1}",
        **({"description": point.doc} if point.doc else {}),
        **schema,
        **({"unit": point.unit} if point.unit else {}),
        **({"map:scale": float(point.scale), "map:offset": float(point.offset)} if point.is_scaled else {}),
        "readOnly": not write,
        "writeOnly": not read,
        "observable": False,
        "forms": [form],
    }


def _wot_schema(point: Point) -> dict[str, Any]:
    if point.is_bit:
        return {"type": "boolean"}
    if point.is_string:
        return {"type": "string", "maxLength": point.characters}
    if point.is_float:
        return {"type": "number"} | _bounds(point)
    schema: dict[str, Any] = {"type": "integer"} | _bounds(point)
    if point.enum:
        schema["oneOf"] = [{"const": item.number, "title": item.label} for item in point.enum]
        if point.minimum is not None or not point.enum_is_limit or not point.writable:
            schema["oneOf"].append({"not": {"enum": [item.number for item in point.enum]}})
    return schema


def _bounds(point: Point) -> dict[str, Any]:
    low, high = (None, None) if point.is_float else point.number_range()
    low = low if point.minimum is None else point.number(point.minimum)  # type: ignore[assignment]
    high = high if point.maximum is None else point.number(point.maximum)  # type: ignore[assignment]
    return {key: number for key, number in (("minimum", low), ("maximum", high)) if number is not None}


# ---------------------------------------------------------------- MBMap


def mbmap(device: Device) -> str:
    """A map in the manner of MBMap 2: one entry an item, with address, type, orders, scale, names, rights."""
    entries = []
    for table, points in device.tables():
        for point in points:
            for item in range(point.count):
                entry: dict[str, Any] = {
                    "name": shared.item_name(point, item),
                    "table": table,
                    "address": point.addresses(item)[0],
                    "type": "string" if point.is_string else "bool" if point.is_bit else HA_TYPES[point.type],
                    "access": {"rw": "read-write", "ro": "read", "wo": "write"}[point.access],
                }
                if not point.is_bit:
                    entry["length"] = point.width
                if point.width > 1:
                    entry["wordOrder"] = point.word_order
                if point.is_scaled:
                    entry |= {"scale": float(point.scale), "offset": float(point.offset)}
                if point.unit:
                    entry["unit"] = point.unit
                for key, raw in (("min", point.minimum), ("max", point.maximum)):
                    if raw is not None:
                        entry[key] = point.number(raw)
                if point.enum:
                    entry["enum"] = {str(i.number): i.label for i in point.enum}
                if point.fields:
                    entry["bits"] = [{"name": f.name, "offset": f.low, "length": f.width} for f in point.fields]
                if point.doc:
                    entry["description"] = point.doc
                entries.append(entry)
    made = {
        "mbmap": 2,
        "name": device.title or device.name,
        "manufacturer": device.identity.vendor,
        "model": device.identity.product or device.name,
        "revision": device.version,
        "addressBase": 0,
        "byteOrder": "big",
        "wordOrder": device.word_order,
        "serial": {"slave": device.line.address, "baud": device.line.baud, "format": device.line.format},
        "registers": entries,
    }
    return json.dumps(made, indent=2, ensure_ascii=False) + "\n"


def generate(device: Device) -> dict[str, str]:
    """{tags/...: text}."""
    return {
        "tags/telegraf.conf": telegraf(device),
        "tags/home_assistant.yaml": home_assistant(device),
        "tags/node_red.json": node_red.flow(device),
        "tags/modpoll.csv": modpoll(device),
        "tags/wot.json": web_of_things(device),
        "tags/mbmap.json": mbmap(device),
    }
