# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""How much each long test plays: in `make test`, and with FULL=1, which `make nightly` sets."""

import os

USUAL = {
    "random requests on the compiled slave": 500,
    "random requests on 32 compiled slaves": 150,
    "bits at every alignment": 250,
    "random requests in a simulator": 15,
    "random requests to the power meter": 20,
    "random writes to overlaid tables": 6,
    "blocks rewritten beside a reading CPU": 5,
    "requests beside a reading CPU": 2,
    "blocks rewritten beside a host": 8,
    "blocks beside a host's accesses": 2,
    "frames beside a reading host": 7,
    "slaves on one line in a simulator": 2,
    "requests to them": 3,
    "blocks written to flat vectors": 2,
    "percent of the sets of parameters in Verilator": 5,
    "random maps": 12,
    "plays of a map with every kind of point": 12,
    "random starts of the automatic line": 36,
    "changes of the rate": 12,
    "frame times of noise": 1_000,
    "random maps in Icarus": 1,
    "rounds with several units": 2,
    "seconds that 32 live devices are polled": 2,
    "reopened clients": 40,
    "connections at once": 300,
    "live devices": 4,
    "seconds of live devices": 3,
    "soak requests": 400,
    "answers that are timed": 40,
}
FULL = {
    "random requests on the compiled slave": 100_000,
    "random requests on 32 compiled slaves": 3_000,
    "bits at every alignment": 20_000,
    "random requests in a simulator": 300,
    "random requests to the power meter": 60,
    "random writes to overlaid tables": 16,
    "blocks rewritten beside a reading CPU": 12,
    "requests beside a reading CPU": 8,
    "blocks rewritten beside a host": 24,
    "blocks beside a host's accesses": 6,
    "frames beside a reading host": 18,
    "slaves on one line in a simulator": 8,
    "requests to them": 20,
    "blocks written to flat vectors": 6,
    "percent of the sets of parameters in Verilator": 100,
    "random maps": 2_000,
    "plays of a map with every kind of point": 200,
    "random starts of the automatic line": 10_000,
    "changes of the rate": 1_000,
    "frame times of noise": 1_000_000,
    "random maps in Icarus": 6,
    "rounds with several units": 40,
    "seconds that 32 live devices are polled": 60,
    "reopened clients": 4_000,
    "connections at once": 1_000,
    "live devices": 32,
    "seconds of live devices": 30,
    "soak requests": 100_000,
    "answers that are timed": 1_000,
}


IS_FULL = os.environ.get("FULL") == "1"
QUICK = "-Og"  # what compiles in half the time: most models of a test run shorter than -O3 takes to compile


def volume(what):
    """The size of a test, by its name in the tables above."""
    return (FULL if IS_FULL else USUAL)[what]
