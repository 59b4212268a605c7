# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Frames and PDUs as bytes: building, checking, taking apart."""

import struct

from .defs import COIL_OFF, COIL_ON, FC, MEI_DEVICE_ID, REFERENCE_TYPE, RESTART_CLEAR, RESTART_KEEP, Sub

CRC_START = 0xFFFF
CRC_POLYNOMIAL = 0xA001  # x^16 + x^15 + x^2 + 1, least significant bit first


def _crc_table():
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = (crc >> 1) ^ (CRC_POLYNOMIAL if crc & 1 else 0)
        table.append(crc)
    return table


_TABLE = _crc_table()


def crc16(data, crc=CRC_START):
    """CRC of `data` as the 16-bit register holds it; on the line its low byte goes first."""
    for byte in data:
        crc = (crc >> 8) ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc


def sealed(data):
    """`data` with its CRC behind it."""
    data = bytes(data)
    return data + struct.pack("<H", crc16(data))


def adu(address, pdu):
    """The frame that carries `pdu` to or from slave `address`."""
    return sealed(bytes([address]) + bytes(pdu))


def check(frame):
    """True if the CRC at the end of `frame` is right."""
    return len(frame) >= 2 and crc16(frame) == 0


def lrc(data):
    """LRC of `data`: the two's complement of the sum of its bytes."""
    return -sum(data) & 0xFF


def ascii_line(data):
    """The characters that carry `data`, which ends with its LRC, in ASCII mode."""
    return b":" + bytes(data).hex().upper().encode() + b"\r\n"


def ascii_adu(address, pdu):
    """The characters of the frame that carries `pdu` to or from slave `address` in ASCII mode."""
    body = bytes([address]) + bytes(pdu)
    return ascii_line(body + bytes([lrc(body)]))


def bad_crc(frame, flip=0x0001):
    """`frame` with the bits of `flip` (16 bits, low byte first on the line) turned in its CRC."""
    frame = bytearray(frame)
    frame[-2] ^= flip & 0xFF
    frame[-1] ^= flip >> 8
    return bytes(frame)


def swapped_crc(frame):
    """`frame` with its CRC high byte first, as some texts print it."""
    return frame[:-2] + frame[-1:] + frame[-2:-1]


