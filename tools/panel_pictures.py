#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Draw the pictures of the panel in docs/: a relay box whose sensor moves, a master, and a frame broken on purpose.

    panel_pictures.py

Needs the packages of `make test` and chromium.
"""

from __future__ import annotations

import os
import shutil
import sys
import time
from pathlib import Path

from common import ROOT

sys.path[:0] = [str(ROOT / "tb"), str(ROOT / "sim")]

from live.web import Device, browser, page  # noqa: E402
from protocol import frames  # noqa: E402

MAP = "examples/relay_box/relay_box.yaml"
SIGNALS = "examples/relay_box/moving.json"
ADDRESS = 17
REQUESTS = (
    frames.read(4, 0, 1),
    frames.write_coil(2, True),
    frames.read(2, 0, 1),
    frames.write_register(0, 300),
    frames.read(3, 0, 1),
    frames.read(3, 1, 1),
    frames.read(4, 0, 1),
)
# File: width, height, colours, the whole page
PICTURES = {
    "panel.png": (1360, 830, "light", False),
    "panel_dark.png": (1360, 830, "dark", False),
    "panel_narrow.png": (360, 1500, "dark", False),
}
SETTLE_S = 2.0


def play(device: Device) -> None:
    """A master, and a gap in its last request."""
    for pdu in REQUESTS:
        device.client.send(frames.adu(ADDRESS, pdu).hex())
        time.sleep(0.15)
    device.client.fault("gap", character=3, amount=2)
    device.client.send(frames.adu(ADDRESS, frames.read(4, 0, 1)).hex())


def main() -> int:
    """Play, and draw each picture."""
    if not shutil.which("chromium"):
        print("panel_pictures: chromium is not installed", file=sys.stderr)
        return 1
    os.chdir(ROOT)
    Path("build").mkdir(exist_ok=True)
    with Device(Path("build"), MAP=MAP, SIGNALS=SIGNALS) as device:
        time.sleep(SETTLE_S)
        play(device)
        with browser() as chromium:
            for name, (width, height, scheme, whole) in PICTURES.items():
                size = {"width": width, "height": height}
                with page(chromium, device.url, viewport=size, color_scheme=scheme) as panel:
                    panel.locator("#list li.silent.error").last.click()
                    panel.wait_for_function("document.getElementById('wave-note').textContent.includes('t1.5')")
                    panel.wait_for_timeout(900)
                    panel.evaluate("window.scrollTo(0, 0)")
                    panel.screenshot(path=str(ROOT / "docs" / name), full_page=whole)
                    print(f"panel_pictures: docs/{name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
