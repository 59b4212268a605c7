# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The panel of a live device, in Chromium as its users have it."""

import re

import pytest
import serial
from live_client import LiveError
from protocol import frames

from .web import Device, needs_chromium, page

pytestmark = needs_chromium
ADDRESS, BAUD = 17, 19200
MAP = "examples/relay_box/relay_box.yaml"
NARROW = {"viewport": {"width": 360, "height": 800}}
SMALLEST_CONTRAST = 4.5  # WCAG 2.1, 1.4.3

# Pixels of the canvas that are not transparent
PAINTED = """() => {
  const canvas = document.getElementById('canvas');
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  return data.filter((value, i) => i % 4 === 3 && value).length;
}"""

# Texts whose colour is too near to that behind them
POOR_CONTRAST = """(limit) => {
  const linear = (v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const light = (colour) => {
    const [r, g, b] = colour.match(/[\\d.]+/g).slice(0, 3).map((v) => linear(v / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = getComputedStyle(e).backgroundColor;
      if (!/, 0\\)$|transparent/.test(colour)) return colour;
    }
    return 'rgb(255, 255, 255)';
  };
  const poor = [];
  for (const e of document.querySelectorAll('body *')) {
    const says = [...e.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!e.offsetParent || !says) continue;
    const [high, low] = [light(getComputedStyle(e).color), light(behind(e))].sort((a, b) => b - a);
    const ratio = (high + 0.05) / (low + 0.05);
    if (ratio < limit) poor.push(`${e.tagName}#${e.id} ${e.textContent.slice(0, 20)}: ${ratio.toFixed(2)}`);
  }
  return poor;
}"""

# Fields and buttons without a name
NAMELESS = """() => [...document.querySelectorAll('input, select, button, textarea')]
  .filter((e) => e.offsetParent)
  .filter((e) => !(e.labels && e.labels.length && e.labels[0].textContent.trim()))
  .filter((e) => !e.getAttribute('aria-label') && !e.textContent.trim())
  .map((e) => e.outerHTML)"""


@pytest.fixture(scope="module")
def device(tmp_path_factory):
    """The standard device."""
    with Device(tmp_path_factory.mktemp("panel"), BAUD=BAUD) as made:
        yield made


@pytest.fixture
def panel(chromium, device):
    """The panel, opened."""
    with page(chromium, device.url) as made:
        yield made


def ask(device, pdu, count, patience=5):
    """A request by a master at the terminal; what comes within so many seconds."""
    with serial.Serial(str(device.link), BAUD, timeout=patience) as port:
        port.write(frames.adu(ADDRESS, pdu))
        return port.read(count)


def value(panel, address):
    """What the cell of an address shows."""
    return panel.inner_text(f"#cells .cell:has(small:text-is('{address}')) span")


def test_register_is_written_by_hand_and_read_by_the_master(panel, device):
    """Click, type, Enter."""
    panel.click("[data-table=holdings]")
    panel.click("#cells .cell:has(small:text-is('5'))")
    panel.keyboard.type("0x1234")
    panel.keyboard.press("Enter")
    panel.wait_for_function("document.querySelectorAll('#cells .cell span')[5].textContent === '4660'")
    assert ask(device, frames.read(3, 5, 1), 7)[3:5] == bytes([0x12, 0x34])


def test_master_writes_and_the_panel_shows_it(panel, device):
    """The cell, the frame in words, the counters."""
    panel.click("[data-table=holdings]")
    ask(device, frames.write_register(7, 777), 8)
    panel.wait_for_function("document.querySelectorAll('#cells .cell span')[7].textContent === '777'")
    panel.wait_for_selector("#list .words:has-text('write holding register 7 = 777')")
    panel.wait_for_function("Number(document.querySelector('[data-name=slave_message]').textContent) > 0")


