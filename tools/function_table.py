#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The README's table of function codes, made from tb/protocol/defs.py, which the tests are made from too.

Without an option it is printed; --check exits 1 if the README says otherwise; --update writes it there.
"""

from __future__ import annotations

import argparse
import sys

from common import ROOT

sys.path.insert(0, str(ROOT / "tb"))
from protocol.defs import FUNCTIONS

README = ROOT / "README.md"
MARK_BEGIN, MARK_END = "<!-- function table begin -->", "<!-- function table end -->"


def table() -> str:
    """The table in Markdown, without the marks."""
    lines = [
        "| Code | Function | Limits | Broadcast | Event | Bit of `FUNCTION_CODES` |",
        "|---|---|---|---|---|---:|",
    ]
    lines += [
        f"| {code:02X} | {row.name} | {row.limits} | {'yes' if row.broadcast else 'no'} | "
        f"{'yes' if row.counts else 'no'} | {int(code)} |"
        for code, row in FUNCTIONS.items()
    ]
    lines += [
        "",
        "Codes in hexadecimal. Broadcast: executed when sent to address 0, never answered. Event: a success adds one",
        "to the event counter. Each can be left out by its bit and then answers exception 01; the default,",
        "`MB_ALL_FUNCTIONS`, is all of them.",
    ]
    return "\n".join(lines)


def parts(text: str) -> tuple[str, str, str]:
    """(before, table, after) of the README; ValueError without the marks."""
    before, begin, rest = text.partition(MARK_BEGIN + "\n")
    inside, end, after = rest.partition("\n" + MARK_END)
    if not begin or not end:
        raise ValueError(f"{README.name} lacks {MARK_BEGIN} or {MARK_END}")
    return before + begin, inside, end + after


def stale() -> bool:
    """True if the README holds another table."""
    return parts(README.read_text(encoding="utf-8"))[1] != table()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--update", action="store_true")
    wanted = parser.parse_args()
    if wanted.update:
        before, _, after = parts(README.read_text(encoding="utf-8"))
        README.write_text(before + table() + after, encoding="utf-8")
    elif wanted.check:
        if stale():
            print("README.md: the function table is stale; run tools/function_table.py --update", file=sys.stderr)
            return 1
    else:
        print(table())
    return 0


if __name__ == "__main__":
    sys.exit(main())
