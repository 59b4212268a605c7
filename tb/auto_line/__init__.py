# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A slave that finds rate and format by itself (examples/modbus_example_auto.v), compiled, against any master."""
