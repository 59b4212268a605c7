// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_sequencer - carries out the steps of modbus_program on the frame in the RAM.
//
// It begins with a good frame for us (t3.5 is over), and with a foreign or a bad one to count it.  VERDICT_SEND: count
// bytes in the frame RAM are the answer; the steps go on beside it.  VERDICT_QUIET: nothing is sent.
//
// A step takes one, two or four clocks (modbus_steps.vh), or waits.  A free clock follows, in which no step begins: what went
// wrong becomes one exception code and the EXCEPTION routine before that.  The next step is fetched meanwhile.  A jump that
// is taken takes one clock more; so do QUANTITY and DEPTH, since their limit is compared in the free clock.  In a broadcast
// the EXCEPTION routine sends nothing either (V1.02, clause 2.2).  A step of several clocks has all its decisions in
// registers, for speed.
//
// byte_i is the byte that was under the cursor a clock ago.  A step may look at it in its first clock, since the free clock
// lies between that and the last move of the cursor.  Likewise the count.  Not behind PUT, which moves both in the free
// clock; tb/test_program.py sees to it that no step behind a PUT looks.
//
// The sequencer waits for nobody but the bank (GRANT, BURST), the user (OFFER) and the transmitter (MODE with WAIT).

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_sequencer #(
  parameter [127:0] FUNCTION_CODES = `MB_ALL_FUNCTIONS,
  parameter [127:0] USER_CODES     = 128'd0
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Host
  input  wire        busy_i,         // level
  input  wire [3:0]  failure_i,      // level : exception code instead of execution, 0: none
  output wire        write_stb_o,    // strobe: a write is committed; space, first and last address are valid

  // Line
  input  wire [`MB_FRAME_WIDTH-1:0]   frame_i,       // MB_FRAME_*
  output wire [`MB_VERDICT_WIDTH-1:0] verdict_o,     // MB_VERDICT_*
  input  wire        sending_i,      // level : an answer is on its way

  // Program
  output wire [8:0]  at_o,
  output wire        fetch_o,        // level : step_i becomes the step at at_o
  input  wire [15:0] step_i,         // stands still otherwise
  input  wire [`MB_ENTRIES_WIDTH-1:0] entries_i,     // constants: where to begin, MB_ENTRY_*

  // Frame RAM
  input  wire [7:0]  byte_i,         // under the cursor a clock ago
  input  wire [3:0]  cursor_i,
  input  wire [8:0]  count_i,
  output wire [`MB_RAM_DO_WIDTH-1:0]   ram_do_o,     // MB_DO_*

  // Range and burst
  output wire [`MB_RANGE_DO_WIDTH-1:0] range_do_o,   // MB_DO_*
  output wire [`MB_BURST_DO_WIDTH-1:0] burst_do_o,   // MB_DO_*
  output wire [10:0] argument_o,     // level : fields of the step, MB_ARG_*
  output wire [2:0]  space_o,        // level : where the steps work
  output wire [3:0]  code_o,         // level : exception code
  input  wire [`MB_FOUND_WIDTH-1:0]    found_i,      // MB_FOUND_*
  input  wire        done_i,         // strobe: granted, or the burst has ended
  input  wire        fail_i,         // strobe: neither will come
  input  wire [3:0]  fail_code_i,    // level : with fail_i
  input  wire [7:0]  held_i,

  // User
  output wire        offer_o,        // level until done or failed
  input  wire        user_done_i,    // strobe
  input  wire        user_fail_i,    // strobe
  input  wire        user_pass_i,    // level : with user_done_i
  input  wire [3:0]  user_code_i,    // level : with user_fail_i

  // Diagnostics
  output wire [`MB_DIAG_DO_WIDTH-1:0]  diag_do_o,    // MB_DO_*
  output wire [7:0]  event_o,        // level : 0 without LOG
  input  wire        listen_only_i
);

`include "modbus_features.vh"

  wire good      = frame_i[`MB_FRAME_GOOD];
  wire foreign   = (HAS_DIAGNOSTICS != 0) & frame_i[`MB_FRAME_FOREIGN];
  wire bad       = (HAS_DIAGNOSTICS != 0) & frame_i[`MB_FRAME_BAD];

  wire [15:0] fetched = step_i;
  wire [4:0]  step = {(HAS_MORE_STEPS != 0) & fetched[15], fetched[14:11]};

  reg        run_q = 1'b0;           // a frame is worked on
  reg        fetched_q = 1'b0;       // step_i is the step that is carried out, or in the free clock the next one
  reg [8:0]  at_q = 9'd0;            // of the step to fetch next
  // verilator lint_off UNUSED
  reg [31:0] is_q = 32'd0;           // the step being carried out, one hot; there are no steps 27, 30 and 31
  // verilator lint_on UNUSED
  reg [10:0] argument;               // and its argument
  reg        active_q = 1'b0;        // there is one
  reg        fields_q = 1'b0;        // it is one that takes fields of the request
  reg        alone_q = 1'b0;         // of one byte
  reg        one_q = 1'b0, two_q = 1'b0, four_q = 1'b0;   // it is one of so many clocks
  reg [1:0]  clock_q = 2'd0;         // its clock: 0, 1, 2, 3, then 2 and 3 in turn
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
  reg        limit_q = 1'b0;         // the quantity is compared with its limit now; the step has ended
  reg [3:0]  unready_q;              // exception code of a host that was busy or had failed a clock ago, 0: neither
  reg        restart_q = 1'b0;
  reg        load_q = 1'b0;          // behind LOAD: its byte is there
  reg        put_q = 1'b0;           // behind PUT: its byte is held
  reg        same_q;                 // the byte was the literal a clock ago
  reg        pass_q;                 // the user passed a clock ago
  reg        holds_q;                // the condition of IF held a clock ago

  wire is_dispatch   = is_q[`MB_STEP_DISPATCH];
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
  wire is_tell       = is_q[`MB_STEP_TELL];
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

  wire clock_1 = (clock_q == 2'd0);
  wire clock_2 = (clock_q == 2'd1);
  wire clock_3 = (clock_q == 2'd2);
  wire clock_4 = (clock_q == 2'd3);

  wire [1:0] condition = argument[`MB_ARG_CONDITION];

  // ------------------------------------------------------------------ what can be wrong with a request

  wire coil_value  = zero_q & (held_i == 8'h00 || (held_i == 8'hFF && !argument[`MB_ARG_ZERO]));
  wire negative    = is_if & clock_2 & (condition == `MB_IF_LEFT) & count_i[8];
  wire goes_on     = (HAS_DIAGNOSTICS != 0 && argument[`MB_ARG_WORDS]) ? no_words_q : left_q;
  wire bad_value   = (limit_q & ~found_i[`MB_FOUND_IN_LIMIT])
                   | (is_coil & clock_4 & ~coil_value)
                   | (is_byte_count & clock_3 & ~count_held_q)
                   | (is_byte_count & clock_4 & argument[`MB_ARG_FIT] & ~found_i[`MB_FOUND_FIT])
                   | (((is_end & clock_2) | (is_coil & clock_4)) & goes_on)
                   | (is_total & clock_2 & found_i[`MB_FOUND_TOO_LONG])
                   | negative;
  wire unready     = is_jump & (condition == `MB_JUMP_READY) & (unready_q != 4'd0);
  wire unmatched   = is_match & clock_2 & ~same_q & (argument[`MB_ARG_EXCEPTION] != 3'd0);
  wire illegal     = is_jump & ((condition == `MB_JUMP_NEVER) | (condition == `MB_JUMP_UNICAST & broadcast_q));
  wire user_fail   = is_offer & user_fail_i;

  // What code it would be depends on the step alone.
  wire [3:0] cause = (is_grant | is_burst)         ? fail_code_i :
                     is_offer                      ? user_code_i :
                     is_match                      ? {1'b0, argument[`MB_ARG_EXCEPTION]} :
                     ~is_jump                      ? `MB_EX_ILLEGAL_DATA_VALUE :
                     (condition == `MB_JUMP_READY) ? unready_q :
                     `MB_EX_ILLEGAL_FUNCTION;

  // ------------------------------------------------------------------ the step and the next

  wire set_mode = is_mode & ~(argument[`MB_MODE_WAIT] & sending_i);
  wire ends     = one_q | (two_q & clock_2) | (four_q & clock_4) | ((is_grant | is_burst | is_offer) & finished_q)
                | (is_walk & clock_q[0] & arrived_q) | set_mode;

  // Whether a step of diagnostics applies
  wire refusal = failed_q & ~broadcast_q;                      // an exception is answered
  reg  applies;
  always @* begin
    case (argument[`MB_ARG_WHEN])
      `MB_WHEN_SUCCESS:   applies = ~failed_q;
      `MB_WHEN_EXCEPTION: applies = failed_q;
      `MB_WHEN_BUSY:      applies = refusal & (code_q == `MB_EX_DEVICE_BUSY);
      `MB_WHEN_NAK:       applies = refusal & (code_q == `MB_EX_NEGATIVE_ACKNOWLEDGE);
      `MB_WHEN_UNSENT:    applies = left_q;
      `MB_WHEN_LONG:      applies = long_q;
      default:            applies = 1'b1;
    endcase
  end

  // The function codes that the user wants to see; nothing in a broadcast
  wire users = USER_CODES[byte_i[6:0]] & ~byte_i[7] & ~broadcast_q;
  reg  holds;
  always @* begin
    case (condition)
      `MB_IF_EQUAL:     holds = (byte_i == held_i);
      `MB_IF_LEFT:      holds = left_q;
      `MB_IF_LISTENING: holds = listen_only_i;
      default:          holds = ~users;
    endcase
  end

  wire       jumps = is_jump & (condition == `MB_JUMP_ALWAYS || condition == `MB_JUMP_UNICAST);
  wire       taken = jumps | (is_if & clock_2 & holds_q) | (is_offer & finished_q & ~pass_q);
  // The entry in a table: the low five bits, 1FH for bytes above
  wire [4:0] entry = byte_i[4:0] | {5{byte_i[7:5] != 3'd0}};

  // The next step decoded: by four of the five bits, the fifth clears.  So each flag is one cell, and what a step has
  // to wait for is not gathered from the flags of all of them.
  wire idle = ~fetched_q | ends | raise_q;
  reg [31:0] decoded;
  reg        fields, one, two, four;
  integer    k;

  always @* begin
    for (k = 0; k < 16; k = k + 1)  decoded[k] = (step[3:0] == k[3:0]);
    for (k = 16; k < 24; k = k + 1) decoded[k] = ({step[4], step[2:0]} == {1'b1, k[2:0]});
    for (k = 24; k < 32; k = k + 1) decoded[k] = ({step[4:3], step[1:0]} == {2'b11, k[1:0]});
    fields = (step[3:2] == 2'b01) & ~(step[4] & step[1]);
    one    = (step[3:2] == 2'b00) | (step[3] & (step[1:0] == 2'b11));
    two    = (step[3:2] == 2'b10) & (step[1:0] != 2'b11);
    four   = (step[3:2] == 2'b01);
  end

  // The limit is compared in the clock behind the step, and the next one is not ready for a clock more.
  wire       judges  = (is_quantity | is_depth) & clock_4;
  // at_q moves on when a step begins, and the next one is fetched in the last clock of that.  After a jump it is fetched at
  // the target, and the sum means nothing; written so, it takes one cell a bit.
  wire       moves   = fetched_q & ~active_q;
  wire       leaves  = ~run_q | raise_q | is_dispatch | taken;
  wire [8:0] next_at = at_q + {{8{leaves}}, 1'b1};
  wire [8:0] begins  = (HAS_DIAGNOSTICS == 0 || good) ? entries_i[`MB_ENTRY_START] :
                       foreign                        ? entries_i[`MB_ENTRY_FOREIGN] : entries_i[`MB_ENTRY_BAD];
  wire [8:0] target  = ~run_q  ? begins :
                       raise_q ? entries_i[`MB_ENTRY_EXCEPTION] :
                       argument[`MB_ARG_TARGET] | ({4'd0, entry} & {9{is_dispatch}});

  always @(posedge clk_i) begin
    limit_q   <= judges;
    fetched_q <= run_q & ~leaves & ~is_rest & ~judges;
    active_q  <= ~idle;
    is_q      <= {(idle | ~step[2]) ? 4'd0 : decoded[31:28], (idle | step[2]) ? 4'd0 : decoded[27:24],
                  (idle | step[3]) ? 8'd0 : decoded[23:16], (idle | step[4]) ? 16'd0 : decoded[15:0]};
    {fields_q, one_q, two_q, four_q} <= idle ? 4'd0 : {fields, one, two, four};
    alone_q   <= is_byte_count & ~argument[`MB_ARG_FIT];
    clock_q   <= active_q ? {clock_q[1] | clock_q[0], ~clock_q[0]} : 2'd0;

    if (is_space || (is_address && argument[`MB_ARG_IN_SPACE])) space_q <= argument[`MB_ARG_SPACE];
    argument     <= fetched[`MB_WORD_ARGUMENT];
    arrived_q    <= (cursor_i == argument[3:0]);
    finished_q   <= done_i | fail_i | (is_offer & user_done_i) | user_fail;
    count_held_q <= (count_i == {1'b0, held_i});
    holds_q      <= holds;
    load_q       <= is_load & clock_2;
    put_q        <= is_put & clock_2;
    restart_q    <= set_mode & argument[`MB_MODE_LINE];
    left_q       <= (count_i != 9'd0);
    no_words_q   <= (count_i == 9'd0) | count_i[0] | count_i[8];
    unready_q    <= busy_i ? `MB_EX_DEVICE_BUSY : failure_i;
    same_q       <= (byte_i == argument[`MB_ARG_LITERAL]);
    pass_q       <= user_pass_i;
    zero_q       <= (byte_i == 8'h00);

    raise_q <= bad_value | unready | unmatched | illegal | fail_i | user_fail;
    failed_q <= run_q & (failed_q | raise_q);
    if (!failed_q && !raise_q) code_q <= cause;

    if (leaves || moves) at_q <= leaves ? target : next_at;

    if (!run_q) begin
      long_q      <= frame_i[`MB_FRAME_LONG];
      broadcast_q <= frame_i[`MB_FRAME_BROADCAST];
    end
    run_q <= run_q ? ~is_rest : good | foreign | bad;
    if (rst_i) begin
      run_q     <= (HAS_DIAGNOSTICS != 0);       // to clear the counters
      if (HAS_DIAGNOSTICS != 0) at_q <= entries_i[`MB_ENTRY_CLEARING];
      fetched_q <= 1'b0;
      is_q      <= 32'd0;
      active_q  <= 1'b0;
      {fields_q, one_q, two_q, four_q} <= 4'd0;
      raise_q   <= 1'b0;
      limit_q   <= 1'b0;
    end
  end

  // ------------------------------------------------------------------ what the step does

  // In its first two clocks a step of fields takes a byte each, but for BYTE_COUNT without FIT, which takes
  // one; only the functions of files have that.
  wire takes   = fields_q & ~clock_q[1] & ~((HAS_FILES != 0) & alone_q & clock_q[0]);
  wire consume = takes | is_dispatch | (is_match & clock_2);
  wire walk    = is_walk & clock_q[0] & ~arrived_q;
  wire places  = (is_load & clock_1) | ((is_put | is_burst) & clock_1 & ~argument[`MB_ARG_HERE]);

  assign at_o        = at_q;
  assign fetch_o     = idle;
  assign argument_o  = argument;
  assign code_o      = code_q;
  assign write_stb_o = is_tell;
  assign offer_o     = is_offer & ~finished_q;
  // Bits of the space that are the same for all functions built in
  assign space_o     = {space_q[2] & (HAS_MORE_STEPS != 0), space_q[1] | (HAS_BITS == 0 && HAS_MORE_STEPS == 0),
                        space_q[0] | (HAS_OTHER_SPACES == 0)};

  assign verdict_o[`MB_VERDICT_SEND]    = is_send & ~broadcast_q;
  assign verdict_o[`MB_VERDICT_QUIET]   = is_rest & ~sending_i;
  assign verdict_o[`MB_VERDICT_RESTART] = restart_q;
  assign verdict_o[`MB_VERDICT_DELIMITER] = set_mode & argument[`MB_MODE_DELIMITER];

  assign ram_do_o[`MB_DO_POINT]  = is_point | places | is_send;
  assign ram_do_o[`MB_DO_CLEAR]  = (is_point | (is_burst & clock_1)) & argument[`MB_ARG_CLEAR];
  assign ram_do_o[`MB_DO_STEP]   = consume | walk | put_q;
  assign ram_do_o[`MB_DO_UP]     = (walk & argument[`MB_ARG_UP]) | put_q;
  assign ram_do_o[`MB_DO_DOWN]   = consume | (walk & ~argument[`MB_ARG_UP]);
  assign ram_do_o[`MB_DO_PUT]    = put_q;
  assign ram_do_o[`MB_DO_SAVE]   = is_context & argument[`MB_ARG_SAVE];
  assign ram_do_o[`MB_DO_RECALL] = is_context & argument[`MB_ARG_RECALL];

  // So the range gets a byte in the second clock and one in the third.
  wire fields_clock = clock_q[1] ^ clock_q[0];

  assign range_do_o[`MB_DO_ADDRESS]  = is_address & fields_clock;
  assign range_do_o[`MB_DO_ONE]      = is_address & clock_1 & argument[`MB_ARG_ONE];
  assign range_do_o[`MB_DO_QUANTITY] = (is_quantity | is_depth) & fields_clock;
  assign range_do_o[`MB_DO_LESS_ONE] = is_quantity & clock_3;
  assign range_do_o[`MB_DO_FIRST]    = is_set & ~argument[`MB_ARG_LESS];
  assign range_do_o[`MB_DO_LESS]     = is_set & argument[`MB_ARG_LESS];
  assign range_do_o[`MB_DO_FILE]     = is_file & fields_clock;
  assign range_do_o[`MB_DO_NO_GROUP] = is_byte_count;
  assign range_do_o[`MB_DO_GROUP]    = is_total & clock_1;

  assign burst_do_o[`MB_DO_HOLD]    = fields_q & clock_1;
  assign burst_do_o[`MB_DO_LOAD]    = load_q;
  assign burst_do_o[`MB_DO_STATUS]  = is_put & clock_1 & argument[`MB_ARG_STATUS];
  assign burst_do_o[`MB_DO_LITERAL] = is_literal;
  assign burst_do_o[`MB_DO_GRANT]   = is_grant & ~finished_q;
  assign burst_do_o[`MB_DO_BURST]   = is_burst & ~finished_q;
  assign burst_do_o[`MB_DO_RELEASE] = verdict_o[`MB_VERDICT_SEND] | verdict_o[`MB_VERDICT_QUIET];

  assign diag_do_o[`MB_DO_COUNT]          = is_count;
  assign diag_do_o[`MB_DO_LOG]            = is_log;
  assign diag_do_o[`MB_DO_NOW]            = clock_4;
  assign diag_do_o[`MB_DO_APPLIES]        = applies;
  assign diag_do_o[`MB_DO_LISTEN]         = set_mode & argument[`MB_MODE_LISTEN];
  assign diag_do_o[`MB_DO_ACTIVE]         = set_mode & argument[`MB_MODE_ACTIVE];
  assign diag_do_o[`MB_DO_EMPTY]          = set_mode & argument[`MB_MODE_EMPTY] & held_i[0];
  assign diag_do_o[`MB_DO_CLEAR_REGISTER] = set_mode & argument[`MB_MODE_REGISTER];
  assign diag_do_o[`MB_DO_CLEAR_OVERRUN]  = set_mode & argument[`MB_MODE_OVERRUN];
  assign diag_do_o[`MB_DO_OVERRUN]        = set_mode & argument[`MB_MODE_LONG] & long_q;

  // Event bytes (V1.1b3, clause 6.10); the program gives the kind, what varies is added.
  wire [3:0] sent = {code_q == 4'd7, code_q == 4'd5 || code_q == 4'd6, code_q == 4'd4, code_q[3:2] == 2'd0};

  assign event_o = {8{is_log}} & (argument[`MB_ARG_EVENT]
                 | {1'b0, argument[`MB_ARG_BROADCAST] & broadcast_q, listen_only_i, argument[`MB_ARG_LONG] & long_q,
                    sent & {4{argument[`MB_ARG_REFUSAL] & refusal}}});

`ifdef FORMAL
  // Any program, any frame; only that an answer, the bank and the user may let the sequencer wait.
  reg       f_past = 1'b0;
  reg [4:0] f_age = 5'd0;            // clocks since the last step began or the frame came
  reg       f_raised = 1'b0;         // a step went wrong two clocks ago
  reg [8:0] f_exception_at;          // EXCEPTION, then

  wire [5:0] f_many = {3'd0, is_address} + is_quantity + is_depth + is_file + is_coil + is_byte_count + is_match
                    + is_end + is_space + is_set + is_tell + is_total + is_grant + is_burst + is_point + is_walk
                    + is_context + is_literal + is_load + is_put + is_send + is_offer + is_count + is_log + is_mode
                    + is_dispatch + is_jump + is_if + is_rest;
  // Waits for the bank, for the user, for the end of an answer; a walk lasts as long as the way
  wire f_waits = is_grant | is_burst | is_offer | is_mode | is_walk;

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    f_age  <= (rst_i | ~run_q | f_waits | (active_q & ends)) ? 5'd0 : f_age + 5'd1;
    f_raised       <= raise_q & ~rst_i;
    f_exception_at <= entries_i[`MB_ENTRY_EXCEPTION];
  end

  always @* begin
    if (!f_past) assume (rst_i);
    // modbus_burst answers what it is asked.
    if (!burst_do_o[`MB_DO_GRANT] && !burst_do_o[`MB_DO_BURST]) assume (!done_i && !fail_i);
  end

  // The program is a memory of steps: at the same address it holds the same one, and it shows it until the next is
  // fetched.
  reg       f_fetched = 1'b0;
  reg [8:0] f_at;
  always @* assume (fetched[15:11] <= `MB_STEP_MODE);
  always @(posedge clk_i) begin
    f_fetched <= f_fetched | fetch_o;
    if (fetch_o) f_at <= at_q;
    if (f_past && (!$past(fetch_o) || ($past(f_fetched) && $past(at_q) == $past(f_at)))) assume ($stable(step_i));
  end

  always @(posedge clk_i) if (f_past && !rst_i && !$past(rst_i)) begin
    // One step at a time, so never two commands at once
    assert (f_many <= 6'd1);
    assert (active_q || f_many == 6'd0);
    // Every step ends, unless it waits.
    assert (f_age <= 5'd8);
    // When a burst begins, modbus_burst already holds the literal or status byte of the step before.
    if (burst_do_o[`MB_DO_BURST]) assert (!$past(burst_do_o[`MB_DO_LITERAL] | burst_do_o[`MB_DO_STATUS]));
    // One that waits ends with the answer.
    if ((is_grant | is_burst) && $past(is_grant | is_burst) && $past(done_i | fail_i)) assert (ends);
    if (is_offer && $past(offer_o & (user_done_i | user_fail_i)))                      assert (ends);
    // Whatever goes wrong ends in the EXCEPTION routine, and nothing is commanded before that.
    if (f_raised) assert (at_q == f_exception_at);
    if ($past(raise_q)) assert (f_many == 6'd0);
    if (raise_q) assert (!active_q || is_grant || is_burst || is_offer || is_byte_count);   // none but the one that failed
    if (raise_q) assert (run_q || $past(is_rest));
    if ($past(raise_q) && run_q) assert (failed_q);
    // Nothing is answered in a broadcast, nothing commanded without a frame.
    if (verdict_o[`MB_VERDICT_SEND]) assert (!broadcast_q);
    if (!run_q) assert (!burst_do_o[`MB_DO_GRANT] && !burst_do_o[`MB_DO_BURST] && !offer_o && !write_stb_o);
    // The bank is asked until it has answered, with an argument that stands still.
    if ($past(burst_do_o[`MB_DO_GRANT]) && !$past(done_i) && !$past(fail_i) && !$past(raise_q))
      assert (burst_do_o[`MB_DO_GRANT] && $stable(argument[10:5]) && $stable(space_q));
    if ($past(burst_do_o[`MB_DO_BURST]) && !$past(done_i) && !$past(fail_i) && !$past(raise_q))
      assert (burst_do_o[`MB_DO_BURST] && $stable(argument) && $stable(space_q));
    cover (f_raised && run_q);
    cover (verdict_o[`MB_VERDICT_SEND]);
    cover (write_stb_o);
  end
`endif

endmodule

`default_nettype wire
