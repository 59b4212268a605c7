# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""One block of registers behind all four tables: a device with one block (V1.1b3, section 4.3)."""

import cocotb
from mbrtu import frames
from mbrtu.bench import Bench
from mbrtu.defs import FC, Space
from mbrtu.model import REGISTER_BITS

OWN = 17


async def ask(tb, pdu):
    """The device's answer, checked against the model."""
    return await tb.both(frames.adu(OWN, pdu))


@cocotb.test()
async def bits_and_registers_are_the_same_memory(dut):
    tb = await Bench.start(dut)
    register, count = tb.slave.config.tables[Space.HOLDINGS]
    coil, _ = tb.slave.config.tables[Space.COILS]
    discrete, _ = tb.slave.config.tables[Space.DISCRETES]
    inputs, _ = tb.slave.config.tables[Space.INPUTS]
    words = [tb.rng.getrandbits(16) for _ in range(count)]
    await ask(tb, frames.write_registers(register, words))
    await ask(tb, frames.read(FC.READ_INPUTS, inputs, count))
    for _ in range(20):
        quantity = tb.rng.randint(1, min(40, count * REGISTER_BITS))
        place = tb.rng.randint(0, count * REGISTER_BITS - quantity)
        bits = [tb.rng.getrandbits(1) for _ in range(quantity)]
        await ask(tb, frames.write_coils(coil + place, bits))
        await ask(tb, frames.read(FC.READ_COILS, coil + place, quantity))
        await ask(tb, frames.read(FC.READ_DISCRETES, discrete + place, quantity))
        await ask(tb, frames.write_coil(coil + place, bool(bits[0] ^ 1)))
        await ask(tb, frames.read(FC.READ_HOLDINGS, register, count))
        await ask(tb, frames.mask_write(register + place // REGISTER_BITS, 0xFFFE, 1))
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
