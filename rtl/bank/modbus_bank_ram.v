// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_ram - the four tables and the files in block RAM, with a second Wishbone side for the host.
//
// Registers and file records share a memory, bits have one of their own unless they fit beside the registers; one port
// each: the two sides take turns.  Whoever has the memory keeps it while its cyc is high, so a burst of the line is
// one snapshot for the host and the other way round.
// A burst takes two clocks an item; the longest, 2000 coils, makes the host wait 4001 clocks.  The host may hold
// host_cyc_i over several accesses to read or write a block in one piece; meanwhile the core waits, up to its stall limit.
//
// Host side: Wishbone B4 classic, address {space, item} as on the line; ack two clocks after stb when free, err for an
// address outside the tables.  All tables are writable by the host.  Record r of file f is item (f - 1) * FILE_RECORDS + r
// of space 4.
//
// OVERLAY = 1: one block of HOLDING_COUNT registers (MODBUS Application Protocol V1.1b3, clause 4.3, device
// with one block); coil and discrete input n are bit n mod 16 of register n / 16, input registers are the
// holding registers.  Contents are 0 after configuration and survive rst_i.

`default_nettype none
`include "modbus_defs.vh"

module modbus_bank_ram #(
  parameter integer COIL_BASE = 0,      parameter integer COIL_COUNT = 64,       // count 0..65536; 0: no such table
  parameter integer DISCRETE_BASE = 0,  parameter integer DISCRETE_COUNT = 64,
  parameter integer INPUT_BASE = 0,     parameter integer INPUT_COUNT = 64,
  parameter integer HOLDING_BASE = 0,   parameter integer HOLDING_COUNT = 64,
  parameter integer READ_ONLY_BASE = 0, parameter integer READ_ONLY_COUNT = 0,
  parameter integer FILE_COUNT = 0,     parameter integer FILE_RECORDS = 256,
  parameter integer OVERLAY = 0
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Core: grant and Wishbone
  input  wire        grant_req_i,
  input  wire [2:0]  grant_space_i,
  input  wire [15:0] grant_first_i,
  input  wire [15:0] grant_last_i,
  input  wire        grant_write_i,
  input  wire [15:0] grant_file_i,
  output wire        grant_ack_o,
  output wire [3:0]  exception_o,
  input  wire        wb_cyc_i,
  input  wire        wb_stb_i,
  input  wire        wb_we_i,
  input  wire [18:0] wb_adr_i,
  input  wire [15:0] wb_dat_i,
  output wire [15:0] wb_dat_o,
  output wire        wb_ack_o,

  // Host: Wishbone
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o
);

  reg host_q = 1'b0;                 // the memory is the host's
  reg ready_q = 1'b0;                // the memory's output belongs to the address now shown

  wire        stb  = host_q ? host_cyc_i & host_stb_i : wb_stb_i & wb_cyc_i;
  // The core shows the address of a beat a clock before its strobe wherever cyc is already high; a master that
  // did not would read the item before.
  wire        show = host_q ? host_cyc_i & host_stb_i : wb_cyc_i;
  wire        we   = host_q ? host_we_i  : wb_we_i;
  wire [2:0]  space = host_q ? host_adr_i[18:16] : wb_adr_i[18:16];
  wire [15:0] item  = host_q ? host_adr_i[15:0]  : wb_adr_i[15:0];
  wire        ack   = stb & ready_q;
  wire        bits  = (space[2:1] == 2'b00);
  wire        refused;               // the host's address is outside the tables
  wire        write = ack & we & ~(host_q & refused);
  wire [15:0] read;

  always @(posedge clk_i) begin
    host_q  <= host_cyc_i & (host_q | ~wb_cyc_i) & ~rst_i;
    ready_q <= show & ~ack & ~rst_i;
  end

  assign wb_ack_o   = ack & ~host_q;
  assign wb_dat_o   = read;
  assign host_ack_o = ack & host_q & ~refused;
  assign host_err_o = ack & host_q & refused;
  assign host_dat_o = read;

  // The guard's question is the core's, or with the memory in the host's hands one for the item that the host shows.
  modbus_bank_guard #(
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
    .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
    .READ_ONLY_BASE(READ_ONLY_BASE), .READ_ONLY_COUNT(READ_ONLY_COUNT), .FILE_COUNT(FILE_COUNT), .FILE_RECORDS(FILE_RECORDS),
    .OVERLAY(OVERLAY)
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .hold_i(host_q), .flat_i(host_q), .req_i(grant_req_i),
    .space_i(host_q ? space : grant_space_i), .first_i(host_q ? item : grant_first_i),
    .last_i(host_q ? item : grant_last_i), .write_i(grant_write_i & ~host_q), .file_i(grant_file_i),
    .ack_o(grant_ack_o), .refused_o(refused), .exception_o(exception_o)
  );

  // ------------------------------------------------------------------ where an item is

  // Holding registers, input registers, file records; then coils and discrete inputs, a word each, where that takes no
  // more blocks of 256 words than a memory of their own.  In the overlay the bits are those of the registers.
  localparam REGISTERS = (OVERLAY != 0) ? HOLDING_COUNT : HOLDING_COUNT + INPUT_COUNT;
  localparam FILES_END = REGISTERS + FILE_COUNT * FILE_RECORDS;
  localparam BITS      = (OVERLAY != 0) ? 0 : COIL_COUNT + DISCRETE_COUNT;
  localparam BESIDE    = (FILES_END + BITS + 255) / 256 <= (FILES_END + 255) / 256 + (BITS + 4095) / 4096;
  localparam ITEMS     = (BESIDE != 0) ? FILES_END + BITS : FILES_END;
  localparam WORDS     = (ITEMS > 0) ? ITEMS : 1;              // a word that is never written: nothing remains of it
  localparam W         = (WORDS > 1) ? $clog2(WORDS) : 1;

  localparam integer COIL_SHIFT    = FILES_END - COIL_BASE,     DISCRETE_SHIFT = FILES_END + COIL_COUNT - DISCRETE_BASE,
                     HOLDING_SHIFT = -HOLDING_BASE,             INPUT_SHIFT    = HOLDING_COUNT - INPUT_BASE;

  // Files begin at 1.  In the arithmetic of as many bits as the memory has the product is a shift where FILE_RECORDS
  // is a power of two.
  // The widths are those of the largest memory:
  // verilator lint_off UNUSED
  wire [17:0]  file    = {2'd0, grant_file_i} - 18'd1;
  wire [17:0]  place   = (OVERLAY != 0 && bits) ? {6'd0, item[15:4]} : {2'd0, item};
  // verilator lint_on UNUSED
  reg  [W-1:0] file_shift_q;         // the file is known long before its burst
  reg  [W-1:0] shift;

  always @(posedge clk_i) file_shift_q <= REGISTERS[W-1:0] + file[W-1:0] * FILE_RECORDS[W-1:0];

  always @* begin
    case (space)
      `MB_SPACE_COILS:     shift = COIL_SHIFT[W-1:0];
      `MB_SPACE_DISCRETES: shift = DISCRETE_SHIFT[W-1:0];
      `MB_SPACE_INPUTS:    shift = INPUT_SHIFT[W-1:0];
      `MB_SPACE_HOLDINGS:  shift = HOLDING_SHIFT[W-1:0];
      default:             shift = REGISTERS[W-1:0];
    endcase
    if (OVERLAY != 0 && !space[2]) shift = {W{1'b0}};
    if (FILE_COUNT != 0 && space[2] && !host_q) shift = file_shift_q;
  end

  // ------------------------------------------------------------------ the memories

  wire [15:0]  given = host_q ? host_dat_i : wb_dat_i;
  wire         apart = bits & (BITS != 0) & (BESIDE == 0);      // the bit memory's
  wire [W-1:0] at    = place[W-1:0] + shift;
  wire [15:0]  data;

  (* no_rw_check *) reg [15:0] words [0:WORDS-1];
  reg [15:0] word_q;
  integer    i;

  initial for (i = 0; i < WORDS; i = i + 1) words[i] = 16'd0;

  always @(posedge clk_i) begin
    if (write && !apart && ITEMS != 0) words[at] <= data;
    word_q <= words[at];
  end

  generate
    if (OVERLAY != 0) begin : gen_overlay
      wire [15:0] mask = bits ? 16'd1 << item[3:0] : 16'hFFFF;
      assign data = ((bits ? {16{given[0]}} : given) & mask) | (word_q & ~mask);
      assign read = bits ? {15'd0, word_q[item[3:0]]} : word_q;
    end else if (BESIDE != 0) begin : gen_beside
      assign data = {given[15:1] & {15{~bits}}, given[0]};
      assign read = word_q;
    end else begin : gen_apart
      localparam BW = $clog2(BITS);
      localparam integer COIL_PLACE = -COIL_BASE, DISCRETE_PLACE = COIL_COUNT - DISCRETE_BASE;
      (* no_rw_check *) reg memory [0:BITS-1];
      reg           bit_q, bits_q;       // bits_q: it is one that was read
      wire [BW-1:0] at_bit = place[BW-1:0] + (space[0] ? DISCRETE_PLACE[BW-1:0] : COIL_PLACE[BW-1:0]);
      integer       k;

      initial for (k = 0; k < BITS; k = k + 1) memory[k] = 1'b0;

      always @(posedge clk_i) begin
        if (write && bits) memory[at_bit] <= given[0];
        bit_q  <= memory[at_bit];
        bits_q <= bits;
      end

      assign data = given;
      assign read = bits_q ? {15'd0, bit_q} : word_q;
    end
  endgenerate

endmodule

`default_nettype wire
