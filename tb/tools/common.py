# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the tools of this folder share: where things are, the one file list of the RTL, how a program is run."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DROP_INS = {"ram": "modbus_rtu_slave", "io": "modbus_rtu_slave_io"}


def rtl_files() -> list[str]:
    """The Verilog files, relative to the root, in the order of rtl/modbus.f."""
    listing = ROOT / "rtl/modbus.f"
    if not listing.exists():
        raise SystemExit("rtl/modbus.f, the list of the RTL files, is missing")
    lines = [line.split("//")[0].strip() for line in listing.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("+")]


def rtl_modules() -> list[str]:
    """The modules of the file list: a file holds one module of its own name."""
    return [Path(name).stem for name in rtl_files()]


class ToolError(RuntimeError):
    """A tool failed; the message holds what it said of it."""


def tool(name: str) -> str:
    """Path of an installed program: beside this interpreter first, then on PATH; ToolError without it."""
    beside = Path(sys.executable).parent / name
    path = str(beside) if beside.exists() else shutil.which(name)
    if path is None:
        raise ToolError(f"{name} is not installed; the make target installs what it needs")
    return path


def run(command: list[str], log: Path, limit_s: int = 900) -> str:
    """Run a program from the root, its output in `log`; returns that.  ToolError when it fails or takes too long."""
    program = tool(command[0])
    with open(ROOT / log, "w") as handle:
        try:
            done = subprocess.run(
                [program, *command[1:]], cwd=ROOT, stdout=handle, stderr=subprocess.STDOUT, timeout=limit_s
            )
        except subprocess.TimeoutExpired as error:
            raise ToolError(f"{log}: not finished after {limit_s} s") from error
    text = (ROOT / log).read_text(errors="replace")
    if done.returncode:
        lines = text.splitlines()
        said = [line for line in lines if "ERROR" in line] or lines[-15:]
        raise ToolError(f"{log} ends in failure:\n" + "\n".join(said))
    return text
