# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""docs/timing.md says what the core does: its pictures and tables are measured anew and compared, with FULL=1 all."""

import shutil

import pytest
from conftest import FULL
from timing_doc import measure, waves
from timing_doc.lab import Lab
from timing_doc.update import DOCUMENT, PICTURES, digest

UPDATE = "if the change is meant: .venv/bin/python tb/timing_doc/update.py, see docs/wave/README.md"


def test_figures_and_pictures_of_timing_doc():
    """One test, so that the three devices are compiled once."""
    if not shutil.which("verilator"):
        pytest.skip("verilator is not installed")
    lab, stale = Lab(every=FULL), []
    for name, text in waves.pictures(lab).items():
        source, picture = PICTURES / f"{name}.json", PICTURES / f"{name}.svg"
        if not source.exists() or source.read_text(encoding="utf-8") != text:
            stale.append(f"docs/wave/{name}.json is not what the signals do now:\n{text}")
        elif digest(text) not in picture.read_text(encoding="utf-8"):
            stale.append(f"docs/wave/{name}.svg is not drawn from {name}.json")
    written = measure.tables_of(DOCUMENT.read_text(encoding="utf-8"))
    left_out = {} if FULL else measure.LONG
    measured = measure.everything(lab, but=left_out)
    assert set(written) == {*measured, *left_out.values()}, "the tables of docs/timing.md and of measure.py differ"
    for name, table in measured.items():
        if written[name] != table:
            old = written[name].splitlines()
            new = [line for line in table.splitlines() if line not in old]
            gone = [line for line in old if line not in table.splitlines()]
            stale.append(f"table {name} of docs/timing.md:\n  measured " + "\n  measured ".join(new)
                         + "\n  written  " + "\n  written  ".join(gone))  # fmt: skip
    assert not stale, "\n".join([*stale, UPDATE])


def test_every_picture_is_shown():
    """No picture lies about unused, none is missing."""
    shown = {word for word in DOCUMENT.read_text(encoding="utf-8").replace(")", "(").split("(") if ".svg" in word}
    assert shown == {f"wave/{path.name}" for path in PICTURES.glob("*.svg")}
    assert {path.stem for path in PICTURES.glob("*.svg")} == {path.stem for path in PICTURES.glob("*.json")}
