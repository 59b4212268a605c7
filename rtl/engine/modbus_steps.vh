// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_steps - the words of the program, and the commands that the sequencer makes of them.
//
// A step is 16 bits: {step[4:0], argument[10:0]}.  modbus_program writes the fields, modbus_sequencer and the modules
// that it commands read them; both use the names below.

`ifndef MODBUS_STEPS_VH
`define MODBUS_STEPS_VH

`define MB_WORD_STEP       15:11
`define MB_WORD_ARGUMENT   10:0
`define MB_AT_WIDTH        9       // bits of a program address

// ------------------------------------------------------------------ steps

// Bits 3 and 2 tell how long a step lasts: 00 one clock, 10 two, 01 four, 11 open.  But with bits 3, 1 and 0 all set (SEND,
// TELL) it is one clock.

// Where to go on
`define MB_STEP_REST       5'd0   // the frame is dealt with
`define MB_STEP_DISPATCH   5'd1   // take a byte and go to its entry in the table at TARGET
`define MB_STEP_JUMP       5'd2   // go to TARGET, see MB_JUMP_*

// Take the request apart, high byte first; each moves the cursor on and count down
`define MB_STEP_ADDRESS    5'd4   // first address of a range; IN_SPACE: in SPACE; ONE: the quantity is 1
`define MB_STEP_QUANTITY   5'd5   // 1 to 2048 - ROOM, else exception 03
`define MB_STEP_COIL       5'd6   // 0000H or FF00H, with ZERO 0000H alone, and the end of the request; else exception 03
`define MB_STEP_BYTE_COUNT 5'd7   // the number of bytes left, else exception 03.  FIT: also that of the quantity; ends
                                  // behind the first data byte
`define MB_STEP_END        5'd10  // exception 03 unless the request ends here.  WORDS: unless one word or more follow

// The bank
`define MB_STEP_TELL       5'd15  // tell the host that the range is written
`define MB_STEP_GRANT      5'd12  // ask for the range; WRITE.  A range past FFFFH, of a file past 270FH: exception 02
`define MB_STEP_BURST      5'd13  // move the range between bank and frame, from PLACE on; HERE, CLEAR, WRITE, KEEP, DRY;
                                  // CHECK: the bank checks what it would store

// Put the answer together
`define MB_STEP_POINT      5'd3   // cursor to PLACE; CLEAR: count to 0
`define MB_STEP_WALK       5'd14  // cursor up to PLACE; count down with it, UP: up
`define MB_STEP_LOAD       5'd8   // hold the byte at PLACE, see MB_LOAD_*; MARK: with bit 7 set
`define MB_STEP_PUT        5'd9   // the held byte, STATUS: that of WHICH, goes to PLACE, HERE: under the cursor; cursor
                                  // and count up
`define MB_STEP_SEND       5'd11  // send count bytes from the start of the half of PLACE; not in a broadcast

// Not needed for 01 to 06, 0F, 10, 16 and 17: where only these are built in, nothing decodes the steps below.
`define MB_STEP_IF         5'd24  // go to TARGET if the condition holds, see MB_IF_*
`define MB_STEP_MATCH      5'd25  // the byte must be LITERAL, else exception EXCEPTION; 0 there: any byte
`define MB_STEP_SPACE      5'd16  // the following is in SPACE
`define MB_STEP_SET        5'd17  // first address = LITERAL, quantity 1; LESS: quantity = LITERAL + 1
`define MB_STEP_DEPTH      5'd21  // quantity + 1, if the quantity is at most 2047 - ROOM, else exception 03
`define MB_STEP_FILE       5'd20  // file number
`define MB_STEP_TOTAL      5'd26  // add a group to the length of a file answer; past F5H: exception 03
`define MB_STEP_CONTEXT    5'd18  // cursor and count: SAVE, RECALL, both: swap
`define MB_STEP_LITERAL    5'd19  // hold LITERAL
`define MB_STEP_OFFER      5'd28  // let the user answer from the cursor on; go to TARGET unless the user passes
`define MB_STEP_COUNT      5'd22  // COUNTER up, CLEAR: to 0, see MB_WHEN_*
`define MB_STEP_LOG        5'd23  // EVENT and what the flags add to the event log
`define MB_STEP_MODE       5'd29  // see MB_MODE_*

