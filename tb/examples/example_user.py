# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_example_user: its three functions, its lengths, what it passes on, and requests withdrawn at any clock."""

import struct

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, start
from protocol.defs import EX

from examples.user_port import UserPort

OWN = 17
ADD, WORK, REVERSE = 0x41, 0x42, 0x64
WAIT, LEAVE = 0, 1
WORK_CLOCKS = PARAMETERS["WORK_CLOCKS"]
MOST_DATA = 252
OVERHEAD = 20  # clocks beside the job


class Bench:
    """The module on its port, and the number of jobs it must have done."""

    @classmethod
    async def start(cls, dut):
        self = cls()
        self.dut, self.rng = dut, await start(dut)
        self.port = UserPort(dut, self.rng)
        self.jobs = 0
        return self

    async def ask(self, code, data=b""):
        """The Verdict on a request with this data."""
        verdict = await self.port.offer(bytes([OWN, code]) + data)
        await self.port.rest(self.rng.randrange(1, 4))
        return verdict

    async def refuses(self, code, data, exception):
        verdict = await self.ask(code, data)
        assert (verdict.exception, verdict.passed) == (exception, False), f"{code:02X} {data.hex(' ')}: {verdict}"

    async def answers(self, code, data, expected):
        verdict = await self.ask(code, data)
        seen = (verdict.data, verdict.exception, verdict.passed)
        assert seen == (expected, 0, False), f"{code:02X} {data.hex(' ')}: {verdict}, expected {expected.hex(' ')}"
        return verdict

    async def adds(self, a, b):
        await self.answers(ADD, struct.pack(">HH", a, b), struct.pack(">I", a + b))

    async def job_is_told(self, mode):
        self.jobs += 1
        return await self.answers(WORK, bytes([mode]), struct.pack(">H", self.jobs))


@cocotb.test()
async def adds_two_words(dut):
    tb = await Bench.start(dut)
    for a, b in ((0, 0), (0xFFFF, 0xFFFF), (0xFFFF, 1), (1, 0xFFFF), (0x1234, 0x0102)):
        await tb.adds(a, b)
    for _ in range(30):
        await tb.adds(tb.rng.randrange(65536), tb.rng.randrange(65536))


@cocotb.test()
async def reverses_any_length(dut):
    tb = await Bench.start(dut)
    for length in (1, 2, 3, 17, MOST_DATA - 1, MOST_DATA):
        data = tb.rng.randbytes(length)
        verdict = await tb.answers(REVERSE, data, data[::-1])
        assert verdict.clocks <= 2 * length + OVERHEAD, f"{verdict.clocks} clocks for {length} bytes"


@cocotb.test()
async def wrong_lengths_are_exception_03(dut):
    tb = await Bench.start(dut)
    for code, right in ((ADD, (4,)), (WORK, (1,)), (REVERSE, range(1, MOST_DATA + 1))):
        for length in (0, 1, 2, 3, 4, 5, 6, MOST_DATA):
            if length not in right:
                await tb.refuses(code, bytes(length), EX.VALUE)
    for mode in range(2, 256):
        await tb.refuses(WORK, bytes([mode]), EX.VALUE)
    assert not int(dut.working.value), "a refused request has started a job"


@cocotb.test()
async def all_others_are_passed_on(dut):
    tb = await Bench.start(dut)
    for code in range(256):
        if code not in (ADD, WORK, REVERSE):
            verdict = await tb.ask(code, tb.rng.randbytes(tb.rng.randrange(6)))
            assert verdict.passed, f"{code:02X}: {verdict}"
            assert not verdict.data, f"{code:02X}: passed on with {verdict.data.hex(' ')}"


@cocotb.test()
async def a_job_may_be_waited_for(dut):
    tb = await Bench.start(dut)
    for _ in range(3):
        verdict = await tb.job_is_told(WAIT)
        assert WORK_CLOCKS <= verdict.clocks <= WORK_CLOCKS + OVERHEAD, f"answered after {verdict.clocks} clocks"


