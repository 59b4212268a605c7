// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_axil_master - a bank for modbus_rtu_core whose items are words on an AXI4-Lite bus: a bridge from Modbus into a SoC.
//
// Item n of a table is the 32-bit word at byte address TABLE_AT + 4 * n, modulo 2^32: a register in bits 15..0, a bit in bit 0.
// A write is a whole word with all four strobes and 0 in the upper bits.  The upper bits of a word that is read are ignored.
// Record r of file f is word (f - 1) * FILE_RECORDS + r.  The tables may lie anywhere on the bus, and may overlap.
//
// modbus_bank_guard answers the grant question with the table parameters of the other banks; OVERLAY is not for a bus.
// GUARD = 0 leaves the guard out: leave grant_ack_o open and answer the question of the core elsewhere.  Give the core the
// TABLE_CODES of modbus_table_codes.vh, so that function codes of a table of size 0 answer 01 as with every bank.
//
// One transfer at a time.  It begins one clock after wb_stb_i, and wb_ack_o comes in the clock in which it ends.  SLVERR and
// DECERR are wb_err_o, exception 04.  Valid signals are registers; no ready output depends combinationally on a valid.
//
// A bus that does not answer is cut off by the stall limit of the core (0 waits for ever): the core gives up with
// exception 04, and the line goes on.  An AXI valid cannot be withdrawn, so the transfer stays on the bus until the bus ends
// it, and its response is dropped.  Until then hung_o is high and each new beat gets wb_err_o at once, exception 04.
// Nothing queues up: at most the one write that was on its way is done late.
// Reset this module together with the bus, not with the core alone.
//
// AXI4-Lite has no lock.  burst_o is high from before the first to after the last transfer of a request: an
// arbiter that serves no other master meanwhile keeps 16H, 17H and long reads in one piece.

`default_nettype none
`include "modbus_defs.vh"

module modbus_axil_master #(
  parameter [31:0]  COIL_AT     = 32'h00000000,          // byte address of coil 0, a multiple of 4
  parameter [31:0]  DISCRETE_AT = 32'h00040000,
  parameter [31:0]  INPUT_AT    = 32'h00080000,
  parameter [31:0]  HOLDING_AT  = 32'h000C0000,
  parameter [31:0]  FILE_AT     = 32'h00100000,
  parameter integer GUARD       = 1,                     // 0: the grant question is answered elsewhere
`include "modbus_tables.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Core: grant and Wishbone
`include "modbus_bank_ports.vh"
  ,

  // Bus
  output wire        burst_o,                    // level : the transfers belong together
  output wire        hung_o,                     // level : the bus owes the end of a transfer that the core gave up
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
    if (OVERLAY != 0) begin : gen_overlay
      ERROR_modbus_axil_master_has_no_overlay illegal_parameter ();
    end
  endgenerate

  // Grant
  generate
    if (GUARD != 0) begin : gen_guard
      wire refused;
      wire unused = refused;                   // exception_o says it

      modbus_bank_guard #(
`include "modbus_tables_inst.vh"
      ) u_guard (
        .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .req_i(grant_req_i), .space_i(grant_space_i),
        .first_i(grant_first_i), .last_i(grant_last_i), .write_i(grant_write_i), .file_i(grant_file_i), .flat_i(1'b0),
        .other_i(1'b0), .wait_i(1'b0), .ack_o(grant_ack_o), .refused_o(refused), .exception_o(exception_o)
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
  reg  [31:0] address_q;                         // held here: the core moves on when it gives up
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

  // The rules of the bus, and what it has taken and not yet ended
  wire f_aw, f_w, f_ar;
  axil_rules #(.ADDRESS_WIDTH(32), .MASTER(1)) u_axil_rules (
    .clk_i(clk_i), .rst_i(rst_i), .awaddr(m_axil_awaddr), .awvalid(m_axil_awvalid), .awready(m_axil_awready),
    .wdata(m_axil_wdata), .wstrb(m_axil_wstrb), .wvalid(m_axil_wvalid), .wready(m_axil_wready), .bresp(m_axil_bresp),
    .bvalid(m_axil_bvalid), .bready(m_axil_bready), .araddr(m_axil_araddr), .arvalid(m_axil_arvalid),
    .arready(m_axil_arready), .rdata(m_axil_rdata), .rresp(m_axil_rresp), .rvalid(m_axil_rvalid),
    .rready(m_axil_rready), .aw_taken_o(f_aw), .w_taken_o(f_w), .ar_taken_o(f_ar)
  );

  // Nothing is assumed of the core.
  wishbone_rules u_wishbone_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(wb_cyc_i), .stb(wb_stb_i), .we(wb_we_i), .adr(wb_adr_i), .dat(wb_dat_i),
    .ack(wb_ack_o), .err(wb_err_o)
  );

  always @(posedge clk_i) if (f_past && !$past(rst_i) && !rst_i) begin
    // A transfer begins only with the core's stb, and never while another is on the bus.
    if (m_axil_awvalid && !$past(m_axil_awvalid)) assert ($past(stb && wb_we_i && !f_aw && !f_w && !f_ar && !ar_q));
    if (m_axil_wvalid && !$past(m_axil_wvalid))   assert (m_axil_awvalid && !$past(m_axil_awvalid));
    if (m_axil_arvalid && !$past(m_axil_arvalid)) assert ($past(stb && !wb_we_i && !f_aw && !f_w && !f_ar && !aw_q && !w_q));
    // What was given up is never answered with an ack, not even when the core asks for the next item.
    if ($past(busy_q && !stb && !ends)) assert (!wb_ack_o && hung_o);
    if (hung_o) assert (!wb_ack_o && wb_err_o == stb);
  end
  always @* if (f_past) begin
    assert (!(f_aw && aw_q) && !(f_w && w_q) && !(f_ar && ar_q));    // one transfer at a time
    assert (busy_q == (f_aw || aw_q || f_ar || ar_q));
    assert ((f_aw || aw_q) == (f_w || w_q));
    assert (!((f_aw || aw_q) && (f_ar || ar_q)));
    assert (!(busy_q && write_q) || f_aw || aw_q);
    assert (!(busy_q && !write_q) || f_ar || ar_q);
    if (wb_ack_o) assert (ends);
  end
  always @(posedge clk_i) if (f_past) begin
    cover ($past(hung_o) && !hung_o && !rst_i && !$past(rst_i));
    cover (wb_ack_o && write_q);
    cover (wb_err_o && !hung_o);
  end
`endif

endmodule

`default_nettype wire
