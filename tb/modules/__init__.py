# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""cocotb tests of single modules; tb/test_modules.py runs them."""
