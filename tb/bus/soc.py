# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The example SoCs: one bus, the Modbus core and a CPU on it that never rests."""

import os

import cocotb
from cocotb.triggers import Event, RisingEdge, Timer, with_timeout
from cocotb.utils import get_sim_time
from harness.bench import CLOCK_PS, PATIENCE_CLOCKS, TOP, Bench
from protocol import frames
from protocol.defs import EX, FC, Space

from bus.axil import Cpu, hesitate
from bus.wishbone import Host

AXIL = TOP == "modbus_example_soc_axil"
OWN = 17
SEED = int(os.environ.get("BENCH_SEED", "1"))
LIMIT = {"timeout_time": 10, "timeout_unit": "ms"}  # for a bus that waits for ever
WORDS = 128
BLOCK = 10
H = Space.HOLDINGS
LONGEST = {True: 2242, False: 766}  # clocks of the longest 17H on the bus, AXI4-Lite and Wishbone: docs/buses.md
CPU_ACCESS_CLOCKS = 30  # the CPU may be in the middle of an access when the burst begins


class Soc:
    """Bench and CPU; `hammer` starts CPU tasks that never pause from the end of a request to the start of its answer.

    Else, where nothing of the line is on the bus, they would only cost time. `rest` ends them.
    """

    @classmethod
    async def start(cls, dut, odds=0.0, **setup):
        self = cls()
        dut.switches_i.value = 0
        if AXIL:
            for port in ("awvalid", "wvalid", "arvalid", "bready", "rready"):
                getattr(dut, f"s_axil_{port}").value = 0
        else:
            for port in ("cyc", "stb", "we", "adr", "dat"):
                getattr(dut, f"cpu_{port}_i").value = 0
        self.dut, self.stop, self.tasks, self.awake = dut, [], [], Event()
        self.tb = await Bench.start(dut, SEED, **{"stall_limit": 200, **setup})
        self.rng = self.tb.rng
        self.cpu = Cpu(dut) if AXIL else Host(dut, "cpu")
        if AXIL and odds:
            cocotb.start_soon(hesitate(self.cpu.bus, dut, self.rng, lambda: odds, end=self.stop))
        return self

    def hammer(self, work):
        """Run the coroutine function `work` again and again."""

        async def task():
            while not self.stop:
                if not self.awake.is_set():
                    await self.awake.wait()
                    await self.tb.clocks(self.rng.randrange(40))  # meet the burst in another phase each time
                await work()

        self.tasks.append(cocotb.start_soon(task()))

    async def rest(self):
        """The end: every task has ended."""
        self.stop.append(True)
        self.awake.set()
        for task in self.tasks:
            await task

    async def _sleep(self):
        await with_timeout(RisingEdge(self.dut.de_o), PATIENCE_CLOCKS * CLOCK_PS, "ps")
        self.awake.clear()

    async def ask(self, pdu):
        """One request; the PDU of its answer."""
        await self.tb.send(frames.adu(OWN, pdu))
        self.awake.set()
        asleep = cocotb.start_soon(self._sleep())
        answer = await self.tb.line.answer(self.tb.t35 + PATIENCE_CLOCKS * CLOCK_PS)
        await asleep
        assert answer, f"{frames.text(pdu)}: silence"
        return answer.data[1:-2]


def words_of(answer):
    """The registers of an answer of 03, 04 or 17H."""
    assert not answer[0] & 0x80, frames.text(answer)
    return frames.unpack_words(answer[2:])


