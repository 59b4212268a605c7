# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the register banks."""

from .kinds import Mistake

MISTAKES = [
    Mistake("table_one_item_too_long", "modbus_bank_guard.v", "(last_i <= high)", "(last_i <= high + 16'd1)"),
    Mistake("first_address_not_compared", "modbus_bank_guard.v", "(first_i >= low) & ", ""),
    Mistake(
        "read_only_range_open_at_its_end", "modbus_bank_guard.v", "first > RO_LAST[15:0];", "first >= RO_LAST[15:0];"
    ),
    Mistake(
        "host_breaks_into_a_burst",
        "modbus_bank_ram.v",
        "host_cyc_i & (host_q | ~wb_cyc_i) & ~lend",
        "host_cyc_i & ~lend",
    ),
    Mistake(
        "refusal_waits_for_the_host", "modbus_bank_ram.v", "wire        lend = host_q &", "wire        lend = 1'b0 &"
    ),
    Mistake("grant_does_not_wait_for_the_host", "modbus_bank_ram.v", ".wait_i(lent_q)", ".wait_i(1'b0)"),
    Mistake("host_loses_its_block_to_a_question", "modbus_bank_ram.v", "(ack | ~host_stb_i)", "(ready_q | host_stb_i)"),
    Mistake("ram_stores_what_it_checks", "modbus_bank_ram.v", "& ~checks;", ";"),
    Mistake("beat_of_bits_writes_behind_its_last", "modbus_bank_lanes.v", "16'hFFFF >> ~end_at", "16'hFFFF"),
    Mistake("beat_of_bits_writes_before_its_first", "modbus_bank_lanes.v", "16'hFFFF << first_i[3:0]", "16'hFFFF"),
    Mistake(
        "host_writes_a_word_of_bits",
        "modbus_bank_ram.v",
        ".last_i(host_q ? item : grant_last_i), .lanes_o",
        ".last_i(item | 16'd15), .lanes_o",
    ),
    Mistake(
        "words_of_discrete_inputs_lie_on_those_of_coils",
        "modbus_bank_ram.v",
        "WIDE ? COIL_WORDS - DISCRETE_BASE / 16",
        "WIDE ? -(DISCRETE_BASE / 16)",
    ),
    Mistake("io_beat_of_bits_writes_the_whole_word", "modbus_bank_io.v", "lanes[c % 16] && ", ""),
    Mistake(
        "read_back_survives_a_reset", "modbus_bank_io.v", "written_q[w] <= 1'b0;", "written_q[w] <= written_q[w];"
    ),
    Mistake("read_back_of_what_was_never_written", "modbus_bank_io.v", "& written_q[holding];", ";"),
    Mistake("file_0_is_there", "modbus_bank_guard.v", " & (few != {FW{1'b0}})", ""),
    Mistake("any_file_is_there", "modbus_bank_guard.v", "~many & ", ""),
    Mistake("axil_verdict_with_an_error", "modbus_bank_guard.v", "(ack_o & refused_q)", "refused_q"),
    Mistake(
        "map_forgets_an_option",
        "modbus_host_map.v",
        "<= host_dat_i[3:0];\n            ITEM_DELAY",
        "<= {1'b0, host_dat_i[2:0]};\n            ITEM_DELAY",
    ),
    Mistake("map_has_no_fraction", "modbus_host_map.v", "((BIT_FRACTIONS != 0) | (item", "(1'b0 | (item"),
    Mistake("map_fraction_is_always_there", "modbus_host_map.v", "((BIT_FRACTIONS != 0) | (item", "(1'b1 | (item"),
    Mistake("map_takes_any_write", "modbus_host_map.v", "(HOST_SETTINGS != 0) & settings_exist &", "settings_exist &"),
    Mistake("map_counter_that_is_not_there", "modbus_host_map.v", "number <= 7'h12", "number <= 7'h13"),
    Mistake("map_writes_do_not_clear_the_words", "modbus_host_map.v", "stb & health & host_we_i;", "1'b0;"),
    Mistake("map_reading_clears_the_words", "modbus_host_map.v", "stb & health & host_we_i;", "stb & health;"),
    Mistake("map_lets_the_memory_go", "modbus_host_map.v", "bank_cyc_o = host_cyc_i;", "bank_cyc_o = bank_stb_o;"),
    Mistake("map_left_out_is_there", "modbus_host_map.v", "(HOST_MAP != 0) & (host_adr_i", "(host_adr_i"),
]
