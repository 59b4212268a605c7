# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A client of the live device's control interface, standard library only.

    device = Live("http://127.0.0.1:8080")
    device.write("inputs", 0, [215])
    device["temperature"] = 21.5                # a point of a map
    device.fault("wrong_crc", every=3)
    for frame in device.frames():
        print(frame["words"], frame.get("silence", {}).get("words", ""))

Every operation of /openapi.json is a call: device.call("status").  LiveError holds what the device says is wrong.
"""

from __future__ import annotations

import json
import urllib.error
import urllib.request
from typing import Any
from urllib.parse import quote, urlencode


class LiveError(Exception):
    """What the device refuses, and why."""


class Live:
    """The control interface at an address."""

    def __init__(self, url: str = "http://127.0.0.1:8080", timeout: float = 10.0) -> None:
        self.url, self.timeout = url.rstrip("/"), timeout

    def ask(self, method: str, path: str, body: Any = None, **query: Any) -> Any:
        """A request; its JSON, or the bytes of a capture.  Raises LiveError."""
        address = f"{self.url}{quote(path)}" + (f"?{urlencode(query)}" if query else "")
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(address, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=self.timeout) as answer:
                found = answer.read()
                return json.loads(found) if answer.headers.get_content_type() == "application/json" else found
        except urllib.error.HTTPError as error:
            text = error.read().decode(errors="replace")
            try:
                text = json.loads(text)["error"]
            except (ValueError, KeyError, TypeError):
                pass
            raise LiveError(text) from None
        except urllib.error.URLError as error:
            raise LiveError(f"{self.url}: {error.reason}") from None

    def device(self) -> dict[str, Any]:
        """What the device is."""
        return self.ask("GET", "/api/device")

    def read(self, table: str, first: int, count: int = 1) -> list[int]:
        """Values of a table."""
        return self.ask("GET", f"/api/tables/{table}", first=first, count=count)["values"]

    def write(self, table: str, first: int, values: list[int]) -> None:
        """Values to a table, as one piece for the line."""
        self.ask("PUT", f"/api/tables/{table}/{first}", {"values": values})

    def __getitem__(self, name: str) -> Any:
        return self.ask("GET", f"/api/points/{name}")["value"]

    def __setitem__(self, name: str, value: Any) -> None:
        self.ask("PUT", f"/api/points/{name}", {"value": value})

    def state(self, **changes: int) -> dict[str, Any]:
        """Exception status, busy, failure, run_indicator, write_lock; those that are named are changed."""
        return self.ask("PATCH", "/api/state", changes) if changes else self.ask("GET", "/api/state")

    def status(self) -> dict[str, Any]:
        """Counters, event log, line errors."""
        return self.ask("GET", "/api/status")

    def frames(self, after: int = 0, limit: int = 200) -> list[dict[str, Any]]:
        """Recent frames, oldest first."""
        return self.ask("GET", "/api/frames", after=after, limit=limit)["frames"]

    def pins(self, n: int) -> dict[str, Any]:
        """The pins of a recent frame."""
        return self.ask("GET", f"/api/frames/{n}/pins")

    def fault(self, kind: str, **arguments: Any) -> int:
        """Break the line; the fault's number."""
        return self.ask("POST", "/api/faults", {"kind": kind, **arguments})["fault"]

    def unfault(self, fault: int | str = "all") -> None:
        """Remove a fault, or all."""
        self.ask("DELETE", f"/api/faults/{fault}")

    def send(self, hex_bytes: str) -> str:
        """A frame of our own on the line; the answer in hexadecimal, empty for silence."""
        return self.ask("POST", "/api/send", {"hex": hex_bytes})["answer"]

    def attach(self, point: str, kind: str, **arguments: Any) -> None:
        """A value that moves."""
        self.ask("POST", "/api/signals", {"point": point, "kind": kind, **arguments})

    def capture(self, kind: str = "pcapng") -> bytes:
        """The recent frames as pcapng, fst or txt."""
        return self.ask("GET", f"/api/capture.{kind}")
