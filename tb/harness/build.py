# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Parameters of the RTL in model terms, with the defaults of the three tops.

Values are integers throughout, texts too (first byte highest), so that they pass through JSON and
every simulator; `for_simulator` writes them the way a simulator's command line wants them.
"""

from protocol.defs import (
    ADDRESSES,
    ALL_FUNCTIONS,
    ASCII_TIMEOUT_MS,
    DEFAULT_OBJECTS,
    FIRST_PRIVATE_OBJECT,
    FUNCTIONS,
    LONGEST_OBJECT,
    REFERENCE_FILES,
    T15_CHARACTERS,
    T15_FLOOR_US,
    T35_CHARACTERS,
    T35_FLOOR_US,
    Limits,
    Space,
    reference_map,
)
from protocol.model import REGISTER_BITS, Config

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
    "slave_bench": dict.fromkeys(PREFIX, 64),
    "io_bench": {
        Space.COILS: 16,
        Space.DISCRETES: 16,
        Space.INPUTS: 8,
        Space.HOLDINGS: 8,
    },
}
DROP_IN_BENCH = {"modbus_rtu_slave": "slave_bench", "modbus_rtu_slave_io": "io_bench"}  # the same tables
DEFAULT_FILES = {"slave_bench": (0, 256), "io_bench": (0, 256)}
NO_FILES = ("io_bench",)  # tops that never have files
OBJECT_PARAMETERS = {
    0: "VENDOR_NAME",
    1: "PRODUCT_CODE",
    2: "REVISION",
    3: "VENDOR_URL",
    4: "PRODUCT_NAME",
    5: "MODEL_NAME",
    6: "USER_APPLICATION_NAME",
}
HOST_UNITS = range(0xC0, 0xD0)  # core_bench.v: the units that the host takes with UNIT_PORT = 1
WIDTHS = {  # bits of the parameters that are no plain integers
    "UNIT_SET": 248,
    "FUNCTION_CODES": 128,
    "USER_CODES": 128,
    "SERVER_ID": 8 * 16,
    "ADDITIONAL_DATA": 8 * 250,
    **dict.fromkeys(OBJECT_PARAMETERS.values(), 8 * LONGEST_OBJECT),
    "PRIVATE_OBJECTS": 4096,
    "CONFORMITY": 8,
}
MANDATORY = (0, 1, 2)  # objects that are there even if empty
INTEGER_BITS = 31  # what every tool takes as a plain decimal
DEFAULT_CLK_HZ = 50_000_000


def function_mask(functions):
    """FUNCTION_CODES or USER_CODES for a set of function codes."""
    return sum(1 << int(code) for code in set(functions))


def functions_of(mask, limit=128):
    """The function codes of a mask."""
    return frozenset(code for code in range(1, limit) if mask >> code & 1)


def table_parameters(tables):
    """{parameter: value} for {space: (base, count)}."""
    out = {}
    for space, (base, count) in tables.items():
        out[f"{PREFIX[space]}_BASE"] = base
        out[f"{PREFIX[space]}_COUNT"] = count
    return out


def file_parameters(files):
    """{parameter: value} for (files, records of each)."""
    return {"FILE_COUNT": files[0], "FILE_RECORDS": files[1]}


REFERENCE = {**table_parameters(reference_map()), **file_parameters(REFERENCE_FILES)}
NO_FLOORS = {"T15_MIN_US": 0, "T35_MIN_US": 0}


def text_value(data):
    """Bytes as the integer that a right-justified vector parameter holds."""
    return int.from_bytes(data, "big")


def _bytes_of(value, size=None):
    """The bytes of a parameter given as an integer, a sized literal, a text or bytes."""
    if isinstance(value, str) and "'h" in value:
        value = int(value.split("'h")[1].replace("_", ""), 16)
    if isinstance(value, str):
        value = value.strip('"').encode("latin-1")
    if isinstance(value, int):
        value = value.to_bytes((value.bit_length() + 7) // 8, "big")
    return bytes(value) if size is None else bytes(value).rjust(size, b"\0")[-size or len(value) :]


def _number(value):
    """A parameter's number, given as one or as a literal."""
    return value if isinstance(value, int) else int.from_bytes(_bytes_of(value), "big")


def identity_parameters(server_id=None, additional_data=None, objects=None, conformity=None, device_id_limit=None):
    """{parameter: integer} for what is given, in the terms of Config."""
    out = {}
    if server_id is not None:
        out |= {"SERVER_ID": text_value(server_id), "SERVER_ID_BYTES": len(server_id)}
    if additional_data is not None:
        out |= {"ADDITIONAL_DATA": text_value(additional_data), "ADDITIONAL_DATA_BYTES": len(additional_data)}
    if objects is not None:
        out |= {name: text_value(objects.get(i, b"")) for i, name in OBJECT_PARAMETERS.items()}
        private = sorted(i for i in objects if i >= FIRST_PRIVATE_OBJECT)
        out["PRIVATE_OBJECTS"] = text_value(b"".join(bytes([i, len(objects[i])]) + objects[i] for i in private))
    if conformity is not None:
        out["CONFORMITY"] = conformity
    if device_id_limit is not None:
        out["DEVICE_ID_LIMIT"] = device_id_limit
    return out


