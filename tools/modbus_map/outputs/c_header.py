# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME.h: addresses, masks, named values, and functions that pack and unpack values. C99 and C++11, no library.

The functions take the registers of one item as 16-bit words in the order of their addresses: what a master has
received, or what the host CPU has read through the host port.
"""

from __future__ import annotations

from modbus_map.model import SPACES, Device, Point, exact_of
from modbus_map.outputs import shared

TYPES = {
    "bool": "bool", "bits": "uint16_t", "u16": "uint16_t", "i16": "int16_t", "u32": "uint32_t", "i32": "int32_t",
    "u64": "uint64_t", "i64": "int64_t", "f32": "float", "f64": "double",
}  # fmt: skip
RAW = {1: "uint16_t", 2: "uint32_t", 4: "uint64_t"}


def _literal(point: Point, number: int | float | str) -> str:
    """A number of the point's type as a C constant expression."""
    if point.is_float:
        value = float(number)
        text = {"inf": "(1.0 / 0.0)", "-inf": "(-1.0 / 0.0)", "nan": "(0.0 / 0.0)"}.get(repr(value), repr(value))
        return text if point.type == "f64" or text.startswith("(") else f"{text}f"
    value = int(number)
    if point.bits <= 16:
        return f"({value})" if value < 0 else f"{value}" if point.is_signed else f"{value}u"
    suffix = "(INT{0}_C({1}))" if point.is_signed else "UINT{0}_C({1})"
    if point.is_signed and value == -(1 << (point.bits - 1)):
        return f"(-INT{point.bits}_C({-(value + 1)}) - 1)"
    return suffix.format(point.bits, value)


def _defines(device: Device, point: Point) -> list[str]:
    up = f"{device.name}_{point.name}".upper()
    rows = [(f"{up}_AT", f"{point.at}u"), (f"{up}_SIZE", f"{point.size}u")]
    if point.is_array:
        rows += [
            (f"{up}_COUNT", f"{point.count}u"),
            (f"{up}_ITEM_AT(item)", f"({point.at}u + {point.width}u * (item))"),
        ]
    if point.kind == "memory":
        rows.append((f"{up}_HOST_AT", f"0x{SPACES[point.table] << 16 | point.at:05X}u"))
    if not point.is_string:
        for tail, raw in (("MIN", point.minimum), ("MAX", point.maximum)):
            if raw is not None:
                rows.append((f"{up}_{tail}", _literal(point, point.number(raw))))
        if point.writable and len(set(point.resets)) == 1 and not point.is_float:
            rows.append((f"{up}_RESET", _literal(point, point.number(point.reset))))
    for part in point.fields:
        tail = f"{up}_{part.name}".upper()
        rows += [(f"{tail}_MASK", f"0x{part.mask:04X}u"), (f"{tail}_SHIFT", f"{part.low}u")]
    rows += [(f"{up}_{item.ident}", _literal(point, item.number)) for item in point.enum if not point.is_float]
    seen: set[str] = set()
    lines = []
    for name, text in rows:
        if name not in seen:
            lines.append(f"#define {name} {text}")
        seen.add(name)
    return lines


def _index(point: Point, word: int) -> int:
    """The register that holds word `word` of a value, counted from its highest."""
    return word if point.word_order == "big" else point.width - 1 - word


