// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_files - function codes 14 15, file records; part of the listing of modbus_program.
//
// A group is reference type, file number, record number, quantity; 15H has the data behind it.  The passes over the
// groups are structure (03), existence (02), then the work.  RECALL brings back the first group.

// 14: function, byte count, groups.  The answer grows in the upper half: its cursor and count and those of the
// request are swapped back and forth.
`ROUTINE(READ_FILES, FUNCTION_CODES[`MB_FC_READ_FILE_RECORD])
  `DO(SPACE(FILES))
  `DO(BYTE_COUNT)
  `DO(SAVE)
  // structure
  `LOOP
  `DO(SKIP_BYTE)
  `DO(ADDRESS)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(TOTAL)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  // existence
  `LOOP
  `DO(MATCH(REFERENCE_TYPE, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(GRANT_READ)
  `DO(IF_LEFT(loop))
  `DO(NEXT_IF_READY)
  // the groups of the answer
  `DO(POINT_CLEAR(UPPER + AT_GROUPS))
  `DO(SWAP)
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(SWAP)
  `DO(PUT_STATUS_HERE(`MB_STATUS_LENGTH))
  `DO(LITERAL(REFERENCE_TYPE))
  `DO(PUT_HERE)
  `DO(READ_HERE_KEEP)
  `DO(SWAP)
  `DO(IF_LEFT(loop))
  `DO(SWAP)
  // its head
  `DO(PUT_STATUS(`MB_STATUS_COUNT, UPPER + AT_BYTE_COUNT))
  `DO(LOAD(AT_FRAME))
  `DO(PUT(UPPER))
  `DO(LOAD(AT_FUNCTION))
  `DO(PUT(UPPER + AT_FUNCTION))
  `FALL_INTO(SEND_UPPER)
`END_ROUTINE

// The answer stands in the upper half.
`ROUTINE(SEND_UPPER, HAS_UPPER != 0)
  `DO(SEND(UPPER))
  if (HAS_DIAGNOSTICS != 0) begin
    `DO(GO(TAIL))
  end else begin
    `DO(GO(DONE))
  end
`END_ROUTINE

// 15: function, byte count, groups.  The answer is the request.
`ROUTINE(WRITE_FILES, FUNCTION_CODES[`MB_FC_WRITE_FILE_RECORD])
  `DO(SPACE(FILES))
  `DO(BYTE_COUNT)
  `DO(SAVE)
  // structure
  `LOOP
  `DO(SKIP_BYTE)
  `DO(ADDRESS)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(PASS_OVER)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  // existence
  `LOOP
  `DO(MATCH(REFERENCE_TYPE, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(GRANT_WRITE)
  `DO(PASS_OVER)
  `DO(IF_LEFT(loop))
  `DO(NEXT_IF_READY)
  `DO(RECALL)
  // writing
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(WRITE_HERE_KEEP)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  // telling the host
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(TELL)
  `DO(PASS_OVER)
  `DO(IF_LEFT(loop))
  // the whole request: its groups and what stands before them
  `DO(RECALL)
  `DO(POINT(AT_FRAME))
  `DO(WALK_UP(AT_GROUPS))
  `DO(GO(SENDING))
`END_ROUTINE
