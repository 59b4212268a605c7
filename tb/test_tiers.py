# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The tools behind make quick, test and nightly: what they choose, count and refuse."""

import re
import sys

import nightly
import pytest
import quick
import run_tests
from harness import volume
from harness.runner import ROOT

TARGETS = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M)) | {"demo", "serve", "try"}


@pytest.mark.parametrize(
    "text,wanted",
    [
        ("912 passed, 3 failed, 1 skipped\n", (912, 3)),
        ("1 passed, 0 failed\nmeasured\n5 passed, 2 failed\n", (5, 2)),
        ("x: FAILS\n147 of 148 mistakes caught\n", (147, 1)),
        ("0 lint messages\n", (0, 0)),
        ("nothing\n", (0, 0)),
    ],
)
def test_a_stage_is_counted(text, wanted):
    assert nightly.counts(text) == wanted


def test_report_names_every_stage_and_shows_why_one_failed(monkeypatch, tmp_path):
    monkeypatch.setattr(nightly, "OUT", tmp_path)
    (tmp_path / "formal.log").write_text("pass  one\nFAIL  two\n1 passed, 1 failed\n")
    failed = {"state": "x", "status": 2, "passed": 1, "failed": 1, "seconds": 90}
    text = nightly.report({**dict.fromkeys(nightly.STAGES), "formal": failed}, "x")
    assert all(f"| {name} |" in text for name in nightly.STAGES)
    assert "| **failed** | 1 | 1 | 1.5 |" in text and "FAIL  two" in text and "pass  one" not in text
    assert text.count("not run") == len(nightly.STAGES) - 1


def test_a_stage_goes_on_after_a_failure(monkeypatch, tmp_path, capsys):
    """Two stages that fail are both run and both reported; the result of one state is kept for the next report."""
    monkeypatch.setattr(nightly, "OUT", tmp_path)
    monkeypatch.setattr(nightly, "REPORT", tmp_path / "report.md")
    monkeypatch.setattr(nightly, "STAGES", {"one": (["no_such_target"], "a"), "two": (["no_such_target"], "b")})
    monkeypatch.setattr(nightly, "state", lambda: "x")
    monkeypatch.setattr(sys, "argv", ["nightly.py"])
    assert nightly.main() == 1
    assert (tmp_path / "report.md").read_text().count("**failed**") == 2
    monkeypatch.setattr(sys, "argv", ["nightly.py", "one"])
    assert nightly.main() == 1 and nightly.earlier("two", "x") and not nightly.earlier("two", "y")
    monkeypatch.setattr(sys, "argv", ["nightly.py", "three"])
    with pytest.raises(SystemExit) as ended:
        nightly.main()
    assert ended.value.code == 2 and "no stage three" in capsys.readouterr().err


@pytest.mark.parametrize(
    "variable,value",
    [("FULL", "yes"), ("SEED", "x"), ("COUNT", "-1"), ("CASE", "("), ("GATES", "2"), ("T", "tb/nowhere.py")],
)
def test_bad_values_are_refused(monkeypatch, variable, value):
    if variable == "T":
        assert "no file" in run_tests.complaint(value)
    else:
        monkeypatch.setenv(variable, value)
        assert run_tests.complaint("").startswith(f"{variable}={value}: ")


@pytest.mark.parametrize("given", ["", "random", "tb/live", "tb/test_system.py::test_system[icarus-fifo]"])
def test_good_values_are_taken(monkeypatch, given):
    monkeypatch.setenv("SEED", "0x10")
    monkeypatch.setenv("FULL", "")
    assert not run_tests.complaint(given)


def test_quick_lints_what_differs():
    assert quick.to_lint({"rtl/line/modbus_crc16.v", "README.md"}) == ["modbus_crc16"]
    assert quick.to_lint({"rtl/include/modbus_defs.vh"}) == list(quick.TOPS), "every module includes it"
    assert quick.to_lint({"tb/README.md"}) == []
    assert "tb/test_modules.py::test_module[icarus-crc16]" in quick.unit_tests({"rtl/line/modbus_crc16.v"})


def test_what_quick_runs_exists():
    import test_system

    runs = {f"{sim}-{suite}" for sim, suite in test_system.RUNS}
    for name in quick.ALWAYS:
        path, _, case = name.partition("::")
        assert (ROOT / path).exists(), path
        assert not case or case.removeprefix("test_system[").rstrip("]") in runs, case


def test_tiers_and_workflows_call_make_targets_that_exist():
    ci = (ROOT / ".ci/run").read_text(encoding="utf-8")
    steps = re.findall(r"^step make (\w+)", ci, re.M)
    jobs = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / ".github/workflows").glob("*.yml"))
    matrix = re.findall(r"^ {10}- (\w+)", jobs, re.M)
    assert {*steps, *matrix, *(command[0] for command, _ in nightly.STAGES.values())} <= TARGETS
    assert set(steps) <= set(matrix), "a step of .ci/run is no job"


def test_both_volumes_have_the_same_rows():
    assert volume.USUAL.keys() == volume.FULL.keys()
    assert all(volume.FULL[what] >= size for what, size in volume.USUAL.items())


def test_the_night_has_a_job_for_each_stage():
    text = (ROOT / ".github/workflows/nightly.yml").read_text(encoding="utf-8")
    assert re.search(r"stage: \[(.*)\]", text)[1].split(", ") == list(nightly.STAGES)
