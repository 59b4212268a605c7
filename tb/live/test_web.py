# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The control interface of a live device: what it does, what it refuses, and that the line goes on whatever is asked.

FULL=1: 100,000 frames instead of 600 in the test of memory, and longer measurements.
"""

import asyncio
import contextlib
import json
import os
import socket
import statistics
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import aiohttp
import pytest
import serial
from conftest import FULL
from harness.volume import volume
from live_client import Live, LiveError
from protocol import frames

from .serve import ROOT, free_port
from .timing import Watch
from .web import Device

ADDRESS, BAUD = 17, 115200
MAP = "examples/relay_box/relay_box.yaml"
SCRIPT = """
import math

INTERVAL = 0.05
seen = []

def step(t, registers):
    registers.inputs[0] = 1000 + round(100 * math.sin(t))
    registers.inputs[1:4] = seen[-1][2][:3] if seen else [0, 0, 0]

def written(t, registers, table, first, values):
    seen.append((table, first, values + [0, 0, 0]))
"""


@pytest.fixture(scope="module")
def device(tmp_path_factory):
    """A fast device with everything on."""
    folder = tmp_path_factory.mktemp("web")
    (folder / "script.py").write_text(SCRIPT)
    with Device(folder, BAUD=BAUD, LOG=1, SCRIPT=folder / "script.py") as made:
        yield made


@contextlib.contextmanager
def master(device):
    """The device's terminal."""
    with serial.Serial(str(device.link), BAUD, timeout=5) as port:
        port.reset_input_buffer()
        yield port


def ask(port, pdu, count, to=ADDRESS):
    """A request and so many bytes of its answer."""
    port.write(frames.adu(to, pdu))
    return port.read(count)


def alive(device):
    """A read through the line is answered."""
    with master(device) as port:
        got = ask(port, frames.read(3, 0, 1), 7)
    return len(got) == 7 and got[:3] == bytes([ADDRESS, 3, 2])


# ---------------------------------------------------------------------- what it does


def test_tables_by_address(device):
    """Both ways, seen from the line too."""
    live = device.client
    live.write("holdings", 100, [1, 2, 65535])
    live.write("discretes", 7, [1, 0, 1])
    assert live.read("holdings", 99, 5) == [0, 1, 2, 65535, 0] and live.read("discretes", 7, 3) == [1, 0, 1]
    live.write("files", 256, [5])
    assert live.read("files", 256) == [5]
    with master(device) as port:
        assert ask(port, frames.read(3, 100, 3), 11)[3:-2] == bytes([0, 1, 0, 2, 255, 255])


def test_write_of_the_master_is_an_event(device):
    """On the WebSocket, in the log, and the script has seen it."""

    async def play():
        async with aiohttp.ClientSession() as session, session.ws_connect(f"{device.url}/api/events") as ws:
            await ws.send_json({"id": 1, "op": "device"})
            first = await ws.receive_json()
            assert first["id"] == 1 and first["result"]["address"] == ADDRESS

            def write():
                with master(device) as port:
                    return ask(port, frames.write_registers(200, [7, 8, 9]), 8)

            answer = await asyncio.to_thread(write)
            assert len(answer) == 8
            while True:
                event = await asyncio.wait_for(ws.receive_json(), 5)
                if event.get("event") == "write":
                    return event

    event = asyncio.run(play())
    assert event["table"] == "holdings" and event["first"] == 200 and event["values"] == [7, 8, 9]
    device.until(lambda: device.client.read("inputs", 1, 3) == [7, 8, 9], "the script has not seen the write")
    assert "written: holdings 200 = 7, 8, 9" in device.said()


def test_state_counters_and_log(device):
    """Busy is exception 06; counters and log tell of it."""
    live = device.client
    before = live.status()
    assert live.state(busy=1, exception_status=0x6D)["busy"] == 1
    with master(device) as port:
        assert ask(port, frames.read(3, 0, 1), 5)[1:3] == bytes([0x83, 6])
        assert ask(port, frames.bare(7), 5)[2] == 0x6D
    assert live.state(busy=0)["busy"] == 0
    after = live.status()
    assert after["counters"]["busy"] == before["counters"]["busy"] + 1
    assert after["counters"]["bus_message"] == before["counters"]["bus_message"] + 2
    assert any("busy" in line for line in after["story"])


