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
  parameter [127:0] FUNCTION_CODES      = 64'h0000080001F399FE,  // bit n: function code n is built in
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
    if ((FUNCTION_CODES & ~128'h0000080001F399FE) != 0) begin : gen_codes
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
  localparam [10:0] NO_FLAG = 11'd0, WRITE = `MB_FLAG_WRITE, KEEP = `MB_FLAG_KEEP, DRY = `MB_FLAG_DRY,
                    UP = `MB_FLAG_UP, CLEAR = `MB_FLAG_CLEAR, HERE = `MB_FLAG_HERE;
  localparam [2:0] ANY = 3'd0, FUNCTION = 3'd1, ADDRESS = 3'd2, VALUE = 3'd3;   // exceptions of MATCH
  localparam [10:0] FILE_READ_MOST = 11'd121, FILE_WRITE_MOST = 11'd122, FIFO_MOST = 11'd31, OBJECTS_MOST = 11'd246;

  // ------------------------------------------------------------------ where everything is

  // Lengths; a routine that is left out has none.
  localparam integer
    D = HAS_DIAGNOSTICS, U = HAS_USER, C = HAS_CONTEXT,
    READS_BITS  = (FUNCTION_CODES[1] || FUNCTION_CODES[2]) ? 1 : 0,
    READS_WORDS = (FUNCTION_CODES[3] || FUNCTION_CODES[4]) ? 1 : 0,
    SINGLES     = (FUNCTION_CODES[5] || FUNCTION_CODES[6]) ? 1 : 0,
    MULTIPLES   = (FUNCTION_CODES[15] || FUNCTION_CODES[16]) ? 1 : 0;

  // The tables have 32 entries, one for each function code below 30 and for each sub-function of 08H.
  localparam integer
    TABLE           = 0,
    SUB_TABLE       = 32,
    START           = SUB_TABLE       + 32 * FUNCTION_CODES[8],
    EXCEPTION       = START           + 3 + 2 * C + 4 * D + 9 * U,
    SENDING         = EXCEPTION       + 6 + D,
    TAIL            = SENDING         + 1,
    DONE            = TAIL            + 6 * D,
    ECHO            = DONE            + 1,
    ANSWER          = ECHO            + 3,
    BAD             = ANSWER          + 5,
    FOREIGN         = BAD             + 5 * D,
    CLEARING        = FOREIGN         + 2 * D,
    LISTENING       = CLEARING        + 10 * D,
    RESTART         = LISTENING       + 9 * D,
    USER_SEND       = RESTART         + 3 * D,
    READ_COILS      = USER_SEND       + 2 * U,
    READ_DISCRETES  = READ_COILS      + 2 * FUNCTION_CODES[1],
    READ_HOLDINGS   = READ_DISCRETES  + 2 * FUNCTION_CODES[2],
    READ_INPUTS     = READ_HOLDINGS   + 2 * FUNCTION_CODES[3],
    READ_BITS       = READ_INPUTS     + 2 * FUNCTION_CODES[4],
    READ_WORDS      = READ_BITS       + 2 * READS_BITS,
    READ            = READ_WORDS      + 1 * READS_WORDS,
    WRITE_COIL      = READ            + 7 * (READS_BITS | READS_WORDS),
    WRITE_REGISTER  = WRITE_COIL      + 3 * FUNCTION_CODES[5],
    WRITE_SINGLE    = WRITE_REGISTER  + 2 * FUNCTION_CODES[6],
    WRITE_COILS     = WRITE_SINGLE    + 7 * SINGLES,
    WRITE_REGISTERS = WRITE_COILS     + 3 * FUNCTION_CODES[15],
    WRITE_MULTIPLE  = WRITE_REGISTERS + 2 * FUNCTION_CODES[16],
    WRITTEN         = WRITE_MULTIPLE  + 6 * MULTIPLES,
    EXCEPTION_STATUS = WRITTEN        + 4 * (SINGLES | MULTIPLES),
    DIAGNOSTICS     = EXCEPTION_STATUS + 6 * FUNCTION_CODES[7],
    SUB_ECHO        = DIAGNOSTICS     + 6 * FUNCTION_CODES[8],
    SUB_COUNTER     = SUB_ECHO        + 3 * FUNCTION_CODES[8],
    SUB_REGISTER    = SUB_COUNTER     + 7 * FUNCTION_CODES[8],
    SUB_DELIMITER   = SUB_REGISTER    + 7 * FUNCTION_CODES[8],
    SUB_LISTEN      = SUB_DELIMITER   + 4 * FUNCTION_CODES[8],
    SUB_CLEAR       = SUB_LISTEN      + 8 * FUNCTION_CODES[8],
    SUB_OVERRUN     = SUB_CLEAR       + 7 * FUNCTION_CODES[8],
    SUB_RESTART     = SUB_OVERRUN     + 9 * FUNCTION_CODES[8],
    EVENT_COUNTER   = SUB_RESTART     + 6 * FUNCTION_CODES[8],
    EVENT_LOG       = EVENT_COUNTER   + 13 * FUNCTION_CODES[11],
    SERVER_ID       = EVENT_LOG       + 23 * FUNCTION_CODES[12],
    MORE_ID         = (ADDITIONAL_DATA_BYTES > 0) ? 3 : 0,
    READ_FILES      = SERVER_ID       + (10 + MORE_ID) * FUNCTION_CODES[17],
    WRITE_FILES     = READ_FILES      + 45 * FUNCTION_CODES[20],
    MASK_WRITE      = WRITE_FILES     + 41 * FUNCTION_CODES[21],
    READ_WRITE      = MASK_WRITE      + 28 * FUNCTION_CODES[22],
    READ_FIFO       = READ_WRITE      + 28 * FUNCTION_CODES[23],
    DEVICE_ID       = READ_FIFO       + 22 * FUNCTION_CODES[24],
    PROGRAM_END     = DEVICE_ID       + 52 * FUNCTION_CODES[43],
    DEPTH           = (PROGRAM_END <= 256) ? 256 : 512;

  generate
    if (USER_CODES[0]) begin : gen_user_code
      ERROR_modbus_USER_CODES_are_function_codes_1_to_127 illegal_parameter ();
    end
    if (PROGRAM_END > 512) begin : gen_too_long
      ERROR_modbus_program_exceeds_512_steps illegal_parameter ();
    end
  endgenerate

  // ------------------------------------------------------------------ the steps in writing

  function [15:0] plain(input [4:0] step, input [10:0] argument);
    plain = {step, argument};
  endfunction
  function [15:0] at(input [4:0] step, input [4:0] place, input [10:0] flags);
    at = {step, flags | {6'd0, place}};
  endfunction
  function [15:0] load(input [1:0] what, input [4:0] place, input [10:0] flags);
    load = {`MB_STEP_LOAD, flags | {2'd0, what, 2'd0, place}};
  endfunction
  function [15:0] status(input [3:0] which);
    status = {`MB_STEP_LOAD, `MB_FLAG_HERE | {2'd0, `MB_LOAD_STATUS, 3'd0, which}};
  endfunction
  function [15:0] match(input [7:0] value, input [2:0] otherwise);
    match = {`MB_STEP_MATCH, otherwise, value};
  endfunction
  function [15:0] jump(input [1:0] condition, input [8:0] target);
    jump = {`MB_STEP_JUMP, condition, target};
  endfunction
  function [15:0] go(input [8:0] target);
    go = jump(`MB_JUMP_ALWAYS, target);
  endfunction
  function [15:0] when(input [1:0] condition, input [8:0] target);
    when = {`MB_STEP_IF, condition, target};
  endfunction
  function [15:0] send(input [4:0] half);
    send = at(`MB_STEP_SEND, half, NO_FLAG);
  endfunction
  function [15:0] address(input [2:0] space);
    address = {`MB_STEP_ADDRESS, `MB_FLAG_SPACE | {8'd0, space}};
  endfunction
  function [15:0] quantity(input [10:0] most);
    quantity = {`MB_STEP_QUANTITY, -most};
  endfunction
  function [15:0] count(input [4:0] counter, input [2:0] condition);
    count = {`MB_STEP_COUNT, 2'd0, condition, 1'b0, counter};
  endfunction

  localparam [15:0] FIRST_SET  = {`MB_STEP_SET, 11'd0};
  localparam [15:0] LESS_SET   = {`MB_STEP_SET, `MB_FLAG_LESS};
  localparam [15:0] SAVE       = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_SAVE};
  localparam [15:0] RECALL     = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_RECALL};
  localparam [15:0] SWAP       = {`MB_STEP_CONTEXT, 9'd0, `MB_CONTEXT_SWAP};
  localparam [15:0] REST       = {`MB_STEP_REST, 11'd0};
  localparam [15:0] ILLEGAL    = {`MB_STEP_JUMP, `MB_JUMP_NEVER, 9'd0};
  localparam [15:0] SENT_EVENT = {`MB_STEP_LOG, `MB_FLAG_EXCEPTION | 11'h040};


`include "modbus_routines_frame.vh"
`include "modbus_routines_data.vh"
`include "modbus_routines_diagnostics.vh"
`include "modbus_routines_files.vh"
`include "modbus_routines_identity.vh"

  // ------------------------------------------------------------------ the memory

  // One entry for each function code: where its routine is, and whether a broadcast may go there
  function [15:0] entry(input integer code);
    begin
      entry = ILLEGAL;
      if (code < 30 ? FUNCTION_CODES[code] : (code == 30 && FUNCTION_CODES[43]))
        case (code)
          `MB_FC_READ_COILS:               entry = jump(`MB_JUMP_UNICAST, READ_COILS[8:0]);
          `MB_FC_READ_DISCRETE_INPUTS:     entry = jump(`MB_JUMP_UNICAST, READ_DISCRETES[8:0]);
          `MB_FC_READ_HOLDING_REGISTERS:   entry = jump(`MB_JUMP_UNICAST, READ_HOLDINGS[8:0]);
          `MB_FC_READ_INPUT_REGISTERS:     entry = jump(`MB_JUMP_UNICAST, READ_INPUTS[8:0]);
          `MB_FC_WRITE_SINGLE_COIL:        entry = go(WRITE_COIL[8:0]);
          `MB_FC_WRITE_SINGLE_REGISTER:    entry = go(WRITE_REGISTER[8:0]);
          `MB_FC_READ_EXCEPTION_STATUS:    entry = jump(`MB_JUMP_UNICAST, EXCEPTION_STATUS[8:0]);
          `MB_FC_DIAGNOSTICS:              entry = jump(`MB_JUMP_UNICAST, DIAGNOSTICS[8:0]);
          `MB_FC_GET_EVENT_COUNTER:        entry = jump(`MB_JUMP_UNICAST, EVENT_COUNTER[8:0]);
          `MB_FC_GET_EVENT_LOG:            entry = jump(`MB_JUMP_UNICAST, EVENT_LOG[8:0]);
          `MB_FC_WRITE_MULTIPLE_COILS:     entry = go(WRITE_COILS[8:0]);
          `MB_FC_WRITE_MULTIPLE_REGISTERS: entry = go(WRITE_REGISTERS[8:0]);
          `MB_FC_REPORT_SERVER_ID:         entry = jump(`MB_JUMP_UNICAST, SERVER_ID[8:0]);
          `MB_FC_READ_FILE_RECORD:         entry = jump(`MB_JUMP_UNICAST, READ_FILES[8:0]);
          `MB_FC_WRITE_FILE_RECORD:        entry = jump(`MB_JUMP_UNICAST, WRITE_FILES[8:0]);
          `MB_FC_MASK_WRITE_REGISTER:      entry = jump(`MB_JUMP_UNICAST, MASK_WRITE[8:0]);
          `MB_FC_READ_WRITE_REGISTERS:     entry = jump(`MB_JUMP_UNICAST, READ_WRITE[8:0]);
          `MB_FC_READ_FIFO_QUEUE:          entry = jump(`MB_JUMP_UNICAST, READ_FIFO[8:0]);
          default:                         entry = jump(`MB_JUMP_UNICAST, DEVICE_ID[8:0]);
        endcase
    end
  endfunction

  // Which routine a step is of
  function [15:0] frame_step(input integer n);
    begin
      if (n < 32)              frame_step = entry(n);
      else if (n < START)      frame_step = sub_entry(n - SUB_TABLE);
      else if (n < EXCEPTION)  frame_step = start(n - START);
      else if (n < SENDING)    frame_step = exception(n - EXCEPTION);
      else if (n < TAIL)       frame_step = send(AT_FRAME);
      else if (n < DONE)       frame_step = tail(n - TAIL);
      else if (n < ECHO)       frame_step = REST;
      else if (n < ANSWER)     frame_step = echo(n - ECHO, AT_VALUE_END);
      else if (n < BAD)        frame_step = answer(n - ANSWER);
      else if (n < FOREIGN)    frame_step = bad(n - BAD);
      else if (n < CLEARING)   frame_step = foreign(n - FOREIGN);
      else if (n < LISTENING)  frame_step = clearing(n - CLEARING);
      else if (n < RESTART)    frame_step = listening(n - LISTENING);
      else if (n < USER_SEND)  frame_step = restart(n - RESTART);
      else                     frame_step = user_send(n - USER_SEND);
    end
  endfunction

  function [15:0] data_step(input integer n);
    begin
      if (n < READ_DISCRETES)        data_step = in_space(n - READ_COILS, COILS, READ_BITS[8:0]);
      else if (n < READ_HOLDINGS)    data_step = in_space(n - READ_DISCRETES, DISCRETES, READ_BITS[8:0]);
      else if (n < READ_INPUTS)      data_step = in_space(n - READ_HOLDINGS, HOLDINGS, READ_WORDS[8:0]);
      else if (n < READ_BITS)        data_step = in_space(n - READ_INPUTS, INPUTS, READ_WORDS[8:0]);
      else if (n < READ_WORDS)       data_step = read_bits(n - READ_BITS);
      else if (n < READ)             data_step = quantity(MAX_READ_REGISTERS[10:0]);
      else if (n < WRITE_COIL)       data_step = read(n - READ);
      else if (n < WRITE_REGISTER)   data_step = write_coil(n - WRITE_COIL);
      else if (n < WRITE_SINGLE)     data_step = write_register(n - WRITE_REGISTER);
      else if (n < WRITE_COILS)      data_step = write_single(n - WRITE_SINGLE);
      else if (n < WRITE_REGISTERS)  data_step = write_coils(n - WRITE_COILS);
      else if (n < WRITE_MULTIPLE)   data_step = write_registers(n - WRITE_REGISTERS);
      else if (n < WRITTEN)          data_step = write_multiple(n - WRITE_MULTIPLE);
      else                           data_step = written(n - WRITTEN);
    end
  endfunction

  function [15:0] diagnostics_step(input integer n);
    begin
      if (n < DIAGNOSTICS)        diagnostics_step = exception_status(n - EXCEPTION_STATUS);
      else if (n < SUB_ECHO)      diagnostics_step = diagnostics(n - DIAGNOSTICS);
      else if (n < SUB_COUNTER)   diagnostics_step = sub_echo(n - SUB_ECHO);
      else if (n < SUB_REGISTER)  diagnostics_step = sub_counter(n - SUB_COUNTER);
      else if (n < SUB_DELIMITER) diagnostics_step = sub_register(n - SUB_REGISTER);
      else if (n < SUB_LISTEN)    diagnostics_step = sub_delimiter(n - SUB_DELIMITER);
      else if (n < SUB_CLEAR)     diagnostics_step = sub_listen(n - SUB_LISTEN);
      else if (n < SUB_OVERRUN)   diagnostics_step = sub_clear(n - SUB_CLEAR);
      else if (n < SUB_RESTART)   diagnostics_step = sub_overrun(n - SUB_OVERRUN);
      else if (n < EVENT_COUNTER) diagnostics_step = sub_restart(n - SUB_RESTART);
      else if (n < EVENT_LOG)     diagnostics_step = event_counter(n - EVENT_COUNTER);
      else                        diagnostics_step = event_log(n - EVENT_LOG);
    end
  endfunction

  function [15:0] other_step(input integer n);
    begin
      if (n < READ_FILES)       other_step = server_id(n - SERVER_ID);
      else if (n < WRITE_FILES) other_step = read_files(n - READ_FILES);
      else if (n < MASK_WRITE)  other_step = write_files(n - WRITE_FILES);
      else if (n < READ_WRITE)  other_step = mask_write(n - MASK_WRITE);
      else if (n < READ_FIFO)   other_step = read_write(n - READ_WRITE);
      else if (n < DEVICE_ID)   other_step = read_fifo(n - READ_FIFO);
      else                      other_step = device_id(n - DEVICE_ID);
    end
  endfunction

  function [15:0] content(input integer n);
    begin
      if (n < READ_COILS)            content = frame_step(n);
      else if (n < EXCEPTION_STATUS) content = data_step(n);
      else if (n < SERVER_ID)        content = diagnostics_step(n);
      else if (n < PROGRAM_END)      content = other_step(n);
      else                           content = ILLEGAL;
    end
  endfunction

  reg [15:0] memory [0:DEPTH-1];
  reg [15:0] step_q;
  integer i;

  initial for (i = 0; i < DEPTH; i = i + 1) memory[i] = content(i);

  generate
    if (DEPTH <= 256) begin : gen_short
      wire unused = at_i[8];
    end
  endgenerate

  always @(posedge clk_i) step_q <= memory[at_i[$clog2(DEPTH)-1:0]];

  assign step_o      = step_q;
  assign start_o     = START[8:0];
  assign foreign_o   = FOREIGN[8:0];
  assign bad_o       = BAD[8:0];
  assign exception_o = EXCEPTION[8:0];
  assign reset_o     = CLEARING[8:0];

endmodule

`default_nettype wire
