# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The bench itself: model, frame helpers and line coding against the printed examples."""

import random

import pytest
from harness import build, wave
from harness.traffic import Traffic
from interface import number
from protocol import frames, vectors
from protocol.defs import ALL_FUNCTIONS, FC, FORMAT_BY_NAME, FORMATS, FUNCTIONS, LONGEST_PDU, Limits, Space
from protocol.model import Config, Slave

BIT = 1000
USER_CODE = 110  # the last of those that the standard leaves to users


@pytest.mark.parametrize("check", vectors.document()["crc_checks"], ids=lambda c: c["crc"])
def test_crc_of_the_sources(check):
    crc = frames.crc16(bytes.fromhex(check["data"]))
    assert f"{crc:04X}" == check["crc"]


def played(vector):
    """(slave, answer) after everything of its sequence up to `vector`; the slave's user knows the PDM record."""
    slave = Slave(vectors.config(vector))
    if vector in vectors.pdm():
        record = vectors.pdm_record(vector)
        asked = frames.read(FC.READ_HOLDINGS, 1, 1)
        slave.config.user_codes = frozenset({FC.READ_HOLDINGS})
        slave.user = lambda pdu: bytes([FC.READ_HOLDINGS, len(record)]) + record if pdu == asked else None
    for step in [*vectors.before(vector), vector]:
        vectors.prepare(slave, step)
        for _ in range(vectors.repeat(step)):
            answer = slave.request(vectors.frame(step["request"]))
    return slave, answer


@pytest.mark.parametrize("vector", vectors.playable() + vectors.pdm(), ids=lambda v: v["id"])
def test_model_answers_as_printed(vector):
    """Answer, memory, all nine counters and the event log."""
    slave, answer = played(vector)
    assert answer == vectors.frame(vector["expected_response"])
    assert not vectors.differences(slave, vector)


@pytest.mark.parametrize("vector", vectors.in_ascii(), ids=lambda v: v["id"])
def test_model_answers_as_printed_in_ascii(vector):
    """Characters, memory, all nine counters and the event log."""
    slave = Slave(vectors.config(vector))
    vectors.prepare(slave, vector)
    assert slave.hear(vector["request_chars"].encode()) == vector["expected_response_chars"].encode()
    assert not vectors.differences(slave, vector)
    assert frames.ascii_line(vectors.frame(vector["request"])) == vector["request_chars"].encode()


@pytest.mark.parametrize("check", vectors.document()["lrc_checks"], ids=lambda c: c["lrc"])
def test_lrc_of_the_sources(check):
    assert f"{frames.lrc(bytes.fromhex(check['data'])):02X}" == check["lrc"]


def test_model_tells_the_kinds_of_bad_frames_apart_in_ascii():
    slave, good = Slave(Config(timeout=50)), frames.ascii_adu(17, frames.read(3, 0, 1))
    cases = {
        "crc": [
            good[:-3] + b"0\r\n",
            good[:-2] + b"g0\r\n",
            good[:-2] + b"0\r\n",
            good[:-1] + b"0",
            good[:-2] + b"\r\r",
        ],
        "short": [b":\r\n", b":1\r\n", b":1107\r\n"],
        "long": [good[:-2] + b"0" * 500 + b"\r\n"],
        "gap": [[*good[:8], (good[8], 51, None), *good[9:]]],
        "parity": [[(58, 0, "parity"), *good[1:]], [*good[:-1], (10, 0, "parity")]],
    }
    for kind, lines in cases.items():
        for line in lines:
            assert slave.hear(line) is None, (kind, line)
            assert slave.errors == {kind}, (kind, line, slave.errors)
    bad = slave.counters["bus_comm_error"]
    assert bad == sum(map(len, cases.values()))
    assert slave.hear(b"garbage" + good) is not None and slave.hear(b"::" + good) is not None
    assert slave.counters["bus_comm_error"] == bad and not slave.errors
    assert slave.hear(good[:5] + good) is not None and slave.counters["bus_comm_error"] == bad + 1
    assert slave.hear(b":11") is None and slave.fall_silent() is None and slave.errors == {"gap", "short"}
    with pytest.raises(ValueError):
        slave.hear(good + good)


