# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/host_library.md: every call of modbus_rtu.dll V3.3 against the live device, by frame; the helpers by value."""

import asyncio
import contextlib
import ctypes
import ctypes.util
import itertools
import json
import re
import shutil
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import minimalmodbus
import pytest
from harness.volume import volume
from pymodbus.client import AsyncModbusSerialClient, ModbusSerialClient

from live.host_calls import CALLS, DATA, INIT, ORDER
from live.serve import ROOT, Serve

PAGE = ROOT / "docs" / "host_library.md"
NODE = 17
ROW = re.compile(r"^\| `(\w+\([^|]*\))` \| ((?:[0-9A-F]{2}[ ,]*)+)\| ([^|]*) \|$", re.M)
PORTS, STARTED_AT_ONCE = 32, 4
POLLED = 8  # registers of a poll


@pytest.fixture(scope="module")
def device(tmp_path_factory):
    """The device with the contents of the page."""
    folder = tmp_path_factory.mktemp("host")
    (folder / "init.json").write_text(json.dumps(INIT), encoding="utf-8")
    with Serve(folder / "bus", INIT=folder / "init.json") as running:
        yield running


class Traced:
    """A pymodbus client that keeps what goes over the line: [(sending, bytes)]."""

    def __init__(self, device):
        self.frames = []
        self.client = ModbusSerialClient(
            str(device.link), baudrate=19200, parity="N", timeout=3, trace_packet=self.note
        )
        assert self.client.connect()

    def note(self, sending, data):
        if sending or not self.frames or self.frames[-1][0]:
            self.frames.append((sending, b""))
        self.frames[-1] = (sending, data if sending else max(self.frames[-1][1], data, key=len))
        return data

    def text(self):
        """Requests and answers in the order of the line, as the page writes them."""
        return ", ".join(data.hex(" ").upper() for _, data in self.frames)


@pytest.fixture
def traced(device):
    made = Traced(device)
    yield made
    made.client.close()


def rows():
    """{call: (frames of the call itself, what it gives)} of the page."""
    return {
        call: (frames.strip(" `"), gives.strip(" `")) for call, frames, gives in ROW.findall(PAGE.read_text("utf-8"))
    }


@pytest.mark.parametrize("call", CALLS)
def test_call(traced, call):
    """The frames are those of the page; what a writing call has written is read back."""
    does, gives = CALLS[call]
    found = does(traced.client, NODE)
    assert found == gives, f"{call} gave {found}"
    frames = traced.text()
    assert call in rows(), f"docs/host_library.md lacks | `{call}` | `{frames}` | `{gives}` |"
    assert frames.startswith(rows()[call][0]), f"{call}: the line carried {frames}"
    assert rows()[call][1] == str(gives)


def test_every_row_is_a_call():
    assert set(rows()) == set(CALLS)


def test_port_is_opened_asked_and_closed(device):
    """mbrtuComOpen, mbrtuComTrue, mbrtuComWork, mbrtuComClose."""
    client = ModbusSerialClient(str(device.link), baudrate=19200, bytesize=8, parity="N", stopbits=1, timeout=5)
    assert not client.connected
    assert client.connect() and client.connected and client.is_socket_open()
    assert client.read_coils(19, count=1, device_id=NODE).bits[0]
    client.close()
    assert not client.connected


def test_delay_is_between_requests(traced):
    """mbrtuSetDelay: the host waits before each request; the device does not care how long."""
    moments = []
    for _ in range(3):
        time.sleep(0.05)
        moments.append(time.monotonic())
        assert not traced.client.read_coils(19, count=1, device_id=NODE).isError()
    assert all(later - earlier >= 0.05 for earlier, later in itertools.pairwise(moments))


