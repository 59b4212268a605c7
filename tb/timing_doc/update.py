#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Measure anew and put the tables into docs/timing.md and the pictures' sources into docs/wave.

`update.py --render` also draws the pictures as SVG; it needs the packages of tools/requirements/docs.txt.
"""

import hashlib
import re
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tb"), str(ROOT / "tools")]

from timing_doc import measure, waves  # noqa: E402
from timing_doc.lab import Lab  # noqa: E402

DOCUMENT = ROOT / "docs" / "timing.md"
PICTURES = ROOT / "docs" / "wave"


def render():
    """Draw every WaveJSON of docs/wave as SVG."""
    import wavedrom

    for source in sorted(PICTURES.glob("*.json")):
        text = source.read_text(encoding="utf-8")
        drawn = lean(wavedrom.render(text).tostring())
        source.with_suffix(".svg").write_text(f"<!-- {digest(text)} -->\n{drawn}\n", encoding="utf-8")


def lean(svg):
    """An SVG of wavedrom without the bricks it does not use, on white."""
    used = set(re.findall(r'href="#([^"]+)"', svg))

    def brick(found):
        return found[0] if found[1] in used else ""

    head, defs, rest = re.split(r"(<defs>.*?</defs>)", svg, maxsplit=1, flags=re.DOTALL)
    defs = re.sub(r'<g id="([^"]+)">.*?</g>', brick, defs, flags=re.DOTALL)
    return f'{head}{defs}<rect width="100%" height="100%" fill="white" />{rest}'


def digest(text):
    """What a picture carries to show which source it was drawn from."""
    return f"drawn from WaveJSON {hashlib.sha256(text.encode()).hexdigest()[:16]}"


def main():
    if sys.argv[1:] not in ([], ["--render"]):
        sys.exit(__doc__)
    lab = Lab()
    for name, text in waves.pictures(lab).items():
        (PICTURES / f"{name}.json").write_text(text, encoding="utf-8")
    if "--render" in sys.argv:
        render()
    measured = measure.everything(lab, time.monotonic)
    text = DOCUMENT.read_text(encoding="utf-8")
    DOCUMENT.write_text(measure.put_tables(text, measured), encoding="utf-8")


if __name__ == "__main__":
    main()
