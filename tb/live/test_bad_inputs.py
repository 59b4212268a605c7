# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make serve` with variables and INIT files it must refuse: one line, exit status 2, nothing left behind."""

import json
import os

import pytest

from live.serve import refuse


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links and INIT files of this module live."""
    return tmp_path_factory.mktemp("bad")


BAD_VARIABLES = [
    {"ADDRESS": "0"},
    {"ADDRESS": "248"},
    {"ADDRESS": "seventeen"},
    {"BAUD": "0"},
    {"BAUD": "fast"},
    {"BAUD": "-9600"},
    {"PARITY": "mark"},
    {"STOP": "3"},
    {"PARITY": "even", "STOP": "2"},
    {"MAP": "coils=1"},
    {"MAP": "valves=0+1"},
    {"MAP": "coils=65535+2"},
    {"MAP": "coils=0+x"},
    {"MAP": "coils=0+8 coils=0+8"},
    {"MAP": "files=4"},
    {"MAP": "files=4+256"},
    {"MAP": "files=4x0"},
    {"MAP": "files=1x10001"},
    {"MAP": "files=257x256"},
    {"MAP": "files=1x8 files=1x8"},
    {"DEVICE": "meter"},
    {"DEVICE": "pdm", "MAP": "coils=0+8"},
    {"INIT": "no/such/file.json"},
    {"MAP": "coils=0+0"},
    {"MAP": "files=4x16"},
    {"HOLD": "-1"},
    {"HOLD": "10001"},
    {"HOLD": "long"},
    {"BAUD": "28"},
    {"BAUD": "230401"},
    {"FAULT": "request"},
    {"FAULT": "request flip; answer flip bit=9"},
]


@pytest.mark.parametrize("variables", BAD_VARIABLES, ids=lambda v: " ".join(f"{k}={x}" for k, x in v.items()))
def test_bad_variable_is_one_line_and_exit_2(folder, variables):
    status, lines = refuse(**{"LINK": folder / "bad", **variables})
    assert status == 2, lines
    assert len(lines) == 1, lines
    assert not os.path.lexists(folder / "bad")


NEAR_MISSES = {
    "ADDR": "ADDRESS", "addr": "ADDRESS", "ADRESS": "ADDRESS", "ADDRESSE": "ADDRESS", "UNIT": "ADDRESS",
    "BAUDRATE": "BAUD", "BAUD_RATE": "BAUD", "Baud": "BAUD", "PARTY": "PARITY", "STOPBITS": "STOP", "SLAVE": "SLAVES",
    "LNK": "LINK", "INITIAL": "INIT", "DEVISE": "DEVICE", "FAULTS": "FAULT",
}  # fmt: skip


@pytest.mark.parametrize("name", NEAR_MISSES)
def test_name_that_is_nearly_one_of_ours_is_refused(folder, name):
    status, lines = refuse(LINK=folder / "bad", **{name: "5"})
    assert status == 2 and len(lines) == 1, lines
    assert lines[0] == f"serve: {name}: unknown variable; {NEAR_MISSES[name]} is meant?"


BAD_INIT = {
    "malformed": "{",
    "not an object": "[]",
    "unknown table": '{"valves": {"0": [1]}}',
    "address outside": '{"coils": {"1024": [1]}}',
    "runs out of the table": '{"holdings": {"2047": [1, 2]}}',
    "negative address": '{"inputs": {"-1": [1]}}',
    "word too large": '{"holdings": {"0": [65536]}}',
    "bit too large": '{"coils": {"0": [2]}}',
    "value no number": '{"holdings": {"0": ["x"]}}',
    "values no list": '{"holdings": {"0": 5}}',
    "file outside": '{"files": {"5": {"0": [1]}}}',
    "file 0": '{"files": {"0": {"0": [1]}}}',
    "record outside": '{"files": {"4": {"255": [1, 2]}}}',
    "record too large": '{"files": {"1": {"0": [65536]}}}',
    "file no object": '{"files": {"1": [1]}}',
    "exception status too large": '{"exception_status": 256}',
    "exception status a text": '{"exception_status": "6D"}',
    "busy 2": '{"busy": 2}',
    "run indicator true": '{"run_indicator": true}',
    "failure 16": '{"failure": 16}',
    "diagnostic bit 0": '{"diagnostic": 32769}',
    "diagnostic too large": '{"diagnostic": 65536}',
    "no server id": '{"server_id": []}',
    "server id too long": json.dumps({"server_id": [1] * 17}),
    "server id no byte": '{"server_id": [256]}',
    "additional data too long": json.dumps({"additional_data": [0] * 250}),
    "additional data a text": '{"additional_data": "abc"}',
    "conformity 0": '{"conformity": 0}',
    "conformity 84": '{"conformity": 132}',
    "objects a list": '{"device_id": ["VENDOR"]}',
    "reserved object": '{"device_id": {"7": "x"}}',
    "object twice": '{"device_id": {"128": "x", "0x80": "y"}}',
    "vendor empty": '{"device_id": {"0": ""}}',
    "object too long": json.dumps({"device_id": {"3": "x" * 245}}),
    "object not ASCII": '{"device_id": {"3": "\\u00e9"}}',
    "object no text": '{"device_id": {"0": 1}}',
    "private objects too long": json.dumps({"device_id": {"128": "x" * 244, "129": "x" * 244, "130": "x" * 20}}),
    "texts too long": json.dumps({"device_id": {str(i): "x" * 244 for i in range(7)} | {"200": "x" * 244}}),
    "events of another device": '{"events": []}',
    "key twice": '{"busy": 1, "busy": 0}',
}

EVENT = dict(zip(("group", "code", "closed", "ms", "minute", "hour", "day", "month"), (4, 9, 1, 19877, 25, 18, 23, 1)))
BAD_METER_INIT = {
    "coils": {"coils": {"0": [1]}},
    "inputs": {"inputs": {"0": [1]}},
    "fifth input": {"discretes": {"4": [1]}},
    "register 512": {"holdings": {"512": [1]}},
    "files": {"files": {"1": {"0": [1]}}},
    "exception status": {"exception_status": 1},
    "identity": {"server_id": [1]},
    "events no list": {"events": {}},
    "event no object": {"events": [[4, 9]]},
    "event without its year": {"events": [EVENT]},
    "event with a wrong year": {"events": [EVENT | {"year": 7}]},
    "event with a wrong day": {"events": [EVENT | {"year": 2007, "day": 0}]},
    "too many events": {"events": [EVENT | {"year": 2007}] * 33},
}


@pytest.mark.parametrize("name", BAD_INIT)
def test_bad_init_is_one_line_and_exit_2(folder, name):
    init = folder / "bad.json"
    init.write_text(BAD_INIT[name], encoding="utf-8")
    status, lines = refuse(LINK=folder / "bad", INIT=init)
    assert status == 2, lines
    assert len(lines) == 1, lines


@pytest.mark.parametrize("name", BAD_METER_INIT)
def test_bad_init_of_the_meter_is_one_line_and_exit_2(folder, name):
    init = folder / "bad_meter.json"
    init.write_text(json.dumps(BAD_METER_INIT[name]), encoding="utf-8")
    status, lines = refuse(DEVICE="pdm", LINK=folder / "bad", INIT=init)
    assert status == 2, lines
    assert len(lines) == 1, lines


def test_link_that_is_no_link_is_left_alone(folder):
    mine = folder / "mine"
    mine.write_text("keep me", encoding="utf-8")
    status, lines = refuse(LINK=mine)
    assert status == 2 and len(lines) == 1, lines
    assert mine.read_text(encoding="utf-8") == "keep me"
    status, lines = refuse(LINK=folder / "no" / "such" / "folder")
    assert status == 2 and len(lines) == 1, lines
