// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_pdm_record - the event records of a PDM meter, on the user port: what reading one register at 0001H answers.
//
// PDM meter protocol, 3.7: function code 03, address 0001, quantity 1 is answered with byte count 0CH and twelve bytes:
//
//   entry number H, L | event group | event code | action: 02 closed, 01 open | ms L, H | minute | hour | day | month | year
//
// All binary; the milliseconds hold the seconds too (0..59999) and are the only field with its low byte first; the year
// counts from 2000.  Every other request is passed on: also another quantity at 0001H, and a request of another length.
// The core must offer function code 03 (bit 3 of USER_CODES).
//
// The document says no more than that; the rest is decided here:
// - Events are numbered from 1 in the order in which they come; 65535 is followed by 1.
// - Each read takes the oldest record that has not been read.  With none left the last one is answered again, so a
//   master finds something new by its number, and may repeat a read whose answer got lost.  Where more records waited
//   behind the lost one, the gap in the numbers tells.
// - DEPTH records wait at most; a further event drops the oldest of them, and again the gap in the numbers tells.
// - Before the first event the number is 0 and so is everything else.
// - With busy_i or failure_i the read answers 06 or that code, as any other register does, and takes nothing.
// - rst_i forgets all records and begins again with number 1.
//
// An event is taken in 12 clocks, later while a request is here: 23 clocks to answer a record, 4 to 10 to pass.

`default_nettype none
`include "modbus_defs.vh"

