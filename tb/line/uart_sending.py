# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_uart sending, with the CRC unit: exact bits, no gap between characters, the check sends itself."""

import cocotb
from cocotb.triggers import Timer
from harness import wave
from harness.line import now
from harness.unit import CLOCK_PS, clocks, start, strobe
from protocol import frames
from protocol.defs import FORMAT_BY_NAME


async def transmitted(dut, data, checks, fmt, bit_time):
    """Feed `data`, then `checks` check characters; the bytes on the line."""
    edges = []

    async def record():
        while True:
            await dut.txd_o.value_change
            edges.append((now(), int(dut.txd_o.value)))

    recorder = cocotb.start_soon(record())
    await clocks(dut)
    await strobe(dut, clear=1)
    for number in range(len(data) + checks):
        dut.valid_i.value = 1
        dut.check_i.value = int(number >= len(data))
        dut.data_i.value = data[number] if number < len(data) else 0xEE
        while True:
            await clocks(dut)
            if int(dut.ready_o.value):
                break
    dut.valid_i.value = 0
    await Timer((fmt.length + 2) * bit_time * CLOCK_PS, "ps")
    recorder.cancel()
    got = wave.decode(edges, fmt, bit_time * CLOCK_PS)
    return got.data


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), bit_time=[8, 9, 10, 11, 16])
async def characters_go_out_without_a_gap(dut, fmt, bit_time):
    """The decoder raises on a gap, a bit of a wrong length, wrong parity or a low stop bit."""
    fmt = FORMAT_BY_NAME[fmt]
    rng = await start(dut, bit_time=bit_time, format=fmt.code)
    assert int(dut.txd_o.value) == 1 and int(dut.ready_o.value) == 1
    for data in (b"\0", b"\xff", b"\x55\xaa", bytes(rng.randbytes(40))):
        seen = await transmitted(dut, data, 0, fmt, bit_time)
        assert seen == data, f"sent {frames.text(data)}, seen {frames.text(seen)}"


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def check_bits_send_themselves(dut, fmt):
    fmt = FORMAT_BY_NAME[fmt]
    rng = await start(dut, bit_time=8, format=fmt.code)
    for data in (b"\x02\x07", b"\x01\x02\0\0\0\x04", rng.randbytes(30)):
        seen = await transmitted(dut, data, 2, fmt, 8)
        assert seen == frames.sealed(data), f"expected {frames.text(frames.sealed(data))}, seen {frames.text(seen)}"


@cocotb.test()
async def all_bytes_have_their_parity(dut):
    for fmt in (FORMAT_BY_NAME["8E1"], FORMAT_BY_NAME["8O1"]):
        await start(dut, bit_time=8, format=fmt.code)
        assert await transmitted(dut, bytes(range(256)), 0, fmt, 8) == bytes(range(256))


@cocotb.test()
async def reset_frees_the_line(dut):
    await start(dut, bit_time=8)
    dut.data_i.value, dut.valid_i.value = 0, 1
    await clocks(dut, 30)
    dut.valid_i.value = 0
    assert int(dut.txd_o.value) == 0
    await strobe(dut, rst=1)
    await clocks(dut)
    assert int(dut.txd_o.value) == 1 and int(dut.ready_o.value) == 1
    await clocks(dut, 200)
    assert int(dut.txd_o.value) == 1
