# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The outputs of a map. A generator takes a Device and gives {path below OUT: text}; it writes nothing itself."""

from __future__ import annotations

from collections.abc import Callable

from modbus_map.model import Device
from modbus_map.outputs import c_header, client, live, manual, rdl, tags, testbench, verilog, vhdl

Generator = Callable[[Device], dict[str, str]]

GENERATORS: dict[str, Generator] = {
    "verilog": verilog.generate,  # NAME.v, NAME.f, the property file
    "vhdl": vhdl.generate,  # NAME.vhd
    "c": c_header.generate,  # NAME.h
    "client": client.generate,  # NAME_client.py
    "manual": manual.generate,  # NAME.md, NAME.html
    "testbench": testbench.generate,  # test_NAME.py
    "rdl": rdl.generate,  # NAME.rdl
    "live": live.generate,  # NAME.live.json
    "tags": tags.generate,  # tags/
}


def generate(device: Device, only: tuple[str, ...] = ()) -> dict[str, str]:
    """All outputs of a device, or those named."""
    files: dict[str, str] = {}
    for name, generator in GENERATORS.items():
        if only and name not in only:
            continue
        for path, text in generator(device).items():
            if path in files:
                raise ValueError(f"two outputs write {path}")
            files[path] = text
    return files
