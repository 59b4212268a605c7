# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The reference slave's counters, event log, listen-only mode and restart, rule by rule."""

import pytest
from protocol import frames
from protocol.defs import ALL_COUNTERS, ALL_FUNCTIONS, COUNTERS, DIAGNOSTIC_FUNCTIONS, EX, FC, LOG_SIZE, Space, Sub
from protocol.model import Config, Slave

OWN, OTHER, ALL = 17, 18, 0
READ = frames.read(FC.READ_HOLDINGS, 0, 1)
BAD_READ = frames.read(FC.READ_HOLDINGS, 0, 0)
WRITE = frames.write_register(0, 7)
LISTEN = frames.diagnostics(Sub.LISTEN_ONLY)
LONG = bytes(257)


@pytest.fixture
def slave():
    return Slave()


def ask(slave, pdu, address=OWN):
    """The answer PDU, None for silence."""
    answer = slave.request(frames.adu(address, pdu))
    assert answer is None or (answer[0] == OWN and frames.check(answer))
    return answer and answer[1:-2]


def code(answer):
    """Exception code of an answer, 0 if it is none."""
    return answer[1] if answer[0] & 0x80 else 0


def shown(slave):
    """(what is not 0 of the counters, log in hex), and forget both."""
    counters = {name: count for name, count in slave.counters.items() if count}
    log = bytes(slave.log).hex().upper()
    slave.counters.update(dict.fromkeys(ALL_COUNTERS, 0))
    slave.log = []
    return counters, log


def counted(**counts):
    """Counters under short names."""
    names = {
        "frames": "bus_message",
        "bad": "bus_comm_error",
        "refused": "bus_exception",
        "ours": "slave_message",
        "silent": "slave_no_response",
        "nak": "slave_nak",
        "busy": "slave_busy",
        "overrun": "bus_char_overrun",
        "events": "event_counter",
    }
    return {names[k]: v for k, v in counts.items()}


# ------------------------------------------------------------------ one frame


def test_what_each_kind_of_frame_counts_and_logs(slave):
    good = frames.adu(OWN, READ)
    for line, counters, log in (
        (good, counted(frames=1, ours=1, events=1), "4080"),
        (frames.adu(OWN, BAD_READ), counted(frames=1, ours=1, refused=1), "4180"),
        (frames.adu(OTHER, READ), counted(frames=1), ""),
        (frames.adu(248, READ), counted(frames=1), ""),
        (frames.adu(ALL, WRITE), counted(frames=1, ours=1, silent=1, events=1), "40C0"),
        (frames.adu(ALL, READ), counted(frames=1, ours=1, silent=1, refused=1), "40C0"),
        (frames.adu(ALL, frames.write_register(5000, 1)), counted(frames=1, ours=1, silent=1, refused=1), "40C0"),
        (frames.adu(ALL, b"\x63"), counted(frames=1, ours=1, silent=1, refused=1), "40C0"),
        (frames.bad_crc(good), counted(bad=1), "82"),
        (frames.bad_crc(frames.adu(OTHER, READ)), counted(bad=1), "82"),
        (frames.bad_crc(frames.adu(ALL, WRITE)), counted(bad=1), "82"),
        (frames.sealed(b"\x11"), counted(bad=1), "82"),
        ([*good[:3], (good[3], 2.0, None), *good[4:]], counted(bad=1), "82"),
        ([*good[:3], (good[3], 0, "parity"), (good[4], 2.0, "framing"), *good[5:]], counted(bad=1), "82"),
        (LONG, counted(bad=1, overrun=1), "92"),
        (frames.sealed(bytes([OWN, 8]) + bytes(253)), counted(bad=1, overrun=1), "92"),
        (frames.adu(OWN, b"\x07"), counted(frames=1, ours=1, events=1), "4080"),
        (frames.adu(OWN, b"\x0b"), counted(frames=1, ours=1), "4080"),
        (frames.adu(OWN, b"\x0c"), counted(frames=1, ours=1, events=1), "4080"),
        (frames.adu(OWN, b"\x11"), counted(frames=1, ours=1, events=1), "4080"),
        (frames.adu(OWN, LISTEN), counted(frames=1, ours=1, events=1, silent=1), "044080"),
    ):
        slave.request(line)
        assert shown(slave) == (counters, log), frames.text([c if isinstance(c, int) else c[0] for c in line])