@cocotb.test(**LIMIT)
async def both_masters_see_the_same(dut):
    soc = await Soc.start(dut)
    values = [soc.rng.getrandbits(16) for _ in range(5)]
    for space, code in ((H, FC.READ_HOLDINGS), (Space.INPUTS, FC.READ_INPUTS)):
        for item, value in enumerate(values):
            assert await soc.cpu.write(space, WORDS - 5 + item, value)
        assert words_of(await soc.ask(frames.read(code, WORDS - 5, 5))) == values
    await soc.ask(frames.write_registers(3, values))
    assert await soc.cpu.block(*((H, 3 + n) for n in range(5))) == values
    await soc.ask(frames.write_coils(0, [1, 0, 1, 1, 0, 0, 0, 1]))
    assert int(dut.lamps_o.value) == 0b10001101
    assert await soc.cpu.write(Space.COILS, 1, 1)
    assert (await soc.ask(frames.read(FC.READ_COILS, 0, 8)))[2] == 0b10001111
    dut.switches_i.value = 0x96
    await soc.tb.clocks(8)
    assert (await soc.ask(frames.read(FC.READ_DISCRETES, 0, 8)))[2] == 0x96
    assert await soc.cpu.read(Space.DISCRETES, 1) == 1
    for access in ((H, WORDS), (Space.INPUTS, WORDS), (Space.COILS, 8), (Space.FILES, 0), (Space.DISCRETES, 0, 1)):
        assert await soc.cpu.block(access) == [None], f"{access} exists"
    assert await soc.ask(frames.read(FC.READ_HOLDINGS, WORDS - 1, 2)) == bytes([0x83, EX.ADDRESS])
    await soc.rest()


@cocotb.test(**LIMIT)
@cocotb.parametrize(odds=[0.0, 0.3])
async def read_write_is_one_piece(dut, odds):
    """17H writes a block and reads it back, while the CPU writes the same registers: the master reads what it wrote."""
    soc = await Soc.start(dut, odds)
    place, written = 0, 0

    async def write():
        nonlocal place, written
        place, written = (place + 1) % BLOCK, written + 1
        assert await soc.cpu.write(H, place, 0x8000 | written & 0x7FFF)

    soc.hammer(write)
    for turn in range(5):
        values = [turn << 8 | n for n in range(BLOCK)]
        before = written
        answer = words_of(await soc.ask(frames.read_write(0, BLOCK, 0, values)))
        assert answer == values, f"torn: wrote {values}, read {answer}"
        assert written > before + 3, "the CPU hardly got the bus"
    await soc.rest()


@cocotb.test(**LIMIT)
async def mask_write_loses_nothing(dut):
    """16H changes the upper byte of a register whose lower byte the CPU counts up: no count is ever undone."""
    soc = await Soc.start(dut)
    count = 0

    async def add():
        nonlocal count
        count = (count + 1) & 0xFF
        assert await soc.cpu.write(H, 5, count)
        seen = await soc.cpu.read(H, 5)
        assert seen & 0xFF == count, f"the CPU wrote {count:02X}, then read {seen:04X}"

    soc.hammer(add)
    for _ in range(14):
        pdu = frames.mask_write(5, 0x00FF, soc.rng.getrandbits(8) << 8)
        assert await soc.ask(pdu) == pdu
    await soc.rest()


@cocotb.test(**LIMIT)
async def long_reads_are_snapshots(dut):
    """The CPU writes registers from the last to the first; a read from first to last sees at most one step."""
    soc = await Soc.start(dut, 0.2)
    steps, mixed = 0, 0

    async def step():
        nonlocal steps
        for item in reversed(range(BLOCK)):
            assert await soc.cpu.write(H, item, steps)
        steps += 1

    soc.hammer(step)
    for _ in range(6):
        seen = words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 0, BLOCK)))
        falls = [n for n in range(1, BLOCK) if seen[n] != seen[n - 1]]
        assert len(falls) <= 1 and seen[-1] - seen[0] in (0, 1), f"no snapshot: {seen}"
        mixed += bool(falls)
    assert mixed, "every read fell between two steps of the CPU"
    await soc.rest()


@cocotb.test(skip=AXIL, **LIMIT)
async def cpu_blocks_are_one_piece(dut):
    """What the CPU does under one cyc the line does not break."""
    soc = await Soc.start(dut)
    value = 0

    async def block():
        nonlocal value
        value = (value + 1) & 0xFFFF
        await soc.cpu.block(*((H, n, value) for n in range(BLOCK)))
        await soc.cpu.gap()

    soc.hammer(block)
    for _ in range(10):
        seen = words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 0, BLOCK)))
        assert len(set(seen)) == 1, f"torn: {seen}"
    await soc.rest()


