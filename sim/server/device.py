# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The live device as the control interface sees it: every operation, and the events that go to clients."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from typing import Any

from protocol.words_special import messages, register

from . import points as maps
from .errors import Refused, Unknown
from .explain import Frames, shown
from .operations import OPERATIONS
from .values import Signal

SPACES = {"coils": 0, "discretes": 1, "inputs": 2, "holdings": 3, "files": 4}
NAMES = {space: name for name, space in SPACES.items()}
BIT_TABLES = ("coils", "discretes")
FORMATS = ("8E1", "8O1", "8N2", "8N1")
STATE = ("exception_status", "busy", "failure", "run_indicator", "write_lock", "diagnostic")
STATE_OF = {"pdm": ("busy",)}  # device: the inputs that it has for these, if not all; one of a map has none
BLOCK = 2048  # items of one read
TICK_S = 0.05  # of the values that move
MOST_SIGNALS = 500
MOST_SENT = 600  # bytes of one burst; the longest frame of ASCII mode has 513
FUNCTION_TABLES = {
    1: "coils",
    2: "discretes",
    3: "holdings",
    4: "inputs",
    5: "coils",
    6: "holdings",
    15: "coils",
    16: "holdings",
    22: "holdings",
}

METHODS = {
    "set": "set_state",
    "device": "describe",
    "frames": "recent",
    "points": "all_points",
    "signals": "list_signals",
}
READS = (1, 2, 3, 4)


