#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Plants deliberate mistakes in copies of the RTL, or of the map compiler, and shows which test catches each.

    plant.py              all of them
    plant.py crc          those whose name contains `crc`
    plant.py --missing    those that docs/mistakes.md does not name
    plant.py --update ... puts what was seen into docs/mistakes.md, each at once

A mistake (tools/mistakes/) is a search and replace in one file; a pattern that is not found exactly once stops the
run, so a mistake cannot silently become none.  Each copy first meets the test that caught the mistake the last time,
by docs/mistakes.md; if that passes, the same fast selection of the regression as all others, in the same order, until
something fails.  At the end the untouched RTL must pass every test that has caught a mistake.  Exit status 0 only if
it does, every mistake is caught, and the table names all of them; 2 for a name that no mistake has.
"""

import argparse
import contextlib
import fcntl
import io
import json
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

import models
from mistakes import MISTAKES
from mistakes.selection import BUSES, COMPILED, COMPILER_FIRST, COMPILER_TESTS, FIRST, MODULES_ALONE, SELECTION

ROOT = Path(__file__).resolve().parents[1]
TB = ROOT / "tb"
TREES = ("rtl", "examples")  # where the Verilog is
COMPILER = "tools/modbus_map"  # the map compiler; its tests run in a copy of the whole checkout
NO_COPY = ("build", "__pycache__", ".*", "*.pyc")
WORK = ROOT / "build" / "mistakes"
TABLE = ROOT / "docs" / "mistakes.md"
WORKERS = min(2, os.cpu_count() or 1)
TIMEOUT_SECONDS = 900
MAPS_FOR_A_MISTAKE = "20"  # random maps that a mistake of the map compiler meets
ROW = re.compile(r"^\| (\w+) \| `([\w.]+)` \| (?:`(\w+): ([^`]+)`(?: and \d+ more)?|random traffic|(.*)) \|$", re.M)
TEST = re.compile(r"[\w/=.+,-]+")  # the name of a cocotb test
HEAD = """# Deliberate mistakes

`make mistakes UPDATE=1` writes this table. It plants each mistake of [`tools/mistakes/`](../tools/mistakes) in a copy
of the RTL, or of the map compiler, and runs a selection of the tests until one fails. The table names the suite and the
test that failed first; others may notice the mistake too.

