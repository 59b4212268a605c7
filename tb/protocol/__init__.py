# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The protocol in Python, without signals: frames, definitions, reference model, words for people.

The bench, the live device and its demonstration share it; it imports nothing outside the standard library.
"""