def _string(name: str, point: Point) -> list[str]:
    reads = []
    order = [_index(point, word) for word in range(point.width)]
    table = ", ".join(f"{k}u" for k in order)
    reads += [
        f"static inline void {name}_get(const uint16_t *registers, char text[{point.characters + 1}])",
        "{",
        f"  static const uint8_t order[{point.width}] = {{{table}}};",
        "  unsigned k;",
        f"  for (k = 0u; k < {point.characters}u; k++) {{",
        "    const unsigned word = registers[order[k / 2u]];",
        "    text[k] = (char)(unsigned char)((k % 2u) != 0u ? word & 0xFFu : word >> 8);",
        "  }",
        f"  text[{point.characters}] = '\\0';",
        "}",
        "",
        f"/* False, and nothing changed, if the text has more than {point.characters} characters. */",
        f"static inline bool {name}_set(uint16_t *registers, const char *text)",
        "{",
        f"  static const uint8_t order[{point.width}] = {{{table}}};",
        "  size_t length = 0u;",
        "  unsigned k;",
        f"  while (length <= {point.characters}u && text[length] != '\\0') length++;",
        f"  if (length > {point.characters}u) return false;",
        f"  for (k = 0u; k < {point.width}u; k++) {{",
        "    const unsigned high = 2u * k < length ? (unsigned char)text[2u * k] : 0u;",
        "    const unsigned low = 2u * k + 1u < length ? (unsigned char)text[2u * k + 1u] : 0u;",
        "    registers[order[k]] = (uint16_t)(high << 8 | low);",
        "  }",
        "  return true;",
        "}",
    ]
    return reads


def _functions(device: Device, point: Point) -> list[str]:
    name = f"{device.name}_{point.name}"
    if point.is_bit:
        return []
    if point.is_string:
        return _string(name, point)
    kind, raw = TYPES[point.type], RAW[point.width]
    bits = point.bits
    words = [f"(({raw})registers[{_index(point, w)}] << {16 * (point.width - 1 - w)})" for w in range(point.width)]
    joined = "registers[0]" if point.width == 1 else " | ".join(words)
    lines = [f"static inline {kind} {name}_get(const uint16_t *registers)", "{", f"  const {raw} raw = {joined};"]
    if point.is_float:
        lines += [f"  {kind} number;", "  memcpy(&number, &raw, sizeof number);", "  return number;", "}"]
    elif point.is_signed:
        top = (1 << (bits - 1)) - 1
        most = f"{top}" if bits == 16 else f"UINT{bits}_C({top})"
        lines += [
            f"  return raw <= {most} ? ({kind})raw : ({kind})(-1 - ({kind})({raw})~raw);",
            "}",
        ]
    else:
        lines += ["  return raw;", "}"]
    lines += ["", f"static inline void {name}_set(uint16_t *registers, {kind} number)", "{"]
    if point.is_float:
        lines += [f"  {raw} raw;", "  memcpy(&raw, &number, sizeof raw);"]
    else:
        lines += [f"  const {raw} raw = ({raw})number;"]
    for w in range(point.width):
        shift = 16 * (point.width - 1 - w)
        source = f"(uint16_t)(raw >> {shift})" if shift else "(uint16_t)raw" if point.width > 1 else "raw"
        lines.append(f"  registers[{_index(point, w)}] = {source};")
    lines += ["}"]
    for part in point.fields:
        tail = f"{device.name}_{point.name}_{part.name}".upper()
        lines += [
            "",
            f"static inline uint16_t {name}_{part.name}_get(uint16_t number)",
            "{",
            f"  return (uint16_t)((number & {tail}_MASK) >> {tail}_SHIFT);",
            "}",
            "",
            f"static inline uint16_t {name}_{part.name}_set(uint16_t number, uint16_t field)",
            "{",
            f"  return (uint16_t)((number & ~{tail}_MASK & 0xFFFFu) | (((unsigned)field << {tail}_SHIFT) & {tail}_MASK));",
            "}",
        ]
    if point.is_scaled:
        lines += _scaled(name, point)
    return lines


