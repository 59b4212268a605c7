# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""test_NAME.py as a user runs it. It passes as made, and fails with a mistake in NAME.v."""

import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import FULL
from harness.runner import PLAIN_ASSERTIONS, PRODUCTS, ROOT, fresh_verilator, same_environment, simulator
from harness.volume import volume
from modbus_map.checks import compile_source, load_device
from modbus_map.loader import parse
from modbus_map.outputs import testbench, verilog
from modbus_map.outputs.verilog import core_files

from map import random_maps
from map.output_devices import EVERYTHING

REFERENCE = {path.stem: path for path in sorted(ROOT.glob("examples/*/*.yaml"))}
SHORT = "relay_box"  # what Icarus plays; it plays all with FULL=1
# The bench, with the faster build of the harness in place of cocotb's runner for Verilator
FAST = "import runpy, sys; from harness.runner import quicker; quicker(); runpy.run_path(sys.argv[1], run_name='__main__')"
ODD = """
device: odd
line: {address: 200, format: 8O1, run_time: true}
functions: [01, 03, 04, 05, 06, 16, 20, 21, 22, 23, 24]
core: {BROADCAST: 0, RESPONSE_DELAY: 20}
holding_registers:
  - gaps: zero
  - {at: 10, name: level, type: i16, min: -5, max: 5}
  - {at: 11, name: level_written}
  - {at: 20, name: total, type: u32, word_order: little, min: 70000, max: 80000, reset: 70001, strobe: true}
  - {at: 22, name: kept, kind: memory, count: 3, max: 9, reset: [1, 2, 3], strobe: true}
  - {at: 25, name: pair, type: u32, kind: memory, reset: 0x12345678}
  - {at: 30, name: ratio, type: f64, word_order: little}
input_registers:
  - {at: 65532, name: clock, type: u64, kind: wire, freeze: take}
coils:
  - {at: 3, name: take}
fifos:
  - {at: 100, name: queue, depth: 5}
files:
  - {number: 4, name: log, records: 20, access: ro}
  - {number: 9, name: notes, records: 7}
"""
LISTS = """
device: lists
line: {address: 17, baud: 115200}
holding_registers:
  - {at: 0, name: mode, type: i16, enum: {-3: "off", 5: slow, 9: fast}}
"""


def simulator_for(name):
    """The simulator of a bench."""
    return "icarus" if FULL or name == SHORT or not fresh_verilator() else "verilator"


def bench_of(device, place, change=lambda text: text, case=""):
    """(exit status, {test: True if it passed}, what was printed) of the generated bench."""
    sim = simulator_for(device.name)
    with same_environment():
        simulator(sim)
        environment = dict(os.environ)
    folder = PRODUCTS / "map_testbench" / place
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in {**verilog.generate(device), **testbench.generate(device)}.items():
        (folder / name).write_text(change(text) if name == f"{device.name}.v" else text, encoding="utf-8")
    environment.pop("COCOTB_LOG_LEVEL", None)  # the table of results is information
    paths = os.pathsep.join([str(ROOT / "tools"), environment["PYTHONPATH"]])
    environment |= {"MODBUS_RTU": str(ROOT), "SIM": sim, "PYTHONPATH": paths, **PLAIN_ASSERTIONS}
    if case:
        environment["COCOTB_TEST_FILTER"] = rf"\.{case}$"
    command = [sys.executable, *(["-c", FAST] if sim == "verilator" else []), f"test_{device.name}.py"]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    said = done.stdout + done.stderr
    results = dict(re.findall(r"\*\* test_\w+\.(\w+) +(PASS|FAIL)", said))
    return done.returncode, {name: word == "PASS" for name, word in results.items()}, said


def passes(device, place):
    status, results, said = bench_of(device, place)
    assert status == 0 and results and all(results.values()), said[-4000:]
    return results


@pytest.mark.parametrize("name", REFERENCE)
def test_reference_map_passes(name):
    passes(load_device(REFERENCE[name])[0], name)


def test_every_part_is_played():
    """Function codes, memory, files and both word orders that the reference maps do not have."""
    device, _ = compile_source(parse(ODD, "odd.yaml"))
    played = passes(device, "odd")
    everything = passes(EVERYTHING, "everything")
    text = testbench.RUNTIME.read_text()
    assert set(re.findall(r"^async def (\w+)\(dut", text, re.M)) == {*played, *everything}


