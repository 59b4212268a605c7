// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_table_codes - TABLE_CODES: FUNCTION_CODES without the codes of tables that do not exist, for the core.
//
// Included in the body of a module with the parameters FUNCTION_CODES and those of modbus_tables.vh.  The rule is the same
// for every bank: a function code whose table has size 0 is left out and answers exception 01.

  // With OVERLAY the holding registers are all four tables.
  localparam [127:0] TABLE_CODES = FUNCTION_CODES
    & ~((OVERLAY == 0 && COIL_COUNT == 0)     ? `MB_COIL_FUNCTIONS     : 128'd0)
    & ~((OVERLAY == 0 && DISCRETE_COUNT == 0) ? `MB_DISCRETE_FUNCTIONS : 128'd0)
    & ~((OVERLAY == 0 && INPUT_COUNT == 0)    ? `MB_INPUT_FUNCTIONS    : 128'd0)
    & ~((HOLDING_COUNT == 0)                  ? `MB_HOLDING_FUNCTIONS  : 128'd0)
    & ~((FILE_COUNT == 0)                     ? `MB_FILE_FUNCTIONS     : 128'd0);
