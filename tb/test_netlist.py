# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The slave as gates of an iCE40 (Yosys synth_ice40), in Icarus, at its ports: what `make synth` measures is right.

No input is tied, the parameters are those of the profiles of tools/synth.py, but for the floors of t1.5 and t3.5:
none, or in a short time. Gates simulate 60 to 100 characters a second, so the usual run plays a selection and
FULL=1 some suites more; GATES=1 plays everything that needs no more than the ports, which takes hours.
"""

import os

import pytest
from conftest import FULL
from harness.build import NO_FLOORS
from harness.runner import run
from synth import PROFILES
from test_system import IO, SLAVE, SUITES

SHORT_FLOORS = {"CLK_HZ": 250_000}  # 187 and 437 clocks: a little more than 1.5 and 3.5 characters of 8 clocks a bit


def profile(name, bank, **more):
    """The build of a profile, for its model too: {parameter: integer}."""
    parameters, _ = PROFILES[name][bank]
    return {k: int(v.split("'h")[1], 16) if "'h" in v else int(v) for k, v in parameters.items()} | more


BUILDS = {
    "basic_ram": (SLAVE, profile("basic", "ram", **NO_FLOORS)),
    "basic_io": (IO, profile("basic", "io", **SHORT_FLOORS)),
    "full_ram": (SLAVE, profile("full", "ram", **NO_FLOORS)),
    "full_io": (IO, profile("full", "io", **NO_FLOORS)),
}
CHOSEN = dict.fromkeys(BUILDS) if FULL else {"basic_ram": "broadcast"}  # build: tests of smoke


@pytest.mark.parametrize("build", CHOSEN)
def test_netlist(record_property, build):
    top, parameters = BUILDS[build]
    own = f"netlist_{build}"
    run(record_property, "icarus", top, "system.smoke", parameters, only=CHOSEN[build], own=own, netlist=True)


@pytest.mark.parametrize("build", CHOSEN)
def test_power_up(record_property, build):
    """With rst_i at 0 throughout; test_system.py does the same to the RTL."""
    top, parameters = BUILDS[build]
    own = f"netlist_power_up_{build}"
    run(record_property, "icarus", top, "system.power_up", parameters, only="without_a_reset", own=own, netlist=True)


# Suites of test_system.py that no netlist plays.
LARGER_THAN_AN_ICE40 = ("functions_whole", "fifo_whole", "files_long")
INSIDE = {"diagnostics_counters": "^(?!.*counters_wrap)"}  # loads counters: the tests that do without
BASIC = {  # what the profile `basic` has something for
    "basic_ram": ("functions", "options", "line_faults"),
    "basic_io": ("functions", "io_bank"),
}
SUITES_ON_GATES = {
    **{
        name: (top, parameters, module, INSIDE.get(name, only))
        for name, (top, parameters, module, only) in SUITES.items()
        if top in (SLAVE, IO) and name not in LARGER_THAN_AN_ICE40
    },
    **{f"{build}_{module}": (*BUILDS[build], module, None) for build, modules in BASIC.items() for module in modules},
}

IN_FULL = ("fifo", "files_ten", "identity_82", "io_read_only", "left_out_only_08", "functions_limited")
GATES = tuple(SUITES_ON_GATES) if os.environ.get("GATES") == "1" else IN_FULL if FULL else ()


if GATES:

    @pytest.mark.parametrize("suite", GATES)
    def test_system_on_gates(record_property, suite, seed):
        top, parameters, module, only = SUITES_ON_GATES[suite]
        env, own = {"BENCH_SEED": str(seed)}, f"gates_{suite}"
        run(record_property, "icarus", top, f"system.{module}", parameters, env, only, own, netlist=True)
