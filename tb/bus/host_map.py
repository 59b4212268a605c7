# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""One map for a CPU: tables, counters, log and settings, by AXI4-Lite or at the Wishbone side, beside the line."""

import os

import cocotb
from cocotb.triggers import RisingEdge
from harness.bench import PARAMETERS, Bench
from harness.volume import volume
from protocol import frames
from protocol.defs import EX, F8N1, F8O1, FC, Space, Sub

from bus.axil import WORD, Cpu
from bus.wishbone import Host

AXIL = bool(PARAMETERS.get("AXIL", 1))
MAP = bool(PARAMETERS.get("HOST_MAP", 1))
WRITES = bool(PARAMETERS.get("HOST_SETTINGS", 1))
SEED = int(os.environ.get("BENCH_SEED", "1"))
LIMIT = {"timeout_time": 20, "timeout_unit": "ms"}
OWN = 17
CORE = 5  # the space of the core
H = Space.HOLDINGS
READ = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 2))

# item: (value at the beginning, bits that exist)
SETTINGS = {
    0x80: (OWN, 0xFF),
    0x81: (8, 0xFFFF),
    0x82: (0, 0x3),
    0x83: (1, 0xF),
    0x84: (0, 0xFFF),
    0x85: (0, 0xFFFF),
    0x86: (0, 0xFF),
    0x88: (2, 0x3F),
    0x89: (0, 0xFF),
    0x8A: (0, 0xFFFE),
    0x8B: (0, 0x1),
}
IDLE = 0x8C
if PARAMETERS.get("BIT_FRACTIONS"):
    SETTINGS[0x87] = (0, 0xF)
if PARAMETERS.get("ASCII_MODE"):
    SETTINGS[0x82] = (0, 0x3F)
HEALTH = list(range(0x20, 0x28)) if PARAMETERS.get("LINE_HEALTH") else []
STATUS = [*range(3), *range(0x0A, 0x13), *range(0x40, 0x80)]
ADDRESS, BIT_TIME, FORMAT, OPTIONS, DELAY, STALL, DRIVER, FRACTION = range(0x80, 0x88)
STATE, EXCEPTION_STATUS, DIAGNOSTIC, LOCK = range(0x88, 0x8C)


class MapBench(Bench):
    """A bench whose counters are read by the CPU, in space 5."""

    def __init__(self, dut, seed):
        super().__init__(dut, seed)
        self.has_host = False
        self.cpu = WideCpu(dut) if AXIL else Host(dut, "host")

    async def clean(self):
        """The CPU clears what earlier tests have written."""
        for key in sorted(self.touched):
            assert await self.cpu.write(*key, 0)
        self.touched.clear()

    async def counter(self, address):
        value = await self.cpu.read(CORE, address)
        assert value is not None, f"item {address:02X} answers err"
        return value


class WideCpu(Cpu):
    """A CPU that knows space 5 too: an item is a word at {space, item, 00}."""

    async def write(self, space, item, value, size=WORD):
        return await super().write(space, item, value, size) if space != CORE else await self._core(item, value)

    async def read(self, space, item):
        return await super().read(space, item) if space != CORE else await self._core(item)

    async def _core(self, item, value=None):
        address = CORE << 18 | item << 2
        if value is not None:
            return not int((await self.bus.write(address, value.to_bytes(WORD, "little"))).resp)
        done = await self.bus.read(address, WORD)
        return None if int(done.resp) else int.from_bytes(done.data, "little")


async def bench(dut):
    """A bench with a CPU, its settings those of the RTL."""
    for port in ("awvalid", "wvalid", "arvalid", "bready", "rready"):
        getattr(dut, f"s_axil_{port}").value = 0
    for port in ("cyc", "stb", "we", "adr", "dat"):
        getattr(dut, f"host_{port}_i").value = 0
    return await MapBench.start(dut, SEED)


async def put(tb, item, value):
    """Write a setting; it must be taken."""
    assert await tb.cpu.write(CORE, item, value), f"item {item:02X} refuses {value:04X}"


async def refused(tb, pdu, code):
    """The request answers this exception code."""
    answer = await tb.query(frames.adu(tb.setup.address, pdu))
    wanted = frames.adu(tb.setup.address, bytes([pdu[0] | 0x80, code]))
    assert answer and answer.data == wanted, f"{frames.text(pdu)}: expected {code}, seen {answer}"


@cocotb.test(skip=not MAP, **LIMIT)
async def every_item_is_there_or_errs(dut):
    """Items 00 to FF and some beyond: values at the beginning, err for the others; then a write of ones."""
    tb = await bench(dut)
    for item in (*range(0x100), 0x180, 0x1000, 0x8080, 0xFF80, 0xFFFF):
        seen = await tb.cpu.read(CORE, item)
        if item in SETTINGS:
            assert seen == SETTINGS[item][0], f"item {item:02X}: {seen}"
        else:
            assert (seen is not None) == (item in (*STATUS, *HEALTH, IDLE)), f"item {item:04X}: {seen}"
    for item in (*range(0x90), 0xFF, 0x180, 0x8080):
        written = await tb.cpu.write(CORE, item, 0xFFFF)
        assert bool(written) == (item in HEALTH or (WRITES and item in SETTINGS)), f"write to {item:04X}"
        for other, (begins, mask) in SETTINGS.items():
            wanted = mask if written and other == item else begins
            assert await tb.cpu.read(CORE, other) == wanted, f"item {other:02X} behind a write to {item:04X}"
        if written and item in SETTINGS:
            await put(tb, item, SETTINGS[item][0])
    await tb.reset()


