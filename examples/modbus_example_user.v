// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_user - three function codes of one's own on the user port: a pattern to copy.
//
// Connect its ports to the user_* ports of the core, which must be built with these codes in USER_CODES
// (128'h00000010_00000006_00000000_00000000: bits 65, 66, 100).  A request with any other code in USER_CODES is passed on.
//
// | Code | Request data     | Answer data                | Shows                                             |
// |------|------------------|----------------------------|---------------------------------------------------|
// | 41H  | two words a, b   | a + b in four bytes        | fields in, fields out                             |
// | 42H  | 00: wait for it  | word: jobs done, this one  | an answer that takes WORK_CLOCKS; the stall limit |
// |      | 01: do not wait  | the same, exception 05, 06 | work that goes on between two requests            |
// | 64H  | 1 to 252 bytes   | the same bytes, last first | reading the request while writing the answer      |
//
// A request of the wrong length, or another byte behind 42H, is exception 03.
//
// The contract, from this side:
// - user_req_i is high while a request waits for us; user_count_i, user_adr_o and user_dat_i mean something only then.
// - Byte user_adr_o of the request is at user_dat_i one clock later; 0 is the address, 1 the function code, the last one
//   user_count_i - 1.  The request stays readable while the answer is written.
// - Each clock with user_put_o appends user_dat_o to the answer's data.
// - One clock of user_done_o ends it: with user_pass_o the request is not ours, else with user_exception_o other
//   than 0 that exception is answered, else what was put.
// - If user_req_i falls before that, the stall limit has passed and the master has got exception 04: forget the request.
//   So every state falls back to ST_IDLE without user_req_i, and nothing here can hang.
// Nothing else can go wrong on the line: framing, CRC, counters and broadcasts stay with the core.

`default_nettype none
`include "modbus_defs.vh"

