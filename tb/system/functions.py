# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What each function does: limits at N-1, N, N+1, order of exceptions, lengths, broadcast, tables.

The build has tables with bases; every test takes its addresses from the model's configuration.
"""

import cocotb
from harness.bench import Bench
from protocol import frames
from protocol.defs import ALL_FUNCTIONS, BROADCAST, EX, FC, FUNCTIONS, Space

OWN = 17
READERS = (FC.READ_COILS, FC.READ_DISCRETES, FC.READ_HOLDINGS, FC.READ_INPUTS)
WRITERS = (
    FC.WRITE_COIL,
    FC.WRITE_REGISTER,
    FC.WRITE_COILS,
    FC.WRITE_REGISTERS,
    FC.MASK_WRITE,
    FC.READ_WRITE,
)


def table(tb, space):
    """(first, last) address of a table."""
    base, count = tb.slave.config.tables[space]
    return base, base + count - 1


async def fill(tb, space, address, quantity):
    """Random contents, in device and model."""
    for item in range(address, address + quantity):
        width = 1 if space in (Space.COILS, Space.DISCRETES) else 16
        await tb.preset((space, item), tb.rng.getrandbits(width))


def quantity_limit(tb, code):
    """The largest quantity of a read or write function."""
    limits = tb.slave.config.limits
    return {
        FC.READ_COILS: limits.read_bits,
        FC.READ_DISCRETES: limits.read_bits,
        FC.READ_HOLDINGS: limits.read_registers,
        FC.READ_INPUTS: limits.read_registers,
        FC.WRITE_COILS: limits.write_bits,
        FC.WRITE_REGISTERS: limits.write_registers,
    }[code]


def supported(tb, code):
    """True if this build answers `code`."""
    return tb.slave.config.supports(code)


def exception(answer):
    """The exception code of an answer, 0 if it is none."""
    return answer[2] if answer[1] & 0x80 else 0


async def ask(tb, pdu, note=""):
    """The device's answer to a unicast request, checked against the model."""
    return await tb.both(frames.adu(OWN, pdu), note=note)


@cocotb.test()
@cocotb.parametrize(code=[int(c) for c in READERS])
async def read_quantity_limits(dut, code):
    tb = await Bench.start(dut)
    if not supported(tb, code):
        assert exception(await ask(tb, frames.read(code, 0, 1))) == EX.FUNCTION
        return await tb.finish()
    space = FUNCTIONS[code].space
    first, last = table(tb, space)
    most = quantity_limit(tb, code)
    fits = min(most, last - first + 1)
    await fill(tb, space, first, fits)
    for quantity in sorted({1, 2, 7, 8, 9, fits - 1, fits}):
        if 1 <= quantity <= fits:
            assert not exception(await ask(tb, frames.read(code, first, quantity)))
    for quantity in (0, most + 1, most + 2, 0x0100 | 1, 0x7FFF, 0x8001, 0xFFFF):
        if quantity > most or not quantity:
            assert exception(await ask(tb, frames.read(code, first, quantity))) == EX.VALUE
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[int(c) for c in READERS])
async def read_bits_and_words_at_every_alignment(dut, code):
    tb = await Bench.start(dut)
    if supported(tb, code):
        space = FUNCTIONS[code].space
        first, last = table(tb, space)
        count = min(24, last - first + 1)
        await fill(tb, space, first, count)
        for _ in range(12):
            quantity = tb.rng.randint(1, count)
            address = first + tb.rng.randint(0, count - quantity)
            assert not exception(await ask(tb, frames.read(code, address, quantity)))
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[int(c) for c in READERS])
async def read_address_limits(dut, code):
    tb = await Bench.start(dut)
    if supported(tb, code):
        first, last = table(tb, FUNCTIONS[code].space)
        for address, quantity in (
            (first, 1),
            (first - 1, 1),
            (first - 1, 2),
            (last, 1),
            (last, 2),
            (last - 1, 2),
            (last - 1, 3),
            (last + 1, 1),
            (0xFFFF, 1),
            (0xFFFF, 2),
            (0xFFFF, min(125, quantity_limit(tb, code))),
            (0x8000, 1),
        ):
            if address in range(65536) and quantity <= quantity_limit(tb, code):
                answer = await ask(tb, frames.read(code, address, quantity))
                good = first <= address and address + quantity - 1 <= last
                assert exception(answer) == (0 if good else EX.ADDRESS)
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(code=[int(FC.WRITE_COILS), int(FC.WRITE_REGISTERS)])
async def write_quantity_limits(dut, code):
    tb = await Bench.start(dut)
    space = FUNCTIONS[code].space
    first, last = table(tb, space)
    most = quantity_limit(tb, code)
    fits = min(most, last - first + 1)

    def pdu(quantity, address=first):
        bits = code == FC.WRITE_COILS
        values = [tb.rng.getrandbits(1 if bits else 16) for _ in range(quantity)]
        return (frames.write_coils if bits else frames.write_registers)(address, values)

    if not supported(tb, code):
        assert exception(await ask(tb, pdu(1))) == EX.FUNCTION
        return await tb.finish()
    for quantity in sorted({1, 2, 7, 8, 9, 15, 16, 17, fits - 1, fits}):
        if 1 <= quantity <= fits:
            assert not exception(await ask(tb, pdu(quantity)))
    longest = 1968 if code == FC.WRITE_COILS else 123
    for quantity in (0, most + 1):
        if quantity <= longest:
            assert exception(await ask(tb, pdu(quantity))) == EX.VALUE
    # one more than any frame can carry: the quantity alone is out of range
    make = frames.write_coils if code == FC.WRITE_COILS else frames.write_registers
    assert exception(await ask(tb, make(first, [1] * 16, quantity=longest + 1))) == EX.VALUE
    for address, quantity in ((last, 1), (last, 2), (last + 1, 1), (first - 1, 2), (0xFFFF, 2)):
        if address in range(65536):
            good = first <= address and address + quantity - 1 <= last
            answer = await ask(tb, pdu(quantity, address))
            assert exception(answer) == (0 if good else EX.ADDRESS)
    await tb.finish()


