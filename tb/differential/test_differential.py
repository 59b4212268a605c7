# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Model against compiled slave over much random traffic: every answer, every strobe, all memory.

SEED chooses the traffic, FULL=1 plays more of it, COUNT any number.
"""

import os
import random
from collections import Counter

import pytest
from harness import build
from harness.build import NO_FLOORS, config_parameters, model_config, table_parameters
from harness.traffic import AsciiTraffic, Traffic
from harness.volume import volume
from protocol import frames
from protocol.defs import ALL_FUNCTIONS, ASCII_FORMATS, EX, EXCEPTION_FLAG, F8E1, F8N1, F8N2, F8O1, FC, LOG_SIZE, Space
from protocol.frames import adu, text
from protocol.model import Slave, characters

from differential.device import Device, LineError, library, user_answer

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
        **config_parameters(
            {
                "files": (3, 100),
                "user_codes": {FC.READ_HOLDINGS, 30, *range(65, 73), *range(100, 111)},
                "server_id": bytes(range(16)),
                "additional_data": bytes(range(234)),
                "objects": {
                    **{i: bytes([65 + i]) * n for i, n in enumerate((20, 244, 0, 60, 61, 60, 60))},
                    **{i: bytes(range(i - 60)) for i in (0x80, 0x81, 0x90, 0xFF)},
                },
                "conformity": 0x83,
            }
        ),
    },
    "ascii": {
        **NO_FLOORS,
        **table_parameters(dict.fromkeys(list(Space)[:4], (0, 300))),
        **config_parameters({"files": (3, 100), "user_codes": {FC.READ_HOLDINGS, 65}}),
        "ASCII_MODE": 1,
        "CLK_HZ": 1_000_000,
        "ASCII_TIMEOUT_MS": 2,
    },
    "whole": {**NO_FLOORS, **table_parameters(dict.fromkeys(list(Space)[:4], (0, 65536)))},
    "overlaid": {
        **NO_FLOORS,
        "OVERLAY": 1,
        "HOLDING_COUNT": 140,
        "READ_ONLY_BASE": 100,
        "READ_ONLY_COUNT": 3,
        **config_parameters({"units": (2, 18, 240)}),
        "UNIT_PORT": 1,
    },
}
SHARE = {"mapped": 0.5, "whole": 0.15, "overlaid": 0.15, "ascii": 0.2}
# Sixteen bits a beat
WIDE = {
    "mapped": {**MAPS["mapped"], "BITS_PER_BEAT": 16, "CHECK_WRITES": 1},
    "whole": {**MAPS["whole"], "BITS_PER_BEAT": 16},
    "overlaid": {**MAPS["overlaid"], "BITS_PER_BEAT": 16},
}
SETTINGS_EVERY, COMPARE_EVERY, WHOLE_COMPARE_EVERY = 40, 250, 5_000
COUNTERS_EVERY, RESET_EVERY = 7, 3_000
BAD_EVENTS = {0x82, 0x92, 0xA2, 0xB2}  # in the event log
BROADCAST_CLOCKS = 8_000  # the longest a broadcast may work on
PROCESSING_CLOCKS = 14_000  # the longest answer, bits included


class Match:
    """A device and a model that get the same traffic."""

    def __init__(self, parameters, seed):
        self.rng = random.Random(seed)
        self.slave = Slave(model_config("modbus_rtu_slave", parameters))
        self.device = Device(library(parameters))
        self.parameters = parameters
        self.slave.user = user_answer
        self.ascii = bool(parameters.get("ASCII_MODE"))
        self.traffic = (AsciiTraffic if self.ascii else Traffic)(self.rng, self.slave.config, self.slave)
        self.kinds, self.latest = Counter(), 0
        self.inputs, self.offset, self.touched = {}, 0.0, set()
        self.settings()
        self.reset()

    def reset(self):
        self.device.reset()
        self.slave.reset()
        self.device.idle(self.t35 + 100)

    def settings(self):
        """Other run-time inputs."""
        rng, config = self.rng, self.slave.config
        self.fmt = rng.choice((F8E1, F8E1, F8O1, F8N2, F8N1))
        if self.ascii:
            self.fmt = rng.choice(list(ASCII_FORMATS.values()))
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
            "stall_limit": rng.choice((0, 0, 100)),  # the user may take 560 clocks
            "ascii": int(self.ascii),
        }
        self.end_open_frame()
        self.momentary()
        _, self.t35 = build.silences(self.parameters, self.fmt, self.bit_time)
        config.timeout = build.ascii_timeout(self.parameters) / (self.fmt.length * self.bit_time)
        self.device.idle(2 * self.t35)

    def end_open_frame(self, waited=None):
        """ASCII mode: the time-out ends the frame that a fault has left open, for the model too.

        With `waited`, clocks since the last character, only if the device's time-out has passed or comes near.
        """
        timeout = build.ascii_timeout(self.parameters)
        if self.ascii and (waited is None or waited > 0.7 * timeout) and self.slave.ascii.receiving:
            self.device.idle(1.1 * timeout)
            self.slave.fall_silent()

    def momentary(self):
        """Inputs that change from request to request."""
        self.slave.busy = self.rng.random() < 0.03
        self.slave.write_lock = self.rng.random() < 0.04
        self.slave.failure = self.rng.choice((4, 5, 6, 7, 8, 10, 11)) if self.rng.random() < 0.03 else 0
        self.slave.exception_status = self.rng.randrange(256)
        self.slave.run_indicator = self.rng.random() < 0.5
        self.slave.diagnostic_bits = 1 << self.rng.randrange(1, 16) if self.rng.random() < 0.02 else 0
        self.device.setup(
            self.fmt,
            self.bit_time,
            busy=int(self.slave.busy),
            write_lock=int(self.slave.write_lock),
            failure=self.slave.failure,
            exception_status=self.slave.exception_status,
            run_indicator=int(self.slave.run_indicator),
            diagnostic=self.slave.diagnostic_bits,
            **self.inputs,
        )
        self.device.idle(4)

    def step(self):
        """One line of traffic to both."""
        if self.rng.random() < 0.02 and not self.ascii:
            self.noise()
        self.momentary()
        line, kind = self.traffic.line()
        if self.fmt.parity is None:
            line = [(c.byte, c.gap, None if c.error == "parity" else c.error) for c in characters(line)]
        self.kinds[kind] += 1
        expected = (self.slave.hear if self.ascii else self.slave.request)(line)
        self.touched |= self.slave.touched
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
        if self.slave.ambiguous:
            self.slave.adopt(bool(seen.errors["long"]))
        rest = 1.1 * self.t35 + 100
        if self.ascii or kind == "restart" or bytes(c.byte for c in characters(line))[1:2] == bytes([FC.DIAGNOSTICS]):
            self.device.idle(rest)  # after a restart the line must be silent; ASCII hides which it was
        self.end_open_frame(patience + rest)
        if self.rng.randrange(COUNTERS_EVERY) == 0:
            self.compare_counters(shown)

    def compare_counters(self, shown):
        """Counters, modes and the newest log entry against the model's."""
        slave, device = self.slave, self.device
        seen = device.counters()
        assert seen == slave.counters, f"{shown}: counters should be {slave.counters}, are {seen}"
        state = (slave.listen_only, len(slave.log), slave.diagnostic_register)
        assert device.state() == state, f"{shown}: listen-only, log entries, register {device.state()}, not {state}"
        newest = [device.log()[:1], slave.log[:1]]
        assert newest[0] == newest[1], f"{shown}: newest event {newest[0]}, should be {newest[1]}"

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
            early = 0 if self.ascii else self.t35
            early += (self.inputs["response_delay"] - 0.5) * self.bit_time
            assert seen.latency >= early, f"{shown}: answered {seen.latency} clocks after the request"
            lead, tail = self.inputs["de_lead"], self.inputs["de_tail"]
            assert lead <= seen.lead / self.bit_time <= lead + 1, f"{shown}: de leads {seen.lead} clocks"
            assert tail <= seen.tail / self.bit_time <= tail + 1, f"{shown}: de stays {seen.tail} clocks"

    def noise(self):
        """Random levels, then silence: nothing may come of it but bad frames, which the model learns of."""
        count = 2 * self.rng.randint(1, 60)
        self.device.noise([self.rng.choice((1, 2, 3, 8, 20, 90)) for _ in range(count)])
        self.device.idle(self.t35 + 20 * self.bit_time)
        slave, seen, log = self.slave, self.device.counters(), self.device.log()
        bad = (seen["bus_comm_error"] - slave.counters["bus_comm_error"]) & 0xFFFF
        kept = LOG_SIZE - bad if len(log) == LOG_SIZE else len(slave.log)
        assert log[bad:] == slave.log[:kept], f"noise: log {log} after {slave.log}"
        assert set(log[:bad]) <= BAD_EVENTS, f"noise: events {log[:bad]}"
        expected = {**slave.counters, **{name: seen[name] for name in ("bus_comm_error", "bus_char_overrun")}}
        assert seen == expected, f"noise: counters {seen} after {slave.counters}"
        slave.counters.update(seen)
        slave.log = log
        slave.diagnostic_register = self.device.state()[2]

    def compare(self, whole):
        """Memory of the device against the model's: what was written lately, or everything."""
        self.end_open_frame()
        keys = self.slave.memory.addresses() if whole else sorted(self.touched)
        for space, item in keys:
            expected, seen = self.slave.memory[space, item], self.device.host(space, item)
            assert seen == expected, f"{space.name} {item}: expected {expected:04X}, holds {seen}"
        seen = self.device.log()
        assert seen == self.slave.log, f"event log should be {self.slave.log}, is {seen}"
        self.touched.clear()
        self.device.idle(2 * self.t35)


