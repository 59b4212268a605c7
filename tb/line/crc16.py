# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""CRC unit: the checks of the sources, random frames, giving out low byte first."""

import cocotb
from harness.unit import clocks, settle, start, strobe
from protocol import frames, vectors


async def feed(dut, data):
    """Bytes as they pass on the line."""
    for byte in data:
        for bit in range(8):
            dut.shift_i.value, dut.feed_i.value, dut.data_i.value = 1, 1, byte >> bit & 1
            await clocks(dut)
    dut.shift_i.value = 0
    await settle()


async def give_out(dut):
    """The two check bytes as they go on the line."""
    out = 0
    for bit in range(16):
        dut.shift_i.value, dut.feed_i.value = 1, 0
        await settle()
        out |= int(dut.bit_o.value) << bit
        await clocks(dut)
    dut.shift_i.value = 0
    return out


@cocotb.test()
async def checks_of_the_sources(dut):
    await start(dut)
    for check in vectors.document()["crc_checks"]:
        await strobe(dut, clear=1)
        await feed(dut, bytes.fromhex(check["data"]))
        seen = await give_out(dut)
        assert f"{seen:04X}" == check["crc"], f"{check['data']}: expected {check['crc']}, seen {seen:04X}"


@cocotb.test()
async def remainder_of_a_good_frame_is_zero(dut):
    """And of no other: every single bit error of a frame."""
    rng = await start(dut)
    for length in (2, 6, 30, 254):
        await strobe(dut, clear=1)
        await feed(dut, frames.sealed(rng.randbytes(length)))
        assert int(dut.zero_o.value) == 1
    good = frames.adu(17, frames.read(3, 1, 2))
    for bit in range(8 * len(good)):
        bad = bytearray(good)
        bad[bit // 8] ^= 1 << bit % 8
        await strobe(dut, clear=1)
        await feed(dut, bad)
        assert int(dut.zero_o.value) == 0, f"bit {bit}"


@cocotb.test()
async def nothing_moves_without_shift(dut):
    rng = await start(dut)
    data = rng.randbytes(9)
    await strobe(dut, clear=1)
    for byte in data:
        await feed(dut, [byte])
        dut.data_i.value = 1
        await clocks(dut, 5)
    assert await give_out(dut) == frames.crc16(data)
