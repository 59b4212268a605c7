# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A live device with its control interface, and the system's Chromium."""

import contextlib
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from live_client import Live

from .serve import ROOT, free_port

START_S = 300  # the first start of a map compiles it
CHROMIUM = shutil.which("chromium")
CHROMIUM_OPTIONS = ["--no-sandbox", "--disable-dev-shm-usage"]  # in containers too; it opens our own pages only
needs_chromium = pytest.mark.skipif(not CHROMIUM, reason="chromium is not installed")


class Device:
    """`serve.py` with WEB on a free port; a context manager. `client` speaks to it, `log` is what it said."""

    def __init__(self, folder, web=True, **variables):
        self.link = folder / "modbus"
        self.port = free_port()
        self.log = folder / "serve.log"
        self.variables = {"LINK": str(self.link), **({"WEB": self.port} if web else {}), **variables}
        self.url = f"http://127.0.0.1:{self.port}"
        self.client = Live(self.url)

    def __enter__(self):
        command = [sys.executable, str(ROOT / "sim" / "serve.py"), "DIE_WITH_PARENT=yes"]
        command += [f"{name}={value}" for name, value in self.variables.items()]
        with self.log.open("w", encoding="utf-8") as log:
            self.process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=log, text=True)
        late = threading.Timer(START_S, self.process.kill)
        late.start()
        line = self.process.stdout.readline()
        late.cancel()
        assert line == f"ready {self.link}\n", f"{line!r}: {self.said()}"
        if "WEB" in self.variables:
            self.until(lambda: "panel at" in self.said(), "no panel")
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(5)
            self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def said(self):
        """Standard error so far."""
        return self.log.read_text(encoding="utf-8")

    def until(self, good, what, seconds=20):
        """Wait for something to become true."""
        deadline = time.monotonic() + seconds
        while not good():
            assert time.monotonic() < deadline, f"{what}: {self.said()[-2000:]}"
            time.sleep(0.05)

    def server(self):
        """The process identifier of the server, a child of the device."""
        found = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        return next(int(pid) for pid in found if b"control_server" in Path(f"/proc/{pid}/cmdline").read_bytes())


@contextlib.contextmanager
def browser():
    """Chromium without a window, driven by playwright."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        made = play.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_OPTIONS)
        yield made
        made.close()


@contextlib.contextmanager
def page(chromium, url, **options):
    """A page whose scripts must raise nothing."""
    made = chromium.new_page(bypass_csp=True, **options)  # playwright waits by eval, which the panel forbids
    raised = []
    made.on("pageerror", lambda error: raised.append(str(error)))
    made.goto(url)
    made.wait_for_selector("#lights .good")
    yield made
    made.close()
    assert not raised, raised
