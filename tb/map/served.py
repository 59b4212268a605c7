# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A device served by pymodbus on a TCP port: addresses without a point answer exception 02."""

import asyncio
import threading

from pymodbus.client import ModbusTcpClient
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

READS = {"coils": 1, "discrete_inputs": 2, "holding_registers": 3, "input_registers": 4}


class Served:
    """With a Device: the server runs in a thread until the end of the block."""

    def __init__(self, device):
        self.device, self.port, self.clients = device, 0, []
        self.tables = {table: {} for table in READS}  # values by address
        for point in device.points:
            for item in range(point.count):
                raw = point.resets[item] if item < len(point.resets) else 0
                self.tables[point.table] |= dict(zip(point.addresses(item), point.registers(raw)))

    async def _action(self, function, start, address, count, current, values):
        """The tables of this class are what is read and written."""
        table = {1: "coils", 5: "coils", 15: "coils", 2: "discrete_inputs", 4: "input_registers"}.get(
            function, "holding_registers"
        )
        if values is not None:
            self.tables[table].update({address + k: int(value) for k, value in enumerate(values)})
        elif table.endswith("registers"):
            for k in range(count):
                current[address - start + k] = self.tables[table].get(address + k, 0)
        return None

    def _simdata(self, table):
        kind, zero = (DataType.REGISTERS, 0) if table.endswith("registers") else (DataType.BITS, False)
        rows, addresses = [], sorted(self.tables[table])
        for address in addresses:
            if rows and rows[-1][0] + rows[-1][1] == address:
                rows[-1][1] += 1
            else:
                rows.append([address, 1])
        return [SimData(at, count=count, values=zero, datatype=kind) for at, count in rows] or [
            SimData(60000, count=1, values=zero, datatype=kind)
        ]

    async def _serve(self, started):
        order = ("coils", "discrete_inputs", "holding_registers", "input_registers")
        simulated = SimDevice(
            self.device.line.address, simdata=tuple(self._simdata(table) for table in order), action=self._action
        )
        self.server = ModbusTcpServer(simulated, address=("127.0.0.1", 0))
        self.loop = asyncio.get_running_loop()
        await self.server.listen()
        self.port = self.server.transport.sockets[0].getsockname()[1]
        started.set()
        try:
            await self.server.serving
        except asyncio.CancelledError:
            pass

    def __enter__(self):
        started = threading.Event()
        self.thread = threading.Thread(target=lambda: asyncio.run(self._serve(started)), name="served", daemon=True)
        self.thread.start()
        assert started.wait(5), "the server did not start"
        return self

    def __exit__(self, *_):
        for client in self.clients:
            client.close()
        asyncio.run_coroutine_threadsafe(self.server.shutdown(), self.loop)
        self.thread.join(5)

    def client(self):
        """A connected blocking client."""
        self.clients.append(ModbusTcpClient("127.0.0.1", port=self.port))
        assert self.clients[-1].connect()
        return self.clients[-1]

    def put(self, point, raws):
        """Sets the raw values of a point's items."""
        for item, raw in enumerate(raws):
            self.tables[point.table] |= dict(zip(point.addresses(item), point.registers(raw)))

    def get(self, point):
        """The raw values of a point's items."""
        table = self.tables[point.table]
        return [point.join([table[k] for k in point.addresses(item)]) for item in range(point.count)]
