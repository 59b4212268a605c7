# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Model against compiled slave over much random traffic: every answer, every strobe, all memory.

SEED chooses the traffic, FULL=1 plays a million requests, COUNT any number.
"""

import os
import random
from collections import Counter

import pytest
from mbrtu import build
from mbrtu.build import NO_FLOORS, model_config, table_parameters
from mbrtu.defs import ALL_FUNCTIONS, EX, EXCEPTION_FLAG, F8E1, F8N1, F8N2, F8O1, Space
from mbrtu.frames import adu, text
from mbrtu.model import Slave, characters
from mbrtu.traffic import Traffic

from differential.device import Device, LineError, library

MAPS = {
    "mapped": {
        **NO_FLOORS,
        **table_parameters(
            {
                Space.COILS: (300, 2100),
                Space.DISCRETES: (65000, 536),
                Space.INPUTS: (1, 130),
                Space.HOLDINGS: (1000, 300),
            }
        ),
        "READ_ONLY_BASE": 1200,
        "READ_ONLY_COUNT": 20,
    },
    "whole": {**NO_FLOORS, **table_parameters(dict.fromkeys(list(Space)[:4], (0, 65536)))},
    "overlaid": {**NO_FLOORS, "OVERLAY": 1, "HOLDING_COUNT": 140, "READ_ONLY_BASE": 100, "READ_ONLY_COUNT": 3},
}
SHARE = {"mapped": 0.6, "whole": 0.2, "overlaid": 0.2}
REQUESTS, FULL_REQUESTS = 20_000, 1_000_000
SETTINGS_EVERY, COMPARE_EVERY, WHOLE_COMPARE_EVERY = 40, 250, 5_000
BROADCAST_CLOCKS = 8_000  # the longest a broadcast may work on
PROCESSING_CLOCKS = 9_000  # the longest answer, bits included


class Match:
    """A device and a model that get the same traffic."""

    def __init__(self, parameters, seed):
        self.rng = random.Random(seed)
        self.slave = Slave(model_config("modbus_rtu_slave", parameters))
        self.device = Device(library(parameters))
        self.parameters = parameters
        self.traffic = Traffic(self.rng, self.slave.config)
        self.kinds, self.latest = Counter(), 0
        self.inputs, self.offset, self.touched = {}, 0.0, set()
        self.settings()
        self.device.reset()
        self.device.idle(self.t35 + 100)

    def settings(self):
        """Other run-time inputs."""
        rng, config = self.rng, self.slave.config
        self.fmt = rng.choice((F8E1, F8E1, F8O1, F8N2, F8N1))
        self.bit_time = rng.choice((8, 8, 8, 9, 11, 16, 23))
        config.address = rng.choice((1, 17, 17, 17, 247, rng.randint(1, 247)))
        config.broadcast = rng.random() < 0.8
        config.gap_count_only = rng.random() < 0.3
        self.offset = rng.uniform(-0.015, 0.015)
        self.inputs = {
            "address": config.address,
            "broadcast_en": int(config.broadcast),
            "gap_count_only": int(config.gap_count_only),
            "response_delay": rng.choice((0, 0, 0, 1, 20)),
            "de_lead": rng.choice((0, 0, 1, 7)),
            "de_tail": rng.choice((0, 0, 1)),
            "stall_limit": rng.choice((0, 0, 50)),
        }
        self.momentary()
        _, self.t35 = build.silences(self.parameters, self.fmt, self.bit_time)
        self.device.idle(2 * self.t35)

    def momentary(self):
        """Inputs that change from request to request."""
        self.slave.busy = self.rng.random() < 0.03
        self.slave.write_lock = self.rng.random() < 0.04
        self.device.setup(
            self.fmt,
            self.bit_time,
            busy=int(self.slave.busy),
            write_lock=int(self.slave.write_lock),
            **self.inputs,
        )

    def step(self):
        """One line of traffic to both."""
        if self.rng.random() < 0.02:
            self.noise()
        self.momentary()
        line, kind = self.traffic.line()
        if self.fmt.parity is None:
            line = [(c.byte, c.gap, None if c.error == "parity" else c.error) for c in characters(line)]
        self.kinds[kind] += 1
        expected = self.slave.request(line)
        self.touched |= {(s, a) for s, first, last in self.slave.written for a in range(first, last + 1)}
        patience = self.t35 + (PROCESSING_CLOCKS if expected else 16 * self.bit_time + 64)
        patience += (self.inputs["response_delay"] + self.inputs["de_lead"]) * self.bit_time
        if expected is None and self.slave.good:
            patience += BROADCAST_CLOCKS
        shown = f"{kind}, {self.fmt.name}, {self.inputs}: {text([c.byte for c in characters(line)])}"
        try:
            seen = self.device.transfer(line, patience, self.offset)
        except LineError as error:
            raise AssertionError(f"{shown}: {error}") from error
        self.judge(seen, expected, shown)

    def judge(self, seen, expected, shown):
        """Raises AssertionError with what differs."""
        assert seen.answer == expected, f"{shown}: expected {text(expected)}, seen {text(seen.answer)}"
        rose = {error for error, count in seen.errors.items() if count}
        must, may = self.slave.errors, self.slave.allowed
        assert must <= rose <= must | may, f"{shown}: expected {must} (allowed {may}), seen {rose}"
        assert seen.good == self.slave.good, f"{shown}: frame_stb_o rose {seen.good} times"
        assert seen.writes == self.slave.written, f"{shown}: expected writes {self.slave.written}, seen {seen.writes}"
        if expected:
            # a slow sender's stop bit ends later than the receiver thinks
            early = self.t35 + self.inputs["response_delay"] * self.bit_time - 0.5 * self.bit_time
            assert seen.latency >= early, f"{shown}: answered {seen.latency} clocks after the request"
            lead, tail = self.inputs["de_lead"], self.inputs["de_tail"]
            assert lead <= seen.lead / self.bit_time <= lead + 1, f"{shown}: de leads {seen.lead} clocks"
            assert tail <= seen.tail / self.bit_time <= tail + 1, f"{shown}: de stays {seen.tail} clocks"

    def noise(self):
        """Random levels, then silence: nothing may come of it."""
        count = 2 * self.rng.randint(1, 60)
        self.device.noise([self.rng.choice((1, 2, 3, 8, 20, 90)) for _ in range(count)])
        self.device.idle(self.t35 + 20 * self.bit_time)

    def compare(self, whole):
        """Memory of the device against the model's: what was written lately, or everything."""
        keys = self.slave.memory.addresses() if whole else sorted(self.touched)
        for space, item in keys:
            expected, seen = self.slave.memory[space, item], self.device.host(space, item)
            assert seen == expected, f"{space.name} {item}: expected {expected:04X}, holds {seen}"
        self.touched.clear()
        self.device.idle(2 * self.t35)


