# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_ascii: characters to bytes and verdicts, bytes to characters, the delimiter, RTU unchanged."""

import cocotb
from harness.unit import clocks, settle, start, strobe
from protocol.frames import ascii_line, lrc

CHARACTER = 4  # clocks, between the end of one and that of the next


class Codec:
    """The module with a frame receiver, a frame RAM's count and a transmitter around it."""

    @classmethod
    async def start(cls, dut, **inputs):
        self = cls()
        self.dut, self.verdicts, self.stored, self.up = dut, [], bytearray(), 0
        self.late = False
        self.rng = await start(dut, **{"ascii": 1, "ready": 1} | inputs)
        cocotb.start_soon(self._receiver())
        return self

    async def _receiver(self):
        """One clock after the other, what modbus_frame_rx does."""
        dut, opens, whole = self.dut, False, False
        while True:
            await clocks(dut)
            begins, ends, receiving = (int(h.value) for h in (dut.start_stb_o, dut.t35_o, dut.receiving_i))
            if receiving and whole:
                self.stored.append(int(dut.byte_o.value))
            if receiving and ends:
                self.verdicts.append((bytes(self.stored), bool(int(dut.check_ok_o.value)) and not self.late))
                dut.receiving_i.value = 0
            self.late = bool(receiving and int(dut.t15_o.value))
            self.up += int(dut.up_stb_o.value)
            whole = bool(int(dut.char_stb_i.value) and int(dut.whole_o.value))
            dut.open_stb_i.value = int(opens)
            opens = begins
            if begins:
                dut.receiving_i.value = 1
                self.stored.clear()

    async def character(self, byte):
        """A character passes; half_o and whole_o with it."""
        dut = self.dut
        await strobe(dut, start_stb=1)
        dut.data_i.value = byte
        dut.char_stb_i.value = 1
        await settle()
        marks = int(dut.half_o.value), int(dut.whole_o.value)
        await clocks(dut)
        dut.char_stb_i.value = 0
        await clocks(dut, CHARACTER)
        return marks

    async def hear(self, line):
        """[(bytes, good), ...] of the frames that end in `line`."""
        self.verdicts.clear()
        for byte in line:
            await self.character(byte)
        return list(self.verdicts)


def frame(body):
    """The characters of `body` with its LRC."""
    return ascii_line(body + bytes([lrc(body)]))


@cocotb.test()
async def characters_become_bytes(dut):
    codec = await Codec.start(dut)
    for number in range(40):
        body = codec.rng.randbytes(codec.rng.choice((1, 2, 3, 8, 30)))
        codec.up = 0
        assert await codec.hear(frame(body)) == [(body + bytes([lrc(body)]), True)], f"{number}: {body.hex()}"
        assert codec.up == 1, f"one more byte counted {codec.up} times"


@cocotb.test()
async def every_byte_and_every_lrc(dut):
    codec = await Codec.start(dut)
    for byte in range(256):
        body = bytes([byte])
        assert await codec.hear(frame(body)) == [(bytes([byte, -byte & 0xFF]), True)]
        wrong = bytes([byte, (1 << byte % 8) ^ lrc(body)])
        assert await codec.hear(ascii_line(wrong)) == [(wrong, False)]


@cocotb.test()
async def every_character_is_judged(dut):
    """In the place of either half of a byte: 0-9 and A-F alone are good, however right the LRC is."""
    codec = await Codec.start(dut)
    for place in (1, 2):
        for byte in range(256):
            if byte in b":\r":
                continue
            good = byte in b"0123456789ABCDEF"
            digits = bytearray(b"00")
            digits[place - 1] = byte
            taken = (byte + (9 if byte & 0x40 else 0)) & 15  # what a careless decoder makes of it
            check = f"{-(taken << (4 if place == 1 else 0)) & 0xFF:02X}".encode()
            ((_, seen),) = await codec.hear(b":" + bytes(digits) + check + b"\r\n")
            assert seen == good, f"{byte:02X} at {place}"


@cocotb.test()
async def half_and_whole_tell_the_characters_of_bytes(dut):
    codec = await Codec.start(dut)
    seen = [await codec.character(byte) for byte in b":12x4\r\n"]
    assert seen[1:6] == [(1, 0), (1, 1), (1, 0), (1, 1), (0, 0)], f"{seen}"


@cocotb.test()
async def a_colon_begins_anew(dut):
    codec = await Codec.start(dut)
    good = frame(b"\x12\x34")
    for place in range(1, len(good)):
        seen = await codec.hear(good[:place] + good)
        assert [ok for _, ok in seen] == [False] * (place > 1) + [True], f"colon at {place}: {seen}"
        assert seen[-1][0] == b"\x12\x34\xba"


@cocotb.test()
async def only_cr_and_the_delimiter_end_a_frame(dut):
    codec = await Codec.start(dut)
    body = b":1234BA"
    for end, good in ((b"\r\n", True), (b"\r\r", False), (b"\r0", False), (b"0\r\n", False), (b"\r\x8a", False)):
        seen = await codec.hear(body + end)
        assert [ok for _, ok in seen] == [good], f"{end}: {seen}"
    assert await codec.hear(body + b"\n") == [], "LF alone"
    assert [ok for _, ok in await codec.hear(b"\r\n")] == [False]


