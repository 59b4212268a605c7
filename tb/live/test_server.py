# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Pieces of the server beside the bridge, without a device: signals, points, captures, the OpenAPI document."""

import io
import json
import math
import shutil
import subprocess
from array import array

import pytest
from server import capture, operations, variables
from server.errors import Refused
from server.explain import Frame, Frames, Log
from server.points import of_map
from server.values import KINDS, Signal, samples

# ---------------------------------------------------------------------- values that move


@pytest.mark.parametrize(
    "kind, arguments, at, value",
    [
        ("constant", {"value": 7}, 99.0, 7),
        ("ramp", {"from": 10, "to": 20, "period": 10}, 5.0, 15),
        ("ramp", {"from": 10, "to": 20, "period": 10}, 10.0, 10),
        ("sine", {"mean": 5, "amplitude": 2, "period": 4}, 1.0, 7),
        ("square", {"low": 1, "high": 9, "period": 2}, 0.5, 1),
        ("square", {"low": 1, "high": 9, "period": 2}, 1.0, 9),
        ("counter", {"start": 3, "step": 2, "period": 0.5}, 1.6, 9),
        ("csv", {"csv": "s,value\n0,1\n1,5\n2,8\n"}, 1.5, 5),
        ("csv", {"csv": "0,1\n1,5\n2,8\n"}, 3.0, 5),
    ],
)
def test_signal_has_its_value(kind, arguments, at, value):
    """At a moment, counted from its beginning."""
    assert math.isclose(Signal(kind, arguments, begin=100.0).at(100.0 + at), value)


def test_walk_stays_within_its_limits():
    """No step is larger than said, none leaves the range."""
    walk = Signal("walk", {"start": 5, "step": 3, "low": 0, "high": 10})
    before = 5
    for tick in range(1, 500):
        value = walk.at(float(tick))
        assert 0 <= value <= 10 and abs(value - before) <= 3
        before = value


@pytest.mark.parametrize(
    "kind, arguments, word",
    [
        ("saw", {}, "kind"),
        ("sine", {"period": 0}, "period"),
        ("sine", {"period": "long"}, "period"),
        ("sine", {"period": float("nan")}, "period"),
        ("sine", {"phase": 1}, "phase"),
        ("csv", {"csv": ""}, "csv"),
        ("csv", {"csv": "0,1\nx,2\n"}, "line 2"),
        ("csv", {"csv": "1,1\n0,2\n"}, "line 2"),
        ("csv", {"csv": 3}, "csv"),
    ],
)
def test_wrong_signal_is_refused(kind, arguments, word):
    """The text names what is wrong."""
    with pytest.raises(Refused, match=word):
        Signal(kind, arguments)


def test_csv_takes_a_head_and_blank_lines():
    """A first line without numbers is a head."""
    assert samples("time,value\n\n0,1\n0.5,2\n") == [(0.0, 1.0), (0.5, 2.0)]
    assert set(KINDS) == {"constant", "ramp", "sine", "square", "walk", "counter", "csv"}


@pytest.mark.parametrize(
    "values, word",
    [
        ({"LOG": "yes"}, "LOG=yes"),
        ({"SCRIPT": "/nowhere.py"}, "SCRIPT"),
        ({"SIGNALS": "/nowhere.json"}, "No such file"),
        ({"SIGNALS": '{"inputs 0": {"kind": "saw"}}'}, "inputs 0: kind"),
        ({"SIGNALS": "[1]"}, "must be"),
        ({"SIGNALS": "{"}, "not JSON"),
        ({"SIGNALS": '{"inputs 0": {"kind": "csv", "csv": "missing.csv"}}'}, "csv"),
    ],
)
def test_wrong_variable_is_one_line(values, word, tmp_path):
    """Judged before anything starts."""
    text = values.get("SIGNALS", "/")
    if text[0] != "/":
        (tmp_path / "s.json").write_text(text)
        values = {"SIGNALS": str(tmp_path / "s.json")}
    wrong = variables.wrong(values)
    assert word in wrong and "\n" not in wrong


# ---------------------------------------------------------------------- points of a map


def point(**changes):
    """A point of an input register, with changes."""
    row = {"name": "p", "at": 0, "size": 1, "type": "i16", "count": 1, "access": "ro", "kind": "wire", "reset": [0]}
    row |= {"host": {"space": 1, "item": 0, "words": row["size"]}} | changes
    return of_map({"tables": {"input_registers": [row]}})["p"]


