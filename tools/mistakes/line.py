# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the line: pins to frames and back."""

from .kinds import Mistake

MISTAKES = [
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
    Mistake("parity_swapped", "modbus_uart_rx.v", "parity_q  <= is_odd;", "parity_q  <= ~is_odd;"),
    Mistake("parity_not_judged", "modbus_frame_rx.v", "parity_q  <= parity_q  | parity_error_i;", "parity_q  <= 1'b0;"),
    Mistake(
        "framing_flag_of_the_last_character_only",
        "modbus_frame_rx.v",
        "framing_q <= framing_q | framing_error_i;",
        "framing_q <= framing_error_i;",
    ),
    Mistake(
        "break_not_waited_out",
        "modbus_uart_rx.v",
        "ST_BREAK: if (rxd_i) state_d = ST_IDLE;",
        "ST_BREAK: state_d = ST_IDLE;",
    ),
    Mistake(
        "second_stop_bit_left_out",
        "modbus_uart_tx.v",
        "(format_i == `MB_FORMAT_8N1) ? 4'd9 : 4'd10",
        "(format_i[1]) ? 4'd9 : 4'd10",
    ),
    Mistake("t15_a_quarter_character_long", "modbus_line_timer.v", "T15_11 = 8'd66", "T15_11 = 8'd77"),
    Mistake("t35_a_bit_short", "modbus_line_timer.v", "T35_11 = 8'd154", "T35_11 = 8'd150"),
    Mistake("silence_from_the_middle_of_the_stop_bit", "modbus_line_timer.v", "REST_1 = 8'd2", "REST_1 = 8'd0"),
    Mistake(
        "gap_forgotten",
        "modbus_frame_rx.v",
        "if (start_stb_i && t15_i) gap_q <= 1'b1;",
        "gap_q <= start_stb_i & t15_i;",
    ),
    Mistake("three_bytes_are_a_frame", "modbus_frame_rx.v", "(count_i < 9'd4)", "(count_i < 9'd3)"),
    Mistake(
        "frame_of_257_bytes_taken",
        "modbus_frame_rx.v",
        "long_q    <= long_q    | (full & ~spoiled);",
        "long_q    <= 1'b0;",
    ),
    Mistake(
        "idle_at_once_after_reset",
        "modbus_frame_rx.v",
        "if (rst_i || restart_i) state_q <= ST_INITIAL;",
        "if (rst_i || restart_i) state_q <= ST_IDLE;",
    ),
    Mistake(
        "strict_turnaround_ignored",
        "modbus_frame_rx.v",
        "(answered_i ? strict_i : heard)",
        "(answered_i ? 1'b0 : heard)",
    ),
    Mistake("line_low_at_power_up", "modbus_uart_tx.v", "reg       txd_q = 1'b1;", "reg       txd_q = 1'b0;"),
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
        "drive_q <= (state_d != ST_REST)",
        "drive_q <= (state_d != ST_REST) & (state_d != ST_TAIL)",
    ),
    Mistake(
        "answer_without_the_response_delay",
        "modbus_frame_tx.v",
        "(state_q == ST_DELAY) ? response_delay_i :",
        "(state_q == ST_DELAY) ? 12'd0 :",
    ),
    # the line
    Mistake(
        "broadcast_taken_for_a_foreign_frame",
        "modbus_frame_rx.v",
        "wire for_us    = for_all | ",
        "wire for_us    = ",
    ),
]
