# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What goes wrong on a line: gaps, parity, framing, length, CRC, merged and foreign frames, breaks,
spikes, collisions with the answer, reset.  Nothing bad is executed; the next good frame is answered.
"""

import cocotb
from cocotb.triggers import RisingEdge, Timer
from harness.bench import CLOCK_PS, STRAGGLER_BITS, Bench
from harness.line import now, wait_until
from harness.lines import scaled, with_error, with_gap
from harness.volume import IS_FULL
from protocol import frames
from protocol.defs import F8N1, F8N2, FC, FORMAT_BY_NAME, LONGEST_FRAME, Space

OWN, OTHER = 17, 18
REGISTER = 5
READ = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, REGISTER, 1))


def write(value, address=OWN):
    """A write that must leave a trace if it is executed."""
    return frames.adu(address, frames.write_register(REGISTER, value))


@cocotb.test()
@cocotb.parametrize(gap=[0, 1.2, 2.0, 2.5, 4.0], count_only=[0, 1])
async def gap_at_every_position(dut, gap, count_only):
    tb = await Bench.start(dut, gap_count_only=count_only)
    silence = scaled(tb, gap)
    frame_length = len(READ)
    for place in range(1, frame_length):
        await tb.both(with_gap(write(0x1000 + place), place, silence), note=f"gap {gap} before {place}")
        assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def gap_between_two_frames_spoils_both(dut):
    tb = await Bench.start(dut)
    for gap in (0, 1.2, 2.0, 2.5):
        line = with_gap(write(0xBAD) + READ, len(READ), scaled(tb, gap))
        assert await tb.both(line, note=f"gap {gap}") is None
        assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def short_gaps_do_not_add_up(dut):
    tb = await Bench.start(dut)
    gap = scaled(tb, 1.2)
    assert await tb.both([(byte, gap, None) for byte in write(0x7117)]) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8O1"])
async def parity_error_in_every_position(dut, fmt):
    tb = await Bench.start(dut, fmt=fmt)
    for place in range(len(READ)):
        assert await tb.both(with_error(write(0xBAD), place, "parity"), note=f"at {place}") is None
        assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def framing_error_in_every_position(dut, fmt):
    tb = await Bench.start(dut, fmt=fmt)
    for place in range(len(READ)):
        assert await tb.both(with_error(write(0xBAD), place, "framing"), note=f"at {place}") is None
        assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def low_second_stop_bit_is_not_looked_at(dut):
    """An 8N1 sender is understood by an 8N2 receiver."""
    tb = await Bench.start(dut, fmt=F8N2)
    tb.line.fmt = F8N1
    sent = await tb.line.send(READ)
    tb.line.fmt = F8N2
    answer = await tb.line.answer(tb.t35 + 400 * tb.bit)
    assert answer and answer.data == tb.slave.request(READ), f"seen {answer}"
    assert answer.start >= sent + tb.t35 - tb.bit
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(length=[255, 256, 257, 258, 259, 300])
async def long_frames(dut, length):
    """Up to 256 bytes is a frame (here of a wrong length: exception 03), more never is."""
    tb = await Bench.start(dut)
    pdu = frames.write_registers(0, [0xBAD] * 100)
    pdu += bytes(length - 3 - len(pdu))
    answer = await tb.both(frames.adu(OWN, pdu))
    assert (answer is None) == (length > LONGEST_FRAME)
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def longest_write_is_executed(dut):
    tb = await Bench.start(dut)
    words = [(0x0101 * i) & 0xFFFF for i in range(123)]
    assert await tb.both(frames.adu(OWN, frames.write_registers(0, words))) is not None
    await tb.finish()


@cocotb.test()
async def good_frame_inside_a_long_one_is_not_seen(dut):
    """Neither the first 256 bytes nor what follows them make a frame of their own."""
    tb = await Bench.start(dut)
    full = frames.adu(OWN, frames.write_registers(0, [0xBAD] * 123) + b"\0")
    assert len(full) == LONGEST_FRAME
    assert await tb.both(full + b"\0") is None
    assert await tb.both(full + write(0xBAD)) is None
    assert await tb.both(bytes(LONGEST_FRAME) + write(0xBAD)) is None
    assert await tb.both(bytes(2 * LONGEST_FRAME) + write(0xBAD)) is None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def truncated_frames(dut):
    tb = await Bench.start(dut)
    block = frames.adu(OWN, frames.write_registers(REGISTER, [0xBAD, 0xBAD]))
    for whole in (write(0xBAD), block):
        for length in range(1, len(whole)):
            assert await tb.both(whole[:length]) is None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def short_frames_with_right_crc(dut):
    tb = await Bench.start(dut)
    for start in (b"", b"\x11"):
        assert await tb.both(frames.sealed(start)) is None
        assert tb.strobes["short"] == 1
    answer = await tb.both(frames.adu(OWN, b"\x09"))  # four bytes are a frame
    assert answer == frames.adu(OWN, b"\x89\x01")
    await tb.finish()


@cocotb.test()
async def every_single_bit_error_is_silence(dut):
    tb = await Bench.start(dut)
    good = write(0x0BAD)
    for bit in range(8 * len(good)):
        spoiled = bytearray(good)
        spoiled[bit // 8] ^= 1 << (bit % 8)
        assert await tb.both(bytes(spoiled), note=f"bit {bit}") is None
    assert await tb.both(good) is not None
    await tb.finish()


@cocotb.test()
async def swapped_crc_is_silence(dut):
    tb = await Bench.start(dut)
    assert await tb.both(frames.swapped_crc(write(0xBAD))) is None
    assert tb.strobes["crc"] == 1
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
async def traffic_of_others_is_ignored(dut):
    """Requests and answers of other slaves, with our request close behind; reserved addresses."""
    tb = await Bench.start(dut)
    answer = frames.adu(OTHER, bytes([FC.READ_HOLDINGS, 2, 0x12, 0x34]))
    for address in (OTHER, OWN ^ 0x80, 1, 247, 248, 255):
        assert await tb.both(write(0xBAD, address), note=f"to {address}") is None
        assert await tb.both(answer) is None
        assert await tb.both(READ) is not None
    # an answer whose inside looks like a request to us
    inside = frames.adu(OTHER, bytes([FC.READ_HOLDINGS, len(write(0xBAD))]) + write(0xBAD))
    assert await tb.both(inside) is None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(address=[0, 1, 247, 248, 255])
async def own_address(dut, address):
    """1..247 can be a slave; with any other setting no unicast frame matches, broadcast works."""
    tb = await Bench.start(dut, address=address)
    for target in (1, 2, 246, 247, 248, 255):
        answer = await tb.both(write(0x100 + target, target), note=f"own {address}, to {target}")
        assert (answer is not None) == (target == address and 1 <= address <= 247)
    assert await tb.both(write(0x4242, 0)) is None
    assert tb.slave.memory[Space.HOLDINGS, REGISTER] == 0x4242
    await tb.finish()


async def recovers(tb):
    """After t3.5 of silence the first good frame is answered."""
    await tb.silence(STRAGGLER_BITS)
    assert not tb.line.answers and not tb.line.driving, "an answer to nothing"
    assert await tb.both(READ) is not None


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8O1", "8N1"])
async def breaks(dut, fmt):
    tb = await Bench.start(dut, fmt=fmt)
    for bits in (9.6, 10.5, 11, 12, 13.7, 22, 40, 250):
        tb.strobes.clear()
        await tb.line.hold_low(bits)
        await recovers_with_framing_error(tb, bits)
    await tb.finish()


async def recovers_with_framing_error(tb, bits):
    """A low time that covers the stop bit is one character with a framing error."""
    await tb.silence()
    fmt = tb.setup.fmt
    if bits > fmt.length - fmt.stops + 1:
        assert tb.strobes["framing"] == 1, f"{bits} bits low: {dict(tb.strobes)}"
    assert tb.strobes["frame"] == 0
    assert not tb.line.answers and not tb.line.driving, "an answer to nothing"
    assert await tb.both(READ) is not None


@cocotb.test()
async def break_next_to_a_frame_spoils_it(dut):
    tb = await Bench.start(dut)
    for before in (True, False):
        for gap in (0.1, 5, 10):
            tb.strobes.clear()
            tb.writes.clear()
            for part in (0, 1):
                if part == before:
                    await tb.line.send(write(0xBAD), phase=0)
                else:
                    await tb.line.hold_low(15)
                if part == 0:
                    await Timer(round(gap * tb.bit), "ps")
            await tb.silence()
            assert not tb.writes, "a spoiled frame was executed"
            assert tb.strobes["framing"] == 1 and tb.strobes["frame"] == 0, dict(tb.strobes)
            await recovers(tb)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 16] if IS_FULL else [8])
async def spike_at_every_position(dut, bit_time):
    """Shorter than a quarter bit: in every bit of the request and of the silence after it."""
    tb = await Bench.start(dut, bit_time=bit_time)
    value = 0
    reach = len(READ) * 11 + 38
    for place in range(reach):
        value += 1
        begin = place + tb.rng.uniform(0, 1)
        width = tb.rng.uniform(0.05, 0.24)
        await tb.both(write(value), note=f"spike {begin:.2f}+{width:.2f}", spikes=[(begin, width)])
    await tb.finish()


@cocotb.test()
async def spike_in_every_character(dut):
    tb = await Bench.start(dut, bit_time=16)
    for value in range(24):
        spikes = [(11 * i + tb.rng.uniform(0.3, 10.5), 0.24) for i in range(len(READ))]
        await tb.both(write(value), note=f"spikes {spikes}", spikes=spikes)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 16])
async def spike_before_a_start_bit(dut, bit_time):
    """Shortly before the frame, and before a start bit inside it."""
    tb = await Bench.start(dut, bit_time=bit_time)
    for number in range(1, 30):
        before, width = number / 24, tb.rng.choice((0.12, 0.2, 0.24))
        note = f"low for {width} bits, beginning {width + before:.3f} bits before a start bit"
        begin = now()
        await tb.line.hold_low(width)
        await wait_until(begin + (width + before) * tb.bit)
        await tb.both(write(number), phase=0, note=note)
        if width + before < 1:  # not across the stop bit's own edge
            spike = (3 * 11 - before - width, width)
            await tb.both(write(number + 100), spikes=[spike], note=note)
    await tb.finish()


@cocotb.test()
async def false_start_is_no_character(dut):
    """Low for less than half a bit: no character, no error, and the answer is not put off."""
    tb = await Bench.start(dut, bit_time=16)
    await tb.both(READ)
    normal = tb.longest_latency
    for width in (0.1, 0.2, 0.3, 0.4):
        tb.strobes.clear()
        await tb.line.hold_low(width)
        await tb.silence()
        assert not tb.strobes, f"{width} bits low: {dict(tb.strobes)}"
        for after in (1.0, 8.3, 20.7, 37.2):
            spike = (len(READ) * 11 + after, width)
            await tb.both(READ, spikes=[spike], note=f"false start {spike}")
            assert tb.longest_latency < normal + 1, (
                f"low for {width} bits, {after} bits after the request, put the answer off by "
                f"{tb.longest_latency - normal:.1f} bits"
            )
    await tb.finish()


async def spiky(tb, stop, period, width):
    """Low spikes of `width` bits, one every `period` bits, until `stop` is no longer empty."""
    while not stop:
        await tb.line.hold_low(width)
        await Timer(round((period - width) * tb.bit), "ps")


# Period and width in bits; the second is what was seen to hold the waits at 115200 baud and 50 MHz.
SPIKES = ((0.31, 0.12), (0.38, 0.01), (0.97, 0.2), (1.0, 0.24), (2.1, 0.2))


@cocotb.test()
@cocotb.parametrize(train=SPIKES, delay=[0, 1, 20])
async def spikes_on_the_idle_line_stop_no_wait(dut, train, delay):
    """From the end of the request to the answer: it comes as on a quiet line, at most a bit later."""
    tb = await Bench.start(dut, bit_time=32, response_delay=delay, de_lead=2)
    assert await tb.both(READ) is not None
    quiet = tb.longest_latency
    for _ in range(3):
        expected = tb.slave.request(READ)
        tb.sent = await tb.line.send(READ)
        stop = []
        noise = cocotb.start_soon(spiky(tb, stop, *train))
        begin = await tb.line.answer_begins(tb.t35 + (delay + 10) * tb.bit)
        stop.append(True)
        await noise
        assert begin is not None, "the answer does not come while there are spikes"
        answer = await tb.line.answer(tb.bit)
        assert answer and answer.data == expected, f"seen {answer}"
        late = tb.latency(answer) - delay - quiet
        assert -0.1 <= late <= 1, f"the answer comes {late:.2f} bits later than on a quiet line"
        await tb.silence()
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(train=SPIKES)
async def spikes_do_not_stretch_the_silence_between_frames(dut, train):
    """A request four characters behind a foreign frame is heard, whatever spikes came between."""
    tb = await Bench.start(dut, bit_time=32)
    foreign = frames.adu(OTHER, frames.read(FC.READ_HOLDINGS, REGISTER, 1))
    for _ in range(3):
        await tb.line.send(foreign)
        stop = []
        noise = cocotb.start_soon(spiky(tb, stop, *train))
        await Timer(round(41.5 * tb.bit), "ps")
        stop.append(True)
        await noise
        await Timer(2 * tb.bit, "ps")
        answer = await tb.query(READ)
        assert answer and answer.data == tb.slave.request(READ), f"seen {answer}"
        await tb.silence()
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8N2"], tail=[0, 15])
async def strict_silence_begins_with_the_last_stop_bit(dut, fmt, tail):
    """A request more than a bit behind t3.5 is heard, though the driver was on for some of it."""
    tb = await Bench.start(dut, fmt=fmt, bit_time=16, strict_turnaround=1, de_tail=tail)
    for margin in (-1.2, 1.2):
        await tb.line.send(READ)
        begin = await tb.line.answer_begins(tb.t35 + 400 * tb.bit)
        assert begin is not None
        await wait_until(begin + 7 * tb.setup.fmt.length * tb.bit + tb.t35 + margin * tb.bit)
        await tb.line.answer(tb.bit)
        second = await tb.query(READ, phase=0)
        assert (second is not None) == (margin > 0), f"t3.5 {margin:+} bits behind our last stop bit"
        await tb.silence()
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8N2", "8N1"])
async def silence_behind_reset_is_exactly_t35(dut, fmt):
    tb = await Bench.start(dut, fmt=fmt, bit_time=16)
    for margin in (-1.2, 0.8):
        for _ in range(3):
            await tb.reset()
            await Timer(round(tb.t35 + margin * tb.bit), "ps")
            answer = await tb.query(READ, phase=0)
            assert (answer is not None) == (margin > 0), f"t3.5 {margin:+} bits behind reset"
            await tb.silence()
    await tb.finish()


@cocotb.test()
async def request_during_the_answer_is_ignored(dut):
    """Whatever is on the line while the device drives it; a frame across the answer's end, too."""
    tb = await Bench.start(dut)
    long_read = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 6))
    for start in (0, 3, 20, 60, 100, 150):  # bits after the first start bit; the answer has 187
        tb.writes.clear()
        expected = tb.slave.request(long_read)
        await tb.line.send(long_read)
        await RisingEdge(tb.dut.de_o)
        await Timer(round(start * tb.bit) + 1, "ps")
        await tb.line.send(write(0xBAD))
        answer = await tb.line.answer(tb.bit)
        assert answer.data == expected, f"seen {frames.text(answer.data)}"
        assert not tb.writes, f"executed a request heard {start} bits into the answer"
        await recovers(tb)
    await tb.finish()


