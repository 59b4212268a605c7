# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the engine: a frame becomes an answer."""

from .kinds import Mistake

MISTAKES = [
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
        "past_end_q <= past_ffff_q | (",
        "past_end_q <= (",
    ),
    Mistake(
        "refusal_taken_for_a_grant",
        "modbus_burst.v",
        """grant_ack_i & (exception_i == 4'd0);
  wire refused  = asks & (past_end_i | (grant_ack_i ? exception_i != 4'd0 : stall_i));""",
        """grant_ack_i;
  wire refused  = asks & (past_end_i | (~grant_ack_i & stall_i));""",
    ),
    Mistake("value_stored_while_checked", "modbus_engine.v", "checks ? `MB_CHECK_OF(space) : space", "space"),
    Mistake("mask_write_not_checked", "modbus_routines_data.vh", "  `CHECKED(AT_SCRATCH, AT_ADDRESS)\n", ""),
    Mistake("single_write_not_checked", "modbus_routines_data.vh", "  `CHECKED(AT_VALUE, AT_ADDRESS)\n", ""),
    Mistake(
        "read_write_checks_another_range",
        "modbus_routines_data.vh",
        "`CHECKED(AT_RW_DATA, AT_RW_WRITE)",
        "`CHECKED(AT_RW_DATA, AT_ADDRESS)",
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
    Mistake("unused_bits_not_zero", "modbus_burst.v", "(wb_dat_i[7:0] & {8{stb}})", "wb_dat_i[7:0]"),
    Mistake("address_stands_still_in_a_burst", "modbus_range.v", "{{15{set_address}}, 1'b1}", "16'd0"),
    Mistake(
        "write_pulse_for_reads_too",
        "modbus_sequencer.v",
        "assign write_stb_o = is_tell;",
        "assign write_stb_o = is_tell | (is_grant & done_i);",
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
        "`DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_UNSENT))",
        "`DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_LONG))",
    ),
    Mistake(
        "dropped_answer_counted_as_sent",
        "modbus_sequencer.v",
        "`MB_WHEN_UNSENT:    applies = left_q;",
        "`MB_WHEN_UNSENT:    applies = broadcast_q;",
    ),
    Mistake("counted_twice", "modbus_diagnostics.v", "word_q + 16'd1", "word_q + 16'd2"),
    Mistake("counter_stops_at_its_end", "modbus_diagnostics.v", "word_q + 16'd1", "word_q + {15'd0, ~&word_q}"),
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
        "(is_end & clock_2) | (is_coil & clock_4)",
        "(is_end & clock_2) | (is_coil & clock_4 & ~listen_only_i)",
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
        "| (is_total & clock_2 & found_i[`MB_FOUND_TOO_LONG])",
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
    Mistake("user_may_not_pass", "modbus_sequencer.v", "(is_offer & finished_q & ~pass_q)", "(is_offer & finished_q)"),
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
        "if (do_i[`MB_DO_ONE] || set_first)     quantity_less_one_q <= 16'd0;",
        "if (do_i[`MB_DO_ONE] || set_first)     quantity_less_one_q <= 16'd1;",
    ),
    Mistake(
        "burst_ends_an_item_early",
        "modbus_burst.v",
        "(ack & at_last_i));",
        "(ack & (at_last_i | bit_q == 3'd6)));",
    ),
    Mistake(
        "bits_packed_from_the_top",
        "modbus_burst.v",
        "{low_q[0], held_q[7:1]}",
        "{held_q[6:0], low_q[0]}",
    ),
    # sixteen bits a beat
    Mistake("wide_bits_turned_the_wrong_way", "modbus_burst.v", "3'd0 - first_i[2:0]", "first_i[2:0]"),
    Mistake("wide_read_puts_a_byte_too_many", "modbus_burst.v", "(gone_q & fit_i)", "1'b0"),
    Mistake("wide_read_shows_items_behind_the_last", "modbus_burst.v", "wb_dat_i & kept", "wb_dat_i"),
    Mistake("wide_read_keeps_the_byte_before_the_first", "modbus_burst.v", "first_i[3] ^ across", "across"),
    Mistake("wide_write_always_begins_in_the_low_byte", "modbus_burst.v", "wide & ~first_i[3];", "wide;"),
    Mistake("wide_beat_moves_on_by_one_item", "modbus_range.v", "first_q[3:0] | lanes} + ", "first_q[3:0]} + "),
    Mistake("wide_burst_ends_with_its_last_item_alone", "modbus_range.v", "last_q[3:0]) | lanes[0])", "last_q[3:0]))"),
    Mistake(
        "question_for_a_range_past_the_end",
        "modbus_burst.v",
        "wire question = asks & ~past_end_i;",
        "wire question = asks;",
    ),
    Mistake("high_byte_of_a_write_lost_in_a_wait_state", "modbus_burst.v", "if (!item_q || !writes) late_q", "late_q"),
    Mistake("bits_behind_the_first_one_place_off", "modbus_burst.v", "late_q[0] : held_q[1]", "late_q[0] : held_q[0]"),
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
]
