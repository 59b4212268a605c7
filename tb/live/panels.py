# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Panels without a browser: a process that asks as panel.js does, until its standard input ends.

    panels.py URL COUNT

At the end it prints, as JSON, how many messages each has got.
"""

import asyncio
import contextlib
import json
import sys

import aiohttp

EVERY_S = 0.7  # POLL_MS of panel.js
ASKED = (
    *({"op": name} for name in ("status", "state", "faults", "signals")),
    {"op": "read", "table": "holdings", "first": 0, "count": 40},
)


async def listen(socket, got, number):
    """Count what comes."""
    async for _ in socket:
        got[number] += 1


async def panel(session, url, got, number):
    """One panel."""
    async with session.ws_connect(f"{url}/api/events") as socket:
        listening, asked = asyncio.create_task(listen(socket, got, number)), 0
        if number == len(got) - 1:
            print("open", flush=True)
        with contextlib.suppress(asyncio.CancelledError):
            while True:
                for message in ASKED:
                    asked += 1
                    await socket.send_json({"id": asked, **message})
                await asyncio.sleep(EVERY_S)
        listening.cancel()


async def main():
    """All of them, until the end of standard input."""
    url, count = sys.argv[1], int(sys.argv[2])
    got = [0] * count
    async with aiohttp.ClientSession() as session:
        tasks = [asyncio.create_task(panel(session, url, got, number)) for number in range(count)]
        await asyncio.to_thread(sys.stdin.read)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    print(json.dumps(got))


if __name__ == "__main__":
    asyncio.run(main())