@pytest.mark.parametrize("given", range(1, 16))
def test_each_exception_code_has_its_bit(slave, given):
    bits = {1: 1, 2: 1, 3: 1, 4: 2, 5: 4, 6: 4, 7: 8}.get(given, 0)
    more = {6: counted(busy=1), 7: counted(nak=1)}.get(given, {})
    slave.failure = given
    assert ask(slave, READ) == bytes([0x83, given])
    assert shown(slave) == (counted(frames=1, ours=1, refused=1) | more, f"{0x40 | bits:02X}80")
    ask(slave, WRITE, ALL)
    assert shown(slave) == (counted(frames=1, ours=1, refused=1, silent=1), "40C0")
    slave.failure = 0
    slave.grant = lambda *_: given
    assert ask(slave, READ) == bytes([0x83, given])
    assert shown(slave)[1] == f"{0x40 | bits:02X}80"


def test_gap_that_is_only_counted_spoils_nothing(slave):
    slave.config.gap_count_only = True
    frame = frames.adu(OWN, READ)
    assert slave.request([*frame[:4], (frame[4], 2.0, None), *frame[5:]])
    assert shown(slave) == (counted(frames=1, ours=1, events=1), "4080")


@pytest.mark.parametrize("listening", [False, True])
def test_long_frame_with_a_gap_is_ambiguous(slave, listening):
    slave.listen_only = listening
    line = [*bytes(100), (0, 2.0, None), *bytes(200)]
    mark = 0x20 * listening
    for long in (False, True, None):
        assert slave.request(line) is None and slave.ambiguous
        if long is not None:
            slave.adopt(long)
            assert not slave.ambiguous
        counters = counted(bad=1, overrun=1) if long else counted(bad=1)
        assert shown(slave) == (counters, f"{(0x92 if long else 0x82) | mark:02X}")
        assert slave.diagnostic_register == int(long is not False)
    slave.request([*bytes(257), (0, 2.0, None)])
    assert not slave.ambiguous and slave.log == [0x92 | mark]
    with pytest.raises(ValueError):
        slave.adopt(True)


# ------------------------------------------------------------------ counters and log


@pytest.mark.parametrize("name", COUNTERS)
def test_counter_is_read_and_wraps(slave, name):
    slave.counters[name] = 0xFFFE
    line = {
        "bus_message": frames.adu(OTHER, READ),
        "bus_comm_error": b"\0\0\0\0",
        "bus_exception": frames.adu(OWN, b"\x63"),
        "slave_message": frames.adu(OWN, READ),
        "slave_no_response": frames.adu(ALL, WRITE),
        "slave_nak": frames.adu(OWN, READ),
        "slave_busy": frames.adu(OWN, READ),
        "bus_char_overrun": LONG,
    }[name]
    slave.failure = {"slave_nak": EX.NAK, "slave_busy": EX.BUSY}.get(name, 0)
    seen = []
    for _ in range(2):
        slave.request(line)
        seen.append(slave.counters[name])
    assert seen == [0xFFFF, 0]
    asked = ask(slave, frames.diagnostics(COUNTERS[name]))
    itself = name in ("bus_message", "slave_message")
    assert asked == bytes([8, 0, COUNTERS[name], 0, int(itself)])


def test_event_counter_wraps(slave):
    slave.counters["event_counter"] = 0xFFFF
    assert ask(slave, b"\x0b") == bytes.fromhex("0B 0000 FFFF")
    ask(slave, READ)
    assert ask(slave, b"\x0b") == bytes.fromhex("0B 0000 0000")
    ask(slave, READ)
    assert ask(slave, b"\x0c")[:8] == bytes.fromhex("0C 0F 0000 0001 0005")


def test_log_holds_64_events_newest_first(slave):
    for _ in range(20):
        ask(slave, READ)
        ask(slave, BAD_READ)
    assert len(slave.log) == LOG_SIZE
    answer = ask(slave, b"\x0c")
    assert answer[1] == 6 + LOG_SIZE and len(answer) == 8 + LOG_SIZE
    assert answer[8:13] == bytes.fromhex("80 41 80 40 80")
    slave.log = range(63)
    assert ask(slave, b"\x0c")[1] == 6 + 64
    slave.log = range(62)
    assert ask(slave, b"\x0c")[1] == 6 + 63


def test_log_of_a_fresh_slave_begins_with_the_request(slave):
    assert ask(slave, b"\x0c") == bytes.fromhex("0C 07 0000 0000 0001 80")


