# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Driver enable and the characters of an answer."""

from harness import wave
from protocol import frames
from protocol.defs import F8E1, F8N1, F8N2, F8O1, FC, Space, bus_address

from .device import OWN, mask
from .lab import BIT_115200, FEW, WORDS, number, table


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
