# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The reference slave: what the core must answer, in plain Python without signals or time.

Written from MODBUS Application Protocol V1.1b3 and MODBUS over Serial Line V1.02, never from the
RTL. One call of `Slave.request` is everything the line carries between two silences of t3.5.
"""

from collections import Counter

from . import frames, identity
from .access import DataAccess
from .ascii import Receiver
from .characters import Character, characters
from .defs import (
    BROADCAST,
    ERRORS,
    EX,
    EXCEPTION_FLAG,
    FC,
    FIRST_ADDRESS,
    FUNCTIONS,
    LAST_ADDRESS,
    LONGEST_FRAME,
    LONGEST_PDU,
    SHORTEST_FRAME,
)
from .diagnostics import Diagnostics, Refused
from .memory import REGISTER_BITS, Config, Memory

__all__ = ["REGISTER_BITS", "Character", "Config", "Memory", "Refused", "Slave", "characters", "split"]


def split(line, t35):
    """`line` cut at every silence of `t35` characters or more: what `Slave.request` takes."""
    pieces = [[]]
    for place, character in enumerate(characters(line)):
        if place and character.gap >= t35:
            pieces.append([])
        pieces[-1].append(character)
    return pieces


class Slave(DataAccess):
    """A Modbus RTU slave.

    Run-time inputs are attributes: `busy`, `write_lock`, `failure` (an exception code or 0),
    `exception_status`, `run_indicator`, `diagnostic_bits`, `memory`, and the configuration's address,
    broadcast and gap_count_only. Two hooks speak for the user's logic:

    - `grant`, the bank's own opinion: `grant(space, first, last, write)`, for files
      `grant(Space.FILES, first record, last record, write, file)` -> exception code or 0. Asked for each
      range in the order of the request, once it exists; `busy` and `failure` come after it.
    - `user(pdu)` is offered unicast requests whose function code is in the configuration's user_codes:
      -> answer PDU, exception code, or None for "not mine".

    After each request `errors` is the set of error strobes that must have risen, `allowed` those
    that may have risen beside them, `good` whether the frame counts as good, `written` the list of
    committed writes (space, first, last), for files (Space.FILES, first record, last record, file),
    `touched` the keys of memory they changed.  `counts` sums good frames and errors.

    `counters`, `log` (newest first), `listen_only`, `diagnostic_register` and `ascii_delimiter` are those
    of the protocol. If `ambiguous`, it is open whether the bad frame counts as too long: characters that
    follow a gap may be dropped before they are counted. `adopt` settles it, else it was not.
    """

    def __init__(self, config=None):
        super().__init__(config or Config())
        self.exception_status = 0
        self.run_indicator = True
        self.user = None
        self.diagnostics = Diagnostics(self.config.has_diagnostics)
        self.ascii = Receiver(self.config, self.diagnostics)
        self.counts = Counter()
        self.errors, self.allowed, self.good, self.ambiguous = set(), set(), False, False
        self._functions |= {
            FC.READ_EXCEPTION_STATUS: self._read_exception_status,
            FC.DIAGNOSTICS: self.diagnostics.sub_function,
            FC.GET_EVENT_COUNTER: lambda pdu: self.diagnostics.event_counter(pdu, self.busy),
            FC.GET_EVENT_LOG: lambda pdu: self.diagnostics.event_log(pdu, self.busy),
            FC.REPORT_SERVER_ID: lambda pdu: identity.server_id(self.config, pdu, self.run_indicator),
            FC.READ_DEVICE_ID: lambda pdu: identity.device_identification(self.config, pdu),
        }

    def reset(self):
        """What rst_i does: counters, log, diagnostic register and listen-only mode; memory stays."""
        self.diagnostics.reset()
        self.ascii.reset()
        self.ambiguous = False

    # ------------------------------------------------------------------ what diagnostics holds

    @property
    def counters(self):
        """{name: count} of ALL_COUNTERS."""
        return self.diagnostics.counters

    @property
    def log(self):
        """Event bytes, newest first."""
        return self.diagnostics.log

    @log.setter
    def log(self, events):
        self.diagnostics.log = list(events)

    @property
    def listen_only(self):
        """True in listen-only mode."""
        return self.diagnostics.listen_only

    @listen_only.setter
    def listen_only(self, value):
        self.diagnostics.listen_only = bool(value)

    @property
    def diagnostic_register(self):
        """The 16 bits that sub-function 0002 returns."""
        return self.diagnostics.register

    @diagnostic_register.setter
    def diagnostic_register(self, value):
        self.diagnostics.register = value

    @property
    def diagnostic_bits(self):
        """The host's bits; those at 1 are set in the register until they are 0 and it is cleared."""
        return self.diagnostics.host_bits

    @diagnostic_bits.setter
    def diagnostic_bits(self, value):
        self.diagnostics.host_bits = value

    @property
    def ascii_delimiter(self):
        """What sub-function 0003 has set; unused in RTU mode."""
        return self.diagnostics.delimiter

    @ascii_delimiter.setter
    def ascii_delimiter(self, character):
        self.diagnostics.delimiter = character

    # ------------------------------------------------------------------ the frame

    def request(self, line):
        """Play what the line carries between two silences; the answer frame, or None.

        `line` is bytes, or a list of bytes and (byte, gap in characters, error).
        Raises ValueError if a gap inside is a frame boundary.
        """
        self.written, self.touched = [], set()
        self.errors, self.allowed = self._judge(characters(line))
        self.good = not (self.errors - ({"gap"} if self.config.gap_count_only else set()))
        self.ambiguous = not self.good and "long" in self.allowed
        if not self.good:
            self._bad()
            return None
        self.counts.update(self.errors)
        frame = bytes(c.byte for c in characters(line))
        answer = self._good(frame[0], frame[1:-2])
        return None if answer is None else frames.adu(frame[0], answer)

    def hear(self, line):
        """Play characters in ASCII mode; the characters of the answer, or None.

        `line` is bytes, or a list of bytes and (byte, gap in characters, error), and may be a part of a frame or
        several; the gap of its first character counts.  Of several frames only the last may be answered (ValueError).
        `good` is the number of good ones, `errors` and `allowed` are those of all.
        """
        return self._ended(self.ascii.take(characters(line)))

    def fall_silent(self):
        """ASCII mode: the line is silent for longer than the time-out."""
        return self._ended(self.ascii.silence())

    def _ended(self, ended):
        """Play the frames that `ended` yields."""
        self.written, self.touched, self.ambiguous = [], set(), False
        must, may, good, answer = set(), set(), 0, None
        for data, errors, allowed in ended:
            if answer is not None:
                raise ValueError("a frame behind one that is answered")
            self.errors, self.allowed = errors, allowed
            must, may = must | errors, may | allowed
            if data is None:
                self._bad()
                continue
            good += 1
            pdu = self._good(data[0], data[1:])
            answer = None if pdu is None else frames.ascii_adu(data[0], pdu)
        self.errors, self.allowed, self.good = must, may - must, good
        return answer

    def _bad(self):
        """A bad frame has ended."""
        self.counts.update(self.errors)
        self.diagnostics.bad_frame("long" in self.errors)

    def _good(self, address, pdu):
        """The answer PDU to a good frame, or None."""
        self.counts["good"] += 1
        self.diagnostics.good_frame()
        if not self._for_us(address):
            return None
        self.counts["for_us"] += 1
        self.diagnostics.addressed(address == BROADCAST)
        if self.listen_only:
            self.diagnostics.unheard(pdu, address == BROADCAST)
            return None
        return self._answer(pdu, address == BROADCAST)

    def adopt(self, long):
        """Settle an ambiguous bad frame: `long` tells whether the device took it for too long."""
        if not self.ambiguous:
            raise ValueError("nothing is ambiguous")
        if long:
            self.diagnostics.was_long()
        self.ambiguous = False

    def _judge(self, line):
        """(errors that must be raised, errors that may be raised beside them)."""
        must, may = set(), set()
        for place, character in enumerate(line):
            if place and character.gap >= self.config.t35:
                raise ValueError(f"silence of {character.gap} characters ends the frame")
        gaps = [i for i, c in enumerate(line) if i and c.gap > self.config.t15]
        heard = line
        if gaps:
            must.add("gap")
            if not self.config.gap_count_only:
                # What comes after the gap is dropped; whether its faults are shown is not fixed.
                heard, dropped = line[: gaps[0]], line[gaps[0] :]
                may |= {c.error for c in dropped if c.error} | {"short"}
                if len(line) > LONGEST_FRAME:
                    may.add("long")
        for character in heard:
            if character.error:
                must.add(character.error)
            if character.error == "framing":
                may.add("parity")
        if len(heard) > LONGEST_FRAME:
            must.add("long")
            may.add("overrun")
        if not gaps and len(line) < SHORTEST_FRAME:
            must.add("short")
        only_counted = {"gap"} if self.config.gap_count_only else set()
        if not must - only_counted and not frames.check(bytes(c.byte for c in heard)):
            must.add("crc")
        assert must | may <= set(ERRORS)
        return must, may - must

    def _for_us(self, address):
        if address == BROADCAST:
            return self.config.broadcast
        ours = {self.config.address, *self.config.units}
        return FIRST_ADDRESS <= address <= LAST_ADDRESS and address in ours

    # ------------------------------------------------------------------ the request

    def _answer(self, pdu, broadcast):
        """The answer PDU, None for silence; counted and logged."""
        code = 0
        try:
            answer = self._process(pdu, broadcast)
        except Refused as refusal:
            self.counts["exception"] += 1
            code = refusal.code
            answer = bytes([pdu[0] | EXCEPTION_FLAG, code])
        if broadcast:
            answer = None
        counts = pdu[0] not in FUNCTIONS or FUNCTIONS[pdu[0]].counts
        self.diagnostics.processed(code, broadcast, answer is None, counts)
        return answer

    def _process(self, pdu, broadcast):
        code = pdu[0]
        if not broadcast and code in self.config.user_codes and self.user:
            answer = self._asked_user(pdu)
            if answer is not None:
                return answer
        if not self.config.supports(code):
            raise Refused(EX.FUNCTION)
        if broadcast and not FUNCTIONS[code].broadcast:
            raise Refused(EX.FUNCTION)
        return self._functions[code](pdu)

    def _asked_user(self, pdu):
        """What the user's function says: an answer PDU, or None if the request is not its own."""
        answer = self.user(pdu)
        if answer is None:
            return None
        if isinstance(answer, int):
            if not answer:
                raise ValueError("an exception has a code")
            raise Refused(answer)
        if len(answer) > LONGEST_PDU:
            raise Refused(EX.FAILURE)
        if answer[0] != pdu[0]:
            raise ValueError("the answer has the function code of the request")
        return bytes(answer)

    def _read_exception_status(self, pdu):
        if len(pdu) != 1:
            raise Refused(EX.VALUE)
        return pdu + bytes([self.exception_status])
