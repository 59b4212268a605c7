# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The receiver of ASCII mode (MODBUS over Serial Line V1.02, clause 2.5.2): characters to frames, without signals.

A frame is `:`, two of 0-9 A-F for each byte, the LRC last, CR and the delimiter.  `:` inside a frame begins anew; the
part before it is a bad frame if any character followed its own colon.  Characters outside a frame are ignored.
"""

from .defs import CARRIAGE_RETURN, COLON, HEXADECIMAL, LONGEST_ASCII, SHORTEST_ASCII
from .frames import lrc

SEVEN_BITS = 0x7F


class Receiver:
    """Takes characters, gives frames.

    `config` has the time-out in character times and gap_count_only, `diagnostics` the delimiter.
    """

    def __init__(self, config, diagnostics):
        self.config, self.diagnostics = config, diagnostics
        self.reset()

    def reset(self):
        """No frame is received."""
        self._digits = None  # characters since the colon, CR excepted; None outside a frame
        self._carriage_return, self._errors = False, set()

    @property
    def receiving(self):
        """True inside a frame."""
        return self._digits is not None

    def take(self, line):
        """Yield (bytes without LRC or None, errors, errors that may be reported too) for each frame that ends.

        A good frame has no errors.  "crc" stands for a wrong LRC, for a character that is not allowed, for half a
        byte and for a frame that is abandoned; it is reported only if no other error is.
        """
        for character in line:
            if character.gap > self.config.timeout:
                yield from self.silence()
            yield from self._character(character)

    def silence(self):
        """Yield the frame that a silence longer than the time-out ends."""
        if self.receiving:
            self._errors.add("gap")
            yield self._end(complete=False)

    def _character(self, character):
        byte = character.byte
        if not self.receiving:
            if byte == COLON:
                self._begin(character)
            return
        if self._carriage_return and byte == self.diagnostics.delimiter & SEVEN_BITS:
            self._note(character)
            yield self._end(complete=True)
        elif byte == COLON:
            if self._digits or self._carriage_return:
                self._note(character)
                yield self._end(complete=False)
            self._begin(character)
        elif self._carriage_return:
            self._note(character)
            yield self._end(complete=False)
        elif byte == CARRIAGE_RETURN:
            self._note(character)
            self._carriage_return = True
        else:
            self._note(character)
            self._digits.append(byte)

    def _begin(self, colon):
        self._digits, self._carriage_return, self._errors = [], False, set()
        self._note(colon)

    def _note(self, character):
        if character.error:
            self._errors.add(character.error)

    def _end(self, complete):
        """(bytes without LRC or None, errors, errors that may be reported too)."""
        digits, must = self._digits, self._errors
        self.reset()
        may = {"parity"} if "framing" in must else set()
        allowed = complete and len(digits) % 2 == 0 and all(d in HEXADECIMAL for d in digits)
        if len(digits) // 2 < SHORTEST_ASCII:
            must.add("short")
        if len(digits) > 2 * LONGEST_ASCII:
            must.add("long")
        data = bytes.fromhex(bytes(digits).decode()) if allowed else b""
        explained = must - ({"gap"} if self.config.gap_count_only else set())
        if not explained and (not allowed or lrc(data)):
            must.add("crc")
        return (None if must else data[:-1]), must, may - must
