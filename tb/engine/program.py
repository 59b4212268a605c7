# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The program memory: a step comes a clock after its address and stays; the entries lead to the right routines."""

import cocotb
from harness.steps import NUMBERS, RANGES, step, taken
from harness.unit import clocks, settle, start


async def word(dut, at):
    dut.at_i.value, dut.fetch_i.value = at, 1
    await clocks(dut)
    await settle()
    return int(dut.step_o.value)


def entry(dut, name):
    high, low = RANGES[f"ENTRY_{name}"]
    return int(dut.entries_o.value) >> low & (2 << (high - low)) - 1


@cocotb.test()
async def a_step_is_fetched_and_stays(dut):
    await start(dut)
    seen = [await word(dut, at) for at in range(512)]
    for at in (511, 0, 256, 255, 37):
        dut.at_i.value, dut.fetch_i.value = at, 0
        await clocks(dut)
        await settle()
        before = int(dut.step_o.value)
        dut.fetch_i.value = 1
        await clocks(dut)
        await settle()
        assert int(dut.step_o.value) == seen[at]
        assert before == seen[37 if at == 511 else {0: 511, 256: 0, 255: 256, 37: 255}[at]] or at == 511


@cocotb.test()
async def entries_begin_with_what_is_to_be_done(dut):
    await start(dut)
    bus_message, comm_error = NUMBERS["CPT_BUS_MESSAGE"], NUMBERS["CPT_COMM_ERROR"]
    assert await word(dut, entry(dut, "START")) == step("COUNT", COUNTER=bus_message)
    assert await word(dut, entry(dut, "FOREIGN")) == step("COUNT", COUNTER=bus_message)
    overrun = step("COUNT", COUNTER=NUMBERS["CPT_OVERRUN"], WHEN=NUMBERS["WHEN_LONG"])
    assert await word(dut, entry(dut, "BAD")) == overrun
    assert await word(dut, entry(dut, "BAD") + 2) == step("COUNT", COUNTER=comm_error)
    assert await word(dut, entry(dut, "CLEARING")) == step("COUNT", COUNTER=NUMBERS["CPT_EVENT"], CLEAR=1)
    first = await word(dut, entry(dut, "EXCEPTION"))
    assert taken("WORD_STEP", first) == NUMBERS["STEP_IF"], "nothing is answered in listen-only mode"
    assert await word(dut, entry(dut, "EXCEPTION") + 1) == step("POINT", CLEAR=1)
