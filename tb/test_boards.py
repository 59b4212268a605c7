# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The boards of constraints/: pin files against tops, lint, behaviour at the pins, and make bitstream."""

import json
import re
import shutil
import subprocess
import sys

import bitstream
import pytest
from conftest import FULL
from harness.runner import ROOT, run, sources
from system.board_pins import PINS

from common import include_files

FOLDER = ROOT / "constraints"
BOARDS = [top.removesuffix("_top") for top in PINS]
SUFFIX = {board: flow.pins for board, flow in bitstream.BOARDS.items()} | {"arty_a7": "xdc", "de10_lite": "qsf"}
# How each kind of pin file places a port: (port, pin) or (pin, port)
PLACED = {
    "pcf": r"^set_io (?:-\w+ \w+ )*(?P<port>\S+) (?P<pin>\S+)$",
    "lpf": r'^LOCATE COMP "(?P<port>[^"]+)" SITE "(?P<pin>\w+)";$',
    "cst": r'^IO_LOC "(?P<port>[^"]+)" (?P<pin>\d+);$',
    "xdc": r"^set_property -dict \{PACKAGE_PIN (?P<pin>\w+) .*\} \[get_ports \{(?P<port>[^}]+)\}\]$",
    "qsf": r"^set_location_assignment PIN_(?P<pin>\w+) -to (?P<port>\S+)$",
}
# The electrical standard of a port; an iCE40 has none to choose
STANDARD = {
    "lpf": r'^IOBUF PORT "(?P<port>[^"]+)" .*IO_TYPE=(?P<standard>\w+)',
    "cst": r'^IO_PORT "(?P<port>[^"]+)" IO_TYPE=(?P<standard>\w+)',
    "xdc": r"IOSTANDARD (?P<standard>\w+).*\[get_ports \{(?P<port>[^}]+)\}\]$",
    "qsf": r'^set_instance_assignment -name IO_STANDARD "(?P<standard>[^"]+)" -to (?P<port>\S+)$',
}
PULL_UP = {
    "pcf": r"^set_io -pullup yes (?P<port>\S+)",
    "lpf": r'^IOBUF PORT "(?P<port>[^"]+)" PULLMODE=UP',
    "cst": r'^IO_PORT "(?P<port>[^"]+)" .*PULL_MODE=UP',
    "xdc": r"PULLUP TRUE\} \[get_ports \{(?P<port>[^}]+)\}\]$",
    "qsf": r"^set_instance_assignment -name WEAK_PULL_UP_RESISTOR ON -to (?P<port>\S+)$",
}
# The clock that the constraints tell: (file, pattern, what one unit of it is in MHz or, negative, its inverse)
CLOCK = {
    "pcf": ("{board}.pcf", r"^set_frequency clk_i (\S+)$", "MHz"),
    "lpf": ("{board}.lpf", r'^FREQUENCY PORT "clk_i" (\S+) MHZ;$', "MHz"),
    "xdc": ("{board}.xdc", r"^create_clock -name clk -period (\S+) \[get_ports clk_i\]$", "ns"),
    "qsf": ("{board}.sdc", r"^create_clock -name clk -period (\S+) \[get_ports clk_i\]$", "ns"),
}
SLOW = {"CLK_HZ": 20_000, "BAUD": 2_000}


def ports_of(board):
    """{port or port[bit]: direction} of a board's top."""
    text = (FOLDER / board / f"{board}_top.v").read_text(encoding="utf-8")
    head = text[text.index(") (") : text.index(");")]
    out = {}
    for direction, high, name in re.findall(r"^  (input|output) +wire +(?:\[(\d+):0\] )? *(\w+)", head, re.M):
        names = [f"{name}[{i}]" for i in range(int(high) + 1)] if high else [name]
        out |= dict.fromkeys(names, direction)
    return out


def pin_file(board):
    """(kind, text) of a board's pin file."""
    kind = SUFFIX[board]
    return kind, (FOLDER / board / f"{board}.{kind}").read_text(encoding="utf-8")


def found(patterns, board, group="port"):
    """What `patterns` of the board's kind find in its pin file, as a list."""
    kind, text = pin_file(board)
    return [m.group(group) for m in re.finditer(patterns[kind], text, re.M)]


