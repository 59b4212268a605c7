# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make serve MAP=device.yaml`: the reference maps behind real masters, INIT by name, and what is refused."""

import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys

import minimalmodbus
import pytest
from live.serve import ROOT, Port, Serve, refuse, request
from modbus_map import checks, live_values, loader
from modbus_map.model import READ_FUNCTION, TABLES
from modbus_map.outputs import live
from protocol import frames
from protocol.defs import FC
from pymodbus.client import ModbusSerialClient

from map.test_client import module

MAPS = {name: ROOT / "examples" / name / f"{name}.yaml" for name in ("relay_box", "drive", "pdm_map", "energy_meter")}
DEVICES = {name: checks.load_device(path)[0] for name, path in MAPS.items()}
ADDRESS_ERROR, VALUE_ERROR = 2, 3
INIT = {
    "relay_box": {"temperature": -12.5, "door_open": True},
    "drive": {
        "ready": 1,
        "digital_in": [1, 0, 1, 1],
        "state": "running",
        "status_word": {"ready": 1, "mode": 2, "warning": 1},
        "speed": 1450.5,
        "dc_voltage": 560.2,
        "heatsink": -4.5,
        "power": -1500,
        "energy": 2**40 + 7,
        "run_time": 70000,
        "fault_code": 3,
        "fault_history": {"1": [4, 3], "4": 1},
    },
    "energy_meter": {
        "serial_number": "EM3-000042",
        "current_a": -12.34,
        "voltage_ln": 230.1,
        "frequency": 49.98,
        "power": -15000,
        "exported": 2**31 * 100,
        "var_exported_q4_c": 123400,
        "events": {"over_voltage": 1},
    },
    "pdm_map": {"di": [1, 0, 0, 1], "setting": {"0": 17, "254": [2, 3]}, "ua": 229.98, "measured_more": {"230": 65535}},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where links, INIT files and maps of this module live."""
    return tmp_path_factory.mktemp("live_map")


@pytest.fixture(scope="module", params=INIT)
def served(request, folder):
    """(device of the map, running live device)."""
    name = request.param
    init = folder / f"{name}.json"
    init.write_text(json.dumps(INIT[name], indent="\t"), encoding="utf-8")
    with Serve(folder / name, MAP=MAPS[name], INIT=init) as running:
        yield DEVICES[name], running


def serial_client(device, running):
    """A connected pymodbus client at the map's rate."""
    found = ModbusSerialClient(str(running.link), baudrate=device.line.baud, parity="N", timeout=3)
    assert found.connect()
    return found


def read(port, device, point):
    """The raw values of a point as the master reads them, or the exception code."""
    raws = []
    for item in range(point.count):
        at = point.addresses(item)
        frame = request(frames.read(READ_FUNCTION[point.table], at[0], len(at)), device.line.address)
        size = 1 if point.is_bit else 2 * len(at)
        answer = port.ask(frame, bytes(5))
        if not answer[1] & 0x80:
            answer += port.read(5, 5 + size - len(answer))
        assert frames.check(answer), f"{point.name}: {answer.hex()}"
        if answer[1] & 0x80:
            return answer[2]
        data = answer[3:-2]
        words = [data[0] & 1] if point.is_bit else list(struct.unpack(f">{len(at)}H", data))
        raws.append(point.join(words))
    return raws


def write(port, device, point, raws):
    """0 or the exception code of writing all items of a point, in one request where the map has one for it."""
    words = [word for raw in raws for word in point.registers(raw)]
    if not point.is_bit:
        pdus = [frames.write_registers(point.at, words)]
    elif device.has_function(FC.WRITE_COILS):
        pdus = [frames.write_coils(point.at, words)]
    else:
        pdus = [frames.write_coil(point.at + n, word) for n, word in enumerate(words)]
    code = 0
    for pdu in pdus:
        answer = port.ask(request(pdu, device.line.address), bytes(5))
        if not answer[1] & 0x80:
            answer += port.read(5, 8 - len(answer))
        assert frames.check(answer), f"{point.name}: {answer.hex()}"
        code = code or (answer[2] if answer[1] & 0x80 else 0)
    return code


def begins_with(device, point, init, taken=()):
    """The raw values of a point of the served device, from INIT as the model reads it, until they are written.

    `taken`: the coils that have taken their snapshot.
    """
    source = loader.parse(json.dumps(init), "init.json")
    words = {(space, item): value for space, item, value in live_values.initial(device, source)}
    if point.freeze and point.freeze not in taken:
        return [0] * point.count
    if point.kind == "memory":
        space = 2 if point.table == "input_registers" else 3
        resets = [w for raw in point.resets for w in point.registers(raw)]
        found = [words.get((space, point.at + n), reset) for n, reset in enumerate(resets)]
        return [point.join(found[n : n + point.width]) for n in range(0, len(found), point.width)]
    if point.kind == "wire":
        return wired(device, point, words)
    return list(point.resets)


def wired(device, point, words):
    """The raw values of an input in INIT's words."""
    vector = sum(
        words.get((live.INPUTS_SPACE, item), 0) << 16 * n for n, item in enumerate(live.input_words(device)[point.name])
    )
    return [vector >> point.bits * item & (1 << point.bits) - 1 for item in range(point.count)]


def sampled(point):
    """A value of each item that may be written and is not the reset; None without one."""
    for number in (1, 0, 2, 0.5, 15, "x"):
        try:
            raw = point.raw(number)
        except (ValueError, TypeError):
            continue
        if point.accepts(raw) and raw not in point.resets:
            return raw
    others = (point.minimum, point.maximum, *(item.raw for item in point.enum))
    return next((raw for raw in others if raw is not None and raw not in point.resets), None)


def refused_value(point):
    """A value outside the limits, or None."""
    numbers = [] if point.maximum is None else [point.number(point.maximum) + 1]
    numbers += [] if point.minimum is None else [point.number(point.minimum) - 1]
    numbers += [max(item.number for item in point.enum) + 1] if point.enum else []
    for number in numbers:
        try:
            raw = point.raw(number)
        except ValueError:
            continue
        if not point.accepts(raw):
            return raw
    return None


def test_every_point_is_read_written_and_refused(served):
    """Reads begin with reset values and INIT; limits answer 03 and change nothing; rights answer 02."""
    device, running = served
    with Port(running.link) as port:
        points = [point for point in device.points if point.size <= 16]  # longer ones: test_values_of_init
        for point in points:
            first = begins_with(device, point, INIT[device.name])
            assert read(port, device, point) == (first if point.readable else ADDRESS_ERROR), point.name
        taken = set()
        for point in points:
            if point.table not in ("coils", "holding_registers"):
                continue
            first = begins_with(device, point, INIT[device.name], taken)
            new = sampled(point)
            assert new is not None, point.name
            if not point.writable:
                assert write(port, device, point, [new] * point.count) == ADDRESS_ERROR, point.name
                assert read(port, device, point) == first, point.name
                continue
            assert write(port, device, point, [new] * point.count) == 0, point.name
            taken |= {point.name} if new else set()
            if point.readable:
                assert read(port, device, point) == [new] * point.count, point.name
            wrong = refused_value(point)
            if wrong is not None:
                assert write(port, device, point, [wrong] * point.count) == VALUE_ERROR, point.name
                assert read(port, device, point) == [new] * point.count, point.name
            assert write(port, device, point, list(point.resets)) == 0, point.name


def test_values_of_init(served, tmp_path):
    """The client that is made of the same map reads what INIT says."""
    device, running = served
    made = getattr(module(tmp_path, device), "".join(part.capitalize() for part in device.name.split("_")))
    connection = serial_client(device, running)
    try:
        slave = made(connection, device.line.address)
        if device.name == "relay_box":
            assert (slave.temperature, slave.door_open, slave.limit) == (-12.5, True, 45)
            slave.limit = 80
            assert slave.limit == 80
            slave.relay = (True, False, False, True)
            assert slave.relay == (True, False, False, True)
        elif device.name == "drive":
            slave.take_snapshot = True
            assert slave.digital_in == (True, False, True, True)
            assert (slave.speed, slave.power, slave.dc_voltage) == (1450.5, -1500, 560.2)
            assert (slave.energy, slave.heatsink, slave.run_time) == (2**40 + 7, -4.5, 70000)
            assert slave.state.name == "RUNNING" and slave.fault_code == 3
            assert (slave.status_word.ready, slave.status_word.mode, slave.status_word.warning) == (True, 2, True)
            assert slave.fault_history == (0, 4, 3, 0, 1)
        elif device.name == "energy_meter":
            slave.hold = True
            assert (slave.manufacturer, slave.serial_number) == ("Acme Metering", "EM3-000042")
            assert (slave.current_a, slave.voltage_ln, slave.frequency, slave.power) == (-12.34, 230.1, 49.98, -15000)
            assert (slave.exported, slave.var_exported_q4_c, slave.imported) == (2**31 * 100, 123400, 0)
            assert slave.events.over_voltage and not slave.events.over_current
            slave.site = "Substation 7"
            slave.ct_ratio = 10000
            assert (slave.site, slave.ct_ratio) == ("Substation 7", 10000)
        else:
            assert slave.di == (True, False, False, True) and math.isclose(slave.ua, 229.98)
            assert slave.setting[0] == 17 and slave.setting[253:] == (0, 2, 3)
            assert slave.measured_more[-1] == 65535
    finally:
        connection.close()


def test_free_addresses_answer_02(served):
    device, running = served
    with Port(running.link) as port:
        for table in TABLES:
            if not device.has_function(READ_FUNCTION[table]):
                continue
            last = max(point.last for point in device.table(table))
            for at, quantity in ((last + 1, 1), (last, 2), (65535, 1)):
                frame = request(frames.read(READ_FUNCTION[table], at, quantity), device.line.address)
                assert port.ask(frame, bytes(5))[1:3] == bytes([0x80 | READ_FUNCTION[table], 2]), (table, at)


def test_minimalmodbus_and_mbpoll(folder):
    """The relay box as the documents show it, at another address and rate."""
    with Serve(folder / "box", MAP=MAPS["relay_box"], ADDRESS=9, BAUD=9600, PARITY="none", STOP=1) as running:
        instrument = minimalmodbus.Instrument(str(running.link), 9)
        instrument.serial.baudrate, instrument.serial.timeout = 9600, 1
        assert instrument.read_register(0, 1) == 45.0
        instrument.write_register(0, 30.5, 1)
        assert instrument.read_register(0, 1) == 30.5
        with pytest.raises(minimalmodbus.IllegalRequestError):
            instrument.write_register(0, 80.1, 1)
        instrument.write_bit(3, 1)
        assert instrument.read_bits(0, 4, functioncode=1) == [0, 0, 0, 1]
        assert instrument.read_bit(0, functioncode=2) == 0
        instrument.serial.close()
        if shutil.which("mbpoll"):
            command = ["mbpoll", *"-m rtu -a 9 -b 9600 -P none -0 -t 4 -r 0 -1".split(), str(running.link)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
            assert re.search(r"\[0\]:\s*305", done.stdout), done.stdout + done.stderr


def test_late_answer_of_a_map_comes(folder):
    """RESPONSE_DELAY is longer than the silence after which the simulated time stands still."""
    file = folder / "slow.yaml"
    file.write_text(
        "device: slow_box\nline: {address: 3, baud: 9600, format: 8N1}\ncore: {RESPONSE_DELAY: 3000}\n"
        "holding_registers:\n  - {at: 5, name: level, reset: 7}\n",
        encoding="utf-8",
    )
    with Serve(folder / "slow", MAP=file) as running, Port(running.link) as port:
        answer = port.ask(request(frames.read(3, 5, 1), 3), bytes(7), 3)
        assert answer[1:5] == bytes([3, 2, 0, 7])


# ------------------------------------------------------------------ what is refused

RELAY_BOX = MAPS["relay_box"]
BAD_INIT = {
    '{"temprature": 1}': "1:2: the device has no temprature; did you mean temperature?",
    '{\n "valve": 1}': "2:2: the device has no valve; known are door_open, temperature",
    '{"busy": 1}': "1:2: the device has no busy; known are door_open, temperature",
    '{"limit": 30}': "1:2: limit is written by the master and begins with its reset value; change `reset` in the map",
    '{"temperature": 21.55}': "1:17: temperature 21.55 is no whole step of 0.1; write 21.5 or 21.6",
    '{"temperature": 3276.8}': "1:17: temperature 3276.8 is outside the type; i16 with this scale is -3276.8 to 3276.7",
    '{"temperature": "warm"}': "1:17: warm is no value of an i16; write one of the numbers",
    '{"temperature": null}': "1:17: nothing is no value of temperature; write one i16",
    '{"temperature": [1]}': "1:17: a list is no value of temperature; write one i16",
    '{"door_open": 2}': "1:15: door_open 2 is no value of a bool; write 0, 1, false or true",
    "[]": '1:1: INIT is a JSON object of values by name; write {"NAME": VALUE}',
}
MANY = """\
device: many
discrete_inputs:
  - {at: 0, name: door, count: 3}
input_registers:
  - {at: 0, name: word, bits: {run: 0, mode: 5..4}}
  - {at: 1, name: text, type: string<4>}
  - {at: 3, name: gain, type: f32}
  - {at: 5, name: pair, type: i32, word_order: little, count: 2}
  - {at: 9, name: fixed, kind: constant, reset: 9}
holding_registers:
  - {at: 0, name: curve, type: u32, count: 3, kind: memory, reset: [1, 2, 3]}
fifos:
  - {at: 100, name: queue, depth: 4}
files:
  - {number: 1, name: first_log, records: 5}
  - {number: 7, name: log, records: 10}
"""
WORDS = {
    '{"door": [1, 0, 1]}': [(1, 0, 5)],
    '{"door": {"2": 1}}': [(1, 0, 4)],
    '{"word": {"run": 1, "mode": 3}}': [(1, 1, 0x31)],
    '{"word": 65535}': [(1, 1, 0xFFFF)],
    '{"text": "abc"}': [(1, 2, 0x6300), (1, 3, 0x6162)],
    '{"gain": 1.5}': [(1, 4, 0), (1, 5, 0x3FC0)],
    '{"pair": [-2, 65536]}': [(1, 6, 0xFFFE), (1, 7, 0xFFFF), (1, 8, 0), (1, 9, 1)],
    '{"curve": {"1": [65537]}}': [(3, 2, 1), (3, 3, 1)],
    '{"queue": [5, 6]}': [(3, 100, 2), (3, 101, 5), (3, 102, 6)],
    '{"queue": []}': [(3, 100, 0)],
    '{"log": [1, 2]}': [(4, 5, 1), (4, 6, 2)],
    '{"log": {"9": 3}}': [(4, 14, 3)],
    "{}": [],
}
MORE_BAD = {
    '{"door": 1}': '1:10: door has 3 items; write a list, or {"FIRST ITEM": [VALUES]}',
    '{"door": [1]}': '1:10: 1 values for 3 items; write one for each, or {"FIRST ITEM": [VALUES]}',
    '{"door": {"3": 1}}': "1:11: item 3 does not exist; door has items 0 to 2",
    '{"door": {"x": 1}}': "1:11: x is no item; door has items 0 to 2",
    '{"word": {"ruin": 1}}': "1:11: word has no field ruin; did you mean run?",
    '{"word": {"mode": 4}}': "1:19: mode 4 is no number from 0 to 3",
    '{"text": "abcde"}': "1:10: 5 characters do not fit into string<4>; shorten the text, or string<5>",
    '{"gain": 1e999}': "1:10: 1e999 is no value of gain; write one f32",
    '{"gain": 1e300}': "1:10: gain 1e300 is too large for f32; take f64, or a smaller one",
    '{"fixed": 1}': "1:2: fixed is a constant; change `reset` in the map",
    '{"queue": [1, 2, 3, 4, 5]}': "1:11: queue takes a list of at most 4 entries",
    '{"log": {"10": 1}}': "1:10: item 10 does not exist; log has items 0 to 9",
    '{"log": [65536]}': "1:10: log 65536 is outside the type; u16 is 0 to 65535",
    '{"door": [1, 0, 1], "door": [1, 0, 1]}': (
        "1:21: door is here for the second time; the first is in line 1, leave one out"
    ),
}


def words_of(device, text):
    """The words of an INIT, or its diagnostics."""
    try:
        return live_values.initial(device, loader.parse(text, "init.json"))
    except loader.MapError as error:
        return [str(note).removeprefix("init.json:") for note in error.diagnostics]


@pytest.mark.parametrize("text", WORDS)
def test_words_of_an_init(text):
    device, _ = checks.compile_source(loader.parse(MANY, "many.yaml"))
    assert words_of(device, text) == WORDS[text]


@pytest.mark.parametrize("text", {**BAD_INIT, **MORE_BAD})
def test_bad_init_is_told_with_its_place(text):
    device = checks.compile_source(loader.parse(MANY, "m"))[0] if text in MORE_BAD else DEVICES["relay_box"]
    assert words_of(device, text) == [{**BAD_INIT, **MORE_BAD}[text]]


def test_bad_init_is_one_line_and_exit_2(folder):
    init = folder / "bad.json"
    text, says = next(iter(BAD_INIT.items()))
    init.write_text(text, encoding="utf-8")
    assert refuse(LINK=folder / "bad", MAP=RELAY_BOX, INIT=init) == (2, [f"{init}:{says}"])
    missing = folder / "none.json"
    wanted = f"{missing}:1:1: no such file; name the INIT file"
    assert refuse(LINK=folder / "bad", MAP=RELAY_BOX, INIT=missing) == (2, [wanted])


def test_bad_map_is_one_line_and_exit_2(folder):
    file = folder / "bad.yaml"
    file.write_text("device: box\ncoils:\n  - {at: 0, name: signal}\n", encoding="utf-8")
    status, lines = refuse(LINK=folder / "bad", MAP=file)
    assert status == 2 and len(lines) == 1 and lines[0].startswith(f"{file}:3:19: signal is a keyword of VHDL"), lines
    status, lines = refuse(LINK=folder / "bad", MAP=folder / "none.yml")
    assert (status, lines) == (2, [f"{folder / 'none.yml'}:1:1: no such file; name the map file"])
    assert not os.path.lexists(folder / "bad")


BAD_VARIABLES = {
    "DEVICE=pdm": "DEVICE: a map file is a device of its own, leave DEVICE out",
    "BAUD=460800": "BAUD=460800: must be a number from 29 to 230400",
    "ADDRESS=0": "ADDRESS=0: must be a number from 1 to 247",
    "PARITY=mark": "PARITY=mark: must be even, odd or none",
}


@pytest.mark.parametrize("variable", BAD_VARIABLES)
def test_bad_variable_with_a_map_is_one_line_and_exit_2(folder, variable):
    name, _, value = variable.partition("=")
    status, lines = refuse(**{"LINK": folder / "bad", "MAP": RELAY_BOX, name: value})
    assert (status, lines) == (2, [f"serve: {BAD_VARIABLES[variable]}"])


def test_rate_of_the_map_that_cannot_be_simulated_is_told(folder):
    file = folder / "fast.yaml"
    file.write_text("device: box\nline: {baud: 1000000}\ncoils:\n  - {at: 0, name: lamp}\n", encoding="utf-8")
    status, lines = refuse(LINK=folder / "bad", MAP=file)
    wanted = "serve: BAUD=1000000: must be a number from 29 to 230400; the map says 1000000, give another BAUD"
    assert (status, lines) == (2, [wanted])


# ------------------------------------------------------------------ NAME.live.json


@pytest.mark.parametrize("name", MAPS)
def test_live_json_is_the_map(name):
    """Every point with its place, type and reset value, and where the host port takes it."""
    device = DEVICES[name]
    found = json.loads(live.generate(device)[f"{name}.live.json"])
    points = {point["name"]: (table, point) for table, points in found["tables"].items() for point in points}
    assert set(points) == {point.name for point in device.points}
    for point in device.points:
        table, made = points[point.name]
        assert (table, made["at"], made["size"], made["type"]) == (point.table, point.at, point.size, point.type)
        assert [point.raw(number) for number in made["reset"]] == list(point.resets)
        assert ("host" in made) == (point.kind in ("wire", "memory", "register"))
    for kind, space in live.HELD.items():
        hosts = [point["host"] for _, point in points.values() if point["kind"] == kind]
        taken = [set(range(host["item"], host["item"] + host["words"])) for host in hosts]
        assert all(host["space"] == space for host in hosts)
        assert sum(map(len, taken)) == len(set().union(*taken)), "two points share a word"
    assert found["line"]["address"] == device.line.address and found["functions"] == list(device.functions)


def test_same_bytes_from_the_same_map(tmp_path):
    made = []
    for turn in "ab":
        command = [str(ROOT / "tools/modbus"), "map", "live", str(MAPS["drive"]), "-o", str(tmp_path / turn)]
        subprocess.run([sys.executable, *command], check=True)
        made.append({path.name: path.read_bytes() for path in sorted((tmp_path / turn).iterdir())})
    assert made[0] == made[1] and set(made[0]) == {
        "drive.v", "drive.f", "drive_properties.v", "drive.live.json", "drive_live.v",
    }  # fmt: skip
