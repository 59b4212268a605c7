# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many compiled slaves on one line (harness.cpp), each beside its model, each with a clock of its own."""

import ctypes
import random
from pathlib import Path

from differential.device import library
from harness import wave
from protocol.defs import ALL_COUNTERS, COUNTER_ADDRESS, F8E1, LOG_ADDRESS, T35_CHARACTERS, Space, bus_address
from protocol.frames import text
from protocol.model import characters

from .listener import SEEN, Listener, spread

HARNESS = Path(__file__).resolve().parent / "harness.cpp"
PROCESSING_CLOCKS = 700  # a request of some ten items, and the last action after an answer
LAST_ACTION_CLOCKS = 64


class _Answer(ctypes.Structure):
    _fields_ = [("speaker", ctypes.c_int32), ("edges", ctypes.c_int32)] + [
        (name, ctypes.c_int64) for name in ("rise", "fall", "rise_ticks", "fall_ticks")
    ]


class Node(Listener):
    """A slave; its clock has `rate` cycles in one of the master's."""

    rate = 1.0


class Bus:
    """`nodes` slaves built with `parameters`, at different addresses, with different contents.

    Times are in clocks of the master, whose bits last `bit_time` of them.
    """

    def __init__(self, nodes, parameters, seed, bit_time=8, fmt=F8E1):
        self._lib = lib = ctypes.CDLL(str(library(parameters, HARNESS)))
        lib.bus_new.restype = ctypes.c_void_p
        lib.bus_now.restype = lib.bus_collisions.restype = ctypes.c_uint64
        lib.bus_edge.restype = ctypes.c_int64
        lib.bus_count.restype = lib.bus_state.restype = ctypes.c_uint32
        lib.bus_host.restype = lib.bus_counter.restype = ctypes.c_int32
        self._handle = ctypes.c_void_p(lib.bus_new(nodes))
        self.rng, self.bit_time, self.fmt = random.Random(seed), bit_time, fmt
        self.nodes = [Node(index, parameters) for index in range(nodes)]
        spread(self.rng, self.nodes)
        for node in self.nodes:
            node.bit_time = bit_time
        self.free_at = 0  # when the last transmission has ended

    def close(self):
        self._lib.bus_free(self._handle)

    # -------------------------------------------------------------- set-up and time

    def begin(self):
        """Bring the settings to the devices, reset, fill the tables; all have then seen the line silent."""
        self.apply()
        self._lib.bus_reset(self._handle)
        self.silence()
        for node in self.nodes:
            for space in (Space.COILS, Space.HOLDINGS):
                base, count = node.slave.config.tables[space]
                for item in range(base, base + count):
                    value = self.rng.getrandbits(1 if space == Space.COILS else 16)
                    node.slave.memory[space, item] = value
                    assert self.host(node, space, item, value) is not None, f"host cannot write {space.name} {item}"

    def apply(self):
        """Drive what the nodes are set to; the line must be at rest."""
        for node in self.nodes:
            inputs = (node.address, node.bit_time, self.fmt.code, node.de_lead, node.de_tail)
            self._lib.bus_setup(self._handle, node.index, ctypes.c_double(node.rate), *map(ctypes.c_uint32, inputs))

    @property
    def now(self):
        """Clocks of the master since the beginning."""
        return self._lib.bus_now(self._handle)

    @property
    def collisions(self):
        """Clocks with more than one driver so far."""
        return self._lib.bus_collisions(self._handle)

    @property
    def slowest(self):
        """The longest bit of all."""
        return max(self.bit_time, *(node.bit_time / node.rate for node in self.nodes))

    def run(self, clocks):
        """Let time pass."""
        self._lib.bus_run(self._handle, ctypes.c_uint64(max(0, round(clocks))))

    def silence(self):
        """Until the slowest node has seen t3.5 pass, and has worked on what it heard."""
        self.run((T35_CHARACTERS * self.fmt.length + 6) * self.slowest + PROCESSING_CLOCKS)

    # -------------------------------------------------------------- a node's host

    def host(self, node, space, item, write=None):
        """Host access of a node; the value, or None for err."""
        value = self._lib.bus_host(
            self._handle, node.index, bus_address(space, item), int(write is not None), write or 0
        )
        assert value != -2, "the host port does not answer"
        return None if value < 0 else value

    def _counter(self, node, address):
        value = self._lib.bus_counter(self._handle, node.index, address)
        assert value >= 0, "the counter port does not answer"
        return value

    def listen_only(self, node):
        """True while the node is silenced."""
        return bool(self._lib.bus_state(self._handle, node.index) >> 23)

    # -------------------------------------------------------------- a request

    def send(self, line, offset=0.0):
        """The master sends `line`; its driver is on from the first start bit to the last stop bit.

        offset: its bits are longer by this fraction. Returns when that has ended.
        """
        sent = wave.encode(line, self.fmt, self.bit_time, offset)
        times = (ctypes.c_uint64 * len(sent.edges))(*[time for time, _ in sent.edges])
        levels = bytes(level for _, level in sent.edges)
        self._lib.bus_play(self._handle, len(sent.edges), times, levels, ctypes.c_uint64(sent.end))
        return self.now

    def answer(self):
        """(node, bytes, clocks from de to start bit, clocks from stop bit to the end of de, begin, end), or None.

        Raises LineError if it is not clean in the clock of its sender.
        """
        got = _Answer()
        patience = (T35_CHARACTERS * self.fmt.length + 22) * self.slowest + PROCESSING_CLOCKS
        self._lib.bus_answer(self._handle, ctypes.c_uint64(round(patience)), ctypes.byref(got))
        if got.speaker < 0:
            return None
        node, level, edges = self.nodes[got.speaker], ctypes.c_int32(), []
        for place in range(got.edges):
            ticks = self._lib.bus_edge(self._handle, place, ctypes.byref(level))
            edges.append((ticks, level.value))
        data = wave.decode(edges, self.fmt, node.bit_time)
        lead, tail = data.start - got.rise_ticks, got.fall_ticks - data.end
        # what a node drives in a clock is on the line in the next
        end = got.fall + 1 - tail / node.rate
        return node, data.data, lead / node.bit_time, tail / node.bit_time, got.rise, end

    def ask(self, line, note="", gap=None, offset=0.0):
        """Send `line`; the answer must be that of the one model that answers, or silence.

        With `gap`, in characters of the master, it is sent that long after the last transmission; else all nodes
        have long judged that. Returns the answer.
        """
        shown = f"{note} {text(bytes(c.byte for c in characters(line))[:16])}"
        answers = {node.index: answer for node in self.nodes if (answer := node.hears(line)) is not None}
        assert len(answers) <= 1, f"{shown}: the models of {sorted(answers)} answer"
        if gap is None:
            self.silence()
        else:
            self.run(self.free_at + gap * self.fmt.length * self.bit_time - self.now)
        sent = self.free_at = self.send(line, offset)
        try:
            got = self.answer()
        except wave.LineError:
            self._nobody_collided(shown)
            raise
        self._nobody_collided(shown)
        seen = {got[0].index: got[1]} if got else {}
        assert seen == answers, f"{shown}: expected {_shown(answers)}, seen {_shown(seen)}"
        if got is None:
            self.free_at = self.now
            return None
        speaker, data, lead, tail, begin, self.free_at = got
        assert begin > sent, f"{shown}: driven before the request has ended"
        assert speaker.de_lead <= lead <= speaker.de_lead + 1, f"{shown}: de leads {lead:.2f}, set {speaker.de_lead}"
        assert speaker.de_tail <= tail <= speaker.de_tail + 1, f"{shown}: de stays {tail:.2f}, set {speaker.de_tail}"
        for node in self.nodes:
            if node is not speaker:
                assert node.hears(data) is None, f"{shown}: the model of node {node.index} answers an answer"
        return data

    # -------------------------------------------------------------- what all of them saw

    def _nobody_collided(self, note):
        assert self.collisions == 0, f"{note}: two drivers for {self.collisions} clocks"

    def check(self, note=""):
        """Strobes, memory, counters, log and mode of every node are those of its model."""
        self.silence()
        self.run(LAST_ACTION_CLOCKS)
        self._nobody_collided(note)
        for node in self.nodes:
            shown = f"{note}: node {node.index} (address {node.address})"
            seen = {name: self._lib.bus_count(self._handle, node.index, i) for i, name in enumerate(SEEN)}
            assert seen == node.wanted, f"{shown}: seen {seen}, expected {node.wanted}"
            for space, item in sorted(node.touched):
                value, wanted = self.host(node, space, item), node.slave.memory[space, item]
                assert value == wanted, f"{shown}: {space.name} {item} holds {value:04X}, expected {wanted:04X}"
            counters = {name: self._counter(node, COUNTER_ADDRESS[name]) for name in ALL_COUNTERS}
            assert counters == node.slave.counters, f"{shown}: {counters}, expected {node.slave.counters}"
            state = self._lib.bus_state(self._handle, node.index)
            log = [self._counter(node, LOG_ADDRESS + i) for i in range(state >> 16 & 0x7F)]
            assert log == node.slave.log, f"{shown}: log {log}, expected {node.slave.log}"
            assert bool(state >> 23) == node.slave.listen_only, f"{shown}: listen-only mode is {state >> 23}"


def _shown(answers):
    """Answers by node, for people."""
    return ", ".join(f"node {index}: {text(data)}" for index, data in answers.items()) or "silence"
