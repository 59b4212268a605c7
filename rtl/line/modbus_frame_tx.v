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

endmodule

`default_nettype wire
