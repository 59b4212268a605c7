# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The parameters of the core that a map may set under `core`, read from the RTL's include files."""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import NamedTuple

INCLUDE = Path(__file__).resolve().parents[2] / "rtl" / "include"
SETTINGS, SETTINGS_VALUE = "modbus_settings.vh", "modbus_settings_value.vh"
FILES = (SETTINGS, "modbus_config.vh")
DEFINES = "modbus_defs.vh"
_FIELD = re.compile(r"^`define (MB_SET_(\w+))\s+(\d+)(?::(\d+))?\s", re.M)
_LINE = re.compile(r"^\s*parameter\s+(?:integer|\[[^]]*\])\s+(\w+)\s*=\s*(.*?)\s*,?\s*(?://\s*(.*))?$", re.M)

# What the map says elsewhere: parameter -> key
BY_THE_MAP = {
    "ADDRESS": "line: address",
    "BAUD": "line: baud",
    "FORMAT": "line: format",
    "FUNCTION_CODES": "functions",
    "SERVER_ID": "identity: server_id",
    "SERVER_ID_BYTES": "identity: server_id",
    "ADDITIONAL_DATA": "identity: additional_data",
    "ADDITIONAL_DATA_BYTES": "identity: additional_data",
    "VENDOR_NAME": "identity: vendor",
    "PRODUCT_CODE": "identity: product",
    "REVISION": "identity: revision",
    "VENDOR_URL": "identity: url",
    "PRODUCT_NAME": "identity: name",
    "MODEL_NAME": "identity: model",
    "USER_APPLICATION_NAME": "identity: application",
    "PRIVATE_OBJECTS": "identity: private",
    "CONFORMITY": "identity: conformity",
}
ONE_UNIT = "a device made from a map has one address; instantiate modbus_rtu_core for more"
NO_ASCII = "a device made from a map has RTU mode alone; instantiate modbus_rtu_core for ASCII mode"


def _declared() -> list[tuple[str, str, str, str]]:
    """(file, name, default, comment) of each parameter of the include files."""
    texts = [(file, (INCLUDE / file).read_text(encoding="utf-8")) for file in FILES]
    return [(file, *found) for file, text in texts for found in _LINE.findall(text)]


NOT_HERE = {
    "USER_CODES": "a device made from a map has no user port; instantiate modbus_rtu_core for that",
    **dict.fromkeys(("UNIT_SET", "UNIT_PORT"), ONE_UNIT),
    **{name: NO_ASCII for _, name, _, _ in _declared() if name.startswith("ASCII")},
    "BITS_PER_BEAT": "the bank that is made from a map takes one bit a beat",
}


class Parameter(NamedTuple):
    """A parameter: the include file that has it, its range, and what it does."""

    name: str
    default: int
    least: int
    most: int
    meaning: str
    file: str


@functools.cache
def parameters() -> dict[str, Parameter]:
    """All parameters that `core` takes, by name."""
    found = {}
    for file, name, default, comment in _declared():
        if name in BY_THE_MAP or name in NOT_HERE or not re.fullmatch(r"\d+", default):
            continue
        limits = re.search(r"(\d+)\.\.(\d+)", comment)
        if limits:
            least, most = int(limits[1]), int(limits[2])
        elif comment.startswith("1:"):  # a switch
            least, most = 0, 1
        else:
            least, most = 0, (1 << 24) - 1
        found[name] = Parameter(name, int(default), least, most, comment, file)
    return found


def settings() -> list[str]:
    """Those that a drop-in makes settings_i of; the core has ports for them."""
    return [name for name, parameter in parameters().items() if parameter.file == SETTINGS]


def of_the_value() -> dict[str, int]:
    """{name: default} of what modbus_settings_value.vh needs beside CLK_HZ and what the map says elsewhere."""
    text = (INCLUDE / SETTINGS_VALUE).read_text(encoding="utf-8")
    used = set(re.findall(r"\b[A-Z]\w+", re.sub(r"//.*", "", text))) - {"CLK_HZ", *BY_THE_MAP}
    return {name: int(default) for _, name, default, _ in _declared() if name in used}


def fields() -> list[tuple[str, str, int]]:
    """(macro, parameter, bits) of each field of settings_i. MB_SET_STRICT is that of STRICT_TURNAROUND."""
    found = []
    for macro, field, high, low in _FIELD.findall((INCLUDE / DEFINES).read_text(encoding="utf-8")):
        longer = [name for name in settings() if name.startswith(f"{field}_")]
        found.append((macro, longer[0] if longer else field, int(high) - int(low or high) + 1))
    return found
