# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Run-time settings and the outputs towards the host: delay, driver enable, alive, host port."""

import cocotb
from cocotb.triggers import RisingEdge, Timer, with_timeout
from harness.bench import CLOCK_PS, PARAMETERS, PROCESSING_CLOCKS, Bench
from harness.build import DEFAULT_CLK_HZ
from harness.line import now
from harness.volume import volume
from protocol import frames
from protocol.defs import EX, FC, Space

OWN, OTHER = 17, 18
READ = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 2))
WORDS = 20


@cocotb.test()
@cocotb.parametrize(delay=[0, 1, 7, 100, 1000])
async def response_delay(dut, delay):
    """Counts in bit times on top of what the answer takes anyway."""
    tb = await Bench.start(dut)
    assert await tb.both(READ) is not None
    normal, tb.longest_latency = tb.longest_latency, 0.0
    tb.apply(response_delay=delay)
    assert await tb.both(READ) is not None
    assert normal <= 2 + PROCESSING_CLOCKS / tb.setup.bit_time, f"{normal} bits late"
    beyond = tb.longest_latency - normal
    assert -0.3 <= beyond <= 1.3, f"a delay of {delay} bits puts the answer off by {delay + beyond:.2f} bits"
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(lead=[0, 1, 5, 11, 15], tail=[0, 1, 6, 15])
async def driver_enable_lead_and_tail(dut, lead, tail):
    tb = await Bench.start(dut, de_lead=lead, de_tail=tail)
    for _ in range(2):
        assert await tb.both(READ) is not None
        await tb.silence()
    await tb.finish()


@cocotb.test()
async def settings_change_while_idle(dut):
    """Address, rate and delay are inputs: a change takes hold with the next frame."""
    tb = await Bench.start(dut)
    for address, bit_time in ((17, 8), (33, 11), (247, 9), (1, 16), (17, 8)):
        tb.apply(address=address, bit_time=bit_time)
        await tb.silence()
        request = frames.adu(address, frames.write_register(1, address))
        assert await tb.both(request, note=f"{bit_time} clocks a bit") is not None
    await tb.finish()


@cocotb.test()
async def receive_activity_is_shown(dut):
    tb = await Bench.start(dut)
    assert int(dut.rx_active_o.value) == 0
    sender = cocotb.start_soon(tb.line.send(READ))
    await with_timeout(RisingEdge(dut.rx_active_o), 100 * tb.bit, "ps")
    assert not sender.done(), "rx_active_o rises only after the frame"
    await sender
    await tb.line.answer(tb.t35 + 400 * tb.bit)
    await tb.silence()
    assert int(dut.rx_active_o.value) == 0, "rx_active_o stays"
    await tb.finish()


