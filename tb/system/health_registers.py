# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""LINE_HEALTH of modbus_rtu_slave_io at the pins: a fault on the line, then what a master reads by function code 04."""

import cocotb
from cocotb.triggers import Timer
from harness.bench import PARAMETERS
from harness.line import drive, record
from harness.unit import CLOCK_PS, start
from harness.wave import decode, encode, low
from protocol import frames
from protocol.defs import EX, F8E1

BIT = 16  # clocks
BIT_PS = BIT * CLOCK_PS
ADDRESS = 17
WORDS = 8
FIRST, COUNT = PARAMETERS["INPUT_BASE"], PARAMETERS["INPUT_COUNT"]  # the words are the last eight
OWN_INPUTS, AT = COUNT - WORDS, FIRST + COUNT - WORDS
COIL = PARAMETERS["HEALTH_COIL"]
NOTHING = frames.adu(5, frames.read(3, 0, 1))  # a good frame for another slave


class Master:
    """Sends frames and faults; collects what the slave sends."""

    def __init__(self, dut):
        self.dut, self.edges = dut, []
        cocotb.start_soon(record(dut.txd_o, self.edges))

    async def bits(self, count):
        await Timer(round(count * BIT_PS), "ps")

    async def play(self, wave):
        """A wave, and silence until an answer is over."""
        self.edges.clear()
        await drive(wave.edges, self.dut.rxd_i.set, wave.end + 1)
        await self.bits(60)
        while int(self.dut.de_o.value):
            await self.bits(1)
        await self.bits(45)

    async def ask(self, line, **wave):
        """The answer to a frame, b"" for silence."""
        await self.play(encode(line, F8E1, BIT_PS, **wave))
        return decode(self.edges, F8E1, BIT_PS).data if self.edges else b""

    async def words(self, first=0, count=WORDS):
        """What function code 04 reads."""
        answer = await self.ask(frames.adu(ADDRESS, frames.read(4, AT + first, count)))
        assert answer[:3] == bytes([ADDRESS, 4, 2 * count]), frames.text(answer)
        return frames.unpack_words(answer[3:-2])

    async def write(self, coil, on):
        request = frames.adu(ADDRESS, frames.write_coil(coil, on))
        assert await self.ask(request) == request

    async def clear(self):
        await self.write(COIL, True)
        await self.write(COIL, False)


async def begin(dut):
    await start(dut, rxd=1)
    master = Master(dut)
    await master.bits(60)
    return master


def spoiled(error):
    return [(byte, 0, error if place == 3 else None) for place, byte in enumerate(NOTHING)]


def gapped(gap):
    return [(byte, gap if place == 3 else 0, None) for place, byte in enumerate(NOTHING)]


def close(words, gap, bit_time):
    """Words 6 and 7: a bit time of 16 clocks is told in steps of 10, and a clock is 6 of them."""
    return abs(words[6] - gap) <= 22 and abs(words[7] - bit_time) <= 22


@cocotb.test()
async def fault_on_the_line_is_in_its_register(dut):
    master = await begin(dut)
    expected = [0] * 6
    faults = [
        (0, low(0.25 * BIT_PS)),
        (1, low(12 * BIT_PS)),
        (2, encode(spoiled("parity"), F8E1, BIT_PS)),
        (3, encode(spoiled("framing"), F8E1, BIT_PS)),
        (4, encode(frames.bad_crc(NOTHING), F8E1, BIT_PS)),
        (5, encode(gapped(1.8), F8E1, BIT_PS)),
    ]
    for word, wave in faults:
        for _ in range(2):
            await master.play(wave)
            expected[word] += 1
            if word == 1:
                expected[3] += 1  # a break is a character of zeros without a stop bit
            words = await master.words()
            assert words[:6] == expected, f"{words} behind a fault of word {word}"
            assert close(words, 0, 1000), f"{words}"
    assert (await master.words(2, 3)) == expected[2:5]


@cocotb.test()
async def master_reads_its_own_rate_and_gaps(dut):
    master = await begin(dut)
    request = frames.adu(ADDRESS, frames.read(4, AT + 6, 2))
    for offset in (-0.02, 0.0, 0.02):
        await master.clear()
        answer = await master.ask(request, offset=offset)
        words = [0] * 6 + frames.unpack_words(answer[3:-2])
        assert close(words, max(0, 1000 * offset), 1000 * (1 + offset)), f"{words} at {offset}"
    for gap in (0.4, 1.2, 0.7):
        await master.ask(gapped(gap))
    assert close(await master.words(), 1200, 1000)


@cocotb.test()
async def coil_clears_when_it_turns_1(dut):
    """No other coil does, and not while it stays 1."""
    master = await begin(dut)

    async def spoil():
        await master.play(low(0.25 * BIT_PS))
        await master.ask(frames.bad_crc(NOTHING))
        words = await master.words()
        assert words[0] == 1 and words[4] == 1, f"{words}"

    for _ in range(2):
        await spoil()
        await master.write(COIL, False)
        await master.write(COIL - 1, True)
        assert (await master.words())[:6] == [1, 0, 0, 0, 1, 0], "another coil or a 0 clears"
        await master.write(COIL, True)
        assert (await master.words())[:6] == [0] * 6
        await spoil()
        await master.write(COIL, True)
        assert (await master.words())[:6] == [1, 0, 0, 0, 1, 0], "a 1 behind a 1 clears"
        await master.write(COIL, False)
        await master.write(COIL - 1, False)
        await master.clear()
        assert (await master.words())[:6] == [0] * 6


@cocotb.test()
async def ranges_and_other_tables_are_those_of_the_bank(dut):
    """Input registers in front of the words are the user's; a read may go over both; behind them is nothing."""
    master = await begin(dut)
    own = [0xA000 + place for place in range(OWN_INPUTS)]
    ones = [0xFFFF] * WORDS  # these bits do not count
    dut.inputs_i.value = sum(word << 16 * place for place, word in enumerate(own + ones))
    await master.ask(frames.bad_crc(NOTHING))
    answer = await master.ask(frames.adu(ADDRESS, frames.read(4, FIRST, COUNT)))
    words = frames.unpack_words(answer[3:-2])
    assert words[:OWN_INPUTS] == own and words[OWN_INPUTS:][:6] == [0, 0, 0, 0, 1, 0], f"{words}"
    for first, count in ((FIRST, COUNT + 1), (AT + WORDS, 1), (AT + 7, 2), (FIRST - 1, 2)):
        answer = await master.ask(frames.adu(ADDRESS, frames.read(4, first, count)))
        assert answer == frames.adu(ADDRESS, bytes([0x84, EX.ADDRESS])), frames.text(answer)
    await master.ask(frames.adu(ADDRESS, frames.write_registers(AT, list(range(100, 108)))))
    answer = await master.ask(frames.adu(ADDRESS, frames.read(3, AT, 8)))
    assert frames.unpack_words(answer[3:-2]) == list(range(100, 108))
    answer = await master.ask(frames.adu(ADDRESS, frames.read(1, COIL, 1)))
    assert answer == frames.adu(ADDRESS, bytes([1, 1, 0]))
