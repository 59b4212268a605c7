// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_io - the four tables as flat vectors: coils and holding registers out, discrete inputs and input registers in.
//
// For LEDs, relays, switches and sensors.  Item k of a table is bit k, register k is [16*k +: 16]; k counts from the base
// of the table.  A burst that writes changes one item every clock or two, not all at once.  A burst that reads samples
// each input when its item is read: a source holds a value that is wider than a register until it has been read.
// Inputs must be synchronous to clk_i.  Coils and holding registers are 0 after configuration and after rst_i.
// With READ_BACK_RAM = 1 each write of a holding register goes to a block RAM too, and reads take the word from there:
// the multiplexer over all registers goes.  Nothing else differs.
// Files and the overlay need a memory: modbus_bank_ram has them.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 16
`define MB_WORDS_DEFAULT 8

module modbus_bank_io #(
  parameter integer BITS_PER_BEAT = 1,           // 1 or 16, that of the core
`include "modbus_read_back.vh"
  ,
`include "modbus_tables.vh"
  ,
`include "modbus_table_widths.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Core: grant and Wishbone
`include "modbus_bank_ports.vh"
  ,

  // Tables
  output wire [COIL_WIDTH-1:0]     coils_o,
  input  wire [DISCRETE_WIDTH-1:0] discretes_i,
  input  wire [INPUT_WIDTH-1:0]    inputs_i,
  output wire [HOLDING_WIDTH-1:0]  holdings_o
);

  generate
    if (FILE_COUNT != 0 || OVERLAY != 0) begin : gen_illegal
      ERROR_modbus_bank_io_has_no_files_and_no_overlay illegal_parameter ();
    end
    if (READ_BACK_RAM < 0 || READ_BACK_RAM > 1) begin : gen_read_back_illegal
      ERROR_modbus_bank_io_READ_BACK_RAM_must_be_0_or_1 illegal_parameter ();
    end
  endgenerate

  wire refused;
  wire unused = &{1'b0, refused, grant_file_i};  // exception_o says what was refused

  modbus_bank_guard #(
`include "modbus_tables_inst.vh"
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .req_i(grant_req_i), .space_i(grant_space_i),
    .first_i(grant_first_i), .last_i(grant_last_i), .write_i(grant_write_i), .file_i(16'd0), .flat_i(1'b0),
    .other_i(1'b0), .wait_i(1'b0), .ack_o(grant_ack_o), .refused_o(refused), .exception_o(exception_o)
  );

  reg [COIL_WIDTH-1:0]    coils_q = 0;
  reg [HOLDING_WIDTH-1:0] holdings_q = 0;
  reg                     ready_q = 1'b0;
  reg [15:0]              read_q;

  wire [2:0]  space = wb_adr_i[18:16];
  // The range was granted, so address bits that are the same for all items of a table are not read:
  // verilator lint_off UNUSED
  wire [15:0] item  = wb_adr_i[15:0];
  // verilator lint_on UNUSED
  wire        ack   = wb_cyc_i & wb_stb_i & ready_q;
  wire        write_coil    = ack & wb_we_i & (space == `MB_SPACE_COILS);
  wire        write_holding = ack & wb_we_i & (space == `MB_SPACE_HOLDINGS);

  // Which item of each table
  localparam HW = (HOLDING_COUNT > 1)  ? $clog2(HOLDING_COUNT) : 1;

  wire [HW-1:0] holding  = item[HW-1:0] - HOLDING_BASE[HW-1:0];
  wire [15:0]   word_in, word_out;
  wire [15:0]   coils_in, discretes_in;          // the data of a beat of bits
  integer       h;

  generate
    if (INPUT_COUNT > 1) begin : gen_inputs
      localparam IW = $clog2(INPUT_COUNT);
      wire [IW-1:0] in_word = item[IW-1:0] - INPUT_BASE[IW-1:0];
      assign word_in = inputs_i[{in_word, 4'd0} +: 16];
    end else begin : gen_input
      assign word_in = inputs_i[15:0];
    end
    if (READ_BACK_RAM != 0 && HOLDING_COUNT > 0) begin : gen_read_back_ram
      // A RAM keeps its words through rst_i: until a register has been written its word comes from word_out, which is 0.
      (* no_rw_check *) reg [15:0] memory [0:HOLDING_COUNT-1];
      reg [15:0]              memory_q;
      reg                     from_memory_q;
      reg [HOLDING_COUNT-1:0] written_q = 0;
      integer                 w;

      always @(posedge clk_i) begin
        if (write_holding) memory[holding] <= wb_dat_i;
        memory_q      <= memory[holding];
        from_memory_q <= (space == `MB_SPACE_HOLDINGS) & written_q[holding];
        for (w = 0; w < HOLDING_COUNT; w = w + 1)
          if (rst_i)                                       written_q[w] <= 1'b0;
          else if (write_holding && holding == w[HW-1:0])  written_q[w] <= 1'b1;
      end

      assign word_out = 16'd0;
      assign wb_dat_o = from_memory_q ? memory_q : read_q;
    end else if (HOLDING_COUNT > 1) begin : gen_holdings
      assign wb_dat_o = read_q;
      assign word_out = holdings_q[{holding, 4'd0} +: 16];
    end else begin : gen_holding
      assign wb_dat_o = read_q;
      assign word_out = holdings_q[15:0];
    end
  endgenerate

  always @(posedge clk_i) begin
    ready_q <= wb_cyc_i & ~ack & ~rst_i;
    case (space)
      `MB_SPACE_COILS:     read_q <= coils_in;
      `MB_SPACE_DISCRETES: read_q <= discretes_in;
      `MB_SPACE_INPUTS:    read_q <= word_in;
      default:             read_q <= word_out;
    endcase
  end

  generate
    if (BITS_PER_BEAT != 1) begin : gen_words_of_bits
      // The tables as words of 16 addresses: item n is bit n mod 16
      localparam integer CLOW = COIL_BASE % 16,     COIL_WORDS = (COIL_COUNT + CLOW + 15) / 16,
                         DLOW = DISCRETE_BASE % 16, DISCRETE_WORDS = (DISCRETE_COUNT + DLOW + 15) / 16;
      localparam CW = (COIL_WORDS > 1)     ? $clog2(COIL_WORDS) : 1;
      localparam DW = (DISCRETE_WORDS > 1) ? $clog2(DISCRETE_WORDS) : 1;
      localparam integer COIL_WORD = COIL_BASE / 16, DISCRETE_WORD = DISCRETE_BASE / 16;
      wire [CW-1:0] coil     = item[4 +: CW] - COIL_WORD[CW-1:0];
      wire [DW-1:0] discrete = item[4 +: DW] - DISCRETE_WORD[DW-1:0];
      // A replication beyond 8192 is doubted; a table has up to 65536 items.
      // verilator lint_off WIDTHCONCAT
      wire [COIL_WIDTH + 16*(1<<CW) - 1:0]     coils     = {{16*(1<<CW){1'b0}}, coils_q}     << CLOW;
      wire [DISCRETE_WIDTH + 16*(1<<DW) - 1:0] discretes = {{16*(1<<DW){1'b0}}, discretes_i} << DLOW;
      // verilator lint_on WIDTHCONCAT
      wire [15:0]   lanes;
      integer       c;
      modbus_bank_lanes u_lanes (.first_i(item), .last_i(grant_last_i), .lanes_o(lanes));
      assign coils_in     = coils[{1'b0, coil, 4'd0} +: 16];
      assign discretes_in = discretes[{1'b0, discrete, 4'd0} +: 16];
      always @(posedge clk_i)
        for (c = CLOW; c < COIL_COUNT + CLOW; c = c + 1)
          if (rst_i)
            coils_q[c - CLOW] <= 1'b0;
          else if (write_coil && lanes[c % 16] && (COIL_WORDS == 1 || coil == c[4 +: CW]))
            coils_q[c - CLOW] <= wb_dat_i[c % 16];
    end else begin : gen_single_bits
      localparam CW = (COIL_COUNT > 1)     ? $clog2(COIL_COUNT) : 1;
      localparam DW = (DISCRETE_COUNT > 1) ? $clog2(DISCRETE_COUNT) : 1;
      wire [CW-1:0] coil     = item[CW-1:0] - COIL_BASE[CW-1:0];
      wire [DW-1:0] discrete = item[DW-1:0] - DISCRETE_BASE[DW-1:0];
      integer       c;
      assign coils_in     = {15'd0, coils_q[coil]};
      assign discretes_in = {15'd0, discretes_i[discrete]};
      always @(posedge clk_i)
        for (c = 0; c < COIL_COUNT; c = c + 1)
          if (rst_i)                                  coils_q[c] <= 1'b0;
          else if (write_coil && coil == c[CW-1:0])   coils_q[c] <= wb_dat_i[0];
    end
  endgenerate

  always @(posedge clk_i)
    for (h = 0; h < HOLDING_COUNT; h = h + 1)
      if (rst_i)                                       holdings_q[16*h +: 16] <= 16'd0;
      else if (write_holding && holding == h[HW-1:0])  holdings_q[16*h +: 16] <= wb_dat_i;

  assign wb_ack_o   = ack;
  assign wb_err_o   = 1'b0;
  assign coils_o    = coils_q;
  assign holdings_o = holdings_q;

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);

  // The core keeps its bus: within a cycle the address is there a clock before a strobe that does not follow an
  // acknowledge, and what was granted exists.
  wire [15:0] f_place = wb_adr_i[15:0] - HOLDING_BASE;
  always @* if (wb_cyc_i && wb_stb_i && space == `MB_SPACE_HOLDINGS) assume (f_place < HOLDING_COUNT);
  always @(posedge clk_i) if (f_past && $past(wb_cyc_i && !wb_ack_o) && wb_cyc_i && wb_stb_i) assume ($stable(wb_adr_i));

  // A holding register reads as its output shows it.
  wire [15:0] f_shown = holdings_o >> {f_place, 4'd0};
  wire f_reads = f_past & wb_ack_o & ~wb_we_i & (space == `MB_SPACE_HOLDINGS);
  always @* if (f_reads) assert (wb_dat_o == f_shown);
  always @(posedge clk_i) begin
    cover (f_reads && wb_dat_o == 16'hA55A);
    cover (f_reads && wb_dat_o == 16'd0 && $past(holdings_o[15:0], 8) == 16'hA55A && $past(rst_i, 4));
  end
`endif

endmodule

`default_nettype wire
