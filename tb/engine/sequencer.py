# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The sequencer alone, with programs of a few steps: which commands each step gives, and how it ends."""

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge, Timer
from harness.steps import NUMBERS, field, step
from harness.unit import clocks, settle, start

ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE, FAILURE, BUSY = 1, 2, 3, 4, 6
START_AT, EXCEPTION_AT, CLEARING_AT = 0x20, 0x100, 0x1F0
REST = step("REST")
LIMIT = 300  # clocks of a program here
NEVER = field("CONDITION", NUMBERS["JUMP_NEVER"], "ARG")
VECTORS = {
    "ram": "POINT CLEAR STEP UP DOWN PUT SAVE RECALL".split(),
    "range": "ADDRESS ONE QUANTITY LESS_ONE FIRST LESS FILE NO_GROUP GROUP".split(),
    "burst": "HOLD LOAD STATUS LITERAL GRANT BURST RELEASE".split(),
    "diag": "COUNT LOG LISTEN ACTIVE EMPTY CLEAR_REGISTER CLEAR_OVERRUN OVERRUN".split(),
}


class Tb:
    """The program memory and a count of bytes behind the frame RAM's commands."""

    def __init__(self, dut):
        self.dut, self.program, self.frame = dut, {}, b""
        self.cursor = self.count = self.held = self.late = 0
        self.seen, self.path, self.running = [], [], False
        self.given = []  # (byte, commands) of each clock with commands
        cocotb.start_soon(self._around())

    async def _around(self):
        dut, at = self.dut, 0
        while True:
            dut.step_i.value = self.program.get(at, REST)
            dut.cursor_i.value, dut.count_i.value = self.cursor & 15, self.count & 0x1FF
            dut.byte_i.value = self.late
            self.late = self.frame[self.cursor] if self.cursor < len(self.frame) else 0
            dut.held_i.value = self.held
            await Timer(1, "ns")
            await ReadOnly()
            at = int(dut.at_o.value) if int(dut.fetch_o.value) else at
            commands = []
            for vector, names in VECTORS.items():
                value = int(getattr(dut, f"{vector}_do_o").value)
                commands += [name for name in names if value >> NUMBERS[f"DO_{name}"] & 1]
            if int(dut.write_stb_o.value):
                commands.append("TELL")
            byte, argument = int(dut.byte_i.value), int(dut.argument_o.value)
            verdict = int(dut.verdict_o.value)
            await RisingEdge(dut.clk_i)
            if self.running:
                self.seen.append(commands)
                self.path.append(at)
                self.given += [(byte, commands)] if commands else []
            if "HOLD" in commands:
                self.held = byte
            if "LITERAL" in commands:
                self.held = argument & 0xFF
            if "POINT" in commands:
                self.cursor = argument & 15
            self.cursor += "STEP" in commands
            self.count += ("UP" in commands) - ("DOWN" in commands)
            if "CLEAR" in commands:
                self.count = 0
            if verdict >> NUMBERS["VERDICT_QUIET"] & 1:
                self.running = False

    async def run(self, steps, frame=b"", broadcast=0):
        """A good frame for us begins the steps; the commands of each clock until REST. Cursor 0, count = bytes."""
        self.program = {START_AT + n: word for n, word in enumerate(steps)}
        self.program[EXCEPTION_AT] = step("POINT", PLACE=31)
        self.frame, self.cursor, self.count, self.held = frame, 0, len(frame), 0
        self.seen, self.path, self.given = [], [], []
        self.dut.frame_i.value = 1 | broadcast << NUMBERS["FRAME_BROADCAST"]
        await clocks(self.dut)
        self.running = True
        self.dut.frame_i.value = 0
        for _ in range(LIMIT):
            await clocks(self.dut)
            await Timer(3, "ns")
            if not self.running:
                return [commands for commands in self.seen if commands]
        raise AssertionError(f"no end after {LIMIT} clocks, at {self.path[-10:]}")

    async def refused(self, steps, frame=b"", **how):
        """The exception code, after a proof that the next step was the EXCEPTION routine's; 0: none."""
        await self.run(steps, frame, **how)
        if EXCEPTION_AT not in self.path:
            return 0
        return int(self.dut.code_o.value)


