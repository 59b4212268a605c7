# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Builds without some functions: those answer exception 01, everything else works as in a full one."""

import cocotb
from harness.bench import Bench
from harness.user import User
from protocol import frames
from protocol.defs import ALL_COUNTERS, ALL_FUNCTIONS, BROADCAST, EX, FC, LOG_ADDRESS, Space, Sub

OWN, OTHER = 17, 18
LONG = bytes(257)


def requests(config):
    """{function code: a request that a slave of `config` carries out if it has the function}."""
    coil, discrete, word, register = (
        config.tables[s][0] for s in (Space.COILS, Space.DISCRETES, Space.INPUTS, Space.HOLDINGS)
    )
    return frames.requests(register, coil, discrete, word)


async def ask(tb, pdu, address=OWN):
    """The answer PDU, checked against the model; None for silence."""
    answer = await tb.both(frames.adu(address, pdu))
    return answer and answer[1:-2]


@cocotb.test()
async def each_function_is_there_or_answers_01(dut):
    tb = await Bench.start(dut, exception_status=0x5A)
    for code, pdu in requests(tb.slave.config).items():
        answer = await ask(tb, pdu)
        if tb.slave.config.supports(code):
            assert answer[0] == code, f"function {code:02X} answers {answer.hex()}"
        else:
            assert answer == bytes([code | 0x80, EX.FUNCTION])
            assert await ask(tb, pdu[:1]) == answer
            assert await ask(tb, pdu, BROADCAST) is None
    await tb.finish()


@cocotb.test()
async def what_is_counted(dut):
    """All of it as soon as one of 08, 0B and 0C is there, nothing without; the port answers either way."""
    tb = await Bench.start(dut)
    read = frames.read(FC.READ_HOLDINGS, tb.slave.config.tables[Space.HOLDINGS][0], 1)
    tb.apply(diagnostic=0x8000)
    lines = [
        frames.adu(OWN, read),
        frames.adu(OWN, b"\x63"),
        frames.adu(OTHER, read),
        frames.adu(BROADCAST, read),
        frames.bad_crc(frames.adu(OWN, read)),
        LONG,
        frames.adu(OWN, frames.diagnostics(Sub.LISTEN_ONLY)),
        frames.adu(OWN, read),
        frames.adu(OWN, frames.restart()),
        frames.adu(OWN, read),
    ]
    for line in lines:
        await tb.both(line)
        counters, log = await tb.compare_counters(frames.text(line[:8]))
    if not tb.slave.config.has_diagnostics:
        assert counters == dict.fromkeys(ALL_COUNTERS, 0) and log == []
        assert await tb.counter(LOG_ADDRESS) == 0
        assert not await tb.diagnostic_register()
    else:
        assert counters["bus_message"] > 0 and log
        assert await tb.diagnostic_register() == 0x8001
    await tb.finish()


@cocotb.test()
async def user_takes_over_what_is_left_out(dut):
    """Function codes of the user port, built in or not."""
    tb = await Bench.start(dut)
    user = User(tb, lambda pdu: pdu if len(pdu) != 3 else None)
    for code in sorted(tb.slave.config.user_codes):
        for pdu in (bytes([code]), bytes([code, 1]), bytes([code, 1, 2]), bytes([code, *range(40)])):
            user.offers.clear()
            await ask(tb, pdu)
            assert user.offers == [bytes([OWN]) + pdu]
    user.check()
    left = set(ALL_FUNCTIONS) - set(tb.slave.config.user_codes) - set(tb.slave.config.functions)
    for code in sorted(left):
        assert await ask(tb, bytes([code])) == bytes([code | 0x80, EX.FUNCTION])
    await tb.compare_counters("at the end", line=True)
    await tb.finish()
