# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Files and queue on the grant and Wishbone ports of modbus_rtu_core: questions, beats, refusals, errors."""

import cocotb
from harness.bench import CLOCK_PS
from protocol import frames
from protocol.defs import EX, FC, FIFO_MOST, Space

from system.core_bus import OWN, ask, bench, memories_agree, preset

STALL_BITS = 40
READ = frames.read_files((4, 1, 2), (3, 9, 3), (1, 255, 1))
WRITE = frames.write_files((2, 7, [0xAF04, 0xBE10]), (4, 0, [0x1234]), (2, 8, [1, 2, 3]))
QUEUE, ENTRIES = 100, [0x1111, 0x2222, 0x3333]
FIFO = frames.read_fifo(QUEUE)


def groups(pdu):
    """[(file, first, last)] of a request for files."""
    out, place = [], 2
    while place < len(pdu):
        file, first, quantity = frames.unpack_words(pdu[place + 1 : place + 7])
        out.append((file, first, first + quantity - 1))
        place += 7 + (2 * quantity if pdu[0] == FC.WRITE_FILE else 0)
    return out


def questions(pdu):
    """The questions that a request must ask, in this order."""
    if pdu[0] == FC.READ_FIFO:
        return [(Space.HOLDINGS, QUEUE, QUEUE, 0), (Space.HOLDINGS, QUEUE, QUEUE + len(ENTRIES), 0)]
    write = int(pdu[0] == FC.WRITE_FILE)
    return [(Space.FILES, first, last, write, file) for file, first, last in groups(pdu)]


def items(pdu):
    """[(file or None, item)] of the beats that a request must do, in this order."""
    if pdu[0] == FC.READ_FIFO:
        return [(None, QUEUE)] + [(None, QUEUE + place) for place in range(len(ENTRIES) + 1)]
    return [(file, item) for file, first, last in groups(pdu) for item in range(first, last + 1)]


def seen_items(tb):
    """The same of the beats that the bank saw."""
    return [(beat[4] if len(beat) > 4 else None, beat[2]) for beat in tb.bank.request.beats]


def fill(tb):
    """A queue and some records, in bank and model."""
    for place, word in enumerate([len(ENTRIES), *ENTRIES]):
        preset(tb, (Space.HOLDINGS, QUEUE + place), word)
    for file, first, last in groups(READ):
        for record in range(first, last + 1):
            preset(tb, (Space.FILES, tb.slave.config.record_item(file, record)), tb.rng.getrandbits(16))


def judge(tb, pdu):
    """Questions, beats and bursts of a request that was carried out."""
    seen = tb.bank.request
    assert seen.questions == questions(pdu), f"asked {seen.questions}"
    wanted = items(pdu)
    if pdu[0] == FC.READ_FIFO and len(seen.beats) < len(wanted):
        wanted = wanted[1:]  # the count may be kept from the first time
    assert seen_items(tb) == wanted, f"accessed {seen_items(tb)}"
    assert seen.bursts == 1, f"cyc rose {seen.bursts} times"
    memories_agree(tb)


@cocotb.test()
@cocotb.parametrize(wait=[0, 1, 7])
async def bank_waits(dut, wait):
    tb = await bench(dut)
    fill(tb)
    for pdu in (READ, WRITE, FIFO):
        answer = await ask(tb, pdu, grant_wait=wait, beat_wait=wait)
        assert answer[1] == pdu[0]
        judge(tb, pdu)
    await tb.finish()


@cocotb.test()
async def bank_waits_at_random(dut):
    tb = await bench(dut)
    fill(tb)
    for _ in range(2):
        for pdu in (READ, WRITE, FIFO):
            await ask(
                tb,
                pdu,
                grant_wait=lambda: tb.rng.choice((0, 0, 1, 5, 60)),
                beat_wait=lambda: tb.rng.choice((0, 0, 0, 1, 2, 40)),
            )
            judge(tb, pdu)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[2, 8, 11])
async def any_group_refused_and_nothing_is_accessed(dut, code):
    """The bank's code is the answer, whichever group it dislikes; those behind are not asked for."""
    tb = await bench(dut)
    fill(tb)
    for pdu in (READ, WRITE):
        for number in range(3):
            asked = []
            tb.slave.grant = lambda *q, n=number, a=asked: a.append(q) or (code if len(a) == n + 1 else 0)
            answer = await ask(tb, pdu, refusals={number: code})
            assert answer == frames.adu(OWN, bytes([pdu[0] | 0x80, code]))
            assert tb.bank.request.questions == questions(pdu)[: number + 1]
            assert not tb.bank.request.beats and not tb.bank.request.bursts
    tb.slave.grant = None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[2, 7])