SCALED = {"scale": 0.1, "offset": 0.0, "unit": "°C"}
WIDE = {"type": "u32", "size": 2, "host": {"space": 1, "item": 0, "words": 2}}
FLOAT = {**WIDE, "type": "f32"}
MEMORY = {"kind": "memory", "host": {"space": 2, "item": 0, "words": 2}}
STATES = {"type": "u16", "enum": {"0": "off", "2": "running"}}
FIELDS = {"type": "bits", "bits": {"ready": [0, 0], "mode": [5, 4]}}
BITS = {"type": "bool", "count": 4, "size": 4}


@pytest.mark.parametrize(
    "changes, value, words, text",
    [
        (SCALED, 21.5, [215], "21.5 °C"),
        (SCALED, -1.0, [65526], "-1 °C"),
        (WIDE, 0x12345678, [0x5678, 0x1234], str(0x12345678)),
        ({**WIDE, **MEMORY, "word_order": "big"}, 0x12345678, [0x1234, 0x5678], str(0x12345678)),
        ({**WIDE, **MEMORY, "word_order": "little"}, 0x12345678, [0x5678, 0x1234], str(0x12345678)),
        (FLOAT, 1.5, [0, 0x3FC0], "1.5"),
        (STATES, "running", [2], "running"),
        (FIELDS, {"ready": 1, "mode": 2}, [0x21], "ready 1, mode 2"),
        ({"type": "string<4>", "size": 2, "host": {"space": 1, "item": 0, "words": 2}}, "ab", [0, 0x6162], "ab"),
        ({"count": 2, "size": 2, "host": {"space": 1, "item": 0, "words": 2}}, [1, -1], [1, 65535], "1, -1"),
    ],
)
def test_point_to_words_and_back(changes, value, words, text):
    """The words of the host port, and what people read."""
    made = point(**changes)
    assert made.words_of(value) == words
    assert made.values(words) == value
    assert made.text(value) == text


def test_bits_of_an_input_are_one_word():
    """An array of bits is a vector."""
    row = {
        "name": "d",
        "at": 0,
        "access": "ro",
        "kind": "wire",
        "reset": [0] * 4,
        "host": {"space": 1, "item": 3, "words": 1},
    }
    made = of_map({"tables": {"discrete_inputs": [{**row, **BITS}]}})["d"]
    assert made.words_of([1, 0, 1, 1]) == [0b1101] and made.values([0b1101]) == [True, False, True, True]


@pytest.mark.parametrize(
    "changes, value, word",
    [
        (SCALED, 1e6, "does not fit"),
        (SCALED, "warm", "no i16"),
        (SCALED, None, "no i16"),
        (SCALED, float("nan"), "nan"),
        (STATES, "running away", "running"),
        (FIELDS, {"speed": 1}, "speed"),
        (FIELDS, {"mode": 4}, "mode"),
        ({"type": "string<2>"}, "abc", "characters"),
        ({"count": 2, "size": 2}, [1], "2 values"),
        ({"kind": "constant", "host": None}, 1, "constant"),
        ({"kind": "register"}, 1, "master"),
        (FLOAT, 1e300, "too large"),
    ],
)
def test_wrong_value_of_a_point_is_refused(changes, value, word):
    """The text names the point and what is wrong."""
    with pytest.raises(Refused, match=f"p.*{word}"):
        point(**changes).words_of(value)


@pytest.mark.parametrize("text, words", [("21.5 °C", [215]), ("21.5", [215]), ("0x10", [160]), ("on", [10])])
def test_point_takes_text_of_a_form(text, words):
    """With or without its unit."""
    assert point(**SCALED).words_of(text) == words


# ---------------------------------------------------------------------- frames, logs, captures

CLOCK_HZ = 307_200
READ = bytes.fromhex("1103006B00037687")
ANSWER = bytes.fromhex("110306022B00000064C8BA")


