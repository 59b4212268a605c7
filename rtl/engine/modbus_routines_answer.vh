// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_answer - how a request ends: answers, exceptions, what is counted; part of the listing of
// modbus_program.

// The data stand at AT_READ_DATA and count is their number: put it before them.
`ROUTINE(ANSWER, HAS_DATA_ANSWERS)
  `DO(PUT_STATUS(`MB_STATUS_COUNT, AT_BYTE_COUNT))
  `FALL_INTO(ANSWER_HEAD)
`END_ROUTINE

// The head of an answer up to its first length byte
`ROUTINE(ANSWER_HEAD, HAS_DATA_ANSWERS | HAS_HEADS)
  `DO(POINT(AT_FRAME))
  `DO(WALK_UP(AT_BYTE_COUNT))
  `FALL_INTO(SENDING)
`END_ROUTINE

// The answer stands in the lower half.
`ROUTINE(SENDING, 1'b1)
  `DO(SEND(AT_FRAME))
  if (HAS_DIAGNOSTICS != 0) begin
    `FALL_INTO(TAIL)
  end else begin
    `FALL_INTO(DONE)
  end
`END_ROUTINE

// What has become of the frame (V1.02, appendix A; steps 7 to 11 of the order of counting)
`ROUTINE(TAIL, HAS_DIAGNOSTICS != 0)
  `DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_SUCCESS))
  `LABEL(TAIL_NO_EVENT)
  `DO(COUNT(`MB_CPT_EXCEPTION, `MB_WHEN_EXCEPTION))
  `DO(COUNT(`MB_CPT_BUSY, `MB_WHEN_BUSY))
  `DO(COUNT(`MB_CPT_NAK, `MB_WHEN_NAK))
  `DO(LOG_SENT(EVENT_SENT))
  `FALL_INTO(FATE)
`END_ROUTINE

// A broadcast is not answered, and the line gives up an answer that comes too late.
`ROUTINE(FATE, HAS_DIAGNOSTICS != 0)
  `DO(MODE(WAIT))
  `DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_UNSENT))
  `FALL_INTO(DONE)
`END_ROUTINE

`ROUTINE(DONE, 1'b1)
  `DO(REST)
`END_ROUTINE

// Function code with bit 7 set, exception code (V1.1b3, clause 7); nothing in listen-only mode
`ROUTINE(EXCEPTION, 1'b1)
  if (HAS_DIAGNOSTICS != 0) begin
    `DO(IF_LISTENING(DONE))
  end
  `DO(POINT_CLEAR(AT_FRAME))
  `DO(WALK_UP(AT_FUNCTION))
  `DO(LOAD_MARKED(AT_FUNCTION))
  `DO(PUT(AT_FUNCTION))
  `DO(PUT_STATUS(`MB_STATUS_CODE, AT_CODE))
  `DO(GO(SENDING))
`END_ROUTINE
