// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_axil_slave - AXI4-Lite in front of a host port: a CPU reads and writes the tables, counters and settings.
//
// The host port is that of modbus_rtu_slave, modbus_host_map or modbus_bank_ram.  Its item n of a space is the 32-bit word
// at byte address {space, n, 00}, as modbus_axil_master has it by default.  A register is in bits 15..0, a bit in bit 0; the
// other bits read 0 and are ignored when written.  Address bits 1..0 are ignored.
// SLVERR means: no such item, which reads 0; or a write of half a register (one of strobes 1..0), because the memory
// writes whole registers only: use stores of 16 or 32 bits.  Of a bit only strobe 0 counts.  A write without any of the
// strobes that count is OKAY and does nothing.
//
// HOLD, the word at 1C0000H (space 7, item 0): while its bit 0 is 1 the memory stays with the CPU between accesses, so that
// several of them are one piece for the line, which waits, up to its stall limit.  A write of 1 is answered when the CPU
// has the memory: no burst of the line is running then.  The host port must answer ack or err to item 0 of space 7; the
// banks answer err.  HOLD = 0 as a parameter leaves it out.
//
// One access at a time; reads and writes take turns when both wait.  AWREADY and WREADY come together, for one clock after
// the access, once both AWVALID and WVALID are high.  No AXI output depends combinationally on an AXI input.  With the
// memory free a read takes 6 clocks from ARVALID to RVALID, and a write as long to BVALID.

