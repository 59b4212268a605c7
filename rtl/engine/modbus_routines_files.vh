// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_files - function codes 14 15, file records; part of the listing.


// 11: function.  The additional data stand behind the identifier, where the burst has left off.
`ROUTINE(SERVER_ID_ANSWER, FUNCTION_CODES[17])
  `DO(END)
  `DO(SPACE(TEXTS))
  `DO(FIRST(`MB_TEXT_SERVER_ID))
  `DO(ITEMS(SERVER_ID_BYTES))
  `DO(RANGE)
  `DO(POINT_CLEAR(AT_READ_DATA))
  `DO(READ_BURST)
  `DO(STATUS(`MB_STATUS_RUN))
  `DO(PUT_HERE)
  if (ADDITIONAL_DATA_BYTES > 0) begin
    `DO(ITEMS(ADDITIONAL_DATA_BYTES))
    `DO(RANGE)
    `DO(READ_BURST)
  end
  `DO(GO(ANSWER))
`END_ROUTINE

// A group is reference type, file number, record number, quantity; 15H has the data behind it.  Every pass over the
// groups begins with the request as it came: structure (03), then existence (02), then the work.

// 14: function, byte count, groups.  The answer grows in the upper half: its cursor and count and those of the
// request are swapped back and forth.
`ROUTINE(READ_FILES, FUNCTION_CODES[20])
  `DO(SPACE(FILES))
  `DO(BYTE_COUNT)
  // structure
  `LOOP
  `DO(SKIP_BYTE)
  `DO(ADDRESS)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(TOTAL)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  `DO(WALK(AT_GROUPS))
  // existence
  `LOOP
  `DO(MATCH(8'h06, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(RANGE_OF_FILE)
  `DO(GRANT_READ)
  `DO(IF_LEFT(loop))
  `DO(GO_IF_READY(`NEXT))
  // the answer: begins with the request at its first group
  `DO(RECALL)
  `DO(WALK(AT_GROUPS))
  `DO(SWAP)
  `DO(POINT_CLEAR(UPPER + AT_GROUPS))
  `DO(SWAP)
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_READ_MOST))
  `DO(RANGE)
  `DO(SWAP)
  `DO(STATUS(`MB_STATUS_LENGTH))
  `DO(PUT_HERE)
  `DO(LITERAL(8'h06))
  `DO(PUT_HERE)
  `DO(READ_BURST_KEEP)
  `DO(SWAP)
  `DO(IF_LEFT(loop))
  `DO(SWAP)
  // its head
  `DO(STATUS(`MB_STATUS_COUNT))
  `DO(PUT(UPPER + AT_BYTE_COUNT))
  `DO(LOAD(AT_FRAME))
  `DO(PUT(UPPER))
  `DO(LOAD(AT_FUNCTION))
  `DO(PUT(UPPER + AT_FUNCTION))
  `DO(SEND(UPPER))
  if (HAS_DIAGNOSTICS != 0) begin
    `DO(GO(TAIL))
  end else begin
    `DO(GO(DONE))
  end
`END_ROUTINE

// 15: function, byte count, groups.  The answer is the request.
`ROUTINE(WRITE_FILES, FUNCTION_CODES[21])
  `DO(SPACE(FILES))
  `DO(BYTE_COUNT)
  // structure
  `LOOP
  `DO(SKIP_BYTE)
  `DO(ADDRESS)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(FIRST(8'd0))                       // not a matter of addresses yet
  `DO(RANGE)
  `DO(DRY_BURST)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  `DO(WALK(AT_GROUPS))
  // existence
  `LOOP
  `DO(MATCH(8'h06, `MB_EX_ILLEGAL_DATA_ADDRESS))
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(RANGE_OF_FILE)
  `DO(GRANT_WRITE)
  `DO(DRY_BURST)
  `DO(IF_LEFT(loop))
  `DO(GO_IF_READY(`NEXT))
  `DO(RECALL)
  `DO(WALK(AT_GROUPS))
  // the writing
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(RANGE)
  `DO(WRITE_BURST_KEEP)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  `DO(WALK(AT_GROUPS))
  // telling the host
  `LOOP
  `DO(SKIP_BYTE)
  `DO(FILE)
  `DO(ADDRESS)
  `DO(QUANTITY(FILE_WRITE_MOST))
  `DO(RANGE_WRITTEN)
  `DO(DRY_BURST)
  `DO(IF_LEFT(loop))
  `DO(RECALL)
  `DO(GO(SENDING))
`END_ROUTINE

// 16: function, address, AND mask, OR mask.  register' = and ? register : or, bit by bit, which is
// ((register ^ or) & and) ^ or: one byte at a time in the scratch place, old and new under one bus cycle.
`ROUTINE(MASK_WRITE, FUNCTION_CODES[22])
  `DO(ADDRESS_IN(HOLDINGS))
  `DO(WALK(AT_MASK_END))
  `DO(END)
  `DO(RANGE_OF_ONE)
  `DO(GRANT_WRITE)
  `DO(GO_IF_READY(`NEXT))
  `DO(POINT(AT_SCRATCH))
  `DO(READ_BURST_KEEP)
  `DO(LOAD(AT_SCRATCH))
  `DO(XOR(AT_OR_MASK))
  `DO(AND(AT_AND_MASK))
  `DO(XOR(AT_OR_MASK))
  `DO(PUT(AT_SCRATCH))
  `DO(LOAD(AT_SCRATCH + 5'd1))
  `DO(XOR(AT_OR_MASK + 5'd1))
  `DO(AND(AT_AND_MASK + 5'd1))
  `DO(XOR(AT_OR_MASK + 5'd1))
  `DO(PUT(AT_SCRATCH + 5'd1))
  `DO(POINT(AT_ADDRESS))
  `DO(ADDRESS)
  `DO(POINT(AT_SCRATCH))
  `DO(WRITE_BURST)
  `DO(POINT(AT_ADDRESS))
  `DO(ADDRESS)
  `DO(RANGE_WRITTEN)
  `DO(POINT_CLEAR(AT_FRAME))
  `DO(WALK_UP(AT_MASK_END))
  `DO(GO(SENDING))
`END_ROUTINE

// 17: function, read address, read quantity, write address, write quantity, byte count, data.
// Both ranges are granted before the first write; the write comes first (clause 6.17), under one bus cycle.
`ROUTINE(READ_WRITE, FUNCTION_CODES[23])
  `DO(ADDRESS_IN(HOLDINGS))
  `DO(QUANTITY(RW_MAX_READ[10:0]))
  `DO(ADDRESS)
  `DO(QUANTITY(RW_MAX_WRITE[10:0]))
  `DO(BYTE_COUNT_FITS)
  `DO(RANGE)
  `DO(GRANT_WRITE)
  `DO(POINT(AT_ADDRESS))
  `DO(ADDRESS)
  `DO(QUANTITY(RW_MAX_READ[10:0]))
  `DO(RANGE)
  `DO(GRANT_READ)
  `DO(GO_IF_READY(`NEXT))
  `DO(ADDRESS)
  `DO(QUANTITY(RW_MAX_WRITE[10:0]))
  `DO(RANGE)
  `DO(POINT(AT_RW_DATA))
  `DO(WRITE_BURST_KEEP)
  `DO(POINT(AT_RW_WRITE))
  `DO(ADDRESS)
  `DO(RANGE_WRITTEN)
  `DO(POINT(AT_ADDRESS))
  `DO(ADDRESS)
  `DO(QUANTITY(RW_MAX_READ[10:0]))
  `DO(RANGE)
  `DO(POINT_CLEAR(AT_READ_DATA))
  `DO(READ_BURST)
  `DO(GO(ANSWER))
`END_ROUTINE

// 18: function, address of the count.  The count is read first; then count and entries are granted and read in one
// burst, all under one bus cycle.
`ROUTINE(READ_FIFO, FUNCTION_CODES[24])
  `DO(ADDRESS_IN(HOLDINGS))
  `DO(END)
  `DO(RANGE_OF_ONE)
  `DO(GRANT_READ)
  `DO(POINT(AT_FIFO))
  `DO(READ_BURST_KEEP)
  `DO(POINT(AT_FIFO))
  `DO(DEPTH(FIFO_MOST))
  `DO(POINT(AT_ADDRESS))
  `DO(ADDRESS)
  `DO(RANGE)
  `DO(GRANT_READ)
  `DO(GO_IF_READY(`NEXT))
  `DO(POINT_CLEAR(AT_FIFO))
  `DO(READ_BURST)
  `DO(STATUS(`MB_STATUS_COUNT))
  `DO(PUT(AT_FIFO_BYTES + 5'd1))
  `DO(LITERAL(8'h00))
  `DO(PUT(AT_FIFO_BYTES))
  `DO(POINT(AT_FRAME))
  `DO(WALK_UP(AT_FIFO_BYTES))
  `DO(GO(SENDING))
`END_ROUTINE
