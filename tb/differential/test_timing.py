# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Times in clock cycles on the compiled slave, where whole frames at real rates cost nothing.

A 50 MHz clock at 115200 baud unless a test says otherwise; t1.5 and t3.5 with their floors.
"""

from dataclasses import dataclass

import pytest
from harness.build import DEFAULT_CLK_HZ, NO_FLOORS, REFERENCE, model_config, silences
from harness.volume import IS_FULL
from protocol import frames
from protocol.defs import DEFAULT_OBJECTS, F8E1, FC, FORMATS, T35_CHARACTERS, Sub
from protocol.model import Slave

from differential.device import Device, library

OWN = 17
BAUD = 115200
BIT_TIME = round(DEFAULT_CLK_HZ / BAUD)
BUILDS = {"full": REFERENCE, "basic": {**REFERENCE, "FUNCTION_CODES": 0x1807E}}
SHARE = 0.02  # of t3.5: how late an answer may start, beyond what is allowed for lists
CLOCKS_A_BIT = 2  # one beat, one wait state of the RAM bank
# A group of file records is checked, asked for, and read or written in passes of their own; a register of 15 too.
CLOCKS_A_GROUP, CLOCKS_A_RECORD = 160, 8
WORDS = [(0x1357 * i) & 0xFFFF for i in range(125)]
QUEUE = 1000  # the register with the count of a queue
LOG_FULL = [b"\x55"] * 80  # bad frames, each leaves an event


def groups(count, registers):
    """Groups of file records with one register each, the last with the rest of so many."""
    return [(1, i, 1) for i in range(count - 1)] + [(1, count, registers - count + 1)]


def with_data(plan):
    """Groups to write."""
    return [(file, first, WORDS[:quantity]) for file, first, quantity in plan]


@dataclass(frozen=True)
class Request:
    """A request and how late its answer may start: within a bit of t3.5, or SHARE of it and so many `clocks` more."""

    pdu: bytes
    clocks: int | None = None
    before: tuple = ()  # lines that make it so


REQUESTS = {
    "FC 03, 1 register": Request(frames.read(FC.READ_HOLDINGS, 0, 1)),
    "FC 03, 125 registers": Request(frames.read(FC.READ_HOLDINGS, 0, 125)),
    "FC 04, 125 registers": Request(frames.read(FC.READ_INPUTS, 0, 125)),
    "FC 06": Request(frames.write_register(0, 0x1234)),
    "FC 10, 123 registers": Request(frames.write_registers(0, WORDS[:123])),
    "FC 16": Request(frames.mask_write(0, 0x00FF, 0xAA55)),
    "FC 17, 1 + 1 registers": Request(frames.read_write(0, 1, 1, [1])),
    "FC 17, 100 registers": Request(frames.read_write(0, 50, 0, WORDS[:50])),
    "FC 17, 125 + 121 registers": Request(frames.read_write(0, 125, 0, WORDS[:121]), 0),
    "FC 01, 1 coil": Request(frames.read(FC.READ_COILS, 0, 1)),
    "FC 01, 1024 coils": Request(frames.read(FC.READ_COILS, 0, 1024), 1024 * CLOCKS_A_BIT),
    "FC 02, 2000 discrete inputs": Request(frames.read(FC.READ_DISCRETES, 0, 2000), 2000 * CLOCKS_A_BIT),
    "FC 05": Request(frames.write_coil(0, True)),
    "FC 0F, 1024 coils": Request(frames.write_coils(0, [i % 3 & 1 for i in range(1024)]), 1024 * CLOCKS_A_BIT),
    "FC 07": Request(frames.bare(FC.READ_EXCEPTION_STATUS)),
    "FC 08, 1 word": Request(frames.diagnostics(Sub.QUERY_DATA, 0xA537)),
    "FC 08, 125 words": Request(frames.diagnostics(Sub.QUERY_DATA, *WORDS)),
    "FC 08, restart": Request(frames.restart()),
    "FC 08, register": Request(frames.diagnostics(Sub.DIAGNOSTIC_REGISTER)),
    "FC 08, delimiter": Request(frames.diagnostics(Sub.DELIMITER, 0x2C00)),
    "FC 08, clear": Request(frames.diagnostics(Sub.CLEAR)),
    "FC 08, counter": Request(frames.diagnostics(Sub.SLAVE_MESSAGE)),
    "FC 08, clear overrun": Request(frames.diagnostics(Sub.CLEAR_OVERRUN)),
    "FC 0B": Request(frames.bare(FC.GET_EVENT_COUNTER)),
    "FC 0C, 1 event": Request(frames.bare(FC.GET_EVENT_LOG)),
    "FC 0C, 64 events": Request(frames.bare(FC.GET_EVENT_LOG), before=tuple(LOG_FULL)),
    "FC 11": Request(frames.bare(FC.REPORT_SERVER_ID)),
    "FC 14, 1 group, 64 registers": Request(frames.read_files((1, 0, 64))),
    "FC 14, 1 group, 121 registers": Request(frames.read_files((1, 0, 121)), 0),
    "FC 14, 35 groups, 87 registers": Request(frames.read_files(*groups(35, 87)), 35 * CLOCKS_A_GROUP),
    "FC 15, 1 group, 16 registers": Request(frames.write_files((1, 0, WORDS[:16]))),
    "FC 15, 1 group, 122 registers": Request(frames.write_files((1, 0, WORDS[:122])), 0),
    "FC 15, 27 groups, 31 registers": Request(
        frames.write_files(*with_data(groups(27, 31))), 27 * CLOCKS_A_GROUP + 31 * CLOCKS_A_RECORD
    ),
    "FC 18, empty": Request(frames.read_fifo(QUEUE)),
    "FC 18, 31 entries": Request(frames.read_fifo(QUEUE), before=(frames.adu(OWN, frames.write_register(QUEUE, 31)),)),
    "FC 2B, all objects": Request(frames.device_identification(1)),
    "FC 2B, no such object": Request(frames.device_identification(1, max(DEFAULT_OBJECTS) + 1), 0),
    "FC 2B, one object": Request(frames.device_identification(4, 0)),
    "exception 01": Request(b"\x41"),
    "exception 02": Request(frames.read(FC.READ_HOLDINGS, 0xFFFF, 2)),
    "exception 03": Request(frames.read(FC.READ_HOLDINGS, 0, 126)),
}
BASIC = [name for name in REQUESTS if name[3:5] in "01 02 03 04 05 06 0F 10".split() or name.startswith("exc")]
SHOWN = ("FC 02, 2000 discrete inputs", "FC 03, 125 registers", "FC 14, 35 groups, 87 registers")
# The rest with FULL=1; the tables of docs/timing.md, measured anew, show that both builds take the same clocks.
SLOW = ("FC 0C, 64 events",)
CASES = [("full", name) for name in REQUESTS if IS_FULL or name not in SLOW]
CASES += [("basic", name) for name in BASIC if IS_FULL or name in SHOWN]


class Bench:
    """A compiled slave and its model."""

    def __init__(self, parameters, fmt=F8E1, bit_time=BIT_TIME, **inputs):
        self.slave = Slave(model_config("modbus_rtu_slave", parameters))
        self.device = Device(library(parameters))
        self.device.setup(fmt, bit_time, address=OWN, broadcast_en=1, run_indicator=1, **inputs)
        _, self.t35 = silences(parameters, fmt, bit_time)
        self.device.reset()
        self.device.idle(self.t35 + 4 * bit_time)

    def ask(self, pdu, patience=20_000, **how):
        """The outcome of one request; the answer is the model's."""
        frame = frames.adu(OWN, pdu)
        expected = self.slave.request(frame)
        seen = self.device.transfer(frame, self.t35 + patience, **how)
        assert seen.answer == expected, f"expected {frames.text(expected)}, seen {frames.text(seen.answer)}"
        return seen

    def play(self, line):
        """A line, answered or not."""
        assert self.device.transfer(line, self.t35 + 20_000).answer == self.slave.request(line)


