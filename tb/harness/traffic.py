# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random line traffic for model against device: mostly sensible, often at a limit, sometimes broken."""

from collections import deque

from protocol import frames
from protocol.characters import characters
from protocol.defs import (
    ADDRESSES,
    BIT_SPACES,
    BROADCAST,
    DEFAULT_OBJECTS,
    FC,
    FIFO_MOST,
    FIRST_PRIVATE_OBJECT,
    FUNCTIONS,
    GROUP_HEAD,
    LONGEST_FRAME,
    LONGEST_PDU,
    MEI_DEVICE_ID,
    QUERY_DATA_MOST,
    READ_FILE_ANSWER,
    REFERENCE_TYPE,
    RESTART_CLEAR,
    RESTART_KEEP,
    WRITE_FILE_BYTES,
    Space,
    Sub,
)

READERS = (FC.READ_COILS, FC.READ_DISCRETES, FC.READ_HOLDINGS, FC.READ_INPUTS)
BARE = (FC.READ_EXCEPTION_STATUS, FC.GET_EVENT_COUNTER, FC.GET_EVENT_LOG, FC.REPORT_SERVER_ID)
KINDS = {
    "good": 60,
    "broadcast": 6,
    "foreign": 6,
    "wrong length": 6,
    "garbage": 4,
    "unsupported": 4,
    "spoiled": 14,
}
WEIGHTS = {**dict.fromkeys(FUNCTIONS, 6), **dict.fromkeys(BARE, 3), FC.DIAGNOSTICS: 16}
USER_WEIGHT = 10  # of all user functions together
SUB_WEIGHTS = {
    **dict.fromkeys(Sub, 4),
    Sub.QUERY_DATA: 16,
    Sub.RESTART: 8,
    Sub.LISTEN_ONLY: 5,
    Sub.CLEAR: 2,
    Sub.CLEAR_OVERRUN: 2,
}
QUEUES = 6  # places of possible queue counts that are remembered
SMALL = 0.3  # how likely a word may count the entries of a queue
WAKE = 0.4  # how likely the next line ends listen-only mode


