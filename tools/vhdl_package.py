#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Makes rtl/vhdl/modbus_pkg.vhd of the Verilog: constants and functions of modbus_defs.vh, components of the modules.

Without an option it is printed; --check exits 1 if the file says otherwise; --update writes it.
"""

from __future__ import annotations

import argparse
import re
import sys

from interface import DERIVED, fields, header, macros, number, parameter_types

from common import ROOT

PACKAGE = ROOT / "rtl/vhdl/modbus_pkg.vhd"
COMPONENTS = ("modbus_rtu_slave_io", "modbus_rtu_slave", "modbus_rtu_core", "modbus_bank_ram", "modbus_bank_io",
              "modbus_auto_line", "modbus_line_health")
# Inputs that must be connected; every other one has its value at rest, 0 unless it stands in AT_REST.
CONNECTED = re.compile(r"clk_i|rxd_i|settings_i|grant_\w+|wb_(?!err)\w+|exception_i")
AT_REST = {"host_state_i": "MB_HOST_AT_REST", "user_reply_i": "MB_NO_USER"}
# Vectors with fields: (kind of the macros, macro of the width, port, comment of the function or nothing)
VECTORS = {
    "settings": ("SET", "MB_SETTINGS_WIDTH", "settings_i"),
    "host_state": ("HOST", "MB_HOST_STATE_WIDTH", "host_state_i"),
    "events": ("EVENT", "MB_EVENTS_WIDTH", "events_o"),
    "user_reply": ("USER", "MB_USER_REPLY_WIDTH", "user_reply_i"),
}
NEEDED = ("ADDRESS", "BIT_TIME", "PUT", "DONE", "DATA")  # fields without a default
ONE = ("BROADCAST", "DE_LEAD", "RUN")  # fields that are 1 unless told otherwise; all others are 0

HEAD = """\
-- SPDX-License-Identifier: Apache-2.0
-- Copyright (c) 2026 the project contributors
--
-- modbus_pkg - the core for a VHDL design: components of the tops and banks, names and functions for their vectors.
--
-- VHDL-93.  The components have the names of the Verilog modules, so tools that take both languages bind them by
-- themselves.  An input that need not be connected has a default: a user of modbus_rtu_slave_io connects clock, line
-- and data.  Names that begin with MB_ are those of rtl/include/modbus_defs.vh.
--
-- Made by tools/vhdl_package.py --update: change the Verilog, not this file.

library ieee;
use ieee.std_logic_1164.all;

package modbus_pkg is
"""
TEXT = """\
  -- The characters of `text`, right-justified in `bytes` bytes: for ADDITIONAL_DATA, SERVER_ID, PRIVATE_OBJECTS
  function mb_text (text : string; bytes : positive) return std_logic_vector"""
BIT_TIME = """\
  -- The bit time of a rate, rounded to whole clocks
  function mb_bit_time (clk_hz : positive; baud : positive) return std_logic_vector"""
BIT = """\
  -- The set of one function code; join sets by `or`
  function mb_bit (code : natural) return mb_codes"""
BODIES = {
    BIT: """\
    variable codes : mb_codes := (others => '0');
  begin
    codes(code) := '1';
    return codes;
""",
    BIT_TIME: """\
  begin
    return std_logic_vector(to_unsigned((clk_hz + baud / 2) / baud, 16));
