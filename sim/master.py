# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the demo plays with: live devices, and a master that speaks through pymodbus.

A reference slave (tb/protocol/model.py) hears every frame as well, so that what the device should say is known
for any traffic, its counters and log included.
"""

import contextlib
import json
import struct
import subprocess
import sys
import time
from pathlib import Path

from protocol.defs import (
    ALL_COUNTERS,
    COUNTERS,
    FC,
    FLOOR_BAUD,
    GROUP_HEAD,
    LONGEST_FRAME,
    MEI_DEVICE_ID,
    RESTART_CLEAR,
    T35_FLOOR_US,
    Space,
    Sub,
)
from protocol.frames import adu, ascii_adu, sealed, text, unpack_bits, unpack_words
from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu.file_message import FileRecord, ReadFifoQueueResponse

ROOT = Path(__file__).resolve().parents[1]
LINK = "build/demo.link"
TRACE = ROOT / "build" / "demo.trace"
TIMEOUT_S = 1.0
PAUSE_S = 0.05  # an answer is over after this
CHUNK = 32  # registers read back at once: fewer than any limit an example sets
CHARACTER_BITS = 11

# pymodbus 3.16.1 counts this answer two bytes short on a serial line and never accepts it.
ReadFifoQueueResponse.calculateRtuFrameSize = classmethod(
    lambda cls, data: 6 + struct.unpack(">H", data[2:4])[0] if len(data) >= 4 else 0
)


class Failure(Exception):
    """The device did not do its part; the text is for people."""


class NoDevice(Exception):
    """The device does not even start; no use going on."""


@contextlib.contextmanager
def device(address, contents, baud, traced=False, **variables):
    """A live device, loaded with `contents` (an INIT document)."""
    init = ROOT / "build" / "demo.json"
    init.write_text(json.dumps(contents))
    command = [sys.executable, str(ROOT / "sim" / "serve.py"), f"LINK={LINK}", f"INIT={init}", f"BAUD={baud}"]
    command += [f"ADDRESS={address}", "DIE_WITH_PARENT=yes", *(f"{k}={v}" for k, v in variables.items())]
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


class Master:
    """pymodbus, with the bytes of the last transaction and what the reference slave says to it kept.

    In ASCII mode frames are the characters on the line.
    """

    def __init__(self, model, baud, ascii_mode=False):
        self.model, self.to, self.baud = model, {"device_id": model.config.address}, baud
        self.ascii = ascii_mode
        self.sent, self.received, self.expected, self.seconds = None, None, None, 0.0
        # Parity none: the kernel has no parity on a pseudo-terminal, and pyserial insists if asked for it.
        self.client = ModbusSerialClient(
            str(ROOT / LINK),
            framer=FramerType.ASCII if ascii_mode else FramerType.RTU,
            baudrate=baud,
            parity="N",
            timeout=TIMEOUT_S,
            retries=0,
            trace_packet=self._seen,
        )

    def __enter__(self):
        if not self.client.connect():
            raise Failure(f"cannot open {LINK}")
        return self

    def __exit__(self, *_):
        self.client.close()

    def _seen(self, sending, data):
        if sending:
            self._note(data)
        else:
            self.received = bytes(data)
        return data

    def _note(self, frame):
        self.sent, self.received = bytes(frame), None
        self.expected = (self.model.hear if self.ascii else self.model.request)(self.sent)

    # ------------------------------------------------------------------ one frame

    def ask(self, frame):
        """Send `frame`, through pymodbus' own request if it has one for it; return what came back."""
        begin = time.monotonic()
        body = self._body(frame)
        call = self._call(body[1:]) if body and body[0] == self.to["device_id"] else None
        if self.model.listen_only:  # pymodbus would wait its whole time for the answer
            call = None
        if call:
            with contextlib.suppress(ModbusException):  # silence; what it means is judged by the caller
                call()
        if not call or self.expected is None:
            self._raw(None if call else frame)
        self.seconds = time.monotonic() - begin
        return self.received

    def _body(self, frame):
        """Address and PDU of a frame with a right check field, else None."""
        if self.ascii:
            body = bytes.fromhex(frame[1:-4].decode())
            return body if ascii_adu(body[0], body[1:]) == frame else None
        return frame[:-2] if sealed(frame[:-2]) == frame else None

    def must(self, frame):
        """Send `frame`, which must be answered as the reference slave says."""
        self._raw(frame)
        if self.received != self.expected:
            raise Failure(f"{text(frame[:20])} got {text(self.received)}, not {text(self.expected)}")

    def _raw(self, frame):
        """A frame without pymodbus; None: only listen, what it has sent gets no answer."""
        port = self.client.socket
        if frame is not None:
            port.reset_input_buffer()
            self._note(frame)
            port.write(frame)
        wanted = len(self.expected or b"")
        port.timeout = self._line_s(wanted) + TIMEOUT_S if wanted else self._line_s(0) + PAUSE_S
        got = port.read(wanted or 1)
        if got and (not wanted or got != self.expected):
            port.timeout = PAUSE_S
            got += port.read(LONGEST_FRAME)
        port.timeout = TIMEOUT_S
        self.received = got or None

    def _line_s(self, answer):
        """What the frame, the silences around it and an answer of so many bytes take on the line."""
        character = CHARACTER_BITS / self.baud
        silence = 3.5 * character if self.baud <= FLOOR_BAUD else T35_FLOOR_US * 1e-6
        return (len(self.sent) + answer) * character + 2 * silence

    def _call(self, pdu):
        """pymodbus' call for a request PDU, None if it has none."""
        client, to = self.client, self.to
        code, body = pdu[0], pdu[1:]
        reads = {
            FC.READ_COILS: client.read_coils,
            FC.READ_DISCRETES: client.read_discrete_inputs,
            FC.READ_HOLDINGS: client.read_holding_registers,
            FC.READ_INPUTS: client.read_input_registers,
        }
        bare = {
            FC.READ_EXCEPTION_STATUS: client.read_exception_status,
            FC.GET_EVENT_COUNTER: client.diag_get_comm_event_counter,
            FC.GET_EVENT_LOG: client.diag_get_comm_event_log,
            FC.REPORT_SERVER_ID: client.report_device_id,
        }
        if code in reads:
            first, count = struct.unpack(">HH", body)
            return lambda: reads[code](first, count=count, **to)
        if code in bare and not body:
            return lambda: bare[code](**to)
        if code == FC.DIAGNOSTICS:
            return self._diagnostic_call(*struct.unpack(">HH", body))
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
        if code in (FC.READ_FILE, FC.WRITE_FILE):
            call = client.read_file_record if code == FC.READ_FILE else client.write_file_record
            return lambda: call(file_records(pdu), **to)
        if code == FC.MASK_WRITE:
            first, ands, ors = struct.unpack(">HHH", body)
            return lambda: client.mask_write_register(address=first, and_mask=ands, or_mask=ors, **to)
        if code == FC.READ_WRITE:
            read, count, write = struct.unpack(">HHH", body[:6])
            words = unpack_words(body[9:])
            return lambda: client.readwrite_registers(
                read_address=read, read_count=count, write_address=write, values=words, **to
            )
        if code == FC.READ_FIFO:
            return lambda: client.read_fifo_queue(address=struct.unpack(">H", body)[0], **to)
        if code == FC.READ_DEVICE_ID and body[0] == MEI_DEVICE_ID:
            return lambda: client.read_device_information(read_code=body[1], object_id=body[2], **to)
        return None

    def _diagnostic_call(self, sub, data):
        client, to = self.client, self.to
        with_data = {
            Sub.QUERY_DATA: lambda: client.diag_query_data(struct.pack(">H", data), **to),
            Sub.RESTART: lambda: client.diag_restart_communication(data == RESTART_CLEAR, **to),
            Sub.DELIMITER: lambda: client.diag_change_ascii_input_delimeter(delimiter=data, **to),
            0x15: lambda: client.diag_getclear_modbus_response(data=data, **to),
        }
        without = {
            Sub.DIAGNOSTIC_REGISTER: client.diag_read_diagnostic_register,
            Sub.LISTEN_ONLY: client.diag_force_listen_only,
            Sub.CLEAR: client.diag_clear_counters,
            Sub.BUS_MESSAGE: client.diag_read_bus_message_count,
            Sub.BUS_COMM_ERROR: client.diag_read_bus_comm_error_count,
            Sub.BUS_EXCEPTION: client.diag_read_bus_exception_error_count,
            Sub.SLAVE_MESSAGE: client.diag_read_device_message_count,
            Sub.SLAVE_NO_RESPONSE: client.diag_read_device_no_response_count,
            Sub.SLAVE_NAK: client.diag_read_device_nak_count,
            Sub.SLAVE_BUSY: client.diag_read_device_busy_count,
            Sub.BUS_CHAR_OVERRUN: client.diag_read_bus_char_overrun_count,
            Sub.CLEAR_OVERRUN: client.diag_clear_overrun_counter,
            0x13: client.diag_read_iop_overrun_count,
        }
        return with_data.get(sub) or (lambda: without[sub](**to))

    # ------------------------------------------------------------------ what the device holds

    def _fetch(self, call, *arguments, **named):
        """The result of a pymodbus call, whose bytes must be those of the reference slave."""
        try:
            got = call(*arguments, **named, **self.to)
        except ModbusException as error:
            raise Failure(f"reading back failed: {error}") from None
        if got.isError():
            raise Failure(f"reading back failed: {got}")
        if self.received != self.expected:
            raise Failure(f"reading back gave {text(self.received)}, should be {text(self.expected)}")
        return got

    def read(self, space, first, count, file=None):
        """Values of a table or a file as they are now."""
        client = self.client
        if space == Space.FILES:
            record = FileRecord(file_number=file, record_number=first, record_length=2 * count)
            return unpack_words(self._fetch(client.read_file_record, [record]).records[0].record_data)
        call = {
            Space.COILS: client.read_coils,
            Space.DISCRETES: client.read_discrete_inputs,
            Space.INPUTS: client.read_input_registers,
            Space.HOLDINGS: client.read_holding_registers,
        }[space]
        found = []
        for start in range(first, first + count, CHUNK):
            part = min(CHUNK, first + count - start)
            got = self._fetch(call, start, count=part)
            found += [int(b) for b in got.bits[:part]] if space in (Space.COILS, Space.DISCRETES) else got.registers
        return found

    def counters(self):
        """All nine, read one after the other; each question is a message and counts itself."""
        found = {}
        for name, sub in COUNTERS.items():
            found[name] = self._fetch(self._diagnostic_method(sub)).message
        found["event_counter"] = self._fetch(self.client.diag_get_comm_event_counter).count
        return {name: found[name] for name in ALL_COUNTERS}

    def _diagnostic_method(self, sub):
        return lambda **_: self._diagnostic_call(sub, 0)()

    def register(self):
        """The diagnostic register."""
        return self._fetch(self.client.diag_read_diagnostic_register).message

    def log(self):
        """(log newest first, event counter, bus messages); the question's own entry is left out."""
        got = self._fetch(self.client.diag_get_comm_event_log)
        return got.events[1:], got.event_count, got.message_count

    def frame(self, pdu, to=None):
        """A frame to this slave, or to another."""
        return (ascii_adu if self.ascii else adu)(self.to["device_id"] if to is None else to, pdu)


def file_records(pdu):
    """The groups of a file request as pymodbus takes them."""
    out, place = [], 2
    while place < len(pdu):
        _, file, first, quantity = struct.unpack(">BHHH", pdu[place : place + GROUP_HEAD])
        place += GROUP_HEAD
        if pdu[0] == FC.READ_FILE:
            out.append(FileRecord(file_number=file, record_number=first, record_length=2 * quantity))
        else:
            data = pdu[place : place + 2 * quantity]
            place += len(data)
            out.append(FileRecord(file_number=file, record_number=first, record_data=data))
    return out
