# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""How much each long test plays: in `make test`, and with FULL=1, which `make nightly` sets."""

import os

USUAL = {
    "random requests on the compiled slave": 15_000,
    "random requests on 32 compiled slaves": 300,
    "random requests in a simulator": 80,
    "slaves on one line in a simulator": 4,
    "requests to them": 6,
    "suites on gates": 0,
    "builds on gates": 2,
    "random maps": 60,
}
FULL = {
    "random requests on the compiled slave": 300_000,
    "random requests on 32 compiled slaves": 3_000,
    "random requests in a simulator": 300,
    "slaves on one line in a simulator": 8,
    "requests to them": 20,
    "suites on gates": 6,
    "builds on gates": 4,
    "random maps": 5_000,
}


def volume(what):
    """The size of a test, by its name in the tables above."""
    return (FULL if os.environ.get("FULL") == "1" else USUAL)[what]
