// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_crc16 - CRC-16 of the serial line, one bit a clock, fed with the bits as they pass on the line.
//
// Polynomial x^16 + x^15 + x^2 + 1, reflected (A001H), start FFFFH, least significant bit first, no final
// inversion (MODBUS over Serial Line V1.02, clause 6.2.2).  Over a whole good frame, check field included, the
// register ends at zero.  With feed_i low the register shifts out as it goes on the line: low
// byte first, each byte least significant bit first, at bit_o.

`default_nettype none

module modbus_crc16 (
  input  wire clk_i,
  input  wire clear_i,       // strobe: back to FFFFH
  input  wire shift_i,       // strobe: take data_i, or give out one bit
  input  wire feed_i,        // level : 1 take in, 0 give out
  input  wire data_i,        // level : the bit, with shift_i
  output wire bit_o,         // level : next check bit for the line
  output wire zero_o         // level : remainder is zero
);

  reg  [15:0] crc_q = 16'hFFFF;
  wire        feedback = feed_i & (crc_q[0] ^ data_i);

  always @(posedge clk_i) begin
    if (clear_i)      crc_q <= 16'hFFFF;
    else if (shift_i) crc_q <= {1'b0, crc_q[15:1]} ^ (feedback ? 16'hA001 : 16'h0000);
  end

  assign bit_o  = crc_q[0];
  assign zero_o = (crc_q == 16'h0000);

`ifdef FORMAL
  // Sending the register, or receiving what it holds, empties it: after n such bits its n highest bits are zero.
  reg [4:0] f_own = 5'd0;
  wire      f_same = ~feed_i | (data_i == bit_o);

  always @(posedge clk_i)
    if (clear_i) f_own <= 5'd0;
    else if (shift_i) f_own <= !f_same ? 5'd0 : (f_own == 5'd16) ? 5'd16 : f_own + 5'd1;

  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;

  always @(posedge clk_i) begin
    assert (f_own <= 5'd16);
    assert ((crc_q >> (5'd16 - f_own)) == 16'd0);
    assert (f_own != 5'd16 || zero_o);
    if (f_past && $past(clear_i)) assert (crc_q == 16'hFFFF);
    // One step of x^16 + x^15 + x^2 + 1, written the other way round: bit by bit.
    if (f_past && !$past(clear_i) && $past(shift_i) && $past(feed_i)) begin
      assert (crc_q[15] == ($past(crc_q[0]) ^ $past(data_i)));
      assert (crc_q[13] == ($past(crc_q[14]) ^ crc_q[15]));
      assert (crc_q[0]  == ($past(crc_q[1]) ^ crc_q[15]));
      assert (crc_q[14] == $past(crc_q[15]) && crc_q[12:1] == $past(crc_q[13:2]));
    end
    cover (f_past && zero_o && f_own == 5'd16);
  end
`endif

endmodule

`default_nettype wire
