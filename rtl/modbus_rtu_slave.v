// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_slave - drop-in Modbus RTU slave: core and block RAM with a Wishbone port for the host.
//
// Connect it between an RS-485 transceiver and your logic; see modbus_rtu_core for the line and modbus_bank_ram for
// the host side.  A table of size 0 does not exist: its function codes answer exception 01 and cost nothing.

`default_nettype none

module modbus_rtu_slave #(
  parameter integer CLK_HZ              = 50000000,      // clk_i in hertz
  parameter integer T15_MIN_US          = 750,           // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US          = 1750,          // floor of t3.5 in microseconds, 0: none
  parameter [63:0]  FUNCTION_CODES      = 64'h0000080001F399FE,  // bit n: function code n is built in
  parameter [127:0] USER_CODES          = 128'd0,        // bit n: function code n is offered to the user first
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
`include "modbus_tables.vh"
  ,
  parameter [127:0] SERVER_ID           = 128'h09,       // function code 11H: its identifier, right-justified
  parameter integer SERVER_ID_BYTES     = 1,             // 1..16
  parameter [1999:0] ADDITIONAL_DATA    = 2000'd0,       // what follows the run indicator, right-justified
  parameter integer ADDITIONAL_DATA_BYTES = 0,           // 0..234
  parameter [1951:0] VENDOR_NAME        = "VENDOR",      // function code 2BH: objects 00, 01, 02
  parameter [1951:0] PRODUCT_CODE       = "PRODUCT",
  parameter [1951:0] REVISION           = "V1.0",
  parameter [1951:0] VENDOR_URL         = "",            // 03 to 06, not there if empty
  parameter [1951:0] PRODUCT_NAME       = "",
  parameter [1951:0] MODEL_NAME         = "",
  parameter [1951:0] USER_APPLICATION_NAME = "",
  parameter [4095:0] PRIVATE_OBJECTS    = 4096'd0,       // {object 80H.., length, value}..., right-justified
  parameter [7:0]   CONFORMITY          = 8'h81,         // 01 02 03 81 82 83
  parameter integer DEVICE_ID_LIMIT     = 253,           // largest PDU of its answers
  parameter integer ALIVE_TIMEOUT_MS    = 0              // alive_o falls so long after the last frame for us, 0: never
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Configuration: tie to constants, or change while the line is idle
  input  wire [7:0]  address_i,                  // 1..247; other values: broadcast only
  input  wire [15:0] bit_time_i,                 // clocks per bit, 8..65535
  input  wire [1:0]  format_i,                   // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  input  wire        broadcast_en_i,             // 1: address 0 is obeyed
  input  wire        gap_count_only_i,           // 1: a gap above t1.5 is only reported, 0: spoils the frame
  input  wire        strict_turnaround_i,        // 1: t3.5 of silence behind the own answer
  input  wire [11:0] response_delay_i,           // bit times before the answer
  input  wire [15:0] stall_limit_i,              // bit times a bank may be silent, 0: for ever
  input  wire [3:0]  de_lead_i,                  // bit times from driver enable to the start bit
  input  wire [3:0]  de_tail_i,                  // bit times from the last stop bit to driver off
  input  wire        busy_i,                     // 1: exception 06 where nothing else is wrong
  input  wire [3:0]  failure_i,                  // 0, or the exception code to give instead of execution
  input  wire [7:0]  exception_status_i,         // function code 07H
  input  wire        run_indicator_i,            // function code 11H: 1 FFH, 0 00H
  input  wire [15:0] diagnostic_i,               // bits 15..1 set those of the diagnostic register
  input  wire        write_lock_i,               // 1: every write answers exception 02

  // Host side of the RAM: Wishbone B4 classic slave
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,                 // {space, item}
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o,                 // address outside the tables

  // User functions, see docs/user_functions.md
  output wire        user_req_o,                 // level until user_done_i or the stall limit: a request for the user
  output wire [7:0]  user_count_o,               // its bytes, address included, check field not
  input  wire [7:0]  user_adr_i,                 // which of them
  output wire [7:0]  user_dat_o,                 // a clock later
  input  wire        user_put_i,                 // strobe: append a byte to the answer
  input  wire [7:0]  user_dat_i,
  input  wire        user_done_i,                // strobe: finished, and how:
  input  wire        user_pass_i,                //   1: not the user's after all
  input  wire [3:0]  user_exception_i,           //   0: the answer is complete, else the exception code

  // Diagnostics
  output wire        listen_only_o,
  output wire [15:0] diagnostic_register_o,
  output wire [6:0]  log_count_o,                // entries of the event log, 0..64
  input  wire        counter_stb_i,              // level until counter_ack_o
  input  wire [6:0]  counter_adr_i,              // 0AH event counter, 0BH..12H by sub-function, 40H + n log entry
  output wire [15:0] counter_dat_o,              // valid with counter_ack_o
  output wire        counter_ack_o,

  // Events: strobes of one clock, but alive_o and rx_active_o
  output wire        write_stb_o,                // a write is committed:
  output wire [2:0]  write_space_o,              //   valid with write_stb_o
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire [15:0] write_file_o,               //   space 4: file number
  output wire        alive_o,                    // level : a master talks to us
  output wire        rx_active_o,                // level : a frame is being received
  output wire        frame_stb_o,                // good frame, for whomever
  output wire        err_parity_o,               // bad frames, when they end
  output wire        err_framing_o,
  output wire        err_overrun_o,              // characters came while a request was worked on
  output wire        err_crc_o,                  // check field wrong and nothing else
  output wire        err_short_o,                // fewer than 4 bytes
  output wire        err_long_o,                 // more than 256 bytes
  output wire        err_gap_o                   // a gap above t1.5
);

