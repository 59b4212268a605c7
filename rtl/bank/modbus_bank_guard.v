// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_guard - answers a bank's grant question: does the range exist, and may it be written?
//
// Exception 02 (illegal data address) when any address of the range is outside its table, when a write touches a
// read-only holding register, or while write_lock_i is high.  The answer comes one clock after the question,
// later while hold_i is high.  The last address is not below the first.  With OVERLAY the bits are those of the holding registers, sixteen to a
// register, and the input registers are the holding registers.

`default_nettype none
`include "modbus_defs.vh"

module modbus_bank_guard #(
  parameter integer COIL_BASE = 0,      parameter integer COIL_COUNT = 64,       // count 0..65536; 0: no such table
  parameter integer DISCRETE_BASE = 0,  parameter integer DISCRETE_COUNT = 64,
  parameter integer INPUT_BASE = 0,     parameter integer INPUT_COUNT = 64,
  parameter integer HOLDING_BASE = 0,   parameter integer HOLDING_COUNT = 64,
  parameter integer READ_ONLY_BASE = 0, parameter integer READ_ONLY_COUNT = 0,   // holding registers not to be written
  parameter integer FILE_COUNT = 0,     parameter integer FILE_RECORDS = 256,    // files 1..count, records 0.. of each
  parameter integer OVERLAY = 0
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,
  input  wire        hold_i,
  input  wire        req_i,          // level until ack_o
  input  wire [2:0]  space_i,
  input  wire [15:0] first_i,
  input  wire [15:0] last_i,
  input  wire        write_i,
  input  wire [15:0] file_i,         // space 4: file number
  input  wire        flat_i,         // level : space 4 is the records of all files in a row
  output wire        ack_o,          // strobe
  output wire        refused_o,      // level : a clock later, with or without req_i: what ack_o would bring is a refusal
  output wire [3:0]  exception_o     // level : with ack_o 0 or 02, else 0
);

  generate
    if (COIL_BASE < 0 || COIL_COUNT < 0 || COIL_BASE + COIL_COUNT > 65536 ||
        DISCRETE_BASE < 0 || DISCRETE_COUNT < 0 || DISCRETE_BASE + DISCRETE_COUNT > 65536 ||
        INPUT_BASE < 0 || INPUT_COUNT < 0 || INPUT_BASE + INPUT_COUNT > 65536 ||
        HOLDING_BASE < 0 || HOLDING_COUNT < 0 || HOLDING_BASE + HOLDING_COUNT > 65536) begin : gen_tables
      ERROR_modbus_bank_table_exceeds_addresses_0_to_65535 illegal_parameter ();
    end
    if (FILE_COUNT < 0 || FILE_COUNT > 65535 || FILE_RECORDS < 1 || FILE_RECORDS > 10000 ||
        FILE_COUNT > 65536 / FILE_RECORDS) begin : gen_files
      ERROR_modbus_bank_files_of_1_to_10000_records_hold_up_to_65536_in_all illegal_parameter ();
    end
    if (COIL_COUNT + DISCRETE_COUNT + INPUT_COUNT + HOLDING_COUNT + FILE_COUNT == 0) begin : gen_empty
      ERROR_modbus_bank_has_no_table illegal_parameter ();
    end
    if (READ_ONLY_COUNT < 0 || READ_ONLY_BASE < 0 || READ_ONLY_BASE + READ_ONLY_COUNT > 65536) begin : gen_read_only
      ERROR_modbus_bank_read_only_range_exceeds_addresses_0_to_65535 illegal_parameter ();
    end
    if (OVERLAY != 0 && (HOLDING_BASE != 0 || HOLDING_COUNT < 1)) begin : gen_overlay
      ERROR_modbus_bank_overlay_needs_HOLDING_BASE_0_and_a_register illegal_parameter ();
    end
  endgenerate

  localparam ITS_BITS  = (HOLDING_COUNT > 4096) ? 65536 : 16 * HOLDING_COUNT;
  localparam COILS     = (OVERLAY != 0) ? ITS_BITS : COIL_COUNT;
  localparam DISCRETES = (OVERLAY != 0) ? ITS_BITS : DISCRETE_COUNT;
  localparam INPUTS    = (OVERLAY != 0) ? HOLDING_COUNT : INPUT_COUNT;
  localparam COIL_LOW     = (OVERLAY != 0) ? 0 : COIL_BASE;
  localparam DISCRETE_LOW = (OVERLAY != 0) ? 0 : DISCRETE_BASE;
  localparam INPUT_LOW    = (OVERLAY != 0) ? 0 : INPUT_BASE;
  localparam RECORDS      = FILE_COUNT * FILE_RECORDS;

  // Tables from 0 on and of a power of two need no comparison: the bits above are 0 or they are not.
  localparam ROUND = COIL_LOW == 0 && DISCRETE_LOW == 0 && INPUT_LOW == 0 && HOLDING_BASE == 0 &&
                     (COILS & (COILS - 1)) == 0 && (DISCRETES & (DISCRETES - 1)) == 0 && (INPUTS & (INPUTS - 1)) == 0 &&
                     (HOLDING_COUNT & (HOLDING_COUNT - 1)) == 0 &&
                     (FILE_COUNT == 0 || ((RECORDS & (RECORDS - 1)) == 0 && (FILE_RECORDS & (FILE_RECORDS - 1)) == 0));

  // The file number: what is above the bits of FILE_COUNT, and those
  localparam FW = (FILE_COUNT > 0) ? $clog2(FILE_COUNT + 1) : 1;
  wire          many = ({1'b0, file_i} >> FW) != 17'd0;
  wire [FW-1:0] few  = file_i[FW-1:0];

  // First and last address of the table; where it is empty, nothing fits.
  reg [15:0] low, high;
  reg        exists;

  always @* begin
    case (space_i)
      `MB_SPACE_COILS: begin
        low = COIL_LOW[15:0];
        high = COIL_LOW[15:0] + COILS[15:0] - 16'd1;
        exists = (COILS != 0);
      end
      `MB_SPACE_DISCRETES: begin
        low = DISCRETE_LOW[15:0];
        high = DISCRETE_LOW[15:0] + DISCRETES[15:0] - 16'd1;
        exists = (DISCRETES != 0);
      end
      `MB_SPACE_INPUTS: begin
        low = INPUT_LOW[15:0];
        high = INPUT_LOW[15:0] + INPUTS[15:0] - 16'd1;
        exists = (INPUTS != 0);
      end
      `MB_SPACE_HOLDINGS: begin
        low = HOLDING_BASE[15:0];
        high = HOLDING_BASE[15:0] + HOLDING_COUNT[15:0] - 16'd1;
        exists = (HOLDING_COUNT != 0);
      end
      default: begin
        low = 16'd0;
        high = (flat_i ? RECORDS[15:0] : FILE_RECORDS[15:0]) - 16'd1;
        // With 1, 3, 7 ... files the last comparison is always true:
        // verilator lint_off CMPCONST
        exists = (FILE_COUNT != 0) & (space_i == `MB_SPACE_FILES) &
                 (flat_i | (~many & few != {FW{1'b0}} & few <= FILE_COUNT[FW-1:0]));
        // verilator lint_on CMPCONST
      end
    endcase
  end

  wire fits = (ROUND != 0) ? (last_i & ~high) == 16'd0 : (first_i >= low) & (last_i <= high);
  wire exists_all = exists & fits;
  wire locked;

  generate
    if (READ_ONLY_COUNT == 0) begin : gen_all_writable
      assign locked = write_lock_i;
    end else begin : gen_read_only_range
      localparam RO_LAST = READ_ONLY_BASE + READ_ONLY_COUNT - 1;
      wire       bits  = (space_i[2:1] == 2'b00);
      wire [15:0] first = bits ? {4'd0, first_i[15:4]} : first_i;
      wire [15:0] last  = bits ? {4'd0, last_i[15:4]}  : last_i;
      wire       touches = (first <= RO_LAST[15:0]) & (last >= READ_ONLY_BASE[15:0]) & (space_i != `MB_SPACE_FILES);
      assign locked = write_lock_i | (touches & (OVERLAY != 0 || !bits));
    end
  endgenerate

  reg ack_q = 1'b0, bad_q = 1'b0;

  always @(posedge clk_i) begin
    ack_q <= req_i & ~ack_q & ~hold_i & ~rst_i;
    bad_q <= ~exists_all | (write_i & locked);
  end

  assign ack_o       = ack_q & req_i;
  assign refused_o   = bad_q;
  assign exception_o = (ack_o & bad_q) ? `MB_EX_ILLEGAL_DATA_ADDRESS : 4'd0;

endmodule

`default_nettype wire