@cocotb.test()
async def characters_outside_a_frame_are_ignored(dut):
    codec = await Codec.start(dut)
    assert await codec.hear(b"0123\r\nxyz\r") == []
    assert not codec.stored
    assert await codec.hear(frame(b"\x01")) == [(b"\x01\xff", True)]


@cocotb.test()
async def the_time_out_ends_the_frame(dut):
    codec = await Codec.start(dut)
    for part in (b":", b":1", b":12", b":12EE\r"):
        await codec.hear(part)
        await strobe(dut, over=1)
        await clocks(dut, 3)
        assert len(codec.verdicts) == 1 and not codec.verdicts[0][1], f"{part}: {codec.verdicts}"
        assert await codec.hear(b"12EE\r\n") == []
        assert await codec.hear(frame(b"\x12")) == [(b"\x12\xee", True)]
    dut.over_i.value = 1  # outside a frame it means nothing
    await clocks(dut, 3)
    dut.over_i.value = 0
    assert await codec.hear(frame(b"\x12")) == [(b"\x12\xee", True)]


@cocotb.test()
async def the_end_waits_for_the_stop_bits(dut):
    codec = await Codec.start(dut)
    dut.rest_i.value = 1
    assert await codec.hear(frame(b"\x12")) == []
    await clocks(dut, 20)
    assert not codec.verdicts
    dut.rest_i.value = 0
    await clocks(dut, 3)
    assert codec.verdicts == [(b"\x12\xee", True)]
    dut.rest_i.value = 1
    await codec.hear(frame(b"\x12"))
    await strobe(dut, start_stb=1)  # or the next character begins
    await clocks(dut, 3)
    assert codec.verdicts == [(b"\x12\xee", True)]


@cocotb.test()
async def the_delimiter(dut):
    """Set by its strobe, without bit 7; back to LF by a restart and by a reset."""
    codec = await Codec.start(dut)
    body = frame(b"\x12")[:-1]
    for byte in (0x00, 0x23, 0x3A, 0x0D, 0x41, 0x7F, 0xA3):
        for back in ("restart", "rst"):
            dut.frame_byte_i.value = byte
            await strobe(dut, delimiter_stb=1)
            dut.frame_byte_i.value = 0
            assert await codec.hear(body + bytes([byte & 0x7F])) == [(b"\x12\xee", True)], f"{byte:02X}"
            ((_, good),) = await codec.hear(body + b"\n")
            assert not good, f"LF beside {byte:02X}"
            await strobe(dut, **{back: 1})
            assert await codec.hear(body + b"\n") == [(b"\x12\xee", True)], f"after {back}"


async def sent(dut, body):
    """What goes to the transmitter when `body` and two check bytes are sent: [(character, check), ...]."""
    seen, places = [], [*((byte, 0, 0) for byte in body), (0, 1, 0), (0, 1, 1)]
    dut.ready_i.value = 0
    dut.valid_i.value = 1
    for byte, check, last in places:
        dut.frame_byte_i.value, dut.check_i.value, dut.last_i.value = byte, check, last
        while True:
            await clocks(dut, 3)
            dut.ready_i.value = 1
            await settle()
            seen.append((int(dut.data_o.value), int(dut.check_o.value)))
            done = int(dut.ready_o.value)
            await clocks(dut)
            dut.ready_i.value = 0
            if done:
                break
    dut.valid_i.value = dut.check_i.value = dut.last_i.value = 0
    await clocks(dut, 2)
    dut.ready_i.value = 1
    await settle()
    assert int(dut.ready_o.value) == 1, "the end of the last character does not pass"
    await clocks(dut, 2)
    return seen


@cocotb.test()
async def bytes_become_characters(dut):
    codec = await Codec.start(dut)
    for body in [bytes([b]) for b in range(256)] + [codec.rng.randbytes(n) for n in (2, 3, 20, 60)]:
        seen = await sent(dut, body)
        assert bytes(c for c, _ in seen) == frame(body), f"{body.hex()}: {bytes(c for c, _ in seen)}"
        assert not any(check for _, check in seen)
    assert await codec.hear(frame(b"\x77")) == [(b"\x77\x89", True)], "a frame behind an answer"


@cocotb.test()
async def rtu_passes_unchanged(dut):
    codec = await Codec.start(dut, ascii=0, crc_zero=1)
    for byte in range(256):
        assert await codec.character(byte) == (1, 1)
        assert int(dut.byte_o.value) == byte
    for level in (0, 1, 0):
        for name_in, name_out in (
            ("start_stb", "start_stb"),
            ("t15", "t15"),
            ("t35", "t35"),
            ("crc_zero", "check_ok"),
            ("ready", "ready"),
            ("check", "check"),
        ):
            getattr(dut, f"{name_in}_i").value = level
            await settle()
            assert int(getattr(dut, f"{name_out}_o").value) == level, name_out
    assert [c for c, _ in (await sent(dut, bytes(range(256))))[:256]] == list(range(256))
    assert not codec.up