def spoken():
    """Frames as the bridge tells of them: one answered, one with a wrong CRC."""
    frames = Frames("this one is 17")
    frames.character = 176
    events = [
        {"event": "frame", "n": 1, "direction": "request", "time": 1000.25, "cycle": 100, "end": 2100,
         "bytes": READ.hex(), "starts": [0, 176], "faults": [], "injected": [], "edges": [0, 2, 16, 6]},
        {"event": "frame", "n": 1, "direction": "answer", "time": 1000.26, "cycle": 3000, "end": 5000,
         "bytes": ANSWER.hex(), "slave": 17, "to": 1, "starts": [0, 176], "edges": [0, 7, 16, 5, 32, 7, 40, 6]},
        {"event": "frame", "n": 2, "direction": "request", "time": 1000.5, "cycle": 9000, "end": 9900,
         "bytes": (READ[:-1] + b"\0").hex(), "starts": [0], "injected": ["wrong_crc"], "edges": [0, 2, 16, 6]},
        {"event": "silence", "to": 2, "verdict": "crc", "time": 1000.6},
        {"event": "frame", "n": 3, "direction": "request", "time": 1001.0, "cycle": 19000, "end": 19900, "bytes": "",
         "starts": [], "edges": []},
        {"event": "silence", "to": 3, "verdict": "not heard", "time": 1001.1},
    ]  # fmt: skip
    return frames, [frames.take(event) for event in events]


def test_frames_are_explained():
    """Words, the reason of a silence, and which answer belongs to which request."""
    frames, said = spoken()
    assert said[0]["frame"]["words"] == "to slave 17: read holding registers 107 to 109"
    assert said[1]["frame"]["words"] == "holding registers 107 to 109 = 555, 0, 100" and said[1]["frame"]["to"] == 1
    assert said[3] == {"event": "silence", "to": 3, "verdict": "crc", "words": "wrong CRC"}
    assert frames.get(1).answer == 2 and frames.get(3).injected == "wrong_crc"


def ascii_events(line, answer=b""):
    """A frame of ASCII mode, and its answer."""
    yield {"event": "frame", "n": 1, "direction": "request", "time": 1.0, "cycle": 0, "end": 9, "bytes": line.hex()}
    if answer:
        yield {"event": "frame", "n": 1, "direction": "answer", "to": 1, "time": 1.0, "cycle": 9, "end": 20,
               "bytes": answer.hex()}  # fmt: skip


@pytest.mark.parametrize(
    "line, words",
    [
        (b":1103006B00037E\r\n", "to slave 17: read holding registers 107 to 109"),
        (b":1103006B00037F\r\n", "LRC 7F is wrong, 7E would be right"),
        (b":1103006b00037e\r\n", "no frame in ASCII mode"),
        (b":1103006B00037\r\n", "no frame in ASCII mode"),
        (b"1103", "no frame in ASCII mode"),
        (b":11EF\r\n", "2 bytes are no frame"),
    ],
)
def test_frames_of_ascii_mode_are_explained(line, words):
    """The same words as in RTU mode, the characters as they are on the line, and a capture that holds them."""
    frames = Frames("this one is 17", ascii=True)
    (said,) = [frames.take(event) for event in ascii_events(line)]
    assert words in said["frame"]["words"]
    assert said["frame"]["hex"] == line.decode().replace("\r\n", "<CR><LF>")
    assert line[:6] in capture.pcapng(frames.kept, "x")


def test_answer_of_ascii_mode():
    """In words, an exception as one."""
    frames = Frames("this one is 17", ascii=True)
    said = [frames.take(e) for e in ascii_events(b":1103006B00037E\r\n", b":1183026A\r\n")]
    assert "exception 02" in said[1]["frame"]["words"] and said[1]["frame"]["exception"]


def test_log_has_colours_on_a_terminal_only():
    """And says the same without them."""
    _, said = spoken()
    lines = {}
    for colours in (False, True):
        stream = io.StringIO()
        for event in said:
            Log(stream, colours).tell(event)
        lines[colours] = stream.getvalue()
    assert "\033" in lines[True] and "\033" not in lines[False]
    assert "no answer: wrong CRC" in lines[False] and "[wrong_crc]" in lines[False]


def test_frames_are_kept_up_to_a_number():
    """Old ones go, with all that leads to them."""
    frames = Frames("this one is 17", kept=__import__("collections").deque(maxlen=10))
    for n in range(1, 100):
        frames.take(
            {"event": "frame", "n": n, "direction": "request", "time": 0.0, "cycle": 0, "end": 1, "bytes": READ.hex()}
        )
    assert len(frames.kept) == len(frames.last) == len(frames.requests) == 10 and frames.get(99) and not frames.get(89)