def test_silence_has_its_reason(device):
    """Frame log, log on the terminal, and the pins of the frame."""
    live = device.client
    last = max((f["n"] for f in live.frames()), default=0)
    live.fault("gap", character=2, amount=12)  # 1.15 ms: t1.5 is 0.75, t3.5 1.75
    assert live.send(frames.adu(ADDRESS, frames.read(3, 0, 1)).hex()) == ""
    found = live.frames(after=last)[-1]
    assert found["silence"]["verdict"] == "gap" and "t1.5" in found["silence"]["words"]
    assert "gap" in found["injected"]
    pins = live.pins(found["n"])
    assert pins["characters"][2]["start"] - pins["characters"][1]["start"] > 12.9 * pins["length"] * pins["bit_time"]
    assert any(row[1] >> 2 == 0 for row in pins["edges"])
    assert "no answer: a gap above t1.5 inside the frame" in device.said()


def test_fault_each_third_frame(device):
    """And a list of what is set; removing it ends it."""
    live = device.client
    number = live.fault("wrong_crc", every=3)
    answers = [live.send(frames.adu(ADDRESS, frames.read(3, 0, 1)).hex()) != "" for _ in range(6)]
    assert answers.count(False) == 2
    (row,) = [f for f in live.ask("GET", "/api/faults")["faults"] if f["fault"] == number]
    assert row["kind"] == "wrong_crc" and row["done"] == 2
    live.unfault(number)
    assert not live.ask("GET", "/api/faults")["faults"]


def test_signal_moves_a_register(device):
    """Seen by the master; taken away, it stands."""
    live = device.client
    live.attach("inputs 20", "counter", period=0.1)
    device.until(lambda: live.read("inputs", 20)[0] >= 3, "the counter stands")
    live.ask("DELETE", "/api/signals/inputs 20")
    time.sleep(0.2)
    stands = live.read("inputs", 20)
    time.sleep(0.3)
    assert live.read("inputs", 20) == stands


def test_captures_and_document(device):
    """Files of each kind, and the OpenAPI document."""
    live = device.client
    assert alive(device)
    assert live.capture("pcapng")[:4] == b"\x0a\x0d\x0d\x0a" and b"read holding" in live.capture("txt")
    assert len(live.capture("fst")) > 100
    document = live.ask("GET", "/openapi.json")
    assert document["openapi"].startswith("3.1") and "/api/tables/{table}" in document["paths"]


# ---------------------------------------------------------------------- what it refuses


@pytest.mark.parametrize(
    "method, path, body, text",
    [
        ("GET", "/api/tables/coils?first=1024", None, "1024"),
        ("GET", "/api/tables/nothing", None, "table: must be"),
        ("GET", "/api/tables/coils?first=x", None, "first"),
        ("GET", "/api/tables/coils?frist=0", None, "frist"),
        ("PUT", "/api/tables/holdings/0", {"values": ["1"]}, "values"),
        ("PUT", "/api/tables/holdings/0", {"values": [70000]}, "values"),
        ("PUT", "/api/tables/coils/0", {"values": [2]}, "0 to 1"),
        ("PUT", "/api/tables/holdings/0", {"values": [1], "table": "coils"}, "path"),
        ("PUT", "/api/tables/holdings/0", [1], "object"),
        ("PATCH", "/api/state", {"busy": "on"}, "busy"),
        ("PATCH", "/api/state", {}, "nothing"),
        ("POST", "/api/faults", {"kind": "rain"}, "rain"),
        ("POST", "/api/faults", {"kind": "flip", "bit": 9}, "bit"),
        ("POST", "/api/faults", {"kind": "flip", "bit\nget 1": 1}, "bit"),
        ("POST", "/api/faults", {"kind": "flip\n1 unfault all"}, "kind"),
        ("POST", "/api/send", {"hex": "0"}, "hex"),
        ("POST", "/api/signals", {"point": "inputs 0", "kind": "sine", "period": 0}, "period"),
        ("POST", "/api/signals", {"point": "inputs 9999", "kind": "sine"}, "9999"),
        ("POST", "/api/signals", {"point": "../../etc/passwd", "kind": "sine"}, "point"),
        ("GET", "/api/points/temperature", None, "no map"),
        ("GET", "/api/frames/0/pins", None, "not kept"),
        ("DELETE", "/api/faults/soon", None, "number"),
        ("GET", "/../serve.py", None, "Not Found"),
        ("GET", "/panel/%2e%2e/server/web.py", None, "Not Found"),
        ("DELETE", "/api/state", None, "Not Allowed"),
    ],
)
def test_bad_request_has_a_clear_error(device, method, path, body, text):
    """Status 4xx, one line that names what is wrong."""
    request = urllib.request.Request(
        device.url + path, None if body is None else json.dumps(body).encode(), method=method
    )
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(request, timeout=10)
    said = json.loads(caught.value.read())["error"]
    assert 400 <= caught.value.code < 500 and text in said and "\n" not in said, said


