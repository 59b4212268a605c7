// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_lanes - which data bits a beat of sixteen bits moves, for a bank with BITS_PER_BEAT = 16.
//
// Item n of a table of bits is data bit n mod 16.  A beat moves the items from its address on to the end of their word
// of 16 addresses, but none behind the last item of the request, grant_last_i.  With first = last it is one item.

`default_nettype none

module modbus_bank_lanes (
  input  wire [15:0] first_i,        // level : the address of the beat
  input  wire [15:0] last_i,         // level : last item of the request, not below first_i
  output wire [15:0] lanes_o         // level : bit k: data bit k is an item of the beat
);

  wire       ends   = (first_i[15:4] == last_i[15:4]);
  wire [3:0] end_at = last_i[3:0] | {4{~ends}};

  assign lanes_o = (16'hFFFF << first_i[3:0]) & (16'hFFFF >> ~end_at);

`ifdef FORMAL
  (* anyconst *) reg [3:0] f_lane;
  wire [15:0] f_item = {first_i[15:4], f_lane};
  always @* begin
    assume (first_i <= last_i);
    assert (lanes_o[f_lane] == (f_item >= first_i && f_item <= last_i));
    assert (lanes_o[first_i[3:0]]);
  end
`endif

endmodule

`default_nettype wire
