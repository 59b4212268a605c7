# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the core and the tops, which join the rooms."""

MISTAKES = []
