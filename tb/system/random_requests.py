# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Model against device over random traffic, through cocotb. SEED and COUNT come from outside."""

import os
from collections import Counter

import cocotb
from mbrtu.bench import Bench
from mbrtu.defs import F8E1, F8N1, F8N2, F8O1
from mbrtu.traffic import Traffic

SEED = int(os.environ.get("BENCH_SEED", "1"))
COUNT = int(os.environ.get("BENCH_COUNT", "300"))
COMPARE_EVERY = 50


@cocotb.test()
async def random_requests_agree_with_the_model(dut):
    tb = await Bench.start(dut, seed=SEED)
    print(f"seed {SEED}, {COUNT} requests")
    traffic, kinds = Traffic(tb.rng, tb.slave.config), Counter()
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
        tb.apply(busy=tb.rng.random() < 0.03, write_lock=tb.rng.random() < 0.05)
        line, kind = traffic.line()
        note = f"seed {SEED}, request {number} ({kind})"
        await tb.both(line, note=note, patience=None if kind != "broadcast" else 200 * tb.bit)
        kinds[kind] += 1
    print(dict(kinds), dict(tb.slave.counts))
    assert tb.slave.counts["good"] > COUNT / 2
    await tb.finish()


@cocotb.test()
async def random_requests_without_parity(dut):
    tb = await Bench.start(dut, seed=SEED + 1)
    traffic = Traffic(tb.rng, tb.slave.config)
    for number in range(COUNT // 10):
        tb.apply(fmt=tb.rng.choice((F8N1, F8N2)))
        await tb.silence()
        line, kind = traffic.line()
        while any(not isinstance(c, int) and c[2] == "parity" for c in line):
            line, kind = traffic.line()
        note = f"seed {SEED}, request {number} ({kind})"
        await tb.both(line, note=note, patience=None if kind != "broadcast" else 200 * tb.bit)
    await tb.finish()
