# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The two banks on their core side: grant and Wishbone, and for the RAM bank the host beside it."""

import cocotb
from harness.bench import PARAMETERS, TOP
from harness.build import DEFAULT_COUNTS, model_config
from harness.unit import clocks, settle, start
from protocol.defs import BIT_SPACES, CHECK_SPACES, Space, bus_address

from bank.bank_guard import expected

PATIENCE = 50
CHECK_OF = {table: space for space, table in CHECK_SPACES.items()}
RAM = TOP == "modbus_bank_ram"
WIDE = int(PARAMETERS.get("BITS_PER_BEAT", 1)) != 1  # a beat of bits is what a burst has in a word of 16 items
CHECKS = int(PARAMETERS.get("CHECK_WRITES", 0))
DROP_IN = "slave_bench" if RAM else "io_bench"


class Bank:
    """The core's side of a bank."""

    @classmethod
    async def start(cls, dut):
        self = cls()
        self.dut, self.rng = dut, await start(dut)
        self.config = model_config(DROP_IN, PARAMETERS)
        assert DROP_IN in DEFAULT_COUNTS
        return self

    async def ask(self, space, first, last, write):
        """The grant question; the exception code."""
        dut = self.dut
        dut.grant_space_i.value, dut.grant_write_i.value = int(space), write
        dut.grant_first_i.value, dut.grant_last_i.value, dut.grant_req_i.value = first, last, 1
        for _ in range(PATIENCE):
            await settle()
            if int(dut.grant_ack_o.value):
                code = int(dut.exception_o.value)
                await clocks(dut)
                dut.grant_req_i.value = 0
                await clocks(dut)
                return code
            await clocks(dut)
        raise AssertionError("no verdict")

    async def burst(self, space, first, values=None, count=0):
        """One burst under one cyc: writes `values`, or reads `count` items; the items read."""
        dut, out = self.dut, []
        count = len(values) if values is not None else count
        wide = WIDE and space in BIT_SPACES
        dut.wb_cyc_i.value, dut.wb_we_i.value = 1, int(values is not None)
        place = 0
        while place < count:
            lane = (first + place) % 16
            beat = min(count - place, 16 - lane) if wide else 1
            dut.wb_stb_i.value, dut.wb_adr_i.value = 1, bus_address(space, first + place)
            if values is not None and wide:
                word = self.rng.getrandbits(16)  # what is no item of the beat is noise
                for n, value in enumerate(values[place : place + beat], lane):
                    word = word & ~(1 << n) | value << n
                dut.wb_dat_i.value = word
            elif values is not None:
                dut.wb_dat_i.value = values[place]
            for _ in range(PATIENCE):
                await settle()
                if int(dut.wb_ack_o.value):
                    break
                await clocks(dut)
            else:
                raise AssertionError(f"no ack for item {first + place}")
            seen = dut.wb_dat_o.value if values is None else 0
            out += [int(seen) >> n & 1 for n in range(lane, lane + beat)] if wide else [int(seen)]
            place += beat
            await clocks(dut)
            if self.rng.random() < 0.2:  # the core may pause between two beats, the next address on show
                dut.wb_stb_i.value, dut.wb_adr_i.value = 0, bus_address(space, (first + place) & 0xFFFF)
                await clocks(dut, self.rng.randrange(1, 4))
        dut.wb_cyc_i.value = dut.wb_stb_i.value = 0
        await clocks(dut)
        return out

    async def write(self, space, first, values):
        """A write that is granted."""
        assert await self.ask(space, first, first + len(values) - 1, 1) == 0
        await self.burst(space, first, values)

    async def read(self, space, first, count):
        """A read that is granted; the items without what a bit has above itself."""
        assert await self.ask(space, first, first + count - 1, 0) == 0
        seen = await self.burst(space, first, count=count)
        return [value & 1 for value in seen] if space in BIT_SPACES else seen

    def writable(self):
        """(space, base, count) of the tables that the core can write, without the read-only range."""
        for space in (Space.COILS, Space.HOLDINGS):
            base, count = self.config.tables[space]
            if count:
                yield space, base, count


@cocotb.test()
async def bursts_keep_what_they_write(dut):
    bank = await Bank.start(dut)
    for _ in range(6):
        for space, base, count in bank.writable():
            quantity = bank.rng.randint(1, min(count, 40))
            first = base + bank.rng.randint(0, count - quantity)
            values = [bank.rng.getrandbits(1 if space in BIT_SPACES else 16) for _ in range(quantity)]
            await bank.write(space, first, values)
            seen = await bank.read(space, first, quantity)
            assert seen == values, f"{space.name} {first}: wrote {values}, read {seen}"


