# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Counters, event log, diagnostic register and listen-only mode of a device, beside the model's.

Read twice: at the status port, which the line must not notice, and on the line by function codes
08, 0B and 0C.
"""

from cocotb.triggers import RisingEdge, with_timeout
from protocol import frames
from protocol.defs import (
    ALL_COUNTERS,
    COUNTER_ADDRESS,
    COUNTERS,
    ENTRIES_ADDRESS,
    FC,
    LISTEN_ADDRESS,
    LOG_ADDRESS,
    REGISTER_ADDRESS,
    Sub,
)

# Instances on the way from a bench to the counters, the inner ones first: Icarus finds a name in outer scopes too
INNER = ("u_engine", "u_core", "u_bench", "u_slave")
PORT_PATIENCE_US = 1_000
LAST_ACTION_CLOCKS = 64  # a clear or a restart comes after its answer


def named(bytes_):
    """Log bytes for people, newest first."""
    return bytes(bytes_).hex(" ").upper() or "empty"


class Readout:
    """Part of Bench: what the host sees of the diagnostics."""

    async def counter(self, address):
        """One read at the status port; the value."""
        return await with_timeout(self._counter(address), PORT_PATIENCE_US, "us")

    async def _counter(self, address):
        dut = self.dut
        await RisingEdge(dut.clk_i)
        dut.status_adr_i.value, dut.status_stb_i.value = address, 1
        while True:
            await RisingEdge(dut.clk_i)
            if int(dut.status_ack_o.value):
                break
        value = int(dut.status_dat_o.value)
        dut.status_stb_i.value = 0
        await RisingEdge(dut.clk_i)
        assert not int(dut.status_ack_o.value), "status_ack_o stays up without status_stb_i"
        return value

    async def read_counters(self):
        """{name: value} of all nine, from the status port."""
        return {name: await self.counter(COUNTER_ADDRESS[name]) for name in ALL_COUNTERS}

    async def read_log(self):
        """The event log from the status port, newest first."""
        count = await self.counter(ENTRIES_ADDRESS)
        return [await self.counter(LOG_ADDRESS + place) for place in range(count)]

    async def diagnostic_register(self):
        """The diagnostic register from the status port."""
        return await self.counter(REGISTER_ADDRESS)

    async def compare_outputs(self, note=""):
        """Listen-only mode at its port and at the status port, the diagnostic register, the length of the log."""
        listening = int(self.slave.listen_only)
        for what, seen, expected in (
            ("listen_only_o", int(self.dut.listen_only_o.value), listening),
            ("listen-only mode", await self.counter(LISTEN_ADDRESS), listening),
            ("diagnostic register", await self.diagnostic_register(), self.slave.diagnostic_register),
            ("entries of the log", await self.counter(ENTRIES_ADDRESS), len(self.slave.log)),
        ):
            assert seen == expected, f"{note}: {what}: {seen:04X}, expected {expected:04X}"

    async def compare_counters(self, note="", line=False):
        """Everything that is counted and logged must be the model's; with `line` asked there as well.

        Asking on the line counts and logs too, in the model as well; in listen-only mode it is left out.
        Returns (counters, log) as read at the counter port.
        """
        await self.clocks(LAST_ACTION_CLOCKS)
        await self.compare_outputs(note)
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
        core = self.dut
        while not hasattr(core, "gen_diagnostics"):  # benches stand around the core
            core = next(getattr(core, name) for name in INNER if hasattr(core, name))
        return core.gen_diagnostics.u_diagnostics.memory

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
