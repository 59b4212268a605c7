# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""YAML in, plain Python out, with the line and column of every key and item.

It builds the tree from the parser's events, by the core schema of YAML 1.2: `on`, `off` and `no` are texts, `01` is
1. Nothing but mappings, sequences and scalars is taken, so a file runs no code and opens no other file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError, YAMLStreamError
from ruamel.yaml.events import AliasEvent, DocumentStartEvent, MappingStartEvent, ScalarEvent, SequenceStartEvent
from ruamel.yaml.reader import ReaderError

from modbus_map.diagnostics import Diagnostic, MapError

MOST_BYTES = 4_000_000
MOST_DEPTH = 20
MOST_DIGITS = 400

Path_ = tuple[Any, ...]
Place = tuple[int, int]  # line and column, from 1


class Int(int):
    """An integer that knows how it was written."""

    text: str


class Float(float):
    """A float that knows how it was written."""

    text: str


@dataclass
class Source:
    """A map as plain Python, and where each of its items stands. A path is the keys and indexes that lead to it."""

    file: str  # as messages name it
    tree: Any
    keys: dict[Path_, Place] = field(default_factory=dict)  # where a key stands, or the item of a list
    values: dict[Path_, Place] = field(default_factory=dict)
    problems: list[Diagnostic] = field(default_factory=list)

    def place(self, path: Path_, key: bool = False) -> Place:
        """Line and column of the value at a path (of the key), or of the nearest thing around it."""
        marks = self.keys if key else self.values
        while path:
            if path in marks:
                return marks[path]
            path, marks = path[:-1], self.values
        return self.values.get((), (1, 1))

    def diagnostic(self, path: Path_, text: str, key: bool = False, warning: bool = False) -> Diagnostic:
        """A diagnostic at a path."""
        line, column = self.place(path, key)
        return Diagnostic(line, column, text, warning, self.file)