def raw(device, data):
    """The first line of the answer to bytes on the port."""
    with socket.create_connection(("127.0.0.1", device.port), timeout=10) as made:
        made.sendall(data)
        return made.recv(200).split(b"\r\n")[0]


def test_rubbish_and_huge_bodies(device):
    """No HTTP, a header without end, a body of a gigabyte that is only announced, and one that comes."""
    assert b"400" in raw(device, b"\x16\x03\x01\x02\x00\x01rubbish\r\n\r\n")
    assert b"400" in raw(device, b"GET / HTTP/1.1\r\n" + b"A: " + b"x" * 20000 + b"\r\n\r\n")
    head = b"PUT /api/tables/coils/0 HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000\r\n\r\n"
    assert b"413" in raw(device, head + b"x" * 100_000)
    with pytest.raises(LiveError, match="bytes"):
        device.client.ask("PUT", "/api/tables/coils/0", {"values": "1" * 100_000})
    with pytest.raises(LiveError, match="JSON"):
        device.client.ask("PUT", "/api/tables/coils/0", float("nan")) or pytest.fail()
    assert alive(device)


@pytest.mark.parametrize("header", ["Origin: http://elsewhere.example", "Host: elsewhere.example"])
def test_pages_of_other_places_are_refused(device, header):
    """A web page that the user happens to have open must not reach the device, by WebSocket either."""
    host = "" if header.startswith("Host") else f"Host: 127.0.0.1:{device.port}\r\n"
    upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    upgrade += "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
    for more in ("", upgrade):
        answer = raw(device, f"GET /api/events HTTP/1.1\r\n{host}{header}\r\n{more}\r\n".encode())
        assert b"403" in answer, answer


def test_bad_messages_on_the_websocket(device):
    """Each gets an error, the socket stays."""

    async def play():
        said = []
        async with aiohttp.ClientSession() as session, session.ws_connect(f"{device.url}/api/events") as ws:
            for text in ("rubbish", "[]", "{}", '{"id": {}, "op": "read"}', '{"id": 5, "op": "fly"}', "[" * 5000):
                await ws.send_str(text)
            await ws.send_json({"id": 9, "op": "read", "table": "coils", "first": 0})
            while True:
                message = await asyncio.wait_for(ws.receive_json(), 5)
                if "error" in message:
                    said.append(message["error"])
                if message.get("id") == 9:
                    return said, message

    said, last = asyncio.run(play())
    assert len(said) == 6 and last["result"] == {"values": [0]}


def test_many_connections(device):
    """Those beyond the limit are told; afterwards all is as before."""
    made = []
    try:
        refused = 0
        for _ in range(volume("connections at once")):
            one = socket.create_connection(("127.0.0.1", device.port), timeout=10)
            made.append(one)
        assert alive(device)
        for one in made[-20:]:
            one.settimeout(5)
            with contextlib.suppress(OSError):
                refused += b"503" in one.recv(100)
        assert refused == 20
    finally:
        for one in made:
            one.close()
    device.until(lambda: quiet(device), "the server does not come back")
    assert alive(device)


def quiet(device):
    """True if a request is answered again."""
    try:
        return bool(device.client.device())
    except (LiveError, OSError):
        return False


def test_nothing_listens_beyond_the_loopback(device):
    """The port is that of 127.0.0.1 alone."""
    rows = [line.split() for line in open("/proc/net/tcp")][1:]
    places = {row[1].split(":")[0] for row in rows if row[3] == "0A" and int(row[1].split(":")[1], 16) == device.port}
    assert places == {"0100007F"}
    six = [line.split() for line in open("/proc/net/tcp6")][1:]
    assert not [row for row in six if row[3] == "0A" and int(row[1].split(":")[1], 16) == device.port]


# ---------------------------------------------------------------------- scripts that misbehave


