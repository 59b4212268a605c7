// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bit_clock - divides a bit into four quarters, exactly N clocks a bit for any N from 8 up.
//
// A quarter lasts N / 4 clocks, rounded up or down so that four quarters make N.  The room has two of these:
// modbus_uart restarts its own at every falling edge, a spike's too; that of modbus_line_timer runs on.
//
// restart_i makes the next clock the first of a new bit.  quarter_stb_o and bit_stb_o are high in the last clock
// of a quarter and of a bit.  Below 8 clocks a bit the strobes are not spaced as promised; nothing locks up.

`default_nettype none

module modbus_bit_clock (
  input  wire        clk_i,
  input  wire [15:0] bit_time_i,     // clocks per bit, 8..65535
  input  wire        restart_i,      // level : a bit begins in the next clock
  output wire        quarter_stb_o,  // strobe: a quarter ends
  output wire [1:0]  quarter_o,      // level : its number, 0..3
  output wire        bit_stb_o       // strobe: the bit ends
);

  // The count starts at the complement of N / 4 and ends near all ones, whatever N is.
  reg [13:0] clocks_q  = 14'd0;
  reg [1:0]  quarter_q = 2'd0;
  reg        stb_q     = 1'b1;       // at power-up the count is loaded first

  // The two low bits of N are paid out as extra clocks.  Two go to the middle quarters, which keeps a receiver's
  // three samples a full quarter apart and the second one in the middle of the bit; one goes to the end.
  wire extend = (quarter_q == 2'd3) ? bit_time_i[0] : (quarter_q != 2'd0) & bit_time_i[1];
  wire load   = restart_i | stb_q;
  // In an extended quarter the count reaches one more.  The strobe is a register, so its condition is true a clock earlier.
  wire ends   = (&clocks_q[13:2]) & (clocks_q[1] | (clocks_q[0] & ~extend));
  // The sum means nothing while the count is loaded; written so, sum and load share one cell a bit.
  wire [13:0] next = clocks_q + {{13{load}}, 1'b1};

  always @(posedge clk_i) begin
    stb_q    <= ends & ~load;
    clocks_q <= load ? ~bit_time_i[15:2] : next;
    if (restart_i)  quarter_q <= 2'd0;
    else if (stb_q) quarter_q <= quarter_q + 2'd1;
  end

  assign quarter_stb_o = stb_q;
  assign quarter_o     = quarter_q;
  assign bit_stb_o     = stb_q & (quarter_q == 2'd3);

`ifdef FORMAL
  // A bit that nothing restarts has exactly bit_time_i clocks, and its samples are a full quarter apart.
  reg        f_past = 1'b0;
  reg        f_whole = 1'b0;         // this bit began as a whole one
  reg [15:0] f_clock = 16'd0;        // clock of this bit, 0 is the first
  reg [15:0] f_edge = 16'd0;         // clock of this bit in which the last quarter ended

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (restart_i || bit_stb_o) begin
      f_whole <= restart_i | f_whole;
      f_clock <= 16'd0;
    end else begin
      f_clock <= f_clock + 16'd1;
    end
    if (quarter_stb_o) f_edge <= f_clock;
  end

  always @* assume (bit_time_i >= 16'd8);
  always @(posedge clk_i) if (f_past) assume ($stable(bit_time_i));

  wire [15:0] f_quarter = {2'd0, bit_time_i[15:2]};
  // Clocks of this bit before this quarter
  wire [15:0] f_before = (quarter_q == 2'd0) ? 16'd0 : (quarter_q == 2'd1) ? f_quarter :
                         (quarter_q == 2'd2) ? 2 * f_quarter + {15'd0, bit_time_i[1]} :
                                               3 * f_quarter + {14'd0, bit_time_i[1], 1'b0};

  always @(posedge clk_i) if (f_past && f_whole) begin
    assert (f_clock < bit_time_i);
    if (bit_stb_o) assert (f_clock + 16'd1 == bit_time_i);
    if (quarter_stb_o && quarter_q != 2'd0) assert (f_clock - f_edge >= f_quarter);
    // What makes that hold from clock to clock
    if (!stb_q) begin
      assert (f_clock >= f_before);
      assert (clocks_q == ~bit_time_i[15:2] + (f_clock[13:0] - f_before[13:0]));
      assert (f_clock - f_before <= f_quarter);
    end
    if (stb_q) assert (f_clock - f_before + 16'd1 == f_quarter + {15'd0, extend});
    if (quarter_q != 2'd0) assert (f_edge + 16'd1 == f_before);
  end
  always @(posedge clk_i) cover (f_whole && bit_stb_o && bit_time_i == 16'd11);
`endif

endmodule

`default_nettype wire
