# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The control interface over HTTP and WebSocket, and the panel: aiohttp around the operations."""

from __future__ import annotations

import asyncio
import ipaddress
import json
import resource
import socket
from collections import deque
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from . import capture, forms
from .device import Device
from .errors import Refused, Unknown
from .operations import OPERATIONS, openapi

ROOT = Path(__file__).resolve().parents[2]
PANEL = ROOT / "sim" / "panel"
FILES = {  # what is served, and nothing else
    "/": ("panel.html", "text/html"),
    "/panel.css": ("panel.css", "text/css"),
    "/faults.js": ("faults.js", "text/javascript"),
    "/panel.js": ("panel.js", "text/javascript"),
    "/socket.js": ("socket.js", "text/javascript"),
}
LARGEST_BODY = 64 * 1024
CONNECTIONS = 200
CLIENT_EVENTS = 2000  # that wait for a slow client
KEEP_ALIVE_S = 15
WRITE_S = 10  # a client that takes nothing for so long is dropped
MOST_CALLS = 64  # of one WebSocket at a time
CAPTURES = {"pcapng": "application/x-pcapng", "fst": "application/octet-stream", "txt": "text/plain"}
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self' ws: wss:",
}


def answer(found: Any, status: int = 200) -> web.Response:
    """JSON."""
    return web.json_response(found, status=status, headers=HEADERS)


def refusal(text: str, status: int) -> web.Response:
    """What is wrong, as JSON of one line."""
    return answer({"error": one_line(text)}, status)


def one_line(text: str) -> str:
    """Without line breaks, whatever the caller has sent."""
    return " ".join(text.split())[:500]


