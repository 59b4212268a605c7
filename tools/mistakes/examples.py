# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the examples."""

from .kinds import Mistake

MISTAKES = [
    Mistake(
        "soc_wishbone_burst_broken",
        "modbus_example_soc_wb.v",
        "(line_q | ~cpu_cyc_i)",
        "((line_q & ~wb_ack) | ~cpu_cyc_i)",
    ),
    Mistake("soc_wishbone_cpu_cycle_broken", "modbus_example_soc_wb.v", "wb_cyc & (line_q | ~cpu_cyc_i)", "wb_cyc"),
    Mistake(
        "soc_axil_burst_not_looked_at",
        "modbus_example_soc_axil.v",
        "else if (!burst) begin",
        "else begin",
    ),
    Mistake(
        "soc_axil_write_begins_without_its_data",
        "modbus_example_soc_axil.v",
        "s_axil_awvalid & s_axil_wvalid & ~cpu_bvalid_q",
        "s_axil_awvalid & ~cpu_bvalid_q",
    ),
    Mistake(
        "soc_axil_response_not_taken_blocks_the_bus",
        "modbus_example_soc_axil.v",
        "reading & (~line_q | line_rready)",
        "reading & (line_q ? line_rready : ~cpu_rvalid_q & s_axil_rready)",
    ),
    Mistake(
        "soc_axil_response_overwritten",
        "modbus_example_soc_axil.v",
        "s_axil_arvalid & ~cpu_rvalid_q",
        "s_axil_arvalid",
    ),
]
