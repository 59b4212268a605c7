# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The reference slave's functions that the printed examples do not exhaust: identity, files, queue, user."""

import pytest
from protocol import frames
from protocol.defs import ALL_FUNCTIONS, CONFORMITIES, EX, FC, FUNCTIONS, LONGEST_PDU, Space
from protocol.model import Config, Slave

OWN, ALL = 17, 0


def ask(slave, pdu, address=OWN):
    """The answer PDU, None for silence."""
    assert len(pdu) <= LONGEST_PDU
    answer = slave.request(frames.adu(address, pdu))
    return answer and answer[1:-2]


def code(answer):
    """Exception code of an answer, 0 if it is none."""
    return answer[1] if answer[0] & 0x80 else 0


# ------------------------------------------------------------------ every function


@pytest.mark.parametrize("function", sorted(ALL_FUNCTIONS))
def test_order_of_exceptions(function):
    """01, 03, 02, 06, then the host's code; functions that touch no data know neither 02 nor 06."""
    touches = FUNCTIONS[function].space is not None
    good, outside = frames.requests()[function], frames.requests(65535, 65535, file=5)[function]
    slave = Slave()
    slave.busy, slave.failure = True, EX.PARITY
    odd = good + (b"\0" if function != FC.DIAGNOSTICS else b"\0\0\0")
    assert code(ask(slave, odd)) == EX.VALUE
    assert code(ask(slave, outside)) == (EX.ADDRESS if touches else 0)
    assert code(ask(slave, good)) == (EX.BUSY if touches else 0)
    slave.busy = False
    assert code(ask(slave, good)) == (EX.PARITY if touches else 0)
    assert not slave.written and not any(slave.memory[key] for key in [(Space.COILS, 0), (Space.HOLDINGS, 0)])
    slave.failure = 0
    assert not code(ask(slave, good))
    slave.config.functions = ALL_FUNCTIONS - {function}
    assert ask(slave, good) == bytes([function | 0x80, EX.FUNCTION])


@pytest.mark.parametrize("function", sorted(ALL_FUNCTIONS))
def test_broadcast_is_for_four_functions(function):
    slave = Slave()
    assert ask(slave, frames.requests()[function], ALL) is None
    assert bool(slave.written) == FUNCTIONS[function].broadcast == (slave.counters["bus_exception"] == 0)


@pytest.mark.parametrize("function", sorted(set(range(256)) - ALL_FUNCTIONS))
def test_other_codes_answer_01(function):
    slave = Slave()
    for data in (b"", b"\0", bytes(4)):
        assert ask(slave, bytes([function]) + data) == bytes([function | 0x80, EX.FUNCTION])


def test_functions_without_their_table_answer_01():
    slave = Slave(Config(tables=dict.fromkeys(Config().tables, (0, 0)), files=(0, 256)))
    for function, pdu in frames.requests().items():
        assert code(ask(slave, pdu)) == (EX.FUNCTION if FUNCTIONS[function].space is not None else 0)


# ------------------------------------------------------------------ identity


def test_server_id_run_indicator_and_data():
    slave = Slave(Config(server_id=b"AB", additional_data=bytes(234)))
    slave.run_indicator = False
    assert ask(slave, b"\x11") == b"\x11" + bytes([237]) + b"AB\0" + bytes(234)
    slave.exception_status = 0x5A
    assert ask(slave, b"\x07") == b"\x07\x5a"


OBJECTS = {0: b"maker", 1: b"thing", 2: b"V1", 3: b"url", 5: b"model", 0x80: b"p80", 0x90: b"p90", 0xFF: b"pFF"}


def identity(slave, read_code, first):
    """(conformity, more, next, {id: value}) or the exception code."""
    answer = ask(slave, frames.device_identification(read_code, first))
    if code(answer):
        return code(answer)
    assert answer[:3] == bytes([0x2B, 0x0E, read_code]) and len(answer) <= slave.config.device_id_limit
    found, place = {}, 7
    while place < len(answer):
        number, size = answer[place : place + 2]
        found[number] = answer[place + 2 : place + 2 + size]
        place += 2 + size
    assert len(found) == answer[6] and list(found) == sorted(found)
    return answer[3], answer[4], answer[5], found


