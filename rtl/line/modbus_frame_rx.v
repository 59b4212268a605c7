// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_frame_rx - the state machine of the line: cuts characters into frames by silence and judges each frame.
//
// MODBUS over Serial Line V1.02, figure 14, completed: a frame is what lies between two silences of t3.5.  It is good
// when every character was, no gap inside passed t1.5, it has 4..256 bytes and the CRC remainder is zero.
// Bad frames are dropped whole; nothing in them is looked at.  With gap_count_only_i a gap above t1.5 is reported
// and the frame goes on.  A good frame is for us if its address byte is ours (1..247) or, with broadcast_en_i, 0.  A
// good frame for another slave only raises foreign_stb_o.
//
// good_stb_o starts the work on a frame for us.  Until the work is done characters on the line are not received, only
// noted (MB_EVENT_OVERRUN at the end: a master did not wait).  The work ends with quiet_i (no answer), sent_i or
// dropped_i.  Behind an answer the next request may follow at once, or with strict_i after t3.5; behind a silent end
// only noted characters make it wait for t3.5.
// While sending_i is high this module stays in its work, so nothing is ever received while we drive the line: send_i
// is passed on as send_stb_o during the work alone, and quiet_i and restart_i wait for nothing and are ignored then.
//
// With ascii_i high modbus_ascii tells where a frame begins and ends.  A start within a frame then begins it anew, the
// first character counts with its errors although it is over when the frame begins, and t15_i alone is a gap.
//
// The other events rise with the verdict, all that apply; CRC only when nothing else explains it.

`default_nettype none
`include "modbus_defs.vh"

