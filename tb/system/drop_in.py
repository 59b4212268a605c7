# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The drop-ins as a user instantiates them: settings are parameters, only clock, line and data are connected."""

import cocotb
from harness import wave
from harness.bench import CLOCK_PS, PARAMETERS, Bench
from harness.line import now
from harness.lines import with_gap
from protocol import frames
from protocol.defs import BROADCAST, DEFAULT_BAUD, FORMATS, Space

OTHER = 99
RATE_ERROR = 0.005  # of what is sent


def built():
    """The fields of Setup that the parameters of the build stand for; drop-in defaults where it names none."""
    given = PARAMETERS.get
    clk_hz, baud = given("CLK_HZ", 50_000_000), given("BAUD", DEFAULT_BAUD)
    sixteenths = 16 if given("BIT_FRACTIONS", 0) else 1
    bit = (clk_hz * sixteenths + baud // 2) // baud * (16 // sixteenths)
    return {
        "address": given("ADDRESS", 1),
        "bit_time": bit // 16,
        "bit_fraction": bit % 16,
        "fmt": next(fmt for fmt in FORMATS if fmt.code == given("FORMAT", 0)),
        "broadcast_en": given("BROADCAST", 1),
        "gap_count_only": given("GAP_COUNT_ONLY", 0),
        "strict_turnaround": given("STRICT_TURNAROUND", 0),
        "response_delay": given("RESPONSE_DELAY", 0),
        "de_lead": given("DE_LEAD", 1),
        "de_tail": given("DE_TAIL", 0),
    }


async def started(dut):
    """A bench of the drop-in with the settings that it was built with."""
    return await Bench.start(dut, **built())


async def ask(tb, line, note=""):
    """Play `line` to device and model once the line has been silent for t3.5, which strict turnaround asks for."""
    await tb.silence()
    return await tb.both(line, note=note)


@cocotb.test()
async def settings_are_those_of_the_parameters(dut):
    """Address, rate, format, broadcast, t1.5 rule, turnaround, delay, driver lead and tail: each shows at the pins."""
    tb = await started(dut)
    own, register = tb.setup.address, tb.slave.config.tables[Space.HOLDINGS][0]
    for address in (own, OTHER, BROADCAST, own):
        value = tb.rng.getrandbits(16)
        await ask(tb, frames.adu(address, frames.write_register(register, value)), note=f"address {address}")
        await ask(tb, frames.adu(own, frames.read(3, register, 1)), note="read back")
    await ask(tb, with_gap(frames.adu(own, frames.read(3, register, 2)), 3, 2.5), note="a gap above t1.5")
    await ask(tb, frames.adu(own, frames.read(3, register, 1)))
    at_once = await tb.query(frames.adu(own, frames.read(3, register, 1)))
    assert (at_once is None) == bool(tb.setup.strict_turnaround), "strict turnaround"
    await tb.finish()


@cocotb.test()
async def data_ports_show_what_the_line_does(dut):
    """Coils, inputs, registers: written on the line and seen at the ports, set at the ports and read on the line."""
    tb = await started(dut)
    own, tables = tb.setup.address, tb.slave.config.tables
    for space in (Space.DISCRETES, Space.INPUTS):
        if tables[space][1]:
            await tb.preset((space, tables[space][0]), 1 if space == Space.DISCRETES else 0xBEEF)
    for code, space in ((1, Space.COILS), (2, Space.DISCRETES), (4, Space.INPUTS), (3, Space.HOLDINGS)):
        await ask(tb, frames.adu(own, frames.read(code, tables[space][0], 1)), note=f"read {space.name}")
    await ask(tb, frames.adu(own, frames.write_coil(tables[Space.COILS][0], True)), note="coil on")
    await ask(tb, frames.adu(own, frames.write_register(tables[Space.HOLDINGS][0], 0x1234)), note="register")
    await tb.finish()


@cocotb.test()
async def alive_rises_with_the_first_request(dut):
    tb = await started(dut)
    assert not int(dut.alive_o.value)
    await ask(tb, frames.adu(tb.setup.address, frames.bare(7)))
    assert int(dut.alive_o.value)
    await tb.finish()


@cocotb.test()
async def rate_is_the_one_that_was_asked_for(dut):
    """Requests at exactly BAUD are understood; the answer's bits, measured at txd_o, are those of BAUD."""
    tb = await started(dut)
    exact = PARAMETERS.get("CLK_HZ", 50_000_000) * CLOCK_PS / PARAMETERS.get("BAUD", DEFAULT_BAUD)
    own, (first, count) = tb.setup.address, tb.slave.config.tables[Space.HOLDINGS]
    edges = []

    async def record():
        while True:
            await dut.txd_o.value_change
            edges.append(now())

    cocotb.start_soon(record())
    for _ in range(3):
        words = [tb.rng.getrandbits(16) for _ in range(count)]
        for pdu in (frames.write_registers(first, words), frames.read(3, first, count)):
            await tb.silence()
            edges.clear()
            answer = await tb.both(frames.adu(own, pdu), offset=exact / tb.bit - 1, timing=False)
        places = [place for place, _ in wave.encode(answer, tb.setup.fmt, 1).edges]
        assert len(edges) == len(places)
        bit = (edges[-1] - edges[0]) / (places[-1] - places[0])
        assert abs(exact / bit - 1) < RATE_ERROR, f"a bit lasts {bit:.0f} ps, wanted {exact:.0f}"
    await tb.finish()
