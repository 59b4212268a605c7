# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Diagnostics, identity, file records, FIFO queues and user functions through `make serve`, asked by pymodbus."""

import json
import struct
import sys
import time
from contextlib import contextmanager

import pytest
from harness import build
from protocol import defs, frames
from protocol.defs import FC, Space
from protocol.memory import Config
from protocol.model import Slave
from protocol.pdm import Event, EventRecords
from pymodbus.client import ModbusSerialClient
from pymodbus.pdu.file_message import FileRecord, ReadFifoQueueResponse

from live.controlled import Controlled
from live.serve import ROOT, Port, Serve, request

ADDRESS = 17
AT = {"device_id": ADDRESS}
BAUD = 115200
READ = request(frames.read(FC.READ_HOLDINGS, 0, 1))
STATUS, DIAGNOSTIC, FAILURE = 0x6D, 0xA5A4, defs.EX.NAK
INIT = {
    "holdings": {"0": [4660], "1246": [2, 440, 4740], "1300": [0], "1301": [32]},
    "files": {"1": {"0": [1, 2, 3]}, "4": {"1": [3582, 32], "255": [65535]}},
    "exception_status": STATUS,
    "run_indicator": 0,
    "diagnostic": DIAGNOSTIC,
}
TEXTS = {0: "V" * 100, 1: "P" * 100, 2: "V2.11", 3: "http://example.org", 5: "model", 0x80: "first", 0xFF: "last"}
LAYOUT = {"holdings": (100, 64), "files": (3, 100)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links and INIT files of this module live."""
    return tmp_path_factory.mktemp("functions")


@contextmanager
def running(folder, name, init=None, **variables):
    """(link, pymodbus) of a device with this INIT; answers to a raw frame come by `Port`."""
    if init is not None:
        path = folder / f"{name}.json"
        path.write_text(json.dumps(init), encoding="utf-8")
        variables["INIT"] = path
    with Serve(folder / name, BAUD=BAUD, **variables) as device:
        client = ModbusSerialClient(str(device.link), baudrate=BAUD, parity="N", timeout=5, retries=0)
        assert client.connect()
        try:
            yield device.link, client
        finally:
            client.close()


@pytest.fixture(scope="module")
def device(folder):
    """The reference map with INIT."""
    with running(folder, "full", INIT) as (link, client):
        yield link, client


@pytest.fixture
def master(device):
    """pymodbus at the device, counters and log freshly cleared: one event, the restart."""
    _, client = device
    assert client.diag_restart_communication(True, **AT).message == defs.RESTART_CLEAR
    return client


def send(master, *lines):
    """Frames that get no answer, one after the other."""
    for line in lines:
        master.socket.write(line)
        master.socket.timeout = 11 * len(line) / BAUD + 0.1
        assert master.socket.read(1) == b"", frames.text(line)
    master.socket.timeout = 5


# ---------------------------------------------------------------------- diagnostics


def test_read_exception_status(master):
    assert master.read_exception_status(**AT).status == STATUS


def test_diag_query_data(master):
    assert master.diag_query_data(b"\xa5\x37", **AT).message == b"\xa5\x37"


def test_diag_restart_communication(master):
    assert master.diag_restart_communication(False, **AT).message == defs.RESTART_KEEP
    assert master.diag_get_comm_event_log(**AT).events == [0x80, 0x00, 0x40, 0x80, 0x00]
    master.diag_restart_communication(True, **AT)
    got = master.diag_get_comm_event_log(**AT)
    assert (got.events, got.event_count, got.message_count) == ([0x80, 0x00], 0, 1)


def test_diag_read_diagnostic_register_and_clear(folder):
    """INIT's bits stand until a master clears them; restart leaves them."""
    with running(folder, "register", {"diagnostic": DIAGNOSTIC}) as (_, master):
        assert master.diag_read_diagnostic_register(**AT).message == DIAGNOSTIC
        master.diag_restart_communication(True, **AT)
        assert master.diag_read_diagnostic_register(**AT).message == DIAGNOSTIC
        assert master.diag_clear_counters(**AT).message == 0
        assert master.diag_read_diagnostic_register(**AT).message == 0
        assert master.diag_read_bus_message_count(**AT).message == 2
        assert master.diag_get_comm_event_log(**AT).events[:3] == [0x80, 0x40, 0x80], "cleared with the counters"


def test_diag_change_ascii_input_delimiter(master):
    assert master.diag_change_ascii_input_delimeter(delimiter=0x2100, **AT).message == 0x2100
    assert master.diag_change_ascii_input_delimeter(delimiter=0x0021, **AT).exception_code == defs.EX.VALUE


def test_diag_force_listen_only(master):
    master.diag_force_listen_only(**AT)
    time.sleep(0.1)  # the line has carried it
    send(master, READ, request(frames.restart()))
    assert master.diag_get_comm_event_log(**AT).events == [
        *(0x80, 0x00, 0x60, 0xA0, 0x60, 0xA0, 0x04, 0x40, 0x80, 0x00),
    ]
    assert master.read_holding_registers(0, count=1, **AT).registers == [4660]


BAD, LONG = frames.bad_crc(READ), bytes([ADDRESS]) * 257
FOREIGN = request(frames.read(FC.READ_HOLDINGS, 0, 1), 18)
BROADCAST = request(frames.write_coil(0, True), 0)
COUNTED = {  # call, what comes before, count
    "diag_read_bus_message_count": ([FOREIGN, BROADCAST, BAD], 3),
    "diag_read_bus_comm_error_count": ([BAD, BAD, LONG], 3),
    "diag_read_device_message_count": ([FOREIGN, BROADCAST, BAD], 2),
    "diag_read_device_no_response_count": ([BROADCAST, BROADCAST, FOREIGN], 2),
    "diag_read_bus_char_overrun_count": ([LONG, BAD, LONG], 2),
    "diag_read_bus_exception_error_count": ([request(frames.read(FC.READ_HOLDINGS, 0, 1), 0)], 1),
    "diag_read_device_nak_count": ([], 0),
    "diag_read_device_busy_count": ([], 0),
}


@pytest.mark.parametrize("call", COUNTED)
def test_counters(master, call):
    lines, count = COUNTED[call]
    send(master, *lines)
    assert getattr(master, call)(**AT).message == count


def test_diag_clear_overrun_counter(master):
    send(master, LONG)
    assert master.diag_read_diagnostic_register(**AT).message & defs.OVERRUN_FLAG
    assert master.diag_clear_overrun_counter(**AT).message == 0
    assert master.diag_read_bus_char_overrun_count(**AT).message == 0
    assert not master.diag_read_diagnostic_register(**AT).message & defs.OVERRUN_FLAG
    assert master.diag_read_bus_comm_error_count(**AT).message == 1


def test_modbus_plus_is_refused(master):
    for answer in (master.diag_read_iop_overrun_count(**AT), master.diag_getclear_modbus_response(data=3, **AT)):
        assert answer.exception_code == defs.EX.FUNCTION


def test_diag_get_comm_event_counter(master):
    master.read_holding_registers(0, count=1, **AT)
    master.read_holding_registers(9999, count=1, **AT)
    for _ in range(2):
        got = master.diag_get_comm_event_counter(**AT)
        assert (got.count, got.status) == (1, True)


def test_diag_get_comm_event_log(master):
    master.read_holding_registers(0, count=1, **AT)
    master.read_holding_registers(9999, count=1, **AT)
    send(master, BROADCAST, FOREIGN, BAD, LONG)
    got = master.diag_get_comm_event_log(**AT)
    assert got.events == [0x80, 0x92, 0x82, 0x40, 0xC0, 0x41, 0x80, 0x40, 0x80, 0x00]
    assert (got.event_count, got.message_count, got.status) == (2, 5, True)
    for _ in range(40):
        master.read_exception_status(**AT)
    assert master.diag_get_comm_event_log(**AT).events == [0x80] + [0x40, 0x80] * 31 + [0x40]


def test_busy_and_failure(folder):
    """INIT's inputs: what they refuse, and how it is counted and logged."""
    with running(folder, "busy", {"busy": 1}) as (_, master):
        assert master.read_holding_registers(0, count=1, **AT).exception_code == defs.EX.BUSY
        assert master.diag_get_comm_event_counter(**AT).status is False
        assert master.diag_read_device_busy_count(**AT).message == 1
        assert master.diag_get_comm_event_log(**AT).events[-2:] == [0x44, 0x80]
    with running(folder, "failing", {"failure": int(FAILURE)}) as (_, master):
        assert master.write_register(0, 1, **AT).exception_code == FAILURE
        assert master.diag_read_device_nak_count(**AT).message == 1
        assert master.diag_get_comm_event_log(**AT).events[-2:] == [0x48, 0x80]


def test_request_right_behind_a_broadcast(folder):
    """The device keeps it until the core has done its work, which nothing on the line shows: it tells of the frame when
    the line has been silent for t3.5."""
    ask, answer = request(frames.read(FC.READ_COILS, 1, 3)), request(b"\x01\x01\x07")
    with Controlled(folder / "behind", BAUD=BAUD) as running, Port(running.link) as port:
        for line in (request(frames.write_coils(0, [1] * 1024), 0), BROADCAST, FOREIGN, BAD):
            port.write(line)
            running.wait_for("frame", direction="request", bytes=line.hex())
            assert port.ask(ask, answer) == answer, frames.text(line)


# ---------------------------------------------------------------------- files and FIFO queues


def test_read_file_record(master):
    asked = [
        FileRecord(file_number=4, record_number=1, record_length=4),
        FileRecord(file_number=1, record_number=0, record_length=6),
        FileRecord(file_number=4, record_number=255, record_length=2),
    ]
    got = [frames.unpack_words(r.record_data) for r in master.read_file_record(asked, **AT).records]
    assert got == [[3582, 32], [1, 2, 3], [65535]]
    outside = [FileRecord(file_number=4, record_number=255, record_length=4)]
    assert master.read_file_record(outside, **AT).exception_code == defs.EX.ADDRESS
    outside = [FileRecord(file_number=5, record_number=0, record_length=2)]
    assert master.read_file_record(outside, **AT).exception_code == defs.EX.ADDRESS


def test_write_file_record(master):
    words = {(2, 7): [1711, 1214, 4109], (3, 200): [9] * 20}
    sent = [
        FileRecord(file_number=file, record_number=first, record_data=frames.pack_words(run))
        for (file, first), run in words.items()
    ]
    assert not master.write_file_record(sent, **AT).isError()
    for (file, first), run in words.items():
        asked = [FileRecord(file_number=file, record_number=first, record_length=2 * len(run))]
        got = master.read_file_record(asked, **AT).records[0].record_data
        assert frames.unpack_words(got) == run


def test_read_fifo_queue(master, monkeypatch):
    """pymodbus 3.16.1 takes the answer for two bytes shorter than it is on a serial line."""
    size = classmethod(lambda cls, data: 6 + struct.unpack(">H", data[2:4])[0] if len(data) >= 4 else 0)
    monkeypatch.setattr(ReadFifoQueueResponse, "calculateRtuFrameSize", size)
    assert master.read_fifo_queue(address=1246, **AT).values == [440, 4740]
    assert master.read_fifo_queue(address=1300, **AT).values == []
    assert master.read_fifo_queue(address=1301, **AT).exception_code == defs.EX.VALUE
    assert master.read_fifo_queue(address=2048, **AT).exception_code == defs.EX.ADDRESS


# ---------------------------------------------------------------------- identity


def test_report_device_id_and_default_objects(master):
    got = master.report_device_id(**AT)
    assert (got.identifier, got.status) == (b"\x09", False)
    assert master.read_device_information(read_code=1, **AT).information == defs.DEFAULT_OBJECTS


@pytest.fixture(scope="module")
def named(folder):
    """(pymodbus, Config) of a device with identity, map and files of its own."""
    init = {
        "server_id": [0, 84],
        "additional_data": list(range(1, 235)),
        "conformity": 0x83,
        "device_id": {str(number): text for number, text in TEXTS.items()},
        "holdings": {"100": [5]},
        "files": {"3": {"99": [77]}},
    }
    config = Config(
        tables=dict.fromkeys(Space, (0, 0)) | {Space.HOLDINGS: LAYOUT["holdings"]},
        files=LAYOUT["files"],
        server_id=bytes([0, 84]),
        additional_data=bytes(range(1, 235)),
        conformity=0x83,
        objects={number: text.encode() for number, text in TEXTS.items()},
    )
    place = "holdings={}+{} files={}x{}".format(*LAYOUT["holdings"], *LAYOUT["files"])
    with running(folder, "named", init, MAP=place) as (_, client):
        yield client, config


def test_server_id_and_additional_data(named):
    master, _ = named
    body = bytes([0, 84, 0xFF, *range(1, 235)])
    got = master.report_device_id(**AT)
    assert got.identifier == body[:-1], "pymodbus takes the last byte for the run indicator"


def test_read_device_information(named):
    """Every category, also over several answers; single objects."""
    master, config = named
    for code, last in ((1, 2), (2, 6), (3, 255)):
        found, first, answers = {}, 0, 0
        while True:
            got = master.read_device_information(read_code=code, object_id=first, **AT)
            assert not got.isError() and got.conformity == 0x83
            found |= got.information
            answers += 1
            if not got.more_follows:
                break
            first = got.next_object_id
        assert found == {i: value for i, value in config.objects.items() if i <= last}
        assert answers == (2 if code == 3 else 1)
    for number, value in config.objects.items():
        assert master.read_device_information(read_code=4, object_id=number, **AT).information == {number: value}
    for number in (4, 7, 0x81):
        got = master.read_device_information(read_code=4, object_id=number, **AT)
        assert got.exception_code == defs.EX.ADDRESS
    assert master.read_device_information(read_code=5, **AT).exception_code == defs.EX.VALUE


def test_map_with_files(named):
    """Files of a MAP; tables that are not named do not exist."""
    master, config = named
    slave = Slave(config)
    slave.memory[Space.HOLDINGS, 100] = 5
    slave.memory[Space.FILES, config.record_item(3, 99)] = 77
    for pdu in (
        frames.read_files((3, 99, 1)),
        frames.read_files((3, 99, 2)),
        frames.read_files((4, 0, 1)),
        frames.write_files((1, 0, [1, 2]), (2, 98, [3, 4])),
        frames.read_files((2, 98, 2), (1, 0, 2)),
        frames.read(FC.READ_HOLDINGS, 100, 1),
        frames.read(FC.READ_COILS, 0, 1),
        frames.read(FC.READ_INPUTS, 0, 1),
    ):
        expected = slave.request(request(pdu))
        master.socket.write(request(pdu))
        assert master.socket.read(len(expected)) == expected, frames.text(pdu)


# ---------------------------------------------------------------------- user functions, the meter


def test_user_functions(folder):
    """DEVICE=user: the example user's functions 41, 42, 64, and everything else as it is."""
    answers = {
        "41 0001 FFFF": "41 00010000",
        "41 0001": "C1 03",
        "42 00": "42 0001",
        "42 01": "C2 05",
        "64 010203": "64 030201",
        "43": "C3 01",
        "07": "07 6D",
    }
    with running(folder, "user", {"exception_status": STATUS}, DEVICE="user") as (link, _), Port(link) as port:
        for asked, wanted in answers.items():
            frame, expected = request(bytes.fromhex(asked)), request(bytes.fromhex(wanted))
            assert port.ask(frame, expected) == expected, asked


def test_meter(folder):
    """DEVICE=pdm: inputs, relays, registers, limits, and the event records in their order."""
    events = [Event(4, 9, True, 19877, 25, 18, 23, 1, 7), Event(4, 10, False, 59999, 59, 23, 31, 12, 99)]
    records = EventRecords()
    for event in events:
        records.add(event)
    init = {
        "discretes": {"0": [1, 1, 0, 1]},
        "holdings": {"1": [4660], "278": [6020, 6016, 6026]},
        "events": [vars(e) | {"closed": int(e.closed), "year": 2000 + e.year} for e in events],
    }
    slave = Slave(
        Config(
            tables={Space.COILS: (0, 2), Space.DISCRETES: (0, 4), Space.INPUTS: (0, 0), Space.HOLDINGS: (0, 512)},
            functions=frozenset({1, 2, 3, 5, 6, 16}),
            limits=defs.Limits(read_registers=50, write_registers=60),
            read_only=(256, 256),
            files=(0, 1),
            user_codes=frozenset({3}),
        )
    )
    slave.user = records.answer
    for table, space in (("discretes", Space.DISCRETES), ("holdings", Space.HOLDINGS)):
        for start, run in init[table].items():
            for address, value in enumerate(run, int(start)):
                slave.memory[space, address] = value
    with running(folder, "meter", init, DEVICE="pdm") as (link, _), Port(link) as port:
        for pdu in (
            frames.read(FC.READ_DISCRETES, 0, 4),
            *[frames.read(FC.READ_HOLDINGS, 1, 1)] * 3,
            frames.read(FC.READ_HOLDINGS, 0, 2),
            frames.read(FC.READ_HOLDINGS, 278, 3),
            frames.read(FC.READ_HOLDINGS, 0, 51),
            frames.write_register(255, 1),
            frames.write_register(256, 1),
            frames.write_coil(1, True),
            frames.read(FC.READ_COILS, 0, 2),
            frames.read(FC.READ_COILS, 0, 3),
            frames.write_registers(0, [1] * 61),
            frames.bare(FC.GET_EVENT_COUNTER),
        ):
            expected = slave.request(request(pdu))
            assert port.ask(request(pdu), expected) == expected, frames.text(pdu)


def test_serve_says_the_same_as_the_bench(monkeypatch):
    """The device keeps its own copy of a few numbers, to start without tb/."""
    monkeypatch.syspath_prepend(str(ROOT / "sim"))
    import init_file

    assert {build.PREFIX[s]: count for s, (_, count) in defs.reference_map().items()} == {
        prefix: count for _, prefix, count, _ in init_file.TABLES.values()
    }
    assert [int(s) for s in build.PREFIX] == [space for space, *_ in init_file.TABLES.values()]
    assert defs.REFERENCE_FILES == init_file.FILES and int(Space.FILES) == init_file.FILES_SPACE
    assert build.OBJECT_PARAMETERS == init_file.OBJECTS and defs.CONFORMITIES == init_file.CONFORMITIES
    assert {name: build.WIDTHS[name] for name in init_file.WIDTHS} == init_file.WIDTHS
    assert {i: text.encode() for i, text in init_file.DEFAULT_OBJECTS.items()} == defs.DEFAULT_OBJECTS
    assert bytes(init_file.DEFAULT_SERVER_ID) == Config().server_id
    assert init_file.DEFAULT_CONFORMITY == Config().conformity
    assert sys.modules.pop("init_file")
