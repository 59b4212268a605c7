# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The part of test_NAME.py that is the same for each device; testbench.py puts the table of points between."""

# ---- head, copied from here
import itertools
import os
import random
import struct
import sys
from pathlib import Path
from typing import NamedTuple

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, First, RisingEdge, Timer, ValueChange


class Point(NamedTuple):
    """A point of the map. `good` and `bad`: values that the master may write, and may not, around each limit."""

    name: str
    table: str
    at: int
    width: int = 1  # addresses of an item
    count: int = 1
    kind: str = "register"
    access: str = "rw"
    resets: tuple[int, ...] = (0,)
    good: tuple[int, ...] = ()
    bad: tuple[int, ...] = ()
    little: bool = False  # the low word has the lowest address
    strobe: bool = False
    freeze: str = ""
    fifo: bool = False

    @property
    def bits(self):
        return 1 if self.table in BIT_TABLES else 16 * self.width

    def place(self, item):
        return self.at + item * self.width

    def words(self, raw):
        """The registers (bit) of an item, the lowest address first."""
        words = [raw >> 16 * n & 0xFFFF for n in range(self.width)]
        return words if self.little else words[::-1]


BIT_TABLES = ("coils", "discrete_inputs")
# ---- head ends
# What testbench.py writes here, for a device of one register:
NAME = "example"
ADDRESS, FORMAT, RUN_TIME, BROADCAST = 1, 0, False, True
FUNCTIONS = (3, 16)
MOST_READ, MOST_WRITE = 125, 123
T35_MIN_US, RESPONSE_DELAY = 1750, 0
POINTS = [Point("level", "holding_registers", 0, good=(0, 0xFFFF))]
FREE: dict[str, tuple[int, ...]] = {"holding_registers": (1,)}
ZERO_GAPS: tuple[str, ...] = ()
FILES: list[tuple[int, int, str]] = []
# ---- body, copied from here
CLK_HZ, BAUD = 153_600, 19_200  # parameters of the simulation: few clocks a bit, so it is fast
PERIOD_NS = 10  # of the simulated clock: only clocks count
BIT_NS = CLK_HZ // BAUD * PERIOD_NS
PARITY_ODD = {0: 0, 1: 1}.get(FORMAT)  # None: no parity
CHARACTER_BITS = 10 if FORMAT == 3 else 11
SILENCE = max(4 * CHARACTER_BITS * CLK_HZ // BAUD, T35_MIN_US * CLK_HZ // 950_000)  # clocks between two frames
PATIENCE_NS = (RESPONSE_DELAY + 600) * BIT_NS + SILENCE * PERIOD_NS
READ = {"coils": 1, "discrete_inputs": 2, "holding_registers": 3, "input_registers": 4}
WRITE = {"coils": (15, 5), "holding_registers": (16, 6)}  # the function code of several items, of one
SPACE = {"input_registers": 2, "holding_registers": 3}
NO_FUNCTION, NO_ADDRESS, BAD_VALUE = 1, 2, 3


def crc16(data):
    """The check field as a number; its low byte is sent first."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return value


def can_read(table):
    return READ[table] in FUNCTIONS


def most_written(point):
    """Addresses that one request may write at this point; 0: the function codes of the map do not reach it."""
    several, one = WRITE.get(point.table, (0, 0))
    if several in FUNCTIONS:
        return 800 if point.table == "coils" else MOST_WRITE
    return 1 if one in FUNCTIONS else 0


def writable():
    """The points that are written here: one of several registers needs a function code that writes it in one piece."""
    return [p for p in POINTS if p.access != "ro" and most_written(p) >= p.width]


def ends(point):
    """The first and the last item."""
    return sorted({0, point.count - 1})


def pattern(point, which):
    """Values for all items: `which` 0 something, 1 its complement."""
    rng = random.Random(point.name)
    return [rng.getrandbits(point.bits) ^ (which and (1 << point.bits) - 1) for _ in range(point.count)]


def packed(point, values):
    """The items as their port has them."""
    return sum(value << n * point.bits for n, value in enumerate(values))


def shown(point, values):
    """The items as the master reads them."""
    return [word for value in values for word in (point.words(value) if point.bits > 1 else [value])]


def adjoining(points):
    """The points in groups: those of a group follow each other without a gap."""
    groups = []
    for point in sorted(points, key=lambda p: (p.table, p.at)):
        last = groups[-1][-1] if groups else None
        if last and last.table == point.table and last.place(last.count) == point.at:
            groups[-1].append(point)
        else:
            groups.append([point])
    return groups


def neighbours(point, item):
    """[(point, item) that ends before this item or begins behind it] where the master may write."""
    here, found = point.place(item), []
    for other in writable():
        for n in range(other.count) if other.table == point.table and other.good else ():
            behind, before = other.place(n) == here + point.width, other.place(n) + other.width == here
            if (other, n) != (point, item) and (behind or before):
                found.append((other, n))
    return found


class Bench:
    """The device behind its pins, and a master at its line."""

    def __init__(self, dut):
        self.dut = dut
        self.values = {p.name: list(p.resets) for p in POINTS}

    async def begin(self):
        """Clock, reset, all inputs 0, and the silence that a slave awaits."""
        dut = self.dut
        dut.rst_i.value, dut.rxd_i.value = 1, 1
        if RUN_TIME:
            dut.address_i.value, dut.bit_time_i.value, dut.format_i.value = ADDRESS, CLK_HZ // BAUD, FORMAT
        if any(p.kind == "memory" for p in POINTS) or FILES:
            for name in ("cyc", "stb", "we", "adr", "dat"):
                getattr(dut, f"host_{name}_i").value = 0
        for point in POINTS:
            if point.kind == "wire":
                self.drive(point, [0] * point.count)
        await Timer(PERIOD_NS, "ns")  # all inputs have values before the first edge
        Clock(dut.clk_i, PERIOD_NS, "ns", impl="gpi").start()
        await ClockCycles(dut.clk_i, 10)
        dut.rst_i.value = 0
        await ClockCycles(dut.clk_i, 2 * SILENCE)
        return self

    # ---- the line

    async def send(self, to, body):
        frame = bytes([to, *body])
        check = crc16(frame)
        for byte in (*frame, check & 255, check >> 8):
            bits = [0, *(byte >> n & 1 for n in range(8))]
            bits += [1] if PARITY_ODD is None else [byte.bit_count() & 1 ^ PARITY_ODD]
            bits += [1] * (CHARACTER_BITS - len(bits))
            for bit, same in itertools.groupby(bits):
                self.dut.rxd_i.value = bit
                await Timer(BIT_NS * len(list(same)), "ns")

    async def receive(self):
        """The bytes of one answer; none after a while without one."""
        dut, data = self.dut, bytearray()
        await First(RisingEdge(dut.de_o), Timer(PATIENCE_NS, "ns"))
        if not int(dut.de_o.value):
            return bytes(data)
        while True:
            if int(dut.txd_o.value):
                await First(FallingEdge(dut.txd_o), FallingEdge(dut.de_o))
                if not int(dut.de_o.value):
                    return bytes(data)
            byte = 0
            await Timer(BIT_NS // 2, "ns")
            for n in range(8):
                await Timer(BIT_NS, "ns")
                byte |= int(dut.txd_o.value) << n
            await Timer(BIT_NS, "ns")
            bit = int(dut.txd_o.value)
            assert bit == (1 if PARITY_ODD is None else byte.bit_count() & 1 ^ PARITY_ODD), (
                "parity or stop bit is wrong"
            )
            if PARITY_ODD is not None:
                await Timer(BIT_NS, "ns")
                assert int(dut.txd_o.value), "no stop bit"
            data.append(byte)

    async def ask(self, *body):
        """(exception code or 0, what follows the function code) of the answer."""
        await self.send(ADDRESS, body)
        answer = await self.receive()
        shown = f"request {bytes(body).hex(' ')}, answer {answer.hex(' ') or 'none'}"
        assert len(answer) > 4 and crc16(answer[:-2]) == answer[-2] | answer[-1] << 8 and answer[0] == ADDRESS, shown
        assert answer[1] & 0x7F == body[0], shown
        await ClockCycles(self.dut.clk_i, SILENCE)
        return (answer[2], b"") if answer[1] & 0x80 else (0, answer[2:-2])

    async def read(self, table, at, quantity):
        """(exception, values)."""
        code, data = await self.ask(READ[table], *struct.pack(">HH", at, quantity))
        if code:
            return code, []
        size = (quantity + 7) // 8 if table in BIT_TABLES else 2 * quantity
        assert data[0] == size == len(data) - 1, (
            f"{table} {at}: byte count {data[0]}, {len(data) - 1} bytes, not {size}"
        )
        if table in BIT_TABLES:
            return 0, [data[1 + n // 8] >> n % 8 & 1 for n in range(quantity)]
        return 0, list(struct.unpack(f">{quantity}H", data[1:]))

    async def write(self, table, at, values):
        """Exception of a write."""
        (several, one), quantity = WRITE[table], len(values)
        if several not in FUNCTIONS:
            value = values[0] * 0xFF00 if table == "coils" else values[0]
            code, data = await self.ask(one, *struct.pack(">HH", at, value))
            assert code or data == struct.pack(">HH", at, value), f"{table} {at}: echo {data.hex(' ')}"
            return code
        if table == "coils":
            number = sum(bit << n for n, bit in enumerate(values))
            content = number.to_bytes((quantity + 7) // 8, "little")
        else:
            content = struct.pack(f">{quantity}H", *values)
        code, data = await self.ask(several, *struct.pack(">HHB", at, quantity, len(content)), *content)
        assert code or data == struct.pack(">HH", at, quantity), f"{table} {at}: echo {data.hex(' ')}"
        return code

    # ---- the points

    def port(self, point, end):
        return getattr(self.dut, f"{point.name}_{end}")

    def drive(self, point, values):
        self.port(point, "i").value = packed(point, values)

    async def expect(self, point, values, first=0, last=None):
        """The master reads these values of the items first to last."""
        wanted = shown(point, [values[n] for n in range(first, point.count if last is None else last + 1)])
        most = 2000 if point.table in BIT_TABLES else MOST_READ
        for start in range(0, len(wanted), most):
            part = wanted[start : start + most]
            code, seen = await self.read(point.table, point.place(first) + start, len(part))
            assert (code, seen) == (0, part), f"{point.name}: exception {code}, read {seen}, not {part}"

    async def read_all(self, points):
        """{name: registers or bits} of points, those that adjoin in one request if it has room for them."""
        found = {}
        for group in adjoining(points):
            table, first, words = group[0].table, group[0].at, []
            end, most = group[-1].place(group[-1].count), 2000 if table in BIT_TABLES else MOST_READ
            for at in range(first, end, most):
                code, part = await self.read(table, at, min(most, end - at))
                assert code == 0, f"{table} {at}: exception {code}"
                words += part
            found |= {p.name: words[p.at - first : p.place(p.count) - first] for p in group}
        return found

    async def expect_all(self, points, values):
        """The master reads these values, {name: values}."""
        seen = await self.read_all(points)
        for point in points:
            wanted = shown(point, values[point.name])
            assert seen[point.name] == wanted, f"{point.name}: read {seen[point.name]}, not {wanted}"

    def expect_output(self, point):
        if point.kind == "register":
            seen, wanted = int(self.port(point, "o").value), packed(point, self.values[point.name])
            assert seen == wanted, f"{point.name}_o is {seen:X}, not {wanted:X}"

    async def watch(self, point, values):
        """Note what the output is in each clock in which it changes."""
        port = self.port(point, "o")
        while True:
            await ValueChange(port)
            await FallingEdge(self.dut.clk_i)
            values.append(int(port.value))

    async def watch_strobe(self, point, pulses):
        """Note the items of each clock of a strobe."""
        port = self.port(point, "stb_o")
        while True:
            await ValueChange(port)
            await FallingEdge(self.dut.clk_i)
            while now := int(port.value):
                pulses += [n for n in range(point.count) if now >> n & 1]
                await FallingEdge(self.dut.clk_i)

    async def put(self, point, first, values, wanted=0, way=None):
        """Write items of a point and judge the answer, the output in each clock, the strobes and what is read back."""
        seen, pulses = [], []
        tasks = [cocotb.start_soon(self.watch(point, seen))] if point.kind == "register" else []
        tasks += [cocotb.start_soon(self.watch_strobe(point, pulses))] if point.strobe else []
        words = [word for value in values for word in (point.words(value) if point.bits > 1 else [value])]
        code = await (way or self.write(point.table, point.place(first), words))
        for task in tasks:
            task.cancel()
        told = f"{point.name} from item {first} = {[f'{v:X}' for v in values]}"
        assert code == wanted, f"{told}: exception {code}, not {wanted}"
        before = packed(point, self.values[point.name])
        if not wanted:
            self.values[point.name][first : first + len(values)] = values
        after = packed(point, self.values[point.name])
        if point.kind == "register" and (len(values) == 1 or wanted):
            assert seen == ([after] if after != before else []), f"{told}: the output went through {seen}"
        self.expect_output(point)
        strobes = list(range(first, first + len(values))) if point.strobe and not wanted else []
        assert sorted(pulses) == strobes, f"{told}: strobes of {pulses}, not {strobes}"
        if point.access == "rw" and can_read(point.table) and not (wanted and point.kind == "register"):
            await self.expect(point, self.values[point.name], first, first + len(values) - 1)

    async def host(self, space, item, value=None):
        """An access of the host; the word that is read, None where no memory is."""
        dut = self.dut
        await FallingEdge(dut.clk_i)
        dut.host_cyc_i.value = dut.host_stb_i.value = 1
        dut.host_we_i.value, dut.host_adr_i.value, dut.host_dat_i.value = (
            int(value is not None),
            space << 16 | item,
            value or 0,
        )
        for _ in range(2000):
            await FallingEdge(dut.clk_i)
            if int(dut.host_ack_o.value) or int(dut.host_err_o.value):
                break
        else:
            raise AssertionError("the host port does not answer")
        found = int(dut.host_dat_o.value) if int(dut.host_ack_o.value) else None
        await RisingEdge(dut.clk_i)  # it is stored at this edge
        dut.host_cyc_i.value = dut.host_stb_i.value = 0
        await FallingEdge(dut.clk_i)
        return found

    async def alternate(self, points, pair):
        """Change inputs in every clock between two sets of values."""
        moments = [[(self.port(p, "i"), packed(p, values[p.name])) for p in points] for values in pair]
        while True:
            for moment in moments:
                await FallingEdge(self.dut.clk_i)
                for port, value in moment:
                    port.value = value


# ---- tests; the first one must be the first: memory keeps its contents through a reset


@cocotb.test()
async def reset_values(dut):
    """After power-up, before and behind the reset, each output has its reset value, and the master reads it."""
    await Timer(1, "ns")
    for point in POINTS:
        Bench(dut).expect_output(point)
    bench = await Bench(dut).begin()
    for point in POINTS:
        bench.expect_output(point)
    held = [p for p in POINTS if p.kind in ("register", "constant", "memory") and p.access != "wo" and can_read(p.table)]
    await bench.expect_all(held, {p.name: p.resets for p in held})


@cocotb.test(skip=not any(p.kind == "wire" and not p.freeze for p in POINTS))
async def inputs_are_read(dut):
    """The master reads what is at the inputs, all ones and zeros of it."""
    bench = await Bench(dut).begin()
    points = [p for p in POINTS if p.kind == "wire" and not p.freeze and can_read(p.table)]
    for which in (0, 1):
        for point in points:
            bench.drive(point, pattern(point, which))
        for point in points:
            await bench.expect(point, pattern(point, which))


@cocotb.test(skip=not any(p.kind == "wire" and not p.freeze and p.width > 1 for p in POINTS))
async def inputs_are_read_whole(dut):
    """An input of several registers that changes in every clock is read as of one clock."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        if (
            point.kind != "wire"
            or point.freeze
            or point.width == 1
            or point.width > MOST_READ
            or not can_read(point.table)
        ):
            continue
        pair = [{point.name: pattern(point, which)} for which in (0, 1)]
        task = cocotb.start_soon(bench.alternate([point], pair))
        for item in ends(point):
            code, seen = await bench.read(point.table, point.place(item), point.width)
            wanted = [point.words(values[point.name][item]) for values in pair]
            assert code == 0 and seen in wanted, f"{point.name}: exception {code}, read {seen}, not one of {wanted}"
        task.cancel()


