#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the bank of a map costs on an iCE40, beside modbus_bank_io: prints the table of docs/map_rtl.md.

    map_cost.py             prints it
    map_cost.py --update    puts it there

Yosys counts LUTs and flip-flops of the bank alone. What one more point costs is the difference between eight and four
of them.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "map_rtl.md"
MARKS = "<!-- cost table begin -->", "<!-- cost table end -->"
IO = ["rtl/bank/modbus_bank_io.v", "rtl/bank/modbus_bank_guard.v"]
SHAPE = (  # that of modbus_bank_io by default
    "coils: [{at: 0, name: c, count: 16}]\n"
    "discrete_inputs: [{at: 0, name: d, count: 16}]\n"
    "input_registers: [{at: 0, name: i, count: 8}]\n"
    "holding_registers: [{at: 0, name: h, count: 8}]\n"
)
MORE = {  # point: (table, keys)
    "`u32` that the master writes and reads": ("holding_registers", "type: u32"),
    "two `u16` that the master writes and reads": ("holding_registers", "count: 2"),
    "`u32` that the master only writes": ("holding_registers", "type: u32, access: wo"),
    "`u32` that the master only reads": ("input_registers", "type: u32"),
}


def synthesised(top: str, files: list[str]) -> tuple[int, int]:
    """(LUTs, flip-flops) of a module."""
    with tempfile.NamedTemporaryFile(suffix=".json") as found:
        script = (
            f"read_verilog -Irtl/include {' '.join(files)}; synth_ice40 -top {top}; tee -q -o {found.name} stat -json"
        )
        subprocess.run([sys.executable, "tools/yosys.py", "-q", "-p", script], cwd=ROOT, check=True)
        text = Path(found.name).read_text(encoding="utf-8")
    cells = json.loads(text)["design"]["num_cells_by_type"]
    return cells.get("SB_LUT4", 0), sum(count for name, count in cells.items() if "DFF" in name)


def bank(text: str) -> tuple[int, int]:
    """The same of the bank that the compiler makes of a map."""
    from modbus_map.checks import compile_source
    from modbus_map.loader import parse
    from modbus_map.rtl_bank import Bank

    device, _ = compile_source(parse("device: cost\n" + text, "cost.yaml"))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cost.v"
        path.write_text('`default_nettype none\n`include "modbus_defs.vh"\n' + Bank(device).text(), encoding="utf-8")
        return synthesised("cost_bank", [str(path)])


def one_more(table: str, what: str) -> tuple[float, float]:
    """(LUTs, flip-flops) that a point adds."""
    few, many = (
        bank(f"{table}:\n" + "".join(f"  - {{at: {2 * n}, name: p{n}, {what}}}\n" for n in range(count)))
        for count in (4, 8)
    )
    return (many[0] - few[0]) / 4, (many[1] - few[1]) / 4


def table() -> str:
    rows = [("`modbus_bank_io`, 16 coils, 16 discrete inputs, 8 + 8 registers", *synthesised("modbus_bank_io", IO))]
    rows.append(("the same as a map", *bank(SHAPE)))
    rows += [(f"one more {name}", *one_more(*where)) for name, where in MORE.items()]
    lines = ["| iCE40 | LUT4 | Flip-flops |", "|---|---:|---:|"]
    return "\n".join([*lines, *(f"| {name} | {luts:.3g} | {ffs:.3g} |" for name, luts, ffs in rows)])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true", help="write docs/map_rtl.md")
    options = parser.parse_args()
    made = table()
    print(made)
    if options.update:
        page = PAGE.read_text(encoding="utf-8")
        page = re.sub(f"{MARKS[0]}.*?{MARKS[1]}", f"{MARKS[0]}\n{made}\n{MARKS[1]}", page, flags=re.S)
        PAGE.write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tools"))
    sys.exit(main())