@pytest.mark.parametrize("build,name", CASES, ids=[f"{build}-{name}" for build, name in CASES])
def test_answer_starts_at_once(build, name, record_property):
    """Never before t3.5; at most a bit later for registers, and 2 % beyond what long lists take for the rest."""
    request = REQUESTS[name]
    bench = Bench(BUILDS[build])
    for line in request.before:
        bench.play(line)
    after = bench.ask(request.pdu).latency - bench.t35
    figure = f"{name}: {after:.0f} clocks after t3.5 = {after / BIT_TIME:.2f} bits = {100 * after / bench.t35:.2f} %"
    if name in SHOWN:
        record_property("figures", [f"{build} build, answer to {figure}"])
    assert after >= 0, figure
    most = BIT_TIME if request.clocks is None else SHARE * bench.t35 + request.clocks
    assert after <= most, f"{figure}; at most {most:.0f}"


@pytest.mark.parametrize("baud", [9600, 19200, 57600, 115200, 1_000_000])
@pytest.mark.parametrize("fmt", FORMATS, ids=lambda f: f.name)
def test_silence_before_the_answer_at_real_rates(fmt, baud):
    """t3.5 of the real character up to 19200 baud, 1750 us above."""
    bit_time = round(DEFAULT_CLK_HZ / baud)
    bench = Bench(REFERENCE, fmt, bit_time)
    wanted = T35_CHARACTERS * fmt.length * bit_time if baud <= 19200 else 87_500
    after = bench.ask(frames.read(FC.READ_HOLDINGS, 0, 2)).latency - wanted
    assert 0 <= after <= max(bit_time, 250), f"{after:.0f} clocks after t3.5"


