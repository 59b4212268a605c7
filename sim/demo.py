#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Play the printed examples of the Modbus documents against the live device, and draw one of them.

Each example of tb/protocol/vectors.json gets a device of its own, loaded with what the example presumes; counts that it
presumes are brought about by real traffic. pymodbus asks, as any master would; the bytes it sends and receives are
compared with the printed ones, and what the request should have changed, counted and logged is read back. A story
of what goes wrong on a line ends it. Exit status 0 only if everything was as expected.
"""

import signal
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tb"))

from master import TRACE, Failure, Master, NoDevice, device  # noqa: E402
from protocol import vectors  # noqa: E402
from protocol import words_special as special  # noqa: E402
from protocol.defs import DIAGNOSTIC_FUNCTIONS, EX, FC, OVERRUN_FLAG, Space  # noqa: E402
from protocol.frames import adu, bad_crc, bare, read, sealed, text, write_coil  # noqa: E402
from protocol.memory import Config  # noqa: E402
from protocol.model import Slave  # noqa: E402
from protocol.pdm import Event, EventRecords  # noqa: E402
from protocol.words import answer, request, span, values  # noqa: E402
from story import tell  # noqa: E402
from waveform import draw  # noqa: E402

PICTURE = ROOT / "build" / "demo.svg"
DRAWN = "S000-FIG14-15"
BAUD, FAST_BAUD = 19200, 115200  # the fast one for examples with much traffic before them
FOREIGN, UNSUPPORTED = 18, 0x09

KEYS = {  # names of tables in the examples and in INIT files
    "coils": "coils",
    "discrete_inputs": "discretes",
    "holding_registers": "holdings",
    "input_registers": "inputs",
}
LIMITS = {"read_registers": "MAX_READ_REGISTERS", "write_registers": "MAX_WRITE_REGISTERS"}
# Source 003's examples are played on its meter (DEVICE=pdm), but for the one that is about a standard slave.
METER_PREFIX, NOT_METER = "S003-", {"S003-3.7-STD"}
METER = Config(
    tables={Space.COILS: (0, 2), Space.DISCRETES: (0, 4), Space.INPUTS: (0, 0), Space.HOLDINGS: (0, 512)},
    functions=frozenset({1, 2, 3, 5, 6, 16}),
    limits=vectors.Limits(read_registers=50, write_registers=60),
    read_only=(256, 256),
    files=(0, 1),
    user_codes=frozenset({3}),
)


def say(line=""):
    """A line at once, also into a pipe."""
    print(line, flush=True)


# ---------------------------------------------------------------------- what an example presumes


def is_meter(vector):
    """True for examples of source 003, played on its meter."""
    return vector["id"].startswith(METER_PREFIX) and vector["id"] not in NOT_METER


def in_ascii(vector):
    """True for examples of ASCII mode."""
    return vector["mode"] == "ascii"


def builds(examples):
    """{id: {field of Config: value}}: what the device of each example is built with; as few builds as do."""
    found, out = [], {}
    for vector in examples:
        items = {} if is_meter(vector) else vectors.build_items(vector)
        home = {}
        if items:
            home = next((b for b in found if all(b.get(k, v) == v for k, v in items.items())), None)
            if home is None:
                found.append(home := {})
            home.update(items)
        out[vector["id"]] = home
    return out


def contents(vector, built):
    """INIT for an example."""
    out, presumed = {}, vectors.state(vector["preconditions"])
    for entry in vector["preconditions"]:
        table, run = entry["table"], entry["values"]
        if table in KEYS and not (is_meter(vector) and table == "coils"):
            out.setdefault(KEYS[table], {})[str(entry["address"])] = run
        elif table == "file":
            out.setdefault("files", {}).setdefault(str(entry["file"]), {})[str(entry["address"])] = run
        elif table == "pdm_event_record":
            _, event = Event.of_record(bytes(run))
            out["events"] = [vars(event) | {"closed": int(event.closed), "year": 2000 + event.year}]
    out |= {name: int(presumed[name]) for name in vectors.INPUTS if name in presumed}
    if presumed.get("diagnostic_register", 0) & ~OVERRUN_FLAG:
        out["diagnostic"] = presumed["diagnostic_register"] & ~OVERRUN_FLAG
    counted = presumed.get("counters", {})
    out |= {"failure": int(EX.NAK)} if counted.get("slave_nak") else {}
    out |= {"busy": 1} if counted.get("slave_busy") else {}
    for name in ("server_id", "additional_data"):
        out |= {name: list(built[name])} if name in built else {}
    if "objects" in built:
        out["device_id"] = {str(i): value.decode() for i, value in built["objects"].items()}
    out |= {"conformity": built["conformity"]} if "conformity" in built else {}
    return out


def parameters(built):
    """Limits that a device is built with, for PARAMETERS."""
    limits = vars(built["limits"]) if "limits" in built else {}
    out = [f"{name}={limits[field]}" for field, name in LIMITS.items() if field in limits]
    if "device_id_limit" in built:
        out.append(f"DEVICE_ID_LIMIT={built['device_id_limit']}")
    return " ".join(out)


def traffic(vector):
    """[(times, frame), ...] that brings about the counts and the state an example presumes."""
    own, presumed = vector["slave_address"], vectors.state(vector["preconditions"])
    counted = presumed.get("counters", {})
    overruns = counted.get("bus_char_overrun", presumed.get("diagnostic_register", 0) & OVERRUN_FLAG)
    event, asked = adu(own, bare(FC.READ_EXCEPTION_STATUS)), adu(own, read(FC.READ_HOLDINGS, 0, 1))
    wanted = [
        (overruns, bytes([own]) * 257),
        (counted.get("bus_comm_error", 0) - (overruns if "bus_comm_error" in counted else 0), bad_crc(asked)),
        (counted.get("bus_exception", 0), adu(own, bare(UNSUPPORTED))),
        (counted.get("slave_no_response", 0), adu(0, write_coil(0, False))),
        (counted.get("slave_nak", 0) + counted.get("slave_busy", 0), asked),
        (counted.get("event_counter", 0), event),
        (counted.get("bus_message", 0) - counted.get("event_counter", 0), adu(FOREIGN, bare(FC.READ_EXCEPTION_STATUS))),
    ]
    if is_meter(vector):
        for entry in vector["preconditions"]:
            if entry["table"] == "coils":
                relays = enumerate(entry["values"], entry["address"])
                wanted += [(1, adu(own, write_coil(address, True))) for address, on in relays if on]
    return [(times, frame) for times, frame in wanted if times > 0]


def reference(vector, built, meter):
    """The reference slave, with what INIT loads."""
    config = METER if meter else Config(**built)
    config = Config(**{**vars(config), "address": vector["slave_address"]})
    slave = Slave(config)
    for key, value in vectors.contents(vector["preconditions"], config.files[1]):
        if not (meter and key[0] == Space.COILS):
            slave.memory[key] = value
    init = contents(vector, built)
    for name in ("exception_status", "busy", "run_indicator", "failure"):
        if name in init:
            setattr(slave, name, init[name])
    slave.diagnostic_register = init.get("diagnostic", 0)
    if meter:
        records = EventRecords()
        for entry in vector["preconditions"]:
            if entry["table"] == "pdm_event_record":
                records.add(Event.of_record(bytes(entry["values"]))[1])
        slave.user = records.answer
    return slave


# ---------------------------------------------------------------------- one example


def characters(line):
    """Characters of ASCII mode for people, `None` as silence."""
    return "silence" if line is None else line.decode("latin-1").replace("\r", " CR").replace("\n", " LF")


class Play:
    """One example on a running device: ask, print, compare. `good` tells whether all was as expected."""

    def __init__(self, vector, master):
        self.vector, self.master, self.good = vector, master, True

    def row(self, name, what, words=None, wrong=None):
        """A line, what it means, and what is wrong with it."""
        self.good &= not wrong
        say(f"    {name:<8} {what}")
        if words:
            say(f"    {'':<8}   {words}")
        if wrong:
            say(f"    {'':<8} NOT AS EXPECTED: {wrong}")

    def run(self, last):
        """True if all was as expected. Counters and log are read after the last step of a sequence only."""
        vector, master = self.vector, self.master
        before = traffic(vector)
        for times, frame in before:
            for _ in range(times):
                master.must(frame)
            shown = text(frame) if len(frame) < 20 else f"{text(frame[:4])} ... ({len(frame)} bytes)"
            self.row("first", f"{times} x {shown}", f"{request(frame)}: {answer(frame, master.received)}")
        binary = printed, expected = vectors.frame(vector["request"]), vectors.frame(vector["expected_response"])
        shown = text
        if in_ascii(vector):  # the characters, and the words about what they carry
            printed, expected = (vector[f"{name}_chars"].encode() for name in ("request", "expected_response"))
            shown, binary = characters, [sealed(data[:-1]) for data in binary]  # the words are about RTU frames
        repeats_log = "event_log" in vectors.state(vector["preconditions"])
        got = master.ask(printed)
        sent, took = master.sent or b"", master.seconds
        words = request(binary[0] if in_ascii(vector) else sent)
        self.row("request", shown(sent), words, sent != printed and f"printed is {shown(printed)}")
        if repeats_log:
            same = got is not None and got[3:9] == expected[3:9] and got == master.expected
            self.row("answer", text(got), got and answer(printed, got), not same and f"printed is {text(expected)}")
            self.row("but", "status and counts are the printed ones, the log is the real one", OTHER_LOG)
        else:
            wrong = got != expected and f"should be {shown(expected)}"
            self.row("answer", shown(got), got and answer(*binary if in_ascii(vector) else (printed, got)), wrong)
        if not before and master.model.config.has_diagnostics:
            for difference in vectors.differences(master.model, vector):
                self.row("after", "the reference slave differs", None, difference)
        self.changed()
        if last and master.model.config.has_diagnostics:
            self.counted()
        if self.good:
            say(f"    as expected{f', {took * 1000:.1f} ms' if got else ''}")
        return self.good

    def changed(self):
        """Read back what the request changed."""
        master = self.master
        for entry in self.vector["postconditions"]:
            table, wanted = entry["table"], entry["values"]
            if table in vectors.SPACE_OF_TABLE:
                space, first, file = vectors.SPACE_OF_TABLE[table], entry["address"], entry.get("file")
                found = master.read(space, first, len(wanted), file)
                where = span(space, first, len(wanted)) if file is None else f"file {file} from record {first} on"
                wrong = found != wanted and f"should be {values(wanted)}"
                self.row("then", f"{where} = {values(found)} (read back)", None, wrong)
            elif table == "diagnostic_register":
                found = master.register()
                wrong = found != wanted[0] and f"should be {wanted[0]:04X}"
                self.row("then", f"diagnostic register {special.register(found)} (read back)", None, wrong)
            elif table == "listen_only":
                got = master.ask(master.frame(read(FC.READ_HOLDINGS, 0, 1)))
                self.row("then", "a read gets no answer: listen-only", None, got and text(got))
                master.must(master.frame(bytes.fromhex("0800010000")))
                self.row("then", "a restart ends that, without an answer")
            else:
                self.row("then", f"{table.replace('_', ' ')} {wanted[0]:02X} is kept; RTU mode has no way to show it")

    def counted(self):
        """Read counters and log; the reference slave has counted along."""
        log, events, total = self.master.log()
        self.row("log", special.story(log), f"events {events}, bus messages {total} with this question")
        if vectors.frame(self.vector["request"])[1] in DIAGNOSTIC_FUNCTIONS:
            self.row("counts", special.counts(self.master.counters()))


OTHER_LOG = "(00 20 as printed cannot be: 20 is no event, and 264 events leave more than two entries)"


def play(steps, heads, built, traced):
    """The steps of a sequence on one device, `heads` above them; how many of them were as expected."""
    first, meter = steps[0], is_meter(steps[0])
    baud = FAST_BAUD if traffic(first) and not meter else BAUD
    variables = {"DEVICE": "pdm"} if meter else {"PARAMETERS": parameters(built)}
    variables |= {"MODE": "ascii"} if in_ascii(first) else {}
    passed = 0
    with (
        device(first["slave_address"], contents(first, built), baud, traced, **variables),
        Master(reference(first, built, meter), baud, in_ascii(first)) as master,
    ):
        for head, vector in zip(heads, steps):
            say(f"{head}{vector['id']}: {vector['description']}")
            say(f"    {vector['source']}")
            passed += Play(vector, master).run(vector is steps[-1])
    return passed


def left_out():
    """What of the examples is not played, and why."""
    for vector, reason in vectors.unplayable():
        yield f"not played: {vector['id']}: {reason.split('. Use ')[0]}"


def main():
    """Entry point; returns the exit status."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    played = {v["id"] for v in vectors.playable() + vectors.pdm() + vectors.in_ascii()}
    examples = [v for v in vectors.document()["vectors"] if v["id"] in played]
    built = builds(examples)
    say(f"{len(examples)} printed examples, played by pymodbus against the compiled RTL: {BAUD} baud, 8E1,")
    say(f"{FAST_BAUD} baud where many frames come before, 7E1 in ASCII mode")
    passed, begin, number = 0, time.monotonic(), 0
    for sequence in vectors.sequences():
        steps = [v for v in sequence if v["id"] in played]
        if not steps:
            continue
        try:
            heads = [f"\n[{number + i}/{len(examples)}] " for i in range(1, len(steps) + 1)]
            number += len(steps)
            passed += play(steps, heads, built[steps[0]["id"]], steps[0]["id"] == DRAWN)
            if steps[0]["id"] == DRAWN:
                draw(TRACE, PICTURE, f"{steps[0]['source'].split(';')[0]}: {steps[0]['description'].lower()}")
        except Failure as failure:
            say(f"    NOT AS EXPECTED: {failure}")
        except NoDevice as failure:
            say(f"demo: {failure}")
            return 1
    say()
    good = tell(say)
    say()
    say(f"picture of {DRAWN}: {PICTURE.relative_to(ROOT)}")
    for line in left_out():
        say(line)
    seconds = time.monotonic() - begin
    story = "the story too" if good else "the story NOT"
    say(f"demo: {passed} of {len(examples)} examples as expected, {story}, in {seconds:.0f} s")
    return 0 if passed == len(examples) and good else 1


if __name__ == "__main__":
    sys.exit(main())