def test_buffered_calls(device):
    """Requests run in the background into a buffer, from which the program reads later; writes leave a buffer likewise.

    mbrtuClearBuf, mbrtufcn01Buf to 04Buf, 03DIntBuf, 04DIntBuf, 03FloatBuf, 04FloatBuf, mbrtuIntDllBufRead,
    mbrtuFloatDllBufRead; mbrtuWriteIntDllBuf, mbrtuWriteFloatDllBuf, 15Buf, 16Buf, 16DIntBuf, 16FloatBuf.
    """
    convert = ModbusSerialClient.convert_from_registers
    back = ModbusSerialClient.convert_to_registers

    async def played():
        client = AsyncModbusSerialClient(str(device.link), baudrate=19200, parity="N", timeout=3)
        assert await client.connect()
        buffer = {}  # mbrtuClearBuf

        async def fill(name, request, kind=None, regular=0):
            answer = await request
            assert not answer.isError(), answer
            values = answer.bits if name in ("01", "02") else answer.registers
            buffer[name] = convert(values, kind, word_order=ORDER[regular]) if kind else values

        reads = {
            "01": (client.read_coils(19, count=8, device_id=NODE),),
            "02": (client.read_discrete_inputs(196, count=6, device_id=NODE),),
            "03": (client.read_holding_registers(107, count=3, device_id=NODE),),
            "04": (client.read_input_registers(8, count=2, device_id=NODE),),
            "03DInt": (client.read_holding_registers(122, count=2, device_id=NODE), DATA.INT32, 1),
            "04DInt": (client.read_input_registers(20, count=2, device_id=NODE), DATA.INT32),
            "03Float": (client.read_holding_registers(124, count=2, device_id=NODE), DATA.FLOAT32),
            "04Float": (client.read_input_registers(26, count=2, device_id=NODE), DATA.FLOAT32, 1),
        }
        tasks = [asyncio.create_task(fill(name, *request)) for name, request in reads.items()]
        assert buffer == {}, "a buffered call waits for nothing"
        await asyncio.gather(*tasks)
        assert [int(bit) for bit in buffer["01"][:8]] == [1, 0, 1, 1, 0, 0, 1, 1]
        assert [int(bit) for bit in buffer["02"][:6]] == [0, 0, 1, 1, 0, 1]
        assert (buffer["03"], buffer["04"]) == ([555, 0, 100], [10, 65535])
        assert (buffer["03DInt"], buffer["04DInt"], buffer["03Float"], buffer["04Float"]) == (-2, -2, 1.0, 1.0)
        buffer = {"bits": [True, False, True], "ints": [7, 8], "long": -70000, "float": -2.5}  # mbrtuWrite...DllBuf
        answers = await asyncio.gather(
            client.write_coils(60, buffer["bits"], device_id=NODE),
            client.write_registers(170, buffer["ints"], device_id=NODE),
            client.write_registers(172, back(buffer["long"], DATA.INT32, word_order="little"), device_id=NODE),
            client.write_registers(174, back(buffer["float"], DATA.FLOAT32), device_id=NODE),
        )
        assert not any(answer.isError() for answer in answers)
        found = (await client.read_holding_registers(170, count=6, device_id=NODE)).registers
        client.close()
        return found

    found = asyncio.run(played())
    assert found == [7, 8, 0xEE90, 0xFFFE, 0xC020, 0x0000]


def test_minimalmodbus_reads_and_writes_both_word_orders(device):
    """The second client library: 32 bits and floats, the low word first as well."""
    instrument = minimalmodbus.Instrument(str(device.link), NODE)
    instrument.serial.baudrate, instrument.serial.timeout = 19200, 5
    swapped = minimalmodbus.BYTEORDER_LITTLE_SWAP
    assert instrument.read_long(120, signed=True) == -2
    assert instrument.read_long(122, signed=True, byteorder=swapped) == -2
    assert instrument.read_float(124) == 1.0
    assert instrument.read_float(126, byteorder=swapped) == 1.0
    instrument.write_long(180, -2, signed=True, byteorder=swapped)
    instrument.write_float(182, 1.0, byteorder=swapped)
    assert instrument.read_registers(180, 4) == [0xFFFE, 0xFFFF, 0, 0x3F80]
    instrument.serial.close()


def test_libmodbus_does_the_same_calls(device):
    """A library in C, the one of mbpoll: the eight standard calls and floats in both word orders."""
    name = ctypes.util.find_library("modbus")
    if not name:
        pytest.skip("libmodbus is not installed")
    lib = ctypes.CDLL(name)
    lib.modbus_new_rtu.restype = ctypes.c_void_p
    lib.modbus_new_rtu.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_char, ctypes.c_int, ctypes.c_int]
    context = ctypes.c_void_p(lib.modbus_new_rtu(str(device.link).encode(), 19200, b"N", 8, 1))
    assert context.value and lib.modbus_set_slave(context, NODE) == 0 and lib.modbus_connect(context) == 0
    try:
        some, few = (ctypes.c_uint8 * 8)(), (ctypes.c_uint16 * 4)()
        assert lib.modbus_read_bits(context, 19, 8, some) == 8 and list(some) == [1, 0, 1, 1, 0, 0, 1, 1]
        assert lib.modbus_read_input_bits(context, 196, 6, some) == 6 and list(some)[:6] == [0, 0, 1, 1, 0, 1]
        assert lib.modbus_read_registers(context, 107, 3, few) == 3 and list(few)[:3] == [555, 0, 100]
        assert lib.modbus_read_input_registers(context, 8, 2, few) == 2 and list(few)[:2] == [10, 65535]
        assert lib.modbus_write_bit(context, 70, 1) == 1
        assert lib.modbus_write_register(context, 190, 555) == 1
        assert lib.modbus_write_bits(context, 71, 3, (ctypes.c_uint8 * 3)(1, 0, 1)) == 3
        assert lib.modbus_read_bits(context, 70, 4, some) == 4 and list(some)[:4] == [1, 1, 0, 1]
        helpers = {}
        exec(block("python"), helpers)  # not modbus_set_float_abcd: see the page
        high, low = helpers["float32_high"](1.0), helpers["float32_low"](1.0)
        for at, pair in ((191, (high, low)), (193, (low, high))):
            assert lib.modbus_write_registers(context, at, 2, (ctypes.c_uint16 * 2)(*pair)) == 2
        assert lib.modbus_read_registers(context, 191, 4, few) == 4 and list(few) == [0x3F80, 0, 0, 0x3F80]
    finally:
        lib.modbus_close(context)
        lib.modbus_free(context)


