# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A device as the outputs see it: every default resolved, every value a raw integer.

A *raw* value is the bit pattern of one item, an unsigned integer of `Point.bits` bits: a negative number in two's
complement, a float as its IEEE 754 pattern, a string with its first character highest, filled up with zeros behind.
A *number* is what the pattern stands for in the point's type, a *value* is number x scale + offset.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from modbus_map import core_parameters

Table = Literal["coils", "discrete_inputs", "input_registers", "holding_registers"]
TABLES: tuple[Table, ...] = ("coils", "discrete_inputs", "input_registers", "holding_registers")
SPACES = {"coils": 0, "discrete_inputs": 1, "input_registers": 2, "holding_registers": 3}  # MB_SPACE_*
FIRST_NUMBER = {"coils": 1, "discrete_inputs": 10001, "input_registers": 30001, "holding_registers": 40001}
READ_FUNCTION = {"coils": 1, "discrete_inputs": 2, "holding_registers": 3, "input_registers": 4}
FORMATS = ("8E1", "8O1", "8N2", "8N1")  # their numbers are MB_FORMAT_*
WIDTHS = {"u16": 1, "i16": 1, "bits": 1, "u32": 2, "i32": 2, "f32": 2, "u64": 4, "i64": 4, "f64": 4}
ITEMS = 65536  # of a table
MEMORY_ABOVE = 64  # registers of a point: above it is in block RAM, if the map says nothing else


def is_bit_table(table: str) -> bool:
    """True for the two tables of bits."""
    return table in ("coils", "discrete_inputs")


@dataclass(frozen=True)
class EnumItem:
    """A named value. `raw` is the bit pattern, `number` what it stands for."""

    raw: int
    number: int
    label: str  # as in the map: any text
    ident: str  # of it an identifier in capitals, unique within the point: OVER_VOLTAGE


@dataclass(frozen=True)
class BitField:
    """A named field of a register: bits `high` to `low` of the raw value."""

    name: str
    high: int
    low: int

    @property
    def width(self) -> int:
        return self.high - self.low + 1

    @property
    def mask(self) -> int:
        """The field's ones, in place."""
        return ((1 << self.width) - 1) << self.low