@cocotb.test()
async def a_job_may_be_left_and_fetched(dut):
    tb = await Bench.start(dut)
    for fetch in (WAIT, LEAVE, LEAVE):
        await tb.refuses(WORK, bytes([LEAVE]), EX.ACKNOWLEDGE)
        await tb.refuses(WORK, bytes([LEAVE]), EX.BUSY)
        await tb.adds(3, 4)  # other functions go on
        await tb.refuses(WORK, bytes([LEAVE]), EX.BUSY)
        if fetch == LEAVE:
            await tb.port.rest(WORK_CLOCKS)
            await tb.adds(5, 6)  # and do not take the result
        verdict = await tb.job_is_told(fetch)
        assert fetch == WAIT or verdict.clocks <= OVERHEAD, "a finished job was waited for"


@cocotb.test()
async def a_job_outlives_a_withdrawn_request(dut):
    """The stall limit ends the request, not the work; the next one is told of it."""
    tb = await Bench.start(dut)
    for _ in range(3):
        assert await tb.port.offer(bytes([OWN, WORK, WAIT]), withdraw=WORK_CLOCKS // 2) is None
        await tb.port.rest(WORK_CLOCKS)
        verdict = await tb.job_is_told(LEAVE)
        assert verdict.clocks <= OVERHEAD


@cocotb.test()
async def a_request_may_be_withdrawn_at_any_clock(dut):
    """Whatever it was in the middle of, the next request finds it whole."""
    tb = await Bench.start(dut)
    for request in (bytes([OWN, ADD, 1, 2, 3, 4]), bytes([OWN, REVERSE, 1, 2, 3, 4, 5, 6]), bytes([OWN, 7, 1])):
        whole = (await tb.port.offer(request)).clocks
        for clock in range(whole + 1):
            await tb.port.rest(1)
            assert await tb.port.offer(request, withdraw=clock) is None
            await tb.port.rest(tb.rng.randrange(1, 3))
            await tb.adds(tb.rng.randrange(65536), tb.rng.randrange(65536))


@cocotb.test()
async def a_withdrawn_request_starts_nothing(dut):
    """Unless its answer was already sure."""
    tb = await Bench.start(dut)
    request = bytes([OWN, WORK, LEAVE])
    whole = (await tb.ask(WORK, bytes([LEAVE]))).clocks
    await tb.job_is_told(WAIT)
    for clock in range(whole):
        assert await tb.port.offer(request, withdraw=clock) is None
        await tb.port.rest(1)
        assert not int(dut.working.value), f"withdrawn after {clock} clocks of {whole}, and a job has started"
    assert await tb.port.offer(request, withdraw=whole) is None
    await tb.port.rest(1)
    await tb.job_is_told(WAIT)


@cocotb.test()
async def a_result_is_told_once(dut):
    """Not before the answer counts: a request that is withdrawn leaves it to the next."""
    tb = await Bench.start(dut)
    request = bytes([OWN, WORK, LEAVE])
    await tb.refuses(WORK, bytes([LEAVE]), EX.ACKNOWLEDGE)
    await tb.port.rest(WORK_CLOCKS)
    whole = (await tb.job_is_told(LEAVE)).clocks
    for clock in range(whole + 1):
        await tb.refuses(WORK, bytes([LEAVE]), EX.ACKNOWLEDGE)
        await tb.port.rest(WORK_CLOCKS)
        assert await tb.port.offer(request, withdraw=clock) is None
        await tb.port.rest(1)
        await tb.job_is_told(LEAVE)


@cocotb.test()
async def reset_forgets(dut):
    tb = await Bench.start(dut)
    await tb.job_is_told(WAIT)
    for rest in (0, WORK_CLOCKS):  # a job on its way, a result that nobody has fetched
        await tb.refuses(WORK, bytes([LEAVE]), EX.ACKNOWLEDGE)
        await tb.port.rest(rest)
        dut.rst_i.value = 1
        await clocks(dut, 2)
        dut.rst_i.value = 0
        tb.jobs = 0
        await tb.port.rest(WORK_CLOCKS)
        await tb.refuses(WORK, bytes([LEAVE]), EX.ACKNOWLEDGE)
        await tb.job_is_told(WAIT)
        await tb.adds(1, 1)
