# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""tags/: each file by the schema or the program it is for, and each decodes the same registers as the model does."""

import ast
import csv
import dataclasses
import json
import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest
import tomllib
import voluptuous as vol
import yaml
from modbus_map.checks import load_device
from modbus_map.model import TABLES
from modbus_map.outputs import tags

from map.output_devices import EVERYTHING, RELAY_BOX, SAMPLES

SCHEMAS = Path(__file__).parent / "schemas"
DEVICES = pytest.mark.parametrize("device", [RELAY_BOX, EVERYTHING], ids=lambda d: d.name)
TURNS = range(5)


def registers(device, turn):
    """({table: {address: register}}, {item name: value}) of one turn of the samples."""
    tables = {"coils": {}, "discrete_inputs": {}, "holding_registers": {}, "input_registers": {}}
    values = {}
    for point in device.points:
        for item in range(point.count):
            numbers = SAMPLES.get(point.name, [(turn + item) % 2])
            raw = point.raw(numbers[(turn + item) % len(numbers)])
            tables[point.table] |= dict(zip(point.addresses(item), point.registers(raw)))
            values[f"{point.name}_{item}" if point.is_array else point.name] = point.value(raw)
    return tables, values


def words(table, at, count):
    return [table[at + k] for k in range(count)]


def readable(device):
    return {f"{p.name}_{k}" if p.is_array else p.name for p in device.points if p.readable for k in range(p.count)}


def unpacked(kind, data):
    """A number of its bytes, for the type names of Telegraf and Home Assistant."""
    letters = {"uint16": "H", "int16": "h", "uint32": "I", "int32": "i", "uint64": "Q", "int64": "q", "float32": "f",
               "float64": "d"}  # fmt: skip
    return struct.unpack(">" + letters[kind.lower()], data)[0]


def bytes_of(parts, reverse=False):
    return b"".join(word.to_bytes(2, "big") for word in (parts[::-1] if reverse else parts))


# ---------------------------------------------------------------- Telegraf: the documented keys of inputs.modbus

FIELD = {
    vol.Required("address"): vol.All(int, vol.Range(0, 65535)),
    vol.Required("name"): str,
    "type": vol.In(["BIT", "INT16", "UINT16", "INT32", "UINT32", "INT64", "UINT64", "FLOAT32", "FLOAT64", "STRING"]),
    "length": int,
    "bit": int,
    "scale": float,
    "output": vol.In(["INT64", "UINT64", "FLOAT64", "STRING"]),
    "omit": bool,
    "measurement": str,
}
REQUEST = {
    vol.Required("slave_id"): vol.All(int, vol.Range(0, 247)),
    vol.Required("register"): vol.In(["coil", "discrete", "holding", "input"]),
    "byte_order": vol.In(["ABCD", "DCBA", "BADC", "CDAB"]),
    "measurement": str,
    "optimization": str,
    vol.Required("fields"): [FIELD],
}
TELEGRAF = vol.Schema(
    {
        vol.Required("inputs"): {
            vol.Required("modbus"): [
                {
                    vol.Required("name"): str,
                    vol.Required("controller"): str,
                    "baud_rate": int,
                    "data_bits": vol.In([7, 8]),
                    "parity": vol.In(["N", "E", "O"]),
                    "stop_bits": vol.In([1, 2]),
                    "transmission_mode": vol.In(["TCP", "RTU", "RTUoverTCP", "ASCII", "ASCIIoverTCP", "auto"]),
                    "timeout": str,
                    "configuration_type": vol.In(["register", "request", "metric"]),
                    vol.Required("request"): [REQUEST],
                }
            ]
        },
        "processors": {"starlark": [{"namepass": [str], "source": str}]},
    }
)


