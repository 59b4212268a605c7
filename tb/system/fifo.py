# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Read FIFO queue, function code 18: counts, both ends of the table, order of exceptions."""

import cocotb
from harness.bench import Bench
from protocol import frames
from protocol.defs import BROADCAST, EX, FC, FIFO_MOST, Space

OWN = 17


def span(tb):
    """(first, last) holding register."""
    base, count = tb.slave.config.tables[Space.HOLDINGS]
    return base, base + count - 1


async def ask(tb, pdu, note=""):
    """The answer PDU to a unicast request, checked against the model."""
    return (await tb.both(frames.adu(OWN, pdu), note=note))[1:-2]


async def queue(tb, pointer, count, words=None):
    """A queue at `pointer`, as far as the table goes."""
    words = [tb.rng.getrandbits(16) for _ in range(count)] if words is None else words
    for place, word in enumerate([count, *words]):
        if pointer + place <= span(tb)[1]:
            await tb.preset((Space.HOLDINGS, pointer + place), word)
    return words


def whole(words):
    """The answer PDU with these entries."""
    return bytes([FC.READ_FIFO]) + frames.pack_words([2 + 2 * len(words), len(words), *words])


def refusal(code):
    """The exception answer PDU."""
    return bytes([FC.READ_FIFO | 0x80, code])


@cocotb.test()
async def counts_up_to_31(dut):
    tb = await Bench.start(dut)
    first, last = span(tb)
    for pointer in (first, last - FIFO_MOST):
        for count in (0, 1, 2, FIFO_MOST - 1, FIFO_MOST):
            words = await queue(tb, pointer, count)
            assert await ask(tb, frames.read_fifo(pointer)) == whole(words), f"{count} at {pointer}"
            assert await ask(tb, frames.read_fifo(pointer)) == whole(words), "reading takes nothing away"
    for count in (FIFO_MOST + 1, FIFO_MOST + 2, 0x003F, 0x0100, 0x011F, 0x8000, 0xFFFF):
        await tb.preset((Space.HOLDINGS, first), count)
        assert await ask(tb, frames.read_fifo(first)) == refusal(EX.VALUE), f"count {count:04X}"
    await tb.finish()


@cocotb.test()
async def queue_at_the_end_of_the_table(dut):
    """The count must exist, then be right, then all its entries must exist."""
    tb = await Bench.start(dut)
    first, last = span(tb)
    for left in (0, 1, 2, FIFO_MOST - 1):
        pointer = last - left
        words = await queue(tb, pointer, left)
        assert await ask(tb, frames.read_fifo(pointer)) == whole(words)
        await tb.preset((Space.HOLDINGS, pointer), left + 1)
        assert await ask(tb, frames.read_fifo(pointer)) == refusal(EX.ADDRESS)
        await tb.preset((Space.HOLDINGS, pointer), FIFO_MOST + 1)
        assert await ask(tb, frames.read_fifo(pointer)) == refusal(EX.VALUE), "the count is judged first"
    for pointer in {last + 1, first - 1, 0xFFFF, 0x8000} - set(range(first, last + 1)):
        if pointer in range(0x10000):
            assert await ask(tb, frames.read_fifo(pointer)) == refusal(EX.ADDRESS)
    await tb.finish()


@cocotb.test()
async def count_may_change_between_requests(dut):
    """The host fills and empties the queue, and so does the master."""
    tb = await Bench.start(dut)
    pointer = span(tb)[0] + 3
    words = await queue(tb, pointer, FIFO_MOST)
    for count in (5, 0, FIFO_MOST, FIFO_MOST + 1, 1):
        await tb.preset((Space.HOLDINGS, pointer), count)
        answer = await ask(tb, frames.read_fifo(pointer))
        assert answer == (whole(words[:count]) if count <= FIFO_MOST else refusal(EX.VALUE))
    await ask(tb, frames.write_registers(pointer, [2, 0xCAFE, 0xF00D]))
    assert await ask(tb, frames.read_fifo(pointer)) == whole([0xCAFE, 0xF00D])
    await tb.finish()


@cocotb.test()
async def exceptions_come_in_order(dut):
    """Length, then pointer, count and end of the queue, then busy and failure."""
    tb = await Bench.start(dut)
    first, last = span(tb)
    await queue(tb, first, 2)
    right = frames.read_fifo(first)
    for setup, code in (({"failure": EX.NAK}, EX.NAK), ({"busy": 1}, EX.BUSY)):
        tb.apply(**setup)
        for pdu in (right + b"\0", right[:2], right[:1], frames.read_fifo(last + 1 & 0xFFFF) + b"\0"):
            assert await ask(tb, pdu) == refusal(EX.VALUE)
        if last < 0xFFFF:
            assert await ask(tb, frames.read_fifo(last + 1)) == refusal(EX.ADDRESS)
        await tb.preset((Space.HOLDINGS, last), 1)
        assert await ask(tb, frames.read_fifo(last)) == refusal(EX.ADDRESS)
        await tb.preset((Space.HOLDINGS, last), FIFO_MOST + 1)
        assert await ask(tb, frames.read_fifo(last)) == refusal(EX.VALUE)
        assert await ask(tb, right) == refusal(code)
    tb.apply(busy=0, failure=0, write_lock=1)
    assert (await ask(tb, right))[0] == FC.READ_FIFO
    assert await tb.both(frames.adu(BROADCAST, right)) is None
    await tb.finish()