module modbus_example_user #(
  parameter integer WORK_CLOCKS = 5000       // clocks that a job of 42H takes, 2..16777215
) (
  input  wire       clk_i,
  input  wire       rst_i,

  // User port of the core: its user_*_o are our _i, its user_*_i our _o
  input  wire       user_req_i,
  input  wire [7:0] user_count_i,
  output wire [7:0] user_adr_o,
  input  wire [7:0] user_dat_i,
  output wire       user_put_o,              // strobe
  output wire [7:0] user_dat_o,              //   valid with user_put_o
  output wire       user_done_o,             // strobe
  output wire       user_pass_o,             //   valid with user_done_o
  output wire [3:0] user_exception_o         //   valid with user_done_o
);

  generate
    if (WORK_CLOCKS < 2 || WORK_CLOCKS > 16777215) begin : gen_illegal
      ERROR_modbus_example_user_WORK_CLOCKS_from_2_to_16777215 illegal_parameter ();
    end
  endgenerate

  localparam [7:0] FC_ADD = 8'h41, FC_WORK = 8'h42, FC_REVERSE = 8'h64;
  localparam [7:0] MODE_WAIT = 8'h00, MODE_LEAVE = 8'h01;
  localparam [3:0] EX_ACKNOWLEDGE = 4'h5;    // accepted, takes its time: ask again

  localparam [7:0] AT_FUNCTION = 8'd1, AT_DATA = 8'd2;

  localparam [2:0] ST_IDLE = 3'd0, ST_FUNCTION = 3'd1, ST_ADD = 3'd2, ST_WORK = 3'd3, ST_REVERSE = 3'd4, ST_PUT = 3'd5,
                   ST_DONE = 3'd6, ST_REST = 3'd7;

  reg [2:0]  state_q = ST_IDLE;
  reg [7:0]  adr_q = AT_FUNCTION;
  reg        fresh_q = 1'b0;                 // user_dat_i is the byte at adr_q
  reg [31:0] data_q;                         // operands on their way in, result on its way out, high byte first
  reg [1:0]  left_q;                         // bytes to put behind the next one
  reg        pass_q;
  reg        result_q;                       // the answer is a job's result
  reg [3:0]  exception_q;

  reg [2:0]  state_d;
  reg [7:0]  adr_d;
  reg [31:0] data_d;
  reg [1:0]  left_d;
  reg        pass_d, result_d, start_stb, told_stb;
  reg [3:0]  exception_d;

  // The job of 42H.  It knows nothing of requests, so one that the master does not wait for is not lost.
  localparam WW = $clog2(WORK_CLOCKS + 1);
  reg [WW-1:0] work_q = {WW{1'b0}};          // clocks left
  reg          ready_q = 1'b0;               // done, and nobody has been told
  reg [15:0]   jobs_q = 16'd0;

  wire working = (work_q != {WW{1'b0}});

  always @(posedge clk_i) begin
    if (start_stb)    work_q <= WORK_CLOCKS[WW-1:0];
    else if (working) work_q <= work_q - 1'b1;
    if (told_stb)     ready_q <= 1'b0;
    if (work_q == {{WW-1{1'b0}}, 1'b1}) begin
      ready_q <= 1'b1;
      jobs_q  <= jobs_q + 16'd1;
    end
    if (rst_i) begin
      work_q  <= {WW{1'b0}};
      ready_q <= 1'b0;
      jobs_q  <= 16'd0;
    end
  end

  // The requests
  wire [7:0] last = user_count_i - 8'd1;     // place of the last byte

  always @* begin
    state_d     = state_q;
    adr_d       = adr_q;
    data_d      = data_q;
    left_d      = left_q;
    pass_d      = pass_q;
    result_d    = result_q;
    exception_d = exception_q;
    start_stb   = 1'b0;
    told_stb    = 1'b0;

    case (state_q)
      // Nothing is offered.  The function code's place is on show, so that it is here a clock after the request.
      ST_IDLE: begin
        adr_d       = AT_FUNCTION;
        pass_d      = 1'b0;
        result_d    = 1'b0;
        exception_d = 4'd0;
        state_d     = ST_FUNCTION;
      end

      // Whose is it, and has it the right length?
      ST_FUNCTION: if (fresh_q) begin
        adr_d   = AT_DATA;
        state_d = ST_DONE;
        case (user_dat_i)
          FC_ADD: begin
            if (last == 8'd5) state_d = ST_ADD;
            else              exception_d = `MB_EX_ILLEGAL_DATA_VALUE;
          end
          FC_WORK: begin
            if (last == AT_DATA) state_d = ST_WORK;
            else                 exception_d = `MB_EX_ILLEGAL_DATA_VALUE;
          end
          FC_REVERSE: begin
            adr_d = last;
            if (last >= AT_DATA) state_d = ST_REVERSE;
            else                 exception_d = `MB_EX_ILLEGAL_DATA_VALUE;
          end
          default: pass_d = 1'b1;
        endcase
      end

      // Four bytes in; behind them their place holds the sum.
      ST_ADD: begin
        left_d = 2'd3;
        if (adr_q > last) begin
          data_d  = {15'd0, {1'b0, data_q[31:16]} + {1'b0, data_q[15:0]}};
          state_d = ST_PUT;
        end else if (fresh_q) begin
          data_d = {data_q[23:0], user_dat_i};
          adr_d  = adr_q + 8'd1;
        end
      end

      // A finished job is answered first.  Else one is started, if none is on, and waited for here or by the master.
      ST_WORK: if (fresh_q) begin
        if (user_dat_i > MODE_LEAVE) begin
          exception_d = `MB_EX_ILLEGAL_DATA_VALUE;
          state_d     = ST_DONE;
        end else if (ready_q) begin
          result_d = 1'b1;
          data_d   = {jobs_q, 16'd0};
          left_d   = 2'd1;
          state_d  = ST_PUT;
        end else begin
          start_stb = ~working;
          if (user_dat_i != MODE_WAIT) begin
            exception_d = working ? `MB_EX_DEVICE_BUSY : EX_ACKNOWLEDGE;
            state_d     = ST_DONE;
          end
        end
      end

      // A byte is put as it comes, two clocks each.
      ST_REVERSE: if (fresh_q) begin
        adr_d = adr_q - 8'd1;
        if (adr_q == AT_DATA) state_d = ST_DONE;
      end

      // The result, a byte a clock.
      ST_PUT: begin
        data_d = {data_q[23:0], 8'd0};
        left_d = left_q - 2'd1;
        if (left_q == 2'd0) state_d = ST_DONE;
      end

      // One clock: user_done_o.  Only now is it sure that the answer counts.
      ST_DONE: begin
        told_stb = result_q;
        state_d  = ST_REST;
      end

      ST_REST: ;                             // until user_req_i falls
      default: state_d = ST_IDLE;
    endcase

    // Withdrawn, or never there: nothing of it may have an effect.
    if (!user_req_i) begin
      state_d   = ST_IDLE;
      adr_d     = AT_FUNCTION;
      start_stb = 1'b0;
      told_stb  = 1'b0;
    end
  end

  always @(posedge clk_i) begin
    state_q     <= rst_i ? ST_IDLE : state_d;
    adr_q       <= adr_d;
    fresh_q     <= user_req_i & (adr_d == adr_q);
    data_q      <= data_d;
    left_q      <= left_d;
    pass_q      <= pass_d;
    result_q    <= result_d;
    exception_q <= exception_d;
  end

  assign user_adr_o       = adr_q;
  assign user_put_o       = (state_q == ST_PUT) | ((state_q == ST_REVERSE) & fresh_q);
  assign user_dat_o       = (state_q == ST_PUT) ? data_q[31:24] : user_dat_i;
  assign user_done_o      = (state_q == ST_DONE);
  assign user_pass_o      = pass_q;
  assign user_exception_o = exception_q;

endmodule

`default_nettype wire
