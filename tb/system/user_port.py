# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The user port: what is offered, what may come back, and what a bad user cannot do."""

import cocotb
from harness.bench import CLOCK_PS, PROCESSING_CLOCKS, Bench
from harness.lines import with_error
from harness.user import User
from protocol import frames
from protocol.defs import BROADCAST, EX, EXCEPTION_FLAG, FC, LONGEST_PDU, Space, Sub

OWN, OTHER = 17, 18
MINE = 65  # a function code that is only the user's
READ = frames.read(FC.READ_HOLDINGS, 0, 2)
STALL_BITS = 60


def echo(pdu):
    """An answer with the data of the request."""
    return bytes(pdu)


async def start(dut, respond=echo, **setup):
    """(bench, user)."""
    tb = await Bench.start(dut, **setup)
    return tb, User(tb, respond)


async def ask(tb, user, pdu, offered=True, **how):
    """The answer PDU, checked against the model; the user must have been offered just this, or nothing."""
    user.offers.clear()
    answer = await tb.both(frames.adu(OWN, pdu), **how)
    assert user.offers == ([bytes([OWN]) + pdu] if offered else []), f"offered {user.offers}"
    user.check()
    return answer and answer[1:-2]


@cocotb.test()
async def every_user_code_is_offered(dut):
    tb, user = await start(dut)
    codes = sorted(tb.slave.config.user_codes)
    for code in codes:
        assert await ask(tb, user, bytes([code, 1, 2, 3])) == bytes([code, 1, 2, 3])
    for code in sorted({c + d for c in codes for d in (-1, 1)} - set(codes) - {0x80} | {0, 0xFF, MINE | 0x80}):
        await ask(tb, user, bytes([code, 1, 2, 3]), offered=False)
    await tb.finish()


@cocotb.test()
async def answers_of_every_length(dut):
    """0 to 252 bytes; one more, or many, is exception 04 and no byte of it."""
    tb, user = await start(dut)
    for size in (0, 1, 2, 100, 252, 253, 254, 256, 300, 511, 513):
        body = tb.rng.randbytes(size)
        user.answer_by(lambda pdu, b=body: pdu[:1] + b)
        answer = await ask(tb, user, bytes([MINE, size & 0xFF]))
        assert answer == (bytes([MINE]) + body if size <= 252 else bytes([MINE | EXCEPTION_FLAG, EX.FAILURE]))
    user.answer_by(echo)
    assert await ask(tb, user, bytes([MINE])) == bytes([MINE])
    await tb.finish()


@cocotb.test()
async def requests_of_every_length(dut):
    """The user reads each byte, of the longest too, a clock after it has said which."""
    tb, user = await start(dut)
    for size in (0, 1, 2, 63, 64, 252):
        user.behave(wait=tb.rng.randrange(4), gap=lambda: tb.rng.choice((0, 0, 0, 1, 5)))
        pdu = bytes([MINE]) + tb.rng.randbytes(size)
        assert len(pdu) <= LONGEST_PDU and await ask(tb, user, pdu) == pdu
    await tb.finish()


@cocotb.test()
async def user_gives_exceptions(dut):
    """Each code, counted and logged as any other; bytes put before it are dropped."""
    tb, user = await start(dut)
    for code in range(1, 16):
        user.answer_by(lambda _, c=code: c)
        user.behave(exception_after=bytes(code % 3))
        assert await ask(tb, user, bytes([MINE, code])) == bytes([MINE | EXCEPTION_FLAG, code])
        await tb.compare_counters(f"exception {code}")
    user.answer_by(lambda _: EX.NAK)
    assert await ask(tb, user, READ) == bytes([READ[0] | EXCEPTION_FLAG, EX.NAK])
    assert tb.slave.counters["slave_nak"] == 2
    await tb.finish()


@cocotb.test()
async def user_passes(dut):
    """On to the built-in function, or to exception 01; what was put does not count."""
    tb, user = await start(dut, lambda _: None)
    await tb.preset((Space.HOLDINGS, 0), 0x1234)
    await tb.preset((Space.HOLDINGS, 1), 0x5678)
    for bytes_ in (b"", b"\xba", bytes(40), bytes(300)):
        user.behave(before_passing=bytes_, wait=3)
        assert await ask(tb, user, READ) == b"\x03\x04\x12\x34\x56\x78"
        assert await ask(tb, user, READ + b"\0") == bytes([0x83, EX.VALUE])
        assert await ask(tb, user, frames.read(FC.READ_HOLDINGS, 0xFFFF, 1)) == bytes([0x83, EX.ADDRESS])
        assert await ask(tb, user, bytes([MINE, 1])) == bytes([MINE | EXCEPTION_FLAG, EX.FUNCTION])
        pdu = frames.diagnostics(Sub.QUERY_DATA, 0xA537)
        assert await ask(tb, user, pdu) == pdu
        pdu = frames.write_registers(5, [7, 8, 9])
        assert await ask(tb, user, pdu) == pdu[:5]
        assert (await ask(tb, user, frames.device_identification(1)))[0] == FC.READ_DEVICE_ID
        await tb.compare_counters("passed")
    tb.apply(busy=1)
    assert await ask(tb, user, READ) == bytes([0x83, EX.BUSY])
    await tb.finish()