@DEVICES
def test_telegraf(device):
    made = TELEGRAF(tomllib.loads(tags.telegraf(device)))
    source = made.get("processors", {}).get("starlark", [{"source": "offsets = {}"}])[0]["source"].strip()
    offsets = ast.literal_eval(ast.parse(source).body[0].value)
    names = {"coil": "coils", "discrete": "discrete_inputs", "holding": "holding_registers", "input": "input_registers"}
    for turn in TURNS:
        tables, values = registers(device, turn)
        seen = {}
        for request in made["inputs"]["modbus"][0]["request"]:
            table = tables[names[request["register"]]]
            for field in request["fields"]:
                at, kind = field["address"], field.get("type")
                if kind is None:
                    seen[field["name"]] = table[at]
                elif kind == "STRING":
                    seen[field["name"]] = bytes_of(words(table, at, field["length"])).rstrip(b"\0").decode("latin-1")
                else:
                    size = int(kind.lstrip("UINTFLOA")) // 16
                    number = unpacked(kind, bytes_of(words(table, at, size), request["byte_order"] == "CDAB"))
                    number = number * field["scale"] if "scale" in field else number
                    seen[field["name"]] = number + offsets.get(field["name"], 0)
        assert set(seen) == readable(device)
        for name, value in seen.items():
            assert value == (values[name] if isinstance(value, str) else pytest.approx(values[name], rel=1e-12)), name


# ---------------------------------------------------------------- Home Assistant: the keys of the modbus integration

ENTITY = {
    vol.Required("name"): str,
    vol.Required("address"): vol.All(int, vol.Range(0)),
    "unique_id": str,
    "device_address": vol.All(int, vol.Range(0)),
    "scan_interval": int,
}
SENSOR = {
    **ENTITY,
    vol.Required("input_type"): vol.In(["holding", "input"]),
    vol.Required("data_type"): vol.In(
        [f"{kind}{bits}" for kind in ("int", "uint", "float") for bits in (16, 32, 64)] + ["string"]
    ),
    "count": int,
    "scale": vol.Coerce(float),
    "offset": vol.Coerce(float),
    "precision": vol.All(int, vol.Range(0)),
    "swap": vol.In(["word"]),
    "unit_of_measurement": str,
    "state_class": vol.In(["measurement", "total", "total_increasing"]),
}
HOME_ASSISTANT = vol.Schema(
    {
        "modbus": [
            {
                vol.Required("name"): str,
                vol.Required("type"): "serial",
                vol.Required("method"): vol.In(["rtu", "ascii"]),
                vol.Required("port"): str,
                vol.Required("baudrate"): int,
                vol.Required("bytesize"): vol.In([5, 6, 7, 8]),
                vol.Required("parity"): vol.In(["E", "O", "N"]),
                vol.Required("stopbits"): vol.In([1, 2]),
                "sensors": [SENSOR],
                "binary_sensors": [{**ENTITY, "input_type": vol.In(["coil", "discrete_input", "holding", "input"])}],
                "switches": [{**ENTITY, "write_type": vol.In(["coil", "holding"]), "verify": {"input_type": "coil"}}],
            }
        ]
    }
)


@DEVICES
def test_home_assistant(device):
    hub = HOME_ASSISTANT(yaml.safe_load(tags.home_assistant(device)))["modbus"][0]
    entities = [e for kind in ("sensors", "binary_sensors", "switches") for e in hub.get(kind, [])]
    assert len({e["unique_id"] for e in entities}) == len({e["name"] for e in entities}) == len(entities)
    for turn in TURNS:
        tables, values = registers(device, turn)
        seen = {}
        for entity in entities:
            name, at = entity["unique_id"].removeprefix(f"{device.name}_"), entity["address"]
            kind = entity.get("data_type")
            if kind is None:
                table = {"discrete_input": "discrete_inputs"}.get(entity.get("input_type"), "coils")
                seen[name] = tables[table][at]
                continue
            table = tables["holding_registers" if entity["input_type"] == "holding" else "input_registers"]
            if kind == "string":
                seen[name] = bytes_of(words(table, at, entity["count"])).rstrip(b"\0").decode()
                assert seen[name] == values[name]
                continue
            size = int(kind.lstrip("uintfloa")) // 16
            number = unpacked(kind, bytes_of(words(table, at, size), entity.get("swap") == "word"))
            seen[name] = number * entity.get("scale", 1) + entity.get("offset", 0)
            step = 10 ** -entity["precision"]
            assert seen[name] == pytest.approx(values[name], rel=1e-12), name
            assert kind.startswith("float") or abs(values[name] / step - round(values[name] / step)) < 1e-3, name
        written_only = {p.name for p in device.points if p.access == "wo" and p.table == "coils"}
        assert set(seen) == readable(device) | written_only


