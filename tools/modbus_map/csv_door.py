# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A map from a spreadsheet: CSV with one row a point, judged by the same checks, with line and column of the cell.

The columns are those of vendors' tables, in any order and case; what a column is called elsewhere is in `COLUMNS`.
Lines `# key: value` above the header give the keys of the device. A column's number in messages counts characters, as
everywhere.
"""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path
from typing import Any

from modbus_map import loader
from modbus_map.diagnostics import Diagnostic, MapError, nearest
from modbus_map.loader import Path_, Source
from modbus_map.model import FIRST_NUMBER, TABLES

COLUMNS = {
    "table": ("table", "space", "register type", "object type", "object"),
    "at": ("at", "address", "addr", "offset address", "register address"),
    "number": ("number", "register", "reference", "register number", "modicon"),
    "name": ("name", "point", "tag", "symbol"),
    "type": ("type", "data type", "datatype", "format"),
    "count": ("count", "quantity", "length", "size"),
    "access": ("access", "r/w", "rw"),
    "kind": ("kind",),
    "reset": ("reset", "default", "default value", "initial value"),
    "min": ("min", "minimum", "low limit"),
    "max": ("max", "maximum", "high limit"),
    "enum": ("enum", "values", "value list"),
    "bits": ("bits", "bit fields"),
    "unit": ("unit", "units"),
    "scale": ("scale", "factor", "multiplier", "resolution", "gain"),
    "offset": ("offset",),
    "word_order": ("word_order", "word order"),
    "strobe": ("strobe",),
    "freeze": ("freeze",),
    "doc": ("doc", "description", "meaning", "comment", "remarks"),
}
TABLE_WORDS = {
    "coils": ("coils", "coil", "0x", "do", "digital output"),
    "discrete_inputs": (
        "discrete_inputs",
        "discrete inputs",
        "discrete input",
        "discrete",
        "1x",
        "di",
        "digital input",
    ),
    "input_registers": ("input_registers", "input registers", "input register", "input", "3x", "ai"),
    "holding_registers": ("holding_registers", "holding registers", "holding register", "holding", "4x", "ao"),
}
TYPE_WORDS = {
    "uint16": "u16", "int16": "i16", "uint32": "u32", "int32": "i32", "uint64": "u64", "int64": "i64", "word": "u16",
    "unsigned": "u16", "signed": "i16", "float": "f32", "float32": "f32", "real": "f32", "double": "f64",
    "float64": "f64", "bit": "bool", "boolean": "bool", "dword": "u32", "udint": "u32", "dint": "i32",
}  # fmt: skip
ACCESS_WORDS = {"r": "ro", "w": "wo", "r/w": "rw", "read": "ro", "read only": "ro", "write": "wo", "read/write": "rw"}


def load(path: str | Path) -> Source:
    """Read a CSV file. Raises MapError for what is no such table; the content is judged by `compile_source`."""
    return parse(loader.read(path), str(path))


def parse(text: str, file: str) -> Source:
    """The same for a text."""
    lines = text.splitlines()
    head = [line if line.startswith("#") else "" for line in lines]
    end = next((number for number, line in enumerate(lines) if line.strip() and not line.startswith("#")), len(lines))
    source = loader.parse("\n".join(line[1:].replace("\t", " ") if line else "" for line in head[:end]), file)
    if source.tree is None:
        source.tree = {}
    if not isinstance(source.tree, dict):
        raise MapError([Diagnostic(1, 1, "lines with # hold keys of the device; write # device: NAME", file=file)])
    _shift_columns(source)
    source.tree.setdefault("device", re.sub(r"\W+", "_", Path(file).stem).strip("_") or "device")
    if end == len(lines):
        raise MapError([Diagnostic(1, 1, "the table has no header; write table,at,name,type,...", file=file)])
    _Rows(source, lines, end).run()
    return source


def _shift_columns(source: Source) -> None:
    """The head was read without its #."""
    for marks in (source.keys, source.values):
        for path, (line, column) in marks.items():
            marks[path] = (line, column + 1)


