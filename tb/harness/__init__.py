# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What tests and tools share about Modbus RTU: definitions, frames, the model slave, the line.

Only `line` and `bench` need cocotb; everything else is plain Python.
"""
