// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_frame_tx - sends the answer: driver enable, characters back to back, check field.
//
// After start_i: the response delay, the driver lead, count bytes from the cursor on, two check characters,
// the driver tail, sent_stb_o.  All three waits are in bit times and may be 0.  de_o rises with the first clock of
// the lead (or two clocks before the start bit without a lead) and falls a clock after the last stop bit and tail.
// With drop_i before the driver is on, the answer is given up: dropped_stb_o.

`default_nettype none

module modbus_frame_tx (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        start_i,        // strobe
  input  wire        drop_i,         // level : the answer comes too late
  output wire        sending_o,      // level : an answer is on its way; the wait counter serves it
  output wire        sent_stb_o,     // strobe: last stop bit and tail have passed
  output wire        dropped_stb_o,  // strobe: given up, nothing was sent
  output wire        de_o,           // level : driver enable; the receiver is deaf

  // Waits, in bit times
  input  wire [11:0] response_delay_i,
  input  wire [3:0]  de_lead_i,
  input  wire [3:0]  de_tail_i,
  output wire        wait_clear_o,
  output wire [11:0] wait_limit_o,
  output wire        wait_short_o,   // level : only the low four bits of the limit count
  input  wire        wait_over_i,

  // Frame RAM
  input  wire [8:0]  count_i,        // level : bytes that are left
  output wire        next_stb_o,     // strobe: the byte was taken; cursor up, count down

  // Transmitter
  output wire        valid_o,
  output wire        check_o,
  output wire        last_o,         // level : the second check character
  input  wire        ready_i
);

  localparam [2:0] ST_REST = 3'd0, ST_DELAY = 3'd1, ST_LEAD = 3'd2, ST_DATA = 3'd3,
                   ST_CHECK_LOW = 3'd4, ST_CHECK_HIGH = 3'd5, ST_DRAIN = 3'd6, ST_TAIL = 3'd7;

  reg [2:0] state_q = ST_REST, state_d;
  reg       de_q = 1'b0;
  reg       next_q = 1'b0;           // a character was taken a clock ago; the following one is far away

  wire waits = (state_q == ST_DELAY) | (state_q == ST_LEAD) | (state_q == ST_TAIL);

  always @* begin
    state_d = state_q;
    case (state_q)
      // Nothing to send.
      ST_REST: if (start_i) state_d = ST_DELAY;
      // A slow master asked for time.
      ST_DELAY: if (drop_i) state_d = ST_REST; else if (wait_over_i) state_d = ST_LEAD;
      // The driver is on, the line rests at 1.
      ST_LEAD: if (wait_over_i) state_d = ST_DATA;
      // Address, function code, data.
      ST_DATA: if (ready_i && count_i == 9'd1) state_d = ST_CHECK_LOW;
      // CRC low byte, CRC high byte.
      ST_CHECK_LOW:  if (ready_i) state_d = ST_CHECK_HIGH;
      ST_CHECK_HIGH: if (ready_i) state_d = ST_DRAIN;
      // The last character passes.
      ST_DRAIN: if (ready_i) state_d = ST_TAIL;
      // The driver holds the line at 1.
      ST_TAIL: if (wait_over_i) state_d = ST_REST;
    endcase
  end

  always @(posedge clk_i) begin
    state_q <= state_d;
    next_q  <= (state_q == ST_DATA) & ready_i;
    de_q    <= (state_d != ST_REST) & (state_d != ST_DELAY);
    if (rst_i) begin
      state_q <= ST_REST;
      de_q    <= 1'b0;
    end
  end

  assign sending_o     = (state_q != ST_REST);
  assign sent_stb_o    = (state_q == ST_TAIL) & wait_over_i;
  assign dropped_stb_o = (state_q == ST_DELAY) & drop_i;
  assign de_o          = de_q;
  assign wait_clear_o  = ~waits | wait_over_i;
  assign wait_limit_o  = {response_delay_i[11:4], (state_q == ST_DELAY) ? response_delay_i[3:0] :
                                                  (state_q == ST_LEAD)  ? de_lead_i : de_tail_i};
  assign wait_short_o  = (state_q != ST_DELAY);
  assign next_stb_o    = next_q;
  assign valid_o       = (state_q == ST_DATA) | (state_q == ST_CHECK_LOW) | (state_q == ST_CHECK_HIGH);
  assign check_o       = (state_q != ST_DATA);
  assign last_o        = (state_q == ST_CHECK_HIGH);

`ifdef FORMAL
  // What an answer is: count bytes, then two check characters, the driver on around all of them, the waits respected.
  reg       f_past = 1'b0;
  reg [8:0] f_left = 9'd0;           // bytes of the answer that were not taken yet
  reg [1:0] f_checks = 2'd0;         // check characters taken
  reg       f_passes = 1'b0;         // a character is on the line, as the transmitter sees it
  reg       f_delayed = 1'b0, f_led = 1'b0, f_trailed = 1'b0;   // the wait was over

  wire f_take = valid_o & ready_i;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (state_q == ST_REST) begin
      {f_checks, f_passes, f_delayed, f_led, f_trailed} <= 6'd0;
      f_left <= count_i;
    end else begin
      if (f_take && !check_o) f_left   <= f_left - 9'd1;
      if (f_take && check_o)  f_checks <= f_checks + 2'd1;
      if (f_take)       f_passes <= 1'b1;
      else if (ready_i) f_passes <= 1'b0;
      if (state_q == ST_DELAY && wait_over_i) f_delayed <= 1'b1;
      if (state_q == ST_LEAD && wait_over_i)  f_led <= 1'b1;
      if (state_q == ST_TAIL && wait_over_i)  f_trailed <= 1'b1;
    end
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) begin
    if (state_q == ST_REST) assume (count_i >= 9'd1 && count_i <= 9'd256);
    else                    assume (count_i == (next_q ? f_left + 9'd1 : f_left));   // the frame RAM counts a clock later
    if (state_q != ST_REST && $past(state_q == ST_REST)) assume ($past(count_i) == count_i);
    // A character lasts: the transmitter is ready again long after it took one; the wait is cleared in a clock.
    if ($past(f_take)) assume (!ready_i);
    if (next_q) assume (!ready_i);
    if ($past(wait_clear_o)) assume (!wait_over_i);
  end

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    assert (de_o == (state_q != ST_REST && state_q != ST_DELAY));
    if (valid_o || f_passes) assert (de_o);                               // covers every character
    if (valid_o) assert (f_delayed && f_led);
    if (de_o) assert (f_delayed);
    if (valid_o && !check_o) assert (f_checks == 2'd0 && f_left != 9'd0);
    if (valid_o && check_o) assert (f_left == 9'd0 && f_checks < 2'd2);
    if (state_q == ST_DRAIN) assert (f_checks == 2'd2 && f_left == 9'd0);
    if (state_q == ST_TAIL) assert (f_checks == 2'd2 && f_left == 9'd0 && !f_passes);
    if (state_q == ST_CHECK_HIGH) assert (f_checks == 2'd1);
    if (state_q == ST_CHECK_LOW) assert (f_checks == 2'd0);
    if (state_q == ST_DELAY || state_q == ST_LEAD) assert (f_left != 9'd0 && f_checks == 2'd0 && !f_passes);
    if (next_q) assert ($past(f_take && !check_o));
    // The driver goes off behind the tail alone, or at a reset; a dropped answer never turned it on.
    if ($past(de_o) && !de_o) assert ($past(sent_stb_o));
    if (dropped_stb_o) assert (!de_o);
    if ($past(start_i) && $past(state_q == ST_REST)) assert (sending_o && !de_o);
    cover (sent_stb_o);
    cover (dropped_stb_o);
  end
`endif

endmodule

`default_nettype wire
