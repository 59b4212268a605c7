// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_line_timer - measures silence (t1.5, t3.5) and the waits of the answer, in bit times.
//
// Its bit clock is its own.  A spike does not reach this module, so it can neither stop a wait nor stretch a silence.
//
// Silence.  t1.5 and t3.5 are the later of 1.5 / 3.5 character times and a floor in clocks.  That gives the character
// times up to 19200 baud and the fixed 750 / 1750 us above (MODBUS over Serial Line V1.02, clause 2.5.1.1).
//   Silence counts from the end of the last stop bit.  receiving_i falls when the first stop bit is decided, half a bit
//   earlier, with a second stop bit one and a half: those halves are counted off first, so that nothing ends early.
//   Behind reset, restart_i and our own characters there is nothing to count off.
//   Resolution: half a bit for the character times, a clock for the floors.
//
// Waits.  While wait_clear_i is low bits are counted; wait_over_o rises a clock behind the last of wait_limit_i.
//   With wait_ticks_i it counts ticks of 2^TICK_BITS clocks of silence instead, up to tick_limit_i.
//   wait_stb_i begins a whole bit, so that the wait is not a part of one short.  A wait that runs is not disturbed by
//   characters; a silence during one may be measured half a bit short.

`default_nettype none
`include "modbus_defs.vh"

