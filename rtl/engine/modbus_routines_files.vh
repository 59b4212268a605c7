// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_files - function codes 14 15, file records; part of modbus_program.

// A group is reference type, file number, record number, quantity; 15H has the data behind it.  Every pass over the
// groups begins with the request as it came: structure (03), then existence (02), then the work.

// 14: function, byte count, groups.  The answer grows in the upper half: its cursor and count and those of the
// request are swapped back and forth.
function [15:0] read_files(input integer n);
  case (n)
    0: read_files = plain(`MB_STEP_SPACE, {8'd0, FILES});
    1: read_files = plain(`MB_STEP_BYTE_COUNT, NO_FLAG);
    // structure
    2: read_files = match(8'h00, ANY);
    3: read_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    4: read_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    5: read_files = quantity(FILE_READ_MOST);
    6: read_files = plain(`MB_STEP_TOTAL, NO_FLAG);
    7: read_files = when(`MB_IF_LEFT, READ_FILES[8:0] + 9'd2);
    8: read_files = RECALL;
    9: read_files = at(`MB_STEP_WALK, AT_GROUPS, NO_FLAG);
    // existence
    10: read_files = match(8'h06, ADDRESS);
    11: read_files = plain(`MB_STEP_FILE, NO_FLAG);
    12: read_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    13: read_files = quantity(FILE_READ_MOST);
    14: read_files = plain(`MB_STEP_RANGE, `MB_FLAG_FILE);
    15: read_files = plain(`MB_STEP_GRANT, NO_FLAG);
    16: read_files = when(`MB_IF_LEFT, READ_FILES[8:0] + 9'd10);
    17: read_files = jump(`MB_JUMP_READY, READ_FILES[8:0] + 9'd18);
    // the answer: begins with the request at its first group
    18: read_files = RECALL;
    19: read_files = at(`MB_STEP_WALK, AT_GROUPS, NO_FLAG);
    20: read_files = SWAP;
    21: read_files = at(`MB_STEP_POINT, UPPER + AT_GROUPS, CLEAR);
    22: read_files = SWAP;
    23: read_files = match(8'h00, ANY);
    24: read_files = plain(`MB_STEP_FILE, NO_FLAG);
    25: read_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    26: read_files = quantity(FILE_READ_MOST);
    27: read_files = plain(`MB_STEP_RANGE, NO_FLAG);
    28: read_files = SWAP;
    29: read_files = status(`MB_STATUS_LENGTH);
    30: read_files = at(`MB_STEP_PUT, AT_FRAME, HERE);
    31: read_files = plain(`MB_STEP_LITERAL, 11'h006);
    32: read_files = at(`MB_STEP_PUT, AT_FRAME, HERE);
    33: read_files = plain(`MB_STEP_BURST, KEEP);
    34: read_files = SWAP;
    35: read_files = when(`MB_IF_LEFT, READ_FILES[8:0] + 9'd23);
    36: read_files = SWAP;
    // its head
    37: read_files = status(`MB_STATUS_COUNT);
    38: read_files = at(`MB_STEP_PUT, UPPER + AT_BYTE_COUNT, NO_FLAG);
    39: read_files = load(`MB_LOAD_BYTE, AT_FRAME, NO_FLAG);
    40: read_files = at(`MB_STEP_PUT, UPPER, NO_FLAG);
    41: read_files = load(`MB_LOAD_BYTE, AT_FUNCTION, NO_FLAG);
    42: read_files = at(`MB_STEP_PUT, UPPER + AT_FUNCTION, NO_FLAG);
    43: read_files = send(UPPER);
    default: read_files = go(TAIL[8:0]);
  endcase
endfunction

// 15: function, byte count, groups.  The answer is the request.
function [15:0] write_files(input integer n);
  case (n)
    0: write_files = plain(`MB_STEP_SPACE, {8'd0, FILES});
    1: write_files = plain(`MB_STEP_BYTE_COUNT, NO_FLAG);
    // structure
    2: write_files = match(8'h00, ANY);
    3: write_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    4: write_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    5: write_files = quantity(FILE_WRITE_MOST);
    6: write_files = FIRST_SET;                  // not a matter of addresses yet
    7: write_files = plain(`MB_STEP_RANGE, NO_FLAG);
    8: write_files = plain(`MB_STEP_BURST, WRITE | DRY);
    9: write_files = when(`MB_IF_LEFT, WRITE_FILES[8:0] + 9'd2);
    10: write_files = RECALL;
    11: write_files = at(`MB_STEP_WALK, AT_GROUPS, NO_FLAG);
    // existence
    12: write_files = match(8'h06, ADDRESS);
    13: write_files = plain(`MB_STEP_FILE, NO_FLAG);
    14: write_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    15: write_files = quantity(FILE_WRITE_MOST);
    16: write_files = plain(`MB_STEP_RANGE, `MB_FLAG_FILE);
    17: write_files = plain(`MB_STEP_GRANT, WRITE);
    18: write_files = plain(`MB_STEP_BURST, WRITE | DRY);
    19: write_files = when(`MB_IF_LEFT, WRITE_FILES[8:0] + 9'd12);
    20: write_files = jump(`MB_JUMP_READY, WRITE_FILES[8:0] + 9'd21);
    21: write_files = RECALL;
    22: write_files = at(`MB_STEP_WALK, AT_GROUPS, NO_FLAG);
    // the writing
    23: write_files = match(8'h00, ANY);
    24: write_files = plain(`MB_STEP_FILE, NO_FLAG);
    25: write_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    26: write_files = quantity(FILE_WRITE_MOST);
    27: write_files = plain(`MB_STEP_RANGE, NO_FLAG);
    28: write_files = plain(`MB_STEP_BURST, WRITE | KEEP);
    29: write_files = when(`MB_IF_LEFT, WRITE_FILES[8:0] + 9'd23);
    30: write_files = RECALL;
    31: write_files = at(`MB_STEP_WALK, AT_GROUPS, NO_FLAG);
    // telling the host
    32: write_files = match(8'h00, ANY);
    33: write_files = plain(`MB_STEP_FILE, NO_FLAG);
    34: write_files = plain(`MB_STEP_ADDRESS, NO_FLAG);
    35: write_files = quantity(FILE_WRITE_MOST);
    36: write_files = plain(`MB_STEP_RANGE, `MB_FLAG_WRITTEN);
    37: write_files = plain(`MB_STEP_BURST, WRITE | DRY);
    38: write_files = when(`MB_IF_LEFT, WRITE_FILES[8:0] + 9'd32);
    39: write_files = RECALL;
    default: write_files = go(SENDING[8:0]);
  endcase
endfunction