@cocotb.test()
async def byte_count_and_length_must_agree(dut):
    tb = await Bench.start(dut)
    coil, register = table(tb, Space.COILS)[0], table(tb, Space.HOLDINGS)[0]
    for make, address, values in (
        (frames.write_coils, coil, [1] * 9),
        (frames.write_registers, register, [0xBAD, 0xBAD]),
    ):
        right = make(address, values)
        for wrong in (
            make(address, values, byte_count=right[5] - 1),
            make(address, values, byte_count=right[5] + 1),
            make(address, values, byte_count=0),
            make(address, values, quantity=len(values) - 1 if make is frames.write_registers else 8),
            make(address, values, quantity=len(values) + 1 if make is frames.write_registers else 17),
            make(address, values, quantity=0),
            make(address, values, quantity=0x0100 + len(values)),
            right + b"\0",
            right[:-1],
            right[:6],
            right[:5],
            right[:1],
        ):
            assert exception(await ask(tb, wrong)) in (EX.VALUE, EX.FUNCTION)
        await ask(tb, right)
    await tb.finish()


@cocotb.test()
async def length_is_exact_for_every_function(dut):
    """One byte missing or too many, down to the bare function code: 03, or 01 if not supported."""
    tb = await Bench.start(dut)
    register, coil = table(tb, Space.HOLDINGS)[0], table(tb, Space.COILS)[0]
    requests = [
        frames.read(FC.READ_COILS, coil, 1),
        frames.read(FC.READ_DISCRETES, table(tb, Space.DISCRETES)[0], 1),
        frames.read(FC.READ_HOLDINGS, register, 1),
        frames.read(FC.READ_INPUTS, table(tb, Space.INPUTS)[0], 1),
        frames.write_coil(coil, True),
        frames.write_register(register, 0xBAD),
        frames.mask_write(register, 0, 0xBAD),
        frames.read_write(register, 1, register, [0xBAD]),
    ]
    for right in requests:
        for wrong in (right + b"\0", right + b"\0\0", right[:-1], right[:-2], right[:2], right[:1]):
            wanted = EX.VALUE if supported(tb, right[0]) else EX.FUNCTION
            assert exception(await ask(tb, wrong)) == wanted
    await tb.finish()


