# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""How late answers are beyond line time, with everything on that a device can have beside its line, and without."""

import contextlib
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest
from harness.volume import volume
from protocol import frames
from protocol.defs import FC

from .serve import Port, Serve, request
from .test_live import line_ms
from .timing import Watch
from .web import Device

MEDIAN_MS, BUSY_MS = 2, 1000
REGISTERS = 10
SCRIPT = """
INTERVAL = 0.05

def step(t, registers):
    registers.inputs[0] = int(20 * t) & 0xFFFF
"""


def latencies(link, baud, count):
    """(median, 99th percentile) in ms of what answers took beyond line time."""
    frame, size = request(frames.read(FC.READ_HOLDINGS, 0, REGISTERS)), 5 + 2 * REGISTERS
    found = []
    with Port(link) as port:
        for _ in range(count):
            time.sleep(0.01)
            begun = time.monotonic()
            answer = port.ask(frame, bytes(size))
            found.append(1000 * (time.monotonic() - begun) - line_ms(len(frame), size, baud))
            assert len(answer) == size
    found.sort()
    return statistics.median(found), found[99 * count // 100]


@contextlib.contextmanager
def panel(device):
    """A panel that is open, in a process of its own."""
    command = [sys.executable, str(Path(__file__).with_name("panels.py")), device.url, "1"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "open\n"
        yield
        process.stdin.close()
        assert json.loads(process.stdout.readline())[0] > 0


@pytest.mark.parametrize("baud", [9600, 19200, 115200])
def test_panel_script_and_log_do_not_delay_answers(tmp_path, baud, record_property):
    count = volume("answers that are timed")
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    with Watch() as watch:
        with Serve(tmp_path / "alone", BAUD=baud) as alone:
            without = latencies(alone.link, baud, count)
        with Device(tmp_path, BAUD=baud, LOG=1, SCRIPT=script) as made, panel(made):
            priority = os.sched_getscheduler(made.process.pid) == os.SCHED_RR
            with_all = latencies(made.link, baud, count)
    said = (
        f"live at {baud} baud: {with_all[0]:.2f} ms beyond line time, 99 % of {count} within {with_all[1]:.2f}, with "
        f"panel, script and log; {without[0]:.2f} and {without[1]:.2f} without them "
        f"({'with' if priority else 'no'} real-time priority, {watch})"
    )
    record_property("figures", [said])
    assert with_all[0] < watch.bound(MEDIAN_MS, BUSY_MS), said
