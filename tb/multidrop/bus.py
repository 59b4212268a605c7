# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A two-wire bus in cocotb: the master's driver, the slaves, and a model of each.

Every frame of the master goes to all models; an answer goes to all but the one that sent it.  What each
device's host sees (strobes, write pulses, how often it drove the line) must be what its model says.
"""

import json
import os
import random

from cocotb.clock import Clock
from cocotb.triggers import RisingEdge, Timer
from harness import build
from harness.bench import AT_REST, CLOCK_PS, PROCESSING_CLOCKS
from harness.host import HostPort
from harness.line import Line, wait_until
from harness.readout import Readout
from protocol.defs import F8E1, Space
from protocol.frames import text
from protocol.model import characters

from .listener import SEEN, Listener, spread

PARAMETERS = json.loads(os.environ.get("BENCH_PARAMETERS", "{}"))
NODES = PARAMETERS.get("NODES", 32)
STROBE_WRAP = 256  # of the bench's counts of strobes


class Master(Line):
    """The line as the master drives it: its driver is enabled from the first start bit to the last stop bit."""

    async def send(self, line, offset=0.0, jitter=0.0, spikes=(), phase=None):
        """As Line.send."""
        if phase is None:
            phase = self.rng.randrange(self.bit_ps)
        await Timer(phase + 1, "ps")
        self.dut.master_de_i.value = 1
        end = await super().send(line, offset, jitter, spikes, phase=0)
        self.dut.master_de_i.value = 0
        return end


class Node(Listener, HostPort, Readout):
    """One slave: its place on the bench, its settings, its model, what its host must have seen."""

    def __init__(self, dut, index):
        self.dut, self.has_host = dut, True
        every = PARAMETERS["DIAGNOSED_EVERY"]
        codes = PARAMETERS["PLAIN_CODES" if index % every else "DIAGNOSED_CODES"]
        count = PARAMETERS["TABLE_COUNT"]
        tables = build.table_parameters(dict.fromkeys(list(Space)[:4], (0, count)))
        super().__init__(index, {**tables, "FUNCTION_CODES": codes})

    async def clocks(self, count):
        """Wait for clock cycles."""
        await Timer(count * CLOCK_PS, "ps")

    async def looked_at(self):
        """Bring this node to the host and counter ports."""
        self.dut.node_i.value = self.index
        await Timer(1, "ps")


class Bus:
    """`await Bus.start(dut, ...)`; then `ask`, `check`, `finish`."""

    def __init__(self, dut, seed, bit_time, fmt):
        self.dut, self.rng, self.bit_time, self.fmt = dut, random.Random(seed), bit_time, fmt
        self.nodes = [Node(dut, index) for index in range(NODES)]
        for port in (*AT_REST, "master_de_i", "node_i"):
            if hasattr(dut, port):
                getattr(dut, port).value = 0
        self.line = Master(dut, bit_time * CLOCK_PS, fmt, self.rng)

    @classmethod
    async def start(cls, dut, seed=1, bit_time=8, fmt=F8E1, **setup):
        """Clock, random addresses, reset, different contents; returns when all have seen the line silent.

        `setup` gives settings of a node as functions of the random generator: bit_time, de_lead, de_tail.
        """
        bus = cls(dut, seed, bit_time, fmt)
        spread(bus.rng, bus.nodes)
        for node in bus.nodes:
            node.bit_time = bit_time
            for name, choose in setup.items():
                setattr(node, name, choose(bus.rng))
        bus.apply()
        dut.rst_i.value, dut.clear_i.value = 1, 1
        Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
        await Timer(4 * CLOCK_PS, "ps")
        await RisingEdge(dut.clk_i)
        dut.rst_i.value, dut.clear_i.value = 0, 0
        await bus.silence()
        for node in bus.nodes:
            await node.looked_at()
            for space in (Space.COILS, Space.HOLDINGS):
                for item in range(PARAMETERS["TABLE_COUNT"]):
                    value = bus.rng.getrandbits(1 if space == Space.COILS else 16)
                    await node.preset((space, item), value)
        return bus

    # -------------------------------------------------------------- set-up and time

    def apply(self):
        """Drive what the nodes are set to."""
        for name, width in (("address", 8), ("bit_time", 16), ("de_lead", 4), ("de_tail", 4)):
            value = sum(getattr(node, name) << width * node.index for node in self.nodes)
            getattr(self.dut, f"{name}_i").value = value
        self.dut.format_i.value = self.fmt.code

    @property
    def bit(self):
        """The master's bit time in ps."""
        return self.bit_time * CLOCK_PS

    @property
    def character(self):
        """The master's character time in ps."""
        return self.fmt.length * self.bit

    @property
    def t35(self):
        """t3.5 of the master in ps."""
        return round(3.5 * self.character)

    @property
    def slowest(self):
        """The longest bit time of all, in ps."""
        return max(self.bit_time, *(node.bit_time for node in self.nodes)) * CLOCK_PS

    async def silence(self):
        """Until the slowest node has seen t3.5 pass, and has worked on what it heard."""
        await Timer(round((3.5 * self.fmt.length + 6) * self.slowest) + PROCESSING_CLOCKS * CLOCK_PS, "ps")

    def at(self, address):
        """The node with this address, or None."""
        return next((node for node in self.nodes if node.address == address), None)

    # -------------------------------------------------------------- a request

    async def ask(self, line, note="", gap=None):
        """Send `line`; the answer on the line must be that of the one model that answers, or silence.

        With `gap`, in characters, nothing is waited for but that silence behind the answer, so that the next
        request can follow at once; else all nodes have judged the answer when this returns.
        """
        shown = f"{note} {text(bytes(c.byte for c in characters(line))[:16])}"
        answers = {node.index: answer for node in self.nodes if (answer := node.hears(line)) is not None}
        assert len(answers) <= 1, f"{shown}: the models of {sorted(answers)} answer"
        sent = await self.line.send(line, phase=0 if gap is not None else None)
        speaker = self.nodes[next(iter(answers))] if answers else None
        expected = answers[speaker.index] if speaker else None
        # The answer is on the grid of its sender's bit time.
        self.line.bit_ps = (speaker.bit_time if speaker else self.bit_time) * CLOCK_PS
        patience = 3.5 * self.fmt.length * self.slowest + 22 * self.slowest + PROCESSING_CLOCKS * CLOCK_PS
        got = await self.line.answer(patience)
        data = got and got.data
        assert data == expected, f"{shown}: expected {text(expected)}, seen {text(data)}"
        if got:
            self._check_driver(shown, speaker, got, sent)
            for node in self.nodes:
                if node is not speaker:
                    assert node.hears(got.data) is None, f"{shown}: the model of node {node.index} answers an answer"
        self.line.bit_ps = self.bit
        if gap is None:
            await self.silence()
            await self.check(shown)
        elif got:
            await wait_until(got.end + gap * self.fmt.length * self.bit - 1)
        return data

    def _check_driver(self, shown, node, answer, sent):
        """The driver is on as long as set, to a bit time, and not before the master's is off."""
        bit = node.bit_time * CLOCK_PS
        lead, tail = (answer.start - answer.de_rise) / bit, (answer.de_fall - answer.end) / bit
        assert answer.de_rise > sent, f"{shown}: driven before the request has ended"
        assert node.de_lead <= lead <= node.de_lead + 1, f"{shown}: de leads by {lead:.2f} bits, set to {node.de_lead}"
        assert node.de_tail <= tail <= node.de_tail + 1, f"{shown}: de stays {tail:.2f} bits, set to {node.de_tail}"

    # -------------------------------------------------------------- what all of them saw

    def _counts(self, name):
        """[count of each node] of one kind of strobe."""
        value = int(getattr(self.dut, f"{name}_o").value)
        return [value >> 8 * index & 0xFF for index in range(NODES)]

    def collisions(self):
        """(clocks with more than one driver, clocks with an undefined level)."""
        return int(self.dut.collisions_o.value), int(self.dut.undefined_o.value)

    async def check(self, note=""):
        """What each node's host has seen so far is what its model says, and nobody drove against another."""
        await RisingEdge(self.dut.clk_i)
        await Timer(1, "ps")
        assert self.collisions() == (0, 0), f"{note}: clocks with two drivers and without a level: {self.collisions()}"
        for name in SEEN:
            seen, wanted = self._counts(name), [node.wanted[name] % STROBE_WRAP for node in self.nodes]
            wrong = [
                f"node {node.index} (address {node.address}) {s}, expected {w}"
                for node, s, w in zip(self.nodes, seen, wanted)
                if s != w
            ]
            assert not wrong, f"{note}: {name}: {'; '.join(wrong)}"

    async def finish(self):
        """All strobes, memories, counters and logs are those of the models; nobody drives."""
        await self.silence()
        await self.check("at the end")
        extra = await self.line.answer(self.t35 + 16 * self.bit)
        assert extra is None, f"an answer nobody asked for: {text(extra.data)}"
        assert int(self.dut.de_o.value) == 0 and int(self.dut.line_o.value) == 1, "the line is not at rest"
        for node in self.nodes:
            await node.looked_at()
            await node.compare(sorted(node.touched))
            if node.slave.config.has_diagnostics:
                await node.compare_counters(f"node {node.index}")
            else:
                await node.compare_outputs(f"node {node.index}")


def share(rng, values):
    """A setting that about half of the nodes have, 0 for the others."""
    return rng.choice(values) if rng.random() < 0.5 else 0
