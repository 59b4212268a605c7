# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random line traffic for model against device: mostly sensible, often at a limit, sometimes broken."""

from . import frames
from .defs import (
    ADDRESSES,
    BIT_SPACES,
    BROADCAST,
    FC,
    FUNCTIONS,
    LONGEST_FRAME,
    Space,
)

READERS = (FC.READ_COILS, FC.READ_DISCRETES, FC.READ_HOLDINGS, FC.READ_INPUTS)


class Traffic:
    """An endless source of lines for a slave of `config`; `rng` is a random.Random."""

    def __init__(self, rng, config):
        self.rng, self.config = rng, config

    def line(self):
        """(line, kind): what the master sends next, and a word for reports."""
        rng = self.rng
        kind = rng.choices(
            ("good", "broadcast", "foreign", "wrong length", "garbage", "unsupported", "spoiled"),
            (60, 6, 6, 6, 4, 4, 14),
        )[0]
        own = self.config.address
        if kind == "garbage":
            return rng.randbytes(rng.choice((1, 2, 3, 4, 5, 8, rng.randint(1, 300)))), kind
        if kind == "unsupported":
            return frames.adu(own, bytes([rng.randrange(256)]) + rng.randbytes(rng.choice((0, 2, 4, 9)))), kind
        pdu = self.request()
        if kind == "wrong length":
            cut = rng.randint(1, len(pdu))
            pdu = rng.choice((pdu[:cut], pdu + rng.randbytes(rng.randint(1, 4))))
        pdu = pdu[: LONGEST_FRAME - 3]
        if kind == "broadcast":
            return frames.adu(BROADCAST, pdu), kind
        if kind == "foreign":
            return frames.adu(rng.choice([a for a in range(1, 256) if a != own]), pdu), kind
        frame = frames.adu(own, pdu)
        return (self.spoil(frame), kind) if kind == "spoiled" else (frame, kind)

    def spoil(self, frame):
        """`frame` with one thing wrong (or, with a short gap, nothing)."""
        rng = self.rng
        place = rng.randrange(1, len(frame))
        how = rng.choice(("crc", "bit", "gap", "short gap", "parity", "framing", "cut", "double"))
        if how == "crc":
            return frames.bad_crc(frame, rng.randrange(1, ADDRESSES))
        if how == "bit":
            return frame[:place] + bytes([frame[place] ^ 1 << rng.randrange(8)]) + frame[place + 1 :]
        if how == "cut":
            return frame[:place]
        if how == "double":
            return (frame + frame)[:300]
        t15, t35 = self.config.t15, self.config.t35
        gap = {"gap": rng.uniform(t15 + 0.2, t35 - 0.2), "short gap": rng.uniform(0, t15 - 0.2)}
        error = how if how in ("parity", "framing") else None
        return [
            (byte, gap.get(how, 0) if i == place else 0, error if i == place else None) for i, byte in enumerate(frame)
        ]

    def place(self, space):
        """An address: often in the table, often at its ends."""
        rng = self.rng
        base, count = self.config.tables[space]
        inside = base + rng.randrange(max(count, 1))
        edge = rng.choice((base, base + count, 0, ADDRESSES)) + rng.randint(-3, 3)
        return rng.choices((inside, edge, rng.randrange(ADDRESSES)), (80, 15, 5))[0] % ADDRESSES

    def quantity(self, most):
        """A quantity: often small, often at the limit, sometimes any."""
        rng = self.rng
        return rng.choices(
            (rng.randint(1, 20), rng.randint(1, most), most + rng.randint(-1, 1), 0, rng.randrange(ADDRESSES)),
            (70, 12, 10, 4, 4),
        )[0]

    def request(self):
        """A request PDU of an implemented function."""
        rng, limits = self.rng, self.config.limits
        code = rng.choice(sorted(FUNCTIONS))
        space = FUNCTIONS[code].space
        address = self.place(space)
        word = rng.randrange(ADDRESSES)
        if code in READERS:
            most = limits.read_bits if space in BIT_SPACES else limits.read_registers
            return frames.read(code, address, self.quantity(most))
        if code == FC.WRITE_COIL:
            value = rng.choice((0xFF00, 0, 0xFF00, 0, word))
            return bytes([code, *address.to_bytes(2, "big"), *value.to_bytes(2, "big")])
        if code == FC.WRITE_REGISTER:
            return frames.write_register(address, word)
        if code == FC.MASK_WRITE:
            return frames.mask_write(address, word, rng.randrange(ADDRESSES))
        if code == FC.WRITE_COILS:
            quantity = self.quantity(limits.write_bits)
            bits = [rng.getrandbits(1) for _ in range(min(quantity, 1976))]
            return frames.write_coils(address, bits, quantity)
        if code == FC.WRITE_REGISTERS:
            quantity = self.quantity(limits.write_registers)
            return frames.write_registers(address, self.words(quantity, 123), quantity)
        quantity = self.quantity(limits.rw_write)
        return frames.read_write(
            self.place(Space.HOLDINGS),
            self.quantity(limits.rw_read),
            address,
            self.words(quantity, 121),
            quantity,
        )

    def words(self, quantity, most):
        """As many random words as asked, if a frame can carry them."""
        return [self.rng.randrange(ADDRESSES) for _ in range(min(quantity, most))]
