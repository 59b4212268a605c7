# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The operations of the control interface, each once: name, HTTP method and path, arguments with their limits.

web.py routes by this table, checks arguments by it, and /openapi.json is made of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import faults

from .errors import Refused

REQUIRED = object()
TABLES = ("coils", "discretes", "inputs", "holdings", "files")
WORD = (0, 65535)
MOST_VALUES = 2048  # of one read or write


@dataclass(frozen=True)
class Argument:
    """An argument: JSON type, limits, meaning; where HTTP has it: path, query or body."""

    kind: str  # integer number string words value object
    doc: str
    default: Any = REQUIRED
    least: float = 0
    most: float = 65535
    choices: tuple[str, ...] = ()
    place: str = "body"

    def check(self, name: str, value: Any) -> Any:
        """The value, or Refused with what it must be."""
        if self.kind == "integer":
            return self.whole(name, value)
        if self.kind == "number":
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not self.least <= value <= self.most:
                raise Refused(f"{name}: must be a number from {self.least:g} to {self.most:g}")
        elif self.kind == "string":
            if not isinstance(value, str) or (self.choices and value not in self.choices):
                raise Refused(f"{name}: must be {', '.join(self.choices) if self.choices else 'a text'}")
            if len(value) > self.most:
                raise Refused(f"{name}: more than {self.most:g} characters")
        elif self.kind == "words":
            if not isinstance(value, list) or not 1 <= len(value) <= MOST_VALUES:
                raise Refused(f"{name}: must be a list of 1 to {MOST_VALUES} numbers")
            for one in value:
                self.whole(name, one)
        return value

    def whole(self, name: str, value: Any) -> int:
        """A whole number within the limits; HTTP writes it as text in path and query."""
        if isinstance(value, str) and self.place != "body" and value.isdecimal() and len(value) < 16:
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or not self.least <= value <= self.most:
            raise Refused(f"{name}: must be a whole number from {self.least:g} to {self.most:g}")
        return value

    def schema(self) -> dict[str, Any]:
        """As JSON Schema."""
        limits = {"minimum": self.least, "maximum": self.most}
        found: dict[str, Any] = {
            "integer": {"type": "integer", **limits},
            "number": {"type": "number", **limits},
            "string": {"type": "string", **({"enum": list(self.choices)} if self.choices else {})},
            "words": {"type": "array", "maxItems": MOST_VALUES, "minItems": 1, "items": {"type": "integer", **limits}},
            "value": {},
        }[self.kind]
        return {
            **found,
            "description": self.doc,
            **({} if self.default in (REQUIRED, None) else {"default": self.default}),
        }


@dataclass(frozen=True)
class Operation:
    """What can be asked."""

    name: str
    method: str
    path: str
    doc: str
    arguments: dict[str, Argument] = field(default_factory=dict)
    more: bool = False  # other arguments are allowed and checked by what they are for

    def checked(self, given: Any) -> dict[str, Any]:
        """All arguments.  Refused with the name of the one that is wrong."""
        if not isinstance(given, dict):
            raise Refused("must be a JSON object")
        for name in given:
            if name not in self.arguments and not self.more:
                known = ", ".join(self.arguments) or "nothing"
                raise Refused(f"{name[:40]}: unknown; {self.name} takes {known}")
        found = dict(given)
        for name, argument in self.arguments.items():
            if name in given:
                found[name] = argument.check(name, given[name])
            elif argument.default is REQUIRED:
                raise Refused(f"{name}: is missing; {argument.doc}")
            elif argument.default is not None:
                found[name] = argument.default
        return found


def path(kind: str, doc: str, **limits: Any) -> Argument:
    """An argument of the path."""
    return Argument(kind, doc, place="path", **limits)


def query(kind: str, doc: str, default: Any = REQUIRED, **limits: Any) -> Argument:
    """An argument of the query."""
    return Argument(kind, doc, default, place="query", **limits)


SLAVE = query("integer", "address of the slave; without it the first one", None, least=1, most=247)
TABLE = path("string", "table", choices=TABLES, most=20)
POINT = path("string", "a point's name, or table and address: inputs 0", most=200)

