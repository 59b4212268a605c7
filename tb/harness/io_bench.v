// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// io_bench - core and vectors like modbus_rtu_slave_io, with every setting and event on a port of its own.

`default_nettype none
`include "modbus_defs.vh"

module io_bench #(
  parameter integer COIL_BASE           = 0,             // first address of each table
  parameter integer COIL_COUNT          = 16,            // its size, 0..65536; 0: no such table
  parameter integer DISCRETE_BASE       = 0,
  parameter integer DISCRETE_COUNT      = 16,
  parameter integer INPUT_BASE          = 0,
  parameter integer INPUT_COUNT         = 8,
  parameter integer HOLDING_BASE        = 0,
  parameter integer HOLDING_COUNT       = 8,
  parameter integer READ_ONLY_BASE      = 0,             // holding registers that answer exception 02 to a write
  parameter integer READ_ONLY_COUNT     = 0,
  parameter integer COIL_WIDTH     = (COIL_COUNT > 0)     ? COIL_COUNT : 1,        // derived
  parameter integer DISCRETE_WIDTH = (DISCRETE_COUNT > 0) ? DISCRETE_COUNT : 1,
  parameter integer INPUT_WIDTH    = (INPUT_COUNT > 0)    ? 16 * INPUT_COUNT : 16,
  parameter integer HOLDING_WIDTH  = (HOLDING_COUNT > 0)  ? 16 * HOLDING_COUNT : 16,
`include "modbus_config.vh"
) (
`include "flat_ports.vh"
,
  input  wire                      write_lock_i,
  output wire [COIL_WIDTH-1:0]     coils_o,
  input  wire [DISCRETE_WIDTH-1:0] discretes_i,
  input  wire [INPUT_WIDTH-1:0]    inputs_i,
  output wire [HOLDING_WIDTH-1:0]  holdings_o
);

`include "modbus_bank_wires.vh"

  // The function codes of a table that does not exist are left out: they answer exception 01 and cost nothing.
  localparam [127:0] CODES = FUNCTION_CODES
    & ~((COIL_COUNT == 0)    ? `MB_COIL_FUNCTIONS     : 128'd0)
    & ~((DISCRETE_COUNT == 0)? `MB_DISCRETE_FUNCTIONS : 128'd0)
    & ~((INPUT_COUNT == 0)   ? `MB_INPUT_FUNCTIONS    : 128'd0)
    & ~((HOLDING_COUNT == 0) ? `MB_HOLDING_FUNCTIONS  : 128'd0)
    & ~`MB_FILE_FUNCTIONS;

  core_bench #(
    .FUNCTION_CODES(CODES),
`include "modbus_config_inst.vh"
  ) u_bench (
`include "flat_inst.vh"
    ,
`include "modbus_bank_core_inst.vh"
  );

  assign wb_err = 1'b0;

  modbus_bank_io #(
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE),
    .DISCRETE_COUNT(DISCRETE_COUNT), .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT),
    .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT), .READ_ONLY_BASE(READ_ONLY_BASE),
    .READ_ONLY_COUNT(READ_ONLY_COUNT)
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i),
    .coils_o(coils_o), .discretes_i(discretes_i), .inputs_i(inputs_i), .holdings_o(holdings_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
