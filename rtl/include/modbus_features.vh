// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_features - what FUNCTION_CODES and USER_CODES ask for; included inside a module that has these parameters.

// Not every module uses each of them:
// verilator lint_off UNUSED
localparam integer HAS_BITS   = ((FUNCTION_CODES & 128'h0000000000008026) != 0) ? 1 : 0;   // 01 02 05 0F
localparam integer HAS_WORDS  = ((FUNCTION_CODES & ~128'h0000000000008026) != 0) ? 1 : 0;  // all others
// Other spaces than the holding registers and the discrete inputs, which have odd numbers
localparam integer HAS_OTHER_SPACES = ((FUNCTION_CODES & ~128'h0000000000C1004C) != 0) ? 1 : 0;  // but 02 03 06 10 16 17
localparam integer HAS_MASK   = ((FUNCTION_CODES & 128'h0000000000400000) != 0) ? 1 : 0;   // 16
localparam integer HAS_FIFO   = ((FUNCTION_CODES & 128'h0000000001000000) != 0) ? 1 : 0;   // 18
localparam integer HAS_FILES  = ((FUNCTION_CODES & 128'h0000000000300000) != 0) ? 1 : 0;   // 14 15
localparam integer HAS_DIAGNOSTICS = ((FUNCTION_CODES & 128'h0000000000001900) != 0) ? 1 : 0;   // 08 0B 0C
localparam integer HAS_IDENTITY    = ((FUNCTION_CODES & 128'h0000080000020000) != 0) ? 1 : 0;   // 11 2B
localparam integer HAS_USER   = (USER_CODES != 0) ? 1 : 0;
// Cursor and count of the request kept beside those in use
localparam integer HAS_CONTEXT = ((FUNCTION_CODES & 128'h0000080000300100) != 0) ? 1 : HAS_USER;   // 08 14 15 2B
// An answer in a half of its own
localparam integer HAS_UPPER  = ((FUNCTION_CODES & 128'h0000000000100000) != 0) ? 1 : HAS_USER;    // 14
localparam integer HAS_INTERNAL = HAS_DIAGNOSTICS | HAS_IDENTITY;       // spaces inside the core
// What is not in the request: addresses, quantities, bytes
localparam integer HAS_LITERALS = HAS_INTERNAL | HAS_FILES | HAS_FIFO;
// Steps above 15
localparam integer HAS_MORE_STEPS = HAS_LITERALS | HAS_USER;
// verilator lint_on UNUSED
