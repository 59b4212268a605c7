# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A user's function in Python on the user port of a device, with manners good and bad."""

from dataclasses import dataclass

import cocotb
from cocotb.triggers import RisingEdge

SOON = 4  # clocks within which user_req_o falls after done


@dataclass
class UserManner:
    """How the user behaves. Times in clock cycles, numbers or callables."""

    wait: object = 0  # before the first byte of the answer
    gap: object = 0  # between two bytes
    silent: bool = False  # never finishes
    late: int = 0  # puts after done, and another done
    before_passing: bytes = b""  # put all the same
    exception_after: bytes = b""  # put before an exception


def _clocks(value):
    return value() if callable(value) else value


class User:
    """Answers offers by `respond(pdu)`: an answer PDU, an exception code, or None to pass.

    `respond` is given to the model as well. `offers` lists the requests, frames without CRC, as read byte
    by byte; `faults` what was wrong with the port.
    """

    def __init__(self, tb, respond):
        self.tb, self.dut = tb, tb.dut
        self.manner, self.offers, self.faults = UserManner(), [], []
        self.answer_by(respond)
        cocotb.start_soon(self._run())

    def answer_by(self, respond):
        """From now on this is what the user says."""
        self.respond = self.tb.slave.user = respond

    def behave(self, **manner):
        """From now on the user has this manner."""
        self.manner = UserManner(**manner)

    def check(self):
        """Raises AssertionError with everything that was wrong."""
        assert not self.faults, "; ".join(self.faults)

    async def strobes(self, puts=b"", done=False):
        """Strobes that nobody has asked for."""
        await self._put(puts, 0)
        if done:
            await self._done()

    async def _run(self):
        dut = self.dut
        while True:
            if not int(dut.user_req_o.value):
                await RisingEdge(dut.user_req_o)
            await RisingEdge(dut.clk_i)
            if not int(dut.user_req_o.value):
                continue  # gates: its inputs have not changed all at once; at the clock it counts
            request = await self._fetch()
            self.offers.append(request)
            await self._serve(request)

    async def _fetch(self):
        """The bytes of the request, one a clock, each a clock behind its place."""
        dut, data = self.dut, bytearray()
        count = int(dut.user_count_o.value)
        for place in range(count + 2):
            if place < count:
                dut.user_adr_i.value = place
            if place >= 2:
                data.append(int(dut.user_dat_o.value))
            await RisingEdge(dut.clk_i)
        return bytes(data)

    async def _serve(self, request):
        dut, manner = self.dut, self.manner
        answer = self.respond(request[1:])
        if not await self._sleep(_clocks(manner.wait)):
            return
        if manner.silent:
            while int(dut.user_req_o.value):
                await RisingEdge(dut.clk_i)
            return
        if answer is None:
            await self._put(manner.before_passing, manner.gap)
            await self._done(passes=1)
        elif isinstance(answer, int):
            await self._put(manner.exception_after, manner.gap)
            await self._done(exception=answer)
        else:
            if not await self._put(answer[1:], manner.gap):
                return
            await self._done()
        await self._put(bytes(manner.late), 0)
        if manner.late:
            await self._done()
        for _ in range(SOON):
            if not int(dut.user_req_o.value):
                return
            await RisingEdge(dut.clk_i)
        self.faults.append("user_req_o stays after done")

    async def _sleep(self, clocks):
        """Wait; False if the request was withdrawn meanwhile."""
        for _ in range(clocks):
            await RisingEdge(self.dut.clk_i)
            if not int(self.dut.user_req_o.value):
                return False
        return True

    async def _put(self, data, gap):
        """Append bytes; False if the request was withdrawn meanwhile."""
        dut = self.dut
        for byte in data:
            dut.user_put_i.value, dut.user_dat_i.value = 1, byte
            await RisingEdge(dut.clk_i)
            wait = _clocks(gap)
            if wait:
                dut.user_put_i.value = 0
                if not await self._sleep(wait):
                    return False
        dut.user_put_i.value = 0
        return True

    async def _done(self, passes=0, exception=0):
        dut = self.dut
        dut.user_done_i.value, dut.user_pass_i.value, dut.user_exception_i.value = 1, passes, exception
        await RisingEdge(dut.clk_i)
        dut.user_done_i.value, dut.user_pass_i.value, dut.user_exception_i.value = 0, 0, 0
