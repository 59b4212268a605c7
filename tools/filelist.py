# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The file lists of the project: rtl/modbus.f is the core, examples/examples.f what is built around it.

A list holds paths from the project's root, a line each, and `+incdir+FOLDER` for include folders.

    filelist.py --update    writes the core's files into the FuseSoC core and the Quartus .qip, which need lists of
                            their own
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

FUSESOC = "modbus_rtu_slave.core"
QUARTUS = "constraints/quartus/modbus_rtu_slave.qip"

CORE = "rtl/modbus.f"
EXAMPLES = "examples/examples.f"
ALL = (CORE, EXAMPLES)
MODULE = re.compile(r"^\s*module\s+(\w+)", re.MULTILINE)


def read(root: Path, *lists: str) -> tuple[list[str], list[str]]:
    """(Verilog files, include folders) that `lists` name, as paths from `root`; SystemExit without a list."""
    files: list[str] = []
    folders: list[str] = []
    for name in lists:
        if not (root / name).exists():
            raise SystemExit(f"{name}, a list of Verilog files, is missing")
        for line in (root / name).read_text(encoding="utf-8").splitlines():
            line = line.split("//")[0].strip()
            if line.startswith("+incdir+"):
                folders.append(line.removeprefix("+incdir+"))
            elif line:
                files.append(line)
    return files, folders


def reached(top: str, files: Sequence[Path]) -> list[Path]:
    """Those of `files` that module `top` needs, by the names of modules in them; all if none declares it."""
    texts = {path: path.read_text(encoding="utf-8") for path in files}
    place = {name: path for path, text in texts.items() for name in MODULE.findall(text)}
    if top not in place:
        return list(files)
    found, left = set(), {top}
    while left:
        if (path := place[left.pop()]) not in found:
            found.add(path)
            left |= set(re.findall(r"\w+", texts[path])) & place.keys()
    return [path for path in files if path in found]


def headers(root: Path) -> list[str]:
    """The include files of the core, as paths from `root`."""
    folders = read(root, CORE)[1]
    return [path.relative_to(root).as_posix() for folder in folders for path in sorted((root / folder).glob("*.vh"))]


def fusesoc(root: Path) -> str:
    """The FuseSoC core with the file list of the core as it is."""
    lines = [f"      - {name}: {{is_include_file: true}}\n" for name in headers(root)]
    lines += [f"      - {name}\n" for name in read(root, CORE)[0]]
    text = (root / FUSESOC).read_text(encoding="utf-8")
    return re.sub(r"(?<=  rtl:\n    files:\n)(?:      - rtl/.*\n)+", "".join(lines), text)


def quartus(root: Path) -> str:
    """The Quartus .qip likewise."""
    files, folders = read(root, CORE)
    kinds = [("SEARCH_PATH", name) for name in folders]
    kinds += [("VERILOG_INCLUDE_FILE", name) for name in headers(root)]
    kinds += [("VERILOG_FILE", name) for name in files]
    line = 'set_global_assignment -name {} [file join $::quartus(qip_path) "../../{}"]\n'
    text = (root / QUARTUS).read_text(encoding="utf-8")
    return text[: text.index("set_global_assignment -name SEARCH_PATH")] + "".join(line.format(*k) for k in kinds)


def stale(root: Path) -> list[str]:
    """The lists that differ from rtl/modbus.f."""
    made = {FUSESOC: fusesoc(root), QUARTUS: quartus(root)}
    return [name for name, text in made.items() if (root / name).read_text(encoding="utf-8") != text]


if __name__ == "__main__":
    ROOT = Path(__file__).resolve().parents[1]
    if sys.argv[1:] != ["--update"]:
        sys.exit(__doc__)
    for place, text in ((FUSESOC, fusesoc(ROOT)), (QUARTUS, quartus(ROOT))):
        (ROOT / place).write_text(text, encoding="utf-8")
