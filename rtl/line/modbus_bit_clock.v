// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bit_clock - divides a bit into four quarters, exactly N clocks a bit for any N from 8 up.
//
// A quarter lasts N / 4 clocks, rounded up or down so that four quarters make N.  The room has two of these:
// modbus_uart restarts its own at every falling edge, a spike's too; that of modbus_line_timer runs on.
//
// With BIT_FRACTIONS = 1 a bit lasts N + fraction_i / 16 clocks on average: some bits have one clock more.  No bit then
// begins more than half a clock away from its exact place behind the restart.
//
// restart_i makes the next clock the first of a new bit.  quarter_stb_o and bit_stb_o are high in the last clock
// of a quarter and of a bit.  Below 8 clocks a bit the strobes are not spaced as promised; nothing locks up.

`default_nettype none

module modbus_bit_clock #(
  parameter integer MAX_BIT_TIME  = 65535, // no bit_time_i is above it; the count has no more bits than that takes
  parameter integer BIT_FRACTIONS = 0  // 1: fraction_i counts
) (
  input  wire        clk_i,
  input  wire [15:0] bit_time_i,     // clocks per bit, 8..MAX_BIT_TIME
  input  wire [3:0]  fraction_i,     // and so many sixteenths of a clock
  input  wire        restart_i,      // level : a bit begins in the next clock
  output wire        quarter_stb_o,  // strobe: a quarter ends
  output wire [1:0]  quarter_o,      // level : its number, 0..3
  output wire        bit_stb_o       // strobe: the bit ends
);

  // The count starts at the complement of N / 4 and ends near all ones, whatever N is, so the carry tells the end:
  //
  //   N = 53, N / 4 = 13     upper_q lower_q   ...FF0|10  ...FF0|11  ...FF1|00  ..  ...FFF|01  ...FFF|10   (load)
  //
  // The two low bits stand apart.  With them the end is known two clocks ahead: one for the strobe's register, one that
  // an extended quarter does not use.
  // Bits of the count above the two low ones
  localparam integer W = $clog2(MAX_BIT_TIME + 1);
  localparam integer U = (W > 16) ? 12 : (W < 8) ? 4 : W - 4;
  reg [U-1:0] upper_q   = {U{1'b0}};
  reg [1:0]  lower_q   = 2'd0;
  reg [1:0]  quarter_q = 2'd0;
  reg        stb_q     = 1'b1;       // at power-up the count is loaded first
  reg        bit_stb_q = 1'b0;       // it is the end of the bit

  // The two low bits of N are paid out as extra clocks.  Two go to the middle quarters, which keeps a receiver's
  // three samples a full quarter apart and the second one in the middle of the bit; one goes to the end.  That of the
  // fraction goes to the first quarter: the bit that gets it has begun early.
  wire       long_bit;
  wire       extend = (quarter_q == 2'd0) ? long_bit : (quarter_q == 2'd3) ? bit_time_i[0] : bit_time_i[1];
  wire       load   = restart_i | stb_q;
  // The sum means nothing while the count is loaded; written so, sum and load share one cell a bit.
  wire       full;
  wire [U-1:0] next;
  assign {full, next} = {1'b0, upper_q} + {1'b0, {(U-1){load}}, 1'b1};

  wire       ends = full & (lower_q[1] | (lower_q[0] & ~extend)) & ~load;

  always @(posedge clk_i) begin
    stb_q     <= ends;
    bit_stb_q <= ends & (quarter_q == 2'd3);
    lower_q <= load ? ~bit_time_i[3:2] : lower_q + 2'd1;
    if (load || lower_q == 2'd3) upper_q <= load ? ~bit_time_i[U+3:4] : next;
    if (restart_i)  quarter_q <= 2'd0;
    else if (stb_q) quarter_q <= quarter_q + 2'd1;
  end

  assign quarter_stb_o = stb_q;
  assign quarter_o     = quarter_q;
  assign bit_stb_o     = bit_stb_q;

  generate
    if (U < 12) begin : gen_narrow
      wire unused = ^bit_time_i[15:U+4];
    end
    if (BIT_FRACTIONS == 0) begin : gen_whole
      wire unused = &{1'b0, fraction_i};
      assign long_bit = 1'b0;
    end else begin : gen_fraction
      // Sixteenths that are due, rounded: from a half on.  Where they make a whole clock, the bit that begins gets it.
      reg [3:0] due_q = 4'd8;
      reg       long_q = 1'b0;
      always @(posedge clk_i)
        if (restart_i || bit_stb_o) {long_q, due_q} <= {1'b0, restart_i ? 4'd8 : due_q} + {1'b0, fraction_i};
      assign long_bit = long_q;
`ifdef FORMAL
      always @(posedge clk_i) if (f_past && f_whole)
        assert ($signed({3'd0, long_q, due_q}) == f_early + 8'sd8 + $signed({4'd0, fraction_i}));
      always @(posedge clk_i) cover (f_whole && bit_stb_o && bit_time_i == 16'd11 && f_clock == 17'd11);
`endif
    end
  endgenerate

`ifdef FORMAL
  // A bit that nothing restarts has exactly bit_time_i clocks, or one more for the fraction, and its samples are a full
  // quarter apart.  It begins at most half a clock from where the bits before it, fractions included, end.
  reg        f_past = 1'b0;
  reg        f_whole = 1'b0;         // this bit began as a whole one
  reg [16:0] f_clock = 17'd0;        // clock of this bit, 0 is the first
  reg [16:0] f_edge = 17'd0;         // clock of this bit in which the last quarter ended
  reg signed [7:0] f_early = 8'sd0;  // sixteenths of a clock that this bit began early
  wire [3:0] f_fraction = (BIT_FRACTIONS != 0) ? fraction_i : 4'd0;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (restart_i || bit_stb_o) begin
      f_whole <= restart_i | f_whole;
      f_clock <= 17'd0;
      f_early <= restart_i ? 8'sd0 : f_early + $signed({4'd0, f_fraction}) -
                                     ((f_clock == {1'b0, bit_time_i}) ? 8'sd16 : 8'sd0);
    end else begin
      f_clock <= f_clock + 17'd1;
    end
    if (quarter_stb_o) f_edge <= f_clock;
  end

  always @* assume (bit_time_i >= 16'd8 && bit_time_i <= MAX_BIT_TIME);
  always @(posedge clk_i) if (f_past) assume ($stable(bit_time_i) && $stable(fraction_i));

  wire [16:0] f_quarter = {3'd0, bit_time_i[15:2]};
  wire [16:0] f_length = {1'b0, bit_time_i} + {16'd0, long_bit};
  // Clocks of this bit before this quarter
  wire [16:0] f_before = (quarter_q == 2'd0) ? 17'd0 : (quarter_q == 2'd1) ? f_quarter + long_bit :
                         (quarter_q == 2'd2) ? 2 * f_quarter + bit_time_i[1] + long_bit :
                                               3 * f_quarter + {15'd0, bit_time_i[1], 1'b0} + long_bit;
  wire [13:0] f_count = ~bit_time_i[15:2] + (f_clock[13:0] - f_before[13:0]);

  always @(posedge clk_i) if (f_past && f_whole) begin
    assert (f_clock < f_length);
    if (bit_stb_o) assert (f_clock + 17'd1 == f_length);
    assert (f_early >= -8'sd8 && f_early < 8'sd8);
    if (quarter_stb_o && quarter_q != 2'd0) assert (f_clock - f_edge >= f_quarter);
    // What makes that hold from clock to clock
    if (!stb_q) begin
      assert (f_clock >= f_before);
      assert ({upper_q, lower_q} == f_count[U+1:0]);
      assert (f_clock - f_before <= f_quarter);
    end
    if (stb_q) assert (f_clock - f_before + 17'd1 == f_quarter + {16'd0, extend});
    if (quarter_q != 2'd0) assert (f_edge + 17'd1 == f_before);
  end
  always @(posedge clk_i) cover (f_whole && bit_stb_o && bit_time_i == 16'd11);
`endif

endmodule

`default_nettype wire
