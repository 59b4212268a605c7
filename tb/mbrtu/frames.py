# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Frames and PDUs as bytes: building, checking, taking apart."""

import struct

from .defs import COIL_OFF, COIL_ON, FC

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


def text(frame):
    """Hex bytes for people, `None` as silence."""
    return "silence" if frame is None else bytes(frame).hex(" ").upper()
