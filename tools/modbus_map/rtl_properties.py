# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME_properties.v: the bank between a core that keeps the rules and the statement that no value is torn."""

from __future__ import annotations

from modbus_map.model import SPACES, Device, Point
from modbus_map.rtl_bank import between, port
from modbus_map.rtl_plan import Item, Plan
from modbus_map.rtl_text import bits, slice_of


def properties(device: Device) -> str:
    """A module for a model checker; its top is NAME_properties."""
    plan = Plan(device)
    inputs, wires, binds = [], [], []
    for point in device.points:
        width = point.bits * point.count
        if point.kind == "wire":
            inputs.append(f"  input wire {bits(width)} {port(point, 'i')}")
            binds.append(f".{port(point, 'i')}({port(point, 'i')})")
        elif point.kind == "register":
            wires.append(f"  wire {bits(width)} {port(point, 'o')};")
            binds.append(f".{port(point, 'o')}({port(point, 'o')})")
        if point.strobe:
            wires.append(f"  wire {bits(point.count)} {port(point, 'stb_o')};")
            binds.append(f".{port(point, 'stb_o')}({port(point, 'stb_o')})")
    if plan.areas:
        for name, width in (("cyc", 1), ("stb", 1), ("we", 1), ("adr", 19), ("dat", 16)):
            inputs.append(f"  input wire {bits(width)} host_{name}_i")
            binds.append(f".host_{name}_i(host_{name}_i)")
        binds += [".host_dat_o()", ".host_ack_o()", ".host_err_o()"]
    there = {s: terms(device, s, False) for s in range(4)}
    written = {s: terms(device, s, True) for s in (0, 3)}
    lines = [
        "// Made by modbus map; change the map, not this file.",
        "//",
        f"// {device.name}_properties - no value of {device.name}_bank is ever torn, whatever a master asks for.",
        "",
        "`default_nettype none",
        '`include "modbus_defs.vh"',
        "",
        f"module {device.name}_properties (",
        "  // A core that keeps the rules of modbus_bank_ports.vh; everything else is free.",
        "  input wire clk_i, rst_i, grant_req_i, grant_write_i, wb_cyc_i, wb_stb_i, wb_we_i,",
        "  input wire [2:0]  grant_space_i,",
        "  input wire [15:0] grant_first_i, grant_last_i, grant_file_i, wb_dat_i,",
        "  input wire [18:0] wb_adr_i" + "".join(f",\n{line}" for line in inputs),
        ");",
        "",
        "  wire        grant_ack_o, wb_ack_o, wb_err_o;",
        "  wire [3:0]  exception_o;",
        "  wire [15:0] wb_dat_o;",
        *wires,
        "",
        f"  {device.name}_bank u_bank (",
        '    .clk_i(clk_i), .rst_i(rst_i),' + "".join(f" {bind}," for bind in binds),
        "    .grant_req_i(grant_req_i), .grant_space_i(grant_space_i), .grant_first_i(grant_first_i),",
        "    .grant_last_i(grant_last_i), .grant_write_i(grant_write_i), .grant_file_i(grant_file_i),",
        "    .grant_ack_o(grant_ack_o), .exception_o(exception_o), .wb_cyc_i(wb_cyc_i), .wb_stb_i(wb_stb_i),",
        "    .wb_we_i(wb_we_i), .wb_adr_i(wb_adr_i), .wb_dat_i(wb_dat_i), .wb_dat_o(wb_dat_o), .wb_ack_o(wb_ack_o),",
        "    .wb_err_o(wb_err_o)",
        "  );",
        "",
        "  wire [2:0]  space = wb_adr_i[18:16];",
        "  wire [15:0] address = wb_adr_i[15:0];",
        "  wire        done = wb_cyc_i & wb_stb_i & wb_ack_o;",
        "  reg         f_past = 1'b0;",
        "  reg         f_inside = 1'b0;                 // the burst goes on behind its last beat",
        "  reg  [18:0] f_next;                          // with this address,",
        "  reg  [15:0] f_last;                          // to this one",
        "  reg         f_we;",
        "  reg  [2:0]  f_space;",
        "  reg         f_same = 1'b0;                   // since the last beat neither a question nor an end of the cycle",
        "",
        "  always @(posedge clk_i) begin",
        "    f_past   <= 1'b1;",
        "    f_inside <= ~rst_i & (done ? address != grant_last_i : f_inside & ~wb_err_o);",
        "    f_same   <= ~rst_i & wb_cyc_i & ~grant_req_i & (done | f_same);",
        "    if (done) begin",
        "      f_next <= wb_adr_i + 19'd1;",
        "      f_last <= grant_last_i;",
        "      f_space <= space;",
        "      f_we   <= wb_we_i;",
        "    end",
        "  end",
        "",
        "  always @* begin",
        "    if (!f_past) assume (rst_i);",
        "    if (wb_stb_i) assume (wb_cyc_i && !grant_req_i && address <= grant_last_i);",
        "    if (f_inside) begin",
        "      assume (wb_cyc_i && !grant_req_i && grant_last_i == f_last);",
        "      if (wb_stb_i) assume (wb_adr_i == f_next && wb_we_i == f_we);",
        "    end",
        "    // A new burst of the same kind follows a question.",
        "    if (wb_stb_i && f_same && !f_inside) assume ({space, wb_we_i} != {f_space, f_we});",
        "    if (wb_stb_i && !wb_we_i) assume ("
        + " || ".join(f"(space == 3'd{s} && ({t}))" for s, t in there.items() if t)
        + ");",
    ]
    granted = [f"((space == 3'd{s} || space == 3'd{s | 6}) && ({t}))" for s, t in written.items() if t]
    lines.append(f"    if (wb_stb_i && wb_we_i) assume ({' || '.join(granted) or chr(49) + chr(39) + 'b0'});")
    lines += [
        "  end",
        "",
        "  always @(posedge clk_i)",
        "    if (f_past && !rst_i && !$past(rst_i) && $past(wb_stb_i) && !$past(wb_ack_o | wb_err_o))",
        "      assume (wb_stb_i && $stable(wb_adr_i) && $stable(wb_we_i) && $stable(wb_dat_i) && $stable(grant_last_i));",
        "",
    ]
    for point in device.points:
        if point.width > 1 and point.kind in ("register", "wire"):
            for index in range(point.count):
                lines += block(point, Item(point, index))
    lines += read_back(device)
    lines += grants(device, plan)
    return "\n".join([*lines, "endmodule", "", "`default_nettype wire"]) + "\n"


