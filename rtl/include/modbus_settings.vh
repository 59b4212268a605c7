// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_settings - the run-time settings of modbus_rtu_core as parameters of a drop-in, each with a sensible default.
//
// Included in the parameter list of a drop-in; it ends without a comma.  modbus_settings_value.vh makes of them the
// vector SETTINGS for settings_i.

  parameter integer ADDRESS             = 1,             // 1..247; 0: only broadcasts are obeyed
  parameter integer BAUD                = 19200,         // bits per second: CLK_HZ / 65535 to CLK_HZ / 8
  parameter integer FORMAT              = 0,             // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  parameter integer BROADCAST           = 1,             // 1: address 0 is obeyed
  parameter integer GAP_COUNT_ONLY      = 0,             // 1: a gap above t1.5 is only reported, 0: it spoils the frame
  parameter integer STRICT_TURNAROUND   = 0,             // 1: t3.5 of silence behind the own answer
  parameter integer DROP_LATE           = 0,             // 1: no answer if the line was heard since the request
  parameter integer RESPONSE_DELAY      = 0,             // bit times before the answer, 0..4095
  parameter integer STALL_LIMIT         = 0,             // bit times a bank may be silent, 0..65535; 0: for ever
  parameter integer DE_LEAD             = 1,             // bit times from driver enable to the start bit, 0..15
  parameter integer DE_TAIL             = 0,             // bit times from the last stop bit to driver off, 0..15
  parameter integer ASCII               = 0,             // 1: ASCII mode, with ASCII_MODE = 1; 0: RTU
  parameter integer ASCII_DATA_BITS     = 7,             // data bits of a character in ASCII mode, 7..8
  parameter integer ASCII_EXTRA         = 0              // the time-out is at least so many ASCII_TIMEOUT_MS longer, 0..3
