# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The program of modbus_program: its size, its labels, and where its steps lead, for many sets of functions."""

import random
import re
import subprocess
from collections import Counter

import pytest
from harness.build import function_mask
from harness.runner import sources
from harness.steps import NUMBERS, RANGES, taken
from harness.volume import IS_FULL
from protocol.defs import ALL_FUNCTIONS, DIAGNOSTIC_FUNCTIONS

STEPS, MOST_STEPS = 512, 440
TABLE = 32
EVERYTHING = {"USER_CODES": 1 << 65, "ADDITIONAL_DATA_BYTES": 1, "CHECK_WRITES": 1}
LEFT_OUT = sorted(ALL_FUNCTIONS)[:: 1 if IS_FULL else 2]
SETS = [
    {},
    EVERYTHING,
    {"FUNCTION_CODES": 0},
    *({"FUNCTION_CODES": function_mask([code])} for code in sorted(ALL_FUNCTIONS)),
    *({"FUNCTION_CODES": function_mask(ALL_FUNCTIONS - {code}), "USER_CODES": 2} for code in LEFT_OUT),
]
# Steps that look at a byte or at the count in their first clock
LOOKS = {NUMBERS[f"STEP_{name}"] for name in (
    "DISPATCH", "ADDRESS", "QUANTITY", "DEPTH", "FILE", "COIL", "BYTE_COUNT", "END", "IF", "MATCH", "MODE"
)}  # fmt: skip
RANDOM_SETS = 20 if IS_FULL else 4
ROOT_OF = {name: index for index, name in enumerate(("START", "FOREIGN", "BAD", "EXCEPTION", "CLEARING"))}


def engine():
    """{file name: text} of the listing."""
    return {path.name: path.read_text() for folder in sources()[1] for path in folder.glob("*.vh")}


