#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Modbus TCP and RTU over TCP in front of the simulated line (TCP=, RTU_TCP= of `make serve`).

Modbus TCP: the unit identifier is the slave's address; 0 is a broadcast, which gets no answer. A slave that is silent
gives exception 0B, gateway target device failed to respond (MODBUS Messaging on TCP/IP 1.0b; V1.1b3, clause 7).
RTU over TCP: frames with their check field, as on the line; a frame ends where its function code says so, else with
a pause. Silence stays silence.

    gateway.py --control-fd N --facts-fd N [--tcp-fd N] [--rtu-tcp-fd N]     (started by serve.py)

Standard library only.
"""

from __future__ import annotations

import argparse
import asyncio
import signal
import socket
import struct
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "tb")]

from bridge_link import BridgeError, BridgeLink  # noqa: E402
from protocol import frames  # noqa: E402

MOST_CONNECTIONS = 64
LONGEST_PDU, LONGEST_FRAME = 253, 256
NO_ANSWER = 0x0B  # gateway target device failed to respond
HEADER = struct.Struct(">HHHB")  # transaction, protocol, length, unit
PAUSE_S = 0.02  # ends a frame of RTU over TCP whose length is not known
IDLE_S = 3600  # a connection that says nothing ends


def request_length(frame: bytes) -> int | None:
    """Bytes of the request that `frame` begins with; None if that cannot be told yet, or at all."""
    if len(frame) < 2:
        return None
    code = frame[1]
    if code in (1, 2, 3, 4, 5, 6, 8):
        return None if code == 8 else 8
    if code in (7, 11, 12, 17):
        return 4
    at = {15: 6, 16: 6, 20: 2, 21: 2, 23: 10}.get(code)
    if at is not None:
        return at + 1 + frame[at] + 2 if len(frame) > at else None
    return {22: 10, 24: 6, 43: 7}.get(code)


class Gateway:
    """Connections to one line."""

    def __init__(self, link: BridgeLink) -> None:
        self.link = link
        self.connections: set[asyncio.Task[None]] = set()

    async def ask(self, frame: bytes) -> bytes:
        """What the line answers; empty for silence."""
        reply = await self.link.call("send", frame.hex())
        return bytes.fromhex(reply["answer"])

    async def modbus_tcp(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """One request after the other; what is no Modbus TCP ends the connection."""
        while True:
            head = await asyncio.wait_for(reader.readexactly(HEADER.size), IDLE_S)
            transaction, protocol, length, unit = HEADER.unpack(head)
            if protocol or not 2 <= length <= LONGEST_PDU + 1:
                return
            pdu = await reader.readexactly(length - 1)
            answer = await self.ask(frames.adu(unit, pdu))
            good = len(answer) >= 4 and frames.check(answer) and answer[0] == unit
            if unit == 0:
                continue
            said = answer[1:-2] if good else bytes([pdu[0] | 0x80, NO_ANSWER])
            writer.write(HEADER.pack(transaction, 0, len(said) + 1, unit) + said)
            await writer.drain()

    async def rtu_over_tcp(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Frames as they are on the line."""
        waiting = b""
        while True:
            if not waiting:
                waiting = await asyncio.wait_for(reader.read(LONGEST_FRAME), IDLE_S)
                if not waiting:
                    return
            wanted = request_length(waiting)
            while wanted is None or len(waiting) < wanted:
                try:
                    more = await asyncio.wait_for(reader.read(LONGEST_FRAME), PAUSE_S)
                except asyncio.TimeoutError:
                    break
                if not more or len(waiting) > 2 * LONGEST_FRAME:
                    break
                waiting += more
                wanted = request_length(waiting)
            whole = wanted is not None and len(waiting) >= wanted and frames.check(waiting[:wanted])
            frame = waiting[:wanted] if whole else waiting[: 2 * LONGEST_FRAME]
            waiting = waiting[len(frame) :]
            writer.write(await self.ask(frame))
            await writer.drain()

    def serve(self, talk):
        """A handler of connections for asyncio.start_server."""

        async def handler(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            task = asyncio.current_task()
            if len(self.connections) >= MOST_CONNECTIONS:
                writer.close()
                return
            self.connections.add(task)
            try:
                writer.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                await talk(reader, writer)
            except (OSError, EOFError, BridgeError, asyncio.TimeoutError):
                pass  # the client has gone, is silent for too long, or there is no line any more
            finally:
                self.connections.discard(task)
                writer.close()

        return handler


async def start(link: BridgeLink, tcp: socket.socket | None, rtu_tcp: socket.socket | None) -> Gateway:
    """Serve the listening sockets that are given, until the event loop ends."""
    gateway = Gateway(link)
    if tcp:
        await asyncio.start_server(gateway.serve(gateway.modbus_tcp), sock=tcp)
    if rtu_tcp:
        await asyncio.start_server(gateway.serve(gateway.rtu_over_tcp), sock=rtu_tcp)
    return gateway


async def run(arguments: argparse.Namespace) -> None:
    """Serve until the bridge ends."""
    link = await BridgeLink.open(arguments.control_fd)
    await link.call("pins", "off")  # nobody looks at them
    listeners = [
        socket.socket(fileno=fd) if fd is not None else None for fd in (arguments.tcp_fd, arguments.rtu_tcp_fd)
    ]
    gateway = await start(link, *listeners)
    await link.closed()
    for task in list(gateway.connections):
        task.cancel()


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser()
    for name in ("--control-fd", "--facts-fd", "--tcp-fd", "--rtu-tcp-fd"):
        parser.add_argument(name, type=int)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the end of the bridge is ours
    try:
        asyncio.run(run(parser.parse_args()))
    except BridgeError:
        pass  # the bridge has not come up, and says why


if __name__ == "__main__":
    main()
