# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The event records of the PDM meter (PDM meter protocol, 3.7): what reading one register at 0001 answers.

What the document leaves open is decided in examples/modbus_pdm_record.v; this is the same in Python.
"""

import struct
from collections import deque
from dataclasses import dataclass

from . import frames
from .defs import EX, FC

RECORD_REGISTER = 0x0001
RECORD_BYTES = 12
CLOSED, OPEN = 2, 1
LAST_NUMBER = 0xFFFF
DEFAULT_DEPTH = 32


@dataclass(frozen=True)
class Event:
    """An event as the meter's logic reports it; `ms` is within the minute, `year` since 2000."""

    group: int
    code: int
    closed: bool
    ms: int
    minute: int
    hour: int
    day: int
    month: int
    year: int

    @classmethod
    def random(cls, rng):
        """Any event at any legal time."""
        return cls(
            group=rng.randrange(256),
            code=rng.randrange(256),
            closed=bool(rng.getrandbits(1)),
            ms=rng.randrange(60_000),
            minute=rng.randrange(60),
            hour=rng.randrange(24),
            day=rng.randint(1, 31),
            month=rng.randint(1, 12),
            year=rng.randrange(100),
        )

    @classmethod
    def of_record(cls, record):
        """(number, event) of a printed record."""
        number, group, code, action = struct.unpack(">HBBB", record[:5])
        ms, *rest = struct.unpack("<H5B", record[5:])
        return number, cls(group, code, action == CLOSED, ms, *rest)

    def record(self, number):
        """The twelve bytes on the line."""
        head = struct.pack(">HBBB", number, self.group, self.code, CLOSED if self.closed else OPEN)
        return head + struct.pack("<H5B", self.ms, self.minute, self.hour, self.day, self.month, self.year)


class EventRecords:
    """Numbers and keeps events; `answer` is a user hook of the model."""

    def __init__(self, depth=DEFAULT_DEPTH):
        self.depth = depth
        self.reset()

    def reset(self):
        """What rst_i does: forget everything."""
        self.unread, self.last, self.number = deque(), bytes(RECORD_BYTES), 0

    def add(self, event):
        """One more event; beyond `depth` the oldest unread one is dropped. Its number."""
        self.number = self.number % LAST_NUMBER + 1
        if len(self.unread) == self.depth:
            self.unread.popleft()
        self.unread.append(event.record(self.number))
        return self.number

    def read(self):
        """The oldest unread record, which is then read; with none left the last one again."""
        if self.unread:
            self.last = self.unread.popleft()
        return self.last

    def answer(self, pdu, busy=False, failure=0):
        """What the user port answers to a request PDU: PDU, exception code, or None for "not mine"."""
        if bytes(pdu) != frames.read(FC.READ_HOLDINGS, RECORD_REGISTER, 1):
            return None
        if busy:
            return EX.BUSY
        if failure:
            return failure
        return bytes([FC.READ_HOLDINGS, RECORD_BYTES]) + self.read()
