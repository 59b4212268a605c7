#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Start the live device: check the variables, compile the model they need, become the bridge.

    serve.py [NAME=VALUE]...        names: see README.md beside this file

Exit status: 0 after SIGINT or SIGTERM, 2 for a bad variable, 1 if the model does not compile.
Needs Python's standard library only, so that `make serve` needs no virtual environment.
"""

import os
import re
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import filelist  # noqa: E402
import map_device  # noqa: E402
import models  # noqa: E402
from init_file import FILES, TABLES, WORDS, BadVariable, Initial, Layout, load  # noqa: E402

CLOCK_HZ = 1_843_200  # divides 9600 to 115200 baud without rest, and 2 cores simulate it in passing
BIT_TIMES = range(8, 65536)  # clock cycles per bit that the core takes
MOST_RATE_ERROR = 50  # one part in so many of the rate; the parameters of a map refuse more
ADDRESSES = range(1, 248)
ITEMS = len(WORDS)  # a table, or all files together, can have

RECORDS = 10_000  # a file can have
FORMATS = {("even", 1): 0, ("odd", 1): 1, ("none", 2): 2, ("none", 1): 3}

# DEVICE: top module and its parameters
DEVICES = {
    "standard": ("modbus_live", {}),
    "user": ("modbus_live", {"USER_CODES": f"128'h{1 << 0x41 | 1 << 0x42 | 1 << 0x64:x}"}),
    "pdm": ("modbus_live_pdm", {}),
}
METER = {"coils": range(0), "discretes": range(4), "inputs": range(0), "holdings": range(512)}

DEFAULTS = {
    "DEVICE": "standard",
    "LINK": "build/modbus",
    "ADDRESS": "17",
    "BAUD": "19200",
    "PARITY": "even",
    "STOP": "",
    "INIT": "",
    "MAP": "",
    "TRACE": "",
    "PARAMETERS": "",
    "DIE_WITH_PARENT": "",
}


def number(name, text, allowed):
    """The decimal number `text` of the range `allowed`."""
    if not re.fullmatch(r"[0-9]{1,10}", text) or int(text) not in allowed:
        raise BadVariable(f"{name}={text}: must be a number from {allowed.start} to {allowed.stop - 1}")
    return int(text)


def character_format(parity, stop):
    """Format code of the core for PARITY and STOP."""
    if parity not in ("even", "odd", "none"):
        raise BadVariable(f"PARITY={parity}: must be even, odd or none")
    if stop not in ("", "1", "2"):
        raise BadVariable(f"STOP={stop}: must be 1 or 2")
    stops = int(stop) if stop else 2 if parity == "none" else 1
    if (parity, stops) not in FORMATS:
        raise BadVariable(f"STOP=2: a character with {parity} parity has 1 stop bit")
    return FORMATS[parity, stops]


def bit_time(text):
    """Clock cycles per bit for BAUD."""
    slowest = -(-CLOCK_HZ // BIT_TIMES[-1])
    baud = number("BAUD", text, range(slowest, CLOCK_HZ // BIT_TIMES[0] + 1))
    return baud, (CLOCK_HZ + baud // 2) // baud


def layout(device, text):
    """MAP as Layout: tables as {name: range of addresses}, files as (count, records)."""
    if device == "pdm":
        if text.strip():
            raise BadVariable("MAP: the PDM meter has its own map, leave MAP out with DEVICE=pdm")
        return Layout(METER, (0, 1), meter=True)
    if not text.strip():
        return Layout({name: range(count) for name, (_, _, count, _) in TABLES.items()}, FILES)
    found, files, named = {name: range(0) for name in TABLES}, (0, 1), set()
    for word in text.split():
        name = word.partition("=")[0]
        if name in named:
            raise BadVariable(f"MAP: {name} is named twice")
        named.add(name)
        if name == "files":
            files = file_layout(word)
        else:
            found[name] = table_layout(name, word)
    return Layout(found, files)


def table_layout(name, word):
    """table=base+size as a range of addresses."""
    match = re.fullmatch(r"[a-z]+=([0-9]{1,5})\+([0-9]{1,5})", word)
    if not match or name not in TABLES:
        raise BadVariable(f"MAP: {word}: must be table=base+size, table one of {', '.join(TABLES)}; or files=4x256")
    base, size = int(match[1]), int(match[2])
    if base >= ITEMS or base + size > ITEMS:
        raise BadVariable(f"MAP: {word}: goes past address {ITEMS - 1}")
    return range(base, base + size)


def file_layout(word):
    """files=countxrecords as (count, records)."""
    match = re.fullmatch(r"files=([0-9]{1,5})x([0-9]{1,5})", word)
    if not match:
        raise BadVariable(f"MAP: {word}: must be files=count x records, for example files=4x256")
    count, records = int(match[1]), int(match[2])
    if not 1 <= records <= RECORDS:
        raise BadVariable(f"MAP: {word}: a file has 1 to {RECORDS} records")
    if count * records > ITEMS or count >= ITEMS:
        raise BadVariable(f"MAP: {word}: all files together have at most {ITEMS} records")
    return count, records


def table_parameters(place):
    """Parameters of modbus_live for a Layout."""
    out = {}
    if not place.meter:
        for name, (_, prefix, _, _) in TABLES.items():
            out |= {f"{prefix}_BASE": place.tables[name].start, f"{prefix}_COUNT": len(place.tables[name])}
        out |= {"FILE_COUNT": place.files[0], "FILE_RECORDS": place.files[1]}
    return out


def parameters(text):
    """Further parameters of the core, "NAME=number ...": for tests of other builds."""
    found = {}
    for word in text.split():
        match = re.fullmatch(r"([A-Z][A-Z0-9_]*)=([0-9]+)", word)
        if not match:
            raise BadVariable(f"PARAMETERS: {word}: must be NAME=number")
        found[match[1]] = match[2]
    return found


def check_link(link):
    """Refuse a LINK that is not ours to take; return True if it is a leftover of a dead device."""
    if not link:
        raise BadVariable("LINK: must be a path")
    if not os.path.lexists(link):
        parent = os.path.dirname(link) or "."
        if not os.path.isdir(parent):
            raise BadVariable(f"LINK={link}: {parent} is no directory")
        return False
    target = os.readlink(link) if os.path.islink(link) else ""
    if not re.fullmatch(r"/dev/pts/[0-9]+", target):
        raise BadVariable(f"LINK={link}: exists and is no link of a live device")
    if os.path.exists(target):
        raise BadVariable(f"LINK={link}: leads to {target}, which is in use")
    return True


def compiled(top, values, files, folders):
    """Path of the bridge for a top module and its parameters, compiled now unless that was done before."""
    model = models.Model(top, ROOT / "sim" / "bridge.cpp", files, folders, values, {"CLOCK_HZ": CLOCK_HZ}, shared=False)
    try:
        return models.compiled(model, lambda: say("compiling the device (10 to 30 s, once for each map and identity)"))
    except models.BuildError as error:
        raise SystemExit(f"serve: the device does not compile: {error}") from None


def say(text):
    """A line for people; standard output belongs to `ready`."""
    print(f"serve: {text}", file=sys.stderr, flush=True)


def init_descriptor(items):
    """The initial contents as a file without a name, open for the bridge."""
    fd = os.memfd_create("init", 0)
    os.write(fd, "".join(f"{s} {a} {v}\n" for s, a, v in items).encode())
    os.lseek(fd, 0, os.SEEK_SET)
    return fd


def named_variables(given):
    """The variables that have a value, by name."""
    named = {}
    for word in given:
        name, _, value = word.strip().partition("=")
        if name not in DEFAULTS:
            raise BadVariable(f"{name}: unknown variable")
        if value:
            named[name] = value
    return named


@dataclass
class Settings:
    """The line, as numbers of the core."""

    address: int
    baud: int
    cycles: int  # per bit
    format: int

    def options(self):
        """Of the bridge."""
        return [
            *("--baud", str(self.baud), "--bit-time", str(self.cycles), "--format", str(self.format)),
            *("--address", str(self.address)),
        ]


def settings(values):
    """ADDRESS, BAUD, PARITY and STOP."""
    address = number("ADDRESS", values["ADDRESS"], ADDRESSES)
    baud, cycles = bit_time(values["BAUD"])
    return Settings(address, baud, cycles, character_format(values["PARITY"], values["STOP"]))


def of_tables(values):
    """(path of the bridge, its options, initial contents) of a device with MAP's tables."""
    line = settings(values)
    device = values["DEVICE"]
    if device not in DEVICES:
        raise BadVariable(f"DEVICE={device}: must be {', '.join(DEVICES)}")
    place = layout(device, values["MAP"])
    initial = Initial()
    if values["INIT"]:
        try:
            initial = load(values["INIT"], place)
        except BadVariable as error:
            raise BadVariable(f"INIT={values['INIT']}: {error}") from None
    top, model = DEVICES[device]
    model = {"CLK_HZ": CLOCK_HZ} | model | table_parameters(place) | initial.parameters
    model |= parameters(values["PARAMETERS"])
    check_link(values["LINK"])
    files, folders = filelist.read(ROOT, *filelist.ALL)
    files = [*(ROOT / name for name in files), ROOT / "sim" / f"{top}.v"]
    bridge = compiled(top, model, files, [ROOT / name for name in folders])
    options = line.options()
    for name, value in initial.inputs.items():
        options += [f"--{name.replace('_', '-')}", str(value)]
    return bridge, options, initial.items


