# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.v: core and bank behind named ports, in Verilog-2005; NAME.f; NAME_properties.v for `formal.py --map`."""

from __future__ import annotations

from pathlib import Path

import filelist

from modbus_map import core_parameters
from modbus_map.model import Device, Port
from modbus_map.rtl_bank import Bank, one_line, place_of, port
from modbus_map.rtl_plan import Plan
from modbus_map.rtl_properties import properties
from modbus_map.rtl_text import aligned, bits, packed

ROOT = Path(__file__).resolve().parents[3]
CORE_FOLDER = "$(MODBUS_RTU)"  # in NAME.f: the folder of this project

TEXTS = {
    "VENDOR_NAME": "vendor",
    "PRODUCT_CODE": "product",
    "REVISION": "revision",
    "VENDOR_URL": "url",
    "PRODUCT_NAME": "name",
    "MODEL_NAME": "model",
    "USER_APPLICATION_NAME": "application",
}
REPORT_ID, DEVICE_ID = 17, 43
SERVER_ID_BITS, ADDITIONAL_BITS, PRIVATE_BITS = 128, 2000, 4096


def generate(device: Device) -> dict[str, str]:
    """The three files."""
    name = device.name
    return {
        f"{name}.v": verilog(device),
        f"{name}.f": file_list(device),
        f"{name}_properties.v": properties(device),
    }


def licence(device: Device) -> list[str]:
    """The head of a generated file; what a user makes of his map is his."""
    source = f" from {device.source}" if device.source else ""
    return [f"// Made{source} by modbus map; change the map, not this file."]


def verilog(device: Device) -> str:
    """The whole of NAME.v."""
    top = [*licence(device), *head(device), "", "`default_nettype none", '`include "modbus_defs.vh"', "", *module(device)]
    bank = [
        "",
        f"// {device.name}_bank - the tables of {device.name} behind the grant question and the Wishbone port of the core.",
        "//",
        "// A write of several words is stored in one clock, when its last word has come; while the burst lasts, grant_last_i is",
        "// its last address.  A beat takes two clocks, of a checking pass three.",
        "",
        "// One file for the device:",
        "// verilator lint_off DECLFILENAME",
        Bank(device).text().rstrip("\n"),
        "// verilator lint_on DECLFILENAME",
        "",
        "`default_nettype wire",
    ]
    return "\n".join([*top, *bank]) + "\n"


def head(device: Device) -> list[str]:
    """The comment above the top: what it is, and its points."""
    lines = ["//", f"// {device.name} - {one_line(device.title or device.name)}, a Modbus RTU slave."]
    if device.doc:
        lines += ["//", *wrapped(device.doc)]
    lines += [
        "//",
        "// A point of several registers is read as of one clock and changes its output in one clock.  A write changes nothing",
        "// unless every address exists and may be written and every value is allowed.  After reset and power-up every output",
        "// has its reset value.  Inputs must be synchronous to clk_i.",
    ]
    if Plan(device).areas:
        lines += [
            "//",
            "// host_*: Wishbone B4 classic; the address is {space, item}: space 2 input registers, 3 holding registers, 4 the",
            "// records of all files in a row.  While host_cyc_i is held the line waits: hold it over what belongs together.",
        ]
    return lines


def wrapped(text: str) -> list[str]:
    """A text as comment lines."""
    import textwrap

    return [f"// {line}" for line in textwrap.wrap(one_line(text), 110)]


def module(device: Device) -> list[str]:
    """The top."""
    line, run_time = device.line, device.line.run_time
    parameters = [f"  parameter integer CLK_HZ  = {device.core_parameter('CLK_HZ')}"]
    comments = ["clk_i in hertz"]
    if not run_time:
        parameters += [
            f"  parameter integer ADDRESS = {line.address}",
            f"  parameter integer BAUD    = {line.baud}",
            f"  parameter integer FORMAT  = {line.format_number}",
        ]
        comments += ["1..247", "bits per second", "0 8E1, 1 8O1, 2 8N2, 3 8N1"]
    lines = [f"module {device.name} #("]
    lines += [
        f"{(p + ',' if n + 1 < len(parameters) else p):<41} // {c}" for n, (p, c) in enumerate(zip(parameters, comments))
    ]
    ports = device.port_list()
    lines += [") (", *aligned([(way(p), bits(p.width), p.name, meaning(p)) for p in ports]), ");", ""]
    lines += settings(device)
    lines += ['`include "modbus_bank_wires.vh"', ""]
    lines += core(device, ports)
    lines += [f"  {device.name}_bank u_bank (", "    .clk_i(clk_i), .rst_i(rst_i),"]
    binds = [bind for point in device.points for bind in binds_of(point)]
    binds += [f".{p.name}({p.name})" for p in ports if p.role == "host"]
    lines += packed(binds, ",", "    ")
    lines += ['`include "modbus_bank_inst.vh"', "  );", "", "endmodule"]
    return lines


def way(port_: Port) -> str:
    return "input  wire" if port_.direction == "input" else "output wire"


