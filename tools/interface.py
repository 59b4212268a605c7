# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the Verilog shows to the outside, read from the files as a compiler does: parameters, ports, macros.

TREE=folder takes the Verilog from a copy of the checkout, as for the tests.
"""

from __future__ import annotations

import functools
import os
import re
import subprocess
import tempfile
from pathlib import Path

import filelist

from common import ROOT, tool

TREE = Path(os.environ.get("TREE", ROOT))
DEFS = "modbus_defs.vh"
DERIVED = re.compile(r"\w+_WIDTH")  # parameters that nobody sets


def preprocessed(text: str) -> str:
    """What Verilog text is to a compiler: includes and macros expanded, comments gone."""
    folders = filelist.read(TREE, filelist.CORE)[1]
    with tempfile.NamedTemporaryFile("w", suffix=".v") as source:
        source.write(text)
        source.flush()
        command = [tool("iverilog"), "-E", "-g2005", "-o", "/dev/stdout", *(f"-I{TREE / name}" for name in folders)]
        done = subprocess.run([*command, source.name], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stderr)
    return re.sub(r"//.*", "", done.stdout)


@functools.cache
def macros() -> dict[str, str]:
    """{name: text} of the macros of modbus_defs.vh that take no argument, expanded."""
    text = (TREE / "rtl/include" / DEFS).read_text(encoding="utf-8")
    names = re.findall(r"^`define (MB_\w+)(?=\s)", text, re.M)
    asked = "".join(f"@{name}@`{name}@\n" for name in names)
    found = re.findall(r"@(\w+)@([^@]*)@", preprocessed(f'`include "{DEFS}"\n{asked}'))
    assert [name for name, _ in found] == names
    return {name: value.strip() for name, value in found}


def enclosed(text: str) -> tuple[str, str]:
    """(what the first pair of parentheses of `text` encloses, what follows it)."""
    start, depth = text.index("("), 0
    for place in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        if not depth:
            return text[start + 1 : place], text[place + 1 :]
    raise ValueError(f"a parenthesis is not closed: {text[start : start + 40]}")


def items(text: str) -> list[str]:
    """The parts of a list that commas outside of all brackets separate."""
    out, depth = [""], 0
    for char in text:
        depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(char, 0)
        if char == "," and not depth:
            out.append("")
        else:
            out[-1] += char
    return [part.strip() for part in out if part.strip()]


@functools.cache
def _lists(top: str) -> tuple[list[str], list[str]]:
    """(parameter declarations, port declarations) of a module."""
    path = next(TREE / name for name in filelist.read(TREE, *filelist.ALL)[0] if Path(name).stem == top)
    text = preprocessed(path.read_text(encoding="utf-8"))
    head, parameters = text[re.search(rf"\bmodule\s+{top}\b", text).end() :].lstrip(), ""
    if head.startswith("#"):
        parameters, head = enclosed(head)
    return items(parameters), items(enclosed(head)[0])


def parameter_types(top: str) -> dict[str, str]:
    """{parameter: `integer`, a range such as `127:0`, or nothing}."""
    pattern = r"parameter\s+(?:(integer)|\[([^\]]*)\])?\s*(\w+)\s*=.*"
    found = (re.fullmatch(pattern, text, re.S).groups() for text in _lists(top)[0])
    return {name: plain or span or "" for plain, span, name in found}


def header(top: str) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """(parameters {name: default text}, ports {name: (direction, width text)}) of a module, includes expanded."""
    parameters, ports = {}, {}
    for text in _lists(top)[0]:
        name, default = text.split("=", 1)
        parameters[name.split()[-1]] = " ".join(default.split())
    for text in _lists(top)[1]:
        direction, width, port = re.fullmatch(
            r"(input|output)\s+(?:wire|reg)\s*(?:\[([^\]]+)\])?\s*(\w+)", text
        ).groups()
        left, _, right = (width or "").partition(":")
        ports[port] = (direction, f"{number(left)}:{right}" if re.fullmatch(r"[\d\s+-]+", left) else width or "1")
    return parameters, ports


def number(text: str) -> int | str:
    """Value of a constant expression of Verilog, of a macro of modbus_defs.vh by its name, or a text in quotes."""
    text = text.strip().strip("`")
    if text.startswith('"'):
        return text
    text = macros().get(text, text) if text.startswith("MB_") else text
    text = re.sub(
        r"\d*'([hHdD])([0-9a-fA-F_]+)", lambda m: str(int(m[2].replace("_", ""), 16 if m[1] in "hH" else 10)), text
    )
    if not re.fullmatch(r"[\d\s()|&<>+*-]+", text):
        raise ValueError(f"no constant: {text}")
    return eval(text)  # digits and operators alone


def fields(kind: str) -> dict[str, tuple[int, int]]:
    """{field: (high bit, low bit)} of the vector whose fields are macros MB_<kind>_*, from the lowest bit up."""
    found = {}
    for name, text in macros().items():
        if (bits := re.fullmatch(r"(\d+)(?::(\d+))?", text)) and name.startswith(f"MB_{kind}_") and "WIDTH" not in name:
            found[name.removeprefix(f"MB_{kind}_")] = (int(bits[1]), int(bits[2] or bits[1]))
    return dict(sorted(found.items(), key=lambda item: item[1][1]))
