# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Values that move: signals attached to points."""

from __future__ import annotations

import csv
import io
import json
import math
import random
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .errors import Refused

NUMBER = (-1e12, 1e12)
SECONDS = (0.01, 1e6)
# kind: {argument: (default, least, most, meaning)}
KINDS: dict[str, dict[str, tuple[Any, Any, Any, str]]] = {
    "constant": {"value": (0, *NUMBER, "value")},
    "ramp": {
        "from": (0, *NUMBER, "first value"),
        "to": (100, *NUMBER, "last value, then it begins anew"),
        "period": (10, *SECONDS, "seconds from first to last"),
    },
    "sine": {
        "mean": (50, *NUMBER, "middle"),
        "amplitude": (10, 0, 1e12, "largest distance from it"),
        "period": (10, *SECONDS, "seconds"),
    },
    "square": {
        "low": (0, *NUMBER, "value of the first half"),
        "high": (1, *NUMBER, "value of the second half"),
        "period": (2, *SECONDS, "seconds"),
    },
    "walk": {
        "start": (50, *NUMBER, "first value"),
        "step": (1, 0, 1e12, "largest change in a second"),
        "low": (0, *NUMBER, "least value"),
        "high": (100, *NUMBER, "largest value"),
    },
    "counter": {
        "start": (0, *NUMBER, "first value"),
        "step": (1, *NUMBER, "what is added"),
        "period": (1, *SECONDS, "seconds between additions"),
    },
    "csv": {"csv": ("", 0, 0, "lines of seconds,value; replayed again and again")},
}
MOST_ROWS = 100_000


def samples(text: str) -> list[tuple[float, float]]:
    """(seconds, value) of CSV lines; a first line without numbers is a head.  Refused if nothing can be replayed."""
    found: list[tuple[float, float]] = []
    for number, row in enumerate(csv.reader(io.StringIO(text)), 1):
        if not row or not "".join(row).strip():
            continue
        try:
            at, value = float(row[0]), float(row[1])
        except (ValueError, IndexError):
            if number == 1:
                continue
            raise Refused(f"csv line {number}: must be seconds,value, not {','.join(row)[:40]!r}") from None
        if not math.isfinite(at) or not math.isfinite(value) or (found and at < found[-1][0]) or at < 0:
            raise Refused(f"csv line {number}: seconds must not be negative and must not go back")
        found.append((at, value))
        if len(found) > MOST_ROWS:
            raise Refused(f"csv: more than {MOST_ROWS} lines")
    if not found:
        raise Refused("csv: no line of seconds,value")
    return found


@dataclass
class Signal:
    """A value over time.  Raises Refused if an argument is wrong."""

    kind: str
    arguments: dict[str, Any] = field(default_factory=dict)
    begin: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise Refused(f"kind: must be {', '.join(KINDS)}")
        given, known = self.arguments, KINDS[self.kind]
        for name in given:
            if name not in known:
                raise Refused(f"{name}: {self.kind} takes {', '.join(known)}")
        self.arguments = {name: given.get(name, default) for name, (default, *_) in known.items()}
        if self.kind == "csv":
            if not isinstance(self.arguments["csv"], str):
                raise Refused("csv: must be a text of lines seconds,value")
            self.rows = samples(self.arguments["csv"])
            self.arguments = {"lines": len(self.rows)}
            return
        for name, value in self.arguments.items():
            _, least, most, _ = known[name]
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:
                raise Refused(f"{name}: must be a number from {least:g} to {most:g}")
        self.walked = self.arguments.get("start", 0)
        self.walked_at = 0.0

    def at(self, now: float) -> float:
        """The value at a moment, in seconds of one clock."""
        t, a = now - self.begin, self.arguments
        phase = t / a["period"] if "period" in a else 0.0
        if self.kind == "constant":
            return a["value"]
        if self.kind == "ramp":
            return a["from"] + (a["to"] - a["from"]) * (phase % 1)
        if self.kind == "sine":
            return a["mean"] + a["amplitude"] * math.sin(2 * math.pi * phase)
        if self.kind == "square":
            return a["high"] if phase % 1 >= 0.5 else a["low"]
        if self.kind == "counter":
            return a["start"] + a["step"] * math.floor(phase)
        if self.kind == "walk":
            step = a["step"] * min(t - self.walked_at, 1.0)
            self.walked_at = t
            self.walked = min(max(self.walked + random.uniform(-step, step), a["low"]), a["high"])
            return self.walked
        return self.replayed(t)

    def replayed(self, t: float) -> float:
        """The last sample of the CSV that is due."""
        length = self.rows[-1][0]
        t = t % length if length else 0.0
        low, high = 0, len(self.rows)
        while low < high:
            middle = (low + high) // 2
            if self.rows[middle][0] <= t:
                low = middle + 1
            else:
                high = middle
        return self.rows[max(low - 1, 0)][1]

    def text(self) -> str:
        """For people."""
        return f"{self.kind} " + ", ".join(f"{name} {value:g}" for name, value in self.arguments.items())


def from_file(path: str) -> dict[str, dict[str, Any]]:
    """SIGNALS=file.json: {point: {"kind": ..., ...}}; `csv` names a file beside it.  Refused if it is wrong."""
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise Refused(error.strerror or str(error)) from None
    except (ValueError, RecursionError) as error:
        raise Refused(f"not JSON: {error}") from None
    if not isinstance(document, dict) or not all(isinstance(one, dict) and "kind" in one for one in document.values()):
        raise Refused('must be {"point": {"kind": ..., ...}}')
    for point, signal in document.items():
        if signal["kind"] == "csv":
            try:
                signal["csv"] = (Path(path).parent / str(signal.get("csv", ""))).read_text(encoding="utf-8")
            except (OSError, ValueError) as error:
                raise Refused(f"{point}: csv: {error}") from None
    return document
