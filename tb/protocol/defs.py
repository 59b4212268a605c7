# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Function codes, exception codes, limits, spaces, formats and the reference map: one place.

MODBUS Application Protocol V1.1b3 sections 4 to 7, MODBUS over Serial Line V1.02 section 2.5 and
appendix A.
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
CHECK_SPACES = {6: Space.COILS, 7: Space.HOLDINGS}  # on the bus in a checking pass: which table is checked
SPACE_SHIFT = 16  # bus address = {space, item}


def bus_address(space, item):
    """The 19-bit Wishbone address of one item."""
    return (int(space) << SPACE_SHIFT) | item


class FC(IntEnum):
    """Public function codes of the serial line (V1.1b3 section 6)."""

    READ_COILS = 0x01
    READ_DISCRETES = 0x02
    READ_HOLDINGS = 0x03
    READ_INPUTS = 0x04
    WRITE_COIL = 0x05
    WRITE_REGISTER = 0x06
    READ_EXCEPTION_STATUS = 0x07
    DIAGNOSTICS = 0x08
    GET_EVENT_COUNTER = 0x0B
    GET_EVENT_LOG = 0x0C
    WRITE_COILS = 0x0F
    WRITE_REGISTERS = 0x10
    REPORT_SERVER_ID = 0x11
    READ_FILE = 0x14
    WRITE_FILE = 0x15
    MASK_WRITE = 0x16
    READ_WRITE = 0x17
    READ_FIFO = 0x18
    READ_DEVICE_ID = 0x2B


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
class Limits:
    """Largest quantities of one request."""

    read_bits: int = 2000
    write_bits: int = 1968
    read_registers: int = 125
    write_registers: int = 123
    rw_read: int = 125
    rw_write: int = 121


LONGEST_PDU = 253

# File records, function codes 14 and 15.
REFERENCE_TYPE = 6
LAST_RECORD = 9999
GROUP_HEAD = 7  # reference type, file, first record, quantity
READ_FILE_BYTES = (7, 0xF5)  # smallest and largest byte count of the request
READ_FILE_ANSWER = 0xF5  # largest byte count of the answer
WRITE_FILE_BYTES = (9, 0xFB)

FIFO_MOST = 31  # entries of a queue that function code 18 reads

# Device identification, function code 2B.
MEI_DEVICE_ID = 0x0E
DEVICE_ID_HEAD = 7  # bytes of the answer PDU before the first object
BASIC, REGULAR, EXTENDED, INDIVIDUAL = 1, 2, 3, 4  # read device ID codes
LEVEL_LAST = {BASIC: 0x02, REGULAR: 0x06, EXTENDED: 0xFF}  # last object id of a level
INDIVIDUAL_ACCESS = 0x80  # in the conformity
CONFORMITIES = (0x01, 0x02, 0x03, 0x81, 0x82, 0x83)
FIRST_PRIVATE_OBJECT = 0x80
LONGEST_OBJECT = 244
DEFAULT_OBJECTS = {0: b"VENDOR", 1: b"PRODUCT", 2: b"V1.0"}


@dataclass(frozen=True)
class Function:
    """One row of the function table. A function that touches data has a space, and can be busy."""

    code: FC
    name: str
    space: Space | None
    reads: bool = False
    writes: bool = False
    broadcast: bool = False
    counts: bool = True  # success counts in the event counter
    limits: str = ""


