# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The scripted mistakes of mistakes.py fit the RTL as it is; `make mistakes` plants them."""

import pytest
from harness.runner import source_of
from mistakes import MISTAKES


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_mistake_can_be_planted(mistake):
    """Its text is found, and only once, so what is planted is what was meant."""
    text = source_of(mistake.file).read_text()
    found = text.count(mistake.old)
    assert found == 1, f"{mistake.old!r} occurs {found} times in {mistake.file}"
    assert mistake.new != mistake.old
