# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_pdm_record: which requests are its own, the record's bytes, their order, and what is lost when."""

import dataclasses

import cocotb
from harness.bench import PARAMETERS
from harness.unit import clocks, settle, start
from protocol import frames, vectors
from protocol.defs import EX, FC
from protocol.pdm import LAST_NUMBER, RECORD_BYTES, RECORD_REGISTER, Event, EventRecords

from examples.user_port import MOST_LINGER, UserPort

OWN = 17
DEPTH = PARAMETERS["DEPTH"]
ASK = frames.read(FC.READ_HOLDINGS, RECORD_REGISTER, 1)
STORE_CLOCKS, ANSWER_CLOCKS, PASS_CLOCKS = 12, 23, 10
PATIENCE = 100


class Bench:
    """The module between an event source and its port, with the model beside it."""

    @classmethod
    async def start(cls, dut):
        self = cls()
        self.dut, self.rng = dut, await start(dut)
        self.port, self.records = UserPort(dut, self.rng), EventRecords(DEPTH)
        await self.port.rest(1)
        return self

    async def event(self, event=None):
        """Report an event, a random one by default; clocks from strobe to acknowledge."""
        dut, event = self.dut, event or Event.random(self.rng)
        for field in dataclasses.fields(event):
            getattr(dut, f"event_{field.name}_i").value = int(getattr(event, field.name))
        dut.event_stb_i.value = 1
        for clock in range(PATIENCE):
            await settle()
            taken = int(dut.event_ack_o.value)
            await clocks(dut)
            if taken:
                dut.event_stb_i.value = 0
                self.records.add(event)
                return clock
        raise AssertionError(f"event not taken after {PATIENCE} clocks")

    async def ask(self, pdu=ASK):
        """The Verdict on a request PDU."""
        verdict = await self.port.offer(bytes([OWN]) + pdu)
        await self.port.rest(1)
        return verdict

    async def reads(self, note=""):
        """One read; it must be the record that the model gives."""
        expected = bytes([RECORD_BYTES]) + self.records.read()
        verdict = await self.ask()
        seen = (verdict.data, verdict.exception, verdict.passed)
        assert seen == (expected, 0, False), f"{note}: {verdict}, expected {expected.hex(' ')}"
        return verdict


@cocotb.test()
async def printed_record(dut):
    tb = await Bench.start(dut)
    (case,) = [v for v in vectors.document()["vectors"] if v["id"] == "S003-3.7-PDM"]
    record = bytes(case["preconditions"][0]["values"])
    number, event = Event.of_record(record)
    assert number == 1 and event.record(number) == record
    await tb.event(event)
    verdict = await tb.port.offer(vectors.frame(case["request"])[:-2])
    assert bytes([FC.READ_HOLDINGS]) + verdict.data == vectors.frame(case["expected_response_pdu"])


@cocotb.test()
async def nothing_has_happened_yet(dut):
    tb = await Bench.start(dut)
    for _ in range(2):
        assert (await tb.reads()).data == bytes([RECORD_BYTES]) + bytes(RECORD_BYTES)


@cocotb.test()
async def oldest_first_and_the_last_one_again(dut):
    tb = await Bench.start(dut)
    for count in (1, 2, DEPTH, DEPTH - 1, 3 * DEPTH):
        for _ in range(min(count, DEPTH)):
            await tb.event()
        for place in range(min(count, DEPTH) + 2):
            await tb.reads(f"read {place} of {count}")


@cocotb.test()
async def too_many_drop_the_oldest(dut):
    tb = await Bench.start(dut)
    for more in (1, 2, DEPTH, DEPTH + 1):
        for _ in range(DEPTH + more):
            await tb.event()
        first = tb.records.number - DEPTH + 1
        for place in range(DEPTH + 1):
            verdict = await tb.reads(f"read {place}, {more} too many")
            if place == 0:
                assert int.from_bytes(verdict.data[1:3], "big") == first, "the gap in the numbers is wrong"


@cocotb.test()
async def any_order_of_events_and_reads(dut):
    tb = await Bench.start(dut)
    for _ in range(400):
        await (tb.event() if tb.rng.random() < 0.55 else tb.reads())


