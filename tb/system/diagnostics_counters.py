# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every counter's rule and every byte of the event log, step by step."""

import cocotb
from cocotb.triggers import Timer
from harness.lines import with_error, with_gap
from harness.readout import LAST_ACTION_CLOCKS
from protocol import frames
from protocol.defs import ALL_COUNTERS, EX, FC, LOG_SIZE, OVERRUN_FLAG, Space, Sub

from system.story import OTHER, OWN, Story, everyone, own

READ = frames.read(FC.READ_HOLDINGS, 0, 1)
WRITE = frames.write_register(3, 0x5EED)
OUTSIDE = frames.read(FC.READ_HOLDINGS, 0xFFFF, 1)
EMPTY = frames.read(FC.READ_HOLDINGS, 0, 0)
LONG = bytes([OWN]) * 257
GOOD = "frames ours events"


@cocotb.test()
async def what_a_good_frame_counts(dut):
    story = await Story.begin(dut)
    for pdu in (READ, WRITE, frames.bare(FC.GET_EVENT_LOG), frames.diagnostics(Sub.QUERY_DATA, 0xA537)):
        assert (await story.step(own(pdu), GOOD, "80 40"))[0] == pdu[0]
    for code in (FC.READ_EXCEPTION_STATUS, FC.REPORT_SERVER_ID):
        await story.step(own(frames.bare(code)), GOOD, "80 40")
    await story.step(own(frames.device_identification(1)), GOOD, "80 40")
    # the one function whose success is no event
    await story.step(own(frames.bare(FC.GET_EVENT_COUNTER)), "frames ours", "80 40")
    for address in (OTHER, 248, 255):
        for pdu in (READ, WRITE, b"\x83\x02", frames.restart(), frames.diagnostics(Sub.LISTEN_ONLY)):
            await story.step(frames.adu(address, pdu), "frames", "")
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
async def what_an_exception_counts(dut):
    story = await Story.begin(dut)
    refused = "frames ours refused"
    for pdu in (
        b"\x09",
        b"\x0a\0",
        b"\x63\0\0",
        b"\x00",
        b"\x80\0",
        frames.diagnostics(0x15, 3),
        frames.device_identification(1, mei=0x0D),
        OUTSIDE,
        EMPTY,
        READ + b"\0",
        frames.bare(FC.GET_EVENT_COUNTER, b"\0"),
        frames.bare(FC.GET_EVENT_LOG, b"\0"),
        frames.bare(FC.READ_EXCEPTION_STATUS, b"\0"),
        frames.bare(FC.REPORT_SERVER_ID, b"\0"),
        frames.diagnostics(Sub.LISTEN_ONLY, 1),
        frames.diagnostics(Sub.RESTART, 1),
        frames.diagnostics(Sub.CLEAR, 0xFF00),
    ):
        assert (await story.step(own(pdu), refused, "80 41"))[1] in (EX.FUNCTION, EX.ADDRESS, EX.VALUE)
    assert not story.listen_only
    await story.look("at the end", line=True)
    await story.tb.finish()


SENT = {  # event byte of each exception code
    **dict.fromkeys((1, 2, 3), "41"),
    4: "42",
    5: "44",
    6: "44",
    7: "48",
    **dict.fromkeys((8, 9, 10, 11, 15), "40"),
}
ALSO = {EX.NAK: "nak", EX.BUSY: "busy"}


