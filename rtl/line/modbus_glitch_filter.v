// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_glitch_filter - takes short pulses out of the received signal, by option.
//
// A pulse of up to CLOCKS clocks, high or low, is not seen.  Every edge comes CLOCKS + 1 clocks late, both alike, so the
// length of a bit does not change.  With CLOCKS = 0 it is a wire.

`default_nettype none

module modbus_glitch_filter #(
  parameter integer CLOCKS = 0       // 0..255, at most a quarter of a bit
) (
  input  wire clk_i,
  input  wire level_i,               // level : synchronised
  output wire level_o
);

  generate
    if (CLOCKS < 0 || CLOCKS > 255) begin : gen_illegal
      ERROR_modbus_GLITCH_FILTER_from_0_to_255 illegal_parameter ();
    end
    if (CLOCKS == 0) begin : gen_wire
      wire unused = &{1'b0, clk_i};
      assign level_o = level_i;
    end else begin : gen_filter
      localparam W = $clog2(CLOCKS + 1);
      reg         level_q = 1'b1;
      reg [W-1:0] count_q = {W{1'b0}};             // clocks for which level_i has differed
      always @(posedge clk_i)
        if (level_i == level_q) begin
          count_q <= {W{1'b0}};
        end else if (count_q == CLOCKS[W-1:0]) begin
          level_q <= level_i;
          count_q <= {W{1'b0}};
        end else begin
          count_q <= count_q + 1'b1;
        end
      assign level_o = level_q;
`ifdef FORMAL
      // The output changes exactly when the input has differed from it for CLOCKS + 1 clocks in a row.
      reg [8:0] f_differs = 9'd0;
      reg       f_past = 1'b0;
      always @(posedge clk_i) begin
        f_past    <= 1'b1;
        f_differs <= (level_i == level_q || f_differs == CLOCKS) ? 9'd0 : f_differs + 9'd1;
        if (f_past) assert ((level_q != $past(level_q)) == ($past(f_differs) == CLOCKS && $past(level_i != level_q)));
        assert (count_q == f_differs[W-1:0] && f_differs <= CLOCKS);
        cover (f_past && level_q && !$past(level_q));
      end
`endif
    end
  endgenerate

endmodule

`default_nettype wire