async def bench(dut):
    await start(
        dut,
        entries=field("ENTRY_START", START_AT) | field("ENTRY_EXCEPTION", EXCEPTION_AT)
        | field("ENTRY_CLEARING", CLEARING_AT),
    )  # fmt: skip
    tb = Tb(dut)
    tb.program = {}
    await clocks(dut, 12)  # after a reset it clears the counters, here it rests at once
    await settle()
    return tb


def flat(seen):
    return [name for commands in seen for name in commands if name != "RELEASE"]


@cocotb.test()
async def a_field_is_two_bytes(dut):
    tb = await bench(dut)
    for name, command in (("ADDRESS", "ADDRESS"), ("FILE", "FILE"), ("DEPTH", "QUANTITY"), ("QUANTITY", "QUANTITY")):
        dut.found_i.value = 1 << NUMBERS["FOUND_IN_LIMIT"]
        seen = flat(await tb.run([step(name), REST], b"\x12\x34\x56"))
        # The range gets the high byte first. LESS_ONE comes with the low byte, and only for QUANTITY.
        less_one = ["LESS_ONE"] if name == "QUANTITY" else []
        assert seen == ["STEP", "DOWN", "HOLD", "STEP", "DOWN", command, command, *less_one], f"{name}: {seen}"
        assert (tb.cursor, tb.count, tb.held) == (2, 1, 0x12)
        field = [(byte, commands) for byte, commands in tb.given if command in commands]
        assert [byte for byte, _ in field] == [0x12, 0x34], f"{name}: {tb.given}"
    seen = flat(await tb.run([step("ADDRESS", ONE=1, IN_SPACE=1, SPACE=3), REST], b"\x12\x34"))
    assert seen == ["STEP", "DOWN", "ONE", "HOLD", "STEP", "DOWN", "ADDRESS", "ADDRESS"]
    assert int(dut.space_o.value) == 3


@cocotb.test()
async def quantity_outside_its_limit_is_03(dut):
    tb = await bench(dut)
    for found, code in ((1, 0), (0, ILLEGAL_VALUE)):
        dut.found_i.value = found << NUMBERS["FOUND_IN_LIMIT"]
        assert await tb.refused([step("QUANTITY", ROOM=100), REST], b"\0\x01") == code


@cocotb.test()
async def coil_takes_two_values_and_ends_the_request(dut):
    tb = await bench(dut)
    for frame, zero, code in (
        (b"\0\0", 0, 0), (b"\xff\0", 0, 0), (b"\xff\0", 1, 3), (b"\0\0", 1, 0), (b"\x01\0", 0, 3), (b"\0\x01", 0, 3),
        (b"\xff\xff", 0, 3), (b"\xff", 0, 3), (b"", 0, 3), (b"\0\0\0", 0, 3),
    ):  # fmt: skip
        seen = await tb.refused([step("COIL", ZERO=zero), REST], frame)
        assert seen == code, f"{frame.hex()} ZERO {zero}: {seen}, expected {code}"


@cocotb.test()
async def the_request_ends_here_or_goes_on_with_words(dut):
    tb = await bench(dut)
    for words, lengths in ((0, (0,)), (1, (2, 4, 6))):
        for length in range(7):
            code = await tb.refused([step("END", WORDS=words), REST], bytes(length))
            assert code == (0 if length in lengths else ILLEGAL_VALUE), f"END, {length} bytes, WORDS {words}: {code}"


@cocotb.test()
async def byte_count_is_that_of_the_bytes_left(dut):
    tb = await bench(dut)
    for fit in (0, 1):
        for given, left, found in ((4, 4, 1), (4, 3, 1), (4, 5, 1), (4, 4, 0)):
            dut.found_i.value = found << NUMBERS["FOUND_FIT"]
            code = await tb.refused([step("BYTE_COUNT", FIT=fit), REST], bytes([given, *[0] * left]))
            assert code == (0 if given == left and (found or not fit) else ILLEGAL_VALUE)


