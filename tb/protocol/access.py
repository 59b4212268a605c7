# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What the reference slave does with data: tables, files, queue (V1.1b3 6.1 to 6.6, 6.11 to 6.18)."""

from . import frames
from .defs import (
    ADDRESSES,
    BIT_SPACES,
    COIL_OFF,
    COIL_ON,
    EX,
    FC,
    FIFO_MOST,
    FUNCTIONS,
    GROUP_HEAD,
    LAST_RECORD,
    READ_FILE_ANSWER,
    READ_FILE_BYTES,
    REFERENCE_TYPE,
    WRITE_FILE_BYTES,
    Space,
)
from .diagnostics import Refused
from .memory import REGISTER_BITS, Memory


class DataAccess:
    """The functions that touch data, each of them from request PDU to answer PDU."""

    def __init__(self, config):
        self.config = config
        self.memory = Memory(config)
        self.busy = False
        self.write_lock = False
        self.failure = 0
        self.grant = None
        self.written, self.touched = [], set()
        self._functions = {
            FC.READ_COILS: self._read_bits,
            FC.READ_DISCRETES: self._read_bits,
            FC.READ_HOLDINGS: self._read_registers,
            FC.READ_INPUTS: self._read_registers,
            FC.WRITE_COIL: self._write_coil,
            FC.WRITE_REGISTER: self._write_register,
            FC.WRITE_COILS: self._write_coils,
            FC.WRITE_REGISTERS: self._write_registers,
            FC.READ_FILE: self._read_files,
            FC.WRITE_FILE: self._write_files,
            FC.MASK_WRITE: self._mask_write,
            FC.READ_WRITE: self._read_write,
            FC.READ_FIFO: self._read_fifo,
        }

    # ------------------------------------------------------------------ may it be done

    def _grant(self, space, address, quantity, write, file=None):
        """Exception 02 for what does not exist or is not writable."""
        if space == Space.FILES:
            files, records = self.config.files
            exists = 1 <= file <= files and address <= LAST_RECORD and address + quantity <= records
        else:
            base, count = self.config.tables[space]
            last = address + quantity - 1
            exists = last < ADDRESSES and base <= address and last < base + count
        if not exists:
            raise Refused(EX.ADDRESS)
        if write and (self.write_lock or self._read_only(space, address, address + quantity - 1)):
            raise Refused(EX.ADDRESS)

    def _read_only(self, space, first, last):
        """True if the range touches a read-only holding register, in an overlay also by its bits."""
        if self.config.overlay and space in BIT_SPACES:
            first, last = first // REGISTER_BITS, last // REGISTER_BITS
        elif space != Space.HOLDINGS:
            return False
        base, count = self.config.read_only
        return first < base + count and last >= base

    def _question(self, space, address, quantity, write, *file):
        """One grant question: what there is, then whatever the bank says."""
        self._grant(space, address, quantity, write, *file)
        code = self.grant and self.grant(space, address, address + quantity - 1, write, *file)
        if code:
            raise Refused(code)

    def _ready(self):
        """After all questions: a slave that is busy or reports a failure does nothing."""
        if self.busy:
            raise Refused(EX.BUSY)
        if self.failure:
            raise Refused(self.failure)

    def _execute(self, *ranges):
        """Every range granted before anything happens; ranges are (space, address, quantity, write[, file])."""
        for one in ranges:
            self._question(*one)
        self._ready()

    def _load(self, space, address, quantity):
        return [self.memory[space, address + i] for i in range(quantity)]

    def _store(self, space, address, values):
        for i, value in enumerate(values):
            self.memory[space, address + i] = value
        self.touched |= {(space, address + i) for i in range(len(values))}
        if space != Space.FILES:
            self.written.append((space, address, address + len(values) - 1))

    # ------------------------------------------------------------------ tables

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

    def _read_fifo(self, pdu):
        (pointer,) = self._fields(pdu, 1)
        self._question(Space.HOLDINGS, pointer, 1, False)
        count = self.memory[Space.HOLDINGS, pointer]
        if count > FIFO_MOST:
            raise Refused(EX.VALUE)
        self._execute((Space.HOLDINGS, pointer, 1 + count, False))
        words = self._load(Space.HOLDINGS, pointer, 1 + count)
        return bytes([pdu[0]]) + frames.pack_words([2 * len(words), *words])

    # ------------------------------------------------------------------ files

    def _read_files(self, pdu):
        data = self._file_data(pdu, READ_FILE_BYTES)
        if len(data) % GROUP_HEAD:
            raise Refused(EX.VALUE)
        groups = [_group(data, place) for place in range(0, len(data), GROUP_HEAD)]
        quantities = [quantity for _, _, _, quantity in groups]
        if not all(quantities) or sum(2 + 2 * n for n in quantities) > READ_FILE_ANSWER:
            raise Refused(EX.VALUE)
        self._grant_files(groups, False)
        body = b""
        for _, file, first, quantity in groups:
            words = self._load(Space.FILES, self.config.record_item(file, first), quantity)
            body += bytes([1 + 2 * quantity, REFERENCE_TYPE]) + frames.pack_words(words)
        return bytes([pdu[0], len(body)]) + body

    def _write_files(self, pdu):
        data = self._file_data(pdu, WRITE_FILE_BYTES)
        groups, values, place = [], [], 0
        while place < len(data):
            if len(data) - place < GROUP_HEAD:
                raise Refused(EX.VALUE)
            groups.append(_group(data, place))
            begin, quantity = place + GROUP_HEAD, groups[-1][3]
            place = begin + 2 * quantity
            if not quantity or place > len(data):
                raise Refused(EX.VALUE)
            values.append(frames.unpack_words(data[begin:place]))
        self._grant_files(groups, True)
        for (_, file, first, quantity), words in zip(groups, values):
            self._store(Space.FILES, self.config.record_item(file, first), words)
            self.written.append((Space.FILES, first, first + quantity - 1, file))
        return pdu

    @staticmethod
    def _file_data(pdu, limits):
        """The groups' bytes, as many as the byte count says."""
        if len(pdu) < 2 or pdu[1] != len(pdu) - 2 or not limits[0] <= pdu[1] <= limits[1]:
            raise Refused(EX.VALUE)
        return pdu[2:]

    def _grant_files(self, groups, write):
        for kind, file, first, quantity in groups:
            if kind != REFERENCE_TYPE:
                raise Refused(EX.ADDRESS)
            self._question(Space.FILES, first, quantity, write, file)
        self._ready()

    # ------------------------------------------------------------------ fields

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


def _group(data, place):
    """(reference type, file, first record, quantity) of the group at `place`."""
    return (data[place], *frames.unpack_words(data[place + 1 : place + GROUP_HEAD]))
