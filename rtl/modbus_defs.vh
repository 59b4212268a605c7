// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_defs - the numbers of the protocol that more than one module needs; each stands here once.

`ifndef MODBUS_DEFS_VH
`define MODBUS_DEFS_VH

// Function codes (MODBUS Application Protocol V1.1b3, clause 6)
`define MB_FC_READ_COILS               32'h01
`define MB_FC_READ_DISCRETE_INPUTS     32'h02
`define MB_FC_READ_HOLDING_REGISTERS   32'h03
`define MB_FC_READ_INPUT_REGISTERS     32'h04
`define MB_FC_WRITE_SINGLE_COIL        32'h05
`define MB_FC_WRITE_SINGLE_REGISTER    32'h06
`define MB_FC_WRITE_MULTIPLE_COILS     32'h0F
`define MB_FC_WRITE_MULTIPLE_REGISTERS 32'h10
`define MB_FC_MASK_WRITE_REGISTER      32'h16
`define MB_FC_READ_WRITE_REGISTERS     32'h17

// Exception codes (V1.1b3, clause 7)
`define MB_EX_ILLEGAL_FUNCTION     4'h1
`define MB_EX_ILLEGAL_DATA_ADDRESS 4'h2
`define MB_EX_ILLEGAL_DATA_VALUE   4'h3
`define MB_EX_DEVICE_FAILURE       4'h4
`define MB_EX_DEVICE_BUSY          4'h6

// Spaces: the upper three address bits towards a bank. Spaces below 2 hold bits, the others words.
`define MB_SPACE_COILS     3'd0
`define MB_SPACE_DISCRETES 3'd1
`define MB_SPACE_INPUTS    3'd2
`define MB_SPACE_HOLDINGS  3'd3
`define MB_SPACE_FILES     3'd4

// Character formats (MODBUS over Serial Line V1.02, clause 2.5.1)
`define MB_FORMAT_8E1 2'd0
`define MB_FORMAT_8O1 2'd1
`define MB_FORMAT_8N2 2'd2
`define MB_FORMAT_8N1 2'd3

`endif