@pytest.mark.parametrize("name", MAPS)
def test_compiled_slave_agrees_with_the_model(name, seed):
    count = int(os.environ.get("COUNT", volume("random requests on the compiled slave")))
    count = max(1, round(count * SHARE[name]))
    match = Match(MAPS[name], f"{seed} {name}")
    print(f"seed {seed}, {count} requests on map {name}")
    wrong = None
    for number in range(count):
        if number % SETTINGS_EVERY == 0:
            match.settings()
        if number % RESET_EVERY == RESET_EVERY - 1:
            match.reset()
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


@pytest.mark.parametrize("name", WIDE)
def test_bits_at_every_alignment(name, seed):
    """01 02 05 0F from every address mod 16 on, sixteen bits a beat: answers, and what is in the tables afterwards."""
    match = Match(WIDE[name], f"{seed} wide {name}")
    rng, slave = match.rng, match.slave
    count = max(1, round(volume("bits at every alignment") / 16))
    print(f"seed {seed}, {16 * count} requests on map {name}")
    for number in range(16 * count):
        if number % SETTINGS_EVERY == 0:
            match.settings()
        match.momentary()
        space = rng.choice((Space.COILS, Space.COILS, Space.DISCRETES))
        base, size = slave.config.tables[space]
        most = rng.choice((1, 8, 17, 40, 300, 2000))
        place = rng.choice((0, 16 * rng.randrange(size // 16), max(0, size - most - 16)))
        first = min(base + place + number % 16, base + size - 1)
        quantity = rng.randint(1, max(1, min(most, base + size - first)))
        writes = space == Space.COILS and rng.random() < 0.6
        if writes and quantity == 1 and rng.random() < 0.5:
            pdu = frames.write_coil(first, rng.random() < 0.5)
        elif writes:
            pdu = frames.write_coils(first, [rng.getrandbits(1) for _ in range(min(quantity, 1968))])
        else:
            pdu = frames.read(FC.READ_COILS if space == Space.COILS else FC.READ_DISCRETES, first, quantity)
        line = adu(slave.config.address, pdu)
        expected = slave.request(line)
        match.touched |= slave.touched
        seen = match.device.transfer(line, match.t35 + PROCESSING_CLOCKS, match.offset)
        match.judge(seen, expected, text(line))
        if number % COMPARE_EVERY == COMPARE_EVERY - 1:
            match.compare(whole=False)
        if number % 8 == 0 and space == Space.DISCRETES:  # the master cannot write them
            item = base + rng.randrange(size)
            if name != "overlaid":
                value = rng.getrandbits(1)
                match.device.host(space, item, value)
                slave.memory[space, item] = value
    match.compare(whole=name != "whole")
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
