# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_rtu_core against a bank that waits, refuses, errs and falls silent."""

import cocotb
from cocotb.triggers import Timer
from harness.bank import Bank
from harness.bench import CLOCK_PS, PROCESSING_CLOCKS, Bench
from harness.lines import with_error, with_gap
from protocol import frames
from protocol.defs import BROADCAST, EX, FC, Space

OWN = 17
COIL, REGISTER = 30, 40


async def bench(dut, **setup):
    """A bench with a Python bank; presets go to the bank's memory."""
    tb = await Bench.start(dut, **setup)
    tb.bank = Bank(tb)
    return tb


def preset(tb, key, value):
    """Put `value` at `key` in bank and model."""
    tb.bank.memory[key] = tb.slave.memory[key] = value


def requests():
    """One request of each function, with the number of bus beats it needs (reads + writes)."""
    return [
        (frames.read(FC.READ_COILS, COIL, 19), 19),
        (frames.read(FC.READ_DISCRETES, COIL, 3), 3),
        (frames.read(FC.READ_HOLDINGS, REGISTER, 5), 5),
        (frames.read(FC.READ_INPUTS, REGISTER, 4), 4),
        (frames.write_coil(COIL, True), 1),
        (frames.write_register(REGISTER, 0x1234), 1),
        (frames.write_coils(COIL, [1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1]), 11),
        (frames.write_registers(REGISTER, [1, 0xFFFF, 0x8001]), 3),
        (frames.mask_write(REGISTER, 0xF0F0, 0x1234), 2),
        (frames.read_write(REGISTER, 4, REGISTER + 2, [7, 8, 9]), 7),
    ]


def questions(pdu):
    """The questions a request must ask, in any order: {(space, first, last, write)}."""
    code, words = pdu[0], frames.unpack_words(pdu[1:9].ljust(8, b"\0"))
    single = code in (FC.WRITE_COIL, FC.WRITE_REGISTER, FC.MASK_WRITE)
    space = {
        FC.READ_COILS: Space.COILS,
        FC.READ_DISCRETES: Space.DISCRETES,
        FC.READ_INPUTS: Space.INPUTS,
        FC.WRITE_COIL: Space.COILS,
        FC.WRITE_COILS: Space.COILS,
    }.get(code, Space.HOLDINGS)
    writes = code not in (FC.READ_COILS, FC.READ_DISCRETES, FC.READ_HOLDINGS, FC.READ_INPUTS)
    if code == FC.READ_WRITE:
        return {
            (space, words[0], words[0] + words[1] - 1, 0),
            (space, words[2], words[2] + words[3] - 1, 1),
        }
    return {(space, words[0], words[0] + (1 if single else words[1]) - 1, int(writes))}


async def ask(tb, pdu, patience=None, address=OWN, **manner):
    """One request against a bank of this manner; what the bus saw is checked."""
    tb.bank.begin(**manner)
    answer = await tb.both(frames.adu(address, pdu), patience, timing=not manner)
    tb.bank.check()
    return answer


def memories_agree(tb):
    """The bank holds what the model holds."""
    for key, value in tb.bank.memory.items():
        assert tb.slave.memory[key] == value, f"{key}: bank {value:04X}, model {tb.slave.memory[key]:04X}"


@cocotb.test()
@cocotb.parametrize(wait=[0, 1, 2, 3, 7, 31, 100])
async def bank_waits(dut, wait):
    tb = await bench(dut)
    for item in range(20):
        preset(tb, (Space.COILS, COIL + item), tb.rng.getrandbits(1))
        preset(tb, (Space.DISCRETES, COIL + item), tb.rng.getrandbits(1))
        preset(tb, (Space.HOLDINGS, REGISTER + item), tb.rng.getrandbits(16))
        preset(tb, (Space.INPUTS, REGISTER + item), tb.rng.getrandbits(16))
    for pdu, beats in requests():
        await ask(tb, pdu, grant_wait=wait, beat_wait=wait)
        seen = tb.bank.request
        assert set(seen.questions) == questions(pdu), f"asked {seen.questions}"
        assert len(seen.beats) == beats, f"{len(seen.beats)} beats instead of {beats}"
        assert 1 <= seen.bursts <= len(seen.questions), f"cyc rose {seen.bursts} times"
        memories_agree(tb)
    await tb.finish()


