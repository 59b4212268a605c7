# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The worked example of user functions in a slave: its answers on the line, counters and log beside the model's."""

import re
import struct

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge
from harness import build
from harness.bench import CLOCK_PS, PARAMETERS, Bench
from harness.runner import ROOT
from protocol import frames
from protocol.defs import EX, FC
from protocol.model import Slave

OWN = 17
ADD, WORK, REVERSE, NOBODYS = 0x41, 0x42, 0x64, 0x6E
WAIT, LEAVE = 0, 1
USERS = frozenset(c for c in range(1, 128) if PARAMETERS["USER_CODES"] >> c & 1)
WORK_CLOCKS = PARAMETERS["WORK_CLOCKS"]
MOST_DATA = 252
BIT_TIME = 8
SHORT_STALL = 20  # bit times; the job takes longer


class Example(Bench):
    """The bench with the example's functions as the model's user; what 42H says, the test knows."""

    def __init__(self, dut, seed):
        super().__init__(dut, seed)
        config = build.model_config("modbus_rtu_slave_io", {})
        config.user_codes = USERS
        self.slave = Slave(config)
        self.slave.user = self._user
        self.work = None  # what 42H answers next

    def _user(self, pdu):
        code, data = pdu[0], bytes(pdu[1:])
        if code == ADD:
            return pdu[:1] + struct.pack(">I", sum(frames.unpack_words(data))) if len(data) == 4 else EX.VALUE
        if code == REVERSE:
            return pdu[:1] + data[::-1] if data else EX.VALUE
        if code == WORK:
            if len(data) != 1 or data[0] > LEAVE:
                return EX.VALUE
            return self.work if isinstance(self.work, int) else pdu[:1] + self.work
        return None

    async def says(self, pdu, address=OWN, work=None, **how):
        """Send a request to model and device, and compare."""
        self.work = struct.pack(">H", work) if isinstance(work, int) and not isinstance(work, EX) else work
        return await self.both(frames.adu(address, pdu), **how)


@cocotb.test()
async def fields_in_and_out(dut):
    tb = await Example.start(dut)
    for a, b in ((0, 0), (0xFFFF, 0xFFFF), (0x1234, 0x4321)):
        answer = await tb.says(struct.pack(">BHH", ADD, a, b))
        assert answer == frames.adu(OWN, struct.pack(">BI", ADD, a + b))
    for data in (b"", b"\1\2\3", b"\1\2\3\4\5"):
        assert await tb.says(bytes([ADD]) + data) == frames.adu(OWN, bytes([ADD | 0x80, EX.VALUE]))
    await tb.finish()


@cocotb.test()
async def requests_of_any_length(dut):
    tb = await Example.start(dut)
    for length in (0, 1, 2, 3, 16, 17, MOST_DATA - 1, MOST_DATA):
        await tb.says(bytes([REVERSE]) + tb.rng.randbytes(length))
    await tb.finish()


@cocotb.test()
async def an_answer_takes_its_time(dut):
    tb = await Example.start(dut)
    for job in (1, 2):
        await tb.says(bytes([WORK, WAIT]), work=job)
        clocks = tb.latency(await tb.query(frames.adu(OWN, bytes([WORK, WAIT])))) * BIT_TIME
        assert WORK_CLOCKS <= clocks <= WORK_CLOCKS + 400, f"answered after {clocks} clocks"
        await tb.reset()
        await tb.silence()
        await tb.says(bytes([WORK, WAIT]), work=1)
    await tb.finish()


@cocotb.test()
async def work_goes_on_between_requests(dut):
    tb = await Example.start(dut)
    for job in (1, 2):
        await tb.says(bytes([WORK, LEAVE]), work=EX.ACKNOWLEDGE)
        await tb.says(bytes([WORK, LEAVE]), work=EX.BUSY)
        await tb.clocks(WORK_CLOCKS)
        await tb.says(bytes([WORK, LEAVE]), work=job)
    await tb.says(bytes([WORK, 2]))
    await tb.finish()


@cocotb.test()
async def a_stall_is_exception_04_and_no_loss(dut):
    tb = await Example.start(dut, stall_limit=SHORT_STALL)
    for job in (1, 2):
        await tb.says(bytes([WORK, WAIT]), work=EX.FAILURE)
        await tb.says(bytes([ADD, 0, 1, 0, 2]))
        await tb.clocks(WORK_CLOCKS)
        await tb.says(bytes([WORK, LEAVE]), work=job)
    await tb.finish()


