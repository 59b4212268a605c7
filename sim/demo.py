#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Play the printed examples of the Modbus documents against the live device, and draw one of them.

Each example of tb/vectors.json gets a device of its own, loaded with what the example presumes. pymodbus
asks, as any master would; the bytes it sends and receives are compared with the printed ones, and what a
write should have changed is read back. Exit status 0 only if everything was as expected.
"""

import contextlib
import json
import signal
import struct
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tb"))

import serial  # noqa: E402
from mbrtu import vectors  # noqa: E402
from mbrtu.defs import FC, Space  # noqa: E402
from mbrtu.frames import sealed, text, unpack_bits, unpack_words  # noqa: E402
from pymodbus.client import ModbusSerialClient  # noqa: E402
from pymodbus.exceptions import ModbusException  # noqa: E402
from waveform import draw  # noqa: E402
from words import answer, request, span, values  # noqa: E402

LINK = "build/demo.link"
TRACE = ROOT / "build" / "demo.trace"
PICTURE = ROOT / "build" / "demo.svg"
DRAWN = "S000-FIG14-15"
BAUD = 19200
TIMEOUT_S = 1.0
PAUSE_S = 0.05  # an answer is over after this
CHUNK = 32  # registers read back at once: fewer than any limit an example sets

KEYS = {  # names of tables in the examples and in INIT files
    "coils": "coils",
    "discrete_inputs": "discretes",
    "holding_registers": "holdings",
    "input_registers": "inputs",
}
PARAMETERS = {"max_read_regs": "MAX_READ_REGISTERS", "max_write_regs": "MAX_WRITE_REGISTERS"}


class Failure(Exception):
    """The device did not do its part; the text is for people."""


class NoDevice(Exception):
    """The device does not even start; no use going on."""


@contextlib.contextmanager
def device(vector, traced=False):
    """A live device with the slave address, limits and contents that an example presumes."""
    init = ROOT / "build" / "demo.json"
    contents = {}
    for entry in vector["preconditions"]:
        contents.setdefault(KEYS[entry["table"]], {})[str(entry["address"])] = entry["values"]
    init.write_text(json.dumps(contents))
    command = [sys.executable, str(ROOT / "sim" / "serve.py"), f"LINK={LINK}", f"INIT={init}", f"BAUD={BAUD}"]
    command += [f"ADDRESS={vector['slave_address']}", "DIE_WITH_PARENT=yes", f"PARAMETERS={parameters(vector)}"]
    if traced:
        command += [f"TRACE={TRACE}"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        if line != f"ready {LINK}\n":
            raise NoDevice(f"the device did not start (status {process.wait()})")
        yield
        process.terminate()
        if process.wait(timeout=2) or (ROOT / LINK).is_symlink():
            raise Failure(f"the device did not end well (status {process.returncode})")
    finally:
        if process.poll() is None:
            process.terminate()
            process.wait()


def parameters(vector):
    """Core parameters for the dialect that an example belongs to.

    Examples of one dialect share one build, so a dialect has all of its limits at once.
    """
    own = [v for v in EXAMPLES if v["profile"] == vector["profile"]] if vector["config"] else []
    return " ".join(sorted({f"{PARAMETERS[k]}={n}" for v in own for k, n in v["config"].items()}))


class Master:
    """pymodbus, with the bytes of the last transaction kept."""

    def __init__(self, slave):
        self.slave, self.sent, self.received, self.seconds = slave, None, None, 0.0
        # Parity none: the kernel has no parity on a pseudo-terminal, and pyserial insists if asked for it.
        self.client = ModbusSerialClient(
            str(ROOT / LINK), baudrate=BAUD, parity="N", timeout=TIMEOUT_S, retries=0, trace_packet=self._seen
        )

    def __enter__(self):
        if not self.client.connect():
            raise Failure(f"cannot open {LINK}")
        return self

    def __exit__(self, *_):
        self.client.close()

    def _seen(self, sending, data):
        if sending:
            self.sent = bytes(data)
        else:
            self.received = bytes(data)
        return data

    def ask(self, frame):
        """Send `frame`, through pymodbus' own request if it has one for it; return what came back."""
        self.sent, self.received = None, None
        begin = time.monotonic()
        call = self._call(frame[1:-2]) if sealed(frame[:-2]) == frame else None
        if call:
            with contextlib.suppress(ModbusException):  # silence; what it means is judged by the caller
                call()
        else:
            self._raw(frame)
        self.seconds = time.monotonic() - begin
        return self.received

    def _raw(self, frame):
        """A frame that no well-behaved master sends."""
        self.client.close()
        with serial.Serial(str(ROOT / LINK), BAUD, timeout=TIMEOUT_S / 2) as port:
            port.write(frame)
            got = port.read(1)
            port.timeout = PAUSE_S
            self.sent, self.received = frame, got + port.read(256) or None
        self.client.connect()

    def _call(self, pdu):
        """pymodbus' call for a request PDU."""
        client, to = self.client, {"device_id": self.slave}
        code, body = pdu[0], pdu[1:]
        reads = {
            FC.READ_COILS: client.read_coils,
            FC.READ_DISCRETES: client.read_discrete_inputs,
            FC.READ_HOLDINGS: client.read_holding_registers,
            FC.READ_INPUTS: client.read_input_registers,
        }
        if code in reads:
            first, count = struct.unpack(">HH", body)
            return lambda: reads[code](first, count=count, **to)
        if code == FC.WRITE_COIL:
            first, value = struct.unpack(">HH", body)
            return lambda: client.write_coil(first, bool(value), **to)
        if code == FC.WRITE_REGISTER:
            first, value = struct.unpack(">HH", body)
            return lambda: client.write_register(first, value, **to)
        if code == FC.WRITE_COILS:
            first, count = struct.unpack(">HH", body[:4])
            bits = [bool(b) for b in unpack_bits(body[5:], count)]
            return lambda: client.write_coils(first, bits, **to)
        if code == FC.WRITE_REGISTERS:
            (first,) = struct.unpack(">H", body[:2])
            return lambda: client.write_registers(first, unpack_words(body[5:]), **to)
        if code == FC.MASK_WRITE:
            first, ands, ors = struct.unpack(">HHH", body)
            return lambda: client.mask_write_register(address=first, and_mask=ands, or_mask=ors, **to)
        if code == FC.READ_WRITE:
            read, count, write = struct.unpack(">HHH", body[:6])
            words = unpack_words(body[9:])
            return lambda: client.readwrite_registers(
                read_address=read, read_count=count, write_address=write, values=words, **to
            )
        return None

    def read(self, space, first, count):
        """Values of a table as they are now."""
        call = {
            Space.COILS: self.client.read_coils,
            Space.DISCRETES: self.client.read_discrete_inputs,
            Space.INPUTS: self.client.read_input_registers,
            Space.HOLDINGS: self.client.read_holding_registers,
        }[space]
        found = []
        for start in range(first, first + count, CHUNK):
            part = min(CHUNK, first + count - start)
            try:
                got = call(start, count=part, device_id=self.slave)
            except ModbusException as error:
                raise Failure(f"reading back failed: {error}") from None
            if got.isError():
                raise Failure(f"reading back failed: {got}")
            found += [int(b) for b in got.bits[:part]] if space in (Space.COILS, Space.DISCRETES) else got.registers
        return found


