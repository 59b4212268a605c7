# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random maps: the generated bank against the oracle of its map. MAPS is their number, SEED chooses them."""

import os
import random

import pytest
from harness.volume import volume

from map import random_maps
from map.batch import Batch
from map.match import Match

BATCH, REQUESTS = 25, 50


def test_random_maps_agree_with_their_oracle(seed):
    count = int(os.environ.get("MAPS", volume("random maps")))
    print(f"seed {seed}, {count} maps of {REQUESTS} requests")
    for first in range(0, count, BATCH):
        rng = random.Random(f"{seed} {first}")
        devices = [random_maps.random_device(rng, f"m{first + n}") for n in range(min(BATCH, count - first))]
        batch = Batch(devices)
        for number in range(len(devices)):
            match = Match(batch, number, random.Random(f"{seed} {first + number} requests"))
            for request in range(REQUESTS):
                try:
                    if request % 7 == 0:
                        match.host()
                    match.step()
                except AssertionError as error:
                    pytest.fail(f"seed {seed}, map {first + number}, request {request}: {error}", pytrace=False)
