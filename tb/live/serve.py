# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Starts `make serve` and speaks raw frames to it."""

import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time
import tty
from pathlib import Path

from protocol import frames

ROOT = Path(__file__).resolve().parents[2]
START_SECONDS = 240  # the first start of a map or an identity compiles it
VARIABLES = (
    *("DEVICE", "LINK", "PORT", "ADDRESS", "SLAVES", "BAUD", "PARITY", "STOP", "INIT", "MAP", "TRACE", "HOLD", "FAULT"),
    *("WEB", "TCP", "RTU_TCP", "MODE", "DATA_BITS"),
)


def command(**variables):
    """(argv, environment) of `make serve` with these variables and no inherited ones."""
    env = {k: v for k, v in os.environ.items() if k not in (*VARIABLES, "MAKEFLAGS", "MAKELEVEL", "RTL", "MFLAGS")}
    return ["make", "serve", *[f"{name}={value}" for name, value in variables.items()]], env


def refuse(with_make=True, **variables):
    """Run `make serve`, or serve.py alone, that must not start: (exit status, stderr lines other than make's own)."""
    argv, env = command(**variables)
    if not with_make:
        argv = [sys.executable, "sim/serve.py", *argv[2:]]
    done = subprocess.run(argv, cwd=ROOT, env=env, capture_output=True, text=True, timeout=60, check=False)
    lines = [s for s in done.stderr.splitlines() if s.strip() and not s.startswith(("make", "[setup]"))]
    assert not any(s.startswith("ready ") for s in done.stdout.splitlines()), done.stdout
    return done.returncode, lines


def free_port():
    """A port of the loopback that nobody has."""
    with socket.socket() as made:
        made.bind(("127.0.0.1", 0))
        return made.getsockname()[1]


class Serve:
    """A running device; a context manager. `link` is where it listens."""

    def __init__(self, link, **variables):
        self.link, self.variables = Path(link), {"LINK": str(link), **variables}
        self.baud = int(variables.get("BAUD", 19200))
        self.log = self.link.with_suffix(".log")
        if "PORT" in variables:  # beside a device file nothing can be written
            self.log = Path(tempfile.mkdtemp(prefix="live.")) / "port.log"

    def __enter__(self):
        argv, env = command(**self.variables)
        with self.log.open("w", encoding="utf-8") as log:
            self.process = subprocess.Popen(argv, cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=log)
        deadline, seen = time.monotonic() + START_SECONDS, b""
        ready = f"ready {self.link}".encode()
        while ready not in seen.splitlines():
            assert time.monotonic() < deadline, f"no `{ready.decode()}`: {seen!r}, {self.stderr()}"
            if select.select([self.process.stdout], [], [], 1)[0]:
                more = os.read(self.process.stdout.fileno(), 4096)
                assert more, f"make serve ended: {seen!r} {self.stderr()}"
                seen += more
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self.process.stdout.close()

    def stderr(self):
        """What the device has said so far."""
        return self.log.read_text(encoding="utf-8")

    def stop(self, number):
        """Send a signal; (exit status, seconds it took)."""
        begun = time.monotonic()
        self.process.send_signal(number)
        status = self.process.wait(10)
        return status, time.monotonic() - begun


class Port:
    """The raw byte side of a device's terminal."""

    def __init__(self, link):
        self.file = os.open(link, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        termios.tcflush(self.file, termios.TCIOFLUSH)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.file)

    def write(self, data):
        """All of `data`, however slowly it goes."""
        data = memoryview(bytes(data))
        while data:
            data = data[os.write(self.file, data) :]

    def read(self, seconds, count=1):
        """Bytes until `count` are there or `seconds` have passed."""
        deadline, out = time.monotonic() + seconds, b""
        while len(out) < count:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.file], [], [], left)[0]:
                break
            out += os.read(self.file, 1024)
        return out

    def ask(self, frame, expected, seconds=5.0):
        """Send `frame`; the answer, as long as `expected` if it comes in time."""
        self.write(frame)
        return self.read(seconds, len(expected))


def request(pdu, address=17):
    """A request frame for the default address."""
    return frames.adu(address, pdu)
