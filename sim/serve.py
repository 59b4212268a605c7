#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Start the live device: check the variables, compile the model they need, become the bridge.

    serve.py [NAME=VALUE]...        names: see README.md beside this file

Exit status: 0 after SIGINT or SIGTERM, 2 for a bad variable, 1 if the model does not compile.
Needs Python's standard library only, so that `make serve` needs no virtual environment.
"""

import contextlib
import fcntl
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / "build" / "live"
TOP = "modbus_live"

CLOCK_HZ = 1_843_200  # divides 9600 to 115200 baud without rest, and 2 cores simulate it in passing
BIT_TIMES = range(8, 65536)  # clock cycles per bit that the core takes
ADDRESSES = range(1, 248)
ITEMS = 65536  # items a table can have

# Table: space on the bus, parameter prefix, items in the reference map, range of values
TABLES = {
    "coils": (0, "COIL", 1024, range(2)),
    "discretes": (1, "DISCRETE", 2048, range(2)),
    "inputs": (2, "INPUT", 1024, range(65536)),
    "holdings": (3, "HOLDING", 2048, range(65536)),
}
FILES, RECORDS = range(1, 5), range(256)
NUMBERS = {"exception_status": range(256), "busy": range(2), "run_indicator": range(2)}
FORMATS = {("even", 1): 0, ("odd", 1): 1, ("none", 2): 2, ("none", 1): 3}

DEFAULTS = {
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


class BadVariable(Exception):
    """What to print before ending with status 2."""


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


def tables(text):
    """MAP as {table: range of addresses}."""
    if not text.strip():
        return {name: range(count) for name, (_, _, count, _) in TABLES.items()}
    found = {name: range(0) for name in TABLES}
    named = set()
    for word in text.split():
        match = re.fullmatch(r"([a-z]+)=([0-9]{1,5})\+([0-9]{1,5})", word)
        if not match or match[1] not in TABLES:
            raise BadVariable(f"MAP: {word}: must be table=base+size, table one of {', '.join(TABLES)}")
        name, base, size = match[1], int(match[2]), int(match[3])
        if name in named:
            raise BadVariable(f"MAP: {name} is named twice")
        if base >= ITEMS or base + size > ITEMS:
            raise BadVariable(f"MAP: {word}: goes past address {ITEMS - 1}")
        named.add(name)
        found[name] = range(base, base + size)
    return found


def parameters(text):
    """Further parameters of the core, "NAME=number ...": for tests of other builds."""
    found = {}
    for word in text.split():
        match = re.fullmatch(r"([A-Z][A-Z0-9_]*)=([0-9]+)", word)
        if not match:
            raise BadVariable(f"PARAMETERS: {word}: must be NAME=number")
        found[match[1]] = match[2]
    return found


def no_duplicates(pairs):
    """JSON objects in which a key stands twice are refused: one of the values would be lost."""
    keys = [key for key, _ in pairs]
    for key in keys:
        if keys.count(key) > 1:
            raise BadVariable(f'key "{key}" stands twice')
    return dict(pairs)


def is_integer(value):
    """JSON true and 1.0 are no numbers of ours."""
    return isinstance(value, int) and not isinstance(value, bool)


def runs(where, entry, addresses, values):
    """{"start": [values]} checked against a range of addresses and of values, as (address, value)."""
    if not isinstance(entry, dict):
        raise BadVariable(f'{where}: must be {{"start address": [values]}}')
    for start, run in entry.items():
        if not re.fullmatch(r"[0-9]{1,5}", start):
            raise BadVariable(f"{where}: {start!r} is no address")
        if not isinstance(run, list):
            raise BadVariable(f"{where} {start}: must be a list of values")
        for address, value in enumerate(run, int(start)):
            if address not in addresses:
                raise BadVariable(f"{where}: address {address} is outside the table ({extent(addresses)})")
            if not is_integer(value) or value not in values:
                raise BadVariable(f"{where} {address}: {json.dumps(value)} is no number from 0 to {values[-1]}")
            yield address, value


def extent(addresses):
    """A range of addresses for people."""
    return f"{addresses[0]} to {addresses[-1]}" if addresses else "no items"


def initial(path, layout):
    """INIT as ([(space, address, value)], {name: number})."""
    try:
        document = json.loads(Path(path).read_bytes(), object_pairs_hook=no_duplicates)
    except OSError as error:
        raise BadVariable(error.strerror) from None
    except (ValueError, RecursionError) as error:
        raise BadVariable(f"not JSON: {error}") from None
    if not isinstance(document, dict):
        raise BadVariable("must be a JSON object")
    items, numbers = [], {}
    for key, entry in document.items():
        if key in TABLES:
            space, values = TABLES[key][0], TABLES[key][3]
            items += [(space, *item) for item in runs(key, entry, layout[key], values)]
        elif key == "files":
            check_files(entry)
        elif key in NUMBERS:
            if not is_integer(entry) or entry not in NUMBERS[key]:
                raise BadVariable(f"{key}: must be a number from 0 to {NUMBERS[key][-1]}")
            numbers[key] = entry
        else:
            raise BadVariable(f'unknown key "{key}"')
    return items, numbers


def check_files(entry):
    """File records are checked and left: the core has no function for them yet."""
    if not isinstance(entry, dict):
        raise BadVariable('files: must be {"file": {"first record": [values]}}')
    for file, records in entry.items():
        if not re.fullmatch(r"[0-9]{1,5}", file) or int(file) not in FILES:
            raise BadVariable(f"files: {file!r} is no file from 1 to {FILES[-1]}")
        list(runs(f"files {file}", records, RECORDS, range(65536)))


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


def sources():
    """Arguments from rtl/modbus.f, and every file they can draw in."""
    listed = (ROOT / "rtl" / "modbus.f").read_text().split()
    files = [ROOT / name for name in listed if not name.startswith(("+", "-"))]
    own = [ROOT / "sim" / "modbus_live.v", ROOT / "sim" / "bridge.cpp"]
    return sorted({*files, *(ROOT / "rtl").glob("*.vh"), *own})


def compiled(values):
    """Path of the bridge for these core parameters, compiled now unless that was done before."""
    command = [
        *("verilator", "--cc", "--exe", "--build", "-j", "2", "-O3", "-Wno-fatal"),
        *("--language", "1364-2005", "--x-assign", "fast", "--x-initial", "fast", "--noassert"),
        *("--top-module", TOP, "--prefix", "Vslave", "-o", "bridge"),
        *("-MAKEFLAGS", "OPT_FAST=-O3", "-CFLAGS", f"-std=c++17 -DCLOCK_HZ={CLOCK_HZ}"),
        *("-f", "rtl/modbus.f", "sim/modbus_live.v", str(ROOT / "sim" / "bridge.cpp")),
        *(f"-G{name}={value}" for name, value in values.items()),
    ]
    digest = hashlib.sha256(" ".join(command).encode())
    for path in sources():
        digest.update(path.read_bytes())
    key = digest.hexdigest()[:12]
    bridge = CACHE / key / "bridge"
    CACHE.mkdir(parents=True, exist_ok=True)
    with open(CACHE / f"{key}.lock", "w") as lock:  # two devices may start at the same moment
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not bridge.exists():
            build(command, CACHE / f"{key}.tmp", bridge)
    return bridge


def build(command, folder, bridge):
    """Run Verilator and the C++ compiler in `folder`; only the finished program reaches `bridge`."""
    say("compiling the device (10 to 30 s, once for each map)")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    log = folder / "build.log"
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    if shutil.which("ccache"):
        environment["OBJCACHE"] = "ccache"
    with open(log, "wb") as out:
        try:
            process = subprocess.Popen(
                [*command, "-Mdir", str(folder.relative_to(ROOT))],
                cwd=ROOT,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except FileNotFoundError:
            raise SystemExit("serve: verilator is not installed") from None
        try:
            status = process.wait()
        except BaseException:  # ended by a signal: the compilers end too
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            shutil.rmtree(folder, ignore_errors=True)
            raise
    if status or not (folder / "bridge").exists():
        sys.stderr.write(log.read_text(errors="replace")[-4000:])
        raise SystemExit("serve: the device does not compile")
    bridge.parent.mkdir(exist_ok=True)
    os.replace(folder / "bridge", bridge)
    shutil.rmtree(folder)


def say(text):
    """A line for people; standard output belongs to `ready`."""
    print(f"serve: {text}", file=sys.stderr, flush=True)


def init_descriptor(items):
    """The initial contents as a file without a name, open for the bridge."""
    fd = os.memfd_create("init", 0)
    os.write(fd, "".join(f"{s} {a} {v}\n" for s, a, v in items).encode())
    os.lseek(fd, 0, os.SEEK_SET)
    return fd


def start(given):
    """Check, compile, become the bridge. Returns only by an exception."""
    values = dict(DEFAULTS)
    for word in given:
        name, _, value = word.strip().partition("=")
        if name not in values:
            raise BadVariable(f"{name}: unknown variable")
        values[name] = value or values[name]

    address = number("ADDRESS", values["ADDRESS"], ADDRESSES)
    baud, cycles = bit_time(values["BAUD"])
    code = character_format(values["PARITY"], values["STOP"])
    layout = tables(values["MAP"])
    model = {"CLK_HZ": CLOCK_HZ}
    for name, (_, prefix, _, _) in TABLES.items():
        model |= {f"{prefix}_BASE": layout[name].start, f"{prefix}_COUNT": len(layout[name])}
    model |= parameters(values["PARAMETERS"])
    items, numbers = [], {}
    if values["INIT"]:
        try:
            items, numbers = initial(values["INIT"], layout)
        except BadVariable as error:
            raise BadVariable(f"INIT={values['INIT']}: {error}") from None
    link = values["LINK"]
    check_link(link)

    bridge = compiled(model)
    if check_link(link):
        os.unlink(link)
    arguments = [
        str(bridge),
        *("--link", link, "--baud", str(baud), "--bit-time", str(cycles), "--format", str(code)),
        *("--address", str(address), "--busy", str(numbers.get("busy", 0))),
    ]
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
