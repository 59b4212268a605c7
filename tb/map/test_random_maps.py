# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random maps: the generated bank against the oracle of its map. MAPS is their number, SEED chooses them."""

import os
import random
import struct

import pytest
from harness.volume import volume
from hypothesis import Phase, given, settings
from hypothesis import seed as seeded
from modbus_map import dump
from modbus_map.rtl_plan import Plan
from protocol.frames import adu

from map import random_maps
from map.batch import ADDRESS, Batch
from map.devices import relay_box, small_drive
from map.match import Match

COUNT = int(os.environ.get("MAPS", volume("random maps")))
SHARE = 500  # maps of one test
BATCH = 30  # maps in one compilation
MANY = volume("plays of a map with every kind of point")  # plays with a device that has every kind of point
PLAYS, REQUESTS = 12, 8  # a play begins with a reset and has up to so many requests


def fault(match, seed, plays=PLAYS):
    """What is wrong with a bank, after the fewest requests that show it; nothing if all is well."""

    @seeded(seed)
    @settings(max_examples=plays, phases=[Phase.generate, Phase.shrink], **random_maps.PLAIN)
    @given(random_maps.plays(match.device, ADDRESS, REQUESTS))
    def play(drawn):
        frames, values = drawn
        match.begin(random.Random(values))
        match.host()
        for frame in frames:
            match.step(frame)

    try:
        play()
    except AssertionError as error:
        return str(error)
    return ""


def test_every_kind_of_point_agrees_with_its_oracle(seed):
    """Pairs, quads, floats, enums, arrays, memory, files, snapshots, limits, both word orders, in two devices."""
    devices = [small_drive(), relay_box()]
    batch = Batch(devices)
    for number in range(len(devices)):
        assert not (wrong := fault(Match(batch, number), seed + number, MANY)), f"seed {seed}: {wrong}"


def write(item, value):
    """The request that writes a whole item of holding registers."""
    made, index = item
    words = made.registers(value & ((1 << made.bits) - 1))
    first = made.addresses(index)[0]
    return adu(ADDRESS, struct.pack(f">BHHB{len(words)}H", 16, first, len(words), 2 * len(words), *words))


def test_limits_are_those_of_the_whole_value():
    """From one legal value to another whose first word, beside the old second one, would be none."""
    match = Match(Batch([small_drive(), relay_box()]), 0)
    match.begin(random.Random(1))
    for name, values in (("ramp", (65535, 65536, 65535)), ("offset", (-1, 3, -4, 0))):
        for value in values:
            match.step(write((match.device.point(name), 0), value))


def test_registers_read_their_reset_values_behind_a_reset():
    """Every register is read before a write, behind it, and behind the reset that follows; so are the inputs beside them."""
    match = Match(Batch([small_drive(), relay_box()]), 0)
    rng = random.Random(1)
    points = [p for p in match.device.table("holding_registers") if p.writable and p.readable and p.kind == "register"]
    assert Plan(match.device).reads_back and {point.bits for point in points} == {16, 32, 64}
    shown = [(4, p) for p in match.device.table("input_registers")]
    for _ in range(3):
        match.begin(rng)
        for repeat in range(2):
            for code, point in [*((3, p) for p in points), *shown]:
                match.step(adu(ADDRESS, struct.pack(">BHH", code, point.at, point.size)))
                for index in range(point.count):
                    match.step(adu(ADDRESS, struct.pack(">BHH", code, point.addresses(index)[0], point.width)))
            for point in points if repeat == 0 else ():
                for index in range(point.count):
                    legal = [item.raw for item in point.enum] or [point.maximum] if point.is_limited else []
                    match.step(write((point, index), legal[-1] if legal else rng.getrandbits(point.bits)))


@pytest.mark.parametrize("start", range(0, COUNT, SHARE))
def test_random_maps_agree_with_their_oracle(seed, start):
    end = min(start + SHARE, COUNT)
    print(f"seed {seed}, maps {start} to {end - 1} of up to {PLAYS * REQUESTS} requests")
    for first in range(start, end, BATCH):
        devices = random_maps.devices(seed + first, min(BATCH, end - first), f"m{first}_")
        batch = Batch(devices)
        for number, device in enumerate(devices):
            if wrong := fault(Match(batch, number), seed + first + number):
                pytest.fail(f"seed {seed}: {wrong}\n{dump.text(device)}", pytrace=False)
