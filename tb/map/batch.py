# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many generated banks in one compilation, so that a map costs no compiler start of its own.

The core is a library of its own, compiled once, with every function code and with checking passes. A bank stands behind
a top whose ports are the same for all of them: the points' inputs are slices of one vector, their outputs and strobes
of another.
"""

import ctypes
import hashlib
import re
from pathlib import Path

import models
from modbus_map.outputs.verilog import core_files
from modbus_map.rtl_bank import Bank, port
from modbus_map.rtl_plan import Plan

from map.devices import ROOT

HERE = Path(__file__).resolve().parent
PLACE = models.CACHE.parent / "map"
ADDRESS, BIT_TIME = 17, 8
MOST_CHANGES = 3000
OPTIMISE = "-O0"  # a bank runs for a second: compiling it is what takes long


def layout(device):
    """({point name: low bit} of the inputs, the same of outputs, {point name: low bit} of strobes, bits of each)."""
    inputs, outputs, strobes, used_in, used_out = {}, {}, {}, 0, 0
    for point in device.points:
        width = point.bits * point.count
        if point.kind == "wire":
            inputs[point.name], used_in = used_in, used_in + width
        elif point.kind == "register":
            outputs[point.name], used_out = used_out, used_out + width
        if point.strobe:
            strobes[point.name], used_out = used_out, used_out + point.count
    return inputs, outputs, strobes, max(used_in, used_out)


def top(device, width):
    """Verilog around the bank of a device."""
    inputs, outputs, strobes, _ = layout(device)
    binds = []
    for point in device.points:
        if point.name in inputs:
            binds.append(f".{port(point, 'i')}(in_i[{inputs[point.name]} +: {point.bits * point.count}])")
        if point.name in outputs:
            binds.append(f".{port(point, 'o')}(out_o[{outputs[point.name]} +: {point.bits * point.count}])")
        if point.name in strobes:
            binds.append(f".{port(point, 'stb_o')}(out_o[{strobes[point.name]} +: {point.count}])")
    idle = ""
    if Plan(device).areas:
        binds += [f".host_{name}_i(host_{name}_i)" for name in ("cyc", "stb", "we", "adr", "dat")]
        binds += [f".host_{name}_o(host_{name}_o)" for name in ("dat", "ack", "err")]
    else:
        idle = "  assign host_dat_o = 16'd0; assign host_ack_o = 1'b0; assign host_err_o = 1'b0;\n"
    return f"""