class Busy(asyncio.Protocol):
    """A connection beyond the limit: told so, and closed."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        body = json.dumps({"error": f"{CONNECTIONS} connections are open already"}).encode()
        head = "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\n"
        head += f"Content-Length: {len(body)}\r\nConnection: close\r\n\r\n"
        transport.write(head.encode() + body)  # type: ignore[attr-defined]
        transport.close()


class Client:
    """A WebSocket: calls in, answers and events out, through one bounded queue."""

    def __init__(self, socket_: web.WebSocketResponse) -> None:
        self.socket = socket_
        self.waiting: deque[str] = deque()
        self.wake = asyncio.Event()
        self.dropped = 0

    def put(self, text: str, event: bool = False) -> None:
        """Queue a message; events beyond the limit are counted instead."""
        if event and len(self.waiting) >= CLIENT_EVENTS:
            self.dropped += 1
            return
        self.waiting.append(text)
        self.wake.set()

    async def pump(self) -> None:
        """Send what waits, until the socket is closed."""
        while not self.socket.closed:
            await self.wake.wait()
            self.wake.clear()
            while self.waiting:
                try:
                    await asyncio.wait_for(self.socket.send_str(self.waiting.popleft()), WRITE_S)
                except (ConnectionError, asyncio.TimeoutError):
                    await self.socket.close(code=WSCloseCode.GOING_AWAY)
                    return
                if self.dropped and len(self.waiting) < CLIENT_EVENTS // 2:
                    self.put(json.dumps({"event": "dropped", "count": self.dropped}))
                    self.dropped = 0


class Server:
    """The application over a device."""

    def __init__(self, device: Device, listening: socket.socket, version: str) -> None:
        self.device, self.listening, self.version = device, listening, version
        self.clients: set[Client] = set()
        device.listeners.append(self.broadcast)
        address = ipaddress.ip_address(listening.getsockname()[0])
        self.loopback_only = address.is_loopback
        self.app = web.Application(client_max_size=LARGEST_BODY, middlewares=[self.guard])
        self.route()

    def route(self) -> None:
        """All paths."""
        add = self.app.router.add_route
        for path in FILES:
            add("GET", path, self.file)
        add("GET", "/forms.js", self.forms)
        add("GET", "/openapi.json", self.document)
        add("GET", "/api/events", self.events)
        add("GET", r"/api/capture.{kind:pcapng|fst|txt}", self.capture)
        for op in OPERATIONS.values():
            path = op.path.replace("{name}", "{name:.+}").replace("{point}", "{point:.+}")
            add(op.method, path, self.handler(op.name))

    # ------------------------------------------------------------------ what may come in

    @web.middleware
    async def guard(self, request: web.Request, handler: Any) -> web.StreamResponse:
        """Refuse foreign pages; make every error JSON."""
        if wrong := self.foreign(request):
            return refusal(wrong, 403)
        try:
            return await handler(request)
        except Unknown as error:
            return refusal(str(error), 404)
        except Refused as error:
            return refusal(str(error), 400)
        except web.HTTPRequestEntityTooLarge:
            return refusal(f"more than {LARGEST_BODY} bytes", 413)
        except web.HTTPException as error:
            return refusal(f"{request.method} {request.path[:100]}: {error.reason}", error.status)
        except (UnicodeDecodeError, ValueError) as error:
            return refusal(str(error)[:200], 400)

    def foreign(self, request: web.Request) -> str:
        """Why a request is not for us: a web page of another place asks, or a name that leads here by a trick."""
        host = request.headers.get("Host", "")
        origin = request.headers.get("Origin")
        if origin is not None and origin.partition("://")[2] != host:
            return f"Origin {origin[:100]}: pages of other places are refused"
        name = host.rsplit(":", 1)[0] if not host.endswith("]") else host
        if self.loopback_only and name not in ("localhost", "127.0.0.1", "[::1]"):
            try:
                if ipaddress.ip_address(name.strip("[]")).is_loopback:
                    return ""
            except ValueError:
                pass
            return f"Host {host[:100]}: this server is 127.0.0.1 and localhost only"
        return ""

    # ------------------------------------------------------------------ handlers

    def handler(self, name: str) -> Any:
        """The handler of an operation."""
        op = OPERATIONS[name]

        async def handle(request: web.Request) -> web.Response:
            given: dict[str, Any] = dict(request.match_info)
            for key, value in request.query.items():
                if op.arguments.get(key) is None or op.arguments[key].place != "query":
                    raise Refused(f"{key[:40]}: unknown in the query")
                given[key] = value
            if request.can_read_body:
                body = await request.read()
                try:
                    found = json.loads(body) if body else {}
                except (ValueError, RecursionError) as error:
                    raise Refused(f"the body is not JSON: {error}") from None
                if not isinstance(found, dict):
                    raise Refused("the body must be a JSON object")
                if double := set(found) & set(request.match_info):
                    raise Refused(f"{double.pop()}: stands in the path already")
                given |= found
            return answer(await self.device.call(name, given))

        return handle

    async def file(self, request: web.Request) -> web.Response:
        """A file of the panel."""
        name, kind = FILES[request.path]
        return web.Response(body=(PANEL / name).read_bytes(), content_type=kind, charset="utf-8", headers=HEADERS)

    async def forms(self, _: web.Request) -> web.Response:
        """What the forms of the panel offer."""
        return web.Response(text=forms.script(), content_type="text/javascript", charset="utf-8", headers=HEADERS)

    async def document(self, _: web.Request) -> web.Response:
        """The OpenAPI document."""
        return answer(openapi(self.version))

    async def capture(self, request: web.Request) -> web.Response:
        """The recent frames as a file."""
        kind = request.match_info["kind"]
        frames = list(self.device.frames.kept)
        body = await asyncio.to_thread(capture.made, kind, frames, self.device.hello, self.device.facts.get("link", ""))
        name = {"Content-Disposition": f'attachment; filename="modbus.{kind}"'}
        return web.Response(body=body, content_type=CAPTURES[kind], headers={**HEADERS, **name})

    async def events(self, request: web.Request) -> web.WebSocketResponse:
        """The WebSocket."""
        socket_ = web.WebSocketResponse(heartbeat=20, max_msg_size=LARGEST_BODY, compress=False)
        if not socket_.can_prepare(request):
            raise Refused("this path is a WebSocket")
        await socket_.prepare(request)
        client = Client(socket_)
        self.clients.add(client)
        pump = asyncio.create_task(client.pump())
        room = asyncio.Semaphore(MOST_CALLS)
        calls: set[asyncio.Task[None]] = set()
        try:
            async for message in socket_:
                if message.type != WSMsgType.TEXT:
                    client.put(json.dumps({"event": "warning", "text": "messages must be text"}))
                    continue
                await room.acquire()
                task = asyncio.create_task(self.called(client, message.data))
                calls.add(task)
                task.add_done_callback(lambda done: (calls.discard(done), room.release()))
        finally:
            self.clients.discard(client)
            pump.cancel()
            for task in calls:
                task.cancel()
        return socket_

    async def called(self, client: Client, text: str) -> None:
        """A call of a WebSocket."""
        number: Any = None
        try:
            given = json.loads(text)
            if not isinstance(given, dict):
                raise Refused("a message must be a JSON object")
            number = given.pop("id", None)
            if isinstance(number, (dict, list)):
                raise Refused("id: must be a number or a text")
            result = await self.device.call(given.pop("op", None), given)
            client.put(json.dumps({"id": number, "result": result}))
        except (Refused, ValueError, RecursionError) as error:
            client.put(json.dumps({"id": number, "error": one_line(str(error))}))

    def broadcast(self, event: dict[str, Any]) -> None:
        """An event to all WebSockets."""
        if not self.clients:
            return
        text = json.dumps(event)
        for client in self.clients:
            client.put(text, event=True)

    # ------------------------------------------------------------------ running

    async def start(self) -> None:
        """Serve, on the socket that was opened before."""
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        self.runner = web.AppRunner(self.app, access_log=None, keepalive_timeout=KEEP_ALIVE_S, handle_signals=False)
        await self.runner.setup()

        def connection() -> asyncio.Protocol:
            return self.runner.server() if len(self.runner.server.connections) < CONNECTIONS else Busy()

        self.server = await asyncio.get_running_loop().create_server(connection, sock=self.listening, backlog=128)

    async def stop(self) -> None:
        """The device has ended."""
        self.server.close()
        for client in list(self.clients):
            await client.socket.close(code=WSCloseCode.GOING_AWAY, message=b"the device has ended")
        await self.runner.cleanup()
