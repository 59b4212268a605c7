# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The bench itself: model, frame helpers and line coding against the printed examples."""

import random

import pytest
from mbrtu import frames, vectors, wave
from mbrtu.defs import FORMAT_BY_NAME, FORMATS, Limits, Space
from mbrtu.model import Config, Slave

BIT = 1000


@pytest.mark.parametrize("check", vectors.document()["crc_checks"], ids=lambda c: c["crc"])
def test_crc_of_the_sources(check):
    crc = frames.crc16(bytes.fromhex(check["data"]))
    assert f"{crc:04X}" == check["crc"]


@pytest.mark.parametrize("vector", vectors.playable(), ids=lambda v: v["id"])
def test_model_answers_as_printed(vector):
    limits = Limits(**vectors.limits(vector))
    slave = Slave(Config(address=vector["slave_address"], limits=limits))
    for key, value in vectors.contents(vector["preconditions"]):
        slave.memory[key] = value
    assert slave.request(vectors.frame(vector["request"])) == vectors.frame(vector["expected_response"])
    for key, value in vectors.contents(vector["postconditions"]):
        assert slave.memory[key] == value


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
