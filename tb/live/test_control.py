# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The control channel of the bridge: every table and input, the log of the line; the line never waits for it."""

import json
import statistics
import threading
import time

import pytest
from protocol import frames
from protocol.defs import EX, FC, Space, Sub

from live.controlled import Controlled, Refused
from live.serve import ROOT, Port, request
from live.timing import Watch

READ = request(frames.read(FC.READ_HOLDINGS, 0, 10))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links and INIT files of this module live."""
    return tmp_path_factory.mktemp("control")


@pytest.fixture(scope="module")
def device(folder):
    """The reference device."""
    with Controlled(folder / "bus") as running:
        yield running


@pytest.fixture(autouse=True)
def fresh(device):
    """No events of the test before."""
    device.call("pins", "on")
    device.events.clear()


def ask(device, pdu, address=17):
    """The PDU of the answer, or None."""
    answer, _ = device.send(request(pdu, address))
    return answer[1:-2] if answer else None


def test_hello_says_what_line_it_is(device):
    hello = device.hello
    assert (hello["baud"], hello["format"], hello["slaves"], hello["link"]) == (19200, 0, [17], str(device.link))
    assert hello["clock_hz"] == hello["bit_time"] * hello["baud"]
    assert hello["t35"] == 3.5 * 11 * hello["bit_time"] and hello["t15"] == 1.5 * 11 * hello["bit_time"]


@pytest.mark.parametrize("space,code,values", [
    (Space.COILS, FC.READ_COILS, [1, 0, 1, 1, 0, 0, 1, 1, 1]),
    (Space.DISCRETES, FC.READ_DISCRETES, [0, 1, 1]),
    (Space.INPUTS, FC.READ_INPUTS, [1, 65535, 4660]),
    (Space.HOLDINGS, FC.READ_HOLDINGS, [0, 43690, 21845]),
])  # fmt: skip
def test_tables_are_written_and_read_from_both_sides(device, space, code, values):
    first = 100
    assert device.call("write", 17, int(space), first, *values)["written"] == len(values)
    assert device.read(space, first, len(values), 17) == values
    body = ask(device, frames.read(code, first, len(values)))[2:]
    bits = space in (Space.COILS, Space.DISCRETES)
    assert body == (frames.pack_bits(values) if bits else frames.pack_words(values))


def test_file_records(device):
    device.call("write", 0, int(Space.FILES), 256 + 7, 3582, 32)
    assert ask(device, frames.read_files((2, 7, 2)))[4:] == frames.pack_words([3582, 32])


def test_whole_tables_and_their_ends(device):
    """As many items as one command takes, up to the last; one beyond is refused and nothing is written."""
    values = [(7 * i) & 0xFFFF for i in range(2048)]
    device.call("write", 17, 3, 0, *values)
    assert device.read(3, 0, 2048) == values
    for arguments in (
        ("read", 17, 3, 2047, 2),
        ("write", 17, 3, 2047, 1, 2),
        ("read", 17, 2, 1024, 1),
        ("read", 0, 7, 0, 1),
    ):
        with pytest.raises(Refused, match=r"slave 17: space [0-9]+ item [0-9]+"):
            device.call(*arguments)


def test_writes_of_the_master_are_told(device):
    assert ask(device, frames.write_registers(300, [1, 2, 3]))
    event = device.wait_for("write")
    assert (event["slave"], event["space"], event["first"], event["last"]) == (17, Space.HOLDINGS, 300, 302)
    assert device.read(Space.HOLDINGS, 300, 3) == [1, 2, 3]
    assert ask(device, frames.write_coil(9, True))
    event = device.wait_for("write")
    assert (event["space"], event["first"], event["last"]) == (Space.COILS, 9, 9)
    assert ask(device, frames.write_files((3, 4, [5, 6])))
    event = device.wait_for("write")
    assert (event["space"], event["file"], event["first"], event["last"]) == (Space.FILES, 3, 4, 5)


def test_inputs_of_the_core(device):
    device.call("set", 17, "exception_status", 0x6D)
    assert ask(device, b"\x07") == b"\x07\x6d"
    device.call("set", 0, "run_indicator", 0)
    assert ask(device, b"\x11")[-1] == 0x00
    device.call("set", 0, "run_indicator", 1)
    assert ask(device, b"\x11")[-1] == 0xFF
    read = frames.read(FC.READ_HOLDINGS, 0, 1)
    for name, value, code in (("busy", 1, EX.BUSY), ("failure", 7, EX.NAK), ("failure", 4, EX.FAILURE)):
        device.call("set", 17, name, value)
        assert ask(device, read) == bytes([0x83, code])
        device.call("set", 17, name, 0)
        assert ask(device, read)[0] == 3
    device.call("set", 17, "write_lock", 1)
    assert ask(device, frames.write_register(0, 1))[0] == 0x86
    assert device.call("get", 17) == {
        "id": device.number, "exception_status": 0x6D, "busy": 0, "failure": 0, "run_indicator": 1, "write_lock": 1,
        "listen_only": 0, "idle": 1,
    }  # fmt: skip
    device.call("set", 17, "write_lock", 0)
    assert ask(device, frames.write_register(0, 1))[0] == 6
    device.call("set", 17, "diagnostic", 0xA5A4)
    assert device.counters()["register"] == 0xA5A4
    assert ask(device, frames.diagnostics(10, 0)), "clear counters and register"
    assert device.counters()["register"] == 0, "bits are set once"


def test_counters_and_log_are_those_of_the_line(device):
    assert ask(device, frames.restart(clear_log=True))
    for pdu in (frames.read(FC.READ_HOLDINGS, 0, 1), frames.read(FC.READ_HOLDINGS, 2047, 2)):
        ask(device, pdu)
    device.send(frames.bad_crc(READ))
    status = device.call("status", 17)
    wanted = {"bus_message": 2, "comm_error": 1, "exception": 1, "slave_message": 2, "event": 1, "no_response": 0,
              "nak": 0, "busy": 0, "overrun": 0, "register": 0}  # fmt: skip
    assert status["counters"] == wanted
    assert status["log"] == [0x82, 0x41, 0x80, 0x40, 0x80, 0x00]
    assert list(ask(device, b"\x0c")[8:]) == [0x80, *status["log"]]
    assert status["errors"]["crc"] >= 1 and status["errors"]["frame"] > 2


VERDICTS = {
    "crc": frames.bad_crc(READ),
    "other address": request(frames.read(FC.READ_HOLDINGS, 0, 1), 18),
    "broadcast": request(frames.write_register(5, 6), 0),
    "too short": READ[:3],
    "too long": bytes(257),
}


@pytest.mark.parametrize("verdict", VERDICTS)
def test_silence_has_a_reason(device, verdict):
    assert device.send(VERDICTS[verdict]) == (b"", verdict)
    event = device.wait_for("silence")
    assert event["verdict"] == verdict and event["slaves"] == {"17": verdict}


def test_listen_only_is_a_reason(device):
    assert device.send(request(frames.diagnostics(4, 0))) == (b"", "listen-only")
    assert device.send(READ) == (b"", "listen-only")
    assert device.call("get", 17)["listen_only"] == 1
    device.send(request(frames.restart()))
    assert device.call("get", 17)["listen_only"] == 0 and ask(device, b"\x07")


def test_frames_of_a_client_are_told_with_their_pins(device):
    with Port(device.link) as port:
        answer = port.ask(READ, bytes(25))
    assert device.wait_for("client", state="open")["clients"] == 1
    asked = device.wait_for("frame", direction="request")
    told = device.wait_for("frame", direction="answer")
    assert (asked["bytes"], told["bytes"], told["to"], told["slave"]) == (READ.hex(), answer.hex(), asked["n"], 17)
    assert asked["source"] == "client" and abs(asked["time"] - time.time()) < 5 and asked["time"] < told["time"]
    assert told["cycle"] >= asked["cycle"] + asked["starts"][-1] + (1 + 3.5) * 11 * device.hello["bit_time"]
    for frame, pin, data in ((asked, 4, READ), (told, 2, answer)):
        assert decoded(frame, pin, device.hello["bit_time"]) == data
    assert device.wait_for("client", state="closed")["clients"] == 0


def decoded(frame, pin, bit):
    """The bytes of a frame, sampled from the edges of a pin at the starts that are told."""
    edges = list(zip(frame["edges"][::2], frame["edges"][1::2]))

    def level(at):
        return bool([pins for offset, pins in edges if offset <= at][-1] & pin)

    return bytes(sum(level(start + bit // 2 + (1 + i) * bit) << i for i in range(8)) for start in frame["starts"])


def test_pins_can_be_left_out(device):
    device.call("pins", "off")
    device.send(READ)
    assert "edges" not in device.wait_for("frame", direction="request")


BAD_COMMANDS = [
    "", "fly", "read", "read 17", "read 17 3 0", "read 17 3 0 0", "read 17 3 0 2049", "read 17 8 0 1", "read 18 3 0 1",
    "read x 3 0 1", "read 17 3 65535 2", "read 17 3 0 1 1", "write 17 3 0", "write 17 3 0 65536", "write 17 3 0 -1",
    "set", "set 17 colour 1", "set 17 busy 2", "set 17 busy x", "set 99 busy 1", "get 99", "status 99", "send",
    "send 1",    "send xy", "send " + "00" * 1027, "pins maybe", "unfault", "unfault x",
]  # fmt: skip


def test_bad_commands_are_refused_and_the_line_goes_on(device):
    for command in BAD_COMMANDS[1:]:
        with pytest.raises(Refused):
            device.call(*command.split())
    device.channel.sendall(b"\n\nnonsense\n-1 get 17\n\xff\xfe\n")
    assert ask(device, frames.read(FC.READ_HOLDINGS, 0, 1))


def round_trips(port, count):
    """Milliseconds of each of `count` reads of ten registers."""
    found = []
    for _ in range(count):
        begun = time.monotonic()
        assert len(port.ask(READ, bytes(25))) == 25
        found.append(1000 * (time.monotonic() - begun))
        time.sleep(0.004)
    return found


def test_commands_never_delay_an_answer(device, record_property):
    """Answers are as early with a flood of large reads and writes as without; a snapshot is never torn."""
    with Port(device.link) as port, Watch() as watch:
        quiet = statistics.median(round_trips(port, 20))
        stop, torn, calls = threading.Event(), [], [0]

        def flood():
            for n in range(10**9):
                if stop.is_set():
                    return
                device.call("write", 17, 3, 0, *[n & 0xFFFF] * 500)
                if len(set(device.read(3, 0, 500))) != 1:
                    torn.append(n)
                calls[0] += 2

        worker = threading.Thread(target=flood)
        worker.start()
        try:
            for _ in range(5):
                busy = statistics.median(round_trips(port, 20))
                if busy < quiet + 1:
                    break
        finally:
            stop.set()
            worker.join()
    said = f"{quiet:.2f} ms without, {busy:.2f} ms with commands ({watch})"
    record_property("figures", [f"live: an answer takes {said}"])
    assert busy < quiet + watch.bound(1, 500), said
    assert not torn and calls[0] > 50, (torn, calls)


def test_dead_reader_never_stops_the_line(folder):
    """Events beyond the queue are dropped and counted; memory does not grow with them."""
    with Controlled(folder / "deaf") as running, Port(running.link) as port:

        def memory():
            with open(f"/proc/{running.process.pid}/status", encoding="ascii") as status:
                return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))

        running.call("write", 17, 3, 0, *[65535] * 2048)
        for number in range(1, 1001):  # 12 MB of replies
            running.channel.sendall(f"{number} read 17 3 0 2048\n".encode())
        before = 0
        while memory() != before:  # until all that it takes is done
            before = memory()
            time.sleep(1)
        for _ in range(20):
            assert len(port.ask(READ, bytes(25))) == 25
        assert memory() < before + 256, "it grows"
        running.number = 1000
        assert running.call("stats")["dropped"] > 0
        assert len(port.ask(READ, bytes(25))) == 25, "told with the next event"
        assert running.wait_for("dropped")["count"] > 0


def test_server_that_ends_leaves_the_line_alone(folder):
    with Controlled(folder / "left") as running:
        running.channel.close()
        with Port(running.link) as port:
            assert len(port.ask(READ, bytes(25))) == 25
        assert "the control server has ended" in running.stderr()


def test_meter_and_map_have_their_items(folder):
    """The PDM meter's inputs, relays and registers; inputs and registers of a map by the places its file tells."""
    with Controlled(folder / "meter", DEVICE="pdm") as running:
        running.call("write", 17, 1, 0, 1, 0, 1)
        assert running.read(1, 0, 4) == [1, 0, 1, 0]
        assert ask(running, frames.read(FC.READ_DISCRETES, 0, 4)) == b"\x02\x01\x05"
        assert ask(running, frames.write_coil(1, True)) and running.read(0, 0, 2) == [0, 1]
        assert running.wait_for("write")["space"] == Space.COILS
        assert running.call("status", 17)["counters"] is None
    with Controlled(folder / "map", MAP="examples/relay_box/relay_box.yaml") as running:
        running.call("write", 17, 1, 1, 215)
        assert ask(running, frames.read(FC.READ_INPUTS, 0, 1)) == b"\x04\x02\x00\xd7"
        assert ask(running, frames.write_register(0, 0x123)) == frames.write_register(0, 0x123)
        assert running.read(6, 1) == [0x123], "limit, the second register"
        with pytest.raises(Refused, match="cannot be written"):
            running.call("write", 17, 6, 1, 5)


