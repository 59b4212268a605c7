# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a deliberate mistake is."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mistake:
    """`old` in `file`, which is somewhere in rtl/, examples/ or tools/modbus_map/, becomes `new`."""

    name: str
    file: str
    old: str
    new: str
