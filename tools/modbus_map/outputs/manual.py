# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.md and NAME.html: the register manual, in the columns of vendor manuals.

The HTML file is whole by itself: no script, no font, no picture from elsewhere. It prints on A4.
"""

from __future__ import annotations

import html
import re

from modbus_map.model import Device, Point
from modbus_map.outputs import shared

COLUMNS = ("Address", "Number", "Name", "Type", "Unit", "Range", "Access", "Default", "Meaning")
ACCESS = {"rw": "R/W", "ro": "R", "wo": "W"}
FUNCTIONS = {
    1: "read coils", 2: "read discrete inputs", 3: "read holding registers", 4: "read input registers",
    5: "write one coil", 6: "write one register", 7: "read exception status", 8: "diagnostics",
    11: "get event counter", 12: "get event log", 15: "write coils", 16: "write registers", 17: "report server ID",
    20: "read file", 21: "write file", 22: "mask write register", 23: "read and write registers", 24: "read FIFO",
    43: "read device identification",
}  # fmt: skip
STYLE = """\
:root { color-scheme: light dark; --ink: #1c2330; --soft: #5a6474; --paper: #fff; --line: #d4d9e1; --head: #eef1f6;
  --accent: #1f5fae; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ef; --soft: #9aa5b5; --paper: #14181f; --line: #333b48; --head: #1e2530; --accent: #7fb2f2; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 2rem 1.5rem 4rem; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 1.9rem; overflow-wrap: anywhere; } h2 { margin: 2.2rem 0 .6rem; font-size: 1.25rem; }
p.version { margin: .2rem 0 1.2rem; color: var(--soft); }
div.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { border: 1px solid var(--line); padding: .3rem .5rem; text-align: left; vertical-align: top; }
th { background: var(--head); white-space: nowrap; }
td.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
td.w { white-space: nowrap; } td.name { font-family: ui-monospace, "DejaVu Sans Mono", monospace; }
td.m { min-width: 13rem; overflow-wrap: anywhere; } td ul { margin: .2rem 0 0; padding-left: 1.1rem; }
nav a, a { color: var(--accent); } nav { margin: 1rem 0; } nav a { margin-right: 1rem; }
table.facts { width: auto; } table.facts th { font-weight: 600; }
@page { size: A4 landscape; margin: 14mm 12mm; @bottom-right { content: counter(page) " / " counter(pages); } }
@media print {
  :root { color-scheme: light; --ink: #000; --soft: #444; --paper: #fff; --line: #999; --head: #eee; --accent: #000; }
  body { max-width: none; padding: 0; font-size: 9pt; } nav { display: none; } div.scroll { overflow: visible; }
  thead { display: table-header-group; } tr { break-inside: avoid; } h2 { break-after: avoid; }
}
"""


def _type(point: Point) -> str:
    text = f"string, {point.characters} characters" if point.is_string else point.type
    if point.is_array:
        text += f" × {point.count}"
    if point.word_order == "little" and point.width > 1:
        text += ", low word first"
    return text


def _default(point: Point) -> str:
    if point.kind == "wire" or not point.readable:
        return ""
    if len(set(point.resets)) == 1:
        return shared.shown(point, point.reset)
    return ", ".join(shared.shown(point, raw) for raw in point.resets)


def _meaning(point: Point) -> tuple[str, list[str]]:
    """A text and the entries of a list."""
    notes = [point.doc] if point.doc else []
    if point.is_scaled:
        step = f"Value = register × {shared.decimal(point.scale)}" if point.scale != 1.0 else "Value = register"
        if point.offset:
            sign = "−" if point.offset < 0 else "+"
            step += f" {sign} {shared.decimal(abs(point.offset))}"
        notes.append(step + ".")
    if point.freeze:
        notes.append(f"Snapshot, taken by coil {point.freeze}.")
    if point.fifo:
        notes.append("FIFO, read by function 24.")
    rows = [f"{item.number}: {item.label}" for item in point.enum]
    for part in point.fields:
        rows.append(
            f"bit {part.low}: {part.name}" if part.width == 1 else f"bits {part.high} to {part.low}: {part.name}"
        )
    return " ".join(notes), rows


def _cells(point: Point) -> list[str]:
    """All columns but the meaning."""
    last = f"–{point.last}" if point.size > 1 else ""
    number = str(point.number_of_register())
    number = number.zfill(5)
    return [
        f"{point.at}{last}", number, point.name, _type(point), point.unit, shared.span(point).replace(" to ", " … "),
        ACCESS[point.access], _default(point),
    ]  # fmt: skip


def _facts(device: Device) -> list[tuple[str, str]]:
    line = device.line
    may = " (set at run time)" if line.run_time else ""
    identity = " ".join(filter(None, (device.identity.vendor, device.identity.product, device.identity.revision)))
    return [
        ("Slave address", f"{line.address}{may}"),
        ("Line", f"{line.baud} baud, {line.format}{may}"),
        ("Word order", "high word first" if device.word_order == "big" else "low word first"),
        ("Functions", ", ".join(f"{code:02} {FUNCTIONS.get(code, '')}".strip() for code in device.functions)),
        *([("Identification", identity)] if identity else []),
    ]


def _gaps(device: Device, table: str) -> str:
    if table in device.zero_gaps:
        return "Addresses that are not listed read 0 and ignore writes."
    return "Addresses that are not listed answer exception 02, also inside a block."


def _plain(text: str) -> str:
    """Markdown: every character that means something is escaped, on one line."""
    text = " ".join(text.split()).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_{}\[\]#|~$!])", r"\\\1", text)


def markdown(device: Device) -> str:
    """The manual for a repository or a wiki."""
    lines = [
        f"# {_plain(device.title or device.name)}",
        "",
        f"Register map of `{device.name}`, version {_plain(device.version)}.",
    ]
    if device.doc:
        lines += ["", _plain(device.doc)]
    lines += ["", "| | |", "|---|---|", *(f"| {name} | {_plain(text)} |" for name, text in _facts(device))]
    for table, points in device.tables():
        lines += ["", f"## {shared.TABLE_TITLES[table]}", "", _gaps(device, table), ""]
        lines += ["| " + " | ".join(COLUMNS) + " |", "|--:|--:|" + "---|" * (len(COLUMNS) - 2)]
        for point in points:
            cells = _cells(point)
            text, rows = _meaning(point)
            meaning = "<br>".join(_plain(part) for part in [text, *rows] if part)
            named = [_plain(cell) for cell in cells]
            named[2] = f"`{point.name}`"
            lines.append("| " + " | ".join([*named, meaning]) + " |")
    if device.files:
        lines += ["", "## Files", "", "| Number | Name | Records | Access | Meaning |", "|--:|---|--:|---|---|"]
        lines += [
            f"| {f.number} | `{f.name}` | {f.records} | {ACCESS[f.access]} | {_plain(f.doc)} |" for f in device.files
        ]
    return "\n".join(lines) + "\n"


def page(device: Device) -> str:
    """The manual as one HTML file."""

    def cell(text: str, kind: str = "") -> str:
        return f"<td{f' class={chr(34)}{kind}{chr(34)}' if kind else ''}>{html.escape(text)}</td>"

    title = html.escape(device.title or device.name)
    kinds = ("n", "n", "name", "", "w", "w", "w", "", "m")
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        "<head>",
        '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{title}: register manual</title>",
        f"<style>\n{STYLE}</style>",
        "</head>",
        "<body>",
        f"<h1>{title}</h1>",
        f'<p class="version">Register manual, version {html.escape(device.version)}</p>',
    ]
    if device.doc:
        lines.append(f"<p>{html.escape(device.doc)}</p>")
    lines += ['<table class="facts"><tbody>']
    lines += [f'<tr><th scope="row">{name}</th>{cell(text)}</tr>' for name, text in _facts(device)]
    lines += ["</tbody></table>", "<nav>"]
    lines += [f'<a href="#{table}">{shared.TABLE_TITLES[table]}</a>' for table, _ in device.tables()]
    lines += ["</nav>"]
    for table, points in device.tables():
        lines += [
            f'<h2 id="{table}">{shared.TABLE_TITLES[table]}</h2>',
            f"<p>{_gaps(device, table)}</p>",
            '<div class="scroll"><table>',
            "<thead><tr>" + "".join(f'<th scope="col">{name}</th>' for name in COLUMNS) + "</tr></thead>",
            "<tbody>",
        ]
        for point in points:
            text, rows = _meaning(point)
            more = "<ul>" + "".join(f"<li>{html.escape(row)}</li>" for row in rows) + "</ul>" if rows else ""
            cells = "".join(cell(value, kind) for value, kind in zip(_cells(point), kinds))
            lines.append(f'<tr id="{point.name}">{cells}<td class="m">{html.escape(text)}{more}</td></tr>')
        lines += ["</tbody>", "</table></div>"]
    if device.files:
        heads = ("Number", "Name", "Records", "Access", "Meaning")
        lines += [
            "<h2>Files</h2>",
            "<table><thead><tr>" + "".join(f"<th>{h}</th>" for h in heads) + "</tr></thead><tbody>",
        ]
        for file in device.files:
            facts = [cell(str(file.number), "n"), cell(file.name, "name"), cell(str(file.records), "n")]
            lines.append(f"<tr>{''.join(facts)}{cell(ACCESS[file.access])}{cell(file.doc)}</tr>")
        lines.append("</tbody></table>")
    return "\n".join([*lines, "</body>", "</html>"]) + "\n"


def generate(device: Device) -> dict[str, str]:
    """{NAME.md, NAME.html: text}."""
    return {f"{device.name}.md": markdown(device), f"{device.name}.html": page(device)}
