# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_line_health alone: every word, its limits, clearing and the read port.  The bench plays the core."""

import cocotb
from cocotb.triggers import Timer
from harness.line import drive
from harness.unit import CLOCK_PS, clocks, settle, start, strobe
from harness.wave import encode, low
from protocol import frames
from protocol.defs import F8E1, F8N1, F8O1, FORMATS

GLITCHES, BREAKS, PARITY, FRAMING, CRC, GAPS, LARGEST_GAP, BIT_TIME = range(8)
# Bits of events_i
FRAME, EVENT_PARITY, EVENT_FRAMING, EVENT_OVERRUN, EVENT_CRC, EVENT_SHORT, EVENT_LONG, EVENT_GAP = range(8)
ROUND = 32  # clocks until the machine is at the same word again
BIT = 104
REQUEST = frames.adu(17, frames.read(3, 1, 2))


class Health:
    """Drives the line in picoseconds and the core's signals; reads the words."""

    def __init__(self, dut, bit, fmt):
        self.dut, self.bit, self.fmt = dut, bit, fmt

    async def read(self, word):
        dut = self.dut
        dut.adr_i.value, dut.stb_i.value = word, 1
        waited = 0
        while not waited or not int(dut.ack_o.value):
            waited += 1
            assert waited < 80, "the word does not come"
            await clocks(dut)
            await settle()
        value = int(dut.dat_o.value)
        dut.stb_i.value = 0
        return value, waited

    async def words(self):
        await clocks(self.dut, 2 * ROUND + 2)
        return [(await self.read(word))[0] for word in range(8)]

    async def word(self, word):
        return (await self.words())[word]

    async def play(self, wave):
        """The edges of a wave, at any phase to the clock."""
        await drive(wave.edges, self.dut.rxd_i.set, wave.end)

    async def bits(self, count):
        if count:
            await Timer(round(count * self.bit * CLOCK_PS), "ps")

    async def frame(self, line, event=FRAME, offset=0.0, spikes=(), jitter=None):
        """A frame, with rx_active_i and the verdict of the core behind t3.5."""
        wave = encode(line, self.fmt, self.bit * CLOCK_PS, offset, jitter)
        task = cocotb.start_soon(self.play(wave))
        await self.bits(0.6)
        self.dut.rx_active_i.value = 1
        await task
        await self.bits(3.5 * self.fmt.length)
        self.dut.rx_active_i.value = 0
        await self.event(event)
        await clocks(self.dut, 2 * ROUND)

    async def event(self, *events):
        await clocks(self.dut)
        await strobe(self.dut, events=sum(1 << event for event in events))

    async def low(self, bits):
        await self.play(low(bits * self.bit * CLOCK_PS))
        await self.bits(3)


def settings(bit, fmt):
    return bit << 8 | fmt.code << 24


async def begin(dut, bit=BIT, fmt=F8E1):
    await start(dut, rxd=1, settings=settings(bit, fmt))
    health = Health(dut, bit, fmt)
    await health.bits(2 * fmt.length)
    await clocks(dut, 3 * ROUND)
    assert await health.words() == [0] * 8
    return health


def gapped(gaps):
    """REQUEST with so many characters of silence before some of its bytes: {place: characters}."""
    return [(byte, gaps.get(place, 0), None) for place, byte in enumerate(REQUEST)]


@cocotb.test()
@cocotb.parametrize(fmt=[F8E1, F8N1])
async def glitch_is_a_low_below_half_a_bit(dut, fmt):
    health = await begin(dut, fmt=fmt)
    for count, width in enumerate((0.02, 0.1, 0.3, 0.4), 1):
        await health.low(width)
        assert await health.words() == [count] + [0] * 7, f"{width} bits"
    for width in (0.6, 0.9, 1, 3, 9):
        await health.low(width)
        await health.bits(2 * fmt.length)
        assert await health.words() == [4] + [0] * 7, f"{width} bits"


@cocotb.test()
async def spike_inside_a_character_is_no_glitch(dut):
    health = await begin(dut)
    await health.play(encode(b"\xff", F8E1, BIT * CLOCK_PS))
    await health.bits(22)
    dut.rxd_i.value = 0
    await health.bits(1)
    for _ in range(4):
        dut.rxd_i.value = 1
        await health.bits(0.8)
        dut.rxd_i.value = 0
        await health.bits(0.2)
    dut.rxd_i.value = 1
    await health.bits(22)
    assert await health.words() == [0] * 8


