# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The printed examples of tb/vectors.json, chosen and turned into model terms."""

import json
from pathlib import Path

from .defs import ALL_FUNCTIONS, Space

PATH = Path(__file__).resolve().parents[1] / "vectors.json"

SPACE_OF_TABLE = {
    "coils": Space.COILS,
    "discrete_inputs": Space.DISCRETES,
    "input_registers": Space.INPUTS,
    "holding_registers": Space.HOLDINGS,
}
LIMIT_OF_CONFIG = {"max_read_regs": "read_registers", "max_write_regs": "write_registers"}


def document():
    """The whole file."""
    return json.loads(PATH.read_text(encoding="utf-8"))


def contents(entries):
    """[((space, address), value), ...] of a list of pre- or postconditions."""
    out = []
    for entry in entries:
        space = SPACE_OF_TABLE[entry["table"]]
        for i, value in enumerate(entry["values"]):
            out.append(((space, entry["address"] + i), value))
    return out


def frame(text):
    """Bytes of a hex field; None for silence."""
    return None if text is None else bytes.fromhex(text)


def limits(vector):
    """The limits that a vector needs built differently, {field of Limits: value}."""
    return {LIMIT_OF_CONFIG[k]: v for k, v in vector["config"].items() if k in LIMIT_OF_CONFIG}


def playable(functions=ALL_FUNCTIONS):
    """RTU vectors of the implemented functions, those about bad frames included.

    A vector that needs something only another function code has is left out.
    """
    out = []
    for vector in document()["vectors"]:
        if vector["mode"] != "rtu" or not vector["playable"]:
            continue
        if any(key not in LIMIT_OF_CONFIG for key in vector["config"]):
            continue
        request = frame(vector["request"])
        unsupported = (vector.get("expected_response_pdu") or "")[3:5] == "01"
        exception = request[1] not in functions and unsupported
        if request[1] in functions or exception or not vector["request_check_ok"]:
            out.append(vector)
    return out
