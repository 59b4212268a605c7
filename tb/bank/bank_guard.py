# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Bank guard: what exists and what may be written, at every edge and at random, against the model."""

import cocotb
from harness.bench import PARAMETERS
from harness.build import model_config
from harness.unit import clocks, settle, start
from protocol.defs import EX, Space
from protocol.model import Refused, Slave

PATIENCE = 20


async def verdict(dut, space, first, last, write):
    """The bank's exception code."""
    dut.space_i.value, dut.first_i.value, dut.last_i.value = int(space), first, last
    dut.write_i.value, dut.req_i.value = write, 1
    for _ in range(PATIENCE):
        await settle()
        if int(dut.ack_o.value):
            code = int(dut.exception_o.value)
            break
        await clocks(dut)
    else:
        raise AssertionError("no verdict")
    await clocks(dut)
    dut.req_i.value = 0
    await clocks(dut)
    return code


def expected(slave, space, first, last, write):
    """What the model says."""
    if space > Space.HOLDINGS:
        return EX.ADDRESS
    try:
        slave._grant(Space(space), first, last - first + 1, bool(write))
    except Refused as refusal:
        return refusal.code
    return 0


@cocotb.test()
async def edges_and_random_ranges(dut):
    rng = await start(dut)
    slave = Slave(model_config("modbus_rtu_slave", PARAMETERS))
    read_only = slave.config.read_only
    for lock in (0, 1):
        dut.write_lock_i.value = slave.write_lock = lock
        for number in range(600):
            space = rng.choice((0, 1, 2, 3, 3, 3, rng.randrange(8)))
            base, count = slave.config.tables.get(space, (0, 0))
            ends = [base, base + count, read_only[0], sum(read_only), 0, 65535, rng.randrange(65536)]
            first = min(max(rng.choice(ends) + rng.randint(-2, 2), 0), 65535)
            last = min(max(rng.choice((first, first + 1, rng.choice(ends) + rng.randint(-2, 2))), first), 65535)
            write = int(space in (Space.COILS, Space.HOLDINGS)) and rng.getrandbits(1)
            code = await verdict(dut, space, first, last, write)
            wanted = expected(slave, space, first, last, write)
            question = f"{number}: space {space}, {first}..{last}, write {write}, lock {lock}"
            assert code == wanted, f"{question}: expected {wanted}, seen {code}"


@cocotb.test()
async def held_back_while_told(dut):
    """With hold_i the question waits."""
    await start(dut, hold=1)
    dut.space_i.value, dut.req_i.value = int(Space.HOLDINGS), 1
    for _ in range(30):
        await clocks(dut)
        await settle()
        assert not int(dut.ack_o.value)
    dut.hold_i.value = 0
    for _ in range(PATIENCE):
        await clocks(dut)
        await settle()
        if int(dut.ack_o.value):
            return
    raise AssertionError("no verdict after hold_i fell")
