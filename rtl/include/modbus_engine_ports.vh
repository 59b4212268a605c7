// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_engine_ports - what modbus_engine shows to bank, user and host; the same ports of modbus_rtu_core.
//
// Included at the end of a port list; modbus_engine_ports_inst.vh connects them by name.

  // Host's state: fields MB_HOST_* of modbus_defs.vh
  input  wire [`MB_HOST_STATE_WIDTH-1:0] host_state_i,

  // Bank: grant
  output wire        grant_req_o,                // level until grant_ack_i or the stall limit; then forget the question
  output wire [2:0]  grant_space_o,              // MB_SPACE_*
  output wire [15:0] grant_first_o,
  output wire [15:0] grant_last_o,               // not below the first; through the burst
  output wire        grant_write_o,
  output wire [15:0] grant_file_o,               // space 4: file number, through the burst; the items are records
  input  wire        grant_ack_i,                // strobe: the answer
  input  wire [3:0]  exception_i,                // with grant_ack_i: 0 granted; with wb_err_i: 0 means 04

  // Bank: Wishbone B4 classic master
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [18:0] wb_adr_o,                   // {space, item}
  output wire [15:0] wb_dat_o,                   // coils: bit 0, or item n in bit n mod 16, the others mean nothing
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i,

  // User functions, see docs/user_functions.md
  output wire        user_req_o,                 // level until MB_USER_DONE or the stall limit: a request for the user
  output wire [7:0]  user_count_o,               // its bytes, address included, check field not
  input  wire [7:0]  user_adr_i,                 // which of them
  output wire [7:0]  user_dat_o,                 // that byte, a clock later
  input  wire [`MB_USER_REPLY_WIDTH-1:0] user_reply_i,   // fields MB_USER_*

  // Status port: 00 diagnostic register, 01 bit 0 listen-only mode, 02 entries of the event log, 0AH event counter,
  // 0BH..12H counters by sub-function of 08H, 40H + n log entry n, the newest first
  input  wire        status_stb_i,               // level until status_ack_o
  input  wire [6:0]  status_adr_i,
  output wire [15:0] status_dat_o,               // valid with status_ack_o
  output wire        status_ack_o,               // strobe

  output wire        write_stb_o,                // strobe: a write is committed: grant_space_o, _first_o, _last_o, _file_o
  output wire        listen_only_o               // level : listen-only mode