class Traffic:
    """An endless source of lines for a slave of `config`; `rng` is a random.Random.

    With the model `slave` it knows when listen-only mode must be ended, else it keeps count itself.
    """

    def __init__(self, rng, config, slave=None):
        self.rng, self.config, self.slave = rng, config, slave
        self._silenced = False
        self._queues = deque(maxlen=QUEUES)

    def line(self):
        """(line, kind): what the master sends next, and a word for reports."""
        rng, own = self.rng, self.config.address
        if self.config.units:
            own = rng.choice((own, *sorted(self.config.units)))
        if self._listening() and rng.random() < WAKE:
            self._silenced = False
            return frames.adu(own, frames.restart(rng.random() < 0.5)), "restart"
        kind = rng.choices(list(KINDS), list(KINDS.values()))[0]
        if kind == "garbage":
            return rng.randbytes(rng.choice((1, 2, 3, 4, 5, 8, rng.randint(1, 300)))), kind
        if kind == "unsupported":
            return frames.adu(own, bytes([rng.randrange(256)]) + rng.randbytes(rng.choice((0, 2, 4, 9)))), kind
        pdu = self.request()
        if kind == "wrong length":
            cut = rng.randint(1, len(pdu))
            pdu = rng.choice((pdu[:cut], pdu + rng.randbytes(rng.randint(1, 4))))
        pdu = pdu[:LONGEST_PDU]
        if kind == "broadcast":
            return frames.adu(BROADCAST, pdu), kind
        if kind == "foreign":
            ours = {self.config.address, *self.config.units}
            return frames.adu(rng.choice([a for a in range(1, 256) if a not in ours]), pdu), kind
        frame = frames.adu(own, pdu)
        if pdu == frames.diagnostics(Sub.LISTEN_ONLY):
            self._silenced = True
        return (self.spoil(frame), kind) if kind == "spoiled" else (frame, kind)

    def _listening(self):
        return self.slave.listen_only if self.slave else self._silenced

    def spoil(self, frame):
        """`frame` with one thing wrong (or, with a short gap, nothing)."""
        rng = self.rng
        place = rng.randrange(1, len(frame))
        how = rng.choice(("crc", "bit", "gap", "short gap", "parity", "framing", "cut", "double", "long"))
        if how == "crc":
            return frames.bad_crc(frame, rng.randrange(1, ADDRESSES))
        if how == "bit":
            return frame[:place] + bytes([frame[place] ^ 1 << rng.randrange(8)]) + frame[place + 1 :]
        if how == "cut":
            return frame[:place]
        if how == "double":
            return (frame + frame)[:300]
        t15, t35 = self.config.t15, self.config.t35
        if how == "long":  # and sometimes with a gap somewhere
            frame += rng.randbytes(LONGEST_FRAME + rng.choice((0, 1, 2, rng.randint(1, 40))) - len(frame))
            place, how = rng.randrange(1, len(frame)), rng.choice(("gap", "none", "none"))
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

    # ------------------------------------------------------------------ requests

    def request(self):
        """A request PDU of a public function or of one of the user's."""
        rng = self.rng
        codes, weights = list(WEIGHTS), list(WEIGHTS.values())
        if self.config.user_codes:
            codes.append(rng.choice(sorted(self.config.user_codes)))
            weights.append(USER_WEIGHT)
        code = rng.choices(codes, weights)[0]
        if code in self.config.user_codes and (code not in FUNCTIONS or rng.random() < 0.3):
            return frames.bare(code, rng.randbytes(rng.choice((0, 1, 4, rng.randint(0, 60), LONGEST_PDU - 1))))
        if code in BARE:
            return frames.bare(code, rng.randbytes(rng.choice((0,) * 12 + (1, 2))))
        special = {
            FC.DIAGNOSTICS: self.diagnostics,
            FC.READ_FILE: self.read_files,
            FC.WRITE_FILE: self.write_files,
            FC.READ_FIFO: self.read_fifo,
            FC.READ_DEVICE_ID: self.device_identification,
        }
        return special[code]() if code in special else self.table_request(code)

    def table_request(self, code):
        """A request for bits or registers."""
        rng, limits = self.rng, self.config.limits
        space = FUNCTIONS[code].space
        address, word = self.place(space), rng.randrange(ADDRESSES)
        if code in READERS:
            most = limits.read_bits if space in BIT_SPACES else limits.read_registers
            return frames.read(code, address, self.quantity(most))
        if code == FC.WRITE_COIL:
            value = rng.choice((0xFF00, 0, 0xFF00, 0, word))
            return bytes([code, *address.to_bytes(2, "big"), *value.to_bytes(2, "big")])
        if code == FC.WRITE_REGISTER:
            return frames.write_register(address, self.values(address, 1)[0])
        if code == FC.MASK_WRITE:
            if rng.random() < 0.4:
                return frames.mask_write(address, 0, self.values(address, 1)[0])
            return frames.mask_write(address, word, rng.randrange(ADDRESSES))
        if code == FC.WRITE_COILS:
            quantity = self.quantity(limits.write_bits)
            bits = [rng.getrandbits(1) for _ in range(min(quantity, 1976))]
            return frames.write_coils(address, bits, quantity)
        if code == FC.WRITE_REGISTERS:
            quantity = self.quantity(limits.write_registers)
            return frames.write_registers(address, self.values(address, min(quantity, 123)), quantity)
        if code != FC.READ_WRITE:  # one without traffic of its own
            return frames.requests(address, address)[code]
        quantity = self.quantity(limits.rw_write)
        return frames.read_write(
            self.place(Space.HOLDINGS),
            self.quantity(limits.rw_read),
            address,
            self.values(address, min(quantity, 121)),
            quantity,
        )

    def values(self, address, count):
        """Random words for the registers from `address`; some of them may count the entries of a queue."""
        rng, words = self.rng, []
        for place in range(count):
            small = rng.random() < SMALL
            if small:
                self._queues.append((address + place) % ADDRESSES)
            counts = (0, 1, 2, rng.randint(3, 30), FIFO_MOST, FIFO_MOST + 1)
            words.append(rng.choice(counts) if small else rng.randrange(ADDRESSES))
        return words

    def read_fifo(self):
        """Mostly where a count has been written."""
        if self._queues and self.rng.random() < 0.8:
            return frames.read_fifo(self.rng.choice(self._queues))
        return frames.read_fifo(self.place(Space.HOLDINGS))

    def diagnostics(self):
        """All sub-functions, those that do not exist too; mostly with the data they want."""
        rng = self.rng
        if rng.random() < 0.06:
            sub = rng.choice((*range(0x05, 0x0A), 0x13, 0x15, 0x16, 0x0100, 0x010B, 0x8000, rng.randrange(ADDRESSES)))
            return frames.diagnostics(sub, rng.choice((0, 3, 4, rng.randrange(ADDRESSES))))
        sub = rng.choices(list(SUB_WEIGHTS), list(SUB_WEIGHTS.values()))[0]
        if sub == Sub.QUERY_DATA:
            most = QUERY_DATA_MOST
            sizes = (2, 2, 2, 4, 2 * rng.randint(1, most // 2), most - 2, most, 0, 1, 3, rng.randint(0, most))
            return frames.diagnostics(sub, rng.randbytes(rng.choice(sizes)))
        if rng.random() < 0.1:
            wrong = (0x0001, 0x0100, 0xFF00, 0xFF01, 0x00FF, 0x8000, rng.randrange(ADDRESSES))
            return frames.diagnostics(sub, rng.choice(wrong))
        if sub == Sub.RESTART:
            return frames.diagnostics(sub, rng.choice((RESTART_KEEP, RESTART_CLEAR)))
        if sub == Sub.DELIMITER:
            return frames.diagnostics(sub, rng.randrange(256) << 8)
        return frames.diagnostics(sub)

    def group(self, most):
        """(file, first record, quantity): often inside, often at the end of a file or of all files."""
        rng = self.rng
        files, records = self.config.files
        file = rng.choices((rng.randint(1, max(files, 1)), 0, files + 1, rng.randrange(ADDRESSES)), (94, 2, 2, 2))[0]
        quantity = rng.choice((1, 2, rng.randint(1, max(most, 1)), rng.randint(1, 8)))
        inside = rng.randint(0, max(records - quantity, 0))
        edge = records - quantity + rng.choice((-1, 0, 0, 1))
        far = rng.choice((records, 9999, 10000, ADDRESSES - 1))
        first = rng.choices((inside, max(edge, 0), far), (80, 17, 3))[0]
        return min(file, ADDRESSES - 1), first, quantity

    def read_files(self):
        """FC 14."""
        rng = self.rng
        count = rng.choice((1, 1, 2, 3, rng.randint(1, 35)))
        groups = [self.group(min(40, 120 // count)) for _ in range(count)]
        how = rng.random()
        if how < 0.15:  # an answer exactly as long as allowed, or one register more
            room = (READ_FILE_ANSWER - sum(2 + 2 * n for _, _, n in groups[1:])) // 2 - 1 + rng.choice((0, 0, 1))
            file, first, _ = groups[0]
            groups[0] = (file, min(first, max(self.config.files[1] - room, 0)), max(room, 0))
        elif how < 0.20:
            groups[rng.randrange(count)] = (1, 0, rng.choice((0, 122, 0x80, 0x100, 0x7FFF, 0xFFFF)))
        elif how < 0.25:
            place = rng.randrange(count)
            groups[place] = (*groups[place], rng.choice((0, 5, 7, 0x86)))
        elif how < 0.28:
            groups = [(1, i, 1) for i in range(rng.choice((34, 35, 36)))]
        pdu = frames.read_files(*groups)
        return self._miscounted(pdu) if rng.random() < 0.05 else pdu

    def write_files(self):
        """FC 15."""
        rng = self.rng
        count = rng.choice((1, 1, 2, 3, rng.randint(1, 20)))
        room = WRITE_FILE_BYTES[1] - GROUP_HEAD * count
        groups = []
        for left in range(count, 0, -1):
            most = room // 2 - (left - 1)  # every group behind has a word at least
            file, first, quantity = self.group(most)
            quantity = most if left == 1 and rng.random() < 0.1 else min(quantity, most)
            first = first if rng.random() < 0.3 else min(first, max(self.config.files[1] - quantity, 0))
            groups.append((file, first, self.words(quantity, most)))
            room -= 2 * quantity
        place = rng.randrange(count)
        file, first, words = groups[place]
        how = rng.random()
        if how < 0.06:  # the quantity does not tell the truth
            wrong = rng.choice((0, len(words) - 1, len(words) + 1, len(words) + 4, 0x8000 + len(words), 0xFFFF))
            groups[place] = (file, first, words, wrong)
        elif how < 0.10:
            groups[place] = (file, first, words, None, rng.choice((0, 5, 7, 0x80 | REFERENCE_TYPE)))
        pdu = frames.write_files(*groups)
        return self._miscounted(pdu) if rng.random() < 0.05 else pdu

    def _miscounted(self, pdu):
        """`pdu` with a byte count, and sometimes a length, that is not right."""
        change = self.rng.choice((-GROUP_HEAD, -2, -1, 1, 2, GROUP_HEAD))
        wrong = bytes([pdu[0], (pdu[1] + change) % 256])
        body = pdu[2:]
        if self.rng.random() < 0.5:  # count and length agree, the groups do not
            body = body[:change] if change < 0 else body + bytes(change)
        return wrong + body

    def device_identification(self):
        """FC 2B: every code, objects of every kind, sometimes another MEI type."""
        rng, known = self.rng, sorted(self.config.objects)
        code = rng.choice((1, 2, 3, 4, 1, 2, 3, 4, 4, 0, 5, rng.randrange(256)))
        private = FIRST_PRIVATE_OBJECT
        anything = rng.choice((len(DEFAULT_OBJECTS), 6, 7, private - 1, private, 0xFF, rng.randrange(256)))
        first = rng.choice((0, 0, rng.choice(known or [0]), rng.choice(known or [0]), anything))
        mei = MEI_DEVICE_ID if rng.random() < 0.94 else rng.choice((0x0D, 0x0F, 0, 0x8E, rng.randrange(256)))
        return frames.device_identification(code, first, mei)

    def words(self, quantity, most):
        """As many random words as asked, if a frame can carry them."""
        return [self.rng.randrange(ADDRESSES) for _ in range(min(quantity, most))]


class AsciiTraffic(Traffic):
    """The same in ASCII mode: characters, with faults of their own.

    A frame that a fault leaves open is closed, or the next line does it.
    """

    def line(self):
        """(line, kind)."""
        frame, kind = super().line()
        if kind == "garbage":
            return bytes(self.rng.choices(b"0123456789ABCDEFabcdef:\r\n#", k=len(frame))), kind
        body = bytes(c.byte for c in characters(frame))[:-2] if kind != "spoiled" else self._body
        end = bytes([self.slave.ascii_delimiter & 0x7F]) if self.slave else b"\n"
        line = frames.ascii_line(body + bytes([frames.lrc(body)]))[:-1] + end
        return (self.spoil_ascii(line), kind) if kind == "spoiled" else (line, kind)

    def spoil(self, frame):
        """Keeps the frame: it is spoiled as characters."""
        self._body = frame[:-2]
        return frame

    def spoil_ascii(self, line):
        """`line` with one thing wrong."""
        rng = self.rng
        place = rng.randrange(1, len(line))
        kinds = "bit character parity framing cut colon cr lrc digit long late"
        how = rng.choice(kinds.split())
        if how == "bit":
            return line[:place] + bytes([line[place] ^ 1 << rng.randrange(7)]) + line[place + 1 :]
        if how == "character":
            return line[:place] + bytes([rng.randrange(128)]) + line[place + 1 :]
        if how == "cut":
            return line[:place]
        if how in ("colon", "cr"):
            return line[:place] + (b":" if how == "colon" else b"\r") + line[place:]
        if how == "lrc":
            return line[:-4] + b"%02X" % (int(line[-4:-2], 16) ^ rng.randrange(1, 256)) + line[-2:]
        if how == "digit":
            return line[:-2] + rng.choice((b"0", b"00")) + line[-2:]
        if how == "long":
            return line[:-2] + b"5" * (LONGEST_FRAME * 2 + rng.randint(-3, 20) - len(line)) + line[-2:]
        gap = self.config.timeout * rng.choice((0.5, 1.2)) if how == "late" else 0
        error = how if how in ("parity", "framing") else None
        return [(byte, gap if i == place else 0, error if i == place else None) for i, byte in enumerate(line)]