def test_vectors_are_all_played_or_explained():
    explained = vectors.unplayable()
    every = vectors.document()["vectors"]
    played = vectors.playable() + vectors.pdm() + vectors.in_ascii()
    assert len(played) + len(explained) == len(every)
    assert all(reason for _, reason in explained)
    few = frozenset((FC.READ_COILS, FC.READ_HOLDINGS))
    assert {vectors.frame(v["request"])[1] for v in vectors.playable(few) if v["request_check_ok"]} >= few
    assert len(vectors.unplayable(few)) > len(explained)


CHARACTERS = [c for c in vectors.document()["char_checks"] if c["format"] in FORMAT_BY_NAME]


@pytest.mark.parametrize("check", CHARACTERS, ids=lambda c: f"{c['byte']}-{c['format']}")
def test_line_bits_of_the_sources(check):
    fmt = FORMAT_BY_NAME[check["format"]]
    sent = wave.encode(bytes.fromhex(check["byte"]), fmt, BIT)
    level, seen, edges = wave.IDLE, "", list(sent.edges)
    for bit in range(fmt.length):
        while edges and edges[0][0] <= bit * BIT:
            level = edges.pop(0)[1]
        seen += str(level)
    assert seen == check["line_bits"]


@pytest.mark.parametrize("fmt", FORMATS, ids=lambda f: f.name)
def test_decoder_reads_what_the_encoder_wrote(fmt):
    data = random.Random(fmt.code).randbytes(300)
    sent = wave.encode(data, fmt, BIT)
    got = wave.decode(sent.edges, fmt, BIT)
    assert (got.data, got.start, got.end) == (data, 0, sent.end)


def test_decoder_rejects_what_is_not_clean():
    fmt = FORMATS[0]
    for line in ([0x12, (0x34, 1 / fmt.length, None)], [(0x12, 0, "parity")], [(0, 0, "framing")]):
        with pytest.raises(wave.LineError):
            wave.decode(wave.encode(line, fmt, BIT).edges, fmt, BIT)
    stretched = wave.encode(b"\x55", fmt, BIT, offset=0.01)
    with pytest.raises(wave.LineError):
        wave.decode(stretched.edges, fmt, BIT)


def test_spikes_turn_the_line_for_their_width():
    edges = wave.with_spikes([(100, 0), (200, 1)], [(120, 10), (250, 5)])
    assert edges == [(100, 0), (120, 1), (130, 0), (200, 1), (250, 0), (255, 1)]


def test_model_tells_the_kinds_of_bad_frames_apart():
    good = list(frames.adu(17, frames.read(3, 0, 1)))
    slave = Slave()
    cases = {
        "crc": [*good[:-1], good[-1] ^ 1],
        "short": good[:3],
        "long": [0] * 257,
        "gap": [*good[:4], (good[4], 2.0, None), *good[5:]],
        "parity": [*good[:4], (good[4], 0, "parity"), *good[5:]],
        "framing": [*good[:4], (good[4], 0, "framing"), *good[5:]],
    }
    for kind, line in cases.items():
        assert slave.request(line) is None, kind
        assert slave.errors == {kind}
    assert slave.request(good) is not None and not slave.errors
    slave.config.gap_count_only = True
    assert slave.request(cases["gap"]) is not None and slave.errors == {"gap"}
    with pytest.raises(ValueError):
        slave.request([*good[:4], (good[4], 4.0, None), *good[5:]])