// ------------------------------------------------------------------ fields of the argument

`define MB_ARG_TARGET      8:0    // JUMP IF OFFER DISPATCH: a program address
`define MB_ARG_CONDITION   10:9   // JUMP IF
`define MB_ARG_SPACE       2:0    // ADDRESS SPACE
`define MB_ARG_IN_SPACE    3      // ADDRESS
`define MB_ARG_ONE         4      // ADDRESS
`define MB_ARG_ROOM        10:0   // QUANTITY DEPTH
`define MB_ARG_ZERO        0      // COIL
`define MB_ARG_FIT         0      // BYTE_COUNT
`define MB_ARG_WORDS       1      // END
`define MB_ARG_PLACE       4:0    // POINT WALK LOAD PUT BURST SEND: {upper half, one of its first 16 bytes}
`define MB_ARG_CLEAR       5      // POINT BURST COUNT
`define MB_ARG_UP          5      // WALK
`define MB_ARG_MARK        5      // LOAD
`define MB_ARG_STATUS      5      // PUT
`define MB_ARG_HERE        6      // PUT BURST
`define MB_ARG_WHAT        8:7    // LOAD
`define MB_ARG_WHICH       9:7    // PUT
`define MB_ARG_WRITE       7      // GRANT BURST
`define MB_ARG_KEEP        8      // BURST: hold the bus for the next one
`define MB_ARG_DRY         9      // BURST: pass over the data, no bus
`define MB_ARG_CHECK       10     // BURST: a checking pass
`define MB_ARG_LITERAL     7:0    // MATCH SET LITERAL
`define MB_ARG_EXCEPTION   10:8   // MATCH
`define MB_ARG_LESS        10     // SET
`define MB_ARG_SAVE        0      // CONTEXT
`define MB_ARG_RECALL      1      // CONTEXT
`define MB_ARG_COUNTER     4:0    // COUNT
`define MB_ARG_WHEN        8:6    // COUNT
`define MB_ARG_EVENT       7:0    // LOG
`define MB_ARG_BROADCAST   8      // LOG: 40H in a broadcast
`define MB_ARG_REFUSAL     9      // LOG: the bit of the exception answered
`define MB_ARG_LONG        10     // LOG: 10H if the frame had more than 256 bytes

`define MB_JUMP_ALWAYS     2'd0
`define MB_JUMP_UNICAST    2'd1   // exception 01 in a broadcast
`define MB_JUMP_READY      2'd2   // goes to the next step; exception 06, or the host's, if it is busy or has failed
`define MB_JUMP_NEVER      2'd3   // exception 01

`define MB_IF_EQUAL        2'd0   // the byte under the cursor is the held byte
`define MB_IF_LEFT         2'd1   // count is not 0; below 0 it is exception 03
`define MB_IF_LISTENING    2'd2   // listen-only mode
`define MB_IF_NOT_USER     2'd3   // the function code under the cursor is not offered to the user

`define MB_LOAD_BYTE       2'd0   // the byte
`define MB_LOAD_XOR        2'd1   // held byte XOR the byte
`define MB_LOAD_AND        2'd2   // held byte AND the byte

`define MB_STATUS_COUNT     3'd0  // count
`define MB_STATUS_CODE      3'd1  // exception code
`define MB_STATUS_EXCEPTION 3'd2  // the host's exception status
`define MB_STATUS_BUSY      3'd3  // FFH or 00H
`define MB_STATUS_RUN       3'd4  // FFH or 00H
`define MB_STATUS_LENGTH    3'd5  // length byte of a file group: 1 + 2 x quantity

`define MB_WHEN_ALWAYS     3'd0
`define MB_WHEN_SUCCESS    3'd1
`define MB_WHEN_EXCEPTION  3'd2
`define MB_WHEN_BUSY       3'd3   // exception 06 is answered
`define MB_WHEN_NAK        3'd4   // exception 07 is answered
`define MB_WHEN_UNSENT     3'd5   // bytes of the answer are left: none was due, or it was given up
`define MB_WHEN_LONG       3'd6   // the frame had more than 256 bytes

