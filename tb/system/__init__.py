# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""cocotb tests of the whole slave, by topic; tb/test_system.py says which build runs which."""
