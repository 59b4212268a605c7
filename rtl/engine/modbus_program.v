// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_program - what each function code does, step by step, in the order of checks that the standard asks for.
//
// A read-only memory with a registered output.  Its contents are a listing, the files modbus_routines_*.vh: one line is
// one step, mnemonic first.  A constant function assembles it, see "The assembler" below.  This is the one place that
// knows the layout of a request and its limits (MODBUS Application Protocol V1.1b3, clause 6) and what is counted and
// logged (MODBUS over Serial Line V1.02, appendix A).
//
// A new function code is a routine and a row in the table of modbus_routines_frame.vh.  A routine that no built-in
// function needs is left out by its condition and takes no room.  The checks run function (01), length and quantity
// (03), address (02), then execution (04, 06), all before the first write.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_program #(
  parameter [127:0] FUNCTION_CODES      = `MB_ALL_FUNCTIONS,  // bit n: function code n is built in
  parameter [127:0] USER_CODES          = 128'd0,        // bit n: function code n is offered to the user
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
  parameter integer CHECK_WRITES        = 0,             // 1: a checking pass before every write of coils and registers
  parameter integer ASCII_MODE          = 0,             // 1: 08H sets the delimiter of ASCII mode
  parameter integer SERVER_ID_BYTES     = 1,             // function code 11H
  parameter integer ADDITIONAL_DATA_BYTES = 0,
  parameter [7:0]   CONFORMITY          = 8'h81          // function code 2BH
) (
  input  wire        clk_i,
  input  wire [8:0]  at_i,        // address of a step
  input  wire        fetch_i,     // level: step_o becomes that step, else it stands still
  output wire [15:0] step_o,

  output wire [`MB_ENTRIES_WIDTH-1:0] entries_o          // constants: where the sequencer begins, MB_ENTRY_*
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
    if ((FUNCTION_CODES & ~`MB_ALL_FUNCTIONS) != 0) begin : gen_codes
      ERROR_modbus_FUNCTION_CODES_names_a_code_that_is_not_implemented illegal_parameter ();
    end
    if (USER_CODES[0]) begin : gen_user_code
      ERROR_modbus_USER_CODES_are_function_codes_1_to_127 illegal_parameter ();
    end
  endgenerate

  // ------------------------------------------------------------------ places and numbers

  // Bytes of a frame, the address byte being 0: request, then answer
  localparam [4:0] AT_FRAME = 5'd0, AT_FUNCTION = 5'd1, AT_CODE = 5'd2, AT_CHECKED = 5'd2,
                   AT_ADDRESS = 5'd2, AT_VALUE = 5'd4, AT_VALUE_END = 5'd6, AT_DATA = 5'd7,
                   AT_AND_MASK = 5'd4, AT_OR_MASK = 5'd6, AT_MASK_END = 5'd8,
                   AT_SCRATCH = 5'd8,  // behind the PDU of function code 16H
                   AT_RW_WRITE = 5'd6, AT_RW_DATA = 5'd11,
                   AT_BYTE_COUNT = 5'd2, AT_READ_DATA = 5'd3, AT_GROUPS = 5'd3,
                   AT_SUB = 5'd2, AT_WORD = 5'd4,
                   AT_EVENTS = 5'd5, AT_LOG = 5'd9, AT_LOG_SCRATCH = 5'd14,
                   AT_FIFO_BYTES = 5'd2, AT_FIFO = 5'd4,
                   AT_MEI = 5'd2, AT_MEI_END = 5'd5, AT_CONFORMITY = 5'd4, AT_OBJECT = 5'd8, AT_ID_WANTED = 5'd4,
                   AT_SECTION = 5'd10, AT_SECTION_LOW = 5'd13,
                   // A record of the directory, see modbus_identity; its first three bytes are those of the answer.
                   AT_RECORD = 5'd5, AT_RECORD_MARK = 5'd8, AT_RECORD_OBJECT = 5'd9, AT_RECORD_RANGE = 5'd10;
  localparam [4:0] UPPER = 5'd16;      // the upper half of the frame RAM

  localparam [2:0] COILS = `MB_SPACE_COILS, DISCRETES = `MB_SPACE_DISCRETES, INPUTS = `MB_SPACE_INPUTS,
                   HOLDINGS = `MB_SPACE_HOLDINGS, FILES = `MB_SPACE_FILES, WORDS = `MB_SPACE_COUNTERS,
                   EVENTS = `MB_SPACE_EVENTS, TEXTS = `MB_SPACE_TEXTS;
  localparam [10:0] FILE_READ_MOST = 11'd121, FILE_WRITE_MOST = 11'd122, FIFO_MOST = 11'd31,
                    OBJECTS_MOST = 11'd246, LOG_MOST = 11'd64;
  localparam [7:0] REFERENCE_TYPE = 8'h06, MEI_DEVICE_ID = 8'h0E;
  // What the event log takes (V1.1b3, clause 6.10)
  localparam [7:0] EVENT_RECEIVED = 8'h80, EVENT_BAD = 8'h82, EVENT_SENT = 8'h40, EVENT_LISTEN = 8'h04,
                   EVENT_RESTART = 8'h00;

  // Routines that serve several functions
  localparam [0:0] HAS_BIT_READS  = FUNCTION_CODES[`MB_FC_READ_COILS] | FUNCTION_CODES[`MB_FC_READ_DISCRETE_INPUTS],
                   HAS_WORD_READS = FUNCTION_CODES[`MB_FC_READ_HOLDING_REGISTERS] |
                                    FUNCTION_CODES[`MB_FC_READ_INPUT_REGISTERS],
                   HAS_SINGLE_WRITES = FUNCTION_CODES[`MB_FC_WRITE_SINGLE_COIL] |
                                       FUNCTION_CODES[`MB_FC_WRITE_SINGLE_REGISTER],
                   HAS_MULTIPLE_WRITES = FUNCTION_CODES[`MB_FC_WRITE_MULTIPLE_COILS] |
                                         FUNCTION_CODES[`MB_FC_WRITE_MULTIPLE_REGISTERS],
                   HAS_HEADS = FUNCTION_CODES[`MB_FC_READ_FIFO_QUEUE] | FUNCTION_CODES[`MB_FC_READ_EXCEPTION_STATUS],
                   HAS_DATA_ANSWERS = HAS_BIT_READS | HAS_WORD_READS |
                                      FUNCTION_CODES[`MB_FC_READ_WRITE_REGISTERS] |
                                      FUNCTION_CODES[`MB_FC_GET_EVENT_LOG] |
                                      FUNCTION_CODES[`MB_FC_REPORT_SERVER_ID];

  // ------------------------------------------------------------------ the mnemonics

`include "modbus_mnemonics.vh"

  // ------------------------------------------------------------------ the assembler

  // Two passes over the listing.  The first finds the place of each label, the second writes the steps with them.  A
  // label is a variable of the function; it is NOWHERE if its routine is left out.
  localparam integer STEPS = 512, NOWHERE = -1;
  localparam integer INFO = 32;        // bits of a number in what the function returns

`define LABEL(NAME) \
  if ((pass == 1) ? NAME != here : NAME != NOWHERE) faults = faults + 1; \
  NAME = here;
`define ROUTINE(NAME, CONDITION) if (CONDITION) begin `LABEL(NAME)
`define END_ROUTINE end
`define DO(STEP) \
  image[16*here +: 16] = STEP; \
  if (pass == 1 && image[16*here +: 16] == NO_SUCH_TARGET) faults = faults + 1; \
  here = here + 1;
// The routine runs into the next one.
`define FALL_INTO(NAME) if (pass == 1 && NAME != here) faults = faults + 1;
// Where the nearest loop begins, for the jump at its end
`define LOOP loop = here;
`define NEXT (here + 1)
// Before the range from AT_RANGE on is written from PLACE on, the bank checks it under the same bus cycle.  The first
// address has moved on with the burst.
`define CHECKED(PLACE, AT_RANGE) \
  if (CHECK_WRITES != 0) begin \
    `DO(CHECK_FROM_KEEP(PLACE)) \
    `DO(POINT(AT_RANGE)) \
    `DO(ADDRESS) \
  end
// A table has an entry for each value of the low five bits of a byte; 1FH is that of all bytes from 1FH up.
`define TABLE(NAME, CONDITION) \
  if (CONDITION) begin \
    if (here % 32 != 0) faults = faults + 1; \
    `LABEL(NAME) here = here + 32;
`define END_TABLE end
`define ENTRY(NAME, NUMBER, STEP) image[16*(NAME + NUMBER) +: 16] = STEP;
// A function code that has no entry of its own gets five steps that compare it, behind the table.
`define FUNCTION_CODE(CODE, STEP) \
  if (FUNCTION_CODES[CODE]) begin \
    if (CODE < `MB_OTHER_CODES) begin \
      `ENTRY(FUNCTION_TABLE, CODE, STEP) \
    end else begin \
      `DO(LITERAL_CODE(CODE)) \
      `DO(IF_EQUAL(here + 2)) \
      `DO(GO(here + 3)) \
      `DO(POINT(AT_CODE)) \
      `DO(STEP) \
    end \
  end

  function [16*STEPS + 2*INFO + `MB_ENTRIES_WIDTH - 1:0] assembled(input integer origin);
    reg [16*STEPS-1:0] image;
    reg [`MB_ENTRIES_WIDTH-1:0] entries;
    integer pass, here, loop, faults;
`define NAME(LABEL) integer LABEL;
`include "modbus_labels.vh"
`undef NAME
    begin
`define NAME(LABEL) LABEL = NOWHERE;
`include "modbus_labels.vh"
`undef NAME
      image   = {STEPS{ILLEGAL}};
      entries = {`MB_ENTRIES_WIDTH{1'b0}};
      faults  = 0;
      here    = origin;
      loop    = NOWHERE;
      for (pass = 0; pass < 2; pass = pass + 1) begin
        here = origin;
`include "modbus_routines_tables.vh"
`include "modbus_routines_frame.vh"
`include "modbus_routines_data.vh"
`include "modbus_routines_answer.vh"
`include "modbus_routines_diagnostics.vh"
`include "modbus_routines_files.vh"
`include "modbus_routines_identity.vh"
      end
      entries[`MB_ENTRY_START]     = START[`MB_AT_WIDTH-1:0];
      entries[`MB_ENTRY_EXCEPTION] = EXCEPTION[`MB_AT_WIDTH-1:0];
      if (HAS_DIAGNOSTICS != 0) begin
        entries[`MB_ENTRY_FOREIGN]  = FOREIGN[`MB_AT_WIDTH-1:0];
        entries[`MB_ENTRY_BAD]      = BAD[`MB_AT_WIDTH-1:0];
        entries[`MB_ENTRY_CLEARING] = CLEARING[`MB_AT_WIDTH-1:0];
      end
      assembled = {entries, faults, here, image};
    end
  endfunction

  localparam [16*STEPS + 2*INFO + `MB_ENTRIES_WIDTH - 1:0] PROGRAM = assembled(0);
  localparam integer PROGRAM_STEPS = PROGRAM[16*STEPS +: INFO],
                     FAULTS        = PROGRAM[16*STEPS + INFO +: INFO],
                     DEPTH         = (PROGRAM_STEPS <= 256) ? 256 : STEPS;

`undef LABEL
`undef ROUTINE
`undef END_ROUTINE
`undef DO
`undef FALL_INTO
`undef LOOP
`undef NEXT
`undef CHECKED
`undef TABLE
`undef END_TABLE
`undef ENTRY
`undef FUNCTION_CODE

  generate
    if (FAULTS != 0) begin : gen_faults
      ERROR_modbus_program_has_a_label_twice_or_a_jump_to_none_or_a_routine_out_of_place illegal_parameter ();
    end
    if (PROGRAM_STEPS > STEPS) begin : gen_too_long
      ERROR_modbus_program_exceeds_512_steps illegal_parameter ();
    end
  endgenerate

  // ------------------------------------------------------------------ the memory

  reg [15:0] memory [0:DEPTH-1];
  reg [15:0] step_q;
  integer i;

  initial for (i = 0; i < DEPTH; i = i + 1) memory[i] = PROGRAM[16*i +: 16];

  generate
    if (DEPTH <= 256) begin : gen_short
      wire unused = at_i[8];
    end
  endgenerate

  always @(posedge clk_i) if (fetch_i) step_q <= memory[at_i[$clog2(DEPTH)-1:0]];

  assign step_o    = step_q;
  assign entries_o = PROGRAM[16*STEPS + 2*INFO +: `MB_ENTRIES_WIDTH];

endmodule

`default_nettype wire