@cocotb.test()
async def user_takes_some_of_a_built_in_function(dut):
    """One register of FC 03 is the user's, twelve bytes long; all others are read as ever."""

    def hook(pdu):
        return b"\x03\x0c" + bytes(range(12)) if pdu == frames.read(FC.READ_HOLDINGS, 1, 1) else None

    tb, user = await start(dut, hook)
    for address, quantity in ((0, 1), (1, 1), (1, 2), (0, 2), (2, 1), (1, 1), (1, 0), (0x0101, 1), (1, 1)):
        answer = await ask(tb, user, frames.read(FC.READ_HOLDINGS, address, quantity))
        assert (answer[1] == 12) == ((address, quantity) == (1, 1))
    for setup in ({"busy": 1}, {"busy": 0, "failure": EX.FAILURE}):
        tb.apply(**setup)
        assert (await ask(tb, user, frames.read(FC.READ_HOLDINGS, 1, 1)))[1] == 12, "the user knows better"
    await tb.finish()


@cocotb.test()
async def silent_user_ends_at_the_stall_limit(dut):
    tb, user = await start(dut, stall_limit=STALL_BITS)

    async def stalled(note):
        answer = await ask(tb, user, bytes([MINE, 1]), note=note)
        assert answer == bytes([MINE | EXCEPTION_FLAG, EX.FAILURE])
        late = tb.latency(tb.last_answer) - STALL_BITS
        assert -1 <= late <= 2 + PROCESSING_CLOCKS / tb.setup.bit_time, f"{note}: {late:.1f} bits after the limit"
        assert not int(dut.user_req_o.value), "user_req_o stays"

    user.answer_by(lambda _: EX.FAILURE)
    user.behave(silent=True)
    await stalled("silent")
    # one that goes on and on has not finished either
    user.answer_by(lambda pdu: pdu[:1] + bytes(300))
    user.behave(gap=2 * tb.setup.bit_time)
    await stalled("slow")
    await user.strobes(b"\xba\xdd", done=True)  # too late, nobody listens
    user.answer_by(echo)
    user.behave(wait=(STALL_BITS - 4) * tb.setup.bit_time)
    assert await ask(tb, user, bytes([MINE, 2])) == bytes([MINE, 2])
    user.behave()
    assert await ask(tb, user, bytes([MINE, 3])) == bytes([MINE, 3])
    await tb.compare_counters("at the end", line=True)
    await tb.finish()


@cocotb.test()
async def without_a_stall_limit_the_user_takes_its_time(dut):
    tb, user = await start(dut)
    user.behave(wait=12_000, gap=lambda: tb.rng.choice((0, 0, 500)))
    pdu = bytes([MINE]) + tb.rng.randbytes(9)
    assert await ask(tb, user, pdu, patience=40_000 * CLOCK_PS) == pdu
    await tb.finish()


@cocotb.test()
async def what_is_never_offered(dut):
    """Broadcasts, frames for others, bad frames, anything in listen-only mode."""
    tb, user = await start(dut)
    pdu = bytes([MINE, 1, 2])
    await tb.preset((Space.HOLDINGS, 0), 0x600D)
    for line in (
        frames.adu(BROADCAST, pdu),
        frames.adu(BROADCAST, READ),
        frames.adu(BROADCAST, frames.write_register(0, 0x600D)),
        frames.adu(OTHER, pdu),
        frames.bad_crc(frames.adu(OWN, pdu)),
        with_error(frames.adu(OWN, pdu), 1, "parity"),
        bytes([OWN, MINE]) * 129,
    ):
        assert await tb.both(line) is None
        assert not user.offers, f"offered {user.offers}"
    listen = frames.diagnostics(Sub.LISTEN_ONLY)
    user.answer_by(lambda request: None if request[0] == FC.DIAGNOSTICS else request)
    assert await ask(tb, user, listen) is None
    for one in (pdu, READ, listen):
        assert await ask(tb, user, one, offered=False) is None
    assert await ask(tb, user, frames.restart(), offered=False) is None
    assert await ask(tb, user, pdu) == pdu
    await tb.compare_counters("at the end", line=True)
    await tb.finish()


@cocotb.test()
async def strobes_out_of_turn_do_nothing(dut):
    """put and done at rest, after done, while other functions work and while a frame comes in."""
    tb, user = await start(dut)
    await tb.preset((Space.HOLDINGS, 1), 0x4321)
    pdu = bytes([MINE, 5, 6])
    for late in (1, 3, 40):
        user.behave(late=late)
        assert await ask(tb, user, pdu) == pdu
        await user.strobes(bytes(late), done=True)
    user.behave()
    stop = []

    async def noise():
        while not stop:
            if not int(dut.user_req_o.value):
                await user.strobes(b"\xee" * tb.rng.randrange(1, 4), done=tb.rng.random() < 0.5)
            await tb.clocks(tb.rng.randrange(1, 40))

    task = cocotb.start_soon(noise())
    for one in (
        frames.read(FC.READ_INPUTS, 0, 3),
        frames.read_write(0, 4, 2, [1, 2, 3]),
        frames.bare(FC.GET_EVENT_LOG),
        frames.bare(FC.REPORT_SERVER_ID),
        frames.write_files((1, 0, [1, 2, 3])),
        frames.read_files((1, 0, 3)),
        frames.read(FC.READ_INPUTS, 0xFFFF, 3),
    ):
        await ask(tb, user, one, offered=False)
    stop.append(True)
    await task
    assert await ask(tb, user, pdu) == pdu
    await tb.finish()


@cocotb.test()
async def reset_withdraws_the_offer(dut):
    tb, user = await start(dut)
    user.behave(silent=True)
    await tb.line.send(frames.adu(OWN, bytes([MINE, 1])))
    await tb.clocks(round(tb.t35 / CLOCK_PS) + 100)
    assert int(dut.user_req_o.value), "not offered"
    await tb.reset()
    assert not int(dut.user_req_o.value)
    await tb.silence()
    user.behave()
    assert await ask(tb, user, bytes([MINE, 2])) == bytes([MINE, 2])
    await tb.finish()
