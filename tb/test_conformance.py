# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/conformance.md and the README's function table against the tests there are.

That the tests of docs/conformance.md ran, and passed, is judged at the end of a run of everything: conftest.py.
"""

import importlib
import re

import pytest
import test_modules
import test_system
from harness.conformance import DOCUMENT, Row, existing, outcomes, rows, unshown

SOURCES = re.compile(r"(AP|SL|RG|PDM|HL) \S.*|decided here")
ON_THE_RTL = {"test_differential", "test_timing", "test_live", "test_functions", "test_host_library"}  # of pytest


@pytest.fixture(scope="module")
def document():
    return rows(DOCUMENT.read_text(encoding="utf-8"))


def test_every_rule_has_a_source_and_a_test(document):
    assert len(document) > 100
    for row in document:
        assert row.rule, f"line {row.line}: no rule"
        for source in row.source.split("; "):
            assert SOURCES.fullmatch(source), f"line {row.line}: source {source}"


def test_every_test_named_exists(document):
    """In a suite that this run plays: those that are left to FULL=1 do not count without it."""
    there = existing({name: test_system.SUITES[name] for name in test_system.PLAYED}, test_modules.MODULES)
    missing = [f"line {row.line}: {test}" for row in document for test in row.tests if test not in there]
    assert not missing, "\n".join(missing)


def test_every_rule_is_shown_on_the_rtl(document):
    """By a simulation or the compiled core; the model alone shows nothing."""
    suites = {*test_system.SUITES, *test_modules.MODULES, *ON_THE_RTL}
    alone = [f"line {row.line}: {row.rule}" for row in document if not any(suite in suites for suite, _ in row.tests)]
    assert not alone, "\n".join(alone)


def test_what_a_simulator_leaves_runs_elsewhere():
    """Each test of a suite that one simulator plays in part runs on another, or on another build of the same topic."""
    for suite in (*test_system.ON_COMPILED, *test_system.PART_ON_VERILATOR, *test_system.BESIDE_VERILATOR):
        _, _, topic, only = test_system.SUITES[suite]
        generators = vars(importlib.import_module(f"system.{topic}")).values()
        names = [t.fullname for g in generators if hasattr(g, "generate_tests") for t in g.generate_tests()]
        played = [test_system.chosen(*run) or "" for run in test_system.RUNS if test_system.SUITES[run[1]][2] == topic]
        missing = [n for n in names if re.search(only or "", n) and not any(re.search(p, n) for p in played)]
        assert not missing, f"{suite}: nobody runs {missing}"


def test_no_rule_stands_twice(document):
    seen = [row.rule for row in document]
    assert len(seen) == len(set(seen)), {rule for rule in seen if seen.count(rule) > 1}


ROW = Row(7, "a rule", "decided here", (("line_faults", "breaks"), ("test_model", "test_overlay_is_one_memory")))
RAN = [
    ("test_system.py::test_system[icarus-line_faults]", True, [("icarus system.line_faults.breaks/fmt=8.1", True)]),
    ("test_model.py::test_overlay_is_one_memory", True, []),
]


@pytest.mark.parametrize(
    "wanted,results",
    [
        ([], RAN),
        ([], [*RAN, ("live/test_live.py::test_other[3]", False, [])]),
        (["line_faults: breaks did not run"], RAN[1:]),
        (["test_model: test_overlay_is_one_memory did not run"], RAN[:1]),
        # another suite with the same test, another test of the same suite
        (["line_faults: breaks did not run"], [("test_system.py::test_system[icarus-other]", *RAN[0][1:]), RAN[1]]),
        (["line_faults: breaks did not run"], [(*RAN[0][:2], [("icarus system.line_faults.other", True)]), RAN[1]]),
        # once wrong is wrong
        (["line_faults: breaks failed"], [*RAN, (*RAN[0][:2], [("icarus system.line_faults.breaks/fmt=1", False)])]),
        (["test_model: test_overlay_is_one_memory failed"], [*RAN, (RAN[1][0] + "[x]", False, [])]),
    ],
)
def test_what_did_not_run_is_noticed(wanted, results):
    assert unshown([ROW], outcomes(results)) == [f"line 7: {text}" for text in wanted]


@pytest.mark.parametrize("cell", ["", "`line_faults`", "line_faults: breaks", "`a: b`, `c: d`"])
def test_a_row_without_a_test_is_noticed(cell):
    with pytest.raises(ValueError):
        rows(f"| Rule | Source | Shown by |\n|---|---|---|\n| a | decided here | {cell} |\n")


def test_function_table_of_the_readme(monkeypatch):

    import function_table

    assert not function_table.stale(), "run tools/function_table.py --update"
