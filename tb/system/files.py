# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""File records, function codes 14 and 15, on the RAM bank: groups, limits, order of checks, host port."""

import cocotb
from harness.bench import Bench
from protocol import frames
from protocol.defs import BROADCAST, EX, FC, READ_FILE_ANSWER, Space

OWN = 17


async def ask(tb, pdu, note=""):
    """The answer PDU to a unicast request, checked against the model."""
    return (await tb.both(frames.adu(OWN, pdu), note=note))[1:-2]


async def refused(tb, pdu, code, note=""):
    """The request must end with exception `code`."""
    answer = await ask(tb, pdu, note)
    assert answer == bytes([pdu[0] | 0x80, code]), (
        f"{note} {frames.text(pdu)}: expected {code:02X}, seen {answer.hex()}"
    )


async def put(tb, file, first, words):
    """Records by the host port."""
    for place, word in enumerate(words):
        await tb.preset((Space.FILES, tb.slave.config.record_item(file, first + place)), word)


def ends(tb):
    """(files, records of each)."""
    return tb.slave.config.files


@cocotb.test()
async def groups_are_read_in_the_order_of_the_request(dut):
    tb = await Bench.start(dut)
    files, records = ends(tb)
    places = [(files, records - 3), (1, 0), (files, 0), (1 + files // 2, 1), (1, records - 3)]
    for place, (file, first) in enumerate(places):
        await put(tb, file, first, [0x1000 * (place + 1) + i for i in range(3)])
    groups = [(file, first, 1 + place % 3) for place, (file, first) in enumerate(places)]
    answer = await ask(tb, frames.read_files(*groups))
    wanted = b""
    for place, (_file, _first, quantity) in enumerate(groups):
        words = [0x1000 * (place + 1) + i for i in range(quantity)]
        wanted += bytes([1 + 2 * quantity, 6]) + frames.pack_words(words)
    assert answer == bytes([FC.READ_FILE, len(wanted)]) + wanted
    assert len(set(places)) == len(places)
    await ask(tb, frames.read_files(*[groups[0]] * 3))  # one group three times
    await tb.finish()


@cocotb.test()
async def groups_are_written_in_the_order_of_the_request(dut):
    """The echo, one pulse a group, and the later of two groups that overlap wins."""
    tb = await Bench.start(dut)
    files, records = ends(tb)
    pdu = frames.write_files(
        (files, records - 2, [0xAAAA, 0xBBBB]),
        (1, 0, [0x0001, 0x0203, 0x0405]),
        (1, 2, [0x1111, 0x2222]),
        (1, 1, [0x3333]),
    )
    assert await ask(tb, pdu) == pdu
    assert tb.writes == [
        (Space.FILES, records - 2, records - 1, files),
        (Space.FILES, 0, 2, 1),
        (Space.FILES, 2, 3, 1),
        (Space.FILES, 1, 1, 1),
    ]
    for record, word in enumerate((0x0001, 0x3333, 0x1111, 0x2222)):
        assert await tb.host(Space.FILES, tb.slave.config.record_item(1, record)) == word
    answer = await ask(tb, frames.read_files((1, 0, 4), (files, records - 2, 2)))
    assert answer[2:] == b"\x09\x06" + frames.pack_words([1, 0x3333, 0x1111, 0x2222]) + b"\x05\x06\xaa\xaa\xbb\xbb"
    await tb.finish()


@cocotb.test()
async def file_and_record_limits(dut):
    """File 1 to the last, record to the last, never past it into the next file."""
    tb = await Bench.start(dut)
    files, records = ends(tb)
    for file, first, quantity, good in (
        (1, 0, 1, True),
        (files, records - 1, 1, True),
        (1, records - 1, 2, False),
        (1, records - 2, 2, True),
        (1, records - 2, 3, False),
        (1, records, 1, False),
        (files, records - 1, 2, False),
        (0, 0, 1, False),
        (files + 1, 0, 1, False),
        (0x0100 + 1, 0, 1, False),
        (0x8001, 0, 1, False),
        (0xFFFF, 0, 1, False),
        (1, 9999, 1, records > 9999),
        (1, 9999, 2, False),
        (1, 10000, 1, False),
        (1, 0x8000, 1, False),
        (1, 0xFFFF, 1, False),
        (1, 0xFFFF, 2, False),
        (1, 0xFFFF, 100, False),
    ):
        note = f"file {file}, record {first}, {quantity}"
        read = frames.read_files((file, first, quantity))
        write = frames.write_files((file, first, [0xBAD] * min(quantity, 3)))
        if good:
            assert (await ask(tb, read, note))[0] == FC.READ_FILE
            assert await ask(tb, write, note) == write
        else:
            await refused(tb, read, EX.ADDRESS, note)
            if quantity <= 3:
                await refused(tb, write, EX.ADDRESS, note)
    await tb.finish()


@cocotb.test()
async def answer_length_limit(dut):
    """121 registers in one group, F5H bytes in all; one more is exception 03."""
    tb = await Bench.start(dut)
    _files, records = ends(tb)
    most = (READ_FILE_ANSWER - 2) // 2
    if records >= most:
        await put(tb, 1, 0, [tb.rng.getrandbits(16) for _ in range(8)])
        answer = await ask(tb, frames.read_files((1, 0, most)))
        assert answer[1] == 2 + 2 * most == 0xF4
        answer = await ask(tb, frames.read_files((1, 0, 60), (1, 1, 60)))
        assert answer[1] == 0xF4
    for wrong in (
        [(1, 0, most + 1)],
        [(1, 0, 60), (1, 0, 61)],
        [(1, 0, 0x0100)],
        [(1, 0, 0x7FFF)],
        [(1, 0, 0x8001)],
        [(1, 0, 0xFFFF)],
        [(1, 0, 0x8000), (1, 0, 0x8000)],  # adds up to nothing in 16 bits
        [(1, 0, 0xFFFF), (1, 0, 1)],
        [(1, 0, 0xFFFE), (1, 0, 1), (1, 0, 1)],
        [(1, 0, 0x7FFF), (1, 0, 0x8001)],
        [(1, 0, 0)],
        [(1, 0, 1), (1, 0, 0)],
    ):
        await refused(tb, frames.read_files(*wrong), EX.VALUE)
    groups = [(1, i % records, 1) for i in range(35)]
    answer = await ask(tb, frames.read_files(*groups))  # F5H bytes asked
    assert answer[1] == 35 * 4
    groups[17] = (1, 0, 1 + (READ_FILE_ANSWER - 35 * 4) // 2)
    if records >= groups[17][2]:
        assert (await ask(tb, frames.read_files(*groups)))[1] == 0xF4
    groups[17] = (1, 0, groups[17][2] + 1)
    await refused(tb, frames.read_files(*groups), EX.VALUE)
    await tb.finish()


@cocotb.test()
async def byte_count_of_a_read(dut):
    tb = await Bench.start(dut)
    right = frames.read_files((1, 0, 1), (1, 1, 1))
    for wrong in (
        right[:1],
        right[:2],
        bytes([FC.READ_FILE, 0]),
        right + b"\0",
        right[:-1],
        right[:-7],
        right[:1] + b"\x07" + right[2:],
        frames.read_files((1, 0, 1), byte_count=6),
        frames.read_files((1, 0, 1), byte_count=8) + b"\0",
        frames.read_files((1, 0, 1), byte_count=14),
        frames.read_files((1, 0, 1), byte_count=0x87),
        frames.read_files((1, 0, 1), byte_count=6)[:-1],
        bytes([FC.READ_FILE, 13]) + right[2:-1],
    ):
        await refused(tb, wrong, EX.VALUE)
    await tb.finish()


@cocotb.test()
async def byte_count_and_groups_of_a_write(dut):
    """09H to FBH bytes, and the groups must fill them exactly."""
    tb = await Bench.start(dut)
    files, records = ends(tb)
    right = frames.write_files((1, 0, [0xBAD, 0xBAD]), (1, 4, [0xBAD]))
    for wrong in (
        right[:1],
        right[:2],
        bytes([FC.WRITE_FILE, 0]),
        right + b"\0",
        right[:-1],
        right[:-2],
        frames.write_files((1, 0, [0xBAD]), byte_count=8),
        frames.write_files((1, 0, [0xBAD]), byte_count=10),
        frames.write_files((1, 0, [])),
        frames.write_files((1, 0, [0xBAD]), (1, 0, [])),
        frames.write_files((1, 0, [0xBAD], 0)),
        frames.write_files((1, 0, [0xBAD], 2)),
        frames.write_files((1, 0, [0xBAD, 0xBAD], 1)),
        frames.write_files((1, 0, [0xBAD], 0x8001)),
        frames.write_files((1, 0, [0xBAD] * 2, 0x0102)),
        frames.write_files((1, 0, [0xBAD], 0xFFFF)),
        # the first group takes in the second and leaves a rest
        frames.write_files((1, 0, [0xBAD], 4), (1, 4, [0xBAD])),
        bytes([FC.WRITE_FILE, 10]) + frames.write_files((1, 0, [0xBAD]))[2:] + b"\0",
        bytes([FC.WRITE_FILE, 15]) + frames.write_files((1, 0, [0xBAD]))[2:] + b"\x06\0\1\0\0\0",
    ):
        await refused(tb, wrong, EX.VALUE)
    words = [tb.rng.getrandbits(16) for _ in range(122)]
    if records >= 122:
        pdu = frames.write_files((files, records - 122, words))
        assert len(pdu) == 2 + 0xFB and await ask(tb, pdu) == pdu
    pdu = frames.write_files(*[(1 + i % files, i % records, [i]) for i in range(27)])  # F3H bytes
    assert await ask(tb, pdu) == pdu
    await tb.finish()


@cocotb.test()
async def exceptions_come_in_order(dut):
    """03 of any group before 02 of any group before busy and failure; nothing is written."""
    tb = await Bench.start(dut)
    files, records = ends(tb)
    good, word = (1, 0, 1), (1, 0, [0xBAD])
    outside = [(0, 0), (files + 1, 0), (1, records), (1, 0xFFFF)]
    for setup in ({"failure": EX.PARITY}, {"busy": 1}):
        tb.apply(**setup)
        for file, first in outside if "failure" in setup else outside[1:2]:
            await refused(tb, frames.read_files((file, first, 1), (1, 0, 0)), EX.VALUE)
            await refused(tb, frames.read_files(good, (file, first, 1)), EX.ADDRESS)
            await refused(tb, frames.write_files((file, first, [0xBAD]), (1, 0, [0xBAD], 2)), EX.VALUE)
            await refused(tb, frames.write_files(word, (file, first, [0xBAD])), EX.ADDRESS)
            await refused(tb, frames.write_files((file, first, [0xBAD]), word), EX.ADDRESS)
        for kind in (0, 7, 0x86):
            await refused(tb, frames.read_files(good, (*good, kind)), EX.ADDRESS)
            await refused(tb, frames.read_files((*good, kind), (1, 0, 0)), EX.VALUE)
            await refused(tb, frames.write_files(word, (*word, None, kind)), EX.ADDRESS)
            await refused(tb, frames.write_files((*word, None, kind), (1, 0, [0xBAD], 0)), EX.VALUE)
        code = EX.BUSY if "busy" in setup else EX.PARITY
        await refused(tb, frames.read_files(good), code)
        await refused(tb, frames.write_files(word, word), code)
    tb.apply(busy=0, failure=0, write_lock=1)
    await refused(tb, frames.write_files(word), EX.ADDRESS)
    assert (await ask(tb, frames.read_files(good)))[0] == FC.READ_FILE
    tb.apply(write_lock=0)
    assert await tb.host(Space.FILES, 0) == 0
    await tb.finish()


@cocotb.test()
async def files_are_not_for_everyone(dut):
    tb = await Bench.start(dut)
    for pdu in (frames.write_files((1, 0, [0xBAD])), frames.read_files((1, 0, 1))):
        assert await tb.both(frames.adu(BROADCAST, pdu)) is None
    assert await tb.host(Space.FILES, 0) == 0
    await tb.finish()


@cocotb.test()
async def host_port_sees_the_records(dut):
    """Record r of file f is item (f - 1) * records + r of space 4."""
    tb = await Bench.start(dut)
    files, records = ends(tb)
    for file in sorted({1, 2, files} & set(range(1, files + 1))):
        for record in (0, records // 2, records - 1):
            item = (file - 1) * records + record
            await tb.preset((Space.FILES, item), 0xFFFF - item)
            answer = await ask(tb, frames.read_files((file, record, 1)))
            assert answer[4:] == frames.pack_words([0xFFFF - item])
    if files * records < 0x10000:
        assert await tb.host(Space.FILES, files * records) is None
        assert await tb.host(Space.FILES, files * records, write=1) is None
    await tb.finish()
