# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The gates that Yosys makes of the RTL for an iCE40, as Verilog with the ports of the top.

Parameters are frozen by the synthesis, no input is tied. Flip-flops and block RAM begin as in the device.
"""

import hashlib
import importlib.util
import json
import subprocess
import sys
from pathlib import Path

from .build import for_simulator

YOSYS = Path(__file__).resolve().parents[2] / "tools" / "yosys.py"
LIMIT_SECONDS = 600
# Icarus does not take ports with default values, which the cell models have otherwise.
DEFINES = {"NO_ICE40_DEFAULT_ASSIGNMENTS": 1}


class SynthesisError(RuntimeError):
    """Yosys is missing or has failed."""


def cells():
    """The simulation models of the iCE40's cells, which come with Yosys."""
    spec = importlib.util.find_spec("pyosys")
    if not spec:
        raise SynthesisError("Yosys (pyosys) is not installed; make test installs it")
    return Path(spec.submodule_search_locations[0]) / "share" / "ice40" / "cells_sim.v"


def folder(top, parameters, files, folders, products):
    """Where the netlist of `top` belongs, below `products`; another one if anything has changed.

    `files` and `folders` are the RTL's Verilog files and include folders.
    """
    digest = hashlib.sha1(json.dumps([top, parameters], sort_keys=True).encode())
    for path in (*files, *sorted(p for f in folders for p in f.glob("*.vh")), cells()):
        digest.update(path.read_bytes())
    return products / f"netlist_{top}_{digest.hexdigest()[:12]}"


def netlist(place, top, parameters, files, folders):
    """Path of the netlist in `place`, made by Yosys unless it is there. Raises SynthesisError."""
    made, part, log = place / "netlist.v", place / "netlist.part.v", place / "yosys.log"
    if made.exists():
        return made
    sets = [f"-set {name} {value}" for name, value in for_simulator("verilator", parameters).items()]
    commands = [
        " ".join(["read_verilog", *(f"-I{f}" for f in folders), *map(str, files)]),
        *([f"chparam {' '.join(sets)} {top}"] if sets else []),
        f"synth_ice40 -top {top}",
        f"rename -top {top}",
        f"write_verilog -noattr {part}",
    ]
    script = place / "netlist.ys"
    script.write_text("\n".join(commands) + "\n", encoding="utf-8")
    with log.open("w", encoding="utf-8") as said:
        done = subprocess.run(
            [sys.executable, str(YOSYS), "-s", str(script)],
            stdout=said,
            stderr=subprocess.STDOUT,
            timeout=LIMIT_SECONDS,
            check=False,
        )
    if done.returncode or not part.exists():
        raise SynthesisError(f"Yosys failed; see {log}")
    part.rename(made)
    return made
