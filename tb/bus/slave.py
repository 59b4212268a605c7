# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A CPU at the tables of the RAM bank, by modbus_axil_slave or at the Wishbone host side, beside the line."""

import os

import cocotb
from cocotb.triggers import Combine, RisingEdge, Timer
from cocotbext.axi import AxiResp
from harness.bench import CLOCK_PS, TOP, Bench
from harness.volume import volume
from protocol import frames
from protocol.defs import BIT_SPACES, EX, FC, Space

from bus.axil import HOLD, Cpu, hesitate, place
from bus.wishbone import Host

AXIL = TOP == "axil_slave_bench"
OWN = 17
SEED = int(os.environ.get("BENCH_SEED", "1"))
LIMIT = {"timeout_time": 10, "timeout_unit": "ms"}  # for a bus that waits for ever
WORDS = 20


async def bench(dut, **setup):
    """A bench with a CPU."""
    if AXIL:
        for port in ("awvalid", "wvalid", "arvalid", "bready", "rready"):
            getattr(dut, f"s_axil_{port}").value = 0
    tb = await Bench.start(dut, SEED, **setup)
    tb.cpu = Cpu(dut) if AXIL else Host(dut, "host")
    return tb


def spaces(tb):
    """{space: (base, count)} of everything on the host side."""
    files, records = tb.slave.config.files
    return {**tb.slave.config.tables, Space.FILES: (0, files * records)}


def value_of(tb, space):
    """A random value of an item."""
    return tb.rng.getrandbits(1 if space in BIT_SPACES else 16)


async def end(tb):
    """All that the model wrote stands in the tables."""
    for key in sorted(tb.touched):
        seen = await tb.cpu.read(*key)
        assert seen == tb.slave.memory[key], f"{key}: expected {tb.slave.memory[key]:04X}, seen {seen}"
        await tb.cpu.write(*key, 0)
    tb.touched.clear()


@cocotb.test(**LIMIT)
async def every_table_ends_where_it_ends(dut):
    tb = await bench(dut)
    for space, (base, count) in spaces(tb).items():
        for item in sorted({base, base + count - 1, base + count, 0xFFFF}):
            exists, value = base <= item < base + count, 1 if space in BIT_SPACES else 0xC0DE
            assert await tb.cpu.write(space, item, value) == exists, f"{space.name} {item}"
            assert await tb.cpu.read(space, item) == (value if exists else None), f"{space.name} {item}"
            if exists:
                await tb.cpu.write(space, item, 0)
    for space in (5, 6, 7):
        at = place(Space.COILS, 1) + 0x40000 * space if AXIL else None
        if AXIL:
            assert (await tb.cpu.bus.read(at, 4)).resp == AxiResp.SLVERR
            assert await tb.cpu.raw(at, 1, 0xF) == AxiResp.SLVERR
        else:
            assert await tb.cpu.read(space, 1) is None
    await end(tb)


@cocotb.test(**LIMIT)
async def line_and_cpu_share_the_tables(dut):
    """What one writes the other reads, in every table."""
    tb = await bench(dut)
    first = 9
    for space, code in (
        (Space.COILS, FC.READ_COILS),
        (Space.DISCRETES, FC.READ_DISCRETES),
        (Space.INPUTS, FC.READ_INPUTS),
        (Space.HOLDINGS, FC.READ_HOLDINGS),
    ):
        for item in range(first, first + 11):
            value = value_of(tb, space)
            assert await tb.cpu.write(space, item, value)
            tb.slave.memory[space, item] = value
            tb.touched.add((space, item))
        await tb.both(frames.adu(OWN, frames.read(code, first, 11)))
    await tb.both(frames.adu(OWN, frames.write_coils(first, [1, 0, 1, 1, 0, 1])))
    await tb.both(frames.adu(OWN, frames.write_registers(first, [tb.rng.getrandbits(16) for _ in range(6)])))
    await tb.both(frames.adu(OWN, frames.write_files((2, 3, [tb.rng.getrandbits(16)]))))
    await end(tb)


@cocotb.test(**LIMIT)
async def random_accesses(dut):
    """One in eight outside the tables, pauses on all channels, half of the time both directions at once."""
    tb = await bench(dut)
    image, done = {}, []
    if AXIL:
        cocotb.start_soon(hesitate(tb.cpu.bus, dut, tb.rng, lambda: tb.rng.choice((0, 0.4, 0.9)), end=done))
    for _ in range(60):
        accesses = []
        for _ in range(tb.rng.choice((1, 1, 2, 3))):
            space = tb.rng.choice(list(spaces(tb)))
            base, count = spaces(tb)[space]
            item = base + (tb.rng.randrange(24) if tb.rng.randrange(8) else count + tb.rng.randrange(9))
            accesses.append((space, item, value_of(tb, space))[: tb.rng.choice((2, 3))])
        if AXIL and tb.rng.random() < 0.5:
            # The write of one direction and the read of the other wait at the same time, and touch different items.
            await Combine(
                cocotb.start_soon(check(tb, image, [a for a in accesses if len(a) == 3])),
                cocotb.start_soon(check(tb, image, [(Space.INPUTS, 100 + n) for n in range(len(accesses))])),
            )
        else:
            await check(tb, image, accesses)
    done.append(True)
    tb.touched |= set(image)
    for key, value in image.items():
        tb.slave.memory[key] = value
    await tb.clocks(2)
    await end(tb)


