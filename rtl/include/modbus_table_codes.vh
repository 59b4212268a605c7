// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_table_codes - TABLE_CODES: FUNCTION_CODES without the codes of tables that do not exist, for the core.
//
// Included in the body of a module with the parameters FUNCTION_CODES and those of modbus_tables.vh.  The rule is the same
// for every bank: a function code whose table has size 0 is left out and answers exception 01.

  // With OVERLAY the holding registers are all four tables.  Numbers without a size take the width of FUNCTION_CODES.
  localparam TABLE_CODES = FUNCTION_CODES
    & ~((OVERLAY == 0 && COIL_COUNT == 0)     ? 'h00008022 : 'h0)    // 01 05 0F
    & ~((OVERLAY == 0 && DISCRETE_COUNT == 0) ? 'h00000004 : 'h0)    // 02
    & ~((OVERLAY == 0 && INPUT_COUNT == 0)    ? 'h00000010 : 'h0)    // 04
    & ~((HOLDING_COUNT == 0)                  ? 'h01C10048 : 'h0)    // 03 06 10 16 17 18
    & ~((FILE_COUNT == 0)                     ? 'h00300000 : 'h0);   // 14 15
