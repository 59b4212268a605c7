// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_axil_master - a bank for modbus_rtu_core whose items are words on an AXI4-Lite bus: Modbus as a bridge into a SoC.
//
// Item n of a table is the 32-bit word at byte address TABLE_AT + 4 * n, modulo 2^32: a register in bits 15..0, a bit in bit 0.
// A write is a whole word, the upper bits 0, all four strobes; of a word that is read the upper bits mean nothing.
// Record r of file f is word (f - 1) * FILE_RECORDS + r.  A 32-bit bus address is an address of AXI, so the tables
// may lie anywhere, and in one another.
//
// What exists, and what may be written, is said by modbus_bank_guard with the parameters of the other banks.  GUARD = 0
// leaves that out: leave grant_ack_o open and answer the core's question yourself.
//
// One transfer at a time, begun a clock after the core's stb; its end is the core's ack in the same clock.  SLVERR and
// DECERR are wb_err_o, exception 04.  All valid signals come from registers, no output ready hangs on a valid.
//
// A bus that does not answer is the core's stall limit's business (stall_limit_i; 0 waits for ever): the core gives
// up with exception 04, and the line goes on.  AXI has no way back from a valid, so the transfer stays on the bus
// until the bus has ended it, and its response is dropped.  Until then hung_o is high and each new beat gets
// wb_err_o at once, exception 04: nothing queues up, and one late write at most is the one that was on its way.
// Reset this module with the bus, not with the core alone.
//
// AXI4-Lite has no lock.  burst_o is high from before the first to behind the last transfer of a request: an
// arbiter that serves nobody else meanwhile keeps 16H, 17H and long reads in one piece.

`default_nettype none
`include "modbus_defs.vh"

