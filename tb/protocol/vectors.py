# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The printed examples of tb/protocol/vectors.json, chosen and turned into model terms."""

import json
from functools import cache
from pathlib import Path

from .defs import ALL_FUNCTIONS, EX, EXCEPTION_FLAG, REFERENCE_FILES, Limits, Space
from .memory import Config

PATH = Path(__file__).resolve().parent / "vectors.json"

SPACE_OF_TABLE = {
    "coils": Space.COILS,
    "discrete_inputs": Space.DISCRETES,
    "input_registers": Space.INPUTS,
    "holding_registers": Space.HOLDINGS,
    "file": Space.FILES,
}
LIMIT_OF_CONFIG = {"max_read_regs": "read_registers", "max_write_regs": "write_registers"}
DEVICE_ID_LIMIT, PDM_RECORD = "devid_pdu_limit", "pdm_event_record"
INPUTS = ("exception_status", "busy", "run_indicator")  # one value each, inputs of the core
INSIDE = ("diagnostic_register", "listen_only", "ascii_delimiter")  # one value each, held by the core


@cache
def document():
    """The whole file."""
    return json.loads(PATH.read_text(encoding="utf-8"))


def contents(entries, records=REFERENCE_FILES[1]):
    """[((space, address), value), ...] of the memory in a list of pre- or postconditions.

    Records of files have the item number of Config.record_item, with `records` in a file.
    """
    out = []
    for entry in entries:
        if entry["table"] not in SPACE_OF_TABLE:
            continue
        space, first = SPACE_OF_TABLE[entry["table"]], entry["address"]
        if space == Space.FILES:
            first += (entry["file"] - 1) * records
        out += [((space, first + i), value) for i, value in enumerate(entry["values"])]
    return out


def state(entries):
    """{name: value} of all that is neither memory nor built in.

    Names of INPUTS and INSIDE, `counters` ({name: value}), `event_log` (newest first).
    """
    out = {}
    for entry in entries:
        table, values = entry["table"], entry["values"]
        if table in INPUTS or table in INSIDE:
            out[table] = values[0]
        elif table in ("counters", "event_log"):
            out[table] = values
    return out


def build_items(vector):
    """{field of Config: value} that the device of a vector must be built with, beyond the defaults.

    A later step of a sequence is built as its first.
    """
    first = next(s for s in sequences() if any(v["id"] == vector["id"] for v in s))[0]
    out = {}
    for entry in first["preconditions"]:
        table, values = entry["table"], entry["values"]
        if table in ("server_id", "additional_data"):
            out[table] = bytes(values)
        elif table == "conformity":
            out["conformity"] = values[0]
        elif table == "device_id":
            kept = {} if entry.get("clear") else dict(Config().objects)
            out["objects"] = kept | {entry["address"] + i: v.encode() for i, v in enumerate(values)}
    if DEVICE_ID_LIMIT in first["config"]:
        out["device_id_limit"] = first["config"][DEVICE_ID_LIMIT]
    if limits(first):
        out["limits"] = Limits(**limits(first))
    return {name: value for name, value in out.items() if value != getattr(Config(), name)}


def config(vector):
    """The model's Config for a vector."""
    return Config(address=vector["slave_address"], **build_items(vector))


def prepare(slave, vector):
    """Give a model slave what the vector presumes."""
    for key, value in contents(vector["preconditions"], slave.config.files[1]):
        slave.memory[key] = value
    for name, value in state(vector["preconditions"]).items():
        if name == "counters":
            slave.counters.update(value)
        elif name == "event_log":
            slave.log = value
        else:
            setattr(slave, name, value)


def differences(slave, vector):
    """What a model slave holds otherwise than the vector says afterwards, as texts."""
    out = []

    def compare(what, wanted, held):
        if wanted != held:
            out.append(f"{what}: printed {wanted}, held {held}")

    for key, value in contents(vector["postconditions"], slave.config.files[1]):
        compare(key, value, slave.memory[key])
    for name, value in state(vector["postconditions"]).items():
        compare(name, value, getattr(slave, name))
    if counters(vector) is not None:
        compare("counters", counters(vector), dict(slave.counters))
    if event_log(vector) is not None:
        compare("event log", event_log(vector), list(slave.log))
    return out


def counters(vector):
    """{name: value} of all nine afterwards, None if the vector does not say."""
    return vector.get("post_counters")


def event_log(vector):
    """The log afterwards, newest first; None if the vector does not say."""
    said = vector.get("post_event_log")
    return None if said is None else list(bytes.fromhex(said))


def needs_backdoor(vector):
    """True if counters or log must be loaded inside the device."""
    return bool({"counters", "event_log"} & state(vector["preconditions"]).keys())


def repeat(vector):
    """How often the request is sent."""
    return vector.get("repeat", 1)


def frame(text):
    """Bytes of a hex field; None for silence."""
    return None if text is None else bytes.fromhex(text)


def limits(vector):
    """The limits that a vector needs built differently, {field of Limits: value}."""
    return {LIMIT_OF_CONFIG[k]: v for k, v in vector["config"].items() if k in LIMIT_OF_CONFIG}


def _needs_pdm(vector):
    return PDM_RECORD in vector["config"] or any(e["table"] == PDM_RECORD for e in vector["preconditions"])


def _belongs(vector, functions):
    """True if a slave with `functions` plays it: its function, its exception 01, or a bad frame."""
    request = frame(vector["request"])
    answer = frame(vector.get("expected_response_pdu"))
    unsupported = answer is not None and answer[0] & EXCEPTION_FLAG and answer[1] == EX.FUNCTION
    return request[1] in functions or unsupported or not vector["request_check_ok"]


def playable(functions=ALL_FUNCTIONS):
    """RTU vectors of a slave with `functions`, those about bad frames included; without pdm()."""
    return [
        v
        for v in document()["vectors"]
        if v["mode"] == "rtu" and v["playable"] and not _needs_pdm(v) and _belongs(v, functions)
    ]


def pdm():
    """The vectors that need the PDM meter's event record."""
    return [v for v in document()["vectors"] if v["mode"] == "rtu" and v["playable"] and _needs_pdm(v)]


def in_ascii():
    """The vectors of ASCII mode."""
    return [v for v in document()["vectors"] if v["mode"] == "ascii" and v["playable"]]


def pdm_record(vector):
    """The twelve bytes of the event record that a vector of pdm() presumes."""
    return next(bytes(e["values"]) for e in vector["preconditions"] if e["table"] == PDM_RECORD)


def unplayable(functions=ALL_FUNCTIONS):
    """[(vector, reason), ...] of all others."""
    played = {v["id"] for v in playable(functions) + pdm() + in_ascii()}
    out = []
    for vector in document()["vectors"]:
        if vector["id"] in played:
            continue
        if not vector["playable"]:
            reason = vector["notes"]
        else:
            reason = "function left out"
        out.append((vector, reason))
    return out


@cache
def sequences():
    """[[vector, ...], ...]: what is played in one go after reset, without reset in between."""
    out, named = [], {}
    for vector in document()["vectors"]:
        sequence = vector.get("sequence")
        if sequence is None:
            out.append([vector])
        elif sequence["name"] in named:
            named[sequence["name"]].append(vector)
        else:
            out.append(named.setdefault(sequence["name"], [vector]))
    for steps in named.values():
        steps.sort(key=lambda v: v["sequence"]["step"])
    return out


def before(vector):
    """The earlier steps of a vector's sequence, in order; they must have been played."""
    steps = next(s for s in sequences() if any(v["id"] == vector["id"] for v in s))
    return steps[: next(i for i, v in enumerate(steps) if v["id"] == vector["id"])]
