// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_run_ram - the memory of modbus_auto_line: lengths of the runs of a frame, and above them a table of rates.
//
// Words of 16 bits, in ticks of 2^PACE clocks.  The table stands in the last 64 words and is never written: four words
// for each of nine rates, the fastest first, then zeros:
//
//   shortest bit that counts as this rate, less one | longest one | the bit of this rate in clocks | not used
//
// read_o follows address_i one clock later; a word that is written shows from the next clock on.

`default_nettype none

module modbus_run_ram #(
  parameter integer ADDRESS_BITS = 8,            // 2^ADDRESS_BITS words
  parameter integer CLK_HZ = 50000000,
  parameter integer PACE   = 3,
  parameter [287:0] RATES  = 288'd0              // nine rates, the fastest first; 0: none
) (
  input  wire                    clk_i,
  input  wire [ADDRESS_BITS-1:0] address_i,
  input  wire                    write_i,        // strobe
  input  wire [15:0]             write_dat_i,
  output wire [15:0]             read_o
);

  localparam integer RATE_COUNT = 9, TICK_HZ = CLK_HZ >> PACE, WORDS = 1 << ADDRESS_BITS, TABLE = WORDS - 64;

  (* no_rw_check *) reg [15:0] memory [0:WORDS-1];
  reg  [15:0] read_q = 16'd0;

  // Words of the table: 0 to 3 of rate n.  Within 2 %, rounded to ticks
  function [15:0] entry(input integer n, input integer which);
    integer rate, ticks;
    // verilator lint_off UNUSED
    integer value;                               // below 2^16 for every rate that can be found
    // verilator lint_on UNUSED
    begin
      rate  = RATES[32 * (RATE_COUNT - 1 - n) +: 32];
      ticks = (rate == 0) ? 0 : (TICK_HZ + rate / 2) / rate;
      value = (ticks == 0) ? 0 : (which == 0) ? (ticks * 98 + 49) / 100 - 1 : (which == 1) ? (ticks * 102 + 50) / 100 :
              (which == 2) ? (CLK_HZ + rate / 2) / rate : 0;
      entry = value[15:0];
    end
  endfunction

  integer i;
  initial for (i = 0; i < WORDS; i = i + 1)
    memory[i] = (i < TABLE || i >= TABLE + 4 * RATE_COUNT) ? 16'd0 : entry((i - TABLE) / 4, (i - TABLE) % 4);

  always @(posedge clk_i) begin
    if (write_i) memory[address_i] <= write_dat_i;
    read_q <= memory[address_i];
  end

  assign read_o = read_q;

endmodule

`default_nettype wire
