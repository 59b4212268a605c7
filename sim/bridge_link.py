# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The control server's end of the channel to the bridge: commands with replies, and the events of the line.

    link = await BridgeLink.open(descriptor)
    values = (await link.call("read", 17, 3, 0, 10))["values"]
    async for event in link.events(): ...

Commands and events: "The control channel" in README.md beside this file. Standard library only.
"""

from __future__ import annotations

import asyncio
import json
import socket
from collections import deque
from collections.abc import AsyncIterator
from typing import Any

LONGEST_LINE = 16 << 20  # a frame with all its edges is far below
KEPT_EVENTS = 10_000  # for a reader; beyond them the oldest are lost


class BridgeError(Exception):
    """The bridge refuses a command; the text says why."""


class BridgeGone(BridgeError):
    """The bridge has ended."""


class Events:
    """The events since this reader came, at most KEPT_EVENTS of them; `lost` counts the others."""

    def __init__(self) -> None:
        self.kept: deque[dict[str, Any]] = deque()
        self.lost = 0
        self.more = asyncio.Event()
        self.ended = False

    def put(self, event: dict[str, Any] | None) -> None:
        """Another event; None after the last one."""
        if event is None:
            self.ended = True
        else:
            if len(self.kept) >= KEPT_EVENTS:
                self.kept.popleft()
                self.lost += 1
            self.kept.append(event)
        self.more.set()

    def __aiter__(self) -> AsyncIterator[dict[str, Any]]:
        return self

    async def __anext__(self) -> dict[str, Any]:
        while not self.kept:
            if self.ended:
                raise StopAsyncIteration
            self.more.clear()
            await self.more.wait()
        return self.kept.popleft()


class BridgeLink:
    """The channel. `hello` says what line it is."""

    hello: dict[str, Any]

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer
        self._waiting: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._number = 0
        self._readers: list[Events] = []
        self._task: asyncio.Task[None] | None = None

    @classmethod
    async def open(cls, descriptor: int) -> BridgeLink:
        """Take over the descriptor of --control-fd, and wait for the bridge's hello."""
        made = socket.socket(fileno=descriptor)
        made.setblocking(False)
        link = cls(*await asyncio.open_unix_connection(sock=made, limit=LONGEST_LINE))
        line = await link._reader.readline()
        if not line:
            raise BridgeGone("the bridge has not started")
        link.hello = json.loads(line)
        link._task = asyncio.create_task(link._read())
        return link

    async def call(self, verb: str, *arguments: object) -> dict[str, Any]:
        """The reply to a command. Raises BridgeError."""
        if self._task is None or self._task.done():
            raise BridgeGone("the bridge has ended")
        self._number += 1
        future: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()
        self._waiting[self._number] = future
        words = [str(self._number), verb, *(str(int(a) if isinstance(a, bool) else a) for a in arguments)]
        self._writer.write((" ".join(words) + "\n").encode("ascii", "replace"))
        reply = await future
        if "error" in reply:
            raise BridgeError(reply["error"])
        return reply

    def events(self) -> Events:
        """The events from now on; each caller gets all of them."""
        made = Events()
        self._readers.append(made)
        return made

    def forget(self, events: Events) -> None:
        """This reader has ended."""
        if events in self._readers:
            self._readers.remove(events)

    async def closed(self) -> None:
        """Returns when the bridge has ended."""
        if self._task:
            await asyncio.shield(self._task)

    async def _read(self) -> None:
        try:
            while line := await self._reader.readline():
                message = json.loads(line)
                if "id" in message:
                    if (future := self._waiting.pop(message["id"], None)) and not future.done():
                        future.set_result(message)
                    continue
                for events in self._readers:
                    events.put(message)
        except ConnectionError:
            pass
        finally:
            for events in self._readers:
                events.put(None)
            for future in self._waiting.values():
                if not future.done():
                    future.set_exception(BridgeGone("the bridge has ended"))
            self._waiting.clear()
            self._writer.close()