@pytest.mark.skipif(not shutil.which("tshark"), reason="tshark is not installed")
def test_tshark_dissects_the_capture(tmp_path):
    """Every frame as Modbus RTU, none malformed, the reason of a silence as its comment."""
    frames, _ = spoken()
    path = tmp_path / "x.pcapng"
    path.write_bytes(capture.pcapng(frames.kept, "build/modbus"))
    run = {"capture_output": True, "text": True, "check": True}
    whole = subprocess.run(["tshark", "-V", "-r", str(path)], **run).stdout
    assert "alformed" not in whole and whole.count("Modbus RTU") >= 3
    fields = ["-T", "fields", "-e", "mbrtu.unit_id", "-e", "frame.time_epoch", "-e", "frame.comment"]
    rows = [
        line.split("\t") for line in subprocess.run(["tshark", "-r", str(path), *fields], **run).stdout.splitlines()
    ]
    assert [row[0] for row in rows] == ["17"] * 3 and rows[0][1].startswith("1000.25")
    assert "wrong CRC" in rows[2][2] and "wrong_crc" in rows[2][2]


def test_fst_holds_every_edge(tmp_path):
    """Read back by another library: names, times in nanoseconds, levels."""
    import pywellen

    frames, _ = spoken()
    path = tmp_path / "x.fst"
    path.write_bytes(capture.fst(frames.kept, CLOCK_HZ))
    wave = pywellen.Waveform(path=str(path))
    found = {var.name: [(int(t), str(v)) for t, v in var.tv] for var in wave.all_vars()}
    assert set(found) == {"rxd", "txd", "de"} and str(wave.timescale) == "1ns"
    wanted = {pin: [] for pin in capture.PINS}
    for cycle, pins in [(99, capture.IDLE), *capture.changes(frames.kept)]:
        for place, pin in enumerate(capture.PINS):
            bit = str(pins >> (2 - place) & 1)
            if not wanted[pin] or wanted[pin][-1][1] != bit:
                wanted[pin].append((cycle * 10**9 // CLOCK_HZ, bit))
    assert found == wanted


def test_text_capture_is_the_log():
    """The same lines."""
    frames, _ = spoken()
    text = capture.text(frames.kept).decode()
    assert "read holding registers 107 to 109" in text and "no answer: wrong CRC" in text


def test_pins_may_be_missing():
    """No frame, no pins: still a file."""
    assert capture.pcapng([], "x") and capture.fst([], CLOCK_HZ)
    empty = Frame(1, 0.0, "request", b"", "", 0, 0, [], array("I"), [])
    assert capture.text([empty])


# ---------------------------------------------------------------------- the interface as a document


def test_openapi_document_is_whole():
    """Every operation once, every path parameter described."""
    document = operations.openapi("1.2.3")
    ids = [entry["operationId"] for path in document["paths"].values() for entry in path.values()]
    assert len(ids) == len(set(ids)) and set(operations.OPERATIONS) <= set(ids)
    for path, entries in document["paths"].items():
        for entry in entries.values():
            named = {p["name"] for p in entry.get("parameters", []) if p["in"] == "path"}
            assert named == {part[1:-1] for part in path.split("/") if part[:1] == "{"}, path
    json.dumps(document)


@pytest.mark.parametrize(
    "name, given, word",
    [
        ("read", {}, "table: is missing"),
        ("read", {"table": "foo"}, "table: must be"),
        ("read", {"table": "coils", "first": -1}, "first"),
        ("read", {"table": "coils", "first": 1.5}, "first"),
        ("read", {"table": "coils", "first": True}, "first"),
        ("read", {"table": "coils", "first": [1]}, "first"),
        ("read", {"table": "coils", "count": 4096}, "count"),
        ("read", {"table": "coils", "foo": 1}, "foo: unknown"),
        ("write", {"table": "coils", "first": 0, "values": "1"}, "values"),
        ("write", {"table": "coils", "first": 0, "values": []}, "values"),
        ("write", {"table": "coils", "first": 0, "values": [1, None]}, "values"),
        ("write", {"table": "coils", "first": 0, "values": [65536]}, "values"),
        ("set", {"busy": 2}, "busy"),
        ("fault", {"kind": 5}, "kind"),
        ("fault", {"kind": "flip", "direction": "up"}, "direction"),
        ("send", {"hex": "00" * 2000}, "hex"),
        ("attach", [], "object"),
    ],
)
def test_wrong_arguments_are_refused(name, given, word):
    """One line that names the argument."""
    with pytest.raises(Refused, match=word):
        operations.OPERATIONS[name].checked(given)
