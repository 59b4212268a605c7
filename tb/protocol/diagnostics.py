# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Counters, event log, diagnostic register and listen-only mode of the reference slave.

MODBUS over Serial Line V1.02 appendix A counts and logs, MODBUS Application Protocol V1.1b3 6.8 to
6.10 reads them out (function codes 07, 08, 0B, 0C).
"""

from .defs import (
    ADDRESSES,
    ALL_COUNTERS,
    COUNTERS,
    ENTERED_LISTEN_ONLY,
    EVENT_COUNTER,
    EX,
    FC,
    LINE_FEED,
    LOG_SIZE,
    OVERRUN_FLAG,
    QUERY_DATA_MOST,
    RECEIVED,
    RECEIVED_BROADCAST,
    RECEIVED_ERROR,
    RECEIVED_LISTENING,
    RECEIVED_OVERRUN,
    RESTART_CLEAR,
    RESTART_KEEP,
    RESTARTED,
    SENT,
    SENT_BUSY,
    SENT_FAILURE,
    SENT_LISTENING,
    SENT_NAK,
    SENT_REFUSAL,
    STATUS_BUSY,
    STATUS_READY,
    Sub,
)
from .frames import pack_words, unpack_words

COUNTER_OF_SUB = {sub: name for name, sub in COUNTERS.items()}
SENT_BITS = {
    EX.FUNCTION: SENT_REFUSAL,
    EX.ADDRESS: SENT_REFUSAL,
    EX.VALUE: SENT_REFUSAL,
    EX.FAILURE: SENT_FAILURE,
    EX.ACKNOWLEDGE: SENT_BUSY,
    EX.BUSY: SENT_BUSY,
    EX.NAK: SENT_NAK,
}
HOST_BITS = 0xFFFE  # of the diagnostic register
DATA_AT, WHOLE = 3, 5  # of a PDU with a sub-function and one word


class Refused(Exception):
    """The request ends with an exception answer."""

    def __init__(self, code):
        super().__init__(f"exception {code:02X}")
        self.code = code


def is_restart(pdu):
    """True for a restart request as it should be: the way out of listen-only mode."""
    return pdu in (
        bytes([FC.DIAGNOSTICS, *pack_words([Sub.RESTART, option])]) for option in (RESTART_KEEP, RESTART_CLEAR)
    )


class Diagnostics:
    """State and rules. `built` False: there is nothing of it, everything stays 0.

    `counters` by the names of ALL_COUNTERS, `log` newest first, `listen_only`, `register`
    (`host_bits` are OR-ed into it as long as they stand), `delimiter`.
    """

    def __init__(self, built=True):
        self.built = built
        self._host_bits = 0
        self.reset()

    def reset(self):
        """What rst_i does."""
        self.counters = dict.fromkeys(ALL_COUNTERS, 0)
        self.log = []
        self.listen_only = False
        self._register = 0
        self._action = None
        self.host_bits = self._host_bits
        self.delimiter = LINE_FEED

    @property
    def register(self):
        """The diagnostic register."""
        return self._register

    @register.setter
    def register(self, value):
        self._register = value
        self.host_bits = self._host_bits

    @property
    def host_bits(self):
        """Bits 15 to 1 that the host holds at 1."""
        return self._host_bits

    @host_bits.setter
    def host_bits(self, value):
        self._host_bits = value
        if self.built:
            self._register |= value & HOST_BITS

    # ------------------------------------------------------------------ what a frame does

    def _count(self, name):
        if self.built:
            self.counters[name] = (self.counters[name] + 1) % ADDRESSES

    def _note(self, event):
        if self.built:
            self.log = [event, *self.log][:LOG_SIZE]

    def overrun(self):
        """More than 256 bytes."""
        self._count("bus_char_overrun")
        if self.built:
            self._register |= OVERRUN_FLAG

    def bad_frame(self, long):
        """No frame: counted and logged, whoever it was for."""
        if long:
            self.overrun()
        self._count("bus_comm_error")
        self._note(RECEIVED | RECEIVED_ERROR | RECEIVED_OVERRUN * long | RECEIVED_LISTENING * self.listen_only)

    def was_long(self):
        """The bad frame just noted was a long one after all."""
        self.overrun()
        if self.log:
            self.log[0] |= RECEIVED_OVERRUN

    def good_frame(self):
        """A frame with a right CRC, whoever it is for."""
        self._count("bus_message")

    def addressed(self, broadcast):
        """The good frame is for this slave."""
        self._count("slave_message")
        self._note(RECEIVED | RECEIVED_BROADCAST * broadcast | RECEIVED_LISTENING * self.listen_only)
        self._action = None

    def unheard(self, pdu, broadcast):
        """What listen-only mode does with a frame for this slave."""
        self._count("slave_no_response")
        self._note(SENT | SENT_LISTENING)
        if not broadcast and is_restart(pdu):
            self._restart(unpack_words(pdu[DATA_AT:])[0])

    def processed(self, code, broadcast, silent, counts):
        """The end of a request: `code` 0 for success, `counts` if that counts as an event."""
        if code:
            self._count("bus_exception")
            if not broadcast and code == EX.BUSY:
                self._count("slave_busy")
            if not broadcast and code == EX.NAK:
                self._count("slave_nak")
        elif counts:
            self._count(EVENT_COUNTER)
        if silent:
            self._count("slave_no_response")
        self._note(SENT | (0 if broadcast else SENT_BITS.get(code, 0)))
        if self._action:
            self._action()

    # ------------------------------------------------------------------ the functions

    def event_counter(self, pdu, busy):
        """FC 0B."""
        self._no_data(pdu)
        return pdu + pack_words([self._status(busy), self.counters[EVENT_COUNTER]])

    def event_log(self, pdu, busy):
        """FC 0C."""
        self._no_data(pdu)
        words = [self._status(busy), self.counters[EVENT_COUNTER], self.counters["bus_message"]]
        body = pack_words(words) + bytes(self.log)
        return pdu + bytes([len(body)]) + body

    @staticmethod
    def _status(busy):
        return STATUS_BUSY if busy else STATUS_READY

    @staticmethod
    def _no_data(pdu):
        if len(pdu) != 1:
            raise Refused(EX.VALUE)

    def sub_function(self, pdu):
        """FC 08; the answer PDU, None for silence. What it changes happens in `processed`."""
        if len(pdu) < DATA_AT:
            raise Refused(EX.VALUE)
        sub = unpack_words(pdu[1:DATA_AT])[0]
        if sub not in list(Sub):
            raise Refused(EX.FUNCTION)
        if sub == Sub.QUERY_DATA:
            size = len(pdu) - DATA_AT
            if size % 2 or not 2 <= size <= QUERY_DATA_MOST:
                raise Refused(EX.VALUE)
            return pdu
        if len(pdu) != WHOLE:
            raise Refused(EX.VALUE)
        data = unpack_words(pdu[DATA_AT:])[0]
        allowed = {
            Sub.RESTART: data in (RESTART_KEEP, RESTART_CLEAR),
            Sub.DELIMITER: data & 0x00FF == 0,
        }
        if not allowed.get(sub, data == 0):
            raise Refused(EX.VALUE)
        if sub in COUNTER_OF_SUB:
            return pdu[:DATA_AT] + pack_words([self.counters[COUNTER_OF_SUB[sub]]])
        if sub == Sub.DIAGNOSTIC_REGISTER:
            return pdu[:DATA_AT] + pack_words([self.register])
        self._action = {
            Sub.RESTART: lambda: self._restart(data),
            Sub.DELIMITER: lambda: self._set_delimiter(data >> 8),
            Sub.LISTEN_ONLY: self._listen,
            Sub.CLEAR: self._clear,
            Sub.CLEAR_OVERRUN: self._clear_overrun,
        }[sub]
        return None if sub == Sub.LISTEN_ONLY else pdu

    def _clear_counters(self):
        self.counters.update(dict.fromkeys(ALL_COUNTERS, 0))

    def _restart(self, option):
        self._clear_counters()
        if option == RESTART_CLEAR:
            self.log = []
        self.listen_only = False
        self.delimiter = LINE_FEED
        self._note(RESTARTED)

    def _set_delimiter(self, character):
        self.delimiter = character

    def _listen(self):
        self.listen_only = True
        self._note(ENTERED_LISTEN_ONLY)

    def _clear(self):
        self._clear_counters()
        self.register = 0

    def _clear_overrun(self):
        self.counters["bus_char_overrun"] = 0
        self.register &= ~OVERRUN_FLAG
