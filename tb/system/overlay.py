# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""One block of registers behind all four tables: a device with one block (V1.1b3, section 4.3)."""

import cocotb
from harness.bench import Bench
from harness.volume import volume
from protocol import frames
from protocol.defs import FC, Space
from protocol.model import REGISTER_BITS

OWN = 17


async def ask(tb, pdu):
    """The device's answer, checked against the model."""
    return await tb.both(frames.adu(OWN, pdu))


def span(tb, space):
    """(base, count) of a table."""
    return tb.slave.config.tables[space]


@cocotb.test()
async def bits_and_registers_are_the_same_memory(dut):
    tb = await Bench.start(dut)
    register, count = span(tb, Space.HOLDINGS)
    coil, discrete = span(tb, Space.COILS)[0], span(tb, Space.DISCRETES)[0]
    free = count - tb.slave.config.read_only[1] - 1  # the read-only registers stand near the end
    await ask(tb, frames.write_registers(register, [tb.rng.getrandbits(16) for _ in range(free)]))
    await ask(tb, frames.read(FC.READ_INPUTS, span(tb, Space.INPUTS)[0], count))
    for _ in range(volume("random writes to overlaid tables")):
        quantity = tb.rng.randint(1, 40)
        place = tb.rng.randint(0, free * REGISTER_BITS - quantity)
        bits = [tb.rng.getrandbits(1) for _ in range(quantity)]
        await ask(tb, frames.write_coils(coil + place, bits))
        await ask(tb, frames.read(FC.READ_COILS, coil + place, quantity))
        await ask(tb, frames.read(FC.READ_DISCRETES, discrete + place, quantity))
        await ask(tb, frames.write_coil(coil + place, bool(bits[0] ^ 1)))
        await ask(tb, frames.read(FC.READ_HOLDINGS, register, count))
        await ask(tb, frames.mask_write(register + place // REGISTER_BITS, 0xFFFE, 1))
    await tb.finish()


@cocotb.test()
async def read_only_registers_keep_their_bits(dut):
    tb = await Bench.start(dut)
    base, count = tb.slave.config.read_only
    await tb.preset((Space.HOLDINGS, base), 0xA5C3)
    first, end = base * REGISTER_BITS, (base + count) * REGISTER_BITS
    for place, quantity in ((first - 1, 1), (first, 1), (first - 1, 2), (end - 1, 1), (end - 1, 2), (end, 1)):
        touched = place < end and place + quantity > first
        answer = await ask(tb, frames.write_coils(place, [1] * quantity))
        assert (answer[1] & 0x80 != 0) == touched, f"coils {place}, {quantity}"
        await ask(tb, frames.write_coil(place, False))
    await ask(tb, frames.write_register(base, 0xBAD))
    await ask(tb, frames.read(FC.READ_INPUTS, base, 1))
    await tb.finish()


@cocotb.test()
async def ends_of_the_block(dut):
    tb = await Bench.start(dut)
    for code, space in (
        (FC.READ_COILS, Space.COILS),
        (FC.READ_DISCRETES, Space.DISCRETES),
        (FC.READ_INPUTS, Space.INPUTS),
        (FC.READ_HOLDINGS, Space.HOLDINGS),
    ):
        base, count = tb.slave.config.tables[space]
        last = base + count - 1
        for address, quantity in ((last, 1), (last, 2), (last + 1, 1), (base, 1)):
            if address < 65536:
                await ask(tb, frames.read(code, address, quantity))
    await tb.finish()
