# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make serve` with real masters, and everything around it: variables, signals, garbage, latency."""

import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import time

import minimalmodbus
import pytest
import serial
from harness.build import silences
from protocol import frames
from protocol.defs import FC, FORMAT_BY_NAME, Space
from protocol.model import Config, Slave
from pymodbus.client import ModbusSerialClient

from live.serve import Port, Serve, refuse, request
from live.timing import Watch

ADDRESS = 17
CHARACTER_BITS = 11
BEYOND_LINE_MS, TYPICAL_MS, BUSY_MS = 10, 5, 1000
WORDS = [0x1234, 0, 0xFFFF, 0x8001]
READ = request(frames.read(FC.READ_HOLDINGS, 0, 2))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links and INIT files of this module live."""
    return tmp_path_factory.mktemp("live")


@pytest.fixture(scope="module")
def device(folder):
    """The device as it comes, with some contents."""
    init = folder / "init.json"
    init.write_text(
        json.dumps(
            {
                "coils": {"19": [1, 0, 1, 1, 0, 0, 1, 1]},
                "discretes": {"196": [0, 0, 1, 1, 0, 1]},
                "inputs": {"8": [10, 20, 65535]},
                "holdings": {"107": [555, 0, 100], "2047": [7]},
            }
        ),
        encoding="utf-8",
    )
    with Serve(folder / "bus", INIT=init) as running:
        yield running


def alive(link, address=ADDRESS):
    """True if the device answers an ordinary read."""
    frame = request(frames.read(FC.READ_HOLDINGS, 0, 1), address)
    with Port(link) as port:
        return frames.check(port.ask(frame, bytes(7))) is True


def play_every_table(client, address=ADDRESS):
    """Drive each function that touches coils or registers and compare what it returns; the others: test_functions."""
    at = {"device_id": address}
    bits = [True, False, True, True, False, False, True, False, True, True]
    assert not client.write_coils(500, bits, **at).isError()
    assert client.read_coils(500, count=10, **at).bits[:10] == bits
    assert not client.write_coil(501, True, **at).isError()
    assert client.read_coils(501, count=1, **at).bits[0] is True
    assert not client.write_registers(600, WORDS, **at).isError()
    assert client.read_holding_registers(600, count=4, **at).registers == WORDS
    assert not client.write_register(601, 77, **at).isError()
    assert not client.mask_write_register(address=600, and_mask=0xFF00, or_mask=0x0056, **at).isError()
    seen = client.readwrite_registers(read_address=600, read_count=4, write_address=602, values=[5, 6], **at)
    assert seen.registers == [0x1256, 77, 5, 6]
    assert len(client.read_discrete_inputs(0, count=2000, **at).bits) >= 2000
    assert len(client.read_input_registers(0, count=125, **at).registers) == 125
    refused = client.read_holding_registers(2047, count=2, **at)
    assert refused.isError() and refused.exception_code == 2
    refused = client.diag_read_iop_overrun_count(device_id=address)
    assert refused.isError() and refused.exception_code == 1


@pytest.mark.parametrize("baud,parity,stop", [(9600, "even", 1), (19200, "none", 2), (115200, "odd", 1)])
def test_pymodbus_drives_every_table(folder, baud, parity, stop):
    with Serve(folder / f"bus{baud}", BAUD=baud, PARITY=parity, STOP=stop) as running:
        client = ModbusSerialClient(str(running.link), baudrate=baud, parity="N", timeout=3)
        assert client.connect()
        try:
            play_every_table(client)
        finally:
            client.close()


def test_initial_contents_are_there(device):
    client = ModbusSerialClient(str(device.link), baudrate=19200, parity="N", timeout=3)
    assert client.connect()
    at = {"device_id": ADDRESS}
    bits = client.read_coils(19, count=8, **at).bits[:8]
    assert bits == [bool(b) for b in (1, 0, 1, 1, 0, 0, 1, 1)]
    assert client.read_discrete_inputs(196, count=6, **at).bits[:6] == [bool(b) for b in (0, 0, 1, 1, 0, 1)]
    assert client.read_input_registers(8, count=3, **at).registers == [10, 20, 65535]
    assert client.read_holding_registers(107, count=3, **at).registers == [555, 0, 100]
    assert client.read_holding_registers(2047, count=1, **at).registers == [7]
    client.close()


def test_minimalmodbus_with_its_own_timeout(device, record_property):
    """Its default gives the whole answer 50 ms beyond nothing at all; parity must be none on a pty."""
    instrument = minimalmodbus.Instrument(str(device.link), ADDRESS)
    port = instrument.serial
    port.baudrate, port.parity, own = 19200, serial.PARITY_NONE, port.timeout
    port.timeout = 2
    instrument.write_registers(700, WORDS)
    assert instrument.read_registers(700, 4) == WORDS
    instrument.write_float(710, 1.5)
    assert instrument.read_float(710) == 1.5
    instrument.write_bit(700, 1)
    assert instrument.read_bit(700, functioncode=1) == 1
    with pytest.raises(minimalmodbus.IllegalRequestError):
        instrument.read_register(2048)
    port.timeout, missed = own, 0
    with Watch() as watch:
        for value in range(30):
            try:
                instrument.write_register(705, value, functioncode=6)
                assert instrument.read_register(705) == value
            except (minimalmodbus.NoResponseError, minimalmodbus.InvalidResponseError):
                missed += 1
                time.sleep(1)
                port.reset_input_buffer()
    said = f"{missed} of 30 exchanges of minimalmodbus took more than its 50 ms ({watch})"
    record_property("figures", [f"live: {said}"])
    port.close()
    assert missed <= watch.bound(0, 30), said


@pytest.mark.skipif(not shutil.which("mbpoll"), reason="mbpoll is not installed")
def test_mbpoll_reads_and_writes(device):
    base = ["mbpoll", "-m", "rtu", "-a", str(ADDRESS), "-b", "19200", "-P", "none", "-1"]
    for arguments in (
        ["-t", "4", "-r", "801", str(device.link), "4660", "99"],
        ["-t", "4", "-r", "801", "-c", "2", str(device.link)],
    ):
        done = subprocess.run([*base, *arguments], capture_output=True, text=True, timeout=30, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"\[801\]:\s*4660", done.stdout) and re.search(r"\[802\]:\s*99", done.stdout), done.stdout
    done = subprocess.run(
        [*base, "-t", "4", "-r", "2049", str(device.link)], capture_output=True, text=True, timeout=30, check=False
    )
    assert "Illegal data address" in done.stdout + done.stderr


def test_mixed_requests_agree_with_the_model(device):
    """Byte for byte: good, bad, foreign, broadcast, malformed."""
    slave = Slave(Config())
    values = [(i * 257) & 0xFFFF for i in range(40)]
    with Port(device.link) as port:
        for pdu in (
            frames.write_registers(900, values),
            frames.read(FC.READ_HOLDINGS, 900, 40),
            frames.write_coils(900, [1, 0, 1] * 11),
            frames.read(FC.READ_COILS, 900, 33),
            frames.read_write(900, 3, 901, [1, 2]),
            frames.mask_write(905, 0xF0F0, 0x0A0A),
            frames.read(FC.READ_HOLDINGS, 900, 126),
            frames.read(FC.READ_HOLDINGS, 2047, 2),
            b"\x07",
            bytes([FC.WRITE_COIL, 0, 0, 0x12, 0x34]),
        ):
            expected = slave.request(request(pdu))
            assert port.ask(request(pdu), expected) == expected, frames.text(pdu)
        slave.request(request(frames.write_register(900, 0x4711), address=0))
        for line in (
            request(frames.write_register(900, 0x4711), address=0),
            request(frames.write_register(900, 0xBAD), address=18),
            frames.bad_crc(request(frames.write_register(900, 0xBAD))),
        ):
            port.write(line)
            assert port.read(0.3) == b"", frames.text(line)
        line = request(frames.read(FC.READ_HOLDINGS, 900, 5))
        expected = slave.request(line)
        assert port.ask(line, expected) == expected


def line_ms(sent, received, baud):
    """What the line itself needs: both frames and t3.5 between them, in ms."""
    bit = 1000 / baud
    _, t35 = silences({"CLK_HZ": baud * 16}, FORMAT_BY_NAME["8E1"], 16)
    return (sent + received) * CHARACTER_BITS * bit + t35 / 16 * bit


def round_of_answers(port, frame, expected, baud):
    """(median, 9th decile) in ms of what 20 answers took beyond line time."""
    late = []
    for _ in range(20):
        time.sleep(0.03)  # t3.5 of silence, well beyond
        begun = time.monotonic()
        assert port.ask(frame, expected) == expected
        late.append(1000 * (time.monotonic() - begun) - line_ms(len(frame), len(expected), baud))
    late.sort()
    return statistics.median(late), late[17]


@pytest.mark.parametrize("baud", [9600, 19200, 115200])
def test_answers_come_in_time(folder, baud, record_property):
    """The whole answer is there within 10 ms beyond line time, 5 ms typical.

    The bound is the device's, not the scheduler's: the best of some rounds counts, and where the machine is busy with
    other things a generous bound.
    """
    pdu = frames.read(FC.READ_HOLDINGS, 0, 10)
    frame, expected = request(pdu), Slave(Config()).request(request(pdu))
    rounds = []
    with Serve(folder / f"late{baud}", BAUD=baud) as running, Port(running.link) as port, Watch() as watch:
        for _ in range(5):
            rounds.append(round_of_answers(port, frame, expected, baud))
            if rounds[-1][0] <= TYPICAL_MS and rounds[-1][1] <= BEYOND_LINE_MS:
                break
    typical, most = min(rounds)
    said = f"live at {baud} baud: {typical:.2f} ms beyond line time, 9 of 10 within {most:.2f} ({watch})"
    record_property("figures", [said])
    good = typical <= watch.bound(TYPICAL_MS, BUSY_MS) and most <= watch.bound(BEYOND_LINE_MS, BUSY_MS)
    assert good, f"{said}; (median, 9th decile) of each round in ms: {rounds}"


def test_line_time_is_real(device):
    """A long answer takes as long as its bits take: the line is paced, not just fast."""
    frame = request(frames.read(FC.READ_HOLDINGS, 0, 120))
    expected = bytes(5 + 240)
    time.sleep(0.05)
    with Port(device.link) as port:
        begun = time.monotonic()
        answer = port.ask(frame, expected, seconds=3)
        taken = 1000 * (time.monotonic() - begun)
    assert len(answer) == len(expected)
    assert taken >= 0.97 * line_ms(len(frame), len(expected), device.baud), f"{taken:.1f} ms"


def test_frame_in_pieces_is_one_frame_or_none(device):
    """A client that writes in two pieces close together: answered as one, or not at all."""
    with Port(device.link) as port:
        for cut in (1, 4, 7):
            port.write(READ[:cut])
            port.write(READ[cut:])
            assert len(port.read(0.5, 9)) in (0, 9)
    assert alive(device.link)


def test_garbage_at_full_speed_does_not_stop_it(device):
    with Port(device.link) as port:
        deadline = time.monotonic() + 2
        while time.monotonic() < deadline:
            port.write(os.urandom(64))
            port.read(0)
        port.read(0.5, 10_000)
    deadline = time.monotonic() + 10
    while not alive(device.link):
        assert time.monotonic() < deadline, "no answer after garbage"
    assert device.process.poll() is None


def test_client_may_leave_and_return(device):
    """Also in the middle of a request, and with an answer unread."""
    for leave in (READ[:3], READ):
        with Port(device.link) as port:
            port.write(leave)
        time.sleep(0.2)
        assert alive(device.link)


def test_two_devices_side_by_side(folder):
    first = Serve(folder / "one", ADDRESS=1, BAUD=115200)
    second = Serve(folder / "two", ADDRESS=2, BAUD=9600)
    with first, second:
        for running, address in ((first, 1), (second, 2)):
            frame = request(frames.write_register(3, 100 + address), address)
            with Port(running.link) as port:
                assert port.ask(frame, frame) == frame
        assert alive(first.link, 1) and alive(second.link, 2)
        assert not alive_quickly(first.link, 2)
    assert not os.path.lexists(first.link) and not os.path.lexists(second.link)


def alive_quickly(link, address):
    """Like alive, for a device that should not answer."""
    with Port(link) as port:
        return port.ask(request(frames.read(FC.READ_HOLDINGS, 0, 1), address), bytes(7), 0.3) != b""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_signal_ends_it_within_a_second(folder, number):
    with Serve(folder / "ended") as running:
        assert running.link.is_symlink()
        with Watch() as watch:
            status, seconds = running.stop(number)
        assert status == 0, f"exit status {status}: {running.stderr()}"
        assert seconds < watch.bound(1, 8), f"took {seconds:.2f} s ({watch})"
        assert not os.path.lexists(running.link), "the link stays"


def test_restart_on_the_same_link(folder):
    link = folder / "again"
    for value in (1, 2):
        with Serve(link) as running:
            frame = request(frames.write_register(0, value))
            with Port(running.link) as port:
                read = request(frames.read(FC.READ_HOLDINGS, 0, 1))
                assert port.ask(read, bytes(7)) == frames.adu(ADDRESS, b"\x03\x02\0\0"), "memory is not new"
                assert port.ask(frame, frame) == frame
    # a leftover of a device that was killed
    with Serve(link) as running:
        running.process.kill()
        running.process.wait()
        assert os.path.lexists(link)
    with Serve(link) as running:
        assert alive(running.link)


def test_no_processor_time_while_idle(device):
    def used():
        with open(f"/proc/{device.process.pid}/stat", encoding="ascii") as stat:
            fields = stat.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    time.sleep(0.3)
    before = used()
    time.sleep(2)
    assert used() - before < 0.2, "busy while the line is idle"


def test_map_builds_another_device(folder):
    """Bases and sizes as in a real device's manual; the last address of each table and the next."""
    tables = {"coils": (304, 37), "discretes": (452, 22), "holdings": (352, 32), "inputs": (264, 1)}
    spaces = {
        "coils": (Space.COILS, FC.READ_COILS),
        "discretes": (Space.DISCRETES, FC.READ_DISCRETES),
        "holdings": (Space.HOLDINGS, FC.READ_HOLDINGS),
        "inputs": (Space.INPUTS, FC.READ_INPUTS),
    }
    slave = Slave(Config(tables={spaces[name][0]: place for name, place in tables.items()}))
    text = " ".join(f"{name}={base}+{count}" for name, (base, count) in tables.items())
    with Serve(folder / "map", MAP=text) as running, Port(running.link) as port:
        for name, (base, count) in tables.items():
            code = spaces[name][1]
            for address, quantity in ((base, count), (base, count + 1), (base - 1, 1), (base + count, 1)):
                frame = request(frames.read(code, address, quantity))
                expected = slave.request(frame)
                assert port.ask(frame, expected) == expected, f"{name} {address} + {quantity}"
                time.sleep(0.01)


def test_link_of_a_running_device_is_refused(device):
    status, lines = refuse(LINK=device.link)
    assert status == 2 and len(lines) == 1, lines
    assert alive(device.link)