@dataclass(frozen=True)
class Point:
    """A point: `count` items of one type, one behind the other from address `at`.

    `scale` and `offset` are what the map says; 1 and 0 without. `minimum`, `maximum` are raw values or None. What a
    master may write is `accepts`: minimum to maximum where one of them is given, else the values of `enum`, else all.
    """

    table: Table
    at: int
    name: str
    type: str  # bool u16 i16 u32 i32 u64 i64 f32 f64 string<N> bits
    width: int  # addresses an item takes: registers, or 1 in a bit table
    count: int = 1
    is_array: bool = False  # the map names a count: an array even if that is 1
    access: Literal["rw", "ro", "wo"] = "ro"
    kind: Literal["register", "wire", "memory", "constant"] = "wire"
    resets: tuple[int, ...] = (0,)  # raw, one an item
    minimum: int | None = None
    maximum: int | None = None
    enum: tuple[EnumItem, ...] = ()
    fields: tuple[BitField, ...] = ()
    unit: str = ""
    scale: float = 1.0
    offset: float = 0.0
    word_order: Literal["big", "little"] = "big"
    doc: str = ""
    strobe: bool = False
    freeze: str = ""  # name of the coil
    fifo: bool = False  # register `at` is the count, the others are the entries (function code 18H)

    # ---------------------------------------------------------------- shape

    @property
    def is_bit(self) -> bool:
        return is_bit_table(self.table)

    @property
    def bits(self) -> int:
        """Bits of an item: 1 in a bit table, else 16 a register."""
        return 1 if self.is_bit else 16 * self.width

    @property
    def is_signed(self) -> bool:
        return self.type in ("i16", "i32", "i64")

    @property
    def is_float(self) -> bool:
        return self.type in ("f32", "f64")

    @property
    def is_string(self) -> bool:
        return self.type.startswith("string")

    @property
    def characters(self) -> int:
        """N of string<N>; 0 for other types."""
        return int(self.type[6:].strip("<>")) if self.is_string else 0

    @property
    def is_scaled(self) -> bool:
        return self.scale != 1.0 or self.offset != 0.0

    @property
    def readable(self) -> bool:
        return self.access != "wo"

    @property
    def writable(self) -> bool:
        return self.access != "ro"

    @property
    def size(self) -> int:
        """Addresses of the whole point."""
        return self.width * self.count

    @property
    def last(self) -> int:
        """Its last address."""
        return self.at + self.size - 1

    def addresses(self, item: int = 0) -> range:
        """The addresses of an item. Raises IndexError."""
        if not 0 <= item < self.count:
            raise IndexError(f"{self.name} has items 0 to {self.count - 1}, not {item}")
        first = self.at + item * self.width
        return range(first, first + self.width)

    def number_of_register(self, item: int = 0) -> int:
        """The five- or six-digit number of vendor manuals: 40001 is holding register 0, 400001 above 9998."""
        first = FIRST_NUMBER[self.table]
        if max(p for p in self.addresses(item)) <= 9998:
            return first + self.addresses(item)[0]
        digit = first // 10000
        return digit * 100000 + 1 + self.addresses(item)[0]

    @property
    def reset(self) -> int:
        """The raw reset value of item 0."""
        return self.resets[0]

    # ---------------------------------------------------------------- values

    def registers(self, raw: int) -> list[int]:
        """The registers (bits) of an item in the order of their addresses."""
        if self.is_bit:
            return [raw & 1]
        words = [raw >> shift & 0xFFFF for shift in range(16 * (self.width - 1), -1, -16)]
        return words if self.word_order == "big" else words[::-1]

    def join(self, registers: Sequence[int]) -> int:
        """The raw value of an item whose registers (bits) are those; the reverse of `registers`."""
        if len(registers) != self.width:
            raise ValueError(f"{self.name} takes {self.width} registers, not {len(registers)}")
        raw = 0
        for word in registers if self.word_order == "big" else reversed(registers):
            raw = raw << 16 | (word & 0xFFFF)
        return raw

    def number(self, raw: int) -> int | float | str:
        """What the bit pattern stands for: an integer, a float, or the text without the zeros behind it."""
        if self.is_string:
            return raw.to_bytes(2 * self.width, "big").rstrip(b"\0").decode("latin-1")
        if self.is_float:
            return _unpack(self.type, raw)
        if self.is_signed and raw >> (self.bits - 1):
            return raw - (1 << self.bits)
        return raw

    def raw(self, number: int | float | str) -> int:
        """The bit pattern of a number. Raises ValueError if the type does not have it."""
        if self.is_string:
            data = str(number).encode("latin-1")
            if len(data) > self.characters:
                raise ValueError(f"{len(data)} characters do not fit into {self.characters}")
            return int.from_bytes(data.ljust(2 * self.width, b"\0"), "big")
        if self.is_float:
            return _pack(self.type, float(number))
        least, most = self.number_range()
        if int(number) != number or not least <= number <= most:
            raise ValueError(f"{number} is not a whole number from {least} to {most}")
        return int(number) & ((1 << self.bits) - 1)

    def number_range(self) -> tuple[int, int]:
        """Least and greatest number of an integer type."""
        if self.is_signed:
            return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1
        return 0, (1 << self.bits) - 1

    def value(self, raw: int) -> int | float | str:
        """What a user sees: number x scale + offset. Integers stay integers where scale and offset are whole."""
        number = self.number(raw)
        if isinstance(number, str) or not self.is_scaled:
            return number
        if isinstance(number, float):
            return number * self.scale + self.offset
        exact = number * exact_of(self.scale) + exact_of(self.offset)
        return int(exact) if exact.denominator == 1 and self.whole_steps else float(exact)

    @property
    def whole_steps(self) -> bool:
        """True if every value of the point is a whole number."""
        return not self.is_float and float(self.scale).is_integer() and float(self.offset).is_integer()

    def accepts(self, raw: int) -> bool:
        """May the master write this value? (Exception 03 if not.)"""
        if self.minimum is not None or self.maximum is not None:
            number = self.number(raw)
            if self.is_float and math.isnan(number):  # type: ignore[arg-type]
                return False
            low = -math.inf if self.minimum is None else self.number(self.minimum)
            high = math.inf if self.maximum is None else self.number(self.maximum)
            return low <= number <= high  # type: ignore[operator]
        if self.enum and self.enum_is_limit:
            return any(item.raw == raw for item in self.enum)
        return True

    @property
    def enum_is_limit(self) -> bool:
        """True if only the values of `enum` may be written: no minimum, no maximum, some value without a name."""
        return bool(self.enum) and self.minimum is None and self.maximum is None and len(self.enum) < 1 << self.bits

    @property
    def is_limited(self) -> bool:
        """True if some value is refused."""
        return self.minimum is not None or self.maximum is not None or self.enum_is_limit

    def label(self, raw: int) -> str:
        """The name of a value of `enum`, or nothing."""
        return next((item.label for item in self.enum if item.raw == raw), "")


