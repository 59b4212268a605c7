# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""What a caller is told when he asks for something that cannot be."""


class Refused(Exception):
    """Bad input, or what the device refuses; the text is for people."""


class Unknown(Refused):
    """No such table, point, frame or fault."""
