# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/conformance.md: its rows, the tests there are, and what became of those that it names.

A test is named `suite: name`.  For a cocotb test the suite is that of test_system.py or test_modules.py and
the name is the function's, whatever its parameters; for a pytest function the suite is the file's stem.
"""

import ast
import re
from collections import defaultdict
from dataclasses import dataclass

from .runner import ROOT, TB

DOCUMENT = ROOT / "docs" / "conformance.md"
COLUMNS = ["Rule", "Source", "Shown by"]
HARNESSES = {"test_system", "test_modules"}  # pytest files whose tests are cocotb's


@dataclass(frozen=True)
class Row:
    """One rule: the line it is on, its cells, and the tests named, as (suite, name)."""

    line: int
    rule: str
    source: str
    tests: tuple


def rows(text):
    """Every row of the tables with the columns of COLUMNS; ValueError for a cell that names no test."""
    out, inside = [], False
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            inside = False
        elif cells == COLUMNS:
            inside = True
        elif inside and not re.fullmatch(r"[-:]+", cells[0]):
            if len(cells) != len(COLUMNS):
                raise ValueError(f"line {number}: {len(cells)} cells")
            named = [re.fullmatch(r"`(\w+): (\w+)`", item.strip()) for item in cells[2].split("<br>")]
            if not all(named):
                raise ValueError(f"line {number}: not `suite: name`<br>...: {cells[2]}")
            out.append(Row(number, cells[0], cells[1], tuple(match.groups() for match in named)))
    return out


def _functions(path, wanted):
    """Names of the top-level functions of a Python file that satisfy `wanted`."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    return {node.name for node in tree.body if isinstance(node, kinds) and wanted(node)}


def _is_cocotb(node):
    return any(ast.unparse(d).startswith("cocotb.test") for d in node.decorator_list)


def existing(suites, modules):
    """{(suite, name)} of every test, from the sources.

    `suites` as SUITES in test_system.py, `modules` as MODULES in test_modules.py.
    """
    out = set()
    for suite, (_, _, module, only) in suites.items():
        # a choice may go on to the parameters, behind a slash
        chosen = re.compile(re.sub(r"/[^|]*", "", only or ""))
        for name in _functions(TB / "system" / f"{module}.py", _is_cocotb):
            if chosen.search(f"system.{module}.{name}"):
                out.add((suite, name))
    for suite, (_, _, module) in modules.items():
        out |= {(suite, name) for name in _functions(TB / f"{module.replace('.', '/')}.py", _is_cocotb)}
    for path in TB.rglob("test_*.py"):
        if path.stem not in HARNESSES:
            out |= {(path.stem, name) for name in _functions(path, lambda node: node.name.startswith("test_"))}
    return out


def outcomes(results):
    """{(suite, name): [passed, ...]} of a session; `results` are (nodeid, passed, cocotb results).

    The cocotb results of a test are what harness.runner.run recorded: ("simulator module.name/parameters", passed).
    """
    out = defaultdict(list)
    for nodeid, passed, inside in results:
        file, _, test = nodeid.partition("::")
        stem = file.rsplit("/", 1)[-1].removesuffix(".py")
        name, _, case = test.rstrip("]").partition("[")
        if stem not in HARNESSES:
            out[stem, name].append(passed)
        for said, good in inside:
            simulator, _, full = said.partition(" ")
            function = full.partition("/")[0].rsplit(".", 1)[-1]
            out[case.removeprefix(f"{simulator}-"), function].append(good)
    return out


def unshown(named, seen):
    """What is wrong with the tests that `named` rows need, given the session's outcomes: a list of texts."""
    out = []
    for row in named:
        for suite, name in row.tests:
            passed = seen.get((suite, name))
            if not passed:
                out.append(f"line {row.line}: {suite}: {name} did not run")
            elif not all(passed):
                out.append(f"line {row.line}: {suite}: {name} failed")
    return out
