# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The core's side of the user port, for modules that are wired to it."""

from dataclasses import dataclass

from harness.unit import clocks, settle
from protocol.frames import text

PATIENCE = 4_000  # clocks
MOST_LINGER = 16  # clocks that a request stays after done


@dataclass(frozen=True)
class Verdict:
    """How an offer ended: answer data, or an exception, or passed on; None: withdrawn by the core."""

    data: bytes = b""
    exception: int = 0
    passed: bool = False
    clocks: int = 0  # from the first clock of the request to that of done

    def __str__(self):
        if self.passed:
            return "passed on"
        return f"exception {self.exception:02X}" if self.exception else f"data {text(self.data)}"


class UserPort:
    """Offers requests and takes answers. The request's bytes come a clock after their place, else rubbish."""

    def __init__(self, dut, rng):
        self.dut, self.rng = dut, rng
        self._place = 0

    async def _clock(self, request):
        """One clock; the module's (put, data, done, pass, exception) in it, what is not valid as 0."""
        dut = self.dut
        await settle()
        put, done, place = int(dut.user_put_o.value), int(dut.user_done_o.value), int(dut.user_adr_o.value)
        byte = int(dut.user_dat_o.value) if put else 0
        passed, exception = (int(dut.user_pass_o.value), int(dut.user_exception_o.value)) if done else (0, 0)
        await clocks(dut)
        held = request is not None and place < len(request)
        dut.user_dat_i.value = request[place] if held else self.rng.randrange(256)
        return put, byte, done, passed, exception

    async def rest(self, count):
        """Clocks without a request: nothing may come from the module."""
        self.dut.user_req_i.value = 0
        for _ in range(count):
            put, _, done, _, _ = await self._clock(None)
            assert not put and not done, "put or done without a request"

    async def offer(self, request, withdraw=None):
        """Offer `request`, the frame without CRC; a Verdict, or None if withdrawn after that many clocks.

        The request stays for a clock or some after done, in which the module must be quiet.
        """
        dut = self.dut
        dut.user_count_i.value = len(request)
        dut.user_req_i.value = 1
        data, shown = bytearray(), text(request)
        for clock in range(PATIENCE):
            if clock == withdraw:
                dut.user_req_i.value = 0
                await self._clock(None)  # it cannot know before this clock's end
                return None
            put, byte, done, passed, exception = await self._clock(request)
            assert not (put and done), f"{shown}: put and done in one clock"
            if put:
                data.append(byte)
            if done:
                for _ in range(self.rng.randrange(MOST_LINGER)):
                    put, _, again, _, _ = await self._clock(request)
                    assert not put and not again, f"{shown}: put or done after done"
                dut.user_req_i.value = 0
                return Verdict(bytes(data), exception, bool(passed), clock)
        raise AssertionError(f"{shown}: no end after {PATIENCE} clocks")
