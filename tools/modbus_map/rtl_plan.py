# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a generated bank is made of: items, rows of the grant, keys, memory. No Verilog text here.

*Item*: one value of a point, `width` registers or one bit. *Word*: a register of an item, 0 at its first address. *Row*: a
run of addresses that may be read, or written, without a break. *Key*: a few address bits in which all items of a
table differ; the address was granted, so they tell the item.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from modbus_map.model import ITEMS, SPACES, Device, Point

FILES_SPACE = 4
MASK_WRITE = 22
READ_BACK_FROM = 4  # registers that are read back: as many as this cost less from a RAM than by a multiplexer
COMPARED_ENUM = 2  # runs of an enum that are compared as limits; one with more gaps is a list


@dataclass(frozen=True)
class Item:
    """Item `index` of a point."""

    point: Point
    index: int

    @property
    def at(self) -> int:
        return self.point.at + self.index * self.point.width

    @property
    def addresses(self) -> range:
        return range(self.at, self.at + self.point.width)

    def word_bits(self, word: int) -> tuple[int, int]:
        """(high, low): the bits of the whole point that its word `word` is."""
        point = self.point
        place = word if point.word_order == "little" else point.width - 1 - word
        low = self.index * point.bits + 16 * place
        return low + 15, low


@dataclass(frozen=True)
class Row:
    """Addresses `low` to `high` of a space may be accessed in one request; `file`: of that file alone."""

    low: int
    high: int
    file: int = 0


@dataclass(frozen=True)
class Area:
    """Addresses `at` to `last` of a space are words `place` and up of the memory."""

    space: int
    at: int
    last: int
    place: int
    name: str
    resets: tuple[int, ...]
    file: int = 0
    host_at: int = 0  # the first address on the host port


def runs(addresses: Iterable[int]) -> list[tuple[int, int]]:
    """The runs of consecutive numbers, as (first, last)."""
    found: list[list[int]] = []
    for address in sorted(addresses):
        if found and address == found[-1][1] + 1:
            found[-1][1] = address
        else:
            found.append([address, address])
    return [(a, b) for a, b in found]


def key_bits(addresses: Iterable[int]) -> list[int]:
    """The numbers of a few address bits, ascending, in which all addresses differ; at least one."""
    groups, chosen = [sorted(set(addresses))], []
    while any(len(group) > 1 for group in groups):
        best, best_groups = -1, groups
        for bit in range(16):
            if bit in chosen:
                continue
            split = [
                part for g in groups for part in ([a for a in g if not a >> bit & 1], [a for a in g if a >> bit & 1])
            ]
            split = [part for part in split if part]
            if len(split) > len(best_groups) or (best < 0 and len(split) > len(groups)):
                best, best_groups = bit, split
        chosen.append(best)
        groups = best_groups
    return sorted(chosen) or [0]