@cocotb.test()
async def single_coil_takes_two_values(dut):
    tb = await Bench.start(dut)
    if supported(tb, FC.WRITE_COIL):
        first, last = table(tb, Space.COILS)
        for address in (first, last, last + 1, first - 1):
            if address not in range(65536):
                continue
            for value in (0xFF00, 0x0000, 0xFF00, 0x0001, 0x00FF, 0xFF01, 0xFFFF, 0xFE00, 0x8000):
                pdu = bytes([FC.WRITE_COIL, *address.to_bytes(2, "big"), *value.to_bytes(2, "big")])
                code = exception(await ask(tb, pdu))
                if value not in (0xFF00, 0):
                    assert code == EX.VALUE, "the value is judged before the address"
    await tb.finish()


@cocotb.test()
async def single_register_takes_every_value(dut):
    tb = await Bench.start(dut)
    first, last = table(tb, Space.HOLDINGS)
    for value in (0, 1, 0x00FF, 0xFF00, 0x7FFF, 0x8000, 0xFFFF, 0xA55A):
        for address in (first, last):
            assert not exception(await ask(tb, frames.write_register(address, value)))
    for address in (last + 1, first - 1, 0xFFFF):
        if address in range(65536) and not first <= address <= last:
            assert exception(await ask(tb, frames.write_register(address, 1))) == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def mask_write_is_and_or(dut):
    tb = await Bench.start(dut)
    if supported(tb, FC.MASK_WRITE):
        first, last = table(tb, Space.HOLDINGS)
        await tb.preset((Space.HOLDINGS, first), 0x0012)
        masks = [(0x00F2, 0x0025), (0xFFFF, 0), (0, 0xFFFF), (0xFFFF, 0xFFFF), (0, 0)]
        masks += [(tb.rng.getrandbits(16), tb.rng.getrandbits(16)) for _ in range(8)]
        for and_mask, or_mask in masks:
            assert not exception(await ask(tb, frames.mask_write(first, and_mask, or_mask)))
            await tb.compare([(Space.HOLDINGS, first)])
        if last < 0xFFFF:
            assert exception(await ask(tb, frames.mask_write(last + 1, 0, 1))) == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def read_write_writes_first_and_reads_then(dut):
    tb = await Bench.start(dut)
    if not supported(tb, FC.READ_WRITE):
        assert exception(await ask(tb, frames.read_write(0, 1, 0, [1]))) == EX.FUNCTION
        return await tb.finish()
    first, last = table(tb, Space.HOLDINGS)
    count = last - first + 1
    limits = tb.slave.config.limits
    await fill(tb, Space.HOLDINGS, first, min(count, 12))
    for read_at, write_at in ((0, 0), (0, 3), (3, 0), (2, 6)):
        if count >= 10:
            pdu = frames.read_write(first + read_at, 4, first + write_at, [0xA0, 0xB0, 0xC0])
            assert not exception(await ask(tb, pdu))
    most_read, most_write = min(limits.rw_read, count), min(limits.rw_write, count)
    for quantity in {1, most_write - 1, most_write} - {0}:
        words = [tb.rng.getrandbits(16) for _ in range(quantity)]
        assert not exception(await ask(tb, frames.read_write(first, most_read, first, words)))
    for bad in (
        frames.read_write(first, 0, first, [0xBAD]),
        frames.read_write(first, limits.rw_read + 1, first, [0xBAD]),
        frames.read_write(first, 1, first, []),
        frames.read_write(first, 1, first, [0xBAD] * 2, quantity=limits.rw_write + 1),
        frames.read_write(first, 1, first, [0xBAD] * 2, byte_count=3),
        frames.read_write(first, 1, first, [0xBAD] * 2, quantity=1),
        frames.read_write(first, 1, first, [0xBAD] * 2) + b"\0",
        frames.read_write(last + 1 & 0xFFFF, 0, first, [0xBAD]),  # 03 before 02
    ):
        assert exception(await ask(tb, bad)) == EX.VALUE
    if limits.rw_write < 121:
        words = [0xBAD] * (limits.rw_write + 1)
        assert exception(await ask(tb, frames.read_write(first, 1, first, words))) == EX.VALUE
    for bad in (
        frames.read_write(last, 2, first, [0xBAD]),  # bad read range: nothing written
        frames.read_write(first, 1, last, [0xBAD, 0xBAD]),
        frames.read_write(0xFFFF, 2, first, [0xBAD]),
        frames.read_write(first, 1, 0xFFFF, [0xBAD, 0xBAD]),
    ):
        assert exception(await ask(tb, bad)) == EX.ADDRESS
    await tb.finish()


