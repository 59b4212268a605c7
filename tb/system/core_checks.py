# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""CHECK_WRITES: the bank judges every value of a write before the first one is stored."""

import cocotb
from harness.bank import WIDE, Bank
from harness.bench import CLOCK_PS, Bench
from protocol import frames
from protocol.defs import BROADCAST, EX, FC, Space

OWN = 17
COIL, REGISTER = 30, 40
PATIENCE = 3000 * CLOCK_PS
BITS = [1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1]


async def bench(dut, **setup):
    """A bench with a Python bank that holds something everywhere a write of this file goes."""
    tb = await Bench.start(dut, **setup)
    tb.bank = Bank(tb)
    for item in range(20):
        for key in ((Space.COILS, COIL + item), (Space.HOLDINGS, REGISTER + item)):
            tb.bank.memory[key] = tb.slave.memory[key] = tb.rng.getrandbits(1 if key[0] == Space.COILS else 16)
    return tb


def masked(tb, item, and_mask, or_mask):
    """The value that 16H makes of a register."""
    return tb.bank.memory[Space.HOLDINGS, item] & and_mask | or_mask & ~and_mask & 0xFFFF


def writes(tb):
    """One write of each function: (PDU, first item, values in order, space)."""
    words = [1, 0xFFFF, 0x8001, 0x0A55, 0]
    return [
        (frames.write_coil(COIL, True), COIL, [1], Space.COILS),
        (frames.write_coil(COIL + 1, False), COIL + 1, [0], Space.COILS),
        (frames.write_register(REGISTER, 0x1234), REGISTER, [0x1234], Space.HOLDINGS),
        (frames.write_coils(COIL + 2, BITS), COIL + 2, BITS, Space.COILS),
        (frames.write_registers(REGISTER, words), REGISTER, words, Space.HOLDINGS),
        (
            frames.mask_write(REGISTER + 6, 0xF0F0, 0x1234),
            REGISTER + 6,
            [masked(tb, REGISTER + 6, 0xF0F0, 0x1234)],
            Space.HOLDINGS,
        ),
        (frames.read_write(REGISTER, 4, REGISTER + 2, words[:3]), REGISTER + 2, words[:3], Space.HOLDINGS),
    ]


@cocotb.test()
@cocotb.parametrize(wait=[0, 1, 3])
async def every_value_is_checked_once_and_then_stored(dut, wait):
    """The checking pass shows the beats of the write, in one cycle with it and behind one question."""
    tb = await bench(dut)
    for pdu, first, values, space in writes(tb):
        tb.bank.begin(grant_wait=wait, beat_wait=wait, unacceptable=lambda *_: None)
        await tb.both(frames.adu(OWN, pdu), timing=False)
        tb.bank.check()
        seen = tb.bank.request
        expected = [(space, first + n, value) for n, value in enumerate(values)]
        assert seen.checks == expected, f"{frames.text(pdu)}: checked {seen.checks}, expected {expected}"
        stored = [beat[1:] for beat in seen.beats if beat[0]]
        assert stored == expected, f"{frames.text(pdu)}: stored {stored}, expected {expected}"
        assert seen.bursts == 1, f"{frames.text(pdu)}: cyc rose {seen.bursts} times"
        assert len(seen.questions) == (2 if pdu[0] == FC.READ_WRITE else 1)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[0, EX.VALUE, EX.ADDRESS, 8])
