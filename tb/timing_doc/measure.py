# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Measures every figure of docs/timing.md at the pins and writes it as the tables of that document."""

import math
import random
import re

from mbrtu import frames, wave
from mbrtu.defs import F8E1, F8N1, F8N2, F8O1, FC, Space, bus_address

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
    """The three compiled devices, each made when it is first wanted."""

    def __init__(self):
        self._made = {}

    def __call__(self, io=0, floors=0):
        key = (io, floors)
        if key not in self._made:
            self._made[key] = Device(IO=io, FLOORS=floors)
        return self._made[key]


# ------------------------------------------------------------------ start of the answer


def read_write(sizes):
    """FC 17H request reading and writing so many registers."""
    return frames.read_write(0, sizes[0], 0, WORDS[: sizes[1]])


# name, PDU of a quantity, quantities, what an item is called (None: one request, one figure)
REQUESTS = (
    ("01", lambda n: frames.read(FC.READ_COILS, 0, n), (1, 7, 8, 9, 100, 2000), "bit"),
    ("02", lambda n: frames.read(FC.READ_DISCRETES, 0, n), (1, 7, 8, 2000), "bit"),
    ("03", lambda n: frames.read(FC.READ_HOLDINGS, 0, n), (1, 2, 60, 125), "register"),
    ("04", lambda n: frames.read(FC.READ_INPUTS, 0, n), (1, 125), "register"),
    ("05", lambda n: frames.write_coil(0, True), (1,), None),
    ("06", lambda n: frames.write_register(0, 0x1234), (1,), None),
    ("0F", lambda n: frames.write_coils(0, BITS[:n]), (1, 7, 8, 9, 1968), "bit"),
    ("10", lambda n: frames.write_registers(0, WORDS[:n]), (1, 2, 123), "register"),
    ("16", lambda n: frames.mask_write(0, 0x00FF, 0xAA55), (1,), None),
    ("17", read_write, ((1, 1), (2, 1), (1, 2), (125, 121)), "register"),
    ("exception 01", lambda n: b"\x41", (None,), None),
    ("exception 02", lambda n: frames.read(FC.READ_HOLDINGS, 1000, 1), (None,), None),
    ("exception 03", lambda n: frames.read(FC.READ_HOLDINGS, 0, 126), (None,), None),
)
READS_BITS = ("01", "02")  # their last byte is filled up


def items(quantity):
    """How many items a request moves."""
    return quantity if isinstance(quantity, int) else sum(quantity)


def fit(name, clocks, item):
    """(A, B, C, rule in words): clocks = A + B * items, and C - r more for a last byte of r bits.

    `clocks`: {quantity: clocks}. Raises AssertionError if the clocks do not follow such a rule.
    """
    if item is None:
        (only,) = set(clocks.values())
        return only, 0, 0, str(only)
    part = name in READS_BITS
    known = sorted((items(q), c) for q, c in clocks.items() if not part or q % 8 == 0)
    (low, begin), (high, end) = known[0], known[-1]
    slope = (end - begin) // (high - low)
    base = begin - slope * low
    rest = clocks[1] - base - slope + 1 if part else 0
    for quantity, seen in clocks.items():
        count = items(quantity)
        rule = base + slope * count + (rest - count % 8 if part and count % 8 else 0)
        assert seen == rule, f"FC {name} of {size(quantity)}: {seen} clocks, the rule says {rule}"
    words = f"{base} + {slope} a {item}"
    if name == "17":
        words += " read or written"
    return base, slope, rest, words + (f", + {rest} − r if the last byte has only r bits" if part else "")


def size(quantity):
    """A quantity in words."""
    if quantity is None:
        return "–"
    return str(quantity) if isinstance(quantity, int) else f"{quantity[0]} + {quantity[1]}"


def start(device, pdu, floors):
    """(clocks from the end of t3.5 to frame_stb_o, from there to the start bit) for one request."""
    end_of_silence = t35(device.bit_time, device.fmt, floors)
    device.reset(end_of_silence + 4 * device.bit_time)
    end, log = device.request(
        frames.adu(OWN, pdu), end_of_silence + 5000 + device.bit_time, log=mask("txd frame")
    )
    seen, begun = log.rises("frame")[0], log.falls("txd")[0]
    return seen - end - end_of_silence, begun - seen


