# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_example_units at the pins: three units in one core, among other slaves, one of them the host's choice."""

import random

import cocotb
from harness.unit import clocks, settle, start
from harness.volume import volume
from harness.wave import decode, encode
from protocol import frames
from protocol.defs import F8E1

BIT = 16  # clocks
UNITS = (17, 18, 40)
ITEMS = 4
OTHERS = (1, 5, 16, 19, 41, 247)


class Line:
    """Sends frames; collects what the core sends; counts good frames and writes."""

    def __init__(self, dut):
        self.dut, self.good, self.writes = dut, 0, []
        self.now, self.edges = 0, []

    async def clock(self, count):
        """So many clocks; the edges of txd_o go to `edges`."""
        dut = self.dut
        for _ in range(count):
            await clocks(dut)
            await settle()
            self.now += 1
            self.good += int(dut.events_o.value) & 1
            if int(dut.write_stb_o.value):
                self.writes.append(int(dut.unit_o.value))
            level = int(dut.txd_o.value)
            if level != (self.edges[-1][1] if self.edges else 1):
                self.edges.append((self.now, level))

    async def ask(self, frame):
        """The answer to a frame, b"" for silence."""
        wave, now, dut = encode(frame, F8E1, BIT), 0, self.dut
        for time, level in wave.edges:
            await self.clock(time - now)
            dut.rxd_i.value, now = level, time
        self.edges = []
        await self.clock(wave.end - now + 60 * BIT)
        while int(dut.de_o.value):
            await self.clock(BIT)
        await self.clock(45 * BIT)
        return decode(self.edges, F8E1, BIT).data if self.edges else b""

    async def held(self):
        """[[holding registers] of each unit]."""
        await settle()
        value = int(self.dut.holdings_o.value)
        words = [value >> 16 * n & 0xFFFF for n in range(3 * ITEMS)]
        return [words[ITEMS * n : ITEMS * (n + 1)] for n in range(3)]


async def begin(dut):
    await start(dut, rxd=1, third=UNITS[2])
    line = Line(dut)
    await line.clock(60 * BIT)
    return line


@cocotb.test()
async def each_unit_has_its_own_registers(dut):
    line = await begin(dut)
    rng, held = random.Random(1), [[0] * ITEMS for _ in UNITS]
    for _ in range(volume("rounds with several units")):
        place = rng.randrange(3)
        unit, item, value = UNITS[place], rng.randrange(ITEMS), rng.getrandbits(16)
        request = frames.adu(unit, frames.write_register(item, value))
        assert await line.ask(request) == request
        held[place][item] = value
        assert await line.held() == held and line.writes[-1] == unit
        if rng.random() < 0.5:  # another slave, and its answer
            foreign = frames.adu(rng.choice(OTHERS), frames.write_register(item, 0xDEAD))
            for _ in range(2):
                assert await line.ask(foreign) == b""
        place = rng.randrange(3)
        answer = await line.ask(frames.adu(UNITS[place], frames.read(3, 0, ITEMS)))
        assert answer == frames.adu(UNITS[place], bytes([3, 2 * ITEMS]) + frames.pack_words(held[place]))
    assert await line.held() == held


@cocotb.test()
async def broadcast_is_one_request_for_all(dut):
    line = await begin(dut)
    good = line.good
    assert await line.ask(frames.adu(0, frames.write_registers(1, [7, 8]))) == b""
    assert await line.held() == [[0, 7, 8, 0]] * 3
    assert line.good == good + 1 and line.writes == [0]


@cocotb.test()
async def no_other_address_is_answered(dut):
    line = await begin(dut)
    for address in (*OTHERS, UNITS[2], 248, 255):
        dut.third_i.value = address if address > 247 else 0  # neither is a unit, whatever the host says
        assert await line.ask(frames.adu(address, frames.read(3, 0, 1))) == b"", f"address {address}"
    assert await line.ask(frames.adu(0, frames.read(3, 0, 1))) == b""


@cocotb.test()
async def host_changes_its_unit(dut):
    line = await begin(dut)
    for unit in (1, 40, 247):
        dut.third_i.value = unit
        assert (await line.ask(frames.adu(unit, frames.read(3, 0, 1))))[:1] == bytes([unit])
    assert await line.ask(frames.adu(40, frames.read(3, 0, 1))) == b""


@cocotb.test()
async def exceptions_and_counters_are_those_of_one_core(dut):
    line = await begin(dut)
    for unit in UNITS:
        assert await line.ask(frames.adu(unit, frames.read(3, ITEMS, 1))) == frames.adu(unit, b"\x83\x02")
        assert await line.ask(frames.adu(unit, b"\x41")) == frames.adu(unit, b"\xc1\x01")
    answer = await line.ask(frames.adu(18, frames.diagnostics(0x0D, 0)))
    assert answer == frames.adu(18, frames.diagnostics(0x0D, 6)), frames.text(answer)
