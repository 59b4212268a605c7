# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The tools behind `make synth`, without synthesis: counting, folding, modules, tables, the size check."""

import copy
import json
import random
import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[1] / "tools"
sys.path.insert(0, str(TOOLS))

import synth  # noqa: E402
import synth_flow  # noqa: E402
import synth_parts  # noqa: E402
import synth_report as report  # noqa: E402
from synth_devices import DEVICES, FAMILIES  # noqa: E402
from synth_profiles import ADDED, BASES, OPTIONS, PROFILES, SHOWN  # noqa: E402

KEYS = [(profile, bank) for profile, banks in PROFILES.items() for bank in banks]
FIELDS = {"profile": str, "bank": str, "device": str, "lc": int, "lut": int, "ff": int, "carry": int, "ram": int}


@pytest.fixture(scope="module")
def record():
    """The figures of the repository."""
    return report.read_record()


def check_rows(rows, full):
    """Every profile, bank and device once, each field of its type; `full`: with the ECP5's place and route."""
    found = [(row["profile"], row["bank"], row["device"]) for row in rows]
    assert found == [(profile, bank, device) for profile, bank in KEYS for device in DEVICES]
    for row in rows:
        for name, kind in FIELDS.items():
            assert type(row[name]) is kind, f"{name} of {row} is no {kind.__name__}"
        device = DEVICES[row["device"]]
        if device.router and (full or not device.optional):
            assert row["fmax_mhz"] > 0 and row["seed"] in synth_flow.SEEDS, row
        else:
            assert row["fmax_mhz"] is None and row["seed"] is None, row
        assert row["lc"] >= row["lut"] > 0, row


# --- the record and the documents -----------------------------------------------------------------


def test_record_has_every_figure(record):
    """docs/size.json: one row per profile, bank and device; parts that add up; every option."""
    check_rows(record["results"], full=True)
    assert set(record["parts"]) == {f"{profile}/{bank}" for profile, bank in SHOWN}
    for name, its in record["parts"].items():
        whole = report.row_of(record["results"], *name.split("/"), report.CHECKED)
        for field in ("lc", "ff", "ram"):
            assert sum(part[field] for part in its.values()) == whole[field], f"{field} of {name}"
    assert set(record["options"]) == {*BASES, *OPTIONS, *ADDED}
    assert record["tools"]["yosys"] and record["tools"]["nextpnr-ice40"] and record["tools"]["nextpnr-ecp5"]


def test_documents_are_made_of_the_record(record):
    """The tables of README.md and docs/size.md and the picture say what docs/size.json says."""
    for path, text in report.documents(record).items():
        assert path.read_text() == text, f"{path.name} is not made of docs/size.json: make synth UPDATE=1"


def test_size_table_shows_each_figure(record):
    """A line per profile and bank, a column per device, in the order of the heads."""
    lines = report.size_table(record["results"], record["tools"]).splitlines()
    body = [line for line in lines if line.startswith("| `")]
    assert [tuple(line.split(" | ")[:2]) for line in body] == [(f"| `{profile}`", bank) for profile, bank in KEYS]
    for (profile, bank), line in zip(KEYS, body, strict=True):
        for name, text in zip(DEVICES, line.strip("| ").split(" | ")[2:], strict=True):
            row = report.row_of(record["results"], profile, bank, name)
            figures = [str(row["lc"]), str(row["ram"])]
            figures += [] if row["fmax_mhz"] is None else [f"{row['fmax_mhz']:.0f}"]
            assert text.split(" / ") == figures
    some = [row for row in record["results"] if row["device"] == "gowin" and row["profile"] == "basic"]
    table = report.size_table(some, record["tools"]).splitlines()
    assert table[0] == "| Profile | Bank | Gowin GW1N: LUT4 / RAM |"
    assert sum(line.startswith("| `") for line in table) == 2


def test_record_survives_writing(record):
    """What record_text writes reads back as it was, but for the parameters."""
    rows = [{**row, "parameters": {"A": "1"}} for row in record["results"]]
    assert json.loads(report.record_text({**record, "results": rows})) == record


