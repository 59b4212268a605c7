// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_burst - the way to the bank: the grant question, and the burst that moves a range between frame and bank.
//
// A burst moves the whole range under one wb_cyc_o: bits packed eight to a byte, least significant first, the last byte
// filled with zeros; registers high byte first.  A register takes two clocks, a bit one and each byte of bits one more,
// beside the bank's wait states.
//
// Block RAMs are slow, so no path leads from one to another, except from the frame RAM to the bank.  Three byte registers stand
// between; the steps use them too.  late_o is the byte under the cursor a clock ago, at which the steps look.  held_o is the
// first byte of a field, or a byte to put or to compare.
//
//   read:   high byte -> late_q -> frame         low byte or bit -> low_q -> held_q -> frame
//   write:  high byte of the frame -> late_q -> bank, low byte -> bank; bits: late_q -> held_q, shifted out to the bank
//   steps:  literal or status byte -> low_q -> held_q;  byte under the cursor -> late_q -> held_q
//
// The bus is Wishbone B4, classic cycles, 16 bits of data.  A bit uses data bit 0; the other data bits of a bit write
// mean nothing.  With BITS_PER_BEAT = 16 a beat moves all bits of the range in one word of 16 addresses: item n is data
// bit n mod 16, and data bits outside the range mean nothing.  Such a word takes two clocks, as a register does.
// wb_err_i ends the burst with the bank's exception code (0 stands for 04).  A range past its end is refused with 02
// without a question.  A grant question or a beat that is not answered when stall_i rises is withdrawn and ends with 06
// or 04.
//
// Spaces above MB_SPACE_FILES are memories inside the core, without grant and bus: words of counters, bytes of the event
// log and of texts, each there a clock after its address.  A dry burst passes over the data of the frame alone.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_burst #(
  parameter integer HAS_BITS     = 1,        // coils or discrete inputs are reachable
  parameter integer HAS_WORDS    = 1,        // registers are reachable
  parameter integer HAS_MASK     = 1,        // the XOR and AND loads are used
  parameter integer HAS_INTERNAL = 1,        // spaces inside the core
  parameter integer HAS_LITERALS = 1,        // literals to hold
  parameter integer HAS_FILES    = 1,        // dry bursts
  parameter integer BITS_PER_BEAT = 1        // 1 or 16
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Sequencer
  input  wire [`MB_BURST_DO_WIDTH-1:0] do_i,         // MB_DO_*
  input  wire [9:0]  argument_i,     // level : MB_ARG_WRITE, KEEP, DRY, WHAT, MARK, LITERAL
  input  wire [2:0]  space_i,        // level
  input  wire [7:0]  status_i,       // level : the status byte
  output wire [7:0]  held_o,
  output wire        done_o,         // strobe: granted, or the burst has ended
  output wire        fail_o,         // strobe: refused, broken off
  output wire [3:0]  fail_code_o,    // level : with fail_o

  // Range
  input  wire        past_end_i,     // level : the range is refused
  input  wire        at_last_i,      // level : this is the last beat
  input  wire [3:0]  first_i,        // level : lowest bits of the first address
  input  wire [3:0]  last_i,         // level : of the last address
  input  wire        fit_i,          // level : a clock ago all bytes of the range but one were in the frame
  output wire        moving_o,       // level : a burst is under way
  output wire        next_o,         // strobe: a beat is through

  // Frame RAM
  input  wire [7:0]  byte_i,         // under the cursor
  output wire [7:0]  late_o,         // the byte that was under the cursor a clock ago, unless an item is on the bus
  output wire        put_o,          // strobe: data_o goes under the cursor; cursor and count up
  output wire [7:0]  data_o,         // level : also for the PUT step
  output wire        step_o,         // strobe: cursor up, count down

  // Memories inside the core
  output wire        inner_o,        // level : a burst reads one of them
  input  wire [15:0] inner_i,        // bytes in the low half; 0 while inner_o is low

  // Stall watch
  output wire        waiting_o,      // level : the bank owes an answer
  input  wire        stall_i,        // level : it has owed it for too long

  // Bank
  output wire        grant_req_o,
  input  wire        grant_ack_i,
  input  wire [3:0]  exception_i,    // with grant_ack_i: 0 granted; with wb_err_i: 0 means 04
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [15:0] wb_dat_o,
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i
);

  generate
    if (BITS_PER_BEAT != 1 && BITS_PER_BEAT != 16) begin : gen_illegal
      ERROR_modbus_BITS_PER_BEAT_is_1_or_16 illegal_parameter ();
    end
  endgenerate

  // Where the burst is, one of these while moving_q is set; a register each, so no strobe has to be decoded
  reg        lead_q = 1'b0;          // the low byte of the first word of sixteen bits leaves the frame
  reg        take_q = 1'b0;          // the next byte to write (of a register the high one) leaves the frame
  reg        item_q = 1'b0;          // an item is on the bus
  reg        fill_q = 1'b0;          // zeros above the last bit; sixteen bits a beat: what is left of the last byte
  reg        put_q  = 1'b0;          // eight bits or a byte are complete, or the high byte of a word goes to the frame
  reg        tail_q = 1'b0;          // a write has ended; sixteen bits a beat: a last byte follows
  reg        moving_q = 1'b0;
  reg [7:0]  held_q = 8'd0;          // a literal may come before the first byte: no X in a simulation
  reg [2:0]  bit_q;
  reg        ended_q;                // the last item is through
  reg [7:0]  late_q = 8'd0;          // the byte under the cursor a clock ago; the high byte of a register that is
                                     // read or written
  reg [7:0]  low_q = 8'd0;           // the low byte of one that is read; bit 0: the bit that was read last, or a zero
  reg        last_q = 1'b0;          // the held byte goes to the frame: a low byte, or eight bits
  reg        keep_q = 1'b0;
  reg        given_q = 1'b0;         // low_q was given by the step and is to be held
  reg        inner_ack_q;            // the inner memory shows the item
  reg        inner_q, dry_q, bus_q;  // the burst goes to a memory of the core, nowhere, to the bank

  wire asks   = do_i[`MB_DO_GRANT];
  wire writes = argument_i[`MB_ARG_WRITE];

  wire words = (HAS_BITS == 0) || (HAS_WORDS != 0 && space_i[2:1] != 2'b00);
  wire inner = (HAS_INTERNAL != 0) & inner_q;
  wire bytes = inner & space_i[1];
  wire dry   = (HAS_FILES != 0) & dry_q;
  wire bus   = (HAS_INTERNAL == 0 && HAS_FILES == 0) | bus_q;
  wire wide  = (BITS_PER_BEAT != 1) & ~words;        // sixteen bits a beat
  wire pairs = words | wide;                         // a beat is two bytes of the frame

  // ------------------------------------------------------------------ the burst

  wire begins = do_i[`MB_DO_BURST] & ~moving_q;
  wire lead  = (BITS_PER_BEAT != 1) & lead_q;
  wire stb   = item_q & bus;
  wire ack   = (stb & wb_ack_i & ~wb_err_i) | (item_q & (inner_ack_q | dry));
  wire whole = pairs | (bit_q == 3'd7);              // with this item the byte, or more, is complete
  wire shift = ~pairs & (ack | fill_q);
  wire lost  = stb & (wb_err_i | (stall_i & ~wb_ack_i));
  wire put_high   = put_q & words & ~bytes;
  wire burst_done = (tail_q & writes) | (wide ? fill_q : put_q & ended_q);
  wire begins_low  = wide & ~first_i[3];              // the range begins in the low byte of a word

  //  read:  item, put, item, put ...          bits: item ..., (fill ...), put, item ...
  //  write: take, item, take, item ..., tail  bits: take, item ..., take ..., tail
  always @(posedge clk_i) begin
    moving_q <= (begins | moving_q) & ~lost & ~burst_done;
    lead_q   <= begins & writes & begins_low;
    take_q   <= (begins & writes & ~begins_low) | lead | (ack & writes & whole & ~at_last_i);
    item_q   <= (begins & ~writes) | take_q | (put_q & ~ended_q) | (item_q & ~lost & ~(ack & (whole | at_last_i)));
    fill_q   <= (HAS_BITS != 0) & ((ack & ~writes & ~whole & at_last_i) | (wide ? tail_q & ~writes : fill_q & ~whole));
    put_q    <= ~writes & whole & (ack | (fill_q & ~wide));
    tail_q   <= (ack & writes & at_last_i) | (wide & put_q & ended_q);
    if (rst_i) {moving_q, lead_q, take_q, item_q, fill_q, put_q, tail_q} <= 7'd0;
  end

  // ------------------------------------------------------------------ sixteen bits a beat

  wire       passes;                 // a byte goes from the bank to the frame, or back
  wire [7:0] fresh;                  // this one
  wire [7:0] turned;                 // eight bits of this byte and of the one before, as they lie on the other side
  wire       packed_put;             // they go to the frame
  wire [15:0] word;                  // to the bank

  // The range begins at bit 0 of a byte of the frame, and at bit (first address mod 16) of a word of the bank.  So each
  // byte on the other side is made of two neighbours:
  //
  //       fresh        held_q
  //   +-----------+-----------+
  //   | 7 ..... 0 | 7 ..... 0 |   shifted left by turn_q; the upper eight bits are the byte
  //   +-----------+-----------+
  //
  // word_q is a shift register of two bytes.  A read puts the bank's word in, and it leaves from the low end; a write
  // collects the word for the bank, and a new low byte comes in while the bank takes the word before.
  generate
    if (BITS_PER_BEAT != 1 && HAS_BITS != 0) begin : gen_wide
      reg [15:0] word_q = 16'd0;     // data bits outside the range are no X in a simulation
      reg [2:0]  turn_q;
      reg [1:0]  skip_q;             // so many bytes of the bank lie before the first of the frame
      reg        second_q = 1'b0;    // the second byte of the bank's word is on its way
      reg        gone_q = 1'b0;      // a byte went to the frame
      reg        all_q = 1'b0;       // and that was the last one

      wire        across = (first_i[2:0] != 3'd0);
      wire [3:0]  end_at = last_i | {4{~at_last_i}};
      wire [15:0] kept = 16'hFFFF >> ~end_at;      // up to the last item
      wire        leaves = wide & ~writes & (put_q | second_q | fill_q);
      wire        all    = all_q | (gone_q & fit_i);
      // verilator lint_off UNUSED
      wire [15:0] twins  = {fresh, held_q} << turn_q;    // its lower half leaves
      // verilator lint_on UNUSED

      assign passes = leaves | (wide & (take_q | lead | (ack & writes)));
      assign fresh  = writes ? byte_i : word_q[7:0];
      assign turned = twins[15:8];
      assign packed_put = leaves & (skip_q == 2'd0) & ~all;
      assign word   = word_q;

      always @(posedge clk_i) begin
        if (ack && !writes) word_q <= wb_dat_i & kept;
        else if (passes)    word_q <= {turned & {8{writes}}, word_q[15:8]};
        second_q <= put_q & ~writes & wide & ~rst_i;
        gone_q   <= packed_put;
        all_q    <= all & moving_q;
        if (!moving_q) begin
          turn_q <= writes ? first_i[2:0] : 3'd0 - first_i[2:0];
          skip_q <= {first_i[3] & across, first_i[3] ^ across};
        end else if (leaves && skip_q != 2'd0) skip_q <= skip_q - 2'd1;
      end
    end else begin : gen_not_wide
      wire unused = &{1'b0, first_i, last_i, fit_i};
      assign passes = 1'b0;
      assign fresh  = 8'd0;
      assign turned = 8'd0;
      assign packed_put = 1'b0;
      assign word   = 16'd0;
    end
  endgenerate

  // ------------------------------------------------------------------ the held byte

  // What the bank and the memories of the core show comes late, so nothing stands behind it but an OR.
  wire        load    = do_i[`MB_DO_LOAD];
  wire        literal = (HAS_LITERALS != 0) & do_i[`MB_DO_LITERAL];
  wire        gives   = literal | do_i[`MB_DO_STATUS];
  wire [7:0]  given   = literal ? argument_i[`MB_ARG_LITERAL] : status_i;
  wire [7:0]  inner_high, inner_low;
  assign {inner_high, inner_low} = (HAS_INTERNAL != 0) ? inner_i : 16'd0;

  wire [7:0]  moved   = (words | given_q) ? low_q : wide ? fresh : {low_q[0], held_q[7:1]};
  wire [1:0]  what    = load ? argument_i[`MB_ARG_WHAT] : `MB_LOAD_BYTE;
  wire [7:0]  seen    = (what == `MB_LOAD_XOR && HAS_MASK != 0) ? held_q ^ late_q :
                        (what == `MB_LOAD_AND && HAS_MASK != 0) ? held_q & late_q :
                        {late_q[7] | (load & argument_i[`MB_ARG_MARK]), late_q[6:0]};
  // The first bit of each byte goes out of late_q while held_q takes the byte; the other seven are shifted out of held_q.
  wire        first   = item_q & writes & ~pairs & (bit_q == 3'd0);
  wire        looks   = do_i[`MB_DO_HOLD] | load | first;
  wire        holds   = looks | given_q | (wide ? passes : put_q | shift);

  always @(posedge clk_i) begin
    inner_q     <= do_i[`MB_DO_BURST] & space_i[2] & (space_i[1:0] != 2'b00);
    dry_q       <= argument_i[`MB_ARG_DRY];
    bus_q       <= ~(space_i[2] & (space_i[1:0] != 2'b00)) & ~argument_i[`MB_ARG_DRY];
    inner_ack_q <= inner & (put_q | (item_q & ~inner_ack_q));
    if (burst_done || lost || do_i[`MB_DO_RELEASE]) keep_q <= argument_i[`MB_ARG_KEEP] & burst_done;
    if (!item_q || !writes) late_q <= item_q ? (wb_dat_i[15:8] & {8{bus}}) | inner_high : byte_i;
    last_q      <= put_q & ~wide;
    given_q     <= gives;
    if (ack || fill_q || gives) low_q <= (wb_dat_i[7:0] & {8{stb}}) | inner_low | (given & {8{gives}});
    ended_q     <= moving_q & (ended_q | (ack & at_last_i));

    if (!moving_q)  bit_q <= 3'd0;
    else if (shift) bit_q <= bit_q + 3'd1;

    if (holds) held_q <= looks ? seen : moved;

    if (rst_i) begin
      keep_q  <= 1'b0;
      given_q <= 1'b0;
      last_q  <= 1'b0;
    end
  end

  // ------------------------------------------------------------------ answers

  wire question = asks & ~past_end_i;
  wire granted  = question & grant_ack_i & (exception_i == 4'd0);
  wire refused  = asks & (past_end_i | (grant_ack_i ? exception_i != 4'd0 : stall_i));

  assign done_o      = granted | burst_done;
  assign fail_o      = refused | lost;
  assign fail_code_o = (asks & past_end_i)               ? `MB_EX_ILLEGAL_DATA_ADDRESS :
                       (asks ? grant_ack_i : wb_err_i)   ? (exception_i | {1'b0, exception_i == 4'd0, 2'b00}) :
                       asks                              ? `MB_EX_DEVICE_BUSY : `MB_EX_DEVICE_FAILURE;
  assign held_o   = held_q;
  assign late_o   = late_q;
  assign moving_o = moving_q;
  assign next_o   = ack;

  assign put_o  = last_q | put_high | packed_put;
  assign data_o = packed_put ? turned : put_high ? late_q : held_q;
  assign step_o = take_q | lead | (ack & writes & pairs);

  assign waiting_o   = (question & ~grant_ack_i) | (stb & ~wb_ack_i);
  assign grant_req_o = question;
  assign inner_o     = inner;

  assign wb_cyc_o = (moving_q & bus) | keep_q;
  assign wb_stb_o = stb;
  assign wb_we_o  = stb & writes;
  assign wb_dat_o = wide ? word : {late_q, byte_i[7:1], words ? byte_i[0] : first ? late_q[0] : held_q[1]};

`ifdef FORMAL
  // A range of f_left items more than this one, and the frame around the burst
  reg        f_past = 1'b0;
  reg [3:0]  f_left = 4'd0;          // items behind the one at hand; free when a burst begins
  (* anyseq *) wire [3:0] f_items;
  reg        f_over = 1'b0;          // the last item of this burst is through
  reg [7:0]  f_bits;                 // bits of this byte, as they came
  reg [3:0]  f_count = 4'd0;         // so many
  reg        f_failed = 1'b0;        // the burst ended without done
  reg [7:0]  f_byte;                 // the byte that left the frame for the items at hand

  wire f_begins = begins;
  wire [15:0] f_data = inner ? inner_i : wb_dat_i;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (f_begins) begin
      f_left <= f_items;
      f_over <= 1'b0;
    end else if (next_o) begin
      f_left <= f_left - 4'd1;
      f_over <= f_over | at_last_i;
    end
    if (take_q) f_byte <= byte_i;
    if (f_begins || (put_o && !words)) begin
      f_count <= {3'd0, ack};
      f_bits  <= {7'd0, ack & f_data[0]};
    end else if (ack) begin
      f_bits[f_count[2:0]] <= f_data[0];
      f_count <= f_count + 4'd1;
    end
  end

  always @* begin
    if (!f_past) assume (rst_i);
    assume (at_last_i == (f_left == 4'd0));
    if (do_i[`MB_DO_BURST]) assume (do_i[5:0] == (6'd1 << `MB_DO_BURST) && !given_q);
  end

  always @(posedge clk_i) begin
    // The sequencer: one command at a time; a burst is asked for until it has ended; its step stands still.
    if (f_past && !rst_i && !$past(rst_i)) begin
      if ($past(moving_o)) begin
        assume ($stable(argument_i) && $stable(space_i));
        assume (do_i[5:0] == 6'd0 || do_i[5:0] == (6'd1 << `MB_DO_BURST));
      end
      if (moving_o) assume (do_i[`MB_DO_BURST] && !do_i[`MB_DO_RELEASE]);
      if ($past(f_begins)) assume ($stable(argument_i) && $stable(space_i));
      if (HAS_INTERNAL != 0 && moving_o) assume (!inner || !writes);
      assume (dry_q == 1'b0 || writes);
      assume (inner || inner_i == 16'd0);
    end
    if (f_past && !rst_i && !$past(rst_i)) begin
      assert (moving_q == ({2'd0, lead_q} + take_q + item_q + fill_q + put_q + tail_q == 3'd1));
      assert ({2'd0, lead_q} + take_q + item_q + fill_q + put_q + tail_q <= 3'd1);
      // Never past the last item
      if (moving_o && f_over) assert (!next_o && !wb_stb_o);
      assert (!moving_o || ended_q == f_over);
      if (burst_done) assert (f_over);
      // Bits packed from the lowest, filled with zeros
      if (put_o && !pairs) assert (data_o == f_bits);
      if (moving_o && !pairs && !writes && !put_q) assert (bit_q == f_count[2:0] || f_over);
      // A register read goes to the frame in the two clocks behind its beat, high byte first.
      if ($past(ack && words && !bytes && !writes)) assert (put_o && data_o == $past(f_data[15:8]));
      if (last_q && words && !bytes)                assert (put_o && data_o == $past(f_data[7:0], 2));
      // A register written is two bytes of the frame that follow each other, a bit written is that of its place.
      if (wb_stb_o && writes && words)  assert (wb_dat_o == {f_byte, byte_i});
      if (wb_stb_o && writes && !pairs) assert (wb_dat_o[0] == f_byte[bit_q]);
      // A beat is not withdrawn or changed before the bank answers.
      if ($past(wb_stb_o) && !$past(wb_ack_i) && !$past(wb_err_i) && !$past(stall_i))
        assert (wb_stb_o && $stable(wb_we_o));
      if (wb_stb_o) assert (wb_cyc_o);
      if (wb_stb_o && $past(wb_stb_o) && !$past(wb_ack_i) && !$past(wb_err_i) && writes && words)
        assert ($stable(wb_dat_o[15:8]));
      // No item without an answer of the bank, and only one for each
      if (next_o && !inner && !dry) assert (wb_stb_o && wb_ack_i && !wb_err_i);
      // A question is put to the bank for a range that can exist alone.
      if (grant_req_o) assert (asks && !past_end_i);
      if (done_o && asks) assert (grant_ack_i && exception_i == 4'd0 && !past_end_i);
      if (fail_o) assert (fail_code_o != 4'd0);
      if (wb_cyc_o && !moving_o) assert (keep_q);
      if ($past(do_i[`MB_DO_RELEASE]) && !$past(moving_o) && !moving_o) assert (!wb_cyc_o);
    end
    cover (f_past && burst_done && !words && writes && f_items == 4'd9);
    cover (f_past && put_o && !words && f_over);
  end

  // Sixteen bits a beat: the range begins at bit f_from of the first of its words and ends at bit f_to of the last.  One
  // of its items is followed from side to side.
  generate
    if (BITS_PER_BEAT != 1 && HAS_BITS != 0) begin : gen_wide_rules
      reg  [3:0] f_from, f_to;
      reg  [7:0] f_most;             // items less one
      reg  [4:0] f_bytes;            // in the frame
      reg  [4:0] f_words;            // on the bus
      reg        f_bit;              // the item, where it comes from
      reg        f_fit = 1'b0;
      (* anyconst *) reg [7:0] f_item;
      wire [7:0] f_lane = f_item + {4'd0, f_from};
      wire       f_here = (f_item <= f_most);
      wire       f_reads = moving_o & wide & ~writes, f_gives = moving_o & wide & writes;
      wire       f_leaves = f_gives & step_o;    // a byte leaves the frame
      always @(posedge clk_i) begin
        if (f_begins) begin
          f_from  <= first_i;
          f_to    <= last_i;
          f_most  <= {f_items, last_i} - {4'd0, first_i};
          f_bytes <= 5'd0;
          f_words <= 5'd0;
        end else begin
          if (ack) f_words <= f_words + 5'd1;
          if (put_o || f_leaves) f_bytes <= f_bytes + 5'd1;
        end
        f_fit <= (f_bytes == f_most[7:3]);
        if (f_reads && ack && f_words == {1'b0, f_lane[7:4]}) f_bit <= wb_dat_i[f_lane[3:0]];
        if (f_leaves && f_bytes == f_item[7:3])              f_bit <= byte_i[f_item[2:0]];
      end
      always @* begin
        assume (fit_i == f_fit);
        if (f_begins && wide) assume (f_items != 4'd0 || last_i >= first_i);
        if (f_begins && wide) assume (f_items <= 4'd2);
        if (moving_o) assume (last_i == f_to);
        // Three words: a first, a last, one between
        assume (f_item < 8'd48);
      end
      always @(posedge clk_i) if (f_past && !rst_i && !$past(rst_i)) begin
        // A bit read lies where it belongs, behind the last one are zeros, and no byte is missing or too many.
        if (f_reads && put_o) begin
          assert (f_bytes <= f_most[7:3]);
          if (f_here && f_bytes == f_item[7:3])  assert (data_o[f_item[2:0]] == f_bit);
          if (!f_here && f_bytes == f_item[7:3]) assert (!data_o[f_item[2:0]]);
        end
        if (f_reads && burst_done) assert (f_bytes + put_o == f_most[7:3] + 5'd1);
        // A bit written too.
        if (f_gives && wb_stb_o && f_here && f_words == {1'b0, f_lane[7:4]}) assert (wb_dat_o[f_lane[3:0]] == f_bit);
        if (f_gives && wb_stb_o && !$past(ack) && $past(wb_stb_o)) assert ($stable(wb_dat_o));
        cover (f_reads && burst_done && f_bytes == 5'd3 && f_from == 4'd13);
        cover (f_gives && burst_done && f_bytes == 5'd4 && f_from == 4'd11 && f_most == 8'd20);
      end
    end
  endgenerate
`endif

endmodule

`default_nettype wire