| Mistake | In | Caught by |
|---|---|---|
"""


def read_table():
    """{mistake: (suite, test)} of docs/mistakes.md; suite and test are empty for random traffic."""
    text = TABLE.read_text(encoding="utf-8") if TABLE.exists() else ""
    return {found[1]: (found[3] or "", found[4] or "") for found in ROW.finditer(text)}


def row(mistake, failed):
    """The line of the table for what `failed` (["suite: test", ...], or the random traffic)."""
    more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
    first = COMPILED if failed[0].startswith(COMPILED) else f"`{failed[0]}`{more}"
    return f"| {mistake.name} | `{mistake.file}` | {first} |"


def in_compiler(file):
    """True if a mistake in this file is one of the map compiler."""
    return file.endswith(".py")


def path_of(file, folder=ROOT):
    """Where the file of a mistake is below `folder`."""
    places = [COMPILER] if in_compiler(file) else TREES
    return next(path for place in places for path in (folder / place).rglob(file))


def planted(mistake, folder):
    """Copy the Verilog, or what the map compiler needs, to `folder` with the mistake in it."""
    shutil.rmtree(folder, ignore_errors=True)
    if mistake is None or not in_compiler(mistake.file):
        for tree in TREES:
            shutil.copytree(ROOT / tree, folder / tree)
    else:
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NO_COPY), symlinks=True)
    if mistake is None:
        return
    path = path_of(mistake.file, folder)
    text = path.read_text(encoding="utf-8")
    found = text.count(mistake.old)
    if found != 1:
        sys.exit(f"{mistake.name}: the pattern is {found} times in {mistake.file}: {mistake.old}")
    path.write_text(text.replace(mistake.old, mistake.new), encoding="utf-8")


# ------------------------------------------------------------------ in a process whose TREE= names the copy


def concerns(suite, file):
    """True if a suite can notice a mistake in this file."""
    if suite in BUSES or any(file in files for files in BUSES.values()):
        return file in BUSES.get(suite, ())
    return file in MODULES_ALONE.get(suite, (file,))


def judge(touched, remembered):
    """Run parts of the selection until a test fails; print what failed as JSON.

    `touched`: the file that the mistake is in; `remembered`: "suite: test" to begin with, or "".
    """
    failed = []
    suite, _, test = remembered.partition(": ")
    if in_compiler(touched):
        first = COMPILER_FIRST.get(touched)
        failed = of_the_compiler([suite], test) if test else []
        rest = sorted(COMPILER_TESTS, key=lambda name: name != first)
        print(json.dumps(failed or of_the_compiler(rest)))
        return
    if test:
        failed = simulated(suite, f"{re.escape(test)}$", len(SELECTION), only_tests=True)
    elif suite == COMPILED:
        failed = compiled(dict(SELECTION)[COMPILED])
    wanted = FIRST.get(touched, ())
    for number, (suite, part) in sorted(enumerate(SELECTION), key=lambda one: one[1][0] not in wanted):
        if failed:
            break
        if concerns(suite, touched):
            failed = compiled(part) if suite == COMPILED else simulated(suite, part, number)
    print(json.dumps(failed))


def judge_untouched(tests):
    """Run these tests, {suite: names, or none for all of it}, without a mistake; print what failed as JSON."""
    failed = []
    for suite, names in tests.items():
        if suite == COMPILED:
            failed += compiled(dict(SELECTION)[COMPILED])
        elif suite in COMPILER_TESTS:
            failed += of_the_compiler([suite], " or ".join(names), Path(ROOT))
        else:
            only = f"({'|'.join(map(re.escape, names))})$" if names else None
            failed += simulated(suite, only, len(SELECTION))
    print(json.dumps(failed))


def of_the_compiler(suites, only="", folder=None):
    """The first failed test in files of tb/map of the copy, or nothing."""
    folder = folder or Path(os.environ["TREE"])
    environment = {**os.environ, "BENCH_BUILD": str(WORK / "compiler"), "MAPS": MAPS_FOR_A_MISTAKE}
    environment.pop("TREE")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *(f"tb/map/{suite}.py" for suite in suites), "-x", "-q", "-n", "0",
         "-p", "no:cacheprovider", "-rfE", *(["-k", only] if only else [])],
        cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    print(done.stdout[-4000:], file=sys.stderr)
    found = re.search(r"^(?:FAILED|ERROR) (?:tb/)?map/(\w+)\.py(?:::(\w+))?", done.stdout, re.M)
    if found:
        return [f"{found[1]}: {found[2] or 'cannot be read'}"]
    return [] if done.returncode == 0 else [f"{suites[0]}: pytest ended with {done.returncode}"]


def suite_of(name):
    """(top, parameters, cocotb module, its tests or None) of a suite; None for a name that is none."""
    import test_buses
    import test_modules
    import test_system

    if name in test_modules.MODULES:
        return (*test_modules.MODULES[name], None)
    for suites, room in ((test_buses.SUITES, "bus"), (test_system.SUITES, "system")):
        if name in suites:
            top, parameters, module, only = suites[name]
            return top, parameters, f"{room}.{module}", only
    return None


def simulator_of(suite):
    """What plays a suite fastest."""
    import test_buses
    import test_modules
    import test_system

    fast = {*test_buses.ON_VERILATOR, *test_modules.ON_VERILATOR, *test_system.SUITES.keys() - test_system.ON_ICARUS}
    return "verilator" if suite in fast else "icarus"


def simulated(suite, only, number, only_tests=False):
    """Failed tests of a suite; an accident counts as one, unless `only_tests`."""
    from harness.runner import run

    if suite_of(suite) is None:
        return []
    top, parameters, module, whole = suite_of(suite)
    sim, recorded = simulator_of(suite), {}
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            run(recorded.__setitem__, sim, top, module, parameters, only=only or whole, own=f"{number}_{suite}")
    except BaseException as problem:  # pytest's outcomes are no Exceptions
        tests = [t.split(".", 2)[-1] for t, ok in recorded.get("cocotb", []) if not ok]
        accident = [] if only_tests else [f"{suite}: {str(problem).splitlines()[0]}"]
        return [f"{suite}: {t}" for t in tests] or accident
    return []


def compiled(count):
    """What random traffic on the compiled slave shows, as a list of none or one."""
    from differential.test_differential import MAPS, SETTINGS_EVERY, Match

    if not shutil.which("verilator"):
        print("verilator is not installed: no compiled slave", file=sys.stderr)
        return []
    match = Match(MAPS["mapped"], "mistakes")
    for number in range(count):
        try:
            if number % SETTINGS_EVERY == 0:
                match.settings()
            match.step()
        except AssertionError as problem:
            print(f"request {number}: {problem}", file=sys.stderr)
            return [f"{COMPILED}, compiled"]
    try:
        match.compare(whole=True)
    except AssertionError as problem:
        print(problem, file=sys.stderr)
        return [f"{COMPILED}, compiled: memory at the end"]
    return []


# ------------------------------------------------------------------ in the process that was started


def judged(name, *task):
    """(failed tests, or None for an accident; seconds) of the copy `name`; `task` are the arguments of a judge."""
    folder = WORK / name
    places_of = {
        "TREE": str(folder / "tree"),
        "BENCH_BUILD": str(folder / "build"),
        "MODELS_RUNTIME": str(models.CACHE),
        "MODELS_OPTIMISE": "-Og",
    }
    env = {**os.environ, **places_of, "COCOTB_LOG_LEVEL": "ERROR"}
    for variable in ("WAVES", "CASE", "FULL"):
        env.pop(variable, None)
    begun = time.monotonic()
    with (folder / "log").open("a", encoding="utf-8") as messages:
        try:
            done = subprocess.run(
                [sys.executable, __file__, "--judge", json.dumps(task)],
                env=env,
                stdout=subprocess.PIPE,
                stderr=messages,
                text=True,
                timeout=TIMEOUT_SECONDS,
                check=False,
            )
            failed = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else None
        except subprocess.TimeoutExpired:
            failed = [f"no end within {TIMEOUT_SECONDS} s"]
    return failed, time.monotonic() - begun


def run_one(mistake, known):
    """(failed tests or None, seconds) of a mistake; its builds are thrown away."""
    (WORK / mistake.name / "log").unlink(missing_ok=True)
    suite, test = known.get(mistake.name, (None, ""))
    remembered = "" if suite is None else f"{suite}: {test}" if suite else COMPILED
    failed, seconds = judged(mistake.name, mistake.file, remembered)
    shutil.rmtree(WORK / mistake.name / "build", ignore_errors=True)
    return failed, seconds


def caught_by(rows):
    """{suite: names of the tests that caught a mistake}; no names where an accident did, such as a time-out."""
    tests = {}
    for found in map(ROW.fullmatch, rows):
        suite, test = (found[3], found[4]) if found[3] else (COMPILED, "")
        names = tests.setdefault(suite, set())
        names.add(test if TEST.fullmatch(test) else "")
    return {suite: [] if "" in names else sorted(names) for suite, names in tests.items()}


def untouched(pool, tests):
    """(what fails of these tests without a mistake, seconds)."""
    planted(None, WORK / "untouched" / "tree")
    (WORK / "untouched" / "log").unlink(missing_ok=True)
    shares = [dict(list(tests.items())[start::WORKERS]) for start in range(WORKERS)]
    results = list(pool.map(lambda share: judged("untouched", share), shares))
    if any(failed is None for failed, _ in results):
        return ["did not run, see build/mistakes/untouched/log"], results[0][1]
    return [test for failed, _ in results for test in failed], max(seconds for _, seconds in results)


def update(rows):
    """Put rows into docs/mistakes.md; those of mistakes that are gone leave it."""
    text = TABLE.read_text(encoding="utf-8") if TABLE.exists() else ""
    kept = {found[1]: found[0] for found in ROW.finditer(text)} | rows
    TABLE.write_text(HEAD + "".join(f"{kept[m.name]}\n" for m in MISTAKES if m.name in kept), encoding="utf-8")


def main():
    """Run the mistakes that were asked for; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", nargs="?", default="", help="in the names of those that are planted; all when absent")
    parser.add_argument("--missing", action="store_true", help="only those that docs/mistakes.md does not name")
    parser.add_argument("--update", action="store_true", help="write docs/mistakes.md")
    options = parser.parse_args()
    known, rows, missed, failed = read_table(), {}, [], []
    chosen = [m for m in MISTAKES if options.part in m.name and not (options.missing and m.name in known)]
    if not chosen and options.missing:
        print("docs/mistakes.md names every mistake")
        return 0
    if not chosen:
        print(f"mistakes: T={options.part}: no mistake has this in its name", file=sys.stderr)
        return 2
    WORK.mkdir(parents=True, exist_ok=True)
    lock = (WORK / "lock").open("w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit("another `make mistakes` is running in this checkout")
    for mistake in chosen:  # patterns first: a stale one shall not cost minutes
        planted(mistake, WORK / mistake.name / "tree")
    with ThreadPoolExecutor(WORKERS) as pool:
        waiting = {pool.submit(run_one, mistake, known): mistake for mistake in chosen}
        for done in as_completed(waiting):
            mistake, (seen, seconds) = waiting[done], done.result()
            if seen:
                rows[mistake.name] = row(mistake, seen)
                if options.update:
                    update({mistake.name: rows[mistake.name]})
            else:
                missed.append(mistake.name)
            said = seen[0] if seen else "NOT CAUGHT" if seen == [] else "did not run, see its log"
            print(f"{mistake.name}: {said} ({seconds:.0f} s)", flush=True)
        if rows:
            failed, seconds = untouched(pool, caught_by(rows.values()))
            print(f"untouched: {f'FAILS: {failed}' if failed else 'passes'} ({seconds:.0f} s)", flush=True)
    absent = sorted({m.name for m in MISTAKES} - set(read_table()))
    if absent and not options.part:
        print(f"docs/mistakes.md lacks {len(absent)}: make mistakes UPDATE=1")
    print(f"{len(chosen) - len(missed)} of {len(chosen)} mistakes caught")
    return 1 if missed or failed or (absent and not options.part) else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--judge"]:
        sys.path[:0] = [str(TB), str(ROOT / "tools")]
        os.environ["PYTHONPATH"] = os.pathsep.join([str(TB), *filter(None, [os.environ.get("PYTHONPATH")])])
        given = json.loads(sys.argv[2])
        judge_untouched(*given) if isinstance(given[0], dict) else judge(*given)
    else:
        sys.exit(main())
