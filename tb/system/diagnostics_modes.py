# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Listen-only mode, restart, sub-functions and their data, the counter port beside a busy line."""

import cocotb
from cocotb.triggers import RisingEdge
from harness.bench import CLOCK_PS, Bench
from harness.line import wait_until
from harness.lines import with_error, with_gap
from harness.volume import volume
from protocol import frames
from protocol.defs import COUNTER_ADDRESS, EX, FC, LOG_ADDRESS, Space, Sub

from system.story import OTHER, OWN, Story, everyone, own

READ = frames.read(FC.READ_HOLDINGS, 0, 1)
WRITE = frames.write_register(0, 0xBAD)
LISTEN = own(frames.diagnostics(Sub.LISTEN_ONLY))
LONG = bytes([OWN]) * 257
GOOD = "frames ours events"
HEARD = "frames ours silent"  # in listen-only mode


async def listening(dut, **setup):
    """A story whose device is in listen-only mode."""
    story = await Story.begin(dut, **setup)
    await story.tb.preset((Space.HOLDINGS, 0), 0x600D)
    assert await story.step(LISTEN, GOOD + " silent", "80 40 04") is None
    assert story.listen_only, "listen_only_o stays low"
    return story


@cocotb.test()
async def listen_only_hears_counts_and_does_nothing(dut):
    story = await listening(dut)
    for pdu in (
        READ,
        WRITE,
        b"\x63",
        b"\0",
        frames.bare(FC.GET_EVENT_COUNTER),
        frames.bare(FC.GET_EVENT_LOG),
        frames.bare(FC.READ_EXCEPTION_STATUS),
        frames.diagnostics(Sub.QUERY_DATA, 1),
        frames.diagnostics(Sub.LISTEN_ONLY),
        frames.diagnostics(Sub.CLEAR),
        frames.diagnostics(Sub.CLEAR_OVERRUN),
        frames.diagnostics(Sub.BUS_MESSAGE),
    ):
        await story.step(own(pdu), HEARD, "A0 60")
        await story.step(everyone(pdu), HEARD, "E0 60")
        await story.step(frames.adu(OTHER, pdu), "frames", "")
    frame = own(WRITE)
    for line in (frames.bad_crc(frame), with_error(frame, 3, "parity"), with_gap(frame, 3, 2.0), frame[:3]):
        await story.step(line, "bad", "A2")
    await story.step(LONG, "bad overrun", "B2")
    for setup in ({"busy": 1}, {"busy": 0, "failure": EX.NAK}):
        story.tb.apply(**setup)
        await story.step(own(READ), HEARD, "A0 60")
    story.tb.apply(failure=0)
    assert await story.tb.diagnostic_register() == 1, "the overrun flag is set here too"
    await story.step(own(frames.restart()), "", "A0 60 00", cleared=True)
    assert await story.step(own(READ), GOOD, "80 40") == b"\x03\x02\x60\x0d"
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
@cocotb.parametrize(option=[0x0000, 0xFF00])
async def only_the_right_restart_ends_listen_only(dut, option):
    story = await listening(dut)
    right = frames.diagnostics(Sub.RESTART, option)
    for pdu in (
        right + b"\0",
        right[:-1],
        right[:3],
        right[:1],
        frames.diagnostics(Sub.RESTART, 0x0001),
        frames.diagnostics(Sub.RESTART, 0x00FF),
        frames.diagnostics(Sub.RESTART, 0xFF01),
        frames.diagnostics(Sub.RESTART, 0x0100),
        frames.diagnostics(Sub.RESTART, 0xFE00),
        frames.diagnostics(0x0101, option),
        frames.diagnostics(0x0000, option),
        frames.diagnostics(0x0003, option),
        bytes([0x88]) + right[1:],
        bytes([0x28]) + right[1:],
    ):
        await story.step(own(pdu), HEARD, "A0 60")
    await story.step(everyone(right), HEARD, "E0 60")
    await story.step(frames.adu(OTHER, right), "frames", "")
    await story.step(frames.bad_crc(own(right)), "bad", "A2")
    await story.step(with_gap(own(right), 4, 2.0), "bad", "A2")
    assert story.listen_only, "ended by a restart that is none"
    events = "00" if option else "A0 60 00"
    await story.step(own(right), "", events, cleared=True, emptied=bool(option))
    assert not story.listen_only
    answer = await story.step(own(frames.bare(FC.GET_EVENT_LOG)), GOOD, "80 40")
    assert answer[8:10] == b"\x80\0", "the restart is the event before this one"
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
@cocotb.parametrize(option=[0x0000, 0xFF00])
async def restart_in_normal_mode(dut, option):
    """Answered first, then everything is cleared but memory, register and settings."""
    story = await Story.begin(dut)
    story.tb.apply(diagnostic=0x4000)
    await story.tb.preset((Space.HOLDINGS, 0), 0x600D)
    await story.step(own(READ), GOOD, "80 40")
    await story.step(LONG, "bad overrun", "92")
    story.tb.apply(diagnostic=0)
    pdu = frames.diagnostics(Sub.RESTART, option)
    events = "00" if option else "80 40 00"
    for _ in range(2):
        assert await story.step(own(pdu), "", events, cleared=True, emptied=bool(option)) == pdu
    assert await story.tb.diagnostic_register() == 0x4001
    assert await story.step(own(READ), GOOD, "80 40") == b"\x03\x02\x60\x0d"
    await story.step(everyone(pdu), "frames ours refused silent", "C0 40")
    await story.look("at the end", line=True)
    await story.tb.finish()


