# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The PDM meter at its pins: every printed frame, live inputs and relays, registers, event records."""

import dataclasses

import cocotb
from cocotb.triggers import RisingEdge, Timer, with_timeout
from harness.bench import CLOCK_PS, PARAMETERS, Bench
from harness.volume import volume
from protocol import frames, vectors
from protocol.defs import EX, FC, Limits, Space
from protocol.model import Config, Slave
from protocol.pdm import DEFAULT_DEPTH, RECORD_REGISTER, Event, EventRecords

OWN = 1
DEFAULTS = {
    "DI_COUNT": 4,
    "DO_COUNT": 2,
    "SETTING_COUNT": 256,
    "MEASURED_COUNT": 256,
    "EVENT_RECORD": 1,
    "EVENT_DEPTH": DEFAULT_DEPTH,
}
BUILT = {**DEFAULTS, **PARAMETERS}
INPUTS, RELAYS = BUILT["DI_COUNT"], BUILT["DO_COUNT"]
SETTINGS, REGISTERS = BUILT["SETTING_COUNT"], BUILT["SETTING_COUNT"] + BUILT["MEASURED_COUNT"]
RECORDS = bool(BUILT["EVENT_RECORD"])
CODES = {
    *(FC.READ_HOLDINGS, FC.WRITE_REGISTER, FC.WRITE_REGISTERS),
    *((FC.READ_COILS, FC.WRITE_COIL) if RELAYS else ()),
    *((FC.READ_DISCRETES,) if INPUTS else ()),
}
MOST_READ, MOST_WRITTEN = 50, 60
STALL_BITS = 200
BROADCAST_CLOCKS = 500
EVENT_PATIENCE_US = 20
ASK = frames.read(FC.READ_HOLDINGS, RECORD_REGISTER, 1)


def config():
    """The meter in the model's terms."""
    return Config(
        tables={
            Space.COILS: (0, RELAYS),
            Space.DISCRETES: (0, INPUTS),
            Space.INPUTS: (0, 0),
            Space.HOLDINGS: (0, REGISTERS),
        },
        functions=frozenset(CODES),
        limits=Limits(read_registers=MOST_READ, write_registers=MOST_WRITTEN),
        read_only=(SETTINGS, REGISTERS - SETTINGS),
        user_codes=frozenset({FC.READ_HOLDINGS}) if RECORDS else frozenset(),
    )


class Meter(Bench):
    """The bench on a meter: bits by wires and by the line, registers by the host port, events."""

    def __init__(self, dut, seed):
        super().__init__(dut, seed)
        self.slave = Slave(config())
        self.records = EventRecords(BUILT["EVENT_DEPTH"])
        if RECORDS:
            self.slave.user = lambda pdu: self.records.answer(pdu, self.slave.busy)
        for handle in dut:
            if handle._name == "di_i" or (handle._name.startswith("event_") and handle._name.endswith("_i")):
                handle.value = 0

    async def host(self, space, item, write=None):
        """One host access to a register; the port has no space bits."""
        assert space == Space.HOLDINGS, "the host sees registers only"
        return await super().host(Space(0), item, write)

    async def clean(self):
        """Registers to 0; the relays are open after reset."""
        for space, address in sorted(self.touched):
            if space == Space.HOLDINGS:
                await self.host(space, address, write=0)
        self.touched.clear()

    async def preset(self, key, value):
        """Registers by the host, inputs by their wires, relays by the line."""
        space, address = key
        if space == Space.COILS:
            await self.says(frames.write_coil(address, value))
            return
        self.slave.memory[key] = value
        if space == Space.HOLDINGS:
            await super().preset(key, value)
        else:
            self.dut.di_i.value = sum(self.slave.memory[space, k] << k for k in range(INPUTS))
            await self.clocks(3)

    async def read_back(self, key):
        """What the meter holds, without asking it on the line."""
        space, address = key
        if space == Space.HOLDINGS:
            return await self.host(space, address)
        return int((self.dut.do_o if space == Space.COILS else self.dut.di_i).value) >> address & 1

    async def compare_counters(self, note="", line=False):
        """The meter has no diagnostics."""

    async def event(self, event=None):
        """Report an event, a random one by default."""
        event = event or Event.random(self.rng)
        dut = self.dut
        await RisingEdge(dut.clk_i)
        for field in dataclasses.fields(event):
            getattr(dut, f"event_{field.name}_i").value = int(getattr(event, field.name))
        dut.event_stb_i.value = 1
        await with_timeout(self._taken(), EVENT_PATIENCE_US, "us")
        dut.event_stb_i.value = 0
        self.records.add(event)

    async def _taken(self):
        while True:
            await RisingEdge(self.dut.clk_i)
            if int(self.dut.event_ack_o.value):
                return

    async def says(self, pdu, address=OWN):
        """Send a request to model and meter, and compare; a broadcast is given its time."""
        patience = None if address else BROADCAST_CLOCKS * CLOCK_PS
        return await self.both(frames.adu(address, pdu), patience)


