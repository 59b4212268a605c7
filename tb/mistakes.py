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

TB = Path(__file__).resolve().parent
ROOT = TB.parent
WORK = ROOT / "build" / "mistakes"
WORKERS = min(4, os.cpu_count() or 1)
TIMEOUT_SECONDS = 900


@dataclass(frozen=True)
class Mistake:
    """`old` in rtl/`file` becomes `new`."""

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
    Mistake("frame_of_257_bytes_taken", "modbus_frame_rx.v", "long_q    <= long_q    | full;", "long_q    <= 1'b0;"),
    Mistake(
        "idle_at_once_after_reset",
        "modbus_frame_rx.v",
        "if (rst_i) state_q <= ST_INITIAL;",
        "if (rst_i) state_q <= ST_IDLE;",
    ),
    Mistake(
        "strict_turnaround_ignored",
        "modbus_frame_rx.v",
        "(answered_i ? strict_i : heard)",
        "(answered_i ? 1'b0 : heard)",
    ),
    Mistake("address_248_answers", "modbus_dispatch.v", " & (address_i[7:3] != 5'h1F)", ""),
    Mistake(
        "broadcast_always_obeyed",
        "modbus_dispatch.v",
        "wire for_all = zero_q & broadcast_en_i;",
        "wire for_all = zero_q;",
    ),
    Mistake(
        "broadcast_read_goes_on",
        "modbus_program.v",
        "entry = go(MASK_WRITE[7:0], `MB_FLAG_UNICAST);",
        "entry = go(MASK_WRITE[7:0], NO_FLAG);",
    ),
    Mistake(
        "function_code_seen_through_five_bits",
        "modbus_dispatch.v",
        "(byte_i[7:5] == 3'd0) ? byte_i[4:0] : 5'd0",
        "byte_i[4:0]",
    ),
    Mistake(
        "quantity_limit_one_too_low",
        "modbus_data_access.v",
        "(less_one_q[10:0] < limit_i)",
        "(less_one_q[10:0] < limit_i - 11'd1)",
    ),
    Mistake("quantity_seen_through_eleven_bits", "modbus_data_access.v", "(less_one_q[15:11] == 5'd0) & ", ""),
    Mistake("any_coil_value_means_on", "modbus_dispatch.v", "(held_i == 8'h00 || held_i == 8'hFF)", "1'b1"),
    Mistake("extra_bytes_accepted", "modbus_dispatch.v", "| (is_end & count_i != 9'd0)", ""),
    Mistake("byte_count_not_compared", "modbus_dispatch.v", "| (is_byte_count & third & ~count_held_q)", ""),
    Mistake("end_of_address_space_wraps", "modbus_dispatch.v", "is_range & third & over_i", "1'b0 & over_i"),
    Mistake("table_one_item_too_long", "modbus_bank_guard.v", "(last_i <= high)", "(last_i <= high + 16'd1)"),
    Mistake("first_address_not_compared", "modbus_bank_guard.v", "(first_i >= low) & ", ""),
    Mistake(
        "read_only_range_open_at_its_end", "modbus_bank_guard.v", "(first <= RO_LAST[15:0])", "(first < RO_LAST[15:0])"
    ),
    Mistake(
        "refusal_taken_for_a_grant",
        "modbus_data_access.v",
        """(grant_ack_i ? exception_i != 4'd0 : stall_i);
  wire granted    = grant_i & grant_ack_i & (exception_i == 4'd0);""",
        """(grant_ack_i ? 1'b0 : stall_i);
  wire granted    = grant_i & grant_ack_i;""",
    ),
    Mistake(
        "second_question_left_out",
        "modbus_program.v",
        "11: read_write = bank(`MB_STEP_GRANT, HOLDINGS, `MB_FLAG_LAST);",
        "11: read_write = at(`MB_STEP_POINT, AT_RW_WRITE, NO_FLAG);",
    ),
    Mistake(
        "bus_error_not_noticed",
        "modbus_data_access.v",
        "stb & (wb_err_i | (stall_i & ~wb_ack_i))",
        "stb & stall_i & ~wb_ack_i",
    ),
    Mistake(
        "stall_in_the_burst_for_ever",
        "modbus_data_access.v",
        "stb & (wb_err_i | (stall_i & ~wb_ack_i))",
        "stb & wb_err_i",
    ),
    Mistake("busy_ignored", "modbus_dispatch.v", "argument[2] & busy_i", "argument[2] & 1'b0"),
    Mistake(
        "unused_bits_not_zero",
        "modbus_data_access.v",
        "{wb_dat_i[0] & beat, held_q[7:1]}",
        "{wb_dat_i[0], held_q[7:1]}",
    ),
    Mistake(
        "address_stands_still_in_a_burst", "modbus_data_access.v", "first_q <= first_q + 16'd1;", "first_q <= first_q;"
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
    Mistake(
        "host_breaks_into_a_burst",
        "modbus_bank_ram.v",
        "host_cyc_i & (host_q | ~wb_cyc_i) & ~rst_i",
        "host_cyc_i & ~rst_i",
    ),
    Mistake(
        "write_pulse_for_reads_too", "modbus_dispatch.v", "is_address & third & argument[11]", "is_address & third"
    ),
]

