# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""pytest set-up: paths, options from the environment, and the closing line `N passed, N failed`."""

import os
import sys
from pathlib import Path

import pytest

TB = Path(__file__).resolve().parent
sys.path[:0] = [str(TB), str(TB.parent / "tools")]
# cocotb starts the simulator with this path, so that it finds harness, protocol and the test modules.
os.environ["PYTHONPATH"] = os.pathsep.join([str(TB), *filter(None, [os.environ.get("PYTHONPATH")])])

from harness.volume import IS_FULL as FULL  # noqa: E402
from harness.volume import QUICK  # noqa: E402

if not FULL:  # live devices too
    os.environ.setdefault("MODELS_OPTIMISE", QUICK)

SEED = int(os.environ.get("SEED", "1"), 0)


def pytest_report_header():
    return f"seed {SEED} (SEED=n for another){', FULL volume' if FULL else ''}"


@pytest.fixture
def seed():
    """The run's random seed, from SEED."""
    return SEED


def _property(report, name):
    """What a test recorded as `name`, or an empty list."""
    return dict(getattr(report, "user_properties", [])).get(name, [])


def _simulations(reporter):
    """(CPU seconds, test) of every simulation, the longest first."""
    reports = [r for outcome in ("passed", "failed") for r in reporter.stats.get(outcome, [])]
    return sorted(((_property(r, "cpu"), r.nodeid) for r in reports if _property(r, "cpu")), reverse=True)


def _counts(reporter):
    """(passed, failed, skipped): a pytest test that ran a simulation counts as its cocotb tests."""
    passed = failed = 0
    for outcome in ("passed", "failed", "error"):
        for report in reporter.stats.get(outcome, []):
            inside = _property(report, "cocotb")
            if inside:
                good = sum(ok for _, ok in inside)
                passed += good
                failed += len(inside) - good
                if outcome != "passed" and good == len(inside):
                    failed += 1
            elif outcome == "passed":
                passed += 1
            else:
                failed += 1
    return passed, failed, len(reporter.stats.get("skipped", []))


def _whole(session):
    """True if nothing was left out of this run, so that what did not run is missing."""
    config = session.config
    choices = ("keyword", "markexpr", "deselect", "ignore", "ignore_glob", "lf", "collectonly")
    chosen = [os.environ.get("CASE"), *(config.getoption(name, default=None) for name in choices)]
    every = [Path(config.invocation_params.dir, arg).resolve() == TB for arg in config.args]
    ended = session.shouldstop or session.shouldfail or session.exitstatus not in (0, 1)
    return bool(every) and all(every) and not any(chosen) and not ended


UNSHOWN = pytest.StashKey[list]()


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session):
    """After a run of everything: every test that docs/conformance.md names has run, and passed.

    Only the process that all results come to knows that. It counts as one more test.
    """
    from harness import conformance

    config = session.config
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or hasattr(config, "workerinput") or not _whole(session):
        return
    results = [
        (report.nodeid, outcome == "passed", _property(report, "cocotb"))
        for outcome in ("passed", "failed", "error")
        for report in reporter.stats.get(outcome, [])
    ]
    named = conformance.rows(conformance.DOCUMENT.read_text(encoding="utf-8"))
    config.stash[UNSHOWN] = conformance.unshown(named, conformance.outcomes(results))
    if config.stash[UNSHOWN]:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or hasattr(config, "workerinput"):
        return
    for report in (r for outcome in ("passed", "failed") for r in reporter.stats.get(outcome, [])):
        for line in _property(report, "figures"):
            reporter.write_line(f"measured {line}")
    if os.environ.get("TIMES") == "1":
        for seconds, name in _simulations(reporter):
            reporter.write_line(f"{seconds:7.1f} s of CPU time {name}")
    passed, failed, skipped = _counts(reporter)
    if UNSHOWN in config.stash:
        wrong = config.stash[UNSHOWN]
        passed, failed = passed + (not wrong), failed + bool(wrong)
        for text in wrong or ["every test that it names ran and passed"]:
            reporter.write_line(f"docs/conformance.md, {text}")
    for report in reporter.stats.get("skipped", []):
        reporter.write_line(f"skipped {report.nodeid}: {report.longrepr[2]}")
    more = f", {skipped} skipped" if skipped else ""
    reporter.write_line(f"{passed} passed, {failed} failed{more}")
