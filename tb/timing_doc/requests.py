# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The requests whose answers are measured, and the rules that their clocks follow."""

from dataclasses import dataclass
from fractions import Fraction

from protocol import frames
from protocol.defs import DEFAULT_OBJECTS, FC, Sub

from .device import OWN
from .lab import BITS, WORDS

BASIC = ("01", "02", "03", "04", "05", "06", "0F", "10", "exception 01", "exception 02", "exception 03")
USER_ANSWERS, USER_PASSES = 65, 66  # function codes of the user in timing_top
USER_CLOCKS = 2  # that he takes
FIFO_COUNT = 60  # the register that holds the count of FC 18


def read_write(sizes):
    """FC 17H request reading and writing so many registers."""
    return frames.read_write(0, sizes[0], 0, WORDS[: sizes[1]])


def read_records(sizes):
    """FC 14H request: (groups, registers in all), all but the last group with one register each."""
    return frames.read_files(*[(1, i, n) for i, n in enumerate(spread(*sizes))])


def write_records(sizes):
    """FC 15H request: likewise."""
    return frames.write_files(*[(1, i, WORDS[:n]) for i, n in enumerate(spread(*sizes))])


def spread(groups, registers):
    """Registers of each group."""
    return [1] * (groups - 1) + [registers - groups + 1]


@dataclass(frozen=True)
class Request:
    """Requests of one kind, and the rule that their clocks follow.

    `pdu` makes one of a quantity; `parts` says of what a quantity consists, in numbers, and `words` the rule in words:
    `{0}` are the clocks that it begins with and `{1}`, `{2}` ... those of each part. `before`: frames that make it so.
    """

    name: str
    pdu: object
    quantities: tuple
    words: str = "{0}"
    parts: object = lambda quantity: ()
    before: object = lambda quantity: ()
    quick: bool = True  # neither bits nor file records
    shown: str = ""  # a quantity in words, if not by its numbers
    wide: bool = False  # with BITS_PER_BEAT = 16

    def size(self, quantity):
        """A quantity in words."""
        if not self.parts(quantity):
            return "–"
        numbers = [quantity] if isinstance(quantity, int) else quantity
        return self.shown.format(*numbers) if self.shown else " + ".join(map(str, numbers))

    def ends(self):
        """The smallest and the largest quantity; only one where it takes no part in the clocks."""
        return list(
            dict.fromkeys(
                (self.quantities[0], self.quantities[-1] if self.parts(self.quantities[0]) else self.quantities[0])
            )
        )


def one(quantity):
    """A quantity that is a number of items."""
    return (quantity,)


def bits_read(quantity):
    """Bits, a last byte that is not full, and the bits in it."""
    return (quantity, int(quantity % 8 > 0), quantity % 8)


def fill_log(events):
    """Frames after which the log holds so many events, with that of the request that asks for it."""
    return [b"\x55"] * (events - 1)


def fifo(entries):
    """Frames that put the count of a queue in its place."""
    return [frames.adu(OWN, frames.write_register(FIFO_COUNT, entries))]


# FC 2BH: (code, object): bytes of the objects that are sent, objects of the category before the first of them, whether
# the one asked for is not there and all are sent
OBJECTS = [2 + len(text) for text in DEFAULT_OBJECTS.values()]
OBJECT_READS = {
    (1, 0): (sum(OBJECTS), 0, 0),
    (1, 1): (sum(OBJECTS[1:]), 1, 0),
    (1, 2): (sum(OBJECTS[2:]), 2, 0),
    (3, 0): (sum(OBJECTS), 0, 0),
    (4, 0): (OBJECTS[0], 0, 0),
    (4, 1): (OBJECTS[1], 1, 0),
    (4, 2): (OBJECTS[2], 2, 0),
    (1, 9): (sum(OBJECTS), 3, 1),
}

