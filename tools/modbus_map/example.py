# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What `modbus map init` writes: a map that is right, with a comment on every key."""

from __future__ import annotations

from pathlib import Path

FILE = Path(__file__).with_name("example.yaml")


def text() -> str:
    """The example."""
    return FILE.read_text(encoding="utf-8")
