# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What several files of tests share."""

import pytest

from .web import browser


@pytest.fixture(scope="module")
def chromium():
    """One browser for this file."""
    with browser() as made:
        yield made
