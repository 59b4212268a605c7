# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Random maps for hypothesis: right ones, as trees of plain Python."""

from hypothesis import strategies as st

TEXT = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc", "Zl", "Zp")), max_size=12).map(str.strip)
DOC = st.lists(TEXT, min_size=1, max_size=2).map("\n".join).map(str.strip)
LATIN = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=6)
ASCII = st.text(st.characters(min_codepoint=32, max_codepoint=126), min_size=1, max_size=12).map(
    lambda text: text.strip() or "x"
)
NUMBERS = ("u16", "i16", "u32", "i32", "u64", "i64")
SIZES = {"u16": 1, "i16": 1, "u32": 2, "i32": 2, "u64": 4, "i64": 4, "f32": 2, "f64": 4, "bits": 1}


@st.composite
def point(draw, table, name, at):
    """(an item of a table's list, its first free address)."""
    made = {"at": at, "name": name}
    bit = table in ("coils", "discrete_inputs")
    written = table in ("coils", "holding_registers")
    kind_of = "bool" if bit else draw(st.sampled_from((*NUMBERS, "f32", "f64", "bits", "string<5>", "string<16>")))
    if not bit and (kind_of != "u16" or draw(st.booleans())):
        made["type"] = kind_of
    count = draw(st.sampled_from((None, None, 1, 2, 5)))
    if count:
        made["count"] = count
    access = draw(st.sampled_from(("rw", "ro", "wo"))) if written else "ro"
    if written:
        made["access"] = access
    kinds = ["register"] if access != "ro" else ["wire", "constant"]
    kind = draw(st.sampled_from(kinds if bit else [*kinds, "memory"]))
    made["kind"] = kind
    number = kind_of in NUMBERS
    low, high = 0, 1
    if number:
        bits = 16 * SIZES[kind_of]
        low, high = (0, (1 << bits) - 1) if kind_of[0] == "u" else (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        whole = kind == "memory" and bits > 16  # limits are for whole values, and memory has words
        shape = draw(st.sampled_from(("plain", "scale") if whole else ("plain", "limits", "enum", "scale")))
        if shape == "limits":
            low, high = sorted((draw(st.integers(low, high)), draw(st.integers(low, high))))
            made.update(min=low, max=high)
        elif shape == "scale" and bits <= 32:
            made["scale"] = draw(st.sampled_from((0.1, 0.01, 0.5, 10, 100, -0.1)))
            low = high = 0
        elif shape == "enum":
            values = draw(st.lists(st.integers(low, high), min_size=1, max_size=4, unique=True))
            made["enum"] = {value: f"{draw(ASCII)} {index}" for index, value in enumerate(values)}
            low = high = values[0]
    if kind_of == "bits":
        made["bits"] = {"ready": 0, "mode": "5..3", "last": 15} if draw(st.booleans()) else {"x": "15..0"}
        low, high = 0, 65535
    if kind != "wire":
        if kind_of in ("f32", "f64"):
            width = 32 if kind_of == "f32" else 64
            value = st.floats(allow_nan=False, allow_infinity=False, width=width)
        elif kind_of.startswith("string"):
            value = LATIN.map(lambda text: text[:5].rstrip())
        else:
            value = st.integers(low, high)
        several = count and draw(st.booleans())
        made["reset"] = [draw(value) for _ in range(count)] if several else draw(value)
    if access != "ro" and draw(st.booleans()):
        made["strobe"] = True
    if draw(st.booleans()):
        made["doc"] = draw(DOC)
    if draw(st.booleans()):
        made["unit"] = draw(TEXT)
    if SIZES.get(kind_of, 1) > 1 and draw(st.booleans()):
        made["word_order"] = draw(st.sampled_from(("big", "little")))
    size = 1 if bit else SIZES.get(kind_of) or (int(kind_of[7:-1]) + 1) // 2
    return made, at + size * (count or 1)


@st.composite
def maps(draw):
    """A map as plain Python."""
    made = {"device": draw(st.sampled_from(("box", "Pump_2", "reg1"))), "title": draw(ASCII), "version": draw(ASCII)}
    if draw(st.booleans()):
        made["doc"] = draw(DOC)
    if draw(st.booleans()):
        made["identity"] = {
            "vendor": draw(ASCII),
            "url": draw(ASCII),
            "private": {0x80: draw(ASCII)},
            "server_id": [9, 0],
        }
    made["line"] = {
        "address": draw(st.integers(1, 247)),
        "baud": draw(st.sampled_from((9600, 115200))),
        "format": draw(st.sampled_from(("8E1", "8N2"))),
        "run_time": draw(st.booleans()),
    }
    made["word_order"] = draw(st.sampled_from(("big", "little")))
    if draw(st.booleans()):
        made["core"] = {"RESPONSE_DELAY": draw(st.integers(0, 4095))}
    tables = ["coils", "discrete_inputs", "input_registers", "holding_registers"]
    chosen = draw(st.lists(st.sampled_from(tables), min_size=1, unique=True))
    number = 0
    for table in chosen:
        items, at = [], draw(st.integers(0, 60000))
        if draw(st.booleans()):
            items.append({"gaps": "zero"})
        for _ in range(draw(st.integers(1, 4))):
            at += draw(st.integers(0, 3))
            item, at = draw(point(table, draw(st.sampled_from(("p", "default_", "value", "Ab"))) + str(number), at))
            number += 1
            items.append(item)
        made[table] = items
    if draw(st.booleans()):
        made["fifos"] = [{"at": 65000, "name": "queue", "depth": draw(st.integers(1, 31)), "doc": draw(TEXT)}]
    if draw(st.booleans()):
        made["files"] = [{"number": 3, "name": "log", "records": 100, "access": "ro"}]
    return made
