#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The server beside the bridge: started by serve.py for WEB, LOG, SIGNALS and SCRIPT; ends when the bridge does.

    control_server.py --control-fd N --facts-fd N [--web-fd N] [--tcp-fd N] [--rtu-tcp-fd N] [NAME=VALUE]...

Exit status 0 when the bridge has gone.  Nothing here can stop the line: the bridge waits for nobody.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import signal
import socket
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "sim"), str(ROOT / "tb")]

from bridge_link import BridgeLink  # noqa: E402
from server.device import Device  # noqa: E402
from server.errors import Refused  # noqa: E402
from server.explain import Log  # noqa: E402
from server.script import Script  # noqa: E402
from server.values import from_file  # noqa: E402

NICE = 5  # the line goes first


def say(text: str) -> None:
    """A line for people."""
    print(f"serve: {text}", file=sys.stderr, flush=True)


def facts_of(descriptor: int) -> dict:
    """What serve.py says of the device."""
    with os.fdopen(descriptor, "rb") as file:
        file.seek(0)
        return json.loads(file.read())


def warn(event: dict) -> None:
    """What the user must see even without LOG."""
    if event["event"] == "script" or (event["event"] == "dropped" and event.get("count")):
        say(event.get("text") or f"{event['count']} events were dropped: this server was too slow")


async def run(arguments: argparse.Namespace, variables: dict[str, str]) -> None:
    """Until the bridge is gone."""
    facts = facts_of(arguments.facts_fd)
    link = await BridgeLink.open(arguments.control_fd)
    device = Device(link, facts)
    tasks = [asyncio.create_task(device.listen())]
    device.listeners.append(warn)
    if variables.get("LOG"):
        device.listeners.append(Log(sys.stderr, sys.stderr.isatty() and "NO_COLOR" not in os.environ).tell)
    if variables.get("SIGNALS"):
        for point, signal_ in from_file(variables["SIGNALS"]).items():
            try:
                await device.attach(point, **signal_)
            except Refused as error:
                say(f"SIGNALS={variables['SIGNALS']}: {point}: {error}")
    if variables.get("SCRIPT"):
        device.script = Script(variables["SCRIPT"], device, device.tell)
        tasks.append(asyncio.create_task(device.script.run()))
    tasks.append(asyncio.create_task(device.move()))
    server = None
    if arguments.web_fd is not None:
        from server.web import Server

        listening = socket.socket(fileno=arguments.web_fd)
        listening.setblocking(False)
        server = Server(device, listening, (ROOT / "VERSION").read_text(encoding="utf-8").strip())
        await server.start()
        host, port = listening.getsockname()[:2]
        say(f"panel at http://{f'[{host}]' if ':' in host else host}:{port}/")
    gateways = {"tcp": arguments.tcp_fd, "rtu_tcp": arguments.rtu_tcp_fd}
    if any(fd is not None for fd in gateways.values()):
        import gateway

        sockets = [None if fd is None else socket.socket(fileno=fd) for fd in gateways.values()]
        await gateway.start(link, *sockets)
    await link.closed()
    if device.script:
        await device.script.end()
    for task in tasks:
        task.cancel()
    if server:
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(server.stop(), 1)


def main() -> int:
    """Entry point."""
    parser = argparse.ArgumentParser()
    for name in ("control", "facts", "web", "tcp", "rtu-tcp"):
        parser.add_argument(f"--{name}-fd", type=int)
    parser.add_argument("variables", nargs="*")
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the bridge ends first, and we with it
    os.nice(NICE)
    variables = dict(word.partition("=")[::2] for word in arguments.variables)
    asyncio.run(run(arguments, variables))
    return 0


if __name__ == "__main__":
    sys.exit(main())
