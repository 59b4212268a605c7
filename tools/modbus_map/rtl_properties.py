# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
from modbus_map.model import Device
def properties(device: Device) -> str:
    return ""
