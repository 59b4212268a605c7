# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a relay box must answer at its pins, whichever language its top is in: 2 MHz, 250 kbaud, 8E1, address 17."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, Timer, with_timeout
from protocol.frames import crc16

BIT_NS, HALF_NS = 4000, 2000


async def ask(dut, *body):
    """Sends a request with its check field; the answer without it."""
    check = crc16(bytes(body))
    for byte in (*body, check & 255, check >> 8):
        for bit in (0, *(byte >> k & 1 for k in range(8)), byte.bit_count() & 1, 1):
            dut.rxd_i.value = bit
            await Timer(BIT_NS, "ns")
    answer = []
    while True:
        try:
            await with_timeout(FallingEdge(dut.txd_o), 3 if answer else 20, "ms")
        except cocotb.triggers.SimTimeoutError:
            break
        await Timer(HALF_NS, "ns")
        byte = 0
        for k in range(8):
            await Timer(BIT_NS, "ns")
            byte |= int(dut.txd_o.value) << k
        await Timer(2 * BIT_NS, "ns")
        answer.append(byte)
    assert crc16(bytes(answer[:-2])) == answer[-2] | answer[-1] << 8, answer
    return answer[:-2]


@cocotb.test()
async def relay_box_answers(dut):
    """Reset values, reading an input, writing an output, and a value out of range that changes nothing."""
    Clock(dut.clk_i, 500, "ns", impl="gpi").start()
    dut.rst_i.value, dut.rxd_i.value = 1, 1
    dut.temperature_i.value, dut.door_open_i.value = 0xFFFB, 1
    await Timer(5, "us")
    dut.rst_i.value = 0
    await Timer(3, "ms")
    assert int(dut.limit_o.value) == 450 and int(dut.relay_o.value) == 0
    assert await ask(dut, 17, 4, 0, 0, 0, 1) == [17, 4, 2, 0xFF, 0xFB]
    assert await ask(dut, 17, 2, 0, 0, 0, 1) == [17, 2, 1, 1]
    assert await ask(dut, 17, 5, 0, 2, 0xFF, 0) == [17, 5, 0, 2, 0xFF, 0]
    assert await ask(dut, 17, 6, 0, 0, 0, 99) == [17, 6, 0, 0, 0, 99]
    assert await ask(dut, 17, 6, 0, 0, 3, 33) == [17, 0x86, 3]
    assert await ask(dut, 17, 3, 0, 1, 0, 1) == [17, 0x83, 2]
    assert int(dut.limit_o.value) == 99 and int(dut.relay_o.value) == 4