@cocotb.test()
async def alive_follows_good_frames_for_us(dut):
    """Rises with a good frame for us, falls ALIVE_TIMEOUT_MS after the last one."""
    tb = await Bench.start(dut)
    timeout_ms = PARAMETERS.get("ALIVE_TIMEOUT_MS", 0)
    bad = [frames.bad_crc(READ), frames.adu(OTHER, READ[1:-2]), READ[:5]]
    for line in bad:
        await tb.both(line)
        assert int(dut.alive_o.value) == 0, f"alive after {frames.text(line)}"
    await tb.both(READ)
    assert int(dut.alive_o.value) == 1, "a good frame for us does not raise alive_o"
    if not timeout_ms:
        await tb.clocks(100_000)
        assert int(dut.alive_o.value) == 1, "alive_o falls without a time-out"
        return await tb.finish()
    millisecond = PARAMETERS.get("CLK_HZ", DEFAULT_CLK_HZ) * CLOCK_PS // 1000
    for _ in range(2):
        heard = cocotb.start_soon(good_frame_time(dut))
        await tb.both(READ)
        last = await heard
    # traffic that is not for us, or bad, does not keep it up
    while now() < last + (timeout_ms - 2) * millisecond:
        assert int(dut.alive_o.value) == 1, "alive_o fell early"
        await tb.both(bad[(now() // millisecond) % len(bad)])
    while int(dut.alive_o.value):
        assert now() < last + (timeout_ms + 3) * millisecond, "alive_o stays"
        await Timer(millisecond // 50, "ps")
    late = (now() - last) / millisecond - timeout_ms
    assert -1 <= late <= 1.1, f"alive_o fell {late:.2f} ms after its time"
    await tb.both(READ)
    assert int(dut.alive_o.value) == 1, "alive_o does not come back"
    await tb.finish()


async def good_frame_time(dut):
    """When frame_stb_o rises next."""
    await RisingEdge(dut.frame_stb_o)
    return now()


@cocotb.test()
async def host_port_reaches_every_table(dut):
    tb = await Bench.start(dut)
    files, records = tb.slave.config.files
    spaces = {**tb.slave.config.tables, Space.FILES: (0, files * records)}
    for space, (base, count) in spaces.items():
        for item in sorted({base - 1, base, base + count - 1, base + count, 0, 0xFFFF}):
            if item not in range(65536):
                continue
            exists = base <= item < base + count
            value = 1 if space in (Space.COILS, Space.DISCRETES) else 0xC0DE
            assert (await tb.host(space, item, write=value) is not None) == exists, (space, item)
            seen = await tb.host(space, item)
            assert seen == (value if exists else None), f"{space.name} {item}: {seen}"
            if exists:
                await tb.host(space, item, write=0)
    for space in (5, 6, 7):
        assert await tb.host(space, 0) is None, f"space {space} answers"
        assert await tb.host(space, 0, write=1) is None, f"space {space} takes a write"
    await tb.finish()


@cocotb.test()
async def bits_are_data_bit_0(dut):
    """The other data bits of a coil are ignored when written and 0 when read."""
    tb = await Bench.start(dut)
    base, count = tb.slave.config.tables[Space.COILS]
    if count > 1:
        assert await tb.host(Space.COILS, base, write=0xFFFE) is not None
        assert await tb.host(Space.COILS, base) == 0
        assert await tb.host(Space.COILS, base, write=0xFFFF) is not None
        assert await tb.host(Space.COILS, base) == 1
        assert await tb.host(Space.COILS, base + 1) == 0
        await tb.host(Space.COILS, base, write=0)
    await tb.finish()


@cocotb.test()
async def host_and_line_share_the_memory_without_tearing(dut):
    """The host reads a block again and again while the line rewrites it: always one whole block.

    The host holds cyc over the block, as an arbiter would; the core's burst waits or goes first.
    """
    tb = await Bench.start(dut)
    base, count = tb.slave.config.tables[Space.HOLDINGS]
    words = min(WORDS, count)
    stop, blocks = [], []

    async def host():
        pause = tb.rng
        while not stop:
            await RisingEdge(dut.clk_i)
            block = []
            dut.host_cyc_i.value, dut.host_we_i.value = 1, 0
            for i in range(words):
                dut.host_stb_i.value = 1
                dut.host_adr_i.value = (int(Space.HOLDINGS) << 16) | (base + i)
                while True:
                    await RisingEdge(dut.clk_i)
                    if int(dut.host_ack_o.value):
                        break
                block.append(int(dut.host_dat_o.value))
            dut.host_cyc_i.value, dut.host_stb_i.value = 0, 0
            blocks.append(block)
            await tb.clocks(pause.randrange(1, 60))

    reader = cocotb.start_soon(host())
    values = volume("blocks rewritten beside a host")
    for value in range(1, values + 1):
        pdu = frames.write_registers(base, [value] * words)
        assert await tb.both(frames.adu(OWN, pdu), timing=False) is not None
    stop.append(True)
    await reader
    torn = [b for b in blocks if len(set(b)) != 1]
    assert not torn, f"{len(torn)} of {len(blocks)} blocks torn, for example {torn[0]}"
    assert len({b[0] for b in blocks}) > values // 3, "the host saw too few of the written values"
    await tb.finish()


@cocotb.test()
async def core_waits_for_a_host_that_keeps_the_bus(dut):
    tb = await Bench.start(dut)
    base, _ = tb.slave.config.tables[Space.HOLDINGS]
    request = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, base, 1))
    dut.host_cyc_i.value = 1
    await tb.line.send(request)
    assert await tb.line.answer(tb.t35 + 2000 * tb.bit) is None, "answered without the bus"
    dut.host_cyc_i.value = 0
    answer = await tb.line.answer(400 * tb.bit)
    assert answer and answer.data == tb.slave.request(request), f"seen {answer}"
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(drop=[0, 1], delay=[0, 30])
async def late_answer_may_be_dropped(dut, drop, delay):
    """The host keeps the memory until the master asks again: with drop_late no answer to the first request.

    The next good frame after t3.5 is answered. An answer that was dropped counts as no response.
    """
    tb = await Bench.start(dut, drop_late=drop, response_delay=delay)
    write = frames.adu(OWN, frames.write_register(3, 0x4711))
    for again in (1, 0, 3, 8):
        dut.host_cyc_i.value = 1
        await tb.line.send(write)
        await tb.silence()
        if again:
            await tb.line.send(READ[:again])
        dut.host_cyc_i.value = 0
        answer = await tb.line.answer(400 * tb.bit)
        dropped = drop and again
        assert (answer is None) == bool(dropped), f"{again} characters heard: {answer}"
        if answer:
            assert answer.data == write
        assert tb.strobes["overrun"] == int(again > 0), "heard during the work"
        tb.strobes.clear()
        tb.slave.request(write)
        tb.slave.counters["slave_no_response"] += bool(dropped)
        await tb.silence()
        got = await tb.query(READ)
        assert got and got.data == tb.slave.request(READ), "the next frame is not answered"
        await tb.compare_counters(f"{again} characters heard")
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(limit=[2, 10, 100])
async def spikes_do_not_hold_the_stall_limit(dut, limit):
    """The host keeps the memory; exception 06 comes after the stall limit whatever spikes there are."""
    tb = await Bench.start(dut, bit_time=32, stall_limit=limit)
    for period, width in ((0.31, 0.12), (0.97, 0.2), (1.0, 0.24)):
        dut.host_cyc_i.value = 1
        tb.sent = await tb.line.send(READ)
        stop = []

        async def spikes(stop=stop, period=period, width=width):
            while not stop:
                await tb.line.hold_low(width)
                await Timer(round((period - width) * tb.bit), "ps")

        noise = cocotb.start_soon(spikes())
        begin = await tb.line.answer_begins(tb.t35 + (limit + 20) * tb.bit)
        stop.append(True)
        await noise
        assert begin is not None, "no answer while there are spikes"
        answer = await tb.line.answer(tb.bit)
        assert answer.data == frames.adu(OWN, bytes([FC.READ_HOLDINGS | 0x80, 6])), f"seen {answer}"
        bits = tb.latency(answer)
        assert limit - 1 <= bits <= limit + 1 + PROCESSING_CLOCKS / 32, f"stalled for {bits:.1f} bits, limit {limit}"
        dut.host_cyc_i.value = 0
        await tb.silence()
    await tb.finish()


@cocotb.test()
async def idle_tells_when_settings_may_change(dut):
    """A rate register: the answer to its write still goes out at the old rate, then idle_o rises."""
    tb = await Bench.start(dut, bit_time=16, response_delay=10, de_tail=3)
    request = frames.adu(OWN, frames.write_register(1, 9))
    assert int(dut.idle_o.value) == 1
    for bit_time in (9, 23, 8):
        expected = tb.slave.request(request)
        sender = cocotb.start_soon(tb.line.send(request))
        await with_timeout(RisingEdge(dut.write_stb_o), 400 * tb.bit, "ps")
        await sender
        assert int(dut.idle_o.value) == 0, "idle while a request is worked on"
        changed = cocotb.start_soon(with_timeout(RisingEdge(dut.idle_o), 400 * tb.bit, "ps"))
        answer = await tb.line.answer(400 * tb.bit)
        await changed
        assert answer and answer.data == expected
        assert answer.de_fall <= now(), "idle while the driver is on"
        tb.apply(bit_time=bit_time)
    await tb.silence()
    assert await tb.both(request) is not None
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(limit=[0, 40], strobes=[0, 1])
async def range_that_does_not_exist_needs_no_memory(dut, limit, strobes):
    """While the host holds the memory: 02 at once outside the tables (protocol digest 7.1), else 06 at the limit.

    The block of the host stays one piece meanwhile, whether it pauses under its cyc or accesses again and again.
    """
    tb = await Bench.start(dut, stall_limit=limit)
    base, count = tb.slave.config.tables[Space.HOLDINGS]
    stop, seen = [], []

    async def host():
        dut.host_cyc_i.value, dut.host_we_i.value = 1, 0
        dut.host_adr_i.value = (int(Space.HOLDINGS) << 16) | base
        dut.host_stb_i.value = strobes
        err, ack, data = dut.host_err_o, dut.host_ack_o, dut.host_dat_o
        while not stop:
            if strobes:
                await RisingEdge(dut.clk_i)
            else:
                await tb.clocks(100)
            assert not int(err.value), "an item of the table answers err"
            if int(ack.value):
                seen.append(int(data.value))
        dut.host_cyc_i.value = dut.host_stb_i.value = 0

    await tb.host(Space.HOLDINGS, base, write=0x7788)
    task = cocotb.start_soon(host())
    for pdu in (
        frames.read(FC.READ_HOLDINGS, base + count, 1),
        frames.read(FC.READ_HOLDINGS, base + count - 1, 2),
        frames.write_registers(base + count - 1, [1, 2]),
    ):
        answer = await tb.query(frames.adu(OWN, pdu))
        wanted = frames.adu(OWN, bytes([pdu[0] | 0x80, EX.ADDRESS]))
        assert answer and answer.data == wanted, f"{frames.text(pdu)}: seen {answer and frames.text(answer.data)}"
        assert tb.latency(answer) < 4 + PROCESSING_CLOCKS / tb.setup.bit_time, "it has waited for the memory"
    pdu = frames.write_register(base, 0x1111)
    answer = await tb.query(frames.adu(OWN, pdu), patience=1000 * tb.bit)
    if limit:
        assert answer and answer.data == frames.adu(OWN, bytes([pdu[0] | 0x80, EX.BUSY])), answer
    else:
        assert answer is None, "answered without the memory"
    assert set(seen) == ({0x7788} if strobes else set()), f"the line wrote into the block of the host: {set(seen)}"
    stop.append(True)
    await task
    if not limit:
        answer = await tb.line.answer(400 * tb.bit)
        assert answer and answer.data == frames.adu(OWN, pdu), answer
    await tb.host(Space.HOLDINGS, base, write=0)


@cocotb.test()
async def host_may_access_at_any_time(dut):
    """Single accesses all the time do not disturb a request, nor the other way round."""
    tb = await Bench.start(dut)
    base, count = tb.slave.config.tables[Space.HOLDINGS]
    own = base + count - 1
    stop = []

    async def host():
        value = 0
        while not stop:
            value = (value + 1) & 0xFFFF
            await tb.host(Space.HOLDINGS, own, write=value)
            assert await tb.host(Space.HOLDINGS, own) == value
            await tb.clocks(tb.rng.randrange(4))

    task = cocotb.start_soon(host())
    for number in range(volume("blocks beside a host's accesses")):
        words = [tb.rng.getrandbits(16) for _ in range(min(10, count - 1))]
        request = frames.adu(OWN, frames.write_registers(base, words))
        assert await tb.both(request, timing=False, note=f"{number}") is not None
        request = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, base, len(words)))
        assert await tb.both(request, timing=False, note=f"{number}") is not None
    stop.append(True)
    await task
    await tb.host(Space.HOLDINGS, own, write=0)
    await tb.finish()
