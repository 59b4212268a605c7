# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Model against device over random traffic of every function, through cocotb. SEED and COUNT come from outside.

The user's functions answer with what they are asked, refuse or pass, by a byte of the request.
"""

import os
from collections import Counter

import cocotb
from harness.bench import Bench
from harness.traffic import Traffic
from harness.user import User
from harness.volume import volume
from protocol.defs import F8E1, F8N1, F8N2, F8O1

SEED = int(os.environ.get("BENCH_SEED", "1"))
COUNT = int(os.environ.get("BENCH_COUNT", volume("random requests in a simulator")))
COMPARE_EVERY = 50
FAILURES = (4, 5, 6, 7, 8, 10, 11)


def respond(pdu):
    """What the user makes of a request."""
    kind = pdu[-1] % 4
    return None if kind == 1 else 1 + pdu[-1] % 15 if kind == 2 else pdu


@cocotb.test()
async def random_requests_agree_with_the_model(dut):
    tb = await Bench.start(dut, seed=SEED)
    print(f"seed {SEED}, {COUNT} requests")
    traffic, kinds = Traffic(tb.rng, tb.slave.config, tb.slave), Counter()
    user = User(tb, respond)
    user.behave(wait=lambda: tb.rng.choice((0, 1, 50)), gap=lambda: tb.rng.choice((0, 0, 3)))
    for number in range(COUNT):
        if number % COMPARE_EVERY == 0:
            # only formats with parity: the traffic has parity errors
            setup = {
                "fmt": tb.rng.choice((F8E1, F8O1)),
                "bit_time": tb.rng.choice((8, 9, 12, 16)),
                "gap_count_only": tb.rng.getrandbits(1),
            }
            tb.apply(**setup)
            await tb.silence()
            await tb.compare_counters(f"seed {SEED}, before request {number}", line=True)
        tb.apply(
            busy=tb.rng.random() < 0.03,
            write_lock=tb.rng.random() < 0.05,
            failure=tb.rng.choice(FAILURES) if tb.rng.random() < 0.05 else 0,
            exception_status=tb.rng.getrandbits(8),
            run_indicator=tb.rng.getrandbits(1),
            diagnostic=1 << tb.rng.randrange(16) if tb.rng.random() < 0.02 else 0,
        )
        line, kind = traffic.line()
        note = f"seed {SEED}, request {number} ({kind})"
        await tb.both(line, note=note, patience=None if kind != "broadcast" else 200 * tb.bit)
        kinds[kind] += 1
        await tb.compare_counters(note)
    print(dict(kinds), dict(tb.slave.counts))
    assert tb.slave.counts["good"] > COUNT / 2
    user.check()
    tb.apply(busy=0, failure=0, diagnostic=0)
    await tb.finish()


@cocotb.test()
async def random_requests_without_parity(dut):
    tb = await Bench.start(dut, seed=SEED + 1)
    traffic = Traffic(tb.rng, tb.slave.config, tb.slave)
    User(tb, respond)
    for number in range(COUNT // 10):
        tb.apply(fmt=tb.rng.choice((F8N1, F8N2)))
        await tb.silence()
        line, kind = traffic.line()
        while any(not isinstance(c, int) and c[2] == "parity" for c in line):
            line, kind = traffic.line()
        note = f"seed {SEED}, request {number} ({kind})"
        await tb.both(line, note=note, patience=None if kind != "broadcast" else 200 * tb.bit)
    await tb.finish()
