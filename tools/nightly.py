#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make nightly`: everything that takes long, stage by stage, with a report.

    nightly.py              every stage, some hours on two cores
    nightly.py test,formal  these stages; the report keeps what the others have shown of the same state of the files

NIGHTLY_SKIP=stage,... leaves stages out, so that a run that was ended can be taken up again.  A stage that fails does
not stop the next.  Each stage's output is in build/nightly/STAGE.log, the report in build/nightly.md.  Exit status 0
only if every stage of the report has passed; 1 if one has failed; 2 for a bad name.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time

from common import ROOT

OUT = ROOT / "build/nightly"
REPORT = ROOT / "build/nightly.md"
LIMIT_MINUTES = 180  # a stage that takes longer has failed
SHOWN = 30  # lines of a failed stage in the report

# stage: (make target and variables, what it does)
STAGES = {
    "lint": (["lint", "FULL=1"], "every linter over every module, many random parameter sets"),
    "test": (["test", "FULL=1"], "the regression with the sizes below"),
    "formal": (["formal"], "every proof, of both tiers"),
    "planted": (["formal", "PLANTED=1"], "every proof again with a mistake: each must fail"),
    "mistakes": (["mistakes"], "every deliberate mistake in the RTL: the tests must catch each"),
    "demo": (["demo"], "the printed examples on the live device"),
    "fusesoc": (["fusesoc"], "the FuseSoC targets"),
    "sizes": (["synth", "CHECK=1"], "sizes and speeds against docs/size.json"),
    "bitstreams": (["bitstream", "BOARD=all"], "a bitstream for every board"),
}
COUNTS = (  # how a stage says what it has counted: (pattern, groups that hold passed and failed)
    (r"^(\d+) passed, (\d+) failed", lambda a, b: (int(a), int(b))),
    (r"^(\d+) of (\d+) mistakes caught", lambda a, b: (int(a), int(b) - int(a))),
    (r"^(\d+) lint messages", lambda a: (0, int(a))),
)
FAILURE = re.compile(r"\bFAIL|\bfailed\b|NOT CAUGHT|did not run|Error\b|^E  |\*\*\*|time-out|unknown ")


def state() -> str:
    """A name for the files as they are: the commit, and what differs from it."""
    head = _git("rev-parse", "--short=12", "HEAD").strip() or "no history"
    differs = _git("diff", "HEAD") + _git("ls-files", "--others", "--exclude-standard")
    return head + (f" with changes {hashlib.sha256(differs.encode()).hexdigest()[:8]}" if differs else "")


def _git(*command: str) -> str:
    return subprocess.run(["git", *command], cwd=ROOT, capture_output=True, text=True, check=False).stdout


def names(text: str, variable: str) -> list[str]:
    """Stages named in a variable, by commas or spaces; exits with status 2 for one that is none."""
    found = text.replace(",", " ").split()
    for name in found:
        if name not in STAGES:
            print(f"nightly: {variable}={text}: no stage {name}; there are {', '.join(STAGES)}", file=sys.stderr)
            sys.exit(2)
    return found


def counts(text: str) -> tuple[int, int]:
    """(passed, failed) as the last counting line of a stage says, (0, 0) without one."""
    for pattern, read in COUNTS:
        found = re.findall(pattern, text, re.M)
        if found:
            return read(*([found[-1]] if isinstance(found[-1], str) else found[-1]))
    return 0, 0


def run(name: str, files: str) -> dict:
    """Run a stage; what the report says of it, which is kept in build/nightly/STAGE.json."""
    command, log = ["make", *STAGES[name][0]], OUT / f"{name}.log"
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "T")}
    began, status = time.monotonic(), 1
    print(f"{time.strftime('%H:%M')} {name}: {' '.join(command)}", flush=True)
    with log.open("wb") as out:
        process = subprocess.Popen(
            command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True
        )
        try:
            status = process.wait(LIMIT_MINUTES * 60)
        except BaseException as error:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            out.write(f"\nno end within {LIMIT_MINUTES} minutes: failed\n".encode())
    passed, failed = counts(log.read_text(encoding="utf-8", errors="replace"))
    seconds = time.monotonic() - began
    result = {"state": files, "status": status, "passed": passed, "failed": failed, "seconds": round(seconds)}
    (OUT / f"{name}.json").write_text(json.dumps(result), encoding="utf-8")
    print(f"      {'passed' if status == 0 else 'FAILED'} after {seconds / 60:.1f} minutes", flush=True)
    return result


def earlier(name: str, files: str) -> dict | None:
    """What an earlier run of the same state of the files has shown of a stage."""
    try:
        found = json.loads((OUT / f"{name}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if found.get("state") == files else None


def sizes() -> list[str]:
    """The volumes of FULL=1."""
    sys.path.insert(0, str(ROOT / "tb"))
    from harness.volume import FULL

    return [f"| {what} | {size} |" for what, size in FULL.items()]


def report(results: dict[str, dict | None], files: str) -> str:
    """The text of build/nightly.md."""
    lines = [f"# Nightly run of {files}", "", f"Written {time.strftime('%Y-%m-%d %H:%M')}.", ""]
    lines += ["| Stage | Does | Result | Passed | Failed | Minutes |", "|---|---|---|--:|--:|--:|"]
    for name, found in results.items():
        said = "not run" if found is None else "passed" if found["status"] == 0 else "**failed**"
        cells = [found[key] if found else "" for key in ("passed", "failed")]
        minutes = f"{found['seconds'] / 60:.1f}" if found else ""
        lines.append(f"| {name} | {STAGES[name][1]} | {said} | {cells[0]} | {cells[1]} | {minutes} |")
    total = sum(found["seconds"] for found in results.values() if found)
    lines += ["", f"{total / 60:.0f} minutes in all.", "", "| Volume of FULL=1 | |", "|---|--:|", *sizes()]
    for name, found in results.items():
        if found and found["status"]:
            text = (OUT / f"{name}.log").read_text(encoding="utf-8", errors="replace").splitlines()
            said = [line for line in text if FAILURE.search(line)] or text
            lines += ["", f"## {name}", "", "```", *said[-SHOWN:], "```"]
    return "\n".join(lines) + "\n"


def main() -> int:
    chosen = names(sys.argv[1] if len(sys.argv) > 1 else "", "T") or list(STAGES)
    skipped = names(os.environ.get("NIGHTLY_SKIP", ""), "NIGHTLY_SKIP")
    OUT.mkdir(parents=True, exist_ok=True)
    files = state()
    results = {name: earlier(name, files) for name in STAGES}
    for name in chosen:
        if name not in skipped:
            results[name] = run(name, files)
            REPORT.write_text(report(results, files), encoding="utf-8")
    REPORT.write_text(report(results, files), encoding="utf-8")
    done = [found for found in results.values() if found]
    failed = sum(found["status"] != 0 for found in done)
    print(f"{len(done) - failed} stages passed, {failed} failed, {len(STAGES) - len(done)} not run: build/nightly.md")
    return 1 if failed or not done else 0


if __name__ == "__main__":
    sys.exit(main())
