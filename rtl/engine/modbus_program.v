// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_program - what each function code does, step by step, in the order of checks the standard asks for.
//
// A read-only memory with registered output.  This file is the one place that knows the layout of a request and
// its limits (MODBUS Application Protocol V1.1b3, clause 6; MODBUS over Serial Line V1.02, appendix A for what is
// counted and logged).  A new function code is a routine here and an entry in the table; one that is left out has
// the entry of an illegal one and takes no room.  Checks run function (01), length and quantity (03), address (02),
// then execution (04, 06), all before the first write.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_program #(
  parameter [63:0]  FUNCTION_CODES      = 64'h0000080001F399FE,  // bit n: function code n is built in
  parameter [127:0] USER_CODES          = 128'd0,        // bit n: function code n is offered to the user
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
  parameter integer SERVER_ID_BYTES     = 1,             // function code 11H
  parameter integer ADDITIONAL_DATA_BYTES = 0,
  parameter [7:0]   CONFORMITY          = 8'h81          // function code 2BH
) (
  input  wire        clk_i,
  input  wire [8:0]  at_i,        // address of a step
  output wire [15:0] step_o,      // {step, argument}, one clock later

  // Constants: where routines begin that modbus_dispatch itself goes to
  output wire [8:0]  start_o,     // a good frame
  output wire [8:0]  foreign_o,   // a good one for somebody else
  output wire [8:0]  bad_o,       // a bad one
  output wire [8:0]  exception_o, // a step went wrong
  output wire [8:0]  reset_o
);

