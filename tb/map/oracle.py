# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a device made from a map must answer: the reference slave with the tables of the map behind it.

Written from docs/map.md. It knows values of points, not how the generated bank finds them.
"""

from modbus_map.model import SPACES
from protocol.defs import EX, Space
from protocol.diagnostics import Refused
from protocol.memory import Config
from protocol.model import Slave

SPACE_OF = {0: Space.COILS, 1: Space.DISCRETES, 2: Space.INPUTS, 3: Space.HOLDINGS}


class MapMemory:
    """The addresses of a map. Key: (space, address)."""

    def __init__(self, oracle):
        self.oracle = oracle

    def __getitem__(self, key):
        return self.oracle.read(*key)


class Oracle(Slave):
    """A slave made from a map.

    `values` holds {(point name, item): raw} of what is written or shown. `inputs` are the two values that a
    wire may have while a request is answered; `seen` is set from outside to choose between them.
    """

    def __init__(self, device, address):
        tables = dict.fromkeys(SPACE_OF.values(), (0, 65536))
        super().__init__(Config(address=address, tables=tables, files=(1, 10_000)))
        self.device = device
        self.memory = MapMemory(self)
        self.values = {(p.name, n): raw for p in device.points for n, raw in enumerate(p.resets)}
        self.taken = set()  # coils that have taken a snapshot; who looks at them empties it
        self.strobes, self.now = [], lambda point, item: self.values[point.name, item]
        self.records = {}
        self.wire = {}  # {(point name, item): raw}
        self._spots = {}
        for point in device.points:
            for item in range(point.count):
                for word, address in enumerate(point.addresses(item)):
                    self._spots[SPACE_OF[SPACES[point.table]], address] = (point, item, word)
        self._zero = {SPACE_OF[SPACES[table]] for table in device.zero_gaps}

    def spot(self, space, address):
        """(point, item, word) at an address, or None."""
        return self._spots.get((space, address))

    def read(self, space, address):
        """A register or bit as the master reads it."""
        if space == Space.FILES:
            return self.records.get(address, 0)
        found = self.spot(space, address)
        if found is None:
            return 0
        point, item, word = found
        return point.registers(self.values[point.name, item])[word]

    def _grant(self, space, address, quantity, write, file=None):
        if space == Space.FILES:
            found = next((f for f in self.device.files if f.number == file), None)
            if not found or address + quantity > found.records or (write and found.access == "ro"):
                raise Refused(EX.ADDRESS)
            return
        for a in range(address, address + quantity):
            found = self.spot(space, a)
            if a > 65535 or (found is None and space not in self._zero):
                raise Refused(EX.ADDRESS)
            if found and not (found[0].writable if write else found[0].readable):
                raise Refused(EX.ADDRESS)

    def _store(self, space, address, values):
        """Every value is judged before the first is stored."""
        if space == Space.FILES:
            for n, value in enumerate(values):
                self.records[address + n] = value
            return
        new = {}
        for n, value in enumerate(values):
            found = self.spot(space, address + n)
            if found:
                point, item, word = found
                words = new.setdefault((point.name, item), point.registers(self.values[point.name, item]))
                words[word] = value
        joined = {}
        for (name, item), words in new.items():
            point = self.device.point(name)
            joined[name, item] = point.join(words)
            if not point.is_bit and not point.accepts(joined[name, item]):
                raise Refused(EX.VALUE)
        self.values |= joined
        self.strobes += [key for key in joined if self.device.point(key[0]).strobe]
        for (name, _), raw in joined.items():
            if raw and any(p.freeze == name for p in self.device.points):
                self.frozen_by(name)

    def frozen_by(self, coil):
        """Take the snapshot; which of two values a live wire had is told by the harness."""
        self.taken.add(coil)
        for point in self.device.points:
            if point.freeze == coil:
                for item in range(point.count):
                    self.values[point.name, item] = self.wire[point.name, item]
