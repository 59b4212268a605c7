// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_ports - the ports of a bank towards the core: grant question and Wishbone; included in a module's port list.
//
// It ends without a comma.  modbus_bank_wires.vh declares the wires between core and bank, modbus_bank_inst.vh connects a
// bank to them, modbus_bank_core_inst.vh the core.
//
// Grant: the core shows the range and holds grant_req_i until grant_ack_o; with it exception_o is 0, or the exception code
// of the answer.  The core may withdraw the question: a bank forgets it when grant_req_i falls.
// Burst: Wishbone B4 classic, at most the range that was granted, under one wb_cyc_i.  While wb_cyc_i is high the core
// shows the address of a beat no later than its strobe, and one clock earlier where the strobe was low.
// Bits: with BITS_PER_BEAT = 1 of the core a beat is one item, in data bit 0.  With 16 it is all items from the address
// of the beat on that lie in one word of 16 addresses, up to grant_last_i: item n is data bit n mod 16, the other data
// bits mean nothing; modbus_bank_lanes tells which count.  The next beat begins at the next multiple of 16.
// A core with CHECK_WRITES = 1 shows the beats of a write twice under one wb_cyc_i.  The first time the space is
// MB_SPACE_CHECK_COILS or MB_SPACE_CHECK_HOLDINGS: the bank stores nothing, answers ack if it would accept the value, else
// err with the code in exception_o.
// The core breaks a burst off when the bank is silent for the stall limit: wb_cyc_i falls.  A bank forgets the access
// then.  An ack that comes later would be taken for one of the next request.

  input  wire        grant_req_i,                // level until grant_ack_o
  input  wire [2:0]  grant_space_i,              // MB_SPACE_*
  input  wire [15:0] grant_first_i,              // first and last item; the last is not below the first
  input  wire [15:0] grant_last_i,               // through the burst
  input  wire        grant_write_i,
  input  wire [15:0] grant_file_i,               // space 4: file number, through the burst; the items are records
  output wire        grant_ack_o,                // strobe
  output wire [3:0]  exception_o,                // with grant_ack_o: 0 granted, else the code; with wb_err_o: 0 means 04
  input  wire        wb_cyc_i,
  input  wire        wb_stb_i,
  input  wire        wb_we_i,
  input  wire [18:0] wb_adr_i,                   // {space, item}
  input  wire [15:0] wb_dat_i,                   // coils: bit 0, or item n in bit n mod 16, the others mean nothing
  output wire [15:0] wb_dat_o,
  output wire        wb_ack_o,                   // only with wb_stb_i
  output wire        wb_err_o