def exact_of(number: float) -> Fraction:
    """The number that was written: 0.1 is one tenth, not its nearest binary float."""
    return Fraction(repr(float(number)))


def _pack(kind: str, number: float) -> int:
    letter = "f" if kind == "f32" else "d"
    try:
        return int.from_bytes(struct.pack(f">{letter}", number), "big")
    except OverflowError:
        raise ValueError(f"{number} is too large for {kind}") from None


def _unpack(kind: str, raw: int) -> float:
    letter, size = ("f", 4) if kind == "f32" else ("d", 8)
    return float(struct.unpack(f">{letter}", raw.to_bytes(size, "big"))[0])


@dataclass(frozen=True)
class Identity:
    """Answers of 2BH and 11H. Texts are printable ASCII; an empty optional one does not exist."""

    vendor: str = ""
    product: str = ""
    revision: str = ""
    url: str = ""
    name: str = ""
    model: str = ""
    application: str = ""
    private: tuple[tuple[int, str], ...] = ()  # (object 80H..FFH, text), ascending
    server_id: bytes = b""  # empty: 11H is not needed
    additional_data: bytes = b""
    conformity: int = 0x81

    @property
    def has_objects(self) -> bool:
        """True if the map names texts, so that 2BH is needed."""
        return bool(self.vendor)

    def objects(self) -> list[tuple[int, str]]:
        """(object id, text) of all that exist."""
        texts = (self.vendor, self.product, self.revision, self.url, self.name, self.model, self.application)
        return [(number, text) for number, text in enumerate(texts) if text or number < 3] + list(self.private)


@dataclass(frozen=True)
class Line:
    """What the line is set to; with `run_time` these are only what documents and clients begin with."""

    address: int = 1
    baud: int = 19200
    format: str = "8E1"
    run_time: bool = False

    @property
    def format_number(self) -> int:
        """MB_FORMAT_*"""
        return FORMATS.index(self.format)

    @property
    def parity(self) -> str:
        """E, O or N."""
        return self.format[1]

    @property
    def stop_bits(self) -> int:
        return int(self.format[2])


@dataclass(frozen=True)
class File:
    """A file of function codes 14H and 15H: records 0 to records - 1, in memory behind the host port."""

    number: int
    name: str
    records: int
    access: Literal["rw", "ro"] = "rw"
    doc: str = ""


@dataclass(frozen=True)
class Port:
    """A port of the generated module."""

    name: str
    direction: Literal["input", "output"]
    width: int
    meaning: str
    point: Point | None = None
    role: str = ""  # value, strobe; line, setting, host, alive, clock
    asynchronous: bool = False


