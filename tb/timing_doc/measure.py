# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Measures every figure of docs/timing.md at the pins and writes it as the tables of that document."""

import math
import random
import re
from dataclasses import dataclass
from fractions import Fraction

from harness import wave
from protocol import frames
from protocol.defs import DEFAULT_OBJECTS, F8E1, F8N1, F8N2, F8O1, FC, Space, Sub, bus_address

from .device import ERRORS, JUDGED, OWN, Device, mask

CLK_HZ = 50_000_000
BIT_115200 = 434  # clocks per bit at 115200 baud
FEW = 16  # clocks per bit of the fast links
FLOOR_T15, FLOOR_T35 = CLK_HZ * 750 // 1_000_000, CLK_HZ * 1750 // 1_000_000
OTHER = 99  # another slave's address: the frame is judged and not answered
WORDS = [(0x1357 * i + 0x2468) & 0xFFFF for i in range(125)]
BITS = [(i // 3) & 1 for i in range(2000)]


def t15(bit_time, fmt=F8E1, floors=True):
    """t1.5 in clocks."""
    return max(1.5 * fmt.length * bit_time, FLOOR_T15 if floors else 0)


def t35(bit_time, fmt=F8E1, floors=True):
    """t3.5 in clocks."""
    return max(3.5 * fmt.length * bit_time, FLOOR_T35 if floors else 0)


def number(value):
    """A count with a separator for thousands; fractions with what they need."""
    if abs(value - round(value)) < 1e-9:
        return f"{round(value):,}".replace(",", " ")
    return f"{value:,.2f}".replace(",", " ")


def table(head, rows, left=1):
    """A Markdown table; the first `left` columns are text."""
    mark = ["---"] * left + ["--:"] * (len(head) - left)
    lines = [head, mark, *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


class Lab:
    """The compiled devices, each made when it is first wanted."""

    def __init__(self):
        self._made = {}

    def __call__(self, io=0, floors=0, build="full"):
        key = (io, floors, build)
        if key not in self._made:
            self._made[key] = Device(IO=io, FLOORS=floors, **BUILDS[build])
        return self._made[key]


# ------------------------------------------------------------------ start of the answer

BUILDS = {"basic": {"FULL": 0, "MORE": 0}, "full": {"FULL": 1, "MORE": 0}, "more": {"FULL": 1, "MORE": 1}}
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


def start(device, request, quantity, floors):
    """(clocks from the end of t3.5 to frame_stb_o, from there to the start bit) for one request."""
    silence = t35(device.bit_time, device.fmt, floors)
    device.reset(silence + 4 * device.bit_time)
    for frame in request.before(quantity):
        device.request(frame, silence + 100 * device.bit_time)
    wait = silence + 5000 + device.bit_time
    end, log = device.request(frames.adu(OWN, request.pdu(quantity)), wait, log=mask("txd frame"))
    seen, begun = log.rises("frame")[0], log.falls("txd")[0]
    return seen - end - silence, begun - seen


def measure_starts(lab):
    """({(build, name, quantity): clocks of the work}, {(bit time, floors): clocks by which t3.5 is seen late})."""
    work, late = {}, {}
    places = [(0, FEW, 0, "basic"), (0, FEW, 0, "full"), (1, FEW, 0, "full")]
    places += [(0, BIT_115200, 1, "basic"), (0, BIT_115200, 1, "full")]
    for io, bit_time, floors, build in places:
        device = lab(io, floors, build)
        device.setup(bit_time)
        for request in REQUESTS:
            if (build == "basic" and request.name not in BASIC) or (io and request.name in MOST_RECORDS):
                continue
            # The whole sweep where it is quick, the ends where it is slow
            name, few = request.name, bit_time == FEW
            for quantity in request.quantities if few else request.ends()[: 1 if request.before(2) else 2]:
                after, clocks = start(device, request, quantity, floors)
                late.setdefault((bit_time, floors), set()).add(after)
                before = work.setdefault((build, name, quantity), clocks)
                assert clocks == before, (
                    f"FC {name} of {request.size(quantity)}, {build}, {'I/O' if io else 'RAM'} bank, {bit_time} "
                    f"clocks per bit: {clocks} clocks, elsewhere {before}"
                )
    for floors, bit_times in ((0, (8, 17, 100, BIT_115200)), (1, (FEW, 2604))):
        for bit_time in bit_times:
            device = lab(0, floors)
            device.setup(bit_time)
            late[bit_time, floors] = {start(device, BY_NAME["exception 01"], None, floors)[0]}
    return work, late


def users(lab, rules):
    """Rows of table `more`: what user functions add, and a long server identification."""
    device = lab(0, 0, "more")
    device.setup(FEW)

    def clocks(name, quantity=None):
        return start(device, BY_NAME[name], quantity, 0)[1]

    def of_user(code):
        return start(device, Request("user", lambda n: bytes([code]), (None,)), None, 0)[1]

    added = {clocks(n, q) - rule_of(rules["full", n], BY_NAME[n], q) for n, q in (("03", 1), ("06", 1), ("14", (2, 2)))}
    assert len(added) == 1, f"with user functions the built-in ones take {added} clocks more"
    (more,) = added
    answered, passed = (of_user(code) - USER_CLOCKS for code in (USER_ANSWERS, USER_PASSES))
    extra = passed - rules["full", "exception 01"][0]
    a_byte = rules["full", "2B"][1]
    head = clocks("11") - more - rules["full", "11"][0]  # 15 bytes more in the identifier, 234 behind it
    step = head - a_byte * (15 + 234)
    return [
        ["11, for each byte more of the identifier or of the additional data", f"+ {a_byte}"],
        ["11, if there are additional data", f"+ {step}"],
        ["any built-in function, if `USER_CODES` is not 0", f"+ {more}"],
        ["a code that the user passes on", f"+ {extra}, and the clocks of `user_req_o`"],
        ["a code that the user answers", f"{answered}, and the clocks of `user_req_o`"],
    ]


def rule_of(numbers, request, quantity):
    """Clocks by the rule."""
    return numbers[0] + sum(n * part for n, part in zip(numbers[1:], request.parts(quantity)))


def in_words(request, numbers):
    """A rule in words."""
    numbers = list(numbers)
    if request.parts is bits_read:
        assert numbers[3] == -1
    return request.words.format(*numbers)


def answer_starts(lab):
    """Tables `rule`, `more`, `seen`, `start115200`, `start16` and `holds`."""
    work, late = measure_starts(lab)
    rules = {}
    for build in ("basic", "full"):
        for request in REQUESTS:
            found = {q: work[build, request.name, q] for q in request.quantities if (build, request.name, q) in work}
            if found:
                rules[build, request.name] = fit(request, found)
    rows = []
    for request in REQUESTS:
        full, basic = (rules.get((build, request.name)) for build in ("full", "basic"))
        assert basic is None or basic[1:] == full[1:], f"FC {request.name}: {basic} and {full}"
        rows.append(
            [request.name, "–" if basic is None else basic[0], full[0], in_words(request, ["", *full[1:]]).strip()]
        )
    out = {
        "rule": table(["function", "basic", "full", "and"], [[a, b, c, d or "–"] for a, b, c, d in rows], 1),
        "more": table(["function", "clocks"], users(lab, rules), 2),
        "seen": table(
            ["clocks per bit", "floors", "t3.5, clocks", "D"],
            [
                [bit_time, "on" if floors else "0", number(t35(bit_time, F8E1, floors)),
                 " or ".join(number(d) for d in sorted(found))]
                for (bit_time, floors), found in sorted(late.items())
            ],
            2,
        ),
    }  # fmt: skip
    for name, bit_time, floors in (("start115200", BIT_115200, 1), ("start16", FEW, 0)):
        silence, rows = t35(bit_time, F8E1, floors), []
        delay = max(late[bit_time, floors])
        for request in REQUESTS:
            for quantity in request.ends():
                basic, full = (work.get((build, request.name, quantity)) for build in ("basic", "full"))
                clocks = full + delay
                share = 100 * clocks / silence
                rows.append([
                    request.name, request.size(quantity), "–" if basic is None else number(basic + delay),
                    number(clocks), f"{clocks / bit_time:.2f}", f"{share:.2f} %",
                    "yes" if clocks <= bit_time else "no", "yes" if share <= 2 else "no",
                ])  # fmt: skip
        head = [
            "function",
            "quantity",
            "basic, clocks",
            "full, clocks",
            "bit times",
            "of t3.5",
            "within 1 bit",
            "within 2 %",
        ]
        out[name] = table(head, rows, 2)
    out["holds"] = holds(rules, max(max(found) for found in late.values()))
    return out


def holds(rules, delay):
    """Table `holds`: up to where the goals are reached, in both builds."""
    percent, two_percent = t35(BIT_115200) // 50, 0.02 * 38.5  # of t3.5: clocks, and bit times without floors

    def most(name, budget, items, waits=0):
        """The most items of which a request keeps within so many clocks, not counting so many waits an item."""

        def of(numbers):
            slack = max(0, numbers[2] - 1) if BY_NAME[name].parts is bits_read else 0
            return f"up to {(int(budget - delay) - numbers[0] - slack) // (numbers[1] - waits)} {items}"

        return name, of

    def records(name, budget):
        """Likewise of file records: registers in one group, groups of one register."""

        def of(numbers):
            first, group, register = numbers
            left, most = int(budget - delay) - first, MOST_RECORDS[name]
            one = min((left - group) // register, most)
            return f"one group of {'all ' if one == most else ''}{one}; groups of 1: {left // (group + register)}"

        return name, of

    def bit_time(name, quantity, bits):
        """The fewest clocks per bit at which a request keeps within so many bit times."""

        def of(numbers):
            return f"from {math.ceil((rule_of(numbers, BY_NAME[name], quantity) + delay) / bits)} clocks per bit"

        return name, of

    at = "115200 baud, 50 MHz: "
    both, sizes = "FC 17, 125 + 121 registers", (125, 121)
    plans = [
        (at + "FC 01 and 02 within t3.5 + 2 %", most("01", percent, "bits")),
        ("the same, the RAM's wait state of each beat not counted", most("01", percent, "bits", 1)),
        (at + "FC 0F within t3.5 + 2 %", most("0F", percent, "bits")),
        (at + "FC 14 within t3.5 + 2 %, registers", records("14", percent)),
        (at + "FC 15 within t3.5 + 2 %, registers", records("15", percent)),
        (at + "FC 14 within 1 bit, registers", records("14", BIT_115200)),
        (at + "FC 15 within 1 bit, registers", records("15", BIT_115200)),
        (at + "FC 17 within 1 bit", most("17", BIT_115200, "registers, read plus written")),
        (at + "FC 2B within 1 bit, from object 00 on", most("2B", BIT_115200, "bytes of objects")),
        ("FC 03, 1 register, within 1 bit", bit_time("03", 1, 1)),
        ("FC 03, 125 registers, within 1 bit", bit_time("03", 125, 1)),
        ("FC 10, 123 registers, within 1 bit", bit_time("10", 123, 1)),
        (f"{both}, within 1 bit", bit_time("17", sizes, 1)),
        ("FC 03, 1 register, within t3.5 + 2 %, floors 0", bit_time("03", 1, two_percent)),
        ("FC 10, 123 registers, within t3.5 + 2 %, floors 0", bit_time("10", 123, two_percent)),
        (f"{both}, within t3.5 + 2 %, floors 0", bit_time("17", sizes, two_percent)),
        ("FC 01, 2000 coils, within t3.5 + 2 %, floors 0", bit_time("01", 2000, two_percent)),
    ]
    rows = []
    for what, (name, figure) in plans:
        found = [rules.get((build, name)) for build in ("basic", "full")]
        rows.append([what, *("–" if numbers is None else figure(numbers) for numbers in found)])
    for what, kinds in (
        ("every answer", REQUESTS),
        ("all but bits and file records", [r for r in REQUESTS if r.quick]),
    ):
        slowest = []
        for build in ("basic", "full"):
            clocks = max(
                rule_of(rules[build, r.name], r, q) for r in kinds if (build, r.name) in rules for q in r.quantities
            )
            slowest.append(f"from {math.ceil((clocks + delay) / 11)} clocks per bit")
        rows.append([f"{what}, within one character time", *slowest])
    return table(["figure", "basic", "full"], rows, 3)


# ------------------------------------------------------------------ driver enable, transmission


def driver(lab):
    """Table `de`: lead and tail for the settings 0 to 15."""
    device, found = lab(), {}
    for bit_time in (FEW, BIT_115200):
        for setting in range(16):
            device.setup(bit_time, de_lead=setting, de_tail=15 - setting)
            _, log = device.request(frames.adu(OWN, b"\x41"), (39 + 16 + 55 + 20) * bit_time, log=mask("txd de"))
            answer = wave.decode(log.edges("txd"), F8E1, bit_time)
            (rise,), (fall,) = log.rises("de"), log.falls("de")
            found[bit_time, "lead", setting] = answer.start - rise
            found[bit_time, "tail", 15 - setting] = fall - answer.end
    rules, rows = {}, []  # clocks beyond the bits: setting 0, others
    for bit_time in (FEW, BIT_115200):
        for setting in range(16):
            for side in ("lead", "tail"):
                rules.setdefault((side, setting == 0), set()).add(found[bit_time, side, setting] - setting * bit_time)
        for setting in (0, 1, 2, 7, 15):
            rows.append([bit_time, setting, *(number(found[bit_time, side, setting]) for side in ("lead", "tail"))])
    extra = table(
        ["clocks beyond n bit times", "setting 0", "setting n = 1 to 15"],
        [
            [side, *(" or ".join(number(c) for c in sorted(rules[side, zero])) for zero in (True, False))]
            for side in ("lead", "tail")
        ],
    )
    return {
        "de": table(
            ["clocks per bit", "setting", "driver on to start bit, clocks", "last stop bit to driver off, clocks"],
            rows,
            2,
        ),
        "derule": extra,
    }


def transmission(lab):
    """Table `gapfree`: the longest answer in every format."""
    device, rows = lab(), []
    device.setup(FEW)
    fill_holdings(device)
    plans = [(fmt, bit_time) for fmt in (F8E1, F8O1, F8N2, F8N1) for bit_time in (8, 17)]
    plans += [(F8E1, 100), (F8E1, BIT_115200)]
    for fmt, bit_time in plans:
        device.setup(bit_time, fmt)
        _, log = device.request(
            frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 125)),
            (fmt.length * 260 + 50) * bit_time + 500,
            log=mask("txd de"),
        )
        got = wave.decode(log.edges("txd"), fmt, bit_time)  # demands that every edge is on the grid
        assert got.data == frames.adu(OWN, bytes([3, 250]) + frames.pack_words(WORDS))
        line = len(got.data) * fmt.length * bit_time
        rows.append(
            [fmt.name, bit_time, len(got.data), number(got.end - got.start), number(got.end - got.start - line)]
        )
    return {
        "gapfree": table(
            ["format", "clocks per bit", "characters", "clocks, first start bit to end of last stop bit",
             "more than characters × bits × clocks"], rows, 1,
        )
    }  # fmt: skip


def host_access(device, address, data=None, last=True, limit=20_000):
    """One access of the host port from the clock that is now; clocks up to and with the answering one."""
    device.host(1, 1, data is not None, address, data or 0)
    for clocks in range(1, limit):
        peek = device.peek()
        device.run(1)
        if peek.host_ack or peek.host_err:
            if last:
                device.host()
            return clocks, peek
    raise AssertionError("the host port does not answer")


def fill_holdings(device):
    """WORDS into the holding registers."""
    for item, word in enumerate(WORDS):
        host_access(device, bus_address(Space.HOLDINGS, item), word, last=item == len(WORDS) - 1)
    device.run(1)


# ------------------------------------------------------------------ receiver


def quick(device, line, **how):
    """True if the first verdict about a frame is good; stops there and resets."""
    wait = t35(device.bit_time, device.fmt, False) + 12 * device.bit_time + 60
    _, _ = device.request(line, wait, stop=JUDGED, **how)
    peek = device.peek()
    good = bool(peek.frame) and not any(getattr(peek, name) for name in ERRORS)
    device.reset()
    return good


def mismatch(lab):
    """Table `baud`: the largest mismatch at which every frame of 256 bytes came through."""
    device, rng, rows = lab(), random.Random(1), []
    body = [bytes([0] * 254), bytes([0xFF] * 254), rng.randbytes(254)]
    long_frames = [frames.sealed(bytes([OTHER]) + data[1:]) for data in body]
    for bit_time in (8, FEW, 100):
        device.setup(bit_time)
        tried = long_frames if bit_time < 100 else long_frames[2:]
        phases = (0, 0.5) if bit_time < 100 else (0,)

        def works(permille, tried=tried, phases=phases):
            return all(
                quick(device, frame, offset=permille / 1000, phase=1 + phase) for frame in tried for phase in phases
            )

        wanted, limits = (2 if bit_time < 16 else 4), []
        for sign in (1, -1):
            good = 0
            for step in (10, 1):
                while good < 100 and works(sign * (good + step)):
                    good += step
            limits.append(good / 10)
        met = "yes" if min(limits) >= wanted else "no"
        rows.append([bit_time, *(f"{limit:.1f} %" for limit in limits), f"{wanted} %", met])
    return {
        "baud": table(["clocks per bit", "sender slower by up to", "sender faster by up to", "wanted", "met"], rows)
    }


SHORT = frames.sealed(bytes([OTHER, 0xA5]))


def looks(lab):
    """Table `looks`: the clocks of a bit in which the line is looked at."""
    device, rows = lab(), []
    place = 11 + 4  # the fourth data bit of the second character: 0 in A5, its neighbours 1 and 0
    for bit_time in (8, 9, 10, 11, FEW, 100, BIT_115200):
        device.setup(bit_time)
        begin = place * bit_time

        def broken(*spikes, begin=begin):
            """The line inverted in these (first, count) clocks of the bit: is the bit lost?"""
            return not quick(device, SHORT, phase=1, spikes=[(begin + b, w) for b, w in spikes])

        # Inverted up to the second look the bit is lost.  With the second look taken, either other one will do.
        second = first_true(lambda x, lost=broken: lost((0, x + 1)), bit_time)
        first = first_true(lambda x, lost=broken, two=second: lost((0, x + 1), (two, 1)), second)
        third = second + first_true(lambda x, lost=broken, two=second: lost((two, 1), (two + 1, x)), bit_time - second)
        rows.append([bit_time, *(f"{x} to {x + 1}" for x in (first, second, third)),
                     ", ".join(f"{(x + 0.5) / bit_time:.3f}" for x in (first, second, third))])  # fmt: skip
    head = ["clocks per bit", "first look", "second", "third", "mean, in bit times"]
    return {"looks": table(head, rows)}


def first_true(test, limit, guess=None):
    """The smallest x from 0 on for which the monotonic `test` holds; a good `guess` saves time."""
    low, high = -1, limit
    if guess is not None and 0 <= guess < limit:
        if test(guess):
            high = guess
            if guess and not test(guess - 1):
                low = guess - 1
        else:
            low = guess
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if test(middle) else (middle, high)
    return high


def spikes(lab):
    """Table `spikes`: the widest spike that changed nothing, wherever it was."""
    device, rows = lab(), []
    for bit_time, step in ((8, 1), (FEW, 3), (100, 13)):
        device.setup(bit_time)
        span = 46 * bit_time
        widest = 0
        for width in range(1 if bit_time < 100 else 24, bit_time):
            # from a bit before the frame to a bit behind it
            places = range(2, span, step)
            if not all(quick(device, SHORT, phase=1 + bit_time, spikes=[(at - bit_time, width)]) for at in places):
                break
            widest = width
        rows.append([bit_time, len(places), widest, f"{widest / bit_time:.3f}"])
    return {"spikes": table(["clocks per bit", "places tried", "widest harmless spike, clocks", "in bit times"], rows)}


# ------------------------------------------------------------------ silence


def silences(lab):
    """Table `silence`: t1.5 and t3.5 as the device sees them."""
    rows = []
    for baud, floors in ((9600, 1), (19200, 1), (38400, 1), (115200, 1), (115200, 0)):
        device = lab(0, floors)
        bit_time = round(CLK_HZ / baud)
        device.setup(bit_time)
        want15, want35 = t15(bit_time, F8E1, floors), t35(bit_time, F8E1, floors)
        bit_end = 2 * bit_time
        quarter = bit_time // 4
        base15, base35 = math.ceil(want15) - bit_time, math.ceil(want35) - bit_time
        floor15, floor35 = want15 > 16.5 * bit_time, want35 > 38.5 * bit_time
        device.reset(want35 + bit_end)
        found15 = base15 + first_true(
            lambda x, args=(device, base15, want35): spoils(args[0], args[1] + x, args[2]),
            bit_end,
            bit_time - 2 * quarter + 2 if floor15 else bit_time - quarter,
        )
        found35 = base35 + first_true(
            lambda x, args=(device, base35, want35): two_frames(args[0], args[1] + x, args[2]),
            bit_end,
            bit_time - 2 * quarter + 21 if floor35 else bit_time - quarter,
        )
        end, log = device.request(SHORT, want35 + bit_time, log=mask("frame"))
        ended = log.rises("frame")[0] - end
        rows.append(
            [baud, "on" if floors else "0", bit_time]
            + [number(want15), number(found15), f"{(found15 - want15) / bit_time:+.2f}"]
            + [number(want35), number(ended), number(ended - want35)]
            + [number(found35), f"{(found35 - want35) / bit_time:+.2f}"]
        )
    return {
        "silence": table(
            ["baud", "floors", "clocks per bit", "t1.5", "shortest gap that spoils", "bits off",
             "t3.5", "frame ends after", "clocks late", "shortest gap between frames", "bits off"], rows,
        )
    }  # fmt: skip


def gapped(device, line, place, clocks):
    """(edges, end) of a line with a silence of so many clocks before character `place`."""
    one, end = device.wave(line[:place])
    two, last = device.wave(line[place:], phase=end + clocks)
    return one + two, last


def spoils(device, clocks, silence):
    """True if a frame with so many clocks of silence in it is discarded for the gap."""
    edges, end = gapped(device, SHORT, 2, clocks)
    log = device.run(end + silence + device.bit_time, edges, log=JUDGED)
    return bool(log.rises("gap"))


def two_frames(device, clocks, silence):
    """True if two frames with so many clocks between them are both heard as good."""
    edges, end = gapped(device, SHORT + SHORT, len(SHORT), clocks)
    log = device.run(end + silence + device.bit_time, edges, log=JUDGED)
    return len(log.rises("frame")) == 2 and not any(log.rises(name) for name in ERRORS)


# ------------------------------------------------------------------ a whole transaction


def transaction(lab):
    """Table `transaction`: 125 registers at 115200 baud."""
    device = lab(0, 1)
    device.setup(BIT_115200)
    device.reset(FLOOR_T35 + 1000)
    frame = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 125))
    begin = device.now
    request_end, log = device.request(frame, FLOOR_T35 + 256 * 11 * BIT_115200 + 2000, log=mask("txd de"))
    answer = wave.decode(log.edges("txd"), F8E1, BIT_115200)
    assert len(answer.data) == 255
    pieces = [
        ("request, 8 characters", request_end - begin, 8 * 11 * BIT_115200),
        ("silence before the answer", answer.start - request_end, FLOOR_T35),
        ("answer, 255 characters", answer.end - answer.start, 255 * 11 * BIT_115200),
        ("silence before the next request", FLOOR_T35, FLOOR_T35),
    ]
    pieces.append(("total", *(sum(piece[i] for piece in pieces) for i in (1, 2))))
    rows = [
        [name, number(got), *(f"{n / CLK_HZ * 1e3:.3f}" for n in (got, line)), f"{100 * (got / line - 1):+.2f} %"]
        for name, got, line in pieces
    ]
    return {"transaction": table(["part", "clocks", "ms", "ms the line needs", "more"], rows)}


