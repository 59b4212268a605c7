# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The core as a master of a bus that waits, errs and dies; the same tests on AXI4-Lite and on Wishbone."""

import os

import cocotb
from cocotb.triggers import RisingEdge, Timer
from cocotb.utils import get_sim_time
from harness.bench import CLOCK_PS, PARAMETERS, PROCESSING_CLOCKS, Bench
from protocol import frames
from protocol.defs import BIT_SPACES, BROADCAST, EX, FC, Space

from bus.axil import AT, AxilMemory
from bus.wishbone import WishboneMemory

AXIL = bool(PARAMETERS.get("AXIL", 1))
OWN = 17
SEED = int(os.environ.get("BENCH_SEED", "1"))
LIMIT = {"timeout_time": 10, "timeout_unit": "ms"}  # for a bus that waits for ever
COIL, REGISTER = 30, 40
STALL_BITS = 40
PLACES = {space: PARAMETERS.get(f"{space.name[:-1]}_AT", at) for space, at in AT.items()}
FILE, RECORD = 2, 5
READING = (FC.READ_COILS, FC.READ_HOLDINGS)
WRITING = (FC.WRITE_COIL, FC.WRITE_REGISTERS)


def requests():
    """(PDU, transfers it makes on the bus)."""
    return [
        (frames.read(FC.READ_COILS, COIL, 19), 19),
        (frames.read(FC.READ_DISCRETES, COIL, 3), 3),
        (frames.read(FC.READ_HOLDINGS, REGISTER, 5), 5),
        (frames.read(FC.READ_INPUTS, REGISTER, 4), 4),
        (frames.write_coil(COIL, True), 1),
        (frames.write_register(REGISTER, 0x1234), 1),
        (frames.write_coils(COIL, [1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1]), 11),
        (frames.write_registers(REGISTER, [1, 0xFFFF, 0x8001]), 3),
        (frames.mask_write(REGISTER, 0xF0F0, 0x1234), 2),
        (frames.read_write(REGISTER, 4, REGISTER + 2, [7, 8, 9]), 7),
    ]


async def bench(dut, **setup):
    """A bench whose bus has the model's memory, with random contents."""
    dut.rst_i.value = 1
    for port in ("wb_dat_i", "wb_ack_i", "wb_err_i"):
        getattr(dut, port).value = 0
    for port in ("awready", "wready", "bresp", "bvalid", "arready", "rdata", "rresp", "rvalid"):
        getattr(dut, f"m_axil_{port}").value = 0
    tb = await Bench.start(dut, SEED, **setup)
    tb.bus = (AxilMemory if AXIL else WishboneMemory)(dut, tb.rng, PLACES)
    tb.bus.noise = 0xA5C3
    for space in list(Space)[:4]:
        base, width = (COIL, 1) if space in BIT_SPACES else (REGISTER, 16)
        if not tb.slave.config.tables[space][1]:
            continue
        for item in range(base, base + 20):
            preset(tb, (space, item), tb.rng.getrandbits(width))
    tb.bursts = [0, 0]  # times burst_o rose, clocks it was high
    cocotb.start_soon(_bursts(tb))
    return tb


async def _bursts(tb):
    while True:
        await RisingEdge(tb.dut.burst_o)
        begin = get_sim_time("ps")
        tb.bursts[0] += 1
        while int(tb.dut.burst_o.value):
            await RisingEdge(tb.dut.clk_i)
        tb.bursts[1] += round((get_sim_time("ps") - begin) / CLOCK_PS)


def preset(tb, key, value):
    """Put `value` on the bus and in the model."""
    tb.bus.words[key] = tb.slave.memory[key] = value


def agree(tb):
    """The bus holds what the model holds, and nobody broke a rule."""
    assert not tb.bus.faults, tb.bus.faults
    for key, value in tb.bus.words.items():
        item = tb.slave.memory[key]
        assert item == value, f"{key}: on the bus {value:04X}, in the model {item:04X}"


def adopt(tb):
    """What a request that failed has left on the bus is what the model knows from now on."""
    for key, value in tb.bus.words.items():
        tb.slave.memory[key] = value


