# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.v, NAME.f and the property file."""

from __future__ import annotations

from modbus_map.model import Device


def generate(device: Device) -> dict[str, str]:
    return {}
