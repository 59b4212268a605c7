# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The recent frames as files: pcapng for Wireshark, FST for GTKWave, text."""

from __future__ import annotations

import io
import os
import struct
import tempfile
from collections.abc import Iterable
from typing import Any

from .errors import Refused
from .explain import Frame, Log, shown

# pcapng (draft-ietf-opsawg-pcapng): block types, options
SECTION, INTERFACE, PACKET = 0x0A0D0D0A, 1, 6
BYTE_ORDER, COMMENT, HARDWARE, NAME, RESOLUTION, END = 0x1A2B3C4D, 1, 2, 2, 9, 0
UPPER_PDU = 252  # link type: tags that name the dissector, then the frame
TAG_DISSECTOR, TAG_END = 12, 0
DISSECTOR = b"mbrtu"  # Modbus RTU
TAGS = struct.pack(">HH8sHH", TAG_DISSECTOR, 8, DISSECTOR, TAG_END, 0)
NO_DISSECTOR = struct.pack(">HH8sHH", TAG_DISSECTOR, 8, b"data", TAG_END, 0)
MICROSECONDS = 6
FST_TIMESCALE_NS = -9
PINS = ("rxd", "txd", "de")
IDLE = 6  # rxd and txd high, de low


def options(*pairs: tuple[int, bytes]) -> bytes:
    """Options of a block, ended."""
    out = b""
    for code, value in pairs:
        out += struct.pack("<HH", code, len(value)) + value + bytes(-len(value) % 4)
    return out + (struct.pack("<HH", END, 0) if pairs else b"")


def block(kind: int, body: bytes) -> bytes:
    """A block, with its length before and behind."""
    size = len(body) + 12
    return struct.pack("<II", kind, size) + body + struct.pack("<I", size)


def pcapng(frames: Iterable[Frame], link: str) -> bytes:
    """Frames with at least two bytes, each with a comment where something was wrong or broken on purpose."""
    head = struct.pack("<IHHq", BYTE_ORDER, 1, 0, -1) + options((HARDWARE, b"modbus_rtu_slave, live device"))
    out = [block(SECTION, head)]
    about = options((NAME, (link or "line").encode()), (RESOLUTION, bytes([MICROSECONDS])))
    out.append(block(INTERFACE, struct.pack("<HHI", UPPER_PDU, 0, 0) + about))
    for frame in frames:
        line = frame.line or frame.data
        if not line:
            continue
        # Wireshark has no dissector for the characters of ASCII mode: the frame is that of RTU mode, with a CRC.
        data = TAGS + frame.data if frame.data else NO_DISSECTOR + line
        stamp = int(frame.time * 10**MICROSECONDS)
        remarks = [f"ASCII mode: {shown(line, True)}"] if frame.ascii else []
        remarks += [f"broken on purpose: {frame.injected}"] if frame.injected else []
        if frame.silence:
            remarks.append(f"no answer: {frame.silence['words']}")
        if frame.delivered:
            remarks.append(f"the client got {frame.delivered['hex'] or 'nothing'}")
        body = (
            struct.pack("<IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(data), len(data))
            + data
            + bytes(-len(data) % 4)
        )
        out.append(block(PACKET, body + options(*[(COMMENT, remark.encode()) for remark in remarks])))
    return b"".join(out)


def text(frames: Iterable[Frame]) -> bytes:
    """Lines as LOG=1 writes them."""
    stream = io.StringIO()
    log = Log(stream, colours=False)
    for frame in frames:
        log.tell({"event": "frame", "frame": frame.row()})
        if frame.silence:
            log.tell({"event": "silence", **frame.silence})
        if frame.delivered:
            log.tell({"event": "delivered", **frame.delivered})
    return stream.getvalue().encode()


def changes(frames: Iterable[Frame]) -> list[tuple[int, int]]:
    """(cycle, pins) of all frames, in order."""
    found = {}
    for frame in frames:
        for i in range(0, len(frame.edges) - 1, 2):
            found[frame.cycle + frame.edges[i]] = frame.edges[i + 1]
    return sorted(found.items())


def fst(frames: Iterable[Frame], clock_hz: int) -> bytes:
    """The pins over simulated time, in nanoseconds, written by the FST library of GTKWave.  Refused without it."""
    try:
        from pylibfst import lib
    except ImportError:
        raise Refused("FST needs the package pylibfst") from None
    handle, path = tempfile.mkstemp(suffix=".fst")
    os.close(handle)
    try:
        writer = lib.fstWriterCreate(path.encode(), 1)
        lib.fstWriterSetTimescale(writer, FST_TIMESCALE_NS)
        lib.fstWriterSetScope(writer, lib.FST_ST_VCD_MODULE, b"line", b"")
        wires = [
            lib.fstWriterCreateVar(writer, lib.FST_VT_VCD_WIRE, lib.FST_VD_IMPLICIT, 1, pin.encode(), 0) for pin in PINS
        ]
        rows = changes(frames)
        before = None
        for cycle, pins in [(rows[0][0] - 1 if rows else 0, IDLE), *rows]:
            lib.fstWriterEmitTimeChange(writer, cycle * 10**9 // clock_hz)
            for place, wire in enumerate(wires):
                bit = pins >> (2 - place) & 1
                if before is None or (before >> (2 - place) & 1) != bit:
                    lib.fstWriterEmitValueChange(writer, wire, b"1" if bit else b"0")
            before = pins
        lib.fstWriterClose(writer)
        with open(path, "rb") as file:
            return file.read()
    finally:
        os.unlink(path)


def made(kind: str, frames: list[Frame], hello: dict[str, Any], link: str) -> bytes:
    """A capture of a kind."""
    if kind == "pcapng":
        return pcapng(frames, link)
    return fst(frames, hello["clock_hz"]) if kind == "fst" else text(frames)
