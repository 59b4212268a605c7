# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The user's script: a process of its own, called with time and registers.

It is ended when it hangs, and started again when its file has changed.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import Refused

RUNNER = Path(__file__).with_name("script_runner.py")
PATIENCE_S = 2.0  # for one call
LOOK_AGAIN_S = 0.5  # at the file of a script that has failed
WRITES_KEPT = 1000
LONGEST_LINE = 1 << 22


class Hangs(Exception):
    """A call has not returned in time."""


class Script:
    """Runs beside the line; whatever it does, the line goes on."""

    def __init__(self, path: str, device: Any, tell: Callable[[dict[str, Any]], None]) -> None:
        self.path, self.device, self.tell = path, device, tell
        self.error, self.calls = "", 0
        self.writes: deque[tuple[str, int, list[int]]] = deque(maxlen=WRITES_KEPT)
        self.begin = time.monotonic()
        self.process: asyncio.subprocess.Process | None = None

    def state(self) -> dict[str, Any]:
        """For the panel."""
        return {"file": self.path, "error": self.error, "calls": self.calls}

    def written(self, table: str, first: int, values: list[int]) -> None:
        """A write of the master, for the script's written()."""
        self.writes.append((table, first, values))

    async def run(self) -> None:
        """For ever: start, call, and start anew with another version of the file."""
        while True:
            stamp = self.stamp()
            try:
                await self.play(stamp)
            except (Refused, Hangs) as error:
                self.error = str(error)
                self.tell({"event": "script", "text": f"{self.path}: {error}", "error": True})
            finally:
                await self.end()
            while self.stamp() == stamp:
                await asyncio.sleep(LOOK_AGAIN_S)
            self.error = ""
            self.writes.clear()  # it hears of what is written from now on
            self.tell({"event": "script", "text": f"{self.path}: has changed, started again"})

    def stamp(self) -> tuple[int, int]:
        """What tells versions of the file apart."""
        with contextlib.suppress(OSError):
            found = os.stat(self.path)
            return found.st_mtime_ns, found.st_size
        return 0, 0

    async def play(self, stamp: tuple[int, int]) -> None:
        """One life of the script, until its file is no longer that of `stamp`."""
        self.process = await asyncio.create_subprocess_exec(
            sys.executable,
            str(RUNNER),
            self.path,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            limit=LONGEST_LINE,
            start_new_session=True,
        )
        interval = (await self.message("the file"))["interval"]
        due = looked = time.monotonic()
        while True:
            if time.monotonic() > looked + LOOK_AGAIN_S:
                looked = time.monotonic()
                if self.stamp() != stamp:
                    return
            while self.writes:
                table, first, values = self.writes.popleft()
                await self.call("written()", {"call": "written", "table": table, "first": first, "values": values})
            await self.call("step()", {"call": "step"})
            self.calls += 1
            due = max(due + interval, time.monotonic())
            while (left := due - time.monotonic()) > 0 and not self.writes:
                await asyncio.sleep(min(left, 0.05))
            if self.writes and left > 0:
                due -= interval  # the step is still to come at its time

    async def call(self, name: str, message: dict[str, Any]) -> None:
        """One call of a function; what it wrote goes to the device."""
        self.send({**message, "t": time.monotonic() - self.begin})
        while True:
            got = await self.message(name)
            if got.get("done"):
                break
            try:
                self.send(await self.answer(got))
            except Refused as error:
                self.send({"error": str(error)})
        for table, first, values in got["runs"]:
            await self.device.write(table, first, values, quiet=True)
        for point, value in got["points"].items():
            await self.device.write_point(point, value, quiet=True)

    async def answer(self, question: dict[str, Any]) -> dict[str, Any]:
        """What the script reads."""
        if question["ask"] == "read":
            return await self.device.read(question["table"], question["first"], question["count"])
        return await self.device.point(question["name"])

    def send(self, message: dict[str, Any]) -> None:
        """A line to the script."""
        self.process.stdin.write(json.dumps(message).encode() + b"\n")

    async def message(self, name: str) -> dict[str, Any]:
        """The script's next line.  Hangs if it takes too long, Refused with what the script says of its error."""
        try:
            line = await asyncio.wait_for(self.process.stdout.readline(), PATIENCE_S)
        except asyncio.TimeoutError:
            raise Hangs(f"{name} did not return within {PATIENCE_S:g} s and was ended") from None
        except ValueError:
            raise Refused(f"{name}: too much data") from None
        try:
            found = json.loads(line)
        except ValueError:
            raise Refused(f"ended by itself (status {await self.process.wait()})") from None
        if "error" in found:
            raise Refused(found["error"])
        return found

    async def end(self) -> None:
        """The process is gone."""
        if self.process and self.process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, 9)
            await self.process.wait()
