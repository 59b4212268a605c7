# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The outputs beside the Verilog are made at once, and are the same each time."""

import time

from modbus_map.outputs import c_header, client, manual, tags, vhdl

from map.output_devices import EVERYTHING


def test_fast_and_the_same_each_time():
    before = time.process_time()
    made = [[generator.generate(EVERYTHING) for generator in (c_header, client, manual, tags, vhdl)] for _ in range(2)]
    assert made[0] == made[1]
    assert time.process_time() - before < 2
