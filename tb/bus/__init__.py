# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""cocotb tests of the bus sides, with cocotbext-axi and -wishbone; tb/test_buses.py says which build runs which."""