def test_driver_enable_in_clocks(record_property):
    bench = Bench(REFERENCE)
    seen = bench.ask(frames.write_register(0, 1))
    record_property("figures", [f"driver enable: leads by {seen.lead} clocks, stays {seen.tail} clocks"])
    assert 0 <= seen.lead <= BIT_TIME and 0 <= seen.tail <= BIT_TIME


@pytest.mark.parametrize("lead,tail", [(1, 0), (0, 1), (3, 2), (11, 11), (15, 15)])
def test_lead_and_tail_are_bit_times(lead, tail):
    seen = Bench(REFERENCE, de_lead=lead, de_tail=tail).ask(frames.write_register(0, 1))
    assert lead <= seen.lead / BIT_TIME <= lead + 1, f"{seen.lead} clocks"
    assert tail <= seen.tail / BIT_TIME <= tail + 1, f"{seen.tail} clocks"


def test_read_of_125_registers_takes_what_the_line_takes(record_property):
    """Request 8 + answer 255 characters + 2 x t3.5, within 1 %."""
    bench = Bench(REFERENCE)
    seen = bench.ask(REQUESTS["FC 03, 125 registers"].pdu)
    characters = (8 + len(seen.answer)) * F8E1.length * BIT_TIME
    taken = characters - (len(seen.answer) * F8E1.length * BIT_TIME) + seen.latency
    taken += len(seen.answer) * F8E1.length * BIT_TIME + bench.t35
    line = characters + 2 * bench.t35
    ms = 1000 / DEFAULT_CLK_HZ
    record_property("figures", [f"read of 125 registers: {taken * ms:.3f} ms, the line needs {line * ms:.3f} ms"])
    assert taken <= 1.01 * line


def test_highest_rate():
    """8 clocks a bit without floors: 6.25 Mbaud at 50 MHz."""
    bench = Bench({**REFERENCE, **NO_FLOORS}, bit_time=8)
    for name, request in REQUESTS.items():
        for line in request.before:
            bench.play(line)
        bench.ask(request.pdu)
        if "restart" in name:
            bench.device.idle(bench.t35 + 8 * 8)  # the line must be silent again


def test_widest_bit_time():
    """65535 clocks a bit: one character is timed, nothing overflows."""
    bench = Bench({**REFERENCE, **NO_FLOORS}, bit_time=65535)
    assert bench.t35 == T35_CHARACTERS * 11 * 65535
    seen = bench.device.transfer(b"\xa5", bench.t35 + 65535)
    assert seen.answer is None and not seen.good
    assert [error for error, count in seen.errors.items() if count] == ["short"]


@pytest.mark.parametrize("delay", [0, 1, 100, 4095])
def test_response_delay_counts_bit_times(delay):
    bench = Bench({**REFERENCE, **NO_FLOORS}, bit_time=8, response_delay=delay)
    plain = Bench({**REFERENCE, **NO_FLOORS}, bit_time=8).ask(frames.write_register(0, 1)).latency
    seen = bench.ask(frames.write_register(0, 1), patience=8 * delay + 2000)
    assert bench.t35 + 8 * delay <= seen.latency <= plain + 8 * (delay + 1), f"{seen.latency} clocks"


@pytest.mark.parametrize(
    "bit_time,offset", [(8, -0.02), (8, 0.02), (16, -0.04), (16, 0.04), (33, -0.04), (100, 0.04), (434, -0.04)]
)
def test_baud_mismatch_over_long_frames(bit_time, offset):
    """Frames of 255 bytes, beginning at every phase of the bit; 8E1."""
    bench = Bench({**REFERENCE, **NO_FLOORS}, bit_time=bit_time)
    for number in range(12 if bit_time < 100 else 2):
        words = [(WORDS[i] * (number + 1)) & 0xFFFF if i % 5 else 0xFFFF * (i & 1) for i in range(123)]
        bench.ask(frames.write_registers(0, words), offset=offset)
        bench.device.idle(number * 7 % bit_time + 1)
