// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_table_widths - the port widths of the tables as flat vectors, derived from modbus_tables.vh; leave them alone.
//
// Included in a parameter list behind modbus_tables.vh and a comma; it ends without one.

  parameter integer COIL_WIDTH     = (COIL_COUNT > 0)     ? COIL_COUNT : 1,
  parameter integer DISCRETE_WIDTH = (DISCRETE_COUNT > 0) ? DISCRETE_COUNT : 1,
  parameter integer INPUT_WIDTH    = (INPUT_COUNT > 0)    ? 16 * INPUT_COUNT : 16,
  parameter integer HOLDING_WIDTH  = (HOLDING_COUNT > 0)  ? 16 * HOLDING_COUNT : 16
