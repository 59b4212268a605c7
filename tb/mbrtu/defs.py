# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Function codes, exception codes, limits, spaces, formats and the reference map: one place.

MODBUS Application Protocol V1.1b3 sections 4 to 7, MODBUS over Serial Line V1.02 section 2.5.
"""

from dataclasses import dataclass, field
from enum import IntEnum


class Space(IntEnum):
    """The upper three bits of a bus address, and the word of the grant question."""

    COILS = 0
    DISCRETES = 1
    INPUTS = 2
    HOLDINGS = 3
    FILES = 4


BIT_SPACES = (Space.COILS, Space.DISCRETES)
ADDRESSES = 65536  # items a space can have
SPACE_SHIFT = 16  # bus address = {space, item}


def bus_address(space, item):
    """The 19-bit Wishbone address of one item."""
    return (int(space) << SPACE_SHIFT) | item


class FC(IntEnum):
    """Function codes that the core implements."""

    READ_COILS = 0x01
    READ_DISCRETES = 0x02
    READ_HOLDINGS = 0x03
    READ_INPUTS = 0x04
    WRITE_COIL = 0x05
    WRITE_REGISTER = 0x06
    WRITE_COILS = 0x0F
    WRITE_REGISTERS = 0x10
    MASK_WRITE = 0x16
    READ_WRITE = 0x17


class EX(IntEnum):
    """Exception codes (V1.1b3 section 7)."""

    FUNCTION = 0x01
    ADDRESS = 0x02
    VALUE = 0x03
    FAILURE = 0x04
    ACKNOWLEDGE = 0x05
    BUSY = 0x06
    NAK = 0x07
    PARITY = 0x08
    GATEWAY_PATH = 0x0A
    GATEWAY_TARGET = 0x0B


@dataclass(frozen=True)
class Function:
    """One row of the function table."""

    code: FC
    name: str
    space: Space
    reads: bool
    writes: bool
    broadcast: bool


FUNCTIONS = {
    row.code: row
    for row in (
        Function(FC.READ_COILS, "read coils", Space.COILS, True, False, False),
        Function(FC.READ_DISCRETES, "read discrete inputs", Space.DISCRETES, True, False, False),
        Function(FC.READ_HOLDINGS, "read holding registers", Space.HOLDINGS, True, False, False),
        Function(FC.READ_INPUTS, "read input registers", Space.INPUTS, True, False, False),
        Function(FC.WRITE_COIL, "write single coil", Space.COILS, False, True, True),
        Function(FC.WRITE_REGISTER, "write single register", Space.HOLDINGS, False, True, True),
        Function(FC.WRITE_COILS, "write multiple coils", Space.COILS, False, True, True),
        Function(FC.WRITE_REGISTERS, "write multiple registers", Space.HOLDINGS, False, True, True),
        Function(FC.MASK_WRITE, "mask write register", Space.HOLDINGS, True, True, False),
        Function(FC.READ_WRITE, "read/write multiple registers", Space.HOLDINGS, True, True, False),
    )
}
ALL_FUNCTIONS = frozenset(FUNCTIONS)

COIL_ON = 0xFF00
COIL_OFF = 0x0000
EXCEPTION_FLAG = 0x80

BROADCAST = 0
FIRST_ADDRESS, LAST_ADDRESS = 1, 247

SHORTEST_FRAME = 4  # address, function, CRC
LONGEST_FRAME = 256
T15_CHARACTERS, T35_CHARACTERS = 1.5, 3.5
FLOOR_BAUD = 19200  # above it t1.5 and t3.5 no longer shrink
T15_FLOOR_US, T35_FLOOR_US = 750, 1750


@dataclass(frozen=True)
class Limits:
    """Largest quantities of one request."""

    read_bits: int = 2000
    write_bits: int = 1968
    read_registers: int = 125
    write_registers: int = 123
    rw_read: int = 125
    rw_write: int = 121


def reference_map():
    """{space: (base, count)} of the live device."""
    return {
        Space.COILS: (0, 1024),
        Space.DISCRETES: (0, 2048),
        Space.INPUTS: (0, 1024),
        Space.HOLDINGS: (0, 2048),
    }


@dataclass(frozen=True)
class Format:
    """A character format: code on `format_i`, parity 'even', 'odd' or None, stop bits."""

    code: int
    name: str
    parity: str | None
    stops: int
    length: int = field(init=False)

    def __post_init__(self):
        object.__setattr__(self, "length", 1 + 8 + (self.parity is not None) + self.stops)


F8E1 = Format(0, "8E1", "even", 1)
F8O1 = Format(1, "8O1", "odd", 1)
F8N2 = Format(2, "8N2", None, 2)
F8N1 = Format(3, "8N1", None, 1)
FORMATS = (F8E1, F8O1, F8N2, F8N1)
FORMAT_BY_NAME = {f.name: f for f in FORMATS}

# The error strobes of the core, without err_ and _o.
ERRORS = ("parity", "framing", "overrun", "crc", "short", "long", "gap")
