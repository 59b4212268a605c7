# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The scripted mistakes of tools/mistakes fit the RTL as it is; `make mistakes` plants them."""

import plant
import pytest
import test_buses
import test_modules
import test_system
from mistakes import MISTAKES
from mistakes.selection import COMPILED, COMPILER_FIRST, COMPILER_TESTS, FIRST, SELECTION


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_mistake_can_be_planted(mistake):
    """Its text is found, and only once, so what is planted is what was meant."""
    try:
        text = plant.path_of(mistake.file).read_text(encoding="utf-8")
    except StopIteration:
        pytest.fail(f"no file {mistake.file}", pytrace=False)
    found = text.count(mistake.old)
    assert found == 1, f"{mistake.old!r} occurs {found} times in {mistake.file}"
    assert mistake.new != mistake.old


def test_names_differ():
    names = [mistake.name for mistake in MISTAKES]
    assert len(names) == len(set(names)), {name for name in names if names.count(name) > 1}


def test_what_is_tried_exists():
    suites = {*test_modules.MODULES, *test_system.SUITES, *test_buses.SUITES, COMPILED}
    assert {suite for suite, _ in SELECTION} <= suites
    assert {suite for first in FIRST.values() for suite in first} <= {suite for suite, _ in SELECTION}
    assert set(COMPILER_FIRST.values()) <= set(COMPILER_TESTS)
    assert all((plant.TB / f"map/{name}.py").exists() for name in COMPILER_TESTS)


def test_every_row_of_the_table_is_a_mistake():
    """docs/mistakes.md is written by `make mistakes UPDATE=1`, which also says what it lacks."""
    text = plant.TABLE.read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| ") and not line.startswith("| Mistake |")]
    files = {mistake.name: mistake.file for mistake in MISTAKES}
    for line in rows:
        found = plant.ROW.fullmatch(line)
        assert found, f"not as written by make mistakes UPDATE=1: {line}"
        assert files.get(found[1]) == found[2], f"no mistake {found[1]} in {found[2]}"


@pytest.mark.parametrize("failed", [["frame_rx: length_limits"], ["a: b/code=3", "a: c"], ["random traffic, compiled"]])
def test_a_row_is_read_as_it_was_written(failed):
    line = plant.row(MISTAKES[0], failed)
    suite, _, test = failed[0].partition(": ")
    found = plant.ROW.fullmatch(line)
    assert found and (found[3] or "", found[4] or "") == ((suite, test) if test else ("", ""))
