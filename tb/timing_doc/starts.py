# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""When an answer starts, by function and quantity."""

import math

from protocol import frames
from protocol.defs import F8E1

from .device import OWN, mask
from .lab import BIT_115200, FEW, number, t35, table
from .requests import (
    BASIC,
    BY_NAME,
    MOST_RECORDS,
    REQUESTS,
    USER_ANSWERS,
    USER_CLOCKS,
    USER_PASSES,
    Request,
    bits_read,
    fit,
)


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
    places += [(0, FEW, 0, "wide"), (1, FEW, 0, "wide"), (0, BIT_115200, 1, "wide")]
    if not lab.every:  # work takes the same clocks with either bank, at every rate
        places = [(io, bit_time, floors, build) for io, bit_time, floors, build in places
                  if (io, floors) == (0, 0) or (floors, build) == (1, "full")]
    for io, bit_time, floors, build in places:
        device = lab(io, floors, build)
        device.setup(bit_time)
        for request in REQUESTS:
            if (build == "basic" and request.name not in BASIC) or (io and request.name in MOST_RECORDS):
                continue
            if request.wide != (build == "wide"):
                continue
            # The whole sweep where it is quick, the ends where it is slow
            name, few = request.name, bit_time == FEW
            ends = 1 if request.before(2) or not lab.every else 2
            for quantity in request.quantities if few else request.ends()[:ends]:
                after, clocks = start(device, request, quantity, floors)
                late.setdefault((bit_time, floors), set()).add(after)
                before = work.setdefault(("full" if build == "wide" else build, name, quantity), clocks)
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
        ("FC 01, 2000 coils, 16 bits a beat, within 1 bit", bit_time("01, 16 bits a beat", 2000, 1)),
        ("FC 0F, 1968 coils, 16 bits a beat, within 1 bit", bit_time("0F, 16 bits a beat", 1968, 1)),
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
