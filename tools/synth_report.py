# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What is made of the figures: tables for the documents, a picture, the record docs/size.json and its check.

The record is a dictionary: `tools` (versions and flows), `peers` (`packages` and their versions, `results` with one
row per peer and device), `results` (one row per profile, bank and device),
`parts` ({"profile/bank": {module: counts}}) and `options` ({option: {"lc", "ram"}}, and what it is compared with).
Everything here works on that dictionary alone; nothing runs a tool.
"""

from __future__ import annotations

import json

from synth_devices import DEVICES, FAMILIES
from synth_peers import DEVICES_OF_PEERS, PEERS
from synth_profiles import ADDED, AIMS, OPTIONS, PROFILE_NOTES, PROFILES, SHOWN, base_of

from common import ROOT, source_of

RECORD = ROOT / "docs/size.json"
README = ROOT / "README.md"
PAGE = ROOT / "docs/size.md"
CHART = ROOT / "docs/size.svg"
CHECKED = "ice40-hx8k"
TOLERANCE = 3  # percent of the logic cells; RAM blocks have none
MARKS = {  # table -> what stands before and after it
    "readme": ("<!-- synth table begin -->", "<!-- synth table end -->"),
    "options": ("<!-- synth table begin -->", "<!-- synth table end -->"),
    "parts": ("<!-- parts table begin -->", "<!-- parts table end -->"),
    "aims": ("<!-- aims table begin -->", "<!-- aims table end -->"),
    "paths": ("<!-- paths table begin -->", "<!-- paths table end -->"),
    "peers": ("<!-- peers table begin -->", "<!-- peers table end -->"),
}


class ReportError(RuntimeError):
    """A document or the record is not as it must be."""


# --- tables ---------------------------------------------------------------------------------------


def row_of(results: list[dict], profile: str, bank: str, device: str) -> dict | None:
    """The row of a profile, bank and device, None if it was not measured."""
    return row_with(results, profile=profile, bank=bank, device=device)


def row_with(results: list[dict], **its: str) -> dict | None:
    """The row with these fields, None if there is none."""
    return next((row for row in results if {key: row[key] for key in its} == its), None)


def cell(row: dict | None) -> str:
    """A row's figures as the table has them: cells / RAM blocks / MHz."""
    if row is None:
        return "-"
    speed = "" if row["fmax_mhz"] is None else f" / {row['fmax_mhz']:.0f}"
    return f"{row['lc']} / {row['ram']}{speed}"


def tools_line(tools: dict) -> str:
    """The versions, for below a table."""
    routers = [f"{name} {tools[name]}" for name in ("nextpnr-ice40", "nextpnr-ecp5") if tools.get(name)]
    return ", ".join([f"Yosys {tools['yosys']}", *routers])


def column_head(device: str, timed: bool) -> str:
    """What stands above a device's column."""
    unit = f"{FAMILIES[DEVICES[device].family].cells} / RAM{' / MHz' if timed else ''}"
    return f"{DEVICES[device].title}: {unit}"


def median_line(tools: dict) -> str:
    """Which seeds a speed is of."""
    seeds = tools["seeds"]
    which = f"median of seeds {', '.join(map(str, seeds))}" if len(seeds) > 1 else f"seed {seeds[0]}"
    return f"{tools_line(tools)}; MHz after place and route, {which}."


def size_table(results: list[dict], tools: dict) -> str:
    """The rows as a markdown table, a line per profile and bank, with what the columns are below it."""
    devices = [name for name in DEVICES if any(row["device"] == name for row in results)]
    timed = {row["device"] for row in results if row["fmax_mhz"] is not None}
    heads = [column_head(name, name in timed) for name in devices]
    lines = ["| Profile | Bank | " + " | ".join(heads) + " |", "|---|---|" + "---:|" * len(heads)]
    for profile, banks in PROFILES.items():
        for bank in banks:
            rows = [row_of(results, profile, bank, name) for name in devices]
            if any(rows):
                lines.append(f"| `{profile}` | {bank} | " + " | ".join(cell(row) for row in rows) + " |")
    shown = [profile for profile in PROFILES if any(row["profile"] == profile for row in results)]
    lines += ["", *(f"- `{profile}`: {PROFILE_NOTES[profile]}" for profile in shown)]
    lines += ["", f"{median_line(tools)} Made by `make synth`; `make peers` measures other cores the same way."]
    return "\n".join(lines)


