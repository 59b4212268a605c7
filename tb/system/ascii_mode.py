# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""ASCII mode at the pins: formats, printed examples, faults at every character, time-out, delimiter, long frames."""

import cocotb
from cocotb.triggers import Timer
from harness.bench import CLOCK_PS, Bench
from harness.lines import with_error, with_gap
from harness.traffic import AsciiTraffic
from harness.volume import volume
from protocol import frames, vectors
from protocol.defs import ASCII_FORMATS, FC, RECEIVED, RECEIVED_ERROR, RECEIVED_OVERRUN, Sub

from system.vectors_at_pins import afterwards, prepare

OWN, OTHER = 17, 18
REGISTER = 5
READ = frames.ascii_adu(OWN, frames.read(FC.READ_HOLDINGS, REGISTER, 1))
CASES = {v["id"]: v for v in vectors.in_ascii()}


def write(value, address=OWN):
    """A write that must leave a trace if it is executed."""
    return frames.ascii_adu(address, frames.write_register(REGISTER, value))


def delimiter(character):
    """A request that sets the delimiter."""
    return frames.ascii_adu(OWN, frames.diagnostics(Sub.DELIMITER, character << 8))


async def start(dut, **setup):
    """A bench in ASCII mode, 7E1 unless `setup` says otherwise."""
    return await Bench.start(dut, **{"ascii": 1, "fmt": "7E1", **setup})


async def spoiled(tb, line, note):
    """`line` is not executed and leaves one bad frame at most; the next request is answered."""
    before = tb.slave.counters["bus_comm_error"]
    assert await tb.both(line, note=note) is None
    assert not tb.writes, f"{note}: executed"
    assert await tb.both(READ, note=f"after {note}") is not None
    assert tb.slave.counters["bus_comm_error"] == before + 1, note


@cocotb.test()
@cocotb.parametrize(vector=list(CASES))
async def printed_example_plays(dut, vector):
    case = CASES[vector]
    tb = await start(dut, address=case["slave_address"], bit_time=16)
    older = await prepare(tb, case)
    seen = await tb.both(case["request_chars"].encode())
    assert seen == case["expected_response_chars"].encode(), f"printed {case['expected_response_chars']!r}, seen {seen}"
    await afterwards(tb, case, older)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=list(ASCII_FORMATS))
async def every_format(dut, fmt):
    """7 and 8 bits with each parity; the longest answer and the longest request too."""
    tb = await start(dut, fmt=fmt)
    words = [(0x0101 * i) & 0xFFFF for i in range(123)]
    assert await tb.both(write(0x1234)) is not None
    assert await tb.both(frames.ascii_adu(OWN, frames.write_registers(0, words))) is not None
    assert await tb.both(frames.ascii_adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 125))) is not None
    assert await tb.both(write(0xBAD, OTHER) + write(0xCAFE)) is not None  # back to back behind one for another
    assert await tb.both(write(0x4711, 0)) is None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def the_mode_changes_at_run_time(dut):
    """RTU, ASCII, RTU: the other mode's frames are never executed."""
    tb = await Bench.start(dut)
    rtu = frames.adu(OWN, frames.write_register(REGISTER, 0xBAD))
    for _ in range(2):
        tb.apply(ascii=0, fmt="8E1")
        await tb.silence()
        assert await tb.both(frames.adu(OWN, frames.write_register(REGISTER, 1))) is not None
        assert await tb.both(write(0xBAD)) is None
        tb.apply(ascii=1)
        await tb.silence()
        assert await tb.both(rtu) is None
        assert not tb.slave.ascii.receiving and tb.slave.counters["bus_comm_error"]
        assert await tb.both(write(2)) is not None
        tb.apply(fmt="7E1")
        await tb.silence()
        assert await tb.both(write(3)) is not None
    await tb.finish()