def plays(vector):
    """Whether this build of the meter has what a printed frame of the document needs."""
    if not vector["id"].startswith("S003-"):
        return False
    if vector["id"].startswith("S003-3.7-") and ("pdm_event_record" in vector["config"]) != RECORDS:
        return False
    code = vectors.frame(vector["request"])[1]
    return code in CODES or not vector["request_check_ok"]


CASES = {v["id"]: v for v in vectors.document()["vectors"] if plays(v)}


@cocotb.test()
@cocotb.parametrize(vector=list(CASES))
async def printed_frame_plays(dut, vector):
    case = CASES[vector]
    tb = await Meter.start(dut, address=case["slave_address"])
    for entry in case["preconditions"]:
        if entry["table"] == "pdm_event_record":
            number, event = Event.of_record(bytes(entry["values"]))
            await tb.event(event)
            assert number == tb.records.number
            continue
        for key, value in vectors.contents([entry]):
            await tb.preset(key, value)
    seen = await tb.both(vectors.frame(case["request"]))
    assert seen == vectors.frame(case["expected_response"]), f"printed {case['expected_response']}"
    for key, value in vectors.contents(case["postconditions"]):
        held = await tb.read_back(key)
        assert held == value, f"{key}: printed {value:04X}, holds {held}"
    await tb.finish()


@cocotb.test(skip=not INPUTS)
async def inputs_are_read_live(dut):
    tb = await Meter.start(dut, address=OWN)
    for _ in range(6):
        for k in range(INPUTS):
            await tb.preset((Space.DISCRETES, k), tb.rng.getrandbits(1))
        assert await tb.says(frames.read(FC.READ_DISCRETES, 0, INPUTS)) is not None
        await tb.says(frames.read(FC.READ_DISCRETES, INPUTS - 1, 1))
    await tb.says(frames.read(FC.READ_DISCRETES, 0, INPUTS + 1))
    await tb.finish()


@cocotb.test(skip=not RELAYS)
async def relays_follow_the_line(dut):
    tb = await Meter.start(dut, address=OWN)
    assert int(dut.do_o.value) == 0, "a relay is closed after reset"
    for _ in range(8):
        k = tb.rng.randrange(RELAYS)
        await tb.says(frames.write_coil(k, tb.rng.getrandbits(1)))
        await tb.compare((Space.COILS, k) for k in range(RELAYS))
    await tb.says(frames.read(FC.READ_COILS, 0, RELAYS))
    await tb.says(frames.write_coil(RELAYS, True))
    await tb.says(frames.write_coils(0, [1] * RELAYS))  # function code 0F is none of the meter's
    await tb.compare((Space.COILS, k) for k in range(RELAYS))
    await tb.finish()


