# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.vhd: GHDL takes it in each standard, its ports are those of the Verilog, its entity works at the pins."""

import dataclasses
import re
import shutil
import subprocess
import sys

import pytest
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner
from harness.runner import PRODUCTS, ROOT, TB, sources
from modbus_map.model import Line
from modbus_map.outputs import verilog, vhdl

from map.output_devices import EVERYTHING, RELAY_BOX

SETTABLE = dataclasses.replace(EVERYTHING, name="settable", line=Line(5, 9600, "8N1", True))
DEVICES = pytest.mark.parametrize("device", [RELAY_BOX, EVERYTHING, SETTABLE], ids=lambda d: d.name)
needs_ghdl = pytest.mark.skipif(shutil.which("ghdl") is None, reason="GHDL (package ghdl) is not installed")


def ghdl(place, *command):
    done = subprocess.run(["ghdl", *map(str, command)], cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def written(place, device):
    """Path of NAME.vhd in a folder."""
    place.mkdir(parents=True, exist_ok=True)
    ((path, text),) = vhdl.generate(device).items()
    (place / path).write_text(text, encoding="utf-8")
    return place / path


def verilog_ports(device):
    """[(name, direction, width)] and parameters of the module in NAME.v."""
    text = re.sub(r"//.*", "", verilog.generate(device)[f"{device.name}.v"])
    head = re.search(rf"^module {device.name}\b(.*?)^\);", text, re.M | re.S)[1]
    ports = [
        (name, direction, int(high or 0) + 1)
        for direction, high, name in re.findall(r"\b(input|output)\s+(?:wire|reg)\s+(?:\[(\d+):0\]\s*)?(\w+)", head)
    ]
    return ports, re.findall(r"parameter\s+(?:integer\s+|\[[^]]*\]\s*)?(\w+)", head)


@DEVICES
def test_ports_are_those_of_the_verilog(device):
    ports, parameters = verilog_ports(device)
    text = next(iter(vhdl.generate(device).values()))
    component = re.search(rf"component {device.name} is(.*?)end component", text, re.S)[1]
    found = [
        (name, "input" if direction == "in" else "output", int(high or 0) + 1)
        for name, direction, high in re.findall(
            r"(\w+)\s*: (in|out)\s+std_logic(?:_vector\((\d+) downto 0\))?", component
        )
    ]
    assert ports and found == ports
    assert re.findall(r"^\s+([A-Z_]+)\s*: (?:natural|positive)", component, re.M) == parameters


@needs_ghdl
@DEVICES
@pytest.mark.parametrize("standard", ["93", "08"])
def test_ghdl_takes_it(device, standard, tmp_path):
    assert not ghdl(tmp_path, "-a", f"--std={standard}", written(tmp_path, device))


@needs_ghdl
@pytest.mark.parametrize("top", ["relay_box", "relay_box_entity"])
def test_relay_box_answers(top):
    """The Verilog top, and the Verilog that GHDL makes of the entity around it, answer the same probe."""
    place = PRODUCTS / "map_vhdl" / top
    source = written(place, RELAY_BOX)
    (place / "relay_box.v").write_text(verilog.generate(RELAY_BOX)["relay_box.v"], encoding="utf-8")
    files, folders = sources()
    files = [path for path in files if TB not in path.parents] + [place / "relay_box.v"]
    generics = {"CLK_HZ": 2_000_000, "BAUD": 250_000}
    if top.endswith("entity"):
        ghdl(place, "-a", "--std=93", source)
        made = ghdl(place, "--synth", "--std=93", "--out=verilog", *(f"-g{k}={v}" for k, v in generics.items()), top)
        made = re.sub(rf"^module (?!{top}\b).*?^endmodule\n", "", made, flags=re.M | re.S)
        (place / "entity.v").write_text(made, encoding="utf-8")
        files, generics = files + [place / "entity.v"], {}
    runner = get_runner("icarus")
    runner.build(
        sources=files, includes=folders, hdl_toplevel=top, build_dir=place / "sim", parameters=generics,
        timescale=("1ns", "1ps"), always=True,
    )  # fmt: skip
    xml = place / "results.xml"
    sys.path[:0] = [str(TB), str(ROOT / "tools")]
    runner.test(
        hdl_toplevel=top, hdl_toplevel_lang="verilog", test_module="map.vhdl_probe", build_dir=place / "sim",
        test_dir=place, results_xml=str(xml), timescale=("1ns", "1ps"),
    )  # fmt: skip
    assert get_results(xml) == (1, 0)