@cocotb.test()
async def what_a_failure_counts(dut):
    """failure_i gives every exception code there is; a busy slave goes before it."""
    story = await Story.begin(dut)
    for code, event in SENT.items():
        story.tb.apply(failure=code)
        counts = f"frames ours refused {ALSO.get(code, '')}"
        assert (await story.step(own(WRITE), counts, f"80 {event}"))[1] == code
        # nothing is sent to a broadcast, so no code is counted
        assert await story.step(everyone(WRITE), "frames ours refused silent", "C0 40") is None
    story.tb.apply(failure=EX.NAK)
    assert (await story.step(own(OUTSIDE), "frames ours refused", "80 41"))[1] == EX.ADDRESS
    await story.step(own(frames.bare(FC.READ_EXCEPTION_STATUS)), GOOD, "80 40")
    await story.step(own(frames.bare(FC.REPORT_SERVER_ID)), GOOD, "80 40")
    await story.step(own(frames.diagnostics(Sub.BUS_MESSAGE)), GOOD, "80 40")
    story.tb.apply(busy=1)
    assert (await story.step(own(WRITE), "frames ours refused busy", "80 44"))[1] == EX.BUSY
    assert (await story.step(own(frames.bare(FC.GET_EVENT_COUNTER)), "frames ours", "80 40"))[1:3] == b"\xff\xff"
    assert (await story.step(own(frames.bare(FC.GET_EVENT_LOG)), GOOD, "80 40"))[2:4] == b"\xff\xff"
    await story.step(everyone(WRITE), "frames ours refused silent", "C0 40")
    story.tb.apply(busy=0, failure=0)
    assert (await story.step(own(frames.bare(FC.GET_EVENT_COUNTER)), "frames ours", "80 40"))[1:3] == b"\0\0"
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
async def what_a_broadcast_counts(dut):
    story = await Story.begin(dut)
    for pdu in (
        frames.write_coil(0, True),
        WRITE,
        frames.write_coils(0, [1, 0, 1]),
        frames.write_registers(0, [1, 2]),
    ):
        assert await story.step(everyone(pdu), GOOD + " silent", "C0 40") is None
    for pdu in (
        READ,
        frames.mask_write(0, 0, 1),
        frames.diagnostics(Sub.QUERY_DATA, 1),
        frames.diagnostics(Sub.LISTEN_ONLY),
        frames.restart(clear_log=True),
        frames.diagnostics(Sub.CLEAR),
        frames.bare(FC.GET_EVENT_COUNTER),
        b"\x63",
        WRITE + b"\0",
        frames.write_register(0xFFFF, 1),
    ):
        assert await story.step(everyone(pdu), "frames ours refused silent", "C0 40") is None
    assert not story.listen_only, "listen-only mode is not for all at once"
    story.tb.apply(broadcast_en=0)  # then they are nobody's
    await story.step(everyone(WRITE), "frames", "")
    story.tb.apply(broadcast_en=1, address=0)  # no unicast frame matches
    await story.step(own(READ), "frames", "")
    await story.step(everyone(WRITE), GOOD + " silent", "C0 40")
    story.tb.apply(address=OWN)
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
async def what_a_bad_frame_counts(dut):
    """Whatever address it carries, and however much is wrong with it."""
    story = await Story.begin(dut)
    for address in (OWN, OTHER, 0):
        frame = frames.adu(address, READ)
        for line in (frames.bad_crc(frame), with_error(frame, 2, "parity"), with_gap(frame, 4, 2.0)):
            assert await story.step(line, "bad", "82") is None
    frame = own(READ)
    for line in (
        with_error(frame, 0, "framing"),
        with_error(frames.bad_crc(frame), 7, "parity"),
        frames.swapped_crc(frame),
        frame[:1],
        frame[:3],
        frames.sealed(bytes([OWN])),  # three bytes with a right CRC
        frame + frame,
        with_gap(frame + frame, 8, 2.5),
    ):
        await story.step(line, "bad", "82")
    for line in (LONG, bytes(257), frames.sealed(bytes([OTHER]) + bytes(254 + 40))):
        await story.step(line, "bad overrun", "92")
    await story.step(frames.adu(OTHER, bytes(253)), "frames", "")  # 256 bytes are a frame
    line = with_gap(frames.bad_crc(frame) + frame, 8, 4.0)
    assert await story.step(line, "bad " + GOOD, "82 80 40") is not None
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
async def counters_wrap(dut):
    story = await Story.begin(dut)
    await story.tb.load_counters(**dict.fromkeys(ALL_COUNTERS, 0xFFFF))
    await story.look("loaded")
    await story.step(frames.adu(OTHER, READ), "frames", "")
    await story.step(LONG, "bad overrun", "92")
    await story.step(everyone(WRITE), GOOD + " silent", "C0 40")
    story.tb.apply(failure=EX.NAK)
    await story.step(own(READ), "frames ours refused nak", "80 48")
    story.tb.apply(failure=EX.BUSY)
    await story.step(own(READ), "frames ours refused busy", "80 44")
    assert all(value < 4 for value in story.counters.values()), story.counters
    story.tb.apply(failure=0)
    # and each alone, so that none carries into another; also from a low byte that is full
    for start in (0x00FF, 0xFFFF):
        for name in ALL_COUNTERS:
            await story.tb.load_counters(**dict.fromkeys(ALL_COUNTERS, 0x1234) | {name: start})
            await story.look(name)
            await story.step(own(READ), GOOD, "80 40", name)
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
async def log_holds_64_newest_first(dut):
    story = await Story.begin(dut)
    kinds = [
        (own(READ), GOOD, "80 40"),
        (own(EMPTY), "frames ours refused", "80 41"),
        (everyone(WRITE), GOOD + " silent", "C0 40"),
        (bytes(2), "bad", "82"),
        (frames.adu(OTHER, READ), "frames", ""),
    ]
    lengths = set()
    while len(story.log) < LOG_SIZE or sum(story.counters.values()) < 150:
        line, counts, events = story.tb.rng.choice(kinds)
        await story.step(line, counts, events)
        if len(story.log) not in lengths and len(story.log) in (1, 2, 61, 62, 63, 64):
            lengths.add(len(story.log))
            held = len(story.log)
            answer = await story.step(own(frames.bare(FC.GET_EVENT_LOG)), GOOD, "80 40")
            # its own receive event is in the answer, the send event not yet
            assert answer[1] == 6 + min(LOG_SIZE, held + 1)
            assert answer[8] == 0x80, f"the newest event in the answer is {answer[8]:02X}"
    assert LOG_SIZE in lengths
    # Neither the clear nor a good restart with "continue" empties it.
    answer = await story.step(own(frames.diagnostics(Sub.CLEAR)), "", "80 40", cleared=True)
    assert len(story.log) == LOG_SIZE and answer
    await story.step(own(frames.restart()), "", "80 40 00", cleared=True)
    answer = await story.step(own(frames.bare(FC.GET_EVENT_LOG)), GOOD, "80 40")
    assert answer[1] == 6 + LOG_SIZE
    await story.step(own(frames.restart(clear_log=True)), "", "00", cleared=True, emptied=True)
    answer = await story.step(own(frames.bare(FC.GET_EVENT_LOG)), GOOD, "80 40")
    assert answer == bytes([FC.GET_EVENT_LOG, 8, 0, 0, 0, 0, 0, 1, 0x80, 0x00])
    await story.tb.finish()


