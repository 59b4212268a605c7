# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A live device whose control server is the test: commands, replies, events."""

import json
import select
import socket
import subprocess
import sys
import time

from live.serve import ROOT, START_SECONDS, Serve

REPLY_SECONDS = 10


class Refused(Exception):
    """The bridge's error text."""


class Controlled(Serve):
    """A running device with `call`, `events` and `wait_for`; a context manager."""

    def __enter__(self):
        ours, theirs = socket.socketpair()
        self.channel, self.events, self.number, self.rest = ours, [], 0, b""
        variables = self.variables | {"CONTROL_FD": theirs.fileno()}
        command = [sys.executable, str(ROOT / "sim" / "serve.py"), *(f"{k}={v}" for k, v in variables.items())]
        with self.log.open("w", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                command, cwd=ROOT, stdout=subprocess.PIPE, stderr=log, pass_fds=[theirs.fileno()]
            )
        theirs.close()
        self.hello = self.wait_for("hello", START_SECONDS)
        assert self.process.stdout.readline().startswith(b"ready "), self.stderr()
        return self

    def __exit__(self, *error):
        self.channel.close()
        super().__exit__(*error)

    def _read(self, deadline):
        """Messages that have come; waits for one until the deadline."""
        left = deadline - time.monotonic()
        assert left > 0 and select.select([self.channel], [], [], left)[0], (
            f"nothing came: {[e.get('event') for e in self.events][-5:]}"
        )
        data = self.channel.recv(1 << 20)
        assert data, f"the bridge has ended: {self.stderr()}"
        *lines, self.rest = (self.rest + data).split(b"\n")
        return [json.loads(line) for line in lines]

    def call(self, verb, *arguments):
        """The reply to a command. Raises Refused."""
        self.number += 1
        self.channel.sendall(" ".join(map(str, (self.number, verb, *arguments))).encode() + b"\n")
        deadline, reply = time.monotonic() + REPLY_SECONDS, None
        while reply is None:
            for message in self._read(deadline):
                if message.get("id") == self.number:
                    reply = message
                else:
                    self.events.append(message)
        if "error" in reply:
            raise Refused(reply["error"])
        return reply

    def read(self, space, item, count=1, slave=0):
        """Items through the host port."""
        return self.call("read", slave, int(space), item, count)["values"]

    def send(self, frame):
        """(answer, verdict) of a frame on the line."""
        reply = self.call("send", frame.hex())
        return bytes.fromhex(reply["answer"]), reply["verdict"]

    def counters(self, slave=0):
        """The counters of the core."""
        return self.call("status", slave)["counters"]

    def wait_for(self, kind, seconds=5, **wanted):
        """The next event of this kind with these entries; it and those before it are taken away."""
        deadline = time.monotonic() + seconds
        while True:
            for i, event in enumerate(self.events):
                if event.get("event") == kind and all(event.get(k) == v for k, v in wanted.items()):
                    del self.events[: i + 1]
                    return event
            self.events += self._read(deadline)
