# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every list of files names exactly what is in rtl/, and the packaging scripts run to their end.

Lists: rtl/modbus.f, modbus_rtu_slave.core, the Quartus .qip, the Vivado packaging script. The last two are programs
in Tcl; they run in tclsh against stand-ins for the vendors' commands (tb/packaging), which refuse what they do not
know.
"""

import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from harness.runner import ROOT
from interface import header
from test_parameters import documented

STUBS = ROOT / "tb" / "packaging"
VIVADO = "constraints/vivado/package_ip.tcl"
QUARTUS = "constraints/quartus/modbus_rtu_slave.qip"
CORE = "modbus_rtu_slave.core"
IPS = ("modbus_rtu_slave", "modbus_axil_slave")
CONNECTED = {"clk_i", "rst_i", "rxd_i"}  # inputs without an idle value
DROP_INS = {"modbus_rtu_slave", "modbus_rtu_slave_io"}  # what stands around the core and its bank
MOST_PORTS = 40
INCLUDES = ("rtl/include", "rtl/engine")
BOARDS = ("icebreaker", "hx8k", "ulx3s", "tangnano9k", "arty_a7", "de10_lite")

# ------------------------------------------------------------------ reading the lists


def present(root, *suffixes):
    """The files of rtl/ with one of `suffixes`, as paths from `root`, sorted."""
    return sorted(path.relative_to(root).as_posix() for path in (root / "rtl").rglob("*") if path.suffix in suffixes)


def tcl(*arguments):
    """The output lines of tclsh, each as a list of words. Raises AssertionError with its message if it fails."""
    if not shutil.which("tclsh"):
        pytest.skip("tclsh (package tcl) is not installed: Tcl scripts cannot be run")
    done = subprocess.run(["tclsh", *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def list_f(root):
    """Verilog files of rtl/modbus.f."""
    lines = (root / "rtl/modbus.f").read_text(encoding="utf-8").split("\n")
    assert [line for line in lines if line.startswith("+")] == [f"+incdir+{folder}" for folder in INCLUDES]
    return [line.strip() for line in lines if line.strip() and not line.startswith(("+", "//"))]


def filesets(root):
    """{fileset: [(path, attributes text)]} of the FuseSoC core."""
    text = (root / CORE).read_text(encoding="utf-8")
    out, name = {}, None
    for line in text[text.index("\nfilesets:") : text.index("\ntargets:")].splitlines():
        if head := re.fullmatch(r"  (\w+):", line):
            name = head[1]
            out[name] = []
        elif item := re.fullmatch(r"      - ([\w./]+)(?:: \{(.*)\})?", line):
            out[name].append((item[1], item[2] or ""))
    return out


def list_core(root):
    """Files of the fileset `rtl`; exactly the .vh must be marked as include files."""
    files = filesets(root)["rtl"]
    for path, attributes in files:
        assert ("is_include_file: true" in attributes) == path.endswith(".vh"), f"{path}: {attributes}"
    return [path for path, _ in files]


def list_qip(root):
    """Files that Quartus is told, .v and .vh by their own assignments; rtl/ must be on the search path."""
    kinds = {"VERILOG_FILE": ".v", "VERILOG_INCLUDE_FILE": ".vh"}
    files = []
    searched = []
    for line in tcl(STUBS / "quartus_stub.tcl", root / QUARTUS):
        kind, path = line.split(" ", 1)
        if kind == "SEARCH_PATH":
            searched.append(path)
            continue
        assert Path(path).suffix == kinds[kind], line
        files.append(Path(path).relative_to(root.resolve()).as_posix())
    assert searched == [str(root.resolve() / folder) for folder in INCLUDES]
    return files


def vivado(root, out, *tops, infers=False, change=None):
    """What the packaging script tells Vivado, as lines of words. `change` (old, new) plants a mistake in a copy."""
    script = root / VIVADO
    if change:
        text = script.read_text(encoding="utf-8")
        assert change[0] in text, f"{change[0]} is not in the script"
        script = script.with_name("changed.tcl")
        script.write_text(text.replace(*change, 1), encoding="utf-8")
    has = [{top: list(header(top)[which]) for top in IPS} for which in (0, 1)]
    lists = [" ".join("{" + " ".join([top, *names]) + "}" for top, names in kind.items()) for kind in has]
    return tcl(STUBS / "vivado_stub.tcl", script, int(infers), *lists, out, *tops)


def list_vivado(root):
    """Files that the packaged IP holds."""
    lines = vivado(root, root / "build" / "ip", IPS[0])
    return [
        Path(line.removeprefix("add_files ")).relative_to(root.resolve()).as_posix()
        for line in lines
        if line.startswith("add_files ")
    ]


LISTS = {
    "rtl/modbus.f": (list_f, (".v",)),
    CORE: (list_core, (".v", ".vh")),
    QUARTUS: (list_qip, (".v", ".vh")),
    VIVADO: (list_vivado, (".v", ".vh")),
}


def difference(name, root):
    """(missing from the list, listed without being there or twice); both empty if the list is right."""
    reader, suffixes = LISTS[name]
    listed, there = Counter(reader(root)), Counter(present(root, *suffixes))
    return sorted((there - listed).elements()), sorted((listed - there).elements())


# ------------------------------------------------------------------ the lists


@pytest.fixture
def copy(tmp_path):
    """A copy of everything that a list or a script reads."""
    for name in ("rtl", "constraints", "docs"):
        shutil.copytree(ROOT / name, tmp_path / name)
    for name in (CORE, "VERSION"):
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def test_no_module_has_more_than_forty_ports():
    """A longer list says that a module is two, or that signals which belong together go one by one."""
    inside = {Path(path).stem for path in present(ROOT, ".v")} - DROP_INS
    ports = {module: len(header(module)[1]) for module in inside}
    assert len(ports) > 20
    assert {module: n for module, n in ports.items() if n > MOST_PORTS} == {}


@pytest.mark.parametrize("name", LISTS)
def test_list_names_exactly_the_files_of_rtl(name, copy):
    assert len(present(ROOT, ".v")) > 20, "the files of rtl/ were not found"
    assert difference(name, copy) == ([], [])


@pytest.mark.parametrize("name", LISTS)
def test_a_file_that_is_not_listed_is_noticed(name, copy):
    (copy / "rtl" / "modbus_extra.v").write_text("")
    assert difference(name, copy) == (["rtl/modbus_extra.v"], [])


@pytest.mark.parametrize("name", LISTS)
@pytest.mark.parametrize("line", ["line/modbus_sync.v", "bus/modbus_axil_slave.v", "engine/modbus_steps.vh"])
def test_a_line_that_lacks_is_noticed(name, line, copy):
    """The Vivado script takes the .v from rtl/modbus.f and whatever .vh there is."""
    path = copy / ("rtl/modbus.f" if name == VIVADO else name)
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [text for text in lines if f"/{line}" not in text]
    if len(kept) == len(lines):
        assert line.endswith(".vh") and name in ("rtl/modbus.f", VIVADO), f"{name} does not name {line}"
        return
    path.write_text("".join(kept), encoding="utf-8")
    assert difference(name, copy) == ([f"rtl/{line}"], [])


@pytest.mark.parametrize("name", LISTS)
def test_a_line_too_many_is_noticed(name, copy):
    """The same line twice, and the name of a file that is not there (which the Vivado stand-in refuses itself)."""
    path = copy / ("rtl/modbus.f" if name == VIVADO else name)
    text = path.read_text(encoding="utf-8")
    line = next(text for text in text.splitlines(keepends=True) if "/modbus_sync.v" in text)
    path.write_text(text.replace(line, line + line), encoding="utf-8")
    assert difference(name, copy) == ([], ["rtl/line/modbus_sync.v"])
    path.write_text(text.replace(line, line + line.replace("modbus_sync.v", "modbus_gone.v")), encoding="utf-8")
    if name == VIVADO:
        with pytest.raises(AssertionError, match=r"no file .*modbus_gone\.v"):
            difference(name, copy)
    else:
        assert difference(name, copy) == ([], ["rtl/line/modbus_gone.v"])


# ------------------------------------------------------------------ FuseSoC


def targets(root):
    """{target: its text} of the FuseSoC core."""
    text = (root / CORE).read_text(encoding="utf-8")
    parts = re.split(r"\n  (\w+):", text[text.index("\ntargets:") :])
    return dict(zip(parts[1::2], parts[2::2]))


def test_core_carries_the_version():
    name = re.search(r"^name: ::modbus_rtu_slave:(\S+)$", (ROOT / CORE).read_text(encoding="utf-8"), re.M)
    assert name[1] == (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def test_core_names_files_that_exist():
    listed = [path for files in filesets(ROOT).values() for path, _ in files]
    assert listed
    assert [path for path in listed if not (ROOT / path).is_file()] == []


def test_core_has_the_vhdl_package_for_those_who_ask():
    """In a fileset of its own, which the default target takes with the flag modbus_vhdl."""
    assert [path for path, _ in filesets(ROOT)["vhdl"]] == present(ROOT, ".vhd")
    assert '"modbus_vhdl? (vhdl)"' in targets(ROOT)["default"]


@pytest.mark.parametrize("board", BOARDS)
def test_core_has_a_target_for_the_board(board):
    """With the RTL, what all boards share, its top, its constraints, and nothing of another board."""
    text = targets(ROOT)[board]
    assert f"    filesets: [rtl, board, {board}]\n" in text
    assert f"    toplevel: {board}_top\n" in text
    own = [path for path, _ in filesets(ROOT)[board]]
    assert f"constraints/{board}/{board}_top.v" in own
    assert len(own) >= 2, "no constraints"
    others = set(BOARDS) - {board}
    assert not [path for path in own if path.split("/")[1] in others]


def test_quartus_takes_the_pins_without_the_files():
    """de10_lite_pins.tcl: the .qsf names files relative to its own folder, which would lead nowhere in FuseSoC's."""
    qsf = (ROOT / "constraints/de10_lite/de10_lite.qsf").read_text(encoding="utf-8")
    assert "VERILOG_FILE" in qsf
    lines = tcl(STUBS / "quartus_stub.tcl", ROOT / "constraints/quartus/de10_lite_pins.tcl")
    pins = [tuple(line.split()[:2]) for line in lines if line.startswith("PIN_")]
    assert "TOP_LEVEL_ENTITY de10_lite_top" in lines
    assert not [line for line in lines if "_FILE " in line]
    assert [name.strip("{}") for _, name in pins] == re.findall(r"^set_location_assignment \S+ -to (\S+)", qsf, re.M)
    assert len(pins) > 5


