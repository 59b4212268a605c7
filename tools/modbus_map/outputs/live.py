# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.live.json: tables, reset values and names for the live device; and NAME_live.v, NAME with the pins of sim/."""

from __future__ import annotations

import json
from typing import Any

from modbus_map.model import SPACES, TABLES, Device, Point
from modbus_map.rtl_plan import FILES_SPACE, Plan

INPUTS_SPACE = 1  # of the live device's host port: the words of all inputs in a row
WORD = 16
MOST_WORDS = 65536  # of a space


def generate(device: Device) -> dict[str, str]:
    """The file that says what the live device has and how it is addressed."""
    return {f"{device.name}.live.json": text(facts(device))}


def text(found: dict[str, Any]) -> str:
    """As JSON with a point a line."""

    def said(value: Any) -> str:
        return json.dumps(value, ensure_ascii=False)

    def listed(rows: list[Any]) -> str:
        return "[\n    " + ",\n    ".join(map(said, rows)) + "\n  ]" if rows else "[]"

    lines = []
    for key, value in found.items():
        if key == "tables":
            tables = ",\n  ".join(f"{said(table)}: {listed(points)}" for table, points in value.items())
            lines.append(f'"tables": {{\n  {tables}\n }}')
        else:
            lines.append(f"{said(key)}: {listed(value) if key == 'files' else said(value)}")
    return "{\n " + ",\n ".join(lines) + "\n}\n"


def facts(device: Device) -> dict[str, Any]:
    """The content of NAME.live.json."""
    line = device.line
    areas = {area.name: area for area in Plan(device).areas}
    return {
        "device": device.name,
        "title": device.title,
        "version": device.version,
        "source": device.source,
        "top": f"{device.name}_live",
        "line": {"address": line.address, "baud": line.baud, "format": line.format, "run_time": line.run_time},
        "core": dict(device.core),
        "functions": list(device.functions),
        "tables": {table: [of_point(device, point) for point in device.table(table)] for table in TABLES},
        "files": [
            {
                "number": file.number,
                "name": file.name,
                "records": file.records,
                "access": file.access,
                "host": {"space": FILES_SPACE, "item": areas[file.name].host_at, "words": file.records},
            }
            for file in device.files
        ],
    }


def of_point(device: Device, point: Point) -> dict[str, Any]:
    """A point: raw values as numbers of its type, `host` where the live device takes its value."""
    found: dict[str, Any] = {
        "name": point.name,
        "at": point.at,
        "size": point.size,
        "type": point.type,
        "count": point.count,
        "access": point.access,
        "kind": point.kind,
        "reset": [number(point, raw) for raw in point.resets],
    }
    if point.minimum is not None:
        found["min"] = number(point, point.minimum)
    if point.maximum is not None:
        found["max"] = number(point, point.maximum)
    if point.is_scaled:
        found |= {"scale": point.scale, "offset": point.offset}
    if point.enum:
        found["enum"] = {str(item.number): item.label for item in point.enum}
    if point.fields:
        found["bits"] = {item.name: [item.high, item.low] for item in point.fields}
    for key in ("unit", "doc", "freeze"):
        if text := getattr(point, key):
            found[key] = text
    if point.width > 1:
        found["word_order"] = point.word_order
    if point.kind == "wire":
        words = input_words(device)[point.name]
        found["host"] = {"space": INPUTS_SPACE, "item": words.start, "words": len(words)}
    elif point.kind == "memory":
        found["host"] = {"space": SPACES[point.table], "item": point.at, "words": point.size}
    return found


def number(point: Point, raw: int) -> int | float | str:
    """What a bit pattern stands for, as JSON can say it: a float that is no number is its name."""
    found = point.number(raw)
    return str(found) if isinstance(found, float) and found - found != 0 else found


