# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""rtl/vhdl/modbus_pkg.vhd says what the Verilog has, and VHDL tops made with it work.

GHDL makes Verilog of a VHDL top; joined with the core it plays the suites that the Verilog drop-ins play.
"""

import re
import shutil
import subprocess

import pytest
import vhdl_package
from conftest import FULL
from harness.build import function_mask
from harness.runner import PRODUCTS, ROOT, TB, run, sources
from interface import DERIVED, header, macros, number
from protocol.defs import ALL_FUNCTIONS, FC

PACKAGE = ROOT / "rtl" / "vhdl" / "modbus_pkg.vhd"
PAGE = ROOT / "docs" / "vhdl.md"
COMPONENTS = ("modbus_rtu_slave_io", "modbus_rtu_slave", "modbus_rtu_core", "modbus_bank_ram", "modbus_bank_io")
NEEDED = {  # inputs without a default: what a user connects
    "modbus_rtu_slave_io": {"clk_i", "rxd_i"},
    "modbus_rtu_slave": {"clk_i", "rxd_i"},
}

# ------------------------------------------------------------------ the package against the Verilog


def package():
    """The text of the package's declaration, without comments."""
    text = re.sub(r"--.*", "", PACKAGE.read_text(encoding="utf-8"))
    return text[: text.index("end package")]


def constants():
    """{name: value text} of the package's constants."""
    return dict(re.findall(r"constant\s+(\w+)\s*:[^;=]*:=\s*([^;]+);", package()))


def component(name):
    """(generics {name: (type, default)}, ports {name: (direction, type, default or None)})."""
    text = re.search(rf"component {name} is(.*?)end component", package(), re.S)[1]
    generics, ports = re.fullmatch(r"\s*generic\s*\((.*)\);\s*port\s*\((.*)\);\s*", text, re.S).groups()
    split = [[re.split(r"\s*:=\s*", " ".join(row.split())) for row in part.split(";")] for part in (generics, ports)]
    found = [
        {row[0].split(" : ")[0].strip(): (row[0].split(" : ")[1].strip(), *row[1:]) for row in part} for part in split
    ]
    return found[0], {
        port: (*row[0].split(maxsplit=1), row[1] if len(row) > 1 else None) for port, row in found[1].items()
    }


def value(text, width=None):
    """An integer, a text in quotes, or an aggregate of `width` bits as an integer; a constant by its name."""
    text = constants().get(text, text).strip()
    if aggregate := re.fullmatch(r"\((?:(.*), )?others => '0'\)", text):
        return sum(1 << int(bit) for bit in re.findall(r"(\d+) => '1'", aggregate[1] or ""))
    if based := re.fullmatch(r"16#(\w+)#", text):
        return int(based[1], 16)
    if bits := re.fullmatch(r'(x?)"([0-9A-Fa-f]+)"', text):
        if width is not None:
            return int(bits[2], 16 if bits[1] else 2)
    return text if text.startswith('"') else int(text)


def width_of(kind, sizes):
    """Bits of a VHDL type, its generics taken from `sizes`."""
    named = {"std_logic": 1, "mb_codes": 128}
    if vector := re.fullmatch(r"mb_(\w+)_vector", kind):
        return number(f"MB_{vector[1].upper()}_WIDTH")
    if kind in named:
        return named[kind]
    text = re.fullmatch(r"std_logic_vector\((.*) downto 0\)", kind)[1]
    text = re.sub(r"boolean'pos\((\w+) = 0\)", lambda m: str(int(sizes[m[1]] == 0)), text)
    return number(re.sub(r"[A-Z]\w+", lambda m: str(sizes[m[0]]), text)) + 1


def verilog_width(text, sizes):
    """Bits of a Verilog port, COIL_WIDTH and its like worked out from `sizes`."""
    if text == "1":
        return 1
    for name, factor in (("COIL", 1), ("DISCRETE", 1), ("INPUT", 16), ("HOLDING", 16)):
        text = text.replace(f"{name}_WIDTH", str(factor * max(sizes.get(f"{name}_COUNT", 0), 1)))
    return number(text.partition(":")[0]) + 1


def test_package_is_made_of_the_verilog():
    assert not vhdl_package.stale(), "run tools/vhdl_package.py --update"


def test_constants_are_those_of_the_verilog():
    """Each constant named MB_ has the value of the macro of that name, and no field or function code lacks."""
    said = {name: text for name, text in constants().items() if name.startswith("MB_")}
    assert len(said) > 50, "the constants were not found"
    for name, text in said.items():
        assert value(text, width=0) == number(macros()[name]), name
    kinds = re.compile(r"MB_(FC|EX|EVENT|FORMAT)_\w+|MB_\w+_FUNCTIONS")
    assert {name for name in macros() if kinds.fullmatch(name)} <= set(said)


@pytest.mark.parametrize("top", COMPONENTS)
def test_generics_are_the_parameters(top):
    """Name by name in any order, default by default; a vector as wide as the Verilog has it."""
    generics, parameters = component(top)[0], header(top)[0]
    assert set(generics) == {name for name in parameters if not DERIVED.fullmatch(name)}
    for name, (kind, default) in generics.items():
        assert value(default, None if kind == "string" else 0) == number(parameters[name]), name