@cocotb.test()
async def wrong_character_in_every_position(dut):
    """All kinds of neighbours of the allowed ones, lower case, controls; `:` and CR have tests of their own."""
    tb = await start(dut, fmt="8E1")
    good = write(0x0BAD)
    for place in range(1, len(good) - 2):
        for wrong in b"/;@Gag`\x00\x10\x7f\xb0\xc1 \n":
            await spoiled(tb, good[:place] + bytes([wrong]) + good[place + 1 :], f"{wrong:02X} at {place}")
    await tb.finish()


@cocotb.test()
async def every_character_is_judged(dut):
    """All 256 in the place of a digit: 0-9 and A-F alone are digits, `:` begins anew, CR ends too early."""
    tb = await start(dut, fmt="8N2")
    good = frames.ascii_adu(OWN, frames.write_register(REGISTER, 0x1B1A))
    place = good.index(b"B")
    for byte in range(256):
        line = good[:place] + bytes([byte]) + good[place + 1 :]
        answer = await tb.both(line, note=f"{byte:02X}")
        assert (answer is not None) == (byte == ord("B"))
        if byte in b"0123456789ABCDEF":  # the LRC that belongs to it
            body = bytes.fromhex(line[1:-4].decode())
            assert await tb.both(frames.ascii_line(body + bytes([frames.lrc(body)])), note=f"{byte:02X}") is not None
    await tb.finish()


@cocotb.test()
async def lower_case_is_no_digit(dut):
    tb = await start(dut)
    good = write(0xABCD)
    for place in (i for i, c in enumerate(good) if chr(c) in "ABCDEF"):
        await spoiled(tb, good[:place] + good[place : place + 1].lower() + good[place + 1 :], f"at {place}")
    await spoiled(tb, good.lower(), "all of it")
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["7E1", "7O1", "8E1"])
async def parity_error_in_every_position(dut, fmt):
    tb = await start(dut, fmt=fmt)
    for place in range(len(READ)):
        await spoiled(tb, with_error(write(0xBAD), place, "parity"), f"at {place}")
        assert not tb.strobes["crc"]
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["7E1", "7N2", "8N1"])
async def framing_error_in_every_position(dut, fmt):
    tb = await start(dut, fmt=fmt)
    for place in range(len(READ)):
        await spoiled(tb, with_error(write(0xBAD), place, "framing"), f"at {place}")
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(count_only=[0, 1])
async def gap_above_the_time_out_in_every_position(dut, count_only):
    """What follows the gap is ignored up to the next colon; the setting for t1.5 is of no consequence."""
    tb = await start(dut, gap_count_only=count_only)
    limit = tb.slave.config.timeout
    for place in range(1, len(READ)):
        await spoiled(tb, with_gap(write(0xBAD), place, limit + 1), f"at {place}")
        assert await tb.both(with_gap(write(place), place, limit - 1), note=f"at {place}") is not None
    await tb.finish()


@cocotb.test()
async def gaps_do_not_add_up(dut):
    tb = await start(dut)
    assert await tb.both([(byte, tb.slave.config.timeout / 3, None) for byte in write(0x7117)]) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(extra=[0, 1, 3])
async def the_time_out_ends_the_frame_by_itself(dut, extra):
    """Not before the time-out, soon behind it, and longer by a setting; the line is idle again."""
    tb = await start(dut, ascii_extra=extra)
    for part in (b":", b":1", READ[:-2], READ[:-1]):
        tb.strobes.clear()
        await tb.send(part)
        assert tb.slave.hear(part) is None
        await Timer(round(tb.timeout) - 2 * CLOCK_PS, "ps")
        assert not tb.strobes and not int(tb.dut.idle_o.value), f"{part}: ended before the time-out, {dict(tb.strobes)}"
        await Timer(round((2 if extra else 1) * tb.timeout) + 100 * CLOCK_PS, "ps")
        tb.slave.fall_silent()
        assert tb.strobes["gap"] == 1 and int(tb.dut.idle_o.value), f"{part}: {dict(tb.strobes)}"
        await tb.compare_counters(f"{part}")
        assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def a_colon_begins_anew_in_every_position(dut):
    """The part before it is one bad frame if anything followed its own colon."""
    tb = await start(dut)
    good = write(0xBAD)
    for place in range(1, len(good)):
        before = tb.slave.counters["bus_comm_error"]
        assert await tb.both(good[:place] + write(place), note=f"at {place}") is not None
        assert tb.slave.counters["bus_comm_error"] == before + (place > 1)
        spoiled_colon = [*good[:place], (ord(":"), 0, "parity"), *write(0xBAD)[1:]]
        assert await tb.both(spoiled_colon, note=f"bad colon at {place}") is None
    colons = [(ord(":"), 0, "parity"), *b"::"]
    assert await tb.both(colons + list(READ[1:]), note="the last colon counts") is not None
    await tb.finish()