async def ask(tb, pdu, transfers=None, address=OWN):
    """One request to device and model, and what it did on the bus."""
    tb.bursts[:] = [0, 0]
    answer = await tb.both(frames.adu(address, pdu), timing=False, patience=30_000 * CLOCK_PS)
    agree(tb)
    if transfers is not None:
        assert len(tb.bus.log) == transfers, f"{len(tb.bus.log)} transfers instead of {transfers}: {tb.bus.log}"
        assert tb.bursts[0] == 1, f"{frames.text(pdu)}: {tb.bursts[0]} bursts"
    return answer


async def fails(tb, pdu, code=EX.FAILURE):
    """One request that must be answered with an exception; the answer."""
    answer = await tb.query(frames.adu(OWN, pdu))
    expected = frames.adu(OWN, bytes([pdu[0] | 0x80, code]))
    assert answer, f"{frames.text(pdu)}: silence"
    seen = frames.text(answer.data)
    assert answer.data == expected, f"{frames.text(pdu)}: expected {frames.text(expected)}, seen {seen}"
    return answer


@cocotb.test(**LIMIT)
@cocotb.parametrize(odds=[0, 0.5])
async def random_waits(dut, odds):
    """Every function, in one burst each; coils are data bit 0 whatever the other bits are."""
    tb = await bench(dut)
    tb.bus.hesitate(odds)
    for pdu, transfers in requests():
        tb.bus.begin(wait=lambda: tb.rng.choice((0, 0, 1, 5, 30)) if odds else 0)
        await ask(tb, pdu, transfers)
        for write in (0, 1):
            items = [item for w, (_, item), _ in tb.bus.log if w == write]
            assert items == list(range(items[0], items[0] + len(items))) if items else True, items
    await tb.finish()


@cocotb.test(**LIMIT)
async def tables_end_where_they_end(dut):
    """02 outside the tables, and nothing on the bus."""
    tb = await bench(dut)
    for code, space in (
        (FC.READ_COILS, Space.COILS),
        (FC.READ_DISCRETES, Space.DISCRETES),
        (FC.READ_INPUTS, Space.INPUTS),
        (FC.READ_HOLDINGS, Space.HOLDINGS),
    ):
        base, count = tb.slave.config.tables[space]
        for first, quantity in ((base, 1), (base + count - 1, 1), (base + count - 1, 2), (base + count, 1)):
            exists = first + quantity <= base + count
            tb.bus.begin()
            answer = await ask(tb, frames.read(code, first, quantity))
            assert (answer[1] == code) == exists and len(tb.bus.log) == exists * quantity
    tb.apply(write_lock=1)
    tb.bus.begin()
    assert (await ask(tb, frames.write_register(REGISTER, 1)))[2] == EX.ADDRESS and not tb.bus.log
    await tb.finish()


@cocotb.test(**LIMIT)
async def codes_of_a_missing_table_are_missing(dut):
    """A table of size 0 answers 01 as behind every other bank, a wrong length included; one that exists 02 and 03."""
    tb = await bench(dut)
    for code, space in (
        (FC.READ_COILS, Space.COILS),
        (FC.READ_DISCRETES, Space.DISCRETES),
        (FC.READ_INPUTS, Space.INPUTS),
        (FC.READ_HOLDINGS, Space.HOLDINGS),
    ):
        base, count = tb.slave.config.tables[space]
        for pdu, otherwise in (
            (frames.read(code, base, 1), None),
            (frames.read(code, base + count, 1), EX.ADDRESS),
            (frames.read(code, base, 0), EX.VALUE),
            (bytes([code, 0]), EX.VALUE),
        ):
            tb.bus.begin()
            answer = await tb.query(frames.adu(OWN, pdu))
            wanted = EX.FUNCTION if not count else otherwise
            seen = answer.data[2] if answer.data[1] & 0x80 else None
            assert seen == wanted, f"{frames.text(pdu)}: expected {wanted}, seen {seen}"
            assert len(tb.bus.log) == (wanted is None)
    await tb.finish()