@cocotb.test()
@cocotb.parametrize(fmt=[F8E1, F8N1])
async def break_is_a_low_above_a_character(dut, fmt):
    health = await begin(dut, fmt=fmt)
    for width, count in (
        (1, 0),
        (fmt.length - 0.1, 0),
        (1.1 * fmt.length, 1),
        (3 * fmt.length, 2),
        (40 * fmt.length, 3),
    ):
        await health.low(width)
        await health.bits(2 * fmt.length)
        assert await health.words() == [0, count] + [0] * 6, f"{width} bits"


@cocotb.test()
async def own_frames_are_not_heard(dut):
    health = await begin(dut)
    dut.de_i.value = 1
    await health.low(0.2)
    await health.low(30)
    await health.play(encode(REQUEST, F8E1, BIT * CLOCK_PS))
    dut.de_i.value = 0
    assert await health.words() == [0] * 8


@cocotb.test()
async def each_event_has_its_counter(dut):
    health = await begin(dut)
    expected = [0] * 8
    for event, word in ((EVENT_PARITY, PARITY), (EVENT_FRAMING, FRAMING), (EVENT_CRC, CRC), (EVENT_GAP, GAPS)):
        for _ in range(3):
            await health.event(event)
            expected[word] += 1
            assert await health.words() == expected
    for event in (EVENT_OVERRUN, EVENT_SHORT, EVENT_LONG):
        await health.event(event)
    assert await health.words() == expected
    await health.event(EVENT_PARITY, EVENT_FRAMING, EVENT_CRC, EVENT_GAP)
    assert await health.words() == [0, 0, 4, 4, 4, 4, 0, 0]


@cocotb.test()
async def event_counts_in_any_clock_of_a_round(dut):
    health, count = await begin(dut), 0
    for delay in range(2 * ROUND + 1):
        await health.event(EVENT_PARITY, EVENT_CRC)
        await clocks(dut, 2 * ROUND + delay)
        count += 1
    assert await health.words() == [0, 0, count, 0, count, 0, 0, 0]


@cocotb.test()
async def counters_stop_at_65535(dut):
    health = await begin(dut)
    for word in range(6):
        dut.u_ram.memory[word].value = 0xFFFD
    for value in (0xFFFE, 0xFFFF, 0xFFFF, 0xFFFF):
        await health.low(0.2)
        await health.low(20)
        await health.bits(12)
        await health.event(EVENT_PARITY, EVENT_FRAMING, EVENT_CRC, EVENT_GAP)
        assert await health.words() == [value] * 6 + [0, 0]


@cocotb.test()
@cocotb.parametrize(how=["clear", "rst"])
async def clear_and_reset_set_all_words_to_0(dut, how):
    health = await begin(dut)
    await health.low(0.2)
    await health.low(20)
    await health.bits(12)
    await health.event(EVENT_PARITY, EVENT_FRAMING, EVENT_CRC, EVENT_GAP)
    await health.frame(gapped({3: 0.5}))
    words = await health.words()
    assert words[:6] == [1] * 6 and words[6] and words[7]
    await strobe(dut, **{how: 1})
    assert await health.words() == [0] * 8
    await health.low(0.2)
    await health.frame(REQUEST)
    words = await health.words()
    assert words[:6] == [1, 0, 0, 0, 0, 0] and words[LARGEST_GAP] <= 1 and abs(words[BIT_TIME] - 1000) <= 1, f"{words}"


@cocotb.test()
@cocotb.parametrize(
    case=[
        *((bit, fmt, offset) for bit in (10, 103, 104) for fmt in (F8E1, F8N1) for offset in (-0.04, 0.0, 0.01, 0.04)),
        *((52, fmt, -0.02) for fmt in FORMATS),
        (434, F8O1, 0.005),
    ]
)
async def bit_time_of_the_sender_in_thousandths(dut, case):
    bit, fmt, offset = case
    health = await begin(dut, bit, fmt)
    await health.frame(REQUEST, offset=offset)
    expected = 1000 * (1 + offset)
    step = 1 if bit >= 104 else 10
    slack = step + 2000 / (bit * fmt.length)
    value = await health.word(BIT_TIME)
    assert abs(value - expected) <= slack, f"{value} for {expected:.1f}, {slack:.1f} allowed"
    gap = await health.word(LARGEST_GAP)
    assert abs(gap - max(0, expected - 1000)) <= slack + 2000 / (bit * fmt.length), f"a gap of {gap}"


@cocotb.test()
async def sender_at_our_rate_has_1000(dut):
    """At any phase to the clock: a clock more or less is below a thousandth."""
    health = await begin(dut, 434)
    for phase in (0, 0.3, 0.7):
        await Timer(1 + round(phase * CLOCK_PS), "ps")
        await health.frame(REQUEST[:4])
        assert await health.words() == [0] * 6 + [0, 1000]


