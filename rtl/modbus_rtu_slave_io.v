// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_slave_io - drop-in Modbus RTU slave with flat vectors: LEDs, relays, switches, sensors.
//
// Connect it between an RS-485 transceiver and your signals.  Coils and holding registers come out, discrete inputs
// and input registers go in; register k is [16*k +: 16], k counted from the table's base.  The settings are
// parameters.  See modbus_bank_io for when outputs change, modbus_rtu_core for settings that change at run time.
// A table of size 0 does not exist: its function codes answer exception 01 and cost nothing; leave its port open, or
// tie it to 0 if it is an input.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 16
`define MB_WORDS_DEFAULT 8

module modbus_rtu_slave_io #(
`include "modbus_settings.vh"
  ,
`include "modbus_tables.vh"
  ,
`include "modbus_read_back.vh"
  ,
`include "modbus_table_widths.vh"
  ,
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high; 0 if there is no reset

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Tables
  output wire [COIL_WIDTH-1:0]     coils_o,
  input  wire [DISCRETE_WIDTH-1:0] discretes_i,  // synchronous to clk_i, like inputs_i
  input  wire [INPUT_WIDTH-1:0]    inputs_i,
  output wire [HOLDING_WIDTH-1:0]  holdings_o,

  output wire        alive_o                     // level : a master talks to us
);

`include "modbus_settings_value.vh"
`include "modbus_bank_wires.vh"

  // The function codes of a table that does not exist are left out: they answer exception 01 and cost nothing.
`include "modbus_table_codes.vh"

  // The drop-in leaves the user port and the status port alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES), .MAX_BIT_TIME(BIT_TIME),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(SETTINGS),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(), .alive_o(alive_o), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY


  modbus_bank_io #(
    .BITS_PER_BEAT(BITS_PER_BEAT), .READ_BACK_RAM(READ_BACK_RAM),
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0),
    .coils_o(coils_o), .discretes_i(discretes_i), .inputs_i(inputs_i), .holdings_o(holdings_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
