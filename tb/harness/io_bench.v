// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// io_bench - core and vectors like modbus_rtu_slave_io, with every setting and event on a port of its own.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 16
`define MB_WORDS_DEFAULT 8

module io_bench #(
`include "modbus_tables.vh"
  ,
`include "modbus_read_back.vh"
  ,
`include "modbus_table_widths.vh"
  ,
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
`include "modbus_table_codes.vh"

  core_bench #(
    .FUNCTION_CODES(TABLE_CODES), .MAX_BIT_TIME(MAX_BIT_TIME),
`include "modbus_config_inst.vh"
  ) u_bench (
`include "flat_inst.vh"
    ,
`include "modbus_bank_core_inst.vh"
  );


  modbus_bank_io #(
    .BITS_PER_BEAT(BITS_PER_BEAT), .READ_BACK_RAM(READ_BACK_RAM),
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i),
    .coils_o(coils_o), .discretes_i(discretes_i), .inputs_i(inputs_i), .holdings_o(holdings_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