@pytest.mark.parametrize(
    "text, said",
    [
        ("def step(t, registers):\n    1 / 0\n", "line 2: ZeroDivisionError"),
        ("def step(t, registers):\n    registers.inputs[99999] = 1\n", "99999"),
        ("def step(t, registers):\n    registers.coils[0] = 7\n", "values"),
        ("def step(t, registers):\n    registers['temperature'] = 7\n", "no point"),
        ("def step(t, registers:\n", "line 1"),
        ("x = 1\n", "no function step"),
        ("import sys\ndef step(t, registers):\n    sys.exit(3)\n", "SystemExit"),
        ("import os\ndef step(t, registers):\n    os._exit(3)\n", "ended by itself"),
        ("def step(t, registers):\n    while True: pass\n", "did not return"),
    ],
)
def test_script_that_fails(device, text, said):
    """One line on the terminal, the reason in the panel, and the line goes on; a mended file starts again."""
    path = device.variables["SCRIPT"]
    path.write_text(text)
    try:
        device.until(lambda: said in (script(device)["error"] or ""), f"no {said}")
        assert said in device.said()
        assert alive(device)
    finally:
        path.write_text(SCRIPT)
    device.until(lambda: not script(device)["error"] and script(device)["calls"], "the script does not start again")


def script(device):
    """The state of the script."""
    return device.client.ask("GET", "/api/signals")["script"]


# ---------------------------------------------------------------------- a device of a map


def test_points_by_name(tmp_path):
    """Values with their units, a moving sensor, a write of the master by name, SIGNALS and LOG without WEB's help."""
    signals = tmp_path / "signals.json"
    (tmp_path / "door.csv").write_text("0,0\n0.2,1\n0.4,0\n")
    signals.write_text(json.dumps({"temperature": {"kind": "sine", "mean": 21.5, "amplitude": 0},
                                   "door_open": {"kind": "csv", "csv": "door.csv"}}))  # fmt: skip
    with Device(tmp_path, MAP=MAP, SIGNALS=signals, LOG=1) as made:
        live = made.client
        assert live["temperature"] == 21.5 and live.ask("GET", "/api/points/temperature")["text"] == "21.5 °C"
        made.until(lambda: live["door_open"] is True, "the door stays closed")
        answer = live.send(frames.adu(ADDRESS, frames.read(4, 0, 1)).hex())
        assert bytes.fromhex(answer)[3:5] == (215).to_bytes(2, "big")
        live.send(frames.adu(ADDRESS, frames.write_register(0, 300)).hex())
        assert live["limit"] == 30.0
        made.until(lambda: "written: limit = 30 °C" in made.said(), "no write by name in the log")
        assert "(limit)" in made.said() and "(temperature 21.5 °C)" in made.said()
        for name, value, text in (("temperature", "hot", "no i16"), ("limit", 1, "master"), ("nix", 1, "no point")):
            with pytest.raises(LiveError, match=text):
                live[name] = value
        with pytest.raises(LiveError, match="by name"):
            live.write("inputs", 0, [1])


def test_several_slaves_on_one_line(tmp_path):
    """Each has its own tables, state and counters; Modbus TCP comes in beside."""
    tcp = free_port()
    with Device(tmp_path, SLAVES="17,18", BAUD=BAUD, TCP=tcp) as made:
        live = made.client
        live.write("holdings", 0, [7])
        assert live.ask("GET", "/api/tables/holdings", slave=18)["values"] == [0]
        assert live.device()["slaves"] == [17, 18]
        got = bytes.fromhex(live.send(frames.adu(17, frames.read(3, 0, 1)).hex()))
        other = bytes.fromhex(live.send(frames.adu(18, frames.read(3, 0, 1)).hex()))
        assert (got[3:5], other[3:5]) == (bytes([0, 7]), bytes([0, 0]))
        assert live.send(frames.adu(19, frames.read(3, 0, 1)).hex()) == ""
        assert live.frames()[-1]["silence"]["words"] == "for slave 19, there are 17, 18"
        with pytest.raises(LiveError, match="slave 19: there are 17, 18"):
            live.ask("GET", "/api/status", slave=19)
        with socket.create_connection(("127.0.0.1", tcp), timeout=5) as gate:
            gate.sendall(bytes([0, 1, 0, 0, 0, 6, 17]) + frames.read(3, 0, 1))
            assert gate.recv(100) == bytes([0, 1, 0, 0, 0, 5, 17, 3, 2, 0, 7])


def test_without_web_nothing_is_started(tmp_path):
    """The device alone has no child, and listens nowhere."""
    with Device(tmp_path, web=False, BAUD=BAUD) as made:
        assert not Path(f"/proc/{made.process.pid}/task/{made.process.pid}/children").read_text().split()
        opened = [os.readlink(one) for one in Path(f"/proc/{made.process.pid}/fd").iterdir()]
        assert not [one for one in opened if one.startswith("socket:")], opened


