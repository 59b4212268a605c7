// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_routines_data - function codes 01-06 0F 10 16 17 18, coils and registers; part of modbus_program.

// 01 02 03 04: function, address, quantity
function [15:0] in_space(input integer n, input [2:0] space, input [8:0] target);
  in_space = (n == 0) ? address(space) : go(target);
endfunction

function [15:0] read_bits(input integer n);
  read_bits = (n == 0) ? quantity(MAX_READ_BITS[10:0]) : go(READ[8:0]);
endfunction

function [15:0] read(input integer n);
  case (n)
    0: read = plain(`MB_STEP_END, NO_FLAG);
    1: read = plain(`MB_STEP_RANGE, NO_FLAG);
    2: read = plain(`MB_STEP_GRANT, NO_FLAG);
    3: read = jump(`MB_JUMP_READY, READ[8:0] + 9'd4);
    4: read = at(`MB_STEP_POINT, AT_READ_DATA, CLEAR);
    5: read = plain(`MB_STEP_BURST, NO_FLAG);
    default: read = go(ANSWER[8:0]);
  endcase
endfunction

// 05 06: function, address, value
function [15:0] write_coil(input integer n);
  case (n)
    0: write_coil = address(COILS);
    1: write_coil = plain(`MB_STEP_COIL, NO_FLAG);
    default: write_coil = go(WRITE_SINGLE[8:0]);
  endcase
endfunction

function [15:0] write_register(input integer n);
  case (n)
    0: write_register = address(HOLDINGS);
    default: write_register = at(`MB_STEP_WALK, AT_VALUE_END, NO_FLAG);
  endcase
endfunction

function [15:0] write_single(input integer n);
  case (n)
    0: write_single = plain(`MB_STEP_END, NO_FLAG);
    1: write_single = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
    2: write_single = plain(`MB_STEP_GRANT, WRITE);
    3: write_single = jump(`MB_JUMP_READY, WRITE_SINGLE[8:0] + 9'd4);
    4: write_single = at(`MB_STEP_POINT, AT_VALUE, NO_FLAG);
    5: write_single = plain(`MB_STEP_BURST, WRITE);
    default: write_single = go(WRITTEN[8:0]);
  endcase
endfunction

// 0F 10: function, address, quantity, byte count, data
function [15:0] write_coils(input integer n);
  case (n)
    0: write_coils = address(COILS);
    1: write_coils = quantity(MAX_WRITE_BITS[10:0]);
    default: write_coils = go(WRITE_MULTIPLE[8:0]);
  endcase
endfunction

function [15:0] write_registers(input integer n);
  case (n)
    0: write_registers = address(HOLDINGS);
    default: write_registers = quantity(MAX_WRITE_REGISTERS[10:0]);
  endcase
endfunction

function [15:0] write_multiple(input integer n);
  case (n)
    0: write_multiple = plain(`MB_STEP_BYTE_COUNT, `MB_FLAG_FIT);
    1: write_multiple = plain(`MB_STEP_RANGE, NO_FLAG);
    2: write_multiple = plain(`MB_STEP_GRANT, WRITE);
    3: write_multiple = jump(`MB_JUMP_READY, WRITE_MULTIPLE[8:0] + 9'd4);
    4: write_multiple = at(`MB_STEP_POINT, AT_DATA, NO_FLAG);
    default: write_multiple = plain(`MB_STEP_BURST, WRITE);
  endcase
endfunction

// The first address has moved on with the burst.
function [15:0] written(input integer n);
  case (n)
    0: written = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    1: written = plain(`MB_STEP_ADDRESS, NO_FLAG);
    2: written = plain(`MB_STEP_RANGE, `MB_FLAG_WRITTEN);
    default: written = go(ECHO[8:0]);
  endcase
endfunction

// 16: function, address, AND mask, OR mask.  register' = and ? register : or, bit by bit, which is
// ((register ^ or) & and) ^ or: one byte at a time in the scratch place, old and new under one bus cycle.
function [15:0] mask_write(input integer n);
  case (n)
    0: mask_write = address(HOLDINGS);
    1: mask_write = at(`MB_STEP_WALK, AT_MASK_END, NO_FLAG);
    2: mask_write = plain(`MB_STEP_END, NO_FLAG);
    3: mask_write = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
    4: mask_write = plain(`MB_STEP_GRANT, WRITE);
    5: mask_write = jump(`MB_JUMP_READY, MASK_WRITE[8:0] + 9'd6);
    6: mask_write = at(`MB_STEP_POINT, AT_SCRATCH, NO_FLAG);
    7: mask_write = plain(`MB_STEP_BURST, KEEP);
    8: mask_write = load(`MB_LOAD_BYTE, AT_SCRATCH, NO_FLAG);
    9: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK, NO_FLAG);
    10: mask_write = load(`MB_LOAD_AND, AT_AND_MASK, NO_FLAG);
    11: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK, NO_FLAG);
    12: mask_write = at(`MB_STEP_PUT, AT_SCRATCH, NO_FLAG);
    13: mask_write = load(`MB_LOAD_BYTE, AT_SCRATCH + 5'd1, NO_FLAG);
    14: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK + 5'd1, NO_FLAG);
    15: mask_write = load(`MB_LOAD_AND, AT_AND_MASK + 5'd1, NO_FLAG);
    16: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK + 5'd1, NO_FLAG);
    17: mask_write = at(`MB_STEP_PUT, AT_SCRATCH + 5'd1, NO_FLAG);
    18: mask_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    19: mask_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    20: mask_write = at(`MB_STEP_POINT, AT_SCRATCH, NO_FLAG);
    21: mask_write = plain(`MB_STEP_BURST, WRITE);
    22: mask_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    23: mask_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    24: mask_write = plain(`MB_STEP_RANGE, `MB_FLAG_WRITTEN);
    default: mask_write = echo(n - 25, AT_MASK_END);
  endcase
endfunction

// 17: function, read address, read quantity, write address, write quantity, byte count, data.
// Both ranges are granted before the first write; the write comes first (clause 6.17), under one bus cycle.
function [15:0] read_write(input integer n);
  case (n)
    0: read_write = address(HOLDINGS);
    1: read_write = quantity(RW_MAX_READ[10:0]);
    2: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    3: read_write = quantity(RW_MAX_WRITE[10:0]);
    4: read_write = plain(`MB_STEP_BYTE_COUNT, `MB_FLAG_FIT);
    5: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
    6: read_write = plain(`MB_STEP_GRANT, WRITE);
    7: read_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    8: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    9: read_write = quantity(RW_MAX_READ[10:0]);
    10: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
    11: read_write = plain(`MB_STEP_GRANT, NO_FLAG);
    12: read_write = jump(`MB_JUMP_READY, READ_WRITE[8:0] + 9'd13);
    13: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    14: read_write = quantity(RW_MAX_WRITE[10:0]);
    15: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
    16: read_write = at(`MB_STEP_POINT, AT_RW_DATA, NO_FLAG);
    17: read_write = plain(`MB_STEP_BURST, WRITE | KEEP);
    18: read_write = at(`MB_STEP_POINT, AT_RW_WRITE, NO_FLAG);
    19: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    20: read_write = plain(`MB_STEP_RANGE, `MB_FLAG_WRITTEN);
    21: read_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    22: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
    23: read_write = quantity(RW_MAX_READ[10:0]);
    24: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
    25: read_write = at(`MB_STEP_POINT, AT_READ_DATA, CLEAR);
    26: read_write = plain(`MB_STEP_BURST, NO_FLAG);
    default: read_write = go(ANSWER[8:0]);
  endcase
endfunction

// 18: function, address of the count.  The count is read first; then count and entries are granted and read in one
// burst, all under one bus cycle.
function [15:0] read_fifo(input integer n);
  case (n)
    0: read_fifo = address(HOLDINGS);
    1: read_fifo = plain(`MB_STEP_END, NO_FLAG);
    2: read_fifo = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
    3: read_fifo = plain(`MB_STEP_GRANT, NO_FLAG);
    4: read_fifo = at(`MB_STEP_POINT, AT_FIFO, NO_FLAG);
    5: read_fifo = plain(`MB_STEP_BURST, KEEP);
    6: read_fifo = at(`MB_STEP_POINT, AT_FIFO, NO_FLAG);
    7: read_fifo = {`MB_STEP_DEPTH, 11'd0 - FIFO_MOST - 11'd1};
    8: read_fifo = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
    9: read_fifo = plain(`MB_STEP_ADDRESS, NO_FLAG);
    10: read_fifo = plain(`MB_STEP_RANGE, NO_FLAG);
    11: read_fifo = plain(`MB_STEP_GRANT, NO_FLAG);
    12: read_fifo = jump(`MB_JUMP_READY, READ_FIFO[8:0] + 9'd13);
    13: read_fifo = at(`MB_STEP_POINT, AT_FIFO, CLEAR);
    14: read_fifo = plain(`MB_STEP_BURST, NO_FLAG);
    15: read_fifo = status(`MB_STATUS_COUNT);
    16: read_fifo = at(`MB_STEP_PUT, AT_FIFO_BYTES + 5'd1, NO_FLAG);
    17: read_fifo = plain(`MB_STEP_LITERAL, 11'd0);
    18: read_fifo = at(`MB_STEP_PUT, AT_FIFO_BYTES, NO_FLAG);
    19: read_fifo = at(`MB_STEP_POINT, AT_FRAME, NO_FLAG);
    20: read_fifo = at(`MB_STEP_WALK, AT_FIFO_BYTES, UP);
    default: read_fifo = go(SENDING[8:0]);
  endcase
endfunction
