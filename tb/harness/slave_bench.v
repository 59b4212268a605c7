// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// slave_bench - core and block RAM like modbus_rtu_slave, with every setting and event on a port of its own.

`default_nettype none
`include "modbus_defs.vh"

module slave_bench #(
  parameter integer COIL_BASE           = 0,             // first address of each table
  parameter integer COIL_COUNT          = 64,            // its size, 0..65536; 0: no such table
  parameter integer DISCRETE_BASE       = 0,
  parameter integer DISCRETE_COUNT      = 64,
  parameter integer INPUT_BASE          = 0,
  parameter integer INPUT_COUNT         = 64,
  parameter integer HOLDING_BASE        = 0,
  parameter integer HOLDING_COUNT       = 64,
  parameter integer READ_ONLY_BASE      = 0,             // holding registers that answer exception 02 to a write
  parameter integer READ_ONLY_COUNT     = 0,
  parameter integer FILE_COUNT          = 0,             // files of function codes 14H and 15H, 0..65535; 0: none
  parameter integer FILE_RECORDS        = 256,           // records of each, 1..10000
  parameter integer OVERLAY             = 0,             // 1: one block of HOLDING_COUNT registers, also as bits
`include "modbus_config.vh"
) (
`include "flat_ports.vh"
,
  input  wire        write_lock_i,
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o
);

`include "modbus_bank_wires.vh"

  // The function codes of a table that does not exist are left out: they answer exception 01 and cost nothing.
  localparam [127:0] CODES = FUNCTION_CODES
    & ~((OVERLAY == 0 && COIL_COUNT == 0)        ? `MB_COIL_FUNCTIONS     : 128'd0)
    & ~((OVERLAY == 0 && DISCRETE_COUNT == 0)    ? `MB_DISCRETE_FUNCTIONS : 128'd0)
    & ~((OVERLAY == 0 && INPUT_COUNT == 0)       ? `MB_INPUT_FUNCTIONS    : 128'd0)
    & ~((HOLDING_COUNT == 0)                     ? `MB_HOLDING_FUNCTIONS  : 128'd0)
    & ~((FILE_COUNT == 0)                        ? `MB_FILE_FUNCTIONS     : 128'd0);

  core_bench #(
    .FUNCTION_CODES(CODES),
`include "modbus_config_inst.vh"
  ) u_bench (
`include "flat_inst.vh"
    ,
`include "modbus_bank_core_inst.vh"
  );

  assign wb_err = 1'b0;

  modbus_bank_ram #(
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE),
    .DISCRETE_COUNT(DISCRETE_COUNT), .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT),
    .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT), .READ_ONLY_BASE(READ_ONLY_BASE),
    .READ_ONLY_COUNT(READ_ONLY_COUNT), .FILE_COUNT(FILE_COUNT), .FILE_RECORDS(FILE_RECORDS), .OVERLAY(OVERLAY)
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i),
    .host_we_i(host_we_i), .host_adr_i(host_adr_i), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o),
    .host_ack_o(host_ack_o), .host_err_o(host_err_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
