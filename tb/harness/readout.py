# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Counters, event log, diagnostic register and listen-only mode of a device, beside the model's.

Read twice: at the counter port, which the line must not notice, and on the line by function codes
08, 0B and 0C.
"""

from cocotb.triggers import RisingEdge, with_timeout
from protocol import frames
from protocol.defs import ALL_COUNTERS, COUNTER_ADDRESS, COUNTERS, FC, LOG_ADDRESS, Sub

PORT_PATIENCE_US = 1_000
LAST_ACTION_CLOCKS = 64  # a clear or a restart comes after its answer


def named(bytes_):
    """Log bytes for people, newest first."""
    return bytes(bytes_).hex(" ").upper() or "empty"


class Readout:
    """Part of Bench: what the host sees of the diagnostics."""

    async def counter(self, address):
        """One read at the counter port; the value."""
        return await with_timeout(self._counter(address), PORT_PATIENCE_US, "us")

    async def _counter(self, address):
        dut = self.dut
        await RisingEdge(dut.clk_i)
        dut.counter_adr_i.value, dut.counter_stb_i.value = address, 1
        while True:
            await RisingEdge(dut.clk_i)
            if int(dut.counter_ack_o.value):
                break
        value = int(dut.counter_dat_o.value)
        dut.counter_stb_i.value = 0
        await RisingEdge(dut.clk_i)
        assert not int(dut.counter_ack_o.value), "counter_ack_o stays up without counter_stb_i"
        return value

    async def read_counters(self):
        """{name: value} of all nine, from the counter port."""
        return {name: await self.counter(COUNTER_ADDRESS[name]) for name in ALL_COUNTERS}

    async def read_log(self):
        """The event log from the counter port, newest first."""
        count = int(self.dut.log_count_o.value)
        return [await self.counter(LOG_ADDRESS + place) for place in range(count)]

    def compare_outputs(self, note=""):
        """The outputs that show listen-only mode, diagnostic register and length of the log."""
        for port, expected in (
            ("listen_only_o", int(self.slave.listen_only)),
            ("diagnostic_register_o", self.slave.diagnostic_register),
            ("log_count_o", len(self.slave.log)),
        ):
            seen = int(getattr(self.dut, port).value)
            assert seen == expected, f"{note}: {port} is {seen:04X}, expected {expected:04X}"

    async def compare_counters(self, note="", line=False):
        """Everything that is counted and logged must be the model's; with `line` asked there as well.

        Asking on the line counts and logs too, in the model as well; in listen-only mode it is left out.
        Returns (counters, log) as read at the counter port.
        """
        await self.clocks(LAST_ACTION_CLOCKS)
        self.compare_outputs(note)
        seen = await self.read_counters()
        wrong = {n: (seen[n], self.slave.counters[n]) for n in ALL_COUNTERS if seen[n] != self.slave.counters[n]}
        assert not wrong, f"{note}: counters (seen, expected) {wrong}"
        log = await self.read_log()
        assert log == self.slave.log, f"{note}: log {named(log)}, expected {named(self.slave.log)}"
        if line and not self.slave.listen_only:
            await self._compare_on_the_line(note)
        return seen, log

    async def _compare_on_the_line(self, note):
        """Each counter, the register, event counter and log by their functions."""
        pdus = [frames.bare(FC.GET_EVENT_LOG), frames.bare(FC.GET_EVENT_COUNTER)]
        pdus += [frames.diagnostics(sub) for sub in (*COUNTERS.values(), Sub.DIAGNOSTIC_REGISTER)]
        for pdu in pdus:
            if pdu[0] in self.slave.config.functions:
                await self.both(frames.adu(self.setup.address, pdu), note=f"{note}, reading back")

    # -------------------------------------------------------------- what only a simulator can

    @property
    def _memory(self):
        core = self.dut.u_core if hasattr(self.dut, "u_core") else self.dut
        return core.u_engine.gen_diagnostics.u_diagnostics.memory

    async def load_counters(self, **counts):
        """Give counters these values, in the device's memory and in the model; the line must be at rest."""
        for name, value in counts.items():
            self._memory[COUNTER_ADDRESS[name]].value = value
            self.slave.counters[name] = value
        await RisingEdge(self.dut.clk_i)

    async def forge_event(self, true, false):
        """The one event `true` in the log becomes `false`, which no traffic can make."""
        memory = self._memory
        places = [i for i in memory.range if memory[i].value.is_resolvable and int(memory[i].value) == true]
        assert len(places) == 1, f"{len(places)} words of the memory hold {true:02X}"
        memory[places[0]].value = false
        self.slave.log = [false if event == true else event for event in self.slave.log]
        await RisingEdge(self.dut.clk_i)
