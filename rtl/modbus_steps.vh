// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_steps - the steps a function code is made of: {step[4:0], argument[10:0]}.
// modbus_program writes them down, modbus_dispatch carries them out.

`ifndef MODBUS_STEPS_VH
`define MODBUS_STEPS_VH

// Whom and what
`define MB_STEP_ADDRESSED  5'd0   // end here unless the byte under the cursor is our address or broadcast
`define MB_STEP_FUNCTION   5'd1   // go to the entry of the function code under the cursor
`define MB_STEP_UNICAST    5'd2   // end here if the frame is a broadcast
`define MB_STEP_JUMP       5'd3   // argument: where
`define MB_STEP_RAISE      5'd4   // argument: exception code

// Take the request apart, high byte first; every one moves the cursor on
`define MB_STEP_ADDRESS    5'd5   // first address of a range
`define MB_STEP_QUANTITY   5'd6   // argument: highest quantity; outside 1..highest is exception 03
`define MB_STEP_COIL       5'd7   // must be 0000H or FF00H, else exception 03
`define MB_STEP_BYTE_COUNT 5'd8   // must fit the quantity and the bytes left, else 03; argument: SPACE
`define MB_STEP_SINGLE     5'd9   // the quantity is 1
`define MB_STEP_END        5'd10  // exception 03 unless the request ends here

// The bank; argument: SPACE in [10:8] and flags
`define MB_STEP_RANGE      5'd11  // last address; past FFFFH is exception 02
`define MB_STEP_GRANT      5'd12  // ask; WRITE flag
`define MB_STEP_READ       5'd13  // one burst into the frame from the cursor on; KEEP flag
`define MB_STEP_WRITE      5'd14  // one burst from the frame from the cursor on; KEEP flag
`define MB_STEP_WRITTEN    5'd15  // tell the host: space, first and last address

// Put the answer together
`define MB_STEP_POINT      5'd16  // cursor to argument[3:0]; CLEAR flag: count to 0
`define MB_STEP_FORGET     5'd17  // cursor up to argument[3:0], count down with it
`define MB_STEP_COUNT      5'd18  // cursor up to argument[3:0], count up with it
`define MB_STEP_LOAD       5'd19  // argument[5:4]: what, see MB_LOAD_*; cursor to argument[3:0] first
`define MB_STEP_PUT        5'd20  // the loaded byte to the cursor; cursor and count up
`define MB_STEP_SEND       5'd21  // send count bytes from the start, check field behind; nothing in a broadcast

`define MB_LOAD_BYTE       2'd0   // byte under the cursor
`define MB_LOAD_XOR        2'd1   // loaded byte XOR byte under the cursor
`define MB_LOAD_AND        2'd2   // loaded byte AND byte under the cursor
`define MB_LOAD_STATUS     2'd3   // argument[6]: 0 count, 1 exception code

// Flags
`define MB_FLAG_WRITE      8'h01
`define MB_FLAG_KEEP       8'h02  // hold the bus for the next burst
`define MB_FLAG_CLEAR      8'h10

`endif
