#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Plants deliberate mistakes in copies of the RTL and shows which test catches each.

    make mistakes           all of them
    make mistakes T=crc     those whose name contains `crc`

Every mistake is a search and replace in one file; a pattern that is not found exactly once stops the
run, so a mistake cannot silently become none. Each copy meets the same fast selection of the
regression, in the same order, until something fails. Exit status 0 only if the untouched RTL
passes the selection and every mistake is caught. The table goes to build/mistakes/table.md.
"""

import contextlib
import fcntl
import io
import json
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TB = ROOT / "tb"
TREES = ("rtl", "examples")  # where the Verilog is
WORK = ROOT / "build" / "mistakes"
WORKERS = min(4, os.cpu_count() or 1)
TIMEOUT_SECONDS = 900


@dataclass(frozen=True)
class Mistake:
    """`old` in `file`, which is somewhere in TREES, becomes `new`."""

    name: str
    file: str
    old: str
    new: str


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
    Mistake("broadcast_read_goes_on", "modbus_routines_tables.vh", "GO_IF_UNICAST(READ_COILS)", "GO(READ_COILS)"),
    Mistake(
        "mask_write_goes_on_in_a_broadcast",
        "modbus_routines_tables.vh",
        "GO_IF_UNICAST(MASK_WRITE)",
        "GO(MASK_WRITE)",
    ),
    Mistake(
        "function_code_seen_through_five_bits",
        "modbus_sequencer.v",
        "byte_i[4:0] | {5{byte_i[7:5] != 3'd0}}",
        "byte_i[4:0]",
    ),
    Mistake(
        "quantity_limit_one_too_low",
        "modbus_range.v",
        "{1'b0, argument_i[`MB_ARG_ROOM]};",
        "{1'b0, argument_i[`MB_ARG_ROOM]} + 12'd1;",
    ),
    Mistake("quantity_seen_through_eleven_bits", "modbus_range.v", "(quantity_less_one_q[15:11] == 5'd0) & ", ""),
    Mistake(
        "any_coil_value_means_on",
        "modbus_sequencer.v",
        "zero_q & (held_i == 8'h00 || (held_i == 8'hFF && !argument[`MB_ARG_ZERO]))",
        "zero_q",
    ),
    Mistake("extra_bytes_accepted", "modbus_sequencer.v", "no_words_q : left_q", "no_words_q : 1'b0"),
    Mistake("byte_count_not_compared", "modbus_sequencer.v", "| (is_byte_count & clock_3 & ~count_held_q)", ""),
    Mistake(
        "end_of_address_space_wraps",
        "modbus_range.v",
        "assign past_end_o = past_ffff_q | (",
        "assign past_end_o = (",
    ),
    Mistake("table_one_item_too_long", "modbus_bank_guard.v", "(last_i <= high)", "(last_i <= high + 16'd1)"),
    Mistake("first_address_not_compared", "modbus_bank_guard.v", "(first_i >= low) & ", ""),
    Mistake(
        "read_only_range_open_at_its_end", "modbus_bank_guard.v", "(first <= RO_LAST[15:0])", "(first < RO_LAST[15:0])"
    ),
    Mistake(
        "refusal_taken_for_a_grant",
        "modbus_burst.v",
        """grant_ack_i & (exception_i == 4'd0);
  wire refused  = asks & (past_end_i | (grant_ack_i ? exception_i != 4'd0 : stall_i));""",
        """grant_ack_i;
  wire refused  = asks & (past_end_i | (~grant_ack_i & stall_i));""",
    ),
    Mistake(
        "second_question_left_out",
        "modbus_routines_data.vh",
        """  `DO(GRANT_READ)
  `DO(NEXT_IF_READY)
  `DO(ADDRESS)
""",
        """  `DO(NEXT_IF_READY)
  `DO(ADDRESS)
""",
    ),
    Mistake(
        "bus_error_not_noticed",
        "modbus_burst.v",
        "stb & (wb_err_i | (stall_i & ~wb_ack_i))",
        "stb & stall_i & ~wb_ack_i",
    ),
    Mistake(
        "stall_in_the_burst_for_ever",
        "modbus_burst.v",
        "stb & (wb_err_i | (stall_i & ~wb_ack_i))",
        "stb & wb_err_i",
    ),
    Mistake(
        "busy_ignored",
        "modbus_sequencer.v",
        "unready_q    <= busy_i ? `MB_EX_DEVICE_BUSY : failure_i;",
        "unready_q    <= failure_i;",
    ),
    Mistake("unused_bits_not_zero", "modbus_burst.v", "{data[0] & beat, held_q[7:1]}", "{data[0], held_q[7:1]}"),
    Mistake("address_stands_still_in_a_burst", "modbus_range.v", "{{15{set_address}}, 1'b1}", "16'd0"),
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
    Mistake(
        "host_breaks_into_a_burst",
        "modbus_bank_ram.v",
        "host_cyc_i & (host_q | ~wb_cyc_i) & ~rst_i",
        "host_cyc_i & ~rst_i",
    ),
    Mistake(
        "write_pulse_for_reads_too",
        "modbus_sequencer.v",
        "assign write_stb_o = is_tell;",
        "assign write_stb_o = is_tell | (is_grant & done_i);",
    ),
    # the line
    Mistake(
        "broadcast_taken_for_a_foreign_frame",
        "modbus_frame_rx.v",
        "wire for_us    = for_all | ",
        "wire for_us    = ",
    ),
    Mistake(
        "after_a_restart_the_line_is_heard_at_once",
        "modbus_routines_frame.vh",
        "WAIT | ACTIVE | EMPTY | LINE",
        "WAIT | ACTIVE | EMPTY",
    ),
    # what is counted
    Mistake(
        "foreign_frames_not_counted",
        "modbus_routines_frame.vh",
        """  `DO(COUNT(`MB_CPT_BUS_MESSAGE, `MB_WHEN_ALWAYS))
  `DO(REST)
""",
        """  `DO(REST)
""",
    ),
    Mistake(
        "exceptions_not_counted",
        "modbus_routines_answer.vh",
        "`DO(COUNT(`MB_CPT_EXCEPTION, `MB_WHEN_EXCEPTION))",
        "`DO(COUNT(`MB_CPT_EXCEPTION, `MB_WHEN_LONG))",
    ),
    Mistake(
        "exception_07_counted_as_busy",
        "modbus_routines_answer.vh",
        "`DO(COUNT(`MB_CPT_BUSY, `MB_WHEN_BUSY))",
        "`DO(COUNT(`MB_CPT_BUSY, `MB_WHEN_NAK))",
    ),
    Mistake(
        "exception_in_a_broadcast_counted_as_answered",
        "modbus_sequencer.v",
        "wire refusal = failed_q & ~broadcast_q;",
        "wire refusal = failed_q;",
    ),
    Mistake(
        "broadcast_counted_as_answered",
        "modbus_routines_answer.vh",
        "`DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_BROADCAST))",
        "`DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_LONG))",
    ),
    Mistake("counted_twice", "modbus_diagnostics.v", "{{15{fresh}}, 1'b1}", "16'd2"),
    Mistake("counter_stops_at_its_end", "modbus_diagnostics.v", "{{15{fresh}}, 1'b1}", "{15'd0, ~&word_q}"),
    Mistake(
        "wrong_counter",
        "modbus_routines_frame.vh",
        "`DO(COUNT(`MB_CPT_SLAVE_MESSAGE, `MB_WHEN_ALWAYS))",
        "`DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_ALWAYS)) ",
    ),
    Mistake(
        "last_counter_not_cleared",
        "modbus_routines_frame.vh",
        """  `DO(CLEAR(`MB_CPT_OVERRUN))
""",
        "",
    ),
    Mistake("event_counter_counts_0b", "modbus_routines_diagnostics.vh", "GO(TAIL_NO_EVENT)", "GO(TAIL)"),
    Mistake(
        "event_counter_counts_exceptions",
        "modbus_routines_answer.vh",
        "`DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_SUCCESS))",
        "`DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_ALWAYS))",
    ),
    Mistake(
        "listen_only_request_does_not_count_as_success",
        "modbus_routines_diagnostics.vh",
        """  `DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_ALWAYS))
  `DO(COUNT(`MB_CPT_NO_RESPONSE""",
        "  `DO(COUNT(`MB_CPT_NO_RESPONSE",
    ),
    Mistake(
        "counter_port_acknowledges_too_early",
        "modbus_diagnostics.v",
        "wire       host  = ~ours & ~read_i;",
        "wire       host  = 1'b1;",
    ),
    # the event log
    Mistake("log_order_reversed", "modbus_diagnostics.v", "(logging ? 6'h3F : wanted)", "(logging ? 6'h01 : wanted)"),
    Mistake("log_grows_beyond_64", "modbus_diagnostics.v", "entries_q != LOG_ENTRIES", "entries_q != 7'd127"),
    Mistake("log_holds_63", "modbus_diagnostics.v", "LOG_ENTRIES = 7'd64", "LOG_ENTRIES = 7'd63"),
    Mistake("log_not_emptied_by_ff00", "modbus_diagnostics.v", "if (do_i[`MB_DO_EMPTY]) entries_q <= 7'd0;", ""),
    Mistake(
        "log_emptied_by_0000",
        "modbus_sequencer.v",
        "argument[`MB_MODE_EMPTY] & held_i[0]",
        "argument[`MB_MODE_EMPTY]",
    ),
    Mistake(
        "broadcast_bit_of_the_receive_event",
        "modbus_routines_frame.vh",
        "LOG_RECEIVED(EVENT_RECEIVED)",
        "LOG(EVENT_RECEIVED)",
    ),
    Mistake(
        "listen_only_bit_of_the_events",
        "modbus_sequencer.v",
        "& broadcast_q, listen_only_i,",
        "& broadcast_q, 1'b0,",
    ),
    Mistake("overrun_bit_of_the_receive_event", "modbus_routines_frame.vh", "LOG_BAD(EVENT_BAD)", "LOG(EVENT_BAD)"),
    Mistake("busy_bit_of_the_send_event", "modbus_sequencer.v", "code_q == 4'd5 || code_q == 4'd6", "code_q == 4'd6"),
    Mistake(
        "send_event_of_no_exception",
        "modbus_sequencer.v",
        "sent & {4{argument[`MB_ARG_REFUSAL] & refusal}}",
        "sent & {4{argument[`MB_ARG_REFUSAL]}}",
    ),
    Mistake(
        "log_without_the_entry_into_listen_only",
        "modbus_routines_diagnostics.vh",
        """  `DO(LOG(EVENT_LISTEN))
""",
        "",
    ),
    Mistake(
        "restart_not_logged",
        "modbus_routines_frame.vh",
        """  `DO(LOG(EVENT_RESTART))
""",
        "",
    ),
    # listen-only mode, restart, the diagnostic register
    Mistake(
        "listen_only_left_by_a_broadcast",
        "modbus_routines_frame.vh",
        "`DO(GO_IF_UNICAST(`NEXT))",
        "`DO(GO(`NEXT))",
    ),
    Mistake("listen_only_not_left", "modbus_routines_frame.vh", "WAIT | ACTIVE | EMPTY", "WAIT | EMPTY"),
    Mistake(
        "listen_only_left_by_any_sub_function",
        "modbus_routines_frame.vh",
        "`DO(MATCH(8'h01, `MB_EX_ILLEGAL_FUNCTION))",
        "`DO(SKIP_BYTE)",
    ),
    Mistake(
        "listen_only_left_by_a_longer_request",
        "modbus_sequencer.v",
        "(is_end | (is_coil & clock_4))",
        "(is_end | (is_coil & clock_4 & ~listen_only_i))",
    ),
    Mistake(
        "exception_in_listen_only_answered",
        "modbus_routines_answer.vh",
        """  if (HAS_DIAGNOSTICS != 0) begin
    `DO(IF_LISTENING(DONE))
  end
""",
        "",
    ),
    Mistake(
        "restart_without_clearing",
        "modbus_routines_frame.vh",
        """  `DO(LOG(EVENT_RESTART))
  `FALL_INTO(CLEARING)""",
        """  `DO(LOG(EVENT_RESTART))
  `DO(REST)""",
    ),
    Mistake(
        "restart_clears_the_diagnostic_register",
        "modbus_routines_frame.vh",
        "WAIT | ACTIVE | EMPTY",
        "WAIT | ACTIVE | REGISTER | EMPTY",
    ),
    Mistake(
        "clearing_leaves_the_diagnostic_register",
        "modbus_routines_diagnostics.vh",
        "MODE(WAIT | REGISTER)",
        "MODE(WAIT)",
    ),
    Mistake(
        "overrun_flag_not_set",
        "modbus_routines_frame.vh",
        """  `DO(MODE(TOO_LONG))
""",
        "",
    ),
    Mistake("overrun_flag_not_cleared_by_0014", "modbus_routines_diagnostics.vh", "MODE(WAIT | OVERRUN)", "MODE(WAIT)"),
    Mistake(
        "overrun_counter_not_cleared_by_0014",
        "modbus_routines_diagnostics.vh",
        """  `DO(CLEAR(`MB_CPT_OVERRUN))
""",
        "",
    ),
    Mistake(
        "diagnostic_bits_do_not_stay",
        "modbus_diagnostics.v",
        "(do_i[`MB_DO_CLEAR_REGISTER] ? 15'd0 : register_q[15:1]) | diagnostic_i",
        "diagnostic_i",
    ),
    # function codes 07, 08, 0B, 11
    Mistake(
        "exception_status_not_given",
        "modbus_engine.v",
        "chosen = exception_status;",
        "chosen = 8'h00;",
    ),
    Mistake(
        "data_of_08_not_judged",
        "modbus_sequencer.v",
        "(held_i == 8'hFF && !argument[`MB_ARG_ZERO])",
        "(held_i == 8'hFF)",
    ),
    Mistake(
        "high_byte_of_the_sub_function_ignored",
        "modbus_routines_diagnostics.vh",
        "`DO(MATCH(8'h00, `MB_EX_ILLEGAL_FUNCTION))",
        "`DO(SKIP_BYTE)",
    ),
    Mistake(
        "odd_query_data_returned",
        "modbus_sequencer.v",
        "(count_i == 9'd0) | count_i[0] | count_i[8];",
        "(count_i == 9'd0) | count_i[8];",
    ),
    Mistake(
        "low_byte_of_the_delimiter_ignored",
        "modbus_routines_diagnostics.vh",
        "`DO(MATCH(8'h00, `MB_EX_ILLEGAL_DATA_VALUE))",
        "`DO(SKIP_BYTE)",
    ),
    Mistake(
        "sub_function_0013_is_there",
        "modbus_routines_tables.vh",
        "  `ENTRY(SUB_TABLE, 'h14, GO(SUB_OVERRUN))",
        """  `ENTRY(SUB_TABLE, 'h13, GO(SUB_OVERRUN))
  `ENTRY(SUB_TABLE, 'h14, GO(SUB_OVERRUN))""",
    ),
    Mistake("busy_not_in_the_status_word", "modbus_engine.v", "{8{host_state_i[`MB_HOST_BUSY]}}", "8'h00"),
    Mistake(
        "run_indicator_inverted",
        "modbus_engine.v",
        "{8{host_state_i[`MB_HOST_RUN]}}",
        "{8{~host_state_i[`MB_HOST_RUN]}}",
    ),
    Mistake(
        "additional_data_dropped",
        "modbus_routines_identity.vh",
        "  if (ADDITIONAL_DATA_BYTES > 0) begin",
        "  if (ADDITIONAL_DATA_BYTES < 0) begin",
    ),
    # function code 18
    Mistake("queue_of_32_read", "modbus_routines_data.vh", "DEPTH_UP_TO(FIFO_MOST)", "DEPTH_UP_TO(FIFO_MOST + 11'd1)"),
    Mistake(
        "rest_of_the_queue_not_asked_for",
        "modbus_routines_data.vh",
        """  `DO(ADDRESS)
  `DO(GRANT_READ)
  `DO(NEXT_IF_READY)
  `DO(READ_TO_CLEAR(AT_FIFO))""",
        """  `DO(ADDRESS)
  `DO(NEXT_IF_READY)
  `DO(READ_TO_CLEAR(AT_FIFO))""",
    ),
    # function codes 14, 15
    Mistake(
        "length_of_the_file_answer_not_judged",
        "modbus_sequencer.v",
        "| (is_total & clock_4 & found_i[`MB_FOUND_TOO_LONG])",
        "",
    ),
    Mistake("length_of_the_file_answer_one_too_much", "modbus_range.v", "NO_GROUP = 8'd5", "NO_GROUP = 8'd4"),
    Mistake(
        "reference_type_of_a_read_ignored",
        "modbus_routines_files.vh",
        """  `DO(MATCH(REFERENCE_TYPE, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))""",
        """  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))""",
    ),
    Mistake(
        "reference_type_of_a_write_ignored",
        "modbus_routines_files.vh",
        """  `DO(MATCH(REFERENCE_TYPE, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))""",
        """  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))""",
    ),
    Mistake(
        "records_beyond_270f",
        "modbus_range.v",
        "past_record_q <= last_q[15]",
        "past_record_q <= 1'b0 & last_q[15]",
    ),
    Mistake("file_0_is_there", "modbus_bank_guard.v", " & few != {FW{1'b0}}", ""),
    Mistake("any_file_is_there", "modbus_bank_guard.v", "~many & ", ""),
    Mistake(
        "second_group_written_before_it_is_granted",
        "modbus_routines_files.vh",
        """  `DO(PASS_OVER)
  `DO(IF_LEFT(loop))
  `DO(NEXT_IF_READY)""",
        """  `DO(PASS_OVER)
  `DO(IF_LEFT(`NEXT))
  `DO(NEXT_IF_READY)""",
    ),
    Mistake("write_of_a_file_asked_for_as_a_read", "modbus_routines_files.vh", "GRANT_WRITE", "GRANT_READ"),
    Mistake(
        "data_of_a_file_write_not_passed_over",
        "modbus_routines_files.vh",
        """  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(PASS_OVER)
""",
        """  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
""",
    ),
    Mistake(
        "host_not_told_of_file_records",
        "modbus_routines_files.vh",
        """  `DO(TELL)
""",
        "",
    ),
    Mistake(
        "bus_let_go_between_groups",
        "modbus_routines_files.vh",
        "  `DO(WRITE_HERE_KEEP)",
        "  `DO(WRITE_HERE_KEEP & ~(16'd1 << `MB_ARG_KEEP))",
    ),
    Mistake(
        "answer_of_15_without_its_length",
        "modbus_routines_files.vh",
        """  `DO(RECALL)
  `DO(POINT(AT_FRAME))""",
        "  `DO(POINT(AT_FRAME))",
    ),
    Mistake("length_byte_of_a_group", "modbus_range.v", "{quantity, 1'b1};", "{quantity_less_one_q[6:0], 1'b1};"),
    # function code 2B
    Mistake(
        "no_fallback_to_the_first_object",
        "modbus_identity.v",
        "(most == 1) ? `MB_TEXT_NONE : `MB_TEXT_LAST",
        "`MB_TEXT_NONE",
    ),
    Mistake(
        "object_that_is_not_there_answered_alone",
        "modbus_routines_identity.vh",
        "`DO(MATCH(`MB_TEXT_LAST, `MB_EX_ILLEGAL_DATA_ADDRESS))",
        "`DO(SKIP_BYTE)",
    ),
    Mistake(
        "next_object_is_the_first",
        "modbus_identity.v",
        "OBJECT_TEXT[8*(from+bytes) +: 8] : 8'h00;",
        "OBJECT_TEXT[8*from +: 8] : 8'h00;",
    ),
    Mistake(
        "objects_one_byte_too_long",
        "modbus_identity.v",
        "HEAD + bytes + size > DEVICE_ID_LIMIT",
        "HEAD + bytes + size > DEVICE_ID_LIMIT + 1",
    ),
    Mistake(
        "single_objects_in_spite_of_the_conformity",
        "modbus_routines_identity.vh",
        "CONFORMITY[7] ? 11'd4 : 11'd3",
        "11'd4",
    ),
    Mistake(
        "conformity_without_bit_7",
        "modbus_routines_identity.vh",
        "`DO(LITERAL(CONFORMITY))",
        "`DO(LITERAL({1'b0, CONFORMITY[6:0]}))",
    ),
    Mistake("code_3_answers_at_level_1", "modbus_identity.v", "SECTION_3 : SECTION_OF_2", "SECTION_3 : SECTION_1"),
    Mistake(
        "other_mei_types_taken_for_0e",
        "modbus_routines_identity.vh",
        "`DO(MATCH(MEI_DEVICE_ID, `MB_EX_ILLEGAL_FUNCTION))",
        "`DO(SKIP_BYTE)",
    ),
    # the host's say
    Mistake("failure_ignored", "modbus_sequencer.v", "`MB_EX_DEVICE_BUSY : failure_i;", "`MB_EX_DEVICE_BUSY : 4'd0;"),
    Mistake(
        "failure_goes_before_busy",
        "modbus_sequencer.v",
        "`MB_EX_DEVICE_BUSY : failure_i;",
        "(failure_i | `MB_EX_DEVICE_BUSY) : failure_i;",
    ),
    Mistake("too_much_from_the_user_not_noticed", "modbus_engine.v", "(refuses | excess)", "refuses"),
    Mistake(
        "silent_user_waited_for_for_ever",
        "modbus_engine.v",
        "(refuses | excess) : stall_i);",
        "(refuses | excess) : 1'b0);",
    ),
    Mistake("broadcasts_offered_to_the_user", "modbus_sequencer.v", "& ~byte_i[7] & ~broadcast_q;", "& ~byte_i[7];"),
    Mistake("user_may_not_pass", "modbus_sequencer.v", "(is_offer & finished_q & ~same_q)", "(is_offer & finished_q)"),
    Mistake(
        "user_put_after_the_end",
        "modbus_engine.v",
        "assign user_put  = offer & wants & ~full;",
        "assign user_put  = wants & ~full;",
    ),
    Mistake(
        "loop_of_a_read_of_files_runs_once",
        "modbus_routines_files.vh",
        """  `DO(SWAP)
  `DO(IF_LEFT(loop))
  `DO(SWAP)
""",
        """  `DO(SWAP)
  `DO(IF_LEFT(`NEXT))
  `DO(SWAP)
""",
    ),
    Mistake(
        "function_code_with_an_entry_of_another",
        "modbus_routines_tables.vh",
        "GO_IF_UNICAST(READ_DISCRETES)",
        "GO_IF_UNICAST(READ_COILS)",
    ),
    Mistake(
        "other_function_codes_taken_for_2b",
        "modbus_program.v",
        "      `DO(IF_EQUAL(here + 2)) \\\n",
        "      `DO(GO(here + 2)) \\\n",
    ),
    Mistake(
        "last_address_moves_with_the_burst",
        "modbus_range.v",
        "if (!moving_i) {past_ffff_q, last_q}",
        "{past_ffff_q, last_q}",
    ),
    Mistake(
        "bit_byte_count_rounded_down",
        "modbus_range.v",
        "quantity_less_one_q[10:3];",
        "{quantity_less_one_q[10:3] - 8'd1};",
    ),
    Mistake(
        "single_item_is_two",
        "modbus_range.v",
        "if (do_i[`MB_DO_ONE] || set_first)      quantity_less_one_q <= 16'd0;",
        "if (do_i[`MB_DO_ONE] || set_first)      quantity_less_one_q <= 16'd1;",
    ),
    Mistake(
        "burst_ends_an_item_early",
        "modbus_burst.v",
        "ended_q <= at_last_i;",
        "ended_q <= at_last_i | (next_o & bit_q == 3'd6);",
    ),
    Mistake(
        "bits_packed_from_the_top",
        "modbus_burst.v",
        "{data[0] & beat, held_q[7:1]}",
        "{held_q[6:0], data[0] & beat}",
    ),
    Mistake(
        "question_for_a_range_past_the_end",
        "modbus_burst.v",
        "wire question = asks & ~past_end_i;",
        "wire question = asks;",
    ),
    Mistake("step_of_two_clocks_ends_after_one", "modbus_sequencer.v", "(two_q & clock_2)", "two_q"),
    Mistake(
        "place_of_a_burst_not_pointed_at",
        "modbus_sequencer.v",
        "((is_put | is_burst) & clock_1",
        "(is_put & clock_1",
    ),
    Mistake("entry_1f_is_that_of_sub_function_1f", "modbus_sequencer.v", "{5{byte_i[7:5] != 3'd0}}", "{5{byte_i[7]}}"),
    Mistake(
        "status_port_answers_before_the_counters_are_cleared",
        "modbus_diagnostics.v",
        "host & status_stb_i & ready_q & ~ack_q",
        "host & status_stb_i & ~ack_q",
    ),
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
    Mistake("axil_verdict_with_an_error", "modbus_bank_guard.v", "(ack_o & bad_q)", "bad_q"),
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
    Mistake("cpu_error_not_told", "modbus_axil_slave.v", "bad_q <= host_err_i;", "bad_q <= 1'b0;"),
    Mistake(
        "cpu_response_falls",
        "modbus_axil_slave.v",
        "(rvalid_q & ~s_axil_rready)",
        "(rvalid_q & s_axil_rready & 1'b0)",
    ),
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
        "(s_axil_awvalid | s_axil_arvalid) & ~burst",
        "(s_axil_awvalid | s_axil_arvalid)",
    ),
    Mistake(
        "soc_axil_burst_of_one_beat",
        "modbus_axil_master.v",
        "assign burst_o = wb_cyc_i;",
        "assign burst_o = stb;",
    ),
]

