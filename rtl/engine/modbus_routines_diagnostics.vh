// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_diagnostics - function codes 07 08 0B 0C; part of modbus_program.

// 07: function
function [15:0] exception_status(input integer n);
  case (n)
    0: exception_status = plain(`MB_STEP_END, NO_FLAG);
    1: exception_status = status(`MB_STATUS_EXCEPTION);
    2: exception_status = at(`MB_STEP_PUT, AT_CODE, NO_FLAG);
    default: exception_status = echo(n - 3, AT_STATUS_END);
  endcase
endfunction

// 08: function, sub-function, data.  Taking the sub-function as an address tells whether it is there, and it is
// the address of its counter.
function [15:0] diagnostics(input integer n);
  case (n)
    0: diagnostics = plain(`MB_STEP_ADDRESS, NO_FLAG);
    1: diagnostics = when(`MB_IF_LEFT, DIAGNOSTICS[8:0] + 9'd2);
    2: diagnostics = RECALL;
    3: diagnostics = at(`MB_STEP_WALK, AT_SUB, NO_FLAG);
    4: diagnostics = match(8'h00, FUNCTION);
    default: diagnostics = plain(`MB_STEP_FUNCTION, SUB_TABLE[10:0]);
  endcase
endfunction

function [15:0] sub_entry(input integer sub);
  case (sub)
    'h00: sub_entry = go(SUB_ECHO[8:0]);
    'h01: sub_entry = go(SUB_RESTART[8:0]);
    'h02: sub_entry = go(SUB_REGISTER[8:0]);
    'h03: sub_entry = go(SUB_DELIMITER[8:0]);
    'h04: sub_entry = go(SUB_LISTEN[8:0]);
    'h0A: sub_entry = go(SUB_CLEAR[8:0]);
    'h0B, 'h0C, 'h0D, 'h0E, 'h0F, 'h10, 'h11, 'h12: sub_entry = go(SUB_COUNTER[8:0]);
    'h14: sub_entry = go(SUB_OVERRUN[8:0]);
    default: sub_entry = ILLEGAL;
  endcase
endfunction

function [15:0] sub_echo(input integer n);
  case (n)
    0: sub_echo = plain(`MB_STEP_END, `MB_FLAG_WORDS);
    1: sub_echo = RECALL;
    default: sub_echo = go(SENDING[8:0]);
  endcase
endfunction

function [15:0] sub_counter(input integer n);
  case (n)
    0: sub_counter = plain(`MB_STEP_COIL, `MB_FLAG_ZERO);
    1: sub_counter = plain(`MB_STEP_END, NO_FLAG);
    2: sub_counter = plain(`MB_STEP_SPACE, {8'd0, WORDS});
    3: sub_counter = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
    4: sub_counter = at(`MB_STEP_POINT, AT_WORD, NO_FLAG);
    5: sub_counter = plain(`MB_STEP_BURST, NO_FLAG);
    default: sub_counter = go(ECHO[8:0]);
  endcase
endfunction

function [15:0] sub_register(input integer n);
  case (n)
    0: sub_register = plain(`MB_STEP_COIL, `MB_FLAG_ZERO);
    1: sub_register = plain(`MB_STEP_END, NO_FLAG);
    2: sub_register = status(`MB_STATUS_HIGH);
    3: sub_register = at(`MB_STEP_PUT, AT_WORD, NO_FLAG);
    4: sub_register = status(`MB_STATUS_LOW);
    5: sub_register = at(`MB_STEP_PUT, AT_WORD + 5'd1, NO_FLAG);
    default: sub_register = go(ECHO[8:0]);
  endcase
endfunction

function [15:0] sub_delimiter(input integer n);
  case (n)
    0: sub_delimiter = match(8'h00, ANY);
    1: sub_delimiter = match(8'h00, VALUE);
    2: sub_delimiter = plain(`MB_STEP_END, NO_FLAG);
    default: sub_delimiter = go(ECHO[8:0]);
  endcase
endfunction

// Not answered: it counts as a success without a response, and the send event is that of an answer.
function [15:0] sub_listen(input integer n);
  case (n)
    0: sub_listen = plain(`MB_STEP_COIL, `MB_FLAG_ZERO);
    1: sub_listen = plain(`MB_STEP_END, NO_FLAG);
    2: sub_listen = count(`MB_CPT_EVENT, `MB_WHEN_ALWAYS);
    3: sub_listen = count(`MB_CPT_NO_RESPONSE, `MB_WHEN_ALWAYS);
    4: sub_listen = SENT_EVENT;
    5: sub_listen = plain(`MB_STEP_LOG, 11'h004);
    6: sub_listen = plain(`MB_STEP_MODE, `MB_MODE_LISTEN);
    default: sub_listen = REST;
  endcase
endfunction

// Clearing is the last action of its own message: it has been answered, counted and logged.
function [15:0] sub_clear(input integer n);
  case (n)
    0: sub_clear = plain(`MB_STEP_COIL, `MB_FLAG_ZERO);
    1: sub_clear = plain(`MB_STEP_END, NO_FLAG);
    2: sub_clear = RECALL;
    3: sub_clear = send(AT_FRAME);
    4: sub_clear = SENT_EVENT;
    5: sub_clear = plain(`MB_STEP_MODE, `MB_MODE_WAIT | `MB_MODE_REGISTER);
    default: sub_clear = go(CLEARING[8:0]);
  endcase
endfunction

function [15:0] sub_overrun(input integer n);
  case (n)
    0: sub_overrun = plain(`MB_STEP_COIL, `MB_FLAG_ZERO);
    1: sub_overrun = plain(`MB_STEP_END, NO_FLAG);
    2: sub_overrun = RECALL;
    3: sub_overrun = send(AT_FRAME);
    4: sub_overrun = count(`MB_CPT_EVENT, `MB_WHEN_ALWAYS);
    5: sub_overrun = SENT_EVENT;
    6: sub_overrun = plain(`MB_STEP_MODE, `MB_MODE_WAIT | `MB_MODE_OVERRUN);
    7: sub_overrun = plain(`MB_STEP_COUNT, CLEAR | {6'd0, `MB_CPT_OVERRUN});
    default: sub_overrun = REST;
  endcase
endfunction

function [15:0] sub_restart(input integer n);
  case (n)
    0: sub_restart = plain(`MB_STEP_COIL, NO_FLAG);
    1: sub_restart = plain(`MB_STEP_END, NO_FLAG);
    2: sub_restart = RECALL;
    3: sub_restart = send(AT_FRAME);
    4: sub_restart = SENT_EVENT;
    default: sub_restart = go(RESTART[8:0]);
  endcase
endfunction

// 0B: function.  It does not count in the event counter, so it enters the tail behind that.
function [15:0] event_counter(input integer n);
  case (n)
    0: event_counter = plain(`MB_STEP_END, NO_FLAG);
    1: event_counter = status(`MB_STATUS_BUSY);
    2: event_counter = at(`MB_STEP_PUT, AT_CODE, NO_FLAG);
    3: event_counter = at(`MB_STEP_PUT, AT_CODE + 5'd1, NO_FLAG);
    4: event_counter = plain(`MB_STEP_SPACE, {8'd0, WORDS});
    5: event_counter = FIRST_SET | {11'd0, `MB_CPT_EVENT};
    6: event_counter = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
    7: event_counter = at(`MB_STEP_POINT, AT_WORD, NO_FLAG);
    8: event_counter = plain(`MB_STEP_BURST, NO_FLAG);
    9: event_counter = at(`MB_STEP_POINT, AT_FRAME, CLEAR);
    10: event_counter = at(`MB_STEP_WALK, AT_VALUE_END, UP);
    11: event_counter = send(AT_FRAME);
    default: event_counter = go(TAIL[8:0] + 9'd1);
  endcase
endfunction

// 0C: function.  Its own receive event is in the log, so there is at least one.
function [15:0] event_log(input integer n);
  case (n)
    0: event_log = plain(`MB_STEP_END, NO_FLAG);
    1: event_log = plain(`MB_STEP_LITERAL, 11'd0);
    2: event_log = at(`MB_STEP_PUT, AT_LOG_SCRATCH, NO_FLAG);
    3: event_log = status(`MB_STATUS_LOG);
    4: event_log = at(`MB_STEP_PUT, AT_LOG_SCRATCH + 5'd1, NO_FLAG);
    5: event_log = status(`MB_STATUS_BUSY);
    6: event_log = at(`MB_STEP_PUT, AT_READ_DATA, NO_FLAG);
    7: event_log = at(`MB_STEP_PUT, AT_READ_DATA + 5'd1, NO_FLAG);
    8: event_log = plain(`MB_STEP_SPACE, {8'd0, WORDS});
    9: event_log = FIRST_SET | {11'd0, `MB_CPT_EVENT};
    10: event_log = LESS_SET | 16'd1;
    11: event_log = plain(`MB_STEP_RANGE, NO_FLAG);
    12: event_log = at(`MB_STEP_POINT, AT_EVENTS, NO_FLAG);
    13: event_log = plain(`MB_STEP_BURST, NO_FLAG);
    14: event_log = at(`MB_STEP_POINT, AT_LOG_SCRATCH, NO_FLAG);
    15: event_log = quantity(11'd64);
    16: event_log = plain(`MB_STEP_SPACE, {8'd0, EVENTS});
    17: event_log = FIRST_SET;
    18: event_log = plain(`MB_STEP_RANGE, NO_FLAG);
    19: event_log = at(`MB_STEP_POINT, AT_READ_DATA, CLEAR);
    20: event_log = at(`MB_STEP_WALK, AT_LOG, UP);
    21: event_log = plain(`MB_STEP_BURST, NO_FLAG);
    default: event_log = go(ANSWER[8:0]);
  endcase
endfunction
