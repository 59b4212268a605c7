// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// slave_bench - core and block RAM like modbus_rtu_slave, with every setting and event on a port of its own.

`default_nettype none
`include "modbus_defs.vh"

module slave_bench #(
`include "modbus_tables.vh"
  ,
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
`include "modbus_table_codes.vh"

  core_bench #(
    .FUNCTION_CODES(TABLE_CODES), .MAX_BIT_TIME(MAX_BIT_TIME),
`include "modbus_config_inst.vh"
  ) u_bench (
`include "flat_inst.vh"
    ,
`include "modbus_bank_core_inst.vh"
  );


  modbus_bank_ram #(
    .BITS_PER_BEAT(BITS_PER_BEAT), .CHECK_WRITES(CHECK_WRITES),
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i),
    .host_we_i(host_we_i), .host_adr_i(host_adr_i), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o),
    .host_ack_o(host_ack_o), .host_err_o(host_err_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
