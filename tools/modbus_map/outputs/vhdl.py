# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.vhd: a package with the component and the map's numbers, and an entity around the component.

The component has the name of the Verilog module, so tools that take both languages bind it by themselves. The entity
is for direct instantiation; it has the same generics and ports.
"""

from __future__ import annotations

from modbus_map.model import Device, Port
from modbus_map.outputs import shared


def _type(width: int) -> str:
    return "std_logic" if width == 1 else f"std_logic_vector({width - 1} downto 0)"


def _ports(device: Device, indent: str) -> list[str]:
    """The port clause. Inputs other than clock, line and wires have a value at rest."""
    ports = device.port_list()
    name = max(len(port.name) for port in ports)
    kind = max(len(_type(port.width)) for port in ports)
    rows = []
    for port in ports:
        direction = "in " if port.direction == "input" else "out"
        default = f" := {_rest(port)}" if port.direction == "input" and port.role in ("clock", "host") else ""
        if port.name == "clk_i":
            default = ""
        text = f"{port.name:<{name}} : {direction} " + (
            f"{_type(port.width):<{kind}}{default}" if default else _type(port.width)
        )
        rows.append(text)
    return (
        [f"{indent}port ("] + [f"{indent}  {row}{';' if row is not rows[-1] else ''}" for row in rows] + [f"{indent});"]
    )


def _rest(port: Port) -> str:
    return "'0'" if port.width == 1 else "(others => '0')"


def _generics(device: Device, indent: str) -> list[str]:
    rows = ["CLK_HZ  : positive := 12000000"]
    if not device.line.run_time:
        rows += [
            f"ADDRESS : natural  := {device.line.address}",
            f"BAUD    : positive := {device.line.baud}",
            f"FORMAT  : natural  := {device.line.format_number}",
        ]
    return [f"{indent}generic ("] + [f"{indent}  {r}{';' if r is not rows[-1] else ''}" for r in rows] + [f"{indent});"]


def _constants(device: Device) -> list[str]:
    """Addresses, fields and named values as natural constants; a value above 31 bits has none."""
    rows = []
    for point in device.points:
        name = point.name.upper()
        rows.append((f"{name}_AT", point.at))
        if point.is_array:
            rows.append((f"{name}_COUNT", point.count))
        for part in point.fields:
            rows += [(f"{name}_{part.name.upper()}_HIGH", part.high), (f"{name}_{part.name.upper()}_LOW", part.low)]
        rows += [(f"{name}_{item.ident}", item.number) for item in point.enum if abs(item.number) < 1 << 31]
    seen: set[str] = set()
    lines = []
    for name, number in rows:
        if name.lower() not in seen:  # VHDL knows no case
            lines.append(f"  constant {name} : integer := {number};")
        seen.add(name.lower())
    return lines


def generate(device: Device) -> dict[str, str]:
    """{NAME.vhd: text}."""
    name = device.name
    generics = ["CLK_HZ"] + ([] if device.line.run_time else ["ADDRESS", "BAUD", "FORMAT"])
    ports = [port.name for port in device.port_list()]
    lines = [
        f"-- {name} - {shared.comment(device.title)}, for a VHDL design.",
        "--",
        f"-- Package {name}_pkg: the component of the Verilog module {name}, and the numbers of the map.",
        f"-- Entity {name}_entity: the same as an entity, for direct instantiation.",
        "--",
        "-- VHDL-93. Made from the map file: change that, not this file.",
        "",
        "library ieee;",
        "use ieee.std_logic_1164.all;",
        "",
        f"package {name}_pkg is",
        "",
        f"  component {name} is",
        *_generics(device, "    "),
        *_ports(device, "    "),
        "  end component;",
        "",
        *_constants(device),
        "",
        f"end package {name}_pkg;",
        "",
        "library ieee;",
        "use ieee.std_logic_1164.all;",
        "",
        f"use work.{name}_pkg.all;",
        "",
        f"entity {name}_entity is",
        *_generics(device, "  "),
        *_ports(device, "  "),
        f"end entity {name}_entity;",
        "",
        f"architecture wrapper of {name}_entity is",
        "begin",
        "",
        f"  u_{name} : {name}",
        "    generic map (" + ", ".join(f"{g} => {g}" for g in generics) + ")",
        "    port map (",
        *(f"      {port} => {port}{',' if port != ports[-1] else ''}" for port in ports),
        "    );",
        "",
        "end architecture wrapper;",
    ]
    return {f"{name}.vhd": "\n".join(lines) + "\n"}
