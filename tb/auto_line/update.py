#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Measure modbus_auto_line anew: the table of docs/auto_line.md and the plot docs/auto_line.svg.

`make auto_line`; FULL=1 takes 10,000 random starts, COUNT=n so many.
"""

import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tb"), str(ROOT / "tools")]

from harness.volume import volume  # noqa: E402

from auto_line import measure  # noqa: E402
from auto_line.lab import FORMATS, RATES, clock_for, library  # noqa: E402

DOCUMENT, PLOT = ROOT / "docs/auto_line.md", ROOT / "docs/auto_line.svg"
MARKS = re.compile(r"(<!-- starts table begin -->\n).*?(<!-- starts table end -->)", re.DOTALL)
COLUMN, ROW, LEFT, TOP, BAR = 74, 34, 60, 50, 60
COLOURS = {1: "#2e7d32", 2: "#f9a825", 3: "#c62828"}


def table(counts):
    """The Markdown table: share of the starts whose first request was answered, and the worst start."""
    names = [fmt.name for fmt in FORMATS]
    lines = ["| Rate | " + " | ".join(names) + " |", "|---:|" + "---:|" * len(names)]
    for rate in RATES:
        cells = []
        for name in names:
            found = counts[rate, name]
            cells.append(f"{100 * found[1] / sum(found.values()):.1f} % / {max(found)}")
        lines.append(f"| {rate} | " + " | ".join(cells) + " |")
    total = sum(sum(found.values()) for found in counts.values())
    first = sum(found[1] for found in counts.values())
    second = sum(found[1] + found[2] for found in counts.values())
    lines += ["", f"{total} random starts: the first request is answered in {100 * first / total:.2f} %, "
                  f"the first or the second in {100 * second / total:.2f} %."]  # fmt: skip
    return "\n".join(lines) + "\n"


def plot(counts):
    """An SVG: for each rate and format a bar of the starts answered at the first, second and a later request."""
    width, height = LEFT + COLUMN * len(FORMATS) + 170, TOP + ROW * len(RATES) + 20
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}"',
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        f'<text x="{LEFT}" y="16">Requests until the first answer, share of the random starts</text>',
    ]
    for column, fmt in enumerate(FORMATS):
        out.append(f'<text x="{LEFT + COLUMN * column}" y="{TOP - 8}">{fmt.name}</text>')
    for row, rate in enumerate(RATES):
        y = TOP + ROW * row
        out.append(f'<text x="{LEFT - 8}" y="{y + 15}" text-anchor="end">{rate}</text>')
        for column, fmt in enumerate(FORMATS):
            found, x = counts[rate, fmt.name], LEFT + COLUMN * column
            total = sum(found.values())
            for number, share in ((1, found[1]), (2, found[2]), (3, total - found[1] - found[2])):
                length = BAR * share / total
                if share:
                    out.append(
                        f'<rect x="{x:.1f}" y="{y}" width="{length:.1f}" height="20" fill="{COLOURS[number]}">'
                        f"<title>{rate} {fmt.name}: {share} of {total}</title></rect>"
                    )
                x += length
    for place, text in enumerate(("first request", "second request", "later")):
        x, y = LEFT + COLUMN * len(FORMATS) + 10, TOP + 24 * place
        out += [f'<rect x="{x}" y="{y}" width="14" height="14" fill="{COLOURS[place + 1]}"/>',
                f'<text x="{x + 20}" y="{y + 12}">{text}</text>']  # fmt: skip
    return "\n".join([*out, "</svg>"]) + "\n"


def main():
    for hz in sorted(set(map(clock_for, RATES))):
        library(CLK_HZ=hz)  # compiled once, before there are several processes
    wanted = int(os.environ.get("COUNT") or volume("random starts of the automatic line"))
    counts = measure.starts(max(1, round(wanted / (len(RATES) * len(FORMATS)))))
    PLOT.write_text(plot(counts), encoding="utf-8")
    text = DOCUMENT.read_text(encoding="utf-8")
    DOCUMENT.write_text(MARKS.sub(lambda found: found[1] + table(counts) + found[2], text), encoding="utf-8")
    print(table(counts))


if __name__ == "__main__":
    main()
