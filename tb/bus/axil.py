# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""AXI4-Lite around a device: cocotbext-axi's master and slave with a memory of ours, and a watch on the rules.

The models run as they come with cocotb 2.1.0. They do not judge what the other side does: `watch` does that.
"""

import cocotb
from cocotb.triggers import Event, RisingEdge, Timer
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiLiteSlave, AxiResp
from harness.bench import CLOCK_PS
from protocol.defs import Space

WORD = 4  # bytes
WINDOW = 0x40000  # bytes of one table in the map as it comes
AT = {space: int(space) * WINDOW for space in Space if space <= Space.FILES}
HOLD = 7 * WINDOW  # the slave's HOLD word
PAYLOAD = {
    "aw": ("awaddr", "awprot"),
    "w": ("wdata", "wstrb"),
    "b": ("bresp",),
    "ar": ("araddr", "arprot"),
    "r": ("rdata", "rresp"),
}


def place(space, item, at=AT):
    """Byte address of an item."""
    return (at[space] + WORD * item) % 2**32


class BusError(Exception):
    """The model answers SLVERR for whatever its target raises."""


def watch(dut, prefix, driven):
    """The channels `driven` keep valid, and what it says, until ready; else the test fails at once."""

    def signal(name):
        return getattr(dut, f"{prefix}_{name}")

    async def channel(name):
        before = None
        valid, ready = signal(f"{name}valid"), signal(f"{name}ready")
        while True:
            if before is None and not (valid.value.is_resolvable and int(valid.value)):
                await RisingEdge(valid)
            await RisingEdge(dut.clk_i)
            if int(dut.rst_i.value):
                before = None
                continue
            shown = tuple(int(signal(n).value) for n in PAYLOAD[name]) if int(valid.value) else None
            kept = before is None or shown == before
            assert kept, f"{prefix}_{name}: {before} became {shown} before it was taken"
            before = shown if shown is not None and not int(ready.value) else None

    for name in driven:
        cocotb.start_soon(channel(name))


def channels(bus):
    """The five channels of a model."""
    write, read = bus.write_if, bus.read_if
    return [write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel]


async def hesitate(bus, dut, rng, odds, begin=None, end=None):
    """Random pauses, of their own on each of the five channels: `odds` of the clocks.

    With `begin`, a signal, only while it is 1 (the models' own generators cost time in every clock); `odds` is a
    function. Ends when `end` has a member.
    """
    while not end:
        if begin is not None and not int(begin.value):
            await RisingEdge(begin)
        for channel in channels(bus):
            channel.pause = rng.random() < odds()
        await RisingEdge(dut.clk_i)
        if begin is not None and not int(begin.value):
            for channel in channels(bus):
                channel.pause = False
    for channel in channels(bus):
        channel.pause = False


class Cpu:
    """cocotbext-axi's master as a CPU that knows the map of docs/buses.md."""

    def __init__(self, dut, prefix="s_axil"):
        self.dut = dut
        self.bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, prefix), dut.clk_i)
        watch(dut, prefix, driven=("b", "r"))

    async def write(self, space, item, value, size=WORD):
        """A store of `size` bytes; True if it was OKAY."""
        done = await self.bus.write(place(space, item), value.to_bytes(size, "little"))
        return done.resp == AxiResp.OKAY

    async def read(self, space, item):
        """The word, or None for an error."""
        done = await self.bus.read(place(space, item), WORD)
        return int.from_bytes(done.data, "little") if done.resp == AxiResp.OKAY else None

    async def block(self, *accesses):
        """(space, item[, value to write]) each, one after the other; as Host.block, but not in one piece."""
        return [await self.read(*a) if len(a) == 2 else (a[2] if await self.write(*a) else None) for a in accesses]

    async def hold(self, on):
        """Set the HOLD word."""
        done = await self.bus.write(HOLD, int(on).to_bytes(WORD, "little"))
        assert done.resp == AxiResp.OKAY

    async def raw(self, address, data, strobes):
        """One write with any strobes; its response."""
        write = self.bus.write_if
        await write.aw_channel.send(write.aw_channel._transaction_obj(awaddr=address, awprot=0))
        await write.w_channel.send(write.w_channel._transaction_obj(wdata=data, wstrb=strobes))
        return AxiResp(int((await write.b_channel.recv()).bresp))


