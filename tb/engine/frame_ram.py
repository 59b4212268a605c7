# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The frame RAM against a list of bytes, a cursor and a count."""

import cocotb
from harness.unit import clocks, settle, start

SIZE, COUNTS = 512, 512


class Model:
    def __init__(self, content):
        self.memory, self.cursor, self.count, self.kept = list(content), 0, 0, None

    def clock(self, s):
        """One clock with these strobes; a cursor runs around within nine bits, which no frame lets it do."""
        if s.get("write"):
            self.memory[self.cursor] = s["data"]
        cursor, count = self.cursor, self.count
        if s.get("point"):
            cursor = (s.get("point_at", 0) >> 4) * 256 + (s.get("point_at", 0) & 15)
        elif s.get("step"):
            cursor = (cursor + 1) % SIZE
        if s.get("clear"):
            count = 0
        else:
            count = (count + bool(s.get("up")) - bool(s.get("down"))) % COUNTS
        kept = (self.cursor, self.count) if s.get("keep") else self.kept
        if s.get("recall"):
            cursor = self.kept[0]
            count = 0 if s.get("clear") else self.kept[1]
        self.cursor, self.count, self.kept = cursor, count, kept


def content(dut):
    """What the tests before have left."""
    return [int(dut.memory[at].value) for at in range(SIZE)]


async def clock(dut, model, **strobes):
    for name in ("point", "step", "clear", "up", "down", "keep", "recall", "write"):
        getattr(dut, f"{name}_i").value = int(bool(strobes.get(name)))
    dut.point_at_i.value, dut.data_i.value = strobes.get("point_at", 0), strobes.get("data", 0)
    await clocks(dut)
    model.clock(strobes)
    await settle()
    assert int(dut.count_o.value) == model.count, f"{strobes}: count {int(dut.count_o.value)}, expected {model.count}"
    assert int(dut.cursor_o.value) == model.cursor & 15, f"{strobes}: cursor {int(dut.cursor_o.value)}"


async def compare(dut, model):
    """The byte under the cursor, a clock in which nothing was written later."""
    await clock(dut, model)
    assert int(dut.byte_o.value) == model.memory[model.cursor], f"byte at {model.cursor}"


@cocotb.test()
async def empty_at_power_up(dut):
    """The first frame may be shorter than what is looked at: there is no X."""
    await start(dut)
    model = Model([0] * SIZE)
    for place in range(32):
        await clock(dut, model, point=1, point_at=place, clear=1)
        await compare(dut, model)


@cocotb.test()
async def a_frame_goes_in_and_comes_out(dut):
    random = await start(dut)
    model = Model(content(dut))
    frame = [random.getrandbits(8) for _ in range(256)]
    await clock(dut, model, point=1, clear=1)
    for byte in frame:
        await clock(dut, model, write=1, data=byte, step=1, up=1)
    assert model.count == 256
    await clock(dut, model, point=1)
    for byte in frame:
        await compare(dut, model)
        assert int(dut.byte_o.value) == byte
        await clock(dut, model, step=1, down=1)
    assert model.count == 0


@cocotb.test()
async def two_cursors_and_two_halves(dut):
    random = await start(dut)
    model = Model(content(dut))
    await clock(dut, model, point=1, clear=1)
    await clock(dut, model, keep=1)
    for _ in range(3000):
        kind = random.choice(("put", "take", "point", "context", "peek"))
        if kind == "put":
            await clock(dut, model, write=1, data=random.getrandbits(8), step=1, up=1)
        elif kind == "take":
            await clock(dut, model, step=1, down=1)
        elif kind == "point":
            await clock(dut, model, point=1, point_at=random.randrange(32), clear=random.getrandbits(1))
        elif kind == "context":
            await clock(dut, model, keep=random.getrandbits(1), recall=random.getrandbits(1))
        else:
            at = random.randrange(256)
            dut.peek_i.value, dut.peek_at_i.value = 1, at
            await clock(dut, model)
            assert int(dut.byte_o.value) == model.memory[at], f"byte {at} of the request"
            dut.peek_i.value = 0
        if random.random() < 0.3:
            await compare(dut, model)
