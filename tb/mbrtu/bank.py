# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A register bank in Python on the grant and Wishbone ports of modbus_rtu_core, which also judges.

It answers from the model's tables but holds its own memory, waits as told, refuses, errs or falls
silent, and raises `BusError` facts in `faults` when the core breaks a promise: no grant question
without a good frame, no access outside what was granted, no write without a grant for writing, every
item once and in ascending order, one cyc for a burst.
"""

from dataclasses import dataclass, field

import cocotb
from cocotb.triggers import First, RisingEdge, Timer

from .defs import ADDRESSES, BIT_SPACES, EX, SPACE_SHIFT, Space

SETTLE_PS = 1_000  # after a clock edge the outputs of the core are read, then answered


@dataclass
class Manner:
    """How the bank behaves. Waits are in clock cycles; 0 answers in the same cycle."""

    grant_wait: object = 0  # number, or a callable giving one
    beat_wait: object = 0
    refuse: int = 0  # exception code instead of a grant
    refuse_second: int = 0  # the same, for the second question of a request
    silent_grant: bool = False
    silent_beat: int | None = None  # number of the beat in a request that is never answered
    error_beat: int | None = None  # number of the beat answered with err
    error_code: int = 0


@dataclass
class Request:
    """What one request did on the bus."""

    questions: list = field(default_factory=list)  # (space, first, last, write)
    beats: list = field(default_factory=list)  # (write, space, item, data)
    bursts: int = 0  # times cyc rose


def _waits(value):
    return value() if callable(value) else value


class Bank:
    """Bank and bus monitor of a Bench whose device is modbus_rtu_core."""

    def __init__(self, tb):
        self.tb, self.dut = tb, tb.dut
        self.manner, self.request = Manner(), Request()
        self.memory, self.faults = {}, []
        self._granted, self._good_frames = [], 0
        for port in ("grant_ack_i", "exception_i", "wb_ack_i", "wb_err_i", "wb_dat_i"):
            getattr(self.dut, port).value = 0
        cocotb.start_soon(self._count_frames())
        cocotb.start_soon(self._run())

    async def _count_frames(self):
        while True:
            await RisingEdge(self.dut.frame_stb_o)
            self._good_frames += 1

    def begin(self, **manner):
        """Forget the last request; the next one meets a bank with this manner."""
        self.manner, self.request, self._granted = Manner(**manner), Request(), []
        self._beat = 0

    _beat = 0

    def _fault(self, text):
        if len(self.faults) < 10:
            self.faults.append(text)

    def check(self):
        """Raises AssertionError with every promise that was broken."""
        assert not self.faults, "; ".join(self.faults)

    def _verdict(self, space, first, last):
        manner = self.manner
        code = manner.refuse if not self.request.questions else manner.refuse_second
        base, count = self.tb.slave.config.tables[space]
        if first < base or last >= base + count:
            return EX.ADDRESS
        return code

    async def _run(self):
        dut = self.dut
        asked = strobed = held = None
        cyc_before = 0
        while True:
            if asked is None and not cyc_before and not int(dut.grant_req_o.value):
                # At rest: nothing to look at each clock.
                await First(*(RisingEdge(port) for port in (dut.grant_req_o, dut.wb_cyc_o, dut.wb_stb_o)))
            else:
                await RisingEdge(dut.clk_i)
            await Timer(SETTLE_PS, "ps")
            # ---- the question
            if int(dut.grant_req_o.value):
                question = tuple(
                    int(getattr(dut, f"grant_{name}_o").value) for name in ("space", "first", "last", "write")
                )
                if asked is None:
                    asked, held = _waits(self.manner.grant_wait), question
                    if not self._good_frames:
                        self._fault(f"question {question} without a good frame")
                if question != held:
                    self._fault(f"question changed from {held} to {question}")
                ready = asked == 0 and not self.manner.silent_grant
                dut.grant_ack_i.value = int(ready)
                if ready:
                    code = self._verdict(*question[:3])
                    dut.exception_i.value = int(code)
                    self.request.questions.append(question)
                    if not code:
                        self._granted.append(question)
                    asked = None
                else:
                    asked = max(asked - 1, 0)
            else:
                asked = None
                dut.grant_ack_i.value = 0
            # ---- the burst
            cyc, stb = int(dut.wb_cyc_o.value), int(dut.wb_stb_o.value)
            if stb and not cyc:
                self._fault("stb without cyc")
            if cyc and not cyc_before:
                self.request.bursts += 1
                if not self._granted:
                    self._fault("cyc without a grant")
            cyc_before = cyc
            ack = err = 0
            if cyc and stb:
                if strobed is None:
                    strobed = _waits(self.manner.beat_wait)
                if strobed == 0 and self._beat != self.manner.silent_beat:
                    err = int(self._beat == self.manner.error_beat)
                    ack = 1 - err
                    self._take(err)
                    strobed = None
                else:
                    strobed = max(strobed - 1, 0)
            else:
                strobed = None
            dut.wb_ack_i.value, dut.wb_err_i.value = ack, err
            if err:
                dut.exception_i.value = self.manner.error_code

    def _take(self, err):
        """Do one beat of the bus."""
        dut = self.dut
        address, write = int(dut.wb_adr_o.value), int(dut.wb_we_o.value)
        space, item = Space(address >> SPACE_SHIFT), address % ADDRESSES
        wide = space not in BIT_SPACES
        if not any(
            s == space and first <= item <= last and may_write >= write for s, first, last, may_write in self._granted
        ):
            self._fault(f"{'write' if write else 'read'} of {space.name} {item} was not granted")
        data = int(dut.wb_dat_o.value) if write else self.memory.get((space, item), 0)
        if not err:
            self.request.beats.append((write, space, item, data if wide else data & 1))
            if write:
                self.memory[space, item] = data if wide else data & 1
        if not write:
            # the unused bits of a coil are noise: the core must look at bit 0 only
            dut.wb_dat_i.value = data if wide else data | 0xAAAA & ~1
        self._beat += 1
