// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_diagnostics - counters, event log, diagnostic register and listen-only mode.
//
// Counters and log share one block RAM: counter n is word n (its sub-function of 08H), log entries are words 64 to
// 127, newest first from newest_q on.  Words 0 to 2 are not in the RAM: diagnostic register, listen-only mode, entries
// of the log.  What is counted, logged and cleared, and when, is written in modbus_program (MODBUS over Serial Line
// V1.02, appendix A; MODBUS Application Protocol V1.1b3, clauses 6.8 to 6.10).
//
// COUNT and LOG are held for four clocks, NOW is high in the last: the word is read, counted up into a register, written, so
// no path leads from the RAM to itself within a clock.  Between them the RAM serves the burst of an answer, else the host:
// status_ack_o comes when it did, so the host never stops the line.  After rst_i the program clears the counters; the host
// is not answered before cleared_i.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_diagnostics (
  input  wire        clk_i,
  input  wire        rst_i,

  // Sequencer
  input  wire [`MB_DIAG_DO_WIDTH-1:0] do_i,          // MB_DO_*
  input  wire [5:0]  argument_i,     // level : MB_ARG_COUNTER, MB_ARG_CLEAR
  input  wire [7:0]  event_i,        // level : 0 without LOG
  input  wire        cleared_i,      // strobe: the counters have been cleared after a reset
  output wire        listen_only_o,

  // Answers: words of MB_SPACE_COUNTERS and bytes of MB_SPACE_EVENTS, a clock after the address
  input  wire        read_i,         // level : the address is shown
  input  wire        read_log_i,     // level : an entry of the log, 0 newest
  input  wire [5:0]  read_at_i,
  output wire [15:0] data_o,         // also for the host, with status_ack_o

  // Host
  input  wire [15:1] diagnostic_i,   // level : set these bits of the register
  input  wire        status_stb_i,   // level until status_ack_o
  input  wire [6:0]  status_adr_i,   // 00..02, counter, or 64 + entry of the log
  output wire        status_ack_o    // strobe: data_o is the host's
);

  localparam [6:0] LOG_ENTRIES = 7'd64;

  (* no_rw_check *) reg [15:0] memory [0:127];
  reg [15:0] word_q;
  reg [5:0]  newest_q = 6'd0;
  reg [6:0]  entries_q = 7'd0;
  reg        listen_only_q = 1'b0;
  reg [15:0] register_q = 16'd0;
  reg        ack_q = 1'b0;
  reg        ready_q = 1'b1;         // the counters have been cleared since the last reset
  reg        state_q;                // the word read is no word of the RAM,
  reg [1:0]  which_q;                // but this one

  integer i;
  initial for (i = 0; i < 128; i = i + 1) memory[i] = 16'd0;

  wire       counting = do_i[`MB_DO_COUNT];
  wire       logging  = do_i[`MB_DO_LOG];
  wire       now   = do_i[`MB_DO_NOW];
  wire [4:0] which = argument_i[`MB_ARG_COUNTER];
  wire       clear = argument_i[`MB_ARG_CLEAR];
  wire       ours   = counting | logging;
  wire       host  = ~ours & ~read_i;
  wire       of_log = read_i ? read_log_i : status_adr_i[6];
  wire [5:0] wanted = read_i ? read_at_i  : status_adr_i[5:0];
  wire [5:0] entry  = newest_q + (logging ? 6'h3F : wanted);     // a new one comes before the newest
  wire [6:0] at     = logging ? {1'b1, entry} : counting ? {2'd0, which} : of_log ? {1'b1, entry} : {1'b0, wanted};
  wire       logs   = logging & now;
  wire       write  = logs | (counting & now & do_i[`MB_DO_APPLIES]);
  wire        fresh = logging | clear;
  reg  [15:0] next_q;                // one more, or 0

  always @(posedge clk_i) begin
    if (write) memory[at] <= next_q | {8'd0, event_i};
    word_q <= memory[at];
    next_q <= fresh ? 16'd0 : word_q + 16'd1;
    ack_q  <= host & status_stb_i & ready_q & ~ack_q;
    state_q <= ~of_log & (wanted[5:2] == 4'd0);
    which_q <= wanted[1:0];
    ready_q <= ready_q | cleared_i;

    if (logs) begin
      newest_q <= entry;
      if (entries_q != LOG_ENTRIES) entries_q <= entries_q + 7'd1;
    end
    if (do_i[`MB_DO_EMPTY]) entries_q <= 7'd0;

    listen_only_q <= (listen_only_q | do_i[`MB_DO_LISTEN]) & ~do_i[`MB_DO_ACTIVE];

    register_q[15:1] <= (do_i[`MB_DO_CLEAR_REGISTER] ? 15'd0 : register_q[15:1]) | diagnostic_i;
    if (do_i[`MB_DO_OVERRUN])
      register_q[0] <= 1'b1;
    else if (do_i[`MB_DO_CLEAR_OVERRUN] || do_i[`MB_DO_CLEAR_REGISTER])
      register_q[0] <= 1'b0;

    if (rst_i) begin
      entries_q     <= 7'd0;
      listen_only_q <= 1'b0;
      register_q    <= 16'd0;
      ack_q         <= 1'b0;
      ready_q       <= 1'b0;
    end
  end

  wire [15:0] state = ({3'd0, which_q} == `MB_CPT_REGISTER)    ? register_q :
                      ({3'd0, which_q} == `MB_CPT_LISTEN_ONLY) ? {15'd0, listen_only_q} : {9'd0, entries_q};

  assign listen_only_o = listen_only_q;
  assign data_o        = state_q ? state : word_q;
  assign status_ack_o  = ack_q;

endmodule

`default_nettype wire