async def answer_beside(tb, begin, line):
    """READ, with `line` starting `begin` ps after the end of t3.5: the answer must be whole and in time."""
    expected = tb.slave.request(READ)
    tb.sent = await tb.line.send(READ)
    await wait_until(tb.sent + tb.t35 + begin)
    intruder = cocotb.start_soon(tb.line.send(line, phase=0))
    answer = await tb.line.answer(tb.t35 + tb.setup.response_delay * tb.bit + 400 * tb.bit)
    shown = f"characters {begin / tb.bit:.3f} bits after t3.5"
    assert answer, f"{shown}: silence"
    assert answer.data == expected, f"{shown}: seen {frames.text(answer.data)}"
    assert tb.latency(answer) >= tb.setup.response_delay, f"{shown}: too early"
    await intruder


@cocotb.test()
async def characters_inside_the_response_delay(dut):
    """They are ignored: the answer is whole, and the line goes on."""
    tb = await Bench.start(dut, response_delay=120)
    for begin, line in ((1.5, b"\xa5"), (20, b"\x00\xff\x55"), (60, write(0xBAD)), (109, b"\x81")):
        tb.writes.clear()
        await answer_beside(tb, begin * tb.bit, line)
        assert not tb.writes, "a request heard during the delay was executed"
        await recovers(tb)
    await tb.finish()


