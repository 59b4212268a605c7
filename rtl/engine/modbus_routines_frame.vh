// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_frame - what is done with every frame; part of modbus_program.

// A good frame for us, the cursor at its first byte.  The two check bytes leave the count, then the address; k skips
// what is left out.
function [15:0] start(input integer n);
  integer k;
  begin
    k = n;
    if (D == 0) k = k + 1;
    if (C == 0 && k >= 1) k = k + 1;
    if (C == 0 && k >= 3) k = k + 1;
    if (D == 0 && k >= 5) k = k + 3;
    if (U == 0 && k >= 8) k = k + 9;
    case (k)
      0: start = count(`MB_CPT_BUS_MESSAGE, `MB_WHEN_ALWAYS);
      // with a context: the whole request is kept
      1: start = at(`MB_STEP_WALK, AT_CHECKED, NO_FLAG);
      2: start = (C == 0) ? at(`MB_STEP_WALK, AT_CHECKED + AT_FUNCTION, NO_FLAG) : at(`MB_STEP_POINT, AT_FRAME, NO_FLAG);
      3: start = SAVE;
      4: start = (C == 0) ? at(`MB_STEP_POINT, AT_FUNCTION, NO_FLAG) : at(`MB_STEP_WALK, AT_FUNCTION, NO_FLAG);
      5: start = count(`MB_CPT_SLAVE_MESSAGE, `MB_WHEN_ALWAYS);
      6: start = plain(`MB_STEP_LOG, `MB_FLAG_BROADCAST | 11'h080);
      7: start = when(`MB_IF_LISTENING, LISTENING[8:0]);
      // The user's answer begins like the request; if he passes, all is as before.
      8:  start = when(`MB_IF_NOT_USER, START[8:0] + n[8:0] + 9'd9);
      9: start = at(`MB_STEP_POINT, UPPER, CLEAR);
      10: start = load(`MB_LOAD_BYTE, AT_FRAME, NO_FLAG);
      11: start = at(`MB_STEP_PUT, UPPER, NO_FLAG);
      12: start = load(`MB_LOAD_BYTE, AT_FUNCTION, NO_FLAG);
      13: start = at(`MB_STEP_PUT, UPPER + AT_FUNCTION, NO_FLAG);
      14: start = {`MB_STEP_OFFER, 2'd0, USER_SEND[8:0]};
      15: start = RECALL;
      16: start = at(`MB_STEP_WALK, AT_FUNCTION, NO_FLAG);
      default: start = plain(`MB_STEP_FUNCTION, `MB_FLAG_WIDE | TABLE[10:0]);
    endcase
  end
endfunction

// Function code with bit 7 set, exception code (V1.1b3, clause 7); nothing in listen-only mode
function [15:0] exception(input integer n);
  case (n + 1 - D)
    0: exception = when(`MB_IF_LISTENING, DONE[8:0]);
    1: exception = at(`MB_STEP_POINT, AT_FRAME, CLEAR);
    2: exception = at(`MB_STEP_WALK, AT_FUNCTION, UP);
    3: exception = load(`MB_LOAD_BYTE, AT_FUNCTION, `MB_FLAG_MARK);
    4: exception = at(`MB_STEP_PUT, AT_FUNCTION, NO_FLAG);
    5: exception = status(`MB_STATUS_CODE);
    default: exception = at(`MB_STEP_PUT, AT_CODE, NO_FLAG);
  endcase
endfunction

// What has become of the frame (V1.02, appendix A; steps 7 to 11 of the order of counting)
function [15:0] tail(input integer n);
  case (n)
    0: tail = count(`MB_CPT_EVENT, `MB_WHEN_SUCCESS);
    1: tail = count(`MB_CPT_EXCEPTION, `MB_WHEN_EXCEPTION);
    2: tail = count(`MB_CPT_BUSY, `MB_WHEN_BUSY);
    3: tail = count(`MB_CPT_NAK, `MB_WHEN_NAK);
    4: tail = count(`MB_CPT_NO_RESPONSE, `MB_WHEN_BROADCAST);
    default: tail = SENT_EVENT;
  endcase
endfunction

// The head of the request, up to a place, is the answer.
function [15:0] echo(input integer n, input [4:0] place);
  case (n)
    0: echo = at(`MB_STEP_POINT, AT_FRAME, CLEAR);
    1: echo = at(`MB_STEP_WALK, place, UP);
    default: echo = go(SENDING[8:0]);
  endcase
endfunction

// The data stand at AT_READ_DATA and count is their number: put it before them.
function [15:0] answer(input integer n);
  case (n)
    0: answer = status(`MB_STATUS_COUNT);
    1: answer = at(`MB_STEP_PUT, AT_BYTE_COUNT, NO_FLAG);
    2: answer = at(`MB_STEP_POINT, AT_FRAME, NO_FLAG);
    3: answer = at(`MB_STEP_WALK, AT_BYTE_COUNT, UP);
    default: answer = go(SENDING[8:0]);
  endcase
endfunction

// A bad frame: runs while the next one may already begin, so it leaves the frame RAM alone.
function [15:0] bad(input integer n);
  case (n)
    0: bad = count(`MB_CPT_OVERRUN, `MB_WHEN_LONG);
    1: bad = plain(`MB_STEP_MODE, `MB_MODE_LONG);
    2: bad = count(`MB_CPT_COMM_ERROR, `MB_WHEN_ALWAYS);
    3: bad = plain(`MB_STEP_LOG, `MB_FLAG_LONG | 11'h082);
    default: bad = REST;
  endcase
endfunction

// A good frame for somebody else: likewise
function [15:0] foreign(input integer n);
  foreign = (n == 0) ? count(`MB_CPT_BUS_MESSAGE, `MB_WHEN_ALWAYS) : REST;
endfunction

// All counters to 0
function [15:0] clearing(input integer n);
  clearing = (n < 9) ? plain(`MB_STEP_COUNT, CLEAR | {6'd0, `MB_CPT_EVENT + n[4:0]}) : REST;
endfunction

// Listen-only: only a restart for us alone is obeyed (V1.1b3, clause 6.8.1, 04); it is never answered.
function [15:0] listening(input integer n);
  case (n)
    0: listening = count(`MB_CPT_NO_RESPONSE, `MB_WHEN_ALWAYS);
    1: listening = SENT_EVENT;
    2: listening = jump(`MB_JUMP_UNICAST, LISTENING[8:0] + 9'd3);
    3: listening = match(8'h08, FUNCTION);
    4: listening = match(8'h00, FUNCTION);
    5: listening = match(8'h01, FUNCTION);
    6: listening = plain(`MB_STEP_COIL, NO_FLAG);
    7: listening = plain(`MB_STEP_END, NO_FLAG);
    default: listening = go(RESTART[8:0]);
  endcase
endfunction

// The held byte is the high one of the option: FFH empties the log.
function [15:0] restart(input integer n);
  case (n)
    0: restart = plain(`MB_STEP_MODE, `MB_MODE_WAIT | `MB_MODE_ACTIVE | `MB_MODE_EMPTY | `MB_MODE_LINE);
    1: restart = plain(`MB_STEP_LOG, 11'h000);
    default: restart = go(CLEARING[8:0]);
  endcase
endfunction

// The answer that the user has put together
function [15:0] user_send(input integer n);
  user_send = (n == 0) ? send(UPPER) : go(TAIL[8:0]);
endfunction
