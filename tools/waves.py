#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Runs the tests that T selects with a trace and writes a GTKWave save file beside it.

    waves.py EXPRESSION     a pytest -k expression or a file, as in make test T=...
    waves.py trace.fst      no test: the save file for a trace that is there

The save file shows the line, then every state machine with the names of its states, then the strobes
and the bank.  It is made from what is in the trace and from the RTL's own localparams and program
steps, so it fits whichever module a test has on top and cannot fall behind the code.  Opens GTKWave
where it is installed and a display is there; else prints the line that does.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

from common import ROOT, all_files

NAMES = ROOT / "build/waves"  # translation tables, one a state register
BINARY, HEX, NAMED = "@28", "@22", "@2022"  # GTKWave's display codes; NAMED: hex through a table
# Groups from top to bottom: title, module that a signal must be in (any when empty), its name.  A name
# that is seen at several depths, like a port wired through, is shown once, at the top; states all are.
GROUPS = [
    ("line", "", r"rxd_i|txd_o|de_o"),
    ("characters", "modbus_uart_rx", r"(char|start)_stb_o|data_o|parity_error_o|framing_error_o"),
    ("silence", "modbus_line_timer", r"t15_o|t35_o"),
    ("states", "", r"state_q"),
    ("program", "modbus_sequencer", r"step|at_q"),
    ("frame", "", r"good_stb_o|rx_active_o|frame_stb_o|count_o|cursor_o|send_stb_o|err_(?!i$)\w+_o"),
    ("grant", "", r"grant_(req|space|first|last|write)_o|grant_ack_i|exception_i"),
    ("bus", "", r"wb_(cyc|stb|we|adr|dat)_o|wb_(dat|ack|err)_i"),
    ("events", "", r"write_(stb|space|first|last)_o|alive_o|busy_i"),
]


def fail(message: str) -> None:
    """One line on standard error and exit status 2."""
    print(f"waves: {message}", file=sys.stderr)
    sys.exit(2)


def state_names() -> dict[tuple[str, str], Path]:
    """{(module, signal): table file} for the state registers of the RTL and the program steps."""
    NAMES.mkdir(parents=True, exist_ok=True)
    tables = {}
    for path in [ROOT / name for name in all_files()]:
        states = re.findall(r"\bST_(\w+)\s*=\s*\d+'d(\d+)", path.read_text())
        if states:
            tables[path.stem, "state_q"] = write_table(path.stem, states)
    header = ROOT / "rtl/engine/modbus_steps.vh"
    steps = re.findall(r"^`define\s+MB_STEP_(\w+)\s+\d+'d(\d+)", header.read_text(), re.M) if header.exists() else []
    if steps:
        tables["modbus_sequencer", "step"] = write_table("modbus_steps", steps)
    return tables


def write_table(name: str, pairs: list[tuple[str, str]]) -> Path:
    """A GTKWave translation table: hexadecimal value, blank, label."""
    path = NAMES / f"{name}.txt"
    path.write_text("".join(f"{int(value):X} {label}\n" for label, value in pairs))
    return path


def module_of(scope: str, modules: list[str]) -> str:
    """The module behind an instance path: u_frame_rx is modbus_frame_rx, a top has its own name."""
    last = scope.rsplit(".", 1)[-1]
    for name in (last, "modbus_" + last.removeprefix("u_")):
        if name in modules:
            return name
    return ""


def save_file(trace: Path) -> Path:
    """Write the save file of a trace."""
    import pywellen

    wave = pywellen.Waveform(path=str(trace))
    tables = state_names()
    modules = [Path(name).stem for name in all_files()]
    found = sorted(wave.all_vars(), key=lambda variable: variable.full_name.count("."))
    rows: dict[str, list[str]] = {title: [] for title, _, _ in GROUPS}
    shown = set()
    for variable in found:
        path = variable.full_name
        scope, _, name = path.rpartition(".")
        plain = re.sub(r"\[[\d:]+\]$", "", name)
        module = module_of(scope, modules)
        group = next((t for t, m, p in GROUPS if m in ("", module) and re.fullmatch(p, plain)), None)
        key = (group, path if group == "states" else plain)
        if not group or not module or key in shown:
            continue
        shown.add(key)
        ranged = path if plain != name or variable.is_1bit else f"{path}[{variable.length - 1}:0]"
        if group == "states":
            ranged = f"+{{{module.removeprefix('modbus_')}}} {ranged}"  # GTKWave's alias
        if table := tables.get((module, plain)):
            rows[group] += [NAMED, f"^1 {table}", ranged]
        else:
            rows[group] += [BINARY if variable.is_1bit else HEX, ranged]
    lines = [f'[dumpfile] "{trace}"', "[timestart] 0", "[size] 1600 900", "[sst_width] 200", "[signals_width] 300"]
    for title, signals in rows.items():
        if signals:
            lines += ["@200", f"-{title}", *signals]
    save = trace.with_suffix(".gtkw")
    save.write_text("\n".join(lines) + "\n")
    return save


def run_tests(selection: str) -> tuple[int, list[Path]]:
    """Run pytest with traces; its exit status and the traces that are new, newest first."""
    began = time.time() - 1
    arguments = [selection] if "/" in selection or ".py" in selection else ["tb", f"-k{selection}"]
    environment = {**os.environ, "WAVES": "1"}
    status = subprocess.run([sys.executable, "-m", "pytest", *arguments], cwd=ROOT, env=environment).returncode
    fresh = [p for p in (ROOT / "build").rglob("*.fst") if p.stat().st_mtime >= began]
    return status, sorted(fresh, key=lambda p: -p.stat().st_mtime)


def main() -> int:
    """Trace, save file, viewer."""
    selection = sys.argv[1] if len(sys.argv) > 1 else ""
    if not selection:
        fail("name the tests: make waves T=expression (as for make test)")
    status = 0
    if selection.endswith(".fst"):
        traces = [Path(selection).resolve()]
        if not traces[0].is_file():
            fail(f"no trace {selection}")
    else:
        status, traces = run_tests(selection)
    if not traces:
        fail(f"the tests that {selection!r} selects left no trace")
    for trace in traces:
        save = save_file(trace)
        print(f"trace     {trace.relative_to(ROOT) if trace.is_relative_to(ROOT) else trace}")
        print(f"open with gtkwave {save.relative_to(ROOT) if save.is_relative_to(ROOT) else save}")
    if shutil.which("gtkwave") and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        viewer = ["gtkwave", str(traces[0].with_suffix(".gtkw"))]
        subprocess.Popen(viewer, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
