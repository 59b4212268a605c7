// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_run_ram - the memory of modbus_auto_line: lengths of the runs of a frame, and above them a table of rates.
//
// Words of 16 bits, in ticks of 32 * TOP_BAUD.  The table stands in the last 36 words and is never written: four words
// for each of nine rates, the fastest first:
//
//   shortest bit that counts as this rate, less one | longest one | the bit of this rate | not used
//
// read_o follows address_i one clock later; a word that is written shows from the next clock on.

`default_nettype none

module modbus_run_ram #(
  parameter integer ADDRESS_BITS = 8,            // 2^ADDRESS_BITS words
  parameter integer TOP_BAUD     = 230400,
  parameter [287:0] RATES        = {32'd230400, 32'd115200, 32'd57600, 32'd38400, 32'd19200, 32'd9600, 32'd4800, 32'd2400,
                                    32'd1200}    // nine rates, the fastest first; 0: none
) (
  input  wire                    clk_i,
  input  wire [ADDRESS_BITS-1:0] address_i,
  input  wire                    write_i,        // strobe
  input  wire [15:0]             write_dat_i,
  output wire [15:0]             read_o
);

  localparam integer RATE_COUNT = 9, TICK_HZ = 32 * TOP_BAUD, WORDS = 1 << ADDRESS_BITS;

  (* no_rw_check *) reg [15:0] memory [0:WORDS-1];
  reg  [15:0] read_q = 16'd0;

  // Words of the table: 0 to 3 of rate n.  Within 2 %; a run that is measured may be a tick short.
  function [15:0] entry(input integer n, input integer which);
    integer rate, ticks, value;
    begin
      rate  = RATES[32 * (RATE_COUNT - 1 - n) +: 32];
      ticks = (rate == 0) ? 0 : (TICK_HZ + rate / 2) / rate;
      value = (ticks == 0) ? 0 : (which == 0) ? ticks * 98 / 100 - 1 : (which == 1) ? ticks * 102 / 100 :
              (which == 2) ? ticks : 0;
      entry = value[15:0];
    end
  endfunction

  integer i;
  initial for (i = 0; i < WORDS; i = i + 1)
    memory[i] = (i < WORDS - 4 * RATE_COUNT) ? 16'd0 :
                entry((i - WORDS + 4 * RATE_COUNT) / 4, (i - WORDS + 4 * RATE_COUNT) % 4);

  always @(posedge clk_i) begin
    if (write_i) memory[address_i] <= write_dat_i;
    read_q <= memory[address_i];
  end

  assign read_o = read_q;

endmodule

`default_nettype wire
