# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Which module each iCE40 logic cell of a flat design belongs to.

Nothing is synthesised apart: the netlist is the flat one that place and route gets, packed into logic
cells by nextpnr, so the parts add up to the whole.  A module is a file of its own, and Yosys remembers
the file of every register, adder and named signal.  A logic cell belongs to the module

  1. whose register or adder it holds;
  2. else whose named signal it drives;
  3. else that everything which reads it belongs to;
  4. else that everything which it reads belongs to.

What is left is logic that Yosys merged out of several modules; it counts as SHARED.
"""

from __future__ import annotations

import re
from collections import Counter

SHARED = "between modules"
OUTSIDE = ""  # the measuring wrapper
FIELDS = ("lc", "lut", "ff", "carry", "ram")
SOURCE = re.compile(r"(?:^|\|)(?:[^|]*/)?(?:rtl|examples|tb)/(?:\w+/)?(\w+)\.v:")
WRAPPER = re.compile(r"(?:^|\|)[^|]*synth_top\.v:")


def module_of_source(source: str) -> str | None:
    """The module of a `src` attribute; OUTSIDE for the wrapper's, None if it names no file of ours."""
    found = SOURCE.search(source)
    if found:
        return found.group(1)
    return OUTSIDE if WRAPPER.search(source) else None


def instances(netlist: dict) -> dict[str, str]:
    """{instance path: module} of a flattened Yosys netlist, from what flatten left behind."""
    found = {}
    for name, cell in netlist["cells"].items():
        if cell["type"] == "$scopeinfo" and "module" in cell["attributes"]:
            module = cell["attributes"].get("module_hdlname", cell["attributes"]["module"])
            found[name] = re.sub(r"^\$paramod(\$[0-9a-f]+)?\\", "", module).split("\\")[0]
    return found


SLOW_NS = 1.0  # a register shows its data sooner than this after the clock, a block RAM later


def longest_path(report: dict, owners: dict[str, str]) -> dict | None:
    """{"ns", "through"}: the longest path between registers in a report of nextpnr, and the modules on its way.

    `owners`: what instances() found.  A cell that has no module in its name is passed over.  None without a path.
    """
    found = [path["path"] for path in report["critical_paths"] if _of_clock(path["from"]) and _of_clock(path["to"])]
    if not found:
        return None
    longest = max(found, key=lambda steps: sum(step["delay"] for step in steps))
    through: list[str] = []
    for step in longest:
        module = _owner(step["from"]["cell"], owners)
        if module and step["type"] == "clk-to-q" and step["delay"] > SLOW_NS:
            module += " (RAM)"
        if module and through[-1:] != [module] and not (step["type"] != "clk-to-q" and through == [f"{module} (RAM)"]):
            through.append(module)
    return {"ns": round(sum(step["delay"] for step in longest), 2), "through": through}


def _of_clock(event: str) -> bool:
    return event.startswith("posedge")


def _owner(cell: str, owners: dict[str, str]) -> str | None:
    """The module of the innermost instance that a cell's name begins with."""
    names = cell.split(".")
    for end in range(len(names) - 1, 0, -1):
        if ".".join(names[:end]) in owners:
            return owners[".".join(names[:end])]
    return None


def signals(netlist: dict) -> dict[str, str]:
    """{signal bit, as nextpnr writes its name: module that declares it}, of a flattened Yosys netlist.

    A bit has a name in each module it passes through: its own is the deepest that is not an input there.
    """
    best: dict[int, tuple[int, str]] = {}
    names: dict[str, int] = {}
    for name, net in netlist["netnames"].items():
        module = module_of_source(net["attributes"].get("src", ""))
        for index, bit in enumerate(net["bits"]):
            if not isinstance(bit, int):
                continue
            names[f"{name}[{index + int(net.get('offset', 0))}]" if len(net["bits"]) > 1 else name] = bit
            if module and not name.endswith("_i"):
                best[bit] = max(best.get(bit, (-1, "")), (name.count("."), module))
    return {name: best[bit][1] for name, bit in names.items() if bit in best}


