# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The map compiler's front: model, schema, reading and writing a map, CSV, SystemRDL, the reference maps."""

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest
from conftest import FULL
from hypothesis import HealthCheck, given, seed, settings
from modbus_map import checks, csv_door, dump, example, loader, outputs, reference, schema
from modbus_map.model import Point
from modbus_map.outputs import rdl
from modbus_map.rdl import importer
from ruamel.yaml import YAML

from map.maps import maps
from map.test_diagnostics import CASES, modbus

ROOT = Path(__file__).resolve().parents[2]
MAPS = {path.stem: path for path in sorted((ROOT / "examples").glob("*/*.yaml"))}
SEED = int(os.environ.get("SEED", "1"), 0)
random_maps = settings(
    max_examples=1000 if FULL else 60, deadline=None, suppress_health_check=list(HealthCheck), database=None
)


def device_of(text, file="map.yaml"):
    return checks.compile_source(loader.parse(text, file))[0]


def plain(tree):
    """A tree of the loader as JSON: keys are texts."""
    if isinstance(tree, dict):
        return {str(key): plain(value) for key, value in tree.items()}
    if isinstance(tree, list):
        return [plain(item) for item in tree]
    if isinstance(tree, bool) or tree is None:
        return tree
    return int(tree) if isinstance(tree, int) else float(tree) if isinstance(tree, float) else tree


def written(tree):
    """A tree as YAML."""
    import io

    yaml = YAML()
    yaml.width = 10**6
    yaml.allow_unicode = True
    out = io.StringIO()
    yaml.dump(tree, out)
    return out.getvalue()


# ------------------------------------------------------------------ schema


def test_schema_in_docs_is_current():
    assert (ROOT / "docs/map.schema.json").read_text() == schema.text(), (
        "tools/modbus map schema > docs/map.schema.json"
    )


def test_schema_is_draft_2020_12():
    jsonschema.Draft202012Validator.check_schema(schema.schema())
    assert schema.schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


VALIDATOR = jsonschema.Draft202012Validator(schema.schema())


@pytest.mark.parametrize("name", [*MAPS, "init"])
def test_schema_takes_the_examples(name):
    tree = loader.parse(example.text(), "x").tree if name == "init" else loader.load(MAPS[name]).tree
    assert [error.message for error in VALIDATOR.iter_errors(plain(tree))] == []


# What is wrong with one key alone is wrong by the schema too.
BY_SCHEMA = """
    no_device unknown_key table_is_a_text gaps_word point_is_a_text device_name_signs title_is_a_list word_order_word
    line_is_a_text address_0 address_248 baud_0 baud_text format run_time line_key core_parameter core_by_the_map
    core_range function_unknown function_text functions_word functions_mapping identity_letters identity_length
    identity_private_id identity_server_id identity_server_id_long identity_conformity identity_key no_at no_name
    key_nearest key_of_another_table at_65536 at_negative at_text at_float name_signs name_digit name_underscores
    name_long type_nearest type_of_a_bit string_without_length count_0 count_text count_boolean access_word
    access_of_inputs kind_word strobe_word strobe_of_inputs
    reset_mapping min_text min_list scale_0 scale_text enum_empty enum_key
    bits_place bits_text word_order_of_a_point doc_is_a_list file_text file_number file_records fifo_depth
    """.split()


@pytest.mark.parametrize("name", BY_SCHEMA)
def test_schema_refuses(name):
    tree = plain(loader.parse(CASES[name]["map"], "x").tree)
    assert not VALIDATOR.is_valid(tree)


@seed(SEED)
@random_maps
@given(maps())
def test_schema_takes_random_maps(tree):
    assert [error.message for error in VALIDATOR.iter_errors(plain(tree))] == []


# ------------------------------------------------------------------ round trips


@seed(SEED)
@random_maps
@given(maps())
def test_map_to_text_and_back_is_the_identity(tree):
    device = device_of(written(tree))
    assert device_of(dump.text(device)) == device


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("rdl")


@seed(SEED)
@settings(random_maps, max_examples=300 if FULL else 20)  # the compiler takes half a second for each
@given(tree=maps())
def test_map_to_systemrdl_and_back_is_the_identity(place, tree):
    device = device_of(written(tree))
    (name, text), *_ = rdl.generate(device).items()
    (place / name).write_text(text, encoding="utf-8")
    assert importer.load(place / name) == device


def test_offset_goes_to_systemrdl_and_back(place):
    """Which random maps have now and then."""
    line = "{at: 0, name: heat, type: i16, scale: 0.5, offset: -40, reset: 20}"
    device = device_of(f"device: heater\nholding_registers:\n  - {line}\n")
    ((name, text),) = rdl.generate(device).items()
    (place / name).write_text(text, encoding="utf-8")
    assert device.points[0].offset == -40 and importer.load(place / name) == device


