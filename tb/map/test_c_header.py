# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.h: clean under the compilers' warnings, and compiled programs agree with the model."""

import json
import subprocess

import pytest
from modbus_map.outputs import c_header

from map.output_devices import EVERYTHING, RELAY_BOX, SAMPLES

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror"]
COMPILERS = {"c99": ["gcc", "-std=c99", "-x", "c"], "c++11": ["g++", "-std=c++11", "-x", "c++"]}


def program(place, device, body, compiler="c99"):
    """What a program with this body prints."""
    place.mkdir(exist_ok=True)
    for path, text in c_header.generate(device).items():
        (place / path).write_text(text, encoding="utf-8")
    source = place / "main.c"
    text = f'#include "{device.name}.h"\n#include "{device.name}.h"\n#include <stdio.h>\n'
    source.write_text(text + f"int main(void)\n{{\n{body}\n  return 0;\n}}\n", encoding="utf-8")
    made = [*COMPILERS[compiler], *WARNINGS, str(source), "-o", str(place / "main")]
    done = subprocess.run(made, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return subprocess.run([place / "main"], capture_output=True, text=True, check=True).stdout


def samples(device):
    """(point, raw, registers) of all samples."""
    for name, numbers in SAMPLES.items():
        point = device.point(name)
        for number in numbers:
            raw = point.raw(number)
            yield point, raw, point.registers(raw)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_values_are_those_of_the_model(tmp_path, compiler):
    """Each sample: registers to number, to value, and back to the registers."""
    lines, expected = [], []
    for point, raw, registers in samples(EVERYTHING):
        name = f"drive_{point.name}"
        words = ", ".join(f"{word}u" for word in registers)
        lines.append(f"  {{ const uint16_t r[] = {{{words}}}; uint16_t w[{point.width}] = {{0}}; unsigned k;")
        if point.is_string:
            lines.append(f"    char t[{point.characters + 1}]; {name}_get(r, t); (void){name}_set(w, t);")
            lines.append('    printf("\\"%s\\"", t);')
        else:
            kind = ("%.17g", "(double)") if point.is_float else ("%lld", "(long long)")
            lines.append(f"    {name}_set(w, {name}_get(r));")
            lines.append(f'    printf("{kind[0]}", {kind[1]}{name}_get(r));')
        lines.append(f'    for (k = 0u; k < {point.width}u; k++) printf(" %u", (unsigned)w[k]);')
        if point.is_scaled:
            lines.append(f"    (void){name}_set_value(w, {name}_value(r));")
            lines.append(f'    printf(" %.17g", {name}_value(r));')
            lines.append(f'    for (k = 0u; k < {point.width}u; k++) printf(" %u", (unsigned)w[k]);')
        lines.append('    printf("\\n"); }')
        number = point.number(raw)
        words = registers + ([point.value(raw)] + registers if point.is_scaled else [])
        expected.append((point, [number, *words]))
    said = program(tmp_path, EVERYTHING, "\n".join(lines), compiler).splitlines()
    assert len(said) == len(expected)
    for line, (point, wanted) in zip(said, expected):
        seen = [json.loads(word) for word in line.split(" ")]
        assert seen == wanted, point.name


def test_limits_fields_and_text(tmp_path):
    """set_value refuses what does not fit and rounds; a text that is too long changes nothing; fields keep the rest."""
    body = """
  uint16_t r[5] = {9u, 9u, 9u, 9u, 9u};
  printf("%d ", relay_dummy);
  printf("%d ", drive_gains_set_value(r, 16383.5) && drive_gains_get(r) == 32767);
  printf("%d ", drive_gains_set_value(r, -16384.0) && drive_gains_get(r) == -32768);
  printf("%d ", !drive_gains_set_value(r, 16383.8) && drive_gains_get(r) == -32768);
  printf("%d ", !drive_gains_set_value(r, 0.0 / zero));
  printf("%d ", drive_speed_set_value(r, -0.019) && drive_speed_get(r) == -2);
  printf("%d ", !drive_energy_set_value(r, -1.0) && !drive_energy_set_value(r, 18446744073709552.0));
  printf("%d ", drive_energy_set_value(r, 18446744073709548.0));
  printf("%d ", !drive_tag_set(r, "1234567890") && drive_tag_set(r, "123456789") && r[4] == 0x3900u);
  printf("%d ", drive_status_mode_set(0u, 0xFFu) == drive_status_mode_set(0u, 3u));
  printf("%d ", drive_status_mode_set(0xFFFFu, 2u) == 0xFFEFu && drive_status_mode_get(0x0020u) == 2u);
  printf("%d ", DRIVE_MODE_ON_NOW == 1u && DRIVE_RAMP_MAX == 60000u && DRIVE_MODE_RESET == 1u);
  printf("%d\\n", DRIVE_GAINS_ITEM_AT(2u) == 10u && DRIVE_CURVE_HOST_AT == 0x300C8u);
""".replace('  printf("%d ", relay_dummy);', "  volatile double zero = 0.0;")
    assert program(tmp_path, EVERYTHING, body).split() == ["1"] * 12


@pytest.mark.parametrize("compiler", COMPILERS)
def test_relay_box(tmp_path, compiler):
    body = (
        '  const uint16_t r[1] = {65531u};\n  printf("%.1f %u", relay_box_temperature_value(r), RELAY_BOX_RELAY_COUNT);'
    )
    assert program(tmp_path, RELAY_BOX, body, compiler) == "-0.5 4"
