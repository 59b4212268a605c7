# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""From a map as plain Python to a Device: every key is judged, every default resolved, every value made raw.

`compile_source` finds all errors of a file in one go: an item that is wrong in itself is left out of the checks that
concern several.
"""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import PurePath
from typing import Any

from pydantic import BaseModel, ValidationError

from modbus_map import filelist_names, loader, names
from modbus_map.diagnostics import Diagnostic, MapError, nearest
from modbus_map.file_model import (
    POINT_MODELS,
    DeviceFile,
    FifoFile,
    FileFile,
    GapsItem,
    IdentityFile,
    PointFile,
    shown,
)
from modbus_map.judge import Judge, with_article
from modbus_map.loader import Path_, Source
from modbus_map.model import (
    ITEMS,
    MEMORY_ABOVE,
    READ_FUNCTION,
    TABLES,
    WIDTHS,
    BitField,
    Device,
    EnumItem,
    File,
    Identity,
    Line,
    Point,
    Port,
    is_bit_table,
)

FLIP_FLOPS = 4096  # of one point: above it a warning names block RAM
LISTS = ("files", "fifos", *TABLES)
WRITE_FUNCTIONS = {"coils": (0x05, 0x0F), "holding_registers": (0x06, 0x10, 0x16, 0x17)}
TEXT_MEMORY = 2048  # bytes of the core's identity, its directory included


def load_device(path: str | PurePath) -> tuple[Device, list[Diagnostic]]:
    """The device of a map file, and warnings. Raises MapError."""
    return compile_source(loader.load(path))


def compile_source(source: Source) -> tuple[Device, list[Diagnostic]]:
    """The device of a map, and warnings. Raises MapError with errors and warnings, in the order of the file."""
    compiler = _Compiler(source)
    device = compiler.run()
    if device is None or any(not note.warning for note in compiler.notes):
        raise MapError(compiler.notes)
    return device, sorted(compiler.notes)


class _Compiler(Judge):
    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self.names: dict[str, tuple[str, Path_]] = {}  # lower case -> name, path
        self.paths: dict[str, Path_] = {}  # of the points, by name
        self.zero_gaps: set[str] = set()
        self.bad_points: set[str] = set()  # tables with items that were left out

    def validate(self, model: type[BaseModel], item: Any, path: Path_, what: str) -> Any:
        """The item as a model, or None after its errors are noted."""
        if not isinstance(item, dict):
            self.error(path, f"{shown(item)} is no {what}; write {{{_example(model)}}}")
            return None
        try:
            return model.model_validate(item)
        except ValidationError as error:
            for found in error.errors(include_url=False, include_input=False):
                self.explain(found, model, path)
            return None

    def explain(self, found: Any, model: type[BaseModel], path: Path_) -> None:
        """One error of pydantic as one diagnostic."""
        where = (*path, *found["loc"])
        kind = found["type"]
        key = found["loc"][-1] if found["loc"] else ""
        if kind == "extra_forbidden":
            inner = model
            for step in found["loc"][:-1]:
                inner = _inner(inner, step)
            known = [name for name in inner.model_fields if name not in self.tree_at(where[:-1])]
            hint = nearest(str(key), inner.model_fields)
            self.error(
                where, f"unknown key {shown(key)}; {hint if '?' in hint else nearest(str(key), known)}", key=True
            )
        elif kind == "missing":
            self.error(where[:-1], f"the key {key} is missing; write {key}: {_EXAMPLES.get(str(key), 'its value')}")
        elif kind == "map":
            items = found["ctx"]["items"]
            for step, text, of_key in items:
                self.error((*where, step), text, key=of_key)
            if not items:
                self.error(where, found["ctx"]["text"])
        elif kind in ("model_type", "model_attributes_type", "dict_type"):
            self.error(where, f"{key} is a mapping; write {key}: {{key: value}}")
        else:
            self.error(where, found["msg"].lower())

    def tree_at(self, path: Path_) -> Any:
        tree = self.source.tree
        for step in path:
            tree = tree[step]
        return tree

    # ---------------------------------------------------------------- the whole

    def run(self) -> Device | None:
        tree = self.source.tree
        if tree is None:
            self.error((), "the file is empty; `modbus map init` writes an example")
            return None
        if not isinstance(tree, dict):
            self.error((), f"a map begins with keys, this is {_indefinite(shown(tree))}; write device: NAME")
            return None
        head_tree = {key: value for key, value in tree.items() if key not in LISTS}
        head = self.validate(DeviceFile, head_tree, (), "map")
        self.device_name(tree)
        order = tree.get("word_order") if tree.get("word_order") in ("big", "little") else "big"
        points: list[Point] = []
        files: list[File] = []
        for table in tree:
            if table in TABLES:
                points += self.table(table, order)
            elif table == "fifos":
                points += self.fifos()
            elif table == "files":
                files = self.files()
        self.overlaps(points)
        self.freezes(points)
        if not any(name in tree for name in LISTS) and not self.source.problems:
            self.error((), "the device has no points; write a table, for example coils: [{at: 0, name: relay}]")
        if head is None:
            return None
        identity = self.identity(head.identity, head)
        device = Device(
            name=head.device,
            title=head.title or head.device,
            version=head.version,
            doc=head.doc.strip(),
            identity=identity,
            line=Line(**head.line.model_dump()),
            word_order=head.word_order,
            functions=(),
            functions_auto=head.functions == "auto",
            core=tuple(head.core.items()),
            points=tuple(points),
            files=tuple(files),
            zero_gaps=frozenset(self.zero_gaps),
            source=PurePath(self.source.file).name,
        )
        self.core(device)
        device = dataclasses.replace(device, functions=self.functions(device, head.functions))
        self.ports(device)
        self.gaps(device)
        return device

    def device_name(self, tree: dict[Any, Any]) -> None:
        name = str(tree.get("device", ""))
        if name.lower() in filelist_names.modules():
            self.error(("device",), f"{name} is a module of the core; take another name, for example my_{name}")

    # ---------------------------------------------------------------- tables

    def table(self, table: str, order: Any) -> list[Point]:
        tree, path = self.source.tree[table], (table,)
        if isinstance(tree, dict):
            unknown = [key for key in tree if key not in ("gaps", "points")]
            for key in unknown:
                hint = nearest(str(key), ("gaps", "points"))
                self.error((table, key), f"unknown key {shown(key)}; {hint} A table is a list of points", key=True)
            if "gaps" in tree:
                self.gaps_item({"gaps": tree["gaps"]}, path, table)
            tree, path = tree.get("points"), (table, "points")
            if tree is None and not unknown:
                self.error((table,), "the table has no points; write points: [{at: 0, name: NAME}]")
                return []
        if not isinstance(tree, list):
            if tree is not None or isinstance(self.source.tree[table], list):
                self.error(path, f"{table} is {_indefinite(shown(tree))}; write a list: - {{at: 0, name: NAME}}")
            elif not isinstance(self.source.tree[table], dict):
                self.error(path, f"{table} is empty; leave it out, or write - {{at: 0, name: NAME}}")
            return []
        points = []
        for index, item in enumerate(tree):
            here = (*path, index)
            if isinstance(item, dict) and set(item) == {"gaps"}:
                self.gaps_item(item, here, table)
                continue
            self.claim(item, here)
            parsed = self.validate(POINT_MODELS[table], item, here, "point")
            point = self.point(parsed, table, order, here) if parsed else None
            if point is None:
                self.bad_points.add(table)
            else:
                self.paths[point.name] = here
                points.append(point)
        return points

    def gaps_item(self, item: dict[Any, Any], path: Path_, table: str) -> None:
        parsed = self.validate(GapsItem, item, path, "table")
        if parsed and parsed.gaps == "zero":
            self.zero_gaps.add(table)

    def claim(self, item: Any, path: Path_) -> None:
        """Note the name of an item, so that others with the same one are found."""
        if not isinstance(item, dict) or "name" not in item or isinstance(item["name"], (dict, list)):
            return
        name = str(getattr(item["name"], "text", item["name"]))
        first = self.names.setdefault(name.lower(), (name, path))
        if first[1] != path:
            line = self.line_of((*first[1], "name"))
            if first[0] == name:
                self.error((*path, "name"), f"{name} is the name of line {line} already; take another")
            else:
                text = f"{name} differs from {first[0]} in line {line} by case only, VHDL takes them for one; rename it"
                self.error((*path, "name"), text)

    # ---------------------------------------------------------------- a point

    def point(self, parsed: PointFile, table: str, order: Any, path: Path_) -> Point | None:
        count_of_errors = len([note for note in self.notes if not note.warning])
        given = self.tree_at(path)
        kind_of = getattr(parsed, "type", None) or ("bits" if getattr(parsed, "bits", None) else "u16")
        width = 1 if is_bit_table(table) else WIDTHS.get(kind_of, 0) or (int(kind_of[7:-1]) + 1) // 2
        count = parsed.count or 1
        last = parsed.at + width * count - 1
        if last >= ITEMS:
            if width > 1 and count == 1:
                room = f"{with_article(kind_of)} takes {width} registers"
            else:
                room = f"{count} items of {kind_of} take {width * count} addresses"
            self.error((*path, "at"), f"{room}, so it ends at {last}; the last address of a table is {ITEMS - 1}")
        access = getattr(parsed, "access", None) or ("ro" if table in ("discrete_inputs", "input_registers") else None)
        strobe = getattr(parsed, "strobe", False)
        freeze = getattr(parsed, "freeze", None) or ""
        kind: Any = parsed.kind
        if access is None:
            access = "ro" if kind in ("wire", "constant") or freeze else "rw"
        big = not is_bit_table(table) and width * count > MEMORY_ABOVE
        if kind is None:
            kind = "memory" if big and not freeze else "wire" if access == "ro" else "register"
        self.kind(parsed.kind is not None, kind, access, table, path)
        if kind == "constant" and parsed.reset is None:
            self.error((*path, "kind"), "a constant needs its value; write reset: VALUE")
        if strobe and access == "ro":
            self.error((*path, "strobe"), "the master cannot write a read-only point; leave strobe out, or access: rw")
        if freeze and kind != "wire":
            self.error(
                (*path, "freeze"), f"only an input (kind: wire) has a snapshot, this is a {kind}; leave freeze out"
            )
        if kind in ("register", "wire") and width * count * (1 if is_bit_table(table) else 16) > FLIP_FLOPS:
            if kind == "register":
                self.warn(path, f"{width * count * 16} flip-flops; kind: memory keeps it in block RAM")
        word_order = getattr(parsed, "word_order", None)
        if word_order and (width == 1 or kind_of.startswith("string")):
            self.warn((*path, "word_order"), f"{with_article(kind_of)} has no word order; leave it out")
        if kind_of.startswith("string") or width == 1:
            word_order = "big"
        scale, offset = getattr(parsed, "scale", None), getattr(parsed, "offset", None)
        point = Point(
            table=table,  # type: ignore[arg-type]
            at=parsed.at,
            name=parsed.name,
            type=kind_of,
            width=width,
            count=count,
            is_array=parsed.count is not None,
            access=access,
            kind=kind,
            resets=(0,) * count,
            unit=parsed.unit,
            scale=float(scale) if scale is not None else 1.0,
            offset=float(offset) if offset is not None else 0.0,
            word_order=word_order or order,
            doc=parsed.doc.strip(),
            strobe=strobe,
            freeze=freeze,
        )
        no_number = kind_of.startswith("string") or kind_of in ("bits", "bool")
        for key in ("scale", "offset"):
            if key in given and no_number:
                self.error((*path, key), f"{with_article(kind_of)} has no {key}; leave it out", key=True)
            elif key in given and parsed.enum:
                self.error((*path, key), f"an enum names raw values and has no {key}; leave one of them out", key=True)
        enum = self.enum(parsed.enum, point, path) if parsed.enum else ()
        fields = self.fields(parsed, point, path) if getattr(parsed, "bits", None) else ()
        point = dataclasses.replace(point, enum=enum, fields=fields)
        limits: dict[str, int | None] = {}
        for key in ("min", "max"):
            limits[key] = None
            if getattr(parsed, key, None) is None:
                continue
            if no_number:
                self.error((*path, key), f"{with_article(kind_of)} has no {key}; leave it out", key=True)
            else:
                limits[key] = self.raw(getattr(parsed, key), point, (*path, key), key)
        if point.scale < 0:
            limits["min"], limits["max"] = limits["max"], limits["min"]
        low, high = limits["min"], limits["max"]
        if low is not None and high is not None and point.number(low) > point.number(high):  # type: ignore[operator]
            self.error(
                (*path, "min"), f"min {shown(given['min'])} is above max {shown(given['max'])}; exchange the two"
            )
            low = high = None
        point = dataclasses.replace(point, minimum=low, maximum=high)
        for item in point.enum:
            if (low is not None or high is not None) and not point.accepts(item.raw):
                text = f"{item.label} is {item.number}, outside min and max; change one of them"
                self.error((*path, "enum", item.number), text, key=True)
        if kind == "memory" and width > 1 and access != "ro" and point.is_limited:
            key = next(key for key in ("min", "max", "enum") if key in given)
            text = f"{with_article(kind_of)} in memory has no limits: they are for whole values; "
            text += f"kind: register, or leave {key} out"
            self.error((*path, key), text, key=True)
        resets = self.resets(parsed, point, path)
        if kind == "wire" and parsed.reset is not None:
            self.warn((*path, "reset"), "an input has no reset value, it is ignored; leave it out, or kind: constant")
            resets = (0,) * count
        point = dataclasses.replace(point, resets=resets)
        wrong = len([note for note in self.notes if not note.warning]) > count_of_errors
        return None if wrong else point

    def kind(self, said: bool, kind: str, access: str, table: str, path: Path_) -> None:
        """Kind, access and table must fit."""
        place = (*path, "kind" if said else "access")
        if kind == "memory" and is_bit_table(table):
            self.error(place, "bits are not kept in memory; kind: register, wire or constant")
        elif kind == "register" and access == "ro":
            if table in ("discrete_inputs", "input_registers"):
                self.error(place, "the master cannot write this table; kind: wire, memory or constant")
            else:
                self.error(place, "a read-only register would never change; kind: wire or constant, or access: rw")
        elif kind == "wire" and access != "ro":
            self.error(place, "the master cannot write an input (kind: wire); access: ro, or kind: register")
        elif kind == "constant" and access != "ro":
            self.error(place, "the master cannot write a constant; access: ro, or kind: register")

    def resets(self, parsed: PointFile, point: Point, path: Path_) -> tuple[int, ...]:
        given = parsed.reset
        if given is None:
            raw = 0
            if point.is_limited and not point.accepts(0) and point.writable:
                raw = self.first_legal(point)
                self.warn(
                    path, f"0 is not allowed here, so {point.name} begins with {point.value(raw)}; write reset: VALUE"
                )
            return (raw,) * point.count
        if isinstance(given, list) and len(given) != point.count:
            many = f"{len(given)} values for {point.count} item{'s' if point.count > 1 else ''}"
            self.error((*path, "reset"), f"{many}; write one for each, or one for all")
            return (0,) * point.count
        values = given if isinstance(given, list) else [given]
        made = []
        for index, value in enumerate(values):
            here = (*path, "reset", index) if isinstance(given, list) else (*path, "reset")
            raw = self.raw(value, point, here, "reset")
            if raw is not None and not point.accepts(raw) and point.kind != "wire":
                if point.minimum is not None or point.maximum is not None:
                    self.error(here, f"reset {shown(value)} is outside min and max; {self.span(point)}")
                else:
                    labels = ", ".join(f"{item.number} ({item.label})" for item in point.enum)
                    self.error(here, f"reset {shown(value)} is no value of the enum; {labels}")
            made.append(raw or 0)
        return tuple(made) if isinstance(given, list) else (made[0],) * point.count

    @staticmethod
    def first_legal(point: Point) -> int:
        """The value that a point without a reset begins with where 0 is refused: that nearest to 0."""
        legal = [raw for raw in (point.minimum, point.maximum) if raw is not None]
        legal += [item.raw for item in point.enum] if not legal else []
        return min(legal, key=lambda raw: abs(point.number(raw)))  # type: ignore[arg-type]

    @staticmethod
    def span(point: Point) -> str:
        parts = []
        if point.minimum is not None:
            parts.append(f"from {point.value(point.minimum)}")
        if point.maximum is not None:
            parts.append(f"to {point.value(point.maximum)}")
        return " ".join(parts)

    def enum(self, given: dict[int, str], point: Point, path: Path_) -> tuple[EnumItem, ...]:
        if point.is_float or point.is_string or point.type == "bits":
            self.error((*path, "enum"), f"{with_article(point.type)} has no enum; leave it out, or take u16", key=True)
            return ()
        least, most = (0, 1) if point.type == "bool" else point.number_range()
        made: list[EnumItem] = []
        for number, label in given.items():
            here = (*path, "enum", number)
            if not least <= number <= most:
                text = f"{number} ({label}) is outside the type; {point.type} is {least} to {most}"
                self.error(here, text, key=True)
                continue
            ident = names.identifier_of(label)
            twin = next((item for item in made if item.ident == ident), None)
            if twin and twin.label == label:
                self.error(here, f"{label} is the name of {twin.number} already; take another")
                continue
            if twin:
                self.error(here, f"{label} and {twin.label} are both {ident} in C and Python; take another")
                continue
            made.append(EnumItem(number & ((1 << point.bits) - 1), number, label, ident))
        return tuple(sorted(made, key=lambda item: item.number))

    def fields(self, parsed: Any, point: Point, path: Path_) -> tuple[BitField, ...]:
        if point.type not in ("bits", "u16", "u32", "u64"):
            self.error(
                (*path, "bits"),
                f"{with_article(point.type)} has no bit fields; take type: bits, or u16, u32, u64",
                key=True,
            )
            return ()
        if parsed.enum:
            self.error((*path, "enum"), "a point has bits or an enum; leave one of them out", key=True)
        made: list[BitField] = []
        for name, (high, low) in parsed.bits.items():
            here = (*path, "bits", name)
            if high >= point.bits:
                where = f"outside {with_article(point.type)}; its bits are 0 to {point.bits - 1}"
                text = f"field {name}: bit {high} is {where}"
                self.error(here, text)
                continue
            for other in made:
                if low <= other.high and other.low <= high:
                    bit = max(low, other.low)
                    self.error(here, f"field {name} overlaps {other.name} at bit {bit}; move one of them")
                if other.name.lower() == name.lower():
                    self.error(here, f"field {name} differs from {other.name} by case only; rename it", key=True)
            made.append(BitField(name, high, low))
        return tuple(sorted(made, key=lambda item: item.low))

    # ---------------------------------------------------------------- files and FIFOs

    def listed(self, key: str, model: type[BaseModel], what: str) -> list[tuple[Any, Path_]]:
        tree = self.source.tree[key]
        if not isinstance(tree, list):
            self.error((key,), f"{key} is {_indefinite(shown(tree))}; write a list: - {{{_example(model)}}}")
            return []
        out = []
        for index, item in enumerate(tree):
            self.claim(item, (key, index))
            if parsed := self.validate(model, item, (key, index), what):
                out.append((parsed, (key, index)))
        return out

    def fifos(self) -> list[Point]:
        points = []
        for parsed, path in self.listed("fifos", FifoFile, "FIFO"):
            if parsed.at + parsed.depth >= ITEMS:
                text = f"the FIFO ends at {parsed.at + parsed.depth}; the last address of a table is {ITEMS - 1}"
                self.error((*path, "at"), text)
                continue
            self.paths[parsed.name] = path
            size = parsed.depth + 1
            points.append(
                Point(
                    "holding_registers",
                    parsed.at,
                    parsed.name,
                    "u16",
                    1,
                    count=size,
                    is_array=True,
                    access="ro",
                    kind="memory",
                    resets=(0,) * size,
                    doc=parsed.doc.strip(),
                    fifo=True,
                )
            )
        return points

    def files(self) -> list[File]:
        made: list[File] = []
        paths: dict[int, Path_] = {}
        for parsed, path in self.listed("files", FileFile, "file"):
            if parsed.number in paths:
                line = self.line_of(paths[parsed.number])
                self.error((*path, "number"), f"file {parsed.number} is in line {line} already; take another number")
                continue
            paths[parsed.number] = path
            made.append(File(parsed.number, parsed.name, parsed.records, parsed.access, parsed.doc.strip()))
        total = sum(file.records for file in made)
        if total > ITEMS:
            self.error(
                ("files",), f"{total} records are too many for one memory; at most {ITEMS} in all files", key=True
            )
        return made

    # ---------------------------------------------------------------- what concerns several points

    def overlaps(self, points: list[Point]) -> None:
        for table in TABLES:
            mine = sorted((point for point in points if point.table == table), key=lambda point: (point.at, point.last))
            furthest: Point | None = None
            for point in mine:
                if furthest and point.at <= furthest.last:
                    later, first = sorted((point, furthest), key=lambda p: self.source.place(self.paths[p.name]))[::-1]
                    line = self.line_of(self.paths[first.name])
                    text = (
                        f"{later.name} ({_span(later)}) overlaps {first.name} ({_span(first)}) of line {line}; "
                        f"the next free address is {furthest.last + 1}"
                    )
                    self.error((*self.paths[later.name], "at"), text)
                if furthest is None or point.last > furthest.last:
                    furthest = point

    def freezes(self, points: list[Point]) -> None:
        by_name = {point.name: point for point in points}
        coils = [point.name for point in points if point.table == "coils" and point.writable and point.count == 1]
        for point in points:
            if not point.freeze:
                continue
            path = (*self.paths[point.name], "freeze")
            coil = by_name.get(point.freeze)
            if coil is None and point.freeze.lower() in self.names and "coils" in self.bad_points:
                continue  # the coil is there, but wrong
            if coil is None:
                hint = nearest(point.freeze, coils) if coils else "write coils: [{at: 0, name: take}]"
                self.error(path, f"there is no coil {point.freeze}; {hint}")
            elif coil.name not in coils:
                text = f"{coil.name} is no single coil that the master can write; name one, or make it one"
                self.error(path, text)

    def gaps(self, device: Device) -> None:
        """Warn of addresses between two points that break a block read."""
        for table, points in device.tables():
            if table in self.bad_points or table in device.zero_gaps:
                continue
            for before, after in itertools.pairwise(points):
                free = after.at - before.last - 1
                if free > 0:
                    where = (
                        f"address {before.last + 1} is"
                        if free == 1
                        else (f"addresses {before.last + 1} to {after.at - 1} are")
                    )
                    text = (
                        f"{where} covered by no point: a block read across answers exception 02; "
                        "close the gap, or write gaps: zero"
                    )
                    self.warn((*self.paths[after.name], "at"), text)
            if any(point.readable for point in points):
                for point in points[1:-1]:
                    if not point.readable:
                        text = (
                            f"a block read across {point.name} answers exception 02; move it to the end, or access: rw"
                        )
                        self.warn((*self.paths[point.name], "access"), text)

    def ports(self, device: Device) -> None:
        """No two ports may have one name."""
        taken: dict[str, Port] = {}
        for port in device.port_list():
            other = taken.setdefault(port.name.lower(), port)
            if other is port:
                continue
            point = port.point or other.point
            if point is None or (port.point and other.point and port.point.name.lower() == other.point.name.lower()):
                continue  # `claim` has told of two points of one name
            both = port.point and other.point
            owner = f"point {(other if port.point else port).point.name}" if both else "the module itself"  # type: ignore[union-attr]
            text = f"the port {port.name} would be there twice, for {point.name} and for {owner}; rename {point.name}"
            self.error((*self.paths[point.name], "name"), text)

    # ---------------------------------------------------------------- device

    def identity(self, given: IdentityFile, head: DeviceFile) -> Identity:
        texts = ("vendor", "product", "revision", "url", "name", "model", "application")
        wanted = [name for name in texts if getattr(given, name)] + (["private"] if given.private else [])
        if wanted and not given.vendor:
            self.error(("identity",), f"identity has {wanted[0]} but no vendor; write vendor: NAME")
        room = 250 - len(given.server_id or b"\x09")
        if len(given.additional_data) > room:
            text = f"{len(given.additional_data)} bytes do not fit behind server_id; at most {room}"
            self.error(("identity", "additional_data"), text)
        level = (
            0x83 if given.private else 0x82 if any((given.url, given.name, given.model, given.application)) else 0x81
        )
        if given.conformity is not None and (given.conformity & 0x7F) < level & 0x7F:
            kind = "private" if given.private else "regular"
            text = f"conformity 0x{given.conformity:02X} hides the {kind} objects; write 0x{level:02X}"
            self.warn(("identity", "conformity"), text)
        made = Identity(
            vendor=given.vendor,
            product=given.product or (head.device if given.vendor else ""),
            revision=given.revision or (head.version if given.vendor else ""),
            url=given.url,
            name=given.name,
            model=given.model,
            application=given.application,
            private=tuple(sorted(given.private.items())),
            server_id=given.server_id,
            additional_data=given.additional_data,
            conformity=given.conformity if given.conformity is not None else level,
        )
        size = sum(4 + len(text) for _, text in made.objects()) + len(made.server_id) + len(made.additional_data) + 32
        if size > TEXT_MEMORY:
            text = f"identity takes {size} bytes, the core's memory has {TEXT_MEMORY}; shorten the texts"
            self.error(("identity",), text, key=True)
        return made

    def core(self, device: Device) -> None:
        low, high = device.core_parameter("T15_MIN_US"), device.core_parameter("T35_MIN_US")
        key = "T15_MIN_US" if "T15_MIN_US" in dict(device.core) else "T35_MIN_US"
        if low > high:
            self.error(("core", key), f"T15_MIN_US {low} is above T35_MIN_US {high}; t1.5 is the shorter one")
        elif high > 100_000:
            self.error(("core", "T35_MIN_US"), f"T35_MIN_US {high} is out of range; 0 to 100000")
        clock = dict(device.core).get("CLK_HZ")
        if clock and not device.line.run_time:
            bit = (clock + device.line.baud // 2) // device.line.baud
            place = ("line", "baud") if ("line", "baud") in self.source.values else ("core", "CLK_HZ")
            if not 8 <= bit <= 65535:
                text = f"{clock} Hz and {device.line.baud} baud are {bit} clocks a bit; 8 to 65535 are possible"
                self.error(place, text)
            elif abs(clock - bit * device.line.baud) > clock // 50:
                text = f"{clock} Hz misses {device.line.baud} baud by more than 2 %; take a multiple of it"
                self.error(place, text)

    def functions(self, device: Device, given: Any) -> tuple[int, ...]:
        """The function codes that are built in."""
        needed = _needed(device)
        if given == "auto":
            return tuple(sorted(needed))
        codes = set(given)
        for index, code in enumerate(given):
            if lacks := _lacking_table(device, code):
                text = f"function code {code:02X}H needs {lacks}, and there is none; leave it out, or write one"
                self.error(("functions", index), text)
        for table, points in device.tables():
            if table in self.bad_points:
                continue
            readers = {READ_FUNCTION[table]} | ({0x17} if table == "holding_registers" else set())
            writers = set(WRITE_FUNCTIONS.get(table, ()))
            reads = [point.name for point in points if point.readable]
            writes = [point.name for point in points if point.writable]
            if reads and not readers & codes:
                text = f"no function code reads {table} ({reads[0]}); add {READ_FUNCTION[table]}"
                self.error(("functions",), text)
            if writes and not writers & codes:
                options = " or ".join(str(code) for code in WRITE_FUNCTIONS[table][:2])
                self.error(
                    ("functions",), f"no function code writes {table} ({writes[0]}); add {options}, or access: ro"
                )
            wide = [point.name for point in points if point.writable and point.width > 1]
            if table == "holding_registers" and wide and writers & codes and not {0x10, 0x17} & codes:
                text = f"{wide[0]} has several registers, and no function code writes them in one request; add 16"
                self.warn(("functions",), text)
        extra = {0x14: "files", 0x15: "files", 0x18: "fifos", 0x2B: "the texts of identity", 0x11: "server_id"}
        for code in sorted(needed - codes):
            if code in extra and not (code == 0x15 and all(file.access == "ro" for file in device.files)):
                self.warn(("functions",), f"{extra[code]} cannot be reached without function code {code}; add it")
        if device.freeze_coils() and not {0x05, 0x0F} & codes:
            self.error(("functions",), "no function code writes the coil of freeze; add 5")
        return tuple(sorted(codes))


# ------------------------------------------------------------------ helpers

_EXAMPLES = {"device": "relay_box", "at": "0", "name": "relay", "number": "1", "points": "[...]", "gaps": "zero"}


def _example(model: type[BaseModel]) -> str:
    needed = [name for name, field in model.model_fields.items() if field.is_required()]
    return ", ".join(f"{name}: {_EXAMPLES.get(name, '...')}" for name in needed)


def _inner(model: Any, step: Any) -> Any:
    field = model.model_fields.get(step)
    inner = field.annotation if field else None
    return inner if isinstance(inner, type) and issubclass(inner, BaseModel) else model


def _indefinite(text: str) -> str:
    return text if text.startswith(("a ", "nothing")) else f"the text {text}"


def _span(point: Point) -> str:
    return str(point.at) if point.size == 1 else f"{point.at} to {point.last}"


def _needed(device: Device) -> set[int]:
    """The function codes without which part of the map cannot be reached."""
    codes: set[int] = set()
    for table, points in device.tables():
        if any(point.readable for point in points):
            codes.add(READ_FUNCTION[table])
        if any(point.writable for point in points):
            codes |= set(WRITE_FUNCTIONS[table][:2])
    if any(point.fifo for point in device.points):
        codes.add(0x18)
    if device.files:
        codes.add(0x14)
        if any(file.access == "rw" for file in device.files):
            codes.add(0x15)
    if device.identity.has_objects:
        codes.add(0x2B)
    if device.identity.server_id or device.identity.additional_data:
        codes.add(0x11)
    return codes


def _lacking_table(device: Device, code: int) -> str:
    """The table that a function code needs and that is not there, or nothing."""
    needs = {
        "coils": (0x01, 0x05, 0x0F),
        "discrete_inputs": (0x02,),
        "input_registers": (0x04,),
        "holding_registers": (0x03, 0x06, 0x10, 0x16, 0x17),
    }
    for table, codes in needs.items():
        if code in codes:
            return "" if device.table(table) or table in device.zero_gaps else table
    if code in (0x14, 0x15):
        return "" if device.files else "files"
    if code == 0x18:
        return "" if any(point.fifo for point in device.points) else "fifos"
    return ""
