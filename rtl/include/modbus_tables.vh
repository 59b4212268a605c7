// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_tables - the parameters that say which tables a bank has; included in a module's parameter list.
//
// It ends without a comma: a further parameter begins with one, on a line of its own.  modbus_tables_inst.vh passes
// the parameters on.  The macros MB_BITS_DEFAULT and MB_WORDS_DEFAULT, defined before the include, set the default sizes of
// the tables of bits and of registers; without them both are 64.

`ifndef MB_BITS_DEFAULT
`define MB_BITS_DEFAULT 64
`endif
`ifndef MB_WORDS_DEFAULT
`define MB_WORDS_DEFAULT 64
`endif

  parameter integer COIL_BASE       = 0,                   // first address of each table
  parameter integer COIL_COUNT      = `MB_BITS_DEFAULT,    // its size, 0..65536; 0: no such table
  parameter integer DISCRETE_BASE   = 0,
  parameter integer DISCRETE_COUNT  = `MB_BITS_DEFAULT,
  parameter integer INPUT_BASE      = 0,
  parameter integer INPUT_COUNT     = `MB_WORDS_DEFAULT,
  parameter integer HOLDING_BASE    = 0,
  parameter integer HOLDING_COUNT   = `MB_WORDS_DEFAULT,
  parameter integer READ_ONLY_BASE  = 0,                   // holding registers that answer exception 02 to a write
  parameter integer READ_ONLY_COUNT = 0,
  parameter integer FILE_COUNT      = 0,                   // files 1..count; 0: none
  parameter integer FILE_RECORDS    = 256,                 // records 0.. of each, 1..10000
  parameter integer OVERLAY         = 0                    // 1: the holding registers are all four tables

`undef MB_BITS_DEFAULT
`undef MB_WORDS_DEFAULT