module modbus_pdm_record #(
  parameter integer DEPTH = 32               // unread records, a power of 2 from 4 to 1024; 16 bytes of RAM each
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // The same signals as at the core
  input  wire        busy_i,
  input  wire [3:0]  failure_i,

  // Events: hold everything from event_stb_i to event_ack_o
  input  wire        event_stb_i,
  input  wire [7:0]  event_group_i,
  input  wire [7:0]  event_code_i,
  input  wire        event_closed_i,         // 1 closed, 0 open
  input  wire [15:0] event_ms_i,             // within the minute, 0..59999
  input  wire [7:0]  event_minute_i,
  input  wire [7:0]  event_hour_i,
  input  wire [7:0]  event_day_i,            // 1..31
  input  wire [7:0]  event_month_i,          // 1..12
  input  wire [7:0]  event_year_i,           // since 2000
  output wire        event_ack_o,            // strobe: taken

  // User port of the core
  input  wire        user_req_i,
  input  wire [7:0]  user_count_i,
  output wire [7:0]  user_adr_o,
  input  wire [7:0]  user_dat_i,
  output wire        user_put_o,
  output wire [7:0]  user_dat_o,
  output wire        user_done_o,
  output wire        user_pass_o,
  output wire [3:0]  user_exception_o
);

  localparam W = (DEPTH > 3) ? $clog2(DEPTH) : 2;
  localparam [W:0] FULL = DEPTH[W:0];

  generate
    if (DEPTH < 4 || DEPTH > 1024 || DEPTH != (1 << W)) begin : gen_illegal
      ERROR_modbus_pdm_record_DEPTH_a_power_of_2_from_4_to_1024 illegal_parameter ();
    end
  endgenerate

  localparam [31:0] READ_REGISTERS = `MB_FC_READ_HOLDING_REGISTERS;
  localparam [7:0] REQUEST_BYTES = 8'd6;     // address, function code, register, quantity
  localparam [7:0] RECORD_BYTES  = 8'h0C;
  localparam [7:0] ACTION_CLOSED = 8'h02, ACTION_OPEN = 8'h01;

  localparam [2:0] ST_IDLE = 3'd0, ST_STORE = 3'd1, ST_MATCH = 3'd2, ST_ANSWER = 3'd3, ST_DONE = 3'd4, ST_REST = 3'd5;

  reg [2:0] state_q = ST_IDLE;
  reg [3:0] place_q = 4'd0;                  // byte of the request, or of the record
  reg       fresh_q = 1'b0;                  // user_dat_i is the byte at place_q
  reg       pass_q;
  reg [3:0] exception_q;

  reg [2:0] state_d;
  reg [3:0] place_d;
  reg       pass_d;
  reg [3:0] exception_d;
  reg       stored_stb, taken_stb;

  // The records: a ring in which the unread ones follow the one read last.
  (* no_rw_check *) reg [7:0] memory [0:16*DEPTH-1];
  reg [7:0]   memory_q;
  reg [W-1:0] at_q = {W{1'b0}};              // the one read last
  reg [W:0]   unread_q = {W+1{1'b0}};
  reg [15:0]  number_q = 16'd0;              // of the newest, 0 before the first

  wire         full    = (unread_q == FULL);
  wire         unread  = (unread_q != {W+1{1'b0}});
  wire         storing = (state_q == ST_STORE);
  wire [15:0]  number  = (number_q == 16'hFFFF) ? 16'd1 : number_q + 16'd1;
  // Full, the newest goes where the oldest lies: one behind at_q in either case.
  wire [W-1:0] slot    = at_q + (storing ? unread_q[W-1:0] + 1'b1 : {{W-1{1'b0}}, unread});

  reg [7:0] event_byte;

  always @* begin
    case (place_q)
      4'd0:    event_byte = number[15:8];
      4'd1:    event_byte = number[7:0];
      4'd2:    event_byte = event_group_i;
      4'd3:    event_byte = event_code_i;
      4'd4:    event_byte = event_closed_i ? ACTION_CLOSED : ACTION_OPEN;
      4'd5:    event_byte = event_ms_i[7:0];
      4'd6:    event_byte = event_ms_i[15:8];
      4'd7:    event_byte = event_minute_i;
      4'd8:    event_byte = event_hour_i;
      4'd9:    event_byte = event_day_i;
      4'd10:   event_byte = event_month_i;
      default: event_byte = event_year_i;
    endcase
  end

  always @(posedge clk_i) begin
    if (storing) memory[{slot, place_q}] <= event_byte;
    memory_q <= memory[{slot, place_q}];
  end

  always @(posedge clk_i) begin
    if (stored_stb) begin
      number_q <= number;
      if (full) at_q     <= at_q + 1'b1;     // the oldest is lost
      else      unread_q <= unread_q + 1'b1;
    end
    if (taken_stb && unread) begin
      at_q     <= at_q + 1'b1;
      unread_q <= unread_q - 1'b1;
    end
    if (rst_i) begin
      at_q     <= {W{1'b0}};
      unread_q <= {W+1{1'b0}};
      number_q <= 16'd0;
    end
  end

  // The request, byte by byte: function code 03, address 0001, quantity 1
  reg [7:0] wanted;

  always @* begin
    case (place_q)
      4'd1:       wanted = READ_REGISTERS[7:0];
      4'd3, 4'd5: wanted = 8'h01;
      default:    wanted = 8'h00;
    endcase
  end

  always @* begin
    state_d     = state_q;
    place_d     = place_q;
    pass_d      = pass_q;
    exception_d = exception_q;
    stored_stb  = 1'b0;
    taken_stb   = 1'b0;

    case (state_q)
      // The function code's place is on show, for a request that may come.
      ST_IDLE: begin
        place_d     = 4'd1;
        pass_d      = 1'b0;
        exception_d = 4'd0;
        if (user_req_i) begin
          state_d = ST_MATCH;
        end else if (event_stb_i) begin
          place_d = 4'd0;
          state_d = ST_STORE;
        end
      end

      // A request that comes meanwhile waits; it is twelve clocks at most.
      ST_STORE: begin
        place_d = place_q + 4'd1;
        if (place_q == 4'd11) begin
          stored_stb = 1'b1;
          place_d    = 4'd1;
          state_d    = ST_IDLE;
        end
      end

      // The first byte that differs passes it on.
      ST_MATCH: if (fresh_q) begin
        place_d = place_q + 4'd1;
        if (user_dat_i != wanted || user_count_i != REQUEST_BYTES) begin
          pass_d  = 1'b1;
          state_d = ST_DONE;
        end else if (place_q == 4'd5) begin
          place_d     = 4'd0;
          exception_d = busy_i ? `MB_EX_DEVICE_BUSY : failure_i;
          state_d     = (busy_i || failure_i != 4'd0) ? ST_DONE : ST_ANSWER;
        end
      end

      // The byte count, and each byte of the record in the clock after its place is shown.
      ST_ANSWER: begin
        place_d = place_q + 4'd1;
        if (place_q == 4'd12) state_d = ST_DONE;
      end

      // One clock: user_done_o.  Only now is it sure that the answer counts.
      ST_DONE: begin
        taken_stb = user_req_i & ~pass_q & (exception_q == 4'd0);
        state_d   = ST_REST;
      end

      ST_REST: ;                             // until user_req_i falls
      default: state_d = ST_IDLE;
    endcase

    // Withdrawn by the core: the record was not answered and stays.
    if (!user_req_i && state_q != ST_IDLE && state_q != ST_STORE) begin
      place_d = 4'd1;
      state_d = ST_IDLE;
    end
  end

  always @(posedge clk_i) begin
    state_q     <= rst_i ? ST_IDLE : state_d;
    place_q     <= place_d;
    fresh_q     <= user_req_i & (place_d == place_q);
    pass_q      <= pass_d;
    exception_q <= exception_d;
  end

  assign event_ack_o      = stored_stb;
  assign user_adr_o       = {4'd0, place_q};
  assign user_put_o       = (state_q == ST_ANSWER);
  assign user_dat_o       = (place_q == 4'd0) ? RECORD_BYTES : (number_q == 16'd0) ? 8'h00 : memory_q;
  assign user_done_o      = (state_q == ST_DONE);
  assign user_pass_o      = pass_q;
  assign user_exception_o = exception_q;

endmodule

`default_nettype wire
