// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// wishbone_rules - the rules of Wishbone B4, classic cycles, as properties of both sides, for proofs.
//
// Wishbone B4, 3.1.3: stb only under cyc, ack or err only with both, never together; 3.2: an access stays as it is until it
// is answered.  Instantiate it under `ifdef FORMAL in the module under proof; MASTER and SLAVE say what becomes of the rules
// of each side.

`default_nettype none

module wishbone_rules #(
  parameter integer ADDRESS_WIDTH = 19,
  parameter integer MASTER    = 0,               // 0: anything may happen, 1: assumed, 2: asserted
  parameter integer SLAVE     = 2,
  parameter integer WITHDRAWS = 0                // 1: the master may give up an access: stb falls unanswered
) (
  input  wire                     clk_i,
  input  wire                     rst_i,
  input  wire                     cyc,
  input  wire                     stb,
  input  wire                     we,
  input  wire [ADDRESS_WIDTH-1:0] adr,
  input  wire [15:0]              dat,           // from the master
  input  wire                     ack,
  input  wire                     err
);

  reg past = 1'b0;
  always @(posedge clk_i) past <= 1'b1;

  wire under    = !stb || cyc;
  wire answered = (!ack && !err) || (cyc && stb && !(ack && err));
  reg  kept;

  always @(posedge clk_i) begin
    kept = !$past(cyc && stb && !ack && !err) || (WITHDRAWS != 0 && !stb) ||
           (cyc && stb && $stable(we) && $stable(adr) && (!we || $stable(dat)));
    if (past && !$past(rst_i)) begin
      if (MASTER == 1) assume (kept);
      if (MASTER == 2) assert (kept);
    end
  end

  always @* if (past) begin
    if (MASTER == 1) assume (under);
    if (MASTER == 2) assert (under);
    if (SLAVE == 1) assume (answered);
    if (SLAVE == 2) assert (answered);
  end

endmodule

`default_nettype wire