@cocotb.test(skip=MAP, **LIMIT)
async def left_out_it_errs_and_the_tables_stay(dut):
    tb = await bench(dut)
    for item in (0, 0x0B, 0x40, 0x80, 0x8C):
        assert await tb.cpu.read(CORE, item) is None
        assert not await tb.cpu.write(CORE, item, 1)
    assert await tb.cpu.write(H, 1, 0x55AA)
    tb.slave.memory[H, 1] = 0x55AA
    await tb.both(READ)
    await tb.cpu.write(H, 1, 0)


@cocotb.test(skip=not MAP, **LIMIT)
async def counters_log_and_status(dut):
    """What the line counts and logs is what the CPU reads."""
    tb = await bench(dut)
    await tb.reset()
    await tb.silence()
    for line in (READ, frames.bad_crc(READ), frames.adu(OWN, bytes([0x2A])), frames.adu(OWN + 1, READ[1:-2]), READ[:3]):
        await tb.both(line)
    await tb.compare_counters("traffic")
    for sub in (Sub.LISTEN_ONLY, Sub.RESTART):
        await tb.both(frames.adu(OWN, frames.diagnostics(sub)))
        await tb.compare_counters(sub.name)
    await tb.both(READ)
    await tb.compare_counters("restarted")


@cocotb.test(skip=not HEALTH, **LIMIT)
async def line_health_is_read_and_cleared(dut):
    """The words of modbus_line_health beside the line's own counters; a write to any of them sets all to 0."""
    tb = await bench(dut)
    await tb.reset()
    await tb.silence()

    async def words():
        return [await tb.cpu.read(CORE, item) for item in HEALTH]

    good = frames.adu(OWN + 1, READ[1:-2])
    for item in (HEALTH[0], HEALTH[-1], HEALTH[3]):
        for times in (1, 2):
            await tb.both(frames.bad_crc(READ))
            await tb.both(good)
            await tb.silence()
            found = await words()
            assert found[:6] == [0, 0, 0, 0, times, 0], f"bad check fields: {found}"
        await tb.compare_counters("beside the words")
        assert await tb.cpu.write(CORE, item, 0xFFFF)
        await tb.clocks(64)
        assert await words() == [0] * 8, f"cleared by item {item:02X}"


@cocotb.test(skip=not SETTINGS[0x82][1] & 4 or not (MAP and WRITES), **LIMIT)
async def ascii_mode_is_set(dut):
    """Bits 2 to 5 of item 82H: ASCII mode, eight bits in it, further periods; then RTU again."""
    tb = await bench(dut)
    await put(tb, FORMAT, 0b110100)
    assert await tb.cpu.read(CORE, FORMAT) == 0b110100
    await put(tb, FORMAT, 0b000100)
    tb.apply(ascii=1, fmt="7E1")
    await tb.silence()
    assert await tb.both(frames.ascii_adu(OWN, READ[1:-2])) is not None
    await put(tb, FORMAT, 0b001100)
    tb.apply(ascii=1, fmt="8E1")
    await tb.silence()
    assert await tb.both(frames.ascii_adu(OWN, READ[1:-2])) is not None
    await put(tb, FORMAT, 0)
    tb.apply(ascii=0, fmt="8E1")
    await tb.silence()
    assert await tb.both(READ) is not None


@cocotb.test(skip=not MAP, **LIMIT)
async def reading_never_disturbs_the_line(dut):
    """The CPU reads counters, log and settings all the time, a table between them."""
    tb = await bench(dut)
    await tb.reset()
    await tb.silence()
    stop, reads = [], []

    async def reader():
        while not stop:
            item = tb.rng.choice(STATUS)
            value = await tb.cpu.read(CORE, item)
            assert value is not None
            reads.append(item)
            assert await tb.cpu.read(CORE, BIT_TIME) == tb.setup.bit_time
            assert await tb.cpu.read(H, 60) == 0

    task = cocotb.start_soon(reader())
    requests = volume("requests beside a reading CPU")
    for number in range(requests):
        await tb.both(frames.adu(OWN, frames.write_registers(0, [number] * 20)), timing=False)
        await tb.both(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 20)), timing=False)
    stop.append(True)
    await task
    await tb.compare_counters("beside the CPU")
    assert len(reads) > 6 * requests