def test_missing_marker_is_an_error():
    """A document without the markers is not written."""
    with pytest.raises(report.ReportError, match="parts table begin"):
        report.placed("no marks here", "table", "parts")
    assert report.placed("a\n<!-- parts table begin -->\nold\n<!-- parts table end -->\nb", "new", "parts") == (
        "a\n<!-- parts table begin -->\nnew\n<!-- parts table end -->\nb"
    )


# --- the size check -------------------------------------------------------------------------------

OLD = {"profile": "full", "bank": "ram", "device": report.CHECKED, "lc": 1000, "ram": 16}


@pytest.mark.parametrize(
    "lc, ram, passes, smaller",
    [
        (1000, 16, True, False),
        (1030, 16, True, False),
        (1031, 16, False, False),
        (1040, 16, False, False),
        (1000, 17, False, False),
        (900, 17, False, False),
        (970, 16, True, False),
        (969, 16, True, True),
        (1000, 15, True, True),
    ],
)
def test_limits_of_the_size_check(lc, ram, passes, smaller):
    """3 % of the logic cells and no RAM block; below -3 % it asks for an update."""
    lines, passed, failed, hint = report.compare([OLD], [{**OLD, "lc": lc, "ram": ram}])
    assert (passed, failed, hint) == (passes, not passes, smaller), lines
    assert ("FAILED" in lines[-1]) == (not passes)


def test_unrecorded_design_fails_the_size_check():
    """A profile that docs/size.json does not know cannot pass."""
    _, passed, failed, _ = report.compare([OLD], [{**OLD, "bank": "io"}])
    assert (passed, failed) == (0, 1)


def run_main(monkeypatch, tmp_path, arguments, rows_of):
    """synth.main with `arguments`, `rows_of` in the place of synthesis, place and route; its files in tmp_path."""

    def measure(design, ports, names, seeds, work, full=False):
        profile, bank = work.parts[-2].split("_")
        return {name: copy.deepcopy(rows_of(profile, bank, name, full)) for name in names}

    def parts(work):
        profile, bank = work.parts[-2].split("_")
        return {"modbus_rtu_core": {**rows_of(profile, bank, report.CHECKED, True)}}

    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(synth, "ROOT", tmp_path)
    monkeypatch.setattr(synth, "ports_of", lambda design, work: {})
    monkeypatch.setattr(synth, "measure", measure)
    monkeypatch.setattr(synth, "parts", parts)
    monkeypatch.setattr(sys, "argv", ["synth.py", *arguments])
    return synth.main()


@pytest.mark.parametrize("planted, status, last", [(1.0, 0, "6 passed, 0 failed"), (1.04, 1, "5 passed, 1 failed")])
def test_size_check_catches_a_planted_growth(monkeypatch, tmp_path, capsys, record, planted, status, last):
    """The whole of `make synth CHECK=1` but for the synthesis: one profile 4 % larger fails it."""

    def rows_of(profile, bank, device, full):
        row = dict(report.row_of(record["results"], profile, bank, device))
        if (profile, bank) == ("basic", "ram"):
            row["lc"] = round(row["lc"] * planted)
        return row

    assert run_main(monkeypatch, tmp_path, ["--check"], rows_of) == status
    output = capsys.readouterr().out.splitlines()
    assert output[-1] == last
    assert sum("FAILED" in line for line in output) == status