HOME_ASSISTANT_WHEEL = os.environ.get("HOMEASSISTANT", "")
WRONG = [("data_type: uint16", "data_type: uint17"), ("parity: ", "parity: X #"), ("address: ", "adress: ")]


@pytest.mark.skipif(
    not HOME_ASSISTANT_WHEEL,
    reason="HOMEASSISTANT=wheel, from `pip download --no-deps homeassistant==2024.3.3`, is not given",
)
def test_home_assistant_by_its_own_schema():
    """The schema of the program itself takes all samples and reference maps, and refuses what is wrong."""

    def judged(text):
        command = [sys.executable, Path(__file__).parent / "home_assistant.py", HOME_ASSISTANT_WHEEL]
        return subprocess.run(command, input=text, capture_output=True, text=True, check=False)

    maps = sorted((Path(__file__).parents[2] / "examples").glob("*/*.yaml"))
    for device in (RELAY_BOX, EVERYTHING, *(load_device(path)[0] for path in maps)):
        done = judged(tags.home_assistant(device))
        assert done.returncode == 0, f"{device.name}: {done.stderr}"
    good = tags.home_assistant(EVERYTHING)
    for old, new in WRONG:
        done = judged(good.replace(old, new, 1))
        assert done.returncode == 1 and "Traceback" not in done.stderr, f"{new}: {done.stderr}"


# ---------------------------------------------------------------- Web of Things, MBMap: their JSON Schemas


def schema(name):
    return json.loads((SCHEMAS / name).read_text(encoding="utf-8"))


@DEVICES
def test_web_of_things(device):
    """By the JSON Schema of TD 1.1; each form decodes as the model does."""
    thing = json.loads(tags.web_of_things(device))
    jsonschema.Draft7Validator(schema("td-1.1.json")).validate(thing)
    assert set(thing["properties"]) == {point.name for point in device.points}
    sizes = {"Short": "h", "unsignedShort": "H", "short": "h", "unsignedInt": "I", "int": "i", "unsignedLong": "Q",
             "long": "q", "float": "f", "double": "d"}  # fmt: skip
    for turn in TURNS:
        tables, values = registers(device, turn)
        for name, about in thing["properties"].items():
            form = about["forms"][0]
            at, quantity = (int(n) for n in form["href"].split("/")[2].split("?quantity="))
            kind = form["modv:type"].removeprefix("xsd:")
            table = {"Coil": "coils", "DiscreteInput": "discrete_inputs", "HoldingRegister": "holding_registers",
                     "InputRegister": "input_registers"}[form["modv:entity"]]  # fmt: skip
            raw = words(tables[table], at, quantity)
            if kind == "boolean":
                found = raw
            elif kind == "string":
                found = [bytes_of(raw).rstrip(b"\0").decode()]
            else:
                width = struct.calcsize(sizes[kind]) // 2
                reverse = not form.get("modv:mostSignificantWord", True)
                parts = [bytes_of(raw[k : k + width], reverse) for k in range(0, quantity, width)]
                found = [struct.unpack(">" + sizes[kind], part)[0] for part in parts]
                scale, offset = about.get("map:scale", 1), about.get("map:offset", 0)
                one = about["items"] if about.get("type") == "array" else about
                for number in found:
                    jsonschema.validate(
                        number, {k: v for k, v in one.items() if k in ("type", "minimum", "maximum", "oneOf")}
                    )
                found = [number * scale + offset for number in found]
            is_array = about.get("type") == "array"
            wanted = [values[f"{name}_{k}" if is_array else name] for k in range(len(found))]
            assert found == (wanted if kind == "string" else pytest.approx(wanted, rel=1e-12)), name


