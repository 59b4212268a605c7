// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_steps - the steps a function code is made of: {step[4:0], argument[10:0]}.
// modbus_program writes them down, modbus_dispatch carries them out.

`ifndef MODBUS_STEPS_VH
`define MODBUS_STEPS_VH

// Where to go on
`define MB_STEP_REST       5'd0   // the frame is dealt with
`define MB_STEP_FUNCTION   5'd1   // go to the entry of the byte under the cursor in a table of 32; WIDE flag: with
                                   // function code 2BH. Entry 1EH is that of 2BH, 1FH that of all others
`define MB_STEP_JUMP       5'd2   // argument[8:0]: where; argument[10:9]: what must be, see MB_JUMP_*

// Take the request apart, high byte first; each moves the cursor on and count down
`define MB_STEP_ADDRESS    5'd3   // first address of a range; SPACE flag: in the space argument[2:0]
`define MB_STEP_QUANTITY   5'd4   // argument[10:0]: 2048 - highest quantity; outside 1..highest is exception 03
`define MB_STEP_COIL       5'd5   // must be 0000H or FF00H, with the ZERO flag 0000H, else exception 03
`define MB_STEP_BYTE_COUNT 5'd6   // must be that of the bytes left, else exception 03. FIT flag: and of the quantity; ends
                                   // behind the first data byte
`define MB_STEP_END        5'd7   // exception 03 unless the request ends here; WORDS flag: unless words follow

// The bank
`define MB_STEP_RANGE      5'd8   // last address; past FFFFH is exception 02. SINGLE flag: the quantity is 1; FILE flag:
                                   // past 270FH is 02 too; WRITTEN flag: tell the host that the range is written
`define MB_STEP_GRANT      5'd9   // ask for the range; WRITE flag
`define MB_STEP_BURST      5'd10  // move the range between bank and frame from the cursor on; WRITE, KEEP, DRY flags

// Put the answer together; argument[4:0] is a place in the frame, bit 4 its upper half
`define MB_STEP_POINT      5'd11  // cursor to the place; CLEAR flag: count to 0
`define MB_STEP_WALK       5'd12  // cursor up to the place; count down with it, with the UP flag up
`define MB_STEP_LOAD       5'd13  // argument[8:7]: what, see MB_LOAD_*, from the place; held for PUT
`define MB_STEP_PUT        5'd14  // the held byte to the place, with the HERE flag under the cursor; cursor and count up
`define MB_STEP_SEND       5'd15  // send count bytes from the start of the half, check field behind; not in a broadcast

// What the functions up to 06, 0F, 10, 16 and 17 can do without; where only they are built in, nothing decodes these.
`define MB_STEP_IF         5'd16  // argument[8:0]: where, if argument[10:9], see MB_IF_*, holds
`define MB_STEP_MATCH      5'd17  // byte must be argument[7:0], else exception argument[10:8]; 0 there: any byte
`define MB_STEP_SPACE      5'd18  // argument[2:0]: the space of what follows
`define MB_STEP_SET        5'd19  // argument[7:0]: first address; LESS flag: quantity less one
`define MB_STEP_DEPTH      5'd20  // entries behind the first address; 2048 - argument or more is exception 03
`define MB_STEP_FILE       5'd21  // file number
`define MB_STEP_TOTAL      5'd22  // add a group to the length of a file answer; past F5H is exception 03
`define MB_STEP_CONTEXT    5'd23  // cursor and count: argument[1:0], see MB_CONTEXT_*
`define MB_STEP_LITERAL    5'd24  // argument[7:0] is held for PUT
`define MB_STEP_OFFER      5'd25  // let the user answer from the cursor on; argument[8:0]: where, unless it passes
`define MB_STEP_COUNT      5'd26  // counter argument[4:0] up, with the CLEAR flag to 0, if argument[8:6], see MB_WHEN_*, holds
`define MB_STEP_LOG        5'd27  // event argument[7:0] and what the flags add
`define MB_STEP_MODE       5'd28  // see MB_MODE_*

`define MB_JUMP_ALWAYS     2'd0
`define MB_JUMP_UNICAST    2'd1   // exception 01 in a broadcast
`define MB_JUMP_READY      2'd2   // exception 06, or the host's, if it is busy or has failed
`define MB_JUMP_NEVER      2'd3   // exception 01

`define MB_IF_EQUAL        2'd0   // the byte under the cursor is the held byte
`define MB_IF_LEFT         2'd1   // count is not 0; below 0 it is exception 03
`define MB_IF_LISTENING    2'd2   // listen-only mode
`define MB_IF_NOT_USER     2'd3   // the function code under the cursor is not offered to the user

`define MB_CONTEXT_SAVE    2'd1
`define MB_CONTEXT_RECALL  2'd2
`define MB_CONTEXT_SWAP    2'd3