module modbus_line_timer #(
  parameter integer MAX_BIT_TIME  = 65535,  // no bit_time_i is above it
  parameter integer BIT_FRACTIONS = 0,      // 1: fraction_i counts
  parameter integer T15_CLOCKS = 37500,     // floor of t1.5 in clocks, 0: none
  parameter integer T35_CLOCKS = 87500,     // floor of t3.5 in clocks, 0: none; not below T15_CLOCKS
  parameter integer TICK_BITS  = 0          // 0: wait_ticks_i is 0; else at least the bits of T35_CLOCKS
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [15:0] bit_time_i,
  input  wire [3:0]  fraction_i,     // sixteenths of a clock beyond bit_time_i
  input  wire [1:0]  format_i,

  // Silence
  input  wire        receiving_i,    // level : a character is on the line
  input  wire        sending_i,      // level : we put one onto it
  input  wire        restart_i,      // strobe: silence counts anew
  output wire        t15_o,          // level : silent for t1.5; still valid in the first clock of receiving_i
  output wire        t35_o,          // level : silent for t3.5
  output wire        rest_o,         // level : the last stop bits have not ended, or a character is on the line

  // Waits
  input  wire        wait_stb_i,     // strobe: a wait of whole bits begins
  input  wire        wait_clear_i,   // level : nothing is waited for
  input  wire [15:0] wait_limit_i,   // bit times
  input  wire        wait_short_i,   // level : only the low four bits of the limit count
  input  wire        wait_ticks_i,   // level : ticks of silence are counted
  input  wire [15:0] tick_limit_i,
  output wire        wait_over_o     // level : the limit is reached; with limit 0 a clock behind wait_clear_i
);

  generate
    if (T15_CLOCKS < 0 || T35_CLOCKS < T15_CLOCKS || T35_CLOCKS >= (1 << 28) ||
        (TICK_BITS != 0 && TICK_BITS < $clog2(T35_CLOCKS + 1))) begin : gen_illegal
      ERROR_modbus_line_timer_floor_of_t35_below_floor_of_t15 illegal_parameter ();
    end
  endgenerate

  // Halves of a bit: in t1.5 and t3.5, and from the middle of the first stop bit to the end of the last
  localparam [6:0] T15_11 = 7'd33, T15_10 = 7'd30, T35_11 = 7'd77, T35_10 = 7'd70;
  localparam [6:0] REST_1 = -7'd1, REST_2 = -7'd3;           // below 0

  wire [6:0] t15 = (format_i == `MB_FORMAT_8N1) ? T15_10 : T15_11;
  wire [6:0] t35 = (format_i == `MB_FORMAT_8N1) ? T35_10 : T35_11;

  wire       quarter_stb, bit_stb;
  wire [1:0] quarter;
  wire       half_stb = quarter_stb & quarter[0];
  wire       unused   = &{1'b0, quarter[1], wait_ticks_i, tick_limit_i, tick};

  // Silence begins with a whole bit.  A wait that begins in this clock is a clock too late to matter.
  reg        no_wait_q = 1'b1;
  always @(posedge clk_i) no_wait_q <= wait_clear_i;

  modbus_bit_clock #(.MAX_BIT_TIME(MAX_BIT_TIME), .BIT_FRACTIONS(BIT_FRACTIONS)) u_bit_clock (
    .clk_i(clk_i), .bit_time_i(bit_time_i), .fraction_i(fraction_i),
    .restart_i(rst_i | restart_i | sending_i | wait_stb_i | (receiving_i & no_wait_q)),
    .quarter_stb_o(quarter_stb), .quarter_o(quarter), .bit_stb_o(bit_stb)
  );

  // ------------------------------------------------------------------ silence

  reg  [6:0] halves_q = 7'd0;        // halves of silence; negative in the rest of the stop bits
  reg        t15_chars_q = 1'b0, t35_chars_q = 1'b0;

  wire       busy   = rst_i | restart_i | sending_i | receiving_i;
  wire       rest   = &halves_q[6:5];
  wire [6:0] behind = (format_i == `MB_FORMAT_8N2) ? REST_2 : REST_1;      // a received character

  always @(posedge clk_i) begin
    t15_chars_q <= ~busy & (t15_chars_q | (halves_q == t15));
    t35_chars_q <= ~busy & (t35_chars_q | (halves_q == t35));
    if (half_stb && !t35_chars_q) halves_q <= halves_q + 7'd1;
    if (busy) halves_q <= receiving_i ? behind : 7'd0;
  end

  assign rest_o = rest;

  wire t15_floor, t35_floor, tick;

  generate
    if (T35_CLOCKS == 0 && TICK_BITS == 0) begin : gen_no_floor
      assign tick      = 1'b0;
      assign t15_floor = 1'b1;
      assign t35_floor = 1'b1;
    end else begin : gen_floor
      localparam W = (TICK_BITS != 0) ? TICK_BITS : $clog2(T35_CLOCKS + 1);
      reg [W-1:0] clocks_q = {W{1'b0}};
      reg         t15_q = 1'b0, t35_q = 1'b0;
      wire        wraps;
      wire        silent = ~busy & ~rest;
      wire [W-1:0] next;
      assign {wraps, next} = {1'b0, clocks_q} + 1'b1;
      assign tick = wraps;
      always @(posedge clk_i) begin
        t15_q <= silent & (t15_q | &(clocks_q | ~T15_CLOCKS[W-1:0]));
        t35_q <= silent & (t35_q | &(clocks_q | ~T35_CLOCKS[W-1:0]));
        clocks_q <= silent ? next : {W{1'b0}};
      end
`ifdef FORMAL
      always @(posedge clk_i) if (f_past) begin
        assert (clocks_q == f_clocks[W-1:0] || f_clocks == 16'hFFFF);
        assert (t15_q == (f_clocks > T15_CLOCKS));
        assert (t35_q == (f_clocks > T35_CLOCKS));
      end
`endif
      assign t15_floor = t15_q;
      assign t35_floor = t35_q;
    end
  endgenerate

  assign t15_o = t15_chars_q & t15_floor;
  assign t35_o = t35_chars_q & t35_floor & ~receiving_i & ~sending_i;

  // ------------------------------------------------------------------ waits

  reg  [15:0] bits_q = 16'd0;
  reg         over_q = 1'b0;         // in a register: the comparison is long
  wire        ticks     = (TICK_BITS != 0) & wait_ticks_i;
  // Counting up from 0, the first number with all the bits of the limit is the limit itself.  A limit tied to 0 leaves
  // nothing of the counter.
  wire        over_bits = &(bits_q[3:0] | ~wait_limit_i[3:0]) & (wait_short_i | &(bits_q[15:4] | ~wait_limit_i[15:4]));
  // The limit in ticks is nearly a constant: compared apart it costs a few cells, chosen before a cell a bit.
  wire        over      = ticks ? &(bits_q | ~tick_limit_i) : over_bits;

  always @(posedge clk_i) begin
    over_q <= over & ~wait_clear_i;
    if (wait_clear_i)            bits_q <= 16'd0;
    else if ((ticks ? tick : bit_stb) && !over_q) bits_q <= bits_q + 16'd1;
  end

  assign wait_over_o = over_q;

`ifdef FORMAL
  // The bit clock is cut off: whatever it does, t1.5 and t3.5 are so many of its half bits, and floors in clocks,
  // neither early nor late.
  reg        f_past = 1'b0;
  reg [7:0]  f_halves = 8'd0;        // half bits since the line was busy
  reg [15:0] f_clocks = 16'd0;       // clocks of silence behind the last stop bit
  reg [7:0]  f_rest = 8'd0;          // half bits of the stop bits
  wire       f_silent = (f_halves >= f_rest);

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (busy) begin
      f_halves <= 8'd0;
      f_clocks <= 16'd0;
      f_rest   <= !receiving_i ? 8'd0 : (format_i == `MB_FORMAT_8N2) ? 8'd3 : 8'd1;
    end else begin
      if (half_stb && f_halves != 8'hFF) f_halves <= f_halves + 8'd1;
      if (f_silent && f_clocks != 16'hFFFF) f_clocks <= f_clocks + 16'd1;
    end
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) begin
    assume ($stable(format_i));
    assume (!quarter_stb || !$past(quarter_stb));
  end

  always @(posedge clk_i) if (f_past) begin
    // What makes the rest hold from clock to clock
    assert (t35_chars_q || {rest, halves_q} + f_rest == f_halves || f_halves == 8'hFF);
    assert (f_halves != 8'hFF || t35_chars_q);
    assert (rest ? halves_q >= 7'd125 : halves_q <= t35);
    assert (rest || halves_q <= t15 || t15_chars_q);
    assert (!t35_chars_q || (t15_chars_q && halves_q == t35));
    assert (rest == (f_halves < f_rest));
    assert (f_rest == 8'd0 || f_rest == 8'd1 || f_rest == 8'd3);
    assert (!t15_chars_q || f_halves >= {1'b0, t15} + f_rest);
    assert (!t35_chars_q || f_halves >= {1'b0, t35} + f_rest);
    if (!$past(busy) && !busy) begin
      if (t15_o) assert (f_halves >= {1'b0, t15} + f_rest && f_clocks > T15_CLOCKS);     // never early
      if (t35_o) assert (f_halves >= {1'b0, t35} + f_rest && f_clocks > T35_CLOCKS);
      // never more than two clocks late
      if (f_halves > {1'b0, t15} + f_rest && f_clocks > T15_CLOCKS + 1) assert (t15_o);
      if (f_halves > {1'b0, t35} + f_rest && f_clocks > T35_CLOCKS + 1) assert (t35_o);
    end
    if (receiving_i || sending_i) assert (!t35_o);
    if ($past(busy)) assert (halves_q == 7'd0 || rest);
    cover (t15_o && f_rest != 8'd0);
  end

  // Waits: exactly so many bits
  reg [15:0] f_bits = 16'd0;
  always @(posedge clk_i) if (wait_clear_i) f_bits <= 16'd0; else if (bit_stb && f_bits != 16'hFFFF) f_bits <= f_bits + 16'd1;
  always @* assume (bit_stb == (quarter_stb && quarter == 2'd3));
  wire [15:0] f_limit = wait_short_i ? {12'd0, wait_limit_i[3:0]} : wait_limit_i;
  always @(posedge clk_i) if (f_past) begin
    assume (wait_clear_i || $past(wait_clear_i) || ($stable(wait_limit_i) && $stable(wait_short_i)));
    if (!$past(wait_clear_i) && !wait_clear_i) begin
      assert (over_q || bits_q == f_bits || f_bits == 16'hFFFF);
      assert (f_bits >= bits_q && (bits_q <= f_limit || f_limit == 16'd0) && bits_q[15:1] <= f_limit[15:1] && (!over_q || over));
      if (wait_over_o) assert (f_bits >= f_limit);
      if ($past(f_bits) >= $past(f_limit)) assert (wait_over_o);
    end
    cover (wait_over_o && f_limit == 16'd2);
  end
`endif

endmodule

`default_nettype wire
