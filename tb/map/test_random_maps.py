# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random maps: the generated bank against the oracle of its map. MAPS is their number, SEED chooses them."""

import os
import random

import pytest
from harness.volume import volume
from hypothesis import Phase, given, settings
from hypothesis import seed as seeded
from modbus_map import dump

from map import random_maps
from map.batch import ADDRESS, Batch
from map.devices import relay_box, small_drive
from map.match import Match

COUNT = int(os.environ.get("MAPS", volume("random maps")))
SHARE = 500  # maps of one test
BATCH = 30  # maps in one compilation
MANY = 60  # plays with a device that has every kind of point
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
