# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every frame explained: the bridge's events as rows with words, and as lines of a terminal."""

from __future__ import annotations

import time
from array import array
from collections import deque
from dataclasses import dataclass, field
from typing import Any

from protocol.defs import EXCEPTION_FLAG
from protocol.frames import adu, lrc
from protocol.words import answer, request

KEPT = 2000  # frames, with their pins
NAMES_SHOWN = 4

# What the bridge calls the reason of a silence, in words.
SILENCES = {
    "crc": "wrong CRC",
    "parity": "a character with wrong parity",
    "framing": "a character without its stop bit",
    "overrun": "characters came while the core was still at work",
    "gap": "a gap above t1.5 inside the frame",
    "too long": "more than 256 bytes",
    "too short": "fewer than 4 bytes",
    "other address": "for another slave",
    "broadcast": "a broadcast, which is never answered",
    "listen-only": "the slave is in listen-only mode",
    "not heard": "no character was heard",
    "no answer": "the core gave no answer",
}
ASCII_SILENCES = {  # where ASCII mode differs
    "crc": "wrong LRC, or a character that is not allowed",
    "gap": "a pause above the time-out inside the frame",
    "too long": "more than 513 characters",
    "too short": "fewer than 3 bytes",
}
HARMLESS = ("broadcast", "other address", "listen-only")
RED, GREEN, BLUE, YELLOW, GREY, PLAIN = (f"\033[{code}m" for code in (31, 32, 34, 33, 90, 0))


ASCII_END = (0x0D,)  # behind the digits, and the delimiter
SHORTEST_ASCII = 3  # bytes: address, function code, LRC


def of_ascii(line: bytes) -> tuple[bytes, str]:
    """A frame of ASCII mode as the one of RTU mode that says the same, or none and what is wrong with it."""
    digits = line[1:-2]
    try:
        if line[:1] != b":" or line[-2] != ASCII_END[0] or digits != digits.upper():
            raise ValueError
        data = bytes.fromhex(digits.decode("ascii"))
    except (ValueError, IndexError):
        return b"", "these characters are no frame in ASCII mode"
    if len(data) < SHORTEST_ASCII:
        return b"", f"{len(data)} bytes are no frame"
    if lrc(data):
        should = lrc(data[:-1])
        return b"", f"LRC {data[-1]:02X} is wrong, {should:02X} would be right: no slave may act on it"
    return adu(data[0], data[1:-1]), ""


def shown(line: bytes, ascii_mode: bool) -> str:
    """A frame for people: hexadecimal, in ASCII mode its characters."""
    if not ascii_mode:
        return line.hex(" ").upper()
    names = {0x0D: "<CR>", 0x0A: "<LF>"}
    return "".join(names.get(c) or (chr(c) if 32 <= c < 127 else f"<{c:02X}>") for c in line)


@dataclass
class Frame:
    """A frame of the line; `edges` are pairs of cycle offset and pins, flat."""

    n: int
    time: float
    direction: str  # request | answer
    data: bytes  # in ASCII mode the frame of RTU mode that says the same, if there is one
    words: str
    cycle: int
    end: int
    starts: list[int]
    edges: array
    errors: list[tuple[int, str]]
    injected: str = ""
    source: str = ""
    slave: int = 0
    to: int = 0  # of an answer: its request
    number: int = 0  # the bridge's: one for a request and its answers
    line: bytes = b""  # as on the line
    ascii: bool = False
    late_ms: float = 0.0  # of an answer: how far the simulation lags behind the clock
    silence: dict[str, Any] | None = None
    delivered: dict[str, Any] | None = None
    answer: int = 0  # of a request: its answer

    def row(self) -> dict[str, Any]:
        """For JSON, without the pins."""
        out = {
            "n": self.n,
            "time": self.time,
            "direction": self.direction,
            "hex": shown(self.line or self.data, self.ascii),
            "words": self.words,
            "errors": sorted({what for _, what in self.errors}),
            "injected": self.injected,
            "start": self.cycle,
            "end": self.end,
            "source": self.source,
            "slave": self.slave,
        }
        if self.direction == "answer":
            out["exception"] = len(self.data) > 2 and bool(self.data[1] & EXCEPTION_FLAG)
            out["to"] = self.to
            out["late_ms"] = self.late_ms
        for name in ("silence", "delivered"):
            if getattr(self, name):
                out[name] = getattr(self, name)
        return out


