# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What judges a map (checks.py) or INIT (live_values.py): messages with their places, and the bits of a value."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from modbus_map.diagnostics import Diagnostic, nearest
from modbus_map.file_model import shown
from modbus_map.loader import Path_, Source
from modbus_map.model import Point


class Judge:
    """Collects what is wrong with a file in `notes`, each with its place."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.notes: list[Diagnostic] = list(source.problems)

    def error(self, path: Path_, text: str, key: bool = False) -> None:
        self.notes.append(self.source.diagnostic(path, text, key))

    def warn(self, path: Path_, text: str, key: bool = False) -> None:
        self.notes.append(self.source.diagnostic(path, text, key, warning=True))

    def line_of(self, path: Path_) -> int:
        return self.source.place(path)[0]

    def raw(self, value: Any, point: Point, path: Path_, what: str) -> int | None:
        """The bit pattern of a value of the file, or None after an error."""
        if point.enum and isinstance(value, str):
            for item in point.enum:
                if value in (item.label, item.ident):
                    return item.raw
            labels = [item.label for item in point.enum]
            self.error(path, f"{shown(value)} is no name of the enum; {nearest(value, labels)}")
            return None
        if point.is_string:
            text = str(getattr(value, "text", value))
            try:
                data = text.encode("latin-1")
            except UnicodeEncodeError:
                self.error(path, f"{shown(text)!r} has letters that are no single byte; write it in Latin-1 letters")
                return None
            if len(data) > point.characters:
                text = f"{len(data)} characters do not fit into {point.type}; shorten the text, or string<{len(data)}>"
                self.error(path, text)
                return None
            if "\0" in text:
                self.error(path, "a zero byte ends a string; leave it out")
                return None
            return point.raw(text)
        if isinstance(value, str):
            hint = "write one of the numbers" if not point.enum else "write one of its names"
            self.error(path, f"{shown(value)} is no value of {with_article(point.type)}; {hint}")
            return None
        if point.type == "bool" or isinstance(value, bool):
            if point.type != "bool" or value not in (0, 1):
                wanted = "0, 1, false or true" if point.type == "bool" else "a number"
                self.error(path, f"{what} {shown(value)} is no value of {with_article(point.type)}; write {wanted}")
                return None
            return int(value)
        return self.number(value, point, path, what)

    def number(self, value: Any, point: Point, path: Path_, what: str) -> int | None:
        exact = Fraction(int(value)) if isinstance(value, int) else Fraction(getattr(value, "text", repr(value)))
        scale, offset = Fraction(repr(point.scale)), Fraction(repr(point.offset))
        number = (exact - offset) / scale
        if point.is_float:
            try:
                raw = point.raw(float(number))
            except (ValueError, OverflowError):
                self.error(path, f"{what} {shown(value)} is too large for {point.type}; take f64, or a smaller one")
                return None
            return raw
        least, most = point.number_range()
        if not least <= number <= most:
            ends = sorted((least * scale + offset, most * scale + offset))
            span = " to ".join(decimal(end) for end in ends)
            scaled = " with this scale" if point.is_scaled else ""
            self.error(path, f"{what} {shown(value)} is outside the type; {point.type}{scaled} is {span}")
            return None
        if number.denominator != 1:
            if not point.is_scaled:
                near = sorted({number.numerator // number.denominator, -(-number.numerator // number.denominator)})
                choice = " or ".join(map(str, near))
                self.error(
                    path, f"{what} {shown(value)} is no whole number; {point.type} takes {choice}, or write a scale"
                )
                return None
            floor = number.numerator // number.denominator
            near = " or ".join(decimal(n * scale + offset) for n in (floor, floor + 1))
            self.error(path, f"{what} {shown(value)} is no whole step of {point.scale!r}; write {near}")
            return None
        return point.raw(int(number))


def with_article(kind: str) -> str:
    """A type with its article."""
    return "a bits point" if kind == "bits" else f"{'an' if kind[0] in 'fi' else 'a'} {kind}"


def decimal(number: Fraction) -> str:
    """A number as a person writes it."""
    return str(number.numerator) if number.denominator == 1 else f"{float(number):.12g}"