def verilog(board):
    """The Verilog files of a board and the include options."""
    files, folders = sources()
    own = [FOLDER / "common/modbus_board.v", FOLDER / board / f"{board}_top.v"]
    return [f"-I{f}" for f in folders], [str(f) for f in (*files, *own)]


@pytest.mark.parametrize("board", BOARDS)
def test_pin_file_places_every_port_and_nothing_else(board):
    placed, pins = found(PLACED, board), found(PLACED, board, "pin")
    assert sorted(placed) == sorted(ports_of(board))
    assert len(set(pins)) == len(pins), f"a pin is used twice: {sorted(pins)}"


@pytest.mark.parametrize("board", [b for b in BOARDS if SUFFIX[b] != "pcf"])
def test_every_port_has_an_electrical_standard(board):
    assert sorted(found(STANDARD, board)) == sorted(ports_of(board))


@pytest.mark.parametrize("board", BOARDS)
def test_both_receivers_have_a_pull_up(board):
    """The one that is not connected must read 1, or the other is deaf."""
    receivers = {port for port in ports_of(board) if "rxd" in port}
    assert receivers == {"usb_rxd_i", "rs485_rxd_i"}
    assert receivers <= set(found(PULL_UP, board))


@pytest.mark.parametrize("board", [b for b in BOARDS if SUFFIX[b] != "cst"])
def test_clock_constraint_is_the_clock_of_the_top(board):
    file, pattern, unit = CLOCK[SUFFIX[board]]
    text = (FOLDER / board / file.format(board=board)).read_text(encoding="utf-8")
    said = [float(value) for value in re.findall(pattern, text, re.M)]
    assert len(said) == 1, f"{len(said)} clock constraints"
    mhz = said[0] if unit == "MHz" else 1000 / said[0]
    assert mhz * 1e6 == pytest.approx(bitstream.clock_hz(board), rel=1e-6)


@pytest.mark.parametrize("tool", ["icarus", "verilator"])
@pytest.mark.parametrize("board", BOARDS)
def test_top_compiles_without_a_message(tool, board):
    """The messages about the core's own files are make lint's business."""
    include, files = verilog(board)
    command = {
        "icarus": ["iverilog", "-g2005", "-Wall", "-tnull", "-s"],
        "verilator": ["verilator", "--lint-only", "-Wall", "-Wno-fatal", "--language", "1364-2005", "--top-module"],
    }[tool]
    done = subprocess.run(
        [*command, f"{board}_top", *include, *files], capture_output=True, text=True, cwd=ROOT, check=False
    )
    said = [line for line in (done.stdout + done.stderr).splitlines() if "constraints/" in line]
    assert not said, "\n".join(said)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("board", BOARDS)
def test_behaviour_at_the_pins(record_property, board):
    sim = "icarus" if FULL else "verilator"
    run(record_property, sim, f"{board}_top", "system.board", SLOW)


