# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The memory of a device as its host sees it, beside the model's."""

from cocotb.triggers import RisingEdge, with_timeout
from protocol import frames
from protocol.defs import Space, bus_address

HOST_PATIENCE_US = 5_000


class HostPort:
    """Part of Bench: the host port of modbus_rtu_slave, the vectors of modbus_rtu_slave_io."""

    async def host(self, space, item, write=None):
        """One host access; the value read, or None if the bank answered err."""
        return await with_timeout(self._host(space, item, write), HOST_PATIENCE_US, "us")

    async def _host(self, space, item, write):
        dut = self.dut
        await RisingEdge(dut.clk_i)
        dut.host_cyc_i.value, dut.host_stb_i.value = 1, 1
        dut.host_we_i.value = int(write is not None)
        dut.host_adr_i.value = bus_address(space, item)
        dut.host_dat_i.value = write or 0
        while True:
            await RisingEdge(dut.clk_i)
            ack, err = int(dut.host_ack_o.value), int(dut.host_err_o.value)
            if ack or err:
                value = int(dut.host_dat_o.value) if ack and write is None else 0
                break
        assert not (ack and err), "ack and err together"
        dut.host_cyc_i.value, dut.host_stb_i.value, dut.host_we_i.value = 0, 0, 0
        return value if ack else None

    async def preset(self, key, value):
        """Put `value` at `key` = (space, address) of the device and of the model."""
        self.touched.add(key)
        space, address = key
        if self.has_host or space in (Space.DISCRETES, Space.INPUTS):
            self.slave.memory[key] = value
        if self.has_host:
            assert await self.host(*key, write=value) is not None, f"host cannot write {key}"
            return
        if space in (Space.DISCRETES, Space.INPUTS):
            self._io_inputs()
            return
        if space == Space.COILS:
            pdu = frames.write_coil(address, value)
        else:
            pdu = frames.write_register(address, value)
        await self.both(frames.adu(self.setup.address, pdu))

    def _io_inputs(self):
        """The input vectors of the I/O drop-in, from the model's tables."""
        for space, port, width in ((Space.DISCRETES, "discretes_i", 1), (Space.INPUTS, "inputs_i", 16)):
            base, count = self.slave.config.tables[space]
            value = sum(self.slave.memory[space, base + i] << (width * i) for i in range(count))
            if hasattr(self.dut, port):
                getattr(self.dut, port).value = value

    async def compare(self, keys):
        """The device's memory at `keys` must be the model's."""
        for key in keys:
            expected = self.slave.memory[key]
            seen = await self.read_back(key)
            assert seen == expected, f"{key}: expected {expected:04X}, seen {seen}"

    async def read_back(self, key):
        """What the device holds at `key`, by host port or output vector."""
        if self.has_host:
            return await self.host(*key)
        space, address = key
        port, width = {
            Space.COILS: ("coils_o", 1),
            Space.DISCRETES: ("discretes_i", 1),
            Space.INPUTS: ("inputs_i", 16),
            Space.HOLDINGS: ("holdings_o", 16),
        }[space]
        place = address - self.slave.config.tables[space][0]
        vector = int(getattr(self.dut, port).value)
        return (vector >> (width * place)) & ((1 << width) - 1)