def test_overlay_is_one_memory():
    tables = {
        Space.COILS: (0, 64),
        Space.DISCRETES: (0, 64),
        Space.INPUTS: (0, 4),
        Space.HOLDINGS: (0, 4),
    }
    slave = Slave(Config(tables=tables, overlay=True))
    slave.request(frames.adu(17, frames.write_register(2, 0x8001)))
    assert [slave.memory[Space.COILS, 32 + i] for i in range(16)] == [1] + 14 * [0] + [1]
    assert slave.memory[Space.INPUTS, 2] == 0x8001
    slave.request(frames.adu(17, frames.write_coil(33, True)))
    assert slave.memory[Space.HOLDINGS, 2] == 0x8003


def test_a_function_table_without_holes():
    assert list(FUNCTIONS) == sorted(FC) and ALL_FUNCTIONS == set(FC)
    assert build.function_mask(ALL_FUNCTIONS) == number("MB_ALL_FUNCTIONS")
    assert {code for code, row in FUNCTIONS.items() if row.broadcast} == {5, 6, 15, 16}
    assert [code for code, row in FUNCTIONS.items() if not row.counts] == [FC.GET_EVENT_COUNTER]
    assert all((row.reads or row.writes) == (row.space is not None) for row in FUNCTIONS.values())


ITEMS = {
    "server_id": b"\0\1\2",
    "additional_data": bytes(5) + b"\xff",
    "objects": {0: b"A" * 244, 1: b"B", 2: b"\x80C", 4: b"four", 0x80: b"", 0x81: b"private", 0xFF: b"\xff"},
    "conformity": 0x83,
    "device_id_limit": 253,
    "files": (3, 1000),
    "user_codes": frozenset((65, 72, 100, 127)),
    "functions": ALL_FUNCTIONS - {FC.DIAGNOSTICS, FC.READ_DEVICE_ID},
    "tables": {Space.COILS: (3, 4), Space.DISCRETES: (0, 0), Space.INPUTS: (9, 9), Space.HOLDINGS: (65535, 1)},
    "read_only": (65535, 1),
    "limits": Limits(read_bits=1000, rw_write=5),
}


@pytest.mark.parametrize("sim", ["icarus", "verilator"])
def test_parameters_and_back(sim):
    parameters = build.for_simulator(sim, build.config_parameters(ITEMS))
    seen = build.model_config("modbus_rtu_slave", parameters)
    for name, value in ITEMS.items():
        assert getattr(seen, name) == value, name
    if sim == "verilator":
        assert parameters["VENDOR_NAME"] == "1952'h" + "41" * 244


def test_defaults_of_the_tops():
    for top, files in (("slave", (0, 256)), ("slave_io", (0, 256)), ("core", (4, 256))):
        seen = build.model_config(f"modbus_rtu_{top}", {})
        assert (seen.files, seen.functions) == (files, ALL_FUNCTIONS)
        plain = Config()
        for name in ("server_id", "additional_data", "objects", "conformity", "device_id_limit", "user_codes"):
            assert getattr(seen, name) == getattr(plain, name), name
        assert seen.supports(FC.READ_FILE) == (top == "core")
    assert build.model_config("modbus_rtu_slave", build.REFERENCE).files == Config().files


def test_traffic_reaches_everything(seed):
    """Every function succeeds and is refused, every sub-function is asked for, and the slave wakes up again."""
    slave = Slave(Config(user_codes=frozenset({USER_CODE})))
    slave.user = lambda pdu: pdu
    traffic = Traffic(random.Random(seed), slave.config, slave)
    seen, listening = set(), 0
    for _ in range(6000):
        line, kind = traffic.line()
        answer = slave.request(line)
        listening += slave.listen_only
        if isinstance(line, bytes) and kind != "foreign" and answer:
            assert 1 <= len(answer) - 3 <= LONGEST_PDU and frames.check(answer)
            seen.add((line[1], answer[2] if answer[1] & 0x80 else 0))
    assert {(code, 0) for code in ALL_FUNCTIONS | {USER_CODE}} <= seen
    assert {(code, 3) for code in ALL_FUNCTIONS} <= seen
    touching = {code for code, row in FUNCTIONS.items() if row.space is not None}
    assert {(code, 2) for code in touching} <= seen
    assert 0 < listening < 600