`include "modbus_table_codes.vh"
`include "modbus_bank_wires.vh"

  modbus_rtu_core #(
    .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .FUNCTION_CODES(TABLE_CODES), .USER_CODES(USER_CODES),
    .MAX_READ_BITS(MAX_READ_BITS), .MAX_WRITE_BITS(MAX_WRITE_BITS), .MAX_READ_REGISTERS(MAX_READ_REGISTERS),
    .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS), .RW_MAX_READ(RW_MAX_READ), .RW_MAX_WRITE(RW_MAX_WRITE),
    .SERVER_ID(SERVER_ID), .SERVER_ID_BYTES(SERVER_ID_BYTES), .ADDITIONAL_DATA(ADDITIONAL_DATA),
    .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES), .VENDOR_NAME(VENDOR_NAME), .PRODUCT_CODE(PRODUCT_CODE),
    .REVISION(REVISION), .VENDOR_URL(VENDOR_URL), .PRODUCT_NAME(PRODUCT_NAME), .MODEL_NAME(MODEL_NAME),
    .USER_APPLICATION_NAME(USER_APPLICATION_NAME), .PRIVATE_OBJECTS(PRIVATE_OBJECTS), .CONFORMITY(CONFORMITY),
    .DEVICE_ID_LIMIT(DEVICE_ID_LIMIT), .ALIVE_TIMEOUT_MS(ALIVE_TIMEOUT_MS)
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .address_i(address_i),
    .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(broadcast_en_i),
    .gap_count_only_i(gap_count_only_i), .strict_turnaround_i(strict_turnaround_i),
    .response_delay_i(response_delay_i), .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i),
    .de_tail_i(de_tail_i), .busy_i(busy_i), .failure_i(failure_i),
    .exception_status_i(exception_status_i), .run_indicator_i(run_indicator_i), .diagnostic_i(diagnostic_i),
`include "modbus_bank_core_inst.vh"
    ,
    .user_req_o(user_req_o), .user_count_o(user_count_o), .user_adr_i(user_adr_i), .user_dat_o(user_dat_o),
    .user_put_i(user_put_i), .user_dat_i(user_dat_i), .user_done_i(user_done_i), .user_pass_i(user_pass_i),
    .user_exception_i(user_exception_i), .listen_only_o(listen_only_o),
    .diagnostic_register_o(diagnostic_register_o), .log_count_o(log_count_o), .counter_stb_i(counter_stb_i),
    .counter_adr_i(counter_adr_i), .counter_dat_o(counter_dat_o), .counter_ack_o(counter_ack_o),
    .write_stb_o(write_stb_o), .write_space_o(write_space_o), .write_first_o(write_first_o),
    .write_last_o(write_last_o), .write_file_o(write_file_o), .alive_o(alive_o), .rx_active_o(rx_active_o), .frame_stb_o(frame_stb_o),
    .err_parity_o(err_parity_o), .err_framing_o(err_framing_o), .err_overrun_o(err_overrun_o),
    .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o), .err_gap_o(err_gap_o)
  );

  modbus_bank_ram #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i),
`include "modbus_bank_inst.vh"
    ,
    .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i), .host_we_i(host_we_i), .host_adr_i(host_adr_i),
    .host_dat_i(host_dat_i), .host_dat_o(host_dat_o), .host_ack_o(host_ack_o), .host_err_o(host_err_o)
  );

endmodule

`default_nettype wire
