# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The register manual: every point in its columns, every text escaped, the page whole by itself."""

import html.parser
import re
import shutil
import subprocess

import pytest
from modbus_map.outputs import manual

from map.output_devices import EVERYTHING, HOSTILE, RELAY_BOX


class Page(html.parser.HTMLParser):
    """Rows of the tables of points, and every tag."""

    VOID = ("meta", "br")

    def __init__(self, text):
        super().__init__()
        self.rows, self.tags, self.open, self.text = [], set(), [], None
        self.feed(text)
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        if tag not in self.VOID:
            self.open.append(tag)
        assert not any(name in ("src", "onload", "onclick") for name, _ in attrs)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.text = True

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        if tag in ("td", "th"):
            self.text = None

    def handle_data(self, data):
        if self.text:
            self.rows[-1][-1] += data


@pytest.mark.parametrize("device", [RELAY_BOX, EVERYTHING], ids=lambda d: d.name)
def test_each_point_is_a_row(device):
    page = Page(manual.page(device))
    rows = {row[2]: row for row in page.rows if len(row) == 9}
    assert set(rows) == {point.name for point in device.points} | {"Name"}
    for point in device.points:
        assert rows[point.name][0].split("–")[0] == str(point.at)
        assert rows[point.name][6] == {"rw": "R/W", "ro": "R", "wo": "W"}[point.access]


def test_columns_of_the_relay_box():
    rows = [row for row in Page(manual.page(RELAY_BOX)).rows if len(row) == 9]
    assert rows[-1] == ["0", "40001", "limit", "i16", "°C", "0.0 … 80.0", "R/W", "45.0", "Value = register × 0.1."]
    assert rows[1][:4] == ["0–3", "00001", "relay", "bool × 4"]


def test_hostile_texts_are_only_texts():
    """No tag, table column or heading comes from a text of the map."""
    text = manual.page(EVERYTHING)
    page = Page(text)
    assert "script" not in page.tags and "<script>" not in text and "http" not in text
    assert sum(HOSTILE in cell for row in page.rows for cell in row) == 1
    marked = manual.markdown(EVERYTHING)
    assert "<script" not in marked
    for line in marked.splitlines():
        if line.startswith("| ") and "`" in line:
            assert len(re.split(r"(?<!\\)\|", line)) in (11, 4), line


BROWSER = next(filter(None, map(shutil.which, ("chromium-headless-shell", "chromium"))), None)


@pytest.mark.skipif(BROWSER is None, reason="Chromium (package chromium-headless-shell) is not installed")
def test_chromium_shows_and_prints_it(tmp_path):
    """The browser's own tree holds the rows; a picture and a PDF come out."""
    (tmp_path / "drive.html").write_text(manual.page(EVERYTHING), encoding="utf-8")
    options = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu"]
    acts = (
        ["--dump-dom"],
        [f"--screenshot={tmp_path}/a.png", "--window-size=1200,900"],
        [f"--print-to-pdf={tmp_path}/a.pdf"],
    )
    for act in acts:
        made = subprocess.run(
            [*options, *act, f"file://{tmp_path}/drive.html"], capture_output=True, text=True, check=True
        )
        if act == ["--dump-dom"]:
            assert len(re.findall(r'<tr id="', made.stdout)) == len(EVERYTHING.points)
            assert "<script" not in made.stdout
    assert (tmp_path / "a.png").stat().st_size > 10_000 and (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