def terms(device: Device, space: int, write: bool) -> str:
    """The condition that an address may be read, or written."""
    rows = Plan(device).rows(space, write)
    return " || ".join(between("address", row.low, row.high) for row in rows)


def block(point: Point, item: Item) -> list[str]:
    """The statements about one value."""
    name, space = f"{point.name}_{item.index}", SPACES[point.table]
    here = between("address", item.at, item.addresses[-1])
    size = point.bits
    low = item.index * size

    def word_case(statement) -> list[str]:
        rows = []
        for word, address in enumerate(item.addresses):
            high, bottom = (n - low for n in item.word_bits(word))
            rows.append(f"        16'd{address}: {statement(high, bottom)}")
        return ["      case (address)", *rows, "        default: ;", "      endcase"]

    if point.kind == "register" and point.writable:
        value = f"{port(point, 'o')}[{low + size - 1}:{low}]"
        reset = point.resets[item.index]
        words = [(16 * n + 15, 16 * n) for n in reversed(range(point.width))]  # one property a word: provable sooner
        return [
            f"  // {point.name}: the registers as they come; the output has all of them or none.",
            f"  reg  {bits(size)} f_{name} = {size}'h{reset:X};",
            f"  reg  f_{name}_open = 1'b0;",
            f"  wire {bits(size)} is_{name} = {value};",
            f"  wire f_{name}_beat = done & wb_we_i & (space == 3'd{space}) & {here};",
            "  always @(posedge clk_i) begin",
            f"    if (f_{name}_beat) begin",
            f"      f_{name}_open <= (address != 16'd{item.addresses[-1]}) & (address != grant_last_i);",
            *word_case(lambda high, bottom: f"f_{name}[{high}:{bottom}] <= wb_dat_i;"),
            "    end",
            f"    if (rst_i) begin f_{name} <= {size}'h{reset:X}; f_{name}_open <= 1'b0; end",
            "    if (f_past && !rst_i && !$past(rst_i)) begin",
            *(f"      if (!f_{name}_open) assert (is_{name}[{h}:{b}] == f_{name}[{h}:{b}]);" for h, b in words),
            *(f"      if (f_{name}_open) assert ($stable(is_{name}[{h}:{b}]));" for h, b in words),
            "    end",
            "  end",
            "",
        ]
    if point.kind == "wire" and not point.freeze and point.readable:
        value = f"{port(point, 'i')}[{low + size - 1}:{low}]"
        return [
            f"  // {point.name}: all registers that a burst reads are of one clock, that before the first of them.",
            f"  reg  {bits(size)} f_{name}, f_{name}_was;",
            f"  reg  f_{name}_open = 1'b0;",
            f"  wire {bits(size)} is_{name} = f_{name}_open ? f_{name} : f_{name}_was;",
            f"  wire f_{name}_beat = done & ~wb_we_i & (space == 3'd{space}) & {here};",
            "  always @(posedge clk_i) begin",
            f"    f_{name}_was <= {value};",
            f"    if (f_{name}_beat) f_{name} <= is_{name};",
            f"    if (f_{name}_beat) f_{name}_open <= (address != 16'd{item.addresses[-1]}) & (address != grant_last_i);",
            f"    if (rst_i) f_{name}_open <= 1'b0;",
            f"    if (f_past && !rst_i && f_{name}_beat)",
            *word_case(lambda high, bottom: f"assert (wb_dat_o == is_{name}[{high}:{bottom}]);"),
            "  end",
            "",
        ]
    return []


