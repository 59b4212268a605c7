# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the tools of this folder share: where things are, and the one file list of the RTL."""

from __future__ import annotations

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
