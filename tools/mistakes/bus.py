# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the bridges to other buses."""

from .kinds import Mistake

MISTAKES = [
    Mistake(
        "axil_valid_falls_with_the_core",
        "modbus_axil_master.v",
        "(ar_q & ~m_axil_arready)",
        "(ar_q & ~m_axil_arready & stb)",
    ),
    Mistake(
        "axil_next_transfer_on_top_of_a_stale_one",
        "modbus_axil_master.v",
        "wire begins = stb & ~busy_q;",
        "wire begins = stb & ~(busy_q & ~stale_q);",
    ),
    Mistake(
        "axil_late_answer_taken_for_the_next",
        "modbus_axil_master.v",
        "stale_q <= busy_q & ~ends & (stale_q | ~stb);",
        "stale_q <= 1'b0;",
    ),
    Mistake(
        "axil_decerr_not_noticed",
        "modbus_axil_master.v",
        "write_q ? m_axil_bresp[1] : m_axil_rresp[1]",
        "write_q ? (m_axil_bresp == 2'b10) : (m_axil_rresp == 2'b10)",
    ),
    Mistake("axil_other_bits_of_a_coil", "modbus_axil_master.v", "wb_dat_i[15:1] & {15{~bits}}", "wb_dat_i[15:1]"),
    Mistake("axil_files_on_top_of_each_other", "modbus_axil_master.v", "file * FILE_RECORDS[15:0]", "file"),
    Mistake(
        "axil_hung_bus_waits_again",
        "modbus_axil_master.v",
        "stb & (stale_q | (ends & bad))",
        "stb & ends & bad & ~stale_q",
    ),
    Mistake("axil_half_of_a_word", "modbus_axil_master.v", "m_axil_wstrb   = 4'b1111", "m_axil_wstrb   = 4'b0011"),
    Mistake("cpu_half_a_register", "modbus_axil_slave.v", "half  = write_q & (", "half  = 1'b0 & ("),
    Mistake("cpu_hold_does_not_hold", "modbus_axil_slave.v", "host_stb_o | hold_q", "host_stb_o"),
    Mistake(
        "cpu_read_over_an_answer_not_taken",
        "modbus_axil_slave.v",
        "s_axil_arvalid & ~rvalid_q;",
        "s_axil_arvalid;",
    ),
    Mistake(
        "cpu_address_without_data",
        "modbus_axil_slave.v",
        "s_axil_awvalid & s_axil_wvalid & ~bvalid_q",
        "s_axil_awvalid & ~bvalid_q",
    ),
    Mistake("cpu_error_not_told", "modbus_axil_slave.v", "bad_q <= host_err_i & ~own;", "bad_q <= 1'b0;"),
    Mistake(
        "cpu_response_falls",
        "modbus_axil_slave.v",
        "(rvalid_q & ~s_axil_rready)",
        "(rvalid_q & s_axil_rready & 1'b0)",
    ),
    Mistake(
        "cpu_hold_answered_within_a_burst",
        "modbus_axil_slave.v",
        "(none | half) ? ST_ACCEPT",
        "(own | none | half) ? ST_ACCEPT",
    ),
    Mistake(
        "soc_axil_burst_of_one_beat",
        "modbus_axil_master.v",
        "assign burst_o = wb_cyc_i;",
        "assign burst_o = stb;",
    ),
]