def test_vivado_reads_the_synchroniser_scoped(tmp_path):
    """scope_sync.tcl: for the instances of modbus_sync, from the file beside it."""
    stub = tmp_path / "stub.tcl"
    stub.write_text("proc read_xdc {args} { puts $args }\nsource [lindex $argv 0]\n")
    (line,) = tcl(stub, ROOT / "constraints/vivado/scope_sync.tcl")
    option, module, path = line.split()
    assert (option, module) == ("-ref", "modbus_sync")
    assert Path(path).resolve() == ROOT / "constraints/sync/modbus_sync.xdc"
    assert Path(path).is_file()


# ------------------------------------------------------------------ Vivado


def said(lines, command, *start):
    """The lines of `command` that begin with `start`, without it."""
    head = " ".join([command, *start]) + " "
    return [line.removeprefix(head) for line in lines if line.startswith(head)]


@pytest.mark.parametrize("infers", [False, True], ids=["told", "inferred"])
def test_vivado_script_packages_both(infers, copy):
    """Whether Vivado finds the interfaces by itself or has to be told."""
    lines = vivado(copy, copy / "ip", infers=infers)
    assert said(lines, "save_core") == list(IPS)
    assert said(lines, "create_xgui_files") == said(lines, "update_checksums") == list(IPS)
    assert said(lines, "set_property", "top") == [f"{top} fileset" for top in IPS]
    major, minor, patch = (copy / "VERSION").read_text(encoding="utf-8").strip().split(".")
    assert said(lines, "set_property", "version") == [f"{major}.{minor} core"] * 2
    assert said(lines, "set_property", "core_revision") == [f"{patch} core"] * 2
    assert said(lines, "set_property", "value") == [
        "ACTIVE_HIGH busparam rst_i POLARITY",
        "rst_i busparam clk_i ASSOCIATED_RESET",
    ] * len(IPS)
    signals = [f"{port} xilinx.com:signal:{kind}_rtl:1.0" for port, kind in (("clk_i", "clock"), ("rst_i", "reset"))]
    assert said(lines, "infer_bus_interface") == ([] if infers else signals * len(IPS))
    assert said(lines, "infer_bus_interfaces") == ([] if infers else ["xilinx.com:interface:aximm_rtl:1.0"])
    assert said(lines, "associate_bus_interfaces") == ["s_axil clk_i"]
    width = int(header("modbus_axil_slave")[1]["s_axil_awaddr"][1].split(":")[0]) + 1
    block = "reg0" if infers else "tables"
    assert said(lines, "set_property", "range") == [f"{1 << width} block s_axil {block}"]
    assert (copy / "ip").is_dir()


