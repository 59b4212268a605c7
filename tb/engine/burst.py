# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The burst alone: a bank, a frame and a range in Python around it."""

import random

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge, Timer
from harness.bench import PARAMETERS
from harness.steps import argument, do
from harness.unit import clocks, settle, start
from protocol.defs import BIT_SPACES, Space

NO_CODE, FAILURE, BUSY, NO_ADDRESS = 0, 4, 6, 2
COUNTERS, EVENTS = 5, 6  # spaces inside the core
LIMIT = 6000  # clocks of the longest burst here
WIDE = int(PARAMETERS.get("BITS_PER_BEAT", 1)) != 1  # sixteen bits a beat


class Tb:
    """`frame`: bytes from the cursor on, taken by a write, appended to by a read. `bank`: {item: value}.

    With WIDE a beat of bits is what the range has in a word of 16 items; the other data bits are noise.
    """

    def __init__(self, dut, waits=(0,), error_at=None, code=NO_CODE, silent_at=None):
        self.dut, self.waits, self.error_at, self.code, self.silent_at = dut, waits, error_at, code, silent_at
        self.frame, self.cursor, self.items, self.bank, self.beats = [], 0, 0, {}, []
        self.first = self.last = self.needed = self.put_before = 0
        self.wide = False
        self.random = random.Random(2)
        self.wait = 0
        self.ended = None
        cocotb.start_soon(self._around())

    async def _around(self):
        """In each clock: what the neighbours answer to the outputs; then what they do with them at the edge."""
        dut, shown, inner_at = self.dut, None, None
        while True:
            dut.at_last_i.value = self.first == self.last or (self.wide and self.first >> 4 == self.last >> 4)
            dut.first_i.value, dut.last_i.value = self.first & 15, self.last & 15
            dut.fit_i.value = self.put_before == self.needed - 1
            self.put_before = len(self.frame)
            dut.byte_i.value = self.frame[self.cursor] if self.cursor < len(self.frame) else 0
            shows = inner_at is not None and int(dut.inner_o.value)  # 0 between the bursts from inside
            dut.inner_i.value = self.bank.get(inner_at, 0xFFFF) if shows else 0
            dut.wb_ack_i.value = dut.wb_err_i.value = 0
            await Timer(1, "ns")
            stb = int(dut.wb_stb_o.value)
            if shown is not None:
                assert stb and (self.first, int(dut.wb_we_o.value)) == shown, "a beat was withdrawn or changed"
            shown = None
            if stb:
                assert int(dut.wb_cyc_o.value), "strobe without cycle"
                number = len(self.beats)
                if self.silent_at == number:
                    pass
                elif self.wait:
                    self.wait -= 1
                    shown = self.first, int(dut.wb_we_o.value)
                elif self.error_at == number:
                    dut.exception_i.value = self.code
                    dut.wb_err_i.value = 1
                else:
                    dut.wb_dat_i.value = self.shown()
                    dut.wb_ack_i.value = 1
            await ReadOnly()
            put, data, step, next_ = (int(s.value) for s in (dut.put_o, dut.data_o, dut.step_o, dut.next_o))
            done, fail, code = int(dut.done_o.value), int(dut.fail_o.value), int(dut.fail_code_o.value)
            ack, we, word = int(dut.wb_ack_i.value), int(dut.wb_we_o.value), int(dut.wb_dat_o.value)
            inner = self.first if int(dut.inner_o.value) else None
            await RisingEdge(dut.clk_i)
            inner_at = inner
            if ack and stb:
                self.beats.append((self.first, we))
                self.wait = self.waits[len(self.beats) % len(self.waits)]
                if we and self.wide:
                    self.bank |= {item: word >> (item & 15) & 1 for item in self.items_of_the_beat()}
                elif we:
                    self.bank[self.first] = word
            if next_:
                self.items += 1
                assert self.first <= self.last, f"item {self.first} past the last, {self.last}"
                self.first += 16 - self.first % 16 if self.wide else 1
            if put:
                self.frame.append(data)
            if step:
                self.cursor += 1
            if (done or fail) and self.ended is None:
                self.ended = code if fail else NO_CODE

    def items_of_the_beat(self):
        """Sixteen bits a beat: those from the first on in its word, up to the last."""
        return range(self.first, min(self.last, self.first | 15) + 1)

    def shown(self):
        """What the bank shows for the beat at hand."""
        if not self.wide:
            return self.bank.get(self.first, 0)
        word = self.random.getrandbits(16)
        for item in self.items_of_the_beat():
            word = word & ~(1 << (item & 15)) | (self.bank.get(item, 0) & 1) << (item & 15)
        return word

    async def burst(self, space, first, quantity, commands="BURST", **flags):
        """Run one burst, or with commands="GRANT" a question; the exception code it ended with, 0: done."""
        dut = self.dut
        self.first, self.last, self.ended = first, first + quantity - 1, None
        self.wide = WIDE and space in BIT_SPACES
        self.needed = (quantity + 7) // 8
        dut.space_i.value = space
        dut.argument_i.value = argument(**flags)
        dut.do_i.value = do(commands)
        for _ in range(LIMIT):
            await clocks(dut)
            await Timer(2, "ns")
            if self.ended is not None:
                dut.do_i.value = 0
                await clocks(dut, 2)
                return self.ended
        raise AssertionError("the burst does not end")


