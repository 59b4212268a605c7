// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_health_ram - the words of modbus_line_health: sixteen, one is read or written in a clock.
//
// A word comes one clock after its address; in a clock that writes nothing is read, and word_o stays.

`default_nettype none

module modbus_health_ram (
  input  wire        clk_i,
  input  wire        write_i,        // strobe
  input  wire [3:0]  write_adr_i,
  input  wire [15:0] write_dat_i,
  input  wire [3:0]  read_adr_i,
  output wire [15:0] word_o
);

  (* no_rw_check, ram_style = "block" *) reg [15:0] memory [0:15];
  reg [15:0] word_q;

  integer i;
  initial for (i = 0; i < 16; i = i + 1) memory[i] = 16'd0;

  always @(posedge clk_i) begin
    if (write_i) memory[write_adr_i] <= write_dat_i;
    else word_q <= memory[read_adr_i];
  end

  assign word_o = word_q;

endmodule

`default_nettype wire
