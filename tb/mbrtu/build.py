# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Parameters of the RTL in model terms, with the defaults of the three tops."""

from .defs import (
    ALL_FUNCTIONS,
    FUNCTIONS,
    T15_CHARACTERS,
    T15_FLOOR_US,
    T35_CHARACTERS,
    T35_FLOOR_US,
    Limits,
    Space,
    reference_map,
)
from .model import REGISTER_BITS, Config

PREFIX = {
    Space.COILS: "COIL",
    Space.DISCRETES: "DISCRETE",
    Space.INPUTS: "INPUT",
    Space.HOLDINGS: "HOLDING",
}
LIMIT_PARAMETERS = {
    "MAX_READ_BITS": "read_bits",
    "MAX_WRITE_BITS": "write_bits",
    "MAX_READ_REGISTERS": "read_registers",
    "MAX_WRITE_REGISTERS": "write_registers",
    "RW_MAX_READ": "rw_read",
    "RW_MAX_WRITE": "rw_write",
}
DEFAULT_COUNTS = {
    "modbus_rtu_slave": dict.fromkeys(PREFIX, 64),
    "modbus_rtu_slave_io": {
        Space.COILS: 16,
        Space.DISCRETES: 16,
        Space.INPUTS: 8,
        Space.HOLDINGS: 8,
    },
}
DEFAULT_CLK_HZ = 50_000_000


def function_mask(functions):
    """FUNCTION_CODES for a set of function codes."""
    return sum(1 << code for code in functions)


def table_parameters(tables):
    """{parameter: value} for {space: (base, count)}."""
    out = {}
    for space, (base, count) in tables.items():
        out[f"{PREFIX[space]}_BASE"] = base
        out[f"{PREFIX[space]}_COUNT"] = count
    return out


REFERENCE = table_parameters(reference_map())
NO_FLOORS = {"T15_MIN_US": 0, "T35_MIN_US": 0}


def model_config(top, parameters, **changes):
    """The model's Config of `top` built with `parameters`."""
    counts = DEFAULT_COUNTS.get(top, {s: n for s, (_, n) in reference_map().items()})
    tables = {
        space: (
            parameters.get(f"{prefix}_BASE", 0),
            parameters.get(f"{prefix}_COUNT", counts[space]),
        )
        for space, prefix in PREFIX.items()
    }
    mask = parameters.get("FUNCTION_CODES", function_mask(ALL_FUNCTIONS))
    overlay = bool(parameters.get("OVERLAY", 0))
    if overlay:
        _, registers = tables[Space.HOLDINGS]
        for space in (Space.COILS, Space.DISCRETES):
            tables[space] = (tables[space][0], min(65536, registers * REGISTER_BITS))
        tables[Space.INPUTS] = (tables[Space.INPUTS][0], registers)
    limits = {f: parameters[p] for p, f in LIMIT_PARAMETERS.items() if p in parameters}
    return Config(
        tables=tables,
        functions=frozenset(code for code in FUNCTIONS if mask >> code & 1),
        limits=Limits(**limits),
        read_only=(parameters.get("READ_ONLY_BASE", 0), parameters.get("READ_ONLY_COUNT", 0)),
        overlay=overlay,
        **changes,
    )


def silences(parameters, fmt, bit_time):
    """(t1.5, t3.5) in clock cycles: the later of the character times and the floors."""
    clk_hz = parameters.get("CLK_HZ", DEFAULT_CLK_HZ)
    character = fmt.length * bit_time
    floors = (
        parameters.get("T15_MIN_US", T15_FLOOR_US) * clk_hz / 1e6,
        parameters.get("T35_MIN_US", T35_FLOOR_US) * clk_hz / 1e6,
    )
    return (
        max(T15_CHARACTERS * character, floors[0]),
        max(T35_CHARACTERS * character, floors[1]),
    )