BITS_READ = {"words": "{0} + {1} a bit, + {2} − r if the last byte has only r bits", "parts": bits_read, "quick": False}
A_WORD_OF_BITS = {
    "words": "{0} + {1} for each 16 bits begun",
    "parts": lambda quantity: (-(-quantity // 16),),
    "shown": "{0}",
    "quick": False,
    "wide": True,
}
A_REGISTER = {"words": "{0} + {1} a register", "parts": one}
A_RECORD = {
    "words": "{0} + {1} a group + {2} a register",
    "parts": lambda sizes: sizes,
    "quick": False,
    "shown": "groups {0}, registers {1}",
}


def sub(number, *data):
    """FC 08 with a sub-function."""
    return lambda quantity: frames.diagnostics(number, *(data if quantity is None else [0] * quantity))


REQUESTS = (
    Request("01", lambda n: frames.read(FC.READ_COILS, 0, n), (1, 7, 8, 9, 100, 2000), **BITS_READ),
    Request("02", lambda n: frames.read(FC.READ_DISCRETES, 0, n), (1, 7, 8, 2000), **BITS_READ),
    Request(
        "01, 16 bits a beat",
        lambda n: frames.read(FC.READ_COILS, 0, n),
        (1, 7, 8, 9, 16, 17, 100, 2000),
        **A_WORD_OF_BITS,
    ),
    Request("02, 16 bits a beat", lambda n: frames.read(FC.READ_DISCRETES, 0, n), (1, 40, 2000), **A_WORD_OF_BITS),
    Request("03", lambda n: frames.read(FC.READ_HOLDINGS, 0, n), (1, 2, 60, 125), **A_REGISTER),
    Request("04", lambda n: frames.read(FC.READ_INPUTS, 0, n), (1, 125), **A_REGISTER),
    Request("05", lambda n: frames.write_coil(0, True), (1,)),
    Request("06", lambda n: frames.write_register(0, 0x1234), (1,)),
    Request("07", lambda n: frames.bare(FC.READ_EXCEPTION_STATUS), (None,)),
    Request("08, 00", sub(Sub.QUERY_DATA), (1, 2, 125)),
    Request("08, 01", sub(Sub.RESTART, 0), (None,)),
    Request("08, 02", sub(Sub.DIAGNOSTIC_REGISTER, 0), (None,)),
    Request("08, 03", sub(Sub.DELIMITER, 0x0A00), (None,)),
    Request("08, 0A", sub(Sub.CLEAR, 0), (None,)),
    Request("08, 0B to 12", lambda n: frames.diagnostics(n, 0), (Sub.BUS_MESSAGE, Sub.BUS_CHAR_OVERRUN)),
    Request("08, 14", sub(Sub.CLEAR_OVERRUN, 0), (None,)),
    Request("0B", lambda n: frames.bare(FC.GET_EVENT_COUNTER), (None,)),
    Request(
        "0C", lambda n: frames.bare(FC.GET_EVENT_LOG), (1, 2, 64), "{0} + {1} an event", parts=one, before=fill_log
    ),
    Request("0F", lambda n: frames.write_coils(0, BITS[:n]), (1, 7, 8, 9, 1968), "{0} + {1} a bit", one, quick=False),
    Request(
        "0F, 16 bits a beat", lambda n: frames.write_coils(0, BITS[:n]), (1, 9, 17, 100, 1968), **A_WORD_OF_BITS
    ),
    Request("10", lambda n: frames.write_registers(0, WORDS[:n]), (1, 2, 123), **A_REGISTER),
    Request("11", lambda n: frames.bare(FC.REPORT_SERVER_ID), (None,)),
    Request("14", read_records, ((1, 1), (1, 2), (2, 2), (2, 60), (1, 121), (35, 87)), **A_RECORD),
    Request("15", write_records, ((1, 1), (1, 2), (2, 2), (2, 60), (1, 122), (27, 31)), **A_RECORD),
    Request("16", lambda n: frames.mask_write(0, 0x00FF, 0xAA55), (1,)),
    Request(
        "17",
        read_write,
        ((1, 1), (2, 1), (1, 2), (125, 121)),
        "{0} + {1} a register read or written",
        lambda sizes: (sum(sizes),),
    ),
    Request(
        "18",
        lambda n: frames.read_fifo(FIFO_COUNT),
        (0, 1, 2, 31),
        "{0} + {1} an entry",
        one,
        before=fifo,
    ),
    Request(
        "2B",
        lambda what: frames.device_identification(*what),
        tuple(OBJECT_READS),
        "{0} + {1} a byte of the objects + {2} an object before the first sent + {3} if the one asked for is not there",
        lambda what: OBJECT_READS[what],
        shown="code {0}, object {1}",
    ),
    Request("exception 01", lambda n: b"\x41", (None,)),
    Request("exception 02", lambda n: frames.read(FC.READ_HOLDINGS, 1000, 1), (None,)),
    Request("exception 03", lambda n: frames.read(FC.READ_HOLDINGS, 0, 126), (None,)),
)
BY_NAME = {request.name: request for request in REQUESTS}
MOST_RECORDS = {"14": 121, "15": 122}  # in one group; the I/O bank has no files


def fit(request, clocks):
    """The numbers of the rule (clocks to begin with, clocks of each part). AssertionError if there is no such rule.

    `clocks`: {quantity: clocks}.
    """
    rows = [[Fraction(v) for v in (1, *request.parts(q), seen)] for q, seen in clocks.items()]
    numbers = len(rows[0]) - 1
    for column in range(numbers):  # elimination; what is left over must be 0
        pivot = next(row for row in rows[column:] if row[column])
        rows.remove(pivot)
        rows = [
            [a - b * row[column] / pivot[column] for a, b in zip(row, pivot)] if row[column] else row for row in rows
        ]
        rows.insert(column, [value / pivot[column] for value in pivot])
    assert not any(any(row) for row in rows[numbers:]), f"FC {request.name} follows no rule: {clocks}"
    out = [row[-1] for row in rows[:numbers]]
    assert all(value.denominator == 1 for value in out), f"FC {request.name} follows no rule: {clocks}"
    return [int(value) for value in out]