# ------------------------------------------------------------------ the helpers, as the page gives them


def block(kind):
    return re.search(rf"^```{kind}\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)[1]


def test_helpers_in_python():
    """DecBitBin, Int32ToInt_16h and _16l, Int16ToInt32, Float32ToInt_16h and _16l, Int16ToFloat32, by value."""
    names = {}
    exec(block("python"), names)  # the page's own text
    assert [names["dec_bit_bin"](0b1010, bit) for bit in range(4)] == [0, 1, 0, 1]
    assert (names["int32_high"](-2), names["int32_low"](-2)) == (0xFFFF, 0xFFFE)
    assert (names["int32_high"](70000), names["int32_low"](70000)) == (1, 4464)
    assert names["to_int32"](0xFFFF, 0xFFFE) == -2 and names["to_int32"](-1, -2) == -2
    assert (names["float32_high"](1.0), names["float32_low"](1.0)) == (0x3F80, 0)
    assert names["to_float32"](0x3F80, 0) == 1.0 and names["to_float32"](-16352, 0) == -2.5
    assert names["words"](0x12345678, 0) == [0x1234, 0x5678] and names["words"](0x12345678, 1) == [0x5678, 0x1234]


def test_helpers_in_c(tmp_path):
    """The same in C: no warning of gcc, and the same values."""
    if not shutil.which("gcc"):
        pytest.skip("gcc is not installed")
    source = tmp_path / "helpers.c"
    source.write_text(
        block("c")
        + """
#include <assert.h>
int main(void)
{
  uint16_t pair[2];
  assert(dec_bit_bin(10, 1) == 1 && dec_bit_bin(10, 2) == 0);
  assert(int32_high(-2) == 0xFFFF && int32_low(-2) == 0xFFFE && int32_low(70000) == 4464);
  assert(to_int32(0xFFFF, 0xFFFE) == -2 && to_int32(1, 4464) == 70000);
  assert(float32_high(1.0f) == 0x3F80 && float32_low(1.0f) == 0);
  assert(to_float32(0x3F80, 0) == 1.0f && to_float32(0xC020, 0) == -2.5f);
  put_words(0x12345678u, 1, pair);
  assert(pair[0] == 0x5678 && pair[1] == 0x1234 && get_words(pair, 1) == 0x12345678u);
  put_words(0x12345678u, 0, pair);
  assert(pair[0] == 0x1234 && get_words(pair, 0) == 0x12345678u);
  return 0;
}
""",
        encoding="utf-8",
    )
    strict = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror".split()
    subprocess.run(["gcc", *strict, source, "-o", tmp_path / "helpers"], check=True)
    subprocess.run([tmp_path / "helpers"], check=True)


# ------------------------------------------------------------------ the headline: 32 ports at once


def test_thirty_two_ports_are_polled_at_once(tmp_path):
    """32 devices at 19200 baud, a thread and a port for each: every request is answered, and rightly."""
    seconds = volume("seconds that 32 live devices are polled")
    devices = []
    for number in range(PORTS):
        init = tmp_path / f"init{number}.json"
        init.write_text(json.dumps({"holdings": {"0": [number * 256 + k for k in range(POLLED)]}}), encoding="utf-8")
        devices.append(Serve(tmp_path / f"port{number}", INIT=init))
    with contextlib.ExitStack() as running:
        running.enter_context(devices[0])  # it compiles the model
        with ThreadPoolExecutor(STARTED_AT_ONCE) as pool:
            for one in pool.map(Serve.__enter__, devices[1:]):
                running.push(one)
        polls, wrong = [0] * PORTS, []
        begin, end = threading.Barrier(PORTS + 1), []

        def poll(number):
            client = ModbusSerialClient(str(devices[number].link), baudrate=19200, parity="N", timeout=5, retries=0)
            try:
                assert client.connect()
                begin.wait()
                while time.monotonic() < end[0]:
                    answer = client.read_holding_registers(0, count=POLLED, device_id=NODE)
                    if answer.isError() or answer.registers != [number * 256 + k for k in range(POLLED)]:
                        wrong.append(f"port {number}, poll {polls[number]}: {answer}")
                        return
                    polls[number] += 1
            except Exception as problem:
                wrong.append(f"port {number}, poll {polls[number]}: {problem!r}")
            finally:
                client.close()

        threads = [threading.Thread(target=poll, args=(number,), daemon=True) for number in range(PORTS)]
        for thread in threads:
            thread.start()
        end.append(time.monotonic() + seconds)
        begin.wait(30)
        for thread in threads:
            thread.join(seconds + 30)
        assert not wrong, "\n".join(wrong[:5])
        assert min(polls) > 0, f"polls of each port: {polls}"
        print(f"{sum(polls)} polls of {PORTS} ports in {seconds} s, {min(polls)} to {max(polls)} a port")