def meaning(port_: Port) -> str:
    """The comment behind a port."""
    if port_.point is None:
        return port_.meaning
    if port_.role == "strobe":
        return "strobe: the master has written it"
    doc = one_line(port_.point.doc)
    unit = f" in {port_.point.unit}" if port_.point.unit else ""
    return place_of(port_.point) + unit + (f": {doc}" if doc else "")


def binds_of(point) -> list[str]:
    found = []
    if point.kind == "register":
        found.append(f".{port(point, 'o')}({point.name}_o)")
    elif point.kind == "wire":
        found.append(f".{port(point, 'i')}({point.name}_i)")
    if point.strobe:
        found.append(f".{port(point, 'stb_o')}({point.name}_stb_o)")
    return found


def settings(device: Device) -> list[str]:
    """What becomes settings_i."""
    known = core_parameters.parameters()
    if not device.line.run_time:
        values = {
            name: device.core_parameter(name) if name in known else default
            for name, default in core_parameters.of_the_value().items()
        }
        lines = [f"  localparam integer {name} = {value};" for name, value in values.items()]
        return [*lines, "", '`include "modbus_settings_value.vh"', ""]
    values = {"ADDRESS": "address_i", "BIT_TIME": "bit_time_i", "FORMAT": "format_i"}
    lines = ["  wire [`MB_SETTINGS_WIDTH-1:0] SETTINGS;"]
    for macro, name, width in core_parameters.fields():
        off = 0  # what a map cannot set is off
        value = values.get(name) or f"{width}'d{device.core_parameter(name) if name in known else off}"
        lines.append(f"  assign SETTINGS[`{macro}] = {value};")
    return [*lines, ""]


def core_values(device: Device) -> list[tuple[str, str]]:
    """(parameter, value) of the core beside CLK_HZ."""
    found = [("FUNCTION_CODES", f"128'h{device.function_mask:X}")]
    if Plan(device).checks:
        found.append(("CHECK_WRITES", "1"))
    said = {*core_parameters.settings(), "CLK_HZ"} | (set() if device.line.run_time else {"MAX_BIT_TIME"})
    found += [(name, str(value)) for name, value in device.core if name not in said]
    identity = device.identity
    if device.has_function(REPORT_ID) and identity.server_id:
        found += [
            ("SERVER_ID", f"{SERVER_ID_BITS}'h{identity.server_id.hex()}"),
            ("SERVER_ID_BYTES", str(len(identity.server_id))),
        ]
    if device.has_function(REPORT_ID) and identity.additional_data:
        found += [
            ("ADDITIONAL_DATA", f"{ADDITIONAL_BITS}'h{identity.additional_data.hex()}"),
            ("ADDITIONAL_DATA_BYTES", str(len(identity.additional_data))),
        ]
    if device.has_function(DEVICE_ID):
        for name, key in TEXTS.items():
            text = getattr(identity, key)
            if text:
                escaped = text.replace("\\", "\\\\").replace('"', '\\"')
                found.append((name, f'"{escaped}"'))
        if identity.private:
            data = b"".join(bytes([i, len(t)]) + t.encode("latin-1") for i, t in identity.private)
            found.append(("PRIVATE_OBJECTS", f"{PRIVATE_BITS}'h{data.hex()}"))
        found.append(("CONFORMITY", f"8'h{identity.conformity:02X}"))
    return found


def core(device: Device, ports: list[Port]) -> list[str]:
    """The instance of the core."""
    codes = " ".join(f"{code:02X}" for code in device.functions)
    longest = [] if device.line.run_time else [".MAX_BIT_TIME(BIT_TIME)"]
    parameters = [".CLK_HZ(CLK_HZ)", *longest, *(f".{name}({value})" for name, value in core_values(device))]
    alive = "alive_o" if any(p.role == "alive" for p in ports) else ""
    binds = [
        ".clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(SETTINGS),",
        ".host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),",
        ".user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),",
        f".write_stb_o(), .events_o(), .alive_o({alive}), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(),",
    ]
    return [
        f"  // Function codes {codes}",
        "  // User port, status port and events are not used:",
        "  // verilator lint_off PINCONNECTEMPTY",
        "  modbus_rtu_core #(",
        *packed(parameters, "", "    "),
        "  ) u_core (",
        *(f"    {line}" for line in binds),
        '`include "modbus_bank_core_inst.vh"',
        "  );",
        "  // verilator lint_on PINCONNECTEMPTY",
        "",
    ]


def core_files() -> tuple[list[str], list[str]]:
    """(files of rtl/modbus.f that the core needs, include folders), from the folder of the project."""
    files, folders = filelist.read(ROOT, filelist.CORE)
    banks = ("rtl/bank/", "rtl/bus/", "rtl/modbus_rtu_slave")
    return [name for name in files if not name.startswith(banks)], folders


def file_list(device: Device) -> str:
    """NAME.f: the core below $(MODBUS_RTU), and NAME.v beside the list."""
    lines = [f"// Made by modbus map.  MODBUS_RTU is the folder of the core; {device.name}.v is found from where the tool runs."]
    files, folders = core_files()
    lines += [f"+incdir+{CORE_FOLDER}/{name}" for name in folders]
    lines += [f"{CORE_FOLDER}/{name}" for name in files]
    return "\n".join([*lines, f"{device.name}.v"]) + "\n"
