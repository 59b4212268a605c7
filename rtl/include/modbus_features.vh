// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_features - what FUNCTION_CODES and USER_CODES ask for; included inside a module that has these parameters.

// Not every module uses each of them:
// verilator lint_off UNUSED
localparam [127:0] BIT_FUNCTIONS =
  `MB_BIT(`MB_FC_READ_COILS) | `MB_BIT(`MB_FC_READ_DISCRETE_INPUTS) | `MB_BIT(`MB_FC_WRITE_SINGLE_COIL) |
  `MB_BIT(`MB_FC_WRITE_MULTIPLE_COILS);
// The spaces of these, discrete inputs and holding registers, have odd numbers.
localparam [127:0] ODD_SPACE_FUNCTIONS =
  `MB_BIT(`MB_FC_READ_DISCRETE_INPUTS) | `MB_BIT(`MB_FC_READ_HOLDING_REGISTERS) |
  `MB_BIT(`MB_FC_WRITE_SINGLE_REGISTER) | `MB_BIT(`MB_FC_WRITE_MULTIPLE_REGISTERS) |
  `MB_BIT(`MB_FC_MASK_WRITE_REGISTER) | `MB_BIT(`MB_FC_READ_WRITE_REGISTERS);
localparam [127:0] FILE_FUNCTIONS = `MB_BIT(`MB_FC_READ_FILE_RECORD) | `MB_BIT(`MB_FC_WRITE_FILE_RECORD);
localparam [127:0] DIAGNOSTIC_FUNCTIONS =
  `MB_BIT(`MB_FC_DIAGNOSTICS) | `MB_BIT(`MB_FC_GET_EVENT_COUNTER) | `MB_BIT(`MB_FC_GET_EVENT_LOG);
localparam [127:0] IDENTITY_FUNCTIONS = `MB_BIT(`MB_FC_REPORT_SERVER_ID) | `MB_BIT(`MB_FC_ENCAPSULATED);
// They come back to the request as it was, or to a place in it.
localparam [127:0] CONTEXT_FUNCTIONS =
  `MB_BIT(`MB_FC_DIAGNOSTICS) | FILE_FUNCTIONS | `MB_BIT(`MB_FC_ENCAPSULATED);

localparam integer HAS_BITS  = ((FUNCTION_CODES & BIT_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_WORDS = ((FUNCTION_CODES & ~BIT_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_OTHER_SPACES = ((FUNCTION_CODES & ~ODD_SPACE_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_MASK  = FUNCTION_CODES[`MB_FC_MASK_WRITE_REGISTER] ? 1 : 0;
localparam integer HAS_FIFO  = FUNCTION_CODES[`MB_FC_READ_FIFO_QUEUE] ? 1 : 0;
localparam integer HAS_FILES = ((FUNCTION_CODES & FILE_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_DIAGNOSTICS = ((FUNCTION_CODES & DIAGNOSTIC_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_IDENTITY    = ((FUNCTION_CODES & IDENTITY_FUNCTIONS) != 0) ? 1 : 0;
localparam integer HAS_USER  = (USER_CODES != 0) ? 1 : 0;
// Function codes behind the direct part of the table
localparam integer HAS_OTHER_CODES = ((FUNCTION_CODES >> `MB_OTHER_CODES) != 0) ? 1 : 0;
// Cursor and count kept beside those in use
localparam integer HAS_CONTEXT = ((FUNCTION_CODES & CONTEXT_FUNCTIONS) != 0) ? 1 : HAS_USER;
// An answer in a half of its own
localparam integer HAS_UPPER = FUNCTION_CODES[`MB_FC_READ_FILE_RECORD] ? 1 : HAS_USER;
localparam integer HAS_INTERNAL = HAS_DIAGNOSTICS | HAS_IDENTITY;       // spaces inside the core
// What is not in the request: addresses, quantities, bytes
localparam integer HAS_LITERALS = HAS_INTERNAL | HAS_FILES | HAS_FIFO | HAS_OTHER_CODES;
// Steps above 15
localparam integer HAS_MORE_STEPS = HAS_LITERALS | HAS_USER;
// verilator lint_on UNUSED