# What is tried, in this order; the quickest that notices most comes first:
# (suite of test_modules.py, test_system.py or test_buses.py, regular expression of its cocotb tests), or the compiled
# slave and how many requests of random traffic it gets. A module alone is left out when the mistake is in none of its
# files.
COMPILED = "random traffic"
MODULES_ALONE = {
    "crc16": ("modbus_crc16.v",),
    "uart_tx": ("modbus_uart_tx.v", "modbus_crc16.v"),
    "line_timer_characters": ("modbus_line_timer.v",),
    "frame_rx": ("modbus_frame_rx.v",),
    "bank_guard": ("modbus_bank_guard.v",),
    "sequencer": ("modbus_sequencer.v",),
    "range": ("modbus_range.v",),
    "burst": ("modbus_burst.v",),
    "frame_ram": ("modbus_frame_ram.v",),
    "diagnostics": ("modbus_diagnostics.v",),
}
# Suites of test_buses.py, and the files that they alone are about.
BUSES = {
    "axil_master": ("modbus_axil_master.v",),
    "axil_slave": ("modbus_axil_slave.v",),
    "soc_axil": ("modbus_axil_master.v", "modbus_example_soc_axil.v"),
    "soc_wishbone": ("modbus_example_soc_wb.v",),
}
SELECTION = [
    *((suite, None) for suite in MODULES_ALONE),
    ("power_up", None),
    (COMPILED, 2000),
    ("functions_mapped", "single_coil|byte_count|length_is_exact|unsupp|mask|broadcast|lock|read_only|order|share"),
    ("functions_mapped", "address_limits|align|read_write|limits.*code=(3|15|16)"),
    (
        "line_faults",
        "gap=(1.2|2.0).count_only|add_up|parity|framing|second_stop|long_frames|truncated|short_frames|swapped|traffic"
        "|own_|breaks|right_after|during|after_reset",
    ),
    ("options", "delay=(0|7)$|tail=6|tearing|any_time|every_table"),
    ("core_bus", "wait=(0|7)$|code=(4|10)$|second_range|past|stall|busy|no_access|in_order"),
    ("speed", "case=(0|16|24)$|to_the_bit"),
    ("identity_01", None),
    ("identity_82", None),
    ("identity_small", None),
    ("fifo", None),
    ("user_port", None),
    ("core_files", "waits$|wait=0|refused|error|stall|longest|busy"),
    ("diagnostics_counters", None),
    ("diagnostics_modes", None),
    ("files", None),
    *((suite, None) for suite in BUSES),
]


