# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Many generated banks in one compiled model, so that a map costs no compilation of its own.

The banks share one core with every function code and with checking passes. The points' inputs are slices of one
vector, their outputs and strobes of another.
"""

import ctypes
import hashlib
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
OPTIMISE = "-O0"  # a batch runs for seconds: compiling it is what takes long


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


def top(devices, width):
    """Verilog of the core with all the banks."""
    binds = []
    for number, device in enumerate(devices):
        inputs, outputs, strobes, _ = layout(device)
        mine = []
        for point in device.points:
            if point.name in inputs:
                mine.append(f".{port(point, 'i')}(in_i[{inputs[point.name]} +: {point.bits * point.count}])")
            if point.name in outputs:
                mine.append(f".{port(point, 'o')}(out_{number}[{outputs[point.name]} +: {point.bits * point.count}])")
            if point.name in strobes:
                mine.append(f".{port(point, 'stb_o')}(out_{number}[{strobes[point.name]} +: {point.count}])")
        host = ""
        if Plan(device).areas:
            names = ("cyc", "stb", "we", "adr", "dat")
            host = "".join(
                f", .host_{n}_i({f'host_{n}_i & on' if n in ('cyc', 'stb') else f'host_{n}_i'})" for n in names
            )
            host += f", .host_dat_o(hd[{number}]), .host_ack_o(ha[{number}]), .host_err_o(he[{number}])"
        else:
            host = ""
        idle = (
            "" if Plan(device).areas else f" assign ha[{number}] = 0; assign he[{number}] = 0; assign hd[{number}] = 0;"
        )
        binds.append(
            f"  wire [{width - 1}:0] out_{number}; assign outs[{number}] = out_{number};{idle}\n"
            f"  if (1) begin : g{number} wire on = sel_i == {number};\n"
            f"  {device.name}_bank u (.clk_i(clk_i), .rst_i(rst_i), .grant_req_i(grant_req & on), .grant_space_i(grant_space),"
            ".grant_first_i(grant_first), .grant_last_i(grant_last), .grant_write_i(grant_write),"
            f".grant_file_i(grant_file), .grant_ack_o(ga[{number}]), .exception_o(ex[{number}]), .wb_cyc_i(wb_cyc & on),"
            ".wb_stb_i(wb_stb), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write),"
            f".wb_dat_o(wd[{number}]), .wb_ack_o(wa[{number}]), .wb_err_o(we[{number}])"
            + "".join(f", {bind}" for bind in mine)
            + host
            + ");\n  end"
        )
    count = len(devices)
    last = count - 1
    return f"""
`include "modbus_defs.vh"
module map_batch (
  input clk_i, input rst_i, input rxd_i, output txd_o, output de_o, input [15:0] sel_i,
  input [{width - 1}:0] in_i, output [{width - 1}:0] out_o,
  input host_cyc_i, input host_stb_i, input host_we_i, input [18:0] host_adr_i, input [15:0] host_dat_i,
  output [15:0] host_dat_o, output host_ack_o, output host_err_o
);
`include "modbus_bank_wires.vh"
  wire [{width - 1}:0] outs [0:{last}];
  wire [15:0] wd [0:{last}], hd [0:{last}];
  wire [3:0] ex [0:{last}];
  wire [{last}:0] ga, wa, we, ha, he;
  assign grant_ack = ga[sel_i]; assign exception = ex[sel_i]; assign wb_read = wd[sel_i]; assign wb_ack = wa[sel_i];
  assign wb_err = we[sel_i]; assign out_o = outs[sel_i]; assign host_dat_o = hd[sel_i]; assign host_ack_o = ha[sel_i];
  assign host_err_o = he[sel_i];
  modbus_rtu_core #(.T15_MIN_US(0), .T35_MIN_US(0), .CHECK_WRITES(1)) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o),
    .settings_i(`MB_LINE_SETTINGS(8'd{ADDRESS}, 16'd{BIT_TIME}, 2'd3)), .host_state_i(`MB_HOST_AT_REST), .user_adr_i(8'd0),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0),
`include "modbus_bank_core_inst.vh"
  );
  generate
{chr(10).join(binds)}
  endgenerate
endmodule
"""


class Batch:
    """Compiled banks of several devices."""

    def __init__(self, devices, change=lambda text: text):
        self.devices = devices
        self.words = max(4, max((layout(d)[3] + 31) // 32 for d in devices))
        head = '`default_nettype none\n`include "modbus_defs.vh"\n'
        text = head + "".join(change(Bank(d).text()) for d in devices) + "`default_nettype wire\n"
        text += top(devices, 32 * self.words)
        PLACE.mkdir(parents=True, exist_ok=True)
        file = PLACE / f"batch_{hashlib.sha256(text.encode()).hexdigest()[:16]}.v"
        file.write_text(text)
        files, folders = core_files()
        model = models.Model(
            "map_batch",
            HERE / "harness.cpp",
            [*(ROOT / f for f in files), file],
            [ROOT / f for f in folders],
            {},
            {"WORDS": self.words},
            optimise=OPTIMISE,
        )
        lib = ctypes.CDLL(str(models.compiled(model)))
        lib.device_new.restype = ctypes.c_void_p
        self._lib, self._handle = lib, ctypes.c_void_p(lib.device_new())
        self._answer = (ctypes.c_uint8 * 300)()
        self._changes = (ctypes.c_uint32 * (self.words * MOST_CHANGES))()

    def choose(self, number):
        self._lib.device_choose(self._handle, ctypes.c_uint32(number))

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