@cocotb.test(skip=not writable())
async def writes_reach_their_outputs(dut):
    """Each value around each limit that is allowed: the output has it, in one clock; one strobe; it is read back."""
    bench = await Bench(dut).begin()
    for point in writable():
        for item in ends(point):
            for value in point.good:
                await bench.put(point, item, [value])
        step = min(point.count, most_written(point) // point.width)
        if point.count > 1 and step > 1:
            for first in range(0, point.count, step):
                items = range(first, min(point.count, first + step))
                await bench.put(point, first, [point.good[n % len(point.good)] for n in items])
    for point in writable():
        bench.expect_output(point)  # writes of other points did not change it
    dut.rst_i.value = 1
    await ClockCycles(dut.clk_i, 3)
    for point in writable():
        if point.kind == "register":
            seen = int(bench.port(point, "o").value)
            assert seen == packed(point, point.resets), f"{point.name}_o is {seen:X} after a reset"


@cocotb.test(skip=not any(p.bad for p in writable()))
async def limits_are_kept(dut):
    """Each value next to a limit that is not allowed: exception 03, and nothing of the request is stored."""
    bench = await Bench(dut).begin()
    for point in writable():
        for item in ends(point) if point.bad else ():
            await bench.put(point, item, [point.good[-1]])
            for value in point.bad:
                await bench.put(point, item, [value], BAD_VALUE)
            for other, n in neighbours(point, item):
                if point.width + other.width > most_written(point):
                    continue
                if other.name != point.name or other.kind == "memory":
                    await bench.put(other, n, [other.good[0]])
                parts = sorted(
                    [(point.place(item), point.words(point.bad[0])), (other.place(n), other.words(other.good[-1]))]
                )
                code = await bench.write(point.table, parts[0][0], [word for _, words in parts for word in words])
                assert code == BAD_VALUE, f"{point.name} beside {other.name}: exception {code}"
                for one in (point, other):
                    bench.expect_output(one)
                if other.access == "rw" and can_read(other.table):
                    await bench.expect(other, bench.values[other.name], n, n)


@cocotb.test()
async def rights_are_kept(dut):
    """A write to what is read-only and a read of what is write-only: exception 02, and nothing is stored."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        for item in ends(point):
            at = point.place(item)
            if point.access == "ro" and most_written(point):
                code = await bench.write(point.table, at, [1])
                assert code == NO_ADDRESS, f"{point.name} was written: exception {code}"
                for other, n in neighbours(point, item):
                    if most_written(point) > other.width:
                        words = other.words(other.good[0]) if other.bits > 1 else [1 - bench.values[other.name][n]]
                        words = [*words, 1] if other.place(n) < at else [1, *words]
                        code = await bench.write(point.table, min(at, other.place(n)), words)
                        assert code == NO_ADDRESS, f"{point.name} beside {other.name}: exception {code}"
                        bench.expect_output(other)
            if point.access == "wo" and can_read(point.table):
                code, _ = await bench.read(point.table, at, 1)
                assert code == NO_ADDRESS, f"{point.name} was read: exception {code}"


@cocotb.test()
async def gaps_are_empty(dut):
    """Addresses next to the points: exception 02, or 0 in a table with `gaps: zero`."""
    bench = await Bench(dut).begin()
    for table, addresses in FREE.items():
        zero = table in ZERO_GAPS
        wanted = (0, [0]) if zero else (NO_ADDRESS, [])
        for at in addresses:
            if any(code in FUNCTIONS for code in WRITE.get(table, ())):
                code = await bench.write(table, at, [1])
                assert code == wanted[0], f"{table} {at}, free, was written: exception {code}"
            if can_read(table):
                assert await bench.read(table, at, 1) == wanted, f"{table} {at} is free"
        if can_read(table):
            code, _ = await bench.read(table, 65535, 2)
            assert code == NO_ADDRESS, f"{table} 65535 and beyond: exception {code}"
            for point in POINTS:
                if point.table == table and point.access != "wo" and not zero:
                    behind = point.place(point.count)
                    if behind in addresses:
                        code, _ = await bench.read(table, behind - 1, 2)
                        assert code == NO_ADDRESS, f"{table} {behind - 1} and {behind}: exception {code}"
    for point in POINTS:
        bench.expect_output(point)


@cocotb.test()
async def other_functions_are_refused(dut):
    """Function codes that the map does not need: exception 01."""
    bench = await Bench(dut).begin()
    for function in {1, 2, 3, 4, 5, 6, 15, 16, 20, 21, 22, 23, 24} - set(FUNCTIONS):
        code, _ = await bench.ask(function, 0, 0, 0, 1)
        assert code == NO_FUNCTION, f"function code {function}: exception {code}"


@cocotb.test(skip=not any(p.freeze for p in POINTS))
async def snapshots_are_of_one_moment(dut):
    """Writing 1 to the coil keeps all of its points as of one clock; writing 0 does nothing."""
    bench = await Bench(dut).begin()
    for coil in [p for p in POINTS if any(q.freeze == p.name for q in POINTS)]:
        points = [p for p in POINTS if p.freeze == coil.name and can_read(p.table)]
        sets = [{p.name: pattern(p, which) for p in points} for which in (0, 1)]
        for point in points:
            bench.drive(point, sets[0][point.name])
        await bench.expect_all(points, {p.name: p.resets for p in points})
        task = cocotb.start_soon(bench.alternate(points, sets))
        if BROADCAST:
            function = 5 if 5 in FUNCTIONS else 15
            await bench.send(
                0,
                struct.pack(">BHH", 5, coil.at, 0xFF00)
                if function == 5
                else struct.pack(">BHHBB", 15, coil.at, 1, 1, 1),
            )
            assert await bench.receive() == b"", "a broadcast was answered"
            await ClockCycles(dut.clk_i, SILENCE)
        else:
            assert await bench.write("coils", coil.at, [1]) == 0
        task.cancel()
        for point in points:
            bench.drive(point, [0] * point.count)
        taken = await bench.read_all(points)
        words = [{p.name: shown(p, values[p.name]) for p in points} for values in sets]
        assert taken in words, f"read {taken}, not one of {words}"
        assert await bench.write("coils", coil.at, [0]) == 0
        assert await bench.read_all(points) == taken, "writing 0 to the coil has changed them"
        assert await bench.write("coils", coil.at, [1]) == 0
        await bench.expect_all(points, {p.name: [0] * p.count for p in points})


@cocotb.test(skip=22 not in FUNCTIONS)
async def mask_writes(dut):
    """Function code 22 on each register of its own: the limits hold for the result."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        if point.table == "holding_registers" and point.width == 1 and point.access == "rw":
            for value, wanted in [*((v, 0) for v in point.good[:3]), *((v, BAD_VALUE) for v in point.bad[:3])]:

                async def mask(at=point.at, value=value):
                    code, data = await bench.ask(22, *struct.pack(">HHH", at, 0, value))
                    assert code or data == struct.pack(">HHH", at, 0, value), f"echo {data.hex(' ')}"
                    return code

                if point.kind == "memory":
                    assert await mask() == wanted, f"{point.name} = {value:X}"
                else:
                    await bench.put(point, 0, [value], wanted, mask())


@cocotb.test(skip=23 not in FUNCTIONS)
async def reads_behind_its_writes(dut):
    """Function code 23: the answer has what the same request has written."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        if point.table == "holding_registers" and point.access == "rw" and point.width <= min(MOST_WRITE, 121):
            for value in point.good[:2]:
                words = point.words(value)
                head = struct.pack(">HHHHB", point.at, point.width, point.at, point.width, 2 * point.width)
                code, data = await bench.ask(23, *head, *struct.pack(f">{point.width}H", *words))
                assert code == 0 and list(struct.unpack(f">{point.width}H", data[1:])) == words, (
                    f"{point.name}: {data.hex(' ')}"
                )


@cocotb.test(skip=not any(p.kind == "memory" for p in POINTS))
async def host_and_master_share_the_memory(dut):
    """What one of them writes the other reads."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        if point.kind != "memory":
            continue
        for item in ends(point):
            at, space = point.place(item), SPACE[point.table]
            for value in pattern(point, 0)[item], pattern(point, 1)[item]:
                for n, word in enumerate(point.words(value)):
                    assert await bench.host(space, at + n, word) is not None, f"{point.name}: host error"
                    assert await bench.host(space, at + n) == word, f"{point.name}: the host reads another value"
                if point.access != "wo" and can_read(point.table):
                    await bench.expect(point, {item: value}, item, item)
            if point in writable():
                words = point.words(point.good[0])
                assert await bench.write(point.table, at, words) == 0
                assert [await bench.host(space, at + n) for n in range(point.width)] == words, f"{point.name}: host"


@cocotb.test(skip=24 not in FUNCTIONS)
async def fifos_are_read(dut):
    """Function code 24 reads as many entries as the count says."""
    bench = await Bench(dut).begin()
    for point in POINTS:
        for count in (0, 1, point.count - 1) if point.fifo else ():
            entries = list(range(0x1100, 0x1100 + count))
            for n, word in enumerate([count, *entries]):
                await bench.host(SPACE[point.table], point.at + n, word)
            code, data = await bench.ask(24, *struct.pack(">H", point.at))
            wanted = struct.pack(f">HH{count}H", 2 + 2 * count, count, *entries)
            assert code == 0 and data == wanted, f"{point.name}: exception {code}, {data.hex(' ')}"


@cocotb.test(skip=not FILES or 20 not in FUNCTIONS)
async def files_are_read_and_written(dut):
    """Function codes 20 and 21 reach the first and the last record, and none beyond."""
    bench = await Bench(dut).begin()
    for number, records, access in FILES:
        for record in sorted({0, records - 1}):
            where = struct.pack(">BHHH", 6, number, record, 1)
            if 21 in FUNCTIONS:
                code, _ = await bench.ask(21, 9, *where, 0x12, record & 0xFF)
                assert code == (0 if access == "rw" else NO_ADDRESS), f"file {number} record {record}: exception {code}"
            code, data = await bench.ask(20, 7, *where)
            wanted = bytes([0x12, record & 0xFF]) if access == "rw" and 21 in FUNCTIONS else bytes(2)
            assert code == 0 and data == bytes([4, 3, 6]) + wanted, f"file {number} record {record}: {data.hex(' ')}"
        code, _ = await bench.ask(20, 7, *struct.pack(">BHHH", 6, number, records, 1))
        assert code == NO_ADDRESS, f"file {number} record {records}: exception {code}"


def main():
    """Build NAME.v and its core, and run all tests; exit status 1 if one fails."""
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    here = Path(__file__).resolve().parent
    core = os.environ.get("MODBUS_RTU")
    if not core:
        sys.exit(f"test_{NAME}: MODBUS_RTU is not set; it is the folder of the core, whose rtl/ {NAME}.f names")
    lines = (here / f"{NAME}.f").read_text().replace("$(MODBUS_RTU)", core).split("\n")
    lines = [line for line in lines if line and not line.startswith("//")]
    simulator = get_runner(os.environ.get("SIM", "icarus"))
    build = here / "sim_build"
    simulator.build(
        sources=[here / line for line in lines if not line.startswith("+")],
        includes=[line.removeprefix("+incdir+") for line in lines if line.startswith("+")],
        hdl_toplevel=NAME,
        parameters={"CLK_HZ": CLK_HZ} | ({} if RUN_TIME else {"BAUD": BAUD, "ADDRESS": ADDRESS, "FORMAT": FORMAT}),
        build_dir=build,
        timescale=("1ns", "1ps"),
        always=True,
    )
    results = build / "results.xml"
    sys.path.insert(0, str(here))
    simulator.test(
        hdl_toplevel=NAME, test_module=f"test_{NAME}", build_dir=build, test_dir=build, results_xml=str(results)
    )
    tests, failed = get_results(results)
    print(f"{tests - failed} passed, {failed} failed")
    sys.exit(1 if failed or not tests else 0)


if __name__ == "__main__":
    main()
