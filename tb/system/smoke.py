# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A little of everything at the pins, for where a simulation is slow: the gates of a synthesised slave.

Takes any build of the drop-ins. Every line is compared with the model: answer, strobes, write pulses, driver
enable; at the end memory, counters and log.
"""

import cocotb
from harness.bench import Bench
from harness.lines import with_error, with_gap
from protocol import frames
from protocol.defs import ALL_FUNCTIONS, BROADCAST, EX, FC, FORMATS, FUNCTIONS, Space, Sub

OWN, OTHER = 17, 18
READERS = (FC.READ_COILS, FC.READ_DISCRETES, FC.READ_HOLDINGS, FC.READ_INPUTS)


def table(tb, space):
    """(first, last) address of a table."""
    base, count = tb.slave.config.tables[space]
    return base, base + count - 1


def sensible(tb, code):
    """A request PDU of function `code` that a slave with its tables carries out."""
    word = tb.rng.getrandbits(16)
    register, coil = table(tb, Space.HOLDINGS)[0], table(tb, Space.COILS)[0]
    if code in READERS:
        return frames.read(code, table(tb, FUNCTIONS[code].space)[0], 3)
    return {
        FC.WRITE_COIL: frames.write_coil(coil + 1, True),
        FC.WRITE_REGISTER: frames.write_register(register + 1, word),
        FC.DIAGNOSTICS: frames.diagnostics(Sub.QUERY_DATA, word),
        FC.WRITE_COILS: frames.write_coils(coil, [word >> i & 1 for i in range(11)]),
        FC.WRITE_REGISTERS: frames.write_registers(register, [word, word ^ 0xFFFF, 2]),
        FC.READ_FILE: frames.read_files((1, 0, 2), (2, 3, 1)),
        FC.WRITE_FILE: frames.write_files((1, 0, [word, 1]), (2, 3, [word])),
        FC.MASK_WRITE: frames.mask_write(register, 0xF0F0, word),
        FC.READ_WRITE: frames.read_write(register, 2, register + 1, [word, 3]),
        FC.READ_FIFO: frames.read_fifo(register + 2),
        FC.READ_DEVICE_ID: frames.device_identification(1),
    }.get(code, frames.bare(code))


def refusal(answer):
    """The exception code of an answer, 0 if it is none."""
    return answer[2] if answer[1] & 0x80 else 0


@cocotb.test()
async def every_function_once(dut):
    """Right, then a byte too long: 03, or 01 for a function that is left out. What was written is read again."""
    tb = await Bench.start(dut)
    for space in (Space.DISCRETES, Space.INPUTS):
        for item in range(3):
            await tb.preset((space, table(tb, space)[0] + item), tb.rng.getrandbits(1 if space < 2 else 16))
    write_first = sorted(ALL_FUNCTIONS, key=lambda code: not FUNCTIONS[code].writes)
    await tb.both(frames.adu(OWN, frames.write_registers(table(tb, Space.HOLDINGS)[0] + 2, [2, 0x1234, 0xABCD])))
    for code in write_first:
        built = tb.slave.config.supports(code)
        pdu = sensible(tb, code)
        if not built and code in (FC.READ_FILE, FC.WRITE_FILE, FC.READ_FIFO, FC.MASK_WRITE):
            assert refusal(await tb.both(frames.adu(OWN, pdu))) == EX.FUNCTION
            continue
        assert refusal(await tb.both(frames.adu(OWN, pdu), note=f"{code.name}")) == (0 if built else EX.FUNCTION)
        wanted = EX.VALUE if built else EX.FUNCTION
        assert refusal(await tb.both(frames.adu(OWN, pdu + b"\0"), note=f"{code.name}, long")) == wanted
    await tb.finish()


@cocotb.test()
async def exceptions_in_their_order(dut):
    """01, 03, 02, 06 of the functions that every build has, nothing written by any of them."""
    tb = await Bench.start(dut)
    first, last = table(tb, Space.HOLDINGS)
    for busy in (0, 1):
        tb.apply(busy=busy)
        for pdu, wanted in (
            (b"\x63", EX.FUNCTION),
            (frames.read(FC.READ_HOLDINGS, last + 1, 0), EX.VALUE),
            (frames.read(FC.READ_HOLDINGS, first, 126), EX.VALUE),
            (frames.read(FC.READ_HOLDINGS, last, 2), EX.ADDRESS),
            (frames.write_registers(last, [1, 2]), EX.ADDRESS),
            (frames.write_register(last + 1, 1), EX.ADDRESS),
            (frames.read(FC.READ_HOLDINGS, last, 1), EX.BUSY if busy else 0),
            (frames.write_register(last, 0xBEEF), EX.BUSY if busy else 0),
        ):
            assert refusal(await tb.both(frames.adu(OWN, pdu))) == wanted
    tb.apply(busy=0, write_lock=1)
    assert refusal(await tb.both(frames.adu(OWN, frames.write_register(last, 1)))) == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def broadcast_is_obeyed_and_not_answered(dut):
    tb = await Bench.start(dut)
    first, _ = table(tb, Space.HOLDINGS)
    for pdu in (frames.write_registers(first, [0x1234, 0x5678]), frames.read(FC.READ_HOLDINGS, first, 1)):
        assert await tb.both(frames.adu(BROADCAST, pdu)) is None
    answer = await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, first, 2)))
    assert answer[3:7] == b"\x12\x34\x56\x78"
    await tb.finish()


@cocotb.test()
async def bad_frames_are_silence(dut):
    """Check field, swapped check field, parity, stop bit, gap, too short, another's; then a good one."""
    tb = await Bench.start(dut)
    good = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, table(tb, Space.HOLDINGS)[0], 1))
    for line in (
        frames.bad_crc(good, 0x0100),
        frames.swapped_crc(good),
        with_error(good, 3, "parity"),
        with_error(good, 7, "framing"),
        with_gap(good, 4, (tb.slave.config.t15 + tb.slave.config.t35) / 2),
        good[:3],
        frames.adu(OTHER, good[1:-2]),
    ):
        assert await tb.both(line) is None
    assert await tb.both(good)
    await tb.finish()


@cocotb.test()
async def t35_ends_a_frame(dut):
    """A silence a bit longer than t3.5 makes two frames of a line, a bit shorter spoils it."""
    tb = await Bench.start(dut)
    pdu = frames.read(FC.READ_HOLDINGS, table(tb, Space.HOLDINGS)[0], 1)
    both, place = frames.adu(OTHER, pdu) + frames.adu(OWN, pdu), len(frames.adu(OTHER, pdu))
    bit = tb.bit / tb.line.fmt.length / tb.bit  # in characters
    assert await tb.both(with_gap(both, place, tb.slave.config.t35 + bit))
    assert tb.strobes["frame"] == 2
    assert await tb.both(with_gap(both, place, tb.slave.config.t35 - bit)) is None
    await tb.finish()


@cocotb.test()
async def formats_and_rates(dut):
    """Each format, at 8, 9 and 19 clocks a bit, driver enable with lead and tail."""
    tb = await Bench.start(dut)
    for fmt, bit_time, wide in ((FORMATS[1], 9, 1), (FORMATS[2], 8, 0), (FORMATS[3], 19, 2), (FORMATS[0], 8, 0)):
        tb.apply(fmt=fmt, bit_time=bit_time, de_lead=wide, de_tail=wide)
        await tb.silence()
        assert await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, table(tb, Space.HOLDINGS)[0], 1)))
    await tb.finish()