@pytest.mark.parametrize("board", ["", "nosuch", "arty_a7", "hx8k ulx3s", "../hx8k"])
def test_make_bitstream_refuses_what_it_cannot_build(board):
    """Exit 2 and one line that lists the boards."""
    done = subprocess.run(
        [sys.executable, "tools/bitstream.py", board], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert done.returncode == 2, done
    assert len(done.stderr.splitlines()) == 1, done.stderr
    for name in bitstream.BOARDS:
        assert name in done.stderr
    assert not done.stdout


def test_synchroniser_constraints_name_registers_that_exist():
    rtl = (ROOT / "rtl/line/modbus_sync.v").read_text(encoding="utf-8")
    registers = set(re.findall(r"\breg (\w+) =", rtl))
    xdc = (FOLDER / "sync/modbus_sync.xdc").read_text(encoding="utf-8")
    sdc = (FOLDER / "sync/modbus_sync.sdc").read_text(encoding="utf-8")
    cells = re.search(r"ASYNC_REG TRUE \[get_cells \{([^}]+)\}\]", xdc).group(1).split()
    assert {cell.removesuffix("_reg") for cell in cells} == registers
    first = re.search(r"(\w+) <= async_i;", rtl).group(1)
    assert re.findall(r"^set_false_path -to \[get_pins (\S+)\]$", xdc, re.M) == [f"{first}_reg/D"]
    assert re.findall(r"^set_false_path -to \[get_registers \{(\S+)\}\]$", sdc, re.M) == [f"*modbus_sync:*|{first}"]


TABLE = re.compile(r"^\| `(\w+)` \| [^|]+ \| [^|]+ \| ([\d.]+) MHz \|", re.M)


def test_page_names_every_board_and_its_clock():
    """docs/boards.md: a row for each board; its folder has a README that names the pin file."""
    page = (ROOT / "docs/boards.md").read_text(encoding="utf-8")
    assert {board: float(mhz) * 1e6 for board, mhz in TABLE.findall(page)} == {b: bitstream.clock_hz(b) for b in BOARDS}
    for board in BOARDS:
        assert f"{board}.{SUFFIX[board]}" in (FOLDER / board / "README.md").read_text(encoding="utf-8")


def test_vendor_projects_name_files_that_exist():
    """Relative to the file that names them; the file list of the core is read, not repeated."""
    quartus = (FOLDER / "de10_lite/de10_lite.qsf").read_text(encoding="utf-8")
    named = re.findall(r"-name \w+_FILE (\S+)$", quartus, re.M)
    assert "../common/modbus_board.v" in named and "de10_lite_top.v" in named
    missing = [name for name in named if not (FOLDER / "de10_lite" / name).exists()]
    assert not missing, f"de10_lite.qsf names {missing}"
    vivado = (FOLDER / "arty_a7/create_project.tcl").read_text(encoding="utf-8")
    for variable, place in (("here", FOLDER / "arty_a7"), ("root", ROOT)):
        for name in re.findall(rf"\${variable}/([\w./]+\.\w+)", vivado):
            assert (place / name).exists(), f"create_project.tcl names {name}"
    for top, file in (("arty_a7_top", vivado), ("de10_lite_top", quartus)):
        assert re.search(rf"\b{top}\b(?!\.v)", file), f"{top} is not set as the top"


VIVADO_STAND_IN = """
proc create_project {args} {}
proc current_fileset {} { return sources_1 }
proc get_files {name} { return $name }
proc add_files {args} { foreach file [lindex $args end] { puts "file [file normalize $file]" } }
proc set_property {name value object} { puts "property $name $value $object" }
"""


def test_vivado_project_has_every_source():
    """create_project.tcl in tclsh, with stand-ins for the commands of Vivado; any other command is an error."""
    if not shutil.which("tclsh"):
        pytest.skip("tclsh (package tcl) is not installed: Tcl scripts cannot be run")
    script = f"{VIVADO_STAND_IN}\nset argv {{}}\nsource {FOLDER}/arty_a7/create_project.tcl\n"
    done = subprocess.run(["tclsh"], input=script, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    files = sorted(line.removeprefix("file ") for line in done.stdout.splitlines() if line.startswith("file "))
    headers = include_files()
    constraints = ["constraints/arty_a7/arty_a7.xdc", "constraints/sync/modbus_sync.xdc"]
    wanted = [*bitstream.sources("arty_a7"), *headers, *constraints]
    assert files == sorted(str(ROOT / name) for name in wanted)
    for said in ("top arty_a7_top sources_1", "SCOPED_TO_REF modbus_sync modbus_sync.xdc"):
        assert f"property {said}" in done.stdout.splitlines()


@pytest.mark.parametrize("board", bitstream.BOARDS)
@pytest.mark.parametrize("ratio", [0.999, 1.001])
def test_a_missed_clock_is_a_failure(monkeypatch, tmp_path, board, ratio):
    """Whatever the place and route said of it; the slowest of several clocks counts."""
    mhz = bitstream.clock_hz(board) / 1e6
    report = {
        "fmax": {"clk": {"achieved": mhz * ratio}, "other": {"achieved": mhz * 2}},
        "utilization": {bitstream.BOARDS[board].cell: {"used": 1, "available": 2}},
    }

    def tools(command, log):
        """Stands for every tool: only the report is written."""
        if "--report" in command:
            (tmp_path / command[command.index("--report") + 1]).write_text(json.dumps(report))

    monkeypatch.setattr(bitstream, "ROOT", tmp_path)
    monkeypatch.setattr(bitstream, "run", tools)
    monkeypatch.setattr(bitstream, "sources", lambda name: [])
    monkeypatch.setattr(bitstream, "clock_hz", lambda name: mhz * 1e6)
    if ratio < 1:
        with pytest.raises(bitstream.ToolError, match="below the clock"):
            bitstream.build(board)
    else:
        assert f"{mhz * ratio:.1f} MHz" in bitstream.build(board)[0]
