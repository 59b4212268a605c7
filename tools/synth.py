#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Size and speed of the core, measured the same way every time.

    synth.py                                  every profile, bank and device; build/synth.json, table
    synth.py --full                           with the place and route of the ECP5
    synth.py --profile basic --device ice40-hx8k,gowin --bank ram --quick
    synth.py --update                         everything there is, and the documents written anew
    synth.py --documents                      only the documents, from docs/size.json
    synth.py --check                          the iCE40 HX8K against docs/size.json
    synth.py --options                        what each option costs
    synth.py --peers                          other cores and the profiles, in one run of one flow
    synth.py --top modbus_crc16 [-P NAME=VALUE ...] [--quick]   one module, with the cells of each part

How a design is measured stands in synth_flow.py, what the figures mean in docs/size.md.  --quick is one
seed instead of three, of the iCE40 HX8K unless --device says otherwise, and writes no file.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor

import synth_report as report
from synth_devices import DEVICES
from synth_flow import OUT, SEEDS, Design, ToolError, bank_design, measure, parts, ports_of, tool_versions
from synth_peers import DEVICES_OF_PEERS, PEERS, design_of, versions
from synth_profiles import PROFILES, SHOWN, option_designs

from common import DROP_INS, ROOT

HX8K = "ice40-hx8k"


class UsageError(RuntimeError):
    """A choice that does not exist; the message is for whom typed it."""


def show(title: str, row: dict) -> None:
    """One line of figures, at once: a run takes minutes."""
    speed = f"  {row['fmax_mhz']:6.1f} MHz (seed {row['seed']})" if row.get("fmax_mhz") else ""
    print(
        f"{title:<34} {row['lc']:5d} LC {row['lut']:5d} LUT {row['ff']:5d} FF {row['carry']:4d} carry "
        f"{row['ram']:2d} RAM{speed}",
        flush=True,
    )


def show_parts(its: dict[str, dict]) -> None:
    """The cells of each module."""
    for module, counts in its.items():
        show("  " + module, counts)


def chosen(given: list[str] | None, known: list[str], what: str) -> list[str]:
    """The names asked for, all of them if none is; names may be separated by commas or blanks."""
    names = [name for item in given or [] for name in re.split(r"[,\s]+", item) if name]
    for name in names:
        if name not in known:
            raise UsageError(f"{what}={name}: there is none; choose from {', '.join(known)}")
    return [name for name in known if name in names] if names else known


def in_parallel(function, jobs: list[tuple], workers: int) -> list:
    """The function's results for each job, in their order; the first failure ends it."""
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(function, *job) for job in jobs]
        try:
            return [future.result() for future in futures]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def families(devices: list[str]) -> list[list[str]]:
    """The devices, those of one family together, since they share their synthesis."""
    return [[d for d in devices if DEVICES[d].family == f] for f in dict.fromkeys(DEVICES[d].family for d in devices)]


