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
  parameter FUNCTION_CODES      = 32'h00C1807E,  // bit n: function code n is built in
  parameter MAX_READ_BITS       = 2000,          // 1..2000
  parameter MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter MAX_READ_REGISTERS  = 125,           // 1..125
  parameter MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter RW_MAX_WRITE        = 121            // 1..121, function code 17H
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
  localparam [7:0] READING = 8'd0, WRITING = `MB_FLAG_WRITE, KEEP = `MB_FLAG_KEEP, RELEASE = 8'd0;

  // Where the routines begin.  The table has 32 entries, one for each function code below 32.
  localparam integer START = 0, EXCEPTION = 5, ECHO = 12, ANSWER = 15, ILLEGAL = 20,
                   TABLE = 32, READ_COILS = 64, READ_DISCRETES = 73, READ_HOLDINGS = 82,
                   READ_INPUTS = 91, WRITE_COIL = 100, WRITE_REGISTER = 112, WRITE_COILS = 124,
                   WRITE_REGISTERS = 135, MASK_WRITE = 146, READ_WRITE = 177, PROGRAM_END = 206;

  // The steps in writing: one without argument, with a number, with a place in the frame, with a space
  function [15:0] plain(input [4:0] step);
    plain = {step, 11'd0};
  endfunction
  function [15:0] number(input [4:0] step, input [10:0] value);
    number = {step, value};
  endfunction
  function [15:0] at(input [4:0] step, input [3:0] place);
    at = {step, 7'd0, place};
  endfunction
  function [15:0] clear_at(input [3:0] place);
    clear_at = {`MB_STEP_POINT, 3'd0, `MB_FLAG_CLEAR | {4'd0, place}};
  endfunction
  function [15:0] bank(input [4:0] step, input [2:0] space, input [7:0] flags);
    bank = {step, space, flags};
  endfunction
  function [15:0] go(input integer target);
    go = {`MB_STEP_JUMP, 3'd0, target[7:0]};
  endfunction
  function [15:0] load(input [1:0] what, input flag, input [3:0] place);
    load = {`MB_STEP_LOAD, 4'd0, flag, what, place};
  endfunction

  localparam [15:0] NONE = {`MB_STEP_RAISE, 7'd0, `MB_EX_ILLEGAL_FUNCTION};

  // For us?  The two check bytes leave the count before the fields are taken.
  function [15:0] start(input integer n);
    case (n)
      0: start = at(`MB_STEP_POINT, 4'd0);
      1: start = at(`MB_STEP_FORGET, 4'd2);
      2: start = at(`MB_STEP_POINT, 4'd0);
      3: start = plain(`MB_STEP_ADDRESSED);
      default: start = plain(`MB_STEP_FUNCTION);
    endcase
  endfunction

  // Function code with bit 7 set, exception code (V1.1b3, clause 7)
  function [15:0] exception(input integer n);
    case (n)
      0: exception = clear_at(4'd0);
      1: exception = at(`MB_STEP_COUNT, AT_FUNCTION);
      2: exception = load(`MB_LOAD_BYTE, 1'b1, AT_FUNCTION);
      3: exception = plain(`MB_STEP_PUT);
      4: exception = load(`MB_LOAD_STATUS, 1'b1, AT_CODE);
      5: exception = plain(`MB_STEP_PUT);
      default: exception = plain(`MB_STEP_SEND);
    endcase
  endfunction

  // The head of the request is the answer.
  function [15:0] echo(input integer n, input [3:0] place);
    case (n)
      0: echo = clear_at(4'd0);
      1: echo = at(`MB_STEP_COUNT, place);
      default: echo = plain(`MB_STEP_SEND);
    endcase
  endfunction

  // The data stand at AT_READ_DATA and count is their number: put it before them.
  function [15:0] answer(input integer n);
    case (n)
      0: answer = load(`MB_LOAD_STATUS, 1'b0, AT_BYTE_COUNT);
      1: answer = plain(`MB_STEP_PUT);
      2: answer = at(`MB_STEP_POINT, 4'd0);
      3: answer = at(`MB_STEP_COUNT, AT_BYTE_COUNT);
      default: answer = plain(`MB_STEP_SEND);
    endcase
  endfunction

  // 01 02 03 04: function, address, quantity
  function [15:0] read_items(input integer n, input [2:0] space, input [10:0] highest);
    case (n)
      0: read_items = plain(`MB_STEP_UNICAST);
      1: read_items = plain(`MB_STEP_ADDRESS);
      2: read_items = number(`MB_STEP_QUANTITY, highest);
      3: read_items = plain(`MB_STEP_END);
      4: read_items = plain(`MB_STEP_RANGE);
      5: read_items = bank(`MB_STEP_GRANT, space, READING);
      6: read_items = clear_at(AT_READ_DATA);
      7: read_items = bank(`MB_STEP_READ, space, RELEASE);
      default: read_items = go(ANSWER);
    endcase
  endfunction

  // 05 06: function, address, value
  function [15:0] write_item(input integer n, input [2:0] space);
    case (n)
      0: write_item = plain(`MB_STEP_ADDRESS);
      1: write_item = (space == COILS) ? plain(`MB_STEP_COIL) : at(`MB_STEP_FORGET, AT_VALUE_END);
      2: write_item = plain(`MB_STEP_END);
      3: write_item = plain(`MB_STEP_SINGLE);
      4: write_item = plain(`MB_STEP_RANGE);
      5: write_item = bank(`MB_STEP_GRANT, space, WRITING);
      6: write_item = at(`MB_STEP_POINT, AT_VALUE);
      7: write_item = bank(`MB_STEP_WRITE, space, RELEASE);
      8: write_item = at(`MB_STEP_POINT, AT_ADDRESS);
      9: write_item = plain(`MB_STEP_ADDRESS);
      10: write_item = bank(`MB_STEP_WRITTEN, space, 8'd0);
      default: write_item = go(ECHO);
    endcase
  endfunction

  // 0F 10: function, address, quantity, byte count, data
  function [15:0] write_items(input integer n, input [2:0] space, input [10:0] highest);
    case (n)
      0: write_items = plain(`MB_STEP_ADDRESS);
      1: write_items = number(`MB_STEP_QUANTITY, highest);
      2: write_items = bank(`MB_STEP_BYTE_COUNT, space, 8'd0);
      3: write_items = plain(`MB_STEP_RANGE);
      4: write_items = bank(`MB_STEP_GRANT, space, WRITING);
      5: write_items = at(`MB_STEP_POINT, AT_DATA);
      6: write_items = bank(`MB_STEP_WRITE, space, RELEASE);
      7: write_items = at(`MB_STEP_POINT, AT_ADDRESS);
      8: write_items = plain(`MB_STEP_ADDRESS);
      9: write_items = bank(`MB_STEP_WRITTEN, space, 8'd0);
      default: write_items = go(ECHO);
    endcase
  endfunction

  // 16: function, address, AND mask, OR mask.  register' = and ? register : or, bit by bit, which is
  // ((register ^ or) & and) ^ or: one byte at a time in the scratch place, old and new under one bus cycle.
  function [15:0] mask_write(input integer n);
    case (n)
      0: mask_write = plain(`MB_STEP_UNICAST);
      1: mask_write = plain(`MB_STEP_ADDRESS);
      2: mask_write = at(`MB_STEP_FORGET, AT_MASK_END);
      3: mask_write = plain(`MB_STEP_END);
      4: mask_write = plain(`MB_STEP_SINGLE);
      5: mask_write = plain(`MB_STEP_RANGE);
      6: mask_write = bank(`MB_STEP_GRANT, HOLDINGS, WRITING);
      7: mask_write = at(`MB_STEP_POINT, AT_SCRATCH);
      8: mask_write = bank(`MB_STEP_READ, HOLDINGS, KEEP);
      9: mask_write = load(`MB_LOAD_BYTE, 1'b0, AT_SCRATCH);
      10: mask_write = load(`MB_LOAD_XOR, 1'b0, AT_OR_MASK);
      11: mask_write = load(`MB_LOAD_AND, 1'b0, AT_AND_MASK);
      12: mask_write = load(`MB_LOAD_XOR, 1'b0, AT_OR_MASK);
      13: mask_write = at(`MB_STEP_POINT, AT_SCRATCH);
      14: mask_write = plain(`MB_STEP_PUT);
      15: mask_write = load(`MB_LOAD_BYTE, 1'b0, AT_SCRATCH + 4'd1);
      16: mask_write = load(`MB_LOAD_XOR, 1'b0, AT_OR_MASK + 4'd1);
      17: mask_write = load(`MB_LOAD_AND, 1'b0, AT_AND_MASK + 4'd1);
      18: mask_write = load(`MB_LOAD_XOR, 1'b0, AT_OR_MASK + 4'd1);
      19: mask_write = at(`MB_STEP_POINT, AT_SCRATCH + 4'd1);
      20: mask_write = plain(`MB_STEP_PUT);
      21: mask_write = at(`MB_STEP_POINT, AT_ADDRESS);
      22: mask_write = plain(`MB_STEP_ADDRESS);
      23: mask_write = at(`MB_STEP_POINT, AT_SCRATCH);
      24: mask_write = bank(`MB_STEP_WRITE, HOLDINGS, RELEASE);
      25: mask_write = at(`MB_STEP_POINT, AT_ADDRESS);
      26: mask_write = plain(`MB_STEP_ADDRESS);
      27: mask_write = bank(`MB_STEP_WRITTEN, HOLDINGS, 8'd0);
      default: mask_write = echo(n - 28, AT_MASK_END);
    endcase
  endfunction

  // 17: function, read address, read quantity, write address, write quantity, byte count, data.
  // Both ranges are granted before the first write; the write comes first (clause 6.17), under one bus cycle.
  function [15:0] read_write(input integer n);
    case (n)
      0: read_write = plain(`MB_STEP_UNICAST);
      1: read_write = plain(`MB_STEP_ADDRESS);
      2: read_write = number(`MB_STEP_QUANTITY, RW_MAX_READ[10:0]);
      3: read_write = plain(`MB_STEP_ADDRESS);
      4: read_write = number(`MB_STEP_QUANTITY, RW_MAX_WRITE[10:0]);
      5: read_write = bank(`MB_STEP_BYTE_COUNT, HOLDINGS, 8'd0);
      6: read_write = plain(`MB_STEP_RANGE);
      7: read_write = bank(`MB_STEP_GRANT, HOLDINGS, WRITING);
      8: read_write = at(`MB_STEP_POINT, AT_ADDRESS);
      9: read_write = plain(`MB_STEP_ADDRESS);
      10: read_write = number(`MB_STEP_QUANTITY, RW_MAX_READ[10:0]);
      11: read_write = plain(`MB_STEP_RANGE);
      12: read_write = bank(`MB_STEP_GRANT, HOLDINGS, READING);
      13: read_write = plain(`MB_STEP_ADDRESS);
      14: read_write = number(`MB_STEP_QUANTITY, RW_MAX_WRITE[10:0]);
      15: read_write = plain(`MB_STEP_RANGE);
      16: read_write = at(`MB_STEP_POINT, AT_RW_DATA);
      17: read_write = bank(`MB_STEP_WRITE, HOLDINGS, KEEP);
      18: read_write = at(`MB_STEP_POINT, AT_RW_WRITE);
      19: read_write = plain(`MB_STEP_ADDRESS);
      20: read_write = bank(`MB_STEP_WRITTEN, HOLDINGS, 8'd0);
      21: read_write = at(`MB_STEP_POINT, AT_ADDRESS);
      22: read_write = plain(`MB_STEP_ADDRESS);
      23: read_write = number(`MB_STEP_QUANTITY, RW_MAX_READ[10:0]);
      24: read_write = plain(`MB_STEP_RANGE);
      25: read_write = clear_at(AT_READ_DATA);
      26: read_write = bank(`MB_STEP_READ, HOLDINGS, RELEASE);
      default: read_write = go(ANSWER);
    endcase
  endfunction

  // One entry for each function code
  function [15:0] entry(input integer code);
    begin
      entry = NONE;
      if (FUNCTION_CODES[code])
        case (code[7:0])
          `MB_FC_READ_COILS:               entry = go(READ_COILS);
          `MB_FC_READ_DISCRETE_INPUTS:     entry = go(READ_DISCRETES);
          `MB_FC_READ_HOLDING_REGISTERS:   entry = go(READ_HOLDINGS);
          `MB_FC_READ_INPUT_REGISTERS:     entry = go(READ_INPUTS);
          `MB_FC_WRITE_SINGLE_COIL:        entry = go(WRITE_COIL);
          `MB_FC_WRITE_SINGLE_REGISTER:    entry = go(WRITE_REGISTER);
          `MB_FC_WRITE_MULTIPLE_COILS:     entry = go(WRITE_COILS);
          `MB_FC_WRITE_MULTIPLE_REGISTERS: entry = go(WRITE_REGISTERS);
          `MB_FC_MASK_WRITE_REGISTER:      entry = go(MASK_WRITE);
          `MB_FC_READ_WRITE_REGISTERS:     entry = go(READ_WRITE);
          default:                         entry = NONE;
        endcase
    end
  endfunction

  function [15:0] content(input integer n);
    begin
      content = NONE;
      if (n < EXCEPTION)             content = start(n - START);
      else if (n < ECHO)             content = exception(n - EXCEPTION);
      else if (n < ANSWER)           content = echo(n - ECHO, AT_VALUE_END);
      else if (n < ILLEGAL)          content = answer(n - ANSWER);
      else if (n < TABLE)            content = NONE;
      else if (n < READ_COILS)       content = entry(n - TABLE);
      else if (n < READ_DISCRETES)   content = read_items(n - READ_COILS, COILS, MAX_READ_BITS[10:0]);
      else if (n < READ_HOLDINGS)    content = read_items(n - READ_DISCRETES, DISCRETES, MAX_READ_BITS[10:0]);
      else if (n < READ_INPUTS)      content = read_items(n - READ_HOLDINGS, HOLDINGS, MAX_READ_REGISTERS[10:0]);
      else if (n < WRITE_COIL)       content = read_items(n - READ_INPUTS, INPUTS, MAX_READ_REGISTERS[10:0]);
      else if (n < WRITE_REGISTER)   content = write_item(n - WRITE_COIL, COILS);
      else if (n < WRITE_COILS)      content = write_item(n - WRITE_REGISTER, HOLDINGS);
      else if (n < WRITE_REGISTERS)  content = write_items(n - WRITE_COILS, COILS, MAX_WRITE_BITS[10:0]);
      else if (n < MASK_WRITE)       content = write_items(n - WRITE_REGISTERS, HOLDINGS, MAX_WRITE_REGISTERS[10:0]);
      else if (n < READ_WRITE)       content = mask_write(n - MASK_WRITE);
      else if (n < PROGRAM_END)      content = read_write(n - READ_WRITE);
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
