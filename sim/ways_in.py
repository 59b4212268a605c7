# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""WEB, TCP and RTU_TCP of `make serve`: listening sockets, and the server that is started beside the bridge.

Standard library only.
"""

import os
import re
import socket
import subprocess
import sys
from pathlib import Path

from init_file import BadVariable

SIM = Path(__file__).resolve().parent
LOOPBACK = "127.0.0.1"
BACKLOG = 64
OPTIONS = {"WEB": "--web-fd", "TCP": "--tcp-fd", "RTU_TCP": "--rtu-tcp-fd"}


def place(name, text):
    """(host, port) of "port", "host:port" or "[host]:port"."""
    match = re.fullmatch(r"(?:(?:\[([^\[\]]+)\]|([^:\[\]]+)):)?([0-9]{1,5})", text.strip())
    if not match or not 1 <= int(match[3]) <= 65535:
        raise BadVariable(f"{name}={text}: must be a port from 1 to 65535, or host:port")
    return match[1] or match[2] or LOOPBACK, int(match[3])


def listening(name, text):
    """A socket that listens there."""
    host, port = place(name, text)
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        made = socket.socket(family, kind, protocol)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(address)
        made.listen(BACKLOG)
    except OSError as error:
        raise BadVariable(f"{name}={text}: {error.strerror or error}") from None
    return made


def sockets(values):
    """Listening sockets by variable, for those that are given."""
    return {name: listening(name, values[name]) for name in OPTIONS if values[name]}


def start(listeners, variables, facts):
    """Start the server; the bridge's end of the channel to it, a descriptor that survives exec."""
    ours, theirs = socket.socketpair()
    if "WEB" in listeners or variables:
        venv = SIM.parent / ".venv" / "bin" / "python"
        program = [str(venv) if venv.exists() else sys.executable, str(SIM / "control_server.py")]
    else:
        program = [sys.executable, str(SIM / "gateway.py")]
    program += ["--control-fd", str(theirs.fileno()), "--facts-fd", str(facts)]
    for name, made in listeners.items():
        program += [OPTIONS[name], str(made.fileno())]
    program += [f"{name}={value}" for name, value in variables.items()]
    passed = [theirs.fileno(), facts, *(made.fileno() for made in listeners.values())]
    # Standard output belongs to `ready`.
    subprocess.Popen(program, stdin=subprocess.DEVNULL, stdout=sys.stderr, pass_fds=passed)
    theirs.close()
    os.close(facts)
    os.set_inheritable(ours.fileno(), True)
    return ours.detach()