def _functions():
    most = Limits()
    bits, registers = f"1 to {most.read_bits} bits", f"1 to {most.read_registers} registers"
    reads, writes = {"reads": True}, {"writes": True}
    modifies, spread = {**reads, **writes}, {**writes, "broadcast": True}
    answer_words = (READ_FILE_ANSWER - 2) // 2
    written_words = (WRITE_FILE_BYTES[1] - GROUP_HEAD) // 2
    return (
        Function(FC.READ_COILS, "read coils", Space.COILS, **reads, limits=bits),
        Function(FC.READ_DISCRETES, "read discrete inputs", Space.DISCRETES, **reads, limits=bits),
        Function(FC.READ_HOLDINGS, "read holding registers", Space.HOLDINGS, **reads, limits=registers),
        Function(FC.READ_INPUTS, "read input registers", Space.INPUTS, **reads, limits=registers),
        Function(FC.WRITE_COIL, "write single coil", Space.COILS, **spread, limits="FF00 or 0000"),
        Function(FC.WRITE_REGISTER, "write single register", Space.HOLDINGS, **spread, limits="any value"),
        Function(FC.READ_EXCEPTION_STATUS, "read exception status", None, limits="8 bits"),
        Function(FC.DIAGNOSTICS, "diagnostics", None, limits=f"sub-functions {_sub_ranges()}"),
        Function(FC.GET_EVENT_COUNTER, "get comm event counter", None, counts=False),
        Function(FC.GET_EVENT_LOG, "get comm event log", None, limits=f"up to {LOG_SIZE} events"),
        Function(FC.WRITE_COILS, "write multiple coils", Space.COILS, **spread, limits=f"1 to {most.write_bits} bits"),
        Function(
            FC.WRITE_REGISTERS,
            "write multiple registers",
            Space.HOLDINGS,
            **spread,
            limits=f"1 to {most.write_registers} registers",
        ),
        Function(FC.REPORT_SERVER_ID, "report slave ID", None),
        Function(
            FC.READ_FILE,
            "read file record",
            Space.FILES,
            **reads,
            limits=f"up to {READ_FILE_BYTES[1] // GROUP_HEAD} groups, {answer_words} registers",
        ),
        Function(
            FC.WRITE_FILE,
            "write file record",
            Space.FILES,
            **writes,
            limits=f"several groups, {written_words} registers",
        ),
        Function(FC.MASK_WRITE, "mask write register", Space.HOLDINGS, **modifies, limits="any masks"),
        Function(
            FC.READ_WRITE,
            "read/write multiple registers",
            Space.HOLDINGS,
            **modifies,
            limits=f"1 to {most.rw_read} read, 1 to {most.rw_write} written",
        ),
        Function(FC.READ_FIFO, "read FIFO queue", Space.HOLDINGS, **reads, limits=f"0 to {FIFO_MOST} entries"),
        Function(
            FC.READ_DEVICE_ID,
            "read device identification",
            None,
            limits=f"MEI type {MEI_DEVICE_ID:02X}, objects up to {LONGEST_OBJECT} bytes",
        ),
    )


class Sub(IntEnum):
    """Sub-functions of function code 08."""

    QUERY_DATA = 0x00
    RESTART = 0x01
    DIAGNOSTIC_REGISTER = 0x02
    DELIMITER = 0x03
    LISTEN_ONLY = 0x04
    CLEAR = 0x0A
    BUS_MESSAGE = 0x0B
    BUS_COMM_ERROR = 0x0C
    BUS_EXCEPTION = 0x0D
    SLAVE_MESSAGE = 0x0E
    SLAVE_NO_RESPONSE = 0x0F
    SLAVE_NAK = 0x10
    SLAVE_BUSY = 0x11
    BUS_CHAR_OVERRUN = 0x12
    CLEAR_OVERRUN = 0x14


def _sub_ranges():
    """The sub-functions as text: "0000-0004, 000A-0012, 0014"."""
    spans = []
    for sub in sorted(Sub):
        if spans and sub == spans[-1][1] + 1:
            spans[-1][1] = sub
        else:
            spans.append([sub, sub])
    return ", ".join(f"{a:04X}" if a == b else f"{a:04X}-{b:04X}" for a, b in spans)


QUERY_DATA_MOST = 250  # bytes
RESTART_KEEP, RESTART_CLEAR = 0x0000, 0xFF00  # sub-function 0001: the log stays, or is emptied
LINE_FEED = 0x0A
OVERRUN_FLAG = 0x0001  # in the diagnostic register
STATUS_READY, STATUS_BUSY = 0x0000, 0xFFFF  # of 0B and 0C