@dataclass(frozen=True)
class Device:
    """A whole device. `points` holds the points of all tables, FIFOs included, in the order of the map's ports."""

    name: str
    title: str
    version: str
    doc: str
    identity: Identity
    line: Line
    word_order: Literal["big", "little"]
    functions: tuple[int, ...]  # function codes that are built in, ascending
    functions_auto: bool
    core: tuple[tuple[str, int], ...]  # other parameters of the core, in the order of the map
    points: tuple[Point, ...]
    files: tuple[File, ...] = ()
    zero_gaps: frozenset[str] = frozenset()  # tables whose free addresses read 0 and ignore writes
    source: str = field(default="", compare=False)  # name of the map file, without its folder

    def table(self, table: str) -> list[Point]:
        """The points of a table, by address."""
        return sorted((point for point in self.points if point.table == table), key=lambda point: point.at)

    def tables(self) -> Iterator[tuple[Table, list[Point]]]:
        """The tables that have points, each with them by address."""
        for table in TABLES:
            if points := self.table(table):
                yield table, points

    def point(self, name: str) -> Point:
        """The point of that name. Raises KeyError."""
        for point in self.points:
            if point.name == name:
                return point
        raise KeyError(name)

    def at(self, table: str, address: int) -> tuple[Point, int, int] | None:
        """(point, item, register within the item) at an address, or None where nothing is."""
        for point in self.points:
            if point.table == table and point.at <= address <= point.last:
                return point, *divmod(address - point.at, point.width)
        return None

    def has_function(self, code: int) -> bool:
        return code in self.functions

    @property
    def function_mask(self) -> int:
        """FUNCTION_CODES of the core: bit n is function code n."""
        return sum(1 << code for code in self.functions)

    def core_parameter(self, name: str) -> int:
        """The value that the map gives a parameter of the core, or the core's own default."""
        return dict(self.core).get(name, core_parameters.parameters()[name].default)

    @property
    def has_memory(self) -> bool:
        """True if there is a host port."""
        return bool(self.files) or any(point.kind == "memory" for point in self.points)

    def freeze_coils(self) -> list[str]:
        """The coils that take snapshots, in the order of the ports."""
        used = {point.freeze for point in self.points if point.freeze}
        return [point.name for point in self.points if point.name in used]

    def port_list(self) -> list[Port]:
        """The ports of the generated module in their order: clock, line, settings, points of the map, host port."""
        ports = [
            Port("clk_i", "input", 1, "the one clock", role="clock"),
            Port("rst_i", "input", 1, "synchronous, active high; 0 if there is no reset", role="clock"),
            Port("rxd_i", "input", 1, "from the receiver, asynchronous, idle 1", role="line", asynchronous=True),
            Port("txd_o", "output", 1, "to the driver, idle 1", role="line"),
            Port("de_o", "output", 1, "driver enable, active high", role="line"),
        ]
        if self.line.run_time:
            ports += [
                Port("address_i", "input", 8, "own address, 1 to 247", role="setting"),
                Port("bit_time_i", "input", 16, "clocks per bit, 8 to 65535", role="setting"),
                Port("format_i", "input", 2, "0 8E1, 1 8O1, 2 8N2, 3 8N1", role="setting"),
            ]
        for point in self.points:
            ports += point_ports(point)
        if self.has_memory:
            ports += HOST_PORTS
        if self.core_parameter("ALIVE_TIMEOUT_MS"):
            ports.append(Port("alive_o", "output", 1, "level: a master talks to us", role="alive"))
        return ports


def point_ports(point: Point) -> list[Port]:
    """The ports of a point: its value, and its strobe."""
    ports = []
    width = point.bits * point.count
    if point.kind == "register":
        ports.append(Port(f"{point.name}_o", "output", width, point.doc, point, "value"))
    elif point.kind == "wire":
        ports.append(Port(f"{point.name}_i", "input", width, point.doc, point, "value"))
    if point.strobe:
        meaning = "strobe: the master has written it" + ("; one bit an item" if point.is_array else "")
        ports.append(Port(f"{point.name}_stb_o", "output", point.count, meaning, point, "strobe"))
    return ports


# The host port in front of all memory: Wishbone B4 classic, as that of modbus_rtu_slave.
HOST_PORTS = [
    Port("host_cyc_i", "input", 1, "hold it over accesses that belong together", role="host"),
    Port("host_stb_i", "input", 1, "hold it until host_ack_o or host_err_o", role="host"),
    Port("host_we_i", "input", 1, "1 write", role="host"),
    Port("host_adr_i", "input", 19, "{space, item}: 2 input registers, 3 holding registers, 4 files", role="host"),
    Port("host_dat_i", "input", 16, "data to write", role="host"),
    Port("host_dat_o", "output", 16, "valid with host_ack_o", role="host"),
    Port("host_ack_o", "output", 1, "done", role="host"),
    Port("host_err_o", "output", 1, "instead of it: no such item", role="host"),
]
