# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Wishbone around a device: cocotbext-wishbone's master and slave, with a memory behind the slave.

The models run as they come with cocotb 2.1.0; the ports' names go in by `signals_dict`. The slave takes data, replies
and waits from generators that it asks when a strobe arrives: ours look at the bus, and so it has a memory. A number of
clocks that does not count down while it is held (`Held`) makes it fall silent.
"""

from cocotb.triggers import RisingEdge
from cocotbext.wishbone.driver import WBOp, WishboneMaster
from cocotbext.wishbone.monitor import WishboneSlave
from protocol.defs import ADDRESSES, BIT_SPACES, SPACE_SHIFT, Space, bus_address

ACK, ERR = 1, 2


class Held:
    """A count of clocks as the model counts it, that stands still until `free`."""

    free = False

    def __gt__(self, other):
        return not self.free

    def __sub__(self, other):
        return self


def signals(directions):
    """The model's names and the ports' behind a prefix; `directions` are the suffixes of master and slave outputs."""
    out, back = directions
    names = {n: f"{n}_{out}" for n in ("cyc", "stb", "we", "adr")}
    return {**names, "datwr": f"dat_{out}", "datrd": f"dat_{back}", "ack": f"ack_{back}", "err": f"err_{back}"}


class WishboneMemory:
    """A slave on the wb port of the device; what it does is said as to AxilMemory."""

    kind = "Wishbone"
    errs = (ERR,)

    def __init__(self, dut, rng, at=None):
        self.dut, self.rng = dut, rng
        self.words, self.log, self.faults = {}, [], []
        self.noise, self._odds = 0, 0
        self.begin()
        self.slave = WishboneSlave(
            dut,
            "wb",
            dut.clk_i,
            width=16,
            signals_dict=signals("oi"),
            waitreplygen=self._waits(),
            datgen=self._reads(),
            ackgen=self._replies(),
        )

    def begin(self, errors=None, silent=None, wait=None):
        """As AxilMemory.begin."""
        self.log, self.errors, self.silent, self.wait = [], errors or {}, silent, wait
        self.number, self._held = 0, Held()

    def recover(self):
        """The silent beat is answered now, late."""
        self._held.free = True

    def hesitate(self, odds):
        """Random waits."""
        self._odds = odds

    def _access(self):
        address, write = int(self.dut.wb_adr_o.value), int(self.dut.wb_we_o.value)
        return write, (Space(address >> SPACE_SHIFT), address % ADDRESSES)

    def _waits(self):
        while True:
            if self.number == self.silent:
                yield self._held
                continue
            clocks = (self.wait() if callable(self.wait) else self.wait) or 0
            while self.rng.random() < self._odds:
                clocks += 1
            yield clocks

    def _reads(self):
        while True:
            _, key = self._access()
            yield self.words.get(key, 0) | (self.noise & 0xFFFE if key[0] in BIT_SPACES else 0)

    def _replies(self):
        while True:
            reply = ERR if self.number in self.errors else ACK
            write, key = self._access()
            if reply == ACK:
                if write:
                    self.words[key] = int(self.dut.wb_dat_o.value) & (1 if key[0] in BIT_SPACES else 0xFFFF)
                self.log.append((write, key, self.words.get(key, 0)))
            self.number += 1
            yield reply


class Host:
    """cocotbext-wishbone's master on a slave port of the device, `prefix` "host" or "cpu"."""

    def __init__(self, dut, prefix):
        self.dut = dut
        self.bus = WishboneMaster(dut, prefix, dut.clk_i, width=16, signals_dict=signals("io"))

    async def block(self, *accesses):
        """(space, item[, value to write]) each, under one cyc; what was read or written, None where err came."""
        ops = [WBOp(bus_address(*access[:2]), *access[2:3]) for access in accesses]
        results = await self.bus.send_cycle(ops)
        out = []
        for result in results:
            value = int(result.datwr if result.datwr is not None else 0)
            out.append(None if result.ack == ERR else value)
        return [v if v is None or len(a) > 2 else int(r.datrd) for v, a, r in zip(out, accesses, results, strict=True)]

    async def write(self, space, item, value):
        """True if it was written."""
        return (await self.block((space, item, value)))[0] is not None

    async def read(self, space, item):
        """The value, or None for err."""
        return (await self.block((space, item)))[0]

    async def gap(self):
        """A clock without cyc."""
        await RisingEdge(self.dut.clk_i)
