# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""SystemRDL to a map. With the properties of modbus_udp.rdl nothing is lost; without them each register is a holding
register of its width, with its rights, its reset value and its fields."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from systemrdl import RDLCompileError, RDLCompiler
from systemrdl.messages import MessagePrinter
from systemrdl.node import AddrmapNode, FieldNode, Node, RegNode

from modbus_map import checks, loader
from modbus_map.diagnostics import Diagnostic, MapError
from modbus_map.loader import Path_, Source
from modbus_map.model import TABLES, Device

PROPERTIES = Path(__file__).with_name("modbus_udp.rdl")
TABLE_BYTES = 0x20000


class _Printer(MessagePrinter):
    """Collects the compiler's messages as diagnostics."""

    def __init__(self) -> None:
        self.notes: list[Diagnostic] = []

    def print_message(self, severity: Any, text: str, src_ref: Any) -> None:
        file, line, column = _place(src_ref)
        if severity.name in ("ERROR", "FATAL"):
            self.notes.append(Diagnostic(line, column, text, file=file))


def load(path: str | Path, top: str | None = None) -> Device:
    """The device of a SystemRDL file. Raises MapError."""
    device, _ = checks.compile_source(source(path, top))
    return device


def source(path: str | Path, top: str | None = None) -> Source:
    """The map of a SystemRDL file as plain Python. Raises MapError."""
    text = loader.read(path)
    printer = _Printer()
    compiler = RDLCompiler(message_printer=printer)
    try:
        if not re.search(r"^\s*property\s+modbus_device\b", text, re.M):
            compiler.compile_file(str(PROPERTIES))
        compiler.compile_file(str(path))
        root = compiler.elaborate(top_def_name=top)
    except RDLCompileError as error:
        notes = printer.notes or [Diagnostic(1, 1, str(error) or "no SystemRDL", file=str(path))]
        raise MapError(notes) from None
    except ValueError as error:
        raise MapError([Diagnostic(1, 1, f"no SystemRDL: {error}", file=str(path))]) from None
    return source_of(root.top, str(path))


def source_of(top: AddrmapNode, file: str) -> Source:
    """The map of an elaborated address map."""
    made = Source(file, {})
    _mark(made, (), top)
    tree = made.tree
    tree["device"] = top.inst_name
    described = _text(top, "modbus_device")
    if described is not None:
        tree.update(loader.parse(described, file).tree or {})
    else:
        tree["title"] = top.get_property("name")
        if top.get_property("desc"):
            tree["doc"] = top.get_property("desc")
    registers: list[tuple[int, int, str, RegNode, int]] = []
    zero = _collect(top, registers)
    registers.sort(key=lambda row: row[:2])
    for _, _, table, node, place in registers:
        _add(made, table, node, place)
    for table in zero:
        tree.setdefault(table, []).append({"gaps": "zero"})
    return made


def _collect(top: Node, registers: list[Any]) -> list[str]:
    """Append (place among all, address, table, register, item) of each; returns the tables whose gaps read zero."""
    zero = []
    for node in top.descendants(unroll=False):
        if isinstance(node, RegNode):
            table = _inherited(node, "modbus_table") or "holding_registers"
            index = _property(node, "modbus_index")
            address = node.raw_absolute_address
            base = (_table_node(node) or top).raw_absolute_address
            place = (address - base) // 2
            registers.append((address if index is None else index, address, table, node, place))
        elif _property(node, "modbus_gaps") == "zero":
            zero.append(_property(node, "modbus_table"))
    return zero


def _property(node: Any, name: str) -> Any:
    """The value of a property, or None where it is not set or does not exist."""
    try:
        return node.get_property(name, default=None)
    except (LookupError, AttributeError):
        return None


def _table_node(node: Node) -> Node:
    here: Any = node
    while here is not None and not _property(here, "modbus_table"):
        here = here.parent
    return here


def _inherited(node: Node, name: str) -> Any:
    here = node.parent
    while here is not None:
        value = _property(here, name)
        if value is not None:
            return value
        here = here.parent
    return None


def _text(node: Node, name: str) -> str | None:
    value = _property(node, name)
    return None if value is None else unquote(value)


def _add(made: Source, table: str, node: RegNode, place: int) -> None:
    tree = made.tree
    if table not in TABLES:
        raise MapError([Diagnostic(*_place(node.inst.inst_src_ref)[1:], f"{table} is no table", file=made.file)])
    fifo = _property(node, "modbus_fifo")
    items = tree.setdefault("fifos" if fifo else table, [])
    path: Path_ = ("fifos" if fifo else table, len(items))
    point: dict[str, Any] = {"at": place, "name": node.inst_name}
    _mark(made, path, node)
    items.append(point)
    doc = _text(node, "modbus_doc")
    if doc is None and node.get_property("desc"):
        doc = node.get_property("desc")
    if doc:
        point["doc"] = doc
    if fifo:
        point["depth"] = fifo
        return
    bit = table in ("coils", "discrete_inputs")
    kind_of = _text(node, "modbus_type")
    if kind_of is None and not bit:
        kind_of = {16: "u16", 32: "u32", 64: "u64"}.get(
            node.get_property("regwidth"), f"u{node.get_property('regwidth')}"
        )
    if kind_of:
        point["type"] = kind_of
    count = _property(node, "modbus_count")
    if count is None and node.is_array and kind_of is not None and not kind_of.startswith("string"):
        count = _product(node.array_dimensions or [])
    if count is not None:
        point["count"] = count
    for key in ("kind", "access", "unit", "word_order", "freeze"):
        if (text := _text(node, f"modbus_{key}")) is not None:
            point[key] = text
    for key in ("reset", "min", "max", "enum", "scale", "offset"):
        if (text := _text(node, f"modbus_{key}")) is not None:
            point[key] = loader.parse(f"v: {text}", made.file).tree["v"]
    if _property(node, "modbus_strobe"):
        point["strobe"] = True
    fields = list(node.fields())
    plain = len(fields) == 1 and fields[0].inst_name == "value"
    if not plain and not bit:
        point["bits"] = {
            field.inst_name: field.low if field.low == field.high else f"{field.high}..{field.low}" for field in fields
        }
    if _text(node, "modbus_kind") is None and table in ("coils", "holding_registers"):
        _rights(point, fields)


def _rights(point: dict[str, Any], fields: list[FieldNode]) -> None:
    """Rights and reset of a register that has no Modbus properties."""
    reads = any(field.is_sw_readable for field in fields)
    writes = any(field.is_sw_writable for field in fields)
    point["access"] = "rw" if reads and writes else "wo" if writes else "ro"
    reset = 0
    for field in fields:
        value = field.get_property("reset")
        if isinstance(value, int):
            reset |= value << field.low
    if point["access"] != "ro":
        point["reset"] = reset
    elif not any(field.is_hw_writable for field in fields):
        point.update(kind="constant", reset=reset)


def _product(sizes: list[int]) -> int:
    made = 1
    for size in sizes:
        made *= size
    return made


def _mark(made: Source, path: Path_, node: Node) -> None:
    _, line, column = _place(node.inst.inst_src_ref)
    made.values[path] = made.keys[path] = (line, column)


def _place(ref: Any) -> tuple[str, int, int]:
    """File, line and column of a reference of the RDL compiler."""
    try:
        selection = ref.line_selection
        return str(ref.path or ""), int(ref.line), int(selection[0]) + 1
    except (AttributeError, TypeError, OSError):
        return str(getattr(ref, "path", "") or ""), 1, 1
