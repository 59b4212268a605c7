# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_uart receiving: characters in every format, errors, breaks, false starts, spikes, the deaf receiver."""

import cocotb
from cocotb.triggers import Timer
from harness import wave
from harness.line import drive
from harness.unit import CLOCK_PS, clocks, start, watch
from protocol.defs import FORMAT_BY_NAME

VALUES = ("data", "parity_error", "framing_error")


class Receiver:
    """The bench's device, its line and what it has heard."""

    @classmethod
    async def start(cls, dut, fmt="8E1", bit_time=8, **inputs):
        self = cls()
        self.dut, self.fmt, self.bit = dut, FORMAT_BY_NAME[fmt], bit_time * CLOCK_PS
        inputs = {"enable": 1, "rxd": 1, "bit_time": bit_time, "format": self.fmt.code, **inputs}
        self.rng = await start(dut, **inputs)
        self.heard = watch(dut, "char_stb", VALUES)
        self.starts, self.bits = watch(dut, "start_stb"), watch(dut, "bit_stb", ("bit",))
        return self

    async def play(self, edges, end):
        """Drive edges (ps from now) and wait until `end`."""
        await drive(edges, self.dut.rxd_i.set, end)

    async def send(self, line, **how):
        """Send characters from a random phase on."""
        await Timer(self.rng.randrange(1, self.bit), "ps")
        sent = wave.encode(line, self.fmt, self.bit, **how)
        await self.play(sent.edges, sent.end)
        await clocks(self.dut, 4)

    def take(self):
        """What was heard since the last call: [(data, parity error, framing error)]."""
        out = list(self.heard)
        self.heard.clear()
        return out


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), bit_time=[8, 9, 10, 11, 16, 100])
async def every_byte_arrives(dut, fmt, bit_time):
    rx = await Receiver.start(dut, fmt, bit_time)
    data = range(256) if (fmt, bit_time) == ("8E1", 8) else rx.rng.randbytes(10)
    await rx.send(bytes(data))
    assert rx.take() == [(byte, 0, 0) for byte in data]
    assert len(rx.starts) == len(data), "one start strobe a character"


@cocotb.test()
async def data_bits_come_as_they_pass(dut):
    """For the bit-serial CRC: eight strobes a character, lowest bit first, no parity, no stop bit."""
    rx = await Receiver.start(dut)
    await rx.send(b"\xc5\x0f")
    assert [bit for (bit,) in rx.bits] == [(b >> i) & 1 for b in b"\xc5\x0f" for i in range(8)]


@cocotb.test()
@cocotb.parametrize(fmt=["8E1", "8O1"])
async def parity_error_is_told_with_its_character(dut, fmt):
    rx = await Receiver.start(dut, fmt)
    line = [(byte, 0, "parity" if i % 3 == 1 else None) for i, byte in enumerate(rx.rng.randbytes(30))]
    await rx.send(line)
    assert rx.take() == [(byte, int(error is not None), 0) for byte, _, error in line]


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME))
async def framing_error_is_told_with_its_character(dut, fmt):
    rx = await Receiver.start(dut, fmt)
    line = [(byte, 0, "framing" if i % 3 == 1 else None) for i, byte in enumerate(rx.rng.randbytes(30))]
    await rx.send(line)
    assert rx.take() == [(byte, 0, int(error is not None)) for byte, _, error in line]


@cocotb.test()
@cocotb.parametrize(fmt=list(FORMAT_BY_NAME), bits=[12, 23, 100])
async def break_is_one_character(dut, fmt, bits):
    """Then the line must be high before the next start bit counts."""
    rx = await Receiver.start(dut, fmt)
    await rx.play([(0, 0), (bits * rx.bit, 1)], (bits + 0.4) * rx.bit)
    ((data, _, framing),) = rx.take()
    assert (data, framing) == (0, 1)
    assert int(dut.receiving_o.value) == 0
    await rx.send(b"\x5a")
    assert rx.take() == [(0x5A, 0, 0)]


