# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The tops of constraints/, at their pins and from power-up: there is no reset.

The clock is told to be slow (CLK_HZ) and the rate is a tenth of it, so that seconds pass quickly.
"""

import json
import os
import random
from types import SimpleNamespace

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Timer
from harness.line import Line, now
from protocol import frames
from protocol.defs import F8E1, FC

from .board_pins import PINS

PARAMETERS = json.loads(os.environ["BENCH_PARAMETERS"])
TICK_CLOCKS = PARAMETERS["CLK_HZ"] // 1000
BIT_CLOCKS = PARAMETERS["CLK_HZ"] // PARAMETERS["BAUD"]
CLOCK_PS = 100_000
ADDRESS, COILS, DISCRETES = 17, 16, 16
MEMORY = 8  # holding registers
SYNC_CLOCKS = 4  # what a button may take to arrive

LEDS, ALIVE, BUTTONS = PINS[os.environ["BENCH_TOP"]]


class Board:
    """A board on its two lines."""

    def __init__(self, dut):
        self.dut, rng = dut, random.Random(1)

        def line(rxd, txd):
            pins = SimpleNamespace(rxd_i=rxd, txd_o=txd, de_o=dut.rs485_de_o)
            return Line(pins, BIT_CLOCKS * CLOCK_PS, F8E1, rng)

        self.lines = {
            "usb": line(dut.usb_rxd_i, dut.usb_txd_o),
            "rs485": line(dut.rs485_rxd_i, dut.rs485_txd_o),
        }

    @classmethod
    async def start(cls, dut):
        """Clock on, nothing pressed; returns when the line has been silent for longer than t3.5."""
        board = await cls.power_up(dut)
        await ClockCycles(dut.clk_i, BIT_CLOCKS * F8E1.length * 5)
        return board

    @classmethod
    async def power_up(cls, dut):
        """The pull-ups have pulled before the first clock: without a reset an X on a pin would stay inside."""
        board = cls(dut)
        board.press()
        await Timer(CLOCK_PS, "ps")
        Clock(dut.clk_i, CLOCK_PS, "ps", impl="gpi").start()
        return board

    def press(self, *numbers):
        """Press these buttons and release all others."""
        words = {}
        for i, (port, bit, active) in enumerate(BUTTONS):
            level = active if i in numbers else 1 - active
            words[port] = words.get(port, 0) | level << (bit or 0)
        for port, word in words.items():
            getattr(self.dut, port).value = word

    def lit(self, lamp):
        """True if this LED shines."""
        port, bit, active = lamp
        word = int(getattr(self.dut, port).value)
        return (word >> (bit or 0) & 1) == active

    def shining(self):
        """The coils whose LEDs shine."""
        return [i for i, lamp in enumerate(LEDS) if self.lit(lamp)]

    async def ask(self, pdu, by="usb", address=ADDRESS):
        """The PDU that answers, or None; it must be on both transmitters."""
        for line in self.lines.values():
            line.forget()
        await self.lines[by].send(frames.adu(address, pdu))
        patience = 20 * F8E1.length * BIT_CLOCKS * CLOCK_PS
        answers = [await line.answer(patience) for line in self.lines.values()]
        data = [answer and answer.data for answer in answers]
        assert data[0] == data[1], f"usb sent {data[0]}, rs485 {data[1]}"
        await ClockCycles(self.dut.clk_i, BIT_CLOCKS * F8E1.length * 5)
        if data[0] is None:
            return None
        assert data[0] == frames.adu(address, data[0][1:-2]), f"bad answer {data[0].hex()}"
        return data[0][1:-2]

    async def inputs(self):
        """(seconds, milliseconds) as read."""
        answer = await self.ask(frames.read(FC.READ_INPUTS, 0, 2))
        return frames.unpack_words(answer[2:])


@cocotb.test()
async def power_up_without_reset(dut):
    board = await Board.power_up(dut)
    await ClockCycles(dut.clk_i, 3)
    assert board.shining() == [], f"LEDs {board.shining()} shine"
    assert not board.lit(ALIVE), "the alive LED shines before any master has talked"
    idle = [int(p.value) for p in (dut.usb_txd_o, dut.rs485_txd_o, dut.rs485_de_o)]
    assert idle == [1, 1, 0], f"usb_txd, rs485_txd, rs485_de are {idle}, expected [1, 1, 0]"
    if hasattr(dut, "wifi_gpio0_o"):
        assert int(dut.wifi_gpio0_o.value) == 1, "the ESP32 is held in its loader"


@cocotb.test()
async def each_coil_lights_its_led(dut):
    board = await Board.start(dut)
    assert await board.ask(frames.write_coils(0, [0] * COILS)) is not None, "no answer"
    for i in range(len(LEDS)):
        request = frames.write_coil(i, True)
        assert await board.ask(request) == request
        assert board.shining() == list(range(i + 1)), f"coils 0 to {i} are on, LEDs {board.shining()} shine"
    await board.ask(frames.write_coils(0, [0] * COILS))
    assert board.shining() == [], f"all coils are off, LEDs {board.shining()} shine"
    answer = await board.ask(frames.write_coil(COILS, True))
    assert answer == bytes([FC.WRITE_COIL | 0x80, 2]), f"coil {COILS} answers {answer.hex()}, expected exception 02"


@cocotb.test()
async def each_button_is_a_discrete_input(dut):
    board = await Board.start(dut)
    for pressed in ((), *((i,) for i in range(len(BUTTONS)))):
        board.press(*pressed)
        await ClockCycles(dut.clk_i, SYNC_CLOCKS)
        answer = await board.ask(frames.read(FC.READ_DISCRETES, 0, DISCRETES))
        seen = [i for i, bit in enumerate(frames.unpack_bits(answer[2:], DISCRETES)) if bit]
        assert seen == list(pressed), f"buttons {list(pressed)} pressed, discrete inputs {seen} are 1"


@cocotb.test()
async def the_counters_count(dut):
    board = await Board.start(dut)
    before, (_, first) = now(), await board.inputs()
    # A second that is a millisecond short shows at the pins only after minutes: look inside for this one.
    await dut.u_board.seconds_q.value_change
    at = int(dut.u_board.milliseconds_q.value)
    assert at % 1000 == 0, f"the second ends at {at} ms"
    await ClockCycles(dut.clk_i, 300 * TICK_CLOCKS)
    after, (seconds, second) = now(), await board.inputs()
    wanted = round((after - before) / CLOCK_PS / TICK_CLOCKS)
    assert abs(second - first - wanted) <= 2, f"{second - first} ms counted, expected {wanted}"
    assert seconds == second // 1000, f"{seconds} s and {second} ms"
    assert seconds >= 1


@cocotb.test()
async def both_receivers_work(dut):
    board = await Board.start(dut)
    for i, by in enumerate(("usb", "rs485", "usb")):
        words = [(0x1234 * (i + 1) + k) & 0xFFFF for k in range(MEMORY)]
        assert await board.ask(frames.write_registers(0, words), by) is not None, f"no answer to {by}"
        answer = await board.ask(frames.read(FC.READ_HOLDINGS, 0, MEMORY), by)
        assert frames.unpack_words(answer[2:]) == words, f"by {by}: {answer.hex()}"
        assert await board.ask(frames.read(FC.READ_HOLDINGS, 0, 1), by, ADDRESS + 1) is None, "answers another address"


@cocotb.test()
async def the_alive_led_follows_the_master(dut):
    board = await Board.start(dut)
    await board.ask(frames.read(FC.READ_COILS, 0, 1))
    assert board.lit(ALIVE), "dark although a master talks"
    await ClockCycles(dut.clk_i, 900 * TICK_CLOCKS)
    assert board.lit(ALIVE), "dark before a second has passed"
    await ClockCycles(dut.clk_i, 150 * TICK_CLOCKS)
    assert not board.lit(ALIVE), "still lit more than a second after the last frame"
