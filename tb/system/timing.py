# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Answer latency and line use at 115200 baud with a 50 MHz clock, in clock cycles.

`BENCH_FIGURES`, if set, names a JSON file that gets what was measured.
"""

import json
import os
from pathlib import Path

import cocotb
from mbrtu import frames
from mbrtu.bench import CLOCK_PS, Bench
from mbrtu.defs import FC, Space
from mbrtu.line import now

OWN = 17
BIT_TIME = 434  # 50 MHz / 115200
SHARE = 0.02  # of t3.5: the most any answer may be late


def cases(most_coils):
    """(name, request PDU, must start within one bit of t3.5)."""
    words = [(0x1357 * i) & 0xFFFF for i in range(123)]
    return [
        ("FC 03, 1 register", frames.read(FC.READ_HOLDINGS, 0, 1), True),
        ("FC 03, 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125), True),
        ("FC 04, 125 registers", frames.read(FC.READ_INPUTS, 0, 125), True),
        ("FC 06", frames.write_register(0, 0x1234), True),
        ("FC 10, 123 registers", frames.write_registers(0, words), True),
        ("FC 16", frames.mask_write(0, 0x00FF, 0xAA55), True),
        ("FC 17, 1 + 1 registers", frames.read_write(0, 1, 1, [1]), True),
        ("FC 17, 125 + 121 registers", frames.read_write(0, 125, 0, words[:121]), False),
        ("FC 01, 1 coil", frames.read(FC.READ_COILS, 0, 1), True),
        (f"FC 01, {most_coils} coils", frames.read(FC.READ_COILS, 0, most_coils), False),
        ("FC 02, 2000 discrete inputs", frames.read(FC.READ_DISCRETES, 0, 2000), False),
        ("FC 05", frames.write_coil(0, True), True),
        ("FC 0F, 1968 coils", frames.write_coils(0, [i & 1 for i in range(1968)]), False),
        ("exception 01", b"\x41", True),
        ("exception 02", frames.read(FC.READ_HOLDINGS, 0xFFFF, 2), True),
        ("exception 03", frames.read(FC.READ_HOLDINGS, 0, 126), True),
    ]


def report(name, figures):
    """Add to the figures file, and print."""
    print(f"{name}: {figures}")
    path = os.environ.get("BENCH_FIGURES")
    if path:
        path = Path(path)
        held = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        held[name] = figures
        path.write_text(json.dumps(held, indent=1) + "\n", encoding="utf-8")


@cocotb.test()
async def answer_starts_at_once(dut):
    """Never before t3.5; within a bit for register requests; else within 2 % of t3.5 - measured."""
    tb = await Bench.start(dut, bit_time=BIT_TIME)
    coils = tb.slave.config.tables[Space.COILS][1]
    late = []
    for name, pdu, strict in cases(min(2000, coils)):
        sent = await tb.line.send(frames.adu(OWN, pdu))
        begin = await tb.line.answer_begins(tb.t35 + 20 * tb.bit)
        assert begin is not None, f"{name}: silence"
        beyond = (begin - sent - tb.t35) / CLOCK_PS
        report(
            name,
            {
                "clocks_after_t35": round(beyond, 1),
                "bits_after_t35": round(beyond / BIT_TIME, 3),
                "percent_of_t35": round(100 * beyond * CLOCK_PS / tb.t35, 3),
            },
        )
        assert beyond >= 0, f"{name}: {-beyond:.1f} clocks before t3.5"
        if strict and beyond > BIT_TIME:
            late.append(f"{name}: {beyond:.0f} clocks after t3.5, a bit has {BIT_TIME}")
        if not strict and beyond > max(SHARE * tb.t35 / CLOCK_PS, BIT_TIME):
            late.append(f"{name}: {beyond:.0f} clocks after t3.5, more than 2 % of it")
        await tb.reset()
        await tb.silence()
    assert not late, "; ".join(late)


@cocotb.test()
async def driver_enable_surrounds_the_answer(dut):
    """Measured in clocks with lead and tail 0: on with the start bit, off with the last stop bit."""
    tb = await Bench.start(dut, bit_time=BIT_TIME)
    answer = await tb.query(frames.adu(OWN, frames.write_register(0, 1)))
    lead = (answer.start - answer.de_rise) // CLOCK_PS
    tail = (answer.de_fall - answer.end) // CLOCK_PS
    report("DE", {"lead_clocks": lead, "tail_clocks": tail})
    assert 0 <= lead <= BIT_TIME and 0 <= tail <= BIT_TIME
    assert (answer.end - answer.start) == 8 * 11 * tb.bit, "not gap-free"


@cocotb.test()
async def read_of_125_registers_takes_what_the_line_takes(dut):
    """Request 8 + answer 255 characters + 2 x t3.5, within 1 %."""
    tb = await Bench.start(dut, bit_time=BIT_TIME)
    begin = now()
    answer = await tb.query(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 125)), phase=0)
    taken = answer.end - begin + tb.t35
    line = (8 + 255) * 11 * tb.bit + 2 * tb.t35
    report("transaction FC 03, 125 registers", {"ms": taken / 1e9, "line_ms": line / 1e9})
    assert taken <= 1.01 * line, f"{taken / line:.4f} of what the line takes"
