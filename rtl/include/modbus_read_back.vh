// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_read_back - where modbus_bank_io reads holding registers back from; included in a module's parameter list.
//
// It ends without a comma: a further parameter begins with one, on a line of its own.

  parameter integer READ_BACK_RAM = 0            // 0: from the registers, 1: from a block RAM with fewer logic cells