def peers_table(peers: dict, results: list[dict], tools: dict) -> str:
    """The peers and the profiles of `results` as a markdown table."""
    heads = [column_head(device, True) for device in DEVICES_OF_PEERS]
    lines = ["| Core | Is | " + " | ".join(heads) + " |", "|---|---|" + "---:|" * len(heads)]

    def line(name: str, note: str, its: dict[str, dict | None]) -> str:
        return f"| {name} | {note} | " + " | ".join(cell(its[device]) for device in DEVICES_OF_PEERS) + " |"

    for name, peer in PEERS.items():
        its = {device: row_with(peers["results"], peer=name, device=device) for device in DEVICES_OF_PEERS}
        lines.append(line(name, peer.note, its))
    for profile, banks in PROFILES.items():
        for bank in banks:
            its = {device: row_of(results, profile, bank, device) for device in DEVICES_OF_PEERS}
            if any(its.values()):
                lines.append(line(f"`{profile}`, {bank}", PROFILE_NOTES[profile], its))
    packages = ", ".join(f"{name} {version}" for name, version in peers["packages"].items())
    return "\n".join([*lines, "", f"{packages}; {median_line(tools)} Made by `make peers`."])


def paths_table(results: list[dict], tools: dict) -> str:
    """The longest path of each seed, as a markdown table: a line per path, of the devices that the peers are on."""
    lines = ["| Profile | Bank | Device | ns | From register to register |", "|---|---|---|---:|---|"]
    for profile, banks in PROFILES.items():
        for bank in banks:
            for device in DEVICES_OF_PEERS:
                row = row_of(results, profile, bank, device) or {}
                for path in row.get("paths", []):
                    through = " → ".join(path["through"])
                    lines.append(f"| `{profile}` | {bank} | {DEVICES[device].title} | {path['ns']:.2f} | {through} |")
    return "\n".join([*lines, "", f"{tools_line(tools)}; seeds {', '.join(map(str, tools['seeds']))}."])


def options_table(options: dict[str, dict], tools: dict) -> str:
    """What each option costs, as a markdown table."""
    lines = ["| Option | Logic cells with / without it | Costs | RAM blocks |", "|---|---:|---:|---:|"]
    for option in [*OPTIONS, *ADDED]:
        row, whole = options[option], options[base_of(option)]
        more, less = (row, whole) if option in ADDED else (whole, row)
        cells, blocks = more["lc"] - less["lc"], more["ram"] - less["ram"]
        lines.append(f"| {option} | {more['lc']} / {less['lc']} | {cells} | {blocks} |")
    return "\n".join([*lines, "", f"iCE40 HX8K, {tools_line({**tools, 'nextpnr-ecp5': None})}, seed 1."])


def aims_table(results: list[dict], tools: dict) -> str:
    """What the profiles aim at beside what they reach, as a markdown table."""
    lines = ["| Profile | Bank | HX8K: LC aimed at / reached | MHz aimed at / reached | ECP5: MHz aimed at / reached |"]
    lines.append("|---|---|---:|---:|---:|")
    for (profile, bank), (cells, fast, fast_ecp5) in AIMS.items():
        hx8k, ecp5 = (row_of(results, profile, bank, device) for device in DEVICES_OF_PEERS)
        pairs = ((cells, hx8k["lc"]), (fast, hx8k["fmax_mhz"]), (fast_ecp5, ecp5["fmax_mhz"]))
        figures = " | ".join(f"{aim} / {reached:.0f}" for aim, reached in pairs)
        lines.append(f"| `{profile}` | {bank} | {figures} |")
    return "\n".join([*lines, "", median_line(tools)])


def parts_order(parts: dict[str, dict]) -> list[str]:
    """Every module of the designs, the largest in any of them first; what is of no module last."""
    modules = list(dict.fromkeys(module for its in parts.values() for module in its))
    known = [module for module in modules if " " not in module]

    def size(module: str) -> tuple:
        return -max(its.get(module, {}).get("lc", 0) for its in parts.values()), module

    return sorted(known, key=size) + [module for module in modules if " " in module]


