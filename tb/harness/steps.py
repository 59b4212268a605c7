# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The names of modbus_steps.vh and modbus_defs.vh for tests: what a step means stands there alone."""

import re
from pathlib import Path

from .runner import TREE

HEADERS = ("rtl/engine/modbus_steps.vh", "rtl/include/modbus_defs.vh")
DEFINE = re.compile(r"^`define\s+MB_(\w+)\s+([^/\n]+?)\s*(?://.*)?$", re.M)


def _number(text):
    """A Verilog number as an integer, None for anything else."""
    if match := re.fullmatch(r"(?:\d+)?'([hdb])([0-9A-Fa-f]+)", text):
        return int(match[2], {"h": 16, "d": 10, "b": 2}[match[1]])
    return int(text) if text.isdigit() else None


def _read():
    """({name: number}, {name: (high bit, low bit)})"""
    numbers, ranges = {}, {}
    for header in HEADERS:
        for name, text in DEFINE.findall((Path(TREE) / header).read_text()):
            if match := re.fullmatch(r"(\d+):(\d+)", text):
                ranges[name] = int(match[1]), int(match[2])
            elif (number := _number(text)) is not None:
                numbers[name] = number
    return numbers, ranges


NUMBERS, RANGES = _read()


def field(name, value, head=""):
    """`value` at the place of a field or of a flag, given as "ARG_PLACE" or with head="ARG" as "PLACE"."""
    name = f"{head}_{name}" if head else name
    if name in RANGES:
        high, low = RANGES[name]
        assert 0 <= value < 2 << (high - low), f"{value} does not fit {name}"
        return value << low
    return int(bool(value)) << NUMBERS[name]


def taken(name, word):
    """A field or flag of `word`."""
    high, low = RANGES[name] if name in RANGES else (NUMBERS[name],) * 2
    return word >> low & (2 << (high - low)) - 1


def argument(**fields):
    """The argument of a step: argument(PLACE=3, CLEAR=1)."""
    return sum(field(name, value, "ARG") for name, value in fields.items())


def step(name, **fields):
    """A word of the program: step("POINT", PLACE=3, CLEAR=1)."""
    return NUMBERS[f"STEP_{name}"] << RANGES["WORD_STEP"][1] | argument(**fields)


def do(*names):
    """A vector of commands: do("ADDRESS", "ONE")."""
    return sum(1 << NUMBERS[f"DO_{name}"] for name in names)
