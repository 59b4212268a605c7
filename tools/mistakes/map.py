# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Deliberate mistakes in the map compiler: what it judges, the Verilog that it writes, and the outputs beside it."""

from .kinds import Mistake

PLAN, BANK, CHECKS = "rtl_plan.py", "rtl_bank.py", "checks.py"

MISTAKES = [
    # The generated bank
    Mistake(
        "compiler_value_is_stored_word_by_word", BANK, "if (write_holding && closes && (", "if (write_holding && ("
    ),
    Mistake("compiler_words_outside_the_request_are_stored", BANK, 'f"  if (covered[{word}]) {stored}', 'f"  {stored}'),
    Mistake("compiler_value_is_loaded_at_each_word", BANK, "(~begun | part == {zero}", "(1'b1 | part == {zero}"),
    Mistake(
        "compiler_words_of_an_input_exchanged", PLAN, "word if point.word_order == ", "word if point.word_order != "
    ),
    Mistake("compiler_read_rights_for_writes", PLAN, "(p.writable if write else p.readable)", "p.readable"),
    Mistake("compiler_row_ends_one_late", PLAN, "[Row(low, high) for", "[Row(low, min(high + 1, 65535)) for"),
    Mistake(
        "compiler_file_is_a_record_too_long", PLAN, "Row(0, f.records - 1, f.number)", "Row(0, f.records, f.number)"
    ),
    Mistake("compiler_read_only_file_is_written", PLAN, '== "rw" or not write]', '== "rw" or True]'),
    Mistake("compiler_gap_shows_an_item", BANK, "_is ? {value} : {width}'d0\"", "_is | 1'b1 ? {value} : {width}'d0\""),
    Mistake(
        "compiler_strobe_at_each_word",
        BANK,
        'closes = " && closes" if point.width > 1',
        'closes = "" if point.width > 1',
    ),
    Mistake(
        "compiler_reads_back_what_was_written_before_a_reset",
        BANK,
        'kept += [f"{name}_written_q <= {literal(point.size, 0)};"]',
        'kept += [f"{name}_written_q <= {name}_written_q;"]',
    ),
    Mistake(
        "compiler_reads_back_in_every_space", BANK, "<= written & (space == {SPACE_NAMES[3]})", "<= written & words"
    ),
    Mistake("compiler_limits_of_a_part", BANK, 'closes = " & closes" if plan', 'closes = "" if plan'),
    Mistake(
        "compiler_limit_is_one_low",
        BANK,
        "return order(point, low), order(point, high)",
        "return order(point, low), order(point, high) - 1",
    ),
    Mistake("compiler_signs_compare_as_unsigned", BANK, "        return raw ^ top\n", "        return raw\n"),
    Mistake("compiler_listed_values_are_a_range", BANK, '["~listed"] * bool', "[\"1'b0\"] * bool"),
    Mistake("compiler_snapshot_by_a_zero", BANK, '& wb_dat_i[0];"', "& (wb_dat_i[0] | 1'b1);\""),
    Mistake(
        "compiler_snapshot_has_no_reset",
        BANK,
        "_frozen_q <= {literal(f.bits * f.count, whole_reset(f))};",
        "_frozen_q <= {literal(f.bits * f.count, whole_reset(f) + 1)};",
    ),
    Mistake(
        "compiler_reset_of_item_0_for_all",
        BANK,
        "sum(raw << (n * point.bits) for n, raw",
        "sum(point.resets[0] << (n * point.bits) for n, raw",
    ),
    Mistake(
        "compiler_memory_begins_empty",
        BANK,
        "for n, word in enumerate(area.resets) if word",
        "for n, word in enumerate(area.resets) if word > 65535",
    ),
    Mistake(
        "compiler_host_reads_beside_the_memory", BANK, "host_err_o = host_done & ~in_memory;", "host_err_o = 1'b0;"
    ),
    Mistake(
        "compiler_function_is_missing",
        "verilog.py",
        "128'h{device.function_mask:X}",
        "128'h{device.function_mask & ~(1 << 16):X}",
    ),
    # What is judged
    Mistake("compiler_last_address_too_far", CHECKS, "        if last >= ITEMS:\n", "        if last > ITEMS:\n"),
    Mistake(
        "compiler_min_above_max",
        CHECKS,
        "point.number(low) > point.number(high):",
        "point.number(low) > 2 * point.number(high):",
    ),
    Mistake("compiler_case_of_names", CHECKS, "self.names.setdefault(name.lower(), ", "self.names.setdefault(name, "),
    Mistake("compiler_columns_of_a_csv_head", "csv_door.py", "(line, column + 1)", "(line, column)"),
    Mistake("compiler_csv_number_is_an_address", "csv_door.py", "str(number - base - 1)", "str(number - base)"),
    Mistake("compiler_text_without_its_strobe", "dump.py", '        made["strobe"] = True\n', "        pass\n"),
    # The outputs beside the Verilog
    Mistake(
        "compiler_c_words_exchanged",
        "c_header.py",
        'word if point.word_order == "big"',
        'word if point.word_order != "big"',
    ),
    Mistake("compiler_c_sign_lost", "c_header.py", "({kind})(-1 - ({kind})({raw})~raw)", "({kind})raw / 2"),
    Mistake("compiler_c_field_spills", "c_header.py", "<< {tail}_SHIFT) & {tail}_MASK));", "<< {tail}_SHIFT)));"),
    Mistake("compiler_client_cuts_an_item", "client_runtime.py", "max(most // self.width, 1) * self.width", "most"),
    Mistake(
        "compiler_client_sends_what_is_refused",
        "client_runtime.py",
        "if len(items) != self.count:",
        "if len(items) > self.count:",
    ),
    Mistake(
        "compiler_manual_number_off_by_one",
        "model.py",
        "return first + self.addresses(item)[0]",
        "return first + self.addresses(item)[0] - 1",
    ),
    Mistake("compiler_telegraf_word_order", "tags.py", '"CDAB" if little else "ABCD"', '"ABCD"'),
    Mistake("compiler_home_assistant_word_order", "tags.py", '("swap", "word")', '("swap", "byte")'),
    Mistake("compiler_web_of_things_quantity", "tags.py", "?quantity={count * point.width}", "?quantity={count}"),
    Mistake(
        "compiler_node_red_scale", "node_red.py", "return n * p.up / p.down + p.offset;", "return n * p.up / p.down;"
    ),
    Mistake(
        "compiler_vhdl_vector_a_bit_wide",
        "vhdl.py",
        "std_logic_vector({width - 1} downto 0)",
        "std_logic_vector({width} downto 0)",
    ),
    Mistake(
        "compiler_live_word_of_an_input",
        "live.py",
        "inputs_q[{WORD} * item +: {WORD}]",
        "inputs_q[{WORD // 2} * item +: {WORD}]",
    ),
    Mistake(
        "compiler_rdl_forgets_an_offset", "rdl.py", '"enum", "unit", "scale", "offset")', '"enum", "unit", "scale")'
    ),
]