class Device:
    """Operations over a link to the bridge; `link` is a BridgeLink."""

    def __init__(self, link: Any, facts: dict[str, Any]) -> None:
        self.link, self.facts = link, facts
        self.told = link.events()  # from the first one on
        self.hello = link.hello
        self.slaves = facts.get("slaves") or [facts["address"]]
        self.tables = {name: tuple(facts["tables"][name]) for name in SPACES if name in facts["tables"]}
        self.files = tuple(facts.get("files") or (0, 1))
        self.points = maps.of_map(facts.get("map"))
        self.inputs = () if self.points else STATE_OF.get(facts.get("device"), STATE)
        present = f"this one is {self.slaves[0]}" if len(self.slaves) == 1 else f"there are {self.addresses()}"
        self.ascii = self.hello.get("mode") == "ascii"
        data_bits = self.hello.get("data_bits", 8)
        self.format = FORMATS[self.hello["format"] & 3].replace("8", str(data_bits))
        self.bits = 1 + data_bits + (self.format[1] != "N") + int(self.format[2])  # of a character
        self.frames = Frames(present, self.point_names if self.points else None)
        self.frames.ascii = self.ascii
        self.frames.character = self.bits * self.hello["bit_time"]
        self.listeners: list[Callable[[dict[str, Any]], None]] = []
        self.signals: dict[str, Signal] = {}
        self.sent: dict[str, Any] = {}  # what a signal wrote last
        self.failed: dict[str, str] = {}  # signals that the device refuses
        self.script: Any = None

    def addresses(self) -> str:
        """All slaves, for people."""
        return ", ".join(map(str, self.slaves))

    # ------------------------------------------------------------------ events

    def tell(self, event: dict[str, Any]) -> None:
        """An event to everybody who listens."""
        for listener in self.listeners:
            listener(event)

    async def listen(self) -> None:
        """Events of the bridge, until it is gone."""
        async for event in self.told:
            try:
                if said := self.frames.take(event):
                    self.tell(said)
                elif event["event"] == "write":
                    await self.written(event)
                elif event["event"] in ("client", "warning", "dropped"):
                    self.tell(event)
            except (Refused, KeyError, ValueError) as error:  # an event that does not fit ends nothing
                self.tell({"event": "warning", "text": f"event of the bridge: {error}", "time": time.time()})

    async def written(self, event: dict[str, Any]) -> None:
        """A write by the master, with the values that are there now."""
        asked = self.frames.request(event.get("to", 0))
        table = NAMES.get(event["space"], str(event["space"]))
        first, count = event["first"], event["last"] - event["first"] + 1
        if table == "files" and event.get("file"):
            first += (event["file"] - 1) * self.files[1]
        said = {
            "event": "write",
            "slave": event["slave"],
            "table": table,
            "first": first,
            "time": event["time"],
            "to": asked.n if asked else 0,
        }
        if self.points:
            covered = [
                p
                for p in self.points.values()
                if p.table == table and p.first <= event["last"] and first < p.first + p.size
            ]
            said["values"] = asked_values(asked.data if asked else b"", count)
            said["points"] = {p.name: (await self.point(p.name))["text"] for p in covered}
        else:
            said["values"] = (await self.read(table, first, count, event["slave"]))["values"]
        self.tell(said)
        if self.script:
            self.script.written(table, first, said["values"])

    def point_names(self, asked: bytes, answered: bytes | None) -> list[str]:
        """The points in a request, and with their values those in an answer that reads."""
        table = FUNCTION_TABLES.get(asked[1]) if len(asked) >= 8 else None
        if not table:
            return []
        first = int.from_bytes(asked[2:4], "big")
        count = int.from_bytes(asked[4:6], "big") if asked[1] in (*READS, 15, 16) else 1
        found = [p for p in self.points.values() if p.table == table and p.first < first + count]
        found = [p for p in found if first < p.first + p.size]
        if answered is None:
            return [p.name for p in found]
        if asked[1] not in READS or len(answered) < 6 or answered[1] != asked[1]:
            return []
        items = items_of(answered, table, count)
        whole = [p for p in found if first <= p.first and p.first + p.size <= first + len(items)]
        return [f"{p.name} {p.text(p.of_line(items[p.first - first :][: p.size]))}" for p in whole]

    # ------------------------------------------------------------------ calls

    async def call(self, name: Any, given: dict[str, Any]) -> Any:
        """An operation by name, with arguments as JSON has them.  Refused if anything is wrong."""
        if not isinstance(name, str) or name not in OPERATIONS:
            raise Unknown(f"op: no such operation; there are {', '.join(OPERATIONS)}")
        method = getattr(self, METHODS.get(name, name))
        return await method(**OPERATIONS[name].checked(given))

    async def ask(self, *words: Any) -> dict[str, Any]:
        """A command of the bridge; Refused with what it says."""
        try:
            return await self.link.call(*words)
        except Exception as error:
            if type(error).__name__ not in ("BridgeError", "BridgeGone", "ConnectionError"):
                raise
            raise Refused(str(error)) from None

    def slave(self, given: int | None) -> int:
        """The address of a slave on the line."""
        if given is None:
            return self.slaves[0]
        if given not in self.slaves:
            raise Unknown(f"slave {given}: there are {self.addresses()}")
        return given

    def place(self, table: str, first: int, count: int) -> int:
        """The host port's space of a table; Refused outside it."""
        if table not in SPACES:
            raise Unknown(f"table {table}: must be {', '.join(SPACES)}")
        if self.points:
            raise Refused("this device has a map: its values are points, by name")
        base, size = (0, self.files[0] * self.files[1]) if table == "files" else self.tables.get(table, (0, 0))
        if not size:
            raise Unknown(f"table {table}: the device has none")
        if first < base or count < 1 or first + count > base + size:
            raise Refused(f"{table} {first} to {first + count - 1}: there are {base} to {base + size - 1}")
        return SPACES[table]

    async def describe(self) -> dict[str, Any]:
        """What the device is."""
        hello = self.hello
        name = (self.facts.get("map") or {}).get("title") or (self.facts.get("map") or {}).get("device")
        return {
            "name": name or f"modbus_rtu_slave ({self.facts.get('device', 'standard')})",
            "device": self.facts.get("device", "standard"),
            "link": self.facts.get("link", ""),
            "address": self.facts["address"],
            "slaves": self.slaves,
            "baud": self.facts["baud"],
            "format": self.format,
            "mode": "ascii" if self.ascii else "rtu",
            "clock_hz": hello["clock_hz"],
            "bit_time": hello["bit_time"],
            "t15": hello["t15"],
            "t35": hello["t35"],
            "tables": {} if self.points else self.tables,
            "files": [0, 1] if self.points else self.files,
            "points": [point.facts() for point in self.points.values()],
            "features": {"send": True, "line": False, "signals": True, "capture": True, "state": list(self.inputs)},
        }

    async def read(self, table: str, first: int, count: int = 1, slave: int | None = None) -> dict[str, Any]:
        """Values of a table."""
        space = self.place(table, first, count)
        got = await self.ask("read", self.slave(slave), space, first, count)
        return {"values": got["values"]}

    async def write(
        self, table: str, first: int, values: list[int], slave: int | None = None, quiet: bool = False
    ) -> dict[str, Any]:
        """Values to a table; `quiet`: no event tells of it, a panel sees it when it looks."""
        space = self.place(table, first, len(values))
        most = 1 if table in BIT_TABLES else 65535
        for value in values:
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= most:
                raise Refused(f"values: must be numbers from 0 to {most}")
        address = self.slave(slave)
        await self.ask("write", address, space, first, *values)
        if not quiet:
            self.tell({"event": "changed", "slave": address, "table": table, "first": first, "values": values})
        return {"written": len(values)}

    # ------------------------------------------------------------------ points of a map, and addresses by name

    def address(self, name: str) -> tuple[str, int] | None:
        """(table, address) of "inputs 0" or "inputs:0"; None for a name of the map."""
        table, _, text = name.strip().replace(":", " ").partition(" ")
        if table not in SPACES or not text.strip().isdecimal():
            return None
        return table, int(text)

    async def point(self, name: str) -> dict[str, Any]:
        """The value of a point."""
        if name not in self.points and (at := self.address(name)):
            value = (await self.read(*at, 1))["values"][0]
            return {"name": name, "value": value, "text": str(value)}
        point = maps.named(self.points, name)
        if point.host is None:
            values = [point.value(self.reset(point, number)) for number in point.resets]
            value = values if point.count > 1 else values[0]
        else:
            space, item, words = point.host
            value = point.values((await self.ask("read", self.slaves[0], space, item, words))["values"])
        return {"name": name, "value": value, "text": point.text(value)}

    def reset(self, point: maps.Point, number: Any) -> int:
        """The bit pattern of a constant, which the map gives as a number of its type."""
        if isinstance(number, str) and not point.type.startswith("string"):
            number = float(number)
        plain = maps.Point(**{**vars(point), "scale": None, "enum": {}, "fields": {}})
        return plain.raw(number)

    async def points_of_blocks(self) -> dict[str, list[int]]:
        """The words of every point of the host port, read in blocks."""
        found: dict[str, list[int]] = {}
        blocks: list[list[maps.Point]] = []
        for point in sorted((p for p in self.points.values() if p.host), key=lambda p: p.host):
            space, item, words = point.host
            last = blocks[-1] if blocks else None
            if (
                last
                and last[0].host[0] == space
                and last[-1].host[1] + last[-1].host[2] == item
                and item + words - last[0].host[1] <= BLOCK
            ):
                last.append(point)
            else:
                blocks.append([point])
        for block in blocks:
            space, first, _ = block[0].host
            count = block[-1].host[1] + block[-1].host[2] - first
            values = (await self.ask("read", self.slaves[0], space, first, count))["values"]
            for point in block:
                at = point.host[1] - first
                found[point.name] = values[at : at + point.host[2]]
        return found

    async def all_points(self) -> dict[str, Any]:
        """The values of all points."""
        found, words = {}, await self.points_of_blocks()
        for name, point in self.points.items():
            if name in words:
                value = point.values(words[name])
                found[name] = {"value": value, "text": point.text(value)}
            else:
                found[name] = await self.point(name)
        return {"points": found}

    async def write_point(self, name: str, value: Any, quiet: bool = False) -> dict[str, Any]:
        """Give a point a value."""
        if name not in self.points and (at := self.address(name)):
            number = maps.Point(name, at[0], at[1], 1, "u16", 1, "rw", "memory", ()).as_number(value)
            return await self.write(at[0], at[1], [round(number)], quiet=quiet)
        point = maps.named(self.points, name)
        words = point.words_of(value)
        space, item, _ = point.host
        await self.ask("write", self.slaves[0], space, item, *words)
        if not quiet:
            place = {"slave": self.slaves[0], "table": point.table, "first": point.first}
            self.tell({"event": "changed", **place, "values": [], "points": [name]})
        return {"written": 1}

    # ------------------------------------------------------------------ state, counters, frames

    async def state(self, slave: int | None = None) -> dict[str, Any]:
        """Exception status, busy and the others."""
        got = await self.ask("get", self.slave(slave))
        absent = {"id", *STATE}.difference(self.inputs)
        return {name: value for name, value in got.items() if name not in absent}

    async def set_state(self, slave: int | None = None, **changes: int) -> dict[str, Any]:
        """Change some of them."""
        there = f"there are {', '.join(self.inputs)}" if self.inputs else "this device has no inputs for its state"
        if not changes:
            raise Refused(f"nothing to change; {there}")
        for name in changes:
            if name not in self.inputs:
                raise Refused(f"{name}: {there}")
        address = self.slave(slave)
        for name, value in changes.items():
            await self.ask("set", address, name, value)
        return await self.state(slave)

    async def status(self, slave: int | None = None) -> dict[str, Any]:
        """Counters, event log, line errors."""
        address = self.slave(slave)
        got = await self.ask("status", address)
        stats = await self.ask("stats")
        counters = dict(got.get("counters") or {})
        value = counters.pop("register", 0)
        log = got.get("log") or []
        return {
            "counters": counters or None,
            "register": value,
            "register_words": register(value),
            "listen_only": got.get("listen_only", 0),
            "log": log,
            "story": messages(log),
            "errors": got.get("errors", {}),
            "stats": {name: value for name, value in stats.items() if name != "id"},
        }

    async def recent(self, after: int = 0, limit: int = 200) -> dict[str, Any]:
        """Recent frames."""
        found = [frame.row() for frame in self.frames.kept if frame.n > after]
        return {"frames": found[-limit:]}

    async def pins(self, n: int) -> dict[str, Any]:
        """The pins of a frame, and of its request or answer."""
        frame = self.frames.get(n)
        if frame is None:
            raise Unknown(f"frame {n}: not kept")
        request = self.frames.get(frame.to) if frame.to else frame
        if request is None:
            raise Unknown(f"frame {n}: its request is no longer kept")
        answer = self.frames.get(request.answer) if request.answer else None
        edges, characters = [], []
        for part, pin in ((request, "rxd"), (answer, "txd")):
            if part is None:
                continue
            edges += [[part.cycle + part.edges[i], part.edges[i + 1]] for i in range(0, len(part.edges) - 1, 2)]
            wrong: dict[int, list[str]] = {}
            for index, what in part.errors:
                wrong.setdefault(index, []).append(what)
            characters += [
                {"pin": pin, "start": part.cycle + start, "data": data, "errors": wrong.get(i, [])}
                for i, (start, data) in enumerate(zip(part.starts, part.line))
            ]
        edges.sort(key=lambda edge: edge[0])
        return {
            "n": request.n,
            "edges": edges,
            "start": request.cycle,
            "end": request.end,
            "characters": characters,
            "clock_hz": self.hello["clock_hz"],
            "bit_time": self.hello["bit_time"],
            "length": self.bits,
            "mode": "ascii" if self.ascii else "rtu",
            "format": self.format,
            "t15": self.hello["t15"],
            "t35": self.hello["t35"],
        }

    # ------------------------------------------------------------------ faults and requests

    async def faults(self) -> dict[str, Any]:
        """What is set."""
        found = []
        for row in (await self.ask("faults"))["faults"]:
            fault = {name: int(v) if isinstance(v, float) and v.is_integer() else v for name, v in row.items()}
            if fault.get("count") and fault.get("done", 0) >= fault["count"]:
                continue  # it has happened
            if fault.get("every") == fault.get("count") == 1:
                del fault["every"], fault["count"]  # the next frame, once
            found.append({name: v for name, v in fault.items() if v or name not in ("every", "count", "probability")})
        return {"faults": found}

    async def fault(self, kind: str, direction: str = "request", **arguments: Any) -> dict[str, Any]:
        """Break the line."""
        words = []
        for name, value in arguments.items():
            if (
                not name.isidentifier()
                or isinstance(value, bool)
                or not isinstance(value, (int, float))
                or value != value
            ):
                raise Refused(f"{name[:40]}: must be a number")
            words.append(f"{name}={value}")
        if not kind.replace("_", "").isalnum() or not kind.isascii():
            raise Refused(f"kind: {kind[:20]!r} is none")
        return {"fault": (await self.ask("fault", direction, kind, *words))["fault"]}

    async def unfault(self, fault: str) -> dict[str, Any]:
        """Remove one, or all."""
        if fault != "all" and not fault.isdecimal():
            raise Refused("fault: must be a number, or all")
        return {"removed": (await self.ask("unfault", fault))["removed"]}

    async def send(self, hex: str, timeout_ms: int | None = None) -> dict[str, Any]:
        """A request of our own."""
        try:
            data = bytes.fromhex(hex)
        except ValueError:
            raise Refused("hex: must be bytes in hexadecimal") from None
        if not 1 <= len(data) <= MOST_SENT:
            raise Refused(f"hex: must be 1 to {MOST_SENT} bytes")
        got = await self.ask("send", data.hex(), *([timeout_ms] if timeout_ms else []))
        return {"answer": shown(bytes.fromhex(got["answer"]), self.ascii), "verdict": got.get("verdict", "")}

    # ------------------------------------------------------------------ values that move

    async def attach(self, point: str, kind: str, **arguments: Any) -> dict[str, Any]:
        """A signal for a point, instead of the one it has."""
        if point not in self.signals and len(self.signals) >= MOST_SIGNALS:
            raise Refused(f"point: there are {MOST_SIGNALS} signals already")
        signal = Signal(kind, arguments, time.monotonic())
        await self.write_point(point, self.fitting(point, signal.at(signal.begin)))
        self.signals[point] = signal
        self.failed.pop(point, None)
        self.sent.pop(point, None)
        return {"attached": point}

    async def detach(self, point: str) -> dict[str, Any]:
        """Take a signal away; the point keeps its value."""
        if point not in self.signals:
            raise Unknown(f"point {point[:60]!r} has no signal")
        del self.signals[point]
        return {"detached": point}

    async def list_signals(self) -> dict[str, Any]:
        """What moves."""
        rows = []
        for name, signal in self.signals.items():
            text = signal.text() + (f": {self.failed[name]}" if name in self.failed else "")
            rows.append({"point": name, "kind": signal.kind, **signal.arguments, "text": text})
        return {"signals": rows, "script": self.script.state() if self.script else None}

    def fitting(self, name: str, value: float) -> Any:
        """The value as the point takes it: whole for a table, the nearer of two for a bit."""
        point = self.points.get(name)
        at = None if point else self.address(name)
        if (point and point.table in BIT_TABLES) or (at and at[0] in BIT_TABLES):
            return int(value >= 0.5)
        if at:
            return round(value) & 0xFFFF if -32768 <= round(value) < 0 else round(value)
        return [value] * point.count if point and point.count > 1 else value

    async def move(self) -> None:
        """For ever: the signals' values to the device when they differ."""
        while True:
            now = time.monotonic()
            for name, signal in list(self.signals.items()):
                value = self.fitting(name, signal.at(now))
                if value == self.sent.get(name):
                    continue
                self.sent[name] = value
                try:
                    await self.write_point(name, value, quiet=True)
                    self.failed.pop(name, None)
                except Refused as error:
                    self.failed[name] = str(error)
            await asyncio.sleep(max(TICK_S - (time.monotonic() - now), 0.01))


def asked_values(data: bytes, count: int) -> list[int]:
    """What a request wrote, as far as it says: a map's registers have no place in a table."""
    if len(data) < 8:
        return []
    if data[1] in (5, 6):
        value = int.from_bytes(data[4:6], "big")
        return [int(value > 0)] if data[1] == 5 else [value]
    body = data[7:-2] if data[1] in (15, 16) else data[11:-2] if data[1] == 23 else b""
    if data[1] == 15:
        return [body[i >> 3] >> (i & 7) & 1 for i in range(min(count, 8 * len(body)))]
    return [int.from_bytes(body[i : i + 2], "big") for i in range(0, min(2 * count, len(body)), 2)]


def items_of(answer: bytes, table: str, count: int) -> list[int]:
    """The bits or registers in the answer of a read."""
    body = answer[3:-2]
    if table in BIT_TABLES:
        return [body[i >> 3] >> (i & 7) & 1 for i in range(min(count, 8 * len(body)))]
    return [int.from_bytes(body[i : i + 2], "big") for i in range(0, len(body) - 1, 2)]
