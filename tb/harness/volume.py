# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""How much each long test plays: in `make test`, and with FULL=1, which `make nightly` sets."""

import os

USUAL = {
    "random requests on the compiled slave": 5_000,
    "random requests on 32 compiled slaves": 150,
    "random requests in a simulator": 40,
    "random requests to the power meter": 20,
    "random writes to overlaid tables": 6,
    "blocks rewritten beside a reading CPU": 5,
    "requests beside a reading CPU": 3,
    "slaves on one line in a simulator": 4,
    "requests to them": 6,
    "suites on gates": 0,
    "builds on gates": 2,
    "random maps": 60,
    "random starts of the automatic line": 72,
    "changes of the rate": 30,
    "frame times of noise": 4_000,
}
FULL = {
    "random requests on the compiled slave": 100_000,
    "random requests on 32 compiled slaves": 3_000,
    "random requests in a simulator": 300,
    "random requests to the power meter": 60,
    "random writes to overlaid tables": 16,
    "blocks rewritten beside a reading CPU": 12,
    "requests beside a reading CPU": 8,
    "slaves on one line in a simulator": 8,
    "requests to them": 20,
    "suites on gates": 6,
    "builds on gates": 4,
    "random maps": 5_000,
    "random starts of the automatic line": 10_000,
    "changes of the rate": 1_000,
    "frame times of noise": 1_000_000,
}


def volume(what):
    """The size of a test, by its name in the tables above."""
    return (FULL if os.environ.get("FULL") == "1" else USUAL)[what]
