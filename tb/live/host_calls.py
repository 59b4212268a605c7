# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The calls of the host library modbus_rtu.dll V3.3, each done by pymodbus: what docs/host_library.md shows.

A call is a function of (client, device id). It returns what the call would put into its buffer. The device begins with
the contents of INIT.
"""

from pymodbus.client import ModbusSerialClient

DATA = ModbusSerialClient.DATATYPE
ORDER = {0: "big", 1: "little"}  # `regular`: 0 the first register is the high word, 1 the low word

INIT = {
    "coils": {"19": [1, 0, 1, 1, 0, 0, 1, 1]},
    "discretes": {"196": [0, 0, 1, 1, 0, 1]},
    "inputs": {"8": [10, 65535], "20": [0xFFFF, 0xFFFE], "22": [0xFFFE, 0xFFFF], "24": [0x3F80, 0], "26": [0, 0x3F80]},
    "holdings": {
        "107": [555, 0, 100],
        "120": [0xFFFF, 0xFFFE],
        "122": [0xFFFE, 0xFFFF],
        "124": [0x3F80, 0],
        "126": [0, 0x3F80],
        "130": [0x00F0],
    },
}


def registers(answer):
    assert not answer.isError(), answer
    return list(answer.registers)


def words(client, node, code, address, count):
    """The registers of a read."""
    read = {3: client.read_holding_registers, 4: client.read_input_registers}[code]
    return registers(read(address, count=count, device_id=node))


def signed(values):
    """16-bit words as the library's ints."""
    return [value - 65536 if value > 32767 else value for value in values]


def bits(client, node, code, address, count):
    read = {1: client.read_coils, 2: client.read_discrete_inputs}[code]
    answer = read(address, count=count, device_id=node)
    assert not answer.isError(), answer
    return [int(bit) for bit in answer.bits[:count]]


def pairs(client, node, code, regular, address, kind):
    """A 32-bit value or a float of two registers."""
    return client.convert_from_registers(words(client, node, code, address, 2), kind, word_order=ORDER[regular])


def write(client, node, address, values):
    """Words by function code 16, read back."""
    registers(client.write_registers(address, values, device_id=node))
    return words(client, node, 3, address, len(values))


def write_pair(client, node, regular, address, kind, value):
    return write(client, node, address, client.convert_to_registers(value, kind, word_order=ORDER[regular]))


def write_word_bit(client, node, address, bit, value):
    """Read the word, set one bit, write it back."""
    (word,) = words(client, node, 3, address, 1)
    word = word | 1 << bit if value else word & ~(1 << bit)
    registers(client.write_register(address, word, device_id=node))


def word_bit_write(client, node, address, bit, value):
    write_word_bit(client, node, address, bit, value)
    return words(client, node, 3, address, 1)


def word_bit_set_reset(client, node, address, bit):
    """The bit on, then off, from one reading of the word."""
    (word,) = words(client, node, 3, address, 1)
    for value in (word | 1 << bit, word & ~(1 << bit)):
        registers(client.write_register(address, value, device_id=node))
    return words(client, node, 3, address, 1)


def coil(client, node, address, value):
    answer = client.write_coil(address, bool(value), device_id=node)
    assert not answer.isError(), answer
    return bits(client, node, 1, address, 1)


def coils(client, node, address, values):
    answer = client.write_coils(address, [bool(value) for value in values], device_id=node)
    assert not answer.isError(), answer
    return bits(client, node, 1, address, len(values))


# Call with its arguments behind `nport, node`: (what does it, what comes back)
CALLS = {
    "mbrtufcn01(19, 8)": (lambda c, n: bits(c, n, 1, 19, 8), [1, 0, 1, 1, 0, 0, 1, 1]),
    "mbrtufcn02(196, 6)": (lambda c, n: bits(c, n, 2, 196, 6), [0, 0, 1, 1, 0, 1]),
    "mbrtufcn03(107, 3)": (lambda c, n: signed(words(c, n, 3, 107, 3)), [555, 0, 100]),
    "mbrtufcn04(8, 2)": (lambda c, n: signed(words(c, n, 4, 8, 2)), [10, -1]),
    "mbrtufcn05(40, 1)": (lambda c, n: coil(c, n, 40, 1), [1]),
    "mbrtufcn06(140, 555)": (
        lambda c, n: registers(c.write_register(140, 555, device_id=n)) and words(c, n, 3, 140, 1),
        [555],
    ),
    "mbrtufcn15(50, 4, {1, 0, 1, 1})": (lambda c, n: coils(c, n, 50, [1, 0, 1, 1]), [1, 0, 1, 1]),
    "mbrtufcn16(150, 2, {-1, 300})": (lambda c, n: signed(write(c, n, 150, [0xFFFF, 300])), [-1, 300]),
    "mbrtufcn03DInt(0, 120, 1)": (lambda c, n: pairs(c, n, 3, 0, 120, DATA.INT32), -2),
    "mbrtufcn03DInt(1, 122, 1)": (lambda c, n: pairs(c, n, 3, 1, 122, DATA.INT32), -2),
    "mbrtufcn04DInt(0, 20, 1)": (lambda c, n: pairs(c, n, 4, 0, 20, DATA.INT32), -2),
    "mbrtufcn04DInt(1, 22, 1)": (lambda c, n: pairs(c, n, 4, 1, 22, DATA.INT32), -2),
    "mbrtufcn03Float(0, 124, 1)": (lambda c, n: pairs(c, n, 3, 0, 124, DATA.FLOAT32), 1.0),
    "mbrtufcn03Float(1, 126, 1)": (lambda c, n: pairs(c, n, 3, 1, 126, DATA.FLOAT32), 1.0),
    "mbrtufcn04Float(0, 24, 1)": (lambda c, n: pairs(c, n, 4, 0, 24, DATA.FLOAT32), 1.0),
    "mbrtufcn04Float(1, 26, 1)": (lambda c, n: pairs(c, n, 4, 1, 26, DATA.FLOAT32), 1.0),
    "mbrtufcn16DInt(0, 160, 1, {-2})": (lambda c, n: write_pair(c, n, 0, 160, DATA.INT32, -2), [0xFFFF, 0xFFFE]),
    "mbrtufcn16DInt(1, 162, 1, {-2})": (lambda c, n: write_pair(c, n, 1, 162, DATA.INT32, -2), [0xFFFE, 0xFFFF]),
    "mbrtufcn16Float(0, 164, 1, {1.0})": (lambda c, n: write_pair(c, n, 0, 164, DATA.FLOAT32, 1.0), [0x3F80, 0]),
    "mbrtufcn16Float(1, 166, 1, {1.0})": (lambda c, n: write_pair(c, n, 1, 166, DATA.FLOAT32, 1.0), [0, 0x3F80]),
    "mbrtuWordBitWrite(130, 0, 1)": (lambda c, n: word_bit_write(c, n, 130, 0, 1), [0x00F1]),
    "mbrtuWordBitWrite(130, 7, 0)": (lambda c, n: word_bit_write(c, n, 130, 7, 0), [0x0071]),
    "mbrtuWordBitSetReset(130, 15)": (lambda c, n: word_bit_set_reset(c, n, 130, 15), [0x0071]),
}
