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

// Sets of function codes, as FUNCTION_CODES and USER_CODES take them: bit n is function code n.
`define MB_BIT(code) (128'd1 << (code))
`define MB_COIL_FUNCTIONS (`MB_BIT(`MB_FC_READ_COILS) | `MB_BIT(`MB_FC_WRITE_SINGLE_COIL) | \
                           `MB_BIT(`MB_FC_WRITE_MULTIPLE_COILS))
`define MB_DISCRETE_FUNCTIONS `MB_BIT(`MB_FC_READ_DISCRETE_INPUTS)
`define MB_INPUT_FUNCTIONS `MB_BIT(`MB_FC_READ_INPUT_REGISTERS)
`define MB_HOLDING_FUNCTIONS (`MB_BIT(`MB_FC_READ_HOLDING_REGISTERS) | `MB_BIT(`MB_FC_WRITE_SINGLE_REGISTER) | \
                              `MB_BIT(`MB_FC_WRITE_MULTIPLE_REGISTERS) | `MB_BIT(`MB_FC_MASK_WRITE_REGISTER) | \
                              `MB_BIT(`MB_FC_READ_WRITE_REGISTERS) | `MB_BIT(`MB_FC_READ_FIFO_QUEUE))
`define MB_FILE_FUNCTIONS (`MB_BIT(`MB_FC_READ_FILE_RECORD) | `MB_BIT(`MB_FC_WRITE_FILE_RECORD))
`define MB_DIAGNOSTIC_FUNCTIONS (`MB_BIT(`MB_FC_DIAGNOSTICS) | `MB_BIT(`MB_FC_GET_EVENT_COUNTER) | \
                                 `MB_BIT(`MB_FC_GET_EVENT_LOG))
`define MB_IDENTITY_FUNCTIONS (`MB_BIT(`MB_FC_REPORT_SERVER_ID) | `MB_BIT(`MB_FC_ENCAPSULATED))
`define MB_ALL_FUNCTIONS (`MB_COIL_FUNCTIONS | `MB_DISCRETE_FUNCTIONS | `MB_INPUT_FUNCTIONS | `MB_HOLDING_FUNCTIONS | \
                          `MB_FILE_FUNCTIONS | `MB_DIAGNOSTIC_FUNCTIONS | `MB_IDENTITY_FUNCTIONS | \
                          `MB_BIT(`MB_FC_READ_EXCEPTION_STATUS))

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

// The checking pass of a write, on the bus instead of coils and holding registers: the space of the table with bits 2 and 1
// set.  The numbers are those of two spaces inside the core, which are never on the bus.
`define MB_SPACE_CHECK_COILS    3'd6
`define MB_SPACE_CHECK_HOLDINGS 3'd7
`define MB_CHECK_OF(space)      ((space) | 3'd6)

// The space of the core on the host side: modbus_host_map
`define MB_SPACE_CORE      3'd5

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

// ------------------------------------------------------------------ vectors with named fields at the core's ports

// Run-time settings: fields of settings_i
`define MB_SET_ADDRESS        7:0      // 1..247; other values: broadcast only
`define MB_SET_BIT_TIME       23:8     // clocks per bit, 8..65535
`define MB_SET_FORMAT         25:24    // MB_FORMAT_*
`define MB_SET_BROADCAST      26       // 1: address 0 is obeyed
`define MB_SET_GAP_COUNT_ONLY 27       // 1: a gap above t1.5 is only reported, 0: it spoils the frame
`define MB_SET_STRICT         28       // 1: t3.5 of silence behind the own answer
`define MB_SET_DROP_LATE      29       // 1: no answer if the line was heard since the request
`define MB_SET_RESPONSE_DELAY 41:30    // bit times before the answer
`define MB_SET_STALL_LIMIT    57:42    // bit times a bank may be silent, 0: for ever
`define MB_SET_DE_LEAD        61:58    // bit times from driver enable to the start bit
`define MB_SET_DE_TAIL        65:62    // bit times from the last stop bit to driver off
`define MB_SET_BIT_FRACTION   69:66    // sixteenths of a clock per bit beyond MB_SET_BIT_TIME, with BIT_FRACTIONS = 1
`define MB_SET_ASCII          70       // 1: ASCII mode, 0: RTU; with ASCII_MODE = 1
`define MB_SET_EIGHT_BITS     71       // ASCII mode: 1: characters of 8 bits, 0: of 7 bits
`define MB_SET_ASCII_EXTRA    73:72    // ASCII mode: the time-out is at least so many ASCII_TIMEOUT_MS longer
`define MB_SETTINGS_WIDTH     74
// A settings_i with the usual options: broadcast obeyed, driver lead of one bit, all others off
`define MB_LINE_SETTINGS(address, bit_time, format) \
  {4'd0, 4'd0, 4'd0, 4'd1, 16'd0, 12'd0, 4'b0001, format, bit_time, address}

// State of the host: fields of host_state_i
`define MB_HOST_BUSY             0
`define MB_HOST_RUN              1
`define MB_HOST_FAILURE          5:2    // 0, or the exception code to give instead of execution
`define MB_HOST_EXCEPTION_STATUS 13:6
`define MB_HOST_DIAGNOSTIC       28:14  // bits 15..1 of the diagnostic register to set
`define MB_HOST_UNIT_OURS        29     // 1: unit_o is a unit of ours, with UNIT_PORT = 1; may depend on unit_o
`define MB_HOST_STATE_WIDTH      30
`define MB_HOST_AT_REST          30'h2  // not busy, no failure, run indicator on

// What happened on the line: strobes of events_o
`define MB_EVENT_FRAME   0   // a good frame, for any slave
`define MB_EVENT_PARITY  1   // bad frames, when they end
`define MB_EVENT_FRAMING 2
`define MB_EVENT_OVERRUN 3   // characters came while a request was worked on
`define MB_EVENT_CRC     4   // the check field alone is wrong; ASCII mode: or a character that is not allowed
`define MB_EVENT_SHORT   5   // fewer than 4 bytes, in ASCII mode than 3
`define MB_EVENT_LONG    6   // more than 256 bytes, in ASCII mode than 513 characters
`define MB_EVENT_GAP     7   // a gap above t1.5, in ASCII mode above the time-out
`define MB_EVENTS_WIDTH  8

// A user's reply on the user port: fields of user_reply_i
`define MB_USER_PUT       0     // strobe: append MB_USER_DATA to the answer
`define MB_USER_DONE      1     // strobe: finished
`define MB_USER_PASS      2     //   with DONE: not the user's after all
`define MB_USER_EXCEPTION 6:3   //   with DONE: 0, the answer is complete; else the exception code
`define MB_USER_DATA      14:7
`define MB_USER_REPLY_WIDTH 15
`define MB_NO_USER        15'd0 // nothing at the user port

// ------------------------------------------------------------------ between line and engine, inside the core

// Frames from the line to the engine: bits of frame_i / frame_o
`define MB_FRAME_GOOD      0   // strobe: a good frame for us, t3.5 has passed
`define MB_FRAME_BROADCAST 1   //   level with GOOD
`define MB_FRAME_FOREIGN   2   // strobe: a good frame for another slave
`define MB_FRAME_BAD       3   // strobe: a bad frame
`define MB_FRAME_LONG      4   //   level with BAD: more bytes than a frame has
`define MB_FRAME_WIDTH     5

// What the line does in the frame RAM: strobes of ram_do
`define MB_RAM_OPEN  0   // a frame begins: cursor and count to 0
`define MB_RAM_LOOK  1   // cursor to the first byte
`define MB_RAM_STORE 2   // the received byte goes under the cursor; cursor and count up
`define MB_RAM_NEXT  3   // a byte was sent: cursor up, count down
`define MB_RAM_UP    4   // count up: a frame in ASCII mode has one check byte less than the engine takes off
`define MB_RAM_WIDTH 5

// What the engine tells the line: strobes of verdict
`define MB_VERDICT_SEND    0   // send the answer that stands in the frame RAM
`define MB_VERDICT_QUIET   1   // the frame is dealt with, nothing to send
`define MB_VERDICT_RESTART 2   // t3.5 of silence before anything is heard again
`define MB_VERDICT_DELIMITER 3 // the byte under the cursor ends a frame in ASCII mode, behind CR
`define MB_VERDICT_WIDTH   4

`endif