def _scaled(name: str, point: Point) -> list[str]:
    """Value in the unit: number x scale + offset. A scale such as 0.1 is a division, so that the result is exact."""
    scale, offset = exact_of(point.scale), exact_of(point.offset)
    if point.is_float:
        there = f"(double){name}_get(registers) * {point.scale!r}"
        back = f"(value - {point.offset!r}) / {point.scale!r}" if point.offset else f"value / {point.scale!r}"
    else:
        up = f" * {float(scale.numerator)!r}" if scale.numerator != 1 else ""
        down = f" / {float(scale.denominator)!r}" if scale.denominator != 1 else ""
        there = f"(double){name}_get(registers){up}{down}"
        up = f" * {float(scale.denominator)!r}" if scale.denominator != 1 else ""
        down = f" / {float(scale.numerator)!r}" if scale.numerator != 1 else ""
        back = (f"(value - ({point.offset!r}))" if offset else "value") + up + down
    if offset:
        there += f" + ({point.offset!r})"
    unit = f" in {shared.comment(point.unit)}" if point.unit else ""
    lines = [
        "",
        f"/* The value{unit}: number x {shared.decimal(point.scale)}"
        + (f" + {shared.decimal(point.offset)}" if offset else "")
        + ". */",
        f"static inline double {name}_value(const uint16_t *registers)",
        "{",
        f"  return {there};",
        "}",
        "",
    ]
    kind = TYPES[point.type]
    if point.is_float:
        return lines + [
            f"static inline void {name}_set_value(uint16_t *registers, double value)",
            "{",
            f"  {name}_set(registers, ({kind})({back}));",
            "}",
        ]
    low, high = point.number_range()
    return lines + [
        "/* False, and nothing changed, if the number does not fit. It is rounded to the nearest one. */",
        f"static inline bool {name}_set_value(uint16_t *registers, double value)",
        "{",
        f"  const double number = {back};",
        f"  if (!(number > {float(low)!r} - 0.5 && number < {float(high)!r} + 0.5)) return false;",
        *([f"  if (number >= {float(high + 1)!r}) return false;"] if point.bits == 64 else []),
        f"  {name}_set(registers, ({kind})(number < 0.0 ? number - 0.5 : number + 0.5));"
        if point.is_signed
        else f"  {name}_set(registers, ({kind})(number < 0.0 ? 0.0 : number + 0.5));",
        "  return true;",
        "}",
    ]


def generate(device: Device) -> dict[str, str]:
    """{NAME.h: text}."""
    up = device.name.upper()
    lines = [
        f"/* {device.name} - {shared.comment(device.title)}: register map {shared.comment(device.version)}",
        " *",
        " * X_AT is the address of a point, X_SIZE its addresses, X_COUNT its items. X_get and X_set turn the registers of",
        " * one item, in the order of their addresses, into a number and back. X_value and X_set_value do it with scale and",
        " * offset. X_HOST_AT is an address of the host port. C99 or C++11; float and double are those of IEEE 754.",
        " *",
        " * Made from the map file: change that, not this file.",
        " */",
        f"#ifndef {up}_H",
        f"#define {up}_H",
        "",
        "#include <stdbool.h>",
        "#include <stddef.h>",
        "#include <stdint.h>",
        "#include <string.h>",
        "",
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        f"#define {up}_SLAVE_ADDRESS {device.line.address}u",
        f"#define {up}_BAUD {device.line.baud}ul",
        f'#define {up}_FORMAT "{device.line.format}"',
    ]
    for table, points in device.tables():
        lines += ["", f"/* {shared.TABLE_TITLES[table]} */"]
        for point in points:
            about = ", ".join(
                filter(None, (point.type, point.access, shared.comment(point.unit), shared.comment(point.doc)))
            )
            lines += ["", f"/* {point.name}: {about} */", *_defines(device, point)]
            if functions := _functions(device, point):
                lines += ["", *functions]
    if device.files:
        lines += ["", "/* Files */", ""]
        for file in device.files:
            name = f"{up}_FILE_{file.name.upper()}"
            lines += [f"#define {name} {file.number}u", f"#define {name}_RECORDS {file.records}u"]
    lines += ["", "#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {up}_H */"]
    return {f"{device.name}.h": "\n".join(lines) + "\n"}