@cocotb.test()
async def bank_waits_at_random(dut):
    tb = await bench(dut)
    for _ in range(2):
        for pdu, _beats in requests():
            await ask(
                tb,
                pdu,
                grant_wait=lambda: tb.rng.choice((0, 0, 1, 5, 100)),
                beat_wait=lambda: tb.rng.choice((0, 0, 0, 1, 2, 60)),
            )
            memories_agree(tb)
    await tb.finish()


@cocotb.test()
async def items_come_once_and_in_order(dut):
    tb = await bench(dut)
    for pdu, _beats in requests():
        await ask(tb, pdu)
        for write in (0, 1):
            items = [item for w, _, item, _ in tb.bank.request.beats if w == write]
            assert items == list(range(items[0], items[0] + len(items))) if items else True, items
        order = [w for w, *_ in tb.bank.request.beats]
        if pdu[0] == FC.READ_WRITE:
            assert order == sorted(order, reverse=True), "17H reads before it has written"
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 15])
async def refusal_is_the_exception_code(dut, code):
    """Whatever code the bank gives, and not one beat on the bus."""
    tb = await bench(dut)
    tb.slave.grant = lambda *_: code
    for pdu, _beats in requests() if code == EX.ADDRESS else requests()[code % 3 :: 4]:
        answer = await ask(tb, pdu, refuse=code)
        assert answer == frames.adu(OWN, bytes([pdu[0] | 0x80, code]))
        assert not tb.bank.request.beats and not tb.bank.request.bursts
    await tb.finish()


@cocotb.test()
async def refusal_of_the_second_range_changes_nothing(dut):
    tb = await bench(dut)
    pdu = frames.read_write(REGISTER, 2, REGISTER, [0xBAD, 0xBAD])
    asked = []
    tb.slave.grant = lambda *question: asked.append(question) or (EX.FAILURE if len(asked) == 2 else 0)
    answer = await ask(tb, pdu, refuse_second=EX.FAILURE)
    assert answer == frames.adu(OWN, bytes([pdu[0] | 0x80, EX.FAILURE]))
    assert len(tb.bank.request.questions) == 2 and not tb.bank.request.beats
    await tb.finish()


@cocotb.test()
async def question_past_65535_is_never_asked(dut):
    tb = await bench(dut)
    for pdu in (
        frames.read(FC.READ_HOLDINGS, 0xFFFF, 2),
        frames.read(FC.READ_COILS, 0xFFF0, 17),
        frames.write_coils(0xFFFE, [1, 1, 1]),
        frames.write_registers(0xFFFF, [0xBAD, 0xBAD]),
        frames.read_write(REGISTER, 1, 0xFFFF, [0xBAD, 0xBAD]),
        frames.read_write(0xFFFF, 2, REGISTER, [0xBAD]),
    ):
        answer = await ask(tb, pdu)
        assert answer[2] == EX.ADDRESS
        assert not tb.bank.request.beats
        assert all(first <= last for _, first, last, _ in tb.bank.request.questions)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[0, 2, 4, 6, 8, 10])
async def error_in_the_burst(dut, code):
    """err on any beat ends the burst with its code (none: 04); what was written stays written."""
    tb = await bench(dut)
    for pdu, beats in requests() if code == 0 else requests()[code % 5 :: 5]:
        for beat in sorted({0, beats // 2, beats - 1}):
            tb.bank.begin(error_beat=beat, error_code=code)
            answer = await tb.query(frames.adu(OWN, pdu))
            expected = frames.adu(OWN, bytes([pdu[0] | 0x80, code or EX.FAILURE]))
            shown = f"{frames.text(pdu)}, err at beat {beat}"
            assert answer, f"{shown}: silence"
            assert answer.data == expected, f"{shown}: seen {frames.text(answer.data)}"
            assert len(tb.bank.request.beats) == tb.bank.request.broken_at <= beat, f"{shown}: {tb.bank.request.beats}"
            tb.bank.check()
    tb.bank.begin()
    answer = await tb.query(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 1)))
    assert answer and not answer.data[1] & 0x80, "the line does not go on after an error"