@cocotb.test()
async def busy_covers_break_and_character(dut):
    rx = await Receiver.start(dut)
    dut.rxd_i.value = 0
    await Timer(2 * rx.bit, "ps")
    for _ in range(30):
        assert int(dut.receiving_o.value) == 1
        await Timer(rx.bit, "ps")
    dut.rxd_i.value = 1
    await Timer(rx.bit, "ps")
    assert int(dut.receiving_o.value) == 0


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 16])
async def low_below_half_a_bit_is_no_start(dut, bit_time):
    rx = await Receiver.start(dut, bit_time=bit_time)
    for percent in range(2, 44 if bit_time == 16 else 37, 2):
        await Timer(rx.rng.randrange(1, rx.bit), "ps")
        await rx.play([(0, 0), (rx.bit * percent // 100, 1)], 2 * rx.bit)
        assert not rx.take() and not rx.starts, f"low for {percent} % of a bit"
        assert int(dut.receiving_o.value) == 0
    await rx.send(b"\x81")
    assert rx.take() == [(0x81, 0, 0)]


@cocotb.test()
@cocotb.parametrize(bit_time=[8, 9, 10, 11, 12, 16])
async def spike_below_a_quarter_bit_changes_nothing(dut, bit_time):
    """Anywhere in the character, at any phase to the clock."""
    rx = await Receiver.start(dut, bit_time=bit_time)
    for place in range(0, 11 * 8):
        byte = rx.rng.getrandbits(8)
        sent = wave.encode([byte], rx.fmt, rx.bit)
        spike = ((place / 8 + rx.rng.uniform(0, 1 / 8)) * rx.bit, 0.24 * rx.bit)
        await Timer(rx.rng.randrange(1, rx.bit), "ps")
        await rx.play(wave.with_spikes(sent.edges, [spike]), sent.end + 2 * rx.bit)
        assert rx.take() == [(byte, 0, 0)], f"{byte:02X}, spike at {spike[0] / rx.bit:.2f} bits"


@cocotb.test()
@cocotb.parametrize(case=[(8, 0.02), (8, -0.02), (16, 0.04), (16, -0.04), (9, -0.02), (17, 0.04), (17, -0.04)])
async def sender_may_be_off_by(dut, case):
    bit_time, offset = case
    rx = await Receiver.start(dut, bit_time=bit_time)
    for data in (bytes(20), b"\xff" * 20, rx.rng.randbytes(60)):
        await rx.send(data, offset=offset)
        assert rx.take() == [(byte, 0, 0) for byte in data], f"{offset:+.0%}"


@cocotb.test()
async def deaf_receiver_hears_nothing(dut):
    rx = await Receiver.start(dut, enable=0)
    await rx.send(b"\x12\x34")
    assert not rx.take() and not rx.starts
    dut.enable_i.value = 1
    await rx.send(b"\x56")
    assert rx.take() == [(0x56, 0, 0)]
    sender = cocotb.start_soon(rx.send(b"\x00"))
    await Timer(4 * rx.bit, "ps")
    dut.enable_i.value = 0
    await sender
    dut.enable_i.value = 1
    await clocks(dut, 200)
    assert not rx.take(), "a character cut off by the driver was reported"


@cocotb.test()
async def reset_forgets_the_character(dut):
    rx = await Receiver.start(dut, "8O1")  # nothing falls any more in the rest of FFH
    sender = cocotb.start_soon(rx.send(b"\xff"))
    await Timer(5 * rx.bit, "ps")
    dut.rst_i.value = 1
    await clocks(dut, 2)
    dut.rst_i.value = 0
    await sender
    await clocks(dut, 100)
    assert not rx.take()


@cocotb.test()
@cocotb.parametrize(limit=[(8, -4.4), (8, 4.0), (16, -4.4), (16, 4.5), (100, 4.5)])
async def sender_may_be_so_far_off(dut, limit):
    """Per cent slower, or faster if negative, at so many clocks per bit."""
    bit_time, percent = limit
    rx = await Receiver.start(dut, "8E1", bit_time)
    rx.bit = round(rx.bit * (1 + percent / 100))
    data = bytes([0x00, 0xFF, 0x01, 0x80]) + rx.rng.randbytes(60)
    await rx.send(data)
    assert rx.take() == [(byte, 0, 0) for byte in data]
