# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the panel's forms offer, from the tables that judge what they send: faults on the wire and signals."""

from __future__ import annotations

import json

import faults

from . import values


def script() -> str:
    """The tables as JavaScript: FORMS, with faults, when and signals."""
    tables = {"faults": faults.KINDS, "when": faults.WHEN, "signals": values.KINDS}
    return f"const FORMS = {json.dumps(tables)};\n"