class Plan:
    """A device, taken apart for the bank."""

    def __init__(self, device: Device) -> None:
        self.device = device

    # ---------------------------------------------------------------- items

    def items(self, space: int, memory: bool = False) -> list[Item]:
        """The items of a space by address: those in flip-flops, wires and constants, or those in memory."""
        points = [p for p in self.device.points if SPACES[p.table] == space and (p.kind == "memory") == memory]
        return [Item(point, index) for point in sorted(points, key=lambda p: p.at) for index in range(point.count)]

    @cached_property
    def keys(self) -> dict[int, list[int]]:
        """{space: address bits} of the spaces that have items outside the memory."""
        return {
            space: key_bits(a for item in self.items(space) for a in item.addresses)
            for space in range(4)
            if self.items(space)
        }

    def key(self, space: int, address: int) -> int:
        """The key of an address: its chosen bits, the lowest first."""
        return sum((address >> bit & 1) << place for place, bit in enumerate(self.keys[space]))

    def key_width(self, space: int) -> int:
        return len(self.keys[space])

    def has(self, space: int) -> bool:
        return space in self.keys

    def has_free_addresses(self, space: int) -> bool:
        """True if addresses where nothing is are granted too (`gaps: zero`)."""
        return any(SPACES[table] == space for table in self.device.zero_gaps)

    def covered(self, space: int) -> list[tuple[int, int]]:
        """The addresses of a space that are items outside the memory, as runs."""
        return runs(a for item in self.items(space) for a in item.addresses)

    @property
    def writes_coils(self) -> bool:
        return any(item.point.writable for item in self.items(0))

    @property
    def writes_words(self) -> bool:
        """True if a holding register outside the memory may be written."""
        return any(item.point.writable for item in self.items(3))

    @property
    def writes_memory(self) -> bool:
        return any(p.kind == "memory" and p.writable for p in self.device.points) or any(
            f.access == "rw" for f in self.device.files
        )

    # ---------------------------------------------------------------- the widest values

    @staticmethod
    def is_live(item: Item) -> bool:
        """True if the value may change while it is read."""
        return item.point.kind == "wire" and not item.point.freeze

    def is_whole(self, item: Item) -> bool:
        """True if the item is loaded in one piece: because it is live, or because its limits are for the whole value."""
        point = item.point
        return point.width > 1 and (self.is_live(item) or (point.writable and point.is_limited))

    @cached_property
    def held_words(self) -> int:
        """Words of the longest item that is loaded in one piece; 1 without any."""
        words = [item.point.width for space in (2, 3) for item in self.items(space) if self.is_whole(item)]
        return max(words, default=1)

    @cached_property
    def staged_words(self) -> int:
        """Words of the longest item that is written in one piece; 1 without any."""
        words = [i.point.width for i in self.items(3) if i.point.writable and i.point.kind == "register"]
        return max(words, default=1)

    @cached_property
    def limited(self) -> list[Point]:
        """The points whose values are checked."""
        return [p for p in self.device.points if p.writable and p.is_limited and not p.is_bit]

    @property
    def checks(self) -> bool:
        return bool(self.limited)

    @cached_property
    def checked_words(self) -> int:
        return max((p.width for p in self.limited), default=1)

    def read_back(self, item: Item) -> bool:
        """True if the bank gives this value to the core: it is readable, or a mask write reads it first."""
        point = item.point
        return point.readable or (point.writable and MASK_WRITE in self.device.functions) or self.is_whole(item)

    def may_be_in_ram(self, item: Item) -> bool:
        """True if a RAM can give its words: the master alone changes them, and they are read one at a time."""
        point = item.point
        return SPACES[point.table] == 3 and point.kind == "register" and point.writable and not self.is_whole(item)

    @cached_property
    def reads_back(self) -> bool:
        """True if registers that the master writes are read back from a RAM."""
        items = [item for item in self.items(3) if self.may_be_in_ram(item) and self.read_back(item)]
        return sum(item.point.width for item in items) >= READ_BACK_FROM

    def in_ram(self, item: Item) -> bool:
        """True if the words of the item are read back from the RAM."""
        return self.reads_back and self.may_be_in_ram(item) and self.read_back(item)

    # ---------------------------------------------------------------- grant

    def rows(self, space: int, write: bool) -> list[Row]:
        """What a request may cover, in ascending order."""
        if space == FILES_SPACE:
            files = [f for f in self.device.files if f.access == "rw" or not write]
            return [Row(0, f.records - 1, f.number) for f in files]
        points = [p for p in self.device.points if SPACES[p.table] == space]
        good = {
            a for p in points for a in range(p.at, p.last + 1) if (p.writable if write else p.readable)
        }
        if self.has_free_addresses(space) and not (write and space in (1, 2)):
            good |= set(range(ITEMS)) - {a for p in points for a in range(p.at, p.last + 1)}
        return [Row(low, high) for low, high in runs(good)] if not (write and space in (1, 2)) else []

    @cached_property
    def questions(self) -> dict[tuple[bool, int], list[Row]]:
        """{(write, space): rows} of the questions that can have a yes."""
        spaces = [0, 1, 2, 3, *([FILES_SPACE] if self.device.files else [])]
        found = {(write, space): self.rows(space, write) for write in (False, True) for space in spaces}
        return {question: rows for question, rows in found.items() if rows}

    @cached_property
    def table_of_rows(self) -> list[tuple[Row, bool, int]]:
        """(row, more: another row follows for the same question, space), each list of rows once."""
        table: list[tuple[Row, bool, int]] = []
        for (_, space), rows in sorted(self.questions.items()):
            block = [(row, n + 1 < len(rows), space) for n, row in enumerate(rows)]
            if not any(table[n : n + len(block)] == block for n in range(len(table))):
                table += block
        return table

    def first_row(self, write: bool, space: int) -> int:
        """The place of a question's first row in the table."""
        rows = self.questions[write, space]
        block = [(row, n + 1 < len(rows), space) for n, row in enumerate(rows)]
        return next(n for n in range(len(self.table_of_rows)) if self.table_of_rows[n : n + len(block)] == block)

    # ---------------------------------------------------------------- freeze

    def frozen(self, coil: str) -> list[Point]:
        return [p for p in self.device.points if p.freeze == coil]

    # ---------------------------------------------------------------- memory

    @cached_property
    def areas(self) -> list[Area]:
        """What is in the memory, in its order: the points of the tables, then the files."""
        found, place = [], 0
        for point in self.device.points:
            if point.kind == "memory":
                words = tuple(w for raw in point.resets for w in point.registers(raw))
                space = SPACES[point.table]
                found.append(Area(space, point.at, point.last, place, point.name, words, host_at=point.at))
                place += point.size
        host = 0
        for file in self.device.files:
            found.append(Area(FILES_SPACE, 0, file.records - 1, place, file.name, (), file.number, host))
            place, host = place + file.records, host + file.records
        return found

    @property
    def memory_words(self) -> int:
        return sum(area.last - area.at + 1 for area in self.areas)

    def points_in(self, kind: str) -> Iterator[Point]:
        yield from (p for p in self.device.points if p.kind == kind)
