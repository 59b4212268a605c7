// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_config - the parameters of the core, each once.
//
// Included in the parameter list of the core, of the drop-ins and of every module inside that needs some of them;
// modbus_config_inst.vh passes all of them on.  An illegal value stops elaboration where the parameter is used.

// A module need not use each of them:
// verilator lint_off UNUSED
  parameter integer CLK_HZ              = 50000000,      // clk_i in hertz, 1000..1000000000
  parameter integer T15_MIN_US          = 750,           // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US          = 1750,          // floor of t3.5 in microseconds, 0: none
  parameter integer MAX_BIT_TIME        = 65535,         // clocks per bit at the slowest rate; what is lower takes fewer cells
  parameter integer BIT_FRACTIONS       = 0,             // 1: a bit may last a sixteenth of a clock more or less
  parameter integer GLITCH_FILTER       = 0,             // clocks: a shorter pulse on rxd_i is not seen, 0..255
  parameter [247:0] UNIT_SET            = 248'd0,        // bit n: address n is answered too, n in 1..247
  parameter integer UNIT_PORT           = 0,             // 1: so is one for which the host sets MB_HOST_UNIT_OURS
  parameter integer ASCII_MODE          = 0,             // 1: ASCII mode is built in, chosen by MB_SET_ASCII
  parameter integer ASCII_TIMEOUT_MS    = 1000,          // longest silence inside a frame of ASCII mode, in milliseconds
  parameter [127:0] FUNCTION_CODES      = `MB_ALL_FUNCTIONS,  // bit n: function code n is built in
  parameter [127:0] USER_CODES          = 128'd0,        // bit n: function code n is offered to the user first
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
  parameter integer BITS_PER_BEAT       = 1,             // 1 or 16: coils and discrete inputs that move in one beat of the bus
  parameter integer CHECK_WRITES        = 0,             // 1: the bank checks the values of a write before the first is stored
  parameter [127:0] SERVER_ID           = 128'h09,       // function code 11H: its identifier, right-justified
  parameter integer SERVER_ID_BYTES     = 1,             // 1..16
  parameter [1999:0] ADDITIONAL_DATA    = 2000'd0,       // 11H: data behind the run indicator, right-justified
  parameter integer ADDITIONAL_DATA_BYTES = 0,           // 0..250 - SERVER_ID_BYTES
  parameter [1951:0] VENDOR_NAME        = "VENDOR",      // function code 2BH: objects 00, 01, 02
  parameter [1951:0] PRODUCT_CODE       = "PRODUCT",
  parameter [1951:0] REVISION           = "V1.0",
  parameter [1951:0] VENDOR_URL         = "",            // 03 to 06; an empty one is left out
  parameter [1951:0] PRODUCT_NAME       = "",
  parameter [1951:0] MODEL_NAME         = "",
  parameter [1951:0] USER_APPLICATION_NAME = "",
  parameter [4095:0] PRIVATE_OBJECTS    = 4096'd0,       // {object 80H.., length, value}..., right-justified
  parameter [7:0]   CONFORMITY          = 8'h81,         // 01 02 03 81 82 83
  parameter integer DEVICE_ID_LIMIT     = 253,           // largest PDU of its answers
  parameter integer ALIVE_TIMEOUT_MS    = 0              // alive_o falls this long after the last good frame for us; 0: never
// verilator lint_on UNUSED