@cocotb.test(skip=not AXIL, **LIMIT)
async def file_records(dut):
    """The bridge makes an address of file and record; on Wishbone the file number is beside the address."""
    tb = await bench(dut)
    values = [tb.rng.getrandbits(16) for _ in range(4)]
    tb.bus.begin()
    await ask(tb, frames.write_files((FILE, RECORD, values)))
    await ask(tb, frames.read_files((FILE, RECORD - 1, 6)))
    item = tb.slave.config.record_item(FILE, RECORD)
    assert tb.bus.log[:4] == [(1, (Space.FILES, item + n), v) for n, v in enumerate(values)], tb.bus.log
    await tb.finish()


@cocotb.test(**LIMIT)
async def errors_are_exception_04(dut):
    """Any error at any transfer ends the request with 04; the line goes on."""
    tb = await bench(dut)
    tb.bus.hesitate(0.3)
    for number, (pdu, transfers) in enumerate(requests()):
        for at in sorted({0, transfers // 2, transfers - 1} if transfers < 5 else {0, transfers - 1}):
            for kind in tb.bus.errs if at == 0 else tb.bus.errs[number % len(tb.bus.errs) :][:1]:
                tb.bus.begin(errors={at: kind})
                await fails(tb, pdu)
                assert len(tb.bus.log) == at, f"{frames.text(pdu)}, error at {at}: {tb.bus.log}"
                assert not tb.bus.faults, tb.bus.faults
    adopt(tb)
    tb.bus.begin()
    await ask(tb, *requests()[-1])


@cocotb.test(**LIMIT)
async def errors_at_random(dut):
    """Errors in a fifth of the requests, waits everywhere: 04 or what the model says."""
    tb = await bench(dut)
    tb.bus.hesitate(0.4)
    for _ in range(12):
        pdu, transfers = tb.rng.choice(requests())
        at = tb.rng.randrange(5 * transfers)
        tb.bus.begin(errors={at: tb.rng.choice(tb.bus.errs)}, wait=lambda: tb.rng.choice((0, 0, 3)))
        if at < transfers:
            await fails(tb, pdu)
            adopt(tb)
        else:
            await ask(tb, pdu, transfers)


@cocotb.test(**LIMIT)
async def dead_bus(dut):
    """A transfer that is not answered: 04 after the stall limit, on AXI then 04 at once until the bus is back, and then
    everything as if nothing had been; the late answer is no answer to anything."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    for number, (pdu, transfers) in enumerate(requests()[0 if AXIL else 1 :: 1 if AXIL else 2]):
        for at in sorted({0, transfers - 1} if number % 3 == 0 else {number % transfers}):
            tb.bus.begin(silent=at)
            answer = await fails(tb, pdu)
            late = tb.latency(answer) - STALL_BITS
            assert -1 <= late <= 2 + PROCESSING_CLOCKS / tb.setup.bit_time, f"answered {late:.1f} bits after the limit"
            assert int(dut.burst_o.value) == 0, "the burst goes on"
            taken, before = tb.bus.number, dict(tb.bus.words)
            if AXIL:
                assert int(dut.hung_o.value) == 1
                await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 2048, 1)))  # 02 as ever
                other, _ = tb.rng.choice(requests())
                answer = await fails(tb, other)
                assert tb.latency(answer) <= PROCESSING_CLOCKS / tb.setup.bit_time, "04 is not prompt"
                assert tb.bus.number == taken and tb.bus.words == before, "a transfer behind the silent one"
            tb.bus.recover()
            await tb.clocks(30)
            assert int(dut.hung_o.value) == 0
            changed = {k for k in tb.bus.words if tb.bus.words[k] != before.get(k)}
            assert len(changed) <= 1, f"written late: {changed}"
            adopt(tb)
            tb.bus.begin()
            await ask(tb, pdu, transfers)
    await tb.finish()


@cocotb.test(**LIMIT)
async def late_answer_meets_the_next_request(dut):
    """The bus comes back at any moment of the next request: it gets 04 or its own data, never the late ones."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    read = frames.read(FC.READ_HOLDINGS, REGISTER, 3)
    other = frames.read(FC.READ_INPUTS, REGISTER, 3)
    codes = set()
    for pdu, step in ((read, 8), (frames.write_registers(REGISTER, [0xDEAD, 0xBEEF]), 20)):
        for clocks in range(0, 120, step) if AXIL else ():
            tb.bus.begin(silent=0)
            await fails(tb, pdu)
            cocotb.start_soon(_recover(tb, frames.adu(OWN, other), clocks))
            answer = await tb.query(frames.adu(OWN, other))
            adopt(tb)
            expected = tb.slave.request(frames.adu(OWN, other))
            failed = frames.adu(OWN, bytes([other[0] | 0x80, EX.FAILURE]))
            assert answer and answer.data in (expected, failed), f"{clocks}: {answer and frames.text(answer.data)}"
            codes.add(answer.data[1])
            assert not tb.bus.faults, tb.bus.faults
    assert len(codes) == (2 if AXIL else 0), "the bus came back too early or too late each time"


async def _recover(tb, line, clocks):
    """Give the bus back `clocks` after t3.5 behind `line`."""
    await Timer(round(len(line) * tb.character * CLOCK_PS + tb.t35) + clocks * CLOCK_PS, "ps")
    tb.bus.recover()


@cocotb.test(skip=not AXIL, **LIMIT)
@cocotb.parametrize(stuck=["aw", "w", "aw w", "ar", "b", "r"])
async def stuck_channel(dut, stuck):
    """A channel that is never ready or never valid: 04, valid stands until it is taken, and then all is well again."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    write, read = tb.bus.slave.write_if, tb.bus.slave.read_if
    channels = [getattr(write if c in ("aw", "w", "b") else read, f"{c}_channel") for c in stuck.split()]
    writes = stuck not in ("ar", "r")
    value = 0x5AFE
    for pdu, transfers in requests():
        if pdu[0] not in (WRITING if writes else READING):
            continue
        for channel in channels:
            channel.pause = True
        tb.bus.begin()
        await fails(tb, pdu)
        await fails(tb, frames.write_register(REGISTER, value))
        await fails(tb, frames.read(FC.READ_HOLDINGS, REGISTER, 2))
        assert not stuck.startswith("a") or not tb.bus.log, "a transfer without its address"
        for channel in channels:
            channel.pause = False
        await tb.clocks(30)
        assert int(dut.hung_o.value) == 0
        assert len(tb.bus.log) == 1, f"one transfer was on its way, the bus saw {tb.bus.log}"
        adopt(tb)
        tb.bus.begin()
        await ask(tb, pdu, transfers)
    await tb.finish()


@cocotb.test(**LIMIT)
async def dead_bus_in_a_broadcast(dut):
    """Silence, and the next request is answered."""
    tb = await bench(dut, stall_limit=STALL_BITS)
    tb.bus.begin(silent=0)
    patience = 3000 * CLOCK_PS
    assert await tb.query(frames.adu(BROADCAST, frames.write_register(REGISTER, 7)), patience) is None
    tb.bus.recover()
    await tb.clocks(30)
    adopt(tb)
    tb.bus.begin()
    await ask(tb, *requests()[2])
    await tb.finish()


# Clocks that burst_o is high on a bus without waits, in all: docs/buses.md gives them for each transfer.
BURSTS = {
    "30 registers read": (frames.read(FC.READ_HOLDINGS, 0, 30), 30),
    "30 registers written": (frames.write_registers(0, list(range(30))), 30),
    "80 bits read": (frames.read(FC.READ_DISCRETES, 0, 80), 80),
    "17H, 20 written and 20 read": (frames.read_write(0, 20, 0, list(range(20))), 40),
}
# The models answer in the clock behind the strobe; of each byte of bits one more clock is the core's.
TRANSFER_CLOCKS = {True: (5, 4), False: (3, 2)}  # (register, bit)
OVERHEAD_CLOCKS = 50  # between the two halves of 17H


@cocotb.test(**LIMIT)
async def bursts_take_their_time(dut):
    tb = await bench(dut)
    for name, (pdu, transfers) in BURSTS.items():
        tb.bus.begin()
        await ask(tb, pdu, transfers)
        each = TRANSFER_CLOCKS[AXIL][pdu[0] == FC.READ_DISCRETES]
        rest = tb.bursts[1] - each * transfers
        assert 0 <= rest <= OVERHEAD_CLOCKS, f"{tb.bus.kind}: {name} took {tb.bursts[1]} clocks"
    await tb.finish()
