# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Inputs of the host that change while a request is being worked on."""

import cocotb
from cocotb.triggers import Timer
from harness.bench import CLOCK_PS, Bench
from protocol import frames
from protocol.defs import EX, FC, Space
from protocol.frames import text

OWN, OTHER = 17, 18
READ = frames.adu(OWN, frames.read(FC.READ_INPUTS, 0, 1))
WORK_CLOCKS = 140  # from the end of t3.5 to the answer's first bit and beyond
REFUSED = {
    "busy": frames.adu(OWN, bytes([FC.READ_INPUTS | 0x80, EX.BUSY])),
    "failure": frames.adu(OWN, bytes([FC.READ_INPUTS | 0x80, EX.PARITY])),
}


@cocotb.test()
@cocotb.parametrize(name=["busy", "failure"], on=[0, 1])
async def a_host_that_changes_its_mind(dut, name, on):
    """Busy or failure rising or falling in any clock: refused with its code, or executed; nothing between."""
    tb = await Bench.start(dut)
    await tb.preset((Space.INPUTS, 0), 0x1234)
    executed = frames.adu(OWN, bytes([FC.READ_INPUTS, 2, 0x12, 0x34]))
    active, seen = {"busy": 1, "failure": int(EX.PARITY)}[name], []
    for clock in range(-6, WORK_CLOCKS):
        tb.apply(**{name: active * (1 - on)})
        answer = await tb.query_while(READ, clock, **{name: active * on})
        assert answer is not None, f"clock {clock}: silence"
        seen.append(answer.data)
        assert answer.data in (executed, REFUSED[name]), f"clock {clock}: {text(answer.data)}"
        await tb.silence()
    assert {seen[0], seen[-1]} == {executed, REFUSED[name]}, "the change was never seen"
    tb.apply(**{name: 0})
    await tb.clocks(10)


@cocotb.test()
async def the_address_counts_when_the_frame_is_complete(dut):
    """An address that changes within a frame: the later one is asked."""
    tb = await Bench.start(dut, address=OTHER)
    sender = cocotb.start_soon(tb.line.send(READ))
    await Timer(3 * tb.setup.fmt.length * round(tb.bit), "ps")
    dut.address_i.value = OWN
    await sender
    answer = await tb.line.answer(tb.t35 + 20_000 * CLOCK_PS)
    assert answer is not None and answer.data[0] == OWN, "the address of the frame's end is not asked"
    await tb.silence()
    sender = cocotb.start_soon(tb.line.send(READ))
    await Timer(3 * tb.setup.fmt.length * round(tb.bit), "ps")
    dut.address_i.value = OTHER
    await sender
    assert await tb.line.answer(tb.t35 + 20_000 * CLOCK_PS) is None, "the address of the frame's beginning is asked"