def test_log_without_web_needs_no_package(tmp_path):
    """LOG alone: the standard library does, and nothing listens."""
    with Device(tmp_path, web=False, LOG=1, BAUD=BAUD) as made:
        port = serial.Serial(str(made.link), BAUD, timeout=5)
        assert len(ask(port, frames.read(3, 0, 1), 7)) == 7
        port.close()
        made.until(lambda: "read holding register 0" in made.said(), "no line in the log")
        modules = "import sys; sys.path[:0] = ['sim', 'tb']; import control_server; " \
                  "print([m for m in ('aiohttp', 'pylibfst', 'pydantic') if m in sys.modules])"  # fmt: skip
        done = subprocess.run([sys.executable, "-c", modules], cwd=ROOT, capture_output=True, text=True, check=True)
        assert done.stdout == "[]\n"


# ---------------------------------------------------------------------- the line does not feel it


ROUND = 25  # answers
PANELS = 10
MOST_LATE_MS = 2


def late_ms(port, count):
    """How late answers are beyond what the line takes, in ms."""
    request, out = frames.adu(ADDRESS, frames.read(3, 0, 10)), []
    line = (len(request) + 25) * 11 / BAUD + 2 * 1.75e-3
    for _ in range(count):
        begin = time.monotonic()
        port.write(request)
        got = port.read(25)
        out.append((time.monotonic() - begin - line) * 1000)
        assert len(got) == 25, got
    return out


@contextlib.contextmanager
def panels(device):
    """Panels that are open, in a process of their own; how many messages each got, when they are closed."""
    got = []
    command = [sys.executable, str(Path(__file__).with_name("panels.py")), device.url, str(PANELS)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "open\n"
        yield got
        process.stdin.close()
        got += json.loads(process.stdout.readline())


def resident_mb(pid):
    """Memory of a process."""
    for line in open(f"/proc/{pid}/status"):
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    raise AssertionError("no VmRSS")


def test_ten_panels_script_and_log_cost_no_time_and_no_memory(device, record_property):
    """Median under 2 ms beyond the line's own time, and no growth over many frames.

    The bound is the device's, not the scheduler's: where other things keep the machine busy, the quietest rounds count.
    """
    count = 50_000 if FULL else 500
    last = max((f["n"] for f in device.client.frames()), default=0)
    with master(device) as port, Watch() as watch:
        alone = sorted(statistics.median(late_ms(port, ROUND)) for _ in range(4))
        with panels(device) as got:
            late_ms(port, 1200 if FULL else 50)  # the frames that are kept fill up
            before = resident_mb(device.server()), resident_mb(device.process.pid)
            rounds = sorted(statistics.median(late_ms(port, ROUND)) for _ in range(count // ROUND))
            after = resident_mb(device.server()), resident_mb(device.process.pid)
            device.until(
                lambda: device.client.frames()[-1]["n"] >= last + 2 * count, "the server has not caught up", 60
            )
    status = device.client.status()["stats"]
    lags = [f["late_ms"] for f in device.client.frames(limit=2000) if f["direction"] == "answer"]
    quiet, typical = rounds[len(rounds) // 4], statistics.median(rounds)
    text = (
        f"{PANELS} panels: answers {quiet:.2f} ms late in quiet rounds, {typical:.2f} in all; alone {alone[0]:.2f} to "
    )
    text += f"{alone[-1]:.2f}; the simulation lags {statistics.median(lags):.2f} ms; {2 * count} frames, "
    text += f"server {before[0]:.0f} to {after[0]:.0f} MB, bridge {before[1]:.1f} to {after[1]:.1f} MB"
    text += f"; {watch}"
    record_property("figures", [text])
    assert quiet < watch.bound(MOST_LATE_MS, 1000), text
    assert len(got) == PANELS and min(got) > count, got
    assert after[0] - before[0] < 40 and after[1] - before[1] < 8, text
    assert status["dropped"] == 0, status


def test_python_client_of_a_few_lines(device):
    """What the document of live_client.py shows."""
    live = Live(device.url)
    live.write("inputs", 30, [215])
    live.fault("wrong_crc")
    live.send(frames.adu(ADDRESS, frames.read(4, 30, 1)).hex())
    assert any(frame.get("silence", {}).get("words") == "wrong CRC" for frame in live.frames())
    with pytest.raises(LiveError, match="refused"):
        Live("http://127.0.0.1:1").device()