def planted(mistake, folder):
    """Copy the Verilog to `folder` with the mistake in it."""
    shutil.rmtree(folder, ignore_errors=True)
    for tree in TREES:
        shutil.copytree(ROOT / tree, folder / tree)
    if mistake is None:
        return
    path = next(folder.glob(f"*/**/{mistake.file}"))
    text = path.read_text(encoding="utf-8")
    found = text.count(mistake.old)
    if found != 1:
        sys.exit(f"{mistake.name}: the pattern is {found} times in {mistake.file}: {mistake.old}")
    path.write_text(text.replace(mistake.old, mistake.new), encoding="utf-8")


def concerns(suite, file):
    """True if a suite can notice a mistake in this file."""
    if suite in BUSES or any(file in files for files in BUSES.values()):
        return file in BUSES.get(suite, ())
    return file in MODULES_ALONE.get(suite, (file,))


def judge(touched):
    """In a process whose TREE= names the copy: run the selection until a test fails; print what failed.

    `touched`: the file that the mistake is in, or "".
    """
    sys.path[:0] = [str(TB), str(ROOT / "tools")]
    os.environ["PYTHONPATH"] = os.pathsep.join([str(TB), *filter(None, [os.environ.get("PYTHONPATH")])])
    failed = []
    for number, (suite, part) in enumerate(SELECTION):
        if touched and not concerns(suite, touched):
            continue
        failed = compiled(part) if suite == COMPILED else simulated(suite, part, number)
        if failed:
            break
    print(json.dumps(failed))


