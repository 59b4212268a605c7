# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""INIT of the live device of a map: values by name, as the map writes them, for its host port.

{"temperature": 21.5, "state": "running", "status_word": {"ready": 1}, "digital_in": [1, 0, 1, 1],
 "curve": {"10": [3, 4]}, "queue": [7, 8], "log": {"0": [1, 2]}}
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from modbus_map.diagnostics import MapError, nearest
from modbus_map.file_model import shown
from modbus_map.judge import Judge
from modbus_map.loader import Path_, Source
from modbus_map.model import SPACES, Device, File, Point
from modbus_map.outputs.live import INPUTS_SPACE, WORD, input_words
from modbus_map.rtl_plan import FILES_SPACE, Plan

Word = tuple[int, int, int]  # space, item, value
RECORD = Point("holding_registers", 0, "record", "u16", 1)


def initial(device: Device, source: Source) -> list[Word]:
    """What the host port is given before the line is served. Raises MapError."""
    values = _Values(device, source)
    words = values.run()
    if values.notes:
        raise MapError(values.notes)
    return words


class _Values(Judge):
    def __init__(self, device: Device, source: Source) -> None:
        super().__init__(source)
        self.device = device
        self.files_at = {area.name: area.host_at for area in Plan(device).areas if area.space == FILES_SPACE}

    def run(self) -> list[Word]:
        tree = self.source.tree
        if not isinstance(tree, dict):
            self.error((), 'INIT is a JSON object of values by name; write {"NAME": VALUE}')
            return []
        points = {point.name: point for point in self.device.points}
        files = {file.name: file for file in self.device.files}
        known = [p.name for p in self.device.points if p.kind in ("wire", "memory")] + list(files)
        words: list[Word] = []
        for name, given in tree.items():
            if name in files:
                words += self.file(files[name], given, (name,))
            elif name not in points:
                self.error((name,), f"the device has no {shown(name)}; {nearest(str(name), known)}", key=True)
            elif points[name].kind == "register":
                text = f"{name} is written by the master and begins with its reset value; change `reset` in the map"
                self.error((name,), text, key=True)
            elif points[name].kind == "constant":
                self.error((name,), f"{name} is a constant; change `reset` in the map", key=True)
            else:
                words += self.point(points[name], given)
        return words

    def point(self, point: Point, given: Any) -> Iterator[Word]:
        """The words of an input or of a point in memory."""
        if point.fifo:
            raws = self.queue(point, given)
        else:
            raws = dict(self.items(point, given, point.count, (point.name,), point.is_array))
        if point.kind == "memory":
            for item, raw in raws.items():
                for address, value in zip(point.addresses(item), point.registers(raw)):
                    yield SPACES[point.table], address, value
            return
        vector = sum(raw << point.bits * item for item, raw in raws.items())
        for place, item in enumerate(input_words(self.device)[point.name]):
            yield INPUTS_SPACE, item, vector >> WORD * place & 0xFFFF

    def file(self, file: File, given: Any, path: Path_) -> Iterator[Word]:
        """The records of a file."""
        for record, raw in self.items(RECORD, given, file.records, path, True, exact=False):
            yield FILES_SPACE, self.files_at[file.name] + record, raw

    def queue(self, point: Point, given: Any) -> dict[int, int]:
        """A FIFO: its count, then its entries."""
        if not isinstance(given, list) or len(given) >= point.count:
            self.error((point.name,), f"{point.name} takes a list of at most {point.count - 1} entries")
            return {}
        entries = self.items(point, given, len(given), (point.name,), True)
        return {0: len(given)} | {item + 1: raw for item, raw in entries}

    def items(
        self, point: Point, given: Any, count: int, path: Path_, array: bool, exact: bool = True
    ) -> Iterator[tuple[int, int]]:
        """(item, raw) of a value, of a list, or of {"first item": list or value}."""
        if not array:
            yield from self.item(0, given, point, path)
        elif isinstance(given, dict):
            for first, run in given.items():
                here = (*path, first)
                if not (isinstance(first, int) or str(first).isdecimal()):
                    self.error(here, f"{shown(first)} is no item; {path[0]} has items 0 to {count - 1}", key=True)
                    continue
                run_list = run if isinstance(run, list) else [run]
                if not 0 <= int(first) <= int(first) + len(run_list) <= count:
                    text = f"item {int(first) + len(run_list) - 1} does not exist; {path[0]} has items 0 to {count - 1}"
                    self.error(here, text, key=True)
                    continue
                for place, value in enumerate(run_list):
                    inner = (*here, place) if isinstance(run, list) else here
                    yield from self.item(int(first) + place, value, point, inner)
        elif isinstance(given, list):
            if len(given) > count or (exact and len(given) != count):
                many = f"{len(given)} values for {count} items"
                self.error(path, f'{many}; write one for each, or {{"FIRST ITEM": [VALUES]}}')
                return
            for place, value in enumerate(given):
                yield from self.item(place, value, point, (*path, place))
        else:
            self.error(path, f'{path[0]} has {count} items; write a list, or {{"FIRST ITEM": [VALUES]}}')

    def item(self, item: int, given: Any, point: Point, path: Path_) -> Iterator[tuple[int, int]]:
        """(item, raw), or nothing after an error."""
        if isinstance(given, dict) and point.fields:
            raw = self.bit_fields(given, point, path)
        elif (
            given is None or isinstance(given, (dict, list)) or (isinstance(given, float) and not math.isfinite(given))
        ):
            self.error(path, f"{shown(given)} is no value of {path[0]}; write one {point.type}")
            raw = None
        else:
            raw = self.raw(given, point, path, str(path[0]))
        if raw is not None:
            yield item, raw

    def bit_fields(self, given: dict[Any, Any], point: Point, path: Path_) -> int | None:
        """A register of named fields; those that are not named are 0."""
        fields = {field.name: field for field in point.fields}
        raw = 0
        for name, value in given.items():
            here = (*path, name)
            if name not in fields:
                self.error(here, f"{point.name} has no field {shown(name)}; {nearest(str(name), fields)}", key=True)
                continue
            field = fields[name]
            if not isinstance(value, int) or not 0 <= value < 1 << field.width:
                self.error(here, f"{name} {shown(value)} is no number from 0 to {(1 << field.width) - 1}")
                continue
            raw |= int(value) << field.low
        return raw