def test_json_of_a_run(monkeypatch, tmp_path, capsys):
    """build/synth.json: tools, and rows with every field and the parameters; nothing of it for a part of a run."""

    def rows_of(profile, bank, device, full):
        its = DEVICES[device]
        routed = its.router and (full or not its.optional)
        figures = {"lc": 10, "lut": 9, "ff": 8, "carry": 7, "ram": 6}
        return {**figures, "fmax_mhz": 100.0 if routed else None, "seed": 2 if routed else None}

    assert run_main(monkeypatch, tmp_path, [], rows_of) == 0
    written = json.loads((tmp_path / "build/synth.json").read_text())
    check_rows(written["results"], full=False)
    assert set(written) == {"tools", "results"}
    assert written["tools"]["seeds"] == list(synth_flow.SEEDS) and set(written["tools"]["flows"]) == set(DEVICES)
    for row in written["results"]:
        parameters, ties = PROFILES[row["profile"]][row["bank"]]
        assert row["parameters"] == {**parameters, **{f"tied {port}": value for port, value in ties.items()}}
    assert "| `basic` | ram | 10 / 6 / 100 | 10 / 6 / 100 | 10 / 6 | 10 / 6 | 10 / 6 | 10 / 6 |" in (
        capsys.readouterr().out.splitlines()
    )
    (tmp_path / "build/synth.json").unlink()
    (tmp_path / "build").rmdir()
    assert run_main(monkeypatch, tmp_path, ["--profile", "basic,minimal", "--device", "gowin"], rows_of) == 0
    assert not (tmp_path / "build/synth.json").exists()


def test_parts_that_do_not_add_up_are_an_error(monkeypatch, tmp_path):
    """A logic cell lost between the modules stops the run."""
    figures = {"lut": 9, "ff": 8, "carry": 7, "ram": 6, "fmax_mhz": 100.0, "seed": 1}

    def rows_of(profile, bank, device, full):
        return {"lc": 11 if full else 10, **figures}

    with pytest.raises(synth.ToolError, match="the parts are 11 cells, the whole is 10"):
        run_main(monkeypatch, tmp_path, ["--profile", "full"], rows_of)


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["--device=foo"], "DEVICE=foo: there is none; choose from ice40-hx8k"),
        (["--profile=full basci"], "PROFILE=basci: there is none; choose from minimal, basic, full"),
        (["--bank=x"], "BANK=x: there is none; choose from io, ram"),
        (["--update", "--profile=full"], "UPDATE=1 measures everything"),
        (["--update", "--quick"], "UPDATE=1 measures everything"),
        (["--update", "--check"], "update and check do not go together"),
        (["--check", "--device=gowin"], "it goes without DEVICE"),
    ],
)
def test_bad_choice_is_one_line_and_exit_2(arguments, said):
    """A bad make variable: one clear line, exit 2, and nothing has run."""
    done = subprocess.run([sys.executable, str(TOOLS / "synth.py"), *arguments], capture_output=True, text=True)
    assert done.returncode == 2 and not done.stdout
    (line,) = done.stderr.splitlines()
    assert line.startswith("synth: ") and said in line


# --- counting -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "family, kinds, expected",
    [
        ("ice40", {"SB_LUT4": 5, "SB_DFFESR": 2, "SB_DFF": 1, "SB_CARRY": 4, "SB_RAM40_4KNW": 1}, (5, 5, 3, 4, 1)),
        ("ecp5", {"LUT4": 5, "CCU2C": 2, "PFUMX": 3, "TRELLIS_DPR16X4": 1, "DP16KD": 2}, (15, 5, 0, 2, 2)),
        ("gowin", {"LUT1": 1, "LUT4": 2, "MUX2_LUT5": 9, "ALU": 4, "DFFRE": 3, "SPX9": 1, "pROM": 1}, (7, 3, 3, 4, 2)),
        ("xilinx", {"LUT6": 3, "LUT2": 1, "INV": 9, "RAM256X1S": 2, "FDRE": 4, "CARRY4": 2, "RAMB36E1": 1,
                    "RAMB18E1": 1}, (12, 4, 4, 2, 3)),
        ("cyclonev", {"MISTRAL_ALUT6": 2, "MISTRAL_ALUT_ARITH": 3, "MISTRAL_NOT": 4, "MISTRAL_FF": 5,
                      "MISTRAL_M10K": 1}, (5, 2, 5, 3, 1)),
    ],
)  # fmt: skip
def test_cells_are_counted(family, kinds, expected):
    """(lc, lut, ff, carry, ram) as synth_devices.py promises them."""
    counts = FAMILIES[family].counts({**kinds, "$scopeinfo": 7})
    assert tuple(counts[field] for field in ("lc", "lut", "ff", "carry", "ram")) == expected


# --- the wrapper ----------------------------------------------------------------------------------

