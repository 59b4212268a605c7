# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`modbus map ...`: build, check, init, schema, from-csv, from-rdl. Exit status 2 and one line for each error."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from modbus_map.checks import compile_source
from modbus_map.diagnostics import Diagnostic, MapError
from modbus_map.model import Device


def main(arguments: list[str] | None = None) -> int:
    """Runs a command; returns the exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except MapError as error:
        for note in error.diagnostics:
            print(note, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"modbus: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 2


def device_of(path: str) -> Device:
    """The device of a map file of any kind (YAML, .csv, .rdl); warnings go to standard error. Raises MapError."""
    device, warnings = compile_source(_source(path))
    _print(warnings)
    return device


def _source(path: str):  # type: ignore[no-untyped-def]
    if path.lower().endswith(".csv"):
        from modbus_map import csv_door

        return csv_door.load(path)
    from modbus_map import loader

    return loader.load(path)


def _print(notes: list[Diagnostic]) -> None:
    for note in notes:
        print(note, file=sys.stderr)


def write_all(files: dict[str, str], out: str | Path) -> None:
    """Write all files below `out`, or none: through a folder beside it. Raises OSError."""
    target = Path(out)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(20, "is a file, not a folder; name a folder", str(target))
    target.parent.mkdir(parents=True, exist_ok=True)
    staging = Path(tempfile.mkdtemp(prefix=f".{target.name or 'out'}.", dir=target.resolve().parent))
    try:
        for name, text in sorted(files.items()):
            (staging / name).parent.mkdir(parents=True, exist_ok=True)
            (staging / name).write_text(text, encoding="utf-8", newline="\n")
        target.mkdir(exist_ok=True)
        for name in sorted(files):
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(staging / name, target / name)
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _build(options: argparse.Namespace) -> int:
    from modbus_map import outputs

    if options.only:
        unknown = [name for name in options.only.split(",") if name not in outputs.GENERATORS]
        if unknown:
            print(f"modbus: no output {unknown[0]}; known are {', '.join(outputs.GENERATORS)}", file=sys.stderr)
            return 2
    device = device_of(options.file)
    files = outputs.generate(device, tuple(options.only.split(",")) if options.only else ())
    write_all(files, options.out)
    print(f"{device.name}: {len(files)} files in {options.out}")
    return 0


def _live(options: argparse.Namespace) -> int:
    """What `make serve MAP=FILE` compiles: the RTL, NAME.live.json, a top for sim/, and INIT for its host port."""
    from modbus_map import live_values, loader, outputs
    from modbus_map.outputs import live

    device = device_of(options.file)
    words = sum(map(len, live.input_words(device).values()))
    if words > live.MOST_WORDS:
        print(f"{options.file}:1:1: {words} words of inputs; the live device has {live.MOST_WORDS}", file=sys.stderr)
        return 2
    files = outputs.generate(device, ("verilog", "live"))
    files[f"{device.name}_live.v"] = live.wrapper(device)
    if options.init:
        initial = live_values.initial(device, loader.load(options.init, "INIT"))
        files["initial.txt"] = "".join(f"{space} {item} {value}\n" for space, item, value in initial)
    write_all(files, options.out)
    return 0


def _check(options: argparse.Namespace) -> int:
    device = device_of(options.file)
    codes = " ".join(f"{code:02X}" for code in device.functions)
    print(f"{device.name}: {len(device.points)} points, function codes {codes}")
    return 0


def _schema(options: argparse.Namespace) -> int:
    from modbus_map import schema

    sys.stdout.write(schema.text())
    return 0


def _init(options: argparse.Namespace) -> int:
    from modbus_map import example

    path = Path(options.file)
    if path.exists() and not options.force:
        print(f"modbus: {path} is there already; name another file, or --force", file=sys.stderr)
        return 2
    path.write_text(example.text(), encoding="utf-8")
    print(f"{path}: an example with all keys; `make map FILE={path} OUT=build/my_device` builds it")
    return 0


def _from_csv(options: argparse.Namespace) -> int:
    from modbus_map import dump

    device = device_of(options.file)
    _write_map(dump.text(device), options.out)
    return 0


def _from_rdl(options: argparse.Namespace) -> int:
    from modbus_map import dump
    from modbus_map.rdl import importer

    device = importer.load(options.file, options.top)
    _write_map(dump.text(device), options.out)
    return 0


def _reference(options: argparse.Namespace) -> int:
    from modbus_map import reference

    path = Path(options.file)
    path.write_text(reference.updated(path.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


def _fusesoc(options: argparse.Namespace) -> int:
    """The generator of modbus_rtu_slave.core: parameters come in a file, a core file goes to the working folder."""
    from modbus_map import loader, outputs

    tree = loader.load(options.file).tree
    file = Path(tree["files_root"]) / str(tree["parameters"]["file"])
    device = device_of(str(file))
    files = outputs.generate(device, ("verilog",))
    files[f"{device.name}.core"] = (
        f"CAPI=2:\nname: {tree['vlnv']}\nfilesets:\n  rtl:\n    files: [{device.name}.v]\n"
        "    file_type: verilogSource-2005\ntargets:\n  default:\n    filesets: [rtl]\n"
    )
    write_all(files, ".")
    return 0


def _write_map(text: str, out: str) -> None:
    if out == "-":
        sys.stdout.write(text)
    else:
        Path(out).write_text(text, encoding="utf-8")
        print(f"{out}: written")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="modbus", description="A Modbus device from one file.")
    areas = parser.add_subparsers(dest="area", required=True, metavar="map")
    commands = areas.add_parser("map", help="the map compiler").add_subparsers(required=True, metavar="COMMAND")

    build = commands.add_parser("build", help="make all outputs of a map; nothing is written if anything is wrong")
    build.add_argument("file", metavar="FILE", help="the map: YAML, or CSV with one row a point")
    build.add_argument("-o", "--out", required=True, metavar="OUT", help="folder for the outputs")
    build.add_argument("--only", default="", metavar="NAME,...", help="only these outputs: verilog, vhdl, c, ...")
    build.set_defaults(run=_build)

    live = commands.add_parser("live", help="what `make serve MAP=FILE` compiles")
    live.add_argument("file", metavar="FILE")
    live.add_argument("--init", default="", metavar="JSON", help="values of the inputs and of the memory by name")
    live.add_argument("-o", "--out", required=True, metavar="OUT")
    live.set_defaults(run=_live)

    check = commands.add_parser("check", help="say what is wrong with a map, write nothing")
    check.add_argument("file", metavar="FILE")
    check.set_defaults(run=_check)

    init = commands.add_parser("init", help="write a commented example")
    init.add_argument("file", metavar="FILE", nargs="?", default="device.yaml")
    init.add_argument("--force", action="store_true", help="overwrite the file")
    init.set_defaults(run=_init)

    schema = commands.add_parser("schema", help="print the JSON Schema of the map file")
    schema.set_defaults(run=_schema)

    table = commands.add_parser("from-csv", help="make a map file of a table with one row a point")
    table.add_argument("file", metavar="FILE")
    table.add_argument("-o", "--out", default="-", metavar="MAP")
    table.set_defaults(run=_from_csv)

    tables = commands.add_parser("reference", help="make the tables of docs/map.md anew")
    tables.add_argument("file", metavar="DOCUMENT")
    tables.set_defaults(run=_reference)

    fusesoc = commands.add_parser("fusesoc", help="what FuseSoC's generator calls")
    fusesoc.add_argument("file", metavar="CONFIG")
    fusesoc.set_defaults(run=_fusesoc)

    rdl = commands.add_parser("from-rdl", help="make a map file of SystemRDL with the properties of modbus_udp.rdl")
    rdl.add_argument("file", metavar="FILE")
    rdl.add_argument("-o", "--out", default="-", metavar="MAP")
    rdl.add_argument("--top", metavar="ADDRMAP", help="the address map to take; default: the last one")
    rdl.set_defaults(run=_from_rdl)
    return parser