@pytest.mark.parametrize("top", COMPONENTS)
def test_ports_are_the_ports(top):
    """Name by name, direction by direction, width by width, with tables of 0, 1 and 5 items."""
    ports, verilog = component(top)[1], header(top)[1]
    assert list(ports) == list(verilog)
    for count in (0, 1, 5):
        sizes = {f"{table}_COUNT": count + k for k, table in enumerate(("COIL", "DISCRETE", "INPUT", "HOLDING"))}
        for port, (direction, kind, _) in ports.items():
            assert direction == verilog[port][0].removesuffix("put"), port
            assert width_of(kind, sizes) == verilog_width(verilog[port][1], sizes), f"{port} with {sizes}"


@pytest.mark.parametrize("top", NEEDED)
def test_little_need_be_connected(top):
    ports = component(top)[1]
    assert {port for port, (direction, _, default) in ports.items() if direction == "in" and not default} == NEEDED[top]


def test_fields_are_where_the_verilog_has_them():
    """The concatenations in the package's body, from the lowest bit up, against the macros."""
    body = PACKAGE.read_text(encoding="utf-8").split("package body")[1]
    for function, prefix in (("mb_settings", "MB_SET"), ("mb_host_state", "MB_HOST"), ("mb_user_reply", "MB_USER")):
        text = re.search(rf"function {function} .*?return (\w+ &[^;]*);", body, re.S)[1]
        fields = [name.strip().upper() for name in text.split("&")][::-1]
        bits = {f: macros()[f"{prefix}_{f}"].partition(":") for f in fields}
        places = [int(low or high) for high, _, low in bits.values()]
        assert places == sorted(places), f"{function}: {bits}"


# ------------------------------------------------------------------ VHDL tops at work


def ghdl(place, *command):
    """The output of GHDL run in `place`, a folder of its own."""
    if not shutil.which("ghdl"):
        pytest.skip("GHDL (package ghdl) is not installed: VHDL cannot be tried")
    place.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(["ghdl", *map(str, command)], cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def verilog_of(top, source):
    """Path of the Verilog that GHDL makes of the entity `top` in `source`, without the components' empty modules."""
    place = PRODUCTS / f"vhdl_{top}"
    ghdl(place, "-a", "--std=93", PACKAGE, source)
    text = ghdl(place, "--synth", "--std=93", "--out=verilog", top)
    text = re.sub(rf"^module (?!{top}\b).*?^endmodule\n", "", text, flags=re.M | re.S)
    made = place / f"{top}.v"
    made.write_text(text, encoding="utf-8")
    return made


@pytest.mark.parametrize("standard", ["93", "02", "08"])
def test_package_is_accepted_by_each_standard(standard, tmp_path):
    assert not ghdl(tmp_path, "-a", f"--std={standard}", PACKAGE)


NO_FLOORS = {"T15_MIN_US": 0, "T35_MIN_US": 0}
TOPS = {  # entity: (what it instantiates, suite, its generics, for the model)
    "vhdl_io": (
        "modbus_rtu_slave_io",
        "drop_in",
        {"CLK_HZ": 2_000_000, "BAUD": 250_000, "ADDRESS": 17, **NO_FLOORS},
    ),
    "vhdl_ram": (
        "modbus_rtu_slave",
        "drop_in",
        {
            **NO_FLOORS,
            "CLK_HZ": 1_000_000,
            "BAUD": 62_500,
            "ADDRESS": 247,
            "FORMAT": 3,
            "BROADCAST": 0,
            "GAP_COUNT_ONLY": 1,
            "STRICT_TURNAROUND": 1,
            "RESPONSE_DELAY": 5,
            "DE_LEAD": 3,
            "DE_TAIL": 2,
            "FUNCTION_CODES": function_mask(ALL_FUNCTIONS - {FC.READ_FIFO}),
            "COIL_COUNT": 40,
            "HOLDING_BASE": 100,
            "HOLDING_COUNT": 50,
        },
    ),
    "vhdl_core": ("slave_bench", "smoke", {**NO_FLOORS, "FILE_COUNT": 2, "FILE_RECORDS": 8}),
}


@pytest.mark.parametrize("top", TOPS)
def test_top_works(record_property, top):
    stands_for, module, parameters = TOPS[top]
    made = verilog_of(top, TB / "vhdl" / f"{top}.vhd")
    sim = "icarus" if FULL or top == "vhdl_io" else "verilator"
    env = {"BENCH_TOP": stands_for}
    run(record_property, sim, top, f"system.{module}", parameters, env, own=f"of_{top}", made=made)


BLOCKS = re.findall(r"^```vhdl\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
EXAMPLES = {re.search(r"^entity (\w+) is", block, re.M)[1]: block for block in BLOCKS}


@pytest.mark.parametrize("top", EXAMPLES)
def test_example_of_the_page_elaborates(top, tmp_path):
    """Each block of docs/vhdl.md, through GHDL and with the core through Icarus."""
    source = tmp_path / f"{top}.vhd"
    source.write_text(EXAMPLES[top], encoding="utf-8")
    made, (files, folders) = verilog_of(top, source), sources()
    command = ["iverilog", "-g2005", "-Wall", "-tnull", "-s", top, *(f"-I{folder}" for folder in folders)]
    done = subprocess.run([*command, *map(str, files), str(made)], capture_output=True, text=True, check=False)
    messages = [line for line in done.stderr.splitlines() if "timescale" not in line]
    assert done.returncode == 0 and not messages, "\n".join(messages)
