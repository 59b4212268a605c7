# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Faults on the wire of the live device: what the core then counts, logs and answers, and what the master gets."""

import sys

import pytest
from protocol import frames
from protocol.defs import EX, FC

from live.controlled import Controlled, Refused
from live.serve import ROOT, Port, Serve, refuse, request

READ = request(frames.read(FC.READ_HOLDINGS, 0, 2))
ANSWER = request(b"\x03\x04\x12\x34\x56\x78")
LENGTH_ERROR = request(bytes([FC.READ_HOLDINGS | 0x80, EX.VALUE]))
BAD, OVERRUN, GOOD, ANSWERED, EXCEPTION = 0x82, 0x92, 0x80, 0x40, 0x41
T15_CHARACTERS = 1.5


@pytest.fixture(scope="module")
def devices(tmp_path_factory):
    """A device with parity and one without, each with two registers."""
    folder = tmp_path_factory.mktemp("faults")
    with Controlled(folder / "even") as even, Controlled(folder / "none", PARITY="none") as none:
        for device in (even, none):
            device.call("write", 0, 3, 0, 0x1234, 0x5678)
        yield {"even": even, "none": none}


@pytest.fixture
def device(devices):
    """That with parity, counters and log cleared: only the restart is in the log."""
    return cleared(devices["even"])


def cleared(device):
    """No faults are left, and counters and log begin anew."""
    device.call("unfault", "all")
    answer, _ = device.send(request(frames.restart(clear_log=True)))
    assert answer, "no restart"
    device.events.clear()
    return device


# fault of the request, parity: answer, verdict, events of the log the newest first, what is counted
SILENT = [
    ("flip character=2 bit=3", "even", "parity"),
    ("flip character=2 bit=3", "none", "crc"),
    ("parity character=5", "even", "parity"),
    ("stop character=1", "even", "framing"),
    ("stop character=1", "none", "framing"),
    ("break character=3", "even", "framing"),
    ("break character=0 bits=30", "none", "framing"),
    ("gap character=3 amount=2", "even", "gap"),
    ("gap character=-1 amount=3", "none", "gap"),
    ("rate amount=8", "none", None),
    ("rate amount=-8", "none", None),
    ("cut character=6", "even", "crc"),
    ("cut character=3", "even", "too short"),
    ("extra value=1", "even", "crc"),
    ("swapped_crc", "even", "crc"),
    ("wrong_crc", "none", "crc"),
    ("collision", "even", None),
    ("collision character=1 value=240", "none", None),
]


@pytest.mark.parametrize("fault,parity,verdict", SILENT, ids=lambda v: str(v).replace(" ", "_"))
def test_broken_request_is_silence_and_one_communication_error(devices, fault, parity, verdict):
    device = cleared(devices[parity])
    device.call("fault", "request", *fault.split())
    answer, said = device.send(READ)
    assert answer == b"" and (said == verdict or verdict is None), said
    event = device.wait_for("silence")
    assert event["verdict"] == said and event["slaves"] == {"17": said}
    status = device.call("status", 17)
    counters = status["counters"]
    assert (counters["comm_error"], counters["bus_message"], counters["overrun"]) == (1, 0, 0), counters
    assert status["log"] == [BAD, 0x00], status["log"]
    assert device.send(READ) == (ANSWER, ""), "the fault was for one frame"


@pytest.mark.parametrize("fault", ["glitch width=0.3", "glitch character=4 width=0.4", "jitter amount=0.2",
                                   "rate amount=2", "rate amount=-2",
                                   f"gap character=2 amount={T15_CHARACTERS - 0.3}"])  # fmt: skip
def test_request_within_the_limits_of_the_line_is_answered(device, fault):
    device.call("fault", "request", *fault.split())
    assert device.send(READ) == (ANSWER, "")
    assert device.wait_for("frame", direction="request")["injected"], "nothing was done to it"
    counters = device.counters()
    assert (counters["comm_error"], counters["slave_message"]) == (0, 1), counters


