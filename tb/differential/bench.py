# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Cocotb tests on the compiled slave: the same test functions, many times as fast, without a simulator.

A test may use what CompiledBench has: lines, host port, settings, reset. What needs the signals (spikes, a user at the
user port, two things at once) stays with a simulator, and so do some builds of every suite, for unknown levels.
"""

import dataclasses
import importlib
import os
import random
import re
import resource
import traceback
from collections import Counter
from types import SimpleNamespace

import models
import pytest
from harness import build
from harness.bench import CLOCK_PS, PATIENCE_CLOCKS, Bench
from harness.bench import Setup as Inputs
from harness.line import Answer
from protocol.frames import text
from protocol.model import Slave

from .device import Device, Setup, library

TOP = "slave_bench"
RESET_CLOCKS = 4
AT_REST_BITS = 64  # after the last answer, in which nothing may come
SETTINGS = {name for name, _ in Setup._fields_} - {"bit_time", "format"}


def settings(inputs):
    """The fields of Inputs that Device.setup takes by name."""
    return {name: value for name, value in dataclasses.asdict(inputs).items() if name in SETTINGS}


class Ports:
    """What the bench reads at ports of a simulation."""

    frame_stb_o = write_stb_o = status_stb_i = None  # they are there: strobes, writes and counters are compared

    def __init__(self, device):
        self._device = device

    @property
    def listen_only_o(self):
        return SimpleNamespace(value=int(self._device.state()[0]))


class CompiledBench(Bench):
    """The Bench of a compiled slave_bench built with `parameters`."""

    def __init__(self, path, parameters, seed):
        # not Bench's own: that one listens to signals
        self.device, self.parameters = Device(path), parameters
        self.dut, self.rng = Ports(self.device), random.Random(seed)
        self.setup, self.strobes, self.writes, self.touched = Inputs(), Counter(), [], set()
        self.line = SimpleNamespace(bit_ps=0, fmt=None)
        self.slave = Slave(build.model_config(TOP, parameters))
        self.has_host, self.longest_latency = True, 0.0
        self.in_step, self._playing_both = True, False

    def apply(self, **setup):
        self.setup = dataclasses.replace(self.setup, **setup)
        self.device.setup(self.setup.fmt, self.setup.bit_time, **settings(self.setup))
        self._settled(self.parameters)

    async def reset(self, clocks=RESET_CLOCKS):
        assert clocks == RESET_CLOCKS, "the compiled slave has one length of reset"
        self.device.reset()
        self.slave.reset()
        self.in_step = True

    async def silence(self, bits=4):
        self.device.idle((self.t35 + bits * self.bit) / CLOCK_PS)

    async def clocks(self, count):
        self.device.idle(count)

    async def query(self, line, patience=None, offset=0.0):
        if patience is None:
            patience = (PATIENCE_CLOCKS + self.setup.response_delay * self.setup.bit_time) * CLOCK_PS
        seen = self.device.transfer(line, (self.t35 + patience) / CLOCK_PS, offset)
        self.strobes.update({**seen.errors, "frame": seen.good})
        self.writes += seen.writes
        self.sent = 0
        if seen.answer is None:
            return None
        start = seen.latency * CLOCK_PS
        end = start + len(seen.answer) * self.character * CLOCK_PS
        return Answer(seen.answer, start, end, start - seen.lead * CLOCK_PS, end + seen.tail * CLOCK_PS)

    async def query_while(self, line, clock, **setup):
        changed = dataclasses.replace(self.setup, **setup)
        self.device.later(round(self.t35 / CLOCK_PS) + clock, changed.fmt, changed.bit_time, **settings(changed))
        answer = await self.query(line)
        self.apply(**setup)
        return answer

    async def host(self, space, item, write=None):
        return self.device.host(space, item, write)

    async def counter(self, address):
        return self.device.counter(address)

    async def finish(self):
        self.strobes.clear()
        self.writes.clear()
        extra = await self.query(b"", AT_REST_BITS * self.bit)
        assert extra is None, f"an answer nobody asked for: {text(extra.data)}"
        assert not any(self.strobes.values()) and not self.writes, f"strobes at rest: {dict(self.strobes)}"
        await self.compare(sorted(self.touched))
        if self.in_step:
            await self.compare_counters("at the end")


class Build:
    """Stands where cocotb hands a test its device: Bench.start makes a CompiledBench of it."""

    def __init__(self, parameters):
        self.parameters, self.path = parameters, library(parameters)

    async def bench(self, seed, **setup):
        bench = CompiledBench(self.path, self.parameters, seed)
        bench.apply(**setup)
        await bench.reset()
        await bench.silence()
        return bench


def tests_of(module):
    """The cocotb tests of a module, with every parameter."""
    generators = [g for g in vars(importlib.import_module(module)).values() if hasattr(g, "generate_tests")]
    return [test for generator in generators for test in generator.generate_tests()]


def run(record_property, module, parameters, only=None):
    """Run the cocotb tests of `module` whose full name `only` finds; like harness.runner.run, but compiled."""
    before = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    try:
        dut = Build(parameters)
    except models.BuildError as error:
        if "not installed" in str(error):
            pytest.skip(str(error))
        raise
    chosen = re.compile(os.environ.get("CASE") or only or "")
    tests = [test for test in tests_of(module) if chosen.search(test.fullname)]
    found, why = [], []
    for test in tests:
        try:
            test.func(dut, *test.args, **test.kwargs).send(None)
            raise RuntimeError(f"{test.fullname} waits for a signal, which only a simulator has")
        except StopIteration:
            found.append((test.fullname, True))
        except AssertionError as error:
            found.append((test.fullname, False))
            why.append(f"{test.fullname}: {error or traceback.format_exc()}")
    after = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    spent = (b.ru_utime + b.ru_stime - a.ru_utime - a.ru_stime for a, b in zip(before, after))
    record_property("cpu", sum(spent))
    record_property("cocotb", [(f"compiled {name}", good) for name, good in found])
    assert found, f"no test of {module} is called {only}"
    if why:
        pytest.fail(f"{len(why)} of {len(found)} failed\n" + "\n".join(why), pytrace=False)