@cocotb.test()
async def cr_in_every_position(dut):
    """CR without the delimiter behind it, LF without CR, CR twice."""
    tb = await start(dut)
    good = write(0xBAD)
    for place in range(1, len(good) - 2):
        await spoiled(tb, good[:place] + b"\r" + good[place:], f"CR before {place}")
    for end in (b"\r", b"\r\r\n", b"\r1\n", b"\n\r", b"\n", b"", b"\n\n"):
        await tb.both(good[:-2] + end, note=f"ends {end}")
        assert not tb.writes
        assert await tb.both(READ, note=f"behind {end}") is not None
    await tb.finish()


@cocotb.test()
async def an_empty_message_does_not_lock_the_port(dut):
    tb = await start(dut)
    for line in (b":\r\n", b"::\r\n", b"\r\n", b":\r:\r\n", b":1\r\n", b":11\r\n", b":1107\r\n", b":11EF\r\n"):
        assert await tb.both(line, note=f"{line}") is None
        assert await tb.both(READ, note=f"after {line}") is not None
    assert await tb.both(frames.ascii_adu(OWN, b"\x07")) is not None  # three bytes are a frame
    await tb.finish()


@cocotb.test()
async def characters_before_the_colon_are_ignored(dut):
    tb = await start(dut)
    for before in (b"\r\n", b"garbage", b"1103", READ[1:], bytes(40)):
        assert await tb.both(before + READ, note=f"{before}") is not None
        assert not any(n for e, n in tb.strobes.items() if e != "frame"), dict(tb.strobes)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(length=[512, 513, 514, 515, 516, 600])
async def long_frames(dut, length):
    """Up to 513 characters is a frame (here of a wrong length: exception 03), more never is."""
    tb = await start(dut)
    digits = length - 3
    body = bytes([OWN]) + frames.write_registers(0, [0xBAD] * 100)
    body += bytes(digits // 2 - 1 - len(body))
    line = b":" + (body + bytes([frames.lrc(body)])).hex().upper().encode() + b"0" * (digits % 2) + b"\r\n"
    assert len(line) == length
    answer = await tb.both(line)
    assert (answer is None) == (length != 513)
    newest = RECEIVED | RECEIVED_ERROR | RECEIVED_OVERRUN * (length > 513)
    assert length == 513 or tb.slave.log[0] == newest
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def the_delimiter_is_set_and_restart_sets_it_back(dut):
    """By 08/0003, for requests alone; LF is of no use then.  A refused request changes nothing."""
    tb = await start(dut)

    def with_end(end, line=READ):
        return line[:-1] + end

    for end in (b"#", b"\r", b":", b"A", b"\x00", b"\x7f"):
        assert await tb.both(delimiter(end[0])) is not None
        await spoiled_or_not(tb, READ, False)
        wrong = frames.ascii_adu(OWN, frames.diagnostics(Sub.DELIMITER, 0x2A01))
        refused = await tb.both(with_end(end, wrong))
        assert refused == frames.ascii_adu(OWN, b"\x88\x03")
        assert await tb.both(with_end(end)) is not None
        await spoiled_or_not(tb, with_end(b"*"), False)
        assert await tb.both(with_end(end, frames.ascii_adu(OWN, frames.restart()))) is not None
        assert await tb.both(READ) is not None
        await spoiled_or_not(tb, with_end(b"#"), False)
    assert await tb.both(delimiter(0xA3)) is not None  # # with bit 7
    assert await tb.both(with_end(b"#")) is not None
    await tb.finish()


async def spoiled_or_not(tb, line, answered):
    assert (await tb.both(line) is not None) == answered, line


@cocotb.test()
async def a_reset_sets_the_delimiter_back(dut):
    tb = await start(dut)
    assert await tb.both(delimiter(ord("#"))) is not None
    await tb.both(b":11")
    await tb.reset()
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def kept_but_unused_in_rtu_mode(dut):
    """08/0003 in RTU mode counts when ASCII mode follows."""
    tb = await Bench.start(dut)
    assert await tb.both(frames.adu(OWN, frames.diagnostics(Sub.DELIMITER, ord("#") << 8))) is not None
    assert await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 1))) is not None
    tb.apply(ascii=1, fmt="7E1")
    assert await tb.both(READ) is None
    assert await tb.both(READ[:-1] + b"#") is not None
    await tb.finish()