@cocotb.test()
async def what_is_passed_goes_to_the_built_in_function(dut):
    """Or is exception 01 where there is none; also in a request whose form is wrong."""
    tb = await Example.start(dut, exception_status=0x5A)
    assert {FC.READ_HOLDINGS, FC.READ_EXCEPTION_STATUS, FC.DIAGNOSTICS, NOBODYS} < USERS
    for pdu in (
        frames.read(FC.READ_HOLDINGS, 0, 8),
        frames.read(FC.READ_HOLDINGS, 0, 9),
        frames.read(FC.READ_HOLDINGS, 0, 0),
        frames.read(FC.READ_HOLDINGS, 0, 1) + b"\0",
        frames.write_register(1, 0x1234),
        bytes([FC.READ_EXCEPTION_STATUS]),
        frames.diagnostics(0, 0xABCD),
        bytes([NOBODYS, 1, 2]),
        bytes([NOBODYS]),
        frames.read(FC.READ_HOLDINGS, 1, 1),
    ):
        await tb.says(pdu)
    await tb.finish()


@cocotb.test()
async def not_offered(dut):
    """Broadcasts, other slaves' requests, bad frames, and codes that are not in USER_CODES."""
    tb = await Example.start(dut)
    add = struct.pack(">BHH", ADD, 1, 2)
    offers = 0

    async def watch():
        nonlocal offers
        while True:
            await dut.user_req.value_change
            offers += 1

    cocotb.start_soon(watch())
    patience = 500 * CLOCK_PS
    await tb.says(add, address=0, patience=patience)
    await tb.says(add, address=OWN + 1)
    await tb.both(frames.bad_crc(frames.adu(OWN, add)))
    await tb.says(bytes([0x43, 1, 2, 3, 4]))
    assert not offers, "offered"
    await tb.says(add)
    assert offers == 2, f"user_req_o changed {offers} times for one request"
    await tb.finish()


@cocotb.test()
async def busy_and_failure_are_the_users_business(dut):
    tb = await Example.start(dut, busy=1)
    await tb.says(struct.pack(">BHH", ADD, 1, 2))
    await tb.says(frames.read(FC.READ_HOLDINGS, 0, 1))
    tb.apply(busy=0, failure=8)
    await tb.says(struct.pack(">BHH", ADD, 3, 4))
    await tb.says(frames.read(FC.READ_HOLDINGS, 0, 1))
    await tb.finish()


SIGNALS = {  # port of the core: its wire in the bench
    "user_req_o": "user_req",
    "user_adr_i": "user_adr",
    "user_dat_o": "user_request",
    "user_put_i": "user_put",
    "user_dat_i": "user_answer",
    "user_done_i": "user_done",
}


def documented_clocks():
    """[{port: text}, ...] of the table in docs/user_functions.md; an empty cell is 0, or not valid."""
    text = (ROOT / "docs" / "user_functions.md").read_text(encoding="utf-8")
    table = re.search(r"<!-- recorded begin -->\n(.*?)<!-- recorded end -->", text, re.S)[1]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    head = [cell.strip("`") for cell in rows[0]]
    assert set(SIGNALS) <= set(head), f"columns {head}"
    return [dict(zip(head, row)) for row in rows[2:]]


@cocotb.test()
async def documented_clock_by_clock(dut):
    """The table of docs/user_functions.md is what the signals do."""
    rows = documented_clocks()
    tb = await Example.start(dut)
    recorded = []

    async def record():
        await RisingEdge(dut.user_req)
        while len(recorded) < len(rows):
            await ReadOnly()
            recorded.append({port: getattr(dut, wire).value for port, wire in SIGNALS.items()})
            await RisingEdge(dut.clk_i)

    cocotb.start_soon(record())
    await tb.says(bytes([REVERSE, 0xA1, 0xB2]))
    for row, seen in zip(rows, recorded):
        for port, said in row.items():
            if port in SIGNALS and (said or port in ("user_req_o", "user_put_i", "user_done_i")):
                assert int(seen[port]) == int(said or "0", 16), (
                    f"clock {row['clock']}: {port} is {seen[port]}, not {said}"
                )
    await tb.finish()
