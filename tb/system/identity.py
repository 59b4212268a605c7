# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Function codes 11 and 2B/0E: what the build says of itself, whole and in segments."""

import cocotb
from harness.bench import Bench
from protocol import frames
from protocol.defs import (
    BROADCAST,
    DEVICE_ID_HEAD,
    EX,
    EXTENDED,
    FC,
    INDIVIDUAL,
    INDIVIDUAL_ACCESS,
    LEVEL_LAST,
)

OWN = 17
STREAMS = (1, 2, 3)


async def ask(tb, pdu):
    """The answer PDU to a unicast request, checked against the model."""
    return (await tb.both(frames.adu(OWN, pdu)))[1:-2]


def objects_of(answer):
    """[(id, value), ...] of an answer PDU, which they must fill exactly."""
    count, place, out = answer[6], DEVICE_ID_HEAD, []
    for _ in range(count):
        number, size = answer[place : place + 2]
        out.append((number, answer[place + 2 : place + 2 + size]))
        place += 2 + size
    assert place == len(answer), f"{count} objects end at {place} of {len(answer)} bytes"
    return out


async def walk(tb, code, first):
    """(objects, segments) as a master gets them that follows "more" and "next"."""
    config, got, segments = tb.slave.config, [], 0
    while True:
        answer = await ask(tb, frames.device_identification(code, first))
        segments += 1
        assert answer[:4] == bytes([FC.READ_DEVICE_ID, 0x0E, code, config.conformity])
        assert len(answer) <= config.device_id_limit, f"{len(answer)} bytes"
        got += objects_of(answer)
        more, first = answer[4:6]
        if not more:
            assert not first
            return got, segments
        assert more == 0xFF and segments < 30
        room = config.device_id_limit - len(answer)
        assert 2 + len(config.objects[first]) > room, f"object {first:02X} would have gone into {room} bytes"


def category(config, code):
    """The objects of a stream, by the standard."""
    level = min(code, config.conformity & ~INDIVIDUAL_ACCESS & 0xFF, EXTENDED)
    return [(i, config.objects[i]) for i in sorted(config.objects) if i <= LEVEL_LAST[level]]


@cocotb.test()
@cocotb.parametrize(code=STREAMS)
async def every_object_comes_once_and_in_order(dut, code):
    tb = await Bench.start(dut)
    wanted = category(tb.slave.config, code)
    got, _segments = await walk(tb, code, 0)
    assert got == wanted, f"expected {wanted}, seen {got}"
    middle = wanted[len(wanted) // 2][0]
    got, _segments = await walk(tb, code, middle)
    assert got == [pair for pair in wanted if pair[0] >= middle]
    await tb.finish()


@cocotb.test()
async def object_ids_that_are_not_there(dut):
    """In a stream they begin anew, alone they are exception 02."""
    tb = await Bench.start(dut)
    known = set(tb.slave.config.objects)
    near = {i + d for i in known for d in (-1, 1)} | {3, 6, 7, 0x7F, 0x80, 0x81, 0xFE, 0xFF}
    individual = bool(tb.slave.config.conformity & INDIVIDUAL_ACCESS)
    for number in sorted(i for i in near - known if 0 <= i <= 0xFF):
        answer = await ask(tb, frames.device_identification(INDIVIDUAL, number))
        assert answer == bytes([0xAB, EX.ADDRESS if individual else EX.VALUE])
    for code in STREAMS:
        wanted = category(tb.slave.config, code)
        outside = sorted(i for i in known if i > LEVEL_LAST[code])[:1]
        for number in (7, 0xFE, *outside):
            answer = await ask(tb, frames.device_identification(code, number))
            assert objects_of(answer)[0] == wanted[0], f"code {code} from {number:02X}"
    await tb.finish()


@cocotb.test()
async def each_object_alone(dut):
    tb = await Bench.start(dut)
    individual = tb.slave.config.conformity & INDIVIDUAL_ACCESS
    for number, value in tb.slave.config.objects.items():
        answer = await ask(tb, frames.device_identification(INDIVIDUAL, number))
        if individual:
            assert answer[3:7] == bytes([tb.slave.config.conformity, 0, 0, 1])
            assert objects_of(answer) == [(number, value)]
        else:
            assert answer == bytes([0xAB, EX.VALUE])
    await tb.finish()


@cocotb.test()
async def wrong_requests(dut):
    """MEI type 01, length and code 03, and all that before the object."""
    tb = await Bench.start(dut)
    for mei in (0x00, 0x0D, 0x0F, 0x1E, 0x8E, 0xFF):
        for pdu in (frames.device_identification(1, mei=mei), bytes([FC.READ_DEVICE_ID, mei])):
            assert await ask(tb, pdu) == bytes([0xAB, EX.FUNCTION])
    right = frames.device_identification(1)
    for pdu in (right + b"\0", right[:3], right[:2], right[:1]):
        assert await ask(tb, pdu) == bytes([0xAB, EX.VALUE])
    for code in (0, 5, 6, 0x81, 0x84, 0xFF):
        assert await ask(tb, frames.device_identification(code, 0x70)) == bytes([0xAB, EX.VALUE])
    assert await tb.both(frames.adu(BROADCAST, right)) is None
    tb.apply(busy=1, failure=EX.FAILURE)
    assert (await ask(tb, frames.device_identification(1)))[0] == FC.READ_DEVICE_ID, "nothing to be busy for"
    await tb.finish()


@cocotb.test()
async def server_id_and_run_indicator(dut):
    tb = await Bench.start(dut)
    config = tb.slave.config
    for run in (1, 0, 1):
        tb.apply(run_indicator=run)
        answer = await ask(tb, frames.bare(FC.REPORT_SERVER_ID))
        body = config.server_id + (b"\xff" if run else b"\0") + config.additional_data
        assert answer == bytes([FC.REPORT_SERVER_ID, len(body)]) + body
    assert await ask(tb, frames.bare(FC.REPORT_SERVER_ID, b"\0")) == bytes([0x91, EX.VALUE])
    assert await tb.both(frames.adu(BROADCAST, frames.bare(FC.REPORT_SERVER_ID))) is None
    tb.apply(busy=1)
    assert await ask(tb, frames.bare(FC.REPORT_SERVER_ID)) == answer
    await tb.finish()


@cocotb.test()
async def exception_status_is_the_input(dut):
    tb = await Bench.start(dut)
    for status in (0x00, 0x01, 0x80, 0x6D, 0xFF):
        tb.apply(exception_status=status)
        assert await ask(tb, frames.bare(FC.READ_EXCEPTION_STATUS)) == bytes([FC.READ_EXCEPTION_STATUS, status])
    assert await ask(tb, frames.bare(FC.READ_EXCEPTION_STATUS, b"\0")) == bytes([0x87, EX.VALUE])
    assert await tb.both(frames.adu(BROADCAST, frames.bare(FC.READ_EXCEPTION_STATUS))) is None
    tb.apply(busy=1)
    assert await ask(tb, frames.bare(FC.READ_EXCEPTION_STATUS)) == bytes([FC.READ_EXCEPTION_STATUS, 0xFF])
    await tb.finish()