# (suite of test_modules.py or test_system.py, regular expression of its cocotb tests); the quickest first.
SELECTION = [
    ("crc16", None),
    ("uart_tx", None),
    ("line_timer_characters", None),
    ("frame_rx", None),
    ("bank_guard", None),
    (
        "functions_mapped",
        "single_coil|byte_count|length_is_exact|unsupp|mask|broadcast|lock|read_only|order|share",
    ),
    ("functions_mapped", "address_limits|align|read_write|limits.*code=(3|15|16)"),
    (
        "line_faults",
        "gap=(1.2|2.0).count_only|add_up|parity|framing|second_stop|long_frames|truncated|short_frames|swapped|traffic"
        "|own_|breaks|right_after|during|after_reset",
    ),
    ("options", "delay=(0|7)$|tail=6|tearing|any_time|every_table"),
    ("core_bus", "wait=(0|7)$|code=(4|10)$|second_range|past|stall|busy|no_access|in_order"),
    ("speed", "case=(0|16|24)$|to_the_bit"),
]


def planted(mistake, folder):
    """Copy rtl/ to `folder` with the mistake in it."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "rtl", folder)
    if mistake is None:
        return
    path = folder / mistake.file
    text = path.read_text(encoding="utf-8")
    found = text.count(mistake.old)
    if found != 1:
        sys.exit(f"{mistake.name}: the pattern is {found} times in {mistake.file}: {mistake.old}")
    path.write_text(text.replace(mistake.old, mistake.new), encoding="utf-8")


def judge():
    """In a process whose RTL= names the copy: run the selection until a test fails; print what failed."""
    sys.path.insert(0, str(TB))
    os.environ["PYTHONPATH"] = os.pathsep.join([str(TB), *filter(None, [os.environ.get("PYTHONPATH")])])
    import test_modules
    import test_system
    from mbrtu.runner import run

    failed = []
    for number, (suite, only) in enumerate(SELECTION):
        if suite in test_modules.MODULES:
            top, parameters, module = test_modules.MODULES[suite]
            module = f"modules.{module}"
        else:
            top, parameters, module, _ = test_system.SUITES[suite]
            module = f"system.{module}"
        recorded = {}
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                run(
                    recorded.__setitem__,
                    "icarus",
                    top,
                    module,
                    parameters,
                    only=only,
                    own=f"{number}_{suite}",
                )
        except BaseException as problem:  # pytest's outcomes are no Exceptions
            tests = [t.split(".", 2)[-1] for t, ok in recorded.get("cocotb", []) if not ok]
            failed = [f"{suite}: {t}" for t in tests] or [f"{suite}: {str(problem).splitlines()[0]}"]
            break
    print(json.dumps(failed))


def run_one(mistake):
    """(mistake, failed tests or None for an accident, seconds)."""
    name = mistake.name if mistake else "untouched"
    folder = WORK / name
    planted(mistake, folder / "rtl")
    env = {**os.environ, "RTL": str(folder / "rtl"), "BENCH_BUILD": str(folder / "build"), "COCOTB_LOG_LEVEL": "ERROR"}
    for variable in ("WAVES", "CASE"):
        env.pop(variable, None)
    begun = time.monotonic()
    log = folder / "log"
    with log.open("w", encoding="utf-8") as messages:
        try:
            done = subprocess.run(
                [sys.executable, __file__, "--judge"],
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
        planted(mistake, WORK / mistake.name / "rtl")
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
    if sys.argv[1:] == ["--judge"]:
        judge()
    else:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else ""))
