# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the line: pins to frames and back."""

from .kinds import Mistake

MISTAKES = [
    Mistake(
        "auto_foreign_frame_played", "modbus_auto_line.v", "wire for_us    = ours_q | all_q;", "wire for_us    = 1'b1;"
    ),
    Mistake(
        "auto_parity_not_judged",
        "modbus_auto_line.v",
        "(is_parity ? parity_q ^ value : ~value)",
        "(~is_parity & ~value)",
    ),
    Mistake(
        "auto_three_characters_lock",
        "modbus_auto_line.v",
        "first & crc_zero & chars_q[3]",
        "first & crc_zero & chars_q[2]",
    ),
    Mistake(
        "auto_two_formats_lock",
        "modbus_auto_line.v",
        "locked_q  <= accept ? ~two_fit :",
        "locked_q  <= accept ? 1'b1 :",
    ),
    Mistake("auto_turns_survive_a_reset", "modbus_auto_line.v", " | {rst_i, 1'b0};", ";"),
    Mistake(
        "auto_own_echo_recorded",
        "modbus_auto_line.v",
        "(accept & ~for_us) | de_i | rst_i;",
        "(accept & ~for_us) | rst_i;",
    ),
    Mistake("auto_spike_ends_the_lock", "modbus_auto_line.v", "(place_q[AW-1:3] == {AW-3{1'b0}})", "1'b0"),
    Mistake("auto_break_not_noticed", "modbus_auto_line.v", "locked_q & ~is_break & ~enough", "locked_q & ~enough"),
    Mistake("auto_always_snapped", "modbus_auto_line.v", "hit_q & ~less & snap_i;", "hit_q & ~less;"),
    Mistake("auto_rate_within_three_percent", "modbus_run_ram.v", "ticks * 102 + 50", "ticks * 103 + 50"),
    Mistake(
        "health_spike_in_a_character_is_a_glitch",
        "modbus_line_health.v",
        "line_q & ~line & (whole_q | spike_q)",
        "line_q & ~line",
    ),
    Mistake(
        "health_counter_wraps",
        "modbus_line_health.v",
        "(place[1] | ~not_less) : ~not_less;",
        "(place[1] | ~not_less) : 1'b1;",
    ),
    Mistake("health_gap_of_the_last_frame_alone", "modbus_line_health.v", "(place[1] | ~not_less) :", "1'b1 :"),
    Mistake(
        "health_gap_of_a_bad_frame",
        "modbus_line_health.v",
        "first_q <= ~rx_active_i | clear_q |",
        "first_q <= clear_q |",
    ),
    Mistake(
        "health_every_character_is_eleven_bits", "modbus_line_health.v", "(ten_bits ? -8'sd100 :", "(1'b0 ? -8'sd100 :"
    ),
    Mistake("health_own_frames_heard", "modbus_line_health.v", "line      = rxd_sync | de_i;", "line      = rxd_sync;"),
    Mistake(
        "health_coil_clears_while_it_is_1",
        "modbus_rtu_slave_io.v",
        "assign clear = coil & ~coil_q;",
        "assign clear = coil;",
    ),
    Mistake(
        "health_coil_counts_from_0",
        "modbus_rtu_slave_io.v",
        "coils_o[HEALTH_COIL - COIL_BASE]",
        "coils_o[HEALTH_COIL % COIL_WIDTH]",
    ),
    Mistake(
        "health_words_are_the_first_registers",
        "modbus_rtu_slave_io.v",
        "FIRST_WORD = INPUT_BASE + INPUT_COUNT - 8",
        "FIRST_WORD = INPUT_BASE",
    ),
    Mistake("units_broadcast_is_a_unit", "modbus_units.v", "ours_i & legal)", "ours_i)"),
    Mistake(
        "units_told_too_late", "modbus_units.v", "assign unit_o = here_q ? byte_i : unit_q;", "assign unit_o = unit_q;"
    ),
    Mistake("crc_polynomial", "modbus_crc16.v", "16'hA001", "16'h8005"),
    Mistake(
        "crc_start_value",
        "modbus_crc16.v",
        "if (clear_i)      crc_q <= 16'hFFFF;",
        "if (clear_i)      crc_q <= 16'h0000;",
    ),
    Mistake(
        "crc_not_judged",
        "modbus_frame_rx.v",
        "wire good      = verdict & ~broken & crc_zero_i;",
        "wire good      = verdict & ~broken;",
    ),
    Mistake("parity_swapped", "modbus_uart.v", "begins ? is_odd :", "begins ? ~is_odd :"),
    Mistake("parity_not_judged", "modbus_frame_rx.v", "parity_q  | (char_stb_i & parity_error_i);", "1'b0;"),
    Mistake(
        "framing_flag_of_the_last_character_only",
        "modbus_frame_rx.v",
        "framing_q | (char_stb_i & framing_error_i);",
        "(char_stb_i ? framing_error_i : framing_q);",
    ),
    Mistake(
        "break_not_waited_out",
        "modbus_uart.v",
        "ST_BREAK: if (rxd_i) state_d = ST_IDLE;",
        "ST_BREAK: state_d = ST_IDLE;",
    ),
    Mistake(
        "second_stop_bit_left_out",
        "modbus_uart.v",
        "(number_q[0] | ten_bits)",
        "(number_q[0] | format_i[1])",
    ),
    Mistake("t15_a_quarter_character_long", "modbus_line_timer.v", "T15_11 = 7'd33", "T15_11 = 7'd38"),
    Mistake("t35_a_bit_short", "modbus_line_timer.v", "T35_11 = 7'd77", "T35_11 = 7'd75"),
    Mistake("silence_from_the_middle_of_the_stop_bit", "modbus_line_timer.v", "REST_1 = -7'd1", "REST_1 = 7'd0"),
    Mistake(
        "gap_forgotten",
        "modbus_frame_rx.v",
        "(gap_q | ((start_stb_i | ascii_i) & t15_i))",
        "((start_stb_i | ascii_i) ? t15_i : gap_q)",
    ),
    Mistake("three_bytes_are_a_frame", "modbus_frame_rx.v", "((count_i & ~9'd3) == 9'd0);", "(count_i < 9'd3);"),
    Mistake(
        "frame_of_257_bytes_taken",
        "modbus_frame_rx.v",
        "long_q    <= ~open_q & (long_q | (char_stb_i & full & half_i & ~spoiled));",
        "long_q    <= 1'b0;",
    ),
    Mistake(
        "idle_at_once_after_reset",
        "modbus_frame_rx.v",
        "if (rst_i || (restart_i && !sending_i && !send_stb_o)) state_q <= ST_INITIAL;",
        "if (rst_i || (restart_i && !sending_i && !send_stb_o)) state_q <= ST_IDLE;",
    ),
    Mistake(
        "strict_turnaround_ignored",
        "modbus_frame_rx.v",
        "(sent_i ? strict_i : heard)",
        "(sent_i ? 1'b0 : heard)",
    ),
    Mistake("line_low_at_power_up", "modbus_uart.v", "txd_q = 1'b1;", "txd_q = 1'b0;"),
    Mistake(
        "idle_at_once_at_power_up",
        "modbus_frame_rx.v",
        "reg [1:0] state_q = ST_INITIAL, state_d;",
        "reg [1:0] state_q = ST_IDLE, state_d;",
    ),
    Mistake("address_248_answers", "modbus_frame_rx.v", " & (address_i[7:3] != 5'h1F)", ""),
    Mistake(
        "broadcast_always_obeyed",
        "modbus_frame_rx.v",
        "wire for_all   = none & broadcast_en_i;",
        "wire for_all   = none;",
    ),
    Mistake(
        "driver_off_before_the_tail",
        "modbus_frame_tx.v",
        "de_q    <= (state_d != ST_REST)",
        "de_q    <= (state_d != ST_REST) & (state_d != ST_TAIL)",
    ),
    Mistake(
        "answer_without_the_response_delay",
        "modbus_frame_tx.v",
        "(state_q == ST_DELAY) ? response_delay_i[3:0] :",
        "(state_q == ST_DELAY) ? 4'd0 :",
    ),
    Mistake(
        "wait_is_never_long", "modbus_frame_tx.v", "wait_short_o  = (state_q != ST_DELAY);", "wait_short_o  = 1'b1;"
    ),
    Mistake(
        "spikes_restart_the_bit_clock_of_the_waits",
        "modbus_line.v",
        ".receiving_i(receiving), .sending_i(tx_sending)",
        ".receiving_i(~rxd & ~de_o), .sending_i(tx_sending)",
    ),
    Mistake(
        "stop_bit_counted_off_behind_our_own_characters",
        "modbus_line_timer.v",
        "receiving_i ? behind : 7'd0",
        "behind",
    ),
    Mistake(
        "strict_silence_from_the_end_of_the_tail",
        "modbus_line.v",
        ".sending_i(tx_sending), .restart_i",
        ".sending_i(de_o), .restart_i",
    ),
    Mistake("characters_stop_a_wait", "modbus_line_timer.v", "(receiving_i & no_wait_q)", "receiving_i"),
    Mistake(
        "late_answer_sent", "modbus_frame_tx.v", "ST_DELAY: if (drop_i) state_d = ST_REST; else if", "ST_DELAY: if"
    ),
    Mistake(
        "every_late_answer_dropped",
        "modbus_frame_rx.v",
        "drop_o        = drop_late_i & heard_q",
        "drop_o        = heard_q",
    ),
    Mistake(
        "behind_a_dropped_answer_the_line_is_heard_at_once",
        "modbus_frame_rx.v",
        "(sent_i ? strict_i : heard)",
        "((sent_i | dropped_i) ? strict_i : heard)",
    ),
    Mistake(
        "idle_while_the_engine_works",
        "modbus_frame_rx.v",
        "idle_o        = ~state_q[1];",
        "idle_o        = ~reception;",
    ),
    Mistake(
        "answer_to_nothing",
        "modbus_frame_rx.v",
        "send_stb_o    = work & send_i & ~sending_i;",
        "send_stb_o    = send_i & ~sending_i;",
    ),
    Mistake(
        "fraction_of_a_clock_lost",
        "modbus_bit_clock.v",
        "(quarter_q == 2'd0) ? long_bit :",
        "(quarter_q == 2'd0) ? 1'b0 :",
    ),
    Mistake(
        "filter_lets_its_limit_pass",
        "modbus_glitch_filter.v",
        "count_q == CLOCKS[W-1:0]",
        "count_q + 1'b1 == CLOCKS[W-1:0]",
    ),
    Mistake("late_stop_bit_not_seen", "modbus_uart.v", "(sample_q | is_stop_q)", "sample_q"),
    Mistake("odd_clock_of_a_bit_lost", "modbus_bit_clock.v", "? bit_time_i[0] :", "? 1'b0 :"),
    # the line
    Mistake(
        "broadcast_taken_for_a_foreign_frame",
        "modbus_frame_rx.v",
        "wire for_us    = for_all | ",
        "wire for_us    = ",
    ),
]
