# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The modules of the core: a device cannot have the name of one."""

from __future__ import annotations

import functools
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@functools.cache
def modules() -> frozenset[str]:
    """Names of the modules of rtl/modbus.f, in lower case."""
    lines = (ROOT / "rtl" / "modbus.f").read_text(encoding="utf-8").splitlines()
    return frozenset(Path(line.strip()).stem.lower() for line in lines if line.strip().endswith(".v"))
