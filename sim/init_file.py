# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""INIT of `make serve`: what the live device holds, shows and is, checked. The format is in README.md beside this file.

Standard library only, and nothing of tb/: the device starts without a virtual environment, and quickly. What is
said twice so (the reference map, widths of parameters) is compared by tb/live.
"""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

# Table: space on the bus, parameter prefix, items in the reference map, range of values
TABLES = {
    "coils": (0, "COIL", 1024, range(2)),
    "discretes": (1, "DISCRETE", 2048, range(2)),
    "inputs": (2, "INPUT", 1024, range(65536)),
    "holdings": (3, "HOLDING", 2048, range(65536)),
}
FILES, FILES_SPACE = (4, 256), 4  # files and records of each in the reference map
WORDS, BYTES = range(65536), range(256)

# Inputs of the core: range of values
INPUTS = {
    "exception_status": BYTES,
    "busy": range(2),
    "run_indicator": range(2),
    "failure": range(16),
    "diagnostic": range(0, 65536, 2),  # bit 0 is the core's own
}

# Identity. Objects 00 to 06 have a parameter each, the private ones share one.
OBJECTS = {
    0: "VENDOR_NAME",
    1: "PRODUCT_CODE",
    2: "REVISION",
    3: "VENDOR_URL",
    4: "PRODUCT_NAME",
    5: "MODEL_NAME",
    6: "USER_APPLICATION_NAME",
}
MANDATORY, PRIVATE = range(3), range(128, 256)
LONGEST_OBJECT = 244
SERVER_ID_BYTES, PRIVATE_BYTES, IDENTITY_BYTES = 16, 512, 2048
REPORT_BYTES = 250  # identifier and additional data of function 11: a PDU of 253 less three
CONFORMITIES = (1, 2, 3, 129, 130, 131)
WIDTHS = {  # bits
    "SERVER_ID": 128,
    "ADDITIONAL_DATA": 2000,
    "PRIVATE_OBJECTS": 8 * PRIVATE_BYTES,
    **dict.fromkeys(OBJECTS.values(), 8 * LONGEST_OBJECT),
}
DEFAULT_SERVER_ID, DEFAULT_CONFORMITY = [9], 129
DEFAULT_OBJECTS = {0: "VENDOR", 1: "PRODUCT", 2: "V1.0"}

# An event of the PDM meter: fields and their ranges; how they go to modbus_live_pdm is said there.
EVENT = {
    "group": BYTES,
    "code": BYTES,
    "closed": range(2),
    "ms": range(60000),
    "minute": range(60),
    "hour": range(24),
    "day": range(1, 32),
    "month": range(1, 13),
    "year": range(2000, 2100),
}
EVENTS, EVENT_SPACE = 32, 4


class BadVariable(Exception):
    """What to print before ending with status 2."""


@dataclass
class Layout:
    """What the device has: tables, files as (count, records), and whether it is the PDM meter."""

    tables: dict
    files: tuple = FILES
    meter: bool = False


@dataclass
class Initial:
    """INIT, checked: `items` (space, item, value) for the host port, `inputs` and `parameters` of the core."""

    items: list = field(default_factory=list)
    inputs: dict = field(default_factory=dict)
    parameters: dict = field(default_factory=dict)
    warnings: list = field(default_factory=list)


def extent(addresses):
    """A range of addresses for people."""
    return f"{addresses[0]} to {addresses[-1]}" if addresses else "no items"


def no_duplicates(pairs):
    """JSON objects in which a key stands twice are refused: one of the values would be lost."""
    keys = [key for key, _ in pairs]
    for key in keys:
        if keys.count(key) > 1:
            raise BadVariable(f'key "{key}" stands twice')
    return dict(pairs)


def is_number(value, allowed):
    """JSON true and 1.0 are no numbers of ours."""
    return isinstance(value, int) and not isinstance(value, bool) and value in allowed


def numbers(where, entry, allowed, counts):
    """A list of numbers, its length in `counts`."""
    if not isinstance(entry, list) or len(entry) not in counts:
        raise BadVariable(f"{where}: must be a list of {counts[0]} to {counts[-1]} numbers")
    for value in entry:
        if not is_number(value, allowed):
            raise BadVariable(f"{where}: {json.dumps(value)} is no number from 0 to {allowed[-1]}")
    return entry


def mapping(where, entry, shape):
    """A JSON object."""
    if not isinstance(entry, dict):
        raise BadVariable(f"{where}: must be {shape}")
    return entry.items()


def runs(where, entry, addresses, values):
    """{"start": [values]} checked against a range of addresses and of values, as (address, value)."""
    for start, run in mapping(where, entry, '{"start address": [values]}'):
        if not re.fullmatch(r"[0-9]{1,5}", start):
            raise BadVariable(f"{where}: {start!r} is no address")
        if not isinstance(run, list):
            raise BadVariable(f"{where} {start}: must be a list of values")
        for address, value in enumerate(run, int(start)):
            if address not in addresses:
                raise BadVariable(f"{where}: address {address} is outside the table ({extent(addresses)})")
            if not is_number(value, values):
                raise BadVariable(f"{where} {address}: {json.dumps(value)} is no number from 0 to {values[-1]}")
            yield address, value


def file_items(entry, files):
    """Records of files, as items of the host port."""
    count, records = files
    for file, content in mapping("files", entry, '{"file": {"first record": [values]}}'):
        if not re.fullmatch(r"[0-9]{1,5}", file) or int(file) not in range(1, count + 1):
            raise BadVariable(f"files: {file!r} is no file ({extent(range(1, count + 1))})")
        for record, value in runs(f"files {file}", content, range(records), WORDS):
            yield FILES_SPACE, (int(file) - 1) * records + record, value


def event_items(entry):
    """Events of the PDM meter, as modbus_live_pdm takes them."""
    if not isinstance(entry, list) or len(entry) > EVENTS:
        raise BadVariable(f"events: must be a list of at most {EVENTS}: more would drop the first")
    for i, event in enumerate(entry):
        if not isinstance(event, dict) or event.keys() != EVENT.keys():
            raise BadVariable(f"events {i}: must be an object with {', '.join(EVENT)}")
        for name, allowed in EVENT.items():
            if not is_number(event[name], allowed):
                raise BadVariable(f"events {i}: {name} must be a number from {allowed[0]} to {allowed[-1]}")
        e = event
        fields = [e["group"] << 8 | e["code"], e["closed"], e["ms"], e["minute"] << 8 | e["hour"]]
        fields += [e["day"] << 8 | e["month"], e["year"] - 2000]
        yield from ((EVENT_SPACE, item, value) for item, value in enumerate(fields))


def device_objects(entry):
    """{id: text} of the device identification; what is not named keeps its default."""
    found, named = dict(DEFAULT_OBJECTS), set()
    for key, text in mapping("device_id", entry, '{"object": "text"}'):
        number = int(key, 0) if re.fullmatch(r"0x[0-9A-Fa-f]{1,2}|0|[1-9][0-9]{0,2}", key) else -1
        if number not in OBJECTS and number not in PRIVATE:
            raise BadVariable(f'device_id: "{key}" is no object (0 to 6, 128 to 255 or 0x80 to 0xFF)')
        if number in named:
            raise BadVariable(f"device_id: object {number} stands twice")
        named.add(number)
        least = 0 if number in OBJECTS and number not in MANDATORY else 1
        if not isinstance(text, str) or not re.fullmatch(r"[ -~]*", text):
            raise BadVariable(f"device_id {key}: must be a text of printable ASCII characters")
        if not least <= len(text) <= LONGEST_OBJECT:
            raise BadVariable(f"device_id {key}: must have {least} to {LONGEST_OBJECT} characters")
        found[number] = text
    return {number: text for number, text in sorted(found.items()) if text}


def private(objects):
    """The private objects as PRIVATE_OBJECTS holds them."""
    return b"".join(bytes([i, len(text)]) + text.encode() for i, text in objects.items() if i in PRIVATE)


def unseen(objects, conformity):
    """A line about objects that a master cannot read at this conformity, or none."""
    level = conformity & 3
    hidden = [i for i in objects if i not in MANDATORY and (level < 2 or (i in PRIVATE and level < 3))]
    if not hidden:
        return []
    wanted = conformity | 3 if hidden[-1] in PRIVATE else (conformity & ~3) | 2
    return [f"device_id: objects {', '.join(map(str, hidden))} are not shown; they need \"conformity\": {wanted}"]


def check_size(identity, objects, conformity):
    """The memory of texts and their directory has its limits, see modbus_identity."""
    if len(private(objects)) > PRIVATE_BYTES:
        raise BadVariable(f"device_id: the private objects exceed {PRIVATE_BYTES} bytes, two for each and its text")
    level, regular = conformity & 3, sum(i in OBJECTS for i in objects)
    rows = [3, *[regular] * (level >= 2), *[len(objects)] * (level >= 3), *[len(objects)] * (conformity >> 7)]
    size = 9 + identity + 9 * sum(row + 1 for row in rows) + sum(2 + len(text) for text in objects.values())
    if size > IDENTITY_BYTES:
        raise BadVariable(f"device_id: texts and their directory need {size} bytes, {IDENTITY_BYTES} is the limit")


def identity(document):
    """Parameters of the core for the identity keys, without those that are as by default."""
    server = numbers("server_id", document.get("server_id", [9]), BYTES, range(1, SERVER_ID_BYTES + 1))
    room = REPORT_BYTES - len(server)
    more = numbers("additional_data", document.get("additional_data", []), BYTES, range(room + 1))
    conformity = document.get("conformity", DEFAULT_CONFORMITY)
    if not is_number(conformity, CONFORMITIES):
        raise BadVariable(f"conformity: must be one of {', '.join(map(str, CONFORMITIES))}")
    objects = device_objects(document.get("device_id", {}))
    check_size(len(server) + len(more), objects, conformity)
    out = {}
    if server != DEFAULT_SERVER_ID:
        out |= {"SERVER_ID": bytes(server), "SERVER_ID_BYTES": len(server)}
    if more:
        out |= {"ADDITIONAL_DATA": bytes(more), "ADDITIONAL_DATA_BYTES": len(more)}
    if conformity != DEFAULT_CONFORMITY:
        out["CONFORMITY"] = conformity
    out |= {OBJECTS[i]: objects.get(i, "").encode() for i in OBJECTS if objects.get(i) != DEFAULT_OBJECTS.get(i)}
    if private(objects):
        out["PRIVATE_OBJECTS"] = private(objects)
    return {name: wide(name, value) if name in WIDTHS else value for name, value in out.items()}


def wide(name, value):
    """Bytes as Verilator takes a parameter that holds them right-justified."""
    return f"{WIDTHS[name]}'h{value.hex() or 0}"


def load(path, layout):
    """The file as Initial. Raises BadVariable."""
    try:
        document = json.loads(Path(path).read_bytes(), object_pairs_hook=no_duplicates)
    except OSError as error:
        raise BadVariable(error.strerror) from None
    except (ValueError, RecursionError) as error:
        raise BadVariable(f"not JSON: {error}") from None
    if not isinstance(document, dict):
        raise BadVariable("must be a JSON object")

    identities = ("server_id", "additional_data", "device_id", "conformity")
    of_slave = {"inputs", "files", *identities, *INPUTS} - {"busy"}
    known = {*TABLES, "files", *identities, *INPUTS, "events"}
    for key in document:
        if key not in known:
            raise BadVariable(f'unknown key "{key}"')
        if layout.meter and key == "coils":
            raise BadVariable("coils: the relays of the PDM meter are open until a master closes them")
        if layout.meter and key in of_slave:
            raise BadVariable(f"{key}: the PDM meter has none")
        if key == "events" and not layout.meter:
            raise BadVariable("events: only the PDM meter (DEVICE=pdm) has them")

    out = Initial()
    for key, entry in document.items():
        if key in TABLES:
            space, values = TABLES[key][0], TABLES[key][3]
            out.items += [(space, *item) for item in runs(key, entry, layout.tables[key], values)]
        elif key == "files":
            out.items += file_items(entry, layout.files)
        elif key == "events":
            out.items += event_items(entry)
        elif key in INPUTS:
            if not is_number(entry, INPUTS[key]):
                even = ", bit 0 being 0" if INPUTS[key].step > 1 else ""
                raise BadVariable(f"{key}: must be a number from 0 to {INPUTS[key][-1]}{even}")
            out.inputs[key] = entry
    if not layout.meter:
        out.parameters = identity(document)
        conformity = document.get("conformity", DEFAULT_CONFORMITY)
        out.warnings = unseen(device_objects(document.get("device_id", {})), conformity)
    return out
