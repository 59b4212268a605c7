# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.live.json: tables, reset values and names for the live device; and NAME_live.v, NAME with the pins of sim/."""

from __future__ import annotations

import json
from typing import Any

from modbus_map.model import SPACES, TABLES, Device, Point
from modbus_map.rtl_plan import FILES_SPACE, Plan

# Of the live device's host port: the words of all inputs in a row; the same of all registers, to read
INPUTS_SPACE, OUTPUTS_SPACE = 1, 6
CORE_SPACE = 5  # counters and event log, with the items of modbus_host_map
COUNTING_FUNCTIONS = {0x08, 0x0B, 0x0C}  # with one of them the core has counters
HELD = {"wire": INPUTS_SPACE, "register": OUTPUTS_SPACE}
WORD = 16
ZERO, NOTHING = "1'b0", "16'd0"
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
    if point.kind in HELD:
        words = port_words(device, point.kind)[point.name]
        found["host"] = {"space": HELD[point.kind], "item": words.start, "words": len(words)}
    elif point.kind == "memory":
        found["host"] = {"space": SPACES[point.table], "item": point.at, "words": point.size}
    return found


def number(point: Point, raw: int) -> int | float | str:
    """What a bit pattern stands for, as JSON can say it: a float that is no number is its name."""
    found = point.number(raw)
    return str(found) if isinstance(found, float) and found - found != 0 else found


def port_words(device: Device, kind: str) -> dict[str, range]:
    """The words of each point of this kind among those of all; a port begins with a word of its own."""
    found, used = {}, 0
    for point in device.points:
        if point.kind == kind:
            words = -(-point.bits * point.count // WORD)
            found[point.name] = range(used, used + words)
            used += words
    return found


def input_words(device: Device) -> dict[str, range]:
    """The words of each input among those of all inputs."""
    return port_words(device, "wire")


def wrapper(device: Device) -> str:
    """NAME_live.v: NAME behind the ports of sim/modbus_live_ports.vh."""
    words = input_words(device) | port_words(device, "register")
    inputs, outputs = (sum(map(len, port_words(device, kind).values())) for kind in HELD)
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
        binds += [".address_i(address_q)", ".bit_time_i(bit_time_q)", ".format_i(format_q)"]
    for port in device.port_list():
        if port.role in ("value", "strobe", "alive"):
            inside = ""
            if port.role == "value" and port.point:
                held = "inputs_q" if port.direction == "input" else "outputs"
                inside = f"{held}[{WORD * words[port.point.name].start} +: {port.width}]"
            binds.append(f".{port.name}({inside})")
    if memory:
        binds += [".host_cyc_i(host_cyc_q)", ".host_stb_i(memory_stb)", ".host_we_i(host_we_q)"]
        binds += [".host_adr_i(host_adr_q)", ".host_dat_i(host_dat_q)", ".host_dat_o(memory_read)"]
        binds += [".host_ack_o(memory_ack)", ".host_err_o(memory_err)"]
    lines = [
        f"// Made{f' from {device.source}' if device.source else ''} by modbus map; change the map, not this file.",
        "//",
        f"// {device.name}_live - {device.name} as the live device runs it.",
        "//",
        f"// Space {INPUTS_SPACE} of the host port: the words of all inputs in a row; space {OUTPUTS_SPACE}: those of all",
        f"// registers, to read; space {CORE_SPACE}: counters and event log, where there are some; other spaces: the memory.",
        "",
        "`default_nettype none",
        '`include "modbus_defs.vh"',
        "",
        f"module {device.name}_live #(",
        ",\n".join(f"  {text}" for text in parameters),
        ")",
        '`include "modbus_live_ports.vh"',
        "",
        "  wire        stb  = host_cyc_q & host_stb_q;",
        "  wire [2:0]  space = host_adr_q[18:16];",
        "  wire [15:0] item  = host_adr_q[15:0];",
    ]
    acks, errors, reads = [], [], []
    for held, space, count in (("inputs_q", INPUTS_SPACE, inputs), ("outputs", OUTPUTS_SPACE, outputs)):
        if not count:
            continue
        name = held.removesuffix("_q")
        value = f"{WORD * count}'d0"
        lines += [
            "  // A port of fewer bits leaves some of its last word:",
            "  // verilator lint_off UNUSED",
            f"  reg  [{WORD * count - 1}:0] {held} = {value};"
            if held == "inputs_q"
            else f"  wire [{WORD * count - 1}:0] {held};",
            "  // verilator lint_on UNUSED",
            f"  wire {name}_stb = stb & (space == 3'd{space}) & (item < {count}){'' if held == 'inputs_q' else ' & ~host_we_q'};",
        ]
        acks.append(f"{name}_stb")
        reads.append(f"{name}_stb ? {held}[{WORD} * item +: {WORD}]")
    for point in device.points:  # bits that no port drives
        held = words[point.name] if point.kind == "register" else range(0)
        spare = WORD * len(held) - point.bits * point.count
        if spare > 0:
            lines.append(f"  assign outputs[{WORD * held.stop - spare} +: {spare}] = {spare}'d0;")
    if inputs:
        lines += [
            "  always @(posedge clk_i)",
            f"    if (inputs_stb && host_we_q) inputs_q[{WORD} * item +: {WORD}] <= host_dat_q;",
        ]
    if COUNTING_FUNCTIONS & set(device.functions):
        kept = "u_device.u_core.u_engine.gen_diagnostics.u_diagnostics"
        lines += [
            "  // The device does not bring out the status port; so they are read where they are kept.",
            f"  wire core_stb = stb & (space == 3'd{CORE_SPACE}) & (item < 128) & ~host_we_q;",
            f"  wire [5:0]  entry = {kept}.newest_q + item[5:0];",
            f"  wire [15:0] state = item[1] ? {{9'd0, {kept}.entries_q}} : item[0] ? {{15'd0, {kept}.listen_only_q}} : {kept}.register_q;",
            f"  wire [15:0] core_read = ~item[6] & (item[5:2] == 4'd0) ? state : {kept}.memory[{{item[6], item[6] ? entry : item[5:0]}}];",
        ]
        acks.append("core_stb")
        reads.append("core_stb ? core_read")
    if memory:
        others = " & ".join(f"(space != 3'd{one})" for one in (INPUTS_SPACE, CORE_SPACE, OUTPUTS_SPACE))
        lines += [
            f"  wire memory_stb = host_stb_q & {others};",
            "  wire memory_ack, memory_err;",
            "  wire [15:0] memory_read;",
            f"  wire none_stb = stb & ~({' | '.join([*acks, 'memory_stb'])});",
        ]
        acks.append("memory_ack")
        errors.append("memory_err")
    else:
        lines.append(f"  wire none_stb = stb & ~({' | '.join(acks or [ZERO])});")
    lines += [
        f"  assign host_ack_o = {' | '.join(acks or [ZERO])};",
        f"  assign host_err_o = {' | '.join([*errors, 'none_stb'])};",
        f"  assign host_dat_o = {' : '.join([*reads, 'memory_read' if memory else NOTHING])};",
    ]
    core = "u_device.u_core"
    lines += [
        "",
        "  // What the device does not bring out is taken from inside:",
        *(f"  assign {name} = {core}.{name};" for name in ("events_o", "listen_only_o", "rx_active_o", "idle_o", "write_stb_o")),
        *(f"  assign write_{part}_o = {core}.grant_{part}_o;" for part in ("space", "first", "last", "file")),
    ]
    lines += [
        "",
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

