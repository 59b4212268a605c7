# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Formats, clocks per bit, baud mismatch and jitter, t1.5 / t3.5 on both sides of 19200 baud."""

import cocotb
from harness.bench import CLOCK_PS, PARAMETERS, PROCESSING_CLOCKS, Bench
from harness.build import DEFAULT_CLK_HZ
from harness.lines import scaled, with_gap
from protocol import frames
from protocol.defs import FC, FLOOR_BAUD, FORMAT_BY_NAME

OWN = 17
READ = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 3))


@cocotb.test()
@cocotb.parametrize(
    case=[
        *((fmt, bit_time) for fmt in FORMAT_BY_NAME for bit_time in (8, 9, 10, 11, 13, 16, 17, 31)),
        ("8E1", 100),
        ("8N1", 434),
    ]
)
async def every_format_at_every_rate(dut, case):
    """Gap-free answers with every bit exactly bit_time clocks long (the decoder demands it)."""
    fmt, bit_time = case
    tb = await Bench.start(dut, fmt=fmt, bit_time=bit_time)
    words = [0x00FF, 0xFF00, 0x5AA5]
    assert await tb.both(frames.adu(OWN, frames.write_registers(0, words))) is not None
    assert await tb.both(READ) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(case=[(8, -0.02), (8, 0.02), (16, -0.04), (16, 0.04)])
async def baud_mismatch_over_the_longest_frame(dut, case):
    """256 bytes: the length is wrong, so exception 03 shows that the frame was understood."""
    bit_time, offset = case
    tb = await Bench.start(dut, bit_time=bit_time)
    frame = frames.adu(OWN, frames.write_registers(0, [0xBAD] * 123) + tb.rng.randbytes(1))
    assert await tb.both(frame, offset=offset, timing=False, note=f"{offset:+.0%}") is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(case=[(8, -0.02), (8, 0.02), (16, -0.04), (16, 0.04)])
async def baud_mismatch_at_every_phase(dut, case):
    """Short frames that begin anywhere between two clock edges."""
    bit_time, offset = case
    tb = await Bench.start(dut, bit_time=bit_time)
    for step in range(0, 25, 2):
        words = [tb.rng.choice((0, 0xFFFF, 0x8000, tb.rng.getrandbits(16))) for _ in range(3)]
        frame = frames.adu(OWN, frames.write_registers(0, words))
        note = f"{offset:+.0%}, {step}/25 of a clock"
        await tb.both(frame, offset=offset, timing=False, note=note, phase=step * CLOCK_PS // 25)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["8O1", "8N2", "8N1"], offset=[-0.035, 0.035])
async def baud_mismatch_in_the_other_formats(dut, fmt, offset):
    tb = await Bench.start(dut, bit_time=16, fmt=fmt)
    frame = frames.adu(OWN, frames.write_registers(0, [tb.rng.getrandbits(16) for _ in range(40)]))
    assert await tb.both(frame, offset=offset, timing=False) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 16])
async def jitter_on_every_edge(dut, bit_time):
    tb = await Bench.start(dut, bit_time=bit_time)
    reach = 0.10 if bit_time == 8 else 0.18
    for _ in range(20):
        assert await tb.both(READ, jitter=reach, timing=False) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8N1"])
async def silences_on_both_sides_of_19200(dut, fmt):
    """t1.5 and t3.5 grow with the character up to 19200 baud and stand still above."""
    clk_hz = PARAMETERS.get("CLK_HZ", DEFAULT_CLK_HZ)
    tb = await Bench.start(dut, fmt=fmt)
    for baud in (9600, FLOOR_BAUD, 38400, 115200):
        bit_time = round(clk_hz / baud)
        if bit_time < 8:
            continue
        tb.apply(bit_time=bit_time)
        await tb.silence()
        for gap in (1.2, 2.0, 4.0):
            line = with_gap(READ, 4, scaled(tb, gap))
            answer = await tb.both(line, note=f"{baud} baud, gap {gap}")
            assert (answer is not None) == (gap < 1.5)
            assert await tb.both(READ) is not None
        assert tb.longest_latency <= 1 + PROCESSING_CLOCKS / bit_time, f"{tb.longest_latency} bits late at {baud}"
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def silence_limits_to_the_bit(dut, fmt):
    """More than a bit inside or outside of t1.5 and t3.5 the outcome is fixed."""
    tb = await Bench.start(dut, fmt=fmt, bit_time=16)
    bit = 1 / tb.setup.fmt.length
    t15, t35 = tb.slave.config.t15, tb.slave.config.t35
    for near in (1.1 * bit, 1.6 * bit):
        for place in (1, 4, 7):
            assert await tb.both(with_gap(READ, place, t15 - near), note="below t1.5") is not None
            assert await tb.both(with_gap(READ, place, t15 + near), note="above t1.5") is None
            assert await tb.both(with_gap(READ, place, t35 - near), note="below t3.5") is None
        foreign = frames.adu(OWN + 1, READ[1:-2])
        line = with_gap(foreign + READ, len(foreign), t35 + near)
        assert await tb.both(line, note="above t3.5") is not None
        line = with_gap(foreign + READ, len(foreign), t35 - near)
        assert await tb.both(line, note="below t3.5") is None
    await tb.finish()
