# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""tags/node_red.json: a flow for node-red-contrib-modbus.

Each block is polled by a modbus-read node and decoded by a function node: msg.payload is {point: value}. One message
with topic = point and payload = value goes through the function `encode` to a modbus-flex-write node.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

from modbus_map.model import Device, Point
from modbus_map.outputs import shared

DATA_TYPES = {
    "coils": "Coil", "discrete_inputs": "Input", "holding_registers": "HoldingRegister",
    "input_registers": "InputRegister",
}  # fmt: skip
DECODE = """\
const raw = Array.isArray(msg.payload) ? msg.payload : msg.payload.data;
const values = {};
for (const p of points) {
  const items = [];
  for (let k = 0; k < p.count; k++) {
    const words = raw.slice(p.at + k * p.width, p.at + (k + 1) * p.width).map(Number);
    items.push(value(p, words));
  }
  values[p.name] = p.array ? items : items[0];
}
msg.payload = values;
return msg;

function value(p, words) {
  if (p.type === "bool") return Boolean(words[0]);
  if (p.little) words.reverse();
  const b = Buffer.alloc(2 * words.length);
  words.forEach((word, k) => b.writeUInt16BE(word, 2 * k));
  if (p.type === "string") return b.toString("latin1").replace(/\\0+$/, "");
  const n = { u16: () => b.readUInt16BE(), i16: () => b.readInt16BE(), u32: () => b.readUInt32BE(),
    i32: () => b.readInt32BE(), f32: () => b.readFloatBE(), f64: () => b.readDoubleBE(),
    u64: () => Number(b.readBigUInt64BE()), i64: () => Number(b.readBigInt64BE()) }[p.type]();
  return n * p.up / p.down + p.offset;
}
"""
ENCODE = """\
const p = points[msg.topic];
if (!p) { node.error("no point " + msg.topic + " that can be written"); return null; }
const items = p.array ? msg.payload : [msg.payload];
if (items.length !== p.count) { node.error(msg.topic + " has " + p.count + " items"); return null; }
let words = [];
for (const item of items) {
  if (p.type === "bool") { words.push(Boolean(item)); continue; }
  const b = Buffer.alloc(2 * p.width);
  if (p.type === "string") b.write(String(item), "latin1");
  else {
    let n = (item - p.offset) * p.down / p.up;
    if (p.type[0] !== "f") n = Math.round(n);
    if ((p.low !== null && n < p.low) || (p.high !== null && n > p.high) || (p.only && !p.only.includes(n))) {
      node.error(msg.topic + ": " + item + " is out of range");
      return null;
    }
    ({ u16: () => b.writeUInt16BE(n), i16: () => b.writeInt16BE(n), u32: () => b.writeUInt32BE(n),
      i32: () => b.writeInt32BE(n), f32: () => b.writeFloatBE(n), f64: () => b.writeDoubleBE(n),
      u64: () => b.writeBigUInt64BE(BigInt(n)), i64: () => b.writeBigInt64BE(BigInt(n)) })[p.type]();
  }
  const part = [];
  for (let k = 0; k < p.width; k++) part.push(b.readUInt16BE(2 * k));
  words = words.concat(p.little ? part.reverse() : part);
}
const one = words.length === 1 && p.single;
msg.payload = { value: one ? words[0] : words, fc: one ? p.single : p.multiple, unitid: unit, address: p.at,
  quantity: words.length };
return msg;
"""


def _facts(point: Point, at: int, count: int) -> dict[str, Any]:
    scale, offset = shared.exact_of(point.scale), shared.exact_of(point.offset)
    kind = "string" if point.is_string else "u16" if point.type == "bits" else point.type
    return {
        "name": point.name, "at": at, "width": point.width, "count": count, "array": point.is_array, "type": kind,
        "little": point.word_order == "little" and point.width > 1,
        "up": scale.numerator, "down": scale.denominator, "offset": float(offset),
    }  # fmt: skip


