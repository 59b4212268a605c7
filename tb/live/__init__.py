# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The live device of `make serve`, as its users meet it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "sim"))
