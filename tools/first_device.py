#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Plays docs/first_device.md as a new user would, in an empty clone, and draws its pictures.

    first_device.py             plays the commands of the page; each must say what the page says. Prints the time
    first_device.py --update    and puts time and pictures into docs/ (the manual's needs Chromium)

The clone gets its own .venv, from pip's cache where that has the packages. Exit status 1 if a command says
something else.
"""

from __future__ import annotations

import argparse
import html
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "first_device.md"
SECONDS = 300  # for one command
MOST = 120  # to the first answer
LEFT_OUT = (
    "bash: ",
    "mbpoll 1.",
    "Copyright",
    "This ",
    "under certain",
)  # of the picture: bash has no terminal; licence


def blocks(kind: str) -> list[str]:
    """The code blocks of the page of a kind; "" for those without."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    return [text for name, text in found if name == kind]


def steps() -> list[tuple[str, list[str]]]:
    """(command, lines that it must say) of the page, in order."""
    found: list[tuple[str, list[str]]] = []
    for block in blocks(""):
        if not block.startswith("$ "):
            continue
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            else:
                found[-1][1].append(line)
    return found


class Differs(RuntimeError):
    """A command did not say what the page says."""


class Shell:
    """A bash in `folder` that is given one command after the other. `change` is applied to each."""

    def __init__(self, folder: Path, change=lambda text: text) -> None:
        self.change = change
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        # Lines come in the order of a terminal.
        command = ["stdbuf", "-oL", "bash", "-m"]
        self.process = subprocess.Popen(command, cwd=folder, text=True, start_new_session=True, **pipes)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.write("kill $(jobs -p) 2>/dev/null; wait; exit\n")
        self.process.stdin.flush()
        try:
            self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)

    def run(self, command: str, wanted: list[str]) -> list[str]:
        """What a command says, until its end; one in the background, until it has said what is wanted."""
        mark = f"end of {time.monotonic_ns()}"
        behind = command.rstrip().endswith("&")
        self.process.stdin.write(f"{self.change(command)}\n" + ("" if behind else f"echo; echo '{mark}'\n"))
        self.process.stdin.flush()
        said: list[str] = []
        expected = [self.change(line) for line in wanted]
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            line = self.process.stdout.readline()
            if not line or line.strip() == mark:
                break
            said.append(line.rstrip("\n"))
            if behind and expected and squeezed(line) == squeezed(expected[-1]):
                break
        rest = iter(map(squeezed, said))
        missing = [line for line in expected if squeezed(line) not in rest]
        if missing:
            raise Differs(f"$ {command}\nsaid:\n" + "\n".join(said) + "\nand not:\n" + "\n".join(missing))
        return said


def squeezed(line: str) -> str:
    return " ".join(line.split())


def play(folder: Path, change=lambda text: text) -> tuple[list[tuple[str, list[str]]], float]:
    """([(command, what it said)], seconds until mbpoll had its first answer). Raises Differs."""
    (folder / change("relay_box.yaml")).write_text(blocks("yaml")[0], encoding="utf-8")
    begun, first, said = time.monotonic(), 0.0, []
    with Shell(folder, change) as shell:
        for command, wanted in steps():
            said.append((command, shell.run(command, wanted)))
            if "mbpoll" in command and not first:
                first = time.monotonic() - begun
    return said, first


# ---------------------------------------------------------------- pictures