`default_nettype none

module modbus_axil_slave #(
  parameter integer HOLD = 1
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // CPU
  input  wire [20:0] s_axil_awaddr,              // {space, item, 00}
  input  wire [2:0]  s_axil_awprot,              // ignored
  input  wire        s_axil_awvalid,
  output wire        s_axil_awready,
  input  wire [31:0] s_axil_wdata,
  input  wire [3:0]  s_axil_wstrb,
  input  wire        s_axil_wvalid,
  output wire        s_axil_wready,
  output wire [1:0]  s_axil_bresp,
  output wire        s_axil_bvalid,
  input  wire        s_axil_bready,
  input  wire [20:0] s_axil_araddr,
  input  wire [2:0]  s_axil_arprot,
  input  wire        s_axil_arvalid,
  output wire        s_axil_arready,
  output wire [31:0] s_axil_rdata,
  output wire [1:0]  s_axil_rresp,
  output wire        s_axil_rvalid,
  input  wire        s_axil_rready,

  // Memory: Wishbone B4 classic master; its host_*_o are the host_*_i of the memory
  output wire        host_cyc_o,
  output wire        host_stb_o,
  output wire        host_we_o,
  output wire [18:0] host_adr_o,
  output wire [15:0] host_dat_o,
  input  wire [15:0] host_dat_i,
  input  wire        host_ack_i,
  input  wire        host_err_i
);

  localparam [1:0] ST_IDLE = 2'd0, ST_LOOK = 2'd1, ST_ACCESS = 2'd2, ST_ACCEPT = 2'd3;
  localparam [18:0] HOLD_ADR = {3'd7, 16'd0};

  reg [1:0]  state_q = ST_IDLE, state_d;
  reg        write_q = 1'b0;                     // direction of the access, or of the last one
  reg        bvalid_q = 1'b0, rvalid_q = 1'b0;
  reg        bad_q, berr_q, rerr_q;
  reg        hold_q = 1'b0;
  reg [15:0] data_q;                             // the word read, until it is taken

  // An address is taken only after its access, so it is stable meanwhile and needs no register here.
  wire [18:0] adr   = write_q ? s_axil_awaddr[20:2] : s_axil_araddr[20:2];
  wire        own   = (HOLD != 0) & (adr == HOLD_ADR);
  wire        one_bit = (adr[18:17] == 2'b00) | own;
  wire        none  = write_q & ~s_axil_wstrb[0] & (one_bit | ~s_axil_wstrb[1]);
  wire        half  = write_q & (s_axil_wstrb[0] ^ s_axil_wstrb[1]) & ~one_bit;

  wire can_write = s_axil_awvalid & s_axil_wvalid & ~bvalid_q;
  wire can_read  = s_axil_arvalid & ~rvalid_q;
  wire ends      = host_ack_i | host_err_i;
  wire accept    = (state_q == ST_ACCEPT);

  always @* begin
    state_d = state_q;
    case (state_q)
      // Both directions are asked whether they want and could answer.
      ST_IDLE: if (can_write || can_read) state_d = ST_LOOK;
      // The address of the chosen one is shown: writes that write nothing need no memory.
      ST_LOOK: state_d = (none | half) ? ST_ACCEPT : ST_ACCESS;
      // The memory does it, or the line has the memory and the CPU waits.  HOLD waits too: a read that answers err.
      ST_ACCESS: if (ends) state_d = ST_ACCEPT;
      // Ready for one clock; the response is valid behind it.
      ST_ACCEPT: state_d = ST_IDLE;
      default: state_d = ST_IDLE;
    endcase
  end

  always @(posedge clk_i) begin
    state_q <= state_d;
    if (state_q == ST_IDLE) write_q <= can_write & ~(can_read & write_q);

    if (state_q == ST_LOOK) begin
      bad_q <= half;
      if (!write_q) data_q <= {15'd0, hold_q & own};     // 0 unless the memory has something
      if (own && write_q && !none) hold_q <= s_axil_wdata[0];
    end
    if (state_q == ST_ACCESS && ends) begin
      bad_q <= host_err_i & ~own;
      if (!write_q && host_ack_i && !own) data_q <= host_dat_i;
    end

    if (accept && write_q)  berr_q <= bad_q;
    if (accept && !write_q) rerr_q <= bad_q;
    bvalid_q <= (accept & write_q)  | (bvalid_q & ~s_axil_bready);
    rvalid_q <= (accept & ~write_q) | (rvalid_q & ~s_axil_rready);

    if (rst_i) begin
      state_q  <= ST_IDLE;
      bvalid_q <= 1'b0;
      rvalid_q <= 1'b0;
      hold_q   <= 1'b0;
    end
  end

  assign host_stb_o = (state_q == ST_ACCESS);
  assign host_cyc_o = host_stb_o | hold_q;
  assign host_we_o  = host_stb_o & write_q & ~own;
  assign host_adr_o = adr;
  assign host_dat_o = s_axil_wdata[15:0];

  assign s_axil_awready = accept & write_q;
  assign s_axil_wready  = accept & write_q;
  assign s_axil_bresp   = {berr_q, 1'b0};
  assign s_axil_bvalid  = bvalid_q;
  assign s_axil_arready = accept & ~write_q;
  assign s_axil_rdata   = {16'd0, data_q};
  assign s_axil_rresp   = {rerr_q, 1'b0};
  assign s_axil_rvalid  = rvalid_q;

  wire unused = &{1'b0, s_axil_awprot, s_axil_arprot, s_axil_awaddr[1:0], s_axil_araddr[1:0], s_axil_wdata[31:16],
                  s_axil_wstrb[3:2]};

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);

  wire f_aw, f_w, f_ar;                          // requests taken and not yet answered
  axil_rules #(.ADDRESS_WIDTH(21), .MASTER(0)) u_axil_rules (
    .clk_i(clk_i), .rst_i(rst_i), .awaddr(s_axil_awaddr), .awvalid(s_axil_awvalid), .awready(s_axil_awready),
    .wdata(s_axil_wdata), .wstrb(s_axil_wstrb), .wvalid(s_axil_wvalid), .wready(s_axil_wready), .bresp(s_axil_bresp),
    .bvalid(s_axil_bvalid), .bready(s_axil_bready), .araddr(s_axil_araddr), .arvalid(s_axil_arvalid),
    .arready(s_axil_arready), .rdata(s_axil_rdata), .rresp(s_axil_rresp), .rvalid(s_axil_rvalid),
    .rready(s_axil_rready), .aw_taken_o(f_aw), .w_taken_o(f_w), .ar_taken_o(f_ar)
  );
  wishbone_rules #(.MASTER(2), .SLAVE(1)) u_wishbone_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(host_cyc_o), .stb(host_stb_o), .we(host_we_o), .adr(host_adr_o),
    .dat(host_dat_o), .ack(host_ack_i), .err(host_err_i)
  );

  // The host port has accepted an access since host_cyc_o rose: the memory is the CPU's.
  reg f_mine = 1'b0;
  always @(posedge clk_i) f_mine <= ~rst_i & host_cyc_o & (f_mine | host_ack_i | host_err_i);

  always @* if (f_past) begin
    // Each request is answered once.
    assert (s_axil_bvalid == f_aw && f_aw == f_w);
    assert (s_axil_rvalid == f_ar);
    assert (s_axil_awready == s_axil_wready);
    if (s_axil_awready) assert (s_axil_awvalid && s_axil_wvalid);
    if (s_axil_arready) assert (s_axil_arvalid);
    // The memory is touched only for a request that stands.
    if (host_stb_o && host_we_o) assert (s_axil_awvalid && s_axil_wvalid && s_axil_wstrb[0] && host_adr_o == s_axil_awaddr[20:2]);
    if (host_stb_o && !host_we_o && !own) assert (s_axil_arvalid && host_adr_o == s_axil_araddr[20:2]);
    if (state_q != ST_IDLE && write_q)  assert (s_axil_awvalid && s_axil_wvalid && !f_aw);
    if (state_q != ST_IDLE && !write_q) assert (s_axil_arvalid && !f_ar);
    // A HOLD that is answered holds.
    if (hold_q && (state_q == ST_IDLE || accept)) assert (f_mine);
  end
  always @(posedge clk_i) if (f_past && !$past(rst_i) && !rst_i) begin
    // An error of the memory reaches the CPU; that of HOLD is none.
    if ($past(host_err_i))         assert (accept && bad_q == !own);
    if ($past(accept && write_q))  assert (s_axil_bresp == {$past(bad_q), 1'b0});
    if ($past(accept && !write_q)) assert (s_axil_rresp == {$past(bad_q), 1'b0});
  end
  always @(posedge clk_i) if (f_past) begin
    cover (s_axil_bvalid && s_axil_rvalid);
    cover (s_axil_rvalid && s_axil_rresp[1]);
    cover (hold_q && host_stb_o && $past(hold_q));
  end
`endif

endmodule

`default_nettype wire