def used(cell: dict) -> dict[str, int]:
    """What a packed cell holds, by FIELDS."""
    if cell["type"] == "ICESTORM_RAM":
        return {"ram": 1}
    parameters, connections = cell["parameters"], cell["connections"]
    register = int(parameters["DFF_ENABLE"], 2)
    through = register and not any(connections[port] for port in ("I1", "I2", "I3"))  # no logic before the register
    return {
        "lc": 1,
        "lut": int(int(parameters["LUT_INIT"], 2) != 0 and not through),
        "ff": register,
        "carry": int(parameters["CARRY_ENABLE"], 2),
    }


class Packed:
    """A design of packed cells, and the module of each."""

    def __init__(self, netlist: dict, packed: dict):
        """Take the one module of the JSON that Yosys wrote, and of the JSON that nextpnr made of it."""
        self.cells = {n: c for n, c in packed["cells"].items() if c["type"] in ("ICESTORM_LC", "ICESTORM_RAM")}
        self.readers: dict[int, list[str]] = {}
        self.drivers: dict[int, str] = {}
        for name, cell in self.cells.items():
            for port, bits in cell["connections"].items():
                for bit in bits:
                    if cell["port_directions"][port] == "input":
                        self.readers.setdefault(bit, []).append(name)
                    else:
                        self.drivers[bit] = name
        declared = signals(netlist)
        self.declared = {
            bit: declared[full]
            for name, net in packed["netnames"].items()
            for index, bit in enumerate(net["bits"])
            if (full := f"{name}[{index}]" if len(net["bits"]) > 1 else name) in declared
        }
        self.paths = instances(netlist)
        self.known = {name: module for name, cell in self.cells.items() if (module := self.own(name, cell)) is not None}

    def own(self, name: str, cell: dict) -> str | None:
        """The module of a cell by what is in it or by its signal; None if neither tells."""
        if cell["type"] == "ICESTORM_RAM":
            while name not in self.paths and "." in name:
                name = name.rpartition(".")[0]
            return self.paths.get(name)
        module = module_of_source(cell["attributes"].get("src", ""))
        if module is None:
            module = next((self.declared[bit] for bit in cell["connections"]["O"] if bit in self.declared), None)
        return module

    def around(self, name: str, forward: bool, memo: dict[str, frozenset]) -> frozenset:
        """The modules of all readers of a cell, or of all it reads, through cells that are nobody's."""
        if name not in memo:
            memo[name] = frozenset()  # a loop ends here
            modules = set()
            for other in self.next_to(name, forward):
                modules |= {self.known[other]} if other in self.known else self.around(other, forward, memo)
            memo[name] = frozenset(modules)
        return memo[name]

    def next_to(self, name: str, forward: bool) -> set[str]:
        """The cells that read a cell's outputs, or that drive its inputs."""
        cell = self.cells[name]
        direction = "output" if forward else "input"
        bits = [b for port, bs in cell["connections"].items() if cell["port_directions"][port] == direction for b in bs]
        if forward:
            return {reader for bit in bits for reader in self.readers.get(bit, [])}
        return {self.drivers[bit] for bit in bits if bit in self.drivers}

    def module(self, name: str, memos: tuple[dict, dict]) -> str:
        """The module of a cell, SHARED or OUTSIDE."""
        if name in self.known:
            return self.known[name]
        for forward, memo in zip((True, False), memos, strict=True):
            modules = self.around(name, forward, memo) - {OUTSIDE}
            if len(modules) == 1:
                return next(iter(modules))
        return SHARED


def attribute(netlist: dict, packed: dict) -> dict[str, dict[str, int]]:
    """{module: {field: count}}, without the wrapper's cells; the largest first, SHARED last."""
    design, memos = Packed(netlist, packed), ({}, {})
    rows: dict[str, Counter] = {}
    for name, cell in design.cells.items():
        module = design.module(name, memos)
        if module != OUTSIDE:
            rows.setdefault(module, Counter()).update(used(cell))
    order = sorted(rows, key=lambda module: (module == SHARED, -rows[module]["lc"], module))
    return {module: {field: rows[module][field] for field in FIELDS} for module in order}
