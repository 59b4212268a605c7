// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_defs - the numbers of the protocol that more than one module needs; each stands here once.

`ifndef MODBUS_DEFS_VH
`define MODBUS_DEFS_VH

// Function codes (MODBUS Application Protocol V1.1b3, clause 6); 2BH has the table entry of 1EH
`define MB_FC_READ_COILS               32'h01
`define MB_FC_READ_DISCRETE_INPUTS     32'h02
`define MB_FC_READ_HOLDING_REGISTERS   32'h03
`define MB_FC_READ_INPUT_REGISTERS     32'h04
`define MB_FC_WRITE_SINGLE_COIL        32'h05
`define MB_FC_WRITE_SINGLE_REGISTER    32'h06
`define MB_FC_READ_EXCEPTION_STATUS    32'h07
`define MB_FC_DIAGNOSTICS              32'h08
`define MB_FC_GET_EVENT_COUNTER        32'h0B
`define MB_FC_GET_EVENT_LOG            32'h0C
`define MB_FC_WRITE_MULTIPLE_COILS     32'h0F
`define MB_FC_WRITE_MULTIPLE_REGISTERS 32'h10
`define MB_FC_REPORT_SERVER_ID         32'h11
`define MB_FC_READ_FILE_RECORD         32'h14
`define MB_FC_WRITE_FILE_RECORD        32'h15
`define MB_FC_MASK_WRITE_REGISTER      32'h16
`define MB_FC_READ_WRITE_REGISTERS     32'h17
`define MB_FC_READ_FIFO_QUEUE          32'h18
`define MB_FC_ENCAPSULATED             8'h2B

// Exception codes (V1.1b3, clause 7)
`define MB_EX_ILLEGAL_FUNCTION     4'h1
`define MB_EX_ILLEGAL_DATA_ADDRESS 4'h2
`define MB_EX_ILLEGAL_DATA_VALUE   4'h3
`define MB_EX_DEVICE_FAILURE       4'h4
`define MB_EX_ACKNOWLEDGE          4'h5
`define MB_EX_DEVICE_BUSY          4'h6
`define MB_EX_NEGATIVE_ACKNOWLEDGE 4'h7

// Spaces: the upper three address bits towards a bank. Spaces below 2 hold bits, up to 5 words, the others bytes.
// Those above 4 are inside the core and not on the bus.
`define MB_SPACE_COILS     3'd0
`define MB_SPACE_DISCRETES 3'd1
`define MB_SPACE_INPUTS    3'd2
`define MB_SPACE_HOLDINGS  3'd3
`define MB_SPACE_FILES     3'd4
`define MB_SPACE_COUNTERS  3'd5
`define MB_SPACE_EVENTS    3'd6
`define MB_SPACE_TEXTS     3'd7

// Counters, by the sub-function of 08H that reads them (V1.1b3, clause 6.8); the event counter has a free number.
`define MB_CPT_EVENT          5'h0A
`define MB_CPT_BUS_MESSAGE    5'h0B
`define MB_CPT_COMM_ERROR     5'h0C
`define MB_CPT_EXCEPTION      5'h0D
`define MB_CPT_SLAVE_MESSAGE  5'h0E
`define MB_CPT_NO_RESPONSE    5'h0F
`define MB_CPT_NAK            5'h10
`define MB_CPT_BUSY           5'h11
`define MB_CPT_OVERRUN        5'h12

// Places and marks in the text memory of modbus_identity
`define MB_TEXT_SERVER_ID     16'd9
`define MB_TEXT_MORE          8'h00   // records follow in this section
`define MB_TEXT_LAST          8'hFF   // the last one: it serves for every other object
`define MB_TEXT_NONE          8'h01   // the last one: there is no other object

// Character formats (MODBUS over Serial Line V1.02, clause 2.5.1)
`define MB_FORMAT_8E1 2'd0
`define MB_FORMAT_8O1 2'd1
`define MB_FORMAT_8N2 2'd2
`define MB_FORMAT_8N1 2'd3

`endif
