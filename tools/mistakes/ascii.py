# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in ASCII mode: the codec, and what the line and the engine do for it."""

from .kinds import Mistake

CODEC = "modbus_ascii.v"
MISTAKES = [
    Mistake("lower_case_taken", CODEC, "~data_i[5] & ~data_i[4] & ~data_i[3] & big", "~data_i[4] & ~data_i[3] & big"),
    Mistake("the_digit_behind_9_taken", CODEC, "data_i[4] & ~big", "data_i[4] & ~(big & nibble[2])"),
    Mistake("a_letter_is_worth_one_less", CODEC, "data_i[0] ^ letter};", "data_i[0]};"),
    Mistake("lrc_not_judged", CODEC, "(sum_q == 8'hFF) & ~wrong_q", "~wrong_q"),
    Mistake("wrong_characters_not_judged", CODEC, "(sum_q == 8'hFF) & ~wrong_q", "(sum_q == 8'hFF)"),
    Mistake("half_a_byte_at_the_end_taken", CODEC, "is_cr ? half_q : ~allowed", "is_cr ? 1'b0 : ~allowed"),
    Mistake("any_character_behind_cr_ends", CODEC, "cr_q ? ~ends :", "cr_q ? 1'b0 :"),
    Mistake("a_colon_inside_is_no_end", CODEC, "(heard & anew & any_q) | (end_q", "(end_q"),
    Mistake("an_empty_part_is_a_bad_frame", CODEC, "(heard & anew & any_q)", "(heard & anew)"),
    Mistake(
        "what_the_colon_began_stays",
        CODEC,
        "cr_q    <= ~start_q & (heard ? is_cr : cr_q);\n    wrong_q <= ~start_q & (",
        "cr_q    <= heard ? is_cr : cr_q;\n    wrong_q <= 1'b1 & (",
    ),
    Mistake(
        "time_out_forgotten", CODEC, "(end_q & (start_stb_i | ~rest_i)) | over;", "(end_q & (start_stb_i | ~rest_i));"
    ),
    Mistake("a_late_frame_is_good", CODEC, "(wrong_q | (heard & misplaced) | over)", "(wrong_q | (heard & misplaced))"),
    Mistake("delimiter_kept_over_a_restart", CODEC, "if (restart_i || rst_i) delimiter_q", "if (rst_i) delimiter_q"),
    Mistake(
        "delimiter_cannot_be_a_colon",
        CODEC,
        "wire       anew     = is_colon & ~(cr_q & ends);",
        "wire       anew     = is_colon;",
    ),
    Mistake("end_before_the_stop_bits", CODEC, "(end_q & (start_stb_i | ~rest_i))", "end_q"),
    Mistake("one_byte_too_few_counted", CODEC, "up_q    <= open_stb_i & ascii_i;", "up_q    <= 1'b0;"),
    Mistake("answer_without_its_colon", CODEC, "(valid_i & (began_q | ready_i))", "valid_i"),
    Mistake("lf_before_cr", CODEC, "cr_tx    = last_i & ~half_q;", "cr_tx    = last_i & half_q;"),
    Mistake("lrc_of_the_answer_before_one_is_added", CODEC, "if (fresh) sum_q <= 8'hFF;", "if (fresh) sum_q <= 8'h00;"),
    Mistake("letters_sent_as_what_follows_9", CODEC, "above_9  = ascii_i & began_q & ~last_i & big", "above_9  = 1'b0"),
    Mistake("eight_bits_in_seven_bit_mode", "modbus_line.v", "ascii & ~settings_i[`MB_SET_EIGHT_BITS]", "1'b0"),
    Mistake("the_eighth_bit_is_sent", "modbus_uart.v", "{2'd0, take & seven_i, take ^ seven_i}", "{3'd0, take}"),
    Mistake(
        "parity_of_the_colon_not_judged",
        "modbus_frame_rx.v",
        "parity_q  <= open_q ? ascii_i & parity_error_i ",
        "parity_q  <= open_q ? 1'b0 ",
    ),
    Mistake(
        "framing_of_the_colon_not_judged",
        "modbus_frame_rx.v",
        "framing_q <= open_q ? ascii_i & framing_error_i ",
        "framing_q <= open_q ? 1'b0 ",
    ),
    Mistake("long_by_a_byte_only", "modbus_frame_rx.v", "full & half_i & ~spoiled", "full & whole_i & ~spoiled"),
    Mistake(
        "time_out_without_what_is_added", "modbus_line.v", "TICKS[15:0] | ({14'd0, extra} << EXTRA_AT)", "TICKS[15:0]"
    ),
    Mistake(
        "time_out_early",
        "modbus_line.v",
        "TICKS       = (TIMEOUT >> TICK_BITS) + 1;",
        "TICKS       = TIMEOUT >> (TICK_BITS + 1);",
    ),
    Mistake(
        "gaps_of_ascii_mode_add_up",
        "modbus_line.v",
        "counts_silence ? receiving : ~bank_waits_i",
        "counts_silence ? 1'b0 : ~bank_waits_i",
    ),
    Mistake("delimiter_not_set", "modbus_sequencer.v", "set_mode & argument[`MB_MODE_DELIMITER]", "1'b0"),
    Mistake(
        "delimiter_from_the_second_byte",
        "modbus_routines_diagnostics.vh",
        "`DO(POINT(AT_WORD))",
        "`DO(POINT(AT_WORD + 5'd1))",
    ),
]
