# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The reference slave: what the core must answer, in plain Python without signals or time.

Written from MODBUS Application Protocol V1.1b3 and MODBUS over Serial Line V1.02, never from the
RTL. One call of `Slave.request` is everything the line carries between two silences of t3.5.
"""

from collections import Counter, namedtuple
from dataclasses import dataclass, field

from . import frames
from .defs import (
    ADDRESSES,
    ALL_FUNCTIONS,
    BIT_SPACES,
    BROADCAST,
    COIL_OFF,
    COIL_ON,
    ERRORS,
    EX,
    EXCEPTION_FLAG,
    FC,
    FIRST_ADDRESS,
    FUNCTIONS,
    LAST_ADDRESS,
    LONGEST_FRAME,
    SHORTEST_FRAME,
    T15_CHARACTERS,
    T35_CHARACTERS,
    Limits,
    Space,
    reference_map,
)

# One character on the line: `gap` is the silence before it in character times, `error` is
# None, "parity" or "framing".
Character = namedtuple("Character", "byte gap error", defaults=(0.0, None))


def split(line, t35):
    """`line` cut at every silence of `t35` characters or more: what `Slave.request` takes."""
    pieces = [[]]
    for place, character in enumerate(characters(line)):
        if place and character.gap >= t35:
            pieces.append([])
        pieces[-1].append(character)
    return pieces


REGISTER_BITS = 16


def characters(line):
    """Any mix of bytes and (byte, gap, error) tuples as a list of Character."""
    return [Character(c) if isinstance(c, int) else Character(*c) for c in line]


class Refused(Exception):
    """The request ends with an exception answer."""

    def __init__(self, code):
        super().__init__(f"exception {code:02X}")
        self.code = code


@dataclass
class Config:
    """What a slave is built and set up with; defaults are those of the live device."""

    address: int = 17
    tables: dict = field(default_factory=reference_map)  # {space: (base, count)}
    functions: frozenset = ALL_FUNCTIONS
    limits: Limits = Limits()
    read_only: tuple = (0, 0)  # (base, count) of holding registers
    overlay: bool = False
    broadcast: bool = True
    gap_count_only: bool = False
    t15: float = T15_CHARACTERS  # in character times
    t35: float = T35_CHARACTERS


class Memory:
    """The four tables; with `overlay` one block of registers behind all of them."""

    def __init__(self, config):
        self.config = config
        _, registers = config.tables[Space.HOLDINGS]
        if config.overlay:
            block = [0] * registers
            self._data = dict.fromkeys((Space.INPUTS, Space.HOLDINGS), block)
        else:
            self._data = {s: [0] * count for s, (_, count) in config.tables.items()}

    def _place(self, space, address):
        base, count = self.config.tables[space]
        if not 0 <= address - base < count:
            raise KeyError(f"{Space(space).name} has no {address}")
        return address - base

    def __getitem__(self, key):
        """Item `key` = (space, address)."""
        space, address = key
        place = self._place(space, address)
        if self.config.overlay and space in BIT_SPACES:
            word, bit = divmod(place, REGISTER_BITS)
            return (self._data[Space.HOLDINGS][word] >> bit) & 1
        return self._data[space][place]

    def __setitem__(self, key, value):
        space, address = key
        place = self._place(space, address)
        if space in BIT_SPACES and value not in (0, 1):
            raise ValueError(f"a bit cannot be {value}")
        if not 0 <= value < ADDRESSES:
            raise ValueError(f"a register cannot be {value}")
        if self.config.overlay and space in BIT_SPACES:
            word, bit = divmod(place, REGISTER_BITS)
            old = self._data[Space.HOLDINGS][word]
            self._data[Space.HOLDINGS][word] = (old & ~(1 << bit)) | (value << bit)
        else:
            self._data[space][place] = value

    def addresses(self):
        """Every (space, address) there is."""
        for space, (base, count) in self.config.tables.items():
            for address in range(base, base + count):
                yield space, address


class Slave:
    """A Modbus RTU slave.

    Run-time inputs are attributes: `busy`, `write_lock`, `memory`, and the configuration's
    address, broadcast and gap_count_only. `grant`, if set, is the bank's own opinion:
    `grant(space, first, last, write)` -> exception code or 0, asked after all other checks.

    After each request `errors` is the set of error strobes that must have risen, `allowed` those
    that may have risen beside them, `good` whether the frame counts as good, `written` the list of
    committed writes (space, first, last).  `counts` sums good frames and errors.
    """

    def __init__(self, config=None):
        self.config = config or Config()
        self.memory = Memory(self.config)
        self.busy = False
        self.write_lock = False
        self.grant = None
        self.counts = Counter()
        self.errors, self.allowed, self.good, self.written = set(), set(), False, []
        self._functions = {
            FC.READ_COILS: self._read_bits,
            FC.READ_DISCRETES: self._read_bits,
            FC.READ_HOLDINGS: self._read_registers,
            FC.READ_INPUTS: self._read_registers,
            FC.WRITE_COIL: self._write_coil,
            FC.WRITE_REGISTER: self._write_register,
            FC.WRITE_COILS: self._write_coils,
            FC.WRITE_REGISTERS: self._write_registers,
            FC.MASK_WRITE: self._mask_write,
            FC.READ_WRITE: self._read_write,
        }

    # ------------------------------------------------------------------ the frame

    def request(self, line):
        """Play what the line carries between two silences; the answer frame, or None.

        `line` is bytes, or a list of bytes and (byte, gap in characters, error).
        Raises ValueError if a gap inside is a frame boundary.
        """
        self.written = []
        self.errors, self.allowed = self._judge(characters(line))
        self.good = not (self.errors - ({"gap"} if self.config.gap_count_only else set()))
        self.counts.update(self.errors)
        if not self.good:
            return None
        self.counts["good"] += 1
        frame = bytes(c.byte for c in characters(line))
        address, pdu = frame[0], frame[1:-2]
        if not self._for_us(address):
            return None
        self.counts["for_us"] += 1
        try:
            answer = self._process(pdu, address == BROADCAST)
        except Refused as refusal:
            self.counts["exception"] += 1
            answer = bytes([pdu[0] | EXCEPTION_FLAG, refusal.code])
        if address == BROADCAST:
            return None
        return frames.adu(self.config.address, answer)

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
        own = self.config.address
        return FIRST_ADDRESS <= own <= LAST_ADDRESS and address == own

    # ------------------------------------------------------------------ the request

    def _process(self, pdu, broadcast):
        code = pdu[0]
        if code not in self.config.functions or not self._table_exists(code):
            raise Refused(EX.FUNCTION)
        if broadcast and not FUNCTIONS[code].broadcast:
            raise Refused(EX.FUNCTION)
        return self._functions[code](pdu)

    def _table_exists(self, code):
        return self.config.tables[FUNCTIONS[code].space][1] > 0

    def _grant(self, space, address, quantity, write):
        """Exception 02 for what does not exist or is not writable, then whatever the bank says."""
        base, count = self.config.tables[space]
        last = address + quantity - 1
        if last >= ADDRESSES or address < base or last >= base + count:
            raise Refused(EX.ADDRESS)
        if write and (self.write_lock or self._read_only(space, address, last)):
            raise Refused(EX.ADDRESS)

    def _read_only(self, space, first, last):
        """True if the range touches a read-only holding register, in an overlay also by its bits."""
        if self.config.overlay and space in BIT_SPACES:
            first, last = first // REGISTER_BITS, last // REGISTER_BITS
        elif space != Space.HOLDINGS:
            return False
        base, count = self.config.read_only
        return first < base + count and last >= base

    def _execute(self, *ranges):
        """Every range granted before anything happens; ranges are (space, address, quantity, write)."""
        for one in ranges:
            self._grant(*one)
        if self.busy:
            raise Refused(EX.BUSY)
        if self.grant:
            for space, address, quantity, write in ranges:
                code = self.grant(space, address, address + quantity - 1, write)
                if code:
                    raise Refused(code)

    def _load(self, space, address, quantity):
        return [self.memory[space, address + i] for i in range(quantity)]

    def _store(self, space, address, values):
        for i, value in enumerate(values):
            self.memory[space, address + i] = value
        self.written.append((space, address, address + len(values) - 1))

    # ------------------------------------------------------------------ the functions

    def _read_bits(self, pdu):
        space = FUNCTIONS[pdu[0]].space
        address, quantity = self._fields(pdu, 2)
        self._quantity(quantity, self.config.limits.read_bits)
        self._execute((space, address, quantity, False))
        data = frames.pack_bits(self._load(space, address, quantity))
        return bytes([pdu[0], len(data)]) + data

    def _read_registers(self, pdu):
        space = FUNCTIONS[pdu[0]].space
        address, quantity = self._fields(pdu, 2)
        self._quantity(quantity, self.config.limits.read_registers)
        self._execute((space, address, quantity, False))
        return bytes([pdu[0], 2 * quantity]) + frames.pack_words(self._load(space, address, quantity))

    def _write_coil(self, pdu):
        address, value = self._fields(pdu, 2)
        if value not in (COIL_ON, COIL_OFF):
            raise Refused(EX.VALUE)
        self._execute((Space.COILS, address, 1, True))
        self._store(Space.COILS, address, [int(value == COIL_ON)])
        return pdu

    def _write_register(self, pdu):
        address, value = self._fields(pdu, 2)
        self._execute((Space.HOLDINGS, address, 1, True))
        self._store(Space.HOLDINGS, address, [value])
        return pdu

    def _write_coils(self, pdu):
        (address, quantity), data = self._list(pdu, 2)
        self._quantity(quantity, self.config.limits.write_bits)
        if len(data) != (quantity + 7) // 8:
            raise Refused(EX.VALUE)
        self._execute((Space.COILS, address, quantity, True))
        self._store(Space.COILS, address, frames.unpack_bits(data, quantity))
        return pdu[:5]

    def _write_registers(self, pdu):
        (address, quantity), data = self._list(pdu, 2)
        self._quantity(quantity, self.config.limits.write_registers)
        if len(data) != 2 * quantity:
            raise Refused(EX.VALUE)
        self._execute((Space.HOLDINGS, address, quantity, True))
        self._store(Space.HOLDINGS, address, frames.unpack_words(data))
        return pdu[:5]

    def _mask_write(self, pdu):
        address, and_mask, or_mask = self._fields(pdu, 3)
        self._execute((Space.HOLDINGS, address, 1, True))
        old = self.memory[Space.HOLDINGS, address]
        self._store(Space.HOLDINGS, address, [(old & and_mask) | (or_mask & ~and_mask)])
        return pdu

    def _read_write(self, pdu):
        (r_address, r_quantity, w_address, w_quantity), data = self._list(pdu, 4)
        self._quantity(r_quantity, self.config.limits.rw_read)
        self._quantity(w_quantity, self.config.limits.rw_write)
        if len(data) != 2 * w_quantity:
            raise Refused(EX.VALUE)
        self._execute(
            (Space.HOLDINGS, r_address, r_quantity, False),
            (Space.HOLDINGS, w_address, w_quantity, True),
        )
        self._store(Space.HOLDINGS, w_address, frames.unpack_words(data))
        words = self._load(Space.HOLDINGS, r_address, r_quantity)
        return bytes([pdu[0], 2 * r_quantity]) + frames.pack_words(words)

    @staticmethod
    def _fields(pdu, count):
        """The `count` 16-bit fields that are all the PDU holds; else exception 03."""
        if len(pdu) != 1 + 2 * count:
            raise Refused(EX.VALUE)
        return frames.unpack_words(pdu[1:])

    @staticmethod
    def _list(pdu, count):
        """(`count` 16-bit fields, data bytes): data must be as long as its byte count says."""
        head = 1 + 2 * count
        if len(pdu) < head + 1 or pdu[head] != len(pdu) - head - 1:
            raise Refused(EX.VALUE)
        return frames.unpack_words(pdu[1:head]), pdu[head + 1 :]

    @staticmethod
    def _quantity(quantity, most):
        if not 1 <= quantity <= most:
            raise Refused(EX.VALUE)
