// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_dispatch - carries out the steps of modbus_program on the frame in the RAM.
//
// Starts with good_i (a good frame for us, t3.5 over), foreign_i or bad_i (only to count it).  send_stb_o: count bytes in the frame RAM
// are the answer; the steps go on beside it.  quiet_stb_o: nothing is sent.  A step takes
// two clocks to fetch and one or more to carry out; a step of several clocks has all its decisions in registers,
// for speed.  Whatever goes wrong becomes one exception code and the EXCEPTION routine, before the next step
// begins; in a broadcast that routine sends nothing either (V1.02, clause 2.2).

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_dispatch #(
  parameter [127:0] FUNCTION_CODES = 64'h0000080001F399FE,
  parameter [127:0] USER_CODES     = 128'd0
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        busy_i,
  input  wire [3:0]  failure_i,      // level : exception code instead of execution, 0: none

  // Line
  input  wire        good_i,         // strobe
  input  wire        broadcast_i,    // level : with good_i
  input  wire        foreign_i,      // strobe
  input  wire        bad_i,          // strobe
  input  wire        long_i,         // level : with bad_i, more than 256 bytes
  output wire        send_stb_o,     // strobe: send the answer
  output wire        quiet_stb_o,    // strobe: nothing to send
  output wire        restart_stb_o,  // strobe: the line must be silent again
  output wire        written_stb_o,  // strobe: a write is committed; space, first and last address valid
  input  wire        sending_i,      // level : an answer is on its way

  // Program
  output wire [8:0]  program_at_o,
  input  wire [15:0] program_step_i,
  input  wire [8:0]  start_i,        // constants: where its routines begin
  input  wire [8:0]  foreign_at_i,
  input  wire [8:0]  bad_at_i,
  input  wire [8:0]  exception_i,
  input  wire [8:0]  reset_i,

  // Frame RAM
  input  wire [7:0]  byte_i,
  input  wire [3:0]  cursor_i,
  input  wire [8:0]  count_i,
  output wire        point_o,
  output wire [4:0]  point_at_o,
  output wire        clear_o,
  output wire        step_o,
  output wire        up_o,
  output wire        down_o,
  output wire        put_o,
  output wire        context_keep_o,
  output wire        context_recall_o,

  // Data access
  output wire        hold_o,
  output wire        address_o,
  output wire        quantity_o,
  output wire        depth_o,
  output wire        single_o,
  output wire        set_first_o,
  output wire        set_less_o,
  output wire        file_o,
  output wire        total_clear_o,
  output wire        total_o,
  output wire        range_o,
  output wire        load_o,
  output wire        literal_o,
  output wire        grant_o,
  output wire        burst_o,
  output wire [10:0] argument_o,     // level : literals and limits
  output wire [2:0]  space_o,        // level : where the steps work
  output wire        write_o,        // level : direction of grant and burst
  output wire        keep_o,         // level : hold the bus after the burst
  output wire        dry_o,          // level : no bus
  output wire [1:0]  what_o,         // level : what to load
  output wire        mark_o,
  output wire [3:0]  code_o,
  input  wire        in_limit_i,
  input  wire        bytes_fit_i,
  input  wire        over_i,
  input  wire        beyond_i,
  input  wire        too_long_i,
  input  wire        done_i,
  input  wire        fail_i,
  input  wire [3:0]  fail_code_i,
  input  wire [7:0]  held_i,

  // User
  output wire        offer_o,        // level until done or failed
  input  wire        user_done_i,    // strobe
  input  wire        user_fail_i,    // strobe
  input  wire        user_pass_i,    // level : with user_done_i
  input  wire [3:0]  user_code_i,    // level : with user_fail_i

  // Diagnostics
  output wire        diag_count_o,
  output wire        diag_clear_o,
  output wire        diag_log_o,
  output wire [7:0]  diag_event_o,
  output wire        diag_now_o,     // level : the clock to do it in
  output wire        diag_applies_o, // level : the condition of a count holds
  output wire [6:1]  mode_o,         // strobes, see MB_MODE_*
  input  wire        listen_only_i
);

