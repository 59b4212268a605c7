# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Scripted stories about counters and log: after each step all of them are what the script says."""

from harness.bench import Bench
from harness.readout import named
from protocol import frames
from protocol.defs import ADDRESSES, ALL_COUNTERS, BROADCAST, LOG_SIZE
from protocol.model import characters

OWN, OTHER = 17, 18
SHORT = {  # names of the counters in the stories
    "frames": "bus_message",
    "bad": "bus_comm_error",
    "refused": "bus_exception",
    "ours": "slave_message",
    "silent": "slave_no_response",
    "nak": "slave_nak",
    "busy": "slave_busy",
    "overrun": "bus_char_overrun",
    "events": "event_counter",
}


def own(pdu):
    """The request to the device."""
    return frames.adu(OWN, pdu)


def everyone(pdu):
    """The same to all."""
    return frames.adu(BROADCAST, pdu)


class Story:
    """A bench, and what its counters and log held after the last step."""

    def __init__(self, tb):
        self.tb = tb
        self.counters, self.log = dict.fromkeys(ALL_COUNTERS, 0), []

    @classmethod
    async def begin(cls, dut, **setup):
        """A device just reset."""
        story = cls(await Bench.start(dut, **setup))
        story.counters, story.log = await story.tb.compare_counters("at the start")
        assert not any(story.counters.values()) and not story.log, "reset leaves something"
        return story

    @property
    def listen_only(self):
        """True in listen-only mode."""
        return bool(int(self.tb.dut.listen_only_o.value))

    async def look(self, note="", line=False):
        """Device against model; what is held now is what the next step starts from."""
        await self.tb.compare_counters(note, line)
        self.counters, self.log = await self.tb.compare_counters(note)

    async def step(self, line, counts, events, note="", cleared=False, emptied=False, **how):
        """Send `line`: the counters named in `counts` (words of SHORT) go up by one, the `events` (hex, oldest
        first) come into the log.  With `cleared` all counters are 0 afterwards, with `emptied` the log holds
        only `events`.  Returns the answer's PDU, None for silence.
        """
        shown = f"{note} {frames.text(bytes(c.byte for c in characters(line))[:16])}"
        answer = await self.tb.both(line, note=note, **how)
        seen, log = await self.tb.compare_counters(shown)
        wanted = dict.fromkeys(ALL_COUNTERS, 0) if cleared else dict(self.counters)
        for word in counts.split():
            wanted[SHORT[word]] = (wanted[SHORT[word]] + 1) % ADDRESSES
        assert seen == wanted, f"{shown}: expected {wanted}, seen {seen}"
        fresh = list(reversed(bytes.fromhex(events)))
        wanted = (fresh + ([] if emptied else self.log))[:LOG_SIZE]
        assert log == wanted, f"{shown}: expected log {named(wanted)}, seen {named(log)}"
        self.counters, self.log = seen, log
        return answer and answer[1:-2]
