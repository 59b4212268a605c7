# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The legal values of every parameter that has a range, and random legal sets of them.

A module's space is a list of groups; a group draws its parameters together and knows the rules between them.  Values
are drawn at the edges of their ranges and at powers of two more often than between, since that is where tools and
comparisons differ.  `draw(module, rng)` gives {parameter: value as a linter's command line takes it}.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

Group = Callable[[Random, bool], dict[str, object]]
ADDRESSES = 65536
ALL_FUNCTIONS = (1, 2, 3, 4, 5, 6, 7, 8, 0x0B, 0x0C, 0x0F, 0x10, 0x11, 0x14, 0x15, 0x16, 0x17, 0x18, 0x2B)
OFTEN_DEFAULT = 0.4  # of the parameters of a group are left alone


def edges(low: int, high: int) -> list[int]:
    """Ends of a range, and the powers of two in it, each with its neighbours."""
    points = {low, high, *(1 << n for n in range(high.bit_length()))}
    return sorted({p + d for p in points for d in (-1, 0, 1) if low <= p + d <= high})


def pick(rng: Random, low: int, high: int) -> int:
    """A value of low..high, at an edge three times of four."""
    return rng.choice(edges(low, high)) if rng.random() < 0.75 else rng.randint(low, high)


def plain(**ranges: tuple[int, int] | list[int]) -> Group:
    """Parameters without rules between them: (low, high), or a list of values."""

    def group(rng: Random, large: bool) -> dict[str, object]:
        out = {}
        for name, values in ranges.items():
            if rng.random() >= OFTEN_DEFAULT:
                out[name] = rng.choice(values) if isinstance(values, list) else pick(rng, *values)
        return out

    return group


def codes(rng: Random, large: bool) -> dict[str, object]:
    """FUNCTION_CODES and USER_CODES: bit n is function code n."""
    out: dict[str, object] = {}
    if rng.random() < 0.7:
        share = rng.random()
        out["FUNCTION_CODES"] = f"128'h{sum(1 << c for c in ALL_FUNCTIONS if rng.random() < share):X}"
    if rng.random() < 0.3:
        share = rng.random()
        out["USER_CODES"] = f"128'h{sum(1 << c for c in range(1, 128) if rng.random() < share):X}"
    return out


def clock(rng: Random, large: bool) -> dict[str, object]:
    """CLK_HZ and the floors of the silences: T15_MIN_US <= T35_MIN_US."""
    t35 = rng.choice((0, 1750, pick(rng, 0, 100000)))
    clk_hz = rng.choice((50000000, 1843200, pick(rng, 1000, 1000000000)))
    return {"CLK_HZ": clk_hz, "T35_MIN_US": t35, "T15_MIN_US": pick(rng, 0, t35)}


LIMITS = plain(
    MAX_READ_BITS=(1, 2000),
    MAX_WRITE_BITS=(1, 1968),
    MAX_READ_REGISTERS=(1, 125),
    MAX_WRITE_REGISTERS=(1, 123),
    RW_MAX_READ=(1, 125),
    RW_MAX_WRITE=(1, 121),
    BITS_PER_BEAT=[1, 16],
    CHECK_WRITES=(0, 1),
    ASCII_MODE=(0, 1),
    ASCII_TIMEOUT_MS=(1, 1073),
    SERVER_ID_BYTES=(1, 16),
    ADDITIONAL_DATA_BYTES=(0, 234),
    CONFORMITY=["8'h01", "8'h02", "8'h03", "8'h81", "8'h82", "8'h83"],
    DEVICE_ID_LIMIT=(16, 253),  # 9 more than the longest object, PRODUCT
    ALIVE_TIMEOUT_MS=(0, 16777215),
)


def settings(rng: Random, large: bool) -> dict[str, object]:
    """The settings of a drop-in, with a clock: BAUD from CLK_HZ / 65535 to CLK_HZ / 8."""
    out = clock(rng, large) | plain(
        ADDRESS=(0, 247),
        FORMAT=(0, 3),
        BROADCAST=(0, 1),
        GAP_COUNT_ONLY=(0, 1),
        STRICT_TURNAROUND=(0, 1),
        DROP_LATE=(0, 1),
        RESPONSE_DELAY=(0, 4095),
        STALL_LIMIT=(0, 65535),
        DE_LEAD=(0, 15),
        DE_TAIL=(0, 15),
        ASCII_DATA_BITS=(7, 8),
        ASCII_EXTRA=(0, 3),
    )(rng, large)
    clk_hz = int(out["CLK_HZ"])
    # Above 100 clocks a bit every rate is near enough to a whole number of them; below, take a rate that is one.
    divider = pick(rng, 8, 65535)
    while divider < 100 and clk_hz % divider:
        divider += 1
    return {**out, "BAUD": max(clk_hz // divider, -(-clk_hz // 65535), 1)}


def tables(files: bool = True, overlay: bool = True, most: int = ADDRESSES) -> Group:
    """The tables of a bank: base + count within the addresses, files within 65536 records, something there at all.

    `most`: the largest count unless `large` sets are asked for.
    """

    def group(rng: Random, large: bool) -> dict[str, object]:
        top = ADDRESSES if large else most
        out: dict[str, object] = {}
        for name in ("COIL", "DISCRETE", "INPUT", "HOLDING"):
            count = pick(rng, 0, min(top, rng.choice((64, 600, ADDRESSES))))
            out[f"{name}_COUNT"] = count
            out[f"{name}_BASE"] = rng.choice((0, ADDRESSES - count, pick(rng, 0, ADDRESSES - count)))
        count = rng.choice((0, pick(rng, 0, ADDRESSES)))
        out["READ_ONLY_COUNT"] = count
        out["READ_ONLY_BASE"] = rng.choice((0, ADDRESSES - count, pick(rng, 0, ADDRESSES - count)))
        if files and rng.random() < 0.5:
            records = pick(rng, 1, 10000)
            out |= {"FILE_RECORDS": records, "FILE_COUNT": pick(rng, 0, min(65535, ADDRESSES // records))}
        if overlay and rng.random() < 0.3:
            out |= {"OVERLAY": 1, "HOLDING_BASE": 0, "HOLDING_COUNT": max(1, int(out["HOLDING_COUNT"]))}
        if not any(v for k, v in out.items() if k.endswith("_COUNT") and k != "READ_ONLY_COUNT"):
            out["HOLDING_COUNT"] = 1
            out["HOLDING_BASE"] = min(int(out["HOLDING_BASE"]), ADDRESSES - 1)
        return out

    return group


def places(rng: Random, large: bool) -> dict[str, object]:
    """Where the tables are on an AXI4-Lite bus: multiples of 4."""
    names = ("COIL_AT", "DISCRETE_AT", "INPUT_AT", "HOLDING_AT", "FILE_AT")
    return {name: f"32'h{pick(rng, 0, 0x3FFFFFFF) * 4:08X}" for name in names if rng.random() < 0.5}


def meter(rng: Random, large: bool) -> dict[str, object]:
    """A PDM meter: SETTING_COUNT from 1, with MEASURED_COUNT up to 65536."""
    setting = pick(rng, 1, rng.choice((300, ADDRESSES)))
    bits = 3000 if not large else ADDRESSES
    return {
        "SETTING_COUNT": setting,
        "MEASURED_COUNT": pick(rng, 0, min(ADDRESSES - setting, rng.choice((300, ADDRESSES)))),
        "DI_COUNT": pick(rng, 0, rng.choice((40, bits))),
        "DO_COUNT": pick(rng, 0, rng.choice((40, bits))),
        "EVENT_RECORD": rng.choice((0, 1)),
        "EVENT_DEPTH": 1 << rng.randint(2, 10),
    }


# Flip-flops cost a linter more than memory: the flat vectors stay moderate unless large sets are asked for.
IO_TABLES = tables(files=False, overlay=False, most=1500)
READ_BACK = plain(READ_BACK_RAM=(0, 1))
HOST_MAP_SWITCHES = ("HOST_MAP", "HOST_SETTINGS", "BIT_FRACTIONS", "ASCII_MODE", "LINE_HEALTH")
SPACE: dict[str, list[Group]] = {
    "modbus_rtu_core": [clock, codes, LIMITS],
    "modbus_rtu_slave": [
        plain(HOST_MAP=(0, 1), HOST_SETTINGS=(0, 1), LINE_HEALTH=(0, 1)),
        *(settings, codes, LIMITS, tables()),
    ],
    "modbus_rtu_slave_io": [settings, codes, LIMITS, IO_TABLES, READ_BACK],
    "modbus_bank_guard": [tables()],
    "modbus_bank_ram": [tables()],
    "modbus_bank_io": [IO_TABLES, READ_BACK],
    "modbus_host_map": [plain(**dict.fromkeys(HOST_MAP_SWITCHES, (0, 1)))],
    "modbus_axil_master": [places, tables(overlay=False), plain(GUARD=(0, 1))],
    "modbus_axil_slave": [plain(HOLD=(0, 1))],
    "modbus_example_ram": [plain(WORDS=(2, 65536))],
    "modbus_example_soc_axil": [plain(WORDS=(2, 65536))],
    "modbus_example_soc_wb": [plain(WORDS=(2, 65536))],
    "modbus_example_user": [plain(WORK_CLOCKS=(2, 16777215))],
    "modbus_pdm_record": [plain(DEPTH=[1 << n for n in range(2, 11)])],
    "modbus_pdm_meter": [meter],
}


def draw(module: str, rng: Random, large: bool = False) -> dict[str, str]:
    """A random legal parameter set of a module of SPACE."""
    out: dict[str, object] = {}
    for group in SPACE[module]:
        out |= group(rng, large)
    return {name: str(value) for name, value in out.items()}


def memory(parameters: dict[str, str]) -> int:
    """Roughly the items that a set asks for: who unrolls them all may want to leave it out."""
    others = ("READ_ONLY_COUNT", "FILE_COUNT")
    counts = [int(v) for k, v in parameters.items() if k.endswith("_COUNT") and k not in others]
    files = int(parameters.get("FILE_COUNT", 0)) * int(parameters.get("FILE_RECORDS", 256))
    return sum(counts) + files + 2 * int(parameters.get("WORDS", 0))
