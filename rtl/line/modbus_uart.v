// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_uart - characters from the line and onto it: 8E1, 8O1, 8N2 or 8N1, for ASCII mode the same with 7 bits.
//
// The line is half duplex: with enable_i low, while the driver is on, the receiver is deaf.  So receiver and
// transmitter share the bit clock, the shift register, the bit number and the parity.
//
// Receiving.  Each bit is sampled 1/4, 1/2 and 3/4 through; two equal samples decide it.  In a stop bit the first sample
// counts as 1.  So a stop bit that is high in its middle ends there, and the next start bit may come early (a fast
// sender); one that comes late has until 3/4 (a slow sender).  The samples are centred on the clock in which the edge
// may have fallen.
//   A start bit that is high again after 1/4 bit, or by majority, was a spike: nothing is reported, and only the bit
//   clock in here has noticed.  A spike shorter than 1/4 bit inside a character spoils at most one sample of three.
//   One case is not cured: a high spike across the first sample of a start bit makes the character begin behind the
//   spike, up to 1/4 bit late.  A sender at our rate is still understood; docs/timing.md, section 4, says what holds
//   at which mismatch.
//   After a framing error (first stop bit low) or a break the line must go high before the next start bit counts.
//   The second stop bit is not checked (an 8N1 sender is understood by an 8N2 receiver).
//   start_stb_o rises one clock after a start bit is confirmed, char_stb_o one clock after the stop bit is decided,
//   errors and data_o valid with it.  receiving_o is high from the confirmed start bit to the decided stop bit, and
//   through a break.
//
// Sending.  A character is taken in the clock in which valid_i and ready_o are high; its start bit begins in the next.
//   ready_o is high while nothing is sent and in the last clock of the last stop bit, so the next character follows
//   without an idle bit.  sending_o is high from the first clock of a start bit to the last of a stop bit.  With
//   check_i the eight bits come from check_bit_i instead of data_i: the CRC unit sends itself.

`default_nettype none
`include "modbus_defs.vh"