async def queue_refused_twice(dut, code):
    """The count alone, then count and entries: either question may be refused."""
    tb = await bench(dut)
    fill(tb)
    for number in range(2):
        asked = []
        tb.slave.grant = lambda *q, n=number, a=asked: a.append(q) or (code if len(a) == n + 1 else 0)
        answer = await ask(tb, FIFO, refusals={number: code})
        assert answer == frames.adu(OWN, bytes([FC.READ_FIFO | 0x80, code]))
        assert tb.bank.request.questions == questions(FIFO)[: number + 1]
        assert len(tb.bank.request.beats) == number
    tb.slave.grant = None
    preset(tb, (Space.HOLDINGS, QUEUE), FIFO_MOST + 1)
    assert (await ask(tb, FIFO))[2] == EX.VALUE
    assert len(tb.bank.request.questions) == 1, "the entries of a bad count are not asked for"
    preset(tb, (Space.HOLDINGS, QUEUE), 0)
    assert (await ask(tb, FIFO))[2:6] == b"\0\2\0\0"
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[0, 8])
async def error_in_a_burst(dut, code):
    """err on any beat ends everything with its code (none: 04); what was written stays, no later beat."""
    tb = await bench(dut)
    fill(tb)
    for pdu in (READ, WRITE, FIFO):
        for beat in range(len(items(pdu)) - (pdu == FIFO)):
            tb.bank.begin(error_beat=beat, error_code=code)
            tb.writes.clear()
            answer = await tb.query(frames.adu(OWN, pdu))
            expected = frames.adu(OWN, bytes([pdu[0] | 0x80, code or EX.FAILURE]))
            shown = f"{frames.text(pdu)}, err at beat {beat}"
            assert answer and answer.data == expected, f"{shown}: seen {answer}"
            assert len(tb.bank.request.beats) == beat, f"{shown}: {tb.bank.request.beats}"
            assert not tb.writes, f"{shown}: write pulses {tb.writes} of a request that failed"
            tb.bank.check()
    tb.bank.begin()
    answer = await tb.query(frames.adu(OWN, READ))
    assert answer and answer.data[1] == FC.READ_FILE, "the line does not go on after an error"


@cocotb.test()
async def stall_limit(dut):
    """A silent bank: 06 while asked, 04 in a burst, at any question and any beat."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    fill(tb)
    for pdu in (READ, WRITE, FIFO):
        tb.bank.begin(silent_grant=True)
        answer = await tb.query(frames.adu(OWN, pdu))
        assert answer and answer.data[1:3] == bytes([pdu[0] | 0x80, EX.BUSY]), f"seen {answer}"
        for beat in (0, 2):
            tb.bank.begin(silent_beat=beat)
            answer = await tb.query(frames.adu(OWN, pdu))
            assert answer and answer.data[1:3] == bytes([pdu[0] | 0x80, EX.FAILURE]), f"seen {answer}"
            assert not int(dut.wb_cyc_o.value), "cyc stays up"
            tb.bank.check()
        tb.bank.begin(beat_wait=(STALL_BITS - 4) * tb.setup.bit_time)
        answer = await tb.query(frames.adu(OWN, pdu), patience=40_000 * CLOCK_PS)
        assert answer and answer.data[1] == pdu[0], "a slow bank is not a silent one"


@cocotb.test()
async def busy_and_failure_come_after_every_question(dut):
    tb = await bench(dut)
    fill(tb)
    for setup, code in (({"busy": 1, "failure": EX.NAK}, EX.BUSY), ({"busy": 0}, EX.NAK)):
        tb.apply(**setup)
        for pdu in (READ, WRITE, FIFO):
            assert (await ask(tb, pdu))[2] == code
            assert tb.bank.request.questions == questions(pdu)
            assert not [beat for beat in tb.bank.request.beats if beat[0]]
            bad = frames.read_files((4, 1, 2), (5, 0, 1))
            assert (await ask(tb, bad))[2] == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def longest_requests(dut):
    """122 registers written, 121 read, 35 groups asked for, a queue of 31."""
    tb = await bench(dut)
    words = [tb.rng.getrandbits(16) for _ in range(122)]
    for pdu, beats in (
        (frames.write_files((3, 100, words)), 122),
        (frames.read_files((3, 100, 121)), 121),
        (frames.read_files(*[(3, 100 + i, 1) for i in range(35)]), 35),
    ):
        await ask(tb, pdu)
        assert len(tb.bank.request.beats) == beats and tb.bank.request.bursts == 1
        assert len(tb.bank.request.questions) == len(groups(pdu))
        memories_agree(tb)
    preset(tb, (Space.HOLDINGS, 7), FIFO_MOST)
    for place in range(FIFO_MOST):
        preset(tb, (Space.HOLDINGS, 8 + place), tb.rng.getrandbits(16))
    await ask(tb, frames.read_fifo(7))
    await tb.finish()