def play(vector):
    """One example: ask, print, compare. True if all was as expected."""
    printed, expected = vectors.frame(vector["request"]), vectors.frame(vector["expected_response"])
    good = True

    def row(name, what, words=None, wrong=None):
        nonlocal good
        good &= not wrong
        say(f"    {name:<8} {what}")
        if words:
            say(f"    {'':<8}   {words}")
        if wrong:
            say(f"    {'':<8} NOT AS EXPECTED: {wrong}")

    with device(vector, traced=vector["id"] == DRAWN), Master(vector["slave_address"]) as master:
        got = master.ask(printed)
        sent = master.sent or b""
        row("request", text(sent), request(sent), sent != printed and f"printed is {text(printed)}")
        row("answer", text(got), got and answer(printed, got), got != expected and f"should be {text(expected)}")
        took = master.seconds
        for entry in vector["postconditions"]:
            space, first, wanted = vectors.SPACE_OF_TABLE[entry["table"]], entry["address"], entry["values"]
            found = master.read(space, first, len(wanted))
            wrong = found != wanted and f"should be {values(wanted)}"
            row("then", f"{span(space, first, len(wanted))} = {values(found)} (read back)", None, wrong)
    if good:
        say(f"    as expected{f', {took * 1000:.1f} ms' if got else ''}")
    return good


def say(line=""):
    """A line at once, also into a pipe."""
    print(line, flush=True)


def left_out():
    """What of the examples is not played, and why, as one sentence."""
    played = {v["id"] for v in EXAMPLES}
    reasons = Counter()
    codes = set()
    for vector in vectors.document()["vectors"]:
        if vector["id"] in played:
            continue
        code = vectors.frame(vector["request"])[1]
        if vector["mode"] != "rtu":
            reasons["ASCII mode"] += 1
        elif code not in list(FC):
            reasons["functions"] += 1
            codes.add(code)
        else:
            reasons["the PDM meter's event record, a dialect"] += 1
    named = " ".join(f"{c:02X}" for c in sorted(codes))
    texts = [f"{n} for {'functions not in this release (' + named + ')' if r == 'functions' else r}"
             for r, n in reasons.items()]  # fmt: skip
    return f"not played: {', '.join(texts)}" if texts else "none is left out"


EXAMPLES = vectors.playable()


def main():
    """Entry point; returns the exit status."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    say(f"{len(EXAMPLES)} printed examples, played by pymodbus at {BAUD} baud, 8E1, against the compiled RTL")
    passed, begin = 0, time.monotonic()
    for i, vector in enumerate(EXAMPLES, 1):
        say(f"\n[{i}/{len(EXAMPLES)}] {vector['id']}: {vector['description']}")
        say(f"    {vector['source']}")
        try:
            passed += play(vector)
            if vector["id"] == DRAWN:
                draw(TRACE, PICTURE, f"{vector['source'].split(';')[0]}: {vector['description'].lower()}")
        except Failure as failure:
            say(f"    NOT AS EXPECTED: {failure}")
        except NoDevice as failure:
            say(f"demo: {failure}")
            return 1
    say()
    say(f"picture of {DRAWN}: {PICTURE.relative_to(ROOT)}")
    say(left_out())
    say(f"demo: {passed} of {len(EXAMPLES)} examples as expected, in {time.monotonic() - begin:.0f} s")
    return 0 if passed == len(EXAMPLES) else 1


if __name__ == "__main__":
    sys.exit(main())
