// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_line_health - what a service engineer wants to know of a line, counted and measured beside the core.
//
// health_o is nine registers of 16 bits, register n in [16*n +: 16].  Counters stop at 65535.
//
// | n | Holds                                                                                        |
// |---|----------------------------------------------------------------------------------------------|
// | 0 | runs shorter than a quarter of a bit: spikes                                                 |
// | 1 | frames with a wrong parity bit                                                               |
// | 2 | frames with a stop bit of 0                                                                  |
// | 3 | frames with a wrong check field alone                                                        |
// | 4 | frames with a gap above t1.5                                                                 |
// | 5 | breaks: the line was 0 for 12 bits                                                           |
// | 6 | largest gap between two characters of a good frame, in quarters of a bit                     |
// | 7 | how much longer the master's bits are than ours, in permille, signed                         |
// | 8 | bits in hundreds that register 7 was measured over, not above 65535; 0: not measured yet     |
//
// A character is timed from its first falling edge: each later edge tells how far it is from the nearest border of our bits.
// The distances of the last edges of the characters add up over 1000 bits; that sum in bits is the permille.  A frame that
// is not good starts it again.
//
// clear_i sets everything to 0.  The module hears rxd_i itself, so the core does not change; left out it costs nothing.

`default_nettype none
`include "modbus_defs.vh"