def config_parameters(items):
    """{parameter: integer} for {field of Config: value}: what a build needs; `limits` as a Limits or a dict."""
    items = dict(items)
    limits, out = items.pop("limits", {}), {}
    limits = limits if isinstance(limits, dict) else vars(limits)
    out |= {p: limits[f] for p, f in LIMIT_PARAMETERS.items() if f in limits}
    for field, convert in (
        ("tables", table_parameters),
        ("files", file_parameters),
        ("functions", lambda codes: {"FUNCTION_CODES": function_mask(codes)}),
        ("user_codes", lambda codes: {"USER_CODES": function_mask(codes)}),
        ("read_only", lambda span: {"READ_ONLY_BASE": span[0], "READ_ONLY_COUNT": span[1]}),
        ("overlay", lambda on: {"OVERLAY": int(on)}),
        ("units", lambda units: {"UNIT_SET": sum(1 << unit for unit in units)}),
    ):
        if field in items:
            out |= convert(items.pop(field))
    return out | identity_parameters(**items)


def for_simulator(sim, parameters):
    """`parameters` as `sim` ("icarus" or "verilator") takes them: Verilator wants wide ones as sized hex."""
    if sim != "verilator":
        return dict(parameters)
    return {
        name: f"{WIDTHS[name]}'h{value:x}"
        if isinstance(value, int) and name in WIDTHS and value.bit_length() > INTEGER_BITS
        else value
        for name, value in parameters.items()
    }


def identity_fields(parameters):
    """{field of Config: value} of the identity parameters, with the RTL's defaults."""
    objects = {}
    for number, name in OBJECT_PARAMETERS.items():
        value = _bytes_of(parameters[name]) if name in parameters else DEFAULT_OBJECTS.get(number, b"")
        if value or number in MANDATORY:
            objects[number] = value
    private = _bytes_of(parameters.get("PRIVATE_OBJECTS", 0))
    while private:
        number, size = private[:2]
        objects[number], private = private[2 : 2 + size], private[2 + size :]
    plain = {"CONFORMITY": "conformity", "DEVICE_ID_LIMIT": "device_id_limit"}
    return {
        "server_id": _bytes_of(parameters.get("SERVER_ID", 9), parameters.get("SERVER_ID_BYTES", 1)),
        "additional_data": _bytes_of(parameters.get("ADDITIONAL_DATA", 0), parameters.get("ADDITIONAL_DATA_BYTES", 0)),
        "objects": objects,
        **{field: _number(parameters[name]) for name, field in plain.items() if name in parameters},
    }


def units_of(parameters):
    """The further addresses: of UNIT_SET, and those that the benches' host takes with UNIT_PORT = 1."""
    units = {unit for unit in range(1, 248) if _number(parameters.get("UNIT_SET", 0)) >> unit & 1}
    return frozenset(units | (set(HOST_UNITS) if parameters.get("UNIT_PORT") else set()))


def model_config(top, parameters, **changes):
    """The model's Config of `top` built with `parameters`."""
    top = DROP_IN_BENCH.get(top, top)
    counts = DEFAULT_COUNTS.get(top, {s: n for s, (_, n) in reference_map().items()})
    tables = {
        space: (
            parameters.get(f"{prefix}_BASE", 0),
            parameters.get(f"{prefix}_COUNT", counts[space]),
        )
        for space, prefix in PREFIX.items()
    }
    mask = _number(parameters.get("FUNCTION_CODES", function_mask(ALL_FUNCTIONS)))
    overlay = bool(parameters.get("OVERLAY", 0))
    if overlay:
        _, registers = tables[Space.HOLDINGS]
        for space in (Space.COILS, Space.DISCRETES):
            tables[space] = (tables[space][0], min(ADDRESSES, registers * REGISTER_BITS))
        tables[Space.INPUTS] = (tables[Space.INPUTS][0], registers)
    limits = {f: parameters[p] for p, f in LIMIT_PARAMETERS.items() if p in parameters}
    files = DEFAULT_FILES.get(top, REFERENCE_FILES)
    if top not in NO_FILES:
        files = tuple(parameters.get(name, value) for name, value in file_parameters(files).items())
    fields = {
        "tables": tables,
        "functions": frozenset(code for code in FUNCTIONS if mask >> code & 1),
        "limits": Limits(**limits),
        "read_only": (parameters.get("READ_ONLY_BASE", 0), parameters.get("READ_ONLY_COUNT", 0)),
        "overlay": overlay,
        "units": units_of(parameters),
        "files": files,
        "user_codes": functions_of(_number(parameters.get("USER_CODES", 0))),
        **identity_fields(parameters),
    }
    return Config(**fields | changes)


def ascii_timeout(parameters, extra=0):
    """The time-out of ASCII mode in clock cycles; the device is late by less than a tick (see modbus_line.v)."""
    clk_hz = parameters.get("CLK_HZ", DEFAULT_CLK_HZ)
    return clk_hz * parameters.get("ASCII_TIMEOUT_MS", ASCII_TIMEOUT_MS) / 1000 * (1 + extra)


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
