// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_mnemonics - the steps as they stand in the listing; part of modbus_program.
//
// A mnemonic is a constant or a function; it fills in the fields of one step (modbus_steps.vh).

// Places in the program and counts are integers, of which a step holds some bits.
// verilator lint_off UNUSED
function [15:0] STEP(input [4:0] code);
  begin
    STEP = 16'd0;
    STEP[`MB_WORD_STEP] = code;
  end
endfunction

localparam [15:0]
  REST            = STEP(`MB_STEP_REST),
  ADDRESS         = STEP(`MB_STEP_ADDRESS),
  ADDRESS_OF_ONE  = STEP(`MB_STEP_ADDRESS) | (16'd1 << `MB_ARG_ONE),
  COIL            = STEP(`MB_STEP_COIL),
  ZERO            = STEP(`MB_STEP_COIL) | (16'd1 << `MB_ARG_ZERO),
  BYTE_COUNT      = STEP(`MB_STEP_BYTE_COUNT),
  BYTE_COUNT_FITS = STEP(`MB_STEP_BYTE_COUNT) | (16'd1 << `MB_ARG_FIT),
  END             = STEP(`MB_STEP_END),
  END_OF_WORDS    = STEP(`MB_STEP_END) | (16'd1 << `MB_ARG_WORDS),
  TELL            = STEP(`MB_STEP_TELL),
  GRANT_READ      = STEP(`MB_STEP_GRANT),
  GRANT_WRITE     = STEP(`MB_STEP_GRANT) | (16'd1 << `MB_ARG_WRITE),
  READ_HERE       = STEP(`MB_STEP_BURST) | (16'd1 << `MB_ARG_HERE),
  READ_HERE_KEEP  = STEP(`MB_STEP_BURST) | (16'd1 << `MB_ARG_HERE) | (16'd1 << `MB_ARG_KEEP),
  WRITE_HERE_KEEP = STEP(`MB_STEP_BURST) | (16'd1 << `MB_ARG_HERE) | (16'd1 << `MB_ARG_WRITE) | (16'd1 << `MB_ARG_KEEP),
  PASS_OVER       = STEP(`MB_STEP_BURST) | (16'd1 << `MB_ARG_HERE) | (16'd1 << `MB_ARG_WRITE) | (16'd1 << `MB_ARG_DRY),
  PUT_HERE        = STEP(`MB_STEP_PUT) | (16'd1 << `MB_ARG_HERE),
  SKIP_BYTE       = STEP(`MB_STEP_MATCH),
  FILE            = STEP(`MB_STEP_FILE),
  TOTAL           = STEP(`MB_STEP_TOTAL),
  SAVE            = STEP(`MB_STEP_CONTEXT) | (16'd1 << `MB_ARG_SAVE),
  RECALL          = STEP(`MB_STEP_CONTEXT) | (16'd1 << `MB_ARG_RECALL),
  SWAP            = STEP(`MB_STEP_CONTEXT) | (16'd1 << `MB_ARG_SAVE) | (16'd1 << `MB_ARG_RECALL);

// Jumps.  A target of a routine that is left out gives a step that the assembler counts as a fault.
localparam [15:0] NO_SUCH_TARGET = 16'hFFFF;

function [15:0] TO(input [4:0] code, input [1:0] condition, input integer target);
  begin
    TO = STEP(code);
    TO[`MB_ARG_CONDITION] = condition;
    TO[`MB_ARG_TARGET]    = target[`MB_AT_WIDTH-1:0];
    if (target < 0) TO = NO_SUCH_TARGET;
  end
endfunction

function [15:0] GO(input integer target);
  GO = TO(`MB_STEP_JUMP, `MB_JUMP_ALWAYS, target);
endfunction

function [15:0] GO_IF_UNICAST(input integer target);
  GO_IF_UNICAST = TO(`MB_STEP_JUMP, `MB_JUMP_UNICAST, target);
endfunction

function [15:0] IF_EQUAL(input integer target);
  IF_EQUAL = TO(`MB_STEP_IF, `MB_IF_EQUAL, target);
endfunction

function [15:0] IF_LEFT(input integer target);
  IF_LEFT = TO(`MB_STEP_IF, `MB_IF_LEFT, target);
endfunction

function [15:0] IF_LISTENING(input integer target);
  IF_LISTENING = TO(`MB_STEP_IF, `MB_IF_LISTENING, target);
endfunction

function [15:0] IF_NOT_USER(input integer target);
  IF_NOT_USER = TO(`MB_STEP_IF, `MB_IF_NOT_USER, target);
endfunction

function [15:0] OFFER(input integer target);
  OFFER = TO(`MB_STEP_OFFER, 2'd0, target);
endfunction

function [15:0] DISPATCH(input integer target);
  DISPATCH = TO(`MB_STEP_DISPATCH, 2'd0, target);
endfunction

localparam [15:0] NEXT_IF_READY = TO(`MB_STEP_JUMP, `MB_JUMP_READY, 0);
localparam [15:0] ILLEGAL       = TO(`MB_STEP_JUMP, `MB_JUMP_NEVER, 0);

function [15:0] ADDRESS_IN(input [2:0] space);
  begin
    ADDRESS_IN = STEP(`MB_STEP_ADDRESS);
    ADDRESS_IN[`MB_ARG_IN_SPACE] = 1'b1;
    ADDRESS_IN[`MB_ARG_SPACE] = space;
  end
endfunction

function [15:0] ADDRESS_OF_ONE_IN(input [2:0] space);
  begin
    ADDRESS_OF_ONE_IN = ADDRESS_IN(space);
    ADDRESS_OF_ONE_IN[`MB_ARG_ONE] = 1'b1;
  end
endfunction

function [15:0] SPACE(input [2:0] space);
  begin
    SPACE = STEP(`MB_STEP_SPACE);
    SPACE[`MB_ARG_SPACE] = space;
  end
endfunction

function [15:0] QUANTITY(input [10:0] most);
  begin
    QUANTITY = STEP(`MB_STEP_QUANTITY);
    QUANTITY[`MB_ARG_ROOM] = 11'd0 - most;
  end
endfunction

function [15:0] DEPTH_UP_TO(input [10:0] most);
  begin
    DEPTH_UP_TO = STEP(`MB_STEP_DEPTH);
    DEPTH_UP_TO[`MB_ARG_ROOM] = 11'd0 - most - 11'd1;
  end
endfunction

function [15:0] FIRST(input [7:0] number);
  begin
    FIRST = STEP(`MB_STEP_SET);
    FIRST[`MB_ARG_LITERAL] = number;
  end
endfunction

function [15:0] ITEMS(input integer number);
  begin
    ITEMS = STEP(`MB_STEP_SET);
    ITEMS[`MB_ARG_LESS] = 1'b1;
    ITEMS[`MB_ARG_LITERAL] = number[7:0] - 8'd1;
  end
endfunction

function [15:0] MATCH(input [7:0] value, input [3:0] exception_code);
  begin
    MATCH = STEP(`MB_STEP_MATCH);
    MATCH[`MB_ARG_LITERAL] = value;
    MATCH[`MB_ARG_EXCEPTION] = exception_code[2:0];
  end
endfunction

function [15:0] LITERAL(input [7:0] value);
  begin
    LITERAL = STEP(`MB_STEP_LITERAL);
    LITERAL[`MB_ARG_LITERAL] = value;
  end
endfunction

function [15:0] LITERAL_CODE(input integer code);
  LITERAL_CODE = LITERAL(code[7:0]);
endfunction

function [15:0] POINT(input [4:0] place);
  begin
    POINT = STEP(`MB_STEP_POINT);
    POINT[`MB_ARG_PLACE] = place;
  end
endfunction

function [15:0] POINT_CLEAR(input [4:0] place);
  begin
    POINT_CLEAR = STEP(`MB_STEP_POINT);
    POINT_CLEAR[`MB_ARG_PLACE] = place;
    POINT_CLEAR[`MB_ARG_CLEAR] = 1'b1;
  end
endfunction

function [15:0] WALK(input [4:0] place);
  begin
    WALK = STEP(`MB_STEP_WALK);
    WALK[`MB_ARG_PLACE] = place;
  end
endfunction

function [15:0] WALK_UP(input [4:0] place);
  begin
    WALK_UP = STEP(`MB_STEP_WALK);
    WALK_UP[`MB_ARG_PLACE] = place;
    WALK_UP[`MB_ARG_UP] = 1'b1;
  end
endfunction

function [15:0] READ_TO(input [4:0] place);
  begin
    READ_TO = STEP(`MB_STEP_BURST);
    READ_TO[`MB_ARG_PLACE] = place;
  end
endfunction

function [15:0] READ_TO_CLEAR(input [4:0] place);
  begin
    READ_TO_CLEAR = STEP(`MB_STEP_BURST);
    READ_TO_CLEAR[`MB_ARG_PLACE] = place;
    READ_TO_CLEAR[`MB_ARG_CLEAR] = 1'b1;
  end
endfunction

function [15:0] READ_TO_KEEP(input [4:0] place);
  begin
    READ_TO_KEEP = STEP(`MB_STEP_BURST);
    READ_TO_KEEP[`MB_ARG_PLACE] = place;
    READ_TO_KEEP[`MB_ARG_KEEP] = 1'b1;
  end
endfunction

function [15:0] WRITE_FROM(input [4:0] place);
  begin
    WRITE_FROM = STEP(`MB_STEP_BURST);
    WRITE_FROM[`MB_ARG_PLACE] = place;
    WRITE_FROM[`MB_ARG_WRITE] = 1'b1;
  end
endfunction

function [15:0] WRITE_FROM_KEEP(input [4:0] place);
  begin
    WRITE_FROM_KEEP = STEP(`MB_STEP_BURST);
    WRITE_FROM_KEEP[`MB_ARG_PLACE] = place;
    WRITE_FROM_KEEP[`MB_ARG_WRITE] = 1'b1;
    WRITE_FROM_KEEP[`MB_ARG_KEEP] = 1'b1;
  end
endfunction

function [15:0] CHECK_FROM_KEEP(input [4:0] place);
  begin
    CHECK_FROM_KEEP = WRITE_FROM_KEEP(place);
    CHECK_FROM_KEEP[`MB_ARG_CHECK] = 1'b1;
  end
endfunction

function [15:0] PUT(input [4:0] place);
  begin
    PUT = STEP(`MB_STEP_PUT);
    PUT[`MB_ARG_PLACE] = place;
  end
endfunction

function [15:0] SEND(input [4:0] place);
  begin
    SEND = STEP(`MB_STEP_SEND);
    SEND[`MB_ARG_PLACE] = place;
  end
endfunction

function [15:0] LOAD_MARKED(input [4:0] place);
  begin
    LOAD_MARKED = STEP(`MB_STEP_LOAD);
    LOAD_MARKED[`MB_ARG_PLACE] = place;
    LOAD_MARKED[`MB_ARG_MARK] = 1'b1;
  end
endfunction

function [15:0] LOAD(input [4:0] place);
  begin
    LOAD = STEP(`MB_STEP_LOAD);
    LOAD[`MB_ARG_PLACE] = place;
    LOAD[`MB_ARG_WHAT] = `MB_LOAD_BYTE;
  end
endfunction

function [15:0] XOR(input [4:0] place);
  begin
    XOR = STEP(`MB_STEP_LOAD);
    XOR[`MB_ARG_PLACE] = place;
    XOR[`MB_ARG_WHAT] = `MB_LOAD_XOR;
  end
endfunction

function [15:0] AND(input [4:0] place);
  begin
    AND = STEP(`MB_STEP_LOAD);
    AND[`MB_ARG_PLACE] = place;
    AND[`MB_ARG_WHAT] = `MB_LOAD_AND;
  end
endfunction

function [15:0] PUT_STATUS(input [2:0] which, input [4:0] place);
  begin
    PUT_STATUS = PUT(place);
    PUT_STATUS[`MB_ARG_STATUS] = 1'b1;
    PUT_STATUS[`MB_ARG_WHICH] = which;
  end
endfunction

function [15:0] PUT_STATUS_HERE(input [2:0] which);
  begin
    PUT_STATUS_HERE = PUT_STATUS(which, 5'd0);
    PUT_STATUS_HERE[`MB_ARG_HERE] = 1'b1;
  end
endfunction

function [15:0] COUNT(input [4:0] counter, input [2:0] condition);
  begin
    COUNT = STEP(`MB_STEP_COUNT);
    COUNT[`MB_ARG_COUNTER] = counter;
    COUNT[`MB_ARG_WHEN] = condition;
  end
endfunction

function [15:0] CLEAR(input [4:0] counter);
  begin
    CLEAR = STEP(`MB_STEP_COUNT);
    CLEAR[`MB_ARG_COUNTER] = counter;
    CLEAR[`MB_ARG_CLEAR] = 1'b1;
  end
endfunction

function [15:0] LOG(input [7:0] kind);
  begin
    LOG = STEP(`MB_STEP_LOG);
    LOG[`MB_ARG_EVENT] = kind;
  end
endfunction

function [15:0] LOG_RECEIVED(input [7:0] kind);
  begin
    LOG_RECEIVED = LOG(kind);
    LOG_RECEIVED[`MB_ARG_BROADCAST] = 1'b1;
  end
endfunction

function [15:0] LOG_BAD(input [7:0] kind);
  begin
    LOG_BAD = LOG(kind);
    LOG_BAD[`MB_ARG_LONG] = 1'b1;
  end
endfunction

function [15:0] LOG_SENT(input [7:0] kind);
  begin
    LOG_SENT = LOG(kind);
    LOG_SENT[`MB_ARG_REFUSAL] = 1'b1;
  end
endfunction

function [15:0] MODE(input integer modes);
  MODE = STEP(`MB_STEP_MODE) | modes[15:0];
endfunction
localparam integer WAIT = 1 << `MB_MODE_WAIT, LISTEN = 1 << `MB_MODE_LISTEN, ACTIVE = 1 << `MB_MODE_ACTIVE,
                   EMPTY = 1 << `MB_MODE_EMPTY, REGISTER = 1 << `MB_MODE_REGISTER, OVERRUN = 1 << `MB_MODE_OVERRUN,
                   TOO_LONG = 1 << `MB_MODE_LONG, LINE = 1 << `MB_MODE_LINE, DELIMITER = 1 << `MB_MODE_DELIMITER;
// verilator lint_on UNUSED