def assembled(folder, parameters, files=None):
    """(steps used, entries, memory) as Icarus works them out; its messages instead if it finds a mistake.

    `files`: {name: text} of include files that go before those of the RTL.
    """
    folder.mkdir(exist_ok=True)
    for name, text in (files or {}).items():
        (folder / name).write_text(text)
    values = {name: f"128'h{value:x}" if name.endswith("CODES") else str(value) for name, value in parameters.items()}
    (folder / "show.v").write_text(f"""
module show;
  wire [{NUMBERS["ENTRIES_WIDTH"] - 1}:0] entries;
  modbus_program #({", ".join(f".{name}({value})" for name, value in values.items())}) u_program (
    .clk_i(1'b0), .at_i(9'd0), .fetch_i(1'b1), .step_o(), .entries_o(entries));
  integer i;
  initial begin
    #1 $display("%0d %h", u_program.PROGRAM_STEPS, entries);
    for (i = 0; i < u_program.PROGRAM_STEPS; i = i + 1) $display("%h", u_program.memory[i]);
  end
endmodule
""")
    rtl, folders = sources()
    includes = [f"-I{place}" for place in [folder, *folders]]
    program = next(path for path in rtl if path.stem == "modbus_program")
    command = ["iverilog", "-g2005", *includes, "-o", "show.vvp", "-s", "show", "show.v", str(program)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        return done.stdout + done.stderr
    shown = subprocess.run(["vvp", "show.vvp"], cwd=folder, capture_output=True, text=True, check=True).stdout.split()
    bits = int(shown[1], 16)
    entries = [bits >> RANGES[f"ENTRY_{name}"][1] & STEPS - 1 for name in ROOT_OF]
    return int(shown[0]), entries, [int(word, 16) for word in shown[2:]]


def successors(word, at):
    """Where the sequencer goes on behind a step, but for exceptions."""
    step, target = taken("WORD_STEP", word), taken("ARG_TARGET", word)
    condition = taken("ARG_CONDITION", word)
    if step == NUMBERS["STEP_REST"] or (step == NUMBERS["STEP_JUMP"] and condition == NUMBERS["JUMP_NEVER"]):
        return []
    if step == NUMBERS["STEP_JUMP"]:
        return [at + 1 if condition == NUMBERS["JUMP_READY"] else target]
    if step in (NUMBERS["STEP_IF"], NUMBERS["STEP_OFFER"]):
        return [at + 1, target]
    if step == NUMBERS["STEP_DISPATCH"]:
        return range(target, target + TABLE)
    return [at + 1]


def reached(entries, memory):
    """All steps that can be reached; each must be inside the program."""
    found, new = set(), list(entries)
    while new:
        at = new.pop()
        if at not in found:
            assert at < len(memory), f"step {at} of {len(memory)}"
            found.add(at)
            new += successors(memory[at], at)
    return found


def looks_too_early(at, memory):
    """Steps right behind a PUT that would see byte and count from before it: modbus_sequencer says why."""
    if taken("WORD_STEP", memory[at]) != NUMBERS["STEP_PUT"]:
        return []
    return [to for to in successors(memory[at], at) if taken("WORD_STEP", memory[to]) in LOOKS]


def sets():
    """SETS, and some by chance."""
    chance = random.Random(7)
    for _ in range(RANDOM_SETS):
        codes = [code for code in sorted(ALL_FUNCTIONS) if chance.getrandbits(1)]
        yield {
            "FUNCTION_CODES": function_mask(codes),
            "USER_CODES": chance.choice((0, 8)),
            "ADDITIONAL_DATA_BYTES": chance.choice((0, 9)),
            "CHECK_WRITES": chance.choice((0, 1)),
        }
    yield from SETS


def test_everything_leaves_room(tmp_path, record_property):
    """With everything on, what a new function code needs is still there."""
    used, _, _ = assembled(tmp_path, EVERYTHING)
    record_property("steps", used)
    print(f"{used} of {STEPS} steps with everything on")
    assert used <= MOST_STEPS


def test_every_step_is_reached_and_ends(tmp_path):
    """No routine is there that no built-in function needs; every way ends in REST or in an exception."""
    for parameters in sets():
        result = assembled(tmp_path, parameters)
        assert not isinstance(result, str), f"{parameters}: {result}"
        used, entries, memory = result
        functions = parameters.get("FUNCTION_CODES", function_mask(ALL_FUNCTIONS))
        if not functions & function_mask(DIAGNOSTIC_FUNCTIONS):
            entries = [entries[ROOT_OF["START"]], entries[ROOT_OF["EXCEPTION"]]]
        found = reached(entries, memory)
        dead = sorted(set(range(used)) - found)
        assert not dead, f"{parameters}: steps {dead} are never reached"
        early = [to for at in found for to in looks_too_early(at, memory)]
        assert not early, f"{parameters}: steps {early} look at the frame right behind a PUT"
        steps = {taken("WORD_STEP", memory[at]) for at in found}
        assert max(steps) <= NUMBERS["STEP_MODE"]
        # Backwards from the ends: from every step one of them can be reached.
        ends = {at for at in found if not successors(memory[at], at)}
        while more := {at for at in found - ends if ends & set(successors(memory[at], at))}:
            ends |= more
        assert ends == found, f"{parameters}: no end behind steps {sorted(found - ends)}"


def test_each_label_stands_once():
    """In the list of labels and in the listing."""
    texts = engine()
    listed = Counter(re.findall(r"`NAME\((\w+)\)", texts["modbus_labels.vh"]))
    listing = "\n".join(text for name, text in texts.items() if name.startswith("modbus_routines_"))
    placed = Counter(re.findall(r"`(?:ROUTINE|LABEL|TABLE)\((\w+)", listing))
    assert listed == placed and set(listed.values()) == {1}


def test_no_number_of_a_step_stands_in_the_listing():
    """A step, a length or an offset kept by hand would be a number in a jump."""
    for name, text in engine().items():
        if name.startswith("modbus_routines_"):
            jumps = re.findall(r"\b(?:GO\w*|IF_\w+|OFFER|DISPATCH)\(([^()]*)\)", re.sub(r"//.*", "", text))
            assert jumps or name == "modbus_routines_files.vh"
            assert all(re.fullmatch(r"[A-Z_]+|loop|here|`NEXT", target) for target in jumps), f"{name}: {jumps}"


FAULTS = {
    "label_twice": ("`ROUTINE(DONE, 1'b1)", "`LABEL(SENDING)\n`ROUTINE(DONE, 1'b1)"),
    "jump_to_a_routine_that_is_left_out": ("`DO(GO(SENDING))", "`DO(GO(READ_COILS))"),
    "runs_into_another_routine": ("`FALL_INTO(SENDING)", "`FALL_INTO(DONE)"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_the_assembler_notices(tmp_path, name):
    """A fault of the listing stops elaboration."""
    old, new = FAULTS[name]
    text = engine()["modbus_routines_answer.vh"]
    assert old in text
    parameters = {"FUNCTION_CODES": function_mask([3, 6])}
    assert not isinstance(assembled(tmp_path, parameters), str)
    result = assembled(tmp_path, parameters, {"modbus_routines_answer.vh": text.replace(old, new)})
    assert isinstance(result, str) and "ERROR_modbus_program_has_a_label_twice" in result
