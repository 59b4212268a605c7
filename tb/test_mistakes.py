# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The scripted mistakes of mistakes.py fit the RTL as it is; `make mistakes` plants them."""

import pytest
from mbrtu.runner import ROOT
from mistakes import MISTAKES


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_mistake_can_be_planted(mistake):
    """Its text is found, and only once, so what is planted is what was meant."""
    text = (ROOT / "rtl" / mistake.file).read_text()
    found = text.count(mistake.old)
    assert found == 1, f"{mistake.old!r} occurs {found} times in rtl/{mistake.file}"
    assert mistake.new != mistake.old