def simulated(suite, only, number):
    """Failed tests of a suite."""
    import test_buses
    import test_modules
    import test_system
    from harness.runner import run

    if suite in test_modules.MODULES:
        top, parameters, module = test_modules.MODULES[suite]
    elif suite in test_buses.SUITES:
        top, parameters, module, only = test_buses.SUITES[suite]
        module = f"bus.{module}"
    else:
        top, parameters, module, whole = test_system.SUITES[suite]
        module, only = f"system.{module}", only or whole
    recorded = {}
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            run(recorded.__setitem__, "icarus", top, module, parameters, only=only, own=f"{number}_{suite}")
    except BaseException as problem:  # pytest's outcomes are no Exceptions
        tests = [t.split(".", 2)[-1] for t, ok in recorded.get("cocotb", []) if not ok]
        return [f"{suite}: {t}" for t in tests] or [f"{suite}: {str(problem).splitlines()[0]}"]
    return []


def compiled(count):
    """What random traffic on the compiled slave shows, as a list of none or one."""
    from differential.test_differential import MAPS, SETTINGS_EVERY, Match

    if not shutil.which("verilator"):
        print("verilator is not installed: no compiled slave", file=sys.stderr)
        return []
    match = Match(MAPS["mapped"], "mistakes")
    for number in range(count):
        try:
            if number % SETTINGS_EVERY == 0:
                match.settings()
            match.step()
        except AssertionError as problem:
            print(f"request {number}: {problem}", file=sys.stderr)
            return [f"{COMPILED}, compiled"]
    try:
        match.compare(whole=True)
    except AssertionError as problem:
        print(problem, file=sys.stderr)
        return [f"{COMPILED}, compiled: memory at the end"]
    return []


