// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_identity - function codes 11 2B, from the texts of modbus_identity; part of modbus_program.

// 11: function.  The additional data stand behind the identifier, where the burst has left off.
function [15:0] server_id(input integer n);
  case ((n >= 9) ? n + 3 - MORE_ID : n)
    0: server_id = plain(`MB_STEP_END, NO_FLAG);
    1: server_id = plain(`MB_STEP_SPACE, {8'd0, TEXTS});
    2: server_id = FIRST_SET | `MB_TEXT_SERVER_ID;
    3: server_id = LESS_SET | (SERVER_ID_BYTES[15:0] - 16'd1);
    4: server_id = plain(`MB_STEP_RANGE, NO_FLAG);
    5: server_id = at(`MB_STEP_POINT, AT_READ_DATA, CLEAR);
    6: server_id = plain(`MB_STEP_BURST, NO_FLAG);
    7: server_id = status(`MB_STATUS_RUN);
    8: server_id = at(`MB_STEP_PUT, AT_FRAME, HERE);
    9: server_id = LESS_SET | (ADDITIONAL_DATA_BYTES[15:0] - 16'd1);
    10: server_id = plain(`MB_STEP_RANGE, NO_FLAG);
    11: server_id = plain(`MB_STEP_BURST, NO_FLAG);
    default: server_id = go(ANSWER[8:0]);
  endcase
endfunction

// 2B: function, MEI type 0EH, code, object.  The directory of modbus_identity has a section for each code, with a
// record for each object that may be asked for: it is searched, and tells what to send.
function [15:0] device_id(input integer n);
  case (n)
    0: device_id = match(8'h00, ANY);
    1: device_id = when(`MB_IF_LEFT, DEVICE_ID[8:0] + 9'd2);
    2: device_id = RECALL;
    3: device_id = at(`MB_STEP_WALK, AT_MEI, NO_FLAG);
    4: device_id = match(8'h0E, FUNCTION);
    5: device_id = at(`MB_STEP_WALK, AT_MEI_END, NO_FLAG);
    6: device_id = plain(`MB_STEP_END, NO_FLAG);
    // the code, as a quantity and an address of 16 bits; 4 needs individual access
    7: device_id = plain(`MB_STEP_LITERAL, 11'h000);
    8: device_id = at(`MB_STEP_PUT, AT_MEI, NO_FLAG);
    9: device_id = at(`MB_STEP_POINT, AT_MEI, NO_FLAG);
    10: device_id = quantity(CONFORMITY[7] ? 11'd4 : 11'd3);
    11: device_id = at(`MB_STEP_POINT, AT_MEI, NO_FLAG);
    12: device_id = plain(`MB_STEP_ADDRESS, NO_FLAG);
    // its section: high and low byte of the address lie four apart
    13: device_id = plain(`MB_STEP_SPACE, {8'd0, TEXTS});
    14: device_id = LESS_SET | 16'd4;
    15: device_id = plain(`MB_STEP_RANGE, NO_FLAG);
    16: device_id = at(`MB_STEP_POINT, AT_SECTION, NO_FLAG);
    17: device_id = plain(`MB_STEP_BURST, NO_FLAG);
    18: device_id = load(`MB_LOAD_BYTE, AT_SECTION, NO_FLAG);
    19: device_id = at(`MB_STEP_PUT, AT_SECTION_LOW, NO_FLAG);
    20: device_id = at(`MB_STEP_POINT, AT_SECTION_LOW, NO_FLAG);
    21: device_id = plain(`MB_STEP_ADDRESS, NO_FLAG);
    // record after record: found by its object, or the last one
    22: device_id = LESS_SET | 16'd8;
    23: device_id = plain(`MB_STEP_RANGE, NO_FLAG);
    24: device_id = at(`MB_STEP_POINT, AT_RECORD, NO_FLAG);
    25: device_id = plain(`MB_STEP_BURST, NO_FLAG);
    26: device_id = load(`MB_LOAD_BYTE, AT_RECORD + 5'd1, NO_FLAG);
    27: device_id = at(`MB_STEP_POINT, AT_ID_WANTED, NO_FLAG);
    28: device_id = when(`MB_IF_EQUAL, DEVICE_ID[8:0] + 9'd33);
    29: device_id = plain(`MB_STEP_LITERAL, {3'd0, `MB_TEXT_MORE});
    30: device_id = at(`MB_STEP_POINT, AT_RECORD, NO_FLAG);
    31: device_id = when(`MB_IF_EQUAL, DEVICE_ID[8:0] + 9'd22);
    32: device_id = match(`MB_TEXT_LAST, ADDRESS);       // no such object
    // address and length of the objects; more, next, number; then the objects over the record
    33: device_id = at(`MB_STEP_POINT, AT_RECORD + 5'd2, NO_FLAG);
    34: device_id = plain(`MB_STEP_ADDRESS, NO_FLAG);
    35: device_id = quantity(OBJECTS_MOST);
    36: device_id = plain(`MB_STEP_RANGE, NO_FLAG);
    37: device_id = load(`MB_LOAD_BYTE, AT_RECORD + 5'd6, NO_FLAG);
    38: device_id = at(`MB_STEP_PUT, AT_MORE, NO_FLAG);
    39: device_id = load(`MB_LOAD_BYTE, AT_RECORD + 5'd7, NO_FLAG);
    40: device_id = at(`MB_STEP_PUT, AT_NEXT, NO_FLAG);
    41: device_id = load(`MB_LOAD_BYTE, AT_RECORD + 5'd8, NO_FLAG);
    42: device_id = at(`MB_STEP_PUT, AT_OBJECTS, NO_FLAG);
    43: device_id = plain(`MB_STEP_LITERAL, {3'd0, CONFORMITY});
    44: device_id = at(`MB_STEP_PUT, AT_CONFORMITY, NO_FLAG);
    45: device_id = plain(`MB_STEP_LITERAL, 11'h00E);
    46: device_id = at(`MB_STEP_PUT, AT_MEI, NO_FLAG);
    47: device_id = at(`MB_STEP_POINT, AT_OBJECT, CLEAR);
    48: device_id = plain(`MB_STEP_BURST, NO_FLAG);
    49: device_id = at(`MB_STEP_POINT, AT_FRAME, NO_FLAG);
    50: device_id = at(`MB_STEP_WALK, AT_OBJECT, UP);
    default: device_id = go(SENDING[8:0]);
  endcase
endfunction