class _Rows:
    def __init__(self, source: Source, lines: list[str], header: int) -> None:
        self.source = source
        self.text = "\n".join(lines[header:])
        self.header = header
        counts = {mark: lines[header].count(mark) for mark in ",;\t"}
        self.delimiter = max(counts, key=lambda mark: counts[mark])

    def note(self, line: int, column: int, text: str) -> None:
        self.source.problems.append(Diagnostic(line, column, text, file=self.source.file))

    def run(self) -> None:
        reader = csv.reader(io.StringIO(self.text), delimiter=self.delimiter, strict=True)
        columns: list[str] = []
        before = 0
        try:
            for row in reader:
                first, before = self.header + before + 1, reader.line_num
                if not any(cell.strip() for cell in row):
                    continue
                if row[0].lstrip().startswith("#"):
                    continue
                places = self.places(row, first)
                if not columns:
                    columns = self.columns(row, places)
                else:
                    self.row(row, columns, places, first)
        except csv.Error as error:
            self.note(self.header + reader.line_num, 1, f"no CSV: {error}; check the quotes")

    def places(self, row: list[str], line: int) -> list[int]:
        """The column in which each cell begins."""
        text = self.text.splitlines()[line - self.header - 1]
        places, at, quoted = [1], 0, False
        for at, letter in enumerate(text):
            if letter == '"':
                quoted = not quoted
            elif letter == self.delimiter and not quoted:
                places.append(at + 2)
        return (places + [len(text) + 1] * len(row))[: len(row)]

    def columns(self, row: list[str], places: list[int]) -> list[str]:
        known = {word: key for key, words in COLUMNS.items() for word in words}
        made: list[str] = []
        line = self.header + 1
        for cell, column in zip(row, places):
            key = known.get(cell.strip().lower(), "")
            if not key and cell.strip():
                self.note(line, column, f"unknown column {cell.strip()}; {nearest(cell.strip(), COLUMNS)}")
            elif key and key in made:
                self.note(line, column, f"a second column for {key}; leave one out")
            made.append(key)
        if "name" not in made:
            self.note(line, 1, "there is no column name; the header is table,at,name,type,...")
        if "at" not in made and "number" not in made:
            self.note(line, 1, "there is no column at; the header is table,at,name,type,...")
        return made

    def row(self, row: list[str], columns: list[str], places: list[int], line: int) -> None:
        cells = {key: (cell.strip(), at) for key, cell, at in zip(columns, row, places) if key and cell.strip()}
        if len(row) > len(columns):
            self.note(
                line, places[len(columns)], f"{len(row)} cells in a table of {len(columns)} columns; quote the text"
            )
        table = self.table(cells, line)
        if not table:
            return
        items = self.source.tree.setdefault(table, [])
        path: Path_ = (table, len(items))
        point: dict[str, Any] = {}
        self.source.values.setdefault((table,), (line, 1))
        self.source.values[path] = self.source.keys[path] = (line, 1)
        for key, (cell, column) in cells.items():
            if key in ("table", "number"):
                continue
            here = (*path, key)
            self.source.keys[here] = self.source.values[here] = (line, column)
            point[key] = self.cell(key, cell, here)
        items.append(point)

    def table(self, cells: dict[str, tuple[str, int]], line: int) -> str:
        if "number" in cells:
            cell, column = cells["number"]
            digits = re.sub(r"^([0134])[xX](?=\d)", r"\1", cell)
            if re.fullmatch(r"[0134]?\d{4,5}", digits):
                number, long = int(digits), len(digits) == 6
                for table, first in FIRST_NUMBER.items():
                    base = first // 10000 * (100000 if long else 10000)
                    if base < number <= base + (65536 if long else 9999):
                        cells.setdefault("at", (str(number - base - 1), column))
                        cells.setdefault("table", (table, column))
                        break
            elif digits.isdigit():
                cells.setdefault("at", (digits, column))
            else:
                self.note(line, column, f"{cell} is no register number; write one such as 40001, or a column at")
                return ""
        if "table" not in cells:
            self.note(line, 1, f"the row names no table; write one of {', '.join(TABLES)}")
            return ""
        word, column = cells["table"]
        for table, words in TABLE_WORDS.items():
            if word.lower() in words:
                return table
        self.note(
            line, column, f"{word} is no table; {nearest(word, [w for words in TABLE_WORDS.values() for w in words])}"
        )
        return ""

    def cell(self, key: str, cell: str, path: Path_) -> Any:
        if key == "type":
            return TYPE_WORDS.get(cell.lower(), cell)
        if key == "access":
            return ACCESS_WORDS.get(cell.lower(), cell.lower())
        if key in ("enum", "bits"):
            made = {}
            for part in re.split(r"[;,|\n]", cell.strip("{}")):
                if not part.strip():
                    continue
                left, _, right = self.pair(part)
                item = loader.scalar(left)
                made[item] = loader.scalar(right)
                self.source.keys[(*path, item)] = self.source.values[(*path, item)] = self.source.values[path]
            return made
        if key in ("name", "doc", "unit", "freeze"):
            return cell
        if re.fullmatch(r"0[xX][0-9a-fA-F]+|[0-9a-fA-F]+[hH]", cell) and key == "at":
            return int(cell.rstrip("hH"), 16)
        if re.fullmatch(r"-?\d+,\d+", cell) and self.delimiter != ",":
            cell = cell.replace(",", ".")  # a decimal comma
        return loader.scalar(cell)

    @staticmethod
    def pair(part: str) -> tuple[str, str, str]:
        left, mark, right = re.match(r"\s*([^:=]*?)\s*([:=]?)\s*(.*?)\s*$", part, re.S).groups()  # type: ignore[union-attr]
        return left, mark, right
