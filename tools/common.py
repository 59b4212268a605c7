# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the tools of this folder share: where things are, the one file list of the RTL, how a program is run."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import filelist

ROOT = Path(__file__).resolve().parents[1]
DROP_INS = {"ram": "slave_bench", "io": "io_bench"}  # core and bank with every setting a port: what is measured
BENCHES = "tb/harness"  # they are there


def rtl_files() -> list[str]:
    """The Verilog files of the core, relative to the root, in the order of rtl/modbus.f."""
    return filelist.read(ROOT, filelist.CORE)[0]


def all_files() -> list[str]:
    """The Verilog files of the core and of the examples, relative to the root."""
    return filelist.read(ROOT, *filelist.ALL)[0]


def bench_files() -> list[str]:
    """The benches around the core, relative to the root."""
    return sorted(str(path.relative_to(ROOT)) for path in (ROOT / BENCHES).glob("*.v"))


def include_options() -> list[str]:
    """The include folders as options that Verilator, Icarus and Yosys take alike."""
    return [f"-I{folder}" for folder in filelist.read(ROOT, filelist.CORE)[1]]


def include_files() -> list[str]:
    """The include files (.vh), relative to the root."""
    folders = filelist.read(ROOT, filelist.CORE)[1]
    return sorted(str(path.relative_to(ROOT)) for folder in folders for path in (ROOT / folder).glob("*.vh"))


def source_of(module: str) -> str:
    """The file that holds `module`, relative to the root: a file holds one module of its own name."""
    for name in all_files():
        if Path(name).stem == module:
            return name
    raise SystemExit(f"no module {module} in {' or '.join(filelist.ALL)}")


def files_below(top: str) -> list[str]:
    """The files of a module and of all that it instantiates, relative to the root."""
    files = [ROOT / name for name in all_files()]
    return [str(path.relative_to(ROOT)) for path in filelist.reached(Path(source_of(top)).stem, files)]


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
