# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Ways to the live device beside the pseudo-terminal: Modbus TCP, RTU over TCP, several slaves, a serial port."""

import os
import socket
import struct
import tty

import pytest
from protocol import frames
from protocol.defs import FC, Space
from pymodbus import FramerType
from pymodbus.client import ModbusTcpClient

from live.controlled import Controlled, Refused
from live.serve import Port, Serve, free_port, refuse, request
from live.timing import until

NO_ANSWER = 0x0B
SLAVES = [17, 18, 20, 21, 22]
READ = frames.read(FC.READ_HOLDINGS, 0, 2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links of this module live."""
    return tmp_path_factory.mktemp("ways")


@pytest.fixture(scope="module")
def served(folder):
    """(device with five slaves, port of Modbus TCP, port of RTU over TCP)."""
    tcp, rtu = free_port(), free_port()
    with Serve(folder / "tcp", SLAVES="17,18,20-22", TCP=tcp, RTU_TCP=rtu) as running:
        yield running, tcp, rtu


# ---------------------------------------------------------------------- TCP


@pytest.mark.parametrize("framer", [FramerType.SOCKET, FramerType.RTU])
def test_pymodbus_by_tcp(served, framer):
    _, tcp, rtu = served
    client = ModbusTcpClient(
        "127.0.0.1", port=tcp if framer == FramerType.SOCKET else rtu, framer=framer, timeout=3, retries=0
    )
    assert client.connect()
    try:
        for address in SLAVES:
            at = {"device_id": address}
            words = [address, 65535, 0, 7]
            assert not client.write_registers(600, words, **at).isError()
            assert not client.write_coils(10, [True, False, True], **at).isError()
        for address in SLAVES:
            at = {"device_id": address}
            assert client.read_holding_registers(600, count=4, **at).registers == [address, 65535, 0, 7]
            assert client.read_coils(10, count=3, **at).bits[:3] == [True, False, True]
            assert client.read_holding_registers(2047, count=2, **at).exception_code == 2
    finally:
        client.close()


def exchange(connection, transaction, unit, pdu):
    """The answer to a request of Modbus TCP: (transaction, unit, PDU)."""
    connection.sendall(struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu)
    return answer(connection)


def answer(connection):
    """The next answer of Modbus TCP."""
    head = b""
    while len(head) < 7:
        head += connection.recv(7 - len(head))
    number, protocol, length, unit = struct.unpack(">HHHB", head)
    assert protocol == 0
    body = b""
    while len(body) < length - 1:
        body += connection.recv(length - 1 - len(body))
    return number, unit, body


def test_silent_slave_is_exception_0b_and_a_broadcast_is_silence(served):
    _, tcp, _ = served
    with socket.create_connection(("127.0.0.1", tcp), 5) as connection:
        assert exchange(connection, 7, 99, READ) == (7, 99, bytes([0x83, NO_ANSWER]))
        write = frames.write_register(700, 4711)
        connection.sendall(struct.pack(">HHHB", 8, 0, len(write) + 1, 0) + write)
        assert exchange(connection, 9, 22, frames.read(FC.READ_HOLDINGS, 700, 1)) == (9, 22, b"\x03\x02\x12\x67")
        assert exchange(connection, 10, 17, frames.read(FC.READ_HOLDINGS, 700, 1)) == (10, 17, b"\x03\x02\x12\x67")


def test_many_connections_take_turns(served):
    """Requests of several masters at once: each gets its own answers."""
    running, tcp, _ = served
    connections = [socket.create_connection(("127.0.0.1", tcp), 5) for _ in range(10)]
    with Port(running.link) as port:
        for number, connection in enumerate(connections):
            pdu = frames.read(FC.READ_HOLDINGS, 0, number + 1)
            connection.sendall(struct.pack(">HHHB", number, 0, len(pdu) + 1, 18) + pdu)
        mine = port.ask(request(READ), bytes(9), 10)
        assert frames.check(mine) and len(mine) == 9
        for number, connection in enumerate(connections):
            got = answer(connection)
            assert (got[0], len(got[2])) == (number, 2 + 2 * (number + 1))
            connection.close()


RUBBISH = [
    b"\x00\x01\x00\x05\x00\x06\x11" + READ,
    b"\x00\x01\x00\x00\x00\x01\x11",
    b"\x00\x01\x00\x00\xff\xff\x11" + READ,
]


@pytest.mark.parametrize("data", RUBBISH)
def test_what_is_no_modbus_tcp_ends_the_connection(served, data):
    _, tcp, _ = served
    with socket.create_connection(("127.0.0.1", tcp), 5) as connection:
        connection.sendall(data)
        assert connection.recv(100) == b""
    with socket.create_connection(("127.0.0.1", tcp), 5) as connection:
        assert exchange(connection, 1, 17, READ)[2][0] == 3


def test_rtu_over_tcp_says_nothing_where_the_line_is_silent(served):
    _, _, rtu = served
    with socket.create_connection(("127.0.0.1", rtu), 5) as connection:
        connection.settimeout(0.2)
        for frame in (frames.bad_crc(request(READ)), request(READ, 99), b"\x11"):
            connection.sendall(frame)
            with pytest.raises(TimeoutError):
                connection.recv(100)
        connection.settimeout(5)
        connection.sendall(request(READ))
        assert len(connection.recv(100)) == 9


def test_a_thousand_connections_do_not_stop_the_line(served):
    running, tcp, _ = served
    kept = []
    for _ in range(1000):
        try:
            kept.append(socket.create_connection(("127.0.0.1", tcp), 1))
        except OSError:
            break
    with Port(running.link) as port:
        assert len(port.ask(request(READ), bytes(9))) == 9
    for connection in kept:
        connection.close()

    def served_again():
        try:
            with socket.create_connection(("127.0.0.1", tcp), 5) as connection:
                return exchange(connection, 1, 17, READ)[2][0] == 3
        except (OSError, AssertionError):  # there is no room yet
            return False

    until(served_again, "no room after the others have gone")


def test_listening_is_on_the_loopback_and_a_port_in_use_is_refused(served, folder):
    _, tcp, _ = served
    with open("/proc/net/tcp", encoding="ascii") as table:
        local = [line.split()[1] for line in table if line.split()[3] == "0A"]
    assert f"0100007F:{tcp:04X}" in local and f"00000000:{tcp:04X}" not in local
    for name in ("TCP", "RTU_TCP", "WEB"):  # without make, which would install what WEB needs
        status, lines = refuse(False, LINK=folder / "bad", **{name: tcp})
        assert status == 2 and len(lines) == 1 and "in use" in lines[0], lines
        for value in ("0", "65536", "http", "host:", "1.2.3.4.5:99999", ":80"):
            status, lines = refuse(False, LINK=folder / "bad", **{name: value})
            assert status == 2 and len(lines) == 1, lines


# ---------------------------------------------------------------------- several slaves


def test_slaves_hear_each_other(folder):
    """Driver enables resolved: one line, on which each slave counts the frames of the others."""
    with Controlled(folder / "many", SLAVES="17,18,20-22", BAUD=115200) as running:
        assert running.hello["slaves"] == SLAVES
        for address in SLAVES:
            running.call("write", address, int(Space.HOLDINGS), 0, address, 0)
        for address in SLAVES:
            got, verdict = running.send(request(READ, address))
            assert got == request(bytes([3, 4, 0, address, 0, 0]), address) and verdict == ""
        for address in SLAVES:
            counters = running.counters(address)
            assert (counters["bus_message"], counters["slave_message"], counters["comm_error"]) == (9, 1, 0), counters
        assert running.send(request(READ, 19)) == (b"", "other address")
        assert running.send(request(frames.write_register(1, 5), 0)) == (b"", "broadcast")
        assert all(running.read(3, 1, 1, address) == [5] for address in SLAVES)
        assert running.send(frames.bad_crc(request(READ)))[1] == "crc"
        running.send(request(frames.diagnostics(4, 0), 20))
        running.events.clear()
        assert running.send(request(READ, 20)) == (b"", "listen-only")
        told = running.wait_for("silence")["slaves"]
        assert told == {str(a): "listen-only" if a == 20 else "other address" for a in SLAVES}
        with pytest.raises(Refused):
            running.read(3, 0, 1, 19)


@pytest.mark.parametrize("value", ["", "0", "248", "17,", "17,17", "20-18", "17-20,19", "a", "1-33", "17 18 x"])
def test_bad_slaves_are_refused(folder, value):
    status, lines = refuse(LINK=folder / "bad", SLAVES=value or ",")
    assert status == 2 and len(lines) == 1, lines


def test_slaves_and_address_exclude_each_other(folder):
    status, lines = refuse(LINK=folder / "bad", SLAVES="1,2", ADDRESS=3)
    assert status == 2 and len(lines) == 1, lines
    status, lines = refuse(LINK=folder / "bad", SLAVES="1,2", MAP="examples/relay_box/relay_box.yaml")
    assert status == 2 and len(lines) == 1 and "run_time" in lines[0], lines


# ---------------------------------------------------------------------- a serial port


def pair():
    """(descriptor of a raw pseudo-terminal, path of its other side): a cable."""
    master, slave = os.openpty()
    tty.setraw(slave)
    path = os.ttyname(slave)
    return master, slave, path


class Cable(Port):
    """The master's end of a cable."""

    def __init__(self, file):
        self.file = file


def test_serial_port_instead_of_the_terminal(folder):
    """Bytes of every value go through, FF too, which marks errors on a real port."""
    master, slave, path = pair()
    os.close(slave)
    with Serve(path, LINK="", PORT=path, BAUD=115200) as running, Cable(master) as port:
        words = [0xFFFF, 0xFF00, 0x00FF, 0x1234]
        write = request(frames.write_registers(0, words))
        assert port.ask(write, bytes(8)) == request(frames.write_registers(0, words)[:5])
        answer_ = request(b"\x03\x08" + frames.pack_words(words))
        for _ in range(20):
            assert port.ask(request(frames.read(FC.READ_HOLDINGS, 0, 4)), answer_) == answer_
        port.write(frames.bad_crc(request(READ)))
        assert port.read(0.1) == b""
        assert running.process.poll() is None


def test_serial_port_that_goes_ends_the_device(folder):
    master, slave, path = pair()
    os.close(slave)
    with Serve(path, LINK="", PORT=path) as running:
        os.close(master)
        assert running.process.wait(5) == 1
        assert "the port has gone" in running.stderr()


def test_bad_ports_are_refused(folder):
    plain = folder / "plain"
    plain.write_text("", encoding="ascii")
    for port in (folder / "none", plain):
        status, lines = refuse(PORT=port)
        assert status == 2 and len(lines) == 1, lines
    status, lines = refuse(PORT="/dev/null", LINK=folder / "x")
    assert status == 2 and len(lines) == 1 and "LINK" in lines[0], lines