def test_fault_at_a_button_and_why_it_was_silent(panel, device):
    """Choose, break, ask: the row says why, the waveform shows where."""
    panel.select_option("#kind", "gap")
    panel.fill("#fault-values [name=amount]", "2.5")
    panel.click("#fault-form button[type=submit]")
    panel.wait_for_selector("#active-faults li:has-text('gap of 2.5 characters')")
    assert ask(device, frames.read(3, 0, 1), 1, patience=1) == b""
    row = panel.locator("#list li.silent.error").last
    row.wait_for()
    assert "gap above t1.5" in row.inner_text() and "gap of 2.5 characters before character 1" in row.inner_text()
    row.click()
    panel.wait_for_function("document.getElementById('wave-note').textContent.includes('more than t1.5')")
    assert panel.evaluate(PAINTED) > 1000
    panel.wait_for_function("!document.querySelector('#active-faults li')")


def test_bits_as_sampled_when_the_waveform_is_near(panel, device):
    """Zoomed in by keys, the view is narrower; out again shows all."""
    panel.click("#clear")  # frames of earlier tests, which scroll away under the mouse when the new ones come
    ask(device, frames.read(3, 0, 1), 7)
    panel.locator("#list li.answer").click()
    panel.wait_for_function("document.getElementById('wave-note').textContent.includes('after the end')")
    panel.focus("#canvas")
    before = panel.evaluate("document.getElementById('canvas').toDataURL()")
    for _ in range(4):
        panel.keyboard.press("+")
    assert panel.evaluate("document.getElementById('canvas').toDataURL()") != before
    panel.keyboard.press("0")
    assert panel.evaluate("document.getElementById('canvas').toDataURL()") == before


def test_keyboard_alone(panel, device):
    """Frames, tables and faults without a mouse."""
    ask(device, frames.read(3, 0, 1), 7)
    panel.wait_for_selector("#list li.answer")
    panel.keyboard.press("f")
    panel.keyboard.press("End")
    panel.keyboard.press("ArrowUp")
    assert panel.locator("#list li[aria-selected=true]").count() == 1
    panel.keyboard.press("t")
    for key in ("ArrowRight", "ArrowRight", "Enter"):
        panel.keyboard.press(key)
    panel.keyboard.type("99")
    panel.keyboard.press("Enter")
    panel.wait_for_function("document.querySelectorAll('#cells .cell span')[2].textContent !== '0'")
    panel.keyboard.press("b")
    assert panel.evaluate("document.activeElement.id") == "kind"
    panel.evaluate("document.activeElement.blur()")
    panel.keyboard.press("?")
    assert panel.locator("#keys").is_visible()


def test_device_state_and_refusals(panel, device):
    """Busy at a tick; a wrong value is refused in words, and the page goes on."""
    panel.check("#state-form [name=busy]")
    panel.wait_for_selector("#lights .bad:has-text('busy')")
    assert ask(device, frames.read(3, 0, 1), 5)[2] == 6
    panel.uncheck("#state-form [name=busy]")
    panel.wait_for_selector("#lights .bad:has-text('busy')", state="detached")
    panel.click("[data-table=holdings]")
    panel.click("#cells .cell:has(small:text-is('9'))")
    panel.keyboard.type("70000")
    panel.keyboard.press("Enter")
    panel.wait_for_selector("#trouble:has-text('0 to 65535')")
    assert value(panel, 9) == "0"


def test_values_that_move(panel, device):
    """Attached in the form, seen in the cell, taken away."""
    panel.click("[data-table=inputs]")
    panel.fill("#signal-point", "inputs 3")
    panel.select_option("#signal-kind", "counter")
    panel.fill("#signal-values [name=period]", "0.1")
    panel.click("#signal-form button[type=submit]")
    panel.wait_for_selector("#signals-list li:has-text('inputs 3')")
    panel.wait_for_function("Number(document.querySelectorAll('#cells .cell span')[3].textContent) > 2")
    panel.click("#signals-list button")
    panel.wait_for_function("!document.querySelector('#signals-list li')")


