// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_data_access - one range of items: its bounds, the grant for it, and the burst that moves it.
//
// Holds the first address, the quantity and the last address of a range, and one byte on its way.  A burst moves the
// whole range between the frame RAM and the bus under one wb_cyc_o: bits packed eight to a byte, least
// significant first, the last byte filled with zeros; registers high byte first.  A register takes two clocks,
// a bit one and each byte of bits one more, beside the bank's wait states.
//
// The bus is Wishbone B4, classic cycles, 16 bits of data, address {space, item}.  A bit uses data bit 0; the other
// data bits of a bit write mean nothing.  wb_err_i ends the burst with the bank's exception code (0 stands
// for 04).  A grant question or a beat unanswered when stall_i rises is withdrawn and ends with 06 or 04.
//
// Spaces above MB_SPACE_FILES are memories inside the core, without grant and bus: words of counters, bytes of the
// event log and of texts, each there a clock after its address.  A dry burst passes over the data of the frame alone.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_data_access #(
  parameter integer HAS_BITS  = 1,           // coils or discrete inputs are reachable
  parameter integer HAS_WORDS = 1,           // registers are reachable
  parameter integer HAS_MASK  = 1,           // the XOR and AND loads are used
  parameter integer HAS_INTERNAL = 1,        // spaces inside the core
  parameter integer HAS_LITERALS = 1,        // addresses and quantities that are not in the request
  parameter integer HAS_FILES = 1
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Commands, each valid for the clock it is high
  input  wire        hold_i,         // strobe: keep the byte under the cursor (high byte of a word)
  input  wire        address_i,      // strobe: first address = {held, byte}
  input  wire        quantity_i,     // strobe: quantity = {held, byte}
  input  wire        depth_i,        // strobe: quantity = {held, byte} + 1
  input  wire        single_i,       // strobe: quantity = 1
  input  wire        set_first_i,    // strobe: first address = literal_i
  input  wire        set_less_i,     // strobe: quantity = literal_i + 1
  input  wire        file_i,         // strobe: file number = {held, byte}
  input  wire        total_clear_i,  // strobe: no group yet
  input  wire        total_i,        // strobe: add a group to the answer's length
  input  wire        range_i,        // strobe: compute the last address
  input  wire        load_i,         // strobe: held byte by load_what_i
  input  wire [1:0]  load_what_i,    // MB_LOAD_*
  input  wire        load_flag_i,    // level : BYTE: set bit 7
  input  wire        literal_stb_i,  // strobe: held byte = literal_i
  input  wire [7:0]  literal_i,
  input  wire        grant_i,        // level until done or failed: ask the bank
  input  wire        burst_i,        // level until done or failed: move the range
  input  wire        write_i,        // level : direction of both
  input  wire        keep_i,         // level : hold the bus after this burst
  input  wire        dry_i,          // level : nothing but the frame
  input  wire        release_i,      // strobe: the request is over, let go of the bus
  input  wire [2:0]  space_i,
  input  wire [10:0] room_i,         // level : 2048 - highest quantity allowed
  input  wire [7:0]  status_i,       // level : for a STATUS load

  // Answers
  output wire        in_limit_o,     // level : 1 <= quantity <= 2048 - room_i, two clocks after quantity_i
  output wire        bytes_fit_o,    // level : count_i + 1 is the byte count of the quantity; one clock late
  output wire        over_o,         // level : the range passes FFFFH, after range_i
  output wire        beyond_o,       // level : it passes record 270FH, a clock later
  output wire        too_long_o,     // level : the groups pass F5H bytes, after total_i
  output wire [7:0]  length_o,       // level : length byte of a group
  output wire        done_o,         // strobe
  output wire        fail_o,         // strobe
  output wire [3:0]  fail_code_o,    // level : with fail_o
  output wire [7:0]  held_o,
  output wire [15:0] first_o,
  output wire [15:0] last_o,
  output wire [15:0] file_o,

  // Memories inside the core
  output wire        inner_o,       // level : a burst reads one of them, at first_o
  input  wire [15:0] inner_i,       // bytes in the low half

  // Frame RAM
  input  wire [7:0]  byte_i,
  input  wire [8:0]  count_i,
  output wire        put_o,          // strobe: data_o goes under the cursor; cursor and count up
  output wire [7:0]  data_o,         // level : also for the PUT step of dispatch
  output wire        step_o,         // strobe: cursor up, count down

  // Stall watch
  output wire        waiting_o,      // level : the bank owes an answer
  input  wire        stall_i,        // level : it has owed it for too long

  // Bank
  output wire        grant_req_o,
  output wire        grant_write_o,
  input  wire        grant_ack_i,
  input  wire [3:0]  exception_i,    // with grant_ack_i: 0 granted; with wb_err_i: 0 means 04
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [18:0] wb_adr_o,
  output wire [15:0] wb_dat_o,
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i
);

  localparam [2:0] ST_REST = 3'd0, ST_TAKE = 3'd1, ST_BEAT = 3'd2, ST_FILL = 3'd3, ST_PUT = 3'd4;

  reg [2:0]  state_q = ST_REST, state_d;
  reg [15:0] first_q;
  reg [15:0] less_one_q;             // quantity - 1: what the last address and the byte count need
  reg [15:0] last_q;
  reg        over_q, in_limit_q, bytes_fit_q;
  reg [7:0]  held_q = 8'd0;         // a literal may come before the first byte: no X in a simulation
  reg [2:0]  bit_q;
  reg        ended_q;                // the last item is through
  reg        keep_q = 1'b0;

  reg        inner_ack_q;           // the inner memory shows first_q
  reg        inner_q, dry_q;         // where the burst goes, known when it begins

  wire words = (HAS_BITS == 0) || (HAS_WORDS != 0 && space_i[2:1] != 2'b00);
  wire inner = (HAS_INTERNAL != 0) & inner_q;
  wire bytes = inner & space_i[1];
  wire dry   = (HAS_FILES != 0) & dry_q;
  wire [7:0] bytes_less_one = words ? {less_one_q[6:0], 1'b1} : less_one_q[10:3];

  // Burst
  wire beat  = (state_q == ST_BEAT);
  wire fill  = (state_q == ST_FILL);
  wire put   = (state_q == ST_PUT);
  wire take  = (state_q == ST_TAKE) & ~ended_q;
  wire item  = beat & ~ended_q;
  wire stb   = item & ~inner & ~dry;
  wire ack   = (stb & wb_ack_i & ~wb_err_i) | (item & (inner_ack_q | dry));
  wire full  = (bit_q == 3'd7);
  wire shift = ~words & (ack | fill);
  wire put_high   = ack & ~write_i & words & ~bytes;
  wire lost       = stb & (wb_err_i | (stall_i & ~wb_ack_i));
  wire burst_done = ended_q & (put | (write_i & (beat | state_q == ST_TAKE)));
  wire refused    = grant_i & (grant_ack_i ? exception_i != 4'd0 : stall_i);
  wire granted    = grant_i & grant_ack_i & (exception_i == 4'd0);

  // The held byte: from the bus or shifted while items move, else from the byte under the cursor or the status.
  wire        moves  = beat | fill;
  wire [15:0] data   = inner ? inner_i : wb_dat_i;
  wire [7:0]  moved  = words ? data[7:0] : {data[0] & beat, held_q[7:1]};
  wire        literal = (HAS_LITERALS != 0) & literal_stb_i;
  wire [1:0]  what   = load_i ? load_what_i : literal ? `MB_LOAD_STATUS : `MB_LOAD_BYTE;
  wire [7:0]  status = literal ? literal_i : status_i;
  wire [7:0]  looked = (what == `MB_LOAD_STATUS)                 ? status :
                      (what == `MB_LOAD_XOR && HAS_MASK != 0)    ? held_q ^ byte_i :
                      (what == `MB_LOAD_AND && HAS_MASK != 0)    ? held_q & byte_i :
                      {byte_i[7] | (load_i & load_flag_i), byte_i[6:0]};

  always @* begin
    state_d = state_q;
    case (state_q)
      // No burst.
      ST_REST: if (burst_i) state_d = write_i ? ST_TAKE : ST_BEAT;
      // The next byte to write (of a register the high one) leaves the frame.
      ST_TAKE: state_d = ST_BEAT;
      // One item on the bus; behind the last bit of a read the byte is filled up.
      ST_BEAT: begin
        if (ended_q)                 state_d = ST_FILL;
        else if (ack && (words || full)) state_d = write_i ? ST_TAKE : ST_PUT;
      end
      // Zeros above the last bit.
      ST_FILL: if (full) state_d = ST_PUT;
      // A byte of bits, or the low byte of a register, goes to the frame.
      ST_PUT: state_d = ST_BEAT;
      default: state_d = ST_REST;
    endcase
    if (lost || burst_done) state_d = ST_REST;
  end

  // Fields come from the request, high byte first, or as a literal with high byte 0.
  wire        set_first = (HAS_LITERALS != 0) & set_first_i;
  wire        set_less  = (HAS_LITERALS != 0) & set_less_i;
  wire [15:0] field     = {held_q, (set_first | set_less) ? literal_i : byte_i};
  wire        as_it_is  = set_less | ((HAS_LITERALS != 0) & depth_i);

  // The sum means nothing while an address is set; written so, a counter that can be loaded takes one cell a bit.
  wire        set_address = address_i | set_first;
  wire [15:0] next_first  = first_q + {{15{set_address}}, 1'b1};

  wire        beyond_limit;
  // verilator lint_off UNUSED
  wire [10:0] excess;
  // verilator lint_on UNUSED
  assign {beyond_limit, excess} = {1'b0, less_one_q[10:0]} + {1'b0, room_i};

  always @(posedge clk_i) begin
    state_q <= state_d;
    inner_q     <= space_i[2] & (space_i[1:0] != 2'b00);
    dry_q       <= dry_i;
    inner_ack_q <= item & inner & ~inner_ack_q;
    if (burst_done || lost || release_i) keep_q <= keep_i & burst_done;
    if (state_q == ST_REST) ended_q <= 1'b0;
    else if (ack)           ended_q <= (first_q == last_q);

    if (state_q == ST_REST) bit_q <= 3'd0;
    else if (shift)         bit_q <= bit_q + 3'd1;

    if (set_address || ack) first_q <= set_address ? field : next_first;
    if (set_first)          first_q[15:8] <= 8'd0;
    if (quantity_i || as_it_is) less_one_q <= field + {16{~as_it_is}};
    if (set_less)               less_one_q[15:8] <= 8'd0;
    if (single_i)               less_one_q <= 16'd0;
    if (range_i) {over_q, last_q} <= {1'b0, first_q} + {1'b0, less_one_q};

    in_limit_q  <= (less_one_q[15:11] == 5'd0) & ~beyond_limit;
    bytes_fit_q <= (count_i == {1'b0, bytes_less_one});

    if (hold_i || take || load_i || literal || ack || fill) held_q <= moves ? moved : looked;

    if (rst_i) begin
      state_q <= ST_REST;
      keep_q  <= 1'b0;
    end
  end

  // File records: file number, end of a file, and what a read answer comes to: 2 + 2 x quantity a group
  generate
    if (HAS_FILES != 0) begin : gen_files
      // Words of a group: 1 and the quantity.  Counted from 5, more than 122 (F5H bytes) in all show in bit 7.
      localparam [7:0] NO_GROUP = 8'd5;
      reg [15:0] file_q = 16'd0;
      reg        beyond_q;
      reg [7:0]  words_q;
      wire [6:0] quantity = less_one_q[6:0] + 7'd1;
      wire [7:0] total;
      wire       unused;
      assign {total, unused} = {words_q, 1'b1} + {1'b0, quantity, 1'b1};
      always @(posedge clk_i) begin
        if (file_i) file_q <= {held_q, byte_i};
        // 2710H or more
        beyond_q <= last_q[15] | last_q[14] |
                    (last_q[13] & (last_q[12] | last_q[11] | ((last_q[10:8] == 3'd7) & (last_q[7:4] != 4'd0))));
        if (total_clear_i) words_q <= NO_GROUP;
        else if (total_i)  words_q <= total;
      end
      assign file_o     = file_q;
      assign beyond_o   = beyond_q;
      assign too_long_o = words_q[7];
      assign length_o   = {quantity, 1'b1};
    end else begin : gen_no_files
      wire unused = file_i | total_clear_i | total_i;
      assign file_o     = 16'd0;
      assign beyond_o   = 1'b0;
      assign too_long_o = 1'b0;
      assign length_o   = 8'd0;
    end
  endgenerate

  assign in_limit_o  = in_limit_q;
  assign bytes_fit_o = bytes_fit_q;
  assign over_o      = over_q;
  assign done_o      = granted | burst_done;
  assign fail_o      = refused | lost;
  assign fail_code_o = (grant_i ? grant_ack_i : wb_err_i) ? (exception_i | {1'b0, exception_i == 4'd0, 2'b00})
                     : grant_i ? `MB_EX_DEVICE_BUSY : `MB_EX_DEVICE_FAILURE;
  assign held_o      = held_q;
  assign first_o     = first_q;
  assign last_o      = last_q;

  assign put_o  = put_high | put;
  assign data_o = beat ? data[15:8] : held_q;
  assign step_o = take | (ack & write_i & words);

  assign waiting_o = (grant_i & ~grant_ack_i) | (stb & ~wb_ack_i);

  assign grant_req_o   = grant_i;
  assign grant_write_o = write_i;
  assign inner_o = (state_q != ST_REST) & inner;

  assign wb_cyc_o = ((state_q != ST_REST) & ~inner & ~dry) | keep_q;
  assign wb_stb_o = stb;
  assign wb_we_o  = stb & write_i;
  assign wb_adr_o = {space_i, first_q};
  assign wb_dat_o = {held_q, byte_i[7:1], words ? byte_i[0] : held_q[0]};

endmodule

`default_nettype wire
