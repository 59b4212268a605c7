# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Illegal parameters stop elaboration; docs/parameters.md says what the RTL has."""

import random
import re
import shutil
import subprocess

import parameter_space
import pytest
from harness.build import config_parameters, for_simulator, function_mask, text_value
from harness.runner import ROOT, sources
from harness.volume import volume
from interface import DERIVED, fields, header, macros, number
from protocol.defs import ALL_FUNCTIONS, CONFORMITIES, FC, LONGEST_OBJECT

SLAVE, IO, CORE = "modbus_rtu_slave", "modbus_rtu_slave_io", "modbus_rtu_core"
TOPS = (SLAVE, IO, CORE)
DOCUMENT = ROOT / "docs" / "parameters.md"

# ------------------------------------------------------------------ illegal parameters

NO_TABLES = dict.fromkeys(("COIL_COUNT", "DISCRETE_COUNT", "INPUT_COUNT", "HOLDING_COUNT"), 0)
EVERYTHING = config_parameters(
    {
        "files": (4, 256),
        "server_id": bytes(range(16)),
        "additional_data": bytes(range(234)),
        "objects": dict.fromkeys(range(7), b"a" * 180) | dict.fromkeys(range(0x80, 0x88), b"b" * 10),
        "conformity": 0x83,
    }
)