def test_glitch_is_on_the_pins(device):
    """A pulse before the start bit, shorter than half a bit, and no character of it."""
    device.call("fault", "request", "glitch", "width=0.3")
    device.send(READ)
    frame = device.wait_for("frame", direction="request")
    edges = list(zip(frame["edges"][::2], frame["edges"][1::2]))
    low, high = edges[0], edges[1]
    assert not low[1] & 4 and high[1] & 4
    assert high[0] - low[0] == round(0.3 * device.hello["bit_time"]) and frame["starts"][0] > high[0]
    assert bytes.fromhex(frame["bytes"]) == READ


def test_extra_zero_is_a_length_error_and_answered(device):
    """A byte 00 behind a good frame leaves its CRC good: the PDU is too long, exception 03."""
    device.call("fault", "request", "extra", "value=0")
    assert device.send(READ) == (LENGTH_ERROR, "")
    status = device.call("status", 17)
    assert status["counters"]["exception"] == 1 and status["log"] == [EXCEPTION, GOOD, 0x00]


def test_lost_request_reaches_no_counter(device):
    before = device.counters()
    device.call("fault", "request", "none")
    assert device.send(READ) == (b"", "not heard")
    assert device.counters() == before


def test_echo_of_the_request_comes_before_the_answer(device):
    device.call("fault", "request", "echo")
    assert device.send(READ) == (READ + ANSWER, "")
    assert device.counters()["slave_message"] == 1


def test_too_long_a_frame_is_an_overrun(device):
    assert device.send(bytes([17]) * 257) == (b"", "too long")
    status = device.call("status", 17)
    assert (status["counters"]["comm_error"], status["counters"]["overrun"]) == (1, 1)
    assert status["log"] == [OVERRUN, 0x00]


BROKEN = {
    "flip character=3 bit=0": ANSWER[:3] + bytes([ANSWER[3] ^ 1]) + ANSWER[4:],
    "parity character=1": ANSWER,
    "stop character=1": ANSWER,
    "break character=0": b"\x00" + ANSWER[1:],
    "glitch": ANSWER,
    "jitter": ANSWER,
    "gap character=3 amount=5": ANSWER,
    "cut character=4": ANSWER[:4],
    "extra value=171": ANSWER + b"\xab",
    "swapped_crc": frames.swapped_crc(ANSWER),
    "wrong_crc": ANSWER[:-1] + bytes([ANSWER[-1] ^ 1]),
    "none": b"",
    "echo": ANSWER,
}
MARKED = {"flip": [[3, "parity"]], "parity": [[1, "parity"]], "stop": [[1, "framing"]], "break": [[0, "framing"]]}


@pytest.mark.parametrize("fault", BROKEN, ids=lambda v: v.replace(" ", "_"))
def test_broken_answer_is_the_masters_trouble(device, fault):
    """The core has answered and does not know: one event, no error. Its own echo is not heard either."""
    device.call("fault", "answer", *fault.split())
    assert device.send(READ)[0] == BROKEN[fault]
    if fault != "echo":
        assert device.wait_for("frame", direction="answer")["bytes"] == ANSWER.hex(), "the core sends what it should"
        delivered = device.wait_for("delivered")
        assert delivered["bytes"] == BROKEN[fault].hex() and delivered["injected"]
        assert delivered["faults"] == MARKED.get(fault.split()[0], []), delivered
    status = device.call("status", 17)
    counters = status["counters"]
    assert (counters["event"], counters["comm_error"], counters["bus_message"]) == (1, 0, 1), counters
    assert status["log"] == [ANSWERED, GOOD, 0x00]
    assert device.send(READ) == (ANSWER, "")


@pytest.mark.parametrize("fault", ["rate amount=8", "collision character=1"])
def test_answer_that_no_uart_understands(device, fault):
    device.call("fault", "answer", *fault.split())
    answer, _ = device.send(READ)
    assert answer and not frames.check(answer), answer.hex()
    assert device.send(READ) == (ANSWER, "")


def test_late_answer_comes_late_and_the_line_goes_on(device):
    """It does not stop the next request, and comes to whoever has asked."""
    device.call("fault", "answer", "late", "amount=150")
    with Port(device.link) as port:
        port.write(READ)
        assert port.read(0.1) == b""
        assert port.read(5, len(ANSWER)) == ANSWER
        assert port.ask(READ, ANSWER) == ANSWER


