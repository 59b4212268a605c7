# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The live device of `make serve`, as its users meet it."""