def of_map(named):
    """The same of a device that a map file describes."""
    for name in ("DEVICE", "PARAMETERS"):
        if name in named:
            raise BadVariable(f"{name}: a map file is a device of its own, leave {name} out")
    check_link(named.get("LINK", DEFAULTS["LINK"]))
    with map_device.built(named["MAP"], named.get("INIT", "")) as made:
        baud = made.facts["line"]["baud"]
        try:
            line = settings(DEFAULTS | made.defaults(named) | named)
        except BadVariable as error:
            from_map = "BAUD" not in named and str(error).startswith("BAUD")
            raise BadVariable(f"{error}; the map says {baud}, give another BAUD" if from_map else error) from None
        parameters = {"CLK_HZ": CLOCK_HZ}
        if not made.run_time:
            if abs(CLOCK_HZ - line.cycles * line.baud) * MOST_RATE_ERROR > CLOCK_HZ:
                raise BadVariable(f"BAUD={line.baud}: {CLOCK_HZ} Hz, the simulated clock, misses it by more than 2 %")
            parameters |= {"ADDRESS": line.address, "BAUD": line.baud, "FORMAT": line.format}
        bridge = compiled(made.top, parameters, made.files, made.folders)
    options = [*line.options(), "--t35-us", str(made.core("T35_MIN_US"))]
    options += ["--reply-bits", str(made.core("RESPONSE_DELAY"))]
    return bridge, options, made.items


def start(given):
    """Check, compile, become the bridge. Returns only by an exception."""
    named = named_variables(given)
    values = DEFAULTS | named
    bridge, options, items = of_map(named) if map_device.is_map(values["MAP"]) else of_tables(values)
    link = values["LINK"]
    if check_link(link):
        os.unlink(link)
    arguments = [str(bridge), "--link", link, *options]
    if items:
        arguments += ["--init-fd", str(init_descriptor(items))]
    if values["TRACE"]:
        arguments += ["--trace", values["TRACE"]]
    if values["DIE_WITH_PARENT"]:
        arguments += ["--die-with-parent"]
    # Held back until the bridge listens for them, so that none is lost on the way.
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    os.execv(bridge, arguments)


SIGNALS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}


def main():
    """Entry point; the exit status is in the module's description."""
    for sig in SIGNALS:
        signal.signal(sig, lambda *_: sys.exit(0))
    try:
        start(sys.argv[1:])
    except BadVariable as error:
        say(error)
        sys.exit(2)


if __name__ == "__main__":
    main()