module modbus_line_health (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        clear_i,                    // strobe: all to 0

  input  wire        rxd_i,                      // the pin that the core has
  input  wire        de_i,                       // level : the core drives the line: nothing is measured
  input  wire [15:0] bit_time_i,                 // clocks per bit, 8..65535
  input  wire [1:0]  format_i,                   // MB_FORMAT_*
  input  wire [`MB_EVENTS_WIDTH-1:0] events_i,   // events_o of the core

  output wire [143:0] health_o
);

  wire rxd_sync;
  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd_sync));
  wire line = rxd_sync | de_i;

  reg  [15:0] counts_q [0:5];
  reg         line_q = 1'b1;
  wire        falls = line_q & ~line, edge_stb = (line_q != line);

  // ------------------------------------------------------------------ runs: spikes and breaks

  reg  [19:0] run_q = 20'd0;                     // clocks of this run, up to 12 bits
  wire [19:0] twelve = {4'd0, bit_time_i} * 20'd12;
  wire        spike  = edge_stb & (run_q < {6'd0, bit_time_i[15:2]});
  reg         broken_q = 1'b0;
  wire        breaks = ~line_q & ~broken_q & (run_q >= twelve);

  // ------------------------------------------------------------------ characters

  reg  [15:0] phase_q = 16'd0;                   // clock of our bit
  reg  [3:0]  bits_q = 4'd0;                     // whole bits since the start bit began
  reg         inside_q = 1'b0;                   // a character is on the line
  wire [3:0]  length = (format_i == `MB_FORMAT_8N1) ? 4'd10 : 4'd11;
  wire        wraps  = (phase_q == bit_time_i - 16'd1);
  // The stop bit may be a little short: a falling edge in its second half begins the next character.
  wire        over   = inside_q & ((bits_q == length) | (falls & (bits_q == length - 4'd1) & (phase_q >= {1'b0, bit_time_i[15:1]})));
  wire        begins = falls & (~inside_q | over);

  // The last edge of a character: bits from its begin, and clocks too late
  reg  [3:0]  last_bits_q = 4'd0;
  reg signed [16:0] last_late_q = 17'sd0;
  wire        half = (phase_q >= {1'b0, bit_time_i[15:1]});
  wire signed [16:0] late = half ? $signed({1'b0, phase_q}) - $signed({1'b0, bit_time_i}) : $signed({1'b0, phase_q});

  // ------------------------------------------------------------------ permille

  reg  signed [17:0] sum_q = 18'sd0;             // clocks, less whole bits
  reg  [9:0]  span_q = 10'd0;                    // bits that it was measured over
  reg  signed [15:0] whole_q = 16'sd0, permille_q = 16'sd0;
  reg  [15:0] hundreds_q = 16'd0;
  reg         add_q = 1'b0;
  wire        bad = |events_i[`MB_EVENT_GAP:`MB_EVENT_PARITY];
  wire        done = (span_q >= 10'd1000);
  wire signed [17:0] one = $signed({2'b00, bit_time_i});

  // ------------------------------------------------------------------ gaps

  reg  [15:0] gap_clock_q = 16'd0;
  reg  [15:0] gap_q = 16'd0, frame_gap_q = 16'd0, largest_q = 16'd0;      // quarters of a bit
  reg         open_q = 1'b0;                     // a character of this frame was there
  wire        quarter = (gap_clock_q >= {2'd0, bit_time_i[15:2]} - 16'd1);

  integer n;

  always @(posedge clk_i) begin
    line_q <= line;
    if (edge_stb) run_q <= 20'd1;
    else if (run_q != 20'hFFFFF) run_q <= run_q + 20'd1;
    broken_q <= ~line_q & (broken_q | breaks);

    // Characters
    if (begins) begin
      phase_q  <= 16'd1;
      bits_q   <= 4'd0;
      inside_q <= 1'b1;
    end else begin
      phase_q <= wraps ? 16'd0 : phase_q + 16'd1;
      if (wraps && bits_q != 4'd15) bits_q <= bits_q + 4'd1;
      if (over) inside_q <= 1'b0;
    end
    if (begins) last_bits_q <= 4'd0;
    else if (inside_q && edge_stb) begin
      last_bits_q <= bits_q + {3'd0, half};
      last_late_q <= late;
    end
    add_q <= over & (last_bits_q != 4'd0);

    // Permille
    if (add_q) begin
      sum_q  <= sum_q + {last_late_q[16], last_late_q};
      span_q <= span_q + {6'd0, last_bits_q};
    end else if (done) begin
      permille_q <= whole_q;
      if (hundreds_q < 16'd65526) hundreds_q <= hundreds_q + 16'd10;
      span_q  <= 10'd0;
      sum_q   <= 18'sd0;
      whole_q <= 16'sd0;
    end else if (sum_q >= one) begin
      sum_q   <= sum_q - one;
      whole_q <= whole_q + 16'sd1;
    end else if (-sum_q >= one) begin
      sum_q   <= sum_q + one;
      whole_q <= whole_q - 16'sd1;
    end
    if (bad) begin
      span_q  <= 10'd0;
      sum_q   <= 18'sd0;
      whole_q <= 16'sd0;
    end

    // Gaps
    if (begins) begin
      if (open_q && gap_q > frame_gap_q) frame_gap_q <= gap_q;
      open_q <= 1'b1;
    end
    gap_clock_q <= (inside_q | quarter) ? 16'd0 : gap_clock_q + 16'd1;
    if (inside_q) gap_q <= 16'd0;
    else if (quarter && gap_q != 16'hFFFF) gap_q <= gap_q + 16'd1;
    if (events_i[`MB_EVENT_FRAME] || bad) begin
      if (events_i[`MB_EVENT_FRAME] && frame_gap_q > largest_q) largest_q <= frame_gap_q;
      frame_gap_q <= 16'd0;
      open_q      <= 1'b0;
    end

    // Counters
    for (n = 0; n < 6; n = n + 1)
      if (((n == 0) ? spike : (n == 1) ? events_i[`MB_EVENT_PARITY] : (n == 2) ? events_i[`MB_EVENT_FRAMING] :
           (n == 3) ? events_i[`MB_EVENT_CRC] : (n == 4) ? events_i[`MB_EVENT_GAP] : breaks) && counts_q[n] != 16'hFFFF)
        counts_q[n] <= counts_q[n] + 16'd1;

    if (rst_i || clear_i) begin
      for (n = 0; n < 6; n = n + 1) counts_q[n] <= 16'd0;
      {largest_q, frame_gap_q, hundreds_q, span_q} <= 58'd0;
      permille_q <= 16'sd0;
      whole_q    <= 16'sd0;
      sum_q      <= 18'sd0;
      open_q     <= 1'b0;
      broken_q   <= 1'b0;
      inside_q   <= 1'b0;
    end
  end

  initial for (n = 0; n < 6; n = n + 1) counts_q[n] = 16'd0;

  genvar g;
  generate
    for (g = 0; g < 6; g = g + 1) begin : gen_counts
      assign health_o[16*g +: 16] = counts_q[g];
    end
  endgenerate
  assign health_o[16*6 +: 48] = {hundreds_q, permille_q, largest_q};

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) begin
    // A counter goes up by one for its event, stops at the top, and falls to 0 when it is told to.
    if ($past(rst_i | clear_i)) assert (health_o == 144'd0);
    else for (n = 1; n < 5; n = n + 1)
      assert (counts_q[n] == $past(counts_q[n]) ||
              (counts_q[n] == $past(counts_q[n]) + 16'd1 && $past(n == 1 ? events_i[`MB_EVENT_PARITY] :
               n == 2 ? events_i[`MB_EVENT_FRAMING] : n == 3 ? events_i[`MB_EVENT_CRC] : events_i[`MB_EVENT_GAP])));
    // What happens on our own time is nobody's fault.
    if ($past(de_i) && $past(de_i, 2) && $past(f_past)) assert (line_q);
    if ($past(f_past) && $past(de_i, 2) && $past(de_i) && de_i && !$past(rst_i) && !$past(clear_i))
      assert (counts_q[0] == $past(counts_q[0]) || $past(spike));
    if (!$past(rst_i | clear_i)) assert (largest_q >= $past(largest_q));
  end
`endif

endmodule

`default_nettype wire
