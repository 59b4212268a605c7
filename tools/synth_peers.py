# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Freely licensed cores that are measured beside ours, so that a reader has a scale.

They come as Python packages (tools/requirements/peers.txt) and are measured by the flow of synth_flow.py, each with
the parameters below.  None is a Modbus slave: no package index ships one.  They are a UART, which a slave needs
twice over, and two processors, which a slave in software would need with its program memory.
"""

from __future__ import annotations

import importlib.metadata as metadata
import importlib.util
from dataclasses import dataclass
from dataclasses import field as member
from pathlib import Path

from synth_flow import Design, ToolError

DEVICES_OF_PEERS = ("ice40-hx8k", "ecp5-25k")


@dataclass(frozen=True)
class Peer:
    """A core of a Python package; `files` are patterns below the package's folder `verilog`."""

    package: str
    files: tuple[str, ...]
    top: str
    note: str  # what it is, for the table
    parameters: dict[str, str] = member(default_factory=dict)


PICORV32 = "pythondata-cpu-picorv32"
SERV = "pythondata-cpu-serv"
PEERS = {
    "simpleuart": Peer(
        PICORV32, ("picosoc/simpleuart.v",), "simpleuart", "UART of PicoSoC: 8N1, rate set at run time, no parity"
    ),
    "SERV": Peer(
        SERV, ("rtl/serv_*.v",), "serv_rf_top", "bit-serial RISC-V, RV32I with interrupts, its registers in RAM"
    ),
    "PicoRV32 small": Peer(
        PICORV32,
        ("picorv32.v",),
        "picorv32",
        "RISC-V, RV32I without counters and misalignment traps: its README's `small`",
        {
            "ENABLE_COUNTERS": "0",
            "ENABLE_COUNTERS64": "0",
            "LATCHED_MEM_RDATA": "1",
            "TWO_STAGE_SHIFT": "0",
            "CATCH_MISALIGN": "0",
            "CATCH_ILLINSN": "0",
        },
    ),
    "PicoRV32": Peer(PICORV32, ("picorv32.v",), "picorv32", "RISC-V, RV32I with counters: its defaults"),
}


def design_of(peer: Peer) -> Design:
    """The peer as a design; ToolError where its package is missing."""
    found = importlib.util.find_spec(peer.package.replace("-", "_"))
    if found is None:
        raise ToolError(f"{peer.package} is not installed; make peers installs it")
    folder = Path(found.submodule_search_locations[0]) / "verilog"
    files = sorted(str(path) for pattern in peer.files for path in folder.glob(pattern))
    if not files:
        raise ToolError(f"{peer.package} has no {' '.join(peer.files)}")
    return Design(peer.top, peer.parameters, sources=tuple(files))


def versions() -> dict[str, str]:
    """{package: version} of the peers."""
    return {name: metadata.version(name) for name in dict.fromkeys(peer.package for peer in PEERS.values())}