HEAD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-size="13">
  <!-- SPDX-License-Identifier: Apache-2.0 -->
  <!-- Copyright (c) 2026 the project contributors. Drawn by tools/first_device.py. -->
  <style>
    .t {{ font-family: "DejaVu Sans Mono", monospace; white-space: pre }} .n {{ font-family: sans-serif }}
    .l {{ stroke: #222; stroke-width: 1.4; fill: none }} .b {{ stroke: #222; stroke-width: 1.6; fill: #fff }}
    .k {{ fill: #1f5fae }} .g {{ fill: #5a6474 }} .m {{ text-anchor: middle }} .e {{ text-anchor: end }}
  </style>
  <rect width="{width}" height="{height}" fill="{paper}" rx="8"/>
"""


def text(x: float, y: float, what: str, kind: str, more: str = "") -> str:
    return f'  <text x="{x}" y="{y}" class="{kind}"{more}>{html.escape(what)}</text>\n'


def terminal(said: list[tuple[str, list[str]]]) -> str:
    """The session as a terminal shows it, from the first command to the refused value."""
    lines = []
    for command, answers in said:
        if command.startswith("kill"):
            break
        lines.append((f"$ {command}", "#9ecbff"))
        shown = [line.expandtabs() for line in answers if line.strip() and not line.startswith(LEFT_OUT)]
        # without the places of one machine
        lines += [(re.sub(r"(?<= )/\S*/", "", line), "#e4e8ef") for line in shown]
    width, pitch = 860, 17
    height = 44 + pitch * len(lines)
    out = HEAD.format(width=width, height=height, paper="#14181f")
    for n, colour in enumerate(("#ff5f57", "#febc2e", "#28c840")):
        out += f'  <circle cx="{18 + 18 * n}" cy="16" r="5.5" fill="{colour}"/>\n'
    for n, (line, colour) in enumerate(lines):
        out += text(14, 44 + pitch * n, line, "t", f' fill="{colour}" font-size="12.5"')
    return out + "</svg>\n"


def module(source: str, device) -> str:
    """The map at the left, the module with its ports at the right."""
    rows = source.splitlines()
    ports = device.port_list()
    sides = {way: [p for p in ports if p.direction == way] for way in ("input", "output")}
    pitch, top, left, right, wide = 26, 86, 880, 1060, 1220
    height = max(top + pitch * max(map(len, sides.values())) + 40, 90 + 19 * len(rows))
    out = HEAD.format(width=wide, height=height, paper="#fff")
    out += text(24, 34, "relay_box.yaml", "n", ' font-weight="600"')
    out += f'  <rect x="16" y="46" width="640" height="{19 * len(rows) + 20}" class="b" rx="4"/>\n'
    for n, row in enumerate(rows):
        key, colon, rest = row.partition(":")
        shown = html.escape(row if len(row) < 92 else row[:88] + " …")
        if not row.startswith(" ") and len(row) < 92:
            shown = f'<tspan class="k">{html.escape(key)}</tspan>{html.escape(colon + rest)}'
        out += f'  <text x="26" y="{68 + 19 * n}" class="t" font-size="11.5">{shown}</text>\n'
    out += text(706, top + 44, "make map", "n m", ' font-weight="600"')
    out += f'  <path d="M664 {top + 54} h76 m-9 -6 l9 6 l-9 6" class="l"/>\n'
    bottom = top + pitch * max(map(len, sides.values()))
    out += f'  <rect x="{left}" y="{top - 24}" width="{right - left}" height="{bottom - top + 24}" class="b" rx="3"/>\n'
    out += text((left + right) / 2, top - 34, device.name, "n m", ' font-weight="600"')
    for way, x, step in (("input", left, -1), ("output", right, 1)):
        for n, port in enumerate(sides[way]):
            y = top + pitch * n
            inner, outer = ("t", "n g e") if way == "input" else ("t e", "n g")
            out += text(x - 8 * step, y + 4, port.name, inner, ' font-size="12"')
            out += f'  <path d="M{x} {y} h{22 * step}" class="l"/>\n'
            size = f"[{port.width - 1}:0]" if port.width > 1 else ""
            point = port.point
            inside = {"clk_i": "clock", "rst_i": "reset"}.get(port.name, "RS-485")
            what = point.name.replace("_", " ") if point else inside
            out += text(x + 28 * step, y + 4, f"{what} {size}".strip(), outer, ' font-size="12"')
    return out + "</svg>\n"


def screenshot(page: Path, picture: Path) -> None:
    """An HTML file as Chromium shows it."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not program:
        sys.exit("first_device: Chromium is not installed: no picture of the manual")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1100,900"]
    subprocess.run([program, *options, f"--screenshot={picture}", page.as_uri()], check=True, capture_output=True)


def used() -> float:
    """Seconds of a processor's time that all programs have taken so far."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return children.ru_utime + children.ru_stime


def update(folder: Path, said: list[tuple[str, list[str]]], taken: float) -> None:
    """Time and pictures, from the folder in which the page was played."""
    sys.path.insert(0, str(ROOT / "tools"))
    from modbus_map.checks import compile_source
    from modbus_map.loader import parse

    source = blocks("yaml")[0]
    device, _ = compile_source(parse(source, "relay_box.yaml"))
    docs = ROOT / "docs"
    (docs / "first_device_module.svg").write_text(module(source, device), encoding="utf-8")
    (docs / "first_device_terminal.svg").write_text(terminal(said), encoding="utf-8")
    screenshot(folder / "build/relay_box/relay_box.html", docs / "first_device_manual.png")
    took = f"All of it takes {taken:.0f} seconds of a processor's time, the making of .venv and two starts included."
    page = PAGE.read_text(encoding="utf-8")
    marks = "<!-- time begin -->", "<!-- time end -->"
    page = re.sub(f"{marks[0]}.*?{marks[1]}", f"{marks[0]}\n{took}\n{marks[1]}", page, flags=re.S)
    PAGE.write_text(page, encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true", help="put time and pictures into docs/")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="first_device.") as place:
        folder = Path(place) / "clone"
        subprocess.run(["git", "clone", "-q", "--depth", "1", ROOT.as_uri(), folder], check=True)
        try:
            before = used()
            said, seconds = play(folder)
            taken = used() - before
        except Differs as error:
            print(f"first_device: {error}", file=sys.stderr)
            return 1
        print(f"{len(said)} commands; the first answer after {seconds:.0f} s; processor's time {taken:.0f} s")
        if options.update:
            update(folder, said, taken)
    return 0 if seconds < MOST else 1


if __name__ == "__main__":
    sys.exit(main())
