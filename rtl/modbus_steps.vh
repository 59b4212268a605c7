// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_steps - the steps a function code is made of: {step[3:0], argument[11:0]}.
// modbus_program writes them down, modbus_dispatch carries them out.

`ifndef MODBUS_STEPS_VH
`define MODBUS_STEPS_VH

// Whom and what
`define MB_STEP_ADDRESSED  4'd0   // end here unless the byte under the cursor is our address or broadcast
`define MB_STEP_FUNCTION   4'd1   // go to the table entry of the function code under the cursor
`define MB_STEP_JUMP       4'd2   // argument[7:0]: where; UNICAST flag: end here if the frame is a broadcast

// Take the request apart, high byte first; each moves the cursor on
`define MB_STEP_ADDRESS    4'd3   // first address of a range; WRITTEN flag: tell the host that range is written
`define MB_STEP_QUANTITY   4'd4   // argument[10:0]: highest quantity; outside 1..highest is exception 03
`define MB_STEP_COIL       4'd5   // must be 0000H or FF00H, else exception 03
`define MB_STEP_BYTE_COUNT 4'd6   // must fit the quantity and the bytes left, else exception 03; SPACE.  Ends behind
                                   // the first data byte, where count is the byte count less one
`define MB_STEP_END        4'd7   // exception 03 unless the request ends here

// The bank; SPACE in argument[10:8]
`define MB_STEP_RANGE      4'd8   // last address; past FFFFH is exception 02; SINGLE flag: the quantity is 1
`define MB_STEP_GRANT      4'd9   // ask for the range; WRITE, LAST flags
`define MB_STEP_BURST      4'd10  // move the range between bank and frame from the cursor on; WRITE, KEEP flags

// Put the answer together; argument[3:0] is a place in the frame
`define MB_STEP_POINT      4'd11  // cursor to the place; CLEAR flag: count to 0
`define MB_STEP_WALK       4'd12  // cursor up to the place; count down with it, with the UP flag up
`define MB_STEP_LOAD       4'd13  // argument[5:4]: what, see MB_LOAD_*, from the place; held for PUT
`define MB_STEP_PUT        4'd14  // the held byte to the place; cursor and count up behind it
`define MB_STEP_SEND       4'd15  // send count bytes from the start, check field behind; nothing in a broadcast

`define MB_LOAD_BYTE       2'd0   // the byte; MARK flag: with bit 7 set
`define MB_LOAD_XOR        2'd1   // held byte XOR the byte
`define MB_LOAD_AND        2'd2   // held byte AND the byte
`define MB_LOAD_STATUS     2'd3   // count; MARK flag: exception code

// Flags
`define MB_FLAG_WRITE      12'h001
`define MB_FLAG_KEEP       12'h002  // hold the bus for the next burst
`define MB_FLAG_LAST       12'h004  // the last question: from here on only busy_i stands in the way
`define MB_FLAG_SINGLE     12'h001
`define MB_FLAG_CLEAR      12'h010
`define MB_FLAG_UP         12'h010
`define MB_FLAG_MARK       12'h040
`define MB_FLAG_UNICAST    12'h100
`define MB_FLAG_WRITTEN    12'h800

`endif
