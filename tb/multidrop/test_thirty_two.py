# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""32 compiled slaves on one line: every address, random traffic, drivers that lead and trail, clocks that differ.

SEED chooses addresses, contents and traffic; FULL=1 plays ten times as much.
"""

import contextlib

import pytest
from harness.build import NO_FLOORS, function_mask
from harness.volume import volume
from harness.wave import LineError
from protocol import frames
from protocol.defs import BROADCAST, DIAGNOSTIC_FUNCTIONS, FC, Sub

from .compiled import Bus

NODES = 32
REQUESTS = volume("random requests on 32 compiled slaves")
ITEMS = 8
PLAIN = (FC.READ_COILS, FC.READ_HOLDINGS, FC.WRITE_COIL, FC.WRITE_REGISTER, FC.WRITE_COILS, FC.WRITE_REGISTERS)
BUILD = {
    **NO_FLOORS,
    **{f"{table}_COUNT": ITEMS for table in ("COIL", "DISCRETE", "INPUT", "HOLDING")},
    "FUNCTION_CODES": function_mask((*PLAIN, *DIAGNOSTIC_FUNCTIONS)),
}
READ = frames.read(FC.READ_HOLDINGS, 0, 3)
ASK_SOON = 4.0  # characters, where clocks differ: t3.5 of the slowest, and some


@pytest.fixture
def bus(seed):
    """A line of NODES slaves; `begin` is for the test, after its settings."""
    bus = Bus(NODES, BUILD, seed)
    yield bus
    bus.close()


def request(bus):
    """(line, what it is): mostly for a node, now and then for nobody or everybody, sometimes spoiled."""
    rng = bus.rng
    kind = rng.choices(("node", "stranger", "broadcast", "silence", "restart"), (70, 8, 10, 4, 8))[0]
    node, item, word = rng.choice(bus.nodes), rng.randrange(ITEMS + 1), rng.getrandbits(16)
    address = {"stranger": rng.randrange(256), "broadcast": BROADCAST}.get(kind, node.address)
    if kind == "silence":
        return frames.adu(address, frames.diagnostics(Sub.LISTEN_ONLY)), kind
    if kind == "restart":
        silenced = [n.address for n in bus.nodes if n.slave.listen_only]
        return frames.adu(rng.choice(silenced or [address]), frames.restart(rng.random() < 0.5)), kind
    pdu = rng.choice(
        (
            frames.read(FC.READ_HOLDINGS, item, rng.randint(0, 4)),
            frames.read(FC.READ_COILS, item, rng.randint(1, 3)),
            frames.write_register(item, word),
            frames.write_coil(item, word & 1),
            frames.write_registers(item, [word, word ^ 0xFFFF]),
            frames.write_coils(item, [word & 1, word >> 1 & 1]),
            frames.diagnostics(rng.choice((Sub.QUERY_DATA, Sub.BUS_MESSAGE, Sub.SLAVE_NO_RESPONSE, Sub.CLEAR))),
            frames.bare(FC.GET_EVENT_COUNTER),
            frames.bare(FC.GET_EVENT_LOG),
            bytes([rng.randrange(128)]),
        )
    )
    line = frames.adu(address, pdu)
    if rng.random() < 0.1:
        return frames.bad_crc(line, 1 << rng.randrange(16)), "bad"
    return line, kind


def play(bus, count, seed, gap):
    """Random requests `gap` characters apart, compared one by one and as a whole now and then.

    Behind a restart the line is left silent for longer: the slave then listens for t3.5 before it hears anything.
    """
    kind = None
    kinds = dict.fromkeys(("node", "stranger", "broadcast", "silence", "restart", "bad"), 0)
    for number in range(count):
        wait = None if kind == "restart" else gap
        line, kind = request(bus)
        kinds[kind] += 1
        bus.ask(line, f"seed {seed}, request {number} ({kind})", wait)
        if number % 250 == 249:
            bus.check(f"seed {seed}, after request {number}")
    bus.check(f"seed {seed}, at the end")
    assert all(kinds.values()), f"some kind of request never came: {kinds}"


def test_every_address_answers_for_itself_only(bus):
    """32 answer with their own contents, nobody for the addresses between; all hear all of it and count it."""
    bus.begin()
    owners = {node.address: node for node in bus.nodes}
    strangers = [address for address in range(1, 256) if address not in owners]
    heard = 0
    for address in bus.rng.sample([*owners, 248, 255, *bus.rng.sample(strangers, 30)], len(owners) + 32):
        answer = bus.ask(frames.adu(address, READ), f"address {address}")
        node = owners.get(address)
        assert (answer is not None) == (node is not None)
        heard += 1 + (node is not None)
    for node in bus.nodes:  # what the models say is what the protocol says
        assert node.wanted == {"drives": 1, "frames": heard - 1, "errors": 0, "writes": 0}
        counters = node.slave.counters
        assert (counters["bus_message"], counters["slave_message"], len(node.slave.log)) == (heard - 1, 1, 2)
    bus.check()


def test_broadcast_reaches_all_and_nobody_answers(bus):
    bus.begin()
    assert bus.ask(frames.adu(BROADCAST, frames.write_registers(1, [0x1234, 0xABCD]))) is None
    assert bus.ask(frames.adu(BROADCAST, frames.write_coils(0, [1, 0, 1]))) is None
    assert bus.ask(frames.adu(BROADCAST, READ)) is None
    for node in bus.nodes:
        assert node.wanted["writes"] == 2 and node.slave.counters["slave_no_response"] == 3
    bus.check()


def test_listen_only_is_one_slaves_own(bus):
    """It hears and does nothing, broadcast writes included, until its own restart; all others go on."""
    bus.begin()
    for node in bus.rng.sample(bus.nodes, 8):
        held = bus.host(node, 3, 0)
        assert bus.ask(frames.adu(node.address, frames.diagnostics(Sub.LISTEN_ONLY))) is None
        assert bus.ask(frames.adu(node.address, READ)) is None
        assert bus.listen_only(node)
        assert bus.ask(frames.adu(BROADCAST, frames.write_register(0, held ^ 0x5555))) is None
        assert bus.host(node, 3, 0) == held, "a broadcast was obeyed in listen-only mode"
        assert bus.ask(frames.adu(BROADCAST, frames.restart())) is None
        assert bus.listen_only(node), "ended by a broadcast"
        assert bus.ask(frames.adu(node.address, frames.restart())) is None
        assert bus.ask(frames.adu(node.address, READ)) is not None
    bus.check()


def test_random_requests_to_anybody(bus, seed):
    """At exactly 3.5 characters behind each other; half of the drivers lead and trail by up to 15 bits."""
    for node in bus.nodes[::2]:
        node.de_lead, node.de_tail = bus.rng.choice((1, 2, 15)), bus.rng.choice((1, 7, 15))
    bus.begin()
    play(bus, REQUESTS, seed, gap=3.5)


def test_clocks_that_differ(seed):
    """Each node's clock is off by up to 1.5 %, some the most in either direction; bits are 16 clocks long."""
    bus = Bus(NODES, BUILD, seed, bit_time=16)
    for node in bus.nodes:
        node.rate = 1 + bus.rng.choice((-0.015, 0.015, bus.rng.uniform(-0.015, 0.015)))
        node.de_tail = bus.rng.choice((0, 1))
    bus.begin()
    play(bus, REQUESTS // 3, seed, gap=ASK_SOON)
    bus.close()


def test_two_of_one_address_collide(bus):
    """The bench itself: the mistake that puts two drivers on a line is seen."""
    first, second = bus.nodes[:2]
    second.slave.config.address = first.address
    second.de_tail = 3
    bus.begin()
    bus.send(frames.adu(first.address, READ))
    with contextlib.suppress(LineError):  # each by itself is clean
        bus.answer()
    assert bus.collisions > 10 * 11 * bus.bit_time, f"two answers, and {bus.collisions} clocks with two drivers"
