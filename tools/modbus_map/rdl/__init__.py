# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""SystemRDL: the properties, the importer, and both as plugins of PeakRDL (peakrdl.toml)."""