def run_one(mistake):
    """(mistake, failed tests or None for an accident, seconds)."""
    name = mistake.name if mistake else "untouched"
    folder = WORK / name
    planted(mistake, folder / "tree")
    places = {"TREE": str(folder / "tree"), "BENCH_BUILD": str(folder / "build")}
    env = {**os.environ, **places, "COCOTB_LOG_LEVEL": "ERROR"}
    for variable in ("WAVES", "CASE"):
        env.pop(variable, None)
    begun = time.monotonic()
    log = folder / "log"
    with log.open("w", encoding="utf-8") as messages:
        try:
            done = subprocess.run(
                [sys.executable, __file__, "--judge", mistake.file if mistake else ""],
                env=env,
                stdout=subprocess.PIPE,
                stderr=messages,
                text=True,
                timeout=TIMEOUT_SECONDS,
                check=False,
            )
            failed = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else None
        except subprocess.TimeoutExpired:
            failed = [f"no end within {TIMEOUT_SECONDS} s"]
    return mistake, failed, time.monotonic() - begun


def main(part):
    """Run all mistakes whose name contains `part`; the exit status."""
    chosen = [m for m in MISTAKES if part in m.name]
    if not chosen:
        sys.exit(f"no mistake has {part!r} in its name")
    WORK.mkdir(parents=True, exist_ok=True)
    lock = (WORK / "lock").open("w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit("another `make mistakes` is running in this checkout")
    for mistake in chosen:  # patterns first: a stale one shall not cost minutes
        planted(mistake, WORK / mistake.name / "tree")
    _, failed, seconds = run_one(None)
    print(f"untouched: {'passes' if failed == [] else f'FAILS: {failed}'} ({seconds:.0f} s)", flush=True)
    if failed != []:
        return 1
    lines = ["| Mistake | In | Caught by |", "|---|---|---|"]
    missed = []
    with ThreadPoolExecutor(WORKERS) as pool:
        for mistake, failed, seconds in pool.map(run_one, chosen):
            if not failed:
                missed.append(mistake.name)
            more = f" and {len(failed) - 1} more" if failed and len(failed) > 1 else ""
            caught = f"{failed[0]}{more}" if failed else "NOT CAUGHT" if failed == [] else "did not run, see its log"
            print(f"{mistake.name}: {caught} ({seconds:.0f} s)", flush=True)
            lines.append(f"| {mistake.name.replace('_', ' ')} | `{mistake.file}` | {caught} |")
    (WORK / "table.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{len(chosen) - len(missed)} of {len(chosen)} mistakes caught; {WORK / 'table.md'}")
    return 1 if missed else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--judge"]:
        judge(sys.argv[2])
    else:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else ""))