LEGAL = [
    (SLAVE, {}),
    (IO, {}),
    (SLAVE, {"ADDRESS": 0, "BAUD": 763, "FORMAT": 3, "RESPONSE_DELAY": 4095, "STALL_LIMIT": 65535, "DE_LEAD": 15}),
    (SLAVE, {"BAUD": 6_250_000, "DE_TAIL": 15, "DROP_LATE": 1, "STRICT_TURNAROUND": 1, "GAP_COUNT_ONLY": 1}),
    (IO, {"CLK_HZ": 12_000_000, "BAUD": 921_600, "BROADCAST": 0}),
    (IO, {"CLK_HZ": 12_000_000, "BAUD": 1_228_800, "BIT_FRACTIONS": 1}),  # 9.77 clocks
    (IO, {"CLK_HZ": 27_000_000, "BAUD": 1_000_000, "GLITCH_FILTER": 6}),
    (SLAVE, {"CLK_HZ": 1_000_000_000, "BAUD": 115_200, "BIT_FRACTIONS": 1, "GLITCH_FILTER": 255}),
    (CORE, {}),
    (SLAVE, {"ASCII_MODE": 1, "ASCII": 1, "ASCII_DATA_BITS": 8, "ASCII_EXTRA": 3, "ASCII_TIMEOUT_MS": 21_474}),
    (CORE, {"ASCII_MODE": 1, "CLK_HZ": 1_000_000_000, "ASCII_TIMEOUT_MS": 1073}),
    (CORE, {"ASCII_MODE": 1, "CLK_HZ": 1000, "ASCII_TIMEOUT_MS": 1, "T15_MIN_US": 0, "T35_MIN_US": 0}),
    (SLAVE, {"COIL_COUNT": 65536, "DISCRETE_COUNT": 0, "INPUT_BASE": 65535, "INPUT_COUNT": 1}),
    (SLAVE, {"T15_MIN_US": 0, "T35_MIN_US": 0, "MAX_READ_BITS": 1, "RW_MAX_WRITE": 1}),
    (SLAVE, {"READ_ONLY_BASE": 65535, "READ_ONLY_COUNT": 1}),
    (SLAVE, {"OVERLAY": 1, "HOLDING_COUNT": 1}),
    (SLAVE, {"BITS_PER_BEAT": 16, "COIL_BASE": 7, "COIL_COUNT": 65529}),
    (IO, {"BITS_PER_BEAT": 16, "COIL_BASE": 65535, "COIL_COUNT": 1, "DISCRETE_COUNT": 0}),
    (IO, {"COIL_COUNT": 1, "DISCRETE_COUNT": 0, "INPUT_COUNT": 0, "HOLDING_COUNT": 0}),
    *((IO, {"READ_BACK_RAM": 1, "HOLDING_COUNT": count}) for count in (0, 1, 300)),
    (IO, {"LINE_HEALTH": 1}),
    (IO, {"LINE_HEALTH": 1, "INPUT_BASE": 65520, "INPUT_COUNT": 16, "COIL_BASE": 9, "HEALTH_COIL": 9}),
    (SLAVE, {"LINE_HEALTH": 1, "HOST_SETTINGS": 1}),
    (CORE, {"FUNCTION_CODES": function_mask([FC.READ_HOLDINGS])}),
    *((CORE, {"FUNCTION_CODES": function_mask([code])}) for code in sorted(ALL_FUNCTIONS)),
    (CORE, {"FUNCTION_CODES": 0, "USER_CODES": function_mask(range(1, 128))}),
    (SLAVE, {**EVERYTHING, "USER_CODES": function_mask(range(1, 128))}),
    (SLAVE, {"FILE_COUNT": 256, "FILE_RECORDS": 256}),
    (SLAVE, {"FILE_COUNT": 6, "FILE_RECORDS": 10000}),
    (SLAVE, {"FILE_COUNT": 65535, "FILE_RECORDS": 1}),
    (SLAVE, {**NO_TABLES, "FILE_COUNT": 1}),
    *((CORE, {"CONFORMITY": conformity}) for conformity in CONFORMITIES),
    (CORE, {"UNIT_SET": 2, "UNIT_PORT": 1}),
    (CORE, {"DEVICE_ID_LIMIT": 9 + len("PRODUCT")}),
    (CORE, {"PRIVATE_OBJECTS": text_value(b"\x80\0\x81\1a\xff\2bc")}),
    (CORE, {"PRIVATE_OBJECTS": text_value(b"\x80" + bytes([LONGEST_OBJECT]) + b"a" * LONGEST_OBJECT)}),
    ("modbus_axil_master", {"HOLDING_AT": 0x1004, "GUARD": 0, "COIL_BASE": 65535, "COIL_COUNT": 2}),
    # what does not exist is not judged
    (CORE, {"FUNCTION_CODES": function_mask([FC.READ_HOLDINGS]), "CONFORMITY": 0}),
]
SOME_CODES = {0, 9, 10, 13, 14, 18, 19, 25, 42, 44, 63, 65, 127}
ILLEGAL = [
    (SLAVE, {"COIL_COUNT": 65537}),
    (SLAVE, {"COIL_COUNT": -1}),
    (SLAVE, {"ADDRESS": 248}),
    (IO, {"ADDRESS": -1}),
    (SLAVE, {"BAUD": 0}),
    (IO, {"CLK_HZ": 12_000_000, "BAUD": 1_228_800}),  # rounded to 10: 2.4 % off
    (SLAVE, {"BAUD": 6_300_000, "BIT_FRACTIONS": 1}),  # 7.94 clocks
    (CORE, {"BIT_FRACTIONS": 2}),
    (CORE, {"ASCII_MODE": 2}),
    (SLAVE, {"ASCII": 1}),
    (IO, {"ASCII_MODE": 1, "ASCII": 2}),
    (SLAVE, {"ASCII_DATA_BITS": 6}),
    (IO, {"ASCII_EXTRA": 4}),
    (CORE, {"ASCII_TIMEOUT_MS": 0}),
    (CORE, {"ASCII_TIMEOUT_MS": 21_475}),
    (CORE, {"MAX_BIT_TIME": 7}),
    (SLAVE, {"HOST_SETTINGS": 1, "HOST_MAP": 1, "MAX_BIT_TIME": 65536}),
    (CORE, {"GLITCH_FILTER": 256}),
    *((top, {"LINE_HEALTH": 2}) for top in (IO, SLAVE)),
    (IO, {"LINE_HEALTH": 1, "INPUT_COUNT": 7}),
    *((IO, {"LINE_HEALTH": 1, "COIL_BASE": 4, "COIL_COUNT": 8, "HEALTH_COIL": coil}) for coil in (3, 12)),
    (CORE, {"UNIT_SET": 1}),
    (CORE, {"UNIT_PORT": 2}),
    *((top, {"BITS_PER_BEAT": bits}) for top in TOPS for bits in (0, 2, 8, 15, 17)),
    (IO, {"CLK_HZ": 27_000_000, "BAUD": 1_000_000, "GLITCH_FILTER": 7}),  # 27 clocks a bit
    (SLAVE, {"BAUD": 700}),  # 71429 clocks a bit
    (SLAVE, {"BAUD": 6_500_000}),  # 7.7 clocks, rounded to 8: 4 % off
    (IO, {"CLK_HZ": 10_000_000, "BAUD": 1_050_000}),  # 9.52 clocks, rounded to 10: 5 % off
    (SLAVE, {"FORMAT": 4}),
    (SLAVE, {"RESPONSE_DELAY": 4096}),
    (SLAVE, {"STALL_LIMIT": 65536}),
    (SLAVE, {"DE_LEAD": 16}),
    (IO, {"DE_TAIL": -1}),
    (SLAVE, {"BROADCAST": 2}),
    (IO, {"GAP_COUNT_ONLY": -1}),
    (SLAVE, {"COIL_BASE": 65535, "COIL_COUNT": 2}),
    (SLAVE, {"DISCRETE_BASE": 65500, "DISCRETE_COUNT": 64}),
    (SLAVE, {"INPUT_BASE": 65536, "INPUT_COUNT": 1}),
    (IO, {"HOLDING_BASE": 65530, "HOLDING_COUNT": 7}),
    (SLAVE, NO_TABLES),
    (IO, NO_TABLES),
    (SLAVE, {"READ_ONLY_BASE": 65535, "READ_ONLY_COUNT": 2}),
    (SLAVE, {"READ_ONLY_COUNT": -1}),
    (SLAVE, {"OVERLAY": 1, "HOLDING_COUNT": 0}),
    (SLAVE, {"MAX_READ_BITS": 0}),
    (SLAVE, {"MAX_READ_BITS": 2001}),
    (SLAVE, {"MAX_WRITE_BITS": 1969}),
    (SLAVE, {"MAX_READ_REGISTERS": 126}),
    (SLAVE, {"MAX_READ_REGISTERS": 0}),
    (SLAVE, {"MAX_WRITE_REGISTERS": 124}),
    (CORE, {"RW_MAX_READ": 126}),
    (CORE, {"RW_MAX_WRITE": 122}),
    (CORE, {"RW_MAX_WRITE": 0}),
    (CORE, {"T15_MIN_US": 1751}),
    (CORE, {"T15_MIN_US": -1}),
    (CORE, {"CLK_HZ": 0}),
    (CORE, {"ALIVE_TIMEOUT_MS": -1}),
    *((CORE, {"FUNCTION_CODES": 1 << code}) for code in sorted(SOME_CODES - ALL_FUNCTIONS)),
    (SLAVE, {"FUNCTION_CODES": 1 << 9}),
    (IO, {"FUNCTION_CODES": 1 << 44}),
    (SLAVE, {"FILE_COUNT": -1}),
    (SLAVE, {"FILE_COUNT": 257, "FILE_RECORDS": 256}),
    (SLAVE, {"FILE_COUNT": 7, "FILE_RECORDS": 10000}),
    (SLAVE, {"FILE_COUNT": 65536, "FILE_RECORDS": 1}),
    (SLAVE, {"FILE_COUNT": 1, "FILE_RECORDS": 10001}),
    (SLAVE, {"FILE_COUNT": 1, "FILE_RECORDS": 0}),
    *((CORE, {"SERVER_ID_BYTES": count}) for count in (-1, 0, 17)),
    *((CORE, {"ADDITIONAL_DATA_BYTES": count}) for count in (-1, 250)),
    *((CORE, {"CONFORMITY": conformity}) for conformity in (0x00, 0x04, 0x05, 0x43, 0x80, 0x84)),
    (CORE, {"DEVICE_ID_LIMIT": 254}),
    (CORE, {"DEVICE_ID_LIMIT": 9 + len("PRODUCT") - 1}),
    *(
        (CORE, {"PRIVATE_OBJECTS": text_value(objects)})
        for objects in (
            b"\x7f\1a",  # no private number
            b"\x81\1a\x80\1b",  # not ascending
            b"\x80\1a\x80\1b",
            b"\x80\2a",  # less than its length says
            b"\x80",
            b"\x80\1a\x90",
            b"\x80" + bytes([LONGEST_OBJECT + 1]) + b"a" * (LONGEST_OBJECT + 1),
        )
    ),
    (CORE, config_parameters({"objects": dict.fromkeys((*range(7), 0x80, 0x81), b"a" * LONGEST_OBJECT)})),
    ("modbus_axil_master", {"HOLDING_AT": 0x1002}),
    ("modbus_axil_master", {"COIL_BASE": 65535, "COIL_COUNT": 2}),
    ("modbus_axil_master", {"OVERLAY": 1}),
    (IO, {"FILE_COUNT": 1}),
    (IO, {"OVERLAY": 1}),
    *((IO, {"READ_BACK_RAM": value}) for value in (-1, 2)),
    ("modbus_example_ram", {"WORDS": 65537}),
]