@cocotb.test()
async def overrun_flag_and_its_clearing(dut):
    story = await Story.begin(dut)
    tb = story.tb

    async def register():
        answer = await story.step(own(frames.diagnostics(Sub.DIAGNOSTIC_REGISTER)), GOOD, "80 40")
        return int.from_bytes(answer[3:], "big")

    tb.apply(diagnostic=0xA5A5)
    await tb.clocks(2)
    tb.apply(diagnostic=0)
    assert await register() == 0xA5A4, "bit 0 is not the host's"
    for _ in range(2):
        await story.step(LONG, "bad overrun", "92")
    assert await register() == 0xA5A5
    answer = await story.step(own(frames.diagnostics(Sub.BUS_CHAR_OVERRUN)), GOOD, "80 40")
    assert answer[3:] == b"\0\x02"
    story.counters["bus_char_overrun"] = 0  # cleared by the answer that follows, all others stay
    await story.step(own(frames.diagnostics(Sub.CLEAR_OVERRUN)), GOOD, "80 40")
    assert await register() == 0xA5A4
    await story.step(LONG, "bad overrun", "92")
    for pdu in (frames.diagnostics(Sub.CLEAR_OVERRUN, 1), frames.diagnostics(Sub.CLEAR, 1)):
        await story.step(own(pdu), "frames ours refused", "80 41")
    await story.step(own(frames.restart()), "", "80 40 00", cleared=True)
    assert await register() == 0xA5A5, "a restart leaves the register alone"
    await story.step(LONG, "bad overrun", "92")
    await story.step(own(frames.diagnostics(Sub.CLEAR)), "", "80 40", cleared=True)
    assert await register() == 0
    # what the host still holds comes back after the clear
    tb.apply(diagnostic=0x8001)
    await story.step(own(frames.diagnostics(Sub.CLEAR)), "", "80 40", cleared=True)
    assert await register() == 0x8000
    tb.apply(diagnostic=0)
    assert await register() == 0x8000
    # a flag of the host must be set by one clock
    for bit in (1, 7, 14):
        await Timer(1, "ns")  # past the clock edge, so that the level lasts over the next one
        tb.apply(diagnostic=1 << bit)
        await tb.clocks(1)
        tb.apply(diagnostic=0)
        await tb.clocks(2)
        assert await tb.diagnostic_register() == tb.slave.diagnostic_register
    assert not tb.slave.diagnostic_register & OVERRUN_FLAG
    await tb.finish()


@cocotb.test()
async def reset_clears_everything(dut):
    story = await Story.begin(dut)
    tb = story.tb
    await tb.preset((Space.HOLDINGS, 0), 0x1234)
    for _ in range(2):
        tb.apply(diagnostic=0xFFFE)
        await story.step(LONG, "bad overrun", "92")
        tb.apply(diagnostic=0)
        await story.step(own(EMPTY), "frames ours refused", "80 41")
        await story.step(own(frames.diagnostics(Sub.LISTEN_ONLY)), GOOD + " silent", "80 40 04")
        assert story.listen_only
        await tb.reset()
        await tb.clocks(LAST_ACTION_CLOCKS)
        await story.look("after reset")
        assert not any(story.counters.values()) and not story.log
        assert not story.listen_only and not await tb.diagnostic_register()
        await tb.silence()
        assert await story.step(own(READ), GOOD, "80 40") == b"\x03\x02\x12\x34", "data stays"
        await tb.reset()
        await tb.silence()
        await story.look("after reset")
    await tb.finish()
