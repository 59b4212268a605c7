// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_units - further addresses of one core: which of them a frame is for.
//
// A frame is for us if its address byte is MB_SET_ADDRESS, a bit of UNIT_SET, or, with UNIT_PORT = 1, one for which the host
// holds ours_i high.  unit_o shows the address byte a clock before the verdict, and ours_i may depend on it in the
// same clock.  unit_o then holds the unit of the request until the next frame is judged; 0 is a broadcast, which is
// one request, whatever the units.  0 and 248..255 are never units.
//
// With UNIT_SET = 0 and UNIT_PORT = 0 nothing of this takes a cell, and unit_o is 0.

`default_nettype none

module modbus_units #(
  parameter [247:0] UNIT_SET     = 248'd0,          // bit n: address n is ours too, n in 1..247
  parameter integer UNIT_PORT = 0                // 1: ours_i counts
) (
  input  wire       clk_i,
  input  wire       look_i,          // strobe: byte_i is the address of the frame in the next clock
  input  wire [7:0] byte_i,
  input  wire       ours_i,          // level : unit_o is a unit of ours
  output wire [7:0] unit_o,
  output wire       also_o           // level : byte_i is a further address
);

  generate
    if (UNIT_PORT < 0 || UNIT_PORT > 1 || UNIT_SET[0]) begin : gen_illegal
      ERROR_modbus_UNIT_SET_has_no_bit_0_and_UNIT_PORT_is_0_or_1 illegal_parameter ();
    end
    if (UNIT_SET == 248'd0 && UNIT_PORT == 0) begin : gen_none
      wire unused = &{1'b0, clk_i, look_i, byte_i, ours_i};
      assign unit_o = 8'd0;
      assign also_o = 1'b0;
    end else begin : gen_units
      localparam [255:0] SET = {8'd0, UNIT_SET};
      reg       here_q = 1'b0;
      reg [7:0] unit_q = 8'd0;
      wire      legal  = (byte_i != 8'd0) & (byte_i[7:3] != 5'h1F);
      always @(posedge clk_i) begin
        here_q <= look_i;
        if (here_q) unit_q <= byte_i;
      end
      assign unit_o = here_q ? byte_i : unit_q;
      assign also_o = SET[byte_i] | ((UNIT_PORT != 0) & ours_i & legal);
    end
  endgenerate

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* begin
    assert (!also_o || (byte_i >= 8'd1 && byte_i <= 8'd247));
    if (UNIT_PORT == 0 || !ours_i) assert (also_o == (byte_i < 8'd248 && UNIT_SET[byte_i]));
  end
  always @(posedge clk_i) if (f_past) begin
    // The unit is that of the frame that was looked at last.
    if ($past(look_i)) assert (unit_o == byte_i || (UNIT_SET == 248'd0 && UNIT_PORT == 0));
    if (!$past(look_i) && $past(f_past)) assert ($stable(unit_o));
    cover (also_o);
  end
`endif

endmodule

`default_nettype wire