# The eight counters, CPT1 to CPT8, and the sub-function that returns each; its number is the
# counter's address at the counter port too.
COUNTERS = {
    "bus_message": Sub.BUS_MESSAGE,
    "bus_comm_error": Sub.BUS_COMM_ERROR,
    "bus_exception": Sub.BUS_EXCEPTION,
    "slave_message": Sub.SLAVE_MESSAGE,
    "slave_no_response": Sub.SLAVE_NO_RESPONSE,
    "slave_nak": Sub.SLAVE_NAK,
    "slave_busy": Sub.SLAVE_BUSY,
    "bus_char_overrun": Sub.BUS_CHAR_OVERRUN,
}
EVENT_COUNTER = "event_counter"
ALL_COUNTERS = (*COUNTERS, EVENT_COUNTER)
COUNTER_ADDRESS = {EVENT_COUNTER: 0x0A, **{name: int(sub) for name, sub in COUNTERS.items()}}
LOG_ADDRESS = 0x40  # of the newest entry at the status port
REGISTER_ADDRESS, LISTEN_ADDRESS, ENTRIES_ADDRESS = 0x00, 0x01, 0x02  # of the status port
LOG_SIZE = 64

# Bytes of the event log.
RECEIVED, RECEIVED_BROADCAST, RECEIVED_LISTENING = 0x80, 0x40, 0x20
RECEIVED_OVERRUN, RECEIVED_ERROR = 0x10, 0x02
SENT, SENT_LISTENING = 0x40, 0x20
SENT_NAK, SENT_BUSY, SENT_FAILURE, SENT_REFUSAL = 0x08, 0x04, 0x02, 0x01
ENTERED_LISTEN_ONLY, RESTARTED = 0x04, 0x00

FUNCTIONS = {row.code: row for row in _functions()}  # in the order of the standard
ALL_FUNCTIONS = frozenset(FUNCTIONS)
DIAGNOSTIC_FUNCTIONS = frozenset((FC.DIAGNOSTICS, FC.GET_EVENT_COUNTER, FC.GET_EVENT_LOG))
FILE_FUNCTIONS = frozenset((FC.READ_FILE, FC.WRITE_FILE))

COIL_ON = 0xFF00
COIL_OFF = 0x0000
EXCEPTION_FLAG = 0x80

BROADCAST = 0
FIRST_ADDRESS, LAST_ADDRESS = 1, 247

SHORTEST_FRAME = 4  # address, function, CRC
LONGEST_FRAME = 256
T15_CHARACTERS, T35_CHARACTERS = 1.5, 3.5
DEFAULT_BAUD = 19200
FLOOR_BAUD = 19200  # above it t1.5 and t3.5 no longer shrink
T15_FLOOR_US, T35_FLOOR_US = 750, 1750


def reference_map():
    """{space: (base, count)} of the live device."""
    return {
        Space.COILS: (0, 1024),
        Space.DISCRETES: (0, 2048),
        Space.INPUTS: (0, 1024),
        Space.HOLDINGS: (0, 2048),
    }


REFERENCE_FILES = (4, 256)  # files, records of each


@dataclass(frozen=True)
class Format:
    """A character format: code on `format_i`, parity 'even', 'odd' or None, stop bits, data bits."""

    code: int
    name: str
    parity: str | None
    stops: int
    data_bits: int = 8
    length: int = field(init=False)

    def __post_init__(self):
        object.__setattr__(self, "length", 1 + self.data_bits + (self.parity is not None) + self.stops)


F8E1 = Format(0, "8E1", "even", 1)
F8O1 = Format(1, "8O1", "odd", 1)
F8N2 = Format(2, "8N2", None, 2)
F8N1 = Format(3, "8N1", None, 1)
FORMATS = (F8E1, F8O1, F8N2, F8N1)
FORMAT_BY_NAME = {f.name: f for f in FORMATS}
F7E1, F7O1, F7N2, F7N1 = (Format(f.code, f.name.replace("8", "7"), f.parity, f.stops, 7) for f in FORMATS)
ASCII_FORMATS = {f.name: f for f in (F7E1, F7O1, F7N2, F7N1, *FORMATS)}  # those of ASCII mode

# ASCII mode (MODBUS over Serial Line V1.02, clause 2.5.2)
COLON, CARRIAGE_RETURN = 0x3A, 0x0D
HEXADECIMAL = b"0123456789ABCDEF"
SHORTEST_ASCII, LONGEST_ASCII = 3, 255  # bytes: address, function code, LRC; address, PDU, LRC
ASCII_TIMEOUT_MS = 1000

# The error strobes of the core, without err_ and _o.
ERRORS = ("parity", "framing", "overrun", "crc", "short", "long", "gap")