@pytest.mark.parametrize("conformity", CONFORMITIES)
@pytest.mark.parametrize("read_code", [1, 2, 3])
def test_stream_of_each_level(conformity, read_code):
    slave = Slave(Config(objects=OBJECTS, conformity=conformity))
    last = {1: 2, 2: 6, 3: 255}[min(read_code, conformity & 0x7F)]
    category = [i for i in OBJECTS if i <= last]
    for first in range(256):
        wanted = [i for i in category if i >= first] if first in category else category
        assert identity(slave, read_code, first) == (conformity, 0, 0, {i: OBJECTS[i] for i in wanted})


@pytest.mark.parametrize("conformity", CONFORMITIES)
def test_individual_access(conformity):
    slave = Slave(Config(objects=OBJECTS, conformity=conformity))
    for wanted in range(256):
        seen = identity(slave, 4, wanted)
        if not conformity & 0x80:
            assert seen == EX.VALUE
        elif wanted not in OBJECTS:
            assert seen == EX.ADDRESS
        else:
            assert seen == (conformity, 0, 0, {wanted: OBJECTS[wanted]})


def test_identification_is_judged_in_order():
    slave = Slave(Config(conformity=0x81))
    assert code(ask(slave, b"\x2b")) == EX.VALUE
    for mei in (0, 0x0D, 0x0F, 0xFF):
        for rest in (b"", b"\1", b"\1\0", b"\1\0\0"):
            assert code(ask(slave, bytes([0x2B, mei]) + rest)) == EX.FUNCTION
    for rest in (b"", b"\1", b"\1\0\0", b"\4\7\0"):
        assert code(ask(slave, b"\x2b\x0e" + rest)) == EX.VALUE
    for read_code in (0, 5, 0x81, 0xFF):
        assert code(ask(slave, frames.device_identification(read_code, 7))) == EX.VALUE
    assert code(ask(slave, frames.device_identification(4, 7))) == EX.ADDRESS


@pytest.mark.parametrize("over", [-1, 0, 1])
@pytest.mark.parametrize("limit", [253, 64])
def test_objects_end_around_the_limit(limit, over):
    """Three objects that together are one below, exactly at and one above what an answer holds."""
    room = limit - 7 - 3 * 2 + over
    objects = {0: b"a" * 20, 1: b"b" * 10, 2: b"c" * (room - 30)}
    slave = Slave(Config(objects=objects, device_id_limit=limit))
    seen = identity(slave, 1, 0)
    if over > 0:
        assert seen == (0x81, 0xFF, 2, {0: objects[0], 1: objects[1]})
        assert identity(slave, 1, 2) == (0x81, 0, 0, {2: objects[2]})
    else:
        assert seen == (0x81, 0, 0, objects)
        assert len(ask(slave, frames.device_identification(1))) == limit + over


def test_longest_objects_come_one_by_one():
    objects = {i: bytes([i]) * 244 for i in (0, 1, 2, 3, 0x80, 0xFF)}
    slave = Slave(Config(objects=objects, conformity=0x83))
    seen, first = {}, 0
    for turn in range(len(objects)):
        _, more, following, part = identity(slave, 3, first)
        seen |= part
        assert list(part) == [first] and more == (0 if turn == len(objects) - 1 else 0xFF)
        first = following
    assert seen == objects


# ------------------------------------------------------------------ files


@pytest.fixture
def filed():
    slave = Slave()
    for file in range(1, 5):
        for record in range(256):
            slave.memory[Space.FILES, slave.config.record_item(file, record)] = file << 8 | record
    return slave


def test_files_read_in_the_order_of_the_request(filed):
    answer = ask(filed, frames.read_files((4, 254, 2), (1, 0, 1), (4, 255, 1)))
    assert answer == bytes.fromhex("14 0E 05 06 04FE 04FF 03 06 0100 03 06 04FF")


