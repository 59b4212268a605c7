// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_identity - who this device is: the texts of function codes 11H and 2BH/0EH in a read-only memory.
//
// All that can be worked out beforehand is (MODBUS Application Protocol V1.1b3, clauses 6.13 and 6.21): for each
// object an answer may begin with, how many objects fit into it and where the next one begins.  So answering is
// finding a record and copying bytes; modbus_program does that.  The memory holds, from address 0 on:
//
//   1..4    address, high byte, of the directory section for code 1, 2, 3, 4; 5..8 the low bytes
//   9..     server identifier, additional data
//   sections of nine-byte records, one for each object in ascending order and a last one for all others:
//           more follows, next object, number of objects, as they stand in the answer; mark (MB_TEXT_*), object,
//           address (2), bytes (2)
//   objects in ascending order: object, length, value
//
// data_o is the byte at at_i one clock later.

`default_nettype none
`include "modbus_defs.vh"

module modbus_identity #(
  parameter [0:0]   HAS_OBJECTS           = 1'b1,          // function code 2BH is built in
  parameter [127:0] SERVER_ID             = 128'h09,       // right-justified
  parameter integer SERVER_ID_BYTES       = 1,             // 1..16
  parameter [1999:0] ADDITIONAL_DATA      = 2000'd0,
  parameter integer ADDITIONAL_DATA_BYTES = 0,             // 0..250 - SERVER_ID_BYTES: PDU of 253 bytes
  parameter [1951:0] VENDOR_NAME           = "VENDOR",     // objects 00 to 02 are always there
  parameter [1951:0] PRODUCT_CODE          = "PRODUCT",
  parameter [1951:0] REVISION              = "V1.0",
  parameter [1951:0] VENDOR_URL            = "",           // 03 to 06: not there if empty
  parameter [1951:0] PRODUCT_NAME          = "",
  parameter [1951:0] MODEL_NAME            = "",
  parameter [1951:0] USER_APPLICATION_NAME = "",
  parameter [4095:0] PRIVATE_OBJECTS       = 4096'd0,      // {object, length, value}..., 80H to FFH, ascending
  parameter [7:0]   CONFORMITY             = 8'h81,
  parameter integer DEVICE_ID_LIMIT        = 253           // largest PDU of an answer
) (
  input  wire        clk_i,
  // verilator lint_off UNUSED
  input  wire [10:0] at_i,           // as many of its bits as the memory needs
  // verilator lint_on UNUSED
  output wire [7:0]  data_o
);

  localparam integer TEXT_BYTES = 244, PRIVATE_BYTES = 512, RECORD = 9, HEAD = 7;
  localparam integer FIRST_PRIVATE = 128;

  // Bytes of a right-justified text, leading zeros left out
  function integer length_of(input [4095:0] text);
    integer k;
    begin
      length_of = 0;
      for (k = 0; k < PRIVATE_BYTES; k = k + 1) if (text[8*k +: 8] != 8'd0) length_of = k + 1;
    end
  endfunction

  // verilator lint_off UNUSED
  function [7:0] high(input integer value);
    high = value[15:8];
  endfunction
  function [7:0] low(input integer value);
    low = value[7:0];
  endfunction
  // verilator lint_on UNUSED

  function [1951:0] text_of(input integer object);
    case (object)
      0: text_of = VENDOR_NAME;
      1: text_of = PRODUCT_CODE;
      2: text_of = REVISION;
      3: text_of = VENDOR_URL;
      4: text_of = PRODUCT_NAME;
      5: text_of = MODEL_NAME;
      default: text_of = USER_APPLICATION_NAME;
    endcase
  endfunction

  localparam integer L0 = length_of({2144'd0, VENDOR_NAME}), L1 = length_of({2144'd0, PRODUCT_CODE}),
                     L2 = length_of({2144'd0, REVISION}), L3 = length_of({2144'd0, VENDOR_URL}),
                     L4 = length_of({2144'd0, PRODUCT_NAME}), L5 = length_of({2144'd0, MODEL_NAME}),
                     L6 = length_of({2144'd0, USER_APPLICATION_NAME}), PRIVATES_GIVEN = length_of(PRIVATE_OBJECTS);

  function integer text_length(input integer object);
    case (object)
      0: text_length = L0;
      1: text_length = L1;
      2: text_length = L2;
      3: text_length = L3;
      4: text_length = L4;
      5: text_length = L5;
      default: text_length = L6;
    endcase
  endfunction

  // Byte k of a text, the last one being 0
  function [7:0] text_byte(input integer object, input integer k);
    reg [1951:0] text;
    begin
      text = text_of(object);
      text_byte = text[8*k +: 8];
    end
  endfunction

  // Private objects: how many, or -1 if they are not what they should be
  function integer private_count(input integer unused);
    integer k, last, size;
    begin
      private_count = unused;
      last = FIRST_PRIVATE - 1;
      k = PRIVATES_GIVEN - 1;
      while (k >= 0) begin
        size = (k >= 1) ? {24'd0, PRIVATE_OBJECTS[8*(k-1) +: 8]} : 0;
        if (k < 1 || {24'd0, PRIVATE_OBJECTS[8*k +: 8]} <= last || size > TEXT_BYTES || k - 1 - size < 0)
          private_count = -1000;
        last = {24'd0, PRIVATE_OBJECTS[8*k +: 8]};
        private_count = private_count + 1;
        k = k - 2 - size;
      end
    end
  endfunction

  function integer private_longest(input integer unused);
    integer k, size;
    begin
      private_longest = unused;
      k = PRIVATES_GIVEN - 1;
      while (k >= 1) begin
        size = {24'd0, PRIVATE_OBJECTS[8*(k-1) +: 8]};
        if (size > private_longest) private_longest = size;
        k = k - 2 - size;
      end
    end
  endfunction

  localparam integer PRIVATES_FOUND = private_count(0);
  localparam integer PRIVATE_MOST   = private_longest(0);

  // Illegal parameters are told of below; here they must not lead outside the memory.
  localparam integer PRIVATES       = (PRIVATES_FOUND > 0) ? PRIVATES_FOUND : 0;
  localparam integer PRIVATE_LENGTH = (PRIVATES_FOUND > 0) ? PRIVATES_GIVEN : 0;
  localparam integer ID_LENGTH   = (SERVER_ID_BYTES < 1 || SERVER_ID_BYTES > 16) ? 1 : SERVER_ID_BYTES;
  // A PDU has 253 bytes; function code, byte count and run indicator take three.
  localparam integer MORE_MOST = 253 - 3 - ID_LENGTH;
  localparam integer MORE_LENGTH =
    (ADDITIONAL_DATA_BYTES < 0 || ADDITIONAL_DATA_BYTES > MORE_MOST) ? 0 : ADDITIONAL_DATA_BYTES;
  localparam integer REGULARS = ((L3 > 0) ? 1 : 0) + ((L4 > 0) ? 1 : 0) + ((L5 > 0) ? 1 : 0) + ((L6 > 0) ? 1 : 0);
  localparam integer OBJECTS_BYTES = 6 + L0 + L1 + L2 + 2 * REGULARS + L3 + L4 + L5 + L6 + PRIVATE_LENGTH;
  localparam integer LEVEL = {30'd0, CONFORMITY[1:0]};

  // Objects of a level, and records of its section
  localparam integer IN_1 = 3, IN_2 = IN_1 + REGULARS, IN_3 = IN_2 + PRIVATES;
  localparam integer ID_BYTES  = ID_LENGTH + MORE_LENGTH;
  localparam integer SECTION_1 = 9 + ID_BYTES;
  localparam integer SECTION_2 = SECTION_1 + RECORD * (IN_1 + 1);
  localparam integer SECTION_3 = SECTION_2 + ((LEVEL >= 2) ? RECORD * (IN_2 + 1) : 0);
  localparam integer SECTION_4 = SECTION_3 + ((LEVEL >= 3) ? RECORD * (IN_3 + 1) : 0);
  localparam integer OBJECTS   = SECTION_4 + (CONFORMITY[7] ? RECORD * (IN_3 + 1) : 0);
  // Codes above the conformity level answer at that level.
  localparam integer SECTION_OF_2 = (LEVEL >= 2) ? SECTION_2 : SECTION_1;
  localparam integer SECTION_OF_3 = (LEVEL >= 3) ? SECTION_3 : SECTION_OF_2;
  localparam integer SIZE      = HAS_OBJECTS ? OBJECTS + OBJECTS_BYTES : SECTION_1;

  generate
    if (SERVER_ID_BYTES < 1 || SERVER_ID_BYTES > 16) begin : gen_server_id
      ERROR_modbus_SERVER_ID_BYTES_from_1_to_16 illegal_parameter ();
    end
    if (ADDITIONAL_DATA_BYTES < 0 || ADDITIONAL_DATA_BYTES > MORE_MOST) begin : gen_additional
      ERROR_modbus_ADDITIONAL_DATA_BYTES_from_0_to_250_less_SERVER_ID_BYTES illegal_parameter ();
    end
    if (HAS_OBJECTS) begin : gen_check
      if (LEVEL == 0 || CONFORMITY[6:2] != 5'd0) begin : gen_conformity
        ERROR_modbus_CONFORMITY_is_01_02_03_81_82_or_83 illegal_parameter ();
      end
      if (PRIVATES_FOUND < 0) begin : gen_private
        ERROR_modbus_PRIVATE_OBJECTS_are_object_80_to_FF_ascending_length_and_value illegal_parameter ();
      end
      if (DEVICE_ID_LIMIT > 253 || DEVICE_ID_LIMIT < HEAD + 2 + L0 || DEVICE_ID_LIMIT < HEAD + 2 + L1 ||
          DEVICE_ID_LIMIT < HEAD + 2 + L2 || DEVICE_ID_LIMIT < HEAD + 2 + L3 || DEVICE_ID_LIMIT < HEAD + 2 + L4 ||
          DEVICE_ID_LIMIT < HEAD + 2 + L5 || DEVICE_ID_LIMIT < HEAD + 2 + L6 ||
          DEVICE_ID_LIMIT < HEAD + 2 + PRIVATE_MOST) begin : gen_limit
        ERROR_modbus_DEVICE_ID_LIMIT_holds_the_longest_object_and_is_at_most_253 illegal_parameter ();
      end
      if (SIZE > 2048) begin : gen_size
        ERROR_modbus_identity_exceeds_2048_bytes illegal_parameter ();
      end
    end
  endgenerate

  // ------------------------------------------------------------------ the memory

  localparam integer ROOM = (SIZE > 1) ? SIZE : 2;
  localparam integer W = $clog2(ROOM);

  // The objects one behind the other; byte k of them is at [8*k +: 8].
  function [8*ROOM-1:0] objects(input integer unused);
    integer object, k, to;
    begin
      objects = 0;
      to = unused;
      for (object = HAS_OBJECTS ? 0 : 7; object < 7; object = object + 1)
        if (object < 3 || text_length(object) > 0) begin
          objects[8*to +: 8]     = low(object);
          objects[8*(to+1) +: 8] = low(text_length(object));
          for (k = 0; k < text_length(object); k = k + 1)
            objects[8*(to+2+k) +: 8] = text_byte(object, text_length(object) - 1 - k);
          to = to + 2 + text_length(object);
        end
      for (k = HAS_OBJECTS ? 0 : PRIVATE_LENGTH; k < PRIVATE_LENGTH; k = k + 1)
        objects[8*(to+k) +: 8] = PRIVATE_OBJECTS[8*(PRIVATE_LENGTH-1-k) +: 8];
    end
  endfunction

  localparam [8*ROOM-1:0] OBJECT_TEXT = objects(0);

  // The record of an answer that begins with the object at byte `from`, of `left` objects of its category; at most
  // `most` of them.
  function [8*RECORD-1:0] record(input [7:0] mark, input integer from, input integer left, input integer most);
    integer bytes, number, size, full;
    begin
      bytes = 0;
      number = 0;
      full = 0;
      while (number < left && number < most && full == 0) begin
        size = 2 + {24'd0, OBJECT_TEXT[8*(from+bytes+1) +: 8]};
        if (HEAD + bytes + size > DEVICE_ID_LIMIT) full = 1;
        else begin
          bytes = bytes + size;
          number = number + 1;
        end
      end
      record[8*0 +: 8] = (number < left && most > 1) ? 8'hFF : 8'h00;
      record[8*1 +: 8] = (number < left && most > 1) ? OBJECT_TEXT[8*(from+bytes) +: 8] : 8'h00;
      record[8*2 +: 8] = low(number);
      record[8*3 +: 8] = mark;
      record[8*4 +: 8] = OBJECT_TEXT[8*from +: 8];
      record[8*5 +: 8] = high(OBJECTS + from);
      record[8*6 +: 8] = low(OBJECTS + from);
      record[8*7 +: 8] = 8'h00;
      record[8*8 +: 8] = low(bytes);
    end
  endfunction

  // One section at its place, the rest 0; most = 1: individual access
  function [8*ROOM-1:0] section(input integer place, input integer count, input integer most);
    integer n, from;
    begin
      section = 0;
      from = 0;
      for (n = 0; n < count; n = n + 1) begin
        section[8*(place + RECORD*n) +: 8*RECORD] = record(`MB_TEXT_MORE, from, count - n, most);
        from = from + 2 + {24'd0, OBJECT_TEXT[8*(from+1) +: 8]};
      end
      section[8*(place + RECORD*count) +: 8*RECORD] =
        record((most == 1) ? `MB_TEXT_NONE : `MB_TEXT_LAST, 0, count, most);
      if (most == 1) section[8*(place + RECORD*count + 4) +: 8] = 8'h00;
    end
  endfunction

  function [8*ROOM-1:0] content(input integer unused);
    integer k;
    begin
      content = 0;
      for (k = 0; k < ID_LENGTH; k = k + 1)
        content[8*(9+k+unused) +: 8] = SERVER_ID[8*(ID_LENGTH-1-k) +: 8];
      for (k = 0; k < MORE_LENGTH; k = k + 1)
        content[8*(9+ID_LENGTH+k) +: 8] = ADDITIONAL_DATA[8*(MORE_LENGTH-1-k) +: 8];
      if (HAS_OBJECTS) begin
        content[8*1 +: 8] = high(SECTION_1);
        content[8*2 +: 8] = high(SECTION_OF_2);
        content[8*3 +: 8] = high(SECTION_OF_3);
        content[8*4 +: 8] = high(SECTION_4);
        content[8*5 +: 8] = low(SECTION_1);
        content[8*6 +: 8] = low(SECTION_OF_2);
        content[8*7 +: 8] = low(SECTION_OF_3);
        content[8*8 +: 8] = low(SECTION_4);
        content = content | (OBJECT_TEXT << (8 * OBJECTS)) | section(SECTION_1, IN_1, 255);
        if (LEVEL >= 2)    content = content | section(SECTION_2, IN_2, 255);
        if (LEVEL >= 3)    content = content | section(SECTION_3, IN_3, 255);
        if (CONFORMITY[7]) content = content | section(SECTION_4, IN_3, 1);
      end
    end
  endfunction

  localparam [8*ROOM-1:0] CONTENT = content(0);

  (* rom_style = "block", ram_style = "block" *) reg [7:0] memory [0:(1<<W)-1];
  reg [7:0] data_q;
  integer   i;

  initial for (i = 0; i < (1 << W); i = i + 1) memory[i] = (i < ROOM) ? CONTENT[8*i +: 8] : 8'h00;

  always @(posedge clk_i) data_q <= memory[at_i[W-1:0]];

  assign data_o = data_q;

endmodule

`default_nettype wire
