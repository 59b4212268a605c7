# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What docs/timing.md says: a device to measure, the figures, the pictures."""
