#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Start the live device: check the variables, compile the model they need, become the bridge.

    serve.py [NAME=VALUE]...        names: see README.md beside this file

Exit status: 0 after SIGINT or SIGTERM, 2 for a bad variable, 1 if the model does not compile.
Needs Python's standard library only, so that `make serve` needs no virtual environment.
"""

import difflib
import json
import os
import re
import shutil
import signal
import stat
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import faults  # noqa: E402
import filelist  # noqa: E402
import map_device  # noqa: E402
import models  # noqa: E402
import ways_in  # noqa: E402
from init_file import FILES, TABLES, WORDS, BadVariable, Initial, Layout, load  # noqa: E402
from server import variables  # noqa: E402

# The model runs at a clock of its own, as slow as the rate allows: each clock costs time of the processor.
BIT_CLOCKS, FAST_BIT_CLOCKS = 16, 8  # clocks per bit; fewer for rates above FAST
FAST = 57_600
BAUDS = range(29, 230_401)
# Up to this rate t1.5 and t3.5 are counted in bits, so one model does for all: the clock it is told does not matter.
SLOW = 19_200
ADDRESSES = range(1, 248)
ITEMS = len(WORDS)  # a table, or all files together, can have

RECORDS = 10_000  # a file can have
SEVEN_BITS, ASCII = 4, 8  # of the format code that the bridge takes, see line.h and device.h
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
    "PORT": "",
    "ADDRESS": "17",
    "SLAVES": "",
    "BAUD": "19200",
    "PARITY": "even",
    "STOP": "",
    "MODE": "rtu",
    "DATA_BITS": "",
    "INIT": "",
    "MAP": "",
    "TRACE": "",
    "HOLD": "200",
    "FAULT": "",
    "WEB": "",
    "TCP": "",
    "RTU_TCP": "",
    "PARAMETERS": "",
    "CONTROL_FD": "",
    "GIVEN": "",
    "DIE_WITH_PARENT": "",
}
NOT_FOR_PEOPLE = ("CONTROL_FD", "GIVEN", "DIE_WITH_PARENT")
# What only the control server knows; it starts if one of them is given, or WEB.
SERVER_VARIABLES = variables.NAMES
# What people write instead
MISTAKEN = {
    "ADDR": "ADDRESS", "UNIT": "ADDRESS", "UNIT_ID": "ADDRESS", "ID": "ADDRESS", "SLAVE_ID": "ADDRESS",
    "SLAVE": "SLAVES", "BAUDRATE": "BAUD", "BAUD_RATE": "BAUD", "RATE": "BAUD", "SPEED": "BAUD", "STOPBITS": "STOP",
    "STOP_BITS": "STOP", "INITIAL": "INIT", "PTY": "LINK", "TTY": "PORT", "SERIAL": "PORT", "FAULTS": "FAULT",
    "HTTP": "WEB", "MODBUS_TCP": "TCP", "BITS": "DATA_BITS", "DATABITS": "DATA_BITS",
}  # fmt: skip
MOST_SLAVES = 32  # on one line without a repeater, MODBUS over Serial Line V1.02 3.4.1
HOLD_MS = range(10_001)
LEAST_SPACE = 64 << 20  # bytes that a build needs


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


def mode_code(mode, bits):
    """Bits of the format code for MODE and DATA_BITS."""
    if mode not in ("rtu", "ascii"):
        raise BadVariable(f"MODE={mode}: must be rtu or ascii")
    if bits not in ("", "7", "8"):
        raise BadVariable(f"DATA_BITS={bits}: must be 7 or 8")
    if mode == "rtu":
        if bits == "7":
            raise BadVariable("DATA_BITS=7: RTU mode has characters of 8 bits")
        return 0
    return ASCII | (0 if bits == "8" else SEVEN_BITS)


def slave_addresses(text):
    """SLAVES, "17,18,20-24", as a list."""
    found = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*([0-9]{1,3})(?:-([0-9]{1,3}))?\s*", part)
        run = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
        if not run or run[0] not in ADDRESSES or run[-1] not in ADDRESSES:
            raise BadVariable(f"SLAVES={text}: must be addresses from 1 to 247, for example 17,18,20-24")
        found += run
    for address in found:
        if found.count(address) > 1:
            raise BadVariable(f"SLAVES={text}: {address} stands twice")
    if len(found) > MOST_SLAVES:
        raise BadVariable(f"SLAVES={text}: at most {MOST_SLAVES} slaves on a line")
    return found


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
    if not any(found.values()):
        raise BadVariable("MAP: a device needs a table that has items")
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


def check_port(port, named):
    """Refuse a PORT that is no serial port."""
    if "LINK" in named:
        raise BadVariable("PORT: a real port has no LINK, leave LINK out")
    try:
        mode = os.stat(port).st_mode
    except OSError as error:
        raise BadVariable(f"PORT={port}: {error.strerror}") from None
    if not stat.S_ISCHR(mode):
        raise BadVariable(f"PORT={port}: is no serial port")
    if not os.access(port, os.R_OK | os.W_OK):
        raise BadVariable(f"PORT={port}: no right to read and write it")


def compiled(top, values, files, folders):
    """Path of the bridge for a top module and its parameters, compiled now unless that was done before."""
    sim = ROOT / "sim"
    folders = [*folders, sim]  # the ports that all tops have
    model = models.Model(top, sim / "pins.cpp", files, folders, values, shared=False, apart=sim / "bridge.cpp")
    try:
        return models.compiled(model, lambda: say("compiling the device (10 to 30 s, once for each map and identity)"))
    except models.BuildError as error:
        cause = no_space() or f"the device does not compile: {error}"
    except OSError as error:
        cause = no_space() or f"the device cannot be compiled: {error.filename or models.CACHE}: {error.strerror}"
    raise SystemExit(f"serve: {cause}") from None


def no_space():
    """A line about a full disk, or an empty one."""
    for place in (models.CACHE, Path(os.environ.get("TMPDIR", "/tmp"))):
        while not place.exists():
            place = place.parent
        if shutil.disk_usage(place).free < LEAST_SPACE:
            return f"the device cannot be compiled: no space left in {place}"
    return ""


def say(text):
    """A line for people; standard output belongs to `ready`."""
    print(f"serve: {text}", file=sys.stderr, flush=True)


def descriptor(name, text):
    """A file without a name that holds `text`, open for the programs that are started."""
    fd = os.memfd_create(name, 0)
    os.write(fd, text.encode())
    os.lseek(fd, 0, os.SEEK_SET)
    return fd


def named_variables(given):
    """The variables that have a value, by name."""
    named = {}
    for word in given:
        name, _, value = word.strip().partition("=")
        if name not in DEFAULTS and name not in SERVER_VARIABLES:
            raise BadVariable(f"{name}: unknown variable")
        if value:
            named[name] = value
    for name in named.pop("GIVEN", "").split():  # on the command line of make
        check_name(name)
    return named


def check_name(name):
    """Refuse the name of a variable that is nearly one of ours."""
    known = [n for n in (*DEFAULTS, *SERVER_VARIABLES) if n not in NOT_FOR_PEOPLE]
    if name in known:
        return
    near = MISTAKEN.get(name.upper()) or next(iter(difflib.get_close_matches(name.upper(), known, 1, 0.75)), None)
    if near:
        raise BadVariable(f"{name}: unknown variable; {near} is meant?")


@dataclass
class Settings:
    """The line, as numbers of the core."""

    slaves: list
    baud: int
    format: int
    parity: str
    stop: int
    ascii: bool = False
    data_bits: int = 8

    @property
    def bit_clocks(self):
        """Clocks per bit."""
        return BIT_CLOCKS if self.baud <= FAST else FAST_BIT_CLOCKS

    def clock_hz(self, exact=True):
        """Of the model; not exact: as models of other rates may have it too."""
        return self.bit_clocks * (self.baud if exact else max(self.baud, SLOW))

    @property
    def code(self):
        """Format code that the bridge takes."""
        return self.format | ASCII * self.ascii | SEVEN_BITS * (self.data_bits == 7)

    def options(self):
        """Of the bridge."""
        return [
            *("--baud", str(self.baud), "--bit-time", str(self.bit_clocks), "--format", str(self.code)),
            *("--slaves", ",".join(map(str, self.slaves))),
        ]


def settings(values):
    """ADDRESS or SLAVES, BAUD, PARITY, STOP, MODE and DATA_BITS."""
    slaves = [number("ADDRESS", values["ADDRESS"], ADDRESSES)]
    if values["SLAVES"]:
        slaves = slave_addresses(values["SLAVES"])
    code = character_format(values["PARITY"], values["STOP"])
    stop = next(stop for (_, stop), other in FORMATS.items() if other == code)
    mode = mode_code(values["MODE"], values["DATA_BITS"])
    baud = number("BAUD", values["BAUD"], BAUDS)
    return Settings(slaves, baud, code, values["PARITY"], stop, bool(mode & ASCII), 7 if mode & SEVEN_BITS else 8)


@dataclass
class Started:
    """What it takes to start: the bridge, its options, initial contents, what the control server is told."""

    bridge: Path
    options: list
    items: list
    facts: dict


def line_facts(line, tables, files, map_facts=None):
    """What the control server is told of the device."""
    return {
        "address": line.slaves[0], "slaves": line.slaves, "baud": line.baud, "parity": line.parity, "stop": line.stop,
        "mode": "ascii" if line.ascii else "rtu", "data_bits": line.data_bits,
        "tables": tables, "files": files, "map": map_facts,
    }  # fmt: skip


def of_tables(values):
    """A device with MAP's tables, as Started."""
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
    if line.ascii and device == "pdm":
        raise BadVariable("MODE=ascii: the PDM meter has RTU mode alone, leave DEVICE=pdm out")
    timed = device == "user" or bool(values["PARAMETERS"]) or line.ascii  # something in it counts clocks
    model = {"CLK_HZ": line.clock_hz(exact=timed)} | model | table_parameters(place) | initial.parameters
    model |= {"ASCII_MODE": 1} if line.ascii else {}
    model |= parameters(values["PARAMETERS"])
    files, folders = filelist.read(ROOT, *filelist.ALL)
    files = [*(ROOT / name for name in files), ROOT / "sim" / f"{top}.v"]
    for text in initial.warnings:
        say(f"warning: INIT={values['INIT']}: {text}")
    bridge = compiled(top, model, files, [ROOT / name for name in folders])
    options = line.options() + (["--real-work", "1"] if device == "user" else [])
    for name, value in initial.inputs.items():
        options += [f"--{name.replace('_', '-')}", str(value)]
    tables = {name: [run.start, len(run)] for name, run in place.tables.items()}
    return Started(bridge, options, initial.items, line_facts(line, tables, list(place.files)))


