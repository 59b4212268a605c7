# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random maps, and random requests to them, drawn by hypothesis: most of them legal, or nearly so.

What is drawn first in a choice is what hypothesis shrinks to: no option, the lowest number, the first of a list.
"""

import random
import struct

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded
from hypothesis import strategies as st
from modbus_map.model import File, Point
from protocol.frames import adu, bad_crc

from map.devices import device, point

TYPES = ("u16", "i16", "u16", "i16", "u32", "i32", "f32", "u64", "i64", "f64", "string<5>", "bits")
TABLES = ("coils", "discrete_inputs", "input_registers", "holding_registers")
FLOATS = {"f32": ("f", 4), "f64": ("d", 8)}
BITS = {"coils": 1, "discrete_inputs": 1}
EVERY_CHECK_OFF = list(HealthCheck)
PLAIN = {  # the seed alone says what is played
    "database": None,
    "deadline": None,
    "suppress_health_check": EVERY_CHECK_OFF,
    "print_blob": False,
    "report_multiple_bugs": False,
}


class Drawn:
    """The draws of an example, named as those of random.Random."""

    def __init__(self, draw):
        self.draw = draw

    def chance(self, percent):
        return self.draw(st.integers(0, 99)) >= 100 - percent

    def choice(self, values):
        return self.draw(st.sampled_from(values))

    def randint(self, low, high):
        return self.draw(st.integers(low, high))

    def getrandbits(self, size):
        return int.from_bytes(self.draw(st.binary(min_size=(size + 7) // 8, max_size=(size + 7) // 8))) >> -size % 8

    def sample(self, values, count):
        return self.draw(st.permutations(values))[:count]

    def other(self):
        """A Random for what need not be shrunk."""
        return random.Random(self.randint(0, (1 << 32) - 1))


def number_to_raw(kind, number, size):
    if kind in FLOATS:
        letter, _length = FLOATS[kind]
        return int.from_bytes(struct.pack(f">{letter}", number), "big")
    return int(number) & ((1 << size) - 1)


def limits(rng, kind, size):
    """Fields of a point that limit its values; a reset that they allow."""
    if kind.startswith("string") or kind == "bits" or not rng.chance(50):
        return {}, None
    if kind not in FLOATS and rng.chance(30):
        values = sorted(rng.sample(range(12), rng.randint(1, 5)) if rng.chance(50) else range(rng.randint(1, 6)))
        return {"enum": tuple(values)}, rng.choice(values)
    span = 1 << rng.choice((3, size // 2, size - 2))
    low, high = sorted((rng.randint(-span, span), rng.randint(-span, span)))
    if kind.startswith("u"):
        low, high = abs(low), abs(low) + high - low
        high = min(high, (1 << size) - 1)
    if kind in FLOATS:
        low, high = rng.choice((0.0, -0.0, float(low))), float(high)
        low, high = min(low, high), max(low, high)
    found = {}
    if rng.chance(80):
        found["minimum"] = number_to_raw(kind, low, size)
    if rng.chance(80) or not found:
        found["maximum"] = number_to_raw(kind, high, size)
    return found, number_to_raw(kind, low if "minimum" in found else high, size)


def random_point(rng, table, at, name, coils):
    """A point of `table` at `at`."""
    written = table in ("coils", "holding_registers")
    kind = "" if table in BITS else rng.choice(TYPES)
    fields = {"count": rng.choice((1, 1, 1, 1, 2, 3, 5, rng.randint(1, 20)))}
    if written:
        fields["access"] = rng.choice(("rw", "rw", "rw", "ro", "wo"))
    if not written or fields["access"] == "ro":
        fields["kind"] = rng.choice(("wire", "wire", "constant"))
    if kind and rng.chance(40):
        fields["word_order"] = "little"
    made = point(table, at, name, kind, **fields)
    if kind and made.width == 1 and rng.chance(15):
        fields["kind"] = "memory"
    if fields.get("kind", made.kind) == "wire" and coils and rng.chance(30):
        fields["freeze"] = rng.choice(coils)
    resets = [rng.getrandbits(made.bits) if rng.chance(50) else 0 for _ in range(made.count)]
    if made.writable and kind:
        extra, allowed = limits(rng, kind, made.bits)
        fields |= extra
        if allowed is not None:
            resets = [allowed] * made.count
    if made.writable and rng.chance(30):
        fields["strobe"] = True
    if fields.get("kind", made.kind) == "wire":
        resets = [0] * made.count
    return point(table, at, name, kind, **fields, resets=tuple(resets))


def random_device(rng, name):
    """A device of a few points in each table, with gaps."""
    points: list[Point] = []
    coils: list[str] = []
    for table in TABLES:
        if rng.chance(15):
            continue
        at = rng.choice((0, 0, 0, 1, 100, 1000, rng.randint(0, 60000)))
        for number in range(rng.randint(1, 6)):
            made = random_point(rng, table, at, f"{table[0]}{number}{rng.choice('abc')}", coils)
            if made.last > 65535:
                break
            points.append(made)
            if table == "coils" and made.count == 1 and made.kind == "register" and made.writable:
                coils.append(made.name)
            at = made.last + 1 + rng.choice((0, 0, 0, 0, 1, 2, 7, 300))
    if not points:
        points = [point("coils", 0, "only")]
    points = rng.sample(points, len(points))
    zero = frozenset(t for t in TABLES if rng.chance(15) and any(p.table == t for p in points))
    files = [File(n, f"file{n}", rng.randint(1, 40), rng.choice(("rw", "ro"))) for n in (1, 2, 7) if rng.chance(30)]
    return device(name, points, zero_gaps=zero, files=files, functions=(1, 2, 3, 4, 5, 6, 15, 16, 20, 21, 22, 23))


@st.composite
def maps(draw, name):
    """A device of that name."""
    return random_device(Drawn(draw), name)


@st.composite
def plays(draw, device_, address, most):
    """(frames of up to `most` requests, seed of the values that the wires and the host have meanwhile)."""
    rng = Drawn(draw)
    frames = [request(rng, device_, address) for _ in range(rng.randint(1, most))]
    return frames, rng.randint(0, (1 << 32) - 1)


def devices(seed, count, name):
    """`count` devices, `name`0 and up. Each comes from a run of its own, since hypothesis varies the one it has drawn."""

    def drawn(number):
        found = []

        @seeded(seed + number)
        @settings(max_examples=2, phases=[Phase.generate], **PLAIN)
        @given(maps(f"{name}{number}"))
        def collect(made):
            found.append(made)  # the first is the simplest

        collect()
        return found[-1]

    return [drawn(number) for number in range(count)]


# -------------------------------------------------------------------- requests


def some_value(rng, made, item):
    """A raw value for a point: mostly one that is accepted."""
    edges = [v for v in (made.minimum, made.maximum) if v is not None] + [e.raw for e in made.enum]
    size = (1 << made.bits) - 1
    if edges and rng.chance(80):
        return (rng.choice(edges) + rng.choice((0, 0, -1, 1))) & size
    if made.is_float and rng.chance(90):
        return number_to_raw(made.type, rng.choice((0.0, -0.0, 1.5, float("nan"), float("inf"), -2.25)), made.bits)
    return rng.getrandbits(made.bits)


def words_for(rng, device_, table, first, quantity):
    """Registers (bits) for a write: values of points where there are points."""
    words = {}
    for made in device_.table(table):
        for item in range(made.count):
            addresses = made.addresses(item)
            if addresses[0] < first + quantity and addresses[-1] >= first:
                words |= dict(zip(addresses, made.registers(some_value(rng, made, item))))
    other = rng.other()
    return [words.get(a, other.getrandbits(1 if table in BITS else 16)) for a in range(first, first + quantity)]


def spot(rng, device_, table, most):
    """(first address, quantity) around the points of a table."""
    points = device_.table(table)
    if not points or rng.chance(3):
        return rng.choice((0, 65535, rng.randint(0, 65535))), rng.randint(1, 4)
    made = rng.choice(points)
    what = rng.choice(("it", "it", "it", "inside", "inside", "inside", "to another", "to another", "near", "near"))
    if what == "it":
        return made.at, min(made.size, most)
    if what == "inside":
        first = rng.randint(made.at, made.last)
        return first, min(rng.randint(1, made.last - first + 1), most)
    first = max(0, made.at + rng.randint(-2, made.size))
    last = rng.choice(points).last + rng.choice((0, 0, 0, 0, 1)) if what == "to another" else first + rng.randint(0, 6)
    return first, max(1, min(most, last - first + 1))


def pdu(rng, device_):
    """A request; its function code is the first byte."""
    code = rng.choice((1, 2, 3, 3, 3, 4, 4, 5, 6, 15, 16, 16, 16, 22, 23, 20, 21))
    if code in (1, 2, 3, 4):
        table = {1: TABLES[0], 2: TABLES[1], 3: TABLES[3], 4: TABLES[2]}[code]
        return struct.pack(">BHH", code, *spot(rng, device_, table, 125))
    if code == 5:
        first, _ = spot(rng, device_, "coils", 1)
        return struct.pack(">BHH", code, first, rng.choice((0, 0xFF00, 0xFF00, 0xFF00, 0x0100)))
    if code == 6:
        first, _ = spot(rng, device_, "holding_registers", 1)
        return struct.pack(">BHH", code, first, words_for(rng, device_, "holding_registers", first, 1)[0])
    if code == 15:
        first, quantity = spot(rng, device_, "coils", 40)
        bits = words_for(rng, device_, "coils", first, quantity)
        data = bytearray((quantity + 7) // 8)
        for n, bit in enumerate(bits):
            data[n // 8] |= bit << n % 8
        return struct.pack(">BHHB", code, first, quantity, len(data)) + data
    if code == 16:
        first, quantity = spot(rng, device_, "holding_registers", 123)
        words = words_for(rng, device_, "holding_registers", first, quantity)
        return struct.pack(f">BHHB{quantity}H", code, first, quantity, 2 * quantity, *words)
    if code == 22:
        first, _ = spot(rng, device_, "holding_registers", 1)
        return struct.pack(">BHHH", code, first, rng.choice((0, 0xFFFF, rng.getrandbits(16))), rng.getrandbits(16))
    if code == 23:
        read, count = spot(rng, device_, "holding_registers", 60)
        first, quantity = spot(rng, device_, "holding_registers", 60)
        words = words_for(rng, device_, "holding_registers", first, quantity)
        return struct.pack(f">BHHHHB{quantity}H", code, read, count, first, quantity, 2 * quantity, *words)
    file = rng.choice(device_.files) if device_.files and not rng.chance(10) else File(3, "none", 20, "rw")
    first = rng.randint(0, file.records)
    rest = max(1, file.records - first)
    quantity = min(rng.choice((1, rest, rest, rest + 1, rng.randint(1, 10))), 40)
    group = struct.pack(">BHHH", 6, file.number, first, quantity)
    if code == 20:
        return bytes([code, len(group)]) + group
    group += bytes(rng.getrandbits(8) for _ in range(2 * quantity))
    return bytes([code, len(group)]) + group


def request(rng, device_, address):
    """A frame, sometimes a broken one."""
    data = pdu(rng, device_)
    what = rng.choice((None,) * 20 + ("short", "long", "function", "byte"))
    if what == "short":
        data = data[:-1]
    elif what == "long":
        data += b"\0"
    elif what == "function":
        data = bytes([rng.choice((0, 7, 9, 65, 100, 200))]) + data[1:]
    elif what == "byte":
        data = bytearray(data)
        data[rng.randint(1, len(data) - 1)] = rng.getrandbits(8)
    to = 0 if rng.chance(8) else address
    frame = adu(to, bytes(data))
    return bad_crc(frame) if rng.chance(2) else frame
