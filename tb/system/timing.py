# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""115200 baud with a 50 MHz clock and the floors of t1.5 and t3.5, once through cocotb.

The measurements themselves run on the compiled slave: tb/differential/test_timing.py.
"""

import cocotb
from harness.bench import CLOCK_PS, Bench
from harness.lines import scaled, with_gap
from protocol import frames

OWN = 17
BIT_TIME = 434  # 50 MHz / 115200


@cocotb.test()
async def answer_at_115200(dut):
    """Starts within a bit of 1750 us, goes out without a gap, de_o around it; a 2 ms gap ends a frame."""
    tb = await Bench.start(dut, bit_time=BIT_TIME)
    assert tb.t35 == 87_500 * CLOCK_PS
    frame = frames.adu(OWN, frames.write_register(0, 0x1234))
    assert await tb.both(frame) is not None
    assert tb.longest_latency <= 1, f"{tb.longest_latency:.2f} bits after t3.5"
    assert await tb.both(with_gap(frame, 4, scaled(tb, 1.2))) is not None
    assert await tb.both(with_gap(frame, 4, scaled(tb, 2.0))) is None
    await tb.finish()
