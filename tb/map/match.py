# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A generated bank and the oracle of its map get the same requests; every answer and every clock of the outputs counts."""

from modbus_map.model import SPACES
from protocol.defs import Space
from protocol.frames import text

from map.batch import ADDRESS, layout
from map.oracle import SPACE_OF, Oracle

READS = {1: "coils", 2: "discrete_inputs", 3: "holding_registers", 4: "input_registers"}
PATIENCE = 30_000


class Match:
    """Number `number` of a batch, and its oracle."""

    def __init__(self, batch, number):
        self.batch, self.device = batch, batch.devices[number]
        self.inputs_at, self.outputs_at, self.strobes_at, _ = layout(self.device)
        self.wires = [p for p in self.device.points if p.kind == "wire"]
        batch.choose(number)

    def begin(self, rng):
        """Reset of both; `rng` makes the values of wires and of the host. Memory keeps what it holds."""
        self.rng = rng
        kept = {} if not hasattr(self, "oracle") else self.oracle.values
        records = {} if not hasattr(self, "oracle") else self.oracle.records
        self.oracle = Oracle(self.device, ADDRESS)
        in_memory = {p.name for p in self.device.points if p.kind == "memory"}
        self.oracle.values |= {key: raw for key, raw in kept.items() if key[0] in in_memory}
        self.oracle.records = records
        self.batch.reset()
        self.compare_outputs(self.batch.outputs(), "behind the reset")

    def item_of(self, vector, at, point, item):
        return vector >> (at[point.name] + item * point.bits) & ((1 << point.bits) - 1)

    def new_inputs(self, still):
        """Two values for each wire, or one; they are what the wires have from now on."""
        pair = []
        for which in range(2):
            if which and still:
                pair.append(pair[0])
                break
            pair.append({(p.name, n): self.rng.getrandbits(p.bits) for p in self.wires for n in range(p.count)})
        vectors = [
            sum(values[p.name, n] << (self.inputs_at[p.name] + n * p.bits) for p in self.wires for n in range(p.count))
            for values in pair
        ]
        self.batch.inputs(*vectors)
        self.pair = pair
        live = {key: raw for key, raw in pair[0].items() if not self.device.point(key[0]).freeze}
        self.oracle.values |= live
        self.oracle.wire = pair[0]

    def step(self, frame):
        """A request to both."""
        oracle = self.oracle
        self.new_inputs(still=frame[1] not in (1, 2, 3, 4, 5, 15))
        before = dict(oracle.values)
        oracle.strobes, oracle.taken = [], set()
        expected = oracle.request(frame)
        seen, vectors = self.batch.request(frame, PATIENCE)
        shown = f"{self.device.name}: {text(frame)}"
        self.judge(frame, expected, seen, shown)
        self.judge_outputs(before, vectors, shown)
        self.compare_outputs(self.batch.outputs(), shown)
        self.settle_snapshots()

    def judge(self, frame, expected, seen, shown):
        """The answer, where values of wires may be those of either moment."""
        if seen == expected:
            return
        wrong = f"{shown}: expected {text(expected)}, seen {text(seen)}"
        assert expected and seen and len(seen) == len(expected) and frame[1] in READS, wrong
        assert seen[:3] == expected[:3], wrong
        table = READS[frame[1]]
        first, quantity = int.from_bytes(frame[2:4], "big"), int.from_bytes(frame[4:6], "big")
        data, wanted = self.items(seen, frame[1], quantity), self.items(expected, frame[1], quantity)
        for point in self.device.table(table):
            for item in range(point.count):
                places = [a - first for a in point.addresses(item) if first <= a < first + quantity]
                if not places:
                    continue
                got = [data[p] for p in places]
                if point.kind == "wire" and not point.freeze:
                    start = places[0] + first - point.addresses(item)[0]
                    good = [point.registers(v[point.name, item])[start : start + len(got)] for v in self.pair]
                    assert got in good, f"{wrong}: {point.name} is torn"
                else:
                    assert got == [wanted[p] for p in places], f"{wrong}: {point.name}"
        covered = {a for p in self.device.table(table) for a in range(p.at, p.last + 1)}
        for place, value in enumerate(data):
            assert first + place in covered or value == 0, wrong

    @staticmethod
    def items(answer, code, quantity):
        """The bits or registers of an answer."""
        data = answer[3:-2]
        if code <= 2:
            return [data[n // 8] >> n % 8 & 1 for n in range(quantity)]
        return [int.from_bytes(data[n : n + 2], "big") for n in range(0, len(data), 2)]

    def settle_snapshots(self):
        """A snapshot is of one moment, but of which is known only to the device: read it back."""
        if self.pair[0] is not self.pair[1]:
            for coil in sorted(self.oracle.taken):
                self.read_back(coil)

    def read_back(self, coil):
        import struct

        from protocol.frames import adu

        points = [p for p in self.device.points if p.freeze == coil]
        found = []
        for point in points:
            code = {"discrete_inputs": 2, "input_registers": 4, "holding_registers": 3, "coils": 1}[point.table]
            for item in range(point.count):
                a = point.addresses(item)
                answer, _ = self.batch.request(adu(ADDRESS, struct.pack(">BHH", code, a[0], len(a))), PATIENCE)
                raw = point.join(self.items(answer, code, len(a)))
                found.append({n for n in range(2) if self.pair[n][point.name, item] == raw})
                self.oracle.values[point.name, item] = raw
        assert set.intersection(*found), f"{self.device.name}: the snapshot of {coil} is of two moments"

    def judge_outputs(self, before, vectors, shown):
        """Every value goes from old to new in one clock, once; strobes pulse once for each item written."""
        oracle = self.oracle
        pulses = {}
        for point in self.device.points:
            for item in range(point.count):
                key = (point.name, item)
                if point.name in self.outputs_at:
                    values = [before[key]]
                    for vector in vectors:
                        value = self.item_of(vector, self.outputs_at, point, item)
                        if value != values[-1]:
                            values.append(value)
                    wanted = [before[key]] + ([oracle.values[key]] if oracle.values[key] != before[key] else [])
                    assert values == wanted, f"{shown}: {key} went {values}, expected {wanted}"
                if point.name in self.strobes_at:
                    bit, last = self.strobes_at[point.name] + item, 0
                    for vector in vectors:
                        now = vector >> bit & 1
                        pulses[key] = pulses.get(key, 0) + (now and not last)
                        last = now
                    expected = oracle.strobes.count(key)
                    assert pulses.get(key, 0) == expected, (
                        f"{shown}: {key} pulsed {pulses.get(key, 0)} times, not {expected}"
                    )

    def compare_outputs(self, vector, shown):
        for point in self.device.points:
            if point.name in self.outputs_at:
                for item in range(point.count):
                    value = self.item_of(vector, self.outputs_at, point, item)
                    wanted = self.oracle.values[point.name, item]
                    assert value == wanted, f"{shown}: {point.name}[{item}] is {value:X}, should be {wanted:X}"

    def host(self):
        """One access of the host to the memory; or to where none is."""
        points = [p for p in self.device.points if p.kind == "memory"]
        if not points:
            return
        point = self.rng.choice(points)
        item = self.rng.randrange(point.count)
        space = SPACES[point.table]
        address = point.addresses(item)[0]
        assert self.batch.host(space, address) == self.oracle.values[point.name, item], (
            f"{self.device.name} {point.name}"
        )
        value = self.rng.getrandbits(16)
        self.batch.host(space, address, value)
        self.oracle.values[point.name, item] = value
        spots = self.oracle._spots
        for free in (point.last + 1, point.at - 1):
            found = spots.get((SPACE_OF[space], free))
            if 0 <= free <= 65535 and not (found and found[0].kind == "memory"):
                assert self.batch.host(space, free) is None, f"{self.device.name}: the host reads {free}"


__all__ = ["Match", "Space"]