# ------------------------------------------------------------------ bus and host port


def to_grant(device, pdu):
    """Send a request and run to the clock in which the bank is asked."""
    device.reset()
    edges, end = device.wave(frames.adu(OWN, pdu))
    device.run(end + 60 * device.bit_time + 5000, edges, mask("grant_req"))
    assert device.peek().grant_req


BUS_REQUESTS = (
    ("FC 03, 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
    ("FC 03, 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
    ("FC 18, 31 entries", frames.read_fifo(FIFO_COUNT)),
    ("FC 10, 1 register", frames.write_registers(0, WORDS[:1])),
    ("FC 10, 123 registers", frames.write_registers(0, WORDS[:123])),
    ("FC 01, 1 coil", frames.read(FC.READ_COILS, 0, 1)),
    ("FC 01, 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
    ("FC 0F, 1968 coils", frames.write_coils(0, BITS[:1968])),
    ("FC 16", frames.mask_write(0, 1, 2)),
    ("FC 17, 125 + 121 registers", read_write((125, 121))),
    ("FC 14, 1 group of 121 registers", read_records((1, 121))),
    ("FC 14, 35 groups, 87 registers", read_records((35, 87))),
    ("FC 15, 1 group of 122 registers", write_records((1, 122))),
    ("FC 15, 27 groups, 31 registers", write_records((27, 31))),
)


def bus(lab):
    """Table `bus`: the grant question and the burst, in clocks; the same in both builds."""
    full, basic = (bus_rows(lab(0, 0, build), build) for build in ("full", "basic"))
    assert [row for row in full if row[0] in [name for name, *_ in basic]] == basic, f"{full} but {basic}"
    head = ["request", "grant asked to given", "given to `wb_cyc_o`", "beats", "`wb_cyc_o` high"]
    return {"bus": table([*head, "`write_stb_o`, from `wb_cyc_o`'s"], full)}


def bus_rows(device, build):
    """Its rows for one build."""
    rows = []
    device.setup(8)
    host_access(device, bus_address(Space.HOLDINGS, FIFO_COUNT), 31)
    device.run(1)
    for name, pdu in BUS_REQUESTS:
        if build == "basic" and name.split()[1].strip(",") not in BASIC:
            continue
        to_grant(device, pdu)
        asked = device.now
        log = device.run(9000, stop=mask("de"), log=mask("grant_req grant_ack wb_cyc wb_stb wb_ack write"))
        granted = log.rises("grant_ack")[0]
        up, down = log.rises("wb_cyc"), log.falls("wb_cyc")
        assert len(up) == 1, f"{name}: {len(up)} bursts"
        beats = len(log.rises("wb_ack"))
        write = log.rises("write")
        told = "–"
        if write:
            told = f"fall + {write[0] - down[0]}" if write[0] >= down[0] else f"rise + {write[0] - up[0]}"
        rows.append([name, granted - asked + 1, up[0] - granted, beats, number(down[0] - up[0]), told])
    return rows


def host(lab):
    """Table `host`: accesses of the host port and what they wait for."""
    device, rows = lab(), []
    device.setup(8)
    address = bus_address(Space.HOLDINGS, 5)
    nowhere = bus_address(Space.HOLDINGS, 125)
    first, _ = host_access(device, address, 0xCAFE, last=False)
    second, _ = host_access(device, address, last=False)
    third, got = host_access(device, address, last=True)
    assert got.host_dat == 0xCAFE
    device.run(1)
    missing, got = host_access(device, nowhere)
    assert got.host_err
    host_access(device, bus_address(Space.HOLDINGS, FIFO_COUNT), 31)
    device.run(1)
    rows += [
        ["first access of a `host_cyc_i`, memory free", first],
        ["each further access under the same `host_cyc_i`", f"{second}" if second == third else f"{second}, {third}"],
        ["an item that does not exist, to `host_err_o`", missing],
    ]
    for name, pdu in (
        ("a read of 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
        ("a read of 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
        ("FC 18, 31 entries", frames.read_fifo(FIFO_COUNT)),
        ("a write of 123 registers", frames.write_registers(0, WORDS[:123])),
        ("FC 16", frames.mask_write(0, 1, 2)),
        ("FC 17, 125 + 121 registers", read_write((125, 121))),
        ("a write of 1968 coils", frames.write_coils(0, BITS[:1968])),
        ("a read of 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
        ("FC 14, 35 groups, 87 registers", read_records((35, 87))),
        ("FC 15, 1 group of 122 registers", write_records((1, 122))),
        ("FC 15, 27 groups, 31 registers", write_records((27, 31))),
    ):
        to_grant(device, pdu)
        device.run(6000, stop=mask("wb_cyc"))
        waits, _ = host_access(device, address)
        rows.append([f"an access that begins with the burst of {name}", number(waits)])
    # The other way round: the core waits for the host.
    for hold in (100, 1000):
        device.reset()
        device.host(1)
        to_wait = device.wave(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 1)))
        device.run(to_wait[1] + 60 * device.bit_time, to_wait[0], mask("grant_req"))
        device.run(hold)
        device.host()
        log = device.run(1000, stop=mask("de"), log=mask("grant_ack"))
        given = log.rises("grant_ack")[0] - log.when[0]
        if hold == 100:
            kept = given
        assert given == kept
    rows.append(["`host_cyc_i` down to the grant, when the core waited for the host", kept])
    return {"host": table(["host port of `modbus_rtu_slave`", "clocks"], rows)}


# ------------------------------------------------------------------ the document

SECTIONS = (answer_starts, driver, transmission, looks, mismatch, spikes, silences, transaction, bus, host)


def everything(lab, clock=None):
    """{table name: Markdown} of all tables; `clock`, if given, is told the time each section took."""
    out = {}
    for section in SECTIONS:
        begin = clock() if clock else 0
        out.update(section(lab))
        if clock:
            print(f"{section.__name__}: {clock() - begin:.1f} s", flush=True)
    return out


MARK = re.compile(r"(<!-- measured (\w+) begin -->\n)(.*?)(<!-- measured \2 end -->)", re.DOTALL)


def tables_of(text):
    """{table name: Markdown} of the marked tables in a document."""
    return {name: body.strip() for _, name, body, _ in MARK.findall(text)}


def put_tables(text, measured):
    """The document with its marked tables replaced by what was measured."""
    return MARK.sub(lambda m: f"{m[1]}{measured[m[2]]}\n{m[4]}", text)