`include "modbus_features.vh"

  wire [4:0]  step     = {(HAS_MORE_STEPS != 0) & program_step_i[15], program_step_i[14:11]};

  reg        run_q = 1'b0;           // a frame is worked on
  reg        fetched_q = 1'b0;       // program_step_i is the step at at_q
  reg [8:0]  at_q = 9'd0;
  // verilator lint_off UNUSED
  reg [31:0] is_q = 32'd0;           // the step being carried out, one hot; there are no steps 29 to 31
  // verilator lint_on UNUSED
  reg [10:0] argument;               // and its argument
  reg        active_q = 1'b0;        // there is one
  reg        fields_q = 1'b0;        // it is one that takes fields of the request
  reg        one_q = 1'b0, two_q = 1'b0, four_q = 1'b0;   // it is one of so many clocks
  reg [1:0]  phase_q = 2'd0;         // its clock, 0 to 3
  reg        raise_q = 1'b0;         // the step before went wrong
  reg        failed_q = 1'b0;        // an exception is to be answered
  reg [3:0]  code_q;                 // which; until then, which it would be
  reg        broadcast_q = 1'b0;
  reg        long_q = 1'b0;
  reg [2:0]  space_q;
  reg        arrived_q;              // the cursor was at the place a clock ago: a walk goes every other clock
  reg        finished_q;             // bank, burst or user ended a clock ago
  reg        count_held_q;           // count was the held byte a clock ago
  reg        zero_q;                 // the byte was 0 a clock ago
  reg        left_q, no_words_q;     // so many bytes were left a clock ago: not 0; none, an odd number, or less
  reg [3:0]  unready_q;              // exception code of a host that was busy or had failed a clock ago, 0: neither
  reg        restart_q = 1'b0;
  reg        same_q;                 // the byte was the held one or the literal a clock ago
  reg        holds_q;                // the condition of IF held a clock ago

  wire is_function   = is_q[`MB_STEP_FUNCTION];
  wire is_jump       = is_q[`MB_STEP_JUMP];
  wire is_if         = is_q[`MB_STEP_IF] & (HAS_MORE_STEPS != 0);
  wire is_rest       = is_q[`MB_STEP_REST];
  wire is_address    = is_q[`MB_STEP_ADDRESS];
  wire is_quantity   = is_q[`MB_STEP_QUANTITY];
  wire is_depth      = is_q[`MB_STEP_DEPTH] & (HAS_FIFO != 0);
  wire is_file       = is_q[`MB_STEP_FILE] & (HAS_FILES != 0);
  wire is_coil       = is_q[`MB_STEP_COIL];
  wire is_byte_count = is_q[`MB_STEP_BYTE_COUNT];
  wire is_match      = is_q[`MB_STEP_MATCH] & (HAS_LITERALS != 0);
  wire is_end        = is_q[`MB_STEP_END];
  wire is_space      = is_q[`MB_STEP_SPACE] & (HAS_MORE_STEPS != 0);
  wire is_set        = is_q[`MB_STEP_SET] & (HAS_LITERALS != 0);
  wire is_range      = is_q[`MB_STEP_RANGE];
  wire is_total      = is_q[`MB_STEP_TOTAL] & (HAS_FILES != 0);
  wire is_grant      = is_q[`MB_STEP_GRANT];
  wire is_burst      = is_q[`MB_STEP_BURST];
  wire is_point      = is_q[`MB_STEP_POINT];
  wire is_walk       = is_q[`MB_STEP_WALK];
  wire is_context    = is_q[`MB_STEP_CONTEXT] & (HAS_CONTEXT != 0);
  wire is_literal    = is_q[`MB_STEP_LITERAL] & (HAS_LITERALS != 0);
  wire is_load       = is_q[`MB_STEP_LOAD];
  wire is_put        = is_q[`MB_STEP_PUT];
  wire is_send       = is_q[`MB_STEP_SEND];
  wire is_offer      = is_q[`MB_STEP_OFFER] & (HAS_USER != 0);
  wire is_count      = is_q[`MB_STEP_COUNT] & (HAS_DIAGNOSTICS != 0);
  wire is_log        = is_q[`MB_STEP_LOG] & (HAS_DIAGNOSTICS != 0);
  wire is_mode       = is_q[`MB_STEP_MODE] & (HAS_DIAGNOSTICS != 0);

  wire first  = (phase_q == 2'd0);
  wire second = (phase_q == 2'd1);
  wire third  = (phase_q == 2'd2);
  wire fourth = (phase_q == 2'd3);

  // ------------------------------------------------------------------ what can be wrong with a request

  wire coil_value  = zero_q & (held_i == 8'h00 || (held_i == 8'hFF && !argument[0]));
  wire negative    = is_if & second & (argument[10:9] == `MB_IF_LEFT) & count_i[8];
  wire bad_value   = ((is_quantity | is_depth) & fourth & ~in_limit_i)
                   | (is_coil & third & ~coil_value)
                   | (is_byte_count & third & ~count_held_q)
                   | (is_byte_count & fourth & argument[0] & ~bytes_fit_i)
                   | (is_end & ((HAS_DIAGNOSTICS != 0 && argument[0]) ? no_words_q : left_q))
                   | (is_total & fourth & too_long_i)
                   | negative;
  wire bad_address = is_range & fourth & (over_i | (argument[1] & beyond_i));
  wire unready     = is_jump & (argument[10:9] == `MB_JUMP_READY) & (unready_q != 4'd0);
  wire unmatched   = is_match & second & ~same_q & (argument[10:8] != 3'd0);
  wire illegal     = is_jump & argument[9] & (argument[10] | broadcast_q);
  wire user_fail   = is_offer & user_fail_i;

  // What code it would be depends on the step alone.
  wire [3:0] cause = (is_grant | is_burst) ? fail_code_i :
                     is_offer              ? user_code_i :
                     is_match              ? {1'b0, argument[10:8]} :
                     is_range              ? `MB_EX_ILLEGAL_DATA_ADDRESS :
                     ~is_jump              ? `MB_EX_ILLEGAL_DATA_VALUE :
                     argument[9]           ? `MB_EX_ILLEGAL_FUNCTION :
                     unready_q;

  // ------------------------------------------------------------------ the step and the next

  wire set_mode = is_mode & ~(argument[0] & sending_i);
  wire over     = one_q | (two_q & second) | (four_q & fourth) | ((is_grant | is_burst | is_offer) & finished_q)
                | (is_walk & phase_q[0] & arrived_q) | set_mode;

  // Whether a step of diagnostics applies
  wire refusal = failed_q & ~broadcast_q;                      // an exception is answered
  reg  applies;
  always @* begin
    case (argument[8:6])
      `MB_WHEN_SUCCESS:   applies = ~failed_q;
      `MB_WHEN_EXCEPTION: applies = failed_q;
      `MB_WHEN_BUSY:      applies = refusal & (code_q == `MB_EX_DEVICE_BUSY);
      `MB_WHEN_NAK:       applies = refusal & (code_q == `MB_EX_NEGATIVE_ACKNOWLEDGE);
      `MB_WHEN_BROADCAST: applies = broadcast_q;
      `MB_WHEN_LONG:      applies = long_q;
      default:            applies = 1'b1;
    endcase
  end

  // The function codes that the user wants to see; nothing in a broadcast
  wire users = USER_CODES[byte_i[6:0]] & ~byte_i[7] & ~broadcast_q;
  reg  holds;
  always @* begin
    case (argument[10:9])
      `MB_IF_EQUAL:     holds = (byte_i == held_i);
      `MB_IF_LEFT:      holds = left_q;
      `MB_IF_LISTENING: holds = listen_only_i;
      default:          holds = ~users;
    endcase
  end

  wire       taken = is_jump | (is_if & second & holds_q) | (is_offer & finished_q & ~same_q);
  wire       fits  = (byte_i[7:5] == 3'd0) & ~(&byte_i[4:1]);
  wire       is_2b = FUNCTION_CODES[43] & argument[9] & (byte_i == `MB_FC_ENCAPSULATED);
  wire [4:0] entry = fits ? byte_i[4:0] : {4'hF, ~is_2b};

  // The next step decoded: by four of the five bits, the fifth clears.  So each flag is one cell, and what a step has
  // to wait for is not gathered from the flags of all of them.
  wire idle = ~fetched_q | over | raise_q;
  reg [31:0] decoded;
  reg        fields, one, two, four;
  integer    k;

  always @* begin
    for (k = 0; k < 16; k = k + 1)  decoded[k] = (step[3:0] == k[3:0]);
    for (k = 16; k < 24; k = k + 1) decoded[k] = ({step[4], step[2:0]} == {1'b1, k[2:0]});
    for (k = 24; k < 32; k = k + 1) decoded[k] = ({step[4:3], step[1:0]} == {2'b11, k[1:0]});
    {fields, one, two, four} = 4'd0;
    case (step)
      `MB_STEP_ADDRESS, `MB_STEP_QUANTITY, `MB_STEP_DEPTH, `MB_STEP_FILE, `MB_STEP_COIL,
      `MB_STEP_BYTE_COUNT:                                                     fields = 1'b1;
      `MB_STEP_RANGE, `MB_STEP_LOAD, `MB_STEP_PUT, `MB_STEP_TOTAL:             four = 1'b1;
      `MB_STEP_IF, `MB_STEP_MATCH, `MB_STEP_COUNT, `MB_STEP_LOG:               two = 1'b1;
      `MB_STEP_WALK, `MB_STEP_GRANT, `MB_STEP_BURST, `MB_STEP_OFFER, `MB_STEP_MODE: ;
      default:                                                                 one = 1'b1;
    endcase
  end

  // The next step, or another; the sum means nothing then, written so it takes one cell a bit.
  wire       leaves  = ~run_q | raise_q | is_function | taken;
  wire [8:0] next_at = at_q + {{8{leaves}}, 1'b1};
  wire [8:0] target  = ~run_q  ? ((HAS_DIAGNOSTICS == 0 || good_i) ? start_i : foreign_i ? foreign_at_i : bad_at_i) :
                       raise_q ? exception_i :
                       argument[8:0] | ({4'd0, entry} & {9{is_function}});

  always @(posedge clk_i) begin
    fetched_q <= run_q & ~over & ~raise_q;
    is_q      <= decoded;
    fields_q  <= fields;
    one_q     <= one;
    two_q     <= two;
    four_q    <= fields | four;
    phase_q   <= phase_q + 2'd1;
    if (idle) {fields_q, one_q, two_q, four_q} <= 4'd0;
    if (idle || step[4]) is_q[15:0] <= 16'd0;
    if (idle || step[3]) is_q[23:16] <= 8'd0;
    if (idle || step[2]) is_q[27:24] <= 4'd0;
    if (idle || !step[2]) is_q[31:28] <= 4'd0;
    if (!active_q) phase_q <= 2'd0;
    active_q <= ~idle;

    if (is_space || (is_address && argument[3])) space_q <= argument[2:0];
    argument     <= program_step_i[10:0];
    arrived_q    <= (cursor_i == argument[3:0]);
    finished_q   <= done_i | fail_i | (is_offer & user_done_i) | user_fail;
    count_held_q <= (count_i == {1'b0, held_i});
    holds_q      <= holds;
    restart_q    <= set_mode & argument[7];
    left_q       <= (count_i != 9'd0);
    no_words_q   <= (count_i == 9'd0) | count_i[0] | count_i[8];
    unready_q    <= busy_i ? `MB_EX_DEVICE_BUSY : failure_i;
    same_q       <= is_offer ? user_pass_i : (byte_i == argument[7:0]);
    zero_q       <= (byte_i == 8'h00);

    raise_q <= bad_value | bad_address | unready | unmatched | illegal | fail_i | user_fail;
    failed_q <= run_q & (failed_q | raise_q);
    if (!failed_q && !raise_q) code_q <= cause;

    if (leaves || over) at_q <= leaves ? target : next_at;

    if (!run_q) begin
      long_q      <= long_i;
      broadcast_q <= broadcast_i;
    end
    run_q <= run_q ? ~is_rest : good_i | (HAS_DIAGNOSTICS != 0 && (foreign_i || bad_i));
    if (rst_i) begin
      run_q     <= (HAS_DIAGNOSTICS != 0);       // to clear the counters
      if (HAS_DIAGNOSTICS != 0) at_q <= reset_i;
      fetched_q <= 1'b0;
      is_q      <= 32'd0;
      active_q  <= 1'b0;
      {fields_q, one_q, two_q, four_q} <= 4'd0;
      raise_q   <= 1'b0;
    end
  end

  // ------------------------------------------------------------------ what the step does

  wire consume = (fields_q & first) | (fields_q & second & (~is_byte_count | argument[0]))
               | is_function | (is_match & second);
  wire walk    = is_walk & phase_q[0] & ~arrived_q;
  wire placed  = is_put & second;
  wire here    = argument[6];

  assign send_stb_o      = is_send & ~broadcast_q;
  assign quiet_stb_o     = is_rest & ~sending_i;
  assign restart_stb_o   = restart_q;
  assign written_stb_o   = is_range & fourth & argument[2];
  assign program_at_o    = at_q;

  assign point_o    = is_point | ((is_load | is_put) & first & ~here) | is_send;
  assign point_at_o = argument[4:0];
  assign clear_o    = is_point & argument[5];
  assign put_o      = placed;
  assign step_o     = consume | walk | placed;
  assign up_o       = (walk & argument[5]) | placed;
  assign down_o     = consume | (walk & ~argument[5]);
  assign context_keep_o   = is_context & argument[0];
  assign context_recall_o = is_context & argument[1];

  assign hold_o      = fields_q & first;
  assign address_o   = is_address & second;
  assign quantity_o  = is_quantity & second;
  assign depth_o     = is_depth & second;
  assign file_o      = is_file & second;
  assign single_o    = is_range & first & argument[0];
  assign set_first_o = is_set & ~argument[10];
  assign set_less_o  = is_set & argument[10];
  assign total_clear_o = is_byte_count;
  assign total_o     = is_total & first;
  assign range_o     = is_range & second;
  assign load_o      = is_load & second;
  assign literal_o   = is_literal;
  assign grant_o     = is_grant & ~finished_q;
  assign burst_o     = is_burst & ~finished_q;
  assign argument_o  = argument;
  // Bits of the space that are the same for all functions built in
  assign space_o     = {space_q[2] & (HAS_MORE_STEPS != 0), space_q[1] | (HAS_BITS == 0 && HAS_MORE_STEPS == 0),
                        space_q[0] | (HAS_OTHER_SPACES == 0)};
  assign write_o     = argument[0];
  assign keep_o      = argument[1];
  assign dry_o       = argument[2];
  assign what_o      = argument[8:7];
  assign mark_o      = argument[5];
  assign code_o      = code_q;

  assign offer_o     = is_offer & ~finished_q;

  // Event bytes (V1.1b3, clause 6.10); the program gives the kind, what varies is added.
  wire [3:0] sent = {code_q == 4'd7, code_q == 4'd5 || code_q == 4'd6, code_q == 4'd4, code_q[3:2] == 2'd0};

  assign diag_count_o = is_count;
  assign diag_clear_o = argument[5];
  assign diag_log_o   = is_log;
  assign diag_event_o = {8{is_log}} & (argument[7:0]
                      | {1'b0, argument[8] & broadcast_q, listen_only_i, argument[10] & long_q,
                         sent & {4{argument[9] & refusal}}});
  assign diag_now_o   = second;
  assign diag_applies_o = applies;
  assign mode_o = {6{set_mode}} & argument[6:1] & {long_q, 2'b11, held_i[0], 2'b11};

endmodule

`default_nettype wire
