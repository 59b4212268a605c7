// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_frame - what is done with every frame; part of the listing of modbus_program.

// A good frame for us, the cursor at its first byte.  The two check bytes leave the count, then the address.
`ROUTINE(START, 1'b1)
  if (HAS_DIAGNOSTICS != 0) begin
    `DO(COUNT(`MB_CPT_BUS_MESSAGE, `MB_WHEN_ALWAYS))
  end
  if (HAS_CONTEXT != 0) begin
    // The whole request is kept.
    `DO(WALK(AT_CHECKED))
    `DO(POINT(AT_FRAME))
    `DO(SAVE)
    `DO(WALK(AT_FUNCTION))
  end else begin
    `DO(WALK(AT_CHECKED + AT_FUNCTION))
    `DO(POINT(AT_FUNCTION))
  end
  if (HAS_DIAGNOSTICS != 0) begin
    `DO(COUNT(`MB_CPT_SLAVE_MESSAGE, `MB_WHEN_ALWAYS))
    `DO(LOG_RECEIVED(EVENT_RECEIVED))
    `DO(IF_LISTENING(LISTENING))
  end
  if (HAS_USER != 0) begin
    // The user's answer begins like the request; if the user passes, all is as before.
    `DO(IF_NOT_USER(BUILT_IN))
    `DO(POINT_CLEAR(UPPER))
    `DO(LOAD(AT_FRAME))
    `DO(PUT(UPPER))
    `DO(LOAD(AT_FUNCTION))
    `DO(PUT(UPPER + AT_FUNCTION))
    `DO(OFFER(SEND_UPPER))
    `DO(RECALL)
    `DO(WALK(AT_FUNCTION))
    `LABEL(BUILT_IN)
  end
  `DO(DISPATCH(FUNCTION_TABLE))
`END_ROUTINE

// A bad frame: runs while the next one may already begin, so it leaves the frame RAM alone.
`ROUTINE(BAD, HAS_DIAGNOSTICS != 0)
  `DO(COUNT(`MB_CPT_OVERRUN, `MB_WHEN_LONG))
  `DO(MODE(TOO_LONG))
  `DO(COUNT(`MB_CPT_COMM_ERROR, `MB_WHEN_ALWAYS))
  `DO(LOG_BAD(EVENT_BAD))
  `DO(REST)
`END_ROUTINE

// A good frame for another slave: likewise
`ROUTINE(FOREIGN, HAS_DIAGNOSTICS != 0)
  `DO(COUNT(`MB_CPT_BUS_MESSAGE, `MB_WHEN_ALWAYS))
  `DO(REST)
`END_ROUTINE

// Listen-only: only a restart for us alone is obeyed (V1.1b3, clause 6.8.1, 04); it is never answered.
`ROUTINE(LISTENING, HAS_DIAGNOSTICS != 0)
  `DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_ALWAYS))
  `DO(LOG_SENT(EVENT_SENT))
  `DO(GO_IF_UNICAST(`NEXT))
  `DO(MATCH(8'h08, `MB_EX_ILLEGAL_FUNCTION))
  `DO(MATCH(8'h00, `MB_EX_ILLEGAL_FUNCTION))
  `DO(MATCH(8'h01, `MB_EX_ILLEGAL_FUNCTION))
  `DO(COIL)
  `FALL_INTO(RESTART)
`END_ROUTINE

// The held byte is the high one of the option: FFH empties the log.
`ROUTINE(RESTART, HAS_DIAGNOSTICS != 0)
  `DO(MODE(WAIT | ACTIVE | EMPTY | LINE))
  `DO(LOG(EVENT_RESTART))
  `FALL_INTO(CLEARING)
`END_ROUTINE

// All counters to 0
`ROUTINE(CLEARING, HAS_DIAGNOSTICS != 0)
  `DO(CLEAR(`MB_CPT_EVENT))
  `DO(CLEAR(`MB_CPT_BUS_MESSAGE))
  `DO(CLEAR(`MB_CPT_COMM_ERROR))
  `DO(CLEAR(`MB_CPT_EXCEPTION))
  `DO(CLEAR(`MB_CPT_SLAVE_MESSAGE))
  `DO(CLEAR(`MB_CPT_NO_RESPONSE))
  `DO(CLEAR(`MB_CPT_NAK))
  `DO(CLEAR(`MB_CPT_BUSY))
  `DO(CLEAR(`MB_CPT_OVERRUN))
  `DO(REST)
`END_ROUTINE