""",
    TEXT: """\
    variable made  : std_logic_vector(8 * bytes - 1 downto 0) := (others => '0');
    variable place : natural;
  begin
    for k in text'range loop
      place := 8 * (text'right - k);
      made(place + 7 downto place) := std_logic_vector(to_unsigned(character'pos(text(k)), 8));
    end loop;
    return made;
""",
}


def bits(value: int, width: int) -> str:
    """A literal of `width` bits."""
    return f'x"{value:0{width // 4}X}"' if width % 4 == 0 else f'"{value:0{width}b}"'


def vector(width: int) -> str:
    """The type of `width` bits."""
    return "std_logic" if width == 1 else f"std_logic_vector({width - 1} downto 0)"


def rows(table: list[tuple[str, ...]], indent: int, end: str = ";") -> list[str]:
    """`name : type := default` lines in columns, separated by semicolons; the last ends with `end`."""
    name, kind = (max(len(row[k]) for row in table) for k in (0, 1))
    lines = [
        f"{' ' * indent}{row[0]:<{name}} : " + (f"{row[1]:<{kind}} := {row[2]}" if len(row) > 2 and row[2] else row[1])
        for row in table
    ]
    return [line + (";" if line is not lines[-1] else end) for line in lines]


def constants() -> list[str]:
    """The constants of modbus_defs.vh that a user can need."""
    every = macros()
    codes = [name for name in every if name.startswith("MB_FC_")]
    sets = [name for name in every if name.endswith("_FUNCTIONS")]
    spaces = [name for name in every if name.startswith("MB_SPACE_") and name not in INSIDE]
    groups = [
        ("Function codes", [(f"constant {n}", "natural", f"16#{number(n):02X}#") for n in codes]),
        ("Sets of them: bit n is function code n", [(f"constant {n}", "mb_codes", bits(number(n), 128)) for n in sets]),
        ("Exception codes", _sized("MB_EX_", 4)),
        ("Spaces", [(f"constant {n}", vector(3), bits(number(n), 3)) for n in spaces]),
        ("Formats", _sized("MB_FORMAT_", 2)),
    ]
    lines = ["", "  subtype mb_codes is std_logic_vector(127 downto 0);"]
    for title, table in groups:
        lines += ["", f"  -- {title}", *rows(table, 2)]
    return lines


INSIDE = ("MB_SPACE_COUNTERS", "MB_SPACE_EVENTS", "MB_SPACE_TEXTS")  # spaces that are not on a bus


def _sized(prefix: str, width: int) -> list[tuple[str, str, str]]:
    return [(f"constant {n}", vector(width), bits(number(n), width)) for n in macros() if n.startswith(prefix)]


def function_of(name: str) -> str:
    """The declaration, without its end, of the function that makes the vector `name` of its fields."""
    table = []
    for field, (high, low) in fields(VECTORS[name][0]).items():
        width = high - low + 1
        one = f"'{int(field in ONE)}'" if width == 1 else bits(int(field in ONE), width)
        table.append((field.lower(), vector(width), "" if field in NEEDED else one))
    return f"  function mb_{name} (\n" + "\n".join(rows(table, 4, "")) + f"\n  ) return mb_{name}_vector"


def vectors() -> list[str]:
    """Types, constants and functions of the vectors with fields."""
    lines = []
    for name, (kind, width, port) in VECTORS.items():
        lines += ["", f"  -- {port}", f"  constant {width} : natural := {number(width)};"]
        lines += [f"  subtype mb_{name}_vector is std_logic_vector({width} - 1 downto 0);"]
        if port == "events_o":
            lines += rows([(f"constant MB_EVENT_{f}", "natural", str(low)) for f, (_, low) in fields(kind).items()], 2)
            continue
        if rest := AT_REST.get(port):
            lines += [f"  constant {rest} : mb_{name}_vector := {bits(number(rest), number(width))};"]
        lines += [*function_of(name).split("\n")]
        lines[-1] += ";"
    return lines


def generic(top: str, name: str, default: str) -> tuple[str, str, str]:
    """(name, type, default) of a parameter."""
    value, span = number(default), parameter_types(top)[name]
    if isinstance(value, str):
        return name, "string", value
    if span == "integer":
        return name, "natural", str(value)
    width = number(span.partition(":")[0]) + 1
    if width > 128 and value == 0:
        return name, vector(width), "(others => '0')"
    set_of = default == macros()["MB_ALL_FUNCTIONS"] and "MB_ALL_FUNCTIONS"
    return name, "mb_codes" if name.endswith("_CODES") else vector(width), set_of or bits(value, width)


def port(name: str, direction: str, width: str) -> tuple[str, str, str]:
    """(name, direction and type, default) of a port."""
    if derived := re.fullmatch(r"(\w+)_WIDTH-1:0", width):
        count = f"{derived[1]}_COUNT"
        items = f"{count} + boolean'pos({count} = 0)"  # a table of size 0 has a port of one item
        kind = f"std_logic_vector({items if derived[1] in ('COIL', 'DISCRETE') else f'16 * ({items})'} - 1 downto 0)"
        rest = "(others => '0')"
    else:
        size = number(width.partition(":")[0]) + 1 if width != "1" else 1
        named = {f"{p}": f"mb_{n}_vector" for n, (_, _, p) in VECTORS.items()}
        kind, rest = named.get(name, vector(size)), AT_REST.get(name, "(others => '0')" if size > 1 else "'0'")
    needs = direction == "output" or CONNECTED.fullmatch(name)
    return name, ("out " if direction == "output" else "in  ") + kind, "" if needs else rest


def component(top: str) -> list[str]:
    """The component of a module."""
    parameters, ports = header(top)
    generics = [generic(top, n, d) for n, d in parameters.items() if not DERIVED.fullmatch(n)]
    lines = ["", f"  component {top} is", "    generic (", *rows(generics, 6, ""), "    );", "    port ("]
    table = [port(name, *what) for name, what in ports.items()]
    wide = max(len(row[0]) for row in table)
    for row in table:
        end = "" if row is table[-1] else ";"
        line = f"      {row[0]:<{wide}} : {row[1]}" + (f" := {row[2]}" if row[2] else "")
        if len(line) > 119:
            line = line.replace(" := ", "\n        := ")
        lines += (line + end).split("\n")
    return [*lines, "    );", f"  end component {top};"]


def package() -> str:
    """The whole file."""
    lines = [*HEAD.rstrip("\n").split("\n"), *constants(), *vectors(), ""]
    for declaration in BODIES:
        lines += [declaration + ";", ""]
    lines.pop()
    for top in COMPONENTS:
        lines += component(top)
    lines += ["", "end package modbus_pkg;", "", "library ieee;", "use ieee.numeric_std.all;", ""]
    lines += ["package body modbus_pkg is"]
    for name, (kind, _, at) in VECTORS.items():
        if at != "events_o":
            joined = " & ".join(field.lower() for field in reversed(fields(kind)))
            joined = joined if len(joined) < 100 else joined.replace(" & format", "\n      & format")
            lines += ["", function_of(name) + " is", "  begin", f"    return {joined};", "  end function;"]
    for declaration, body in BODIES.items():
        lines += ["", declaration.split("\n")[1] + " is", body.rstrip("\n"), "  end function;"]
    return "\n".join([*lines, "", "end package body modbus_pkg;"]) + "\n"


def stale() -> bool:
    """True if the file holds something else."""
    return PACKAGE.read_text(encoding="utf-8") != package()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--update", action="store_true")
    wanted = parser.parse_args()
    if wanted.update:
        PACKAGE.write_text(package(), encoding="utf-8")
    elif wanted.check:
        if stale():
            print(f"{PACKAGE.name} is stale; run tools/vhdl_package.py --update", file=sys.stderr)
            return 1
    else:
        print(package(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