@pytest.mark.parametrize("name", MAPS)
def test_compiled_slave_agrees_with_the_model(name, seed):
    full = os.environ.get("FULL") == "1"
    count = int(os.environ.get("COUNT", FULL_REQUESTS if full else REQUESTS))
    count = max(1, round(count * SHARE[name]))
    match = Match(MAPS[name], f"{seed} {name}")
    print(f"seed {seed}, {count} requests on map {name}")
    wrong = None
    for number in range(count):
        if number % SETTINGS_EVERY == 0:
            match.settings()
        try:
            match.step()
            if number % COMPARE_EVERY == COMPARE_EVERY - 1:
                match.compare(whole=number % WHOLE_COMPARE_EVERY == WHOLE_COMPARE_EVERY - 1)
        except AssertionError as error:
            wrong = f"seed {seed}, map {name}, request {number}: {error}".splitlines()[0]
            break
    if wrong:
        pytest.fail(wrong, pytrace=False)
    match.compare(whole=True)
    print(dict(match.kinds), dict(match.slave.counts))
    assert match.slave.counts["good"] > count / 2
    match.device.close()


def test_every_unsupported_function_code():
    """All 246 codes, with any data or none: exception 01; 80H and above come back unchanged."""
    match = Match(MAPS["mapped"], "codes")
    match.slave.busy = False
    own = match.slave.config.address
    for code in set(range(256)) - set(ALL_FUNCTIONS):
        for data in (b"", b"\0", b"\0\0\0\1", bytes(9)):
            frame = adu(own, bytes([code]) + data)
            assert match.slave.request(frame) == adu(own, bytes([code | EXCEPTION_FLAG, EX.FUNCTION]))
            seen = match.device.transfer(frame, match.t35 + PROCESSING_CLOCKS, 0.0)
            match.judge(seen, adu(own, bytes([code | EXCEPTION_FLAG, EX.FUNCTION])), f"code {code:02X}")
    match.device.close()