def bounds(text):
    """(least, most) of a documented range of two numbers, or None for any other."""
    match = re.search(r"^(\d+) \.\. (\d+)(?:,|$)", text)
    return (0, 1) if text == "0, 1" else match and (int(match[1]), int(match[2]))


def test_vivado_parameters_are_those_of_the_core(copy):
    """Every parameter has a meaning, and the range of docs/parameters.md where that is two numbers."""
    table = documented("parameter")
    lines = vivado(copy, copy / "ip", IPS[0])
    names = [line.split()[-1] for line in said(lines, "set_property", "tooltip")]
    assert sorted(names) == sorted(header(IPS[0])[0])
    limits = {}
    for end in ("minimum", "maximum"):
        for line in said(lines, "set_property", f"value_validation_range_{end}"):
            value, _, name = line.split()
            limits.setdefault(name, []).append(int(value))
    assert [line.split() for line in said(lines, "set_property", "value_validation_type")] == [
        ["range_long", "param", name] for name in names if name in limits
    ]
    wanted = {name: bounds(table[name]["Range"]) for name in names}
    assert sum(value is not None for value in wanted.values()) > 30
    assert {name: tuple(value) for name, value in limits.items()} == {
        name: value for name, value in wanted.items() if value is not None
    }


def test_vivado_open_inputs_have_idle_values(copy):
    lines = vivado(copy, copy / "ip", IPS[0])
    idle = {line.split()[-1] for line in said(lines, "set_property", "driver_value")}
    inputs = {name for name, (direction, _) in header(IPS[0])[1].items() if direction == "input"}
    assert idle == inputs - CONNECTED


