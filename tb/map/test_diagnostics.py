# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the map compiler says of maps that are wrong: each line of `diagnostics.yaml`, with its place.

One that is wrong writes nothing and ends with exit status 2; a warning changes neither.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from modbus_map import checks, csv_door, loader
from modbus_map.diagnostics import MapError
from ruamel.yaml import YAML

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
CASES = {case["name"]: case for case in YAML(typ="safe").load(HERE / "diagnostics.yaml")}


def said(text, file="map.yaml", parse=loader.parse):
    """(lines without the file's name, True if the map is refused)."""
    try:
        _, notes = checks.compile_source(parse(text, file))
        refused = False
    except MapError as error:
        notes, refused = error.diagnostics, True
    return [str(note).removeprefix(f"{file}:") for note in notes], refused


def modbus(*arguments, **options):
    """The command, run as a user runs it."""
    command = [sys.executable, str(ROOT / "tools/modbus"), "map", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


@pytest.mark.parametrize("name", CASES)
def test_wrong_map_is_told_with_its_place(name):
    lines, refused = said(CASES[name]["map"])
    assert lines == CASES[name]["says"]
    assert refused == any(": warning: " not in f"{line}" for line in lines)
    for line in lines:
        assert re.match(r"\d+:\d+: \S", line) and "\n" not in line


def test_there_are_many():
    texts = {re.sub(r"\d+|'[^']*'", "", line.split(": ", 1)[1]) for case in CASES.values() for line in case["says"]}
    assert len(texts) >= 120, f"{len(texts)} different ones"


@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith("warn")])
def test_place_is_inside_the_file(name):
    text = CASES[name]["map"]
    lines = text.split("\n")
    for said_line in CASES[name]["says"]:
        line, column = map(int, said_line.split(":")[:2])
        assert 1 <= line <= len(lines) and 1 <= column <= len(lines[line - 1]) + 1, said_line


def test_number_of_thousands_of_digits_is_no_trap():
    lines, refused = said(f"device: box\ncoils:\n  - {{at: {'9' * 5000}, name: a}}\n")
    assert refused and lines[0].startswith("3:10: 99999")


# ------------------------------------------------------------------ at the command line


def test_all_errors_at_once_exit_2_and_nothing_is_written(tmp_path):
    file, out = tmp_path / "box.yaml", tmp_path / "out"
    file.write_text(CASES["all_at_once"]["map"])
    done = modbus("build", file, "-o", out)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.splitlines() == [f"{file}:{line}" for line in CASES["all_at_once"]["says"]]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["box.yaml"]


def test_warning_goes_to_standard_error_and_the_map_is_built(tmp_path):
    file, out = tmp_path / "box.yaml", tmp_path / "out"
    file.write_text(CASES["warn_gap"]["map"])
    done = modbus("build", file, "-o", out)
    assert done.returncode == 0 and ": warning: " in done.stderr
    assert out.is_dir() and sorted(path.name for path in tmp_path.iterdir()) == ["box.yaml", "out"]


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda path: None, "1:1: no such file; name the map file"),
        (lambda path: path.mkdir(), "1:1: this is a folder; name the map file in it"),
        (
            lambda path: path.write_bytes(b"device: box\ntitle: B\xe4hr\n"),
            "2:9: byte E4 is no UTF-8; save the file as UTF-8",
        ),
        (
            lambda path: path.write_bytes(b"x" * 4_000_001),
            "1:1: 4000001 bytes are no map file; at most 4000000 are read",
        ),
    ],
)
def test_file_that_cannot_be_read(tmp_path, make, text):
    path = tmp_path / "box.yaml"
    make(path)
    done = modbus("check", path)
    assert (done.returncode, done.stderr) == (2, f"{path}:{text}\n")


def test_output_folder_that_is_a_file(tmp_path):
    file, out = tmp_path / "box.yaml", tmp_path / "out"
    file.write_text("device: box\ncoils: [{at: 0, name: a}]\n")
    out.write_text("")
    done = modbus("build", file, "-o", out)
    assert done.returncode == 2 and done.stderr == f"modbus: {out}: is a file, not a folder; name a folder\n"


def test_unknown_output(tmp_path):
    done = modbus("build", tmp_path / "x", "-o", tmp_path / "y", "--only", "verilgo")
    assert done.returncode == 2 and done.stderr.startswith("modbus: no output verilgo; known are verilog, ")


def test_make_map_without_variables():
    text = (ROOT / "Makefile").read_text()
    assert 'echo "map: FILE=device.yaml OUT=folder" >&2; exit 2' in text


# ------------------------------------------------------------------ the CSV door

CSV = "# device: box\ntable,at,name,type,min,max,default,unit\n"
CSV_CASES = {
    "column": ("table,at,name,tpye\ncoil,0,a,\n", ["1:15: unknown column tpye; did you mean type?"]),
    "no name": ("table,at\ncoil,0\n", [
            "1:1: there is no column name; the header is table,at,name,type,...",
            "2:1: the key name is missing; write name: relay"]),
    "two columns": ("table,at,address,name\ncoil,0,,a\n", ["1:10: a second column for at; leave one out"]),
    "table": (CSV + "holdin,0,a,u16,,,,\n", ["3:1: holdin is no table; did you mean holding?"]),
    "value": (CSV + "holding,0,a,u16,0,9,70000,V\n", ["3:21: reset 70000 is outside the type; u16 is 0 to 65535"]),
    "overlap": (CSV + 'holding,0,"a",u32,,,,\nholding,1,b,u16,,,,\n',
        ["4:9: b (1) overlaps a (0 to 1) of line 3; the next free address is 2"]),
    "name behind quotes": (CSV + '"holding","0","reg",u16,,,,\n',
        ["3:15: reg is a keyword of Verilog; take another name, for example reg_value"]),
    "more cells": (CSV + "holding,0,a,u16,,,,V,more,\n", ["3:22: 10 cells in a table of 8 columns; quote the text"]),
    "number": ("number;name\n4x;a\n", ["2:1: 4x is no register number; write one such as 40001, or a column at"]),
    "quote": (CSV + 'holding,0,"a,u16\n', ["3:1: no CSV: unexpected end of data; check the quotes"]),
    "head": ("# devise: box\ntable,at,name\ncoil,0,a\n", ["1:3: unknown key devise; did you mean device?"]),
    "empty": ("# device: box\n", ["1:1: the table has no header; write table,at,name,type,..."]),
}  # fmt: skip


@pytest.mark.parametrize("name", CSV_CASES)
def test_wrong_table_is_told_with_its_cell(name):
    text, expected = CSV_CASES[name]
    lines, refused = said(text, "box.csv", csv_door.parse)
    assert (lines, refused) == (expected, True)
