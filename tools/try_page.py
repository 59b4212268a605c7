#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Make docs/try.html: the core as WebAssembly behind the panel, one file that opens from disk.

    try_page.py [OUT.html]
    try_page.py --check        says if docs/try.html is older than what it is made of

The RTL goes through Yosys CXXRTL and the C++ compiler of the package ziglang; page, style and scripts are those of
sim/panel.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path

import common

ROOT = common.ROOT
sys.path.insert(0, str(ROOT / "sim"))
from server import forms  # noqa: E402

PANEL = ROOT / "sim" / "panel"
BUILD = Path("build") / "try"
TARGET = ROOT / "docs" / "try.html"
LIMIT = 400_000  # bytes of the page
TOP, HARNESS = "slave_bench", ("core_bench.v", "slave_bench.v")
# The reference map; 16 clocks a bit at 19200 baud.  CLK_HZ and the tables are said again in sim/panel/wasm.js.
PARAMETERS = {
    "CLK_HZ": 307_200,
    "COIL_COUNT": 1024,
    "DISCRETE_COUNT": 2048,
    "INPUT_COUNT": 1024,
    "HOLDING_COUNT": 2048,
    "FILE_COUNT": 4,
    "FILE_RECORDS": 256,
}
COMPILE = (
    *("-target", "wasm32-wasi", "-mexec-model=reactor", "-std=c++17", "-O3", "-flto"),
    *("-fno-exceptions", "-fno-rtti", "-DNDEBUG", "-w", "-Wl,--strip-all"),
)
FORMS = ("sim/server/forms.py", "sim/server/values.py", "sim/faults.py", "sim/fault_kinds.h")
SCRIPTS = ("words.js", "faults.js", "panel.js", "wasm.js")
START = """
Wasm.open(Uint8Array.from(atob(CORE), (c) => c.charCodeAt(0))).then((backend) => {
  Panel.use(backend);
  backend.device.tell({ event: "connection", open: true });
});
"""


def sources() -> list[str]:
    """The Verilog files of the core and of the bench around it, relative to the root."""
    return [*common.rtl_files(), *(f"{common.BENCHES}/{name}" for name in HARNESS)]


def _digest(names: list[str], *more: str) -> str:
    """A name for the contents of files, relative to the root."""
    out = hashlib.sha256("\n".join(more).encode())
    for name in names:
        out.update(f"{name}\n".encode())
        out.update((ROOT / name).read_bytes())
    return out.hexdigest()[:16]


def core_sources() -> list[str]:
    """Everything that goes into the core, relative to the root."""
    flat = [f"{common.BENCHES}/{name}" for name in ("flat_ports.vh", "flat_inst.vh")]
    tools = ["sim/panel/core.cpp", "tools/requirements/try.txt", "tools/requirements/yosys.txt"]
    return [*sources(), *common.include_files(), *flat, *tools]


def digest() -> str:
    """A name for the contents of everything that goes into the page."""
    pages = [f"sim/panel/{name}" for name in (*SCRIPTS, "panel.css", "panel.html")]
    return _digest([*core_sources(), *pages, *FORMS, "tools/try_page.py"])


def stale(target: Path = TARGET) -> str:
    """Why the page must be made again, or an empty text."""
    if not target.exists():
        return f"{target.name} is not there; run make try"
    return (
        "" if f'content="{digest()}"' in target.read_text(encoding="utf-8") else f"{target.name} is old; run make try"
    )


def wasm(folder: Path = BUILD, parameters: Mapping[str, object] = PARAMETERS) -> Path:
    """The core as WebAssembly in `folder` (relative to the root), compiled if it is old; ToolError if a tool fails."""
    import pyosys

    out, stamp = folder / "core.wasm", ROOT / folder / "made_from"
    made_from = _digest(core_sources(), *COMPILE, *(f"{name}={value}" for name, value in parameters.items()))
    if (ROOT / out).exists() and stamp.exists() and stamp.read_text(encoding="ascii") == made_from:
        return ROOT / out
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    stamp.unlink(missing_ok=True)
    includes = " ".join([*common.include_options(), f"-I{common.BENCHES}"])
    settings = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    model = folder / "model.cc"
    script = "; ".join(
        (
            f"read_verilog {includes} {' '.join(sources())}",
            f"chparam {settings} {TOP}",
            f"hierarchy -check -top {TOP}",
            "proc; flatten; opt; memory -nomap; opt_clean",
            f"write_cxxrtl -O6 -g0 {model}",
        )
    )
    common.run(["python", "tools/yosys.py", "-p", script], folder / "yosys.log")
    os.environ |= {f"ZIG_{kind}_CACHE_DIR": str(ROOT / BUILD / "zig") for kind in ("GLOBAL", "LOCAL")}
    runtime = Path(pyosys.__file__).parent / "share" / "include" / "backends" / "cxxrtl" / "runtime"
    command = ["python", "-m", "ziglang", "c++", *COMPILE, f"-I{runtime}", f'-DCORE_MODEL="{ROOT / model}"']
    common.run([*command, "sim/panel/core.cpp", "-o", str(out)], folder / "zig.log")
    stamp.write_text(made_from, encoding="ascii")
    return ROOT / out


def page(core: bytes) -> str:
    """The text of the page around the bytes of core.wasm."""
    text = (PANEL / "panel.html").read_text(encoding="utf-8")
    text = text.replace(
        '<meta charset="utf-8">', f'<meta charset="utf-8">\n<meta name="made-from" content="{digest()}">'
    )
    style = (PANEL / "panel.css").read_text(encoding="utf-8")
    text = text.replace('<link rel="stylesheet" href="panel.css">', f"<style>\n{style}</style>")
    text = re.sub(r'<script src="[a-z]+\.js"></script>\n', "", text)
    scripts = "\n".join([forms.script(), *((PANEL / name).read_text(encoding="utf-8") for name in SCRIPTS)])
    core_text = f"const CORE = {json.dumps(base64.b64encode(core).decode())};"
    return text.replace("</body>", f"<script>\n{scripts}\n{core_text}\n{START}</script>\n</body>")


def main() -> int:
    """Build the core, write the page, say how large it is."""
    if sys.argv[1:] == ["--check"]:
        print(f"try: {stale() or 'docs/try.html is up to date'}")
        return 1 if stale() else 0
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET
    try:
        core = wasm()
    except common.ToolError as error:
        print(f"try: {error}", file=sys.stderr)
        return 1
    text = page(core.read_bytes())
    size = len(text.encode())
    if size > LIMIT:
        print(f"try: the page has {size} bytes, {LIMIT} is the limit", file=sys.stderr)
        return 1
    target.write_text(text, encoding="utf-8")
    print(f"try: {target} ({size} bytes, {core.stat().st_size} of them the core)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
