# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The JSON Schema (draft 2020-12) of the map file, made from its models: docs/map.schema.json."""

from __future__ import annotations

import json
from typing import Any

from modbus_map.file_model import DeviceFile

ADDRESS = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, Any]:
    """The schema."""
    made = DeviceFile.model_json_schema(by_alias=True)
    _tidy(made)
    return {"$schema": ADDRESS, "title": "Modbus device map", **{k: v for k, v in made.items() if k != "title"}}


def text() -> str:
    """The schema as a file."""
    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


def _tidy(node: Any) -> None:
    """Leave out titles that repeat the key, and the null that stands for a key that is not there."""
    if isinstance(node, dict):
        if isinstance(node.get("title"), str) and (
            "type" in node or "$ref" in node or "anyOf" in node or "enum" in node
        ):
            del node["title"]
        if isinstance(node.get("anyOf"), list):
            rest = [option for option in node["anyOf"] if option != {"type": "null"}]
            if len(rest) == 1 and len(rest) < len(node["anyOf"]):
                del node["anyOf"]
                node.update(rest[0])
        if node.get("default", 0) is None or node.get("default") == b"" or node.get("default") == "":
            node.pop("default", None)
        for value in node.values():
            _tidy(value)
    elif isinstance(node, list):
        for value in node:
            _tidy(value)
