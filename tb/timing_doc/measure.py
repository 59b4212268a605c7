# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Measures every figure of docs/timing.md at the pins and writes it as the tables of that document."""

import re

from .ports import bus, host, transaction
from .receiver import looks, mismatch, spikes, spikes_and_mismatch
from .silence import silences
from .starts import answer_starts
from .transmission import driver, transmission

SECTIONS = (
    answer_starts,
    driver,
    transmission,
    looks,
    mismatch,
    spikes,
    spikes_and_mismatch,
    silences,
    transaction,
    bus,
    host,
)
# Three quarters of the time, and their tables: measured by `update.py` and with FULL=1
LONG = {spikes_and_mismatch: "spiked", silences: "silence", mismatch: "baud", spikes: "spikes"}


def everything(lab, clock=None, but=()):
    """{table name: Markdown} of all tables but those of some sections; with `clock` it prints the time each took."""
    out = {}
    for section in (s for s in SECTIONS if s not in but):
        begin = clock() if clock else 0
        out.update(section(lab))
        if clock:
            print(f"{section.__name__}: {clock() - begin:.1f} s", flush=True)
    return out


MARK = re.compile(r"(<!-- measured (\w+) begin -->\n)(.*?)(<!-- measured \2 end -->)", re.DOTALL)


def tables_of(text):
    """{table name: Markdown} of the marked tables in a document."""
    return {name: body.strip() for _, name, body, _ in MARK.findall(text)}


def put_tables(text, measured):
    """The document with its marked tables replaced by what was measured."""
    return MARK.sub(lambda m: f"{m[1]}{measured[m[2]]}\n{m[4]}", text)
