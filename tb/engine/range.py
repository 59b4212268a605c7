# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The range: fields, limits and last address to the item, byte counts, files."""

import cocotb
from harness.bench import PARAMETERS
from harness.steps import NUMBERS, argument, do
from harness.unit import clocks, settle, start
from protocol.defs import Space

ROOM = 2048  # a limit is given as ROOM - limit
LIMITS = (1, 31, 125, 1968, 2000)
LONGEST_ANSWER = 0xF5  # bytes of a file answer
LAST_RECORD = 0x270F


async def give(dut, commands, value=None):
    """Commands, in one clock; with a field in two, its high byte in the first, the low one in the second."""
    *field, last = [None] if value is None else [value >> 8, value & 0xFF]
    for byte in field:
        dut.byte_i.value, dut.do_i.value = byte, do(*(c for c in commands.split() if c != "LESS_ONE"))
        await clocks(dut)
    dut.byte_i.value, dut.do_i.value = last or 0, do(*commands.split())
    await clocks(dut)
    dut.do_i.value = 0
    await settle()


async def range_of(dut, first, quantity, space=Space.HOLDINGS):
    """First address and quantity as fields; three clocks later all is known."""
    dut.space_i.value = space
    await give(dut, "ADDRESS", first)
    await give(dut, "QUANTITY LESS_ONE", quantity)
    await clocks(dut, 3)
    await settle()


def found(dut, name):
    return int(dut.found_o[NUMBERS[f"FOUND_{name}"]].value)


@cocotb.test()
@cocotb.parametrize(most=LIMITS)
async def limits_are_exact(dut, most):
    await start(dut)
    dut.argument_i.value = argument(ROOM=ROOM - most)
    for quantity in {0, 1, most - 1, most, most + 1, 2047, 2048, 2049, 4096 + most, 0x8000 + most, 0xFFFF}:
        await range_of(dut, 5, quantity)
        expected = 1 <= quantity <= most
        assert found(dut, "IN_LIMIT") == expected, f"quantity {quantity}, limit {most}: expected {expected}"


@cocotb.test()
async def last_address_is_exact_and_never_wraps(dut):
    random = await start(dut)
    cases = [(0, 1), (0, 2000), (63536, 2000), (63537, 2000), (65535, 1), (65535, 2), (65534, 2), (65411, 125)]
    cases += [(65412, 125), (65535, 2047), (63489, 2047), (63490, 2047)]
    cases += [(random.randrange(65536), random.randrange(1, 2001)) for _ in range(200)]
    for first, quantity in cases:
        await range_of(dut, first, quantity)
        last = first + quantity - 1
        assert int(dut.first_o.value) == first
        assert int(dut.last_o.value) == last & 0xFFFF, f"{first} + {quantity}: last {int(dut.last_o.value)}"
        assert int(dut.past_end_o.value) == (last > 65535), f"{first} + {quantity}: past the end is wrong"


@cocotb.test()
async def quantity_comes_in_four_ways(dut):
    await start(dut)
    for commands, literal, expected in (
        ("ADDRESS ONE", 0, (0x1234, 0x1234)),
        ("QUANTITY", 0, (0x1234, 0x1234 + 3)),
        ("FIRST", 0x0A, (0x0A, 0x0A)),
        ("LESS", 0x05, (0x0A, 0x0F)),
    ):
        dut.argument_i.value = argument(LITERAL=literal)
        await give(dut, commands, {"ADDRESS ONE": 0x1234, "QUANTITY": 3}.get(commands))
        await clocks(dut, 2)
        await settle()
        seen = int(dut.first_o.value), int(dut.last_o.value)
        assert seen == expected, f"{commands}: expected {expected}, seen {seen}"


@cocotb.test()
async def a_burst_moves_the_first_address_alone(dut):
    await start(dut)
    await range_of(dut, 0xFFF0, 5)
    dut.moving_i.value = 1
    for item in range(5):
        assert int(dut.first_o.value) == 0xFFF0 + item and int(dut.last_o.value) == 0xFFF4
        assert int(dut.at_last_o.value) == (item == 4)
        dut.next_i.value = 1
        await clocks(dut)
        dut.next_i.value = 0
        await settle()
        await clocks(dut, item)
        await settle()
    assert int(dut.last_o.value) == 0xFFF4 and not int(dut.past_end_o.value)


