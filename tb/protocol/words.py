# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Modbus RTU frames in words, for people who read along.

Addresses are the zero-based ones of the frames (register 40108 of older texts is holding register 107).
"""

import struct

from protocol.defs import COIL_OFF, COIL_ON, EXCEPTION_FLAG, FUNCTIONS, LONGEST_FRAME, Space
from protocol.frames import crc16, text, unpack_bits, unpack_words
from protocol.pdm import RECORD_BYTES, Event

from .words_special import ANSWERS, REQUESTS

EXCEPTIONS = {
    0x01: "illegal function",
    0x02: "illegal data address",
    0x03: "illegal data value",
    0x04: "slave device failure",
    0x05: "acknowledge",
    0x06: "slave device busy",
    0x07: "negative acknowledge",
    0x08: "memory parity error",
    0x0A: "gateway path unavailable",
    0x0B: "gateway target failed to respond",
}
ITEMS = {
    Space.COILS: ("coil", "coils"),
    Space.DISCRETES: ("discrete input", "discrete inputs"),
    Space.INPUTS: ("input register", "input registers"),
    Space.HOLDINGS: ("holding register", "holding registers"),
}
SHOWN = 12  # values of a list that are spelled out


def span(space, first, count):
    """`count` items from `first`: "holding registers 107 to 109"."""
    one, many = ITEMS[space]
    return f"{one} {first}" if count == 1 else f"{many} {first} to {first + count - 1}"


def values(items):
    """Numbers in a row; the middle of a long row is left out."""
    if len(items) > SHOWN:
        shown = [*map(str, items[: SHOWN - 2]), "...", str(items[-1])]
    else:
        shown = map(str, items)
    return ", ".join(shown)


def bits(items):
    """Bits in a row, first item first, in groups of eight."""
    row = "".join(map(str, items))
    groups = [row[i : i + 8] for i in range(0, len(row), 8)]
    return " ".join(groups)


def function_name(code):
    """Name of a function code."""
    if code in FUNCTIONS:
        return FUNCTIONS[code].name
    return "function unknown"


def broken(frame):
    """What is wrong with the frame as such, or None."""
    if len(frame) < 4:
        return f"{len(frame)} bytes are no frame"
    if len(frame) > LONGEST_FRAME:
        return f"{len(frame)} bytes are more than a frame can have"
    if crc16(frame):
        should = crc16(frame[:-2]).to_bytes(2, "little")
        return f"CRC {text(frame[-2:])} is wrong, {text(should)} would be right: no slave may act on it"
    return None


def request(frame):
    """A master's frame in words."""
    if broken(frame):
        return broken(frame)
    to = f"slave {frame[0]}" if frame[0] else "all slaves"
    return f"to {to}: {request_pdu(frame[1:-2])}"


def request_pdu(pdu):
    """A request without address and CRC."""
    code = pdu[0]
    function = FUNCTIONS.get(code)
    try:
        if code in (0x01, 0x02, 0x03, 0x04):
            return "read " + span(function.space, *struct.unpack(">HH", pdu[1:]))
        if code == 0x05:
            address, value = struct.unpack(">HH", pdu[1:])
            state = {COIL_ON: "on", COIL_OFF: "off"}.get(value, f"to {value:04X}, which is neither on nor off")
            return f"switch {span(function.space, address, 1)} {state}"
        if code == 0x06:
            address, value = struct.unpack(">HH", pdu[1:])
            return f"write {span(function.space, address, 1)} = {value}"
        if code == 0x0F:
            address, quantity, _ = struct.unpack(">HHB", pdu[1:6])
            return f"write {span(function.space, address, quantity)} = {bits(unpack_bits(pdu[6:], quantity))}"
        if code == 0x10:
            address, quantity, _ = struct.unpack(">HHB", pdu[1:6])
            return f"write {span(function.space, address, quantity)} = {values(unpack_words(pdu[6:]))}"
        if code == 0x16:
            address, and_mask, or_mask = struct.unpack(">HHH", pdu[1:])
            return f"mask {span(function.space, address, 1)}: AND {and_mask:04X}, OR {or_mask:04X}"
        if code == 0x17:
            read, count, write, quantity, _ = struct.unpack(">HHHHB", pdu[1:10])
            return (
                f"write {span(function.space, write, quantity)} = {values(unpack_words(pdu[10:]))}, "
                f"then read {span(function.space, read, count)}"
            )
        if code in REQUESTS:
            return REQUESTS[code](pdu)
    except (struct.error, IndexError, ValueError):
        return f"{function_name(code)}, but the length does not fit"
    return f"{function_name(code)} (function {code:02X})"


def answer(asked, frame):
    """A slave's frame in words; `asked` is the request it answers, `frame` None for silence."""
    if frame is None:
        return "silence"
    if broken(frame):
        return broken(frame)
    said = answer_pdu(asked[1:-2], frame[1:-2])
    return said if frame[0] == asked[0] else f"from slave {frame[0]}, which was not asked: {said}"


def answer_pdu(asked, pdu):
    """An answer without address and CRC."""
    code = pdu[0]
    if code == asked[0] | EXCEPTION_FLAG and len(pdu) == 2:
        return f"refused, exception {pdu[1]:02X}: {EXCEPTIONS.get(pdu[1], 'unknown')}"
    if code != asked[0]:
        return f"answers another function ({code:02X})"
    function = FUNCTIONS.get(code)
    try:
        if code in (0x01, 0x02):
            first, count = struct.unpack(">HH", asked[1:])
            return f"{span(function.space, first, count)} = {bits(unpack_bits(pdu[2:], count))}"
        if code in (0x03, 0x04, 0x17):
            first, count = struct.unpack(">HH", asked[1:5])
            if pdu[1] == RECORD_BYTES != 2 * count:
                return event_record(pdu[2:])
            return f"{span(function.space, first, count)} = {values(unpack_words(pdu[2:]))}"
        if code in (0x05, 0x06, 0x16):
            return "done (the request is repeated)" if pdu == asked else "done, but not what was asked"
        if code in (0x0F, 0x10):
            return "done: " + span(function.space, *struct.unpack(">HH", pdu[1:]))
        if code in ANSWERS:
            return ANSWERS[code](asked, pdu)
    except (struct.error, IndexError, ValueError):
        return f"answer to {function_name(code)}, but the length does not fit"
    return f"answer to {function_name(code)}: {text(pdu[1:])}"


def event_record(record):
    """The twelve bytes of a PDM meter's event."""
    number, e = Event.of_record(record)
    second = f"{e.ms // 1000:02d}.{e.ms % 1000:03d}"
    at = f"{2000 + e.year}-{e.month:02d}-{e.day:02d} {e.hour:02d}:{e.minute:02d}:{second}"
    return f"event record {number}: {e.group:02X}{e.code:02X} {'closed' if e.closed else 'open'}, {at}"
