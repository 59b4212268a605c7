# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The demo's last part: what goes wrong on a line, and how a master reads it from counters and event log."""

from master import Failure, Master, NoDevice, device
from protocol import words_special as special
from protocol.defs import FC
from protocol.frames import bad_crc, diagnostics, read, restart, text, write_register
from protocol.memory import Config
from protocol.model import Slave
from protocol.words import answer, request

BAUD = 19200
FOREIGN, OUTSIDE = 18, 5000
REGISTER = 7


def steps(master):
    """(what happens, frame) in order; None: counters and log are read."""
    own = master.frame
    yield "a master writes", own(write_register(REGISTER, 1234))
    yield "a disturbance hits its next frame", bad_crc(own(read(FC.READ_HOLDINGS, REGISTER, 1)), 0x0100)
    yield "somebody sends more than a frame can hold", own(bytes(256))
    yield "the master talks to another slave", own(read(FC.READ_HOLDINGS, 0, 1), FOREIGN)
    yield "it asks for what is not there", own(read(FC.READ_HOLDINGS, OUTSIDE, 1))
    yield "it writes to all slaves", own(write_register(REGISTER, 4321), 0)
    yield "counters and log", None
    yield "it sends the slave into listen-only mode", own(diagnostics(4))
    yield "it asks all the same", own(read(FC.READ_HOLDINGS, REGISTER, 1))
    yield "a restart brings the slave back", own(restart())
    yield "and it answers again", own(read(FC.READ_HOLDINGS, REGISTER, 1))
    yield "counters and log", None


def show(master, say):
    """Read by pymodbus; every answer is compared with the reference slave's."""
    log, _, _ = master.log()
    say("      event log, oldest first:")
    for line in special.story(log).split("; "):
        say(f"        {line}")
    say("      counters, one question after the other; each question counts, too:")
    for name, count in master.counters().items():
        say(f"        {special.COUNTER_WORDS[name]:<24} {count:>3}")
    say(f"      diagnostic register {special.register(master.register())}")


def tell(say):
    """Play the story, a line each through `say`; True if all was as expected."""
    say("What goes wrong on a line, and what the slave tells of it")
    try:
        with device(17, {}, BAUD), Master(Slave(Config()), BAUD) as master:
            for what, frame in steps(master):
                say(f"    {what}")
                if frame is None:
                    show(master, say)
                    continue
                got = master.ask(frame)
                shown = text(frame) if len(frame) < 20 else f"{text(frame[:4])} ... ({len(frame)} bytes)"
                say(f"      {shown}  {request(frame)}")
                say(f"      {text(got)}" + (f"  {answer(frame, got)}" if got else ""))
                if master.sent != frame:
                    raise Failure(f"pymodbus has sent {text(master.sent)}")
                if got != master.expected:
                    raise Failure(f"should be {text(master.expected)}")
    except (Failure, NoDevice) as failure:
        say(f"    NOT AS EXPECTED: {failure}")
        return False
    say("    as expected: each answer, count and entry is that of the reference slave, which has heard the same")
    return True