// Bits of the argument of MODE
`define MB_MODE_WAIT       0      // until the answer has been sent; then the others
`define MB_MODE_LISTEN     1      // enter listen-only mode
`define MB_MODE_ACTIVE     2      // leave it
`define MB_MODE_EMPTY      3      // empty the event log if the held byte is FFH
`define MB_MODE_REGISTER   4      // clear the diagnostic register
`define MB_MODE_OVERRUN    5      // clear its overrun flag
`define MB_MODE_LONG       6      // set it if the frame had more than 256 bytes
`define MB_MODE_LINE       7      // the line must be silent for t3.5 again
`define MB_MODE_DELIMITER  8      // the byte under the cursor is the delimiter of ASCII mode

// ------------------------------------------------------------------ entries: where the sequencer begins

`define MB_ENTRY_START     8:0    // a good frame for us
`define MB_ENTRY_FOREIGN   17:9   // a good frame for another slave
`define MB_ENTRY_BAD       26:18  // a bad frame
`define MB_ENTRY_EXCEPTION 35:27  // a step went wrong
`define MB_ENTRY_CLEARING  44:36  // reset
`define MB_ENTRIES_WIDTH   45

// ------------------------------------------------------------------ commands

// To the frame RAM: strobes
`define MB_DO_POINT        0      // cursor to the place
`define MB_DO_CLEAR        1      // count to 0
`define MB_DO_STEP         2      // cursor up
`define MB_DO_UP           3      // count up
`define MB_DO_DOWN         4      // count down
`define MB_DO_PUT          5      // the held byte goes under the cursor
`define MB_DO_SAVE         6      // keep cursor and count
`define MB_DO_RECALL       7      // back to those kept; with SAVE: swap
`define MB_RAM_DO_WIDTH    8

// To modbus_range: strobes, two for a field, with a byte each, the high one first
`define MB_DO_ADDRESS      0      // first address = field
`define MB_DO_ONE          1      // quantity = 1
`define MB_DO_QUANTITY     2      // quantity = field + 1
`define MB_DO_LESS_ONE     3      // with the low byte: quantity = field, without the + 1
`define MB_DO_FIRST        4      // first address = literal, quantity = 1
`define MB_DO_LESS         5      // quantity = literal + 1
`define MB_DO_FILE         6      // file number = field
`define MB_DO_NO_GROUP     7      // no group yet
`define MB_DO_GROUP        8      // add a group to the length of the answer
`define MB_RANGE_DO_WIDTH  9

// To modbus_burst
`define MB_DO_HOLD         0      // strobe: hold the byte that was under the cursor a clock ago
`define MB_DO_LOAD         1      // strobe: the same by WHAT and MARK
`define MB_DO_STATUS       2      // strobe: hold the status byte
`define MB_DO_LITERAL      3      // strobe: hold the literal
`define MB_DO_GRANT        4      // level until done or failed: ask the bank
`define MB_DO_BURST        5      // level until done or failed: move the range
`define MB_DO_RELEASE      6      // strobe: the request is over, let go of the bus
`define MB_BURST_DO_WIDTH  7

// To modbus_diagnostics
`define MB_DO_COUNT        0      // level of four clocks: COUNTER up, with CLEAR to 0
`define MB_DO_LOG          1      // level of four clocks: the event goes to the log
`define MB_DO_NOW          2      // level: the last of the four clocks
`define MB_DO_APPLIES      3      // level: the condition of COUNT holds
`define MB_DO_LISTEN       4      // strobes: those of MODE
`define MB_DO_ACTIVE       5
`define MB_DO_EMPTY        6
`define MB_DO_CLEAR_REGISTER 7
`define MB_DO_CLEAR_OVERRUN  8
`define MB_DO_OVERRUN      9
`define MB_DIAG_DO_WIDTH   10

// Answers of modbus_range: levels
`define MB_FOUND_IN_LIMIT  0      // 1 <= quantity <= 2048 - ROOM, two clocks after the quantity
`define MB_FOUND_FIT       1      // count + 1 is the byte count of the quantity; a clock late
`define MB_FOUND_TOO_LONG  2      // the groups pass F5H bytes
`define MB_FOUND_WIDTH     3

`endif
