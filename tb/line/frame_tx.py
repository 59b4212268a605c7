# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""modbus_frame_tx: what is handed to the transmitter, driver enable around it, the three waits, dropped answers."""

import cocotb
from harness.unit import clocks, settle, start, strobe, watch

CHARACTER = 6  # clocks that a character of this bench takes


class Sender:
    """The module with a transmitter, a frame RAM's count and a wait counter around it."""

    @classmethod
    async def start(cls, dut, count, **inputs):
        self = cls()
        self.dut, self.left, self.taken, self.waited = dut, count, [], []
        self.steps = 0
        self.on_line = 0  # clocks that the character on the line lasts
        await start(dut, count=count, ready=1, **inputs)
        self.sent, self.dropped = watch(dut, "sent_stb"), watch(dut, "dropped_stb")
        cocotb.start_soon(self._around())
        return self

    async def _around(self):
        """One clock after the other: the outputs as they are at the edge, then the inputs for the next."""
        dut, waited = self.dut, 0
        while True:
            await clocks(dut)
            assert not (self.on_line and not int(dut.de_o.value)), "a character without the driver"
            if int(dut.valid_o.value) and int(dut.ready_i.value):
                self.taken.append("check" if int(dut.check_o.value) else self.left)
                self.on_line = CHARACTER
            elif self.on_line:
                self.on_line -= 1
            if int(dut.next_stb_o.value):
                self.left -= 1
                self.steps += 1
            limit = int(dut.wait_limit_o.value)
            limit = limit & 15 if int(dut.wait_short_o.value) else limit
            if int(dut.wait_clear_o.value):
                waited = 0
                over = 0
            else:
                over = int(waited >= limit)
                if over:
                    self.waited.append(limit)
                waited += 1
            dut.wait_over_i.value = over
            dut.count_i.value = self.left
            dut.ready_i.value = int(self.on_line <= 1)

    async def answer(self, most=3000):
        """Start, and wait until the module is at rest again."""
        await strobe(self.dut, start=1)
        await settle()
        assert int(self.dut.sending_o.value) == 1, "sending_o rises a clock behind start_i"
        for clock in range(most):
            if not int(self.dut.sending_o.value):
                await clocks(self.dut, 2)
                return clock
            await clocks(self.dut)
            await settle()
        raise AssertionError("the answer has no end")


@cocotb.test()
@cocotb.parametrize(count=[1, 2, 3, 100, 256])
async def bytes_then_two_check_characters(dut, count):
    tx = await Sender.start(dut, count)
    await tx.answer()
    assert tx.taken == [*range(count, 0, -1), "check", "check"], f"{tx.taken}"
    assert tx.steps == count and len(tx.sent) == 1 and not tx.dropped


@cocotb.test()
@cocotb.parametrize(waits=[(0, 0, 0), (1, 2, 3), (4095, 15, 15), (0, 15, 0), (16, 0, 1), (256, 0, 0)])
async def waits_are_asked_for_in_their_order(dut, waits):
    delay, lead, tail = waits
    tx = await Sender.start(dut, 3, response_delay=delay, de_lead=lead, de_tail=tail)
    await tx.answer(6000)
    seen = [w for i, w in enumerate(tx.waited) if i == 0 or tx.waited[i - 1] != w or w]
    assert [w for w in (delay, lead, tail) if w] == [w for w in seen if w], f"asked for {tx.waited}"


@cocotb.test()
async def driver_is_on_from_the_lead_to_the_end_of_the_tail(dut):
    tx = await Sender.start(dut, 2, response_delay=9, de_lead=5, de_tail=4)
    task = cocotb.start_soon(tx.answer())
    history = []
    while not task.done():
        await clocks(dut)
        await settle()
        history.append((int(dut.de_o.value), tx.on_line > 0 or int(dut.valid_o.value), int(dut.sending_o.value)))
    driven = [i for i, (de, _, _) in enumerate(history) if de]
    line = [i for i, (_, on, _) in enumerate(history) if on]
    assert driven == list(range(driven[0], driven[-1] + 1)), "the driver went off in between"
    assert 5 <= line[0] - driven[0] <= 8, "lead"
    assert 4 <= driven[-1] - line[-1] <= 8, "tail"
    assert not history[driven[0] - 9][0] and history[driven[0] - 9][2], "the delay is spent without the driver"


@cocotb.test()
@cocotb.parametrize(late=[0, 1, 20, 49])
async def late_answer_is_dropped(dut, late):
    """Whenever drop_i rises before the driver is on; then the next answer goes out."""
    tx = await Sender.start(dut, 4, response_delay=50)
    dut.drop_i.value = int(late == 0)
    task = cocotb.start_soon(tx.answer())
    await clocks(dut, late)
    dut.drop_i.value = 1
    await task
    assert len(tx.dropped) == 1 and not tx.sent and not tx.taken
    assert int(dut.de_o.value) == 0
    dut.drop_i.value = 0
    await tx.answer()
    assert len(tx.sent) == 1 and len(tx.taken) == 6


@cocotb.test()
async def answer_that_has_begun_is_not_dropped(dut):
    tx = await Sender.start(dut, 4, de_lead=3)
    task = cocotb.start_soon(tx.answer())
    while not int(dut.de_o.value):
        await clocks(dut)
        await settle()
    dut.drop_i.value = 1
    await task
    assert len(tx.sent) == 1 and len(tx.taken) == 6 and not tx.dropped


@cocotb.test()
async def reset_turns_the_driver_off(dut):
    tx = await Sender.start(dut, 4, de_lead=3)
    for moment in (1, 5, 12, 30):
        tx.left, tx.on_line = 4, 0
        await strobe(dut, start=1)
        await clocks(dut, moment)
        tx.on_line = 0
        await strobe(dut, rst=1)
        tx.on_line = 0
        await settle()
        assert int(dut.de_o.value) == 0 and int(dut.sending_o.value) == 0 and int(dut.valid_o.value) == 0
        await clocks(dut, 3)
