#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Runs a user's script in a process of its own: lines of JSON on standard input and output.

    script_runner.py FILE

The script has `step(t, registers)`, called every `INTERVAL` seconds (0.1 without one), and may have
`written(t, registers, table, first, values)`, called for each write by the master.  `registers` reads and writes: a
point of the map by name, `registers["temperature"] = 21.5`; tables by address, `registers.inputs[0] = 7`,
`registers.holdings[0:4]`.
What a call writes goes to the device when it returns, as one piece for each run of addresses.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
import traceback

TABLES = ("coils", "discretes", "inputs", "holdings", "files")
channel_out = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)  # what the script prints is for people


def say(message: dict) -> None:
    """A line to the server."""
    channel_out.write(json.dumps(message) + "\n")


def ask(message: dict) -> dict:
    """A question to the server, and its answer; LookupError with the text of a refusal."""
    say(message)
    answer = json.loads(sys.stdin.readline())
    if "error" in answer:
        raise LookupError(answer["error"])
    return answer


class Table:
    """A table by address; numbers and slices."""

    def __init__(self, registers: Registers, name: str) -> None:
        self.registers, self.name = registers, name

    def __getitem__(self, key):
        if isinstance(key, slice):
            first, last = key.start or 0, key.stop
            got = ask({"ask": "read", "table": self.name, "first": first, "count": last - first})["values"]
            return [self.registers.changes.get((self.name, first + i), value) for i, value in enumerate(got)]
        if (self.name, key) in self.registers.changes:
            return self.registers.changes[self.name, key]
        return ask({"ask": "read", "table": self.name, "first": key, "count": 1})["values"][0]

    def __setitem__(self, key, value):
        if isinstance(key, slice):
            for i, one in enumerate(value):
                self.registers.changes[self.name, (key.start or 0) + i] = int(one)
        else:
            self.registers.changes[self.name, key] = round(value)


class Registers:
    """What a script is given."""

    def __init__(self) -> None:
        self.changes: dict = {}
        self.points: dict = {}
        for name in TABLES:
            setattr(self, name, Table(self, name))

    def __getitem__(self, name):
        if name in self.points:
            return self.points[name]
        return ask({"ask": "point", "name": name})["value"]

    def __setitem__(self, name, value):
        self.points[name] = value

    def take(self) -> dict:
        """What has been written since, as runs of addresses and values by name."""
        runs: list = []
        for (table, address), value in sorted(self.changes.items()):
            if runs and runs[-1][0] == table and runs[-1][1] + len(runs[-1][2]) == address:
                runs[-1][2].append(value)
            else:
                runs.append([table, address, [value]])
        out = {"runs": runs, "points": self.points}
        self.changes, self.points = {}, {}
        return out


def reason(error: BaseException, path: str) -> str:
    """One line: what was raised, and the line of the script."""
    if isinstance(error, SyntaxError):
        return f"line {error.lineno}: {error.msg}"
    lines = [row.lineno for row in traceback.extract_tb(error.__traceback__) if row.filename == path]
    return (f"line {lines[-1]}: " if lines else "") + f"{type(error).__name__}: {error}"


def main() -> int:
    """Load the script, then a call for each line of the server."""
    path = sys.argv[1]
    registers = Registers()
    try:
        space = runpy.run_path(path, run_name="live_script")
        if not callable(space.get("step")):
            raise LookupError("has no function step(t, registers)")
        interval = space.get("INTERVAL", 0.1)
        if not isinstance(interval, (int, float)) or not 0.01 <= interval <= 3600:
            raise LookupError("INTERVAL must be 0.01 to 3600 seconds")
    except BaseException as error:  # whatever a script does must end in a line for its author
        say({"error": reason(error, path)})
        return 1
    say({"ready": True, "interval": interval})
    for line in sys.stdin:
        call = json.loads(line)
        try:
            if call["call"] == "step":
                space["step"](call["t"], registers)
            elif "written" in space:
                space["written"](call["t"], registers, call["table"], call["first"], call["values"])
        except BaseException as error:  # the same
            say({"error": reason(error, path)})
            return 1
        say({"done": True, **registers.take()})
    return 0


if __name__ == "__main__":
    sys.exit(main())
