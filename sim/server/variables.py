# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""LOG, SIGNALS and SCRIPT of `make serve`, judged before anything starts."""

from __future__ import annotations

import os
from collections.abc import Mapping

from .errors import Refused
from .values import Signal, from_file

NAMES = ("LOG", "SIGNALS", "SCRIPT")


def wrong(values: Mapping[str, str]) -> str:
    """What is wrong with the variables, or an empty text."""
    if values.get("LOG", "1") not in ("0", "1"):
        return f"LOG={values['LOG']}: must be 0 or 1"
    if name := values.get("SCRIPT"):
        if not os.path.isfile(name) or not os.access(name, os.R_OK):
            return f"SCRIPT={name}: is no file that can be read"
    if name := values.get("SIGNALS"):
        try:
            for point, given in from_file(name).items():
                arguments = {key: value for key, value in given.items() if key != "kind"}
                try:
                    Signal(given["kind"], arguments)
                except Refused as error:
                    return f"SIGNALS={name}: {point}: {error}"
        except Refused as error:
            return f"SIGNALS={name}: {error}"
    return ""