`define MB_LOAD_BYTE       2'd0   // the byte; MARK flag: with bit 7 set
`define MB_LOAD_XOR        2'd1   // held byte XOR the byte
`define MB_LOAD_AND        2'd2   // held byte AND the byte
`define MB_LOAD_STATUS     2'd3   // argument[3:0]: see MB_STATUS_*

`define MB_STATUS_COUNT     4'd0  // count
`define MB_STATUS_CODE      4'd1  // exception code
`define MB_STATUS_EXCEPTION 4'd2  // the host's exception status
`define MB_STATUS_BUSY      4'd3  // FFH or 00H
`define MB_STATUS_RUN       4'd11 // FFH or 00H
`define MB_STATUS_LOW       4'd4  // diagnostic register
`define MB_STATUS_HIGH      4'd5
`define MB_STATUS_LOG       4'd6  // entries of the event log
`define MB_STATUS_LENGTH    4'd7  // length byte of a file group: 1 + 2 x quantity

`define MB_WHEN_ALWAYS     3'd0
`define MB_WHEN_SUCCESS    3'd1
`define MB_WHEN_EXCEPTION  3'd2
`define MB_WHEN_BUSY       3'd3   // exception 06 is answered
`define MB_WHEN_NAK        3'd4   // exception 07 is answered
`define MB_WHEN_BROADCAST  3'd5
`define MB_WHEN_LONG       3'd6   // the frame had more than 256 bytes

`define MB_MODE_WAIT       11'h001  // until the answer has been sent
`define MB_MODE_LISTEN     11'h002  // enter listen-only mode
`define MB_MODE_ACTIVE     11'h004  // leave it
`define MB_MODE_EMPTY      11'h008  // empty the event log if the held byte says so (FFH)
`define MB_MODE_REGISTER   11'h010  // clear the diagnostic register
`define MB_MODE_OVERRUN    11'h020  // clear its overrun flag
`define MB_MODE_LONG       11'h040  // set it if the frame had more than 256 bytes
`define MB_MODE_LINE       11'h080  // the line must be silent for t3.5 again

// Flags
`define MB_FLAG_WIDE       11'h200
`define MB_FLAG_SPACE      11'h008
`define MB_FLAG_ZERO       11'h001
`define MB_FLAG_WORDS      11'h001
`define MB_FLAG_FIT        11'h001
`define MB_FLAG_LESS       11'h400
`define MB_FLAG_SINGLE     11'h001
`define MB_FLAG_FILE       11'h002
`define MB_FLAG_WRITTEN    11'h004
`define MB_FLAG_WRITE      11'h001
`define MB_FLAG_KEEP       11'h002  // hold the bus for the next burst
`define MB_FLAG_DRY        11'h004  // pass over the data, no bus
`define MB_FLAG_CLEAR      11'h020
`define MB_FLAG_UP         11'h020
`define MB_FLAG_MARK       11'h020
`define MB_FLAG_HERE       11'h040
`define MB_FLAG_BROADCAST  11'h100  // LOG: 40H in a broadcast
`define MB_FLAG_EXCEPTION  11'h200  // LOG: the bit of the exception answered
`define MB_FLAG_LONG       11'h400  // LOG: 10H if the frame had more than 256 bytes

`endif