@cocotb.test(skip=int(PARAMETERS.get("BITS_PER_BEAT", 1)) == 1)
@cocotb.parametrize(space=[Space.COILS, Space.DISCRETES])
async def a_beat_of_bits_ends_with_its_word(dut, space):
    random = await start(dut)
    cases = [(0, 1), (15, 1), (15, 2), (0xFFFF, 1), (0xFFF0, 16), (0xFFEF, 17), (100, 2000)]
    for first, quantity in cases + [(random.randrange(63000), random.randrange(1, 200)) for _ in range(20)]:
        dut.moving_i.value = 0
        await range_of(dut, first, quantity, space)
        dut.moving_i.value = 1
        last = first + quantity - 1
        for at in [first, *range((first | 15) + 1, last + 1, 16)]:
            assert int(dut.first_o.value) == at and int(dut.last_o.value) == last
            assert int(dut.at_last_o.value) == (at | 15 >= last), f"{first} + {quantity}: at {at}"
            dut.next_i.value = 1
            await clocks(dut)
            dut.next_i.value = 0
            await settle()
    dut.moving_i.value = 0


@cocotb.test()
@cocotb.parametrize(space=[Space.COILS, Space.DISCRETES, Space.INPUTS, Space.HOLDINGS])
async def byte_count_of_the_quantity(dut, space):
    """count is one less than the byte count: the first data byte has gone."""
    await start(dut)
    for quantity in (1, 7, 8, 9, 16, 17, 100, 121, 123):
        bits = space in (Space.COILS, Space.DISCRETES)
        byte_count = (quantity + 7) // 8 if bits else 2 * quantity
        for other in (-2, -1, 0, 1):
            dut.count_i.value = (byte_count + other - 1) & 0x1FF
            await range_of(dut, 0, quantity, space)
            assert found(dut, "FIT") == (other == 0), f"{quantity} items, byte count {byte_count + other}"


@cocotb.test()
async def records_end_at_270f(dut):
    await start(dut)
    for first, quantity in (
        (8000, 2000), (8001, 2000), (LAST_RECORD, 1), (LAST_RECORD, 2), (LAST_RECORD + 1, 1), (9000, 999), (9000, 1001),
        (0x4000, 1), (0x8000, 1), (0xFFFF, 1), (0xFFFF, 2),
    ):  # fmt: skip
        last = first + quantity - 1
        await range_of(dut, first, quantity, Space.FILES)
        assert int(dut.past_end_o.value) == (last > LAST_RECORD), f"record {first} + {quantity}"
        await range_of(dut, first, quantity, Space.HOLDINGS)
        assert int(dut.past_end_o.value) == (last > 65535), f"register {first} + {quantity}"


@cocotb.test()
async def file_number_is_kept(dut):
    await start(dut)
    await give(dut, "FILE", 0xBEEF)
    await range_of(dut, 7, 3, Space.FILES)
    assert int(dut.file_o.value) == 0xBEEF


@cocotb.test()
async def file_answers_end_at_f5(dut):
    random = await start(dut)
    cases = [[121], [121, 1], [120], [60, 60], [60, 61], [1] * 61, [1] * 62]
    cases += [[random.randrange(1, 40) for _ in range(random.randrange(1, 9))] for _ in range(30)]
    for groups in cases:
        await give(dut, "NO_GROUP")
        total = 0
        for quantity in groups:
            await give(dut, "QUANTITY LESS_ONE", quantity)
            assert int(dut.length_o.value) == 1 + 2 * quantity
            if total <= LONGEST_ANSWER:
                await give(dut, "GROUP")
                total += 2 + 2 * quantity
                await clocks(dut)
                await settle()
                expected = total > LONGEST_ANSWER
                assert found(dut, "TOO_LONG") == expected, f"{groups}: {total} bytes"
