# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The file lists of the project: rtl/modbus.f is the core, examples/examples.f what is built around it.

A list holds paths from the project's root, a line each, and `+incdir+FOLDER` for include folders.
"""

from __future__ import annotations

from pathlib import Path

CORE = "rtl/modbus.f"
EXAMPLES = "examples/examples.f"
ALL = (CORE, EXAMPLES)


def read(root: Path, *lists: str) -> tuple[list[str], list[str]]:
    """(Verilog files, include folders) that `lists` name, as paths from `root`; SystemExit without a list."""
    files: list[str] = []
    folders: list[str] = []
    for name in lists:
        if not (root / name).exists():
            raise SystemExit(f"{name}, a list of Verilog files, is missing")
        for line in (root / name).read_text(encoding="utf-8").splitlines():
            line = line.split("//")[0].strip()
            if line.startswith("+incdir+"):
                folders.append(line.removeprefix("+incdir+"))
            elif line:
                files.append(line)
    return files, folders
