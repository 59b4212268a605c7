# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Bank guard: what exists and what may be written, at every edge and at random, against the model."""

import cocotb
from harness.bench import PARAMETERS
from harness.build import model_config
from harness.unit import clocks, settle, start
from protocol.defs import BIT_SPACES, EX, Space
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
        assert not int(dut.exception_o.value), "an exception before the verdict"
        await clocks(dut)
    else:
        raise AssertionError("no verdict")
    await clocks(dut)
    dut.req_i.value = 0
    await settle()
    assert not int(dut.exception_o.value), "an exception behind the verdict"
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
async def limits_are_exact(dut):
    """Each end of each table and of the read-only range at N - 1, N and N + 1, ranges of one and of two items."""
    await start(dut)
    slave = Slave(model_config("modbus_rtu_slave", PARAMETERS))
    read_only, count_of_cases = slave.config.read_only, 0
    for space in list(Space)[:4]:
        base, count = slave.config.tables.get(space, (0, 0))
        ends = [base, base + count]
        if space == Space.HOLDINGS or slave.config.overlay:
            step = 16 if slave.config.overlay and space in BIT_SPACES else 1
            ends += [read_only[0] * step, sum(read_only) * step]
        for first in sorted({end + offset for end in ends for offset in (-2, -1, 0, 1)}):
            for last in (first, first + 1):
                if not 0 <= first <= last <= 65535:
                    continue
                for write in {0, int(space in (Space.COILS, Space.HOLDINGS))}:
                    code = await verdict(dut, space, first, last, write)
                    wanted = expected(slave, space, first, last, write)
                    assert code == wanted, f"{space.name} {first}..{last} write {write}: expected {wanted}, seen {code}"
                    count_of_cases += 1
    assert count_of_cases > 30


@cocotb.test()
async def other_user_and_wait(dut):
    """While other_i is high nothing is answered; while wait_i is high a refusal is, a grant is not."""
    await start(dut)
    slave = Slave(model_config("modbus_rtu_slave", PARAMETERS))
    base, count = slave.config.tables[Space.HOLDINGS]
    inside, outside = base, base + count
    dut.space_i.value, dut.req_i.value = int(Space.HOLDINGS), 1
    for item, exists in ((inside, True), (outside, False)):
        if item > 65535:
            continue
        dut.first_i.value = dut.last_i.value = item
        for other, wait in ((1, 0), (1, 1), (0, 1)):
            dut.req_i.value, dut.other_i.value, dut.wait_i.value = 1, other, wait
            await clocks(dut, 2)
            answered = []
            for _ in range(6):
                await settle()
                assert int(dut.refused_o.value) == (not exists)
                answered.append(int(dut.ack_o.value))
                if answered[-1]:
                    assert int(dut.exception_o.value) == EX.ADDRESS
                await clocks(dut)
            assert any(answered) == (not other and not exists), f"item {item}, other {other}, wait {wait}: {answered}"
            dut.req_i.value = 0
            await clocks(dut, 2)
        dut.other_i.value = dut.wait_i.value = 0
        assert await verdict(dut, Space.HOLDINGS, item, item, 0) == (0 if exists else EX.ADDRESS)