async def one_value_that_is_refused_stops_the_whole_write(dut, code):
    """At every position: the bank's code (0: 04) is the answer, and nothing was stored."""
    tb = await bench(dut)
    for pdu, first, values, space in writes(tb):
        for place in range(len(values)):
            before = dict(tb.bank.memory)
            tb.bank.begin(unacceptable=lambda _space, item, _data, bad=first + place: code if item == bad else None)
            answer = await tb.query(frames.adu(OWN, pdu))
            tb.bank.check()
            shown = f"{frames.text(pdu)}, value {place} refused with {code}"
            expected = frames.adu(OWN, bytes([pdu[0] | 0x80, code or EX.FAILURE]))
            assert answer and answer.data == expected, f"{shown}: seen {answer and frames.text(answer.data)}"
            assert tb.bank.memory == before, f"{shown}: something was stored"
            assert not any(beat[0] for beat in tb.bank.request.beats), f"{shown}: {tb.bank.request.beats}"
            checked = len(tb.bank.request.checks)  # with sixteen bits a beat those of the beats before
            assert checked == place or (WIDE and space == Space.COILS and checked <= place < checked + 16), shown
            assert tb.bank.request.checks == [(space, first + n, values[n]) for n in range(checked)], shown
            assert not int(dut.wb_cyc_o.value), f"{shown}: cyc stays up"
    tb.bank.begin()
    answer = await tb.query(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 1)))
    assert answer and not answer.data[1] & 0x80, "the line does not go on"


@cocotb.test()
async def broadcast_is_checked_too(dut):
    tb = await bench(dut)
    pdu = frames.write_registers(REGISTER, [3, 4])
    tb.bank.begin()
    assert await tb.both(frames.adu(BROADCAST, pdu), PATIENCE, timing=False) is None
    assert tb.bank.request.checks == [(Space.HOLDINGS, REGISTER, 3), (Space.HOLDINGS, REGISTER + 1, 4)]
    before = dict(tb.bank.memory)
    tb.bank.begin(unacceptable=lambda _space, item, _data: EX.VALUE if item == REGISTER + 1 else None)
    bad = frames.write_registers(REGISTER, [5, 6])
    assert await tb.query(frames.adu(BROADCAST, bad), patience=PATIENCE) is None
    assert tb.bank.memory == before and len(tb.bank.request.checks) == 1
    tb.bank.check()
    await tb.finish()


@cocotb.test()
async def reads_are_not_checked(dut):
    tb = await bench(dut)
    for pdu in (frames.read(FC.READ_COILS, COIL, 9), frames.read(FC.READ_HOLDINGS, REGISTER, 5)):
        tb.bank.begin(unacceptable=lambda *_: EX.VALUE)
        await tb.both(frames.adu(OWN, pdu), timing=False)
        assert not tb.bank.request.checks
        tb.bank.check()
    await tb.finish()


@cocotb.test()
async def a_write_that_is_not_granted_is_not_checked(dut):
    tb = await bench(dut)
    for pdu, *_ in writes(tb):
        tb.bank.begin(refuse=EX.ADDRESS)
        answer = await tb.query(frames.adu(OWN, pdu))
        assert answer and answer.data[2] == EX.ADDRESS
        assert not tb.bank.request.checks and not tb.bank.request.bursts
        tb.bank.check()


@cocotb.test()
async def a_bank_silent_in_the_checking_pass_is_given_up(dut):
    """04 after the stall limit; nothing was stored."""
    tb = await bench(dut, stall_limit=40)
    for pdu, _first, values, _space in writes(tb):
        before, reads = dict(tb.bank.memory), int(pdu[0] == FC.MASK_WRITE)
        tb.bank.begin(silent_beat=reads + len(values) - 1)
        answer = await tb.query(frames.adu(OWN, pdu))
        assert answer and answer.data == frames.adu(OWN, bytes([pdu[0] | 0x80, EX.FAILURE]))
        assert tb.bank.memory == before and not int(dut.wb_cyc_o.value)
        tb.bank.check()


@cocotb.test()
async def write_strobe_comes_with_the_write_alone(dut):
    tb = await bench(dut)
    strobes = []

    async def watch():
        while True:
            await cocotb.triggers.RisingEdge(dut.write_stb_o)
            strobes.append(len([beat for beat in tb.bank.request.beats if beat[0]]))

    cocotb.start_soon(watch())
    for pdu, _first, values, _space in writes(tb):
        strobes.clear()
        tb.bank.begin(unacceptable=lambda *_: EX.VALUE)
        await tb.query(frames.adu(OWN, pdu))
        assert not strobes, f"{frames.text(pdu)}: refused, but told"
        tb.bank.begin()
        await tb.query(frames.adu(OWN, pdu))
        assert strobes == [len(values)]
