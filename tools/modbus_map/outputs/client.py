# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME_client.py: the Python master, one module that needs pymodbus only.

The part that is the same for each device is in client_runtime.py; its text stands in the module as it is. Behind it
come the named values, the table of points, and two classes of typed attributes.
"""

from __future__ import annotations

from pathlib import Path

from modbus_map.model import READ_FUNCTION, Device, Point, exact_of
from modbus_map.outputs import shared

RUNTIME = Path(__file__).with_name("client_runtime.py")


def _runtime() -> str:
    """The text between the marks of client_runtime.py."""
    return RUNTIME.read_text(encoding="utf-8").split("# ---- copied from here\n")[1].rstrip("\n")


class _Names:
    """Class names that are used once."""

    def __init__(self) -> None:
        self.taken = {"IntEnum", "NamedTuple", "Generic", "TypeVar", "Fraction", "Any", "Literal", "Point", "Number"}

    def new(self, name: str) -> str:
        while name in self.taken:
            name += "Value"
        self.taken.add(name)
        return name


def _text(text: str) -> str:
    """A docstring's content: one line, quotes and backslashes escaped."""
    return shared.comment(text).replace("\\", "\\\\").replace('"', '\\"')


def _enum(name: str, point: Point) -> list[str]:
    lines = ["", "", f"class {name}(IntEnum):", f'    """Values of {point.name}."""', ""]
    seen: set[str] = set()
    for item in point.enum:
        ident = item.ident if item.ident not in {"MRO"} and item.ident.isidentifier() else f"V_{item.ident}"
        if ident not in seen:
            lines.append(f"    {ident} = {item.number}")
        seen.add(ident)
    return lines


def _fields(name: str, point: Point) -> list[str]:
    lines = ["", "", f"class {name}(NamedTuple):", f'    """Fields of {point.name}; bits without a name are 0."""', ""]
    return lines + [f"    {part.name}: {'bool' if part.width == 1 else 'int'}" for part in point.fields]


def _kind(point: Point, special: str) -> str:
    if special:
        return special
    if point.type == "bool":
        return "bool"
    if point.is_string:
        return "str"
    return "float" if point.is_float or not point.whole_steps else "int"


def _limits(point: Point) -> tuple[str, str]:
    if point.is_bit or point.is_string:
        return "None", "None"
    low = None if point.minimum is None else point.number(point.minimum)
    high = None if point.maximum is None else point.number(point.maximum)
    return repr(low), repr(high)


def _point(point: Point, device: Device, special: str) -> str:
    """The line of the table of points."""
    low, high = _limits(point)
    scale, offset = exact_of(point.scale), exact_of(point.offset)
    facts = [
        repr(point.table), str(point.at), repr(point.name), repr(point.type.strip()), str(point.width),
        str(point.count), repr(point.access),
    ]  # fmt: skip
    if point.is_array:
        facts.append("array=True")
    if point.word_order == "little":
        facts.append("little=True")
    if point.is_float and point.is_scaled:
        facts += [f"scale={point.scale!r}", f"offset={point.offset!r}"]
    elif point.is_scaled:
        facts += [f'scale=Fraction("{scale}")', f'offset=Fraction("{offset}")']
    if low != "None":
        facts.append(f"low={low}")
    if high != "None":
        facts.append(f"high={high}")
    if point.enum_is_limit:
        facts.append("only=" + repr(tuple(item.number for item in point.enum)))
    if shared.has_names(point):
        facts.append(f"names={special}")
    elif special:
        facts.append(f"fields=({special}, {tuple((part.low, part.width) for part in point.fields)})")
    if point.is_scaled and point.whole_steps:
        facts.append("whole=True")
    for key, write in (("reads", False), ("writes", True)):
        fewer = shared.most(device, point.table, write)
        if fewer < shared.most_of_protocol(point.table, write):
            facts.append(f"{key}={fewer}")
    single = 5 if point.is_bit else 6
    if point.writable and not device.has_function(single):
        facts.append("single=False")
    if point.writable and not device.has_function(15 if point.is_bit else 16):
        facts.append("multiple=False")
    return f"_{point.name.upper()}: Point[Any] = Point({', '.join(facts)})"


def _about(point: Point) -> str:
    parts = [shared.item_doc(point, 0).rstrip(" 0") if point.is_array else shared.item_doc(point, 0)]
    if point.unit:
        parts[0] += f" in {point.unit}"
    if limit := shared.span(point):
        parts.append(limit)
    if point.access != "rw":
        parts.append({"ro": "read only", "wo": "write only"}[point.access])
    return _text(", ".join(parts) + "." + (f" {point.doc}" if point.doc else ""))