def answer_starts(lab):
    """Tables `rule`, `seen`, `start115200`, `start16` and `holds`."""
    work, late = {}, {}
    places = ((0, FEW, 0), (1, FEW, 0), (0, BIT_115200, 1))
    for io, bit_time, floors in places:
        device = lab(io, floors)
        device.setup(bit_time)
        for name, pdu, quantities, _ in REQUESTS:
            # The whole sweep where it is quick, the ends where it is slow
            for quantity in quantities if bit_time == FEW else {quantities[0], quantities[-1]}:
                after, clocks = start(device, pdu(quantity), floors)
                late.setdefault((bit_time, floors), set()).add(after)
                before = work.setdefault((name, quantity), clocks)
                assert clocks == before, (
                    f"FC {name} of {size(quantity)}, {'I/O' if io else 'RAM'} bank, {bit_time} clocks per bit: "
                    f"{clocks} clocks, elsewhere {before}"
                )
    for floors, bit_times in ((0, (8, 17, 100, BIT_115200)), (1, (FEW, 2604))):
        for bit_time in bit_times:
            device = lab(0, floors)
            device.setup(bit_time)
            late[bit_time, floors] = {start(device, b"\x41", floors)[0]}
    rules = {
        name: fit(name, {q: work[name, q] for q in quantities}, item) for name, _, quantities, item in REQUESTS
    }
    out = {
        "rule": table(
            ["function", "clocks from the end of t3.5 to the start bit, without D"],
            [[name, words] for name, (*_, words) in rules.items()],
            2,
        ),
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
        for function, _, quantities, _ in REQUESTS:
            for quantity in dict.fromkeys((quantities[0], quantities[-1])):
                clocks = work[function, quantity] + delay
                share = 100 * clocks / silence
                rows.append([
                    function, size(quantity), number(clocks), f"{clocks / bit_time:.2f}", f"{share:.2f} %",
                    "yes" if clocks <= bit_time else "no", "yes" if share <= 2 else "no",
                ])  # fmt: skip
        out[name] = table(
            ["function", "quantity", "clocks after t3.5", "bit times", "of t3.5", "within 1 bit", "within 2 %"],
            rows,
            2,
        )
    delay = max(max(found) for found in late.values())
    percent = t35(BIT_115200) // 50

    def most(name, budget, waits=0):
        """The most items of which a request keeps within so many clocks, not counting so many waits an item."""
        base, slope, rest, _ = rules[name]
        return int((budget - delay - base - max(0, rest - 1)) // (slope - waits))

    def bit_time(name, quantity, bits):
        """The fewest clocks per bit at which a request keeps within so many bit times."""
        return math.ceil((work[name, quantity] + delay) / bits)

    two_percent = 0.02 * 38.5  # of t3.5 without floors, in bit times
    both = "FC 17, 125 + 121 registers"
    rows = [
        ["115200 baud, 50 MHz: FC 01 and 02 within t3.5 + 2 %", f"up to {most('01', percent)} bits"],
        ["the same, the RAM's wait state of each beat not counted", f"up to {most('01', percent, 1)} bits"],
        ["115200 baud, 50 MHz: FC 0F within t3.5 + 2 %", f"up to {most('0F', percent)} bits"],
        ["115200 baud, 50 MHz: FC 17 within 1 bit", f"up to {most('17', BIT_115200)} registers, read plus written"],
        ["FC 03, 1 register, within 1 bit", f"from {bit_time('03', 1, 1)} clocks per bit"],
        ["FC 10, 123 registers, within 1 bit", f"from {bit_time('10', 123, 1)} clocks per bit"],
        [f"{both}, within 1 bit", f"from {bit_time('17', (125, 121), 1)} clocks per bit"],
        ["FC 03, 1 register, within t3.5 + 2 %, floors 0", f"from {bit_time('03', 1, two_percent)} clocks per bit"],
        [
            "FC 10, 123 registers, within t3.5 + 2 %, floors 0",
            f"from {bit_time('10', 123, two_percent)} clocks per bit",
        ],
        [f"{both}, within t3.5 + 2 %, floors 0", f"from {bit_time('17', (125, 121), two_percent)} clocks per bit"],
        ["FC 01, 2000 coils, within t3.5 + 2 %, floors 0", f"from {bit_time('01', 2000, two_percent)} clocks per bit"],
        [
            "every answer within one character time",
            f"from {bit_time('01', 2000, 11)} clocks per bit; register requests from {bit_time('17', (125, 121), 11)}",
        ],
    ]
    out["holds"] = table(["figure", "holds"], rows, 2)
    return out


# ------------------------------------------------------------------ driver enable, transmission


def driver(lab):
    """Table `de`: lead and tail for the settings 0 to 15."""
    device, found = lab(), {}
    for bit_time in (FEW, BIT_115200):
        for setting in range(16):
            device.setup(bit_time, de_lead=setting, de_tail=15 - setting)
            _, log = device.request(
                frames.adu(OWN, b"\x41"), (39 + 16 + 55 + 20) * bit_time, log=mask("txd de")
            )
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
            rows.append(
                [bit_time, setting, *(number(found[bit_time, side, setting]) for side in ("lead", "tail"))]
            )
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
        "baud": table(
            ["clocks per bit", "sender slower by up to", "sender faster by up to", "wanted", "met"], rows
        )
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
        third = second + first_true(
            lambda x, lost=broken, two=second: lost((two, 1), (two + 1, x)), bit_time - second
        )
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
            if not all(
                quick(device, SHORT, phase=1 + bit_time, spikes=[(at - bit_time, width)]) for at in places
            ):
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
    request_end, log = device.request(
        frame, FLOOR_T35 + 256 * 11 * BIT_115200 + 2000, log=mask("txd de")
    )
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
    device.run(end + 60 * device.bit_time, edges, mask("grant_req"))
    assert device.peek().grant_req


def bus(lab):
    """Table `bus`: the grant question and the burst, in clocks."""
    device, rows = lab(), []
    device.setup(8)
    for name, pdu in (
        ("FC 03, 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
        ("FC 03, 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
        ("FC 10, 1 register", frames.write_registers(0, WORDS[:1])),
        ("FC 10, 123 registers", frames.write_registers(0, WORDS[:123])),
        ("FC 01, 1 coil", frames.read(FC.READ_COILS, 0, 1)),
        ("FC 01, 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
        ("FC 0F, 1968 coils", frames.write_coils(0, BITS[:1968])),
        ("FC 16", frames.mask_write(0, 1, 2)),
        ("FC 17, 125 + 121 registers", read_write((125, 121))),
    ):
        to_grant(device, pdu)
        asked = device.now
        log = device.run(5000, stop=mask("de"), log=mask("grant_req grant_ack wb_cyc wb_stb wb_ack write"))
        granted = log.rises("grant_ack")[0]
        up, down = log.rises("wb_cyc"), log.falls("wb_cyc")
        assert len(up) == 1, f"{name}: {len(up)} bursts"
        beats = len(log.rises("wb_ack"))
        write = log.rises("write")
        rows.append(
            [name, granted - asked + 1, up[0] - granted, beats, number(down[0] - up[0]),
             f"fall + {write[0] - down[0]}" if write and write[0] >= down[0] else
             (f"rise + {write[0] - up[0]}" if write else "–")]
        )  # fmt: skip
    return {
        "bus": table(
            ["request", "grant asked to given", "given to `wb_cyc_o`", "beats", "`wb_cyc_o` high",
             "`write_stb_o`, from `wb_cyc_o`'s"], rows,
        )
    }  # fmt: skip


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
    rows += [
        ["first access of a `host_cyc_i`, memory free", first],
        ["each further access under the same `host_cyc_i`", f"{second}" if second == third else f"{second}, {third}"],
        ["an item that does not exist, to `host_err_o`", missing],
    ]
    for name, pdu in (
        ("a read of 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
        ("a read of 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
        ("a write of 123 registers", frames.write_registers(0, WORDS[:123])),
        ("FC 16", frames.mask_write(0, 1, 2)),
        ("FC 17, 125 + 121 registers", read_write((125, 121))),
        ("a write of 1968 coils", frames.write_coils(0, BITS[:1968])),
        ("a read of 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
    ):
        to_grant(device, pdu)
        device.run(100, stop=mask("wb_cyc"))
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
