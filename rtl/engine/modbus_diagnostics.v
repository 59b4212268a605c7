// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_diagnostics - counters, event log, diagnostic register and listen-only mode.
//
// Counters and log share one block RAM: counter n is word n (its sub-function of 08H), log entries are words 64 to
// 127, newest first from newest_q on.  What is counted, logged and cleared, and when, is written in modbus_program
// (MODBUS over Serial Line V1.02, appendix A; MODBUS Application Protocol V1.1b3, clauses 6.8 to 6.10).
//
// count_i and log_i are held for two clocks, now_i is high in the second.  Between them the RAM serves the burst of
// an answer, else the host: counter_ack_o comes when it did, so the host never stops the line.  After rst_i the
// program clears the counters.

`default_nettype none
`include "modbus_defs.vh"

module modbus_diagnostics (
  input  wire        clk_i,
  input  wire        rst_i,

  // Program
  input  wire        count_i,        // level : counter which_i up, with clear_i to 0
  input  wire [4:0]  which_i,
  input  wire        clear_i,
  input  wire        log_i,          // level : event_i to the log
  input  wire [7:0]  event_i,        // level : 0 without log_i
  input  wire        now_i,          // level : the second of their two clocks
  input  wire        applies_i,      // level : with count_i, the counter is changed
  input  wire        empty_i,        // strobe: empty the log
  input  wire        listen_i,       // strobe: enter listen-only mode
  input  wire        active_i,       // strobe: leave it
  input  wire        overrun_i,      // strobe: set the overrun flag
  input  wire        no_overrun_i,   // strobe: clear it
  input  wire        clear_register_i, // strobe: clear the whole diagnostic register
  output wire        listen_only_o,
  output wire [15:0] register_o,
  output wire [6:0]  log_count_o,

  // Answers: words of MB_SPACE_COUNTERS and bytes of MB_SPACE_EVENTS, a clock after the address
  input  wire        read_i,         // level : the address is shown
  input  wire        read_log_i,     // level : an entry of the log, 0 newest
  input  wire [5:0]  read_at_i,
  output wire [15:0] data_o,

  // Host
  input  wire [15:1] diagnostic_i,   // level : set these bits of the register
  input  wire        counter_stb_i,
  input  wire [6:0]  counter_adr_i,  // counter, or 64 + entry of the log
  output wire        counter_ack_o   // strobe: data_o is the host's
);

  localparam [6:0] LOG_ENTRIES = 7'd64;

  (* no_rw_check *) reg [15:0] memory [0:127];
  reg [15:0] word_q;
  reg [5:0]  newest_q = 6'd0;
  reg [6:0]  entries_q = 7'd0;
  reg        listen_only_q = 1'b0;
  reg [15:0] register_q = 16'd0;
  reg        ack_q = 1'b0;

  integer i;
  initial for (i = 0; i < 128; i = i + 1) memory[i] = 16'd0;

  wire       ours  = count_i | log_i;
  wire       host  = ~ours & ~read_i;
  wire       of_log = read_i ? read_log_i : counter_adr_i[6];
  wire [5:0] wanted = read_i ? read_at_i  : counter_adr_i[5:0];
  wire [5:0] entry  = newest_q + (log_i ? 6'h3F : wanted);     // a new one comes before the newest
  wire [6:0] at     = log_i ? {1'b1, entry} : count_i ? {2'd0, which_i} : of_log ? {1'b1, entry} : {1'b0, wanted};
  wire       logs   = log_i & now_i;
  wire       write  = logs | (count_i & now_i & applies_i);
  // Event, 0, or one more: the sum means nothing in the first two cases; written so, it takes one cell a bit.
  wire        fresh = log_i | clear_i;
  wire [15:0] next  = word_q + {{15{fresh}}, 1'b1};

  always @(posedge clk_i) begin
    if (write) memory[at] <= fresh ? {8'd0, event_i} : next;
    word_q <= memory[at];
    ack_q  <= host & counter_stb_i & ~ack_q;

    if (logs) begin
      newest_q <= entry;
      if (entries_q != LOG_ENTRIES) entries_q <= entries_q + 7'd1;
    end
    if (empty_i) entries_q <= 7'd0;

    if (listen_i) listen_only_q <= 1'b1;
    if (active_i) listen_only_q <= 1'b0;

    register_q[15:1] <= (clear_register_i ? 15'd0 : register_q[15:1]) | diagnostic_i;
    if (overrun_i)                             register_q[0] <= 1'b1;
    else if (no_overrun_i || clear_register_i) register_q[0] <= 1'b0;

    if (rst_i) begin
      entries_q     <= 7'd0;
      listen_only_q <= 1'b0;
      register_q    <= 16'd0;
      ack_q         <= 1'b0;
    end
  end

  assign listen_only_o = listen_only_q;
  assign register_o    = register_q;
  assign log_count_o   = entries_q;
  assign data_o        = word_q;
  assign counter_ack_o = ack_q;

endmodule

`default_nettype wire