def _classes(device: Device, main: str, values: str, kinds: dict[str, str]) -> list[str]:
    usable = [p for p in device.points if p.readable and device.has_function(READ_FUNCTION[p.table])]
    written = [p for p in device.points if p.writable]
    lines = ["", "", f"class {values}(NamedTuple):", '    """All values that can be read, as of one read_all()."""', ""]
    lines += [f"    {p.name}: {kinds[p.name]}" for p in usable] or ["    pass"]
    address = device.line.address
    for is_async in (False, True):
        name = main + ("Async" if is_async else "")
        client = "ModbusBaseClient" if is_async else "ModbusBaseSyncClient"
        a, w = ("async ", "await ") if is_async else ("", "")
        example = (
            f"await device.{usable[0].name}"
            if usable and is_async
            else f"device.{usable[0].name}"
            if usable
            else "device"
        )
        lines += [
            "",
            "",
            f"class {name}({'AsyncDevice' if is_async else 'SyncDevice'}):",
            f'    """{_text(device.title)}{" (await)" if is_async else ""}: `{example}`.',
            "",
            "    Reading raises ModbusError for an exception answer, writing also ValueError for a value out of range.",
            '    """',
            "",
            "    points: dict[str, Point[Any]] = {",
            *(f'        "{p.name}": _{p.name.upper()},' for p in device.points),
            "    }",
            "",
            f"    def __init__(self, client: {client}, device_id: int = {address}) -> None:",
            "        super().__init__(client, device_id)",
            "",
            f"    {a}def read_all(self) -> {values}:",
            '        """All values, in as few requests as the map allows."""',
            f"        got = {w}self._read_blocks(_BLOCKS)",
            f"        return {values}(" + ", ".join(f'got["{p.name}"]' for p in usable) + ")"
            if usable
            else f"        return {values}()",
        ]
        for freeze in device.freeze_coils():
            if freeze == device.freeze_coils()[0]:
                lines += [
                    "",
                    f"    {a}def freeze(self) -> None:",
                    f'        """Broadcasts 1 to coil {freeze}: all slaves take their snapshots at once."""',
                    f"        {w}self._broadcast(_{freeze.upper()}, True)",
                ]
        for p in device.points:
            kind = kinds[p.name]
            lines += ["", "    @property"]
            if p in usable:
                result = f"Awaitable[{kind}]" if is_async else kind
                lines += [
                    f"    def {p.name}(self) -> {result}:",
                    f'        """{_about(p)}"""',
                    f"        return self._read(_{p.name.upper()})"
                    + ("" if is_async else "  # type: ignore[no-any-return]"),
                ]
            else:
                lines += [
                    f"    def {p.name}(self) -> {kind}:",
                    f'        """{_about(p)}"""',
                    f'        raise AttributeError("{p.name} cannot be read")',
                ]
            if p.writable and not is_async:
                lines += [
                    "",
                    f"    @{p.name}.setter",
                    f"    def {p.name}(self, value: {kind}) -> None:",
                    f"        self._write(_{p.name.upper()}, value)",
                ]
        for verb, some in (("read", usable), ("write", written)):
            value, back = ("", "Any") if verb == "read" else (", value: Any", "None")
            for p in some:
                kind = kinds[p.name]
                lines += [
                    "",
                    "    @overload",
                    f'    {a}def {verb}(self, name: Literal["{p.name}"]'
                    + (f") -> {kind}: ..." if verb == "read" else f", value: {kind}) -> None: ..."),
                ]
            if some:
                lines += ["", "    @overload", f"    {a}def {verb}(self, name: str{value}) -> {back}: ..."]
            lines += [
                "",
                f"    {a}def {verb}(self, name: str{value}) -> {back}:",
                f'        """{"Reads" if verb == "read" else "Writes"} a point by its name. Raises KeyError."""',
                f"        {'return ' if verb == 'read' else ''}{w}self._{verb}(self.points[name]"
                + (")" if verb == "read" else ", value)"),
            ]
    return lines


def generate(device: Device) -> dict[str, str]:
    """{NAME_client.py: text}."""
    names = _Names()
    main = names.new(shared.camel(device.name))
    names.taken |= {
        f"{main}Async",
        "SyncDevice",
        "AsyncDevice",
        "ModbusError",
        "ModbusBaseClient",
        "ModbusBaseSyncClient",
    }
    values = names.new(f"{main}Values")
    lines = [
        f'"""{_text(device.title)}: register map {_text(device.version)}, for a master in Python.',
        "",
        "    from pymodbus.client import ModbusSerialClient",
        f"    from {device.name}_client import {main}",
        "",
        f'    client = ModbusSerialClient("/dev/ttyUSB0", baudrate={device.line.baud}, parity="{device.line.parity}",'
        f" stopbits={device.line.stop_bits})",
        "    client.connect()",
        f"    device = {main}(client)",
        "    print(device.read_all())",
        "",
        f"{main}Async does the same with an asynchronous client and `await`.",
        "",
        "Made from the map file: change that, not this file.",
        '"""',
        "",
        _runtime(),
    ]
    kinds: dict[str, str] = {}
    table: list[str] = []
    for point in device.points:
        special = ""
        if shared.has_names(point):
            special = names.new(shared.camel(point.name))
            lines += _enum(special, point)
        elif point.fields and not point.is_scaled and not point.is_string:
            special = names.new(shared.camel(point.name))
            lines += _fields(special, point)
        kind = _kind(point, special)
        if shared.has_names(point):
            kind = f"{special} | int"
        kinds[point.name] = f"tuple[{kind}, ...]" if point.is_array else kind
        table.append(_point(point, device, special))
    lines += [
        "",
        "",
        *table,
        "",
        "# What one request reads: table, address, quantity, and (point, item) in their order",
    ]
    lines += ["_BLOCKS: list[Block] = ["]
    for block in shared.blocks(device):
        parts: list[str] = []
        for point in dict.fromkeys(point for point, _ in block.items):
            of_it = [item for p, item in block.items if p is point]
            parts.append(f"(_{point.name.upper()}, {of_it[0]}, {len(of_it)})")
        lines.append(f'    ("{block.table}", {block.at}, {block.size}, [{", ".join(parts)}]),')
    lines += ["]", *_classes(device, main, values, kinds)]
    return {f"{device.name}_client.py": "\n".join(lines) + "\n"}
