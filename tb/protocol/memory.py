# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a slave is built with, and what it holds: configuration, tables and files."""

from dataclasses import dataclass, field

from .defs import (
    ADDRESSES,
    ALL_FUNCTIONS,
    BIT_SPACES,
    DEFAULT_OBJECTS,
    DIAGNOSTIC_FUNCTIONS,
    FUNCTIONS,
    INDIVIDUAL_ACCESS,
    LONGEST_PDU,
    REFERENCE_FILES,
    T15_CHARACTERS,
    T35_CHARACTERS,
    Limits,
    Space,
    reference_map,
)

REGISTER_BITS = 16


@dataclass
class Config:
    """What a slave is built and set up with; defaults are those of the live device."""

    address: int = 17
    units: frozenset = frozenset()  # further addresses that are answered
    tables: dict = field(default_factory=reference_map)  # {space: (base, count)}
    functions: frozenset = ALL_FUNCTIONS
    limits: Limits = Limits()
    read_only: tuple = (0, 0)  # (base, count) of holding registers
    overlay: bool = False
    broadcast: bool = True
    gap_count_only: bool = False
    t15: float = T15_CHARACTERS  # in character times
    t35: float = T35_CHARACTERS
    timeout: float = float("inf")  # of ASCII mode, in character times
    files: tuple = REFERENCE_FILES  # (files, records of each)
    server_id: bytes = b"\x09"
    additional_data: bytes = b""
    objects: dict = field(default_factory=DEFAULT_OBJECTS.copy)  # {id: value} of the device identification
    conformity: int = INDIVIDUAL_ACCESS | 1
    device_id_limit: int = LONGEST_PDU  # largest answer PDU of function code 2B
    user_codes: frozenset = frozenset()  # function codes offered to Slave.user first

    @property
    def has_diagnostics(self):
        """True if there are counters, a log and a diagnostic register."""
        return bool(self.functions & DIAGNOSTIC_FUNCTIONS)

    def supports(self, code):
        """True if function code `code` is built in and has something to work on."""
        if code not in self.functions:
            return False
        space = FUNCTIONS[code].space
        if space is None:
            return True
        return (self.files[0] if space == Space.FILES else self.tables[space][1]) > 0

    def record_item(self, file, record):
        """The host port's item number of `record` of `file`."""
        return (file - 1) * self.files[1] + record


class Memory:
    """The four tables and the files; with `overlay` one block of registers behind all tables.

    Keys are (space, address); a record's address is that of Config.record_item.
    """

    def __init__(self, config):
        self.config = config
        _, registers = config.tables[Space.HOLDINGS]
        if config.overlay:
            block = [0] * registers
            self._data = dict.fromkeys((Space.INPUTS, Space.HOLDINGS), block)
        else:
            self._data = {s: [0] * count for s, (_, count) in config.tables.items()}
        self._records = {}  # what is not 0

    def _place(self, space, address):
        if space == Space.FILES:
            base, count = 0, self.config.files[0] * self.config.files[1]
        else:
            base, count = self.config.tables[space]
        if not 0 <= address - base < count:
            raise KeyError(f"{Space(space).name} has no {address}")
        return address - base

    def __getitem__(self, key):
        """Item `key` = (space, address)."""
        space, address = key
        place = self._place(space, address)
        if space == Space.FILES:
            return self._records.get(place, 0)
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
        if space == Space.FILES:
            self._records[place] = value
        elif self.config.overlay and space in BIT_SPACES:
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
        for item in range(self.config.files[0] * self.config.files[1]):
            yield Space.FILES, item
