# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Characters on the line."""

from collections import namedtuple

# One character on the line: `gap` is the silence before it in character times, `error` is
# None, "parity" or "framing".
Character = namedtuple("Character", "byte gap error", defaults=(0.0, None))


def characters(line):
    """Any mix of bytes and (byte, gap, error) tuples as a list of Character."""
    return [Character(c) if isinstance(c, int) else Character(*c) for c in line]
