# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/first_device.md and the README's first example: what they show is what happens. tools/first_device.py plays both."""

import re
import shutil
import sys
from pathlib import Path

import first_device
import pytest
from live.serve import ROOT
from modbus_map.checks import compile_source
from modbus_map.loader import parse

README = ROOT / "README.md"


def device_of(text):
    return compile_source(parse(text, "relay_box.yaml"))[0]


@pytest.mark.skipif(shutil.which("mbpoll") is None, reason="mbpoll is not installed")
def test_every_command_says_what_the_page_says(tmp_path):
    """In this checkout, with files and device of the test elsewhere; `make map` needs a .venv, so the compiler is named."""
    compiler = f"{sys.executable} tools/modbus map build"

    def change(text):
        text = re.sub(r"make map FILE=(\S+) OUT=(\S+)", rf"{compiler} \1 -o \2", text)
        text = re.sub(
            r"build/relay_box\b|relay_box\.(yaml|json)", lambda found: str(tmp_path / Path(found[0]).name), text
        )
        return text.replace("make serve", f"make serve LINK={tmp_path}/modbus").replace(
            "build/modbus", f"{tmp_path}/modbus"
        )

    said, seconds = first_device.play(ROOT, change)
    assert len(said) == len(first_device.steps()) and 0 < seconds < first_device.SECONDS


def test_the_readme_begins_with_the_same_map():
    """Ten lines, and the instantiation names every port of the module: at most ten."""
    text = README.read_text(encoding="utf-8")
    shown = re.search(r"^```yaml\n(.*?)^```", text, re.M | re.S)[1]
    assert shown == first_device.blocks("yaml")[0] and shown.count("\n") == 10
    device = device_of(shown)
    ports = [port.name for port in device.port_list()]
    assert len(ports) <= 10
    page = first_device.PAGE.read_text(encoding="utf-8")
    for place in (text, page):
        instance = re.search(r"^relay_box #\(.*?^\);", place, re.M | re.S)[0]
        assert re.findall(r"\.(\w+_[io])\(", instance) == ports
    assert len(first_device.steps()) > 5
    for command, _ in first_device.steps()[:3]:
        assert command in text, f"README.md does not show {command}"


def test_pictures_are_of_this_map():
    text = first_device.blocks("yaml")[0]
    drawn = (ROOT / "docs/first_device_module.svg").read_text(encoding="utf-8")
    assert drawn == first_device.module(text, device_of(text)), "tools/first_device.py --update"
    shown = (ROOT / "docs/first_device_terminal.svg").read_text(encoding="utf-8")
    for command, _ in first_device.steps()[:5]:
        assert f"$ {command.replace('&', '&amp;')}" in shown, "tools/first_device.py --update"
    assert not re.search(r"> *(/|[^<]* /)", shown), "a path of one machine is in the picture"