@cocotb.test()
async def listen_only_mode_in_ascii(dut):
    tb = await start(dut)
    assert await tb.both(frames.ascii_adu(OWN, frames.diagnostics(Sub.LISTEN_ONLY))) is None
    assert await tb.both(READ) is None
    assert await tb.both(write(0xBAD)[:-3] + b"0\r\n") is None
    assert await tb.both(frames.ascii_adu(OWN, frames.restart(clear_log=True))) is None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["7E1", "7N2", "8N1"], bit_time=[8, 64])
async def an_answer_waits_for_the_stop_bits(dut, fmt, bit_time):
    """However fast the engine is, the driver is off while the master sends its last stop bits."""
    tb = await start(dut, fmt=fmt, bit_time=bit_time)
    for delay in (0, 1, 20):
        tb.apply(response_delay=delay)
        for _ in range(3):
            assert await tb.both(frames.ascii_adu(OWN, b"\x07")) is not None
    await tb.finish()


@cocotb.test()
async def late_answers_and_strict_turnaround(dut):
    """A colon since the request makes the answer late; other characters do not.  Strict turnaround does not wait."""
    tb = await start(dut, drop_late=1, strict_turnaround=1, response_delay=200)
    for noise, answered in ((b"11", True), (b":1", False)):
        await tb.send(READ + noise)
        answer = await tb.line.answer(400 * tb.bit)
        assert (answer is not None) == answered, f"{noise}: {answer}"
        tb.slave.hear(READ)
        if not answered:
            tb.slave.counters["slave_no_response"] += 1
        assert tb.strobes["overrun"] == (not answered)
        tb.strobes.clear()
    assert await tb.both(READ) is not None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def breaks_and_spikes(dut):
    tb = await start(dut, bit_time=16)
    for number in range(20):
        spikes = [(10 * i + tb.rng.uniform(0.3, 9.5), 0.24) for i in range(len(READ))]
        assert await tb.both(write(number), spikes=spikes) is not None
    tb.strobes.clear()
    await tb.line.hold_low(25)
    await tb.silence(30)
    assert not tb.strobes, "a break outside a frame"
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def the_master_may_be_two_percent_off(dut):
    tb = await start(dut, bit_time=16)
    for offset in (-0.02, 0.02):
        assert await tb.both(READ, offset=offset) is not None
    await tb.finish()


@cocotb.test()
async def random_requests(dut):
    """What RTU gets in random_requests, in ASCII mode."""
    tb = await start(dut, bit_time=8)
    traffic = AsciiTraffic(tb.rng, tb.slave.config, tb.slave)
    for _ in range(volume("random requests in a simulator")):
        line, kind = traffic.line()
        await tb.both(line, note=kind)
    await tb.finish()
