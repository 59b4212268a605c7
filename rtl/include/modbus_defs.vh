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
`define MB_FC_ENCAPSULATED             32'h2B

// Function codes below this one have an entry of their own in the table of modbus_program; it is searched for others.
`define MB_OTHER_CODES                 32'h1F

// A set of function codes has bit n for function code n.
`define MB_BIT(CODE) (128'd1 << (CODE))
`define MB_ALL_FUNCTIONS ( \
  `MB_BIT(`MB_FC_READ_COILS) | `MB_BIT(`MB_FC_READ_DISCRETE_INPUTS) | `MB_BIT(`MB_FC_READ_HOLDING_REGISTERS) | \
  `MB_BIT(`MB_FC_READ_INPUT_REGISTERS) | `MB_BIT(`MB_FC_WRITE_SINGLE_COIL) | `MB_BIT(`MB_FC_WRITE_SINGLE_REGISTER) | \
  `MB_BIT(`MB_FC_READ_EXCEPTION_STATUS) | `MB_BIT(`MB_FC_DIAGNOSTICS) | `MB_BIT(`MB_FC_GET_EVENT_COUNTER) | \
  `MB_BIT(`MB_FC_GET_EVENT_LOG) | `MB_BIT(`MB_FC_WRITE_MULTIPLE_COILS) | `MB_BIT(`MB_FC_WRITE_MULTIPLE_REGISTERS) | \
  `MB_BIT(`MB_FC_REPORT_SERVER_ID) | `MB_BIT(`MB_FC_READ_FILE_RECORD) | `MB_BIT(`MB_FC_WRITE_FILE_RECORD) | \
  `MB_BIT(`MB_FC_MASK_WRITE_REGISTER) | `MB_BIT(`MB_FC_READ_WRITE_REGISTERS) | `MB_BIT(`MB_FC_READ_FIFO_QUEUE) | \
  `MB_BIT(`MB_FC_ENCAPSULATED))

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

// Words of MB_SPACE_COUNTERS and of the status port below the counters
`define MB_CPT_REGISTER       5'h00   // diagnostic register
`define MB_CPT_LISTEN_ONLY    5'h01   // bit 0: listen-only mode
`define MB_CPT_ENTRIES        5'h02   // entries of the event log

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
`define MB_TEXT_SERVER_ID     8'd9
`define MB_TEXT_MORE          8'h00   // records follow in this section
`define MB_TEXT_LAST          8'hFF   // the last one: it serves for every other object
`define MB_TEXT_NONE          8'h01   // the last one: there is no other object

// Character formats (MODBUS over Serial Line V1.02, clause 2.5.1)
`define MB_FORMAT_8E1 2'd0
`define MB_FORMAT_8O1 2'd1
`define MB_FORMAT_8N2 2'd2
`define MB_FORMAT_8N1 2'd3

// State of the host: fields of host_state_i
`define MB_HOST_BUSY             0
`define MB_HOST_RUN              1
`define MB_HOST_FAILURE          5:2    // 0, or the exception code to give instead of execution
`define MB_HOST_EXCEPTION_STATUS 13:6
`define MB_HOST_DIAGNOSTIC       28:14  // bits 15..1 of the diagnostic register to set
`define MB_HOST_STATE_WIDTH      29

// A user's reply on the user port: fields of user_reply_i
`define MB_USER_PUT       0     // strobe: append MB_USER_DATA to the answer
`define MB_USER_DONE      1     // strobe: finished
`define MB_USER_PASS      2     //   with DONE: not the user's after all
`define MB_USER_EXCEPTION 6:3   //   with DONE: 0, the answer is complete; else the exception code
`define MB_USER_DATA      14:7
`define MB_USER_REPLY_WIDTH 15

// Frames from the line to the engine: bits of frame_i / frame_o
`define MB_FRAME_GOOD      0   // strobe: a good frame for us, t3.5 has passed
`define MB_FRAME_BROADCAST 1   //   level with GOOD
`define MB_FRAME_FOREIGN   2   // strobe: a good frame for another slave
`define MB_FRAME_BAD       3   // strobe: a bad frame
`define MB_FRAME_LONG      4   //   level with BAD: more than 256 bytes
`define MB_FRAME_WIDTH     5

// What the line does in the frame RAM: strobes of ram_do
`define MB_RAM_OPEN  0   // a frame begins: cursor and count to 0
`define MB_RAM_LOOK  1   // cursor to the first byte
`define MB_RAM_STORE 2   // the received byte goes under the cursor; cursor and count up
`define MB_RAM_NEXT  3   // a byte was sent: cursor up, count down
`define MB_RAM_WIDTH 4

// What the engine tells the line: strobes of verdict
`define MB_VERDICT_SEND    0   // send the answer that stands in the frame RAM
`define MB_VERDICT_QUIET   1   // the frame is dealt with, nothing to send
`define MB_VERDICT_RESTART 2   // t3.5 of silence before anything is heard again
`define MB_VERDICT_WIDTH   3

`endif
