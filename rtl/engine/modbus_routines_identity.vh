// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_identity - function codes 11 2B, from the texts of modbus_identity; part of the listing of
// modbus_program.

// 11: function.  The additional data stand behind the identifier, where the burst has left off.
`ROUTINE(REPORT_SERVER_ID, FUNCTION_CODES[`MB_FC_REPORT_SERVER_ID])
  `DO(END)
  `DO(SPACE(TEXTS))
  `DO(FIRST(`MB_TEXT_SERVER_ID))
  `DO(ITEMS(SERVER_ID_BYTES))
  `DO(READ_TO_CLEAR(AT_READ_DATA))
  `DO(PUT_STATUS_HERE(`MB_STATUS_RUN))
  if (ADDITIONAL_DATA_BYTES > 0) begin
    `DO(ITEMS(ADDITIONAL_DATA_BYTES))
    `DO(READ_HERE)
  end
  `DO(GO(ANSWER))
`END_ROUTINE

// 2B: function, MEI type 0EH, code, object.  The directory of modbus_identity has a section for each code, with a
// record for each object that may be asked for: it is searched, and tells what to send.
`ROUTINE(DEVICE_ID, FUNCTION_CODES[`MB_FC_ENCAPSULATED])
  `DO(SKIP_BYTE)
  `DO(IF_LEFT(`NEXT))
  `DO(RECALL)
  `DO(WALK(AT_MEI))
  `DO(MATCH(MEI_DEVICE_ID, `MB_EX_ILLEGAL_FUNCTION))
  `DO(WALK(AT_MEI_END))
  `DO(END)
  // the code, as a quantity and an address of 16 bits; 4 needs individual access
  `DO(LITERAL(0))
  `DO(PUT(AT_MEI))
  `DO(POINT(AT_MEI))
  `DO(QUANTITY(CONFORMITY[7] ? 11'd4 : 11'd3))
  `DO(POINT(AT_MEI))
  `DO(ADDRESS)
  // its section: high and low byte of the address lie four apart
  `DO(SPACE(TEXTS))
  `DO(ITEMS(5))
  `DO(READ_TO(AT_SECTION))
  `DO(LOAD(AT_SECTION))
  `DO(PUT(AT_SECTION_LOW))
  `DO(POINT(AT_SECTION_LOW))
  `DO(ADDRESS)
  // record after record: found by its object, or the last one
  `LOOP
  `DO(ITEMS(9))
  `DO(READ_TO(AT_RECORD))
  `DO(LOAD(AT_RECORD_OBJECT))
  `DO(POINT(AT_ID_WANTED))
  `DO(IF_EQUAL(FOUND))
  `DO(LITERAL(`MB_TEXT_MORE))
  `DO(POINT(AT_RECORD_MARK))
  `DO(IF_EQUAL(loop))
  `DO(MATCH(`MB_TEXT_LAST, `MB_EX_ILLEGAL_DATA_ADDRESS))     // no such object
  // address and length of the objects; then the objects over the rest of the record
  `LABEL(FOUND)
  `DO(POINT(AT_RECORD_RANGE))
  `DO(ADDRESS)
  `DO(QUANTITY(OBJECTS_MOST))
  `DO(LITERAL(CONFORMITY))
  `DO(PUT(AT_CONFORMITY))
  `DO(LITERAL(MEI_DEVICE_ID))
  `DO(PUT(AT_MEI))
  `DO(READ_TO_CLEAR(AT_OBJECT))
  `DO(POINT(AT_FRAME))
  `DO(WALK_UP(AT_OBJECT))
  `DO(GO(SENDING))
`END_ROUTINE
