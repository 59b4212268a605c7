# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The worked examples: illegal parameters stop elaboration; docs/pdm_meter.md says what the RTL has."""

import re

import pytest
from harness.runner import ROOT
from interface import DERIVED, header
from test_parameters import elaborate

PDM, USER = "modbus_pdm_meter", "modbus_example_user"

LEGAL = [
    (PDM, {}),
    (PDM, {"DI_COUNT": 0, "DO_COUNT": 0, "MEASURED_COUNT": 0, "SETTING_COUNT": 1}),
    (PDM, {"EVENT_DEPTH": 1024}),
    (PDM, {"DI_COUNT": 65536, "DO_COUNT": 65536}),
    ("modbus_example_ram", {"WORDS": 2}),
    ("modbus_example_ram", {"WORDS": 65536}),
    ("modbus_example_soc_axil", {"WORDS": 32769}),
    ("modbus_example_soc_wb", {"WORDS": 65536}),
    (USER, {"WORK_CLOCKS": 2}),
    (USER, {"WORK_CLOCKS": 16777215}),
]
ILLEGAL = [
    (PDM, {"SETTING_COUNT": 0}),
    (PDM, {"SETTING_COUNT": 65536, "MEASURED_COUNT": 1}),
    (PDM, {"DO_COUNT": 65537}),
    (PDM, {"DI_COUNT": -1}),
    (PDM, {"EVENT_DEPTH": 2}),
    (PDM, {"EVENT_DEPTH": 24}),
    (PDM, {"EVENT_DEPTH": 2048}),
    (USER, {"WORK_CLOCKS": 1}),
    (USER, {"WORK_CLOCKS": 16777216}),
]


def name(case):
    """A test's name for (top, parameters)."""
    top, parameters = case
    return "-".join([top.removeprefix("modbus_"), *(f"{k}={v}" for k, v in parameters.items())])


@pytest.mark.parametrize("tool", ["icarus", "verilator"])
@pytest.mark.parametrize("case", LEGAL, ids=name)
def test_legal_parameters_elaborate(tool, case):
    status, messages = elaborate(tool, *case)
    assert status == 0, messages


@pytest.mark.parametrize("tool", ["icarus", "verilator"])
@pytest.mark.parametrize("case", ILLEGAL, ids=name)
def test_illegal_parameters_stop_elaboration(tool, case):
    """With the rule as the name of a missing module."""
    status, messages = elaborate(tool, *case)
    assert status != 0, f"{name(case)} was accepted"
    assert "ERROR_modbus" in messages, messages


def page():
    """The text of docs/pdm_meter.md."""
    return (ROOT / "docs" / "pdm_meter.md").read_text(encoding="utf-8")


def test_parameters_and_defaults_are_as_documented():
    said = dict(re.findall(r"^\| `([A-Z]\w+)` \| (\d+) \|", page(), re.M))
    assert said == {k: v for k, v in header(PDM)[0].items() if not DERIVED.fullmatch(k)}


def test_ports_and_directions_are_as_documented():
    """A row may name several ports of one width, or a family of them with a star."""
    ports, said = header(PDM)[1], {}
    for names, direction in re.findall(r"^\| ((?:`[a-z_*]+`(?:, )?)+) \| [^|]+ \| (in|out) \|", page(), re.M):
        for port in re.findall(r"`([a-z_*]+)`", names):
            pattern = re.compile(port.replace("*", r"\w+"))
            family = [p for p in ports if pattern.fullmatch(p)] if "*" in port else [port]
            said |= dict.fromkeys(family, direction)
    assert said == {port: direction.removesuffix("put") for port, (direction, _) in ports.items()}
