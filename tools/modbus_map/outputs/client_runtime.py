# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The part of a client that is the same for each device; client.py copies what follows the mark."""

# ---- copied from here
from __future__ import annotations

import struct
from collections.abc import Awaitable, Sequence
from enum import IntEnum
from fractions import Fraction
from typing import Any, Generic, Literal, NamedTuple, TypeVar, overload

from pymodbus.client.base import ModbusBaseClient, ModbusBaseSyncClient

__all__ = ["AsyncDevice", "ModbusError", "Point", "SyncDevice"]
_EXPORTED = (Awaitable, Literal, NamedTuple, overload, IntEnum)  # used by the classes below, if they need them

Number = int | float | Fraction
T = TypeVar("T")
MOST_READS, MOST_WRITES = (125, 2000), (123, 1968)  # registers and bits of a request
_FLOATS = {"f32": (">f", 4), "f64": (">d", 8)}


class ModbusError(Exception):
    """The slave answered with an exception; `code` is its number, 2 is an illegal address, 3 an illegal value."""

    def __init__(self, what: str, code: int) -> None:
        super().__init__(f"{what}: exception {code:02X}H")
        self.code = code


class Point(Generic[T]):
    """A point of the map: where it is, and how its registers become a value."""

    def __init__(
        self,
        table: str,
        at: int,
        name: str,
        type: str,
        width: int,
        count: int,
        access: str,
        *,
        array: bool = False,
        little: bool = False,
        scale: Number = 1,
        offset: Number = 0,
        low: int | float | None = None,
        high: int | float | None = None,
        only: tuple[int, ...] = (),
        names: Any = None,
        fields: tuple[Any, tuple[tuple[int, int], ...]] | None = None,
        whole: bool = False,
        single: bool = True,
        multiple: bool = True,
        reads: int = 0,
        writes: int = 0,
    ) -> None:
        self.table, self.at, self.name, self.type, self.width, self.count = table, at, name, type, width, count
        self.access, self.array, self.little, self.scale, self.offset = access, array, little, scale, offset
        self.low, self.high, self.only, self.names, self.fields, self.whole = low, high, only, names, fields, whole
        self.single, self.multiple = single, multiple
        self.reads, self.writes = reads or MOST_READS[self.is_bit], writes or MOST_WRITES[self.is_bit]

    @property
    def is_bit(self) -> bool:
        return self.table in ("coils", "discrete_inputs")

    @property
    def size(self) -> int:
        """Addresses of the whole point."""
        return self.width * self.count

    def whole_items(self, most: int) -> int:
        """Addresses of the items that fit into a request of `most`."""
        return max(most // self.width, 1) * self.width

    def decode(self, registers: Sequence[int]) -> Any:
        """The value of the whole point, a tuple if it is an array."""
        step = self.width
        items = tuple(self._decode(registers[k : k + step]) for k in range(0, self.size, step))
        return items if self.array else items[0]

    def encode(self, value: Any) -> list[int]:
        """The registers of a value. Raises ValueError if the slave would refuse it."""
        items = list(value) if self.array else [value]
        if len(items) != self.count:
            raise ValueError(f"{self.name} has {self.count} items, not {len(items)}")
        return [word for item in items for word in self._encode(item)]

    def _decode(self, words: Sequence[int]) -> Any:
        if self.is_bit:
            return self.names(int(words[0])) if self.names else bool(words[0])
        data = b"".join(word.to_bytes(2, "big") for word in (words[::-1] if self.little else words))
        if self.type.startswith("string"):
            return data.rstrip(b"\0").decode("latin-1")
        if self.type in _FLOATS:
            number: float = struct.unpack(_FLOATS[self.type][0], data)[0]
            return number if self.scale == 1 and self.offset == 0 else number * float(self.scale) + float(self.offset)
        whole = int.from_bytes(data, "big", signed=self.type.startswith("i"))
        if self.names:
            return self.names(whole) if whole in self.names._value2member_map_ else whole
        if self.fields:
            return self.fields[0](
                *(
                    bool(whole >> low & 1) if width == 1 else whole >> low & (1 << width) - 1
                    for low, width in self.fields[1]
                )
            )
        if self.scale == 1 and self.offset == 0:
            return whole
        exact = Fraction(whole) * Fraction(self.scale) + Fraction(self.offset)
        return int(exact) if self.whole else float(exact)

    def _encode(self, value: Any) -> list[int]:
        if self.is_bit:
            return [int(bool(value))]
        if self.type.startswith("string"):
            text = str(value).encode("latin-1")
            most = int(self.type[6:].strip("<>"))
            if len(text) > most:
                raise ValueError(f"{self.name}: {len(text)} characters do not fit into {most}")
            return self._words(text.ljust(2 * self.width, b"\0"))
        if self.fields and not isinstance(value, int):
            made = 0
            for part, (low, width) in zip(value, self.fields[1]):
                if not 0 <= int(part) < 1 << width:
                    raise ValueError(f"{self.name}: {part} does not fit into {width} bits")
                made |= int(part) << low
            value = made
        number: int | float
        if self.type in _FLOATS:
            plain = self.scale == 1 and self.offset == 0
            number = float(value) if plain else (float(value) - float(self.offset)) / float(self.scale)
            layout, size = _FLOATS[self.type]
            try:
                data = struct.pack(layout, number)
            except OverflowError:
                raise ValueError(f"{self.name}: {value} is too large for {self.type}") from None
            number = struct.unpack(layout, data)[0]
            if number != number and (self.low is not None or self.high is not None):
                raise ValueError(f"{self.name}: not a number")
        else:
            exact = value if isinstance(value, int) else Fraction(repr(float(value)))
            number = round((Fraction(exact) - Fraction(self.offset)) / Fraction(self.scale))
            size = 2 * self.width
            try:
                data = number.to_bytes(size, "big", signed=self.type.startswith("i"))
            except OverflowError:
                raise ValueError(f"{self.name}: {value} does not fit into {self.type}") from None
        if (self.low is not None and number < self.low) or (self.high is not None and number > self.high):
            raise ValueError(f"{self.name}: {value} is out of range")
        if self.only and number not in self.only:
            raise ValueError(f"{self.name}: {value} is none of its values")
        return self._words(data)

    def _words(self, data: bytes) -> list[int]:
        words = [int.from_bytes(data[k : k + 2], "big") for k in range(0, len(data), 2)]
        return words[::-1] if self.little else words


Block = tuple[str, int, int, list[tuple[Point[Any], int, int]]]
_READS = {
    "coils": "read_coils",
    "discrete_inputs": "read_discrete_inputs",
    "input_registers": "read_input_registers",
    "holding_registers": "read_holding_registers",
}


def _chunks(point: Point[Any]) -> list[tuple[int, int]]:
    """(address, quantity) of the requests that a point takes; no item is cut."""
    most = point.whole_items(point.reads)
    return [(point.at + k, min(most, point.size - k)) for k in range(0, point.size, most)]


def _data(answer: Any, bits: bool, quantity: int, what: str) -> list[int]:
    if answer.isError():
        raise ModbusError(what, getattr(answer, "exception_code", 0))
    return [int(bit) for bit in answer.bits[:quantity]] if bits else list(answer.registers)


def _writes(point: Point[Any], words: list[int]) -> list[tuple[str, int, Any]]:
    """(method, address, argument) of the requests that write a point."""
    if point.access == "ro":
        raise AttributeError(f"{point.name} cannot be written")
    kind = "coil" if point.is_bit else "register"
    one = bool if point.is_bit else int
    most = point.whole_items(point.writes)
    if (len(words) == 1 and point.single) or not point.multiple:
        return [(f"write_{kind}", point.at + k, one(word)) for k, word in enumerate(words)]
    return [
        (f"write_{kind}s", point.at + k, [one(word) for word in words[k : k + most]])
        for k in range(0, len(words), most)
    ]


def _items(blocks: list[Block], answers: list[list[int]]) -> dict[str, Any]:
    found: dict[str, list[int]] = {}
    points: dict[str, Point[Any]] = {}
    for (_, at, _, parts), words in zip(blocks, answers):
        for point, item, count in parts:
            first = point.at + item * point.width - at
            found.setdefault(point.name, []).extend(words[first : first + count * point.width])
            points[point.name] = point
    return {name: points[name].decode(words) for name, words in found.items()}


class SyncDevice:
    """A slave behind a blocking client."""

    def __init__(self, client: ModbusBaseSyncClient, device_id: int) -> None:
        self.client, self.device_id = client, device_id

    def connect(self) -> bool:
        """Opens the line; false if it cannot."""
        return bool(self.client.connect())

    def close(self) -> None:
        """Closes the line."""
        self.client.close()  # type: ignore[no-untyped-call]

    def _ask(self, table: str, at: int, quantity: int, what: str) -> list[int]:
        answer = getattr(self.client, _READS[table])(at, count=quantity, device_id=self.device_id)
        return _data(answer, table in ("coils", "discrete_inputs"), quantity, what)

    def _read(self, point: Point[Any]) -> Any:
        words: list[int] = []
        for at, quantity in _chunks(point):
            words += self._ask(point.table, at, quantity, f"read {point.name}")
        return point.decode(words)

    def _read_blocks(self, blocks: list[Block]) -> dict[str, Any]:
        return _items(blocks, [self._ask(table, at, size, f"read {table} {at}") for table, at, size, _ in blocks])

    def _write(self, point: Point[Any], value: Any) -> None:
        for method, at, argument in _writes(point, point.encode(value)):
            answer = getattr(self.client, method)(at, argument, device_id=self.device_id)
            _data(answer, True, 0, f"write {point.name}") if answer.isError() else None

    def _broadcast(self, point: Point[Any], value: Any) -> None:
        for method, at, argument in _writes(point, point.encode(value)):
            getattr(self.client, method)(at, argument, device_id=0, no_response_expected=True)


class AsyncDevice:
    """A slave behind an asynchronous client."""

    def __init__(self, client: ModbusBaseClient, device_id: int) -> None:
        self.client, self.device_id = client, device_id

    async def connect(self) -> bool:
        """Opens the line; false if it cannot."""
        return bool(await self.client.connect())

    def close(self) -> None:
        """Closes the line."""
        self.client.close()

    async def _ask(self, table: str, at: int, quantity: int, what: str) -> list[int]:
        answer = await getattr(self.client, _READS[table])(at, count=quantity, device_id=self.device_id)
        return _data(answer, table in ("coils", "discrete_inputs"), quantity, what)

    async def _read(self, point: Point[Any]) -> Any:
        words: list[int] = []
        for at, quantity in _chunks(point):
            words += await self._ask(point.table, at, quantity, f"read {point.name}")
        return point.decode(words)

    async def _read_blocks(self, blocks: list[Block]) -> dict[str, Any]:
        return _items(blocks, [await self._ask(table, at, size, f"read {table} {at}") for table, at, size, _ in blocks])

    async def _write(self, point: Point[Any], value: Any) -> None:
        for method, at, argument in _writes(point, point.encode(value)):
            answer = await getattr(self.client, method)(at, argument, device_id=self.device_id)
            _data(answer, True, 0, f"write {point.name}") if answer.isError() else None

    async def _broadcast(self, point: Point[Any], value: Any) -> None:
        for method, at, argument in _writes(point, point.encode(value)):
            await getattr(self.client, method)(at, argument, device_id=0, no_response_expected=True)
