# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""tb/formal/proofs.txt fits the RTL as it is; `make formal` proves its rows."""

import re

import formal
import pytest
from harness.runner import ROOT

from common import all_files

TABLE = formal.read_table(formal.TABLE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("mistake", TABLE.mistakes, ids=lambda m: f"{m.proof}-{m.old}")
def test_planted_mistake_fits(mistake):
    """Its text stands once in its file."""
    assert not formal.misfit(mistake)
    assert mistake.new != mistake.old


@pytest.mark.parametrize("proof", TABLE.proofs.values(), ids=lambda proof: proof.name)
def test_proof_has_its_modules_and_properties(proof):
    there = formal.sources(proof.map)
    missing = [name for name in (proof.module, *proof.beside) if f"{name}.v" not in there]
    assert not missing, f"no module {', '.join(missing)}"
    assert formal.properties(proof), f"nothing in {proof.module} that {proof.method} checks"


def test_every_include_file_is_there():
    """What the files of a proof include is beside them."""
    there = formal.sources()
    wanted = {name for path in there.values() for name in re.findall(r'^ *`include "([^"]+)"', path.read_text(), re.M)}
    assert wanted <= set(there), sorted(wanted - set(there))


def test_every_module_with_properties_is_proven():
    proven = {name for proof in TABLE.proofs.values() for name in (proof.module, *proof.beside)}
    with_properties = {p.stem for name in all_files() if "`ifdef FORMAL" in (p := ROOT / name).read_text()}
    assert with_properties <= proven, f"no row for {sorted(with_properties - proven)}"


def test_every_proof_by_induction_or_pdr_is_tried_with_a_mistake():
    """At least one mistake for each module: a proof that no mistake fails may prove nothing."""
    tried = {TABLE.proofs[m.proof].module for m in TABLE.mistakes}
    proven = {proof.module for proof in TABLE.proofs.values() if proof.method != "cover"}
    assert proven <= tried, f"no mistake for {sorted(proven - tried)}"


SMALL = "set few = cut=a,b N=1\none m pdr 0 @few cut=c tier=nightly with=x\nmistake one `a#1` -> ``\n"


def test_table_is_read():
    table = formal.read_table(SMALL)
    (proof,) = table.proofs.values()
    assert (proof.cut, proof.beside, proof.parameters, proof.tier) == (["a", "b", "c"], ["x"], {"N": "1"}, "nightly")
    assert table.mistakes == [("one", "m.v", "a#1", "", "")]
    assert formal.read_table(SMALL.replace("one `", "one n.vh `")).mistakes[0].file == "n.vh"
    assert formal.read_table("one m pdr 0").proofs["one"].tier == "ci"
    table = formal.read_table("map one examples/box/box.yaml bmc 9 tier=nightly\nmistake one `a` -> `b`")
    assert table.proofs["one"][1:4] == ("box_properties", "bmc", 9) and table.proofs["one"].tier == "nightly"
    assert table.mistakes == [("one", "box.v", "a", "b", "examples/box/box.yaml")]


def test_every_reference_map_is_proven():
    files = {str(path.relative_to(ROOT)) for path in ROOT.glob("examples/*/*.yaml")}
    assert files == {proof.map for proof in TABLE.proofs.values() if proof.map}


@pytest.mark.parametrize(
    "row",
    ["one m pdr", "one m magic 0", "one m pdr x", "one m pdr 0 N", "one m pdr 0 tier=daily", "one m pdr 0 @none",
     "mistake one `a` -> `b`", "one m pdr 0\none m pdr 0", "set = a",
     "map one box", "map one a/box.yaml", "map one a/box.yaml pdr 0 tier=daily"],
)  # fmt: skip
def test_wrong_row_is_refused(row):
    with pytest.raises(formal.TableError, match=r"row \d"):
        formal.read_table(row)


def test_properties_of_a_proof_are_read_and_no_others():
    """The module's own, those of `with`, and the rules; the rest of the design is plain logic."""
    proof = formal.read_table("one modbus_frame_rx pdr 0 with=modbus_crc16 N=2").proofs["one"]
    script = formal.sby_text(proof, {})
    formal_ones = set(re.findall(r"^read -formal -I. (\w+)", script, re.M))
    assert {"modbus_frame_rx", "modbus_crc16", "axil_rules"} <= formal_ones
    assert "read_verilog -I. modbus_rtu_core.v" in script and "chparam -set N 2 modbus_frame_rx" in script