module modbus_frame_rx (
  input  wire       clk_i,
  input  wire       rst_i,
  input  wire       gap_count_only_i,
  input  wire       strict_i,        // level : strict turnaround
  input  wire       ascii_i,         // level : ASCII mode
  input  wire       drop_late_i,     // level : no answer once the line was heard
  input  wire [7:0] address_i,
  input  wire       broadcast_en_i,
  input  wire       also_i,          // level : byte_i is a further address of ours

  // Characters
  input  wire       start_stb_i,
  input  wire       char_stb_i,
  input  wire       parity_error_i,
  input  wire       framing_error_i,
  input  wire       half_i,          // level : with char_stb_i, it belongs to a byte
  input  wire       whole_i,         // level : with char_stb_i, it completes the byte
  input  wire       crc_zero_i,
  input  wire       t15_i,
  input  wire       t35_i,

  // Frame RAM
  input  wire [8:0] count_i,
  input  wire [7:0] byte_i,          // level : the byte that was under the cursor a clock ago
  output wire       open_stb_o,      // strobe: a frame begins; cursor, count and CRC to start
  output wire       look_stb_o,      // strobe: cursor to the first byte
  output wire       read_stb_o,      // strobe: byte_i is the first byte in the next clock
  output wire       store_stb_o,     // strobe: the character belongs under the cursor, a clock after char_stb_i

  // Verdict
  output wire       good_stb_o,      // strobe: good frame for us complete, t3.5 has passed
  output wire       broadcast_o,     // level : with good_stb_o, it is for all
  output wire       foreign_stb_o,   // strobe: good frame for another slave
  output wire       bad_stb_o,       // strobe: bad frame

  // What becomes of a frame for us
  input  wire       send_i,          // strobe: there is an answer
  output wire       send_stb_o,      // strobe: send it
  output wire       drop_o,          // level : it comes too late
  input  wire       sending_i,       // level : it is on its way
  input  wire       sent_i,          // strobe: it was sent
  input  wire       dropped_i,       // strobe: it was given up
  input  wire       quiet_i,         // strobe: there is none
  input  wire       restart_i,       // strobe: silence of t3.5 before anything is heard again

  output wire       idle_o,          // level : no frame is received or worked on
  output wire       active_o,        // level : a frame is being received
  output wire [`MB_EVENTS_WIDTH-1:0] events_o        // strobes MB_EVENT_*
);

  localparam [1:0] ST_INITIAL = 2'd0, ST_IDLE = 2'd1, ST_RECEPTION = 2'd2, ST_WORK = 2'd3;

  reg [1:0] state_q = ST_INITIAL, state_d;
  reg       parity_q = 1'b0, framing_q = 1'b0, long_q = 1'b0, gap_q = 1'b0;
  reg       heard_q = 1'b0;          // a character came during the work
  reg       open_q = 1'b0;           // a frame has begun; its first bit is far away
  reg       store_q = 1'b0;
  // The frame is good: cursor to its first byte, fetch that, compare it, decide whose it is; a clock each
  reg       look_q = 1'b0, read_q = 1'b0, check_q = 1'b0, decide_q = 1'b0;
  reg       for_us_q, for_all_q;

  wire reception = (state_q == ST_RECEPTION);
  wire full      = count_i[8];
  wire spoiled   = gap_q & ~gap_count_only_i;
  wire is_short  = ((count_i & ~9'd3) == 9'd0);             // below 4
  wire broken    = parity_q | framing_q | long_q | spoiled | is_short;
  wire heard     = heard_q | start_stb_i;
  wire verdict   = reception & t35_i;
  wire good      = verdict & ~broken & crc_zero_i;
  // 1..247 can be ours, 0 is for all, 248..255 is reserved (V1.02, clause 2.2).
  wire none      = (byte_i == 8'h00);
  wire for_all   = none & broadcast_en_i;
  wire for_us    = for_all | also_i | ((byte_i == address_i) & ~none & (address_i[7:3] != 5'h1F));

  // The next frame may begin while the address of a foreign one is still being looked at.
  wire foreign = decide_q & ~for_us_q;
  wire judging = look_q | read_q | check_q | decide_q;
  wire work    = (state_q == ST_WORK) & ~judging;
  wire silent_end = dropped_i | (quiet_i & ~sending_i & ~send_i);
  wire done    = work & (sent_i | silent_end);

  assign open_stb_o  = open_q;
  assign store_stb_o = store_q;

  always @* begin
    state_d = state_q;
    case (state_q)
      // Whatever is on the line began before we listened.  In ASCII mode `:` tells what does not.
      ST_INITIAL: if (t35_i || ascii_i) state_d = ST_IDLE;
      // Silent: the next character is the first of a frame.
      ST_IDLE: if (start_stb_i) state_d = ST_RECEPTION;
      // Characters of one frame, until t3.5 of silence.
      ST_RECEPTION: if (verdict) state_d = good ? ST_WORK : ST_IDLE;
      // The address is compared; then the frame is worked on and answered.
      ST_WORK: begin
        if (foreign)   state_d = heard ? ST_RECEPTION : ST_IDLE;
        else if (done) state_d = (sent_i ? strict_i : heard) ? ST_INITIAL : ST_IDLE;
      end
    endcase
  end

  always @(posedge clk_i) begin
    state_q <= state_d;
    open_q  <= ((((state_q == ST_IDLE) | (reception & ascii_i)) & start_stb_i) | (foreign & heard)) & ~rst_i;
    store_q <= reception & whole_i & char_stb_i & ~full & ~rst_i;
    heard_q <= (state_q == ST_WORK) & heard;
    look_q   <= good & ~rst_i;
    read_q   <= look_q & ~rst_i;
    check_q  <= read_q & ~rst_i;
    decide_q <= check_q & ~rst_i;
    for_us_q  <= for_us;
    for_all_q <= for_all;
    // What spoils a frame stays from its first character to the verdict; an opening frame has nothing yet.
    parity_q  <= open_q ? ascii_i & parity_error_i  : parity_q  | (char_stb_i & parity_error_i);
    framing_q <= open_q ? ascii_i & framing_error_i : framing_q | (char_stb_i & framing_error_i);
    long_q    <= ~open_q & (long_q | (char_stb_i & full & half_i & ~spoiled));   // what follows a gap is not looked at
    gap_q     <= ~open_q & (gap_q | ((start_stb_i | ascii_i) & t15_i));
    if (rst_i || (restart_i && !sending_i && !send_stb_o)) state_q <= ST_INITIAL;
  end

  assign look_stb_o    = look_q;
  assign read_stb_o    = read_q;
  assign good_stb_o    = decide_q & for_us_q;
  assign broadcast_o   = for_all_q;
  assign foreign_stb_o = foreign;
  assign bad_stb_o     = verdict & ~good;
  assign send_stb_o    = work & send_i & ~sending_i;
  assign drop_o        = drop_late_i & heard_q;
  assign idle_o        = ~state_q[1];
  assign active_o      = reception;

  assign events_o[`MB_EVENT_FRAME]   = decide_q;
  assign events_o[`MB_EVENT_PARITY]  = verdict & parity_q;
  assign events_o[`MB_EVENT_FRAMING] = verdict & framing_q;
  assign events_o[`MB_EVENT_OVERRUN] = done & heard;
  assign events_o[`MB_EVENT_CRC]     = verdict & ~broken & ~crc_zero_i;
  assign events_o[`MB_EVENT_SHORT]   = verdict & is_short;
  assign events_o[`MB_EVENT_LONG]    = verdict & long_q;
  assign events_o[`MB_EVENT_GAP]     = verdict & gap_q;

`ifdef FORMAL
  reg       f_past = 1'b0;
  reg       f_clean = 1'b0;          // no character of this frame was faulty
  reg [8:0] f_stored = 9'd0;         // characters stored
  reg [2:0] f_age = 3'd7;            // clocks since the last start bit, 7 and more
  wire      f_gap   = events_o[`MB_EVENT_GAP];
  wire      f_error = f_gap | events_o[`MB_EVENT_PARITY] | events_o[`MB_EVENT_FRAMING] | events_o[`MB_EVENT_CRC] |
                      events_o[`MB_EVENT_SHORT] | events_o[`MB_EVENT_LONG];

  reg       f_bias = 1'b0;           // ASCII mode: the frame RAM counts one byte more than there is
  wire      f_limit = ascii_i;       // and so a frame has one byte less

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    f_bias <= ascii_i & ~open_stb_o;
    f_age  <= start_stb_i ? 3'd0 : (f_age == 3'd7) ? 3'd7 : f_age + 3'd1;
    if (open_stb_o) begin
      f_clean  <= ~(ascii_i & (parity_error_i | framing_error_i));
      f_stored <= 9'd0;
    end else begin
      if (char_stb_i && (parity_error_i || framing_error_i)) f_clean <= 1'b0;
      if (store_stb_o) f_stored <= f_stored + 9'd1;
    end
  end

  always @* if (!f_past) assume (rst_i);
  always @* if (reception && !open_stb_o) assume (count_i == f_stored + {8'd0, f_bias});   // what the frame RAM does
  always @(posedge clk_i) if (f_past) begin
    assume ($stable(gap_count_only_i) && $stable(ascii_i));
    if (!ascii_i) assume (half_i && whole_i);
    if (whole_i) assume (half_i);
    if (f_age != 3'd7) assume (!t35_i && !char_stb_i);          // a character lasts from its start bit on,
    assume (!(char_stb_i && t35_i));                            // a character is no silence,
    if (byte_i == 8'd0 || byte_i > 8'd247) assume (!also_i);   // what modbus_units does
    if ($past(char_stb_i)) assume (!char_stb_i);               // and long
    if ($past(char_stb_i && whole_i)) assume (!t35_i);
    if (ascii_i && start_stb_i) assume (!char_stb_i && !t35_i);
    if (judging || good) assume (!restart_i);                  // the engine has no frame then
    if (!sending_i) assume (!sent_i && !dropped_i);            // of an answer on its way
    if ($past(rst_i))      assume (!sending_i);
    else if ($past(send_stb_o)) assume (sending_i);            // send_stb_o begins one, sent_i or dropped_i ends it
    else assume (!sending_i || $past(sending_i && !sent_i && !dropped_i));
  end

  always @(posedge clk_i) if (f_past) begin
    if (reception && !open_stb_o) begin
      assert (f_stored <= 9'd256 - {8'd0, f_limit});
      assert (f_clean || parity_q || framing_q);
    end
    if (good) begin
      assert (f_clean && t35_i && crc_zero_i && f_stored >= 9'd4 - {8'd0, f_limit} && f_stored <= 9'd256 - {8'd0, f_limit});
      assert (gap_count_only_i || !gap_q);
      assert (!long_q);
      assert (!(f_error && !f_gap));
    end
    if (verdict) assert (good || f_error);             // every frame is accounted for
    if (look_q) assert ($past(good));
    if (read_q)  assert ($past(look_q));
    if (check_q) assert ($past(read_q));
    if (good_stb_o || foreign_stb_o) assert ($past(check_q));
    if (events_o[`MB_EVENT_FRAME]) assert (good_stb_o != foreign_stb_o);
    else                           assert (!good_stb_o && !foreign_stb_o);
    if (foreign_stb_o) assert ($past(!also_i));
    if (good_stb_o) assert ($past((byte_i == 8'd0) ? broadcast_en_i : (also_i || byte_i == address_i) && byte_i <= 8'd247));
    if (store_stb_o) assert (f_stored < 9'd256 && (reception || $past(restart_i)) && !char_stb_i);
    if (sending_i && !$past(rst_i)) assert (state_q == ST_WORK);    // stays in its work while an answer is on its way
    if (send_stb_o) assert (state_q == ST_WORK && !judging);
    if (drop_o) assert (drop_late_i && heard_q);
    if ($past(good_stb_o) && !$past(rst_i | restart_i)) assert (state_q == ST_WORK);
    if (state_q == ST_WORK) assert (!store_stb_o && !open_stb_o && !good);
    cover (good_stb_o && f_stored == 9'd5);
    cover (f_gap && !good_stb_o);
    cover (ascii_i && good_stb_o && f_stored == 9'd3);
    cover (events_o[`MB_EVENT_OVERRUN]);
  end
`endif

endmodule

`default_nettype wire
