# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Faults on the wire as people write them: "answer flip character=3 bit=1 every=10; request gap amount=2".

The bridge carries them out (faults.h). This copy of its table serves to judge them before anything starts, and forms
of the control server; tb/live compares the two. Standard library only.
"""

import math

from init_file import BadVariable

DIRECTIONS = ("request", "answer")
CHARACTER = (0, -256, 255, True)  # default, least, most, whole
# Kind: (directions, {key: (default, least, most, whole)})
KINDS = {
    "flip": (DIRECTIONS, {"character": CHARACTER, "bit": (0, 0, 7, True)}),
    "parity": (DIRECTIONS, {"character": CHARACTER}),
    "stop": (DIRECTIONS, {"character": CHARACTER}),
    "break": (DIRECTIONS, {"character": CHARACTER, "bits": (12, 1, 1000, False)}),
    "glitch": (DIRECTIONS, {"character": CHARACTER, "width": (0.3, 0.07, 0.49, False)}),
    "jitter": (DIRECTIONS, {"amount": (0.2, 0, 0.45, False)}),
    "rate": (DIRECTIONS, {"amount": (3, -20, 20, False)}),
    "gap": (DIRECTIONS, {"character": (1, -256, 255, True), "amount": (2, 0, 1000, False)}),
    "cut": (DIRECTIONS, {"character": (4, -256, 255, True)}),
    "extra": (DIRECTIONS, {"value": (0, 0, 255, True)}),
    "swapped_crc": (DIRECTIONS, {}),
    "wrong_crc": (DIRECTIONS, {}),
    "late": (("answer",), {"amount": (100, 0, 60000, False)}),
    "none": (DIRECTIONS, {}),
    "echo": (DIRECTIONS, {}),
    "collision": (DIRECTIONS, {"character": CHARACTER, "value": (85, 0, 255, True)}),
}
WHEN = {"every": (None, 1, 1e9, True), "count": (None, 1, 1e9, True), "probability": (None, 0, 1, False)}


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
    directions, keys = KINDS[kind]
    if words[0] not in directions:
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
        if name not in keys and name not in WHEN:
            return f"{word}: {kind} has no such key"
        _, least, most, whole = keys.get(name) or WHEN[name]
        if not least <= number <= most or (whole and number != int(number)) or (name == "probability" and not number):
            return f"{word}: must be a {'whole ' if whole else ''}number from {least:g} to {most:g}"
        named.add(name)
    return "every and probability exclude each other" if {"every", "probability"} <= named else ""
