# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The modules of the core: a device cannot have the name of one."""

from __future__ import annotations

import functools
from pathlib import Path

import filelist

ROOT = Path(__file__).resolve().parents[2]


@functools.cache
def modules() -> frozenset[str]:
    """Names of the modules of rtl/modbus.f, in lower case."""
    return frozenset(Path(name).stem.lower() for name in filelist.read(ROOT, filelist.CORE)[0])