@cocotb.test()
@cocotb.parametrize(mode=["normal", "listen-only"], option=[0x0000, 0xFF00])
async def restart_waits_for_a_silent_line(dut, mode, option):
    """A request less than t3.5 behind a restart is dropped, uncounted; from there on it is heard."""
    story = await Story.begin(dut, bit_time=12)
    tb = story.tb
    restart = own(frames.diagnostics(Sub.RESTART, option))
    limit = tb.t35 / tb.bit
    for bits, heard in ((0.5, False), (11, False), (limit - 2, False), (limit + 7, True)):
        if mode == "listen-only":
            await story.step(LISTEN, GOOD + " silent", "80 40 04")
        expected = tb.slave.request(restart)
        end = await tb.send(restart)
        answer = await tb.line.answer(tb.t35 + 300 * CLOCK_PS) if expected else None
        assert (answer and answer.data) == expected
        # without an answer the restart happens when t3.5 has expired behind the request
        end = answer.end if answer else end + tb.t35
        await wait_until(end + bits * tb.bit)
        await tb.send(own(READ), phase=0)
        answer = await tb.line.answer(tb.t35 + 300 * CLOCK_PS)
        assert (answer is not None) == heard, f"{bits} bits behind the restart: {answer}"
        if heard:
            assert answer.data == tb.slave.request(own(READ))
        await tb.silence()
        await story.look(f"request {bits} bits behind the restart")
    await tb.finish()


@cocotb.test()
async def sub_functions_and_their_data(dut):
    """Each sub-function with data it does not allow, with lengths it does not have, and those there are not."""
    tb = await Bench.start(dut)

    async def code(pdu):
        answer = await tb.both(own(pdu))
        return answer[2] if answer[1] & 0x80 else 0

    allowed = {Sub.QUERY_DATA: lambda _: True, Sub.DELIMITER: lambda d: not d & 0xFF}
    for sub in Sub:
        for data in (0x0001, 0x0100, 0xFF00):
            if sub == Sub.RESTART and data == 0xFF00:
                continue
            good = allowed.get(sub, lambda d: d == 0)(data)
            assert await code(frames.diagnostics(sub, data)) == (0 if good else EX.VALUE), f"{sub.name} {data:04X}"
        if sub != Sub.QUERY_DATA:
            for wrong in (b"", bytes(3)):
                assert await code(frames.diagnostics(sub, wrong)) == EX.VALUE
    for sub in (*range(5, 10), 0x13, *range(0x15, 0x18), 0x0100, 0x010B, 0x0200, 0x000B << 8, 0x8004, 0xFFFF):
        assert await code(frames.diagnostics(sub)) == EX.FUNCTION
        assert await code(frames.diagnostics(sub, b"\0")) == EX.FUNCTION, "01 goes before 03"
    for pdu in (b"\x08", b"\x08\0", b"\x08\xff"):
        assert await code(pdu) == EX.VALUE
    for size in (0, 1, 3, 249):
        assert await code(frames.diagnostics(Sub.QUERY_DATA, bytes(size))) == EX.VALUE
    for size in (2, 4, 128, 250):
        pdu = frames.diagnostics(Sub.QUERY_DATA, tb.rng.randbytes(size))
        assert await tb.both(own(pdu)) == own(pdu)
    await tb.compare_counters("at the end", line=True)
    await tb.finish()


@cocotb.test()
async def counter_port_never_disturbs_the_line(dut):
    """A host that never stops reading; what it reads is the value before or after a frame."""
    story = await Story.begin(dut)
    tb, stop, reads = story.tb, [], []
    names = {address: name for name, address in COUNTER_ADDRESS.items()}

    async def host():
        while not stop:
            address = tb.rng.choice([*names, *range(LOG_ADDRESS, LOG_ADDRESS + 4)])
            begin = tb.slave.counters.get(names.get(address))
            value = await tb.counter(address)
            reads.append(value)
            if begin is not None:
                low, high = begin - 1, tb.slave.counters[names[address]]
                assert low <= value <= high, f"{names[address]}: {value}, model from {begin} to {high}"
            await tb.clocks(tb.rng.choice((0, 0, 1, 2, 30)))

    task = cocotb.start_soon(host())
    count = volume("frames beside a reading host")
    for number in range(count):
        line = tb.rng.choice(
            (own(READ), own(READ + b"\0"), everyone(WRITE), frames.adu(OTHER, READ), bytes(3), LONG, own(b"\x0c"))
        )
        await tb.both(line, note=f"{number}")
    stop.append(True)
    await task
    assert len(reads) > 16 * count, f"only {len(reads)} reads"
    await story.look("at the end", line=True)
    await tb.finish()


@cocotb.test()
async def counter_port_answers_at_once(dut):
    """Every access, whatever its address, is acknowledged once and soon."""
    story = await Story.begin(dut)
    tb = story.tb
    await tb.both(own(READ))
    seen = await tb.read_counters()
    for address in range(0x80):
        waited = 0
        dut.status_adr_i.value, dut.status_stb_i.value = address, 1
        await RisingEdge(dut.clk_i)
        while not int(dut.status_ack_o.value):
            waited += 1
            assert waited <= 8, f"address {address:02X} is not acknowledged"
            await RisingEdge(dut.clk_i)
        dut.status_stb_i.value = 0
        await RisingEdge(dut.clk_i)
        assert not int(dut.status_ack_o.value)
    assert await tb.read_counters() == seen
    await tb.finish()
