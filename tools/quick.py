#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make quick`: what a change needs before a commit, in under a minute on two cores.

Lints the modules that differ from the upstream branch (without one: from the last commit) with their default
parameters, Python and the house rules; then runs the tests of the model, the tables that must fit the RTL, a little of
everything at the pins, and the unit tests of the modules that differ.  Ends with `N passed, N failed`.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from common import ROOT, all_files

ALWAYS = [
    *(f"tb/test_{name}.py" for name in ("model", "model_functions", "model_diagnostics", "mistakes", "formal")),
    "tb/test_conformance.py",
    "tb/test_system.py::test_system[compiled-smoke]",
    *(f"tb/test_system.py::test_system[icarus-{suite}]" for suite in ("smoke", "power_up", "power_up_io")),
]
MOST_MODULES = 12  # linted; after that the tops alone, which hold all the others
TOPS = ("modbus_rtu_slave", "modbus_rtu_slave_io")


def changed() -> set[str]:
    """Files that differ from the upstream branch or else from the last commit, new ones too."""
    found = _git("merge-base", "HEAD", "@{upstream}") or ["HEAD"]
    return {*_git("diff", "--name-only", found[0]), *_git("ls-files", "--others", "--exclude-standard")}


def _git(*command: str) -> list[str]:
    done = subprocess.run(["git", *command], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.split("\n")[:-1] if done.returncode == 0 else []


def to_lint(files: set[str]) -> list[str]:
    """Modules to lint: those that differ, those that include what differs, or the tops where that is too many."""
    texts = {name: (ROOT / name).read_text(encoding="utf-8") for name in all_files()}
    headers = {Path(name).name for name in files if name.endswith(".vh")}
    modules = [
        Path(name).stem
        for name, text in texts.items()
        if name in files or headers & set(re.findall(r'`include "([^"]+)"', text))
    ]
    return modules if len(modules) <= MOST_MODULES else list(TOPS)


def unit_tests(files: set[str]) -> list[str]:
    """The suites of tb/test_modules.py for modules or tests that differ."""
    sys.path.insert(0, str(ROOT / "tb"))
    import test_modules

    names = {Path(name).stem for name in files if name.endswith((".v", ".py"))}
    suites = test_modules.MODULES.items()
    played = {name: sim for sim, name in reversed(test_modules.RUNS)}
    chosen = [suite for suite, (top, _, module) in suites if {top, module.rsplit(".", 1)[-1]} & names]
    return [f"tb/test_modules.py::test_module[{played[suite]}-{suite}]" for suite in chosen]


def main() -> int:
    files = changed()
    modules = to_lint(files)
    print(f"{len(files)} files differ; modules to lint: {', '.join(modules) or 'none'}", flush=True)
    lint = [sys.executable, "tools/lint.py", "--quick", *modules]
    test = [sys.executable, "-m", "pytest", "-q", "-n2", *ALWAYS, *unit_tests(files)]
    failed = [command[1:3] for command in (lint, test) if subprocess.run(command, cwd=ROOT, check=False).returncode]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