`include "modbus_features.vh"

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
    if ((FUNCTION_CODES & ~64'h0000080001F399FE) != 0) begin : gen_codes
      ERROR_modbus_FUNCTION_CODES_names_a_code_that_is_not_implemented illegal_parameter ();
    end
  endgenerate

  // Bytes of a frame, the address byte being 0: request, then answer
  localparam [4:0] AT_ADDRESS = 5'd2, AT_VALUE = 5'd4, AT_VALUE_END = 5'd6, AT_DATA = 5'd7,
                   AT_AND_MASK = 5'd4, AT_OR_MASK = 5'd6, AT_MASK_END = 5'd8,
                   AT_RW_WRITE = 5'd6, AT_RW_DATA = 5'd11,
                   AT_SCRATCH = 5'd8,  // behind the PDU of function code 16H
                   AT_FRAME = 5'd0, AT_CHECKED = 5'd2, AT_FUNCTION = 5'd1, AT_CODE = 5'd2, AT_BYTE_COUNT = 5'd2, AT_READ_DATA = 5'd3,
                   AT_STATUS_END = 5'd3, AT_GROUPS = 5'd3,
                   AT_SUB = 5'd2, AT_WORD = 5'd4,
                   AT_EVENTS = 5'd5, AT_LOG = 5'd9, AT_LOG_SCRATCH = 5'd14,
                   AT_FIFO_BYTES = 5'd2, AT_FIFO = 5'd4,
                   AT_MEI = 5'd2, AT_MEI_END = 5'd5, AT_CONFORMITY = 5'd4, AT_MORE = 5'd5, AT_NEXT = 5'd6, AT_OBJECTS = 5'd7, AT_OBJECT = 5'd8,
                   AT_ID_WANTED = 5'd4, AT_SECTION = 5'd10, AT_SECTION_LOW = 5'd13,
                   AT_RECORD = 5'd7;   // of the directory, see modbus_identity: the first of nine bytes
  localparam [4:0] UPPER = 5'd16;      // the upper half of the frame RAM

  localparam [2:0] COILS = `MB_SPACE_COILS, DISCRETES = `MB_SPACE_DISCRETES, INPUTS = `MB_SPACE_INPUTS,
                   HOLDINGS = `MB_SPACE_HOLDINGS, FILES = `MB_SPACE_FILES, WORDS = `MB_SPACE_COUNTERS,
                   EVENTS = `MB_SPACE_EVENTS, TEXTS = `MB_SPACE_TEXTS;
  localparam [10:0] FILE_READ_MOST = 11'd121, FILE_WRITE_MOST = 11'd122, FIFO_MOST = 11'd31, OBJECTS_MOST = 11'd246;

  // ------------------------------------------------------------------ the mnemonics

  localparam [15:0] ILLEGAL    = {`MB_STEP_JUMP, `MB_JUMP_NEVER, 9'd0};
  localparam [15:0] REST       = {`MB_STEP_REST, 11'd0};
  localparam [15:0] ADDRESS    = {`MB_STEP_ADDRESS, 11'd0};
  localparam [15:0] COIL       = {`MB_STEP_COIL, 11'd0};
  localparam [15:0] ZERO       = {`MB_STEP_COIL, `MB_FLAG_ZERO};
  localparam [15:0] BYTE_COUNT = {`MB_STEP_BYTE_COUNT, 11'd0};
  localparam [15:0] BYTE_COUNT_FITS = {`MB_STEP_BYTE_COUNT, `MB_FLAG_FIT};
  localparam [15:0] END        = {`MB_STEP_END, 11'd0};
  localparam [15:0] END_OF_WORDS = {`MB_STEP_END, `MB_FLAG_WORDS};
  localparam [15:0] FILE       = {`MB_STEP_FILE, 11'd0};
  localparam [15:0] TOTAL      = {`MB_STEP_TOTAL, 11'd0};
  localparam [15:0] RANGE      = {`MB_STEP_RANGE, 11'd0};
  localparam [15:0] RANGE_OF_ONE = {`MB_STEP_RANGE, `MB_FLAG_SINGLE};
  localparam [15:0] RANGE_OF_FILE = {`MB_STEP_RANGE, `MB_FLAG_FILE};
  localparam [15:0] RANGE_WRITTEN = {`MB_STEP_RANGE, `MB_FLAG_WRITTEN};
  localparam [15:0] GRANT_READ  = {`MB_STEP_GRANT, 11'd0};
  localparam [15:0] GRANT_WRITE = {`MB_STEP_GRANT, `MB_FLAG_WRITE};
  localparam [15:0] READ_BURST  = {`MB_STEP_BURST, 11'd0};
  localparam [15:0] READ_BURST_KEEP = {`MB_STEP_BURST, `MB_FLAG_KEEP};
  localparam [15:0] WRITE_BURST = {`MB_STEP_BURST, `MB_FLAG_WRITE};
  localparam [15:0] WRITE_BURST_KEEP = {`MB_STEP_BURST, `MB_FLAG_WRITE | `MB_FLAG_KEEP};
  localparam [15:0] DRY_BURST  = {`MB_STEP_BURST, `MB_FLAG_WRITE | `MB_FLAG_DRY};
  localparam [15:0] PUT_HERE   = {`MB_STEP_PUT, `MB_FLAG_HERE};
  localparam [15:0] SAVE       = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_SAVE};
  localparam [15:0] RECALL     = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_RECALL};
  localparam [15:0] SWAP       = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_SWAP};
  localparam [15:0] SENT_EVENT = {`MB_STEP_LOG, `MB_FLAG_EXCEPTION | 11'h040};

  // A target that does not exist, -1, gives a step that the assembler counts as a fault.
  localparam [15:0] FAULT      = {`MB_STEP_JUMP, `MB_JUMP_NEVER, 9'h1FF};

  function [15:0] JUMP(input [1:0] condition, input integer target);
    JUMP = (target < 0) ? FAULT : {`MB_STEP_JUMP, condition, target[8:0]};
  endfunction
  function [15:0] GO(input integer target);
    GO = JUMP(`MB_JUMP_ALWAYS, target);
  endfunction
  function [15:0] GO_IF_READY(input integer target);
    GO_IF_READY = JUMP(`MB_JUMP_READY, target);
  endfunction
  function [15:0] GO_IF_UNICAST(input integer target);
    GO_IF_UNICAST = JUMP(`MB_JUMP_UNICAST, target);
  endfunction
  function [15:0] IF(input [1:0] condition, input integer target);
    IF = (target < 0) ? FAULT : {`MB_STEP_IF, condition, target[8:0]};
  endfunction
  function [15:0] IF_LEFT(input integer target);
    IF_LEFT = IF(`MB_IF_LEFT, target);
  endfunction
  function [15:0] IF_EQUAL(input integer target);
    IF_EQUAL = IF(`MB_IF_EQUAL, target);
  endfunction
  function [15:0] IF_LISTENING(input integer target);
    IF_LISTENING = IF(`MB_IF_LISTENING, target);
  endfunction
  function [15:0] IF_NOT_USER(input integer target);
    IF_NOT_USER = IF(`MB_IF_NOT_USER, target);
  endfunction
  function [15:0] OFFER(input integer target);
    OFFER = (target < 0) ? FAULT : {`MB_STEP_OFFER, 2'd0, target[8:0]};
  endfunction
  function [15:0] DISPATCH(input integer table_at);
    DISPATCH = {`MB_STEP_FUNCTION, 2'd0, table_at[8:0]};
  endfunction
  function [15:0] DISPATCH_WIDE(input integer table_at);
    DISPATCH_WIDE = {`MB_STEP_FUNCTION, `MB_FLAG_WIDE | {2'd0, table_at[8:0]}};
  endfunction
  function [15:0] ADDRESS_IN(input [2:0] space);
    ADDRESS_IN = {`MB_STEP_ADDRESS, `MB_FLAG_SPACE | {8'd0, space}};
  endfunction
  function [15:0] SPACE(input [2:0] space);
    SPACE = {`MB_STEP_SPACE, 8'd0, space};
  endfunction
  function [15:0] QUANTITY(input [10:0] most);
    QUANTITY = {`MB_STEP_QUANTITY, -most};
  endfunction
  function [15:0] DEPTH(input [10:0] most);
    DEPTH = {`MB_STEP_DEPTH, 11'd0 - most - 11'd1};
  endfunction
  function [15:0] FIRST(input [7:0] number);
    FIRST = {`MB_STEP_SET, 3'd0, number};
  endfunction
  function [15:0] ITEMS(input integer number);
    ITEMS = {`MB_STEP_SET, `MB_FLAG_LESS | {3'd0, number[7:0] - 8'd1}};
  endfunction
  function [15:0] POINT(input [4:0] place);
    POINT = {`MB_STEP_POINT, 6'd0, place};
  endfunction
  function [15:0] POINT_CLEAR(input [4:0] place);
    POINT_CLEAR = {`MB_STEP_POINT, `MB_FLAG_CLEAR | {6'd0, place}};
  endfunction
  function [15:0] WALK(input [4:0] place);
    WALK = {`MB_STEP_WALK, 6'd0, place};
  endfunction
  function [15:0] WALK_UP(input [4:0] place);
    WALK_UP = {`MB_STEP_WALK, `MB_FLAG_UP | {6'd0, place}};
  endfunction
  function [15:0] LOAD(input [4:0] place);
    LOAD = {`MB_STEP_LOAD, 2'd0, `MB_LOAD_BYTE, 2'd0, place};
  endfunction
  function [15:0] LOAD_MARKED(input [4:0] place);
    LOAD_MARKED = {`MB_STEP_LOAD, `MB_FLAG_MARK | {2'd0, `MB_LOAD_BYTE, 2'd0, place}};
  endfunction
  function [15:0] XOR(input [4:0] place);
    XOR = {`MB_STEP_LOAD, 2'd0, `MB_LOAD_XOR, 2'd0, place};
  endfunction
  function [15:0] AND(input [4:0] place);
    AND = {`MB_STEP_LOAD, 2'd0, `MB_LOAD_AND, 2'd0, place};
  endfunction
  function [15:0] STATUS(input [3:0] which);
    STATUS = {`MB_STEP_LOAD, `MB_FLAG_HERE | {2'd0, `MB_LOAD_STATUS, 3'd0, which}};
  endfunction
  function [15:0] LITERAL(input [7:0] value);
    LITERAL = {`MB_STEP_LITERAL, 3'd0, value};
  endfunction
  function [15:0] PUT(input [4:0] place);
    PUT = {`MB_STEP_PUT, 6'd0, place};
  endfunction
  function [15:0] SEND(input [4:0] half);
    SEND = {`MB_STEP_SEND, 6'd0, half};
  endfunction
  function [15:0] MATCH(input [7:0] value, input [3:0] exception_code);
    MATCH = {`MB_STEP_MATCH, exception_code[2:0], value};
  endfunction
  localparam [15:0] SKIP_BYTE = {`MB_STEP_MATCH, 11'd0};
  function [15:0] COUNT(input [4:0] counter, input [2:0] condition);
    COUNT = {`MB_STEP_COUNT, 2'd0, condition, 1'b0, counter};
  endfunction
  function [15:0] CLEAR(input integer counter);
    CLEAR = {`MB_STEP_COUNT, `MB_FLAG_CLEAR | {6'd0, counter[4:0]}};
  endfunction
  function [15:0] LOG(input [7:0] what, input [10:0] flags);
    LOG = {`MB_STEP_LOG, flags | {3'd0, what}};
  endfunction
  function [15:0] MODE(input [10:0] modes);
    MODE = {`MB_STEP_MODE, modes};
  endfunction

  // ------------------------------------------------------------------ the assembler

  // Two passes over the listing: the first finds where each label is, the second writes the steps with these places.
  // A label is a variable of the function; -1: not in this program.  A fault: a label that stands twice, a jump to one
  // that is not there, a routine that should run into another and does not.
  localparam integer STEPS = 512;

`define LABEL(NAME) \
  if (second ? NAME != here : NAME != NOWHERE) faults = faults + 1; \
  NAME = here;
`define ROUTINE(NAME, CONDITION) if (CONDITION) begin `LABEL(NAME)
`define DO(STEP) \
  if (second && STEP == FAULT) faults = faults + 1; \
  image[16*here +: 16] = STEP; \
  here = here + 1;
`define LOOP loop = here;
`define FALL_INTO(NAME) if (second && NAME != here) faults = faults + 1;
`define END_ROUTINE end
`define NEXT (here + 1)
`define TABLE(NAME) `LABEL(NAME) here = here + 32;
`define FUNCTION_CODE(CODE, STEP) \
  if (FUNCTION_CODES[CODE]) image[16*((CODE == 43) ? 30 : CODE) +: 16] = STEP;
`define SUB_FUNCTION(CODE, STEP) image[16*(SUB_TABLE + CODE) +: 16] = STEP;
`define END_TABLE

  localparam integer NOWHERE = -1, WHERE = 16;    // bits of an address in what the function returns
  localparam integer BITS = 7 * WHERE + 16 * STEPS;

  function [BITS-1:0] assembled(input integer origin);
    reg [16*STEPS-1:0] image;
    reg second;
    integer pass, here, loop, faults;
    integer FUNCTION_TABLE, SUB_TABLE, START, OURS, EXCEPTION, SENDING, TAIL, TAIL_NO_EVENT, DONE, ECHO, ANSWER,
            BAD, FOREIGN, CLEARING, LISTENING, RESTART, USER_SEND, READ_COILS, READ_DISCRETES, READ_HOLDINGS,
            READ_INPUTS, READ_BITS, READ_WORDS, READ, WRITE_COIL, WRITE_REGISTER, WRITE_SINGLE, WRITE_COILS,
            WRITE_REGISTERS, WRITE_MULTIPLE, WRITTEN, EXCEPTION_STATUS, DIAGNOSTICS, SUB_ECHO, SUB_COUNTER,
            SUB_REGISTER, SUB_DELIMITER, SUB_LISTEN, SUB_CLEAR, SUB_OVERRUN, SUB_RESTART, EVENT_COUNTER,
            EVENT_LOG, SERVER_ID_ANSWER, READ_FILES, WRITE_FILES, MASK_WRITE, READ_WRITE, READ_FIFO, DEVICE_ID,
            FOUND;
    begin
      FUNCTION_TABLE = NOWHERE;
      SUB_TABLE = NOWHERE;
      START = NOWHERE;
      OURS = NOWHERE;
      EXCEPTION = NOWHERE;
      SENDING = NOWHERE;
      TAIL = NOWHERE;
      TAIL_NO_EVENT = NOWHERE;
      DONE = NOWHERE;
      ECHO = NOWHERE;
      ANSWER = NOWHERE;
      BAD = NOWHERE;
      FOREIGN = NOWHERE;
      CLEARING = NOWHERE;
      LISTENING = NOWHERE;
      RESTART = NOWHERE;
      USER_SEND = NOWHERE;
      READ_COILS = NOWHERE;
      READ_DISCRETES = NOWHERE;
      READ_HOLDINGS = NOWHERE;
      READ_INPUTS = NOWHERE;
      READ_BITS = NOWHERE;
      READ_WORDS = NOWHERE;
      READ = NOWHERE;
      WRITE_COIL = NOWHERE;
      WRITE_REGISTER = NOWHERE;
      WRITE_SINGLE = NOWHERE;
      WRITE_COILS = NOWHERE;
      WRITE_REGISTERS = NOWHERE;
      WRITE_MULTIPLE = NOWHERE;
      WRITTEN = NOWHERE;
      EXCEPTION_STATUS = NOWHERE;
      DIAGNOSTICS = NOWHERE;
      SUB_ECHO = NOWHERE;
      SUB_COUNTER = NOWHERE;
      SUB_REGISTER = NOWHERE;
      SUB_DELIMITER = NOWHERE;
      SUB_LISTEN = NOWHERE;
      SUB_CLEAR = NOWHERE;
      SUB_OVERRUN = NOWHERE;
      SUB_RESTART = NOWHERE;
      EVENT_COUNTER = NOWHERE;
      EVENT_LOG = NOWHERE;
      SERVER_ID_ANSWER = NOWHERE;
      READ_FILES = NOWHERE;
      WRITE_FILES = NOWHERE;
      MASK_WRITE = NOWHERE;
      READ_WRITE = NOWHERE;
      READ_FIFO = NOWHERE;
      DEVICE_ID = NOWHERE;
      FOUND = NOWHERE;
      image  = {STEPS{ILLEGAL}};
      faults = origin;
      second = 1'b0;
      for (pass = 0; pass < 2; pass = pass + 1) begin
        second = (pass == 1);
        here   = origin;
`include "modbus_routines_frame.vh"
`include "modbus_routines_data.vh"
`include "modbus_routines_diagnostics.vh"
`include "modbus_routines_files.vh"
`include "modbus_routines_identity.vh"
      end
      assembled = {faults[WHERE-1:0], here[WHERE-1:0], CLEARING[WHERE-1:0], EXCEPTION[WHERE-1:0], BAD[WHERE-1:0],
                   FOREIGN[WHERE-1:0], START[WHERE-1:0], image};
    end
  endfunction

  localparam [BITS-1:0] PROGRAM = assembled(0);
  localparam integer PROGRAM_END = PROGRAM[16*STEPS + 5*WHERE +: WHERE],
                     FAULTS      = PROGRAM[16*STEPS + 6*WHERE +: WHERE],
                     DEPTH_STEPS = (PROGRAM_END <= 256) ? 256 : 512;

  generate
    if (FAULTS != 0) begin : gen_faults
      ERROR_modbus_program_a_label_is_missing_or_stands_twice illegal_parameter ();
    end
    if (USER_CODES[0]) begin : gen_user_code
      ERROR_modbus_USER_CODES_are_function_codes_1_to_127 illegal_parameter ();
    end
    if (PROGRAM_END > STEPS) begin : gen_too_long
      ERROR_modbus_program_exceeds_512_steps illegal_parameter ();
    end
  endgenerate

  // ------------------------------------------------------------------ the memory

  reg [15:0] memory [0:DEPTH_STEPS-1];
  reg [15:0] step_q;
  integer i;

  initial for (i = 0; i < DEPTH_STEPS; i = i + 1) memory[i] = PROGRAM[16*i +: 16];

  generate
    if (DEPTH_STEPS <= 256) begin : gen_short
      wire unused = at_i[8];
    end
  endgenerate

  always @(posedge clk_i) step_q <= memory[at_i[$clog2(DEPTH_STEPS)-1:0]];

  assign step_o      = step_q;
  assign start_o     = PROGRAM[16*STEPS + 0*WHERE +: 9];
  assign foreign_o   = PROGRAM[16*STEPS + 1*WHERE +: 9];
  assign bad_o       = PROGRAM[16*STEPS + 2*WHERE +: 9];
  assign exception_o = PROGRAM[16*STEPS + 3*WHERE +: 9];
  assign reset_o     = PROGRAM[16*STEPS + 4*WHERE +: 9];

endmodule

`default_nettype wire