@cocotb.test()
async def exceptions_come_in_order(dut):
    """01 before 03 before 02 before 06, each with everything behind it wrong as well."""
    tb = await Bench.start(dut, busy=1)
    for code in (*READERS, *WRITERS):
        if not supported(tb, code):
            continue
        space = FUNCTIONS[code].space
        first, last = table(tb, space)
        outside = last + 1 if last < 0xFFFF else first - 1
        good = outside not in range(65536)
        for address in (first, outside):
            if address not in range(65536):
                continue
            right = {
                FC.WRITE_COIL: frames.write_coil(address, True),
                FC.WRITE_REGISTER: frames.write_register(address, 1),
                FC.WRITE_COILS: frames.write_coils(address, [1]),
                FC.WRITE_REGISTERS: frames.write_registers(address, [1]),
                FC.MASK_WRITE: frames.mask_write(address, 0, 0),
                FC.READ_WRITE: frames.read_write(address, 1, first, [1]),
            }.get(code) or frames.read(code, address, 1)
            wanted = EX.BUSY if address == first or good else EX.ADDRESS
            assert exception(await ask(tb, right)) == wanted
            assert exception(await ask(tb, right + b"\0")) == EX.VALUE
    tb.apply(busy=0)
    assert not exception(await ask(tb, frames.read(FC.READ_HOLDINGS, table(tb, Space.HOLDINGS)[0], 1)))
    await tb.finish()


@cocotb.test()
async def unsupported_function_codes(dut):
    """Beside the implemented ones and at the ends; 80H and above come back unchanged.

    tb/differential asks for every code there is.
    """
    tb = await Bench.start(dut)
    near = {code ^ 1 << bit for code in ALL_FUNCTIONS for bit in (3, 5, 7)} | {0, 0x7F, 0xFF}
    for code in sorted(near - set(ALL_FUNCTIONS)):
        data = tb.rng.choice([b"", b"\0", b"\0\0\0\1", bytes(9)])
        answer = await ask(tb, bytes([code]) + data)
        assert answer == frames.adu(OWN, bytes([code | 0x80, EX.FUNCTION]))
    await tb.finish()


@cocotb.test()
async def left_out_functions_and_tables_answer_01(dut):
    tb = await Bench.start(dut)
    for code in sorted(ALL_FUNCTIONS):
        if not supported(tb, code):
            for pdu in (bytes([code]), frames.read(code, 0, 1), frames.read(code, 0, 0) + bytes(4)):
                assert exception(await ask(tb, pdu)) == EX.FUNCTION
    await tb.finish()


@cocotb.test()
@cocotb.parametrize(enabled=[1, 0])
async def broadcast(dut, enabled):
    """05 06 0F 10 are executed, nothing is ever answered; with broadcast off nothing happens."""
    tb = await Bench.start(dut, broadcast_en=enabled)
    register, coil = table(tb, Space.HOLDINGS)[0], table(tb, Space.COILS)[0]
    count = table(tb, Space.HOLDINGS)[1] - register + 1
    requests = [
        frames.write_coil(coil, True),
        frames.write_register(register, 0x1234),
        frames.write_coils(coil, [1, 0, 1, 1]),
        frames.write_registers(register, [0x77] * min(60, count)),
        frames.mask_write(register, 0, 0xBAD),
        frames.read_write(register, 1, register, [0xBAD]),
        frames.read(FC.READ_HOLDINGS, register, 1),
        frames.read(FC.READ_COILS, coil, 1),
        frames.write_register(register, 0xBAD) + b"\0",
        frames.write_registers(0xFFFF, [0xBAD, 0xBAD]),
        b"\x2b\x0e\x01\x00",
        b"\x07",
    ]
    for pdu in requests:
        assert await tb.both(frames.adu(BROADCAST, pdu)) is None
        await ask(tb, frames.read(FC.READ_HOLDINGS, register, 1))
    await tb.finish()