def profile_rows(
    options: argparse.Namespace, devices: list[str], seeds: tuple[int, ...], full: bool
) -> tuple[list[dict], dict[str, dict]]:
    """The rows of build/synth.json for the profiles and banks asked for, and the parts of those in SHOWN."""
    wanted = chosen(options.profile, list(PROFILES), "PROFILE")
    banks = chosen(options.bank, sorted(DROP_INS), "BANK")
    keys = [(profile, bank) for profile in wanted for bank in PROFILES[profile] if bank in banks]
    if not keys:
        raise UsageError("no profile with that bank")
    designs = {}
    for profile, bank in keys:
        parameters, ties = PROFILES[profile][bank]
        designs[profile, bank] = bank_design(bank, {**parameters, **options.parameter}, {**ties, **options.tie})
    works = {(profile, bank): OUT / f"{profile}_{bank}" for profile, bank in keys}
    ports = dict(
        zip(keys, in_parallel(ports_of, [(designs[key], works[key]) for key in keys], options.jobs), strict=True)
    )

    def job(key: tuple[str, str], names: list[str]) -> dict[str, dict]:
        work = works[key] / DEVICES[names[0]].family
        its = measure(designs[key], ports[key], names, seeds, work, full)
        for name, row in its.items():
            show(f"{key[0]}, {key[1]} bank, {name}", row)
        return its

    jobs = [(key, names) for names in families(devices) for key in keys]
    rows: dict[tuple, dict] = {}
    for (key, _), its in zip(jobs, in_parallel(job, jobs, options.jobs), strict=True):
        rows.update({(*key, name): row for name, row in its.items()})
    results = []
    for profile, bank in keys:
        design = designs[profile, bank]
        settings = {**design.parameters, **{f"tied {k}": v for k, v in design.ties.items()}}
        for name in devices:
            head = {"profile": profile, "bank": bank, "device": name}
            results.append({**head, **rows[profile, bank, name], "parameters": settings})
    pieces = {}
    for profile, bank in keys:
        if HX8K in devices and ((profile, bank) in SHOWN or options.parts):
            pieces[f"{profile}/{bank}"] = parts(works[profile, bank] / "ice40")
            row = rows[profile, bank, HX8K]
            found = sum(part["lc"] for part in pieces[f"{profile}/{bank}"].values())
            if found != row["lc"]:
                raise ToolError(f"{profile}, {bank} bank: the parts are {found} cells, the whole is {row['lc']}")
    if options.parts:
        for name, its in pieces.items():
            print(f"\n{name}")
            show_parts(its)
    return results, {key: its for key, its in pieces.items() if tuple(key.split("/")) in SHOWN}


def option_rows(workers: int) -> dict[str, dict]:
    """{option: {"lc", "ram"}} on the HX8K with one seed: no seed changes the number of cells."""

    def job(number: int, option: str, bank: str, parameters: dict, ties: dict) -> tuple[str, dict]:
        design, work = bank_design(bank, parameters, ties), OUT / f"option{number}"
        row = measure(design, ports_of(design, work), [HX8K], SEEDS[:1], work)[HX8K]
        show(option or "all of it", row)
        return option, {"lc": row["lc"], "ram": row["ram"]}

    jobs = [(number, option, *design) for number, (option, design) in enumerate(option_designs().items())]
    return dict(in_parallel(job, jobs, workers))


def peer_rows(seeds: tuple[int, ...], workers: int) -> dict:
    """What docs/size.json has of the peers: packages, and a row per peer and device."""

    def job(number: int, name: str, device: str) -> dict:
        design, work = design_of(PEERS[name]), OUT / f"peer{number}"
        family = work / DEVICES[device].family
        row = measure(design, ports_of(design, family), [device], seeds, family, full=True)[device]
        show(f"{name}, {device}", row)
        return {"peer": name, "device": device, **row}

    jobs = [(number, name, device) for number, name in enumerate(PEERS) for device in DEVICES_OF_PEERS]
    return {"packages": versions(), "results": in_parallel(job, jobs, workers)}


def check(options: argparse.Namespace) -> int:
    """Compare the HX8K's sizes with the record; 1 if one has grown too much."""
    recorded = report.read_record()["results"]
    rows, _ = profile_rows(options, [HX8K], SEEDS[:1], False)
    lines, passed, failed, smaller = report.compare(recorded, rows)
    print("\n" + "\n".join(lines))
    if smaller:
        print("smaller than recorded: make synth UPDATE=1 records it, and the check holds the gain")
    if failed:
        print("larger than recorded: make it smaller, or, if it is worth it, record it with make synth UPDATE=1")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed or not passed else 0


def pairs(items: list[str], what: str) -> dict[str, str]:
    """NAME=VALUE items as a dictionary."""
    for item in items:
        if not re.fullmatch(r"\w+=.+", item):
            raise UsageError(f"{what}: expected NAME=VALUE, not {item!r}")
    return dict(item.split("=", 1) for item in items)