def name(case):
    """A test's name for (top, parameters)."""
    top, parameters = case
    values = {k: v if v < 1 << 31 else f"{v:#x}"[:20] for k, v in parameters.items()}
    return "-".join([top.removeprefix("modbus_rtu_"), *(f"{k}={v}" for k, v in values.items())])


def elaborate(tool, top, parameters):
    """(exit status, messages) of elaborating `top`."""
    files, folders = sources()
    parameters = for_simulator(tool, parameters)
    if tool == "icarus":
        command = ["iverilog", "-g2005", "-Wall", "-tnull", "-s", top]
        command += [f"-I{f}" for f in folders] + [f"-P{top}.{k}={v}" for k, v in parameters.items()]
    else:
        command = ["verilator", "--lint-only", "--language", "1364-2005", "-Wno-fatal", "--top-module", top]
        command += [f"-I{f}" for f in folders] + [f"-G{k}={v}" for k, v in parameters.items()]
    if not shutil.which(command[0]):
        pytest.skip(f"{command[0]} is not installed")
    done = subprocess.run([*command, *map(str, files)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def judged(cases):
    """Every case in Icarus, and those that the volume says in Verilator, which takes five times as long."""
    step = 100 // volume("percent of the sets of parameters in Verilator")
    runs = [("icarus", case) for case in cases] + [("verilator", case) for case in cases[::step]]
    return pytest.mark.parametrize("tool,case", runs, ids=[f"{name(case)}-{tool}" for tool, case in runs])


@judged(LEGAL)
def test_legal_parameters_elaborate(tool, case):
    status, messages = elaborate(tool, *case)
    assert status == 0, messages
    assert "ERROR_" not in messages


@judged(ILLEGAL)
def test_illegal_parameters_stop_elaboration(tool, case):
    """With the rule as the name of a missing module."""
    status, messages = elaborate(tool, *case)
    assert status != 0, f"{name(case)} was accepted"
    assert "ERROR_modbus" in messages, messages


@pytest.mark.parametrize("module", sorted(parameter_space.SPACE))
def test_drawn_parameters_are_legal(module, seed):
    """The parameter space that lint draws from: two sets of each module elaborate."""
    rng = random.Random(f"{seed} {module}")
    for _ in range(2):
        drawn = parameter_space.draw(module, rng)
        status, messages = elaborate("icarus", module, drawn)
        assert status == 0 and "ERROR_" not in messages, f"{drawn}: {messages}"


# ------------------------------------------------------------------ the document


def rows():
    """(columns, cells) of every table row of the document whose first cell is a `name`."""
    columns, out = [], []
    for line in DOCUMENT.read_text(encoding="utf-8").splitlines():
        if not line.startswith("|"):
            columns = []
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not columns:
            columns = cells
        elif re.fullmatch(r"`\w+`", cells[0]):
            out.append((columns, [cells[0].strip("`"), *cells[1:]]))
    return out


def documented(kind):
    """{name: {column: cell}} of the parameter, port or field tables."""
    first = {"parameter": "Name", "port": "Port", "field": "Field"}[kind]
    return {cells[0]: dict(zip(columns, cells)) for columns, cells in rows() if columns[0] == first}


def test_every_parameter_is_documented():
    wanted = {p for top in TOPS for p in header(top)[0] if not DERIVED.fullmatch(p)}
    assert wanted, "no parameter found in the RTL"
    assert set(documented("parameter")) == wanted


def test_every_port_is_documented():
    wanted = {p for top in TOPS for p in header(top)[1]}
    assert wanted, "no port found in the RTL"
    assert set(documented("port")) == wanted


@pytest.mark.parametrize("top", TOPS)
def test_defaults_are_as_documented(top):
    """A cell `a / b` holds the defaults of the RAM and of the I/O drop-in."""
    table = documented("parameter")
    for parameter, default in header(top)[0].items():
        if DERIVED.fullmatch(parameter):
            continue
        row = table[parameter]
        said = next(cell for column, cell in row.items() if column.startswith("Default")).split("/")
        text = said[-1] if top == IO else said[0]
        assert number(text) == number(default), f"{parameter}: document {text}, RTL {default}"


@pytest.mark.parametrize("top", TOPS)
def test_directions_and_widths_are_as_documented(top):
    table = documented("port")
    for port, (direction, width) in header(top)[1].items():
        row = table[port]
        assert row["Direction"] == direction.removesuffix("put"), f"{port} is an {direction}"
        bits = re.fullmatch(r"(\d+):0", width)
        if bits and row["Width"].isdigit():
            assert int(row["Width"]) == int(bits[1]) + 1, f"{port} is [{width}], document {row['Width']}"
        if width == "1":
            assert row["Width"] == "1", f"{port}: document {row['Width']}"


VECTORS = {
    "SET": "MB_SETTINGS_WIDTH",
    "HOST": "MB_HOST_STATE_WIDTH",
    "EVENT": "MB_EVENTS_WIDTH",
    "USER": "MB_USER_REPLY_WIDTH",
}


def test_fields_are_as_documented():
    """Each field of the vectors at the core's ports, with its bits."""
    wanted = {f"MB_{kind}_{name}": macros()[f"MB_{kind}_{name}"] for kind in VECTORS for name in fields(kind)}
    assert len(wanted) > 20, "the fields were not found"
    assert {name: row["Bits"] for name, row in documented("field").items()} == wanted


@pytest.mark.parametrize("kind", VECTORS)
def test_fields_fill_their_vector(kind):
    """Without a hole and without an overlap."""
    bits = [bit for high, low in fields(kind).values() for bit in range(low, high + 1)]
    assert bits == list(range(number(VECTORS[kind])))