def read_back(device: Device) -> list[str]:
    """A register that the master writes reads as its output shows it."""
    rows = []
    for point in device.points:
        if point.table != "holding_registers" or point.kind != "register" or not (point.writable and point.readable):
            continue
        for item in (Item(point, index) for index in range(point.count)):
            for word, address in enumerate(item.addresses):
                high, low = item.word_bits(word)
                value = slice_of(port(point, "o"), point.bits * point.count, high, low)
                rows.append(f"      16'd{address}: assert (wb_dat_o == {value});")
    if not rows:
        return []
    return [
        "  // A register that the master writes reads as its output shows it.",
        "  always @(posedge clk_i) if (f_past && !rst_i && done && !wb_we_i && space == `MB_SPACE_HOLDINGS)",
        "    case (address)",
        *rows,
        "      default: ;",
        "    endcase",
        "",
    ]


def grants(device: Device, plan: Plan) -> list[str]:
    """A grant is given exactly where every address may be accessed."""
    questions = []
    for (write, space), rows in sorted(plan.questions.items()):
        inside = " || ".join(
            f"(grant_first_i >= 16'd{r.low} && grant_last_i <= 16'd{r.high}"
            + (f" && grant_file_i == 16'd{r.file}" if r.file else "")
            + ")"
            for r in rows
        )
        questions.append(f"(grant_write_i == 1'b{int(write)} && grant_space_i == 3'd{space} && ({inside}))")
    return [
        "  // A grant is given exactly where every address may be accessed.",
        "  wire f_allowed = " + " ||\n                   ".join(questions or ["1'b0"]) + ";",
        "  always @(posedge clk_i) begin",
        "    if (f_past && $past(grant_req_i) && grant_req_i)",
        "      assume ($past(grant_ack_o) || ($stable(grant_write_i) && $stable(grant_space_i) && $stable(grant_first_i) &&",
        "              $stable(grant_last_i) && $stable(grant_file_i)));",
        "    if (f_past && $past(grant_ack_o)) assume (!grant_req_i);",
        "  end",
        "  always @* if (grant_req_i) assume (grant_first_i <= grant_last_i);",
        "  always @(posedge clk_i) if (f_past && !rst_i && grant_ack_o) begin",
        "    assert (exception_o == (f_allowed ? 4'd0 : `MB_EX_ILLEGAL_DATA_ADDRESS));",
        "  end",
        "",
    ]