def pack_bits(bits):
    """Bits (0/1, first one lowest) in bytes, unused high bits 0."""
    out = bytearray((len(bits) + 7) // 8)
    for i, bit in enumerate(bits):
        if bit:
            out[i >> 3] |= 1 << (i & 7)
    return bytes(out)


def unpack_bits(data, count):
    """The first `count` bits of `data`, lowest first."""
    return [(data[i >> 3] >> (i & 7)) & 1 for i in range(count)]


def pack_words(words):
    """16-bit words, high byte first."""
    return struct.pack(f">{len(words)}H", *words)


def unpack_words(data):
    """The 16-bit words of `data`, high byte first."""
    return list(struct.unpack(f">{len(data) // 2}H", data))


# Request PDUs. Every argument goes into the frame as it is: legal or not is the slave's business.


def read(function, address, quantity):
    """FC 01, 02, 03, 04."""
    return struct.pack(">BHH", function, address, quantity)


def write_coil(address, on):
    """FC 05 with FF00 or 0000."""
    return struct.pack(">BHH", FC.WRITE_COIL, address, COIL_ON if on else COIL_OFF)


def write_register(address, value):
    """FC 06."""
    return struct.pack(">BHH", FC.WRITE_REGISTER, address, value)


def write_coils(address, bits, quantity=None, byte_count=None):
    """FC 0F."""
    data = pack_bits(bits)
    quantity = len(bits) if quantity is None else quantity
    byte_count = len(data) & 0xFF if byte_count is None else byte_count
    return struct.pack(">BHHB", FC.WRITE_COILS, address, quantity, byte_count) + data


def write_registers(address, words, quantity=None, byte_count=None):
    """FC 10."""
    quantity = len(words) if quantity is None else quantity
    byte_count = (2 * len(words)) & 0xFF if byte_count is None else byte_count
    head = struct.pack(">BHHB", FC.WRITE_REGISTERS, address, quantity, byte_count)
    return head + pack_words(words)


def mask_write(address, and_mask, or_mask):
    """FC 16."""
    return struct.pack(">BHHH", FC.MASK_WRITE, address, and_mask, or_mask)


def read_write(read_address, read_quantity, write_address, words, quantity=None, byte_count=None):
    """FC 17."""
    quantity = len(words) if quantity is None else quantity
    byte_count = (2 * len(words)) & 0xFF if byte_count is None else byte_count
    head = struct.pack(">BHHHHB", FC.READ_WRITE, read_address, read_quantity, write_address, quantity, byte_count)
    return head + pack_words(words)


def bare(function, data=b""):
    """A function code with bytes behind it or none: FC 07, 0B, 0C, 11, user functions."""
    return bytes([function]) + bytes(data)


def diagnostics(sub, *data):
    """FC 08; `data` are 16-bit words, or bytes objects for odd lengths. A sub-function alone gets 0000."""
    if not data:
        data = (0,)
    body = b"".join(d if isinstance(d, (bytes, bytearray)) else struct.pack(">H", d) for d in data)
    return struct.pack(">BH", FC.DIAGNOSTICS, sub) + body


def restart(clear_log=False):
    """FC 08, restart communications option."""
    return diagnostics(Sub.RESTART, RESTART_CLEAR if clear_log else RESTART_KEEP)


def read_files(*groups, byte_count=None):
    """FC 14; a group is (file, first record, quantity) and, if not 6, the reference type."""
    body = b"".join(_group_head(*group) for group in groups)
    return bytes([FC.READ_FILE, len(body) & 0xFF if byte_count is None else byte_count]) + body


def write_files(*groups, byte_count=None):
    """FC 15; a group is (file, first record, words) and, if not as it should be, quantity and reference type."""
    body = b""
    for file, first, words, *wrong in groups:
        quantity = wrong[0] if wrong and wrong[0] is not None else len(words)
        body += _group_head(file, first, quantity, *wrong[1:]) + pack_words(words)
    return bytes([FC.WRITE_FILE, len(body) & 0xFF if byte_count is None else byte_count]) + body


def _group_head(file, first, quantity, reference_type=REFERENCE_TYPE):
    return struct.pack(">BHHH", reference_type, file, first, quantity)


def read_fifo(pointer):
    """FC 18."""
    return struct.pack(">BH", FC.READ_FIFO, pointer)


def device_identification(code, first=0, mei=MEI_DEVICE_ID):
    """FC 2B: read device ID code and object id."""
    return bytes([FC.READ_DEVICE_ID, mei, code, first])


def text(frame):
    """Hex bytes for people, `None` as silence."""
    return "silence" if frame is None else bytes(frame).hex(" ").upper()


def requests(register=0, coil=0, discrete=None, word=None, file=1):
    """{function code: a right request PDU of it}; all that touch data touch what is named, from there on.

    `discrete` and `word` are addresses of a discrete input and an input register, those of coil and register unless
    given. Function code 18 finds at `register` what 06 writes there.
    """
    return {
        FC.READ_COILS: read(FC.READ_COILS, coil, 1),
        FC.READ_DISCRETES: read(FC.READ_DISCRETES, coil if discrete is None else discrete, 1),
        FC.READ_HOLDINGS: read(FC.READ_HOLDINGS, register, 1),
        FC.READ_INPUTS: read(FC.READ_INPUTS, register if word is None else word, 1),
        FC.WRITE_COIL: write_coil(coil, True),
        FC.WRITE_REGISTER: write_register(register, 1),
        FC.READ_EXCEPTION_STATUS: bare(FC.READ_EXCEPTION_STATUS),
        FC.DIAGNOSTICS: diagnostics(0, 0x1234),
        FC.GET_EVENT_COUNTER: bare(FC.GET_EVENT_COUNTER),
        FC.GET_EVENT_LOG: bare(FC.GET_EVENT_LOG),
        FC.WRITE_COILS: write_coils(coil, [1]),
        FC.WRITE_REGISTERS: write_registers(register, [1]),
        FC.REPORT_SERVER_ID: bare(FC.REPORT_SERVER_ID),
        FC.READ_FILE: read_files((file, 0, 1)),
        FC.WRITE_FILE: write_files((file, 0, [1])),
        FC.MASK_WRITE: mask_write(register, 0, 1),
        FC.READ_WRITE: read_write(register, 1, register, [1]),
        FC.READ_FIFO: read_fifo(register),
        FC.READ_DEVICE_ID: device_identification(1),
    }
