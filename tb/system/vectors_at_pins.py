# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Every printed example at the pins with RTU timing: answer, memory, counters, log, mode afterwards."""

import cocotb
from harness import bench, build
from harness.readout import LAST_ACTION_CLOCKS, named
from protocol import frames, vectors
from protocol.defs import LONGEST_FRAME, OVERRUN_FLAG, RECEIVED, RECEIVED_ERROR

BUILT = build.model_config(bench.TOP, bench.PARAMETERS)
LIMITS_BUILT = {
    field: bench.PARAMETERS[name] for name, field in build.LIMIT_PARAMETERS.items() if name in bench.PARAMETERS
}
IDENTITY = ("server_id", "additional_data", "objects", "conformity", "device_id_limit")


def at_the_ports(vector):
    """True if nothing must be loaded inside the device before it."""
    steps = (*vectors.before(vector), vector)
    overrun = any(vectors.state(s["preconditions"]).get("diagnostic_register", 0) & OVERRUN_FLAG for s in steps)
    return not overrun and not any(map(vectors.needs_backdoor, steps))


def belongs(vector):
    """An example that needs other limits or another identity belongs to the build that has them."""
    if bench.PORTS_ONLY and not at_the_ports(vector):
        return False
    wanted, presumed = vectors.limits(vector), vectors.config(vector)
    identity = all(getattr(BUILT, name) == getattr(presumed, name) for name in IDENTITY)
    return identity and bool(wanted) == bool(LIMITS_BUILT) and wanted.items() <= LIMITS_BUILT.items()


CASES = {v["id"]: v for v in vectors.playable() if belongs(v)}


async def prepare(tb, vector):
    """Bring device and model into the state that the example presumes; returns what the log holds beyond it."""
    for key, value in vectors.contents(vector["preconditions"], tb.slave.config.files[1]):
        await tb.preset(key, value)
    state = vectors.state(vector["preconditions"])
    tb.apply(**{name: state[name] for name in vectors.INPUTS if name in state})
    register = state.get("diagnostic_register", 0)
    tb.apply(diagnostic=register & ~OVERRUN_FLAG)
    await tb.clocks(2)
    tb.apply(diagnostic=0)
    if register & OVERRUN_FLAG:
        await tb.both(bytes(LONGEST_FRAME + 1))
    if "event_log" in state:
        await make_log(tb, state["event_log"])
    if vectors.needs_backdoor(vector) or register & OVERRUN_FLAG:
        await tb.load_counters(**{name: state.get("counters", {}).get(name, 0) for name in tb.slave.counters})
    await tb.compare_counters(vector["id"])
    return [] if "event_log" in state else list(tb.slave.log)


async def make_log(tb, events):
    """A log of one event that no traffic makes on top of a restart; newest first."""
    newest, restarted = events
    await tb.both(frames.adu(tb.setup.address, frames.restart(clear_log=True)))
    await tb.both(bytes(2))
    assert not restarted and tb.slave.log == [RECEIVED | RECEIVED_ERROR, restarted]
    await tb.forge_event(RECEIVED | RECEIVED_ERROR, newest)


async def afterwards(tb, vector, older):
    """What the device holds must be what is printed."""
    await tb.clocks(LAST_ACTION_CLOCKS)
    for key, value in vectors.contents(vector["postconditions"], tb.slave.config.files[1]):
        held = await tb.read_back(key)
        assert held == value, f"{key}: printed {value:04X}, holds {held}"
    state = vectors.state(vector["postconditions"])
    seen = {"listen_only": int(tb.dut.listen_only_o.value), "diagnostic_register": await tb.diagnostic_register()}
    for name in seen.keys() & state.keys():
        assert seen[name] == state[name], f"{name}: printed {state[name]:X}, is {seen[name]:X}"
    counters, log = vectors.counters(vector), vectors.event_log(vector)
    if counters is not None:
        seen = await tb.read_counters()
        assert seen == counters, f"printed {counters}, seen {seen}"
    if log is not None:
        seen = await tb.read_log()
        assert seen == log + older, f"printed {named(log)} on {named(older)}, seen {named(seen)}"


async def play(dut, case):
    """An example and what is printed before it; each step's answer and everything afterwards is compared."""
    tb = await bench.Bench.start(dut, address=case["slave_address"], bit_time=16)
    older = None  # than what is printed
    for step in (*vectors.before(case), case):
        log = await prepare(tb, step)
        older = log if older is None else older
        for _ in range(vectors.repeat(step)):
            seen = await tb.both(vectors.frame(step["request"]))
            assert seen == vectors.frame(step["expected_response"]), f"printed {step['expected_response']}"
        await afterwards(tb, step, older)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(vector=[name for name, case in CASES.items() if at_the_ports(case)])
async def printed_example_plays(dut, vector):
    await play(dut, CASES[vector])


@cocotb.test()
@cocotb.parametrize(vector=[name for name, case in CASES.items() if not at_the_ports(case)])
async def printed_example_with_loaded_counters_plays(dut, vector):
    """Its counters cannot be reached by traffic in reasonable time: they are loaded inside the device."""
    await play(dut, CASES[vector])