module {device.name}_top (
  input wire clk_i, input wire rst_i,
`include "modbus_bank_ports.vh"
  , input wire [{width - 1}:0] in_i, output wire [{width - 1}:0] out_o,
  input wire host_cyc_i, input wire host_stb_i, input wire host_we_i, input wire [18:0] host_adr_i,
  input wire [15:0] host_dat_i, output wire [15:0] host_dat_o, output wire host_ack_o, output wire host_err_o
);
{idle}  {device.name}_bank u_bank (
    .clk_i(clk_i), .rst_i(rst_i),
    .grant_req_i(grant_req_i), .grant_space_i(grant_space_i), .grant_first_i(grant_first_i),
    .grant_last_i(grant_last_i), .grant_write_i(grant_write_i), .grant_file_i(grant_file_i),
    .grant_ack_o(grant_ack_o), .exception_o(exception_o), .wb_cyc_i(wb_cyc_i), .wb_stb_i(wb_stb_i), .wb_we_i(wb_we_i),
    .wb_adr_i(wb_adr_i), .wb_dat_i(wb_dat_i), .wb_dat_o(wb_dat_o), .wb_ack_o(wb_ack_o), .wb_err_o(wb_err_o){
        "".join(f",{chr(10)}    {bind}" for bind in binds)
    }
  );
endmodule
"""


CORE = """
`include "modbus_defs.vh"
module map_core (
  input wire clk_i, input wire rst_i, input wire rxd_i, output wire txd_o, output wire de_o, output wire idle_o,
{ports}
);
  modbus_rtu_core #(.T15_MIN_US(0), .T35_MIN_US(0), .CHECK_WRITES(1)) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .idle_o(idle_o),
    .settings_i(`MB_LINE_SETTINGS(8'd{address}, 16'd{bit_time}, 2'd3)), .host_state_i(`MB_HOST_AT_REST),
    .user_adr_i(8'd0), .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0),
    {binds}
  );
endmodule
"""


def of_the_core():
    """The Verilog top around the core: its side of modbus_bank_ports.vh, which is the bank's turned round."""
    text = (ROOT / "rtl/include/modbus_bank_ports.vh").read_text(encoding="utf-8")
    ports = re.findall(r"^ *(input|output) +wire +(\[\w+:0\])? *(\w+)_([io]),?\s", text, re.M)
    turned = {"input": ("output", "o"), "output": ("input", "i")}
    lines = [f"  {turned[way][0]} wire {span} {name}_{turned[way][1]}" for way, span, name, _ in ports]
    names = [f"{name}_{turned[way][1]}" for way, _, name, _ in ports]
    binds = ", ".join(f".{name}({name})" for name in names)
    return CORE.format(ports=",\n".join(lines), binds=binds, address=ADDRESS, bit_time=BIT_TIME)


def written(name, text):
    """Path of a file of the batch; its name tells its contents."""
    PLACE.mkdir(parents=True, exist_ok=True)
    stem, _, suffix = name.rpartition(".")
    path = PLACE / f"{stem}_{hashlib.sha256(text.encode()).hexdigest()[:16]}.{suffix}"
    path.write_text(text, encoding="utf-8")
    return path


class Batch:
    """Compiled banks of several devices."""

    def __init__(self, devices, change=lambda text: text):
        self.devices = devices
        self.words = max(4, max((layout(d)[3] + 31) // 32 for d in devices))
        files, folders = core_files()
        folders = [ROOT / f for f in folders]
        core = models.Model(
            "map_core",
            HERE / "harness.cpp",
            [*(ROOT / f for f in files), written("core.v", of_the_core())],
            folders,
            headers=[HERE],
        )
        tops = {}
        for device in devices:
            text = '`default_nettype none\n`include "modbus_defs.vh"\n' + change(Bank(device).text())
            tops[f"{device.name}_top"] = written(f"{device.name}.v", text + top(device, 32 * self.words))
        (first, file), *others = tops.items()
        classes = ["Vmodel", *(f"V{name}" for name, _ in others)]
        glue = '#include "one_bank.h"\nextern "C" AnyBank *bank_new(int number) {\n  switch (number) {\n'
        glue += "".join(f"    case {n}: return new OneBank<{name}>;\n" for n, name in enumerate(classes))
        banks = models.Model(
            first,
            written("banks.cpp", glue + "  }\n  return nullptr;\n}\n"),
            [file],
            folders,
            {},
            {"WORDS": self.words},
            optimise=OPTIMISE,
            others=dict(others),
            headers=[HERE],
        )
        self._lib = ctypes.CDLL(str(models.compiled(core)))
        self._banks = ctypes.CDLL(str(models.compiled(banks)))
        self._lib.device_new.restype = self._banks.bank_new.restype = ctypes.c_void_p
        self._handle = ctypes.c_void_p(self._lib.device_new())
        self._answer = (ctypes.c_uint8 * 300)()
        self._changes = (ctypes.c_uint32 * (self.words * MOST_CHANGES))()

    def choose(self, number):
        bank = ctypes.c_void_p(self._banks.bank_new(number))
        self._lib.device_choose(self._handle, bank, self.words)
        self.reset()

    def reset(self):
        self._lib.device_reset(self._handle)

    def _array(self, value):
        return (ctypes.c_uint32 * self.words)(*[value >> 32 * n & 0xFFFFFFFF for n in range(self.words)])

    def inputs(self, first, second):
        """The two vectors between which the inputs change while a request is under way."""
        self._lib.device_inputs(self._handle, self._array(first), self._array(second))

    def outputs(self):
        out = (ctypes.c_uint32 * self.words)()
        self._lib.device_outputs(self._handle, out)
        return sum(word << 32 * n for n, word in enumerate(out))

    def request(self, frame, patience):
        """(answer bytes or None, the vectors of outputs that followed)."""
        count = self._lib.device_xfer(self._handle, len(frame), bytes(frame), ctypes.c_uint32(patience), self._answer)
        if count < 0:
            raise AssertionError(f"fault {count} on the line")
        changes = self._lib.device_changes(self._handle, self._changes, MOST_CHANGES)
        if changes > MOST_CHANGES:
            raise AssertionError(f"{changes} changes of the outputs")
        n = self.words
        vectors = [sum(self._changes[n * k + w] << 32 * w for w in range(n)) for k in range(changes)]
        return (bytes(self._answer[:count]) if count else None), vectors

    def host(self, space, item, write=None):
        """An access of the host; the value, None for err."""
        value = self._lib.device_host(self._handle, space << 16 | item, int(write is not None), write or 0)
        assert value != -2, "the host port does not answer"
        return None if value < 0 else value
