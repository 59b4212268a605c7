# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/try.html: the core as WebAssembly says what the compiled core says, in the same words as the Python side.

FULL=1 adds the examples that need another identity: the core is built once more for each, by what `make try` installs.
"""

import base64
import json
import random
from pathlib import Path

import demo
import faults
import pytest
import try_page
from conftest import FULL
from differential.device import Device, library
from harness import build
from protocol import frames, vectors, words
from protocol.defs import F8E1
from protocol.pdm import RECORD_BYTES
from protocol.words_special import messages, register

from .web import needs_chromium, page

pytestmark = needs_chromium
TABLES = {
    "coils": "coils",
    "discrete_inputs": "discretes",
    "input_registers": "inputs",
    "holding_registers": "holdings",
}
STATE = {"exception_status", "busy", "run_indicator"}
BIT_TIME = 16
PATIENCE_CLOCKS = 60_000
RANDOM_FRAMES = 3000

PLAY = """async ([core, jobs]) => {
  const bytes = Uint8Array.from(atob(core || CORE), (c) => c.charCodeAt(0));
  const out = [];
  for (const steps of jobs) {
    const device = await Wasm.open(bytes);
    const answers = [];
    for (const step of steps) {
      await device.call("line", { address: step.address });
      for (const [table, first, values] of step.load) await device.call("write", { table, first, values });
      await device.call("set", step.state);
      for (const [times, hex] of step.before) for (let i = 0; i < times; ++i) await device.call("send", { hex });
      for (const hex of step.requests) answers.push((await device.call("send", { hex })).answer);
    }
    out.push(answers);
  }
  return out;
}"""


@pytest.fixture(scope="module")
def built():
    """The page, which must be of these sources."""
    assert not try_page.stale()
    return try_page.TARGET


@pytest.fixture
def tried(chromium, built):
    """The page, opened from disk."""
    with page(chromium, built.as_uri()) as made:
        yield made


def played():
    """[(parameters, [sequence, ...]), ...]: the printed examples of a standard slave, by the build they need."""
    known = {v["id"] for v in vectors.playable()}
    found = {}
    for sequence in vectors.sequences():
        steps = [v for v in sequence if v["id"] in known and not demo.is_meter(v)]
        if steps:
            parameters = build.config_parameters(vectors.build_items(steps[0]))
            found.setdefault(json.dumps(parameters), (parameters, []))[1].append(steps)
    return list(found.values())


def job(steps):
    """A sequence for PLAY."""
    out = []
    for vector in steps:
        load, state = [], {}
        for entry in vector["preconditions"]:
            if entry["table"] in TABLES:
                load.append([TABLES[entry["table"]], entry["address"], entry["values"]])
            elif entry["table"] == "file":
                records = vectors.document()["reference_map"]["file_records"]
                load.append(["files", (entry["file"] - 1) * records + entry["address"], entry["values"]])
        wanted = demo.contents(vector, {})
        state = {name: wanted[name] for name in (*STATE, "failure", "diagnostic") if name in wanted}
        before = [[times, frame.hex(" ")] for times, frame in demo.traffic(vector)]
        request = vectors.frame(vector["request"]).hex(" ")
        out.append(
            {
                "address": vector["slave_address"],
                "load": load,
                "state": {"busy": 0, **state},
                "before": before,
                "requests": [request] * vectors.repeat(vector),
            }
        )
    return out


def compiled(path, steps):
    """What the compiled core answers to a job."""
    spaces = {"coils": 0, "discretes": 1, "inputs": 2, "holdings": 3, "files": 4}
    device, out = Device(path), []
    inputs = {"broadcast_en": 1, "run_indicator": 1}
    for step in steps:
        inputs |= {"address": step["address"], **{k: v for k, v in step["state"].items() if k != "diagnostic"}}
        device.setup(F8E1, BIT_TIME, **inputs)
        if step is steps[0]:
            device.reset()
        device.idle(5000)
        for table, first, values in step["load"]:
            for i, value in enumerate(values):
                device.host(spaces[table], first + i, value)
        if "diagnostic" in step["state"]:
            device.setup(F8E1, BIT_TIME, **inputs, diagnostic=step["state"]["diagnostic"])
            device.idle(10)
            device.setup(F8E1, BIT_TIME, **inputs)
        for times, hex_bytes in step["before"]:
            for _ in range(times):
                device.transfer(bytes.fromhex(hex_bytes), PATIENCE_CLOCKS)
        for request in step["requests"]:
            out.append((device.transfer(bytes.fromhex(request), PATIENCE_CLOCKS).answer or b"").hex(" ").upper())
    device.close()
    return out


def test_page_is_up_to_date_and_small():
    """The file in docs/ is made of these sources."""
    assert not try_page.stale()
    assert try_page.TARGET.stat().st_size <= try_page.LIMIT


@pytest.mark.parametrize("number", range(len(played())) if FULL else [0])
def test_every_printed_vector_as_the_compiled_device(tried, number, tmp_path):
    """Byte for byte, with the counts that an example presumes brought about by real traffic."""
    parameters, sequences = played()[number]
    core = None
    if parameters:
        pytest.importorskip("ziglang", reason="ziglang is not installed: make try installs it")
        sized = {
            n: f"{v}" if isinstance(v, int) else v for n, v in build.for_simulator("verilator", parameters).items()
        }
        made = try_page.wasm(Path("build") / f"try_{number}", try_page.PARAMETERS | sized)
        core = base64.b64encode(made.read_bytes()).decode()
    jobs = [job(steps) for steps in sequences]
    got = tried.evaluate(PLAY, [core, jobs])
    path = library({**try_page.PARAMETERS, **parameters})
    for steps, wanted, answers in zip(sequences, jobs, got):
        name = steps[0]["id"]
        assert answers == compiled(path, wanted), name
        printed = [
            vectors.frame(v["expected_response"]) or b"" for v in steps for _ in range(vectors.repeat(v))
        ]  # the log of FIG 26/27 as printed cannot be, see sim/README.md
        if not any("event_log" in vectors.state(v["preconditions"]) for v in steps):
            assert answers == [p.hex(" ").upper() for p in printed], name
    if not parameters:
        assert sum(map(len, sequences)) > 40


def said(tried, pairs):
    """What the page says of [(request, answer or None), ...]."""
    script = "(pairs) => pairs.map(([q, a]) => [Words.request(q), Words.answer(q, a)])"
    return tried.evaluate(script, [[list(q), None if a is None else list(a)] for q, a in pairs])


def test_words_are_those_of_the_python_side(tried, seed):
    """All printed frames, and random ones, long and short, with every function code."""
    pairs = [
        (vectors.frame(v["request"]), vectors.frame(v["expected_response"]))
        for v in vectors.playable()
        if len(vectors.frame(v["request"])) > 3
    ]
    rng = random.Random(seed)
    codes = [1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 16, 17, 20, 21, 22, 23, 24, 43, 99]
    for _ in range(RANDOM_FRAMES):
        code = rng.choice(codes)
        body = [rng.choice((0, 1, 2, 6, 255, rng.randrange(256))) for _ in range(rng.choice((0, 2, 4, 4, 5, 9, 20)))]
        request = frames.adu(17, bytes([code, *body]))
        reply = [rng.randrange(256) for _ in range(rng.choice((0, 1, 2, 4, 6, 12, 30)))]
        answer = frames.adu(rng.choice((17, 17, 18)), bytes([rng.choice((code, code, code | 128, 3)), *reply]))
        if code in (3, 4, 23) and answer[2] == RECORD_BYTES:
            continue  # the page knows no PDM meter
        if rng.random() < 0.1:
            answer = answer[:-1] + b"\0"
        pairs.append((request, answer))
    for (request, answer), (asked, replied) in zip(pairs, said(tried, pairs)):
        assert asked == words.request(request), frames.text(request)
        assert replied == words.answer(request, answer), f"{frames.text(request)} / {answer and frames.text(answer)}"


def test_log_and_register_in_words(tried, seed):
    """The event log and the diagnostic register."""
    rng = random.Random(seed)
    logs = [
        [rng.choice((0, 4, 64, 65, 128, 130, 146, 192, 224, rng.randrange(256))) for _ in range(20)] for _ in range(50)
    ]
    assert tried.evaluate("(logs) => logs.map(Words.messages)", logs) == [messages(log) for log in logs]
    values = [0, 1, 2, 0x8000, 0x8001, 0xFFFF]
    assert tried.evaluate("(values) => values.map(Words.register)", values) == [register(v) for v in values]


def test_form_of_faults_is_the_table_of_the_bridge(tried):
    """Kinds, directions, arguments, defaults and limits in the page are those that the bridge is compiled with."""
    found = tried.evaluate("Faults.KINDS")
    assert set(found) == set(faults.KINDS)
    for kind, (directions, keys, meaning) in found.items():
        assert (tuple(directions), meaning) == (faults.KINDS[kind].directions, faults.KINDS[kind].meaning), kind
        assert {name: tuple(key) for name, key in keys.items()} == faults.KINDS[kind].keys, kind


@pytest.mark.parametrize(
    "fault, verdict",
    [
        ({"kind": "wrong_crc"}, "crc"),
        ({"kind": "swapped_crc"}, "crc"),
        ({"kind": "parity"}, "parity"),
        ({"kind": "stop"}, "parity"),
        ({"kind": "break"}, "framing"),
        ({"kind": "gap", "amount": 2}, "gap"),
        ({"kind": "cut", "character": 3}, "too short"),
        ({"kind": "none"}, "not heard"),
        ({"kind": "rate", "amount": 15}, None),
    ],
    ids=lambda value: value["kind"] if isinstance(value, dict) else "",
)
def test_fault_has_its_verdict(tried, fault, verdict):
    """A broken request is not answered, and the page says why."""
    script = """async ([fault, hex]) => {
      const device = await Wasm.open(Uint8Array.from(atob(CORE), (c) => c.charCodeAt(0))), told = [];
      device.onEvent((event) => told.push(event));
      await device.call("fault", fault);
      const first = (await device.call("send", { hex })).answer;
      const then = (await device.call("send", { hex })).answer;
      return [first, then, told.filter((e) => e.event === "silence").map((e) => e.verdict)];
    }"""
    hex_bytes = frames.adu(17, frames.read(3, 0, 1)).hex(" ")
    first, then, verdicts = tried.evaluate(script, [fault, hex_bytes])
    assert first == "" and then == frames.adu(17, bytes([3, 2, 0, 0])).hex(" ").upper()
    assert len(verdicts) == 1 and (verdict is None or verdicts == [verdict])


def test_visitor_sends_breaks_and_looks(tried):
    """By hand: a request, a broken one, its reason and its waveform; a register changed by the master shows."""
    tried.select_option("#preset", label="write holding register 1 = 42")
    tried.click("#send-form button[type=submit]")
    tried.wait_for_function("document.querySelectorAll('#cells .cell span')[1].textContent === '42'")
    tried.select_option("#kind", "gap")
    tried.click("#fault-form button[type=submit]")
    tried.click("#send-form button[type=submit]")
    tried.wait_for_selector("#list li.silent.error .why:has-text('gap above t1.5')")
    tried.click("#list li.silent.error")
    tried.wait_for_function("document.getElementById('wave-note').textContent.includes('more than t1.5')")
    assert tried.inner_text("#counts [data-name=comm_error]") == "1"
