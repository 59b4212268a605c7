// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_line_timer - measures silence on the line: t1.5 and t3.5.
//
// t1.5 and t3.5 are the later of 1.5 / 3.5 character times and a floor in clocks, which gives the character times
// up to 19200 baud and the fixed 750 / 1750 us above (MODBUS over Serial Line V1.02, clause 2.5.1.1).
// Silence counts from the end of the last stop bit.  busy_i falls when the receiver decides the first stop bit,
// half a bit earlier (with a second stop bit one and a half): those quarters are counted off first,
// so that nothing ends early.  Resolution: a quarter bit for the character times, a clock for the floors.

`default_nettype none
`include "modbus_defs.vh"

module modbus_line_timer #(
  parameter integer T15_CLOCKS = 37500,     // floor of t1.5 in clocks, 0: none
  parameter integer T35_CLOCKS = 87500      // floor of t3.5 in clocks, 0: none; not below T15_CLOCKS
) (
  input  wire       clk_i,
  input  wire       rst_i,
  input  wire [1:0] format_i,
  input  wire       quarter_stb_i,

  input  wire       busy_i,         // level : a character is on the line, or we drive it
  output wire       t15_o,          // level : silent for t1.5; still valid in the first clock of busy_i
  output wire       t35_o           // level : silent for t3.5
);

  generate
    if (T15_CLOCKS < 0 || T35_CLOCKS < T15_CLOCKS || T35_CLOCKS >= (1 << 28)) begin : gen_illegal
      ERROR_modbus_line_timer_floor_of_t35_below_floor_of_t15 illegal_parameter ();
    end
  endgenerate

  // Quarters from the middle of the first stop bit to the end of the last, then to t1.5 and t3.5.
  localparam [7:0] REST_1 = 8'd2,  REST_2 = 8'd6;
  localparam [7:0] T15_11 = 8'd66, T15_10 = 8'd60;
  localparam [7:0] T35_11 = 8'd154, T35_10 = 8'd140;

  wire two_stops = (format_i == `MB_FORMAT_8N2);
  wire ten_bits  = (format_i == `MB_FORMAT_8N1);
  wire [7:0] t15  = two_stops ? REST_2 + T15_11 : ten_bits ? REST_1 + T15_10 : REST_1 + T15_11;
  wire [7:0] t35  = two_stops ? REST_2 + T35_11 : ten_bits ? REST_1 + T35_10 : REST_1 + T35_11;

  reg [7:0] quarters_q = 8'd0;
  reg       t15_chars_q = 1'b0, t35_chars_q = 1'b0;

  always @(posedge clk_i) begin
    // Counting up from 0, the first number with all the bits of the limit is the limit itself.
    if (&(quarters_q | ~t15)) t15_chars_q <= 1'b1;
    if (&(quarters_q | ~t35)) t35_chars_q <= 1'b1;
    if (quarter_stb_i && !t35_chars_q) quarters_q <= quarters_q + 8'd1;
    if (rst_i || busy_i) begin
      quarters_q  <= 8'd0;
      t15_chars_q <= 1'b0;
      t35_chars_q <= 1'b0;
    end
  end

  wire t15_floor, t35_floor;

  generate
    if (T35_CLOCKS == 0) begin : gen_no_floor
      assign t15_floor = 1'b1;
      assign t35_floor = 1'b1;
    end else begin : gen_floor
      localparam W = $clog2(T35_CLOCKS + 1);
      reg [W-1:0] clocks_q = {W{1'b0}};
      reg         rest_q = 1'b0, t15_q = 1'b0, t35_q = 1'b0;
      always @(posedge clk_i) begin
        rest_q <= (rest_q | t35_chars_q | (quarters_q == (two_stops ? REST_2 : REST_1))) & ~rst_i & ~busy_i;
        if (&(clocks_q | ~T15_CLOCKS[W-1:0])) t15_q <= 1'b1;
        if (&(clocks_q | ~T35_CLOCKS[W-1:0])) t35_q <= 1'b1;
        clocks_q <= clocks_q + 1'b1;
        if (!rest_q) begin
          clocks_q <= {W{1'b0}};
          t15_q    <= 1'b0;
          t35_q    <= 1'b0;
        end
      end
`ifdef FORMAL
      always @(posedge clk_i) begin
        assert (!rest_q || !t15_q || f_clocks > T15_CLOCKS);
        assert (!rest_q || !t35_q || f_clocks > T35_CLOCKS);
      end
`endif
      assign t15_floor = t15_q;
      assign t35_floor = t35_q;
    end
  endgenerate

  assign t15_o = t15_chars_q & t15_floor;
  assign t35_o = t35_chars_q & t35_floor & ~busy_i;

`ifdef FORMAL
  reg       f_past = 1'b0;
  reg [8:0] f_quarters = 9'd0;       // quarters of silence, the rest of the stop bits included
  reg [15:0] f_clocks = 16'd0;       // clocks of silence, likewise

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (rst_i || busy_i) begin
      f_quarters <= 9'd0;
      f_clocks   <= 16'd0;
    end else begin
      if (quarter_stb_i && !(&f_quarters)) f_quarters <= f_quarters + 9'd1;
      if (!(&f_clocks)) f_clocks <= f_clocks + 16'd1;
    end
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) assume ($stable(format_i));

  always @(posedge clk_i) if (f_past) begin
    assert (quarters_q <= t35 + 8'd1);
    assert (f_quarters >= {1'b0, quarters_q});
    assert (!t15_chars_q || quarters_q >= t15);
    assert (!t35_chars_q || quarters_q >= t35);
    if (!$past(rst_i) && !$past(busy_i)) begin
      if (t15_o) assert (f_quarters >= {1'b0, t15} && f_clocks > T15_CLOCKS);     // never early
      if (t35_o) assert (f_quarters >= {1'b0, t35} && f_clocks > T35_CLOCKS);
    end
    if (busy_i) assert (!t35_o);
    cover (t35_o && t15_o);
  end
`endif

endmodule

`default_nettype wire
