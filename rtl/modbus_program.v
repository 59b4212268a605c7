// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_program - what each function code does, step by step, in the order of checks the standard asks for.
//
// A read-only memory with registered output.  This file is the one place that knows the layout of a request and
// its limits (MODBUS Application Protocol V1.1b3, clause 6).  A new function code is a routine here and
// an entry in the table; one that is left out has the entry of an illegal one and its routine is empty.
// Checks run function (01), length and quantity (03), address (02), then execution (04, 06), all before
// the first write.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_program #(
  parameter [31:0]  FUNCTION_CODES      = 32'h00C1807E,  // bit n: function code n is built in
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121            // 1..121, function code 17H
) (
  input  wire        clk_i,
  input  wire [7:0]  at_i,        // address of a step
  output wire [15:0] step_o       // {step, argument}, one clock later
);

  generate
    if (MAX_READ_BITS < 1 || MAX_READ_BITS > 2000 || MAX_WRITE_BITS < 1 || MAX_WRITE_BITS > 1968) begin : gen_bits
      ERROR_modbus_bit_limits_are_1_to_2000_and_1_to_1968 illegal_parameter ();
    end
    if (MAX_READ_REGISTERS < 1 || MAX_READ_REGISTERS > 125 ||
        MAX_WRITE_REGISTERS < 1 || MAX_WRITE_REGISTERS > 123) begin : gen_registers
      ERROR_modbus_register_limits_are_1_to_125_and_1_to_123 illegal_parameter ();
    end
    if (RW_MAX_READ < 1 || RW_MAX_READ > 125 || RW_MAX_WRITE < 1 || RW_MAX_WRITE > 121) begin : gen_rw
      ERROR_modbus_read_write_limits_are_1_to_125_and_1_to_121 illegal_parameter ();
    end
    if ((FUNCTION_CODES & ~32'h00C1807E) != 0) begin : gen_codes
      ERROR_modbus_FUNCTION_CODES_names_a_code_that_is_not_implemented illegal_parameter ();
    end
  endgenerate

  // Bytes of a frame, the address byte being 0: request, then answer
  localparam [3:0] AT_ADDRESS = 4'd2, AT_VALUE = 4'd4, AT_VALUE_END = 4'd6, AT_DATA = 4'd7,
                   AT_AND_MASK = 4'd4, AT_OR_MASK = 4'd6, AT_MASK_END = 4'd8,
                   AT_RW_WRITE = 4'd6, AT_RW_DATA = 4'd11,
                   AT_SCRATCH = 4'd8,  // behind the PDU of function code 16H
                   AT_FUNCTION = 4'd1, AT_CODE = 4'd2, AT_BYTE_COUNT = 4'd2, AT_READ_DATA = 4'd3;

  localparam [2:0] COILS = `MB_SPACE_COILS, DISCRETES = `MB_SPACE_DISCRETES,
                   INPUTS = `MB_SPACE_INPUTS, HOLDINGS = `MB_SPACE_HOLDINGS;
  localparam [11:0] NO_FLAG = 12'd0, WRITE = `MB_FLAG_WRITE, KEEP = `MB_FLAG_KEEP;

  // Where the routines begin.  The table has 32 entries, one for each function code below 32.
  localparam integer START = 0, EXCEPTION = 5, ECHO = 12, ANSWER = 15, UNUSED = 20, TABLE = 32,
                     READ_COILS = 64, READ_DISCRETES = 72, READ_HOLDINGS = 80, READ_INPUTS = 88,
                     WRITE_COIL = 96, WRITE_REGISTER = 106, WRITE_COILS = 116, WRITE_REGISTERS = 126,
                     MASK_WRITE = 136, READ_WRITE = 162, PROGRAM_END = 188;

  // The steps in writing: plain, with a place in the frame, with a space, a load, a jump
  function [15:0] plain(input [3:0] step, input [11:0] argument);
    plain = {step, argument};
  endfunction
  function [15:0] at(input [3:0] step, input [3:0] place, input [11:0] flags);
    at = {step, flags | {8'd0, place}};
  endfunction
  function [15:0] bank(input [3:0] step, input [2:0] space, input [11:0] flags);
    bank = {step, flags | {1'b0, space, 8'd0}};
  endfunction
  function [15:0] load(input [1:0] what, input [3:0] place, input [11:0] flags);
    load = {`MB_STEP_LOAD, flags | {6'd0, what, place}};
  endfunction
  function [15:0] go(input [7:0] target, input [11:0] flags);
    go = {`MB_STEP_JUMP, flags | {4'd0, target}};
  endfunction

  // For us?  The two check bytes leave the count before the fields are taken.
  function [15:0] start(input integer n);
    case (n)
      0: start = at(`MB_STEP_POINT, 4'd0, NO_FLAG);
      1: start = at(`MB_STEP_WALK, 4'd2, NO_FLAG);
      2: start = at(`MB_STEP_POINT, 4'd0, NO_FLAG);
      3: start = plain(`MB_STEP_ADDRESSED, NO_FLAG);
      default: start = plain(`MB_STEP_FUNCTION, NO_FLAG);
    endcase
  endfunction

  // Function code with bit 7 set, exception code (V1.1b3, clause 7)
  function [15:0] exception(input integer n);
    case (n)
      0: exception = at(`MB_STEP_POINT, 4'd0, `MB_FLAG_CLEAR);
      1: exception = at(`MB_STEP_WALK, AT_FUNCTION, `MB_FLAG_UP);
      2: exception = load(`MB_LOAD_BYTE, AT_FUNCTION, `MB_FLAG_MARK);
      3: exception = at(`MB_STEP_PUT, AT_FUNCTION, NO_FLAG);
      4: exception = load(`MB_LOAD_STATUS, AT_CODE, `MB_FLAG_MARK);
      5: exception = at(`MB_STEP_PUT, AT_CODE, NO_FLAG);
      default: exception = plain(`MB_STEP_SEND, NO_FLAG);
    endcase
  endfunction

  // The head of the request, up to a place, is the answer.
  function [15:0] echo(input integer n, input [3:0] place);
    case (n)
      0: echo = at(`MB_STEP_POINT, 4'd0, `MB_FLAG_CLEAR);
      1: echo = at(`MB_STEP_WALK, place, `MB_FLAG_UP);
      default: echo = plain(`MB_STEP_SEND, NO_FLAG);
    endcase
  endfunction

  // The data stand at AT_READ_DATA and count is their number: put it before them.
  function [15:0] answer(input integer n);
    case (n)
      0: answer = load(`MB_LOAD_STATUS, AT_BYTE_COUNT, NO_FLAG);
      1: answer = at(`MB_STEP_PUT, AT_BYTE_COUNT, NO_FLAG);
      2: answer = at(`MB_STEP_POINT, 4'd0, NO_FLAG);
      3: answer = at(`MB_STEP_WALK, AT_BYTE_COUNT, `MB_FLAG_UP);
      default: answer = plain(`MB_STEP_SEND, NO_FLAG);
    endcase
  endfunction

  // 01 02 03 04: function, address, quantity
  function [15:0] read_items(input integer n, input [2:0] space, input [11:0] highest);
    case (n)
      0: read_items = plain(`MB_STEP_ADDRESS, NO_FLAG);
      1: read_items = plain(`MB_STEP_QUANTITY, highest);
      2: read_items = plain(`MB_STEP_END, NO_FLAG);
      3: read_items = plain(`MB_STEP_RANGE, NO_FLAG);
      4: read_items = bank(`MB_STEP_GRANT, space, `MB_FLAG_LAST);
      5: read_items = at(`MB_STEP_POINT, AT_READ_DATA, `MB_FLAG_CLEAR);
      6: read_items = bank(`MB_STEP_BURST, space, NO_FLAG);
      default: read_items = go(ANSWER[7:0], NO_FLAG);
    endcase
  endfunction

  // 05 06: function, address, value
  function [15:0] write_item(input integer n, input [2:0] space);
    case (n)
      0: write_item = plain(`MB_STEP_ADDRESS, NO_FLAG);
      1: write_item = (space == COILS) ? plain(`MB_STEP_COIL, NO_FLAG) : at(`MB_STEP_WALK, AT_VALUE_END, NO_FLAG);
      2: write_item = plain(`MB_STEP_END, NO_FLAG);
      3: write_item = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
      4: write_item = bank(`MB_STEP_GRANT, space, WRITE | `MB_FLAG_LAST);
      5: write_item = at(`MB_STEP_POINT, AT_VALUE, NO_FLAG);
      6: write_item = bank(`MB_STEP_BURST, space, WRITE);
      7: write_item = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      8: write_item = bank(`MB_STEP_ADDRESS, space, `MB_FLAG_WRITTEN);
      default: write_item = go(ECHO[7:0], NO_FLAG);
    endcase
  endfunction

  // 0F 10: function, address, quantity, byte count, data
  function [15:0] write_items(input integer n, input [2:0] space, input [11:0] highest);
    case (n)
      0: write_items = plain(`MB_STEP_ADDRESS, NO_FLAG);
      1: write_items = plain(`MB_STEP_QUANTITY, highest);
      2: write_items = bank(`MB_STEP_BYTE_COUNT, space, NO_FLAG);
      3: write_items = plain(`MB_STEP_RANGE, NO_FLAG);
      4: write_items = bank(`MB_STEP_GRANT, space, WRITE | `MB_FLAG_LAST);
      5: write_items = at(`MB_STEP_POINT, AT_DATA, NO_FLAG);
      6: write_items = bank(`MB_STEP_BURST, space, WRITE);
      7: write_items = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      8: write_items = bank(`MB_STEP_ADDRESS, space, `MB_FLAG_WRITTEN);
      default: write_items = go(ECHO[7:0], NO_FLAG);
    endcase
  endfunction

  // 16: function, address, AND mask, OR mask.  register' = and ? register : or, bit by bit, which is
  // ((register ^ or) & and) ^ or: one byte at a time in the scratch place, old and new under one bus cycle.
  function [15:0] mask_write(input integer n);
    case (n)
      0: mask_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      1: mask_write = at(`MB_STEP_WALK, AT_MASK_END, NO_FLAG);
      2: mask_write = plain(`MB_STEP_END, NO_FLAG);
      3: mask_write = plain(`MB_STEP_RANGE, `MB_FLAG_SINGLE);
      4: mask_write = bank(`MB_STEP_GRANT, HOLDINGS, WRITE | `MB_FLAG_LAST);
      5: mask_write = at(`MB_STEP_POINT, AT_SCRATCH, NO_FLAG);
      6: mask_write = bank(`MB_STEP_BURST, HOLDINGS, KEEP);
      7: mask_write = load(`MB_LOAD_BYTE, AT_SCRATCH, NO_FLAG);
      8: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK, NO_FLAG);
      9: mask_write = load(`MB_LOAD_AND, AT_AND_MASK, NO_FLAG);
      10: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK, NO_FLAG);
      11: mask_write = at(`MB_STEP_PUT, AT_SCRATCH, NO_FLAG);
      12: mask_write = load(`MB_LOAD_BYTE, AT_SCRATCH + 4'd1, NO_FLAG);
      13: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK + 4'd1, NO_FLAG);
      14: mask_write = load(`MB_LOAD_AND, AT_AND_MASK + 4'd1, NO_FLAG);
      15: mask_write = load(`MB_LOAD_XOR, AT_OR_MASK + 4'd1, NO_FLAG);
      16: mask_write = at(`MB_STEP_PUT, AT_SCRATCH + 4'd1, NO_FLAG);
      17: mask_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      18: mask_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      19: mask_write = at(`MB_STEP_POINT, AT_SCRATCH, NO_FLAG);
      20: mask_write = bank(`MB_STEP_BURST, HOLDINGS, WRITE);
      21: mask_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      22: mask_write = bank(`MB_STEP_ADDRESS, HOLDINGS, `MB_FLAG_WRITTEN);
      default: mask_write = echo(n - 23, AT_MASK_END);
    endcase
  endfunction

  // 17: function, read address, read quantity, write address, write quantity, byte count, data.
  // Both ranges are granted before the first write; the write comes first (clause 6.17), under one bus cycle.
  function [15:0] read_write(input integer n);
    case (n)
      0: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      1: read_write = plain(`MB_STEP_QUANTITY, RW_MAX_READ[11:0]);
      2: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      3: read_write = plain(`MB_STEP_QUANTITY, RW_MAX_WRITE[11:0]);
      4: read_write = bank(`MB_STEP_BYTE_COUNT, HOLDINGS, NO_FLAG);
      5: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
      6: read_write = bank(`MB_STEP_GRANT, HOLDINGS, WRITE);
      7: read_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      8: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      9: read_write = plain(`MB_STEP_QUANTITY, RW_MAX_READ[11:0]);
      10: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
      11: read_write = bank(`MB_STEP_GRANT, HOLDINGS, `MB_FLAG_LAST);
      12: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      13: read_write = plain(`MB_STEP_QUANTITY, RW_MAX_WRITE[11:0]);
      14: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
      15: read_write = at(`MB_STEP_POINT, AT_RW_DATA, NO_FLAG);
      16: read_write = bank(`MB_STEP_BURST, HOLDINGS, WRITE | KEEP);
      17: read_write = at(`MB_STEP_POINT, AT_RW_WRITE, NO_FLAG);
      18: read_write = bank(`MB_STEP_ADDRESS, HOLDINGS, `MB_FLAG_WRITTEN);
      19: read_write = at(`MB_STEP_POINT, AT_ADDRESS, NO_FLAG);
      20: read_write = plain(`MB_STEP_ADDRESS, NO_FLAG);
      21: read_write = plain(`MB_STEP_QUANTITY, RW_MAX_READ[11:0]);
      22: read_write = plain(`MB_STEP_RANGE, NO_FLAG);
      23: read_write = at(`MB_STEP_POINT, AT_READ_DATA, `MB_FLAG_CLEAR);
      24: read_write = bank(`MB_STEP_BURST, HOLDINGS, NO_FLAG);
      default: read_write = go(ANSWER[7:0], NO_FLAG);
    endcase
  endfunction

  // An exception raised by nobody is 01, so whatever has no routine goes there.
  localparam [15:0] ILLEGAL = {`MB_STEP_JUMP, 4'd0, EXCEPTION[7:0]};

  // One entry for each function code: where its routine is, and whether a broadcast may go there
  function [15:0] entry(input integer code);
    begin
      entry = ILLEGAL;
      if (FUNCTION_CODES[code])
        case (code)
          `MB_FC_READ_COILS:               entry = go(READ_COILS[7:0], `MB_FLAG_UNICAST);
          `MB_FC_READ_DISCRETE_INPUTS:     entry = go(READ_DISCRETES[7:0], `MB_FLAG_UNICAST);
          `MB_FC_READ_HOLDING_REGISTERS:   entry = go(READ_HOLDINGS[7:0], `MB_FLAG_UNICAST);
          `MB_FC_READ_INPUT_REGISTERS:     entry = go(READ_INPUTS[7:0], `MB_FLAG_UNICAST);
          `MB_FC_WRITE_SINGLE_COIL:        entry = go(WRITE_COIL[7:0], NO_FLAG);
          `MB_FC_WRITE_SINGLE_REGISTER:    entry = go(WRITE_REGISTER[7:0], NO_FLAG);
          `MB_FC_WRITE_MULTIPLE_COILS:     entry = go(WRITE_COILS[7:0], NO_FLAG);
          `MB_FC_WRITE_MULTIPLE_REGISTERS: entry = go(WRITE_REGISTERS[7:0], NO_FLAG);
          `MB_FC_MASK_WRITE_REGISTER:      entry = go(MASK_WRITE[7:0], `MB_FLAG_UNICAST);
          `MB_FC_READ_WRITE_REGISTERS:     entry = go(READ_WRITE[7:0], `MB_FLAG_UNICAST);
          default:                         entry = ILLEGAL;
        endcase
    end
  endfunction

  // Where a routine is left out its place is empty, so that a memory made of logic shrinks too.
  function [15:0] built(input integer code, input [15:0] step);
    built = (((FUNCTION_CODES >> code) & 1) != 0) ? step : ILLEGAL;
  endfunction

  function [15:0] content(input integer n);
    begin
      content = ILLEGAL;
      if (n < EXCEPTION)            content = start(n - START);
      else if (n < ECHO)            content = exception(n - EXCEPTION);
      else if (n < ANSWER)          content = echo(n - ECHO, AT_VALUE_END);
      else if (n < UNUSED)          content = answer(n - ANSWER);
      else if (n < TABLE)           content = ILLEGAL;
      else if (n < READ_COILS)      content = entry(n - TABLE);
      else if (n < READ_DISCRETES)  content = built(1, read_items(n - READ_COILS, COILS, MAX_READ_BITS[11:0]));
      else if (n < READ_HOLDINGS)   content = built(2, read_items(n - READ_DISCRETES, DISCRETES, MAX_READ_BITS[11:0]));
      else if (n < READ_INPUTS)     content = built(3, read_items(n - READ_HOLDINGS, HOLDINGS, MAX_READ_REGISTERS[11:0]));
      else if (n < WRITE_COIL)      content = built(4, read_items(n - READ_INPUTS, INPUTS, MAX_READ_REGISTERS[11:0]));
      else if (n < WRITE_REGISTER)  content = built(5, write_item(n - WRITE_COIL, COILS));
      else if (n < WRITE_COILS)     content = built(6, write_item(n - WRITE_REGISTER, HOLDINGS));
      else if (n < WRITE_REGISTERS) content = built(15, write_items(n - WRITE_COILS, COILS, MAX_WRITE_BITS[11:0]));
      else if (n < MASK_WRITE)      content = built(16, write_items(n - WRITE_REGISTERS, HOLDINGS, MAX_WRITE_REGISTERS[11:0]));
      else if (n < READ_WRITE)      content = built(22, mask_write(n - MASK_WRITE));
      else if (n < PROGRAM_END)     content = built(23, read_write(n - READ_WRITE));
    end
  endfunction

  reg [15:0] memory [0:255];
  reg [15:0] step_q;
  integer i;

  initial for (i = 0; i < 256; i = i + 1) memory[i] = content(i);

  always @(posedge clk_i) step_q <= memory[at_i];

  assign step_o = step_q;

endmodule

`default_nettype wire
