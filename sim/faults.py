# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Faults on the wire as people write them: "answer flip character=3 bit=1 every=10; request gap amount=2".

The bridge carries them out (faults.h). What there is to break stands in fault_kinds.h, which both read: here to judge
faults before anything starts, and for the forms of the panel. Standard library only.
"""

import math
import re
from pathlib import Path
from typing import NamedTuple

from init_file import BadVariable

TABLE = Path(__file__).with_name("fault_kinds.h")
DIRECTIONS = ("request", "answer")


class Key(NamedTuple):
    """A number of a fault: what it is if not given (None: it is left out), its limits, in words what it means."""

    value: float | None
    least: float
    most: float
    meaning: str
    whole: bool


class Kind(NamedTuple):
    """What can be broken."""

    directions: tuple
    keys: dict
    meaning: str


def _number(text):
    return int(text) if re.fullmatch(r"-?\d+", text) else float(text)


def _read(text):
    """The kinds, and the keys that all have, of the table's text."""
    text = re.sub(r"//.*", "", text)
    shared = re.search(r"#define CHARACTER\(value\) (.*)", text)[1]
    text = re.sub(r"\bCHARACTER\((-?\d+)\)", lambda found: shared.replace("value", found[1]), text.replace(shared, ""))
    row = r'(\w+), ([^"]*), (WHOLE|REAL), "([^"]*)"\)'

    def keys(macro, text):
        return {
            name: Key(*([None] * (3 - len(numbers)) + numbers), meaning, whole == "WHOLE")
            for name, given, whole, meaning in re.findall(rf"\b{macro}\({row}", text)
            for numbers in [[_number(one) for one in given.split(", ")]]
        }

    kinds = {
        name: Kind(DIRECTIONS if direction == "BOTH" else DIRECTIONS[1:], keys("KEY", rest), meaning)
        for name, direction, meaning, rest in re.findall(r'^KIND\((\w+), (\w+), "([^"]*)",(.*)\)$', text, re.M)
    }
    return kinds, keys("WHEN", text)


KINDS, WHEN = _read(TABLE.read_text(encoding="ascii"))


def parse(text):
    """The faults of the variable FAULT, each as the bridge takes it. Raises BadVariable."""
    found = [" ".join(part.split()) for part in text.split(";") if part.strip()]
    for fault in found:
        if wrong := judge(fault.split()):
            raise BadVariable(f"FAULT: {wrong}")
    return found


def judge(words):
    """What is wrong with a fault, or an empty text."""
    if len(words) < 2 or words[0] not in DIRECTIONS:
        return f"{' '.join(words)}: must be request or answer, and a kind"
    kind = words[1]
    if kind not in KINDS:
        return f"{kind}: no such kind; there are {', '.join(sorted(KINDS))}"
    keys = KINDS[kind].keys | WHEN
    if words[0] not in KINDS[kind].directions:
        return f"{kind}: not in this direction"
    named = set()
    for word in words[2:]:
        name, _, value = word.partition("=")
        try:
            number = float(value)
        except ValueError:
            return f"{word}: must be key=number"
        if not math.isfinite(number):
            return f"{word}: must be key=number"
        if name not in keys:
            return f"{word}: {kind} has no such key"
        _, least, most, _, whole = keys[name]
        if not least <= number <= most or (whole and number != int(number)):
            return f"{word}: must be a {'whole ' if whole else ''}number from {least:g} to {most:g}"
        named.add(name)
    return "every and probability exclude each other" if {"every", "probability"} <= named else ""
