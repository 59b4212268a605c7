# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A register bank in Python on the grant and Wishbone ports of modbus_rtu_core, which also judges.

It answers from the model's tables but holds its own memory, waits as told, refuses, errs or falls
silent, and notes in `faults` when the core breaks a promise: no grant question without a good frame,
no access outside what was granted, no write without a grant for writing, no checking pass behind the first
write, nothing that changes while the bank makes it wait, and for files every question before the first access,
one cyc for all groups.
"""

from dataclasses import dataclass, field

import cocotb
from cocotb.triggers import First, RisingEdge, Timer
from protocol.defs import ADDRESSES, BIT_SPACES, CHECK_SPACES, EX, SPACE_SHIFT, Space

from .bench import PARAMETERS

WIDE = int(PARAMETERS.get("BITS_PER_BEAT", 1)) != 1  # sixteen bits a beat
SETTLE_PS = 1_000  # after a clock edge the outputs of the core are read, then answered


@dataclass
class Manner:
    """How the bank behaves. Waits are in clock cycles; 0 answers in the same cycle."""

    grant_wait: object = 0  # number, or a callable giving one
    beat_wait: object = 0
    refuse: int = 0  # exception code instead of a grant
    refuse_second: int = 0  # the same, for the second question of a request and those behind it
    refusals: dict = field(default_factory=dict)  # the same, {number of the question: code}
    silent_grant: bool = False
    silent_beat: int | None = None  # number of the item in a request whose beat is never answered
    error_beat: int | None = None  # number of the item whose beat is answered with err
    error_code: int = 0
    unacceptable: object = None  # (space, item, data): exception code of the value in a checking pass, None: acceptable


@dataclass
class Request:
    """What one request did on the bus."""

    questions: list = field(default_factory=list)  # (space, first, last, write), for files (.., file)
    beats: list = field(default_factory=list)  # (write, space, item, data), for files (.., file); an item each
    checks: list = field(default_factory=list)  # (space, item, data) of the beats of a checking pass
    bursts: int = 0  # times cyc rose
    broken_at: int | None = None  # number of the first item of the beat that was answered with err


def _waits(value):
    return value() if callable(value) else value


class Bank:
    """Bank and bus monitor of a Bench whose device is modbus_rtu_core.

    `memory` has the keys of the model's; records of files have the item of Config.record_item.
    """

    def __init__(self, tb):
        self.tb, self.dut = tb, tb.dut
        self.manner, self.request = Manner(), Request()
        self.memory, self.faults = {}, []
        self._granted, self._good_frames = [], 0
        self._levels = {}  # of inputs of the core
        for port in ("grant_ack_i", "exception_i", "wb_ack_i", "wb_err_i", "wb_dat_i"):
            self._put(port, 0)
        self._question = [getattr(self.dut, f"grant_{name}_o") for name in ("space", "first", "last", "write")]
        cocotb.start_soon(self._count_frames())
        cocotb.start_soon(self._run())

    def _put(self, port, value):
        """Drive an input; a level that it has already costs nothing."""
        if self._levels.get(port) != value:
            getattr(self.dut, port).value = self._levels[port] = value

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

    def _verdict(self, space, first, last, _write, file=None):
        manner, config, number = self.manner, self.tb.slave.config, len(self.request.questions)
        if space == Space.FILES:
            files, records = config.files
            exists = 1 <= file <= files and last < records
        else:
            base, count = config.tables[space]
            exists = base <= first and last < base + count
        if not exists:
            return EX.ADDRESS
        return manner.refusals.get(number, manner.refuse_second if number else manner.refuse)

    async def _run(self):
        dut = self.dut
        self._asked = self._held = self._strobed = self._shown = None
        cyc_before = 0
        while True:
            if self._asked is None and not cyc_before and not int(dut.grant_req_o.value):
                # At rest: nothing to look at each clock.
                await First(*(RisingEdge(port) for port in (dut.grant_req_o, dut.wb_cyc_o, dut.wb_stb_o)))
            else:
                await RisingEdge(dut.clk_i)
            await Timer(SETTLE_PS, "ps")
            self._judge_question()
            cyc, stb = int(dut.wb_cyc_o.value), int(dut.wb_stb_o.value)
            if stb and not cyc:
                self._fault("stb without cyc")
            if cyc and not cyc_before:
                self.request.bursts += 1
                if not self._granted:
                    self._fault("cyc without a grant")
                if self.request.bursts > 1 and self._granted[0][0] == Space.FILES:
                    self._fault("cyc falls between two groups")
            cyc_before = cyc
            self._judge_beat(cyc and stb)

    def _judge_question(self):
        """Grant or refuse what is asked in this clock."""
        dut = self.dut
        if not int(dut.grant_req_o.value):
            self._asked = None
            self._put("grant_ack_i", 0)
            return
        question = tuple(int(port.value) for port in self._question)
        if question[0] == Space.FILES:
            question += (int(dut.grant_file_o.value),)
        if self._asked is None:
            self._asked, self._held = _waits(self.manner.grant_wait), question
            if not self._good_frames:
                self._fault(f"question {question} without a good frame")
            if question[0] == Space.FILES and self.request.beats:
                self._fault(f"question {question} behind the first access")
        if question != self._held:
            self._fault(f"question changed from {self._held} to {question}")
        ready = self._asked == 0 and not self.manner.silent_grant
        self._put("grant_ack_i", int(ready))
        if not ready:
            self._asked = max(self._asked - 1, 0)
            return
        code = self._verdict(*question)
        self._put("exception_i", int(code))
        self.request.questions.append(question)
        if not code:
            self._granted.append(question)
        self._asked = None

    def _judge_beat(self, wanted):
        """Answer the beat of this clock, if there is one."""
        ack = err = 0
        if wanted:
            access = self._access()
            if self._strobed is None:
                self._strobed, self._shown = _waits(self.manner.beat_wait), access
            if access != self._shown:
                self._fault(f"access changed from {self._shown} to {access}")
            if self._strobed == 0 and not self._holds(access, self.manner.silent_beat):
                code = self._error(access)
                err, ack = int(code is not None), int(code is None)
                self._take(access, err)
                self._strobed = None
            else:
                self._strobed = max(self._strobed - 1, 0)
        else:
            self._strobed = None
        self._put("wb_ack_i", ack)
        self._put("wb_err_i", err)
        if err:
            self._put("exception_i", code)

    def _error(self, access):
        """The code with which this beat ends with err, None: it does not."""
        if self._holds(access, self.manner.error_beat):
            return self.manner.error_code
        _write, space, item, data, _file = access
        if space in CHECK_SPACES and self.manner.unacceptable:
            table = CHECK_SPACES[space]
            for place, value in self._items(table, item, data):
                code = self.manner.unacceptable(table, place, value)
                if code is not None:
                    return code
        return None

    def _holds(self, access, number):
        """True if the beat moves the item of this number in the request; None is none."""
        _write, space, item, data, _file = access
        items = len(self._items(CHECK_SPACES.get(space, space), item, data))
        return number is not None and self._beat <= number < self._beat + items

    def _items(self, space, item, data):
        """[(item, value), ...] of a beat: one, or with sixteen bits a beat those up to the end of word and range."""
        data = data or 0
        if space not in BIT_SPACES:
            return [(item, data)]
        if not WIDE:
            return [(item, data & 1)]
        last = min(int(self.dut.grant_last_o.value), item | 15)
        return [(place, data >> (place & 15) & 1) for place in range(item, last + 1)]

    def _access(self):
        """(write, space, item, data or None, file or None) on the bus now."""
        dut = self.dut
        address, write = int(dut.wb_adr_o.value), int(dut.wb_we_o.value)
        space, item = address >> SPACE_SHIFT, address % ADDRESSES
        if space not in CHECK_SPACES:
            space = Space(space)
        file = int(dut.grant_file_o.value) if space == Space.FILES else None
        return write, space, item, int(dut.wb_dat_o.value) if write else None, file

    def _take(self, access, err):
        """Do one beat of the bus."""
        write, space, item, data, file = access
        checks = space in CHECK_SPACES
        if checks:
            space = CHECK_SPACES[space]
            if not write:
                self._fault(f"a checking pass reads {space.name} {item}")
            if any(beat[0] for beat in self.request.beats):
                self._fault(f"{space.name} {item} is checked behind the first write")
        read = 0xA5C3 if WIDE else 0xAAAA & ~1  # the unused bits of a coil are noise: the core must not look at them
        for place, value in self._items(space, item, data):
            value = self._take_item(write, checks, err, space, place, value, file)
            if space in BIT_SPACES and WIDE:
                read = read & ~(1 << (place & 15)) | value << (place & 15)
            else:
                read = value | read if space in BIT_SPACES else value
        if not write:
            self._put("wb_dat_i", read)
        if err:
            self.request.broken_at = self._beat
        self._beat += len(self._items(space, item, data))

    def _take_item(self, write, checks, err, space, item, data, file):
        """Do one item of a beat; its value."""
        if not any(
            s == space and first <= item <= last and may_write >= write and ([file] == rest if rest else True)
            for s, first, last, may_write, *rest in self._granted
        ):
            where = f"{space.name} {item}" if file is None else f"{space.name} {file}/{item}"
            self._fault(f"{'write' if write else 'read'} of {where} was not granted")
        key = (space, item if file is None else self.tb.slave.config.record_item(file, item))
        data = data if write else self.memory.get(key, 0)
        if checks:
            if not err:
                self.request.checks.append((space, item, data))
        elif not err:
            beat = (write, space, item, data)
            self.request.beats.append(beat if file is None else (*beat, file))
            if write:
                self.memory[key] = data
        return data