def test_map_device_has_counters_and_log(folder):
    """Where the map asks for diagnostics: what the master reads and what the control channel says is the same."""
    file = folder / "counting.yaml"
    file.write_text(
        "device: counting\nfunctions: [03, 06, 08, 11, 12]\nholding_registers:\n  - {at: 0, name: level}\n",
        encoding="utf-8",
    )
    with Controlled(folder / "counting", MAP=file) as running:
        got = running.call("status", 1)
        assert got["log"] == [] and not any(got["counters"].values())
        assert ask(running, frames.read(FC.READ_HOLDINGS, 0, 1), 1) == b"\x03\x02\0\0"
        assert ask(running, frames.read(FC.READ_HOLDINGS, 9, 1), 1) == b"\x83\x02"
        assert running.send(frames.bad_crc(frames.adu(1, frames.read(FC.READ_HOLDINGS, 0, 1))))[1] == "crc"
        listen = frames.diagnostics(Sub.LISTEN_ONLY, 0)
        assert running.send(frames.adu(1, listen))[0] == b""
        got = running.call("status", 1)
        counters = got["counters"]
        assert got["log"] == [0x04, 0x40, 0x80, 0x82, 0x41, 0x80, 0x40, 0x80], got
        assert (counters["bus_message"], counters["comm_error"], counters["exception"]) == (3, 1, 1), got
        assert (counters["event"], counters["slave_message"], got["listen_only"]) == (2, 3, 1), got
        assert got["errors"]["crc"] == 1


def test_message_is_json_a_line(device):
    """Names with quotes do not break it."""
    with pytest.raises(Refused, match='"fly'):
        device.call('"fly\\')
    assert json.dumps(device.call("stats"))
    assert (ROOT / "sim" / "bridge_link.py").exists()