@DEVICES
def test_mbmap(device):
    """By the schema in schemas/, which was written from the format's published description."""
    made = json.loads(tags.mbmap(device))
    jsonschema.Draft202012Validator(schema("mbmap.json")).validate(made)
    for turn in TURNS:
        tables, values = registers(device, turn)
        for entry in made["registers"]:
            part = words(tables[entry["table"]], entry["address"], entry.get("length", 1))
            if entry["type"] == "bool":
                value = part[0]
            elif entry["type"] == "string":
                value = bytes_of(part).rstrip(b"\0").decode()
            else:
                number = unpacked(entry["type"], bytes_of(part, entry.get("wordOrder") == "little"))
                value = pytest.approx(number * entry.get("scale", 1) + entry.get("offset", 0), rel=1e-12)
            assert values[entry["name"]] == value, entry["name"]


# ---------------------------------------------------------------- a device that answers short requests only


def test_no_request_is_longer_than_the_map_allows():
    """`core: {MAX_READ_REGISTERS: ..., ...}` of the map holds for every program that polls."""
    few = {"MAX_READ_REGISTERS": 6, "MAX_WRITE_REGISTERS": 4, "MAX_READ_BITS": 3, "MAX_WRITE_BITS": 2}
    device = dataclasses.replace(EVERYTHING, core=tuple((dict(EVERYTHING.core) | few).items()))
    most = {
        table: few["MAX_READ_BITS" if table in ("coils", "discrete_inputs") else "MAX_READ_REGISTERS"]
        for table in TABLES
    }
    names = {"coil": "coils", "discrete": "discrete_inputs", "holding": "holding_registers", "input": "input_registers"}
    seen = set()
    for request in TELEGRAF(tomllib.loads(tags.telegraf(device)))["inputs"]["modbus"][0]["request"]:
        ends = []
        for field in request["fields"]:
            kind = field.get("type", "BIT")
            size = field["length"] if kind == "STRING" else max(1, int(kind.lstrip("BUINTFLOA") or 1) // 16)
            ends.append((field["address"], field["address"] + size))
            seen.add(field["name"])
        assert max(end for _, end in ends) - min(at for at, _ in ends) <= most[names[request["register"]]]
    fits = {
        f"{p.name}_{k}" if p.is_array else p.name
        for p in device.points
        if p.readable and p.width <= most[p.table]
        for k in range(p.count)
    }
    assert seen == fits
    entities = {name: table for table, name in tags.WOT_ENTITY.items()}
    thing = json.loads(tags.web_of_things(device))
    jsonschema.Draft7Validator(schema("td-1.1.json")).validate(thing)
    covered = set()
    for about in thing["properties"].values():
        form = about["forms"][0]
        table = entities[form["modv:entity"]]
        at, quantity = (int(n) for n in form["href"].split("/")[2].split("?quantity="))
        covered |= {(table, a) for a in range(at, at + quantity)}
        if "readproperty" in form["op"]:
            assert quantity <= most[table]
        if "writeproperty" in form["op"]:
            assert quantity <= few["MAX_WRITE_BITS" if table == "coils" else "MAX_WRITE_REGISTERS"]
    for point in device.points:
        limit = most[point.table] if point.readable else 4
        for item in range(point.count if point.width <= limit else 0):
            assert {(point.table, a) for a in point.addresses(item)} <= covered, point.name


# ---------------------------------------------------------------- modpoll


@DEVICES
def test_modpoll(device):
    """Rows by modpoll's rules: a reference lies inside its poll, a poll reads only what exists, at most 123 registers."""
    rows = list(csv.reader(tags.modpoll(device).splitlines()))
    assert rows[0] == ["device", device.name, "17"]
    kinds = {"coil": "coils", "discrete_input": "discrete_inputs", "holding_register": "holding_registers",
             "input_register": "input_registers"}  # fmt: skip
    for turn in TURNS:
        tables, values = registers(device, turn)
        seen = {}
        for row in rows[1:]:
            if row[0] == "poll":
                table, start, size, order = kinds[row[1]], int(row[2]), int(row[3]), row[4]
                assert size <= (2000 if "coil" in row[1] or "discrete" in row[1] else 123)
                raw = words(tables[table], start, size)  # KeyError where nothing is
                continue
            name, (at, _, bit), kind = row[1], row[2].partition(":"), row[3]
            part = raw[int(at) - start :]
            if kind == "bool8":
                stem, _, first = name.rpartition("_")
                for k, value in enumerate(part[:8]):
                    seen[f"{stem}_{int(first) + k}" if first.isdigit() and stem else name] = value
            elif kind == "bool":
                assert part[0] >> int(bit) & 1 == values[name.partition(".")[0]] >> int(bit) & 1
            elif kind.startswith("string"):
                seen[name] = bytes_of(part[: int(kind[6:]) // 2]).rstrip(b"\0").decode()
            else:
                size = int(kind.lstrip("uintfloa")) // 16
                number = unpacked(kind, bytes_of(part[:size], order == "BE_LE" and size > 1))
                offset = float(row[5].partition("(add ")[2].rstrip(")") or 0)
                seen[name] = number * (float(row[6]) if len(row) > 6 else 1) + offset
        assert set(seen) == readable(device)
        for name, value in seen.items():
            assert value == (values[name] if isinstance(value, str) else pytest.approx(values[name], rel=1e-12)), name


# ---------------------------------------------------------------- Node-RED

DEFAULTS = json.loads((SCHEMAS / "node_red_modbus.json").read_text(encoding="utf-8"))


@DEVICES
def test_node_red_flow(device):
    """Properties are those of the nodes, wires lead to nodes, ids are unique."""
    nodes = json.loads(tags.generate(device)["tags/node_red.json"])
    ids = [node["id"] for node in nodes]
    assert len(set(ids)) == len(ids)
    for node in nodes:
        assert {target for wires in node.get("wires", []) for target in wires} <= set(ids)
        assert node.get("server", ids[0]) in ids and node.get("z", ids[0]) == ids[0]
        if node["type"] in DEFAULTS:
            assert set(node) - {"id", "type", "z", "x", "y", "wires"} <= set(DEFAULTS[node["type"]]), node["type"]


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed: the functions are not run")
def test_node_red_functions():
    """The code of the function nodes, run by Node.js: decode gives the values of the model, encode the registers."""
    nodes = json.loads(tags.generate(EVERYTHING)["tags/node_red.json"])
    tables, values = registers(EVERYTHING, 1)
    kinds = {"Coil": "coils", "Input": "discrete_inputs", "HoldingRegister": "holding_registers",
             "InputRegister": "input_registers"}  # fmt: skip
    by_id = {node["id"]: node for node in nodes}
    jobs = []
    for node in nodes:
        if node["type"] == "modbus-read":
            part = words(tables[kinds[node["dataType"]]], int(node["adr"]), int(node["quantity"]))
            jobs.append([by_id[node["wires"][0][0]]["func"], {"payload": part}])
    (encode,) = [node["func"] for node in nodes if node.get("name") == "encode"]
    written = [p for p in EVERYTHING.points if p.writable and p.name in SAMPLES]
    for point in written:
        numbers = [values[f"{point.name}_{k}"] for k in range(point.count)] if point.is_array else values[point.name]
        jobs.append([encode, {"topic": point.name, "payload": numbers}])
    refused = [("ramp", 61), ("mode", 2), ("speed", 1), ("gains", [1])]
    jobs += [[encode, {"topic": name, "payload": value}] for name, value in refused]
    script = (
        "const jobs = JSON.parse(require('fs').readFileSync(0));"
        "console.log(JSON.stringify(jobs.map(([f, m]) => new Function('msg', 'node', f)(m, { error() {} }))));"
    )
    done = subprocess.run(["node", "-e", script], input=json.dumps(jobs), capture_output=True, text=True, check=True)
    said = json.loads(done.stdout)
    seen = {}
    for message in said[: -len(written) - len(refused)]:
        for name, value in message["payload"].items():
            seen |= {f"{name}_{k}": v for k, v in enumerate(value)} if isinstance(value, list) else {name: value}
    assert set(seen) == readable(EVERYTHING)
    for name, value in seen.items():
        assert value == (values[name] if isinstance(value, str) else pytest.approx(values[name], rel=1e-12)), name
    for point, message in zip(written, said[-len(written) - len(refused) :]):
        made = message["payload"]
        wanted = words(tables[point.table], point.at, point.size)
        assert made["value"] == (wanted if made["fc"] in (15, 16) else wanted[0]), point.name
        assert (made["address"], made["quantity"], made["unitid"]) == (point.at, point.size, 17)
    assert said[-len(refused) :] == [None] * len(refused)