@cocotb.test()
async def no_access_without_a_good_frame_for_us(dut):
    """Bad, foreign, prohibited or malformed: not a question, not a beat."""
    tb = await bench(dut)
    good = frames.adu(OWN, frames.write_registers(REGISTER, [0xBAD, 0xBAD]))
    lines = [
        frames.bad_crc(good),
        frames.bad_crc(good, 0x8000),
        frames.swapped_crc(good),
        good[:-1],
        good[:-2],
        good + good,
        frames.adu(OWN + 1, good[1:-2]),
        frames.adu(248, good[1:-2]),
        with_gap(good, 7, 2.0),
        with_error(good, len(good) - 1, "framing"),
        with_error(good, len(good) - 1, "parity"),
        with_error(good, 0, "parity"),
        frames.adu(OWN, good[1:-2] + b"\0"),
        frames.adu(OWN, good[1:-3]),
        frames.adu(OWN, frames.write_registers(REGISTER, [0xBAD], quantity=2)),
        frames.adu(OWN, frames.write_registers(REGISTER, [0xBAD], byte_count=3)),
        frames.adu(OWN, bytes([FC.WRITE_COIL, 0, COIL, 0xFF, 0x01])),
        frames.adu(BROADCAST, frames.mask_write(REGISTER, 0, 0xBAD)),
        frames.adu(BROADCAST, frames.read_write(REGISTER, 1, REGISTER, [0xBAD])),
        frames.adu(BROADCAST, frames.read(FC.READ_HOLDINGS, REGISTER, 1)),
        bytes(257),
    ]
    for line in lines:
        tb.bank.begin()
        await tb.both(line)
        tb.bank.check()
        assert not tb.bank.request.questions, f"asked {tb.bank.request.questions}"
        assert not tb.bank.request.bursts, "cyc without a grant"
    tb.apply(broadcast_en=0)
    await ask(tb, good[1:-2], address=BROADCAST)
    assert not tb.bank.request.questions, "broadcast is off"
    await tb.finish()


@cocotb.test()
async def broadcast_is_executed_and_refused_in_silence(dut):
    tb = await bench(dut)
    pdu = frames.write_registers(REGISTER, [3, 4])
    assert await ask(tb, pdu, patience=PATIENCE, address=BROADCAST) is None
    assert len(tb.bank.request.beats) == 2
    tb.slave.grant = lambda *_: EX.FAILURE
    assert await ask(tb, pdu, patience=PATIENCE, address=BROADCAST, refuse=EX.FAILURE) is None
    await tb.finish()


PATIENCE = 3000 * CLOCK_PS
STALL_BITS = 40


@cocotb.test()
async def stall_limit_on_the_question(dut):
    """A bank silent while asked: exception 06 after the limit, and the line goes on."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    for pdu, _beats in requests():
        tb.bank.begin(silent_grant=True)
        answer = await tb.query(frames.adu(OWN, pdu))
        expected = frames.adu(OWN, bytes([pdu[0] | 0x80, EX.BUSY]))
        assert answer and answer.data == expected, f"seen {answer}"
        late = tb.latency(answer) - STALL_BITS
        assert -1 <= late <= 2 + PROCESSING_CLOCKS / tb.setup.bit_time, f"answered {late:.1f} bits after the limit"
        assert not tb.bank.request.beats
        tb.bank.check()
        assert not await ask(tb, pdu) == expected, "the line does not go on"
        tb.bank.check()
    await tb.finish()


@cocotb.test()
async def stall_limit_in_the_burst(dut):
    """A bank silent during the burst: exception 04 after the limit, cyc released."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    for pdu, beats in requests():
        for beat in sorted({0, beats - 1}):
            tb.bank.begin(silent_beat=beat)
            answer = await tb.query(frames.adu(OWN, pdu))
            expected = frames.adu(OWN, bytes([pdu[0] | 0x80, EX.FAILURE]))
            assert answer and answer.data == expected, f"beat {beat}: seen {answer}"
            late = tb.latency(answer) - STALL_BITS
            assert -1 <= late <= 2 + PROCESSING_CLOCKS / tb.setup.bit_time, f"{late:.1f} bits after the limit"
            assert int(dut.wb_cyc_o.value) == 0, "cyc stays up"
            tb.bank.check()
            tb.bank.begin()
            answer = await tb.query(frames.adu(OWN, pdu))
            assert answer and not answer.data[1] & 0x80, "the line does not go on"