def parts_table(parts: dict[str, dict], tools: dict) -> str:
    """Where every logic cell is, as a markdown table: a line per module, its cells in each design."""
    designs = [f"{profile}/{bank}" for profile, bank in SHOWN]
    heads = " | ".join(f"`{profile}`, {bank}: LC (LUT, FF, carry) | RAM" for profile, bank in SHOWN)
    lines = ["| Module | " + heads + " |", "|---|" + "---:|---:|" * len(designs)]

    def counts(row: dict | None) -> str:
        if row is None:
            return "- | -"
        return f"{row['lc']} ({row['lut']}, {row['ff']}, {row['carry']}) | {row['ram']}"

    for module in parts_order(parts):
        title = f"[{module}](../{source_of(module)})" if " " not in module else module
        lines.append(f"| {title} | " + " | ".join(counts(parts[design].get(module)) for design in designs) + " |")
    sums = [{key: sum(row[key] for row in parts[d].values()) for key in ("lc", "lut", "ff", "carry", "ram")}
            for d in designs]  # fmt: skip
    lines.append("| **all of it** | " + " | ".join(counts(row) for row in sums) + " |")
    return "\n".join([*lines, "", f"iCE40 HX8K, {tools_line({**tools, 'nextpnr-ecp5': None})}."])


def placed(document: str, text: str, table: str) -> str:
    """The document with the text between the marks of its table; ReportError without the marks."""
    begin, end = MARKS[table]
    if document.count(begin) != 1 or document.count(end) != 1:
        raise ReportError(f"a document lacks the markers {begin} and {end}")
    head, rest = document.split(begin)
    return f"{head}{begin}\n{text}\n{end}{rest.split(end)[1]}"


# --- the picture ----------------------------------------------------------------------------------

INK, PAPER, FAINT = "#1f2933", "#ffffff", "#d9dee4"
SHADES = ("#1b6ca8", "#e08a1e", "#5a9e4b")
LEFT, RIGHT, BAR, GAP, TOP, WIDTH = 150, 60, 9, 8, 46, 760