@cocotb.test()
async def settings_are_written_measured_values_are_not(dut):
    tb = await Meter.start(dut, address=OWN)
    last = SETTINGS - 1
    for address in (SETTINGS, REGISTERS - 1):
        await tb.preset((Space.HOLDINGS, address), 0x1784)
    for pdu in (
        frames.write_register(last, 0x1111),
        frames.write_register(SETTINGS, 0x2222),
        frames.write_register(REGISTERS - 1, 0x3333),
        frames.write_register(REGISTERS, 0x4444),
        frames.write_registers(last, [5, 6]),
        frames.write_registers(last, [7]),
        frames.read(FC.READ_HOLDINGS, last, 2),
        frames.read(FC.READ_HOLDINGS, REGISTERS - 1, 1),
        frames.read(FC.READ_HOLDINGS, REGISTERS - 1, 2),
    ):
        await tb.says(pdu)
    await tb.compare((Space.HOLDINGS, a) for a in (last, SETTINGS, REGISTERS - 1))
    assert await tb.host(Space.HOLDINGS, REGISTERS) is None, "the host reads past the last register"
    await tb.finish()


@cocotb.test()
async def other_function_codes_are_illegal(dut):
    tb = await Meter.start(dut, address=OWN)
    for code in (*range(1, 26), FC.READ_DEVICE_ID, 0x41, 0x64, 0x7F):
        if code not in CODES:
            answer = await tb.says(bytes([code, 0, 1, 0, 1]))
            assert answer == frames.adu(OWN, bytes([code | 0x80, EX.FUNCTION]))
    await tb.finish()


@cocotb.test(skip=not RECORDS)
async def records_are_read_one_by_one(dut):
    tb = await Meter.start(dut, address=OWN)
    await tb.says(ASK)  # nothing yet
    for count in (1, 3):
        for _ in range(count):
            await tb.event()
        for _ in range(count + 1):
            answer = await tb.says(ASK)
            assert answer[2] == 0x0C
    await tb.finish()


@cocotb.test(skip=not RECORDS)
async def only_an_answered_read_takes_a_record(dut):
    tb = await Meter.start(dut, address=OWN)
    await tb.preset((Space.HOLDINGS, RECORD_REGISTER), 0x1234)
    await tb.event()
    await tb.event()
    await tb.says(ASK, address=0)  # not offered in a broadcast
    await tb.says(ASK, address=OWN + 1)
    await tb.both(frames.bad_crc(frames.adu(OWN, ASK)))
    await tb.says(ASK + b"\0")
    await tb.says(ASK[:-1])
    tb.apply(busy=1)
    assert await tb.says(ASK) == frames.adu(OWN, bytes([0x83, EX.BUSY]))
    tb.apply(busy=0)
    for first, quantity in ((0, 2), (1, 2), (2, 1), (1, MOST_READ), (1, MOST_READ + 1), (1, 0)):
        await tb.says(frames.read(FC.READ_HOLDINGS, first, quantity))
    await tb.says(frames.write_register(RECORD_REGISTER, 0x4321))  # an ordinary setting to everything else
    await tb.says(frames.read(FC.READ_HOLDINGS, 0, 3))
    for number in (1, 2, 2):
        answer = await tb.says(ASK)
        assert int.from_bytes(answer[3:5], "big") == number
    await tb.finish()


@cocotb.test()
async def reset_opens_relays_and_forgets_records(dut):
    tb = await Meter.start(dut, address=OWN)
    await tb.preset((Space.HOLDINGS, 3), 0x5555)
    if RELAYS:
        await tb.says(frames.write_coil(0, True))
    await tb.event()
    await tb.reset()
    tb.records.reset()
    for k in range(RELAYS):
        tb.slave.memory[Space.COILS, k] = 0
    await tb.silence()
    await tb.compare((Space.COILS, k) for k in range(RELAYS))
    await tb.says(ASK)
    await tb.event()
    await tb.says(ASK)
    await tb.finish()  # registers stay


