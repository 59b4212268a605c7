// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_slave - drop-in Modbus RTU slave: core and block RAM with a Wishbone port for the host.
//
// Connect it between an RS-485 transceiver and your logic.  Clock, line and host port are all it needs; the settings
// are parameters.  Behind the host port are the tables, and as space 5 the counters, the event log and the settings of
// the core: modbus_host_map has the list.  With HOST_SETTINGS = 1 the host changes the settings at run time.
// With LINE_HEALTH = 1 the host reads there what modbus_line_health counts and measures of the line.
// A table of size 0 does not exist: its function codes answer exception 01 and cost nothing.

`default_nettype none
`include "modbus_defs.vh"

module modbus_rtu_slave #(
  parameter integer HOST_MAP      = 1,           // 1: counters, event log and settings are space 5 of the host port
  parameter integer HOST_SETTINGS = 0,           // 1: the host may change the settings at run time
  parameter integer LINE_HEALTH   = 0,           // 1: and in it, items 20 to 27, the words of modbus_line_health
`include "modbus_settings.vh"
  ,
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
  output wire        host_err_o,                 // no such item

  // What happens
  output wire        write_stb_o,                // strobe: a write from the line is committed; valid with it:
  output wire [2:0]  write_space_o,              //   MB_SPACE_*
  output wire [15:0] write_first_o,              //   first address
  output wire [15:0] write_last_o,               //   last address
  output wire [15:0] write_file_o,               //   space 4: file number
  output wire        alive_o                     // level : a master talks to us
);

  generate
    if (LINE_HEALTH < 0 || LINE_HEALTH > 1) begin : gen_line_health
      ERROR_modbus_rtu_slave_LINE_HEALTH_is_0_or_1 illegal_parameter ();
    end
  endgenerate

`include "modbus_settings_value.vh"
`include "modbus_table_codes.vh"
`include "modbus_bank_wires.vh"

  wire [`MB_SETTINGS_WIDTH-1:0]   settings;
  wire [`MB_HOST_STATE_WIDTH-1:0] host_state;
  wire                            status_stb, status_ack, idle, write_lock;
  wire [6:0]                      status_adr;
  wire [15:0]                     status_read, bank_write, bank_read;
  wire                            bank_cyc, bank_stb, bank_we, bank_ack, bank_err;
  wire [18:0]                     bank_adr;
  wire [`MB_EVENTS_WIDTH-1:0]     events;
  wire                            rx_active, health_stb, health_ack, health_clear;
  wire [2:0]                      health_adr;
  wire [15:0]                     health_read;

  localparam integer SLOWEST = (HOST_MAP != 0 && HOST_SETTINGS != 0) ? MAX_BIT_TIME : BIT_TIME;

  // The drop-in leaves the user port alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES), .MAX_BIT_TIME(SLOWEST),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(status_stb), .status_adr_i(status_adr), .status_dat_o(status_read),
    .status_ack_o(status_ack), .write_stb_o(write_stb_o), .events_o(events), .alive_o(alive_o), .rx_active_o(rx_active),
    .listen_only_o(), .unit_o(), .idle_o(idle),
`include "modbus_bank_core_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

  assign write_space_o = grant_space;
  assign write_first_o = grant_first;
  assign write_last_o  = grant_last;
  assign write_file_o  = grant_file;

  modbus_host_map #(
    .HOST_MAP(HOST_MAP), .HOST_SETTINGS(HOST_SETTINGS), .BIT_FRACTIONS(BIT_FRACTIONS), .ASCII_MODE(ASCII_MODE),
    .LINE_HEALTH(LINE_HEALTH), .INITIAL_SETTINGS(SETTINGS), .INITIAL_STATE(`MB_HOST_AT_REST)
  ) u_host_map (
    .clk_i(clk_i), .rst_i(rst_i), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i), .host_we_i(host_we_i),
    .host_adr_i(host_adr_i), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o), .host_ack_o(host_ack_o),
    .host_err_o(host_err_o), .bank_cyc_o(bank_cyc), .bank_stb_o(bank_stb), .bank_we_o(bank_we), .bank_adr_o(bank_adr),
    .bank_dat_o(bank_write), .bank_dat_i(bank_read), .bank_ack_i(bank_ack), .bank_err_i(bank_err),
    .status_stb_o(status_stb), .status_adr_o(status_adr), .status_dat_i(status_read), .status_ack_i(status_ack),
    .health_stb_o(health_stb), .health_adr_o(health_adr), .health_dat_i(health_read), .health_ack_i(health_ack),
    .health_clear_o(health_clear), .settings_i(SETTINGS), .host_state_i(`MB_HOST_AT_REST), .write_lock_i(1'b0),
    .idle_i(idle), .settings_o(settings), .host_state_o(host_state), .write_lock_o(write_lock)
  );

  generate
    if (HOST_MAP != 0 && LINE_HEALTH != 0) begin : gen_health
      modbus_line_health #(.MAX_BIT_TIME(SLOWEST)) u_health (
        .clk_i(clk_i), .rst_i(rst_i), .clear_i(health_clear), .rxd_i(rxd_i), .de_i(de_o), .rx_active_i(rx_active),
        .events_i(events), .settings_i(settings), .stb_i(health_stb), .adr_i(health_adr), .dat_o(health_read),
        .ack_o(health_ack)
      );
    end else begin : gen_no_health
      wire unused = &{1'b0, events, rx_active, health_stb, health_adr, health_clear};
      assign health_read = 16'd0;
      assign health_ack  = 1'b0;
    end
  endgenerate

  modbus_bank_ram #(
    .BITS_PER_BEAT(BITS_PER_BEAT), .CHECK_WRITES(CHECK_WRITES),
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock), .host_cyc_i(bank_cyc), .host_stb_i(bank_stb),
    .host_we_i(bank_we), .host_adr_i(bank_adr), .host_dat_i(bank_write), .host_dat_o(bank_read),
    .host_ack_o(bank_ack), .host_err_o(bank_err),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
