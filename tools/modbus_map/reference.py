# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The reference tables of docs/map.md, made from the models of the map file: `modbus map reference FILE`."""

from __future__ import annotations

import re
from typing import Any

from modbus_map import core_parameters, schema
from modbus_map.file_model import FUNCTIONS

SECTIONS = {  # marker in the document -> model
    "device": "DeviceFile",
    "identity": "IdentityFile",
    "line": "LineFile",
    "coils": "Coil",
    "discrete_inputs": "DiscreteInput",
    "input_registers": "InputRegister",
    "holding_registers": "HoldingRegister",
    "files": "FileFile",
    "fifos": "FifoFile",
}
_MARK = re.compile(r"(<!-- map table (\w+) begin -->\n).*?(<!-- map table \2 end -->)", re.S)


def updated(document: str) -> str:
    """The document with its tables made anew."""
    return _MARK.sub(lambda found: found[1] + table(found[2]) + found[3], document)


def table(section: str) -> str:
    """A table of Markdown, with a line end."""
    if section == "functions":
        rows = [f"| {code} | {code:02X} | {name} |" for code, name in FUNCTIONS.items()]
        return "\n".join(["| Code | Hexadecimal | Function |", "|---:|---:|---|", *rows]) + "\n"
    if section == "core":
        known = core_parameters.parameters().values()
        rows = [f"| `{p.name}` | {p.default} | {p.least} .. {p.most} | {_cell(p.meaning)} |" for p in known]
        return "\n".join(["| Parameter | Default | Range | Meaning |", "|---|---|---|---|", *rows]) + "\n"
    whole = schema.schema()
    made = whole if section == "device" else whole["$defs"][SECTIONS[section]]
    needed = made.get("required", [])
    rows = []
    for key, item in made["properties"].items():
        must = "yes" if key in needed else ""
        rows.append(f"| `{key}` | {must} | {_cell(_kind(item))} | {_cell(item.get('description', ''))} |")
    return "\n".join(["| Key | Needed | Value | Meaning |", "|---|---|---|---|", *rows]) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def _kind(item: Any) -> str:
    """A value in words."""
    if "enum" in item:
        return ", ".join(f"`{value}`" for value in item["enum"] if value != 80)
    if "const" in item:
        return f"`{item['const']}`"
    if "anyOf" in item:
        return " or ".join(dict.fromkeys(_kind(option) for option in item["anyOf"]))
    if "$ref" in item:
        return "mapping"
    kind = item.get("type")
    if isinstance(kind, list):
        return "text" if "minimum" not in item else "number"
    if kind in ("integer", "number") and "minimum" in item:
        return f"{item['minimum']} .. {item['maximum']}"
    words = {"string": "text", "integer": "whole number", "number": "number", "boolean": "`true`, `false`"}
    if kind == "string" and item.get("pattern", "").startswith("^[A-Za-z]"):
        return "name"
    return words.get(str(kind), {"array": "list", "object": "mapping"}.get(str(kind), "value"))