@cocotb.test()
async def character_across_the_start_of_the_answer(dut):
    """At every clock from the end of t3.5 until the answer is on its way."""
    tb = await Bench.start(dut)
    assert await tb.both(READ) is not None
    clock = tb.bit // tb.setup.bit_time
    last = round(tb.longest_latency * tb.setup.bit_time) + 2 * tb.setup.bit_time
    first = round(1.2 * tb.setup.bit_time)  # before that the character may still spoil the request
    for place in range(first, last):
        if place > last - 5 * tb.setup.bit_time or place % 3 == 0:
            await answer_beside(tb, place * clock + clock // 3, tb.rng.choice((b"\x00", b"\xff", b"\x55")))
            await tb.silence(STRAGGLER_BITS)
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(strict=[0, 1])
async def request_right_after_the_answer(dut, strict):
    """Heard at once, or with strict turnaround only after t3.5 of silence."""
    tb = await Bench.start(dut, strict_turnaround=strict)
    answer_bits = 7 * tb.setup.fmt.length
    value = 0x100
    silence = tb.t35 / tb.bit
    for after in (0.05, 0.3, 0.5, 1, 2, 11, silence - 8, silence - 1.5, silence + 1.5):
        expected = tb.slave.request(READ)
        await tb.line.send(READ)
        begin = await tb.line.answer_begins(tb.t35 + 400 * tb.bit)
        await wait_until(begin + (answer_bits + after) * tb.bit)
        first = await tb.line.answer(tb.bit)
        assert first and first.data == expected
        value += 1
        heard = not strict or after * tb.bit > tb.t35 + tb.bit
        if heard:
            assert await tb.both(write(value), phase=0, note=f"{after} bits later") is not None
        else:
            tb.strobes.clear()
            late = await tb.query(write(0xBAD), STRAGGLER_BITS * tb.bit, phase=0)
            assert late is None, f"strict turnaround: heard {after} bits after the answer"
            assert not tb.strobes, f"a frame that was not heard is no error: {dict(tb.strobes)}"
    await tb.silence()
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(strict=[0, 1])
async def own_echo_is_ignored(dut, strict):
    tb = await Bench.start(dut, strict_turnaround=strict)
    tb.line.echo = True
    for value in range(6):
        assert await tb.both(write(value)) is not None
        if strict:
            await tb.silence()
    tb.strobes.clear()
    await tb.silence()
    assert not tb.strobes, f"the echo raised {dict(tb.strobes)}"
    await tb.finish()


@cocotb.test()
async def reset_at_any_moment(dut):
    tb = await Bench.start(dut)
    whole = (len(READ) + 7) * 11 + 45
    for number in range(36):
        moment = tb.rng.uniform(0, whole)
        sender = cocotb.start_soon(tb.line.send(READ))
        await Timer(round(moment * tb.bit), "ps")
        await RisingEdge(dut.clk_i)
        dut.rst_i.value = 1
        await tb.clocks(2)
        assert int(dut.txd_o.value) == 1 and int(dut.de_o.value) == 0, f"not at rest, try {number}"
        if not sender.done():
            await sender
        await tb.reset(1)
        await tb.silence()
        tb.line.forget()
        assert await tb.both(READ, note=f"after a reset at {moment:.1f} bits") is not None
    await tb.finish()


@cocotb.test()
async def after_reset_the_line_must_be_silent_first(dut):
    """A node that wakes up in the middle of a frame takes no part of it for a frame."""
    tb = await Bench.start(dut)
    for early in (0.5, 5, 20, 36):
        await tb.reset()
        tb.writes.clear()
        await Timer(round(early * tb.bit), "ps")
        assert await tb.query(write(0xBAD), 6 * tb.bit) is None, f"heard {early} bits after reset"
        assert not tb.writes
        assert await tb.both(READ) is not None
    tb.strobes.clear()
    sender = cocotb.start_soon(tb.line.send(bytes(6) + write(0xBAD), phase=0))
    await Timer(round((6 * 11 - 0.5) * tb.bit), "ps")
    await tb.reset(2)
    await sender
    await recovers(tb)
    await tb.finish()


@cocotb.test()
async def noise_never_locks_the_receiver(dut):
    """Random levels at random times, then t3.5 of silence, then a request."""
    tb = await Bench.start(dut)
    for _ in range(12):
        edges, time = [], 0
        for _ in range(tb.rng.randrange(10, 120)):
            edges.append((time, tb.rng.getrandbits(1)))
            time += round(tb.rng.expovariate(1 / (1.5 * tb.bit))) + 1
        await tb.line.play([*edges, (time, 1)])
        await recovers(tb)
    await tb.finish()


@cocotb.test()
async def outputs_are_defined_without_reset(dut):
    """Idle from power-up: checked before the first clock edge has done anything."""
    dut.rst_i.value = 0
    dut.rxd_i.value = 1
    await Timer(CLOCK_PS, "ps")
    for name, level in (("txd_o", 1), ("de_o", 0), ("frame_stb_o", 0), ("write_stb_o", 0)):
        seen = str(getattr(dut, name).value)
        assert seen == str(level), f"{name} is {seen} at power-up"
