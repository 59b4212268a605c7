// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_diagnostics - function codes 07 08 0B 0C; part of the listing of modbus_program.

// 07: function.  The status byte is the one that counts so far.
`ROUTINE(EXCEPTION_STATUS, FUNCTION_CODES[`MB_FC_READ_EXCEPTION_STATUS])
  `DO(END)
  `DO(PUT_STATUS(`MB_STATUS_EXCEPTION, AT_CODE))
  `DO(GO(ANSWER_HEAD))
`END_ROUTINE

// 08: function, sub-function, data.  Taking the sub-function as an address tells whether it is there, and it is
// the address of its counter.
`ROUTINE(DIAGNOSTICS, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(ADDRESS_OF_ONE)
  `DO(IF_LEFT(`NEXT))
  `DO(RECALL)
  `DO(WALK(AT_SUB))
  `DO(MATCH(8'h00, `MB_EX_ILLEGAL_FUNCTION))
  `DO(DISPATCH(SUB_TABLE))
`END_ROUTINE

// The request is the answer.
`ROUTINE(SUB_ECHO, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(END_OF_WORDS)
  `DO(RECALL)
  `DO(GO(SENDING))
`END_ROUTINE

`ROUTINE(SUB_REGISTER, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(FIRST({3'd0, `MB_CPT_REGISTER}))
  `FALL_INTO(SUB_COUNTER)
`END_ROUTINE

`ROUTINE(SUB_COUNTER, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(ZERO)
  `DO(SPACE(WORDS))
  `DO(READ_TO(AT_WORD))
  `DO(GO(ECHO))
`END_ROUTINE

`ROUTINE(SUB_DELIMITER, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(SKIP_BYTE)
  `DO(MATCH(8'h00, `MB_EX_ILLEGAL_DATA_VALUE))
  `DO(END)
  if (ASCII_MODE != 0) begin
    `DO(POINT(AT_WORD))
    `DO(MODE(DELIMITER))
  end
  `DO(GO(ECHO))
`END_ROUTINE

// Not answered: it counts as a success without a response, and the send event is that of an answer.
`ROUTINE(SUB_LISTEN, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(ZERO)
  `DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_ALWAYS))
  `DO(COUNT(`MB_CPT_NO_RESPONSE, `MB_WHEN_ALWAYS))
  `DO(LOG_SENT(EVENT_SENT))
  `DO(LOG(EVENT_LISTEN))
  `DO(MODE(LISTEN))
  `DO(REST)
`END_ROUTINE

// Clearing is the last action of its own message: it has been answered and logged.
`ROUTINE(SUB_CLEAR, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(ZERO)
  `DO(RECALL)
  `DO(SEND(AT_FRAME))
  `DO(LOG_SENT(EVENT_SENT))
  `DO(MODE(WAIT | REGISTER))
  `DO(GO(CLEARING))
`END_ROUTINE

`ROUTINE(SUB_OVERRUN, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(ZERO)
  `DO(RECALL)
  `DO(SEND(AT_FRAME))
  `DO(COUNT(`MB_CPT_EVENT, `MB_WHEN_ALWAYS))
  `DO(LOG_SENT(EVENT_SENT))
  `DO(MODE(WAIT | OVERRUN))
  `DO(CLEAR(`MB_CPT_OVERRUN))
  `DO(GO(FATE))
`END_ROUTINE

`ROUTINE(SUB_RESTART, FUNCTION_CODES[`MB_FC_DIAGNOSTICS])
  `DO(COIL)
  `DO(RECALL)
  `DO(SEND(AT_FRAME))
  `DO(LOG_SENT(EVENT_SENT))
  `DO(GO(RESTART))
`END_ROUTINE

// 0B: function.  It does not count in the event counter, so it enters the tail behind that.
`ROUTINE(EVENT_COUNTER, FUNCTION_CODES[`MB_FC_GET_EVENT_COUNTER])
  `DO(END)
  `DO(PUT_STATUS(`MB_STATUS_BUSY, AT_CODE))
  `DO(PUT_STATUS(`MB_STATUS_BUSY, AT_CODE + 5'd1))
  `DO(SPACE(WORDS))
  `DO(FIRST({3'd0, `MB_CPT_EVENT}))
  `DO(READ_TO(AT_WORD))
  `DO(POINT_CLEAR(AT_FRAME))
  `DO(WALK_UP(AT_VALUE_END))
  `DO(SEND(AT_FRAME))
  `DO(GO(TAIL_NO_EVENT))
`END_ROUTINE

// 0C: function.  Its own receive event is in the log, so there is at least one.
`ROUTINE(EVENT_LOG, FUNCTION_CODES[`MB_FC_GET_EVENT_LOG])
  `DO(END)
  `DO(PUT_STATUS(`MB_STATUS_BUSY, AT_READ_DATA))
  `DO(PUT_STATUS(`MB_STATUS_BUSY, AT_READ_DATA + 5'd1))
  // event counter and message counter
  `DO(SPACE(WORDS))
  `DO(FIRST({3'd0, `MB_CPT_EVENT}))
  `DO(ITEMS(2))
  `DO(READ_TO(AT_EVENTS))
  // the log, newest entry first: their number becomes the quantity.  Six bytes count when it is taken: the status, the
  // two counters.
  `DO(FIRST({3'd0, `MB_CPT_ENTRIES}))
  `DO(READ_TO(AT_LOG_SCRATCH))
  `DO(SPACE(EVENTS))
  `DO(FIRST(8'd0))
  `DO(POINT(AT_LOG_SCRATCH))
  `DO(QUANTITY(LOG_MOST))
  `DO(READ_TO(AT_LOG))
  `DO(GO(ANSWER))
`END_ROUTINE
