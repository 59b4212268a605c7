# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Who the reference slave says it is: function codes 11 and 2B/0E (V1.1b3 6.13, 6.21)."""

from .defs import (
    BASIC,
    DEVICE_ID_HEAD,
    EX,
    EXTENDED,
    INDIVIDUAL,
    INDIVIDUAL_ACCESS,
    LEVEL_LAST,
    MEI_DEVICE_ID,
)
from .diagnostics import Refused

DEVICE_ID_REQUEST = 4  # bytes
RUNNING, STOPPED = 0xFF, 0x00
MORE, NO_MORE = 0xFF, 0x00


def server_id(config, pdu, running):
    """FC 11."""
    if len(pdu) != 1:
        raise Refused(EX.VALUE)
    body = config.server_id + bytes([RUNNING if running else STOPPED]) + config.additional_data
    return pdu + bytes([len(body)]) + body


def device_identification(config, pdu):
    """FC 2B with MEI type 0E; other types are not supported."""
    if len(pdu) < 2:
        raise Refused(EX.VALUE)
    if pdu[1] != MEI_DEVICE_ID:
        raise Refused(EX.FUNCTION)
    if len(pdu) != DEVICE_ID_REQUEST:
        raise Refused(EX.VALUE)
    code, first = pdu[2:]
    if not BASIC <= code <= INDIVIDUAL:
        raise Refused(EX.VALUE)
    if code == INDIVIDUAL:
        return _individual(config, pdu, first)
    level = min(code, config.conformity & ~INDIVIDUAL_ACCESS, EXTENDED)
    category = [i for i in sorted(config.objects) if i <= LEVEL_LAST[level]]
    left = [i for i in category if i >= first] if first in category else category
    sent, size = [], DEVICE_ID_HEAD
    while left and size + 2 + len(config.objects[left[0]]) <= config.device_id_limit:
        size += 2 + len(config.objects[left[0]])
        sent.append(left.pop(0))
    more = (MORE, left[0]) if left else (NO_MORE, 0)
    return _answer(config, pdu, more, sent)


def _individual(config, pdu, wanted):
    if not config.conformity & INDIVIDUAL_ACCESS:
        raise Refused(EX.VALUE)
    if wanted not in config.objects:
        raise Refused(EX.ADDRESS)
    return _answer(config, pdu, (NO_MORE, 0), [wanted])


def _answer(config, pdu, more, sent):
    body = b"".join(bytes([i, len(config.objects[i])]) + config.objects[i] for i in sent)
    return pdu[:3] + bytes([config.conformity, *more, len(sent)]) + body
