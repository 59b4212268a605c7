# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Counters, log and status port alone."""

import cocotb
from harness.steps import NUMBERS, argument, do
from harness.unit import clocks, settle, start, strobe

EVENT, OVERRUN = NUMBERS["CPT_EVENT"], NUMBERS["CPT_OVERRUN"]
LOG_AT = 0x40
WAIT_CLOCKS = 10


async def command(dut, name, event=0, **fields):
    """COUNT or LOG: four clocks, NOW in the last."""
    dut.argument_i.value, dut.event_i.value = argument(**fields), event
    dut.do_i.value = do(name, "APPLIES")
    await clocks(dut, 3)
    dut.do_i.value = do(name, "APPLIES", "NOW")
    await clocks(dut)
    dut.do_i.value = dut.event_i.value = 0
    await settle()


async def mode(dut, *names):
    dut.do_i.value = do(*names)
    await clocks(dut)
    dut.do_i.value = 0
    await settle()


async def status(dut, address):
    """What the host reads, None if it gets no answer."""
    dut.status_stb_i.value, dut.status_adr_i.value = 1, address
    for _ in range(WAIT_CLOCKS):
        await clocks(dut)
        await settle()
        if int(dut.status_ack_o.value):
            seen = int(dut.data_o.value)
            dut.status_stb_i.value = 0
            await clocks(dut, 2)
            await settle()
            return seen
    dut.status_stb_i.value = 0
    await clocks(dut, 2)
    return None


async def cleared(dut):
    random = await start(dut)
    await clocks(dut, 3)
    await settle()
    await strobe(dut, cleared=1)
    return random


@cocotb.test()
async def the_host_waits_until_the_counters_are_cleared(dut):
    await cleared(dut)
    for _ in range(3):
        await command(dut, "COUNT", COUNTER=EVENT)
    assert await status(dut, EVENT) == 3
    await strobe(dut, rst=1)
    assert await status(dut, EVENT) is None, "a count from before the reset"
    await command(dut, "COUNT", COUNTER=EVENT, CLEAR=1)
    await strobe(dut, cleared=1)
    assert await status(dut, EVENT) == 0


@cocotb.test()
async def counters_go_up_and_to_zero(dut):
    await cleared(dut)
    for counter in range(EVENT, OVERRUN + 1):
        await command(dut, "COUNT", COUNTER=counter, CLEAR=1)
        for _ in range(counter):
            await command(dut, "COUNT", COUNTER=counter)
    for counter in range(EVENT, OVERRUN + 1):
        assert await status(dut, counter) == counter
    await command(dut, "COUNT", COUNTER=OVERRUN, CLEAR=1)
    assert await status(dut, OVERRUN) == 0


@cocotb.test()
async def a_condition_that_does_not_hold_counts_nothing(dut):
    await cleared(dut)
    await command(dut, "COUNT", COUNTER=EVENT, CLEAR=1)
    dut.argument_i.value = argument(COUNTER=EVENT)
    for now in ((), (), ("NOW",)):
        dut.do_i.value = do("COUNT", *now)
        await clocks(dut)
    dut.do_i.value = 0
    assert await status(dut, EVENT) == 0


@cocotb.test()
async def newest_entry_comes_first(dut):
    random = await cleared(dut)
    log = []
    for _ in range(70):
        log.insert(0, random.getrandbits(8))
        await command(dut, "LOG", event=log[0])
        del log[64:]
        assert await status(dut, NUMBERS["CPT_ENTRIES"]) == len(log)
        entry = random.randrange(len(log))
        assert await status(dut, LOG_AT + entry) == log[entry]
    await mode(dut, "EMPTY")
    assert await status(dut, NUMBERS["CPT_ENTRIES"]) == 0


@cocotb.test()
async def register_and_modes(dut):
    await cleared(dut)
    register, listen = NUMBERS["CPT_REGISTER"], NUMBERS["CPT_LISTEN_ONLY"]
    assert (await status(dut, register), await status(dut, listen)) == (0, 0)
    dut.diagnostic_i.value = 0x4000 >> 1
    await clocks(dut)
    dut.diagnostic_i.value = 0
    await mode(dut, "OVERRUN", "LISTEN")
    assert (await status(dut, register), await status(dut, listen)) == (0x4001, 1)
    assert int(dut.listen_only_o.value)
    await mode(dut, "CLEAR_OVERRUN", "ACTIVE")
    assert (await status(dut, register), await status(dut, listen)) == (0x4000, 0)
    await mode(dut, "CLEAR_REGISTER")
    assert await status(dut, register) == 0


@cocotb.test()
async def an_answer_goes_before_the_host(dut):
    await cleared(dut)
    await command(dut, "COUNT", COUNTER=EVENT, CLEAR=1)
    await command(dut, "COUNT", COUNTER=EVENT)
    dut.read_i.value, dut.read_at_i.value = 1, EVENT
    assert await status(dut, OVERRUN) is None
    assert int(dut.data_o.value) == 1
    dut.read_i.value = 0
    assert await status(dut, EVENT) == 1
