# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the RTL and in the map compiler, by rooms, and what is tried against them.

tools/plant.py plants them. Each is a search and replace in one file, and its text must stand there once.
"""

from . import ascii as ascii_mode
from . import bank, bus, core, engine, examples, line, map
from .kinds import Mistake

MISTAKES = [mistake for room in (line, ascii_mode, engine, bank, bus, examples, core, map) for mistake in room.MISTAKES]

__all__ = ["MISTAKES", "Mistake"]
