# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""In words: diagnostics, counters, event log, identity, file records and FIFO queues.

`REQUESTS` has a function (request PDU) -> text for each function code, `ANSWERS` one (request PDU, answer PDU) -> text.
"""

import struct
from itertools import groupby

from protocol.defs import (
    COUNTERS,
    ENTERED_LISTEN_ONLY,
    EVENT_COUNTER,
    FC,
    GROUP_HEAD,
    INDIVIDUAL,
    OVERRUN_FLAG,
    RECEIVED,
    RECEIVED_BROADCAST,
    RECEIVED_ERROR,
    RECEIVED_LISTENING,
    RECEIVED_OVERRUN,
    RESTART_CLEAR,
    RESTARTED,
    SENT,
    SENT_BUSY,
    SENT_FAILURE,
    SENT_LISTENING,
    SENT_NAK,
    SENT_REFUSAL,
    STATUS_BUSY,
    Sub,
)
from protocol.frames import text, unpack_words

COUNTER_WORDS = {
    "bus_message": "bus messages",
    "bus_comm_error": "communication errors",
    "bus_exception": "exceptions",
    "slave_message": "messages for this slave",
    "slave_no_response": "not answered",
    "slave_nak": "NAKs",
    "slave_busy": "busy answers",
    "bus_char_overrun": "overruns",
    EVENT_COUNTER: "events",
}
SUBS = {
    Sub.QUERY_DATA: "return query data",
    Sub.RESTART: "restart communications",
    Sub.DIAGNOSTIC_REGISTER: "return the diagnostic register",
    Sub.DELIMITER: "change the ASCII input delimiter",
    Sub.LISTEN_ONLY: "force listen-only mode",
    Sub.CLEAR: "clear counters and diagnostic register",
    Sub.CLEAR_OVERRUN: "clear overrun counter and flag",
    **{sub: f"return the count of {COUNTER_WORDS[name]}" for name, sub in COUNTERS.items()},
}
OBJECTS = (
    *("VendorName", "ProductCode", "MajorMinorRevision", "VendorUrl", "ProductName", "ModelName"),
    "UserApplicationName",
)
CATEGORIES = ("", "basic", "regular", "extended", "one object")


# ---------------------------------------------------------------------- the event log


def received(event):
    """A receive event in words."""
    if event & RECEIVED_ERROR:
        what = "frame too long" if event & RECEIVED_OVERRUN else "bad frame"
    else:
        what = "broadcast received" if event & RECEIVED_BROADCAST else "received"
    return what + (" while listening only" if event & RECEIVED_LISTENING else "")


def sent(event, answerless):
    """A send event in words; `answerless` if the message was one that gets no answer."""
    if event & SENT_LISTENING:
        return "kept silent"
    for bit, what in (
        (SENT_REFUSAL, "refused"),
        (SENT_FAILURE, "failed"),
        (SENT_BUSY, "put off as busy"),
        (SENT_NAK, "refused with NAK"),
    ):
        if event & bit:
            return what
    return "no answer due" if answerless else "answered"


def messages(log):
    """The log (newest entry first, as on the line) as texts, oldest message first."""
    events = list(reversed(log))
    out = []
    for place, event in enumerate(events):
        if event & RECEIVED:
            out.append(f"{event:02X} {received(event)}")
        elif event & SENT:
            before = events[place - 1] if place else RECEIVED
            listening = events[place + 1 : place + 2] == [ENTERED_LISTEN_ONLY]
            said = f"{event:02X} {sent(event, before & RECEIVED_BROADCAST or listening)}"
            out[-1:] = [f"{out[-1]}, {said}"] if place and before & RECEIVED else [*out[-1:], said]
        else:
            known = {ENTERED_LISTEN_ONLY: "listens only from now on", RESTARTED: "communication restarted"}
            out.append(f"{event:02X} {known.get(event, 'is no event')}")
    return out


def story(log):
    """The log on one line, oldest message first, repetitions counted."""
    runs = [(what, len(list(same))) for what, same in groupby(messages(log))]
    return "; ".join(f"{n} x ({what})" if n > 1 else what for what, n in runs) or "empty"


def counts(values):
    """{name: count} on one line, zeros left out."""
    return ", ".join(f"{COUNTER_WORDS[name]} {n}" for name, n in values.items() if n) or "all 0"


def register(value):
    """The diagnostic register."""
    if not value:
        return "0000, nothing set"
    bits = [str(i) for i in range(15, 0, -1) if value >> i & 1]
    names = [f"bit{'s' * (len(bits) > 1)} {' '.join(bits)} of the host"] if bits else []
    return f"{value:04X}, " + " and ".join([*names, *["overrun flag"] * bool(value & OVERRUN_FLAG)])


def status(word):
    """Status of functions 0B and 0C."""
    return "busy" if word == STATUS_BUSY else "ready" if word == 0 else f"status {word:04X}"


# ---------------------------------------------------------------------- requests and answers


def _name(sub):
    return SUBS.get(sub, f"sub-function {sub:04X}")


def _diagnostics(pdu):
    sub, data = struct.unpack(">HH", pdu[1:5])
    if sub == Sub.RESTART:
        return f"{_name(sub)}, {'empty' if data == RESTART_CLEAR else 'keep'} the event log"
    if sub == Sub.DELIMITER:
        return f"{_name(sub)} to {chr(data >> 8)!r}"
    return f"diagnostics, {_name(sub)}" + (f" {text(pdu[3:])}" if sub not in SUBS or data else "")


def _diagnosed(asked, pdu):
    sub, data = struct.unpack(">HH", pdu[1:5])
    name = {number: name for name, number in COUNTERS.items()}.get(sub)
    if name:
        return f"{COUNTER_WORDS[name]}: {data}"
    if sub == Sub.DIAGNOSTIC_REGISTER:
        return f"diagnostic register {register(data)}"
    return "the same comes back" if pdu == asked else "something else comes back"


def _event_counter(_, pdu):
    word, count = struct.unpack(">HH", pdu[1:])
    return f"{status(word)}, events {count}"


def _event_log(_, pdu):
    word, count, total = struct.unpack(">HHH", pdu[2:8])
    return f"{status(word)}, events {count}, bus messages {total}; log, oldest first: {story(pdu[8:])}"


def _server_id(_, pdu):
    more = f", additional data {text(pdu[4:])}" if pdu[4:] else ""
    return f"server ID {pdu[2]:02X}, {'running' if pdu[3] else 'stopped'}{more}"


def groups(pdu):
    """[(file, first record, values or quantity), ...] of a file request."""
    out, place = [], 2
    while place < len(pdu):
        _, file, first, quantity = struct.unpack(">BHHH", pdu[place : place + GROUP_HEAD])
        place += GROUP_HEAD
        if pdu[0] == FC.WRITE_FILE:
            out.append((file, first, unpack_words(pdu[place : place + 2 * quantity])))
            place += 2 * quantity
        else:
            out.append((file, first, quantity))
    return out


def _records(file, first, quantity):
    return f"file {file} record{'' if quantity == 1 else 's'} {first}" + f" to {first + quantity - 1}" * (quantity > 1)


def _joined(numbers):
    return ", ".join(map(str, numbers))


def _file_read(asked, pdu):
    place, out = 2, []
    for file, first, quantity in groups(asked):
        size = pdu[place]
        out.append(f"{_records(file, first, quantity)} = {_joined(unpack_words(pdu[place + 2 : place + 1 + size]))}")
        place += 1 + size
    return "; ".join(out)


def _fifo(_, pdu):
    count, values = struct.unpack(">H", pdu[3:5])[0], unpack_words(pdu[5:])
    return f"{count} entries: {_joined(values)}" if count else "the queue is empty"


def _object(number):
    return OBJECTS[number] if number < len(OBJECTS) else f"object {number:02X}"


def _identify(pdu):
    if len(pdu) != 4 or pdu[1] != 0x0E:
        return f"encapsulated interface, type {pdu[1]:02X}"
    code, first = pdu[2:]
    which = CATEGORIES[code] if code < len(CATEGORIES) else f"code {code:02X}"
    return f"read device identification, {which}" + (f", from {_object(first)} on" if code != INDIVIDUAL else "")


def identity(pdu):
    """{id: text} and what is said beside it, of an answer of function 2B."""
    objects, place = {}, 7
    for _ in range(pdu[6]):
        number, size = pdu[place : place + 2]
        objects[number] = pdu[place + 2 : place + 2 + size].decode("latin-1")
        place += 2 + size
    return objects


def _identified(_, pdu):
    objects = [f"{_object(i)} {value!r}" for i, value in identity(pdu).items()]
    more = f"; more from {_object(pdu[5])} on" if pdu[4] else ""
    return f"conformity {pdu[3]:02X}: {', '.join(objects)}{more}"


REQUESTS = {
    FC.READ_EXCEPTION_STATUS: lambda pdu: "read exception status",
    FC.DIAGNOSTICS: _diagnostics,
    FC.GET_EVENT_COUNTER: lambda pdu: "get the event counter",
    FC.GET_EVENT_LOG: lambda pdu: "get the event log",
    FC.REPORT_SERVER_ID: lambda pdu: "report server ID",
    FC.READ_FILE: lambda pdu: "read " + "; ".join(_records(*group) for group in groups(pdu)),
    FC.WRITE_FILE: lambda pdu: (
        "write " + "; ".join(f"{_records(f, r, len(v))} = {_joined(v)}" for f, r, v in groups(pdu))
    ),
    FC.READ_FIFO: lambda pdu: f"read FIFO queue at holding register {struct.unpack('>H', pdu[1:])[0]}",
    FC.READ_DEVICE_ID: _identify,
}
ANSWERS = {
    FC.READ_EXCEPTION_STATUS: lambda _, pdu: f"exception status {pdu[1]:02X} = {pdu[1]:08b}",
    FC.DIAGNOSTICS: _diagnosed,
    FC.GET_EVENT_COUNTER: _event_counter,
    FC.GET_EVENT_LOG: _event_log,
    FC.REPORT_SERVER_ID: _server_id,
    FC.READ_FILE: _file_read,
    FC.WRITE_FILE: lambda asked, pdu: "done (the request is repeated)" if pdu == asked else "not what was asked",
    FC.READ_FIFO: _fifo,
    FC.READ_DEVICE_ID: _identified,
}
