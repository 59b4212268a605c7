# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What is wrong with a map, with the place where it is: one line each."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field


@dataclass(frozen=True, order=True)
class Diagnostic:
    """One line for the user. Lines and columns count from 1."""

    line: int
    column: int
    text: str
    warning: bool = False
    file: str = field(default="", compare=False)

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}: {'warning: ' if self.warning else ''}{self.text}"


class MapError(Exception):
    """The map cannot be used; `diagnostics` says why, errors and warnings in the order of the file."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = sorted(set(diagnostics))
        super().__init__("\n".join(map(str, self.diagnostics)))


def nearest(word: str, known: Iterable[str]) -> str:
    """`did you mean x?` for a mistyped word, else the list of all."""
    known = list(known)
    found = difflib.get_close_matches(word.lower(), [name.lower() for name in known], 1, 0.6)
    if found:
        return f"did you mean {next(name for name in known if name.lower() == found[0])}?"
    return f"known are {', '.join(known)}" if known else "none is known here"