def of_map(named):
    """The same of a device that a map file describes."""
    for name in ("DEVICE", "PARAMETERS"):
        if name in named:
            raise BadVariable(f"{name}: a map file is a device of its own, leave {name} out")
    if named.get("MODE", "rtu") != "rtu" or "DATA_BITS" in named:
        raise BadVariable("MODE: a device of a map file has RTU mode alone, leave MODE and DATA_BITS out")
    with map_device.built(named["MAP"], named.get("INIT", "")) as made:
        baud = made.facts["line"]["baud"]
        try:
            line = settings(DEFAULTS | made.defaults(named) | named)
        except BadVariable as error:
            from_map = "BAUD" not in named and str(error).startswith("BAUD")
            raise BadVariable(f"{error}; the map says {baud}, give another BAUD" if from_map else error) from None
        parameters = {"CLK_HZ": line.clock_hz()}
        if not made.run_time:
            if len(line.slaves) > 1:
                raise BadVariable("SLAVES: the map fixes the address; with run_time in its line there can be several")
            parameters |= {"ADDRESS": line.slaves[0], "BAUD": line.baud, "FORMAT": line.format}
        bridge = compiled(made.top, parameters, made.files, made.folders)
    options = line.options()
    for name, option in (("T15_MIN_US", "--t15-us"), ("T35_MIN_US", "--t35-us")):
        if name in made.facts["core"]:
            options += [option, str(made.core(name))]
    if delay := made.core("RESPONSE_DELAY"):
        options += ["--reply-bits", str(delay), "--real-work", "1"]
    return Started(bridge, options, made.items, line_facts(line, made.tables(), [0, 1], made.facts))