class AxilMemory:
    """A slave on the m_axil port of the device that waits, errs and falls silent.

    `words` has keys (space, item); `log` has (write, (space, item), value) of each transfer in the order of their
    ends; `errors` is {number of a transfer since `begin`: AxiResp}; transfer `silent` is not ended before `recover`.
    """

    kind = "AXI4-Lite"
    errs = (AxiResp.SLVERR, AxiResp.DECERR)

    def __init__(self, dut, rng, at=AT):
        self.dut, self.rng, self.at = dut, rng, at
        self.words, self.log, self.faults = {}, [], []
        self.odds = None  # nothing pauses
        self.noise = 0  # upper half of what is read
        self.begin()
        self.slave = AxiLiteSlave(AxiLiteBus.from_prefix(dut, "m_axil"), dut.clk_i, target=self)
        for channel, field in ((self.slave.read_if.r_channel, "rresp"), (self.slave.write_if.b_channel, "bresp")):
            self._coded(channel, field)
        watch(dut, "m_axil", driven=("aw", "w", "ar"))

    def _coded(self, channel, field):
        """The model knows SLVERR only; `errors` may say DECERR."""
        send = channel.send

        async def coded(response):
            if getattr(response, field) != AxiResp.OKAY:
                setattr(response, field, self._error)
            await send(response)

        channel.send = coded

    def begin(self, errors=None, silent=None, wait=None):
        """Forget the log; from now on err, fall silent and wait (clocks, or a function giving them) like this."""
        self.log, self.errors, self.silent, self.wait = [], errors or {}, silent, wait
        self.number, self._recovered = 0, Event()

    def recover(self):
        """The silent transfer is ended now."""
        self._recovered.set()

    def hesitate(self, odds):
        """Random pauses on all channels during bursts, in `odds` of the clocks."""
        if self.odds is None:
            cocotb.start_soon(hesitate(self.slave, self.dut, self.rng, lambda: self.odds, self.dut.burst_o))
        self.odds = odds

    def _key(self, address):
        for space, at in self.at.items():
            item, odd = divmod((address - at) % 2**32, WORD)
            if item < 65536 and not odd:
                return space, item
        raise AssertionError(f"transfer at {address:08X}, where no table is")

    async def _turn(self):
        number, self.number = self.number, self.number + 1
        recovered, self._error = self._recovered, self.errors.get(number)
        clocks = self.wait() if callable(self.wait) else self.wait
        if clocks:
            await Timer(clocks * CLOCK_PS, "ps")
        if number == self.silent:
            await recovered.wait()
        if self._error is not None:
            raise BusError

    async def write(self, address, data):
        """What the model calls for each run of strobes."""
        key = self._key(address)
        await self._turn()
        if len(data) != WORD or data[2:] != b"\0\0":
            self.faults.append(f"write of {data.hex()} at {address:08X}: not a whole word with an empty upper half")
        if int(self.dut.m_axil_awprot.value):
            self.faults.append("awprot is not 000")
        value = int.from_bytes(data, "little")
        self.words[key] = value
        self.log.append((1, key, value))

    async def read(self, address, length):
        """What the model calls for each read."""
        key = self._key(address)
        await self._turn()
        value = self.words.get(key, 0)
        self.log.append((0, key, value))
        noise = self.noise << 16 if key[0] > Space.DISCRETES else (self.noise << 16 | 0xFFFE) & 0xFFFFFFFE
        return (value | noise).to_bytes(length, "little")