def test_status_word_tells_busy(slave):
    slave.busy = True
    assert ask(slave, b"\x0b")[1:3] == b"\xff\xff"
    assert ask(slave, b"\x0c")[2:4] == b"\xff\xff"


# ------------------------------------------------------------------ diagnostics


def test_data_of_each_sub_function(slave):
    """One word, and only the right one; unknown sub-functions before everything else."""
    for sub in (s for s in Sub if s != Sub.QUERY_DATA):
        for wrong in (b"", b"\0", b"\0\0\0", b"\0\0\0\0", b"\0\1", b"\1\1", b"\xff\1"):
            assert code(ask(slave, frames.diagnostics(sub, wrong))) == EX.VALUE, (sub, wrong)
        assert not slave.listen_only
    for sub in (Sub.RESTART, Sub.DIAGNOSTIC_REGISTER, Sub.LISTEN_ONLY, Sub.CLEAR, Sub.CLEAR_OVERRUN):
        assert code(ask(slave, frames.diagnostics(sub, 0x8000))) == EX.VALUE
    assert code(ask(slave, frames.diagnostics(Sub.CLEAR, 0xFF00))) == EX.VALUE
    for sub in (*range(5, 10), 0x13, *range(0x15, 0x30), 0x100, 0x10A, 0xFFFF):
        for data in (b"", b"\0\0", b"\0\3", bytes(7)):
            assert code(ask(slave, frames.diagnostics(sub, data))) == EX.FUNCTION
    for short in (b"\x08", b"\x08\0"):
        assert code(ask(slave, short)) == EX.VALUE


@pytest.mark.parametrize("size", range(0, 251))
def test_query_data_comes_back_in_whole_words(slave, size):
    pdu = frames.diagnostics(Sub.QUERY_DATA, bytes(range(size)))
    answer = ask(slave, pdu)
    assert answer == (pdu if size and size % 2 == 0 else b"\x88\3")


def test_delimiter_is_kept_until_a_restart(slave):
    pdu = frames.diagnostics(Sub.DELIMITER, 0x4100)
    assert ask(slave, pdu) == pdu and slave.ascii_delimiter == 0x41
    ask(slave, frames.restart())
    assert slave.ascii_delimiter == 0x0A


def test_clear_is_the_last_action_of_its_message(slave):
    for line in (frames.adu(OTHER, READ), LONG, frames.adu(OWN, READ)):
        slave.request(line)
    slave.diagnostic_bits, slave.diagnostic_bits = 0x4001, 0
    assert slave.diagnostic_register == 0x4001, "bit 0 is the overrun flag alone"
    pdu = frames.diagnostics(Sub.CLEAR)
    assert ask(slave, pdu) == pdu
    assert not any(slave.counters.values()) and slave.diagnostic_register == 0
    assert slave.log == [0x40, 0x80, 0x40, 0x80, 0x92]
    assert ask(slave, frames.diagnostics(Sub.BUS_MESSAGE))[-1] == 1
    assert ask(slave, b"\x0b")[-1] == 1


def test_clear_overrun_takes_counter_and_flag_only(slave):
    slave.diagnostic_bits = 0x8000
    slave.request(LONG)
    pdu = frames.diagnostics(Sub.CLEAR_OVERRUN)
    assert ask(slave, pdu) == pdu
    assert slave.diagnostic_register == 0x8000
    assert shown(slave)[0] == counted(bad=1, frames=1, ours=1, events=1)


def test_host_bits_stick(slave):
    slave.diagnostic_bits = 0x0003
    assert slave.diagnostic_register == 0x0002
    slave.diagnostic_bits = 0x8000
    assert ask(slave, frames.diagnostics(Sub.DIAGNOSTIC_REGISTER))[3:] == b"\x80\x02"
    ask(slave, frames.diagnostics(Sub.CLEAR))
    assert slave.diagnostic_register == 0x8000, "a bit that still stands is set again"
    slave.diagnostic_bits = 0
    ask(slave, frames.restart(True))
    assert slave.diagnostic_register == 0x8000, "a restart keeps the register"
    slave.reset()
    assert slave.diagnostic_register == 0


def test_without_diagnostics_nothing_is_kept():
    slave = Slave(Config(functions=ALL_FUNCTIONS - DIAGNOSTIC_FUNCTIONS))
    slave.diagnostic_bits = 0x8000
    for line in (LONG, frames.adu(OWN, READ), frames.adu(OWN, LISTEN), frames.adu(ALL, WRITE)):
        slave.request(line)
    assert shown(slave) == ({}, "") and not slave.listen_only and not slave.diagnostic_register
    assert code(ask(slave, LISTEN)) == EX.FUNCTION