@cocotb.test()
async def a_host_that_holds_on_does_not_silence_the_meter(dut):
    """Past the stall limit registers are busy; inputs, relays and records are not concerned."""
    tb = await Meter.start(dut, address=OWN)
    await tb.event()
    dut.host_cyc_i.value = 1
    await tb.clocks(4)
    answer = await tb.query(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 2)))
    assert answer and answer.data == frames.adu(OWN, bytes([0x83, EX.BUSY])), f"seen {answer}"
    latency = tb.latency(answer)
    assert STALL_BITS - 2 <= latency <= STALL_BITS + 40, f"answered after {latency:.1f} bits"
    if INPUTS:
        await tb.says(frames.read(FC.READ_DISCRETES, 0, INPUTS))
    if RELAYS:
        await tb.says(frames.write_coil(RELAYS - 1, True))
    if RECORDS:
        await tb.says(ASK)
    dut.host_cyc_i.value = 0
    await tb.says(frames.read(FC.READ_HOLDINGS, 0, 2))
    await tb.finish()


@cocotb.test()
async def a_value_of_two_registers_is_never_torn(dut):
    """An energy that the host writes under one cyc, whenever the master reads it."""
    tb = await Meter.start(dut, address=OWN)
    high = SETTINGS
    energy = 0
    running = True

    async def measure():
        nonlocal energy
        while running:
            energy += 0x1_0001
            await RisingEdge(dut.clk_i)
            dut.host_cyc_i.value = dut.host_stb_i.value = dut.host_we_i.value = 1
            for address, word in ((high, energy >> 16), (high + 1, energy & 0xFFFF)):
                dut.host_adr_i.value, dut.host_dat_i.value = address, word
                while True:
                    await RisingEdge(dut.clk_i)
                    if int(dut.host_ack_o.value):
                        break
            dut.host_cyc_i.value = dut.host_stb_i.value = dut.host_we_i.value = 0
            await Timer(tb.rng.randrange(1, 60) * CLOCK_PS, "ps")

    task = cocotb.start_soon(measure())
    seen = set()
    for _ in range(12):
        answer = await tb.query(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, high, 2)))
        first, second = frames.unpack_words(answer.data[3:-2])
        assert first == second, f"torn: {first:04X} {second:04X}"
        seen.add(first)
    assert len(seen) > 8, "the value hardly moved"
    running = False
    await task
    for word in range(2):
        await tb.host(Space.HOLDINGS, high + word, write=0)
    await tb.finish()


@cocotb.test()
async def random_requests_and_events(dut):
    tb = await Meter.start(dut, address=OWN)
    rng = tb.rng
    edges = (0, RECORD_REGISTER, SETTINGS, REGISTERS)
    for _ in range(volume("random requests to the power meter")):
        code = rng.choice(sorted(CODES))
        address = max(0, rng.choice(edges) + rng.randint(-2, 2))
        quantity = rng.choice((1, 1, 1, 2, 3, MOST_READ, MOST_READ + 1))
        if code in (FC.READ_COILS, FC.READ_DISCRETES):
            pdu = frames.read(code, rng.randrange(4), rng.randint(1, 5))
        elif code == FC.READ_HOLDINGS:
            pdu = frames.read(code, address, quantity)
        elif code == FC.WRITE_COIL:
            pdu = frames.write_coil(rng.randrange(RELAYS + 1), rng.getrandbits(1))
        elif code == FC.WRITE_REGISTER:
            pdu = frames.write_register(address, rng.getrandbits(16))
        else:
            quantity = rng.choice((1, 1, 2, 2, 3, MOST_WRITTEN, MOST_WRITTEN + 1))
            pdu = frames.write_registers(address, [rng.getrandbits(16) for _ in range(quantity)])
        if rng.random() < 0.4:
            await tb.event()
        if INPUTS and rng.random() < 0.3:
            await tb.preset((Space.DISCRETES, rng.randrange(INPUTS)), rng.getrandbits(1))
        tb.apply(busy=int(rng.random() < 0.1))
        await tb.says(pdu, address=0 if rng.random() < 0.1 else OWN)
        if rng.random() < 0.5:
            await tb.says(ASK)
    tb.apply(busy=0)
    await tb.finish()
