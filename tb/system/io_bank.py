# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The drop-in with flat vectors: every item at its place, whole blocks at once, inputs as snapshots."""

import cocotb
from cocotb.triggers import ReadOnly, Timer
from harness.bench import Bench
from harness.volume import volume
from protocol import frames
from protocol.defs import FC, Space

OWN = 17
TABLES = {
    FC.READ_COILS: Space.COILS,
    FC.READ_DISCRETES: Space.DISCRETES,
    FC.READ_HOLDINGS: Space.HOLDINGS,
    FC.READ_INPUTS: Space.INPUTS,
}


def span(tb, space):
    """(base, count) of a table."""
    return tb.slave.config.tables[space]


@cocotb.test()
async def outputs_are_zero_after_reset(dut):
    await Bench.start(dut)
    assert int(dut.coils_o.value) == 0, f"coils {dut.coils_o.value}"
    assert int(dut.holdings_o.value) == 0, f"holdings {dut.holdings_o.value}"


@cocotb.test()
async def every_input_is_read_at_its_place(dut):
    tb = await Bench.start(dut)
    for _ in range(4):
        for space, width in ((Space.DISCRETES, 1), (Space.INPUTS, 16)):
            base, count = span(tb, space)
            for item in range(base, base + count):
                await tb.preset((space, item), tb.rng.getrandbits(width))
        for code in (FC.READ_DISCRETES, FC.READ_INPUTS):
            base, count = span(tb, TABLES[code])
            assert await tb.both(frames.adu(OWN, frames.read(code, base, count))) is not None
            await tb.both(frames.adu(OWN, frames.read(code, base + count - 1, 1)))
    await tb.finish()


@cocotb.test()
async def every_output_is_written_at_its_place(dut):
    tb = await Bench.start(dut)
    for space in (Space.COILS, Space.HOLDINGS):
        base, count = span(tb, space)
        for item in range(base, base + count):
            if space == Space.COILS:
                pdu = frames.write_coil(item, item % 3 != 1)
            else:
                pdu = frames.write_register(item, tb.rng.getrandbits(16))
            assert await tb.both(frames.adu(OWN, pdu)) is not None
            await tb.compare((space, base + i) for i in range(count))
    coils, registers = span(tb, Space.COILS), span(tb, Space.HOLDINGS)
    for _ in range(volume("blocks written to flat vectors")):
        bits = [tb.rng.getrandbits(1) for _ in range(coils[1])]
        words = [tb.rng.getrandbits(16) for _ in range(registers[1])]
        for pdu in (
            frames.write_coils(coils[0], bits),
            frames.write_registers(registers[0], words),
            frames.read(FC.READ_COILS, *coils),
            frames.read(FC.READ_HOLDINGS, *registers),
        ):
            assert await tb.both(frames.adu(OWN, pdu)) is not None
        await tb.compare((Space.COILS, coils[0] + i) for i in range(coils[1]))
        await tb.compare((Space.HOLDINGS, registers[0] + i) for i in range(registers[1]))
    await tb.finish()


@cocotb.test()
async def nothing_moves_on_refused_and_bad_requests(dut):
    tb = await Bench.start(dut)
    coils, registers = span(tb, Space.COILS), span(tb, Space.HOLDINGS)
    moved = []

    async def watch(port):
        while True:
            await port.value_change
            await ReadOnly()
            moved.append(port.value)

    for port in (dut.coils_o, dut.holdings_o):
        cocotb.start_soon(watch(port))
    block = frames.write_registers(registers[0], [0xFFFF] * (registers[1] + 1))
    bits = frames.write_coils(coils[0], [1] * (coils[1] + 1))
    for pdu in (block, bits, frames.write_register(registers[0], 0xFFFF) + b"\0"):
        await tb.both(frames.adu(OWN, pdu))
        await tb.both(frames.adu(OWN + 1, pdu))
        await tb.both(frames.bad_crc(frames.adu(OWN, frames.write_coil(coils[0], True))))
    tb.apply(busy=1)
    await tb.both(frames.adu(OWN, frames.write_register(registers[0], 0xFFFF)))
    assert not moved, f"outputs moved to {moved[0]}"
    await tb.finish()


@cocotb.test()
async def write_pulse_tells_the_range(dut):
    """One pulse for a committed write, none for anything else (the bench compares each request)."""
    tb = await Bench.start(dut)
    base, count = span(tb, Space.HOLDINGS)
    await tb.both(frames.adu(OWN, frames.write_registers(base, [1] * count)))
    assert tb.writes == [(Space.HOLDINGS, base, base + count - 1)]
    await Timer(round(tb.t35), "ps")
    assert len(tb.writes) == 1
    await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, base, count)))
    assert not tb.writes
    await tb.finish()