@cocotb.test()
async def jumps(dut):
    tb = await bench(dut)
    target = 5
    steps = [0, REST, REST, REST, REST, step("POINT", PLACE=3), REST]
    for condition, broadcast, busy, failure, went, code in (
        ("ALWAYS", 0, 1, 0, True, 0), ("UNICAST", 0, 0, 0, True, 0), ("UNICAST", 1, 0, 0, False, ILLEGAL_FUNCTION),
        ("NEVER", 0, 0, 0, False, ILLEGAL_FUNCTION), ("READY", 0, 0, 0, False, 0), ("READY", 0, 1, 9, False, BUSY),
        ("READY", 0, 0, 9, False, 9),
    ):  # fmt: skip
        dut.busy_i.value, dut.failure_i.value = busy, failure
        steps[0] = step("JUMP", CONDITION=NUMBERS[f"JUMP_{condition}"], TARGET=START_AT + target)
        seen = await tb.refused(steps, broadcast=broadcast)
        assert seen == code, f"{condition}: {seen}, expected {code}"
        assert code or (START_AT + target in tb.path) == went, f"{condition}: {tb.path}"


@cocotb.test()
async def conditions(dut):
    tb = await bench(dut)
    steps = [step("LITERAL", LITERAL=0x41), 0, REST, REST, step("POINT", PLACE=3), REST]
    for condition, frame, listen, broadcast, went in (
        ("EQUAL", b"\x41", 0, 0, True), ("EQUAL", b"\x42", 0, 0, False), ("LEFT", b"\0", 0, 0, True),
        ("LEFT", b"", 0, 0, False), ("LISTENING", b"", 1, 0, True), ("LISTENING", b"", 0, 0, False),
        ("NOT_USER", b"\x41", 0, 0, False), ("NOT_USER", b"\x40", 0, 0, True), ("NOT_USER", b"\xc1", 0, 0, True),
        ("NOT_USER", b"\x41", 0, 1, True),
    ):  # fmt: skip
        dut.listen_only_i.value = listen
        steps[1] = step("IF", CONDITION=NUMBERS[f"IF_{condition}"], TARGET=START_AT + 4)
        assert await tb.refused(steps, frame, broadcast=broadcast) == 0
        assert (START_AT + 4 in tb.path) == went, f"{condition} {frame.hex()}: {tb.path}"


@cocotb.test()
async def fewer_bytes_than_none_are_03(dut):
    tb = await bench(dut)
    left = step("IF", CONDITION=NUMBERS["IF_LEFT"], TARGET=START_AT + 2)
    for length, code in ((1, 3), (2, 0), (3, 0)):
        assert await tb.refused([step("ADDRESS"), left, REST], bytes(length)) == code


@cocotb.test()
async def the_table_has_an_entry_for_each_byte(dut):
    tb = await bench(dut)
    dispatch = step("DISPATCH", TARGET=0x40)
    for byte in range(256):
        await tb.run([dispatch], bytes([byte, 0]))
        entry = 0x40 + (byte if byte < 0x20 else 0x1F)
        assert entry in tb.path, f"{byte:02X}: {tb.path}"
        assert (tb.cursor, tb.count) == (1, 1)


@cocotb.test()
async def a_byte_is_matched(dut):
    tb = await bench(dut)
    for byte, exception, code in ((6, 2, 0), (7, 2, ILLEGAL_ADDRESS), (7, 1, ILLEGAL_FUNCTION), (7, 0, 0)):
        assert await tb.refused([step("MATCH", LITERAL=6, EXCEPTION=exception), REST], bytes([byte])) == code
        assert code or tb.cursor == 1


@cocotb.test()
async def the_cursor_walks_to_a_place(dut):
    tb = await bench(dut)
    for place, up in ((0, 0), (1, 0), (6, 1), (15, 0)):
        await tb.run([step("WALK", PLACE=place, UP=up), REST], bytes(20))
        assert (tb.cursor, tb.count) == (place, 20 + (place if up else -place))


@cocotb.test()
async def a_byte_is_put_at_its_place(dut):
    tb = await bench(dut)
    for fields, commands in (
        ({"PLACE": 5}, ["POINT", "STEP", "UP", "PUT"]),
        ({"HERE": 1}, ["STEP", "UP", "PUT"]),
        ({"PLACE": 5, "STATUS": 1}, ["POINT", "STATUS", "STEP", "UP", "PUT"]),
    ):
        assert flat(await tb.run([step("PUT", **fields), REST])) == commands


