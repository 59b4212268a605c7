# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The pictures of docs/timing.md as WaveJSON, drawn from the signals of the running core."""

import json

from protocol import frames
from protocol.defs import FC, Space, bus_address

from .device import OWN, mask
from .lab import Lab
from .ports import to_grant
from .transmission import fill_holdings

LONGEST = 5  # clocks in which nothing changes before a picture is cut


class Trace:
    """The signals of the core, clock by clock."""

    def __init__(self):
        self.rows = []  # {name: level, or text while a bus means something, or None}

    def take(self, device, **inputs):
        """Keep this clock; `inputs` are the host port's. Then go to the next."""
        now = device.peek()
        row = {f"{name}_o": getattr(now, name) for name in ("grant_req", "wb_cyc", "wb_stb", "wb_we")}
        row["grant_ack_i"], row["wb_ack_i"] = now.grant_ack, now.wb_ack
        row["write_stb_o"] = now.write
        row["grant_*_o"] = (
            f"{now.grant_space}, {now.grant_first}–{now.grant_last}{' w' if now.grant_write else ''}"
            if now.grant_req
            else None
        )
        row["exception_i"] = f"{now.exception:02X}" if now.grant_ack else None
        row["wb_adr_o"] = f"{now.wb_adr >> 16},{now.wb_adr & 0xFFFF}" if now.wb_stb else None
        row["wb_dat_o"] = f"{now.wb_write:04X}" if now.wb_stb and now.wb_we else None
        row["wb_dat_i"] = f"{now.wb_read:04X}" if now.wb_ack and not now.wb_we else None
        if inputs:
            row.update({f"host_{name}_i": inputs[name] for name in ("cyc", "stb")})
            address = inputs["address"]
            row["host_adr_i"] = f"{address >> 16},{address & 0xFFFF}" if inputs["stb"] else None
            row["host_ack_o"] = now.host_ack
            row["host_dat_o"] = f"{now.host_dat:04X}" if now.host_ack else None
        self.rows.append(row)
        device.run(1)
        return now

    def columns(self):
        """Numbers of the clocks that are drawn; None where a stretch without change is cut out."""
        out, same = [], 0
        for clock, row in enumerate(self.rows):
            same = same + 1 if clock and row == self.rows[clock - 1] else 0
            out.append(clock)
            if same >= LONGEST and (clock + 1 == len(self.rows) or self.rows[clock + 1] != row):
                del out[-same + 1 :]
                out += [None, clock]
        return out

    def picture(self, title, signals, foot):
        """WaveJSON of some signals; an empty name leaves a space."""
        columns = self.columns()
        cuts = [clock is None for clock in columns]

        def of(name):
            """The lane of a signal."""
            return {"name": name, **lane([None if c is None else self.rows[c][name] for c in columns], cuts)}

        lanes = [{"name": "clk_i", "wave": "p" + "".join("|" if cut else "." for cut in cuts[1:])}]
        lanes += [of(name) if name else {} for name in signals]
        if any(cuts):
            clocks = lane([None if c is None else str(c) for c in columns], cuts)
            lanes += [{}, {"name": "clock", **clocks}]
        picture = {"signal": lanes, "head": {"text": title}, "foot": {"text": foot}}
        if None not in columns:
            picture["head"]["tick"] = 0
        return picture


def lane(values, cuts):
    """{"wave": ..., "data": ...} of levels (int), bus contents (text) and nothing (None)."""
    wave, data, before = "", [], object()
    for value, cut in zip(values, cuts):
        if cut:
            wave += "|"
        elif value == before:
            wave += "."
        elif value is None:
            wave += "x"
        elif isinstance(value, str):
            wave += "="
            data.append(value)
        else:
            wave += str(value)
        if not cut:
            before = value
    return {"wave": wave, **({"data": data} if data else {})}


QUESTION = ["grant_req_o", "grant_*_o", "grant_ack_i", "exception_i"]
READ = ["wb_cyc_o", "wb_stb_o", "wb_adr_o", "wb_dat_i", "wb_ack_i"]
WRITE = ["wb_cyc_o", "wb_stb_o", "wb_we_o", "wb_adr_o", "wb_dat_o", "wb_ack_i"]
BOTH = [*WRITE[:5], "wb_dat_i", "wb_ack_i"]


def traced(device, pdu, clocks, stop=None):
    """A Trace of so many clocks, or to a signal, that begins a clock before the grant question."""
    device.reset()
    edges, end = device.wave(frames.adu(OWN, pdu))
    device.run(end + 60 * device.bit_time, edges, mask("frame"))
    trace = Trace()
    while not trace.take(device).grant_req:
        del trace.rows[:-1]
    for _ in range(clocks - 2):
        now = trace.take(device)
        if stop and getattr(now, stop):
            break
    return trace


