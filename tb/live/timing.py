# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Claims of time on a machine that may be busy with other things.

What a device does in time is the device's only where a processor is free for it.  So a claim is judged over the time
in which it was measured: with its own bound where the processors were idle for a part of it, else with a generous one.
The figure is printed in either case, with how idle the processors were.
"""

import time

FREE = 0.25  # of the processors idle: a device, a master and the kernel find one when they need it


class Watch:
    """How idle the processors are inside a `with`; `idle` is 0 to 1."""

    def __enter__(self):
        self._before = self._read()
        return self

    def __exit__(self, *_):
        idle, total = (after - before for after, before in zip(self._read(), self._before, strict=True))
        self.idle = idle / max(total, 1)

    def bound(self, free, busy):
        """The bound that holds for what was measured inside."""
        return free if self.idle >= FREE else busy

    def __str__(self):
        return f"processors {100 * self.idle:.0f} % idle"

    @staticmethod
    def _read():
        """(idle, all) of the processors' time so far; a stolen processor is no idle one."""
        with open("/proc/stat", encoding="ascii") as stat:
            times = [int(word) for word in stat.readline().split()[1:9]]
        return times[3] + times[4], sum(times)


def until(good, what, seconds=20):
    """Wait for something to become true."""
    deadline = time.monotonic() + seconds
    while not good():
        assert time.monotonic() < deadline, what() if callable(what) else what
        time.sleep(0.01)
