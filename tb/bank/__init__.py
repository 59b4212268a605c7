# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Tests of rtl/bank, module by module; tb/test_modules.py runs them."""