def test_client_sees_the_gap_in_an_answer(device):
    """What comes before a silence is not held back for what comes behind it."""
    device.call("fault", "answer", "gap", "character=4", "amount=120")  # 69 ms
    with Port(device.link) as port:
        port.write(READ)
        first = port.read(1, 4)
        assert first == ANSWER[:4]
        assert port.read(1, 5) == ANSWER[4:]


def test_every_count_and_probability(device):
    answers = lambda count: [device.send(READ)[0] == ANSWER for _ in range(count)]  # noqa: E731
    device.call("fault", "request", "wrong_crc", "every=3", "count=2")
    assert answers(10) == [n not in (3, 6) for n in range(1, 11)]
    device.call("unfault", "all")
    device.call("fault", "answer", "wrong_crc", "probability=0.5")
    good = sum(answers(40))
    assert 8 <= good <= 32, good
    fault = device.call("faults")["faults"][0]
    assert fault["kind"] == "wrong_crc" and fault["done"] == 40 - good
    assert device.call("unfault", fault["fault"])["removed"] == 1
    assert all(answers(3))


def test_two_faults_in_one_frame(device):
    device.call("fault", "request", "jitter", "amount=0.1")
    device.call("fault", "request", "wrong_crc")
    device.send(READ)
    frame = device.wait_for("frame", direction="request")
    assert frame["injected"] == ["jitter amount 0.1", "wrong_crc"]


BAD_FAULTS = [
    "", "request", "sideways flip", "request melt", "request late", "request flip bit=8", "request flip bit=1.5",
    "request flip character=300", "request flip amount=1", "request flip bit", "request flip bit=x",
    "request rate amount=25", "request jitter amount=0.5", "request glitch width=0.6", "request gap amount=-1",
    "request flip every=0", "request flip every=1.5", "request flip probability=0", "request flip probability=2",
    "request flip every=2 probability=0.5", "answer late amount=1e9", "request flip bit=nan", "request flip count=0",
]  # fmt: skip


def test_bad_faults_are_refused_with_a_reason(devices):
    device = cleared(devices["even"])
    for fault in BAD_FAULTS:
        with pytest.raises(Refused, match="fault: "):
            device.call("fault", *fault.split())
    with pytest.raises(Refused, match="no parity"):
        devices["none"].call("fault", "request", "parity")
    assert device.call("faults")["faults"] == []
    assert device.send(READ) == (ANSWER, "")


def test_serve_judges_faults_as_the_bridge_does(devices, monkeypatch):
    """Both read one table: kinds, directions, keys, defaults and limits."""
    monkeypatch.syspath_prepend(str(ROOT / "sim"))
    import faults

    device = cleared(devices["even"])
    for fault in BAD_FAULTS:
        assert faults.judge(fault.split()), fault
    for kind, (directions, keys, _) in faults.KINDS.items():
        for direction in faults.DIRECTIONS:
            words = [direction, kind]
            if direction not in directions:
                with pytest.raises(Refused):
                    device.call("fault", *words)
                continue
            device.call("fault", *words)
            made = device.call("faults")["faults"][-1]
            assert {k: made[k] for k in keys} == {k: default for k, (default, *_) in keys.items()}, made
            for key, (_, least, most, *_) in (keys | faults.WHEN).items():
                for value in (least, most):
                    device.call("fault", *words, f"{key}={value}")
                    assert not faults.judge([*words, f"{key}={value}"])
                for value in (least - 1, most + 1):
                    with pytest.raises(Refused):
                        device.call("fault", *words, f"{key}={value}")
            device.call("unfault", "all")
    assert sys.modules.pop("faults")


def test_faults_by_the_variable(devices, tmp_path):
    with Serve(tmp_path / "bus", FAULT="answer wrong_crc every=2; request glitch every=1") as running:
        with Port(running.link) as port:
            zero = request(b"\x03\x04\0\0\0\0")
            got = [port.ask(READ, zero) for _ in range(4)]
        assert [frames.check(answer) for answer in got] == [True, False, True, False]
    status, lines = refuse(LINK=tmp_path / "bad", FAULT="answer melt")
    assert status == 2 and len(lines) == 1 and "no such kind" in lines[0], lines
