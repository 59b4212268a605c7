# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The bus sides in cocotb: the core as a master, a CPU at the RAM bank, two masters in one SoC."""

import re
import shutil
import subprocess

import interface
import pytest
from conftest import FULL
from harness.build import NO_FLOORS, REFERENCE
from harness.runner import ROOT, run, source_of

MASTER, SLAVE, MAPPING = "bus_master_bench", "axil_slave_bench", "host_map_bench"
MAPPED = {**NO_FLOORS, **REFERENCE}
# Places that no table begins at: nothing of an address is a constant.
SCATTERED = {
    **MAPPED,
    "COIL_AT": 0x40000004,
    "DISCRETE_AT": 0x80001FFC,
    "INPUT_AT": 0xFFFF8000,
    "HOLDING_AT": 0x12345678,
    "FILE_AT": 0x7FFFFFF0,
}

# name: (top, parameters, cocotb module, names of cocotb tests or None for all)
SUITES = {
    "axil_master": (MASTER, {**MAPPED, "AXIL": 1}, "master", None),
    "axil_master_scattered": (MASTER, {**SCATTERED, "AXIL": 1}, "master", "waits/odds=0.3|files|tables"),
    "axil_master_two_tables": (
        MASTER,
        {**MAPPED, "AXIL": 1, "DISCRETE_COUNT": 0, "HOLDING_COUNT": 0},
        "master",
        "missing_table",
    ),
    "axil_master_unguarded": (MASTER, {**MAPPED, "AXIL": 1, "GUARD": 0}, "master", "waits/odds=0.5|tables"),
    "wishbone_master": (MASTER, {**MAPPED, "AXIL": 0}, "master", None),
    "axil_slave": (SLAVE, MAPPED, "slave", None),
    "wishbone_host": ("slave_bench", MAPPED, "slave", None),
    "host_map_axil": (MAPPING, {**MAPPED, "AXIL": 1}, "host_map", None),
    "host_map_wishbone": (
        MAPPING,
        {**MAPPED, "AXIL": 0, "BIT_FRACTIONS": 1, "ASCII_MODE": 1, "LINE_HEALTH": 1},
        "host_map",
        None,
    ),
    "host_map_reads_only": (MAPPING, {**MAPPED, "AXIL": 0, "HOST_SETTINGS": 0}, "host_map", "item|counters"),
    "host_map_left_out": (MAPPING, {**MAPPED, "AXIL": 1, "HOST_MAP": 0}, "host_map", "left_out"),
    "soc_axil": ("modbus_example_soc_axil", NO_FLOORS, "soc", None),
    "soc_axil_largest": ("modbus_example_soc_axil", {**NO_FLOORS, "WORDS": 65536}, "soc", "half_a_write"),
    "soc_wishbone": ("modbus_example_soc_wb", NO_FLOORS, "soc", None),
}


# The others are short in Icarus, which plays all with FULL=1: regular expression of what each simulator plays.
ON_VERILATOR = {
    **dict.fromkeys(("axil_master", "axil_slave", "wishbone_host", "host_map_axil", "host_map_wishbone")),
    **dict.fromkeys(("soc_axil", "soc_wishbone")),
    "wishbone_master": "waits|tables|missing|dead_bus|late_answer|time$",
}
KEPT_BY_ICARUS = {"wishbone_master": "errors_are"}  # these fail in Verilator with the slave of cocotbext-wishbone
RUNS = [
    *(("verilator", name) for name in ON_VERILATOR),
    *(("icarus", name) for name in SUITES if FULL or name in KEPT_BY_ICARUS or name not in ON_VERILATOR),
]


@pytest.mark.parametrize("sim,suite", RUNS, ids=[f"{sim}-{name}" for sim, name in RUNS])
def test_buses(record_property, sim, suite, seed):
    top, parameters, module, only = SUITES[suite]
    only = ON_VERILATOR[suite] if sim == "verilator" else only if FULL else KEPT_BY_ICARUS.get(suite, only)
    run(record_property, sim, top, f"bus.{module}", parameters, {"BENCH_SEED": str(seed)}, only, suite)


