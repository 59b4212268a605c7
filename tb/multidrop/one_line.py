# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many slaves on one line: each answers for itself alone, and never do two drive it.

`Bus.ask` compares every node with its model after each request; `Bus.finish` looks at memory, counters and log.
"""

import os

import cocotb
from cocotb.triggers import Timer
from protocol import frames
from protocol.defs import BROADCAST, FC, LAST_ADDRESS, Space, Sub

from .bus import PARAMETERS, Bus

SEED = int(os.environ.get("BENCH_SEED", "1"))
COUNT = int(os.environ.get("BENCH_COUNT", "12"))
ITEMS = PARAMETERS["TABLE_COUNT"]
READ = frames.read(FC.READ_HOLDINGS, 0, 2)


def some(values):
    """A setting that half of the nodes have, 0 for the others."""
    return lambda rng: rng.choice(values) if rng.random() < 0.5 else 0


def request(bus):
    """(address, PDU) of any request: mostly for a node, now and then for nobody or everybody."""
    rng = bus.rng
    address = rng.choices((rng.choice(bus.nodes).address, rng.randrange(256), BROADCAST), (80, 10, 10))[0]
    item, word = rng.randrange(ITEMS), rng.getrandbits(16)
    pdu = rng.choice(
        (
            frames.read(FC.READ_HOLDINGS, item, rng.randint(1, 3)),
            frames.read(FC.READ_COILS, item, 1),
            frames.write_register(item, word),
            frames.write_coil(item, word & 1),
            frames.write_registers(item, [word, word ^ 0xFFFF]),
            frames.diagnostics(Sub.BUS_MESSAGE),
            frames.bare(FC.GET_EVENT_LOG),
        )
    )
    return address, pdu


@cocotb.test()
async def every_address_answers_for_itself(dut):
    """All others hear question and answer as good frames that are not for them, and keep silent."""
    bus = await Bus.start(dut, SEED)
    for node in bus.rng.sample(bus.nodes, len(bus.nodes)):
        before = {other.index: dict(other.wanted) for other in bus.nodes}
        answer = await bus.ask(frames.adu(node.address, READ), f"node {node.index}")
        words = [node.slave.memory[Space.HOLDINGS, item] for item in range(2)]
        assert answer == frames.adu(node.address, bytes([FC.READ_HOLDINGS, 4]) + frames.pack_words(words))
        for other in bus.nodes:  # what the models say is what the protocol says
            risen = {name: n - before[other.index][name] for name, n in other.wanted.items()}
            mine = {"drives": 1, "frames": 1} if other is node else {"drives": 0, "frames": 2}
            assert risen == {"errors": 0, "writes": 0, **mine}
    for node in (n for n in bus.nodes if n.slave.config.has_diagnostics):
        assert node.slave.counters["bus_message"] == 2 * len(bus.nodes) - 1
        assert node.slave.counters["slave_message"] == 1 and len(node.slave.log) == 2
    await bus.finish()


@cocotb.test()
async def nobody_answers_for_a_stranger(dut):
    bus = await Bus.start(dut, SEED)
    free = [address for address in range(1, 256) if not bus.at(address)]
    for address in (next(a for a in free if a <= LAST_ADDRESS), LAST_ADDRESS + 1, 255, bus.rng.choice(free)):
        assert await bus.ask(frames.adu(address, READ)) is None
    await bus.finish()


@cocotb.test()
async def broadcast_reaches_all_and_nobody_answers(dut):
    bus = await Bus.start(dut, SEED)
    for pdu in (frames.write_registers(1, [0x1234, 0xABCD]), frames.write_coil(3, True), READ):
        before = [node.wanted["writes"] for node in bus.nodes]
        assert await bus.ask(frames.adu(BROADCAST, pdu)) is None
        wrote = [node.wanted["writes"] - n for node, n in zip(bus.nodes, before)]
        assert wrote == [int(pdu != READ)] * len(bus.nodes)
    for node in bus.nodes:
        await node.looked_at()
        assert [await node.host(Space.HOLDINGS, item) for item in (1, 2)] == [0x1234, 0xABCD]
        assert await node.host(Space.COILS, 3) == 1
    await bus.finish()


@cocotb.test()
async def listen_only_is_one_slaves_own(dut):
    """It does nothing until its own restart, broadcast writes included; all others go on."""
    bus = await Bus.start(dut, SEED)
    silent = bus.nodes[0]
    other = bus.nodes[1]
    await silent.looked_at()
    held = await silent.host(Space.HOLDINGS, 0)
    assert await bus.ask(frames.adu(silent.address, frames.diagnostics(Sub.LISTEN_ONLY))) is None
    assert silent.slave.listen_only and int(dut.listen_only_o.value) == 1
    assert await bus.ask(frames.adu(silent.address, READ)) is None
    assert await bus.ask(frames.adu(BROADCAST, frames.write_register(0, held ^ 0xFFFF))) is None
    assert await bus.ask(frames.adu(BROADCAST, frames.restart())) is None
    assert await bus.ask(frames.adu(other.address, READ))
    assert await silent.host(Space.HOLDINGS, 0) == held, "a broadcast was obeyed in listen-only mode"
    assert await bus.ask(frames.adu(silent.address, frames.restart())) is None
    assert await bus.ask(frames.adu(silent.address, READ))
    await bus.finish()


@cocotb.test()
async def a_bad_frame_is_bad_for_all(dut):
    """Nobody answers it, whoever it was for; each counts it."""
    bus = await Bus.start(dut, SEED)
    frame = frames.adu(bus.nodes[0].address, READ)
    for line in (frames.bad_crc(frame), frames.swapped_crc(frame), frame[:3]):
        before = [node.wanted["errors"] for node in bus.nodes]
        assert await bus.ask(line) is None
        assert [node.wanted["errors"] - n for node, n in zip(bus.nodes, before)] == [1] * len(bus.nodes)
    await bus.finish()


@cocotb.test()
async def requests_follow_at_t35_with_drivers_that_lead_and_trail(dut):
    """The next request starts 3.5 characters behind the answer; a driver may be held up to 15 bits of them."""
    bus = await Bus.start(dut, SEED, de_lead=some((1, 3, 15)), de_tail=some((1, 2, 15)))
    nodes = [bus.rng.choice(bus.nodes) for _ in range(COUNT)]
    for number, node in enumerate(nodes):
        await bus.ask(frames.adu(node.address, READ), f"request {number}", gap=3.5)
    await bus.finish()


@cocotb.test()
async def random_requests_to_anybody(dut):
    bus = await Bus.start(dut, SEED, de_lead=some((1, 2)), de_tail=some((1, 4)))
    for number in range(COUNT):
        address, pdu = request(bus)
        line = frames.adu(address, pdu)
        if bus.rng.random() < 0.15:
            line = frames.bad_crc(line, 1 << bus.rng.randrange(16))
        await bus.ask(line, f"seed {SEED}, request {number}")
    await bus.finish()


@cocotb.test()
async def two_of_one_address_collide(dut):
    """The monitor itself: the only fault that puts two drivers on the line is seen."""
    bus = await Bus.start(dut, SEED)
    first, second = bus.nodes[:2]
    second.slave.config.address = first.address
    second.de_tail = 1
    bus.apply()
    await bus.line.send(frames.adu(first.address, READ))
    while not int(dut.de_o.value):
        await dut.de_o.value_change
    await Timer(10 * bus.character, "ps")
    two, undefined = bus.collisions()
    assert two >= 5 * bus.fmt.length * bus.bit_time, "two answers at once, and no collision is counted"
    assert undefined, "two answers with different contents, and the line is always 0 or 1"