@dataclass
class Frames:
    """The recent frames, and what is said of them."""

    present: str  # "this one is 17"
    names: Any = None  # (request, answer or None) -> the points in it
    kept: deque = field(default_factory=lambda: deque(maxlen=KEPT))
    last: dict[int, Frame] = field(default_factory=dict)
    requests: dict[int, Frame] = field(default_factory=dict)  # by the bridge's number
    character: int = 0  # clocks
    ascii: bool = False
    count: int = 0

    def get(self, n: int) -> Frame | None:
        """A frame that is still kept."""
        return self.last.get(n)

    def request(self, n: int) -> Frame | None:
        """The request with this number of the bridge, if it is still kept."""
        return self.requests.get(n)

    def take(self, event: dict[str, Any]) -> dict[str, Any] | None:
        """An event of the bridge as the event for clients; None if it is of no frame."""
        kind = event["event"]
        if kind == "frame":
            return {"event": "frame", "frame": self.frame(event).row()}
        if kind == "silence":
            frame = self.request(event["to"])
            if frame is None:
                return None
            frame.silence = {"to": frame.n, "verdict": event["verdict"], "words": self.silence(event, frame)}
            return {"event": "silence", **frame.silence}
        if kind == "delivered":
            said = self.delivered(event)
            return {"event": "delivered", **said} if said else None
        return None

    def frame(self, event: dict[str, Any]) -> Frame:
        """Keep a frame."""
        line = bytes.fromhex(event["bytes"])
        data, wrong = of_ascii(line) if self.ascii else (line, "")
        asks = event["direction"] == "request"
        asked = None if asks else self.request(event.get("to", 0))
        words = wrong or self.words(data, asks, asked)
        if self.names and (asks or asked):
            names = self.names(data if asks else asked.data, None if asks else data)
            more = ", ..." if len(names) > NAMES_SHOWN else ""
            words += f" ({', '.join(names[:NAMES_SHOWN])}{more})" if names else ""
        starts = event.get("starts", [])
        self.count += 1
        frame = Frame(
            n=self.count,
            time=event["time"],
            direction=event["direction"],
            data=data,
            words=words,
            cycle=event["cycle"],
            end=event["cycle"] + starts[-1] + self.character if starts else event["end"],
            starts=starts,
            edges=array("I", event.get("edges", [])),
            errors=[tuple(fault) for fault in event.get("faults", [])],
            injected=injections(event),
            source=event.get("source", ""),
            slave=event.get("slave", 0),
            to=asked.n if asked else 0,
            number=event["n"],
            line=line,
            ascii=self.ascii,
            late_ms=round(event.get("late_ms", 0.0), 3),
        )
        if len(self.kept) == self.kept.maxlen:
            old = self.kept[0]
            self.last.pop(old.n, None)
            if self.requests.get(old.number) is old:
                del self.requests[old.number]
        self.kept.append(frame)
        self.last[frame.n] = frame
        if asks:
            self.requests[frame.number] = frame
        if asked:
            asked.answer = frame.n
        return frame

    @staticmethod
    def words(data: bytes, asks: bool, asked: Frame | None) -> str:
        """A frame in words; `asked` is the request of an answer."""
        if asks:
            return request(data)
        return answer(asked.data, data) if asked and len(asked.data) > 3 else data.hex(" ").upper()

    def silence(self, event: dict[str, Any], frame: Frame) -> str:
        """Why a request got no answer, in words."""
        verdict = event["verdict"]
        if verdict == "other address" and frame.data:
            return f"for slave {frame.data[0]}, {self.present}"
        if verdict == "not heard" and frame.line:
            return "the core has taken these characters for no frame"
        known = {**SILENCES, **(ASCII_SILENCES if self.ascii else {})}
        return known.get(verdict, verdict)

    def delivered(self, event: dict[str, Any]) -> dict[str, Any] | None:
        """What the client got of an answer that a fault has changed."""
        line = bytes.fromhex(event["bytes"])
        data, wrong = of_ascii(line) if self.ascii and line else (line, "")
        asked = self.request(event["to"])
        frame = self.get(asked.answer) if asked and asked.answer else None
        if asked is None or frame is None:
            return None
        words = wrong or (answer(asked.data, data) if data and len(asked.data) > 3 else "")
        frame.delivered = {"to": frame.n, "hex": shown(line, self.ascii), "words": words, "injected": injections(event)}
        return frame.delivered


def injections(event: dict[str, Any]) -> str:
    """What was broken on purpose, one text."""
    found = event.get("injected") or ""
    return found if isinstance(found, str) else "; ".join(found)


class Log:
    """Lines for a terminal or a text file."""

    def __init__(self, stream: Any, colours: bool) -> None:
        self.stream, self.colours = stream, colours

    def paint(self, colour: str, text: str) -> str:
        """`text` in a colour, where the stream is a terminal."""
        return f"{colour}{text}{PLAIN}" if self.colours else text

    def tell(self, event: dict[str, Any]) -> None:
        """One event for clients as a line."""
        if line := self.line(event):
            self.stream.write(line + "\n")
            self.stream.flush()

    def line(self, event: dict[str, Any]) -> str:
        """The line of an event; empty for those that are not of the line."""
        kind = event["event"]
        if kind == "frame":
            return self.frame(event["frame"])
        if kind == "silence":
            colour = GREY if event["verdict"] in HARMLESS else RED
            return " " * 13 + self.paint(colour, f"   no answer: {event['words']}")
        if kind == "delivered":
            return " " * 13 + self.paint(
                YELLOW, f"   the client got {event['hex'] or 'nothing'}: {event['words']} [{event['injected']}]"
            )
        if kind == "write":
            names = ", ".join(f"{name} = {text}" for name, text in event.get("points", {}).items())
            values = ", ".join(map(str, event["values"][:8])) + (", ..." if len(event["values"]) > 8 else "")
            return " " * 13 + "   written: " + (names or f"{event['table']} {event['first']} = {values}")
        if kind == "script":
            return self.paint(RED if event.get("error") else GREY, f"script: {event['text']}")
        return ""

    def frame(self, frame: dict[str, Any]) -> str:
        """A frame as a line: time, direction, bytes, words."""
        at = time.strftime("%H:%M:%S", time.localtime(frame["time"])) + f".{int(frame['time'] % 1 * 1000):03d}"
        asks = frame["direction"] == "request"
        bad = frame["errors"] or "is wrong" in frame["words"] or "refused" in frame["words"]
        arrow = self.paint(BLUE, "->") if asks else self.paint(GREEN, "<-")
        words = self.paint(RED, frame["words"]) if bad else frame["words"]
        fault = self.paint(YELLOW, f" [{frame['injected']}]") if frame["injected"] else ""
        return f"{self.paint(GREY, at)} {arrow} {self.paint(GREY, frame['hex'])}  {words}{fault}"
