// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_ram - the four tables and the files in block RAM, with a second Wishbone side for the host.
//
// One memory for bits, one for registers, one for file records, one port each: the two sides take turns.  Whoever has the memory keeps it
// while its cyc is high, so a burst of the line is one snapshot for the host and the other way round.
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

  modbus_bank_guard #(
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
    .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
    .READ_ONLY_BASE(READ_ONLY_BASE), .READ_ONLY_COUNT(READ_ONLY_COUNT), .FILE_COUNT(FILE_COUNT), .FILE_RECORDS(FILE_RECORDS),
    .OVERLAY(OVERLAY)
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .hold_i(host_q),
    .req_i(grant_req_i), .space_i(grant_space_i), .first_i(grant_first_i), .last_i(grant_last_i),
    .write_i(grant_write_i), .file_i(grant_file_i), .ack_o(grant_ack_o), .exception_o(exception_o)
  );

  wire        stb  = host_q ? host_cyc_i & host_stb_i : wb_stb_i & wb_cyc_i;
  // The core shows the address of a beat a clock before its strobe wherever cyc is already high; a master that
  // did not would read the item before.
  wire        show = host_q ? host_cyc_i & host_stb_i : wb_cyc_i;
  wire        we   = host_q ? host_we_i  : wb_we_i;
  wire [2:0]  space = host_q ? host_adr_i[18:16] : wb_adr_i[18:16];
  wire [15:0] item  = host_q ? host_adr_i[15:0]  : wb_adr_i[15:0];
  wire [15:0] data  = host_q ? host_dat_i : wb_dat_i;
  wire        ack   = stb & ready_q;
  wire        bits  = (space[2:1] == 2'b00);
  wire        exists;

  wire        files = (FILE_COUNT != 0) & space[2];
  wire [15:0] file_word;

  wire write = ack & we & (~host_q | exists);

  always @(posedge clk_i) begin
    host_q  <= host_cyc_i & (host_q | ~wb_cyc_i) & ~rst_i;
    ready_q <= show & ~ack & ~rst_i;
  end

  wire [15:0] table_word;
  wire        in_table;
  wire [15:0] read = files ? file_word : table_word;

  assign wb_ack_o   = ack & ~host_q;
  assign wb_dat_o   = read;
  assign host_ack_o = ack & host_q & exists;
  assign host_err_o = ack & host_q & ~exists;
  assign host_dat_o = read;

  generate
    if (FILE_COUNT != 0) begin : gen_files
      localparam RECORDS = FILE_COUNT * FILE_RECORDS;
      localparam FW = (RECORDS > 1) ? $clog2(RECORDS) : 1;
      (* no_rw_check *) reg [15:0] memory [0:RECORDS-1];
      reg  [15:0]   word_q;
      // Files begin at 1.  In the arithmetic of as many bits as the memory has the product is a shift where FILE_RECORDS
      // is a power of two.
      wire [16:0]   file    = {1'b0, grant_file_i} - 17'd1;
      wire [FW-1:0] skipped = file[FW-1:0] * FILE_RECORDS[FW-1:0];
      wire [FW-1:0] record  = host_q ? item[FW-1:0] : item[FW-1:0] + skipped;
      wire          unused  = &{1'b0, file};
      integer       i;

      initial for (i = 0; i < RECORDS; i = i + 1) memory[i] = 16'd0;

      always @(posedge clk_i) begin
        if (write && files) memory[record] <= data;
        word_q <= memory[record];
      end

      assign file_word = word_q;
      assign exists    = (space == `MB_SPACE_FILES) ? {1'b0, item} < RECORDS[16:0] : in_table;
    end else begin : gen_no_files
      assign file_word = 16'd0;
      assign exists    = in_table;
    end
  endgenerate

  generate
    if (OVERLAY != 0) begin : gen_overlay
      localparam W = (HOLDING_COUNT > 1) ? $clog2(HOLDING_COUNT) : 1;
      (* no_rw_check *) reg [15:0] memory [0:HOLDING_COUNT-1];
      reg  [15:0] word_q;
      wire [15:0] register = bits ? {4'd0, item[15:4]} : item;
      wire [15:0] mask     = bits ? 16'd1 << item[3:0] : 16'hFFFF;
      wire [15:0] source   = bits ? {16{data[0]}} : data;
      integer i;

      initial for (i = 0; i < HOLDING_COUNT; i = i + 1) memory[i] = 16'd0;

      always @(posedge clk_i) begin
        if (write && !files) memory[register[W-1:0]] <= (source & mask) | (word_q & ~mask);
        word_q <= memory[register[W-1:0]];
      end

      assign table_word = bits ? {15'd0, word_q[item[3:0]]} : word_q;
      assign in_table = (space <= `MB_SPACE_HOLDINGS) & ({1'b0, register} < HOLDING_COUNT[16:0]);
    end else begin : gen_tables
      // A memory without items is one word that is never written: nothing remains of it.
      localparam BITS  = (COIL_COUNT + DISCRETE_COUNT > 0) ? COIL_COUNT + DISCRETE_COUNT : 1;
      localparam WORDS = (HOLDING_COUNT + INPUT_COUNT > 0) ? HOLDING_COUNT + INPUT_COUNT : 1;
      localparam BW = (BITS > 1) ? $clog2(BITS) : 1, WW = (WORDS > 1) ? $clog2(WORDS) : 1;
      // Coils lie before discrete inputs, holding before input registers.
      localparam DISCRETE_SHIFT = COIL_COUNT - DISCRETE_BASE, INPUT_SHIFT = HOLDING_COUNT - INPUT_BASE;
      localparam COIL_SHIFT = -COIL_BASE, HOLDING_SHIFT = -HOLDING_BASE;

      wire [16:0]   place   = {1'b0, item};
      wire [BW-1:0] at_bit  = place[BW-1:0] + (space[0] ? DISCRETE_SHIFT[BW-1:0] : COIL_SHIFT[BW-1:0]);
      wire [WW-1:0] at_word = place[WW-1:0] + (space[0] ? HOLDING_SHIFT[WW-1:0]  : INPUT_SHIFT[WW-1:0]);
      wire [16:0]   low     = bits ? (space[0] ? DISCRETE_BASE[16:0] : COIL_BASE[16:0])
                                   : (space[0] ? HOLDING_BASE[16:0]  : INPUT_BASE[16:0]);
      wire [16:0]   size    = bits ? (space[0] ? DISCRETE_COUNT[16:0] : COIL_COUNT[16:0])
                                   : (space[0] ? HOLDING_COUNT[16:0]  : INPUT_COUNT[16:0]);
      (* no_rw_check *) reg        bit_memory  [0:BITS-1];
      (* no_rw_check *) reg [15:0] word_memory [0:WORDS-1];
      reg        bit_q;
      reg [15:0] word_q;
      integer    i;

      initial begin
        for (i = 0; i < BITS; i = i + 1)  bit_memory[i]  = 1'b0;
        for (i = 0; i < WORDS; i = i + 1) word_memory[i] = 16'd0;
      end

      always @(posedge clk_i) begin
        if (write && bits) bit_memory[at_bit] <= data[0];
        bit_q <= bit_memory[at_bit];
      end
      always @(posedge clk_i) begin
        if (write && !bits && !files) word_memory[at_word] <= data;
        word_q <= word_memory[at_word];
      end

      assign in_table   = (space <= `MB_SPACE_HOLDINGS) & (place - low < size);
      assign table_word = bits ? {15'd0, bit_q} : word_q;
    end
  endgenerate

endmodule

`default_nettype wire
