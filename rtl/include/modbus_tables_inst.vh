// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_tables_inst - passes the parameters of modbus_tables.vh on; included in an instance's parameter list.

  .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
  .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
  .READ_ONLY_BASE(READ_ONLY_BASE), .READ_ONLY_COUNT(READ_ONLY_COUNT), .FILE_COUNT(FILE_COUNT),
  .FILE_RECORDS(FILE_RECORDS), .OVERLAY(OVERLAY)