def chart(parts: dict[str, dict]) -> str:
    """The logic cells of each module in each design shown, as an SVG of horizontal bars."""
    designs = [f"{profile}/{bank}" for profile, bank in SHOWN]
    modules = [m for m in parts_order(parts) if any(parts[d].get(m, {}).get("lc") for d in designs)]
    most = max(row["lc"] for design in designs for row in parts[design].values())
    scale = (WIDTH - LEFT - RIGHT) / most
    group = BAR * len(designs) + GAP
    height = TOP + group * len(modules) + 8
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" '
        f'font-size="11" fill="{INK}">',
        "<title>Logic cells of an iCE40 by module</title>",
        f'<rect width="{WIDTH}" height="{height}" fill="{PAPER}"/>',
    ]
    x = LEFT
    for (profile, bank), design, shade in zip(SHOWN, designs, SHADES, strict=True):
        total = sum(row["lc"] for row in parts[design].values())
        out.append(f'<rect x="{x}" y="14" width="11" height="11" fill="{shade}"/>')
        out.append(f'<text x="{x + 16}" y="24">{profile}, {bank} bank: {total} cells</text>')
        x += 195
    step = next(step for step in (10, 20, 50, 100, 200, 500, 1000) if most / step <= 8)
    for value in range(0, most + 1, step):
        at = LEFT + value * scale
        out.append(f'<path d="M{at:.1f} {TOP - 6}V{height - 6}" stroke="{FAINT}"/>')
        out.append(f'<text x="{at:.1f}" y="{TOP - 9}" text-anchor="middle" font-size="9">{value}</text>')
    for number, module in enumerate(modules):
        y = TOP + number * group
        title = module.removeprefix("modbus_")
        middle = y + BAR * len(designs) / 2 + 4
        out.append(f'<text x="{LEFT - 8}" y="{middle:.1f}" text-anchor="end">{title}</text>')
        for line, (design, shade) in enumerate(zip(designs, SHADES, strict=True)):
            cells = parts[design].get(module, {}).get("lc", 0)
            if cells:
                top, wide = y + line * BAR, cells * scale
                out.append(f'<rect x="{LEFT}" y="{top}" width="{wide:.1f}" height="{BAR - 1}" fill="{shade}"/>')
                out.append(f'<text x="{LEFT + wide + 4:.1f}" y="{top + BAR - 2}" font-size="8">{cells}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


# --- the record -----------------------------------------------------------------------------------


def record_text(record: dict) -> str:
    """The record as JSON, a row a line, so that a change reads well."""

    def lines(items: list[str]) -> str:
        return ",\n".join(f"    {item}" for item in items)

    results = [json.dumps({k: v for k, v in row.items() if k != "parameters"}) for row in record["results"]]
    options = [f"{json.dumps(name)}: {json.dumps(row)}" for name, row in record["options"].items()]
    parts = []
    for design, modules in record["parts"].items():
        inner = ",\n".join(f"      {json.dumps(name)}: {json.dumps(row)}" for name, row in modules.items())
        parts.append(f"{json.dumps(design)}: {{\n{inner}\n    }}")
    tools = json.dumps(record["tools"], indent=2).replace("\n", "\n  ")
    peers = [json.dumps(row) for row in record["peers"]["results"]]
    packages = json.dumps(record["peers"]["packages"])
    return (
        f'{{\n  "tools": {tools},\n  "peers": {{"packages": {packages}, "results": [\n{lines(peers)}\n  ]}},\n'
        f'  "results": [\n{lines(results)}\n  ],\n'
        f'  "parts": {{\n{lines(parts)}\n  }},\n  "options": {{\n{lines(options)}\n  }}\n}}\n'
    )


def read_record() -> dict:
    """The record in the repository; ReportError if it is missing or no JSON."""
    try:
        return json.loads(RECORD.read_text())
    except (OSError, json.JSONDecodeError) as error:
        raise ReportError(f"{RECORD.relative_to(ROOT)}: {error}; make synth UPDATE=1 writes it") from error


def documents(record: dict) -> dict:
    """{path: text} of everything that is written from the record."""
    readme, page, tools = README.read_text(), PAGE.read_text(), record["tools"]
    readme = placed(readme, size_table(record["results"], tools), "readme")
    page = placed(page, options_table(record["options"], tools), "options")
    page = placed(page, parts_table(record["parts"], tools), "parts")
    page = placed(page, aims_table(record["results"], tools), "aims")
    page = placed(page, paths_table(record["results"], tools), "paths")
    page = placed(page, peers_table(record["peers"], record["results"], tools), "peers")
    return {RECORD: record_text(record), README: readme, PAGE: page, CHART: chart(record["parts"])}


def write_documents(record: dict) -> None:
    """Write the record and what is made of it."""
    for path, text in documents(record).items():
        path.write_text(text)
        print(f"{path.relative_to(ROOT)}: written")


# --- the check ------------------------------------------------------------------------------------


def compare(recorded: list[dict], measured: list[dict]) -> tuple[list[str], int, int, bool]:
    """Compare sizes with the record: (lines of a table, passed, failed, whether the record is worth an update).

    A design fails with more than TOLERANCE more logic cells, with any more RAM block, or unrecorded.
    """
    lines, passed, failed, smaller = [], 0, 0, False
    lines.append(f"{'profile':<8} {'bank':<4} {'LC old':>7} {'new':>5} {'percent':>8}   {'RAM old':>7} {'new':>3}")
    for row in measured:
        old = row_of(recorded, row["profile"], row["bank"], row["device"])
        name = f"{row['profile']:<8} {row['bank']:<4}"
        if old is None:
            failed += 1
            lines.append(f"{name} {'-':>7} {row['lc']:>5} {'':>8}   {'-':>7} {row['ram']:>3}  FAILED: not recorded")
            continue
        change = 100 * row["lc"] / old["lc"] - 100
        faults = []
        if 100 * row["lc"] > (100 + TOLERANCE) * old["lc"]:
            faults.append(f"more than {TOLERANCE} % larger")
        if row["ram"] > old["ram"]:
            faults.append("more RAM blocks")
        verdict = "FAILED: " + ", ".join(faults) if faults else "ok"
        if not faults and (100 * row["lc"] < (100 - TOLERANCE) * old["lc"] or row["ram"] < old["ram"]):
            verdict, smaller = "ok, smaller", True
        failed += bool(faults)
        passed += not faults
        figures = f"{old['lc']:>7} {row['lc']:>5} {change:>+7.1f}%   {old['ram']:>7} {row['ram']:>3}"
        lines.append(f"{name} {figures}  {verdict}")
    return lines, passed, failed, smaller