def start(given):
    """Check, compile, become the bridge. Returns only by an exception."""
    named = named_variables(given)
    values = DEFAULTS | named
    if "SLAVES" in named and "ADDRESS" in named:
        raise BadVariable("SLAVES: leave ADDRESS out")
    for name in ("TCP", "RTU_TCP"):
        if values["MODE"] == "ascii" and values[name]:
            raise BadVariable(f"{name}: needs MODE=rtu")
    hold = number("HOLD", values["HOLD"], HOLD_MS)
    armed = faults.parse(values["FAULT"])
    link = values["LINK"]
    if values["PORT"]:
        check_port(values["PORT"], named)
    else:
        check_link(link)
    served = {name: value for name, value in named.items() if name in SERVER_VARIABLES}
    if wrong := variables.wrong(served):
        raise BadVariable(wrong)
    if served.get("LOG") == "0":
        del served["LOG"]
    sockets = ways_in.sockets(values)
    made = of_map(named) if map_device.is_map(values["MAP"]) else of_tables(values)
    if values["PORT"]:
        arguments = [str(made.bridge), "--port", values["PORT"]]
    else:
        if check_link(link):
            os.unlink(link)
        arguments = [str(made.bridge), "--link", link]
    arguments += [*made.options, "--hold-ms", str(hold)]
    for fault in armed:
        arguments += ["--fault", fault]
    if made.items:
        arguments += ["--init-fd", str(descriptor("init", "".join(f"{s} {a} {v}\n" for s, a, v in made.items)))]
    if values["TRACE"]:
        arguments += ["--trace", values["TRACE"]]
    if values["DIE_WITH_PARENT"]:
        arguments += ["--die-with-parent"]
    if values["CONTROL_FD"]:  # the caller is the control server
        arguments += ["--control-fd", values["CONTROL_FD"]]
    elif sockets or served:
        facts = made.facts | {"link": values["PORT"] or link, "device": values["DEVICE"]}
        arguments += ["--control-fd", str(ways_in.start(sockets, served, descriptor("facts", json.dumps(facts))))]
    # Held back until the bridge listens for them, so that none is lost on the way.
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    os.execv(made.bridge, arguments)


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
