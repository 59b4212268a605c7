# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""test_NAME.py: the cocotb bench."""

from __future__ import annotations

from modbus_map.model import Device


def generate(device: Device) -> dict[str, str]:
    return {}