@cocotb.test(skip=not CHECKS)
async def a_checking_pass_stores_nothing(dut):
    """Over whole tables: what is stored by mistake would be somewhere else."""
    bank = await Bank.start(dut)
    tables = {space: (base, count) for space, base, count in bank.writable()}
    image = {}
    for space, (base, count) in tables.items():
        image[space] = [bank.rng.getrandbits(1 if space in BIT_SPACES else 16) for _ in range(count)]
        await bank.write(space, base, image[space])
    for _ in range(20):
        for space, (base, count) in tables.items():
            quantity = bank.rng.randint(1, min(count, 40))
            first = base + bank.rng.randint(0, count - quantity)
            assert await bank.ask(space, first, first + quantity - 1, 1) == 0
            others = [value ^ 1 for value in image[space][first - base : first - base + quantity]]
            await bank.burst(CHECK_OF[space], first, others)
    for space, (base, count) in tables.items():
        seen = await bank.read(space, base, count)
        wrong = [base + n for n, (a, b) in enumerate(zip(seen, image[space], strict=True)) if a != b]
        assert not wrong, f"{space.name}: stored by a checking pass: {wrong}"


@cocotb.test(skip=not WIDE)
async def a_beat_of_bits_leaves_the_others_alone(dut):
    """Bursts of any alignment over a table whose contents are known; then every item is read alone."""
    bank = await Bank.start(dut)
    base, count = bank.config.tables[Space.COILS]
    image = [0] * count  # block RAM keeps what it held before
    await bank.write(Space.COILS, base, image)
    for number in range(64):
        first = bank.rng.randrange(count) if number % 2 else min(number // 2, count - 1)
        quantity = bank.rng.randint(1, min(count - first, 50))
        values = [bank.rng.getrandbits(1) for _ in range(quantity)]
        await bank.write(Space.COILS, base + first, values)
        image[first : first + quantity] = values
    assert await bank.ask(Space.COILS, base, base + count - 1, 0) == 0
    assert await bank.burst(Space.COILS, base, count=count) == image
    for item in range(min(count, 70)):
        assert await bank.ask(Space.COILS, base + item, base + item, 0) == 0
        assert await bank.burst(Space.COILS, base + item, count=1) == [image[item]], f"coil {base + item}"


@cocotb.test()
async def verdicts_are_the_models(dut):
    from protocol.model import Slave

    bank = await Bank.start(dut)
    slave = Slave(bank.config)
    for _ in range(200):
        space = bank.rng.randrange(4)
        base, count = bank.config.tables[space]
        first = min(max(bank.rng.choice((base, base + count)) + bank.rng.randint(-2, 2), 0), 65535)
        last = min(first + bank.rng.choice((0, 0, 1, count, 124)), 65535)
        write = int(space in (Space.COILS, Space.HOLDINGS)) and bank.rng.getrandbits(1)
        wanted = expected(slave, space, first, last, write)
        seen = await bank.ask(space, first, last, write)
        assert seen == wanted, f"space {space}, {first}..{last}, write {write}: expected {wanted}, seen {seen}"


@cocotb.test(skip=RAM)
async def outputs_follow_the_writes(dut):
    bank = await Bank.start(dut)
    image = {Space.COILS: 0, Space.HOLDINGS: 0}
    for _ in range(40):
        for space, base, count in bank.writable():
            width = 1 if space in BIT_SPACES else 16
            place, value = bank.rng.randrange(count), bank.rng.getrandbits(width)
            assert await bank.ask(space, base + place, base + place, 1) == 0
            await bank.burst(space, base + place, [value])
            mask = ((1 << width) - 1) << (width * place)
            image[space] = image[space] & ~mask | value << (width * place)
            seen = int((dut.coils_o if space in BIT_SPACES else dut.holdings_o).value)
            assert seen == image[space], f"{space.name} {base + place} = {value:X}"


@cocotb.test(skip=RAM)
async def registers_read_as_their_outputs(dut):
    """Every holding register, behind power-up, writes, and a reset that falls between them or into a burst."""
    bank = await Bank.start(dut)
    base, count = bank.config.tables[Space.HOLDINGS]
    assert await bank.ask(Space.HOLDINGS, base, base + count - 1, 0) == 0

    async def compare(image, when):
        seen = int(dut.holdings_o.value)
        assert seen == sum(word << 16 * n for n, word in enumerate(image)), f"{when}: the outputs are {seen:X}"
        for n in bank.rng.sample(range(count), count):  # one a burst, in any order
            assert await bank.burst(Space.HOLDINGS, base + n, count=1) == [image[n]], f"{when}: register {base + n}"
        assert await bank.burst(Space.HOLDINGS, base, count=count) == image, f"{when}: all in a burst"

    await compare([0] * count, "behind power-up")
    for number in range(8):
        image = [0] * count
        for n in bank.rng.sample(range(count), bank.rng.randint(1, count)):
            image[n] = bank.rng.getrandbits(16)
            await bank.burst(Space.HOLDINGS, base + n, [image[n]])
        await compare(image, f"behind the writes of round {number}")
        dut.wb_cyc_i.value = dut.wb_stb_i.value = number % 2  # the reset falls into a write, or it does not
        dut.wb_we_i.value, dut.wb_adr_i.value, dut.wb_dat_i.value = 1, bus_address(Space.HOLDINGS, base), 0xDEAD
        await clocks(dut, number // 2)
        dut.rst_i.value = 1
        await clocks(dut)
        dut.wb_cyc_i.value = dut.wb_stb_i.value = dut.rst_i.value = 0
        await clocks(dut)
        await compare([0] * count, f"behind the reset of round {number}")


@cocotb.test(skip=not RAM)
async def host_and_core_take_turns(dut):
    """A host that always wants the bus and a core that bursts: both get their data, bursts unbroken."""
    bank = await Bank.start(dut)
    base, count = bank.config.tables[Space.HOLDINGS]
    stop, rounds = [], []

    async def host():
        value = 0
        while not stop:
            for write in (1, 0):
                value = (value + write) & 0xFFFF
                dut.host_cyc_i.value = dut.host_stb_i.value = 1
                dut.host_we_i.value, dut.host_dat_i.value = write, value
                dut.host_adr_i.value = bus_address(Space.HOLDINGS, base + count - 1)
                while True:
                    await settle()
                    if int(dut.host_ack_o.value):
                        break
                    assert not int(dut.host_err_o.value)
                    await clocks(dut)
                seen = int(dut.host_dat_o.value)
                await clocks(dut)
                dut.host_cyc_i.value = dut.host_stb_i.value = 0
                await clocks(dut)
                if not write:
                    assert seen == value, f"the host wrote {value}, read {seen}"
                    rounds.append(value)

    task = cocotb.start_soon(host())
    for _ in range(12):
        values = [bank.rng.getrandbits(16) for _ in range(min(20, count - 1))]
        await bank.write(Space.HOLDINGS, base, values)
        assert await bank.ask(Space.HOLDINGS, base, base + len(values) - 1, 0) == 0
        assert await bank.burst(Space.HOLDINGS, base, count=len(values)) == values
    stop.append(True)
    await task
    assert len(rounds) > 5, "the host hardly ever got the bus"


@cocotb.test(skip=not RAM)
async def host_reaches_each_table_to_its_ends(dut):
    """ack from the first items, in every lane, to the last, err before and behind; no table lies on another."""
    bank = await Bank.start(dut)
    image = {}

    async def access(space, item, write=None):
        dut.host_cyc_i.value = dut.host_stb_i.value = 1
        dut.host_we_i.value, dut.host_dat_i.value = int(write is not None), write or 0
        dut.host_adr_i.value = bus_address(space, item)
        for _ in range(PATIENCE):
            await settle()
            ack, err = int(dut.host_ack_o.value), int(dut.host_err_o.value)
            if ack or err:
                assert not (ack and err)
                value = int(dut.host_dat_o.value) if ack else None
                await clocks(dut)
                dut.host_cyc_i.value = dut.host_stb_i.value = 0
                await clocks(dut)
                return value
            await clocks(dut)
        raise AssertionError(f"no answer for {space} {item}")

    for write in (True, False):
        for space in list(Space)[:4]:
            base, count = bank.config.tables[space]
            for item in sorted({base - 1, *range(base, base + min(count, 16)), base + count - 1, base + count}):
                if not 0 <= item <= 65535:
                    continue
                exists = base <= item < base + count
                if write:
                    value = bank.rng.getrandbits(1 if space in BIT_SPACES else 16)
                    assert (await access(space, item, value) is not None) == exists, f"{space.name} {item}"
                    if exists:
                        image[space, item] = value
                else:
                    assert await access(space, item) == image.get((space, item)), f"{space.name} {item}"


@cocotb.test()
async def what_is_withdrawn_is_forgotten(dut):
    """No ack without a question, and none without a strobe, however late the core has withdrawn either."""
    bank = await Bank.start(dut)
    base, count = bank.config.tables[Space.HOLDINGS]
    for held in range(4):
        dut.grant_space_i.value, dut.grant_write_i.value = int(Space.HOLDINGS), 0
        dut.grant_first_i.value = dut.grant_last_i.value = base
        dut.grant_req_i.value = 1
        await clocks(dut, held)
        dut.grant_req_i.value = 0
        for _ in range(4):
            await settle()
            assert not int(dut.grant_ack_o.value), f"a question of {held} clocks is answered behind its end"
            await clocks(dut)
        dut.wb_cyc_i.value = dut.wb_stb_i.value = 1
        dut.wb_adr_i.value = bus_address(Space.HOLDINGS, base)
        await clocks(dut, held)
        dut.wb_cyc_i.value = dut.wb_stb_i.value = 0
        for _ in range(4):
            await settle()
            assert not int(dut.wb_ack_o.value) and not int(dut.wb_err_o.value)
            await clocks(dut)
    assert await bank.ask(Space.HOLDINGS, base, base + count - 1, 0) == 0