@cocotb.test()
async def stall_limit_counts_silence_not_the_burst(dut):
    """A slow bank that keeps answering is not stalled, however long the burst takes."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    wait = (STALL_BITS - 4) * tb.setup.bit_time
    pdu = frames.read(FC.READ_HOLDINGS, REGISTER, 6)
    answer = await ask(tb, pdu, grant_wait=wait, beat_wait=wait)
    assert not answer[1] & 0x80, f"seen {frames.text(answer)}"
    await tb.finish()


@cocotb.test()
async def without_a_stall_limit_the_core_waits(dut):
    tb = await bench(dut, stall_limit=0)
    pdu = frames.read(FC.READ_HOLDINGS, REGISTER, 1)
    tb.bank.begin(grant_wait=20_000)
    answer = await tb.query(frames.adu(OWN, pdu), patience=30_000 * CLOCK_PS)
    assert answer and not answer.data[1] & 0x80, f"seen {answer}"


@cocotb.test()
async def stalled_broadcast_is_silent(dut):
    tb = await bench(dut, stall_limit=STALL_BITS)
    frame = frames.adu(BROADCAST, frames.write_register(REGISTER, 1))
    for manner in ({"silent_grant": True}, {"silent_beat": 0}):
        tb.bank.begin(**manner)
        assert await tb.query(frame, patience=PATIENCE) is None
        assert await ask(tb, frames.read(FC.READ_HOLDINGS, 0, 1)) is not None


@cocotb.test()
async def answer_to_a_late_bank_goes_on(dut):
    """A grant that comes when nobody asks any more (one clock late) harms nothing."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    limit = STALL_BITS * tb.setup.bit_time
    pdu = frames.read(FC.READ_HOLDINGS, REGISTER, 2)
    for near in range(-3, 4):
        tb.bank.begin(grant_wait=limit + near)
        answer = await tb.query(frames.adu(OWN, pdu))
        assert answer, "silence"
        assert answer.data[1:3] in (bytes([pdu[0] | 0x80, EX.BUSY]), bytes([pdu[0], 4]))
        tb.bank.check()
        await Timer(200 * CLOCK_PS, "ps")


@cocotb.test()
async def busy_is_judged_after_the_bank(dut):
    """06 comes after 02, and a busy slave does nothing."""
    tb = await bench(dut, busy=1)
    for pdu, _beats in requests():
        assert (await ask(tb, pdu))[2] == EX.BUSY
        assert not tb.bank.request.beats
    answer = await ask(tb, frames.read(FC.READ_HOLDINGS, 2048, 1))
    assert answer[2] == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def longest_lists(dut):
    """125 registers, 2000 bits, 123 registers and 1968 bits in one burst each."""
    tb = await bench(dut)
    for item in range(2000):
        preset(tb, (Space.DISCRETES, item), tb.rng.getrandbits(1))
    for pdu, beats in (
        (frames.read(FC.READ_HOLDINGS, 0, 125), 125),
        (frames.read(FC.READ_DISCRETES, 0, 2000), 2000),
        (frames.write_registers(0, list(range(123))), 123),
        (frames.read_write(0, 125, 100, list(range(121))), 246),
        (frames.write_coils(0, [tb.rng.getrandbits(1) for _ in range(1024)]), 1024),
    ):
        await ask(tb, pdu)
        assert len(tb.bank.request.beats) == beats
        memories_agree(tb)
    await tb.finish()


@cocotb.test()
async def reset_releases_the_bus(dut):
    """rst_i in a burst or a question: cyc and the question fall, nothing is half remembered."""
    tb = await bench(dut)
    pdu = frames.write_registers(REGISTER, list(range(20)))
    for manner in ({"silent_beat": 7}, {"silent_grant": True}):
        tb.bank.begin(**manner)
        await tb.line.send(frames.adu(OWN, pdu))
        await Timer(round(tb.t35) + 200 * CLOCK_PS, "ps")
        busy = int(dut.wb_cyc_o.value) or int(dut.grant_req_o.value)
        assert busy, "the bank was not asked"
        await tb.reset(2)
        assert not int(dut.wb_cyc_o.value) and not int(dut.grant_req_o.value)
        tb.bank.begin()
        await tb.silence()
        assert await ask(tb, frames.read(FC.READ_HOLDINGS, 0, 1)) is not None
    await tb.finish()
