# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_bit_clock with BIT_FRACTIONS: every bit ends within half a clock of its exact place."""

import cocotb
from harness.unit import clocks, settle, start, strobe
from harness.volume import IS_FULL as FULL


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 9, 11, 13, 434], fraction=[0, 1, 5, 8, 15])
async def bit_ends_within_half_a_clock_of_its_place(dut, bit_time, fraction):
    await start(dut, bit_time=bit_time, fraction=fraction)
    for _ in range(2 if bit_time < 100 or FULL else 1):
        await strobe(dut, restart=1)
        clock = ended = 0
        while ended < 33:
            await settle()
            clock += 1
            if int(dut.bit_stb_o.value):
                ended += 1
                early = ended * (16 * bit_time + fraction) - 16 * clock
                assert -8 <= early <= 8, f"bit {ended} ends {early / 16} clocks early"
            await clocks(dut)
        await clocks(dut, 5)