# ------------------------------------------------------------------ the document and the header

PAGE, HEADER = ROOT / "docs" / "buses.md", ROOT / "docs" / "modbus_map.h"
MAP = {"coils": 0, "discrete inputs": 1, "input registers": 2, "holding registers": 3}
WINDOW = 0x40000  # bytes of a table


def test_parameters_are_those_of_the_rtl():
    """Names and defaults on the page; what stands there as one row is what other banks have too."""
    for module in ("modbus_axil_master", "modbus_axil_slave"):
        declared = interface.header(module)[0]
        page = PAGE.read_text(encoding="utf-8")
        table = page[page.index(f"\n`{module}`:") :].split("\n\n")[1]
        listed = dict(re.findall(r"^\| `(\w+)` \| ([\w']+) \|", table, re.M))
        assert listed and listed.items() <= declared.items(), f"{module}: {listed} on the page, {declared} in the RTL"
        others = set(declared) - set(listed)
        tables = re.compile("_(BASE|COUNT|RECORDS)$|^OVERLAY$")
        assert all(tables.search(name) for name in others), f"{module}: not on the page: {others}"


def test_map_is_one_map():
    """Page, header, test bench and the RTL's defaults."""
    page, header = PAGE.read_text(encoding="utf-8"), HEADER.read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([^|,]+?)(?:,[^|]*)? \| (\d) \| ([0-9A-F]{6})H(?: \+ 4n)? \| ?(?:`(\w+)`)?", page, re.M)
    assert [int(space) for _, space, *_ in rows] == [*range(6), 7], rows
    rtl = source_of("modbus_axil_master").read_text(encoding="utf-8")
    macros = ("COILS", "DISCRETES", "INPUTS", "HOLDINGS", "FILES", "CORE", "HOLD")
    for (_, space, offset, parameter), macro in zip(rows, macros, strict=True):
        place = int(offset, 16)
        assert place == int(space) * WINDOW
        assert re.search(rf"#define MODBUS_{macro}\s+0x{place:06X}u", header), f"MODBUS_{macro} in {HEADER.name}"
        if parameter:
            assert re.search(rf"\b{parameter}\s*= 32'h{place:08X}\b", rtl), parameter


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler (cc)")
def test_header_compiles_and_reaches_the_words(tmp_path):
    """Against memory in place of the device."""
    program = tmp_path / "map.c"
    program.write_text(
        """
        #include <stdint.h>
        static uint32_t words[0x200000 / 4];
        #define MODBUS_BASE words
        #include "modbus_map.h"
        int main(void)
        {
            MODBUS_COIL(1) = 1; MODBUS_DISCRETE(2) = 2; MODBUS_INPUT(3) = 3; MODBUS_HOLDING(65535) = 4;
            MODBUS_RECORD(3, 7, 256) = 5;
            modbus_write32(MODBUS_INPUTS, 8, 0x12345678);
            MODBUS_BIT_TIME = 434; MODBUS_STATUS(0x0A) = 9;
            return !(words[1] == 1 && words[0x10002] == 2 && words[0x20003] == 3 && words[0x3FFFF] == 4
                     && words[0x40000 + 519] == 5 && words[0x20008] == 0x1234 && words[0x20009] == 0x5678
                     && words[0x70000] == 0
                     && words[0x50081] == 434 && words[0x5000A] == 9 && modbus_read32(MODBUS_INPUTS, 8) == 0x12345678);
        }
        """,
        encoding="utf-8",
    )
    binary = tmp_path / "map"
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{HEADER.parent}"]
    subprocess.run(["cc", *options, str(program), "-o", str(binary)], check=True)
    assert subprocess.run([str(binary)], check=False).returncode == 0