async def check(tb, image, accesses):
    """Do accesses and compare with `image`."""
    if not accesses:
        return
    seen = await tb.cpu.block(*accesses)
    for (space, item, *value), got in zip(accesses, seen, strict=True):
        base, count = spaces(tb)[space]
        exists = base <= item < base + count
        if exists and value:
            image[space, item] = value[0]
        wanted = image.get((space, item), 0) if exists else None
        assert got == wanted, f"{space.name} {item} {value}: expected {wanted}, seen {got}"


@cocotb.test(skip=not AXIL, **LIMIT)
async def strobes(dut):
    """All sixteen, on a register, a coil, an item that does not exist and HOLD; upper halves mean nothing."""
    tb = await bench(dut)
    base, count = tb.slave.config.tables[Space.HOLDINGS]
    key, coil, beyond = (Space.HOLDINGS, base + 5), (Space.COILS, 3), (Space.HOLDINGS, base + count)
    for strobe in range(16):
        low = strobe & 3
        await tb.cpu.write(*key, 0x1111)
        response = await tb.cpu.raw(place(*key), 0xABCD_2222, strobe)
        assert response == (AxiResp.SLVERR if low in (1, 2) else AxiResp.OKAY), f"strobes {strobe:04b}: {response!r}"
        assert await tb.cpu.read(*key) == (0x2222 if low == 3 else 0x1111), f"strobes {strobe:04b}"
        await tb.cpu.write(*coil, 0)
        assert await tb.cpu.raw(place(*coil), 0xFFFF_FFFF, strobe) == AxiResp.OKAY
        assert await tb.cpu.read(*coil) == strobe & 1, f"coil, strobes {strobe:04b}"
        assert await tb.cpu.raw(place(*beyond), 0, strobe) == (AxiResp.SLVERR if low else AxiResp.OKAY)
        assert await tb.cpu.raw(HOLD, 1, strobe) == AxiResp.OKAY
        assert (await tb.cpu.bus.read(HOLD, 4)).data[0] == strobe & 1, f"HOLD, strobes {strobe:04b}"
        await tb.cpu.hold(0)
    for size in (2, 4):
        assert await tb.cpu.write(*key, 0x3333, size)
    assert not await tb.cpu.write(*key, 0x44, 1), "a store of a byte"
    assert await tb.cpu.read(*key) == 0x3333
    for at in range(4):  # address bits 1 and 0 mean nothing
        assert await tb.cpu.raw(place(*key) + at, 0x5550 + at, 0xF) == AxiResp.OKAY
        assert await tb.cpu.read(*key) == 0x5550 + at
    await tb.cpu.write(*key, 0)
    await tb.cpu.write(*coil, 0)
    await end(tb)


@cocotb.test(skip=not AXIL, **LIMIT)
@cocotb.parametrize(first=["aw", "w"])
async def address_and_data_in_any_order(dut, first):
    """One of them comes long before the other; reads go on meanwhile."""
    tb = await bench(dut)
    write = tb.cpu.bus.write_if
    late = write.w_channel if first == "aw" else write.aw_channel
    for value in (0x1357, 0x2468):
        late.pause = True
        task = cocotb.start_soon(tb.cpu.write(Space.HOLDINGS, 7, value))
        before = await tb.cpu.read(Space.HOLDINGS, 7)
        assert before == (0 if value == 0x1357 else 0x1357), "written without its other half"
        await tb.clocks(50)
        late.pause = False
        assert await task
        assert await tb.cpu.read(Space.HOLDINGS, 7) == value
    await tb.cpu.write(Space.HOLDINGS, 7, 0)
    await end(tb)


@cocotb.test(skip=not AXIL, **LIMIT)
async def a_response_that_nobody_takes_holds_up_its_direction_only(dut):
    tb = await bench(dut)
    write, read = tb.cpu.bus.write_if, tb.cpu.bus.read_if
    write.b_channel.pause = True
    task = cocotb.start_soon(tb.cpu.write(Space.HOLDINGS, 1, 0x77))
    for _ in range(4):
        assert await tb.cpu.read(Space.HOLDINGS, 2) == 0
    assert not task.done()
    write.b_channel.pause = False
    assert await task
    read.r_channel.pause = True
    task = cocotb.start_soon(tb.cpu.read(Space.HOLDINGS, 1))
    for value in range(4):
        assert await tb.cpu.write(Space.HOLDINGS, 1, value)
    assert not task.done()
    read.r_channel.pause = False
    assert await task in (0x77, *range(4))
    # Several on their way: each gets its own answer.
    values = [0x1010 * n for n in range(4)]
    for paused in (write.b_channel, read.r_channel, None):
        if paused:
            paused.pause = True
        else:
            values = [0] * 4
        writes = [cocotb.start_soon(tb.cpu.write(Space.HOLDINGS, n, v)) for n, v in enumerate(values)]
        writes.append(cocotb.start_soon(tb.cpu.write(Space.HOLDINGS, 0xFFFF, 0)))
        reads = [cocotb.start_soon(tb.cpu.read(Space.INPUTS, n)) for n in (0xFFFF, 5, 0xFFFF, 6)]
        await tb.clocks(60)
        write.b_channel.pause = read.r_channel.pause = False
        assert [await w for w in writes] == [True] * 4 + [False]
        assert [await r for r in reads] == [None, 0, None, 0]
        assert await tb.cpu.block(*((Space.HOLDINGS, n) for n in range(4))) == values
    await end(tb)