@cocotb.test()
async def busy_broadcast_is_not_executed(dut):
    tb = await Bench.start(dut, busy=1)
    register = table(tb, Space.HOLDINGS)[0]
    assert await tb.both(frames.adu(BROADCAST, frames.write_register(register, 0xBAD))) is None
    await tb.finish()


@cocotb.test()
async def write_lock_refuses_every_write(dut):
    tb = await Bench.start(dut, write_lock=1)
    register, coil = table(tb, Space.HOLDINGS)[0], table(tb, Space.COILS)[0]
    for pdu in (
        frames.write_coil(coil, True),
        frames.write_register(register, 0xBAD),
        frames.write_coils(coil, [1, 1]),
        frames.write_registers(register, [0xBAD]),
        frames.mask_write(register, 0, 0xBAD),
        frames.read_write(register, 1, register, [0xBAD]),
    ):
        if supported(tb, pdu[0]):
            assert exception(await ask(tb, pdu)) == EX.ADDRESS
            assert await tb.both(frames.adu(BROADCAST, pdu)) is None
    assert not exception(await ask(tb, frames.read(FC.READ_HOLDINGS, register, 1)))
    tb.apply(write_lock=0)
    assert not exception(await ask(tb, frames.write_register(register, 0x600D)))
    await tb.finish()


@cocotb.test()
async def read_only_range(dut):
    """A write that touches it anywhere answers 02 and changes nothing; reads are free."""
    tb = await Bench.start(dut)
    base, count = tb.slave.config.read_only
    first, last = table(tb, Space.HOLDINGS)
    if count:
        await fill(tb, Space.HOLDINGS, base, count)
        end = base + count - 1
        for address, quantity in (
            (base, 1),
            (end, 1),
            (base - 1, 1),
            (end + 1, 1),
            (base - 1, 2),
            (end, 2),
            (end + 1, 2),
            (base - 1, count + 2),
            (base - 2, 2),
        ):
            if not first <= address <= address + quantity - 1 <= last:
                continue
            wanted = EX.ADDRESS if address <= end and address + quantity > base else 0
            words = [tb.rng.getrandbits(16) for _ in range(quantity)]
            assert exception(await ask(tb, frames.write_registers(address, words))) == wanted
            if quantity == 1:
                assert exception(await ask(tb, frames.write_register(address, 0xBAD))) == wanted
                if supported(tb, FC.MASK_WRITE):
                    mask = frames.mask_write(address, 0, 0xBAD)
                    assert exception(await ask(tb, mask)) == wanted
            if supported(tb, FC.READ_WRITE):
                both = frames.read_write(base, 1, address, words)
                assert exception(await ask(tb, both)) == wanted
        # its numbers are free in the other spaces
        if supported(tb, FC.WRITE_COIL):
            coils = table(tb, Space.COILS)
            if coils[0] <= base <= coils[1]:
                assert not exception(await ask(tb, frames.write_coil(base, True)))
    await tb.finish()


@cocotb.test()
async def tables_do_not_share_memory(dut):
    """The same number in every space is a different item (unless the build overlays them)."""
    tb = await Bench.start(dut)
    for space in (Space.COILS, Space.DISCRETES, Space.INPUTS, Space.HOLDINGS):
        first, last = table(tb, space)
        if last >= first:
            for address in {first, last}:
                bit = space in (Space.COILS, Space.DISCRETES)
                await tb.preset((space, address), 1 if bit else 0x1111 * (space + 1))
    for code in READERS:
        if supported(tb, code):
            first, last = table(tb, FUNCTIONS[code].space)
            await ask(tb, frames.read(code, first, min(16, last - first + 1)))
            await ask(tb, frames.read(code, last, 1))
    await tb.finish()
