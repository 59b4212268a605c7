// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// axil_rules - the rules of AXI4-Lite as properties of both sides, for proofs.
//
// AMBA AXI and ACE Protocol Specification: A3.2.1, a valid and what it says stay until ready; A3.3.1, a response follows
// what it answers; A3.1.2, no valid behind a reset.  Each direction has at most one transfer on its way, as in the bridges
// of this project.  Instantiate it under `ifdef FORMAL in the module under proof, say which side that is, and it asserts the
// rules of this side and assumes those of the other.

`default_nettype none

module axil_rules #(
  parameter integer ADDRESS_WIDTH = 32,
  parameter integer MASTER        = 1            // 1: the module under proof is the master, 0: the slave
) (
  input  wire                     clk_i,
  input  wire                     rst_i,
  input  wire [ADDRESS_WIDTH-1:0] awaddr,
  input  wire                     awvalid,
  input  wire                     awready,
  input  wire [31:0]              wdata,
  input  wire [3:0]               wstrb,
  input  wire                     wvalid,
  input  wire                     wready,
  input  wire [1:0]               bresp,
  input  wire                     bvalid,
  input  wire                     bready,
  input  wire [ADDRESS_WIDTH-1:0] araddr,
  input  wire                     arvalid,
  input  wire                     arready,
  input  wire [31:0]              rdata,
  input  wire [1:0]               rresp,
  input  wire                     rvalid,
  input  wire                     rready,
  output wire                     aw_taken_o,    // level: taken and not yet answered
  output wire                     w_taken_o,
  output wire                     ar_taken_o
);

  reg past = 1'b0;                               // there was a clock before this one
  reg aw_q = 1'b0, w_q = 1'b0, ar_q = 1'b0;

  always @(posedge clk_i) begin
    past <= 1'b1;
    aw_q <= ~rst_i & ((awvalid & awready) | (aw_q & ~(bvalid & bready)));
    w_q  <= ~rst_i & ((wvalid & wready)   | (w_q & ~(bvalid & bready)));
    ar_q <= ~rst_i & ((arvalid & arready) | (ar_q & ~(rvalid & rready)));
  end

  assign aw_taken_o = aw_q;
  assign w_taken_o  = w_q;
  assign ar_taken_o = ar_q;

  reg aw_kept, w_kept, ar_kept, b_kept, r_kept;
  always @(posedge clk_i) begin
    aw_kept = !$past(awvalid && !awready) || (awvalid && $stable(awaddr));
    w_kept  = !$past(wvalid && !wready) || (wvalid && $stable(wdata) && $stable(wstrb));
    ar_kept = !$past(arvalid && !arready) || (arvalid && $stable(araddr));
    b_kept  = !$past(bvalid && !bready) || (bvalid && $stable(bresp));
    r_kept  = !$past(rvalid && !rready) || (rvalid && $stable(rdata) && $stable(rresp));

    if (past && !$past(rst_i)) begin
      if (MASTER != 0) begin
        assert (aw_kept);
        assert (w_kept);
        assert (ar_kept);
        assume (b_kept && r_kept);
      end else begin
        assume (aw_kept && w_kept && ar_kept);
        assert (b_kept);
        assert (r_kept);
      end
    end
    if (past && $past(rst_i)) begin
      if (MASTER != 0) assert (!awvalid && !wvalid && !arvalid);
      else             assert (!bvalid && !rvalid);
    end
  end

  // Sides may not answer what they were not asked, nor ask before the answer.
  always @* if (past) begin
    if (MASTER != 0) begin
      if (!(aw_q && w_q)) assume (!bvalid);
      if (!ar_q) assume (!rvalid);
      if (!rst_i) assert (!(awvalid && aw_q) && !(wvalid && w_q) && !(arvalid && ar_q));
    end else if (!rst_i) begin
      if (!(aw_q && w_q)) assert (!bvalid);
      if (!ar_q) assert (!rvalid);
      assert (!(awready && aw_q) && !(wready && w_q) && !(arready && ar_q));
    end
  end

endmodule

`default_nettype wire