# ------------------------------------------------------------------ restart and listen-only


@pytest.mark.parametrize("clear", [False, True])
def test_restart(slave, clear):
    slave.request(LONG)
    ask(slave, WRITE)
    pdu = frames.restart(clear)
    assert ask(slave, pdu) == pdu
    assert shown(slave) == ({}, "00" if clear else "004080408092")
    assert slave.diagnostic_register == 1 and slave.memory[Space.HOLDINGS, 0] == 7
    assert ask(slave, b"\x0c") == bytes.fromhex("0C 07 0000 0000 0001 80")


@pytest.mark.parametrize("clear", [False, True])
def test_restart_out_of_listen_only(slave, clear):
    assert ask(slave, LISTEN) is None and slave.listen_only
    assert ask(slave, frames.restart(clear)) is None
    assert not slave.listen_only
    assert shown(slave) == ({}, "00" if clear else "0060A0044080")
    assert ask(slave, READ) == bytes([3, 2, 0, 0])
    assert shown(slave) == (counted(frames=1, ours=1, events=1), "4080")


def test_listen_only_hears_and_does_nothing(slave):
    ask(slave, LISTEN)
    shown(slave)
    own, everyone = counted(frames=1, ours=1, silent=1), counted(frames=1, ours=1, silent=1)
    for line, counters, log in (
        (frames.adu(OWN, READ), own, "60A0"),
        (frames.adu(OWN, WRITE), own, "60A0"),
        (frames.adu(OWN, BAD_READ), own, "60A0"),
        (frames.adu(OWN, b"\x63"), own, "60A0"),
        (frames.adu(OWN, b"\x0b"), own, "60A0"),
        (frames.adu(OWN, LISTEN), own, "60A0"),
        (frames.adu(OWN, frames.diagnostics(Sub.CLEAR)), own, "60A0"),
        (frames.adu(OWN, frames.diagnostics(Sub.RESTART, 1)), own, "60A0"),
        (frames.adu(OWN, frames.diagnostics(Sub.RESTART, 0xFF)), own, "60A0"),
        (frames.adu(OWN, frames.restart() + b"\0"), own, "60A0"),
        (frames.adu(OWN, frames.restart()[:-1]), own, "60A0"),
        (frames.adu(ALL, WRITE), everyone, "60E0"),
        (frames.adu(ALL, frames.restart()), everyone, "60E0"),
        (frames.adu(ALL, READ), everyone, "60E0"),
        (frames.adu(OTHER, frames.restart()), counted(frames=1), ""),
        (frames.bad_crc(frames.adu(OWN, frames.restart())), counted(bad=1), "A2"),
        (frames.sealed(b"\x11"), counted(bad=1), "A2"),
        (LONG, counted(bad=1, overrun=1), "B2"),
    ):
        assert slave.request(line) is None
        assert slave.listen_only and not slave.written
        assert shown(slave) == (counters, log), frames.text(line)
    assert slave.memory[Space.HOLDINGS, 0] == 0 and slave.diagnostic_register == 1
    slave.reset()
    assert not slave.listen_only and shown(slave) == ({}, "") and slave.diagnostic_register == 0


def test_listen_only_does_not_ask_the_user():
    slave = Slave(Config(user_codes=frozenset({65, FC.DIAGNOSTICS})))
    ask(slave, LISTEN)
    slave.user = lambda pdu: pytest.fail("asked")
    ask(slave, b"\x41")
    ask(slave, frames.restart())
    assert not slave.listen_only


def test_broadcast_switched_off_is_foreign():
    slave = Slave(Config(broadcast=False))
    ask(slave, WRITE, ALL)
    assert shown(slave) == (counted(frames=1), "") and slave.memory[Space.HOLDINGS, 0] == 0


@pytest.mark.parametrize("address", [0, 248, 255])
def test_illegal_own_address_hears_broadcasts_only(address):
    slave = Slave(Config(address=address))
    assert slave.request(frames.adu(address or 1, READ)) is None
    assert shown(slave) == (counted(frames=1), "")
    slave.request(frames.adu(ALL, WRITE))
    assert slave.memory[Space.HOLDINGS, 0] == 7
