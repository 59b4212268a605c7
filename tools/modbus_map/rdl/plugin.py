# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`peakrdl modbus` writes a map file of SystemRDL; the importer lets any PeakRDL command read a map file.

    peakrdl modbus device.rdl -o device.yaml
    peakrdl html device.yaml -o html

peakrdl.toml of the checkout names both.
"""

from __future__ import annotations

import atexit
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from peakrdl.plugins.exporter import ExporterSubcommandPlugin
from peakrdl.plugins.importer import ImporterPlugin

from modbus_map import checks, dump, loader
from modbus_map.diagnostics import MapError
from modbus_map.outputs import rdl
from modbus_map.rdl import importer

if TYPE_CHECKING:
    import argparse

    from systemrdl import RDLCompiler
    from systemrdl.node import AddrmapNode


class Exporter(ExporterSubcommandPlugin):
    """`peakrdl modbus`: the map file of an address map."""

    short_desc = "Write the map file of a Modbus device (modbus_rtu_slave)"

    def do_export(self, top_node: AddrmapNode, options: argparse.Namespace) -> None:
        """Write the map; errors end PeakRDL with one line each."""
        try:
            device, _ = checks.compile_source(importer.source_of(top_node, options.input_files[0]))
        except MapError as error:
            raise SystemExit(str(error)) from None
        Path(options.output).write_text(dump.text(device), encoding="utf-8")


class Importer(ImporterPlugin):
    """Map files as inputs of every PeakRDL command."""

    file_extensions = ("yaml", "yml")

    def is_compatible(self, path: str) -> bool:
        """True for a YAML file that names a device."""
        try:
            tree = loader.load(path).tree
        except MapError:
            return True  # it is ours to say what is wrong with it
        return isinstance(tree, dict) and "device" in tree

    def do_import(self, rdlc: RDLCompiler, options: Any, path: str) -> None:
        """Compile the map's SystemRDL."""
        try:
            device, _ = checks.load_device(path)
        except MapError as error:
            raise SystemExit(str(error)) from None
        (name, text), *_ = rdl.generate(device).items()
        folder = Path(tempfile.mkdtemp())  # PeakRDL reads it again where it has something to say of it
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        file = folder / name
        file.write_text(text, encoding="utf-8")
        rdlc.compile_file(str(file))