@cocotb.test(**LIMIT)
async def blocks_are_never_torn(dut):
    """The line rewrites a block again and again; read under HOLD, or under one cyc, it is always one whole block."""
    tb = await bench(dut)
    blocks, stop = [], []

    async def cpu():
        while not stop:
            if AXIL:
                await tb.cpu.hold(1)
            blocks.append(await tb.cpu.block(*((Space.HOLDINGS, n) for n in range(WORDS))))
            if AXIL:
                await tb.cpu.hold(0)
            await tb.clocks(tb.rng.randrange(1, 40))

    task = cocotb.start_soon(cpu())
    rewritten = volume("blocks rewritten beside a reading CPU")
    for value in range(1, rewritten + 1):
        await tb.both(frames.adu(OWN, frames.write_registers(0, [value] * WORDS)), timing=False)
    stop.append(True)
    await task
    torn = [block for block in blocks if len(set(block)) != 1]
    assert not torn, f"{len(torn)} of {len(blocks)} blocks torn, for example {torn[0]}"
    assert len({block[0] for block in blocks}) > rewritten * 2 // 3, "the CPU saw too few of the blocks"
    await end(tb)


@cocotb.test(skip=not AXIL, **LIMIT)
async def hold_that_stays_is_the_stall_limits_business(dut):
    """06 while the CPU holds the memory, then all is well; rst_i lets go of it."""
    tb = await bench(dut, stall_limit=40)
    pdu = frames.write_register(3, 0xFACE)
    await tb.cpu.hold(1)
    answer = await tb.query(frames.adu(OWN, pdu))
    assert answer and answer.data == frames.adu(OWN, bytes([pdu[0] | 0x80, EX.BUSY])), answer
    assert await tb.cpu.read(Space.HOLDINGS, 3) == 0
    await tb.cpu.hold(0)
    await tb.both(frames.adu(OWN, pdu))
    await tb.cpu.hold(1)
    await tb.reset()
    await tb.silence()
    await tb.both(frames.adu(OWN, pdu))
    await end(tb)


@cocotb.test(skip=not AXIL, **LIMIT)
async def hold_is_answered_when_the_cpu_has_the_memory(dut):
    """HOLD = 1 in the middle of a burst is answered behind the burst; HOLD = 1 again, and HOLD = 0, at once."""
    tb = await bench(dut)
    burst = dut.u_slave.wb_cyc
    for _ in range(5):
        task = cocotb.start_soon(tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 60)), timing=False))
        await RisingEdge(burst)
        await tb.clocks(tb.rng.randrange(2, 60))
        assert int(burst.value)
        await tb.cpu.hold(1)
        assert not int(burst.value), "HOLD is answered within a burst of the line"
        await tb.cpu.hold(1)
        assert (await tb.cpu.bus.read(HOLD, 4)).data[0] == 1
        await tb.cpu.hold(0)
        assert (await tb.cpu.bus.read(HOLD, 4)).data[0] == 0
        await task
    await end(tb)


@cocotb.test(**LIMIT)
async def time_of_an_access(dut):
    """Clocks of an access to a memory that is free: the figures of docs/buses.md."""
    tb = await bench(dut)
    signals = {
        "read": (dut.s_axil_arvalid, dut.s_axil_rvalid) if AXIL else (dut.host_stb_i, dut.host_ack_o),
        "write": (dut.s_axil_awvalid, dut.s_axil_bvalid) if AXIL else (dut.host_stb_i, dut.host_ack_o),
    }
    for kind, (start, stop) in signals.items():
        access = tb.cpu.read(Space.HOLDINGS, 4) if kind == "read" else tb.cpu.write(Space.HOLDINGS, 4, 0)
        task = cocotb.start_soon(access)
        await RisingEdge(start)
        clocks = 0
        while not int(stop.value):
            await RisingEdge(dut.clk_i)
            await Timer(CLOCK_PS // 4, "ps")
            clocks += 1
        await task
        wanted = 6 if AXIL else 2
        assert clocks == wanted, f"{kind}: {clocks} clocks instead of {wanted}"
    await end(tb)
