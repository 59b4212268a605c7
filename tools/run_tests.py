#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make test`: looks at the variables, then becomes pytest.

    run_tests.py [EXPRESSION | FILE | FOLDER]    what pytest's -k takes, or a path; everything when absent

SEED, FULL, COUNT, CASE, TIMES and WAVES come from the environment: tb/README.md.  A bad value gives one line and exit
status 2.
"""

from __future__ import annotations

import os
import re
import sys

from common import ROOT

FLAGS = ("FULL", "TIMES", "WAVES", "GATES")  # 1, 0 or nothing
NUMBERS = ("SEED", "COUNT")


def complaint(given: str) -> str:
    """What is wrong with T or a variable of the environment, or nothing."""
    for name in FLAGS:
        if os.environ.get(name, "") not in ("", "0", "1"):
            return f"{name}={os.environ[name]}: must be 1 or nothing"
    for name in NUMBERS:
        if not re.fullmatch(r"(0x[0-9a-fA-F]+|[0-9]+)?", os.environ.get(name, "")):
            return f"{name}={os.environ[name]}: must be a number"
    try:
        re.compile(os.environ.get("CASE", ""))
    except re.error as error:
        return f"CASE={os.environ['CASE']}: no regular expression: {error}"
    path = given.split("::")[0]
    if is_path(given) and not (ROOT / path).exists():
        return f"T={given}: no file or folder {path}"
    return ""


def is_path(given: str) -> bool:
    """True for a file or a folder, False for an expression."""
    return "/" in given or ".py" in given


def main() -> int:
    given = sys.argv[1] if len(sys.argv) > 1 else ""
    wrong = complaint(given)
    if wrong:
        print(f"test: {wrong}", file=sys.stderr)
        return 2
    for name in (*FLAGS, *NUMBERS):
        if os.environ.get(name) == "":  # as if it were not there
            del os.environ[name]
    chosen = [given] if is_path(given) else ["tb", *([f"-k{given}"] if given else [])]
    os.execv(sys.executable, [sys.executable, "-m", "pytest", *chosen])


if __name__ == "__main__":
    sys.exit(main())
