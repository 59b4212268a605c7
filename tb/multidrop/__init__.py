# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many slaves on one line: bench, bus and tests."""