@pytest.mark.parametrize("number", range(volume("random maps in Icarus")))
def test_random_map_passes(number, seed):
    (device,) = random_maps.devices(1000 * seed + number, 1, f"random_{number}_")
    passes(device, f"random_{number}")


MISTAKES = [  # (map, text of NAME.v, what stands there instead, the test that fails)
    ("relay_box", "limit_q = 16'd450;", "limit_q = 16'd451;", "reset_values"),
    ("relay_box", "limit_q <= 16'd450;", "limit_q <= 16'd451;", "writes_reach_their_outputs"),
    ("relay_box", "item = temperature_i", "item = temperature_i | 16'd1", "inputs_are_read"),
    ("relay_box", "ordered > most", "ordered >= most", "writes_reach_their_outputs"),
    ("relay_box", "ordered < least", "1'b0", "limits_are_kept"),
    ("relay_box", "MB_SPACE_INPUTS}: {exists, high} = {1'b1, 16'd0};", "MB_SPACE_INPUTS}: {exists, high} = {1'b1, 16'd1};",
     "gaps_are_empty"),
    ("relay_box", "FUNCTION_CODES(128'h8000001807E)", "FUNCTION_CODES(128'h8000041807E)", "other_functions_are_refused"),
    ("drive", "{1'b0, `MB_SPACE_COILS}: {low, high} = {16'd0, 16'd2};",
     "{1'b0, `MB_SPACE_COILS}: {low, high} = {16'd0, 16'd3};", "rights_are_kept"),
    ("drive", "speed_frozen_q <= speed_i;", "speed_frozen_q <= wb_cyc_i ? speed_i : 32'd0; speed_frozen_q <= speed_i + 1;",
     "snapshots_are_of_one_moment"),
    ("drive", "closes  = tail |", "closes  = 1'b1 |", "writes_reach_their_outputs"),
    ("drive", "(~begun | part == ", "(1'b1 | part == ", "inputs_are_read_whole"),
    ("pdm_map", "{1'b1, 16'd255};", "{1'b1, 16'd511};", "rights_are_kept"),
    ("pdm_map", "place = the_address;\n    end", "place = the_address ^ 16'd1 & {16{host_q}};\n    end",
     "host_and_master_share_the_memory"),
]  # fmt: skip


PLANTED = MISTAKES if FULL else [m for m in MISTAKES if m[0] == SHORT][::2]


@pytest.mark.parametrize("name, old, new, case", PLANTED, ids=[f"{m[0]}-{m[3]}-{m[1]}" for m in PLANTED])
def test_mistake_is_seen(name, old, new, case):
    def plant(text):
        assert text.count(old) >= 1, f"`{old}` is not in {name}.v"
        return text.replace(old, new, 1)

    status, results, said = bench_of(
        load_device(REFERENCE[name])[0], f"{name}_{MISTAKES.index((name, old, new, case))}", plant, case
    )
    assert status == 1 and results == {case: False}, said[-3000:]


def test_one_line_without_the_core(tmp_path):
    device, _ = load_device(REFERENCE["relay_box"])
    (tmp_path / "test_relay_box.py").write_text(testbench.generate(device)["test_relay_box.py"], encoding="utf-8")
    settings = {name: value for name, value in os.environ.items() if name != "MODBUS_RTU"}
    done = subprocess.run(
        [sys.executable, tmp_path / "test_relay_box.py"], env=settings, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "MODBUS_RTU is not set" in done.stderr


@pytest.mark.skipif(not shutil.which("iverilog"), reason="Icarus Verilog (iverilog) is not installed")
def test_no_block_sleeps_for_ever_in_icarus(tmp_path, seed):
    """An `always @*` of constants alone never runs there: its outputs stay unknown. A list of values and no range made one."""
    lists, _ = compile_source(parse(LISTS, "lists.yaml"))
    files, folders = core_files()
    command = ["iverilog", "-g2005", "-Wall", "-tnull", *(f"-I{ROOT / folder}" for folder in folders)]
    command += [str(ROOT / name) for name in files]
    for device in (lists, *random_maps.devices(7000 * seed, volume("random maps") // 4, "asleep_")):
        path = tmp_path / f"{device.name}.v"
        path.write_text(verilog.generate(device)[path.name], encoding="utf-8")
        done = subprocess.run([*command, str(path)], capture_output=True, text=True, check=True)
        assert not done.stderr, f"{device.name}: {done.stderr}"