@cocotb.test()
async def an_event_during_a_read_waits(dut):
    """Neither tears the other's record, whichever comes first and whenever."""
    tb = await Bench.start(dut)
    await tb.event()
    for delay in range(ANSWER_CLOCKS + 8):

        async def later(wait=delay):
            await clocks(dut, wait)
            return await tb.event()

        waiting = cocotb.start_soon(later())
        expected = tb.records.read()
        verdict = await tb.port.offer(bytes([OWN]) + ASK)
        taken = await waiting
        assert verdict.data[1:] == expected, f"event after {delay} clocks: {verdict}, expected {expected.hex(' ')}"
        assert taken <= ANSWER_CLOCKS + MOST_LINGER + STORE_CLOCKS + 4, f"the event waited {taken} clocks"
        await tb.port.rest(1)
    await tb.reads()


@cocotb.test()
async def times_are_as_told(dut):
    tb = await Bench.start(dut)
    assert await tb.event() == STORE_CLOCKS
    verdict = await tb.reads()
    assert verdict.clocks == ANSWER_CLOCKS, f"answered in {verdict.clocks} clocks"
    for pdu, told in ((frames.read(FC.READ_HOLDINGS, 0x0116, 3), 4), (ASK[:-1] + b"\2", PASS_CLOCKS)):
        verdict = await tb.ask(pdu)
        assert verdict.passed and verdict.clocks == told, f"{verdict} after {verdict.clocks} clocks"


@cocotb.test()
async def everything_else_is_passed_on(dut):
    tb = await Bench.start(dut)
    await tb.event()
    others = [ASK[:place] + bytes([ASK[place] ^ 1 << bit]) + ASK[place + 1 :] for place in range(5) for bit in range(8)]
    others += [ASK[:length] for length in range(1, 5)] + [ASK + b"\0", ASK + ASK]
    others += [frames.read(FC.READ_HOLDINGS, RECORD_REGISTER, 0), frames.write_register(RECORD_REGISTER, 1)]
    for pdu in others:
        verdict = await tb.ask(pdu)
        assert verdict.passed and not verdict.data, f"{pdu.hex(' ')}: {verdict}"
    await tb.reads("after requests for others")


@cocotb.test()
async def busy_and_failure_go_first(dut):
    tb = await Bench.start(dut)
    await tb.event()
    await tb.event()
    for busy, failure, code in ((1, 0, EX.BUSY), (0, 4, EX.FAILURE), (1, 4, EX.BUSY), (0, 0xB, 0xB)):
        dut.busy_i.value, dut.failure_i.value = busy, failure
        verdict = await tb.ask()
        assert (verdict.exception, verdict.data) == (code, b""), f"busy {busy}, failure {failure}: {verdict}"
        verdict = await tb.ask(frames.read(FC.READ_HOLDINGS, 2, 1))
        assert verdict.passed, f"busy {busy}, failure {failure}, not its own: {verdict}"
    dut.busy_i.value = dut.failure_i.value = 0
    await tb.reads("after refusals")
    await tb.reads("after refusals")


@cocotb.test()
async def a_withdrawn_read_takes_nothing(dut):
    tb = await Bench.start(dut)
    await tb.event()
    whole = (await tb.reads()).clocks
    for clock in range(whole + 1):
        for _ in range(2):
            await tb.event()
        assert await tb.port.offer(bytes([OWN]) + ASK, withdraw=clock) is None
        await tb.port.rest(tb.rng.randrange(1, 3))
        for _ in range(2):
            await tb.reads(f"withdrawn after {clock} clocks")


@cocotb.test()
async def numbers_go_round(dut):
    tb = await Bench.start(dut)
    await tb.event()
    await tb.reads()
    dut.number_q.value = tb.records.number = LAST_NUMBER - 2
    for number in (LAST_NUMBER - 1, LAST_NUMBER, 1, 2):
        await tb.event()
        verdict = await tb.reads()
        assert int.from_bytes(verdict.data[1:3], "big") == number


@cocotb.test()
async def reset_forgets(dut):
    tb = await Bench.start(dut)
    for _ in range(DEPTH + 3):
        await tb.event()
    await tb.reads()
    dut.rst_i.value = 1
    await clocks(dut, 2)
    dut.rst_i.value = 0
    tb.records.reset()
    await tb.port.rest(1)
    await tb.reads("after reset")
    await tb.event()
    await tb.reads("first after reset")
