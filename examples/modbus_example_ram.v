// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_ram - the slave on the bus of the example SoCs: registers in RAM, eight lamps, eight switches.
//
// Wishbone B4 classic, address {space, item}.  Holding and input registers 0..WORDS-1 are memory, coils 0..7 the lamps,
// discrete inputs 0..7 the switches.  Every other address, and a write to a switch, answers err.  Both masters may write.
// ack or err comes two clocks after stb.

`default_nettype none
`include "modbus_defs.vh"

module modbus_example_ram #(
  parameter integer WORDS = 128                  // of each table, 2..65536
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Bus
  input  wire        wb_cyc_i,
  input  wire        wb_stb_i,
  input  wire        wb_we_i,
  input  wire [18:0] wb_adr_i,
  input  wire [15:0] wb_dat_i,
  output wire [15:0] wb_dat_o,
  output wire        wb_ack_o,
  output wire        wb_err_o,

  // Board
  input  wire [7:0]  switches_i,                 // asynchronous
  output wire [7:0]  lamps_o
);

  generate
    if (WORDS < 2 || WORDS > 65536) begin : gen_illegal
      ERROR_modbus_example_ram_WORDS_from_2_to_65536 illegal_parameter ();
    end
  endgenerate

  localparam W = $clog2(2 * WORDS);

  wire [2:0]  space = wb_adr_i[18:16];
  wire [15:0] item  = wb_adr_i[15:0];
  wire        bits  = (space[2:1] == 2'b00);
  wire        words = (space[2:1] == 2'b01);
  wire        exists = (words & ({1'b0, item} < WORDS[16:0])) |
                       (bits & (item[15:3] == 13'd0) & ~(space[0] & wb_we_i));
  // Input registers lie behind the holding registers.  The largest memory has a 17-bit address; smaller ones use its low bits.
  // verilator lint_off UNUSED
  wire [16:0]  whole = {1'b0, item} + (space[0] ? 17'd0 : WORDS[16:0]);
  // verilator lint_on UNUSED
  wire [W-1:0] place = whole[W-1:0];
  wire [7:0]   switches;

  (* no_rw_check *) reg [15:0] memory [0:2*WORDS-1];
  reg  [15:0] word_q;
  reg  [7:0]  lamps_q = 8'd0;
  reg         ready_q = 1'b0;
  integer     i;

  initial for (i = 0; i < 2 * WORDS; i = i + 1) memory[i] = 16'd0;

  wire write = wb_ack_o & wb_we_i;

  always @(posedge clk_i) begin
    ready_q <= wb_cyc_i & wb_stb_i & ~ready_q & ~rst_i;
    if (write && bits) lamps_q[item[2:0]] <= wb_dat_i[0];
    if (rst_i) lamps_q <= 8'd0;
  end

  always @(posedge clk_i) begin
    if (write && words) memory[place] <= wb_dat_i;
    word_q <= memory[place];
  end

  genvar n;
  generate
    for (n = 0; n < 8; n = n + 1) begin : gen_switches
      modbus_sync u_sync (.clk_i(clk_i), .async_i(switches_i[n]), .sync_o(switches[n]));
    end
  endgenerate

  wire [7:0] lights = space[0] ? switches : lamps_q;

  assign wb_dat_o = words ? word_q : {15'd0, lights[item[2:0]]};
  assign wb_ack_o = ready_q & wb_cyc_i & wb_stb_i & exists;
  assign wb_err_o = ready_q & wb_cyc_i & wb_stb_i & ~exists;
  assign lamps_o  = lamps_q;

endmodule

`default_nettype wire
