// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_wires - the wires between the core and one bank; included in a module's body.

  wire        grant_req, grant_write, grant_ack, wb_cyc, wb_stb, wb_we, wb_ack, wb_err;
  wire [2:0]  grant_space;
  wire [3:0]  exception;
  wire [15:0] grant_first, grant_last, grant_file;
  wire [15:0] wb_write, wb_read;                 // from the core, to the core
  wire [18:0] wb_adr;