def flow(device: Device) -> str:
    """The flow as JSON, for the import dialog."""

    def new(role: str) -> str:
        return hashlib.sha256(f"{device.name} {role}".encode()).hexdigest()[:16]

    line, tab, server = device.line, new("tab"), new("client")
    nodes: list[dict[str, Any]] = [
        {"id": tab, "type": "tab", "label": device.title or device.name, "disabled": False, "info": device.doc},
        {
            "id": server, "type": "modbus-client", "name": device.name, "clienttype": "simpleser",
            "bufferCommands": True, "stateLogEnabled": False, "queueLogEnabled": False, "failureLogEnabled": True,
            "tcpHost": "127.0.0.1", "tcpPort": "502", "tcpType": "DEFAULT", "serialPort": "/dev/ttyUSB0",
            "serialType": "RTU-BUFFERD", "serialBaudrate": str(line.baud), "serialDatabits": "8",
            "serialStopbits": str(line.stop_bits), "serialParity": {"N": "none", "E": "even", "O": "odd"}[line.parity],
            "serialConnectionDelay": "100", "serialAsciiResponseStartDelimiter": "0x3A", "unit_id": str(line.address),
            "commandDelay": "1", "clientTimeout": "1000", "reconnectOnTimeout": True, "reconnectTimeout": "2000",
            "parallelUnitIdsAllowed": True, "showErrors": False, "showWarnings": True, "showLogs": True,
        },
    ]  # fmt: skip
    y = 60
    for block in shared.blocks(device):
        role = f"{block.table} {block.at}"
        points = []
        for point in dict.fromkeys(point for point, _ in block.items):
            items = [item for p, item in block.items if p is point]
            points.append(_facts(point, point.addresses(items[0])[0] - block.at, len(items)))
        nodes += [
            {
                "id": new(f"read {role}"), "type": "modbus-read", "z": tab, "name": role, "topic": role,
                "showStatusActivities": True, "logIOActivities": False, "showErrors": True, "showWarnings": True,
                "unitid": str(line.address), "dataType": DATA_TYPES[block.table], "adr": str(block.at),
                "quantity": str(block.size), "rate": "1", "rateUnit": "s", "delayOnStart": False,
                "startDelayTime": "", "server": server, "useIOFile": False, "ioFile": "", "useIOForPayload": False,
                "emptyMsgOnFail": False, "x": 160, "y": y, "wires": [[new(f"decode {role}")], []],
            },
            _function(new(f"decode {role}"), tab, "decode", points, line.address, DECODE, 400, y, new("debug")),
        ]  # fmt: skip
        y += 60
    nodes.append(
        {
            "id": new("debug"), "type": "debug", "z": tab, "name": "values", "active": True, "tosidebar": True,
            "console": False, "tostatus": False, "complete": "payload", "targetType": "msg", "x": 640, "y": 60,
            "wires": [],
        }
    )  # fmt: skip
    written = {}
    for point in device.points:
        single, multiple = (5, 15) if point.is_bit else (6, 16)
        if not point.writable or not (device.has_function(single) or device.has_function(multiple)):
            continue
        low, high = (
            None if raw is None or point.is_string else point.number(raw) for raw in (point.minimum, point.maximum)
        )
        written[point.name] = _facts(point, point.at, point.count) | {
            "low": low, "high": high, "only": [i.number for i in point.enum] if point.enum_is_limit else None,
            "single": single if device.has_function(single) else 0, "multiple": multiple,
        }  # fmt: skip
    if written:
        nodes += [
            {"id": new("link"), "type": "link in", "z": tab, "name": f"write {device.name}", "links": [], "x": 115,
             "y": y, "wires": [[new("encode")]]},
            _function(new("encode"), tab, "encode", written, line.address, ENCODE, 400, y, new("write")),
            {"id": new("write"), "type": "modbus-flex-write", "z": tab, "name": "write", "showStatusActivities": True,
             "showErrors": True, "showWarnings": True, "server": server, "emptyMsgOnFail": False,
             "keepMsgProperties": False, "delayOnStart": False, "startDelayTime": "", "x": 640, "y": y,
             "wires": [[], []]},
        ]  # fmt: skip
    return json.dumps(nodes, indent=1, ensure_ascii=False) + "\n"


def _function(
    node: str, tab: str, name: str, points: Any, unit: int, body: str, x: int, y: int, target: str
) -> dict[str, Any]:
    code = f"const unit = {unit};\nconst points = {json.dumps(points)};\n{body}"
    return {
        "id": node, "type": "function", "z": tab, "name": name, "func": code, "outputs": 1, "timeout": 0,
        "noerr": 0, "initialize": "", "finalize": "", "libs": [], "x": x, "y": y, "wires": [[target]],
    }  # fmt: skip
