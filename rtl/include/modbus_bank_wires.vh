// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_wires - the wires between modbus_rtu_core and a bank: grant question and Wishbone.
//
// modbus_bank_core_inst.vh connects them to the core, modbus_bank_inst.vh to a bank.

  wire        grant_req, grant_write, grant_ack, wb_cyc, wb_stb, wb_we, wb_ack, wb_err;
  wire [2:0]  grant_space;
  wire [3:0]  exception;
  wire [15:0] grant_first, grant_last, grant_file, wb_write, wb_read;
  wire [18:0] wb_adr;
