# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The map compiler: one description of a device, everything made from it (docs/map.md)."""