@cocotb.test()
async def bit_time_is_that_of_the_last_good_frame(dut):
    health = await begin(dut)
    for offset in (0.03, -0.02, 0.0):
        await health.frame(REQUEST, offset=offset)
        value = await health.word(BIT_TIME)
        assert abs(value - 1000 * (1 + offset)) <= 3
    await health.frame(REQUEST, EVENT_CRC, offset=0.03)
    assert await health.word(BIT_TIME) == value


@cocotb.test()
async def bit_time_is_that_of_the_shortest_distance(dut):
    """One character that follows without a gap is enough."""
    health = await begin(dut)
    await health.frame(gapped({1: 0.7, 2: 0.7, 3: 0.7, 5: 0.7, 6: 0.7, 7: 0.7}))
    assert abs(await health.word(BIT_TIME) - 1000) <= 2
    await health.frame(gapped(dict.fromkeys(range(1, len(REQUEST)), 0.25)))
    assert abs(await health.word(BIT_TIME) - 1250) <= 3, "a gap behind every character"


@cocotb.test()
@cocotb.parametrize(fmt=[F8E1, F8N1], gap=[0.1, 1.49, 8.7], place=[1, 7])
async def largest_gap_of_a_good_frame(dut, fmt, gap, place):
    health = await begin(dut, fmt=fmt)
    await health.frame(gapped({2: 0.05, place: gap}))
    value = await health.word(LARGEST_GAP)
    assert abs(value - 1000 * gap) <= 3, f"{value} for {gap} characters"


@cocotb.test()
async def largest_gap_stays_until_it_is_cleared(dut):
    health = await begin(dut)
    seen = 0
    for gap in (0.2, 0.1, 0.4, 0.4, 0.0, 0.45):
        seen = max(seen, gap)
        await health.frame(gapped({5: gap}))
        value = await health.word(LARGEST_GAP)
        assert abs(value - 1000 * seen) <= 3
    await strobe(dut, clear=1)
    await clocks(dut, 2 * ROUND)
    await health.frame(gapped({5: 0.3}))
    assert abs(await health.word(LARGEST_GAP) - 300) <= 3


@cocotb.test()
@cocotb.parametrize(event=[EVENT_PARITY, EVENT_FRAMING, EVENT_CRC, EVENT_SHORT, EVENT_GAP])
async def gap_of_a_bad_frame_does_not_count(dut, event):
    health = await begin(dut)
    await health.frame(gapped({5: 1.2}), event)
    words = await health.words()
    assert words[LARGEST_GAP] == 0 and words[BIT_TIME] == 0
    await health.frame(REQUEST)
    assert await health.word(LARGEST_GAP) <= 1, "what the bad frame left"


@cocotb.test()
async def silence_between_frames_is_no_gap(dut):
    health = await begin(dut)
    for silence in (0, 1, 30, 200):
        await health.bits(silence)
        await health.frame(REQUEST)
        assert (await health.words())[LARGEST_GAP] <= 1


@cocotb.test()
async def longest_gap_that_is_told(dut):
    health = await begin(dut, 16, F8N1)
    for gap in (30, 200):
        await health.frame(gapped({3: gap}))
        assert 13336 <= await health.word(LARGEST_GAP) <= 13350


@cocotb.test()
async def glitch_in_a_gap_does_not_change_what_is_measured(dut):
    health = await begin(dut)
    wave = encode(gapped({4: 1.0}), F8E1, BIT * CLOCK_PS)
    begins, bit = wave.starts[4] - 5 * BIT * CLOCK_PS, BIT * CLOCK_PS
    wave.edges = sorted([*wave.edges, (begins, 0), (begins + bit // 5, 1)])
    task = cocotb.start_soon(health.play(wave))
    await health.bits(0.6)
    dut.rx_active_i.value = 1
    await task
    await health.bits(40)
    dut.rx_active_i.value = 0
    await health.event(FRAME)
    words = await health.words()
    assert words[GLITCHES] == 1 and words[LARGEST_GAP] <= 1 and abs(words[BIT_TIME] - 1000) <= 2, f"{words}"


@cocotb.test()
async def read_port_answers(dut):
    health = await begin(dut)
    waits = []
    for n in range(40):
        waits.append((await health.read(n % 8))[1])
        await clocks(dut, n % 3)
    assert max(waits) == 2 and min(waits) == 1, f"{waits}"
    await strobe(dut, clear=1)
    assert max([(await health.read(n % 8))[1] for n in range(40)]) <= 34
    dut.stb_i.value = 0
    await clocks(dut, 2)
    for _ in range(10):
        await clocks(dut)
        await settle()
        assert not int(dut.ack_o.value), "an answer without a question"