@cocotb.test(skip=not (MAP and WRITES), **LIMIT)
async def rate_format_and_address_are_set(dut):
    """The CPU waits for the idle line, then changes them; the next frame goes by them.  rst_i brings the first back."""
    tb = await bench(dut)
    for address, bit_time, fraction, fmt in ((33, 11, 7, F8O1), (247, 9, 12, F8N1), (5, 8, 0, F8N1)):
        fraction *= FRACTION in SETTINGS
        sender = cocotb.start_soon(tb.both(frames.adu(tb.setup.address, READ[1:-2])))
        await tb.clocks(60 * tb.setup.bit_time)
        assert await tb.cpu.read(CORE, IDLE) == 0, "idle in the middle of a frame"
        await sender
        for _ in range(2000):
            if await tb.cpu.read(CORE, IDLE) == 1:
                break
        else:
            raise AssertionError("never idle")
        items = {ADDRESS: address, BIT_TIME: bit_time, FORMAT: fmt.code, FRACTION: fraction}
        for item in items.keys() & SETTINGS:
            await put(tb, item, items[item])
        tb.apply(address=address, bit_time=bit_time, bit_fraction=fraction, fmt=fmt)
        await tb.silence()
        assert await tb.both(frames.adu(address, READ[1:-2])) is not None
    await tb.reset()
    tb.apply(address=OWN, bit_time=8, bit_fraction=0, fmt="8E1")
    await tb.silence()
    assert await tb.both(READ) is not None


@cocotb.test(skip=not (MAP and WRITES), **LIMIT)
async def options_delay_and_driver_are_set(dut):
    tb = await bench(dut)
    for setup, items in (
        ({"broadcast_en": 0}, {OPTIONS: 0b0000}),
        ({"broadcast_en": 1, "gap_count_only": 1}, {OPTIONS: 0b0011}),
        ({"gap_count_only": 0, "response_delay": 9}, {OPTIONS: 0b0001, DELAY: 9}),
        ({"response_delay": 0, "de_lead": 5, "de_tail": 3}, {DELAY: 0, DRIVER: 0x35}),
    ):
        for item, value in items.items():
            await put(tb, item, value)
        tb.apply(**setup)
        await tb.both(READ)
        await tb.both(frames.adu(0, frames.write_register(3, 0x1234)))
        await tb.silence()
    await put(tb, DRIVER, 0)
    await put(tb, STALL, 40)
    dut_holds = AXIL or setattr(dut.host_cyc_i, "value", 1)
    if not dut_holds:
        await refused(tb, frames.read(FC.READ_HOLDINGS, 0, 1), EX.BUSY)
        dut.host_cyc_i.value = 0
    await tb.reset()
    await tb.silence()


@cocotb.test(skip=not (MAP and WRITES), **LIMIT)
async def state_of_the_host_is_set(dut):
    tb = await bench(dut)
    write = frames.write_register(2, 7)
    await put(tb, STATE, 0b000011)  # busy, run
    await refused(tb, write, EX.BUSY)
    await put(tb, STATE, EX.PARITY << 2 | 2)
    await refused(tb, write, EX.PARITY)
    await put(tb, STATE, 0)
    await put(tb, EXCEPTION_STATUS, 0xA6)
    await put(tb, LOCK, 1)
    await put(tb, DIAGNOSTIC, 0x8001)
    tb.apply(run_indicator=0, exception_status=0xA6, write_lock=1, diagnostic=0x8000)
    answer = await tb.query(frames.adu(OWN, frames.bare(FC.REPORT_SERVER_ID)))
    assert answer.data[-3] == 0, "run indicator"
    answer = await tb.query(frames.adu(OWN, frames.bare(FC.READ_EXCEPTION_STATUS)))
    assert answer.data[2] == 0xA6
    await refused(tb, write, EX.ADDRESS)
    assert await tb.cpu.read(CORE, 0) & 0xFFFE == 0x8000, "diagnostic register"
    await put(tb, LOCK, 0)
    answer = await tb.query(frames.adu(OWN, write))
    assert answer.data == frames.adu(OWN, write)
    await tb.reset()
    for item, (begins, _) in SETTINGS.items():
        assert await tb.cpu.read(CORE, item) == begins, f"item {item:02X} behind rst_i"
    await tb.cpu.write(H, 2, 0)


@cocotb.test(skip=AXIL or not MAP, **LIMIT)
async def block_with_a_counter_in_it_is_one_piece(dut):
    """Under one cyc: registers, a counter, registers; the line that rewrites them is never in between."""
    tb = await bench(dut)
    stop, blocks = [], []

    async def host():
        while not stop:
            block = await tb.cpu.block(*((H, n) for n in range(5)), (CORE, 0x0B), *((H, n) for n in range(5, 10)))
            blocks.append(block[:5] + block[6:])
            await tb.clocks(tb.rng.randrange(1, 40))

    task = cocotb.start_soon(host())
    for value in range(1, 12):
        await tb.both(frames.adu(OWN, frames.write_registers(0, [value] * 10)), timing=False)
    stop.append(True)
    await task
    torn = [b for b in blocks if len(set(b)) != 1]
    assert not torn, f"torn: {torn[0]}"
    assert len({b[0] for b in blocks}) > 6
    await RisingEdge(dut.clk_i)
