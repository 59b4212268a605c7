// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_burst - the way to the bank: the grant question, and the burst that moves a range between frame and bank.
//
// A burst moves the whole range under one wb_cyc_o: bits packed eight to a byte, least significant first, the last byte
// filled with zeros; registers high byte first.  A register takes two clocks, a bit one and each byte of bits one more,
// beside the bank's wait states.  The byte on its way, held_o, is also that of the steps between bursts: the high byte
// of a field, or a byte to put.
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
  output wire        put_o,          // strobe: data_o goes under the cursor; cursor and count up
  output wire [7:0]  data_o,         // level : also for the PUT step
  output wire        step_o,         // strobe: cursor up, count down

  // Memories inside the core
  output wire        inner_o,        // level : a burst reads one of them
  input  wire [15:0] inner_i,        // bytes in the low half

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

  localparam [2:0] ST_REST = 3'd0, ST_TAKE = 3'd1, ST_BEAT = 3'd2, ST_FILL = 3'd3, ST_PUT = 3'd4, ST_LEAD = 3'd5;

  reg [2:0]  state_q = ST_REST, state_d;
  reg [7:0]  held_q = 8'd0;          // a literal may come before the first byte: no X in a simulation
  reg [2:0]  bit_q;
  reg        ended_q;                // the last item is through
  reg        keep_q = 1'b0;
  reg        inner_ack_q;            // the inner memory shows the item
  reg        inner_q, dry_q;         // where the burst goes, known when it begins

  wire asks   = do_i[`MB_DO_GRANT];
  wire writes = argument_i[`MB_ARG_WRITE];

  wire words = (HAS_BITS == 0) || (HAS_WORDS != 0 && space_i[2:1] != 2'b00);
  wire inner = (HAS_INTERNAL != 0) & inner_q;
  wire bytes = inner & space_i[1];
  wire dry   = (HAS_FILES != 0) & dry_q;
  wire wide  = (BITS_PER_BEAT != 1) & ~words;        // sixteen bits a beat
  wire pairs = words | wide;                         // a beat is two bytes of the frame

  // ------------------------------------------------------------------ the burst

  wire beat  = (state_q == ST_BEAT);
  wire fill  = (state_q == ST_FILL);
  wire put   = (state_q == ST_PUT);
  wire take  = (state_q == ST_TAKE) & ~ended_q;
  wire item  = beat & ~ended_q;
  wire stb   = item & ~inner & ~dry;
  wire ack   = (stb & wb_ack_i & ~wb_err_i) | (item & (inner_ack_q | dry));
  wire full  = (bit_q == 3'd7);
  wire shift = ~pairs & (ack | fill);
  wire put_high   = ack & ~writes & words & ~bytes;
  wire lost       = stb & (wb_err_i | (stall_i & ~wb_ack_i));
  wire burst_done = ended_q & (wide & ~writes ? fill : put | (writes & (beat | state_q == ST_TAKE)));

  always @* begin
    state_d = state_q;
    case (state_q)
      // No burst.
      ST_REST: if (do_i[`MB_DO_BURST]) state_d = ~writes ? ST_BEAT : (wide & ~first_i[3]) ? ST_LEAD : ST_TAKE;
      // The low byte of the first word of sixteen bits leaves the frame, unless the range begins above it.
      ST_LEAD: state_d = ST_TAKE;
      // The next byte to write (of a register the high one) leaves the frame.
      ST_TAKE: state_d = ST_BEAT;
      // One item on the bus; behind the last bit of a read the byte is filled up.
      ST_BEAT: begin
        if (ended_q)                     state_d = ST_FILL;
        else if (ack && (pairs || full)) state_d = writes ? ST_TAKE : ST_PUT;
      end
      // Zeros above the last bit.  Sixteen bits a beat: what is left of the last byte.
      ST_FILL: if (full) state_d = ST_PUT;
      // A byte of bits, or the low byte of a register, goes to the frame.
      ST_PUT: state_d = ST_BEAT;
      default: state_d = ST_REST;
    endcase
    if (lost || burst_done) state_d = ST_REST;
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
      reg        second_q;           // the second byte of the bank's word is on its way
      reg        put_q, whole_q;     // whole_q: the last byte is in the frame

      wire        across = (first_i[2:0] != 3'd0);
      wire [3:0]  end_at = last_i | {4{~at_last_i}};
      wire [15:0] kept = 16'hFFFF >> ~end_at;      // up to the last item
      wire        leaves = wide & ~writes & (put | (beat & second_q) | fill);
      wire        whole  = whole_q | (put_q & fit_i);
      // verilator lint_off UNUSED
      wire [15:0] twins  = {fresh, held_q} << turn_q;    // its lower half leaves
      // verilator lint_on UNUSED

      assign passes = leaves | (wide & (take | (state_q == ST_LEAD) | (ack & writes)));
      assign fresh  = writes ? byte_i : word_q[7:0];
      assign turned = twins[15:8];
      assign packed_put = leaves & (skip_q == 2'd0) & ~whole;
      assign word   = word_q;

      always @(posedge clk_i) begin
        if (ack && !writes) word_q <= wb_dat_i & kept;
        else if (passes)    word_q <= {turned & {8{writes}}, word_q[15:8]};
        second_q <= put & ~writes & wide;
        put_q    <= packed_put;
        whole_q  <= whole & moving_o;
        if (state_q == ST_REST) begin
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

  // From the bus or shifted while items move, else a literal, the status, or made of the byte under the cursor
  wire        load    = do_i[`MB_DO_LOAD];
  wire        literal = (HAS_LITERALS != 0) & do_i[`MB_DO_LITERAL];
  wire        moves   = beat | fill | passes;
  wire [15:0] data    = inner ? inner_i : wb_dat_i;
  wire [7:0]  moved   = wide ? fresh : words ? data[7:0] : {data[0] & beat, held_q[7:1]};
  wire [1:0]  what    = load ? argument_i[`MB_ARG_WHAT] : `MB_LOAD_BYTE;
  wire [7:0]  given   = literal ? argument_i[`MB_ARG_LITERAL] : status_i;
  wire [7:0]  seen    = (literal | do_i[`MB_DO_STATUS])            ? given :
                        (what == `MB_LOAD_XOR && HAS_MASK != 0)    ? held_q ^ byte_i :
                        (what == `MB_LOAD_AND && HAS_MASK != 0)    ? held_q & byte_i :
                        {byte_i[7] | (load & argument_i[`MB_ARG_MARK]), byte_i[6:0]};
  wire        holds   = do_i[`MB_DO_HOLD] | load | literal | do_i[`MB_DO_STATUS] | (wide ? passes : take | ack | fill);

  always @(posedge clk_i) begin
    state_q     <= state_d;
    inner_q     <= space_i[2] & (space_i[1:0] != 2'b00);
    dry_q       <= argument_i[`MB_ARG_DRY];
    inner_ack_q <= item & inner & ~inner_ack_q;
    if (burst_done || lost || do_i[`MB_DO_RELEASE]) keep_q <= argument_i[`MB_ARG_KEEP] & burst_done;
    ended_q     <= moving_o & (ended_q | (ack & at_last_i));

    if (state_q == ST_REST) bit_q <= 3'd0;
    else if (shift)         bit_q <= bit_q + 3'd1;

    if (holds) held_q <= moves ? moved : seen;

    if (rst_i) begin
      state_q <= ST_REST;
      keep_q  <= 1'b0;
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
  assign moving_o = (state_q != ST_REST);
  assign next_o   = ack;

  assign put_o  = put_high | (put & ~wide) | packed_put;
  assign data_o = packed_put ? turned : beat ? data[15:8] : held_q;
  assign step_o = take | (wide & (state_q == ST_LEAD)) | (ack & writes & pairs);

  assign waiting_o   = (question & ~grant_ack_i) | (stb & ~wb_ack_i);
  assign grant_req_o = question;
  assign inner_o     = moving_o & inner;

  assign wb_cyc_o = (moving_o & ~inner & ~dry) | keep_q;
  assign wb_stb_o = stb;
  assign wb_we_o  = stb & writes;
  assign wb_dat_o = wide ? word : {held_q, byte_i[7:1], words ? byte_i[0] : held_q[0]};

`ifdef FORMAL
  // A range of f_left items more than this one, and the frame around the burst
  reg        f_past = 1'b0;
  reg [3:0]  f_left = 4'd0;          // items behind the one at hand; free when a burst begins
  (* anyseq *) wire [3:0] f_items;
  reg        f_over = 1'b0;          // the last item of this burst is through
  reg [7:0]  f_bits;                 // bits of this byte, as they came
  reg [3:0]  f_count = 4'd0;         // so many
  reg        f_failed = 1'b0;        // the burst ended without done

  wire f_begins = (state_q == ST_REST) & do_i[`MB_DO_BURST];

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (f_begins) begin
      f_left <= f_items;
      f_over <= 1'b0;
    end else if (next_o) begin
      f_left <= f_left - 4'd1;
      f_over <= f_over | at_last_i;
    end
    if (f_begins || (put_o && !words)) begin
      f_count <= 4'd0;
      f_bits  <= 8'd0;
    end else if (ack) begin
      f_bits[f_count[2:0]] <= data[0];
      f_count <= f_count + 4'd1;
    end
  end

  always @* begin
    if (!f_past) assume (rst_i);
    assume (at_last_i == (f_left == 4'd0));
    assume (!(do_i[`MB_DO_GRANT] && do_i[`MB_DO_BURST]));
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
    end
    if (f_past && !rst_i && !$past(rst_i)) begin
      assert (state_q <= ST_LEAD);
      // Never past the last item
      if (moving_o && f_over) assert (!next_o && !wb_stb_o);
      assert (!moving_o || ended_q == f_over);
      if (burst_done) assert (f_over);
      // Bits packed from the lowest, filled with zeros
      if (put_o && moving_o && !pairs) assert (data_o == f_bits);
      if (moving_o && !pairs && !writes && state_q != ST_PUT) assert (bit_q == f_count[2:0] || f_over);
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
    cover (f_past && put_o && !words && moving_o && f_over);
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
