# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The keys of a map file: pydantic models that judge one item at a time, and that the JSON Schema is made of.

What concerns two keys or two items is in checks.py. Every message says what is wrong and what would be right.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from modbus_map import core_parameters, names
from modbus_map.diagnostics import nearest
from modbus_map.model import FORMATS, ITEMS

LONGEST_TEXT = 244  # of an identity object
LONGEST_STRING = 250  # characters: what one read fetches
PRIVATE_BYTES = 512
TYPES = ("bool", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64", "bits")
TYPE_PATTERN = r"^(u16|i16|u32|i32|u64|i64|f32|f64|bits|string<[0-9]+>)$"
FUNCTIONS = {
    0x01: "read coils",
    0x02: "read discrete inputs",
    0x03: "read holding registers",
    0x04: "read input registers",
    0x05: "write single coil",
    0x06: "write single register",
    0x07: "read exception status",
    0x08: "diagnostics",
    0x0B: "get comm event counter",
    0x0C: "get comm event log",
    0x0F: "write multiple coils",
    0x10: "write multiple registers",
    0x11: "report server id",
    0x14: "read file record",
    0x15: "write file record",
    0x16: "mask write register",
    0x17: "read/write multiple registers",
    0x18: "read FIFO queue",
    0x2B: "read device identification",
}


def wrong(text: str) -> PydanticCustomError:
    """The error of a validator."""
    return PydanticCustomError("map", "{text}", {"text": text, "items": []})


class Each:
    """Collects what is wrong with the items of a mapping or a list, each with its own place."""

    def __init__(self) -> None:
        self.items: list[tuple[Any, str, bool]] = []  # key or index, text, whether the key is meant

    def check(self, key: Any, what: Callable[[], Any], of_key: bool = False) -> Any:
        """The result of `what`, or None if it raises."""
        try:
            return what()
        except PydanticCustomError as error:
            self.items.append((key, error.message(), of_key))
            return None

    def note(self, key: Any, text: str, of_key: bool = False) -> None:
        """Something is wrong with an item."""
        self.items.append((key, text, of_key))

    def done(self) -> None:
        """Raise what was collected."""
        if self.items:
            raise PydanticCustomError("map", "{text}", {"text": self.items[0][1], "items": self.items})


def shown(value: Any) -> str:
    """A value as a message shows it: as it was written, and short."""
    text = str(getattr(value, "text", value))
    if isinstance(value, bool):
        text = text.lower()
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a mapping" if value else "an empty mapping"
    if isinstance(value, list):
        return "a list"
    return text if len(text) <= 40 else f"{text[:37]}..."


# ------------------------------------------------------------------ kinds of values


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if value is None:
        raise wrong("a text is missing; write one behind the colon")
    if isinstance(value, (dict, list)):
        raise wrong(f"{shown(value)} is no text; write one text, in quotes if it holds `: ` or `{{`")
    return str(getattr(value, "text", value))


def _one_line(value: Any) -> str:
    text = _text(value)
    if "\n" in text.strip() or any(ord(letter) < 32 for letter in text.strip()):
        raise wrong("this text is one line; put longer ones under doc")
    return text.strip()


def _name(value: Any) -> str:
    text = _text(value)
    if not names.IDENTIFIER.fullmatch(text):
        raise wrong(
            f"{shown(text)!r} is no name in Verilog, VHDL, C and Python; take letters, digits and single underscores, "
            "a letter first"
        )
    if len(text) > names.LONGEST:
        raise wrong(f"a name of {len(text)} characters is too long; at most {names.LONGEST}")
    if language := names.keyword_of(text):
        raise wrong(f"{text} is a keyword of {language}; take another name, for example {text}_value")
    if text in names.CLIENT:
        raise wrong(f"{text} is an attribute of the Python client itself; take another name, for example {text}_value")
    return text


def _integer(least: int, most: int, what: str) -> Any:
    def check(value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise wrong(f"{shown(value)} is no whole number; {what} is {least} to {most}")
        if not least <= value <= most:
            raise wrong(f"{shown(value)} is out of range; {what} is {least} to {most}")
        return int(value)

    return check


def _number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise wrong(f"{shown(value)} is no number; write one such as 0.1")
    if isinstance(value, float) and not math.isfinite(value):
        raise wrong(f"{shown(value)} is no number to reckon with; write a finite one")
    return value


def _scale(value: Any) -> Any:
    if _number(value) == 0:
        raise wrong("a scale of 0 makes every value 0; leave it out, or write one such as 0.1")
    return value


def _boolean(value: Any) -> bool:
    if isinstance(value, bool):
        return value
    raise wrong(f"{shown(value)} is neither true nor false; write one of them")


def _word(*allowed: str) -> Any:
    def check(value: Any) -> str:
        text = _text(value)
        if text not in allowed:
            raise wrong(f"{shown(text)} is not known here; {nearest(text, allowed)}")
        return text

    return check


def _type(value: Any) -> str:
    text = _text(value).replace(" ", "")
    if text == "string":
        raise wrong("a string needs its length; write string<16> for 16 characters")
    if found := re.fullmatch(r"string<?([0-9]+)>?", text):
        length = int(found[1]) if len(found[1]) < 9 else 10**9
        if not 1 <= length <= LONGEST_STRING:
            raise wrong(f"a string of {length} characters does not fit into one answer; 1 to {LONGEST_STRING}")
        return f"string<{length}>"
    if text not in TYPES:
        raise wrong(f"{shown(text)} is no type; {nearest(text, (*TYPES, 'string<16>'))}")
    return text


def _value(value: Any) -> Any:
    """One reset, min or max: a number, a label of the enum, or a text."""
    if value is None or isinstance(value, dict):
        raise wrong(f"{shown(value)} is no value; write a number, a text or a name of the enum")
    if isinstance(value, float) and math.isnan(value):
        raise wrong("NaN is no value of a point; write a number")
    if isinstance(value, float) and math.isinf(value):
        raise wrong("infinity is no value of a point; write a finite number")
    return value


def _values(value: Any) -> Any:
    """A reset: one value for all items, or a list with one for each."""
    if isinstance(value, list):
        if not value:
            raise wrong("an empty list is no reset value; leave reset out")
        each = Each()
        made = [each.check(index, lambda item=item: _value(item)) for index, item in enumerate(value)]
        each.done()
        return made
    return _value(value)


def _limit(value: Any) -> Any:
    if isinstance(value, list):
        raise wrong("a list is no limit; write one number, it holds for all items")
    if isinstance(value, str):
        raise wrong(f"{shown(value)} is no number; write one")
    return _value(value)


def _enum(value: Any) -> dict[int, str]:
    if not isinstance(value, dict) or not value:
        raise wrong(f"{shown(value)} is no enum; write {{0: idle, 1: running}}")
    out: dict[int, str] = {}
    each = Each()
    for key, label in value.items():
        if isinstance(key, bool) or not isinstance(key, int):
            each.note(
                key, f"{shown(key)} is no whole number; an enum is {{0: idle, 1: running}}, the number first", True
            )
            continue
        text = each.check(key, lambda label=label: _one_line(label))
        if text == "":
            each.note(key, f"the value {shown(key)} has an empty name; write one")
        out[int(key)] = text
    each.done()
    return out


def _bits(value: Any) -> dict[str, tuple[int, int]]:
    if not isinstance(value, dict) or not value:
        raise wrong(f"{shown(value)} is no list of fields; write {{ready: 0, mode: 5..4}}")
    out: dict[str, tuple[int, int]] = {}
    each = Each()
    for key, place in value.items():
        name = each.check(key, lambda key=key: _name(key), True)
        found = re.fullmatch(r"(\d{1,2})(?:\s*(?:\.\.|:)\s*(\d{1,2}))?", shown(place).strip())
        if not found:
            each.note(key, f"field {key}: {shown(place)} is no place; write one bit (3) or two (5..4)")
            continue
        high, low = int(found[1]), int(found[2] or found[1])
        if high < low:
            each.note(key, f"field {key}: {high}..{low} is the wrong way round; write {low}..{high}")
        elif name:
            out[name] = (high, low)
    each.done()
    return out


def _functions(value: Any) -> Any:
    if isinstance(value, str):
        return _word("auto")(value)
    if not isinstance(value, list):
        raise wrong(f"{shown(value)} is no list of function codes; write auto, or a list such as [03, 06, 16]")
    out: list[int] = []
    each = Each()
    for index, code in enumerate(value):
        if isinstance(code, bool) or not isinstance(code, int):
            each.note(index, f"{shown(code)} is no function code; write it decimal (43) or as 0x2B")
        elif code not in FUNCTIONS:
            hexadecimal = int(str(code), 16) if re.fullmatch(r"\d{1,3}", str(code)) else 0
            hint = f"; did you mean 0x{hexadecimal:02X}?" if hexadecimal in FUNCTIONS else ""
            known = ", ".join(str(known) for known in FUNCTIONS)
            each.note(index, f"the core has no function code {shown(code)}{hint or f'; it has {known}'}")
        elif code in out:
            each.note(index, f"function code {shown(code)} is named twice; leave one out")
        else:
            out.append(int(code))
    each.done()
    return out


def _core(value: Any) -> dict[str, int]:
    if not isinstance(value, dict):
        raise wrong(f"{shown(value)} names no parameters; write {{RESPONSE_DELAY: 10}}")
    known = core_parameters.parameters()
    out = {}
    each = Each()
    for key, number in value.items():
        name = str(key)
        if name in core_parameters.BY_THE_MAP:
            text = f"{name} is made from the map; write it under {core_parameters.BY_THE_MAP[name]}"
            each.note(key, text, True)
        elif name in core_parameters.NOT_HERE:
            each.note(key, f"{name} cannot be set: {core_parameters.NOT_HERE[name]}", True)
        elif name not in known:
            each.note(key, f"the core has no parameter {shown(name)}; {nearest(name, known)}", True)
        else:
            check = _integer(known[name].least, known[name].most, name)
            number = int(number) if isinstance(number, bool) else number
            out[name] = each.check(key, lambda check=check, number=number: check(number))
    each.done()
    return out


def _printable(value: Any) -> str:
    text = _one_line(value)
    if any(not 32 <= ord(letter) < 127 for letter in text):
        raise wrong(f"{shown(text)!r}: identity texts are printable ASCII; write it without other letters")
    return text


def _identity_text(value: Any) -> str:
    text = _printable(value)
    if len(text) > LONGEST_TEXT:
        raise wrong(f"a text of {len(text)} characters does not fit into one answer; at most {LONGEST_TEXT}")
    return text


def _private(value: Any) -> dict[int, str]:
    if not isinstance(value, dict):
        raise wrong(f"{shown(value)} names no objects; write {{0x80: text}}")
    out: dict[int, str] = {}
    each = Each()
    for key, text in value.items():
        if isinstance(key, bool) or not isinstance(key, int) or not 0x80 <= key <= 0xFF:
            each.note(key, f"{shown(key)} is no private object; their numbers are 0x80 to 0xFF", True)
            continue
        out[int(key)] = each.check(key, lambda text=text: _identity_text(text)) or ""
        if text == "":
            each.note(key, f"object 0x{key:02X} is empty; leave it out")
    each.done()
    size = sum(2 + len(text) for text in out.values())
    if size > PRIVATE_BYTES:
        raise wrong(f"private objects of {size} bytes are too long; {PRIVATE_BYTES} with two for each object")
    return out


def _octets(most: int) -> Any:
    def check(value: Any) -> bytes:
        if isinstance(value, str):
            value = list(_printable(value).encode("ascii"))
        if not isinstance(value, list):
            value = [value]
        each = Each()
        for index, octet in enumerate(value):
            each.check(index, lambda octet=octet: _integer(0, 255, "a byte")(octet))
        each.done()
        if not 1 <= len(value) <= most:
            raise wrong(f"{len(value)} bytes do not fit; 1 to {most}")
        return bytes(value)

    return check


def _octets_schema(most: int) -> Any:
    """A text, a byte, or a list of bytes."""
    octet = {"type": "integer", "minimum": 0, "maximum": 255}
    return _schema(
        anyOf=[
            {"type": "string", "minLength": 1, "maxLength": most},
            octet,
            {"type": "array", "minItems": 1, "maxItems": most, "items": octet},
        ]
    )


def _conformity(value: Any) -> int:
    if isinstance(value, bool) or value not in (1, 2, 3, 0x81, 0x82, 0x83):
        raise wrong(f"{shown(value)} is no conformity level; 1, 2, 3, 0x81, 0x82 or 0x83")
    return int(value)


def _baud(value: Any) -> int:
    return int(_integer(1, 10_000_000, "baud")(value))


def _schema(**schema: Any) -> WithJsonSchema:
    return WithJsonSchema(schema)


SCALAR_SCHEMA = {"type": ["number", "string", "boolean"]}
TextField = Annotated[str, BeforeValidator(_text), _schema(type=["string", "number", "boolean"])]
LineField = Annotated[str, BeforeValidator(_one_line), _schema(type=["string", "number", "boolean"])]
NameField = Annotated[
    str,
    BeforeValidator(_name),
    _schema(type="string", pattern=f"^{names.IDENTIFIER.pattern}$", maxLength=names.LONGEST),
]
Address = Annotated[
    int, BeforeValidator(_integer(0, ITEMS - 1, "an address")), _schema(type="integer", minimum=0, maximum=ITEMS - 1)
]
Count = Annotated[int, BeforeValidator(_integer(1, ITEMS, "count")), _schema(type="integer", minimum=1, maximum=ITEMS)]
Boolean = Annotated[bool, BeforeValidator(_boolean), _schema(type="boolean")]
ValueField = Annotated[
    Any,
    BeforeValidator(_values),
    _schema(anyOf=[SCALAR_SCHEMA, {"type": "array", "minItems": 1, "items": SCALAR_SCHEMA}]),
]
LimitField = Annotated[Any, BeforeValidator(_limit), _schema(type="number")]
Number = Annotated[Any, BeforeValidator(_number), _schema(type="number")]
ScaleField = Annotated[Any, BeforeValidator(_scale), _schema(type="number", **{"not": {"const": 0}})]
EnumField = Annotated[
    dict[int, str],
    BeforeValidator(_enum),
    _schema(
        type="object",
        minProperties=1,
        patternProperties={r"^-?(0x[0-9a-fA-F]+|[0-9]+)$": {"type": ["string", "number", "boolean"]}},
        additionalProperties=False,
    ),
]
BitsField = Annotated[
    dict[str, tuple[int, int]],
    BeforeValidator(_bits),
    _schema(
        type="object",
        minProperties=1,
        patternProperties={
            f"^{names.IDENTIFIER.pattern}$": {
                "anyOf": [
                    {"type": "integer", "minimum": 0, "maximum": 63},
                    {"type": "string", "pattern": r"^[0-9]{1,2}(\s*(\.\.|:)\s*[0-9]{1,2})?$"},
                ]
            }
        },
        additionalProperties=False,
    ),
]
IdentityText = Annotated[
    str,
    BeforeValidator(_identity_text),
    _schema(type=["string", "number"], pattern="^[ -~]*$", maxLength=LONGEST_TEXT),
]


def _words(*allowed: str) -> tuple[BeforeValidator, WithJsonSchema]:
    return BeforeValidator(_word(*allowed)), _schema(enum=list(allowed))


_RW, _RW_SCHEMA = _words("rw", "ro", "wo")
_RO, _RO_SCHEMA = _words("ro")
_FILE_RW, _FILE_RW_SCHEMA = _words("rw", "ro")
_BOOL, _BOOL_SCHEMA = _words("bool")
_KIND, _KIND_SCHEMA = _words("register", "wire", "memory", "constant")
_ORDER, _ORDER_SCHEMA = _words("big", "little")
_GAPS, _GAPS_SCHEMA = _words("exception", "zero")
_FORMAT, _ = _words(*FORMATS)
Order = Annotated[Literal["big", "little"], _ORDER, _ORDER_SCHEMA]
Kind = Annotated[Literal["register", "wire", "memory", "constant"], _KIND, _KIND_SCHEMA]


def _ro(value: Any) -> str:
    if value != "ro":
        raise wrong(f"the master cannot write this table, {shown(value)} is impossible; leave access out, or write ro")
    return "ro"


ReadOnly = Annotated[Literal["ro"], BeforeValidator(_ro), _RO_SCHEMA]


# ------------------------------------------------------------------ the models


class Strict(BaseModel):
    """A mapping that takes the keys named here and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class PointFile(Strict):
    """What every point has."""

    at: Address = Field(description="zero-based address of the first item, as on the line")
    name: NameField = Field(description="name in every language; ports are name_i, name_o, name_stb_o")
    count: Count | None = Field(None, description="an array of so many items, one behind the other")
    kind: Kind | None = Field(
        None,
        description="register: kept in flip-flops, an output; wire: an input; memory: in block RAM behind the host "
        "port; constant: its reset value. Default: register if the master writes it, else wire; memory above 64 "
        "registers",
    )
    reset: ValueField | None = Field(
        None, description="value after power-up and reset, or a list with one for each item; also a name of the enum"
    )
    enum: EnumField | None = Field(
        None, description="names of raw values; without min and max no other value may be written"
    )
    doc: TextField = Field("", description="meaning, for the manual and the comments")
    unit: LineField = Field("", description="unit of the value")


class Writable(PointFile):
    """What the points of the two tables have that the master can write."""

    access: Annotated[Literal["rw", "ro", "wo"], _RW, _RW_SCHEMA] | None = Field(
        None, description="rw: read and written by the master (default), ro: only read, wo: only written"
    )
    strobe: Boolean = Field(False, description="true: a port that pulses when the master has written the point")


class InputPoint(PointFile):
    """What the points of the two input tables have."""

    access: ReadOnly | None = Field(None, description="ro: the master can only read this table")


class BitPoint(PointFile):
    """What the points of the bit tables have."""

    type: Annotated[Literal["bool"], _BOOL, _BOOL_SCHEMA] = Field("bool", description="bool, nothing else")


class RegisterPoint(PointFile):
    """What the points of the register tables have."""

    type: Annotated[str, BeforeValidator(_type), _schema(type="string", pattern=TYPE_PATTERN)] | None = Field(
        None, description="u16 (default) i16 u32 i32 u64 i64 f32 f64 bits string<N>; N characters, two a register"
    )
    min: LimitField | None = Field(None, description="least value; a write below it answers exception 03")
    max: LimitField | None = Field(None, description="greatest value; a write above it answers exception 03")
    bits: BitsField | None = Field(None, description="named fields of the register: {ready: 0, mode: 5..4}")
    scale: ScaleField | None = Field(None, description="value = raw x scale + offset; reset, min and max are values")
    offset: Number | None = Field(None, description="see scale")
    word_order: Order | None = Field(None, description="of this point; default is that of the device")


class Coil(BitPoint, Writable):
    """A bit that the master reads and writes."""


class DiscreteInput(BitPoint, InputPoint):
    """A bit that the master reads."""

    freeze: NameField | None = Field(None, description="coil whose writing takes the snapshot that is read")


class HoldingRegister(RegisterPoint, Writable):
    """Registers that the master reads and writes."""

    freeze: NameField | None = Field(None, description="coil whose writing takes the snapshot that is read")


class InputRegister(RegisterPoint, InputPoint):
    """Registers that the master reads."""

    freeze: NameField | None = Field(None, description="coil whose writing takes the snapshot that is read")


class GapsItem(Strict):
    """An item of a table's list that is no point: what its free addresses do."""

    gaps: Annotated[Literal["exception", "zero"], _GAPS, _GAPS_SCHEMA] = Field(
        description="addresses that no point covers: exception 02 (default), or zero: they read 0 and ignore writes"
    )


class CoilTable(GapsItem):
    """A table as a mapping, with what its free addresses do."""

    points: list[Coil]


class DiscreteTable(GapsItem):
    """A table as a mapping, with what its free addresses do."""

    points: list[DiscreteInput]


class InputTable(GapsItem):
    """A table as a mapping, with what its free addresses do."""

    points: list[InputRegister]


class HoldingTable(GapsItem):
    """A table as a mapping, with what its free addresses do."""

    points: list[HoldingRegister]


class FileFile(Strict):
    """A file of function codes 14H and 15H, in memory behind the host port."""

    number: Annotated[
        int, BeforeValidator(_integer(1, 65535, "a file number")), _schema(type="integer", minimum=1, maximum=65535)
    ] = Field(description="file number")
    name: NameField = Field(description="name in every language")
    records: Annotated[
        int, BeforeValidator(_integer(1, 10000, "records")), _schema(type="integer", minimum=1, maximum=10000)
    ] = Field(256, description="records 0 to records - 1 of 16 bits")
    access: Annotated[Literal["rw", "ro"], _FILE_RW, _FILE_RW_SCHEMA] = Field(
        "rw", description="ro: only the host writes"
    )
    doc: TextField = Field("", description="meaning")


class FifoFile(Strict):
    """A FIFO queue of function code 18H: holding register `at` is the count, the entries follow. The host fills it."""

    at: Address = Field(description="address of the count")
    name: NameField = Field(description="name in every language")
    depth: Annotated[int, BeforeValidator(_integer(1, 31, "depth")), _schema(type="integer", minimum=1, maximum=31)] = (
        Field(31, description="most entries")
    )
    doc: TextField = Field("", description="meaning")


class IdentityFile(Strict):
    """What function codes 2BH (texts) and 11H (server_id) answer."""

    vendor: IdentityText = Field("", description="object 00, vendor name; with any other text it is needed")
    product: IdentityText = Field("", description="object 01, product code; default: the device's name")
    revision: IdentityText = Field("", description="object 02; default: version")
    url: IdentityText = Field("", description="object 03, vendor URL")
    name: IdentityText = Field("", description="object 04, product name")
    model: IdentityText = Field("", description="object 05, model name")
    application: IdentityText = Field("", description="object 06, user application name")
    private: Annotated[
        dict[int, str],
        BeforeValidator(_private),
        _schema(
            type="object",
            patternProperties={
                "^(0x[89a-fA-F][0-9a-fA-F]|1[3-9][0-9]|12[89]|2[0-4][0-9]|25[0-5])$": {"type": ["string", "number"]}
            },
            additionalProperties=False,
        ),
    ] = Field(default_factory=dict, description="objects 0x80 to 0xFF: {0x80: text}")
    server_id: Annotated[
        bytes,
        BeforeValidator(_octets(16)),
        _octets_schema(16),
    ] = Field(b"", description="answer of function code 11H: a text, a byte, or a list of bytes")
    additional_data: Annotated[
        bytes,
        BeforeValidator(_octets(249)),
        _octets_schema(249),
    ] = Field(b"", description="what function code 11H answers behind the run indicator")
    conformity: Annotated[int, BeforeValidator(_conformity), _schema(enum=[1, 2, 3, 0x81, 0x82, 0x83])] | None = Field(
        None, description="conformity level of 2BH; default: 0x81, 0x82 or 0x83 by the objects that exist"
    )


class LineFile(Strict):
    """The serial line."""

    address: Annotated[
        int, BeforeValidator(_integer(1, 247, "a slave address")), _schema(type="integer", minimum=1, maximum=247)
    ] = Field(1, description="slave address")
    baud: Annotated[int, BeforeValidator(_baud), _schema(type="integer", minimum=1, maximum=10_000_000)] = Field(
        19200, description="bits per second"
    )
    # 80: YAML 1.2 reads 8E1 as a number, editors too.
    format: Annotated[str, _FORMAT, _schema(enum=[*FORMATS, 80])] = Field(
        "8E1", description="data bits, parity, stop bits"
    )
    run_time: Boolean = Field(False, description="true: address, bit time and format are ports of the module")


class DeviceFile(Strict):
    """The map of a Modbus device: docs/map.md of the modbus_rtu_slave project."""

    device: NameField = Field(description="name of the module, the C prefix, the Python class")
    title: LineField = Field("", description="title of the manual; default: the device's name")
    version: LineField = Field("1.0", description="version of the map")
    doc: TextField = Field("", description="what the device is, for the manual")
    identity: IdentityFile = Field(default_factory=IdentityFile, description="what the device says it is")
    line: LineFile = Field(default_factory=LineFile, description="the serial line")
    word_order: Order = Field(
        "big", description="big: the high word of a value is in the lower register (default); little: the low word"
    )
    functions: Annotated[
        Any,
        BeforeValidator(_functions),
        _schema(
            anyOf=[
                {"const": "auto"},
                {"type": "array", "uniqueItems": True, "items": {"enum": sorted(FUNCTIONS)}},
            ]
        ),
    ] = Field("auto", description="function codes that are built in, decimal or 0x10; auto: what the map needs")
    core: Annotated[
        dict[str, int],
        BeforeValidator(_core),
        _schema(
            type="object",
            properties={
                p.name: {"type": "integer", "minimum": p.least, "maximum": p.most, "description": p.meaning}
                for p in core_parameters.parameters().values()
            },
            additionalProperties=False,
        ),
    ] = Field(default_factory=dict, description="other parameters of the core: {RESPONSE_DELAY: 10}")
    files: list[FileFile] = Field(default_factory=list, description="files of function codes 14H and 15H")
    fifos: list[FifoFile] = Field(default_factory=list, description="FIFO queues of function code 18H")
    coils: list[Coil | GapsItem] | CoilTable = Field(default_factory=list, description="bits, read and written")
    discrete_inputs: list[DiscreteInput | GapsItem] | DiscreteTable = Field(
        default_factory=list, description="bits, read"
    )
    input_registers: list[InputRegister | GapsItem] | InputTable = Field(
        default_factory=list, description="registers, read"
    )
    holding_registers: list[HoldingRegister | GapsItem] | HoldingTable = Field(
        default_factory=list, description="registers, read and written"
    )


POINT_MODELS: dict[str, type[PointFile]] = {
    "coils": Coil,
    "discrete_inputs": DiscreteInput,
    "input_registers": InputRegister,
    "holding_registers": HoldingRegister,
}
TABLE_MODELS: dict[str, type[GapsItem]] = {
    "coils": CoilTable,
    "discrete_inputs": DiscreteTable,
    "input_registers": InputTable,
    "holding_registers": HoldingTable,
}