def burst_pictures(device):
    """The bus of the core."""
    device.setup(8)
    fill_holdings(device)
    out = {}
    trace = traced(device, frames.read(FC.READ_HOLDINGS, 5, 3), 20)
    out["read_burst"] = trace.picture(
        "Grant and burst of a read: FC 03, registers 5 to 7", [*QUESTION, "", *READ],
        "Bank: modbus_bank_ram. Two clocks a register.",
    )  # fmt: skip
    trace = traced(device, frames.write_registers(5, [0x1234, 0x5678]), 60, "write")
    trace.take(device)
    out["write_burst"] = trace.picture(
        "Grant and burst of a write: FC 10, registers 5 and 6", [*QUESTION, "", *WRITE, "", "write_stb_o"],
        "write_stb_o comes after the burst, the answer after that.",
    )  # fmt: skip
    trace = traced(device, frames.read(FC.READ_HOLDINGS, 124, 2), 8)
    out["refused"] = trace.picture(
        "A refused read: exception 02", [*QUESTION, "", "wb_cyc_o"],
        "No burst follows.",
    )  # fmt: skip
    trace = traced(device, frames.mask_write(5, 0x00F2, 0x2500), 200, "write")
    trace.take(device)
    out["mask_write"] = trace.picture(
        "FC 16: register 5 read, changed and written back under one wb_cyc_o",
        [*QUESTION, "", *BOTH, "", "write_stb_o"],
        "AND mask 00F2, OR mask 2500. Nobody gets between the two accesses.",
    )  # fmt: skip
    return out


def host_pictures(device):
    """The host port."""
    out = {}
    device.setup(8)
    fill_holdings(device)
    address = bus_address(Space.HOLDINGS, 5)
    host = ["host_cyc_i", "host_stb_i", "host_adr_i", "host_dat_o", "host_ack_o"]

    def play(before, accesses, after):
        """Some clocks, reads of so many items, some clocks."""
        trace = Trace()
        idle = {"cyc": 0, "stb": 0, "address": 0}
        for _ in range(before):
            trace.take(device, **idle)
        for item in range(accesses):
            while True:
                device.host(1, 1, 0, address + item)
                if trace.take(device, cyc=1, stb=1, address=address + item).host_ack:
                    break
        device.host()
        for _ in range(after):
            trace.take(device, **idle)
        return trace

    device.run(4)
    out["host_read"] = play(1, 3, 2).picture(
        "The host reads registers 5 to 7 under one host_cyc_i", host,
        "Three clocks for the first access, two for each further one.",
    )  # fmt: skip
    to_grant(device, frames.read(FC.READ_HOLDINGS, 5, 3))
    device.run(100, stop=mask("wb_cyc"))
    out["host_waits"] = play(1, 1, 2).picture(
        "The host waits for a burst: it asks while registers 5 to 7 are read", [*host, "", *READ],
        "The memory becomes the host's when wb_cyc_o is 0.",
    )  # fmt: skip
    # The other way round
    device.reset()
    device.host(1)
    edges, end = device.wave(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 5, 1)))
    device.run(end + 60 * device.bit_time, edges, mask("grant_req"))
    trace = Trace()
    for clock in range(26):
        level = int(clock < 12)
        device.host(level)
        trace.take(device, cyc=level, stb=0, address=0)
    device.host()
    out["core_waits"] = trace.picture(
        "The core waits for the host", ["host_cyc_i", "", *QUESTION, "", *READ],
        "While host_cyc_i is 1 the grant question stays unanswered.",
    )  # fmt: skip
    return out


def line_pictures(device):
    """The driver enable around an answer, a column a bit time."""
    bit_time = 16
    device.setup(bit_time, de_lead=2, de_tail=1)
    edges, end = device.wave(frames.adu(OWN, b"\x41"))
    log = device.run(end + 140 * bit_time, edges, log=mask("txd de"))
    rise, fall = log.rises("de")[0], log.falls("de")[0]
    first = log.falls("txd")[0]

    def sample(name, bits):
        """Level in the middle of a bit time counted from the answer's first start bit."""
        return log.at(name, first + bits * bit_time + bit_time // 2)

    head = list(range(-4, 13))  # lead, first character, the begin of the second
    tail = list(range((fall - first) // bit_time - 6, (fall - first) // bit_time + 3))
    columns = [*head, None, *tail]
    cuts = [c is None for c in columns]
    names = ["start", *(f"d{i}" for i in range(8)), "par", "stop"]

    def meaning(bits):
        """What a bit time of the answer is."""
        if first + bits * bit_time < rise - bit_time // 2 or first + bits * bit_time > fall - bit_time // 2:
            return None
        if bits < 0:
            return "lead"
        return "tail" if bits >= 55 else names[bits % 11]

    assert len(log.rises("de")) == 1
    lanes = [
        {"name": "de_o", **lane([None if c is None else sample("de", c) for c in columns], cuts)},
        {"name": "txd_o", **lane([None if c is None else sample("txd", c) for c in columns], cuts)},
        {"name": "bit", **lane([None if c is None else meaning(c) for c in columns], cuts)},
    ]
    return {
        "driver": {
            "signal": lanes,
            "head": {"text": "Driver enable around an answer: de_lead_i = 2, de_tail_i = 1, 8E1"},
            "foot": {"text": "A column is a bit time. The lead is longer by one clock, so is the tail."},
        }
    }


def pictures(lab=None):
    """{name: WaveJSON text} of all pictures."""
    lab = lab or Lab()
    device = lab()
    out = {**burst_pictures(device), **host_pictures(device), **line_pictures(device)}
    return {name: as_text(picture) for name, picture in out.items()}


def as_text(picture):
    """WaveJSON with one lane a line."""
    lanes = ",\n".join("  " + json.dumps(one, ensure_ascii=False) for one in picture["signal"])
    rest = ",\n".join(f' "{key}": {json.dumps(picture[key], ensure_ascii=False)}' for key in picture if key != "signal")
    return f'{{"signal": [\n{lanes}\n ],\n{rest}\n}}\n'