OPERATIONS = {
    op.name: op
    for op in (
        Operation("device", "GET", "/api/device", "What the device is: line, tables, points of its map"),
        Operation(
            "read",
            "GET",
            "/api/tables/{table}",
            "Values of a table, all of one moment",
            {
                "table": TABLE,
                "first": query("integer", "first address", 0),
                "count": query("integer", "how many", 1, least=1, most=MOST_VALUES),
                "slave": SLAVE,
            },
        ),
        Operation(
            "write",
            "PUT",
            "/api/tables/{table}/{first}",
            "Write values to a table; no request of the master comes between",
            {
                "table": TABLE,
                "first": path("integer", "first address"),
                "values": Argument("words", "the values; 0 or 1 in tables of bits"),
                "slave": SLAVE,
            },
        ),
        Operation("points", "GET", "/api/points", "The values of all points of the map"),
        Operation("point", "GET", "/api/points/{name}", "The value of a point", {"name": POINT}),
        Operation(
            "write_point",
            "PUT",
            "/api/points/{name}",
            "Give a point a value, as the map has it: scaled, a name of its enum, fields",
            {"name": POINT, "value": Argument("value", "number, text, list or fields")},
        ),
        Operation(
            "state",
            "GET",
            "/api/state",
            "Exception status, busy, failure, run indicator, write lock, listen-only",
            {"slave": SLAVE},
        ),
        Operation(
            "set",
            "PATCH",
            "/api/state",
            "Change some of the state",
            {
                "exception_status": Argument("integer", "what function 07 answers", None, most=255),
                "busy": Argument("integer", "1: accesses answer exception 06", None, most=1),
                "failure": Argument("integer", "exception code that accesses answer, 0: none", None, most=15),
                "run_indicator": Argument("integer", "of function 11", None, most=1),
                "write_lock": Argument("integer", "1: writes by the master answer exception 04", None, most=1),
                "diagnostic": Argument("integer", "bits of the diagnostic register to set now", None, most=65534),
                "slave": SLAVE,
            },
        ),
        Operation(
            "status", "GET", "/api/status", "Counters, diagnostic register, event log, line errors", {"slave": SLAVE}
        ),
        Operation(
            "frames",
            "GET",
            "/api/frames",
            "Recent frames, oldest first",
            {
                "after": query("integer", "only frames with a larger number", 0, most=1 << 53),
                "limit": query("integer", "at most so many, the newest", 200, least=1, most=2000),
            },
        ),
        Operation(
            "pins",
            "GET",
            "/api/frames/{n}/pins",
            "The pins of a recent frame and of what belongs to it: [cycle, rxd*4 + txd*2 + de], and the characters",
            {"n": path("integer", "number of the frame", most=1 << 53)},
        ),
        Operation("faults", "GET", "/api/faults", "Faults that are set"),
        Operation(
            "fault",
            "POST",
            "/api/faults",
            "Break the line: `kind` with its arguments, see sim/README.md",
            {
                "kind": Argument("string", "what to break", most=20),
                "direction": Argument("string", "which way", "request", choices=("request", "answer")),
                **{
                    name: Argument("integer" if whole else "number", meaning, None, least=least, most=most)
                    for name, (_, least, most, meaning, whole) in faults.WHEN.items()
                },
            },
            more=True,
        ),
        Operation(
            "unfault",
            "DELETE",
            "/api/faults/{fault}",
            "Remove a fault",
            {"fault": path("string", "its number, or all", most=10)},
        ),
        Operation(
            "send",
            "POST",
            "/api/send",
            "A burst of a client of its own on the line; the answer, empty for silence",
            {
                "hex": Argument("string", "bytes, CRC included", most=2000),
                "timeout_ms": Argument("integer", "how long to wait", None, least=1, most=60_000),
            },
        ),
        Operation("signals", "GET", "/api/signals", "Values that move, and the script"),
        Operation(
            "attach",
            "POST",
            "/api/signals",
            "Attach a signal to a point: constant, ramp, sine, square, walk, counter, csv",
            {
                "point": Argument("string", "a point's name, or table and address: inputs 0", most=200),
                "kind": Argument("string", "which", most=20),
            },
            more=True,
        ),
        Operation("detach", "DELETE", "/api/signals/{point}", "Take a signal away", {"point": POINT}),
    )
}


def openapi(version: str) -> dict[str, Any]:
    """The OpenAPI document."""
    refused = {
        "description": "what is wrong",
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Error"}}},
    }
    paths: dict[str, Any] = {}
    for op in OPERATIONS.values():
        body = {name: a for name, a in op.arguments.items() if a.place == "body"}
        entry: dict[str, Any] = {
            "operationId": op.name,
            "summary": op.doc,
            "parameters": [
                {
                    "name": name,
                    "in": a.place,
                    "required": a.place == "path",
                    "schema": a.schema(),
                    "description": a.doc,
                }
                for name, a in op.arguments.items()
                if a.place != "body"
            ],
            "responses": {
                "200": {"description": "done", "content": {"application/json": {"schema": {"type": "object"}}}},
                "400": refused,
                "404": refused,
                "503": refused,
            },
        }
        if body:
            schema = {
                "type": "object",
                "properties": {name: a.schema() for name, a in body.items()},
                "required": [name for name, a in body.items() if a.default is REQUIRED],
                "additionalProperties": op.more,
            }
            if not schema["required"]:
                del schema["required"]
            entry["requestBody"] = {"required": True, "content": {"application/json": {"schema": schema}}}
        paths.setdefault(op.path, {})[op.method.lower()] = entry
    for kind, what in (("pcapng", "a capture for Wireshark"), ("fst", "the pins for GTKWave"), ("txt", "text")):
        paths[f"/api/capture.{kind}"] = {
            "get": {
                "operationId": f"capture_{kind}",
                "summary": f"The recent frames as {what}",
                "responses": {
                    "200": {"description": "a file", "content": {"application/octet-stream": {}}},
                    "503": refused,
                },
            }
        }
    paths["/api/events"] = {
        "get": {
            "operationId": "events",
            "summary": "WebSocket: operations as {id, op, ...}; events frame, silence, delivered, write, changed, "
            "client, script, warning, dropped",
            "responses": {"101": {"description": "a WebSocket"}},
        }
    }
    return {
        "openapi": "3.1.0",
        "info": {"title": "modbus_rtu_slave, live device", "version": version},
        "paths": paths,
        "components": {
            "schemas": {"Error": {"type": "object", "properties": {"error": {"type": "string"}}, "required": ["error"]}}
        },
    }