def input_words(device: Device) -> dict[str, range]:
    """The words of each input among those of all inputs; a port begins with a word of its own."""
    found, used = {}, 0
    for point in device.points:
        if point.kind == "wire":
            words = -(-point.bits * point.count // WORD)
            found[point.name] = range(used, used + words)
            used += words
    return found


def wrapper(device: Device) -> str:
    """NAME_live.v: NAME behind the pins of sim/modbus_live.v."""
    words = input_words(device)
    count = sum(map(len, words.values()))
    memory, run_time = device.has_memory, device.line.run_time
    parameters = ["parameter integer CLK_HZ  = 1843200"]
    passed = [".CLK_HZ(CLK_HZ)"]
    if not run_time:
        line = device.line
        parameters += [
            f"parameter integer ADDRESS = {line.address}",
            f"parameter integer BAUD    = {line.baud}",
            f"parameter integer FORMAT  = {line.format_number}",
        ]
        passed += [".ADDRESS(ADDRESS)", ".BAUD(BAUD)", ".FORMAT(FORMAT)"]
    binds = [".clk_i(clk_i)", ".rst_i(rst_q)", ".rxd_i(rxd_q)", ".txd_o(txd_o)", ".de_o(de_o)"]
    if run_time:
        binds += [".address_i(address_i)", ".bit_time_i(bit_time_i)", ".format_i(format_i)"]
    for port in device.port_list():
        if port.role in ("value", "strobe", "alive"):
            inside = ""
            if port.direction == "input" and port.point:
                inside = f"inputs_q[{WORD * words[port.point.name].start} +: {port.width}]"
            binds.append(f".{port.name}({inside})")
    if memory:
        binds += [".host_cyc_i(memory_stb)", ".host_stb_i(memory_stb)", ".host_we_i(memory_stb)"]
        binds += [".host_adr_i(host_adr_q)", ".host_dat_i(host_dat_q)", ".host_dat_o()"]
        binds += [".host_ack_o(memory_ack)", ".host_err_o(memory_err)"]
    lines = [
        f"// Made{f' from {device.source}' if device.source else ''} by modbus map; change the map, not this file.",
        "//",
        f"// {device.name}_live - {device.name} as the live device runs it.",
        "//",
        f"// Space {INPUTS_SPACE} of the host port: the words of all inputs in a row; other spaces: the memory.",
        "",
        "`default_nettype none",
        "",
        f"module {device.name}_live #(",
        ",\n".join(f"  {text}" for text in parameters),
        PORTS,
    ]
    if count:
        lines += [
            "  // A port of fewer bits leaves some of its last word:",
            "  // verilator lint_off UNUSED",
            f"  reg  [{WORD * count - 1}:0] inputs_q = {WORD * count}'d0;",
            "  // verilator lint_on UNUSED",
            f"  wire input_stb = host_stb_q & (host_adr_q[18:16] == 3'd{INPUTS_SPACE}) & (host_adr_q[15:0] < {count});",
            "  always @(posedge clk_i)",
            f"    if (input_stb) inputs_q[{WORD} * host_adr_q[15:0] +: {WORD}] <= host_dat_q;",
        ]
    else:
        lines.append("  wire input_stb = 1'b0;")
    if memory:
        lines += [
            f"  wire memory_stb = host_stb_q & (host_adr_q[18:16] != 3'd{INPUTS_SPACE});",
            "  wire memory_ack, memory_err;",
            "  assign host_ack_o = input_stb | memory_ack;",
            "  assign host_err_o = memory_err | (host_stb_q & ~memory_stb & ~input_stb);",
        ]
    else:
        lines += ["  assign host_ack_o = input_stb;", "  assign host_err_o = host_stb_q & ~input_stb;"]
    lines += [
        "",
        "  // Outputs are read through the line:",
        "  // verilator lint_off PINCONNECTEMPTY",
        f"  {device.name} #({', '.join(passed)}) u_device (",
        ",\n".join(f"    {bind}" for bind in binds),
        "  );",
        "  // verilator lint_on PINCONNECTEMPTY",
        "",
        "endmodule",
        "",
        "`default_nettype wire",
    ]
    return "\n".join(lines) + "\n"


PORTS = """\
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,

  // What the map does not ask for is open:
  // verilator lint_off UNUSED
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        busy_i,
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,

  // Initial contents, written by the bridge
  input  wire        host_stb_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire        host_ack_o,
  output wire        host_err_o
);

  // Each input passes a register, as in modbus_live
  reg         rst_q = 1'b1, rxd_q = 1'b1, host_stb_q = 1'b0;
  reg  [18:0] host_adr_q = 19'd0;
  reg  [15:0] host_dat_q = 16'd0;
  // verilator lint_on UNUSED

  always @(posedge clk_i) begin
    rst_q      <= rst_i;
    rxd_q      <= rxd_i;
    host_stb_q <= host_stb_i;
    host_adr_q <= host_adr_i;
    host_dat_q <= host_dat_i;
  end
"""
