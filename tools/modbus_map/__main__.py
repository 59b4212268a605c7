# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`python -m modbus_map map build ...` is `tools/modbus map build ...`."""

import sys

from modbus_map.cli import main

sys.exit(main())