def arguments() -> argparse.Namespace:
    """Parse and check the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--profile", action="append", help="only these profiles")
    parser.add_argument("--bank", action="append", help="only this bank")
    parser.add_argument("--device", action="append", help="only these devices")
    parser.add_argument("--top", help="measure this module alone instead of the profiles")
    parser.add_argument("-P", "--parameter", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--tie", action="append", default=[], metavar="PORT=VALUE", help="constant input")
    parser.add_argument("--quick", "--fast", action="store_true", help="one seed, nothing written but build/synth")
    parser.add_argument("--full", action="store_true", help="also the place and route of the ECP5")
    parser.add_argument("--parts", action="store_true", help="also the cells of each module")
    parser.add_argument("--update", action="store_true", help="measure everything, write record and documents")
    parser.add_argument("--documents", action="store_true", help="instead: write the documents from docs/size.json")
    parser.add_argument("--check", action="store_true", help="instead: compare the HX8K with docs/size.json")
    parser.add_argument("--options", action="store_true", help="instead: what each option costs")
    parser.add_argument("--peers", action="store_true", help="instead: other cores beside the profiles")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="at a time (the processors)")
    options = parser.parse_args()
    options.parameter = pairs(options.parameter, "-P")
    options.tie = {port: int(value, 0) for port, value in pairs(options.tie, "--tie").items()}
    options.some = bool(options.profile or options.bank or options.device or options.parameter or options.tie)
    if options.update:
        options.options = False  # UPDATE=1 has them too
    modes = [name for name in ("top", "update", "documents", "check", "options", "peers") if getattr(options, name)]
    if len(modes) > 1:
        raise UsageError(f"{' and '.join(modes)} do not go together")
    if options.update and (options.some or options.quick):
        raise UsageError("UPDATE=1 measures everything: it goes without PROFILE, BANK, DEVICE and QUICK")
    if options.check and options.device:
        raise UsageError(f"the size check is of the {HX8K}: it goes without DEVICE")
    if options.peers and options.device:
        raise UsageError(f"the peers are measured on {' and '.join(DEVICES_OF_PEERS)}: it goes without DEVICE")
    if options.top and (options.profile or options.bank):
        raise UsageError("--top goes without a profile")
    if options.jobs < 1:
        raise UsageError("--jobs needs at least 1")
    return options


def main() -> int:
    """Measure what was asked for."""
    options = arguments()
    os.chdir(ROOT)
    if options.documents:
        report.write_documents(report.read_record())
        return 0
    full = options.full or options.update or options.peers
    quick = options.quick or options.check
    seeds = SEEDS[:1] if quick else SEEDS
    usual = list(DEVICES_OF_PEERS) if options.peers else [HX8K] if quick else None
    devices = chosen(options.device or usual, list(DEVICES), "DEVICE")
    if options.check:
        return check(options)
    if options.top:
        design = Design(options.top, options.parameter, options.tie)
        ports = ports_of(design, OUT / options.top)
        for names in families(devices if options.device else [HX8K]):
            work = OUT / options.top / DEVICES[names[0]].family
            for name, row in measure(design, ports, names, seeds, work, full).items():
                show(f"{options.top}, {name}", row)
                if name == HX8K:
                    show_parts(parts(work))
        return 0
    tools = {**tool_versions(full), "seeds": list(seeds)}
    if options.options:
        print("\n" + report.options_table(option_rows(options.jobs), tools))
        return 0

    results, pieces = profile_rows(options, devices, seeds, full)
    if options.peers:
        print("\n" + report.peers_table(peer_rows(seeds, options.jobs), results, tools))
        return 0
    print("\n" + report.size_table(results, tools))
    if not options.some and not quick:
        (ROOT / "build/synth.json").write_text(json.dumps({"tools": tools, "results": results}, indent=2) + "\n")
        print("\nfigures in build/synth.json")
    if options.update:
        peers = peer_rows(seeds, options.jobs)
        record = {"tools": tools, "peers": peers, "results": results, "parts": pieces}
        record["options"] = option_rows(options.jobs)
        report.write_documents(record)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except UsageError as error:
        print(f"synth: {error}", file=sys.stderr)
        sys.exit(2)
    except (ToolError, report.ReportError) as error:
        print(f"synth: {error}", file=sys.stderr)
        sys.exit(1)
