# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The points of a map (NAME.live.json): scale, unit, enum, bit fields, to and from words of the host port."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from .errors import Refused, Unknown

TABLES = {  # of the map: of the live device
    "coils": "coils",
    "discrete_inputs": "discretes",
    "input_registers": "inputs",
    "holding_registers": "holdings",
}
BIT_TABLES = ("coils", "discretes")
FLOATS = {"f32": ">f", "f64": ">d"}
PACKED = ("wire", "register")  # kinds whose words are a vector, lowest word first
DIGITS = 6  # of a scaled number shown to people


@dataclass(frozen=True)
class Point:
    """A point of the map: where it is on the line, where the host port takes it, what its bits stand for."""

    name: str
    table: str
    first: int
    size: int  # addresses
    type: str
    count: int
    access: str
    kind: str
    resets: tuple[Any, ...]
    host: tuple[int, int, int] | None = None  # space, item, words
    unit: str = ""
    doc: str = ""
    scale: float | None = None
    offset: float = 0.0
    enum: dict[int, str] = field(default_factory=dict)
    fields: dict[str, tuple[int, int]] = field(default_factory=dict)  # high, low
    word_order: str = "big"

    @property
    def bits(self) -> int:
        """Bits of an item."""
        return 1 if self.table in BIT_TABLES else 16 * self.size // self.count

    @property
    def settable(self) -> bool:
        """True if the host may write it: an input, or memory."""
        return self.host is not None and self.kind != "register"

    def facts(self) -> dict[str, Any]:
        """For the device's description."""
        return {
            "name": self.name,
            "table": self.table,
            "first": self.first,
            "size": self.size,
            "type": self.type,
            "count": self.count,
            "access": self.access,
            "unit": self.unit,
            "description": self.doc,
            "host": self.settable,
        }

    # ------------------------------------------------------------------ words of the host port

    def words(self, raws: list[int]) -> list[int]:
        """The items' bit patterns as the host port takes them."""
        if self.kind in PACKED:
            vector = sum(raw << self.bits * i for i, raw in enumerate(raws))
            return [vector >> 16 * i & 0xFFFF for i in range(self.host[2])]
        out = []
        for raw in raws:
            width = max(self.bits // 16, 1)
            run = [raw >> 16 * i & 0xFFFF for i in range(width)]
            out += run[::-1] if self.word_order == "big" else run
        return out

    def raws(self, words: list[int]) -> list[int]:
        """The reverse of `words`."""
        if self.kind in PACKED:
            vector = sum(word << 16 * i for i, word in enumerate(words))
            return [vector >> self.bits * i & (1 << self.bits) - 1 for i in range(self.count)]
        width, out = max(self.bits // 16, 1), []
        for at in range(0, self.count * width, width):
            run = words[at : at + width]
            out.append(sum(w << 16 * i for i, w in enumerate(run[::-1] if self.word_order == "big" else run)))
        return out

    def of_line(self, registers: list[int]) -> Any:
        """The value of the registers or bits of the whole point, in the order of their addresses."""
        if self.table in BIT_TABLES:
            found = [self.value(bit) for bit in registers]
        else:
            width = self.size // self.count
            runs = [registers[at : at + width] for at in range(0, self.size, width)]
            order = -1 if self.word_order == "big" else 1
            found = [self.value(sum(w << 16 * i for i, w in enumerate(run[::order]))) for run in runs]
        return found if self.count > 1 else found[0]

    # ------------------------------------------------------------------ values

    def number(self, raw: int) -> Any:
        """What a bit pattern stands for, before scale and names."""
        if self.type.startswith("string"):
            return raw.to_bytes(self.bits // 8, "big").rstrip(b"\0").decode("latin-1")
        if self.type in FLOATS:
            return struct.unpack(FLOATS[self.type], raw.to_bytes(self.bits // 8, "big"))[0]
        return raw - (1 << self.bits) if self.type[0] == "i" and raw >> self.bits - 1 else raw

    def value(self, raw: int) -> Any:
        """An item as people name it: scaled, by name, as named fields."""
        number = self.number(raw)
        if self.enum:
            return self.enum.get(number, number)
        if self.fields:
            return {name: raw >> low & (1 << high - low + 1) - 1 for name, (high, low) in self.fields.items()}
        if self.type == "bool":
            return bool(raw)
        return round(number * self.scale + self.offset, DIGITS) if self.scale is not None else number

    def values(self, words: list[int]) -> Any:
        """The value of a point, a list of an array."""
        found = [self.value(raw) for raw in self.raws(words)]
        return found if self.count > 1 else found[0]

    def text(self, value: Any) -> str:
        """A value for people, with its unit."""
        if isinstance(value, list):
            return ", ".join(self.text(one).removesuffix(f" {self.unit}") for one in value) + f" {self.unit}" * bool(
                self.unit
            )
        if isinstance(value, dict):
            return ", ".join(f"{name} {number}" for name, number in value.items())
        shown = (
            "on"
            if value is True
            else "off"
            if value is False
            else f"{value:.7g}"
            if isinstance(value, float)
            else str(value)
        )
        return f"{shown} {self.unit}" if self.unit else shown

    def raw(self, value: Any) -> int:
        """The bit pattern of a value.  Refused if the type does not have it."""
        if self.enum and isinstance(value, str):
            named = {label: number for number, label in self.enum.items()}
            if value in named:
                return named[value] & (1 << self.bits) - 1
        if self.fields and isinstance(value, dict):
            raw = 0
            for name, number in value.items():
                high, low = self.fields.get(name, (-1, 0))
                if high < 0 or not isinstance(number, int) or not 0 <= number < 1 << high - low + 1:
                    raise Refused(f"{self.name}: {name} = {number!r} is no field with such a number")
                raw |= int(number) << low
            return raw
        if self.type.startswith("string"):
            data = str(value).encode("latin-1", "replace")
            if len(data) > self.bits // 8:
                raise Refused(f"{self.name}: more than {self.bits // 8} characters")
            return int.from_bytes(data.ljust(self.bits // 8, b"\0"), "big")
        return self.raw_number(self.as_number(value))

    def as_number(self, value: Any) -> float | int:
        """A number of what a person or a script gives."""
        if isinstance(value, bool):
            return int(value)
        if isinstance(value, str):
            text = value.strip().lower().removesuffix(self.unit.lower()).strip()
            if text in ("on", "true", "off", "false"):
                return int(text in ("on", "true"))
            try:
                return int(text, 0)
            except ValueError:
                pass
            try:
                return float(text)
            except ValueError:
                names = f", or {', '.join(self.enum.values())}" if self.enum else ""
                raise Refused(f"{self.name}: {value!r} is no {self.type}{names}") from None
        if not isinstance(value, (int, float)):
            raise Refused(f"{self.name}: {value!r} is no {self.type}")
        return value

    def raw_number(self, number: float | int) -> int:
        """The bit pattern of a number in the point's unit."""
        if number != number or number in (float("inf"), float("-inf")):
            if self.type not in FLOATS:
                raise Refused(f"{self.name}: {number} is no {self.type}")
        elif self.scale is not None:
            number = (number - self.offset) / self.scale
        if self.type in FLOATS:
            try:
                return int.from_bytes(struct.pack(FLOATS[self.type], number), "big")
            except OverflowError:
                raise Refused(f"{self.name}: {number} is too large for {self.type}") from None
        whole = round(number)
        least, most = (
            (-(1 << self.bits - 1), (1 << self.bits - 1) - 1) if self.type[0] == "i" else (0, (1 << self.bits) - 1)
        )
        if not least <= whole <= most:
            raise Refused(f"{self.name}: {number:g} does not fit, {self.type} holds {least} to {most}")
        return whole & (1 << self.bits) - 1

    def words_of(self, value: Any) -> list[int]:
        """A value, or the list of an array, as words of the host port.  Refused if it does not fit."""
        if not self.settable:
            why = (
                "begins with its reset value and is written by the master"
                if self.kind == "register"
                else "is a constant"
            )
            raise Refused(f"{self.name} {why}")
        given = value if isinstance(value, list) else [value]
        if self.count > 1 and isinstance(value, str):
            given = [part.strip() for part in value.split(",")]
        if len(given) != self.count:
            raise Refused(f"{self.name}: takes {self.count} values, not {len(given)}")
        return self.words([self.raw(one) for one in given])


def of_map(document: dict[str, Any] | None) -> dict[str, Point]:
    """The points of NAME.live.json by name; none without a map."""
    found = {}
    for table, rows in (document or {}).get("tables", {}).items():
        for row in rows:
            host = row.get("host")
            found[row["name"]] = Point(
                name=row["name"],
                table=TABLES[table],
                first=row["at"],
                size=row["size"],
                type=row["type"],
                count=row["count"],
                access=row["access"],
                kind=row["kind"],
                resets=tuple(row["reset"]),
                host=(host["space"], host["item"], host["words"]) if host else None,
                unit=row.get("unit", ""),
                doc=row.get("doc", ""),
                scale=row.get("scale"),
                offset=row.get("offset", 0.0),
                enum={int(number): label for number, label in row.get("enum", {}).items()},
                fields={name: (high, low) for name, (high, low) in row.get("bits", {}).items()},
                word_order=row.get("word_order", "big"),
            )
    return found


def named(points: dict[str, Point], name: str) -> Point:
    """The point of a name.  Unknown without it."""
    if name not in points:
        known = ", ".join(list(points)[:8]) + (", ..." if len(points) > 8 else "")
        raise Unknown(f"no point {name!r}" + (f"; there are {known}" if points else "; the device has no map"))
    return points[name]