MISTAKES = {
    "a bracket that lacks": ("[ipx::current_core]", "[ipx::current_core", "missing close-bracket"),
    "an unknown command": ("ipx::save_core", "ipx::save_cores", "invalid command name"),
    "an unknown option": ("-root_dir", "-rootdir", "unknown option"),
    "an unknown property": ("set_property tooltip", "set_property tip", "no tip of"),
    "a document that is not there": ("docs parameters.md", "docs parameter.md", "couldn't open"),
    "a port that is not there": ("host_we_i 0", "host_ve_i 0", "no port host_ve_i"),
    "a property before packaging": ("ipx::package_project", "#", "nothing is packaged"),
    "a project left open": ("close_project\n", "", "a project is open"),
    "a variable that is not set": ("$out $vendor", "$out $seller", 'can\'t read "seller"'),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_the_vivado_script_is_noticed(mistake, copy):
    old, new, message = MISTAKES[mistake]
    with pytest.raises(AssertionError, match=re.escape(message)):
        vivado(copy, copy / "ip", change=(old, new))


def test_vivado_script_refuses_what_it_cannot_package(copy):
    with pytest.raises(AssertionError, match="cannot package modbus_crc16"):
        vivado(copy, copy / "ip", "modbus_crc16")


def test_vivado_script_writes_over_packaged_ip_only(copy):
    """OUT/TOP may be a checkout of this very core."""
    place = copy / "ip" / IPS[0]
    place.mkdir(parents=True)
    (place / "precious").write_text("")
    with pytest.raises(AssertionError, match="is no packaged IP"):
        vivado(copy, copy / "ip", IPS[0])
    assert (place / "precious").exists()
    (place / "component.xml").write_text("")
    assert said(vivado(copy, copy / "ip", IPS[0]), "save_core") == [IPS[0]]
    assert not (place / "precious").exists()