def test_files_written_in_the_order_of_the_request(filed):
    pdu = frames.write_files((1, 0, [1, 2, 3]), (1, 1, [9]), (4, 255, [7]))
    assert ask(filed, pdu) == pdu
    assert filed.written == [(Space.FILES, 0, 2, 1), (Space.FILES, 1, 1, 1), (Space.FILES, 255, 255, 4)]
    assert filed.touched == {(Space.FILES, i) for i in (0, 1, 2, 1023)}
    assert ask(filed, frames.read_files((1, 0, 4))) == bytes.fromhex("14 0A 09 06 0001 0009 0003 0103")


@pytest.mark.parametrize(
    "wanted,groups",
    [
        (0, [(1, 0, 121)]),  # 244 bytes
        (EX.VALUE, [(1, 0, 122)]),
        (0, [(1, 0, 100), (2, 0, 20)]),
        (EX.VALUE, [(1, 0, 100), (2, 0, 21)]),
        (0, [(1, i, 1) for i in range(35)]),  # 245 bytes of groups
        (EX.VALUE, []),
        (EX.VALUE, [(1, 0, 0)]),
        (EX.VALUE, [(9, 0, 1), (1, 0, 0)]),  # 03 before 02
        (EX.VALUE, [(1, 0, 0x7FFF), (1, 0, 0x7FFF)]),
        (EX.ADDRESS, [(1, 255, 2)]),
        (EX.ADDRESS, [(1, 256, 1)]),
        (EX.ADDRESS, [(1, 0xFFFF, 1)]),
        (EX.ADDRESS, [(0, 0, 1)]),
        (EX.ADDRESS, [(5, 0, 1)]),
        (EX.ADDRESS, [(0xFFFF, 0, 1)]),
        (EX.ADDRESS, [(1, 0, 1, 5)]),
        (EX.ADDRESS, [(1, 0, 1), (1, 0, 1, 7)]),
    ],
)
def test_read_file_checks(filed, wanted, groups):
    assert code(ask(filed, frames.read_files(*groups))) == wanted


def test_read_file_byte_count(filed):
    right = frames.read_files((1, 0, 1), (2, 0, 1))
    for wrong in (right + b"\0", right[:-1], right[:2], right[:1], b"\x14\x0d" + right[2:], b"\x14\x07" + right[2:]):
        assert code(ask(filed, wrong)) == EX.VALUE
    assert code(ask(filed, b"\x14\x0d" + right[2:-1])) == EX.VALUE  # agrees, but no multiple of 7
    many = frames.read_files(*[(1, i, 1) for i in range(36)])
    assert code(ask(filed, many[:LONGEST_PDU])) == EX.VALUE  # no frame carries 36 groups


@pytest.mark.parametrize(
    "wanted,groups",
    [
        (0, [(1, 0, [1])]),  # byte count 9
        (0, [(1, 0, [5] * 122)]),  # byte count FB
        (0, [(1, 0, [5] * 100), (2, 0, [6] * 18)]),
        (EX.VALUE, [(1, 0, [])]),
        (EX.VALUE, [(1, 0, [1]), (1, 0, [])]),
        (EX.VALUE, [(1, 0, [1, 2], 1)]),  # a word left over
        (EX.VALUE, [(1, 0, [1, 2], 3)]),
        (EX.VALUE, [(1, 0, [1, 2], 0x8002)]),
        (EX.VALUE, [(1, 0, [1, 2], 0xFFFF)]),
        (EX.VALUE, [(9, 0, [1]), (1, 0, [1], 2)]),
        (EX.ADDRESS, [(1, 0, [1]), (1, 255, [1, 2])]),
        (EX.ADDRESS, [(1, 0, [1]), (5, 0, [1])]),
        (EX.ADDRESS, [(1, 0, [1]), (0, 0, [1])]),
        (EX.ADDRESS, [(1, 0, [1]), (2, 0, [1], None, 0)]),
    ],
)
def test_write_file_checks(filed, wanted, groups):
    """Nothing is written before every group is right."""
    assert code(ask(filed, frames.write_files(*groups))) == wanted
    assert bool(filed.written) == (not wanted)
    assert filed.memory[Space.FILES, 0] == (groups[0][2][0] if not wanted else 0x0100)