def read(path: str | Path, what: str = "map") -> str:
    """The text of a file; `what` it is, for messages. Raises MapError."""
    name = str(path)

    def wrong(text: str, line: int = 1, column: int = 1) -> MapError:
        return MapError([Diagnostic(line, column, text, file=name)])

    try:
        data = Path(path).read_bytes()
    except FileNotFoundError:
        raise wrong(f"no such file; name the {what} file") from None
    except IsADirectoryError:
        raise wrong(f"this is a folder; name the {what} file in it") from None
    except (OSError, ValueError) as error:
        raise wrong(f"the file cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(data) > MOST_BYTES:
        raise wrong(f"{len(data)} bytes are no {what} file; at most {MOST_BYTES} are read")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        line = before.count(b"\n") + 1
        column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8", "replace")) + 1
        raise wrong(f"byte {data[error.start]:02X} is no UTF-8; save the file as UTF-8", line, column) from None


def load(path: str | Path, what: str = "map") -> Source:
    """Read a map file (or `what`). Raises MapError for what is no YAML; the content is not checked."""
    return parse(read(path, what), str(path))


def parse(text: str, file: str) -> Source:
    """The same for a text. Problems that do not stop the parser (doubled keys) are in `problems`."""
    source = Source(file, None)
    builder = _Builder(source)
    try:
        builder.run(text)
    except ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        column = error.position - text.rfind("\n", 0, error.position)
        raise MapError(
            [*source.problems, Diagnostic(line, column, "control characters are not allowed; remove it", file=file)]
        ) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        if "quoted scalar" in str(error.context) and "end of" in str(error.problem):
            mark = error.context_mark  # where the quote begins, not the end of the file
        place = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        said = _explain(error, text, place)
        raise MapError([*source.problems, Diagnostic(*place, said, file=file)]) from None
    except (YAMLError, YAMLStreamError, ValueError, RecursionError) as error:
        said = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise MapError([*source.problems, Diagnostic(1, 1, f"no YAML: {said}", file=file)]) from None
    return source


def _explain(error: MarkedYAMLError, text: str, place: Place) -> str:
    lines = text.splitlines()
    line = lines[place[0] - 1] if place[0] <= len(lines) else ""
    problem = (error.problem or "it cannot be read").strip()
    if "\t" in line and (problem.startswith("found character") or "\t" in line[: place[1]]):
        return "a tab is no indentation in YAML; use spaces"
    if "expected ',' or '}'" in problem or "expected ',' or ']'" in problem:
        return f"no YAML: {problem}; close the bracket, or put a comma between the items"
    if "mapping values are not allowed" in problem:
        return "no YAML: a second `: ` in one line; indent it, or put the text in quotes"
    if "could not find expected ':'" in problem:
        return "no YAML: a key without a `: ` behind it; write `key: value`"
    if "while scanning a quoted scalar" in str(error.context):
        return "no YAML: the quote is never closed; put one at the end of the text"
    if "block mapping" in str(error.context) or "block collection" in str(error.context):
        return f"no YAML: {problem}; indent it like the items around it"
    return f"no YAML: {problem}; see yaml.org for the rules"


_NULL = re.compile(r"~|null|Null|NULL|")
_TRUE = re.compile(r"true|True|TRUE")
_FALSE = re.compile(r"false|False|FALSE")
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|[-+]?0x[0-9a-fA-F]+|[-+]?0b[01]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def scalar(text: str) -> Any:
    """A plain scalar by the core schema of YAML 1.2, and 0b101 beside 0x5."""
    if _NULL.fullmatch(text):
        return None
    if _TRUE.fullmatch(text):
        return True
    if _FALSE.fullmatch(text):
        return False
    if _INT.fullmatch(text) and len(text) <= MOST_DIGITS:
        body = text.lstrip("+-")
        base = {"0x": 16, "0o": 8, "0b": 2}.get(body[:2].lower(), 10)
        number = Int(int(body[2:] if base != 10 else body, base) * (-1 if text.startswith("-") else 1))
        number.text = text
        return number
    if _FLOAT.fullmatch(text):
        real = Float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
        real.text = text
        return real
    return text


class _Builder:
    """Events to a tree. A node that cannot be taken is left out and noted in the source's problems."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.depth = 0

    def run(self, text: str) -> None:
        yaml = YAML(typ="safe", pure=True)
        self.events = iter(yaml.parse(text))
        documents = 0
        for event in self.events:
            if isinstance(event, DocumentStartEvent):
                documents += 1
                if documents > 1:
                    self.note(event, "a second document begins here; a map file is one document")
                    return
            elif isinstance(event, (ScalarEvent, MappingStartEvent, SequenceStartEvent, AliasEvent)):
                self.source.tree = self.node(event, ())

    def note(self, event: Any, text: str) -> None:
        mark = event.start_mark
        self.source.problems.append(Diagnostic(mark.line + 1, mark.column + 1, text, file=self.source.file))

    def node(self, event: Any, path: Path_) -> Any:
        place = (event.start_mark.line + 1, event.start_mark.column + 1)
        self.source.values[path] = place
        if isinstance(event, AliasEvent):
            self.note(event, f"*{event.anchor}: a map file has no aliases; write the item out")
            return None
        if event.anchor:
            self.note(event, f"&{event.anchor}: a map file has no anchors; leave it out and write the items out")
        if event.tag and str(event.tag) not in ("!", "tag:yaml.org,2002:str"):
            self.note(event, f"{event.tag}: a map file has no tags; leave it out")
        self.depth += 1
        if self.depth > MOST_DEPTH:
            mark = Diagnostic(*place, f"nested deeper than {MOST_DEPTH}; a map is flat", file=self.source.file)
            raise MapError([*self.source.problems, mark])
        if isinstance(event, MappingStartEvent):
            made: Any = self.mapping(path)
        elif isinstance(event, SequenceStartEvent):
            made = self.sequence(path)
        else:
            plain = event.style is None and not (event.tag and str(event.tag) != "!")
            made = scalar(event.value) if plain else event.value
        self.depth -= 1
        return made

    def mapping(self, path: Path_) -> dict[Any, Any]:
        made: dict[Any, Any] = {}
        while True:
            event = next(self.events)
            if not isinstance(event, (ScalarEvent, MappingStartEvent, SequenceStartEvent, AliasEvent)):
                return made
            if not isinstance(event, ScalarEvent):
                self.note(event, "a key must be a word or a number")
                self.node(event, (*path, "?"))
                self.node(next(self.events), (*path, "?"))
                continue
            place = (event.start_mark.line + 1, event.start_mark.column + 1)
            key = scalar(event.value) if event.style is None else event.value
            if isinstance(key, float) or key is None or isinstance(key, bool):
                key = event.value
            if key == "<<" and event.style is None:
                self.note(event, "<<: a map file has no merge keys; write the items out")
            child = (*path, key)
            if key in made:
                line = self.source.keys[child][0]
                self.note(
                    event, f"{event.value} is here for the second time; the first is in line {line}, leave one out"
                )
                self.node(next(self.events), (*path, "?"))
                continue
            self.source.keys[child] = place
            made[key] = self.node(next(self.events), child)

    def sequence(self, path: Path_) -> list[Any]:
        made: list[Any] = []
        while True:
            event = next(self.events)
            if not isinstance(event, (ScalarEvent, MappingStartEvent, SequenceStartEvent, AliasEvent)):
                return made
            child = (*path, len(made))
            self.source.keys[child] = (event.start_mark.line + 1, event.start_mark.column + 1)
            made.append(self.node(event, child))
