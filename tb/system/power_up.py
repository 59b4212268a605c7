# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""From power-up with rst_i at 0 throughout: the first thing that happens in its simulation, so one test a run."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, Timer
from harness.bench import AT_REST, CLOCK_PS, Bench
from harness.line import now
from protocol import frames
from protocol.defs import FC, Space

OWN = 17
IDLE = {"txd_o": 1, "de_o": 0, "alive_o": 0, "rx_active_o": 0, "frame_stb_o": 0, "write_stb_o": 0, "listen_only_o": 0}
EARLY_CLOCKS = 40  # into the silence that comes first


async def powered_up(dut):
    """A bench at time 0, every input at rest, the clock not yet running."""
    assert now() == 0, "something ran before"
    for port in (*AT_REST, "rst_i", "clk_i"):
        if hasattr(dut, port):
            getattr(dut, port).value = 0
    dut.rxd_i.value = 1
    await Timer(1, "ps")
    tb = Bench(dut, 1)
    tb.apply()
    await Timer(1, "ps")
    return tb


def watch(tb):
    """Count the strobes that the frames here may give."""
    for name in ("err_crc", "err_gap", "err_short", "frame_stb"):
        cocotb.start_soon(tb._count(name))
    cocotb.start_soon(tb._watch_writes())


@cocotb.test()
@cocotb.parametrize(code=[FC.WRITE_COIL.value, FC.WRITE_FILE.value])
async def first_frame_is_short(dut, code):
    """A request that ends before its fields, as the first frame: exception 03, and the next request is answered."""
    tb = await powered_up(dut)
    Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
    watch(tb)
    await tb.silence()
    assert await tb.both(frames.adu(OWN, {FC.WRITE_COIL: b"\x05", FC.WRITE_FILE: b"\x15\x00"}[code]))
    assert await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, tb.slave.config.tables[Space.HOLDINGS][0], 1)))


@cocotb.test()
async def works_without_a_reset(dut):
    """Idle outputs from the first moment; nothing is heard before t3.5 of silence; then all is as after a reset."""
    tb = await powered_up(dut)

    async def idle(when):
        await ReadOnly()
        for port, level in IDLE.items():
            seen = getattr(dut, port).value
            assert str(seen) == str(level), f"{port} is {seen} {when}, expected {level}"
        await Timer(1, "ps")

    await idle("before the first clock")
    Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
    watch(tb)
    await tb.clocks(EARLY_CLOCKS)
    await idle("after some clocks")
    holdings = tb.slave.config.tables[Space.HOLDINGS][0]
    request = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, holdings, 1))
    # Behind less than t3.5: somebody else's, for all that the slave knows.
    await tb.line.send(request, phase=0)
    assert await tb.line.answer(tb.t35 + 300 * CLOCK_PS) is None, "heard before the line was silent for t3.5"
    assert not tb.strobes, f"strobes for what came too early: {dict(tb.strobes)}"
    await tb.silence()
    await idle("after the silence")
    for pdu in (
        frames.write_registers(holdings, [0x1234, 0xABCD]),
        frames.read(FC.READ_HOLDINGS, holdings, 2),
        b"\x63",
    ):
        assert await tb.both(frames.adu(OWN, pdu))
    assert await tb.both(frames.bad_crc(request)) is None
    await tb.compare_counters("without a reset")
    await tb.finish()