module modbus_uart #(
  parameter integer MAX_BIT_TIME  = 65535, // no bit_time_i is above it
  parameter integer BIT_FRACTIONS = 0  // 1: fraction_i counts
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [15:0] bit_time_i,
  input  wire [3:0]  fraction_i,      // sixteenths of a clock beyond bit_time_i
  input  wire [1:0]  format_i,
  input  wire        seven_i,         // level : characters have 7 bits; data_o[7] is 0 and data_i[7] not sent

  // Line
  input  wire        enable_i,        // level : 0 makes the receiver deaf
  input  wire        rxd_i,           // level : synchronised
  output wire        txd_o,
  output wire        idle_o,          // level : not even a start bit is suspected

  // Received characters
  output wire        receiving_o,     // level : a character is on the line
  output wire        start_stb_o,     // strobe: a start bit was confirmed
  output wire        char_stb_o,      // strobe: a character is complete
  output wire [7:0]  data_o,
  output wire        parity_error_o,  // level : with char_stb_o
  output wire        framing_error_o, // level : with char_stb_o

  // Characters to send
  input  wire        valid_i,
  input  wire [7:0]  data_i,
  input  wire        check_i,         // level : with valid_i, send check bits
  output wire        ready_o,
  output wire        sending_o,       // level : a character is sent
  output wire        begin_stb_o,     // strobe: the first character of a row begins in the next clock

  // CRC unit: data bits as they pass, either way
  output wire        bit_stb_o,       // strobe: a data or check bit
  output wire        bit_o,           // level : its value
  output wire        feed_o,          // level : 1 data, 0 check bits
  input  wire        check_bit_i
);

  localparam [1:0] ST_IDLE = 2'd0, ST_START = 2'd1, ST_BITS = 2'd2, ST_BREAK = 2'd3;

  wire has_parity = ~format_i[1];
  wire is_odd     =  format_i[0];
  wire ten_bits   = (format_i == `MB_FORMAT_8N1);

  // Shared.  The number is that of the received bit on the line, or of the next bit to send: 0 start, 1..8 data, then
  // parity and stop; 10 or 11 is behind the last.  With 7 bits it begins one later: 1 start, 2..8 data.
  reg [3:0] number_q = 4'd0;
  reg [7:0] data_q = 8'h00;
  reg       parity_q = 1'b0;
  // What the bit of this number is: known a clock later, long before it is needed
  reg       is_parity_q = 1'b0, is_stop_q = 1'b0, is_behind_q = 1'b0;

  // Receiver
  reg [1:0] state_q = ST_IDLE, state_d;
  reg       line_q = 1'b1;           // the line one clock ago: an edge is seen half a clock late on average
  reg       sample_q = 1'b1;         // the sample at 1/4
  reg       decided_q = 1'b0;        // this bit is decided
  reg       may_q = 1'b0;            // a sample now decides: the third, or the second if it is like the first
  reg       start_stb_q = 1'b0, bit_stb_q = 1'b0, char_stb_q = 1'b0;
  reg       parity_error_q = 1'b0, framing_error_q = 1'b0;

  // Transmitter
  reg       sends_q = 1'b0, check_q = 1'b0, txd_q = 1'b1;

  // ------------------------------------------------------------------ bit clock

  wire       begin_char, quarter_stb, bit_stb;
  wire [1:0] quarter;

  modbus_bit_clock #(.MAX_BIT_TIME(MAX_BIT_TIME), .BIT_FRACTIONS(BIT_FRACTIONS)) u_bit_clock (
    .clk_i(clk_i), .bit_time_i(bit_time_i), .fraction_i(fraction_i), .restart_i(begin_char | begin_stb_o),
    .quarter_stb_o(quarter_stb), .quarter_o(quarter), .bit_stb_o(bit_stb)
  );

  // ------------------------------------------------------------------ receiver

  wire data_bit = ~is_parity_q & ~is_stop_q;
  // The sample that completes the majority has the majority's value.
  wire decide   = quarter_stb & may_q;
  wire confirm  = (state_q == ST_START) & decide & ~line_q;
  wire take_bit = (state_q == ST_BITS) & decide;
  wire finish   = take_bit & is_stop_q;
  // The start bit behind a fast sender's stop bit may fall in the very clock in which that is decided.
  assign begin_char = ((state_q == ST_IDLE) | (finish & line_q)) & enable_i & ~rxd_i;

  always @* begin
    state_d = state_q;
    case (state_q)
      // The line rests at 1.
      ST_IDLE: if (begin_char) state_d = ST_START;
      // It has fallen: a start bit, or a spike.
      ST_START: begin
        if (confirm) state_d = ST_BITS;
        else if (decide || (quarter_stb && quarter == 2'd0 && rxd_i)) state_d = ST_IDLE;
      end
      // Data, parity and stop bits pass.
      ST_BITS: if (finish) state_d = begin_char ? ST_START : line_q ? ST_IDLE : ST_BREAK;
      // The stop bit was 0: wait for the line to rest.
      ST_BREAK: if (rxd_i) state_d = ST_IDLE;
    endcase
    if (!enable_i) state_d = ST_IDLE;
  end

  always @(posedge clk_i) begin
    // In a stop bit the first sample counts as 1: with a slow sender it may still fall into the bit before.
    may_q       <= ~decided_q & ((quarter == 2'd2) | ((quarter == 2'd1) & (rxd_i == (sample_q | is_stop_q))));
    line_q      <= rxd_i;
    start_stb_q <= confirm & enable_i;
    bit_stb_q   <= take_bit & data_bit;
    char_stb_q  <= finish & enable_i;
    if (finish) begin
      framing_error_q <= ~line_q;
      parity_error_q  <= has_parity & parity_q;
    end
    if (quarter_stb && quarter == 2'd0) sample_q <= line_q;
    decided_q <= (decided_q | decide) & ~bit_stb & ~begin_char;
    state_q <= state_d;
    if (rst_i) begin
      state_q     <= ST_IDLE;
      start_stb_q <= 1'b0;
      char_stb_q  <= 1'b0;
    end
  end

  // ------------------------------------------------------------------ transmitter

  wire step   = sends_q & bit_stb;
  wire ends   = bit_stb & is_behind_q;
  wire take   = valid_i & ready_o;
  wire serial = check_q ? check_bit_i : data_q[0];
  wire tx_bit = step & data_bit;

  always @(posedge clk_i) begin
    sends_q <= take | (sends_q & ~ends);
    check_q <= take ? check_i : check_q & ~ends;
    if (take)      txd_q <= 1'b0;
    else if (step) txd_q <= is_parity_q ? parity_q : is_stop_q | serial;
    if (rst_i) begin
      sends_q <= 1'b0;
      check_q <= 1'b0;
      txd_q   <= 1'b1;
    end
  end

  // ------------------------------------------------------------------ shared

  wire begins = begin_char | take;

  always @(posedge clk_i) begin
    // 9; 10 and 11, without parity also 9; 11, with ten bits also 10: numbers above 11 do not occur in a character.
    is_parity_q <= number_q[3] & ~number_q[1] & number_q[0] & has_parity;
    is_stop_q   <= number_q[3] & (number_q[1] | (number_q[0] & ~has_parity));
    is_behind_q <= number_q[3] & number_q[1] & (number_q[0] | ten_bits);
    // A character behind another is taken when a bit ends.
    if (bit_stb || begin_char || begin_stb_o) number_q <= begins ? {2'd0, take & seven_i, take ^ seven_i} : number_q + 4'd1;
    if (take || tx_bit || (take_bit && data_bit)) 
      data_q <= take ? data_i : {line_q & ~seven_i, seven_i ? line_q : data_q[7], data_q[6:1]};
    if (begins || step || (take_bit && !is_stop_q))
      parity_q <= begins ? is_odd : parity_q ^ (sends_q ? serial : line_q);
  end

  assign txd_o           = txd_q;
  assign idle_o          = (state_q == ST_IDLE) & ~sends_q;
  assign receiving_o     = state_q[1];
  assign start_stb_o     = start_stb_q;
  assign char_stb_o      = char_stb_q;
  assign data_o          = data_q;
  assign parity_error_o  = parity_error_q;
  assign framing_error_o = framing_error_q;
  assign ready_o         = ~sends_q | ends;
  assign sending_o       = sends_q;
  assign begin_stb_o     = valid_i & ~sends_q;
  assign bit_stb_o       = bit_stb_q | tx_bit;
  assign bit_o           = sends_q ? serial : data_q[7];
  assign feed_o          = ~check_q;

`ifdef FORMAL
  // The bit clock is cut off and may do all that a bit clock can.
  reg       f_past = 1'b0;
  reg [3:0] f_bits = 4'd0;           // data bits received since the start bit
  reg       f_parity = 1'b0;         // over them
  reg [7:0] f_data = 8'd0;           // the sent character as it was handed over
  reg       f_check = 1'b0;
  reg       f_sent_parity;
  integer   f_i;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (start_stb_o)    {f_bits, f_parity} <= {4'd0, is_odd};
    else if (bit_stb_q) {f_bits, f_parity} <= {f_bits + 4'd1, f_parity ^ data_q[7]};
    if (take) {f_data, f_check} <= {data_i, check_i};
  end

  always @* if (!f_past) assume (rst_i);
  always @* if (enable_i) assume (!sends_q && !valid_i);                 // half duplex
  always @(posedge clk_i) if (f_past) begin
    assume (($stable(format_i) && $stable(seven_i)) || (idle_o && $past(idle_o) && !start_stb_o && !char_stb_o));
    if ($past(begin_char | begin_stb_o)) assume (quarter == 2'd0 && !quarter_stb);
    else if ($past(quarter_stb))         assume (quarter == $past(quarter) + 2'd1);
    else                                 assume ($stable(quarter));
    assume (!$past(quarter_stb) || !quarter_stb);
    assume (bit_stb == (quarter_stb && quarter == 2'd3));
  end

  // With 7 bits the numbers begin one later.
  wire [3:0] f_start = {3'd0, seven_i};
  wire [3:0] f_first = f_start + 4'd1;
  wire [3:0] f_data_bits = 4'd8 - f_start;
  wire [7:0] f_mask = {~seven_i, 7'h7F};
  wire [3:0] f_number_bits = (number_q <= f_start) ? 4'd0 : (number_q > 4'd9) ? f_data_bits : number_q - f_first;
  wire [3:0] f_stop = has_parity ? 4'd10 : 4'd9;
  wire [3:0] f_behind = ten_bits ? 4'd10 : 4'd11;
  reg        f_settled = 1'b0;       // the number has stood for two clocks: the registers behind it know
  always @(posedge clk_i) f_settled <= ~(bit_stb | begin_char | begin_stb_o);
  reg        f_young = 1'b1;         // a clock behind a change of the number
  always @(posedge clk_i) f_young <= bit_stb | begin_char | begin_stb_o | rst_i;

  always @* begin
    f_sent_parity = is_odd;
    for (f_i = 0; f_i < 8; f_i = f_i + 1) if (f_i < f_data_bits && f_i + f_first < number_q) f_sent_parity = f_sent_parity ^ f_data[f_i];
  end

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    // What is known of the number, a clock later
    if (!f_young && (state_q == ST_BITS || sends_q)) begin
      assert (is_parity_q == (has_parity && number_q == 4'd9));
      assert (is_stop_q == (number_q >= f_stop));
      assert (is_behind_q == (number_q == f_behind) || !sends_q);
    end
    // Receiving
    if (state_q == ST_BITS) begin
      assert (number_q <= f_stop);
      if (number_q == f_start) assert (decided_q);
      assert (number_q >= f_start);
      if (number_q == f_stop) assert (!decided_q);                   // that decision ends the character
      if (!start_stb_o && !bit_stb_q)
        assert (f_bits == f_number_bits + ((decided_q && number_q != f_start && number_q < 4'd9) ? 4'd1 : 4'd0));
    end
    if (state_q == ST_START) assert (number_q == f_start && !decided_q);
    // Each bit is decided before its last quarter.
    if (state_q == ST_START || state_q == ST_BITS) begin
      if (quarter == 2'd3) assert (decided_q);
      if (quarter == 2'd0) assert (!decided_q);
      if (quarter == 2'd2 && $past(quarter) == 2'd2 && !decided_q) assert (may_q);
    end
    if (char_stb_o) assert (f_bits == f_data_bits && (data_o & ~f_mask) == 8'd0);   // never a shorter or longer one
    if (char_stb_o) assert (framing_error_o ? state_q == ST_BREAK || !receiving_o : !receiving_o || state_q == ST_BREAK);
    assert (!(start_stb_o && char_stb_o));
    if (!$past(enable_i)) assert (!receiving_o && !start_stb_o && !char_stb_o);   // deaf
    // A spike is nobody's business: a character on the line is told of only from a confirmed start bit on.
    if (receiving_o && !$past(receiving_o)) assert ($past(confirm) && start_stb_o);
    // Sending
    assert (check_q == f_check || !sends_q);
    assert (!(sends_q && state_q != ST_IDLE));
    if (!sends_q) assert (txd_o);                                    // rests at 1
    if (sends_q) begin
      assert (number_q >= f_first && number_q <= f_behind);
      if (number_q == f_first) assert (!txd_o);                         // start bit
      if (!f_check && number_q < 4'd10) begin
        assert ((data_q & (f_mask >> (number_q - f_first))) == ((f_data & f_mask) >> (number_q - f_first)));
        assert (parity_q == f_sent_parity);
        if (number_q != f_first) assert (txd_o == f_data[number_q - f_first - 4'd1]);
      end
      if (!f_check && number_q == 4'd10 && has_parity) assert (txd_o == (^(f_data & f_mask) ^ is_odd));
      if (number_q > 4'd10 || (number_q == 4'd10 && !has_parity)) assert (txd_o);   // stop bits
    end
    if ($past(take)) assert (sends_q && number_q == f_first);
    cover (char_stb_o && data_o == 8'hA5 && !framing_error_o && !parity_error_o);
    cover (char_stb_o && framing_error_o);
    cover (state_q == ST_IDLE && $past(state_q) == ST_START);        // a spike
    // Back to back: the stop bit of one is followed by the start bit of the next.
    cover (sends_q && number_q == f_first && $past(sends_q) && f_data == 8'hA5);
  end
`endif

endmodule

`default_nettype wire
