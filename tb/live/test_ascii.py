# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make serve MODE=ascii` with real masters: pymodbus and minimalmodbus; mbpoll has no ASCII mode."""

import json
import time

import minimalmodbus
import pytest
import serial
from protocol import frames
from protocol.defs import FC, Sub
from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient

from live.serve import Serve, refuse

ADDRESS = 17
READ = frames.ascii_adu(ADDRESS, frames.read(FC.READ_HOLDINGS, 107, 3))
ANSWER = frames.ascii_adu(ADDRESS, bytes([FC.READ_HOLDINGS, 6]) + frames.pack_words([555, 0, 100]))


@pytest.fixture(scope="module", params=["7", "8"])
def device(request, tmp_path_factory):
    """The device in ASCII mode, with characters of 7 and of 8 bits."""
    folder = tmp_path_factory.mktemp("ascii")
    init = folder / "init.json"
    init.write_text(json.dumps({"holdings": {"107": [555, 0, 100]}, "inputs": {"8": [10]}, "discretes": {"3": [1]}}))
    with Serve(folder / "bus", INIT=init, MODE="ascii", DATA_BITS=request.param) as running:
        yield running


def raw(port, line, patience=5.0):
    """What comes back for characters."""
    port.reset_input_buffer()
    port.write(line)
    port.timeout = patience
    return port.read_until(b"\n")


def test_pymodbus(device):
    with ModbusSerialClient(str(device.link), framer=FramerType.ASCII, baudrate=19200, timeout=2, retries=0) as client:
        to = {"device_id": ADDRESS}
        assert client.read_holding_registers(107, count=3, **to).registers == [555, 0, 100]
        assert client.read_input_registers(8, count=1, **to).registers == [10]
        assert client.read_discrete_inputs(0, count=8, **to).bits[3]
        words = [(7 * i) & 0xFFFF for i in range(123)]
        assert not client.write_registers(200, words, **to).isError()
        assert client.read_holding_registers(200, count=123, **to).registers == words
        assert not client.write_coils(5, [True, False, True], **to).isError()
        assert client.read_coils(5, count=3, **to).bits[:3] == [True, False, True]
        assert client.read_holding_registers(60000, count=1, **to).exception_code == 2
        assert client.diag_query_data(b"\x12\x34", **to).message
        assert client.report_device_id(**to).identifier


def test_minimalmodbus(device):
    instrument = minimalmodbus.Instrument(str(device.link), ADDRESS, mode=minimalmodbus.MODE_ASCII)
    instrument.serial.baudrate, instrument.serial.timeout = 19200, 2  # parity must be none on a pseudo-terminal
    assert instrument.read_registers(107, 3) == [555, 0, 100]
    instrument.write_register(300, 0xBEEF, functioncode=6)
    assert instrument.read_register(300) == 0xBEEF
    instrument.write_float(310, 2.5)
    assert instrument.read_float(310) == 2.5
    instrument.write_bit(7, 1)
    assert instrument.read_bit(7, functioncode=1) == 1
    with pytest.raises(minimalmodbus.IllegalRequestError):
        instrument.read_register(60000)
    instrument.serial.close()


def test_a_person_at_a_terminal(device):
    """Characters one by one with pauses, garbage before, an abandoned frame, lower case, the delimiter."""
    with serial.Serial(str(device.link), 19200) as port:
        assert raw(port, b"hello\r\n" + READ) == ANSWER
        port.reset_input_buffer()
        for character in READ:
            port.write(bytes([character]))
            time.sleep(0.02)
        assert port.read_until(b"\n") == ANSWER
        assert raw(port, READ[:9] + READ) == ANSWER
        assert raw(port, READ.lower(), 0.3) == b""
        assert raw(port, READ) == ANSWER
        delimiter = frames.ascii_adu(ADDRESS, frames.diagnostics(Sub.DELIMITER, ord("#") << 8))
        assert raw(port, delimiter) == delimiter
        assert raw(port, READ, 0.3) == b""
        assert raw(port, READ[:-1] + b"#") == ANSWER
        restart = frames.ascii_adu(ADDRESS, frames.restart())
        assert raw(port, restart[:-1] + b"#") == restart
        assert raw(port, READ) == ANSWER


def test_a_pause_of_more_than_a_second_ends_the_frame(device):
    with serial.Serial(str(device.link), 19200) as port:
        port.reset_input_buffer()
        port.write(READ[:8])
        time.sleep(0.7)
        port.write(READ[8:])
        port.timeout = 5
        assert port.read_until(b"\n") == ANSWER
        port.write(READ[:8])
        time.sleep(1.5)
        assert raw(port, READ[8:], 0.3) == b""
        assert raw(port, READ) == ANSWER


@pytest.mark.parametrize(
    "variables, says",
    [
        ({"MODE": "tcp"}, "MODE=tcp: must be rtu or ascii"),
        ({"MODE": "ascii", "DATA_BITS": "6"}, "DATA_BITS=6: must be 7 or 8"),
        ({"MODE": "ascii", "TCP": "5020"}, "TCP: needs MODE=rtu"),
        ({"DATA_BITS": "7"}, "DATA_BITS=7: RTU mode has characters of 8 bits"),
        ({"MODE": "ascii", "DEVICE": "pdm"}, "MODE=ascii: the PDM meter has RTU mode alone, leave DEVICE=pdm out"),
        (
            {"MODE": "ascii", "MAP": "examples/relay_box/relay_box.yaml"},
            "MODE: a device of a map file has RTU mode alone, leave MODE and DATA_BITS out",
        ),
    ],
)
def test_bad_variables_are_refused(tmp_path, variables, says):
    assert refuse(LINK=tmp_path / "bus", **variables) == (2, [f"serve: {says}"])
