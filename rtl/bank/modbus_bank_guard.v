// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_guard - answers the grant question of a bank: does the range exist, and may it be written?
//
// The answer is exception 02 (illegal data address) when an address of the range is outside its table, when a write
// touches a read-only holding register, or while write_lock_i is high.  It comes one clock after the question.  The last
// address is not below the first.  With OVERLAY the bits are those of the holding registers, sixteen to a register, and
// the input registers are the holding registers.
//
// A bank whose memory has a second user may share the comparison: while other_i is high the range shown is the other
// user's, and the question waits.  refused_o is the verdict on the range of one clock ago, whoever showed it.  While
// wait_i is high a grant waits, but a refusal does not: it needs no memory.

`default_nettype none
`include "modbus_defs.vh"

module modbus_bank_guard #(
`include "modbus_tables.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Question
  input  wire        req_i,          // level : until ack_o
  input  wire [2:0]  space_i,
  input  wire [15:0] first_i,
  input  wire [15:0] last_i,
  input  wire        write_i,
  input  wire [15:0] file_i,         // space 4: file number
  input  wire        flat_i,         // level : space 4 is the records of all files in a row
  input  wire        other_i,        // level : the range is not that of the question
  input  wire        wait_i,         // level : a grant waits

  // Answer
  output wire        ack_o,          // strobe
  output wire        refused_o,      // level : the range of one clock ago is refused
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

  // Tables that begin at 0 and hold a power of two need no comparison: the address bits above must be 0.
  localparam ROUND = COIL_LOW == 0 && DISCRETE_LOW == 0 && INPUT_LOW == 0 && HOLDING_BASE == 0 &&
                     (COILS & (COILS - 1)) == 0 && (DISCRETES & (DISCRETES - 1)) == 0 && (INPUTS & (INPUTS - 1)) == 0 &&
                     (HOLDING_COUNT & (HOLDING_COUNT - 1)) == 0 &&
                     (FILE_COUNT == 0 || ((RECORDS & (RECORDS - 1)) == 0 && (FILE_RECORDS & (FILE_RECORDS - 1)) == 0));

  // ------------------------------------------------------------------ which file exists

  wire file_exists;                  // 1..FILE_COUNT

  generate
    if (FILE_COUNT == 0) begin : gen_no_file
      wire unused = &{1'b0, file_i};
      assign file_exists = 1'b0;
    end else begin : gen_file
      localparam FW = $clog2(FILE_COUNT + 1);
      wire          many = ({1'b0, file_i} >> FW) != 17'd0;
      wire [FW-1:0] few  = file_i[FW-1:0];
      wire          past;            // above FILE_COUNT; a count of 1, 3, 7 ... fills its bits
      if (FILE_COUNT + 1 == 1 << FW) begin : gen_full
        assign past = 1'b0;
      end else begin : gen_part
        assign past = few > FILE_COUNT[FW-1:0];
      end
      assign file_exists = ~many & (few != {FW{1'b0}}) & ~past;
    end
  endgenerate

  // ------------------------------------------------------------------ the table of the space

  reg [15:0] low, high;              // first and last address
  reg        exists;                 // it is not empty

  always @* begin
    case (space_i)
      `MB_SPACE_COILS: begin
        low    = COIL_LOW[15:0];
        high   = COIL_LOW[15:0] + COILS[15:0] - 16'd1;
        exists = (COILS != 0);
      end
      `MB_SPACE_DISCRETES: begin
        low    = DISCRETE_LOW[15:0];
        high   = DISCRETE_LOW[15:0] + DISCRETES[15:0] - 16'd1;
        exists = (DISCRETES != 0);
      end
      `MB_SPACE_INPUTS: begin
        low    = INPUT_LOW[15:0];
        high   = INPUT_LOW[15:0] + INPUTS[15:0] - 16'd1;
        exists = (INPUTS != 0);
      end
      `MB_SPACE_HOLDINGS: begin
        low    = HOLDING_BASE[15:0];
        high   = HOLDING_BASE[15:0] + HOLDING_COUNT[15:0] - 16'd1;
        exists = (HOLDING_COUNT != 0);
      end
      default: begin
        low    = 16'd0;
        high   = (flat_i ? RECORDS[15:0] : FILE_RECORDS[15:0]) - 16'd1;
        exists = (FILE_COUNT != 0) & (space_i == `MB_SPACE_FILES) & (flat_i | file_exists);
      end
    endcase
  end

  wire fits = (ROUND != 0) ? (last_i & ~high) == 16'd0 : (first_i >= low) & (last_i <= high);

  // ------------------------------------------------------------------ what may be written

  wire locked;

  generate
    if (READ_ONLY_COUNT == 0) begin : gen_all_writable
      assign locked = write_lock_i;
    end else begin : gen_read_only_range
      localparam RO_LAST = READ_ONLY_BASE + READ_ONLY_COUNT - 1;
      wire        bits  = (space_i[2:1] == 2'b00);
      wire [15:0] first = bits ? {4'd0, first_i[15:4]} : first_i;
      wire [15:0] last  = bits ? {4'd0, last_i[15:4]}  : last_i;
      wire        below, above;    // the range lies below or above the read-only one
      if (READ_ONLY_BASE == 0) begin : gen_from_the_first
        wire unused = &{1'b0, last};
        assign below = 1'b0;
      end else begin : gen_from
        assign below = last < READ_ONLY_BASE[15:0];
      end
      if (RO_LAST == 65535) begin : gen_to_the_last
        wire unused = &{1'b0, first};
        assign above = 1'b0;
      end else begin : gen_to
        assign above = first > RO_LAST[15:0];
      end
      assign locked = write_lock_i |
                      (~below & ~above & (space_i != `MB_SPACE_FILES) & (OVERLAY != 0 || !bits));
    end
  endgenerate

  // ------------------------------------------------------------------ verdict

  wire refuse = ~exists | ~fits | (write_i & locked);
  reg  ack_q = 1'b0, refused_q = 1'b0;

  always @(posedge clk_i) begin
    ack_q     <= req_i & ~ack_q & ~other_i & (refuse | ~wait_i) & ~rst_i;
    refused_q <= refuse;
  end

  assign ack_o       = ack_q & req_i;
  assign refused_o   = refused_q;
  assign exception_o = (ack_o & refused_q) ? `MB_EX_ILLEGAL_DATA_ADDRESS : 4'd0;

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);
  always @* assume (first_i <= last_i);

  // What exists, in 17 bits and without the short cuts above
  wire f_bits = (space_i == `MB_SPACE_COILS) || (space_i == `MB_SPACE_DISCRETES);
  reg [17:0] f_low, f_end;                       // first address, and the one behind the last
  always @* begin
    case (space_i)
      `MB_SPACE_COILS:     begin f_low = COIL_BASE;     f_end = COIL_BASE + COIL_COUNT; end
      `MB_SPACE_DISCRETES: begin f_low = DISCRETE_BASE; f_end = DISCRETE_BASE + DISCRETE_COUNT; end
      `MB_SPACE_INPUTS:    begin f_low = INPUT_BASE;    f_end = INPUT_BASE + INPUT_COUNT; end
      `MB_SPACE_HOLDINGS:  begin f_low = HOLDING_BASE;  f_end = HOLDING_BASE + HOLDING_COUNT; end
      `MB_SPACE_FILES: begin
        f_low = 0;
        f_end = flat_i ? RECORDS : (file_i >= 1 && file_i <= FILE_COUNT) ? FILE_RECORDS : 0;
      end
      default:             begin f_low = 0; f_end = 0; end
    endcase
    if (OVERLAY != 0 && space_i < `MB_SPACE_FILES) begin
      f_low = 0;
      f_end = f_bits ? ((HOLDING_COUNT > 4096) ? 65536 : 16 * HOLDING_COUNT) : HOLDING_COUNT;
    end
  end
  wire f_inside = ({2'd0, first_i} >= f_low) && ({2'd0, last_i} < f_end);
  // The registers that a write touches, of which one may be read-only
  wire [17:0] f_first = (OVERLAY != 0 && f_bits) ? first_i / 16 : first_i;
  wire [17:0] f_last  = (OVERLAY != 0 && f_bits) ? last_i / 16 : last_i;
  wire f_registers = (space_i == `MB_SPACE_HOLDINGS) || (OVERLAY != 0 && f_bits);
  wire f_read_only = f_registers && f_first < READ_ONLY_BASE + READ_ONLY_COUNT && f_last >= READ_ONLY_BASE &&
                     READ_ONLY_COUNT != 0;
  wire f_allowed = f_inside && !(write_i && (write_lock_i || f_read_only));
  // Only coils, holding registers and files are ever written.
  always @* if (space_i == `MB_SPACE_INPUTS || space_i == `MB_SPACE_DISCRETES) assume (!write_i);

  always @(posedge clk_i) if (f_past) begin
    assert (refused_o == !$past(f_allowed));
    // Granted exactly where all of the range is there, and refused with 02 exactly where not, one clock behind the question.
    if (ack_o) assert (exception_o == ($past(f_allowed) ? 4'd0 : 4'd2));
    if (ack_o) assert ($past(req_i) && req_i && !$past(other_i));
    if (ack_o && $past(wait_i)) assert (exception_o != 4'd0);
    if (!ack_o) assert (exception_o == 4'd0);
    // It is answered once, and at once.
    if (ack_o) assert (!$past(ack_o));
    if (!$past(rst_i) && $past(req_i && !ack_o && !other_i && !wait_i) && req_i) assert (ack_o);
    if (!$past(rst_i) && $past(req_i && !ack_o && !other_i && !f_allowed) && req_i) assert (ack_o);
  end
  always @(posedge clk_i) if (f_past) begin
    cover (ack_o && exception_o == 4'd0 && $past(write_i));
    cover (ack_o && exception_o != 4'd0 && $past(wait_i));
  end
`endif

endmodule

`default_nettype wire
