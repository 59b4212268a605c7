// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_io - the four tables as flat vectors: coils and holding registers out, discrete inputs and input registers in.
//
// For LEDs, relays, switches, sensors.  Item k of a table is bit k, register k is [16*k +: 16], k counted from the
// table's base.  Outputs change item by item while a burst writes them, one every clock or two; inputs are looked
// at when they are read, so a value wider than a register must be held by its source.  Inputs must be
// synchronous to clk_i.  Coils and holding registers are 0 after configuration and after rst_i.

`default_nettype none
`include "modbus_defs.vh"

module modbus_bank_io #(
  parameter COIL_BASE = 0,      parameter COIL_COUNT = 16,       // count 0..65536; 0: no such table
  parameter DISCRETE_BASE = 0,  parameter DISCRETE_COUNT = 16,
  parameter INPUT_BASE = 0,     parameter INPUT_COUNT = 8,
  parameter HOLDING_BASE = 0,   parameter HOLDING_COUNT = 8,
  parameter READ_ONLY_BASE = 0, parameter READ_ONLY_COUNT = 0,
  parameter COIL_WIDTH     = (COIL_COUNT > 0)     ? COIL_COUNT : 1,        // derived, leave alone
  parameter DISCRETE_WIDTH = (DISCRETE_COUNT > 0) ? DISCRETE_COUNT : 1,
  parameter INPUT_WIDTH    = (INPUT_COUNT > 0)    ? 16 * INPUT_COUNT : 16,
  parameter HOLDING_WIDTH  = (HOLDING_COUNT > 0)  ? 16 * HOLDING_COUNT : 16
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Core: grant and Wishbone
  input  wire        grant_req_i,
  input  wire [2:0]  grant_space_i,
  input  wire [15:0] grant_first_i,
  input  wire [15:0] grant_last_i,
  input  wire        grant_write_i,
  output wire        grant_ack_o,
  output wire [3:0]  exception_o,
  input  wire        wb_cyc_i,
  input  wire        wb_stb_i,
  input  wire        wb_we_i,
  input  wire [18:0] wb_adr_i,
  input  wire [15:0] wb_dat_i,
  output wire [15:0] wb_dat_o,
  output wire        wb_ack_o,

  // Tables
  output wire [COIL_WIDTH-1:0]     coils_o,
  input  wire [DISCRETE_WIDTH-1:0] discretes_i,
  input  wire [INPUT_WIDTH-1:0]    inputs_i,
  output wire [HOLDING_WIDTH-1:0]  holdings_o
);

  modbus_bank_guard #(
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
    .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
    .READ_ONLY_BASE(READ_ONLY_BASE), .READ_ONLY_COUNT(READ_ONLY_COUNT), .OVERLAY(0)
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .hold_i(1'b0),
    .req_i(grant_req_i), .space_i(grant_space_i), .first_i(grant_first_i), .last_i(grant_last_i),
    .write_i(grant_write_i), .ack_o(grant_ack_o), .exception_o(exception_o)
  );

  reg [COIL_WIDTH-1:0]    coils_q = {COIL_WIDTH{1'b0}};
  reg [HOLDING_WIDTH-1:0] holdings_q = {HOLDING_WIDTH{1'b0}};
  reg                     ready_q = 1'b0;
  reg [15:0]              read_q, read_d;

  wire [2:0]  space = wb_adr_i[18:16];
  wire        ack   = wb_cyc_i & wb_stb_i & ready_q;
  integer     k;

  // The range was granted: only the bits that tell the items of a table apart are compared.
  always @* begin
    read_d = 16'd0;
    case (space)
      `MB_SPACE_COILS:
        for (k = 0; k < COIL_COUNT; k = k + 1)
          if (wb_adr_i[15:0] == COIL_BASE[15:0] + k[15:0]) read_d = {15'd0, coils_q[k]};
      `MB_SPACE_DISCRETES:
        for (k = 0; k < DISCRETE_COUNT; k = k + 1)
          if (wb_adr_i[15:0] == DISCRETE_BASE[15:0] + k[15:0]) read_d = {15'd0, discretes_i[k]};
      `MB_SPACE_INPUTS:
        for (k = 0; k < INPUT_COUNT; k = k + 1)
          if (wb_adr_i[15:0] == INPUT_BASE[15:0] + k[15:0]) read_d = inputs_i[16*k +: 16];
      default:
        for (k = 0; k < HOLDING_COUNT; k = k + 1)
          if (wb_adr_i[15:0] == HOLDING_BASE[15:0] + k[15:0]) read_d = holdings_q[16*k +: 16];
    endcase
  end

  always @(posedge clk_i) begin
    ready_q <= wb_cyc_i & ~ack & ~rst_i;
    read_q  <= read_d;
    if (ack && wb_we_i) begin
      for (k = 0; k < COIL_COUNT; k = k + 1)
        if (space == `MB_SPACE_COILS && wb_adr_i[15:0] == COIL_BASE[15:0] + k[15:0]) coils_q[k] <= wb_dat_i[0];
      for (k = 0; k < HOLDING_COUNT; k = k + 1)
        if (space == `MB_SPACE_HOLDINGS && wb_adr_i[15:0] == HOLDING_BASE[15:0] + k[15:0])
          holdings_q[16*k +: 16] <= wb_dat_i;
    end
    if (rst_i) begin
      coils_q    <= {COIL_WIDTH{1'b0}};
      holdings_q <= {HOLDING_WIDTH{1'b0}};
    end
  end

  assign wb_dat_o   = read_q;
  assign wb_ack_o   = ack;
  assign coils_o    = coils_q;
  assign holdings_o = holdings_q;

endmodule

`default_nettype wire