@cocotb.test(skip=AXIL, **LIMIT)
async def cpu_that_never_lets_go(dut):
    """04 after the stall limit, and when the CPU lets go the line goes on."""
    soc = await Soc.start(dut, stall_limit=40)
    dut.cpu_cyc_i.value = 1
    for _ in range(2):
        assert await soc.ask(frames.read(FC.READ_HOLDINGS, 0, 1)) == bytes([0x83, EX.FAILURE])
    dut.cpu_cyc_i.value = 0
    assert words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 30, 1))) == [0]
    await soc.rest()


@cocotb.test(skip=not AXIL, **LIMIT)
async def cpu_that_takes_no_response(dut):
    """A CPU whose RREADY or BREADY stays low holds up its own direction, not the line, and gets what it asked for."""
    soc = await Soc.start(dut, stall_limit=40)
    await soc.cpu.write(H, 40, 0x1234)
    for channel, access, other, wanted in (
        (soc.cpu.bus.read_if.r_channel, lambda: soc.cpu.read(H, 40), lambda: soc.cpu.write(H, 42, 1), 0x1234),
        (soc.cpu.bus.write_if.b_channel, lambda: soc.cpu.write(H, 40, 7), lambda: soc.cpu.read(H, 42), True),
    ):
        channel.pause = True
        tasks = [cocotb.start_soon(access()) for _ in range(2)]
        await soc.tb.clocks(30)
        await soc.ask(frames.write_register(41, 0x4444))
        assert words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 41, 1))) == [0x4444]
        await with_timeout(cocotb.start_soon(other()), 100 * CLOCK_PS, "ps")
        assert not any(task.done() for task in tasks)
        channel.pause = False
        assert [await task for task in tasks] == [wanted, wanted]
        await soc.ask(frames.write_register(41, 0))
    assert await soc.cpu.read(H, 40) == 7
    await soc.rest()


@cocotb.test(skip=not AXIL, **LIMIT)
@cocotb.parametrize(first=["aw", "w"])
async def cpu_gives_half_a_write_and_reads_first(dut, first):
    """Address or data early, the other half only behind a read of its own: neither the CPU nor the line waits."""
    soc = await Soc.start(dut, stall_limit=40)
    await soc.cpu.write(H, 50, 0)
    write = soc.cpu.bus.write_if
    late = write.w_channel if first == "aw" else write.aw_channel
    for value in (0x1357, 0x2468):
        late.pause = True
        task = cocotb.start_soon(soc.cpu.write(H, 50, value))
        await soc.tb.clocks(10)
        before = await with_timeout(cocotb.start_soon(soc.cpu.read(H, 50)), 100 * CLOCK_PS, "ps")
        assert before == (0 if value == 0x1357 else 0x1357), "written without its other half"
        assert words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 50, 1))) == [before]
        late.pause = False
        assert await with_timeout(task, 100 * CLOCK_PS, "ps")
        assert words_of(await soc.ask(frames.read(FC.READ_HOLDINGS, 50, 1))) == [value]
    await soc.rest()


@cocotb.test(**LIMIT)
async def cpu_waits_for_one_request_at_most(dut):
    """The longest 17H: the CPU's access that meets it takes as long as the burst, the figure of docs/buses.md."""
    soc = await Soc.start(dut)
    burst = dut.wb_cyc
    longest, clocks = 0, 0

    async def access():
        nonlocal longest
        begin = clocks_now()
        await soc.cpu.write(H, 127, 1)
        longest = max(longest, clocks_now() - begin)

    soc.hammer(access)
    task = cocotb.start_soon(soc.ask(frames.read_write(0, 125, 0, list(range(121)))))
    await RisingEdge(burst)
    begin = clocks_now()
    while int(burst.value):
        await RisingEdge(dut.clk_i)
        await Timer(1, "ns")
    clocks = clocks_now() - begin
    await task
    assert clocks - 10 <= longest <= clocks + 30, f"the burst took {clocks}, the CPU waited {longest}"
    assert 0 <= clocks - LONGEST[AXIL] <= CPU_ACCESS_CLOCKS, f"17H of 121 and 125 registers took {clocks} clocks"
    await soc.rest()


def clocks_now():
    """Simulation time in clocks."""
    return round(get_sim_time("ps") / CLOCK_PS)
