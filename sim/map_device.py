# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""MAP=device.yaml of `make serve`: the device of a map file, made by the map compiler (docs/map.md).

Standard library only: the compiler is a program of its own, which installs what it lacks.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENDINGS = (".yaml", ".yml", ".csv")
CORE_FOLDER, INCLUDE = "$(MODBUS_RTU)", "+incdir+"  # in NAME.f
PARITIES = {"E": "even", "O": "odd", "N": "none"}
EXIT_BAD_MAP = 2
TABLES = {  # as INIT and the control server name them
    "coils": "coils",
    "discrete_inputs": "discretes",
    "input_registers": "inputs",
    "holding_registers": "holdings",
}


@dataclass
class MapDevice:
    """What NAME.live.json says, NAME.f and NAME_live.v, and the initial contents as (space, item, value)."""

    facts: dict
    files: list[Path]
    folders: list[Path]
    items: list[tuple[int, int, int]]

    @property
    def top(self) -> str:
        return self.facts["top"]

    @property
    def run_time(self) -> bool:
        """True if address, rate and format are ports; else they are parameters."""
        return self.facts["line"]["run_time"]

    def defaults(self, named: dict[str, str]) -> dict[str, str]:
        """Variables of `make serve` as the map has them. A PARITY that is given brings its own default of STOP."""
        line = self.facts["line"]
        found = {"ADDRESS": str(line["address"]), "BAUD": str(line["baud"]), "PARITY": PARITIES[line["format"][1]]}
        if "PARITY" not in named:
            found["STOP"] = line["format"][2]
        return found

    def core(self, name: str) -> int:
        """What the map gives a parameter of the core, or 0."""
        return self.facts["core"].get(name, 0)

    def tables(self) -> dict[str, list[int]]:
        """Table: first address and number of addresses, as far as points reach."""
        found = {}
        for table, points in self.facts["tables"].items():
            places = [point["at"] for point in points] + [point["at"] + point["size"] for point in points]
            found[TABLES[table]] = [min(places), max(places) - min(places)] if places else [0, 0]
        return found


def is_map(text: str) -> bool:
    """True if MAP names a map file; else it is a list of tables."""
    return text.strip().lower().endswith(ENDINGS)


@contextmanager
def built(file: str, init: str) -> Iterator[MapDevice]:
    """The device of a map file, its RTL in a folder that is there until the end of the block.

    The compiler's diagnostics go to standard error; a map or an INIT that is wrong ends with status 2.
    """
    venv = ROOT / ".venv" / "bin" / "python"
    python = str(venv) if venv.exists() else sys.executable
    with tempfile.TemporaryDirectory(prefix="modbus_map.") as folder:
        command = [python, str(ROOT / "tools" / "modbus"), "map", "live", file.strip(), "-o", folder]
        done = subprocess.run([*command, *(["--init", init] if init else [])], stdout=sys.stderr, check=False)
        if done.returncode:
            sys.exit(EXIT_BAD_MAP if done.returncode == EXIT_BAD_MAP else 1)
        yield read(Path(folder))


def read(folder: Path) -> MapDevice:
    """What `modbus map live` has written."""
    facts = json.loads(next(folder.glob("*.live.json")).read_text(encoding="utf-8"))
    name = facts["device"]
    lines = [line for line in (folder / f"{name}.f").read_text(encoding="utf-8").splitlines() if line[:2] != "//"]
    core = [line.replace(CORE_FOLDER, str(ROOT)) for line in lines if CORE_FOLDER in line]
    initial = folder / "initial.txt"
    words = initial.read_text(encoding="utf-8").split("\n") if initial.exists() else []
    return MapDevice(
        facts,
        [
            *(Path(line) for line in core if not line.startswith(INCLUDE)),
            folder / f"{name}.v",
            folder / f"{name}_live.v",
        ],
        [Path(line[len(INCLUDE) :]) for line in core if line.startswith(INCLUDE)],
        [tuple(map(int, line.split())) for line in words if line],
    )