@pytest.mark.parametrize("name", MAPS)
def test_reference_map_to_systemrdl_and_back(place, name):
    device, _ = checks.load_device(MAPS[name])
    (file, text), *_ = rdl.generate(device).items()
    (place / file).write_text(text, encoding="utf-8")
    assert importer.load(place / file) == device
    done = modbus("from-rdl", place / file, "-o", place / f"{name}.yaml")
    assert done.returncode == 0, done.stderr
    assert checks.load_device(place / f"{name}.yaml")[0] == device


def peakrdl(*arguments):
    return subprocess.run(
        [Path(sys.executable).parent / "peakrdl", *map(str, arguments)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_peakrdl_reads_and_writes_maps(tmp_path):
    device, _ = checks.load_device(MAPS["drive"])
    (tmp_path / "drive.rdl").write_text(rdl.generate(device)["drive.rdl"], encoding="utf-8")
    done = peakrdl("modbus", tmp_path / "drive.rdl", "-o", tmp_path / "drive.yaml")
    assert done.returncode == 0, done.stderr
    assert checks.load_device(tmp_path / "drive.yaml")[0] == device
    done = peakrdl("html", MAPS["drive"], "-o", tmp_path / "html")
    assert done.returncode == 0, done.stderr
    pages = "".join(
        path.read_text(errors="replace") for path in (tmp_path / "html").rglob("*") if path.suffix in (".html", ".json")
    )
    for name in ("torque_reference", "heatsink", "fault_reset"):
        assert name in pages


def test_peakrdl_tells_of_a_wrong_map(tmp_path):
    (tmp_path / "box.yaml").write_text("device: box\ncoils: [{at: 0, name: reg}]\n")
    done = peakrdl("html", tmp_path / "box.yaml", "-o", tmp_path / "html")
    assert done.returncode != 0 and "2:23: reg is a keyword of Verilog" in done.stderr


def test_systemrdl_of_others_becomes_holding_registers(tmp_path):
    (tmp_path / "a.rdl").write_text(
        "addrmap box { default regwidth = 16; default accesswidth = 16;\n"
        "  reg { field { sw = rw; hw = r; } enable[0:0] = 1; field { sw = rw; } mode[5:4] = 2; } control @ 0x0;\n"
        "  reg { field { sw = r; hw = w; } value[15:0]; } state @ 0x4;\n};\n"
    )
    device = importer.load(tmp_path / "a.rdl")
    control, state = device.points
    assert (control.at, control.access, control.reset, len(control.fields)) == (0, "rw", 0x21, 2)
    assert (state.at, state.access, state.kind) == (2, "ro", "wire")


def test_wrong_systemrdl_is_told_with_its_place(tmp_path):
    (tmp_path / "a.rdl").write_text("addrmap box {\n  reg { field { nonsense = 1; } a; } r;\n};\n")
    done = modbus("from-rdl", tmp_path / "a.rdl")
    assert done.returncode == 2 and f"{tmp_path / 'a.rdl'}:2:" in done.stderr, done.stderr


# ------------------------------------------------------------------ values


def point_of(line, table="holding_registers"):
    return device_of(f"device: box\n{table}:\n  - {{at: 0, name: a, {line}}}\n").points[0]


@pytest.mark.parametrize(
    ("line", "raw", "number", "value", "registers"),
    [
        ("type: i16, scale: 0.1, reset: -4.5", 0xFFD3, -45, -4.5, [0xFFD3]),
        ("type: u32, reset: 0x12345678", 0x12345678, 0x12345678, 0x12345678, [0x1234, 0x5678]),
        ("type: u32, word_order: little, reset: 0x12345678", 0x12345678, 0x12345678, 0x12345678, [0x5678, 0x1234]),
        ("type: f32, reset: 1.5", 0x3FC00000, 1.5, 1.5, [0x3FC0, 0]),
        ("type: i64, reset: -2", 2**64 - 2, -2, -2, [65535, 65535, 65535, 65534]),
        ("type: string<3>, reset: abc", 0x61626300, "abc", "abc", [0x6162, 0x6300]),
        ("type: u16, scale: 0.5, offset: -40, reset: 20", 120, 120, 20.0, [120]),
        ("enum: {0: idle, 3: run}, reset: run", 3, 3, 3, [3]),
    ],
)
def test_value_is_raw_times_scale_plus_offset(line, raw, number, value, registers):
    point = point_of(line)
    assert (point.reset, point.number(raw), point.value(raw), point.registers(raw)) == (raw, number, value, registers)
    assert point.join(registers) == raw and point.raw(number) == raw


def test_limits_are_values():
    point = point_of('type: i16, unit: "°C", scale: 0.1, min: 0, max: 80, reset: 45')
    assert (point.minimum, point.maximum, point.reset) == (0, 800, 450)
    assert [point.accepts(raw) for raw in (0xFFFF, 0, 800, 801)] == [False, True, True, False]


def test_negative_scale_exchanges_the_limits():
    point = point_of("type: i16, scale: -0.1, min: 0, max: 80, reset: 45")
    assert (point.number(point.minimum), point.number(point.maximum)) == (-800, 0)


def test_enum_is_a_limit_only_without_min_and_max():
    assert not point_of("enum: {0: a0, 2: b0}").accepts(1)
    assert point_of("enum: {0: a0, 2: b0}, max: 5").accepts(1)


def test_float_limit_refuses_nan():
    point = point_of("type: f32, min: -1, max: 1")
    assert not point.accepts(0x7FC00000) and point.accepts(0x3F800000)


@pytest.mark.parametrize(("at", "number"), [(0, 40001), (9998, 49999), (9999, 410000), (65535, 465536)])
def test_number_of_vendor_manuals(at, number):
    assert Point("holding_registers", at, "a", "u16", 1).number_of_register() == number


def test_yaml_1_2_words_are_texts():
    device = device_of("device: box\nversion: 1.10\ncoils:\n  - {at: 08, name: a, enum: {0: off, 1: on}, unit: no}\n")
    point = device.points[0]
    assert ([item.label for item in point.enum], point.unit, point.at, device.version) == (
        ["off", "on"],
        "no",
        8,
        "1.10",
    )


# ------------------------------------------------------------------ the device


def test_ports_of_the_relay_box():
    device, notes = checks.load_device(MAPS["relay_box"])
    names = [port.name for port in device.port_list()]
    wanted = "clk_i rst_i rxd_i txd_o de_o relay_o door_open_i temperature_i limit_o"
    assert (names, notes) == (wanted.split(), [])


def test_functions_are_those_the_map_needs():
    assert device_of("device: b\ndiscrete_inputs: [{at: 0, name: a}]\n").functions == (2,)
    assert device_of("device: b\ncoils: [{at: 0, name: a, access: wo}]\n").functions == (5, 15)
    assert device_of("device: b\nholding_registers: [{at: 0, name: a, access: ro}]\n").functions == (3,)
    assert device_of("device: b\nfifos: [{at: 0, name: a}]\n").functions == (3, 24)


def test_points_follow_the_order_of_the_file():
    device = device_of(
        "device: b\ninput_registers:\n- {at: 9, name: x}\n- {at: 8, name: y}\ncoils: [{at: 0, name: z}]\n"
    )
    assert [point.name for point in device.points] == ["x", "y", "z"]


def test_gaps_zero_in_both_forms():
    for text in ("- {gaps: zero}\n  - {at: 0, name: a}", "{gaps: zero, points: [{at: 0, name: a}]}"):
        assert device_of(f"device: b\ncoils:\n  {text}\n").zero_gaps == {"coils"}


def test_large_points_are_memory():
    kinds = [point_of(f"count: {count}").kind for count in (64, 65)]
    assert kinds == ["register", "memory"]


# ------------------------------------------------------------------ the command


def test_init_writes_a_map_that_is_right(tmp_path):
    done = modbus("init", tmp_path / "a.yaml")
    assert done.returncode == 0, done.stderr
    assert checks.load_device(tmp_path / "a.yaml")[1] == []
    assert modbus("init", tmp_path / "a.yaml").returncode == 2


def test_init_shows_every_key():
    text = example.text()
    for key in schema.schema()["properties"]:
        assert f"{key}:" in text, key


def test_schema_is_printed():
    assert json.loads(modbus("schema").stdout) == schema.schema()


def test_same_input_gives_the_same_bytes(tmp_path):
    first, second = (outputs.generate(checks.load_device(MAPS["drive"])[0]) for _ in range(2))
    assert first == second


def test_nothing_is_left_of_an_output_that_fails(tmp_path):
    file, out = tmp_path / "box.yaml", tmp_path / "out"
    file.write_text("device: box\ncoils: [{at: 0, name: a}]\n")
    tmp_path.chmod(0o555)
    try:
        if not os.access(tmp_path, os.W_OK):
            assert modbus("build", file, "-o", out).returncode == 2
            assert not out.exists()
    finally:
        tmp_path.chmod(0o755)


@pytest.mark.parametrize("name", MAPS)
def test_reference_map_is_built(tmp_path, name):
    done = modbus("build", MAPS[name], "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    made = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*") if path.is_file()}
    for wanted in (
        "NAME.v",
        "NAME.f",
        "NAME.vhd",
        "NAME.h",
        "NAME_client.py",
        "NAME.md",
        "NAME.html",
        "NAME.rdl",
        "tags/mbmap.json",
    ):
        assert wanted.replace("NAME", name) in made, wanted


def test_energy_meter_takes_less_than_two_seconds(tmp_path):
    """Of a processor's time: others may want it too."""

    def used():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return children.ru_utime + children.ru_stime

    taken = []
    for _ in range(2):
        before = used()
        done = modbus("build", MAPS["energy_meter"], "-o", tmp_path / "out")
        assert done.returncode == 0, done.stderr
        taken.append(used() - before)
    assert min(taken) < 2, f"{min(taken):.2f} s"


# ------------------------------------------------------------------ CSV

CSV = """\
# device: relay_box
# title: Relay box
# version: 1.0.0
# identity: {vendor: Acme, product: RB-4, revision: V1.0}
# line: {address: 17, baud: 19200, format: 8E1}
Object;Register;Name;Data type;Quantity;Min;Max;Default;Unit;Factor;Description
coil;00001;relay;bit;4;;;;;;Relays, 1 closes
;10001;door_open;boolean;;;;;;;
3x;30001;temperature;int16;;;;;°C;0,1;
Holding register;40001;limit;int16;;0;80;45;°C;0,1;
"""


def test_table_of_a_spreadsheet_is_the_relay_box(tmp_path):
    source = csv_door.parse(CSV, "box.csv")
    assert checks.compile_source(source)[0] == checks.load_device(MAPS["relay_box"])[0]
    (tmp_path / "box.csv").write_text(CSV, encoding="utf-8")
    done = modbus("from-csv", tmp_path / "box.csv", "-o", tmp_path / "box.yaml")
    assert done.returncode == 0, done.stderr
    assert checks.load_device(tmp_path / "box.yaml")[0] == checks.load_device(MAPS["relay_box"])[0]


# ------------------------------------------------------------------ documents


def test_tables_of_the_reference_are_current():
    text = (ROOT / "docs/map.md").read_text(encoding="utf-8")
    assert reference.updated(text) == text, "python tools/modbus map reference"


def test_first_map_of_the_document_is_right():
    text = (ROOT / "docs/first_device.md").read_text(encoding="utf-8")
    first = text.split("```yaml\n", 1)[1].split("```", 1)[0]
    device, notes = checks.compile_source(loader.parse(first, "first"))
    assert notes == [] and len(first.splitlines()) <= 11 and len(device.points) == 4


# ------------------------------------------------------------------ the command


def test_old_packages_are_told_in_one_line(tmp_path):
    """Packages of another version than tools/requirements/map.txt names are not used; this stands in for a bad .venv."""
    place = tmp_path / "pydantic-1.10.2.dist-info"
    place.mkdir()
    (place / "METADATA").write_text("Metadata-Version: 2.1\nName: pydantic\nVersion: 1.10.2\n", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, ROOT / "tools/modbus", "map", "check", MAPS["drive"]],
        env={**os.environ, "PYTHONPATH": str(tmp_path), "MODBUS_MAP_INSTALLED": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
    assert re.search(r"lacks pydantic \S+ \(here 1\.10\.2\); run make map", done.stderr), done.stderr


def test_additional_data_as_a_text_is_as_long_as_the_schema_says():
    for length, good in ((249, True), (250, False)):
        tree = {"device": "box", "identity": {"additional_data": "x" * length}, "coils": [{"at": 0, "name": "a"}]}
        assert VALIDATOR.is_valid(tree) is good
        text = f"device: box\nidentity: {{additional_data: {'x' * length}}}\ncoils: [{{at: 0, name: a}}]\n"
        try:
            assert len(device_of(text).identity.additional_data) == length and good
        except loader.MapError as error:
            assert not good and "250 bytes do not fit; 1 to 249" in str(error.diagnostics[0])


@pytest.mark.parametrize("text", ["?", "? a", ":", ":?", "- a", "-", "a: b", "#", "{", "'", '"', "a # b", "~", "=", "%"])
def test_texts_that_look_like_yaml_come_back(place, text):
    """From the map to a map file and to SystemRDL, and back."""
    tree = {"device": "box", "title": text, "doc": text, "coils": [{"at": 0, "name": "a", "doc": text}]}
    tree["holding_registers"] = [{"at": 1, "name": "b", "unit": text, "enum": {1: text}, "reset": 1}]
    device = device_of(written(tree))
    assert device_of(dump.text(device)) == device
    (name, made), *_ = rdl.generate(device).items()
    (place / name).write_text(made, encoding="utf-8")
    assert importer.load(place / name) == device
