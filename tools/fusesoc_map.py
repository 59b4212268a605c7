#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The generator of modbus_rtu_slave.core: FuseSoC gives it one file, `modbus map fusesoc` does the rest."""

import os
import sys
from pathlib import Path

tool = str(Path(__file__).resolve().parent / "modbus")
os.execv(sys.executable, [sys.executable, tool, "map", "fusesoc", *sys.argv[1:]])