def test_bank_is_asked_for_every_group_first(filed):
    asked = []
    filed.grant = lambda *question: asked.append(question) or (EX.PARITY if question[4] == 3 else 0)
    assert code(ask(filed, frames.write_files((1, 5, [1, 2]), (2, 0, [1]), (3, 0, [1]), (9, 0, [1])))) == EX.PARITY
    assert asked == [(Space.FILES, 5, 6, True, 1), (Space.FILES, 0, 0, True, 2), (Space.FILES, 0, 0, True, 3)]
    assert not filed.written
    filed.grant, filed.write_lock = None, True
    assert code(ask(filed, frames.write_files((1, 0, [1])))) == EX.ADDRESS
    assert not code(ask(filed, frames.read_files((1, 0, 1))))


def test_files_of_ten_thousand_records():
    slave = Slave(Config(files=(2, 10000)))
    assert not code(ask(slave, frames.write_files((2, 9999, [0x77]))))
    assert ask(slave, frames.read_files((2, 9999, 1))) == bytes.fromhex("14 04 03 06 0077")
    assert slave.memory[Space.FILES, 19999] == 0x77
    assert code(ask(slave, frames.read_files((2, 9999, 2)))) == EX.ADDRESS


# ------------------------------------------------------------------ queue


@pytest.mark.parametrize(
    "wanted,pointer,count",
    [
        (0, 0, 0),
        (0, 0, 1),
        (0, 0, 31),
        (EX.VALUE, 0, 32),
        (EX.VALUE, 0, 0xFFFF),
        (0, 2047, 0),
        (EX.ADDRESS, 2047, 1),
        (EX.VALUE, 2047, 32),  # the count before the tail
        (0, 2016, 31),
        (EX.ADDRESS, 2017, 31),
        (EX.ADDRESS, 2048, None),
        (EX.ADDRESS, 0xFFFF, None),
    ],
)
def test_queue(wanted, pointer, count):
    slave = Slave()
    if count is not None:
        slave.memory[Space.HOLDINGS, pointer] = count
    answer = ask(slave, frames.read_fifo(pointer))
    assert code(answer) == wanted
    if not wanted:
        assert answer == bytes([0x18]) + frames.pack_words([2 + 2 * count, count]) + bytes(2 * count)
        slave.busy = True
        assert code(ask(slave, frames.read_fifo(pointer))) == EX.BUSY


def test_queue_asks_twice():
    slave, asked = Slave(), []
    slave.memory[Space.HOLDINGS, 5] = 3
    slave.grant = lambda *question: asked.append(question) or 0
    ask(slave, frames.read_fifo(5))
    assert asked == [(Space.HOLDINGS, 5, 5, False), (Space.HOLDINGS, 5, 8, False)]


# ------------------------------------------------------------------ the user's functions


def test_user_answers_refuses_or_passes():
    slave = Slave(Config(user_codes=frozenset({110, FC.READ_HOLDINGS, FC.WRITE_REGISTER})))
    assert code(ask(slave, b"\x6e")) == EX.FUNCTION
    said = {b"\x6e": b"\x6eok", b"\x6e\1": EX.NAK, b"\x6e\2": b"\x6e" + bytes(252), b"\x6e\3": b"\x6e" + bytes(253)}
    slave.user = said.get
    slave.reset()
    assert ask(slave, b"\x6e") == b"\x6eok"
    assert slave.counters["event_counter"] == 1
    assert ask(slave, b"\x6e\1") == b"\xee\7" and slave.counters["slave_nak"] == 1
    assert len(ask(slave, b"\x6e\2")) == LONGEST_PDU
    assert ask(slave, b"\x6e\3") == b"\xee\4"
    assert ask(slave, b"\x6e\4") == b"\xee\1"
    assert ask(slave, frames.read(3, 0, 1)) == bytes([3, 2, 0, 0])
    slave.user = lambda pdu: pytest.fail("broadcasts are not offered")
    ask(slave, frames.write_register(0, 9), ALL)
    assert slave.memory[Space.HOLDINGS, 0] == 9
    slave.user, slave.busy = said.get, True
    assert ask(slave, b"\x6e") == b"\x6eok", "busy is about data"