module modbus_axil_master #(
  parameter [31:0]  COIL_AT     = 32'h00000000,          // byte address of coil 0, a multiple of 4
  parameter [31:0]  DISCRETE_AT = 32'h00040000,
  parameter [31:0]  INPUT_AT    = 32'h00080000,
  parameter [31:0]  HOLDING_AT  = 32'h000C0000,
  parameter [31:0]  FILE_AT     = 32'h00100000,
  parameter integer COIL_BASE = 0,      parameter integer COIL_COUNT = 64,       // count 0..65536; 0: no such table
  parameter integer DISCRETE_BASE = 0,  parameter integer DISCRETE_COUNT = 64,
  parameter integer INPUT_BASE = 0,     parameter integer INPUT_COUNT = 64,
  parameter integer HOLDING_BASE = 0,   parameter integer HOLDING_COUNT = 64,
  parameter integer READ_ONLY_BASE = 0, parameter integer READ_ONLY_COUNT = 0,
  parameter integer FILE_COUNT = 0,     parameter integer FILE_RECORDS = 256,
  parameter integer GUARD = 1                            // 0: the grant question is answered elsewhere
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
  output wire [3:0]  exception_o,                // 0 with wb_err_o
  input  wire        wb_cyc_i,
  input  wire        wb_stb_i,
  input  wire        wb_we_i,
  input  wire [18:0] wb_adr_i,
  input  wire [15:0] wb_dat_i,
  output wire [15:0] wb_dat_o,
  output wire        wb_ack_o,
  output wire        wb_err_o,

  // Bus
  output wire        burst_o,                    // level : transfers belong together
  output wire        hung_o,                     // level : the bus owes the end of a transfer nobody waits for
  output wire [31:0] m_axil_awaddr,
  output wire [2:0]  m_axil_awprot,              // 000: data, secure, unprivileged
  output wire        m_axil_awvalid,
  input  wire        m_axil_awready,
  output wire [31:0] m_axil_wdata,
  output wire [3:0]  m_axil_wstrb,
  output wire        m_axil_wvalid,
  input  wire        m_axil_wready,
  input  wire [1:0]  m_axil_bresp,
  input  wire        m_axil_bvalid,
  output wire        m_axil_bready,
  output wire [31:0] m_axil_araddr,
  output wire [2:0]  m_axil_arprot,
  output wire        m_axil_arvalid,
  input  wire        m_axil_arready,
  input  wire [31:0] m_axil_rdata,
  input  wire [1:0]  m_axil_rresp,
  input  wire        m_axil_rvalid,
  output wire        m_axil_rready
);

  generate
    if (COIL_AT[1:0] != 0 || DISCRETE_AT[1:0] != 0 || INPUT_AT[1:0] != 0 || HOLDING_AT[1:0] != 0 ||
        FILE_AT[1:0] != 0) begin : gen_places
      ERROR_modbus_axil_master_byte_address_of_a_table_is_a_multiple_of_4 illegal_parameter ();
    end
  endgenerate

  // Grant
  generate
    if (GUARD != 0) begin : gen_guard
      wire refused;
      wire unused = refused;                   // exception_o says it

      modbus_bank_guard #(
        .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
        .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
        .READ_ONLY_BASE(READ_ONLY_BASE), .READ_ONLY_COUNT(READ_ONLY_COUNT), .FILE_COUNT(FILE_COUNT),
        .FILE_RECORDS(FILE_RECORDS)
      ) u_guard (
        .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .hold_i(1'b0),
        .req_i(grant_req_i), .space_i(grant_space_i), .first_i(grant_first_i), .last_i(grant_last_i),
        .write_i(grant_write_i), .file_i(grant_file_i), .flat_i(1'b0), .ack_o(grant_ack_o), .refused_o(refused),
        .exception_o(exception_o)
      );
    end else begin : gen_no_guard
      wire unused = &{1'b0, write_lock_i, grant_req_i, grant_space_i, grant_first_i, grant_last_i, grant_write_i};
      assign grant_ack_o = 1'b0;
      assign exception_o = 4'd0;
    end
  endgenerate

  // Place of an item
  reg  [31:0] at;
  wire [15:0] skipped;                           // words before the file

  generate
    if (FILE_COUNT != 0) begin : gen_files
      wire [15:0] file = grant_file_i - 16'd1;   // files begin at 1
      assign skipped = (wb_adr_i[18:16] == `MB_SPACE_FILES) ? file * FILE_RECORDS[15:0] : 16'd0;
    end else begin : gen_no_files
      wire unused = &{1'b0, grant_file_i};
      assign skipped = 16'd0;
    end
  endgenerate

  always @* begin
    case (wb_adr_i[18:16])
      `MB_SPACE_COILS:     at = COIL_AT;
      `MB_SPACE_DISCRETES: at = DISCRETE_AT;
      `MB_SPACE_INPUTS:    at = INPUT_AT;
      `MB_SPACE_HOLDINGS:  at = HOLDING_AT;
      default:             at = FILE_AT;
    endcase
  end

  wire [15:0] word = wb_adr_i[15:0] + skipped;
  wire        bits = (wb_adr_i[18:17] == 2'b00);

  // The transfer
  reg         busy_q = 1'b0;                     // a transfer is on the bus
  reg         stale_q = 1'b0;                    // and the core has given it up
  reg         aw_q = 1'b0, w_q = 1'b0, ar_q = 1'b0;
  reg         write_q;
  reg  [31:0] address_q;                         // of its own: the core moves on when it gives up
  reg  [15:0] data_q;

  wire stb   = wb_cyc_i & wb_stb_i;
  wire begins = stb & ~busy_q;
  wire b_end = m_axil_bvalid & m_axil_bready;
  wire r_end = m_axil_rvalid & m_axil_rready;
  wire ends  = b_end | r_end;
  wire bad   = write_q ? m_axil_bresp[1] : m_axil_rresp[1];

  always @(posedge clk_i) begin
    if (begins) begin
      write_q   <= wb_we_i;
      address_q <= at + {14'd0, word, 2'b00};
      data_q    <= {wb_dat_i[15:1] & {15{~bits}}, wb_dat_i[0]};
    end
    busy_q  <= begins | (busy_q & ~ends);
    stale_q <= busy_q & ~ends & (stale_q | ~stb);
    aw_q    <= (begins & wb_we_i)  | (aw_q & ~m_axil_awready);
    w_q     <= (begins & wb_we_i)  | (w_q & ~m_axil_wready);
    ar_q    <= (begins & ~wb_we_i) | (ar_q & ~m_axil_arready);
    if (rst_i) begin
      busy_q  <= 1'b0;
      stale_q <= 1'b0;
      aw_q    <= 1'b0;
      w_q     <= 1'b0;
      ar_q    <= 1'b0;
    end
  end

  assign wb_dat_o = m_axil_rdata[15:0];
  assign wb_ack_o = stb & ~stale_q & ends & ~bad;
  assign wb_err_o = stb & (stale_q | (ends & bad));

  assign burst_o = wb_cyc_i;
  assign hung_o  = stale_q;

  assign m_axil_awaddr  = address_q;
  assign m_axil_awprot  = 3'b000;
  assign m_axil_awvalid = aw_q;
  assign m_axil_wdata   = {16'd0, data_q};
  assign m_axil_wstrb   = 4'b1111;
  assign m_axil_wvalid  = w_q;
  assign m_axil_bready  = busy_q & write_q & ~aw_q & ~w_q;
  assign m_axil_araddr  = address_q;
  assign m_axil_arprot  = 3'b000;
  assign m_axil_arvalid = ar_q;
  assign m_axil_rready  = busy_q & ~write_q & ~ar_q;

  wire unused = &{1'b0, m_axil_rdata[31:16], m_axil_bresp[0], m_axil_rresp[0]};

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);

  // What the bus has taken and not yet ended, counted from its side.
  reg f_aw = 1'b0, f_w = 1'b0, f_ar = 1'b0;
  always @(posedge clk_i) begin
    f_aw <= ~rst_i & ((m_axil_awvalid & m_axil_awready) | (f_aw & ~b_end));
    f_w  <= ~rst_i & ((m_axil_wvalid & m_axil_wready)   | (f_w & ~b_end));
    f_ar <= ~rst_i & ((m_axil_arvalid & m_axil_arready) | (f_ar & ~r_end));
  end
  // A bus answers what it was asked, and not before.
  always @* begin
    if (!(f_aw && f_w)) assume (!m_axil_bvalid);
    if (!f_ar) assume (!m_axil_rvalid);
  end

  always @(posedge clk_i) if (f_past && !$past(rst_i) && !rst_i) begin
    // Valid stays until it is taken, and so does what it says: whatever the core does meanwhile.
    if ($past(m_axil_awvalid && !m_axil_awready)) assert (m_axil_awvalid && $stable(m_axil_awaddr));
    if ($past(m_axil_wvalid && !m_axil_wready))   assert (m_axil_wvalid && $stable(m_axil_wdata));
    if ($past(m_axil_arvalid && !m_axil_arready)) assert (m_axil_arvalid && $stable(m_axil_araddr));
    // A transfer begins only with the core's stb, and never while another is on the bus.
    if (m_axil_awvalid && !$past(m_axil_awvalid)) assert ($past(stb && wb_we_i && !f_aw && !f_w && !f_ar && !ar_q));
    if (m_axil_wvalid && !$past(m_axil_wvalid))   assert (m_axil_awvalid && !$past(m_axil_awvalid));
    if (m_axil_arvalid && !$past(m_axil_arvalid)) assert ($past(stb && !wb_we_i && !f_aw && !f_w && !f_ar && !aw_q && !w_q));
    // What was given up is never answered with an ack, not even when the core asks for the next item.
    if ($past(busy_q && !stb && !ends)) assert (!wb_ack_o && hung_o);
    if (hung_o) assert (!wb_ack_o && wb_err_o == stb);
  end
  always @* if (f_past) begin
    assert (!(f_aw && aw_q) && !(f_w && w_q) && !(f_ar && ar_q));
    assert (busy_q == (f_aw || aw_q || f_ar || ar_q));
    assert ((f_aw || aw_q) == (f_w || w_q));
    assert (!((f_aw || aw_q) && (f_ar || ar_q)));
    assert (!(busy_q && write_q) || f_aw || aw_q);
    assert (!(busy_q && !write_q) || f_ar || ar_q);
    assert (!(wb_ack_o && wb_err_o));
    if (wb_ack_o) assert (stb && ends);
  end
  always @(posedge clk_i) if (f_past) begin
    cover ($past(hung_o) && !hung_o && !rst_i && !$past(rst_i));
    cover (wb_ack_o && write_q);
    cover (wb_err_o && !hung_o);
  end
`endif

endmodule

`default_nettype wire