PORTS = {"clk_i": ("input", 1), "rxd_i": ("input", 1), "busy_i": ("input", 1), "data_i": ("input", 16),
         "data_o": ("output", 16), "status_dat_o": ("output", 16)}  # fmt: skip


def test_wrapper_ties_and_shifts():
    """Constants are tied, other inputs come from the shift register, and its length is returned."""
    design = synth_flow.Design("some_module", {"WIDTH": "16"}, {"busy_i": 1}, left_open=True)
    text, shifted = synth_flow.wrapper(design, PORTS, shift=True)
    assert shifted == 16 and "reg [15:0] shift_q;" in text
    assert ".busy_i(1'd1)" in text and ".data_i(shift_q[0 +: 16])" in text and ".status_dat_o()" in text
    text, shifted = synth_flow.wrapper(design, PORTS, shift=False)
    assert shifted == 0 and "shift" not in text and "input wire [15:0] data_i" in text
    with pytest.raises(synth_flow.ToolError, match="some_module has no port buzy_i"):
        synth_flow.wrapper(synth_flow.Design("some_module", {}, {"buzy_i": 1}), PORTS, shift=True)


@pytest.mark.parametrize("outputs", [2, 4, 5, 7, 8, 64, 150])
@pytest.mark.parametrize("family", ["ice40", "ecp5"])
def test_folded_outputs_all_count(family, outputs, seed):
    """Every output reaches the one pin (an XOR of all), with the number of look-up tables that is subtracted."""
    bits = list(range(10, 10 + outputs))
    ports = {"clk_i": {"direction": "input", "bits": [2]}, "data_o": {"direction": "output", "bits": ["0", *bits]}}
    module = {"ports": ports, "netnames": {name: {"bits": port["bits"]} for name, port in ports.items()}, "cells": {}}
    whole = copy.deepcopy(module)
    assert synth_flow.fold_outputs(module, FAMILIES[family], pins=outputs + 2) == 0 and module == whole
    count = synth_flow.fold_outputs(module, FAMILIES[family], pins=2)
    assert count == len(module["cells"]) == -(-(outputs - 1) // 3)
    assert set(module["ports"]) == {"clk_i", synth_flow.FOLDED}
    kind, inputs, output, _ = FAMILIES[family].fold
    rng = random.Random(seed)
    for _ in range(20):
        values = {bit: rng.randrange(2) for bit in bits} | {"0": 0}
        for cell in module["cells"].values():
            assert cell["type"] == kind
            index = sum(values[cell["connections"][name][0]] << n for n, name in enumerate(inputs.split()))
            (table,) = cell["parameters"].values()
            values[cell["connections"][output][0]] = int(table[::-1][index])
        (pin,) = module["ports"][synth_flow.FOLDED]["bits"]
        assert values[pin] == sum(values[bit] for bit in bits) % 2


# --- the longest path -----------------------------------------------------------------------------


def test_longest_path_is_named_by_modules():
    """The longest path between registers, not one from a pin; each module once in a row, a RAM marked."""

    def step(cell, delay, kind="logic"):
        return {"from": {"cell": cell, "port": "O"}, "to": {"cell": "any", "port": "I0"}, "delay": delay, "type": kind}

    owners = {"u_dut": "top", "u_dut.u_a": "a", "u_dut.u_a.u_b": "b"}
    memory = [step("u_dut.u_a.words.0_RAM", 2.1, "clk-to-q"), step("u_dut.u_a.words.0_RAM", 1.0, "routing"),
              step("u_dut.u_a.u_b.some_LC", 0.4), step("$nextpnr_1", 0.4), step("u_dut.u_a.u_b.more_LC", 0.3),
              step("u_dut.out_LC", 0.3, "setup")]  # fmt: skip
    short = [step("u_dut.u_a.q_LC", 0.5, "clk-to-q"), step("u_dut.u_a.q_LC", 0.3, "setup")]
    report_of = {
        "critical_paths": [
            {"from": "posedge clk_i", "to": "posedge clk_i", "path": short},
            {"from": "posedge clk_i", "to": "posedge clk_i", "path": memory},
            {"from": "<async>", "to": "posedge clk_i", "path": [step("u_dut.pin", 99.0)]},
        ]
    }
    assert synth_parts.longest_path(report_of, owners) == {"ns": 4.5, "through": ["a (RAM)", "b", "top"]}
    assert synth_parts.longest_path({"critical_paths": []}, owners) is None
    row = {"profile": "basic", "bank": "ram", "device": report.CHECKED, "paths": [{"ns": 4.5, "through": ["a", "b"]}]}
    table = report.paths_table([row], {"yosys": "1", "seeds": [1, 2, 3]})
    assert "| `basic` | ram | iCE40 HX8K | 4.50 | a → b |" in table.splitlines()


# --- which module a logic cell belongs to ---------------------------------------------------------


def packed_cell(output, inputs=(), source="", register=False):
    """An ICESTORM_LC as nextpnr writes it."""
    ports = {f"I{n}": [inputs[n]] if n < len(inputs) else [] for n in range(4)}
    return {
        "type": "ICESTORM_LC",
        "attributes": {"src": source} if source else {},
        "parameters": {"LUT_INIT": "1" * 16, "DFF_ENABLE": str(int(register)), "CARRY_ENABLE": "0"},
        "port_directions": {**dict.fromkeys(ports, "input"), "O": "output"},
        "connections": {**ports, "O": [output]},
    }


def test_cells_are_attributed_by_the_four_rules():
    """Register's file, signal's module, readers, what it reads; the rest is shared, the wrapper is nobody's."""
    mapped = "share/ice40/cells_map.v:1.1|"
    packed = {
        "cells": {
            "wrapper": packed_cell(1, source="build/synth/x/synth_top.v:3.1-3.9|share/ff_map.v:2.1", register=True),
            "a_register": packed_cell(2, [12], "rtl/a.v:9.3-9.9|share/ice40/ff_map.v:1.1", register=True),
            "b_register": packed_cell(3, [10, 11], mapped + "/abs/path/rtl/b.v:8.1", register=True),
            "named_by_a": packed_cell(10, [1], "share/ice40/cells_map.v:1.1"),
            "read_by_b": packed_cell(11, [1, 13], mapped),
            "read_by_a_through": packed_cell(12, [14], mapped),
            "reads_a_feeds_both": packed_cell(13, [2], mapped),
            "mixed": packed_cell(14, [2, 3, 15], mapped),
            "to_pin_from_b": packed_cell(16, [3], mapped),
            "mixed_to_pin": packed_cell(17, [2, 3], mapped),
            "memory": {"type": "ICESTORM_RAM", "attributes": {}, "parameters": {}, "port_directions": {},
                       "connections": {}},
        },
        "netnames": {"u_dut.word[0]": {"bits": [10]}, "u_dut.u_b.got_i": {"bits": [11]}},
    }  # fmt: skip
    packed["cells"]["u_dut.u_b.words.0.0_RAM"] = packed["cells"].pop("memory")
    # 13 feeds a's cell too
    packed["cells"]["read_by_a_through"]["connections"]["I1"] = [13]
    scope = {"type": "$scopeinfo", "attributes": {"module": "$paramod$00ff\\b"}}
    netlist = {
        "cells": {"u_dut.u_b": scope},
        "netnames": {
            "u_dut.word[0]": {"bits": [40], "attributes": {"src": "rtl/a.v:2.1-2.5"}},
            "u_dut.u_b.word_i": {"bits": [40], "attributes": {"src": "rtl/b.v:2.1-2.5"}},
            "u_dut.u_b.got_i": {"bits": [41], "attributes": {"src": "rtl/b.v:3.1-3.5"}},
        },
    }
    rows = synth_parts.attribute(netlist, packed)
    assert {name: row["lc"] for name, row in rows.items()} == {"a": 5, "b": 3, synth_parts.SHARED: 1}
    assert rows["b"]["ram"] == 1 and rows["a"]["ff"] == 1 and rows["b"]["ff"] == 1
    assert list(rows)[-1] == synth_parts.SHARED