def test_send_as_a_master(panel):
    """From the form, with its CRC."""
    panel.select_option("#preset", label="return query data")
    panel.click("#send-form button[type=submit]")
    panel.wait_for_selector("#send-answer:has-text('11 08 00 00 A5 37')")


def test_captures_are_offered(panel, device):
    """Each link gives a file."""
    ask(device, frames.read(3, 0, 1), 7)
    for kind in ("pcapng", "fst", "txt"):
        with panel.expect_download() as got:
            panel.click(f"#downloads a:text-is('{kind}')")
        assert got.value.path().stat().st_size > 50


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_narrow_and_in_both_colours(chromium, device, scheme):
    """360 px without scrolling sideways; text and its background differ enough."""
    with page(chromium, device.url, color_scheme=scheme, **NARROW) as panel:
        ask(device, frames.read(3, 0, 1), 7)
        panel.wait_for_selector("#list li.answer")
        assert panel.evaluate("document.documentElement.scrollWidth") <= 360
        assert not panel.evaluate(POOR_CONTRAST, SMALLEST_CONTRAST)
        dark = panel.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (int(re.findall(r"\d+", dark)[0]) < 100) == (scheme == "dark")


def test_every_field_has_a_label(panel):
    """For those who cannot see it."""
    assert panel.evaluate(NAMELESS) == []


def test_nothing_comes_from_the_network(chromium, device):
    """Every request of the page goes to the device."""
    made, asked = chromium.new_page(), []
    made.on("request", lambda request: asked.append(request.url))
    made.goto(device.url)
    made.wait_for_selector("#lights .good")
    made.close()
    foreign = [url for url in asked if not url.startswith((device.url, "data:", device.url.replace("http", "ws")))]
    assert asked and not foreign


def test_panel_finds_its_device_again(chromium, tmp_path):
    """The device ends: the page says so; it comes back: the page goes on by itself."""
    first = Device(tmp_path, BAUD=BAUD)
    with first, page(chromium, first.url) as panel:
        first.process.terminate()
        first.process.wait()
        panel.wait_for_selector("#trouble:has-text('does not answer')")
        again = Device(tmp_path, BAUD=BAUD)
        again.port, again.url = first.port, first.url
        again.variables["WEB"] = first.port
        with again:
            panel.wait_for_selector("#lights .good:has-text('connected')", timeout=15000)
            assert panel.locator("#trouble").is_hidden()


def test_points_of_a_map(chromium, tmp_path):
    """Names and units; a value is changed by hand; what the host may not write is refused in words."""
    with Device(tmp_path, MAP=MAP) as made, page(chromium, made.url) as panel:
        panel.wait_for_selector("#cells.points .cell:has-text('temperature')")
        panel.click("#cells .cell:has-text('temperature')")
        panel.keyboard.press("Control+a")
        panel.keyboard.type("23.5")
        panel.keyboard.press("Enter")
        panel.wait_for_selector("#cells .cell:has-text('23.5 °C')")
        assert made.client["temperature"] == 23.5
        with pytest.raises(LiveError):
            made.client["limit"] = 1
        assert not panel.is_visible("#state-form"), "a switch that does nothing"
        assert panel.inner_text("#lights") == "connected" and "diagnostic" not in panel.inner_text("#facts")
        with pytest.raises(LiveError, match="busy: this device has no inputs"):
            made.client.state(busy=1)


def test_meter_has_the_switches_that_do_something(chromium, tmp_path):
    with Device(tmp_path, DEVICE="pdm") as made, page(chromium, made.url) as panel:
        panel.wait_for_selector("#state-form :text('busy')")
        shown = panel.eval_on_selector_all("#state-form label", "all => all.filter((l) => !l.hidden).length")
        assert shown == 1
        panel.check("#state-form [name=busy]")
        panel.wait_for_selector("#lights :text('busy')")
        assert made.client.state()["busy"] == 1
        with pytest.raises(LiveError, match="failure: there are busy"):
            made.client.state(failure=4)