@cocotb.test()
@cocotb.parametrize(name=["GRANT", "BURST"])
async def the_bank_is_waited_for(dut, name):
    tb = await bench(dut)
    for fail, code, wait in ((0, 0, 0), (0, 0, 37), (1, 2, 11), (1, 8, 0)):

        async def bank(fail=fail, code=code, wait=wait):
            while not int(dut.burst_do_o.value) >> NUMBERS[f"DO_{name}"] & 1:
                await clocks(dut)
                await settle()
            await clocks(dut, wait)
            dut.done_i.value, dut.fail_i.value, dut.fail_code_i.value = int(not fail), fail, code
            await clocks(dut)
            dut.done_i.value = dut.fail_i.value = 0

        task = cocotb.start_soon(bank())
        assert await tb.refused([step(name, PLACE=3, CLEAR=1) if name == "BURST" else step(name), REST]) == code
        await task
        seen = flat(tb.seen)
        assert wait + 1 <= seen.count(name) <= wait + 2
        if name == "BURST":
            points = seen.count("POINT") - (code != 0)
            assert points == 1 and seen.count("CLEAR") == 1, "pointed once, however long it takes"


@cocotb.test()
async def two_steps_never_command_at_once(dut):
    """Commands of two steps in a row never fall into one clock."""
    tb = await bench(dut)
    dut.found_i.value = 7 & ~(1 << NUMBERS["FOUND_TOO_LONG"])
    steps = [step("ADDRESS"), step("SPACE", SPACE=2), step("POINT", PLACE=4), step("LOAD", PLACE=2),
             step("PUT", PLACE=7), step("SET", LITERAL=3), step("CONTEXT", SAVE=1), step("LITERAL", LITERAL=1),
             step("TOTAL"), step("COUNT", COUNTER=10), step("LOG", EVENT=4), step("TELL")]  # fmt: skip
    for first in steps:
        for second in steps:
            await tb.run([first, second, REST], bytes(12))
            ats = [at for at, commands in zip(tb.path, tb.seen, strict=True) if commands]
            busy = [bool(commands) for commands in tb.seen]
            assert len(tb.path) < 40 and busy.count(True) <= 12
            assert all(at in (START_AT, START_AT + 1, START_AT + 2, START_AT + 3) for at in ats)


@cocotb.test()
async def the_first_mistake_counts(dut):
    """A second step would raise another code; it is not carried out."""
    tb = await bench(dut)
    steps = [step("END"), step("JUMP", CONDITION=NUMBERS["JUMP_NEVER"]), REST]
    assert await tb.refused(steps, b"\0") == ILLEGAL_VALUE
    assert START_AT + 2 not in tb.path


@cocotb.test()
async def nothing_is_sent_in_a_broadcast(dut):
    tb = await bench(dut)
    sent = []

    async def watch():
        while True:
            await RisingEdge(dut.clk_i)
            sent.append(int(dut.verdict_o.value) >> NUMBERS["VERDICT_SEND"] & 1)

    cocotb.start_soon(watch())
    for broadcast in (0, 1):
        sent.clear()
        await tb.run([step("SEND"), REST], broadcast=broadcast)
        assert any(sent) == (not broadcast)


@cocotb.test()
async def the_user_is_waited_for(dut):
    tb = await bench(dut)
    steps = [step("OFFER", TARGET=START_AT + 4), REST, REST, REST, step("POINT", PLACE=3), REST]
    for passes, fail, code, went in ((0, 0, 0, True), (1, 0, 0, False), (0, 1, 4, False)):

        async def user(passes=passes, fail=fail, code=code):
            while not int(dut.offer_o.value):
                await clocks(dut)
                await settle()
            await clocks(dut, 9)
            dut.user_done_i.value, dut.user_pass_i.value = 1, passes
            dut.user_fail_i.value, dut.user_code_i.value = fail, code
            await clocks(dut)
            dut.user_done_i.value = dut.user_fail_i.value = 0

        task = cocotb.start_soon(user())
        assert await tb.refused(steps) == code
        await task
        if not fail:
            assert (START_AT + 4 in tb.path) == went