def packed(bits):
    """Bits as the standard packs them."""
    return [sum(bit << place for place, bit in enumerate(bits[at : at + 8])) for at in range(0, len(bits), 8)]


def beats(first, quantity):
    """The address of each beat of bits."""
    end = first + quantity
    return [first, *range(first // 16 * 16 + 16, end, 16)] if WIDE else list(range(first, end))


def alignments(first, quantity):
    """First addresses to try: with sixteen bits a beat every one mod 16 for some quantities, and three for all."""
    if not WIDE:
        return (first,)
    return range(first, first + 16) if quantity in (1, 2, 8, 9, 16, 17, 40) else (0, 65536 - quantity, first)


async def bench(dut, **how):
    rng = await start(dut)
    return Tb(dut, **how), rng


@cocotb.test()
@cocotb.parametrize(waits=[(0,), (3,), (0, 1, 0, 2)])
async def bits_are_read_packed_and_filled(dut, waits):
    tb, rng = await bench(dut, waits=waits)
    for quantity in (*range(1, 18), 31, 40):
        for first in alignments(100, quantity):
            bits = [rng.getrandbits(1) for _ in range(quantity)]
            tb.bank = {first + n: bit | rng.getrandbits(15) << 1 for n, bit in enumerate(bits)}
            tb.frame, tb.items, tb.beats = [], 0, []
            assert await tb.burst(Space.COILS, first, quantity) == NO_CODE
            assert tb.frame == packed(bits), f"{quantity} bits {bits} from {first} on: {tb.frame}"
            assert tb.beats == [(item, 0) for item in beats(first, quantity)]


@cocotb.test()
@cocotb.parametrize(waits=[(0,), (3,), (0, 1, 0, 2)])
async def bits_are_written_from_the_lowest(dut, waits):
    tb, rng = await bench(dut, waits=waits)
    for quantity in (*range(1, 18), 31, 40):
        for first in alignments(9, quantity):
            bits = [rng.getrandbits(1) for _ in range(quantity)]
            tb.bank, tb.frame, tb.cursor, tb.beats = {}, packed(bits), 0, []
            assert await tb.burst(Space.COILS, first, quantity, WRITE=1) == NO_CODE
            assert [tb.bank[first + n] & 1 for n in range(quantity)] == bits, f"{quantity} bits from {first} on"
            assert tb.beats == [(item, 1) for item in beats(first, quantity)], "each bit once, none past the last"
            # what has left the frame behind the last byte is not used
            assert tb.cursor == (quantity + 7) // 8 or (WIDE and tb.cursor >= (quantity + 7) // 8)


@cocotb.test()
@cocotb.parametrize(waits=[(0,), (3,), (0, 1, 0, 2)])
async def registers_go_high_byte_first(dut, waits):
    tb, rng = await bench(dut, waits=waits)
    for quantity in (1, 2, 3, 17):
        words = [rng.getrandbits(16) for _ in range(quantity)]
        data = [byte for word in words for byte in (word >> 8, word & 0xFF)]
        tb.bank, tb.frame, tb.cursor, tb.beats = {}, [*data, 0xAA], 0, []
        assert await tb.burst(Space.HOLDINGS, 65536 - quantity, quantity, WRITE=1) == NO_CODE
        assert [tb.bank[65536 - quantity + n] for n in range(quantity)] == words
        assert tb.cursor == 2 * quantity
        tb.frame, tb.beats = [], []
        assert await tb.burst(Space.HOLDINGS, 65536 - quantity, quantity) == NO_CODE
        assert tb.frame == data
        assert tb.beats == [(65536 - quantity + n, 0) for n in range(quantity)]


@cocotb.test()
@cocotb.parametrize(code=[0, 1, 6, 10], write=[0, 1])
async def an_error_ends_the_burst(dut, code, write):
    tb, _ = await bench(dut, error_at=2, code=code)
    tb.frame = list(range(20))
    assert await tb.burst(Space.HOLDINGS, 0, 5, WRITE=write) == (code or FAILURE)
    assert len(tb.beats) == 2 and not int(dut.wb_cyc_o.value)


@cocotb.test()
@cocotb.parametrize(write=[0, 1])
async def a_silent_bank_is_given_up(dut, write):
    tb, _ = await bench(dut, silent_at=1)
    tb.frame = list(range(20))
    dut.space_i.value = Space.HOLDINGS

    async def stall():
        while len(tb.beats) < 1:
            await clocks(dut)
        await clocks(dut, 40)
        assert int(dut.wb_stb_o.value) and int(dut.waiting_o.value), "waits for the bank"
        dut.stall_i.value = 1

    task = cocotb.start_soon(stall())
    assert await tb.burst(Space.HOLDINGS, 0, 3, WRITE=write) == FAILURE
    await task
    assert not int(dut.wb_cyc_o.value) and not int(dut.waiting_o.value)


@cocotb.test()
async def the_bus_is_kept_until_it_is_released(dut):
    tb, _ = await bench(dut)
    assert await tb.burst(Space.HOLDINGS, 0, 2, KEEP=1) == NO_CODE
    assert int(dut.wb_cyc_o.value)
    assert await tb.burst(Space.HOLDINGS, 7, 1) == NO_CODE
    assert not int(dut.wb_cyc_o.value), "the last burst lets go"
    assert await tb.burst(Space.HOLDINGS, 0, 2, KEEP=1) == NO_CODE
    dut.do_i.value = do("RELEASE")
    await clocks(dut)
    dut.do_i.value = 0
    await settle()
    assert not int(dut.wb_cyc_o.value)


@cocotb.test()
async def a_dry_burst_only_passes_over_the_frame(dut):
    tb, _ = await bench(dut)
    tb.frame = list(range(40))
    assert await tb.burst(Space.FILES, 5, 9, WRITE=1, DRY=1) == NO_CODE
    assert tb.cursor == 18 and not tb.beats


@cocotb.test()
@cocotb.parametrize(space=[COUNTERS, EVENTS])
async def memories_inside_are_read_without_the_bus(dut, space):
    tb, rng = await bench(dut)
    tb.bank = {n: rng.getrandbits(16 if space == COUNTERS else 8) for n in range(10, 15)}
    assert await tb.burst(space, 10, 5) == NO_CODE
    expected = [byte for n in range(10, 15) for byte in (tb.bank[n] >> 8, tb.bank[n] & 0xFF)]
    assert tb.frame == (expected if space == COUNTERS else expected[1::2])
    assert not tb.beats


@cocotb.test()
async def a_question_is_granted_or_refused(dut):
    tb, _ = await bench(dut)
    for code, clocks_later in ((0, 0), (0, 5), (2, 0), (8, 3)):

        async def bank(code=code, later=clocks_later):
            while not int(dut.grant_req_o.value):
                await clocks(dut)
                await settle()
            await clocks(dut, later)
            dut.grant_ack_i.value, dut.exception_i.value = 1, code
            await clocks(dut)
            dut.grant_ack_i.value, dut.exception_i.value = 0, 0

        task = cocotb.start_soon(bank())
        assert await tb.burst(Space.HOLDINGS, 0, 3, "GRANT") == code
        await task
    assert not tb.beats


@cocotb.test()
async def a_range_past_its_end_is_not_asked_for(dut):
    tb, _ = await bench(dut)
    dut.past_end_i.value = 1
    dut.grant_ack_i.value = 0
    asked = []

    async def watch():
        while True:
            await RisingEdge(dut.clk_i)
            asked.append(int(dut.grant_req_o.value))

    cocotb.start_soon(watch())
    assert await tb.burst(Space.HOLDINGS, 65535, 2, "GRANT") == NO_ADDRESS
    assert not any(asked)


@cocotb.test()
async def a_question_without_an_answer_is_withdrawn(dut):
    tb, _ = await bench(dut)

    async def stall():
        await clocks(dut, 30)
        assert int(dut.grant_req_o.value) and int(dut.waiting_o.value)
        dut.stall_i.value = 1

    cocotb.start_soon(stall())
    assert await tb.burst(Space.HOLDINGS, 0, 2, "GRANT") == BUSY


@cocotb.test()
async def held_byte_is_loaded_in_each_way(dut):
    await start(dut)
    held = 0
    for commands, fields, byte, expected in (
        ("HOLD", {}, 0x3C, lambda held: 0x3C),
        ("LOAD", {"WHAT": 0, "MARK": 1}, 0x11, lambda held: 0x91),
        ("LOAD", {"WHAT": 1}, 0xF0, lambda held: held ^ 0xF0),
        ("LOAD", {"WHAT": 2}, 0x6F, lambda held: held & 0x6F),
        ("STATUS", {}, 0x99, lambda held: 0xA5),
        ("LITERAL", {"LITERAL": 0x42}, 0x99, lambda held: 0x42),
    ):
        dut.byte_i.value, dut.status_i.value = byte, 0xA5
        dut.argument_i.value = argument(**fields)
        await clocks(dut)
        dut.byte_i.value = byte ^ 0xFF  # seen a clock later
        dut.do_i.value = do(commands)
        await clocks(dut)
        dut.do_i.value = 0
        await clocks(dut, commands in ("STATUS", "LITERAL"))
        await settle()
        held = expected(held)
        assert int(dut.held_o.value) == held, f"{commands} {fields}: {int(dut.held_o.value):02X}, expected {held:02X}"
