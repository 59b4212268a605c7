// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_slave - drop-in Modbus RTU slave: core and block RAM with a Wishbone port for the host.
//
// Connect it between an RS-485 transceiver and your logic.  Clock, line and host port are all it needs; the settings
// are parameters.  See modbus_bank_ram for the host port, modbus_rtu_core for settings that change at run time.
// A table of size 0 does not exist: its function codes answer exception 01 and cost nothing.

`default_nettype none
`include "modbus_defs.vh"

module modbus_rtu_slave #(
`include "modbus_settings.vh"
`include "modbus_tables.vh"
  ,
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high; 0 if there is no reset

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Host: Wishbone B4 classic slave
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,                 // {space, item}
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o,                 // address outside the tables

  // What happens
  output wire        write_stb_o,                // strobe: a write from the line is committed; valid with it:
  output wire [2:0]  write_space_o,              //   MB_SPACE_*
  output wire [15:0] write_first_o,              //   first address
  output wire [15:0] write_last_o,               //   last address
  output wire [15:0] write_file_o,               //   space 4: file number
  output wire        alive_o                     // level : a master talks to us
);

`include "modbus_settings_value.vh"
`include "modbus_bank_wires.vh"

  // The function codes of a table that does not exist are left out: they answer exception 01 and cost nothing.
`include "modbus_table_codes.vh"

  // The drop-in leaves the user port and the status port alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(SETTINGS),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(write_stb_o), .events_o(), .alive_o(alive_o), .rx_active_o(), .listen_only_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

  assign write_space_o = grant_space;
  assign write_first_o = grant_first;
  assign write_last_o  = grant_last;
  assign write_file_o  = grant_file;

  modbus_bank_ram #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i),
    .host_we_i(host_we_i), .host_adr_i(host_adr_i), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o),
    .host_ack_o(host_ack_o), .host_err_o(host_err_o),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
