// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_dispatch - carries out the steps of modbus_program on the frame in the RAM.
//
// Starts with start_i (a good frame, t3.5 over) and ends with send_stb_o (count bytes in the frame RAM are the
// answer) or with quiet_stb_o (not for us, or broadcast: nothing is sent).  Each step takes a clock to
// fetch and one or more to carry out.  Whatever goes wrong becomes one exception code and the EXCEPTION routine;
// in a broadcast that routine sends nothing either (V1.02, clause 2.2).

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_dispatch (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire [7:0]  address_i,
  input  wire        broadcast_en_i,
  input  wire        busy_i,

  // Line
  input  wire        start_i,        // strobe
  output wire        send_stb_o,     // strobe: send the answer
  output wire        quiet_stb_o,    // strobe: nothing to send
  output wire        addressed_stb_o,// strobe: a good frame for us or for all
  output wire        written_stb_o,  // strobe: a write is committed; space, first and last address valid

  // Program
  output wire [7:0]  program_at_o,
  input  wire [15:0] program_step_i,

  // Frame RAM
  input  wire [7:0]  byte_i,
  input  wire [3:0]  cursor_i,
  input  wire [8:0]  count_i,
  output wire        point_o,
  output wire [3:0]  point_at_o,
  output wire        clear_o,
  output wire        step_o,
  output wire        up_o,
  output wire        down_o,
  output wire        put_o,

  // Data access
  output wire        hold_o,
  output wire        address_o,
  output wire        quantity_o,
  output wire        single_o,
  output wire        range_o,
  output wire        load_o,
  output wire        grant_o,
  output wire        burst_o,
  output wire        write_o,
  output wire [10:0] argument_o,     // level : limit, space and flags of the step
  output wire [3:0]  code_o,
  input  wire        in_limit_i,
  input  wire        bytes_fit_i,
  input  wire        over_i,
  input  wire        done_i,
  input  wire        fail_i,
  input  wire [3:0]  fail_code_i,
  input  wire [7:0]  held_i
);

  // Routines that this module itself goes to
  localparam [7:0] START = 8'd0, EXCEPTION = 8'd5;
  localparam [2:0] TABLE_PAGE = 3'd1;            // the table fills addresses 32..63

  wire [4:0]  step     = program_step_i[15:11];
  wire [10:0] argument = program_step_i[10:0];

  reg        run_q = 1'b0;           // a frame is worked on
  reg        fetched_q = 1'b0;       // the step at at_q is there
  reg [7:0]  at_q = START;
  reg [1:0]  phase_q = 2'd0;         // clocks spent in this step, up to two
  reg        broadcast_q = 1'b0;
  reg [3:0]  code_q;

  wire go = run_q & fetched_q;
  wire in_first  = (phase_q == 2'd0);
  wire in_second = (phase_q == 2'd1);

  wire is_addressed  = go & (step == `MB_STEP_ADDRESSED);
  wire is_function   = go & (step == `MB_STEP_FUNCTION);
  wire is_unicast    = go & (step == `MB_STEP_UNICAST);
  wire is_jump       = go & (step == `MB_STEP_JUMP);
  wire is_raise      = go & (step == `MB_STEP_RAISE);
  wire is_address    = go & (step == `MB_STEP_ADDRESS);
  wire is_quantity   = go & (step == `MB_STEP_QUANTITY);
  wire is_coil       = go & (step == `MB_STEP_COIL);
  wire is_byte_count = go & (step == `MB_STEP_BYTE_COUNT);
  wire is_single     = go & (step == `MB_STEP_SINGLE);
  wire is_end        = go & (step == `MB_STEP_END);
  wire is_range      = go & (step == `MB_STEP_RANGE);
  wire is_grant      = go & (step == `MB_STEP_GRANT);
  wire is_read       = go & (step == `MB_STEP_READ);
  wire is_write      = go & (step == `MB_STEP_WRITE);
  wire is_written    = go & (step == `MB_STEP_WRITTEN);
  wire is_point      = go & (step == `MB_STEP_POINT);
  wire is_forget     = go & (step == `MB_STEP_FORGET);
  wire is_count      = go & (step == `MB_STEP_COUNT);
  wire is_load       = go & (step == `MB_STEP_LOAD);
  wire is_put        = go & (step == `MB_STEP_PUT);
  wire is_send       = go & (step == `MB_STEP_SEND);

  // Address byte: 1..247 can be ours, 0 is for all, 248..255 is reserved (V1.02, clause 2.2)
  wire for_all = (byte_i == 8'd0) & broadcast_en_i;
  wire for_us  = (byte_i == address_i) & (byte_i != 8'd0) & (byte_i[7:3] != 5'h1F);

  // Steps that take a field
  wire is_word = is_address | is_quantity | is_coil;
  wire arrived = (cursor_i == argument[3:0]);
  wire walk    = (is_forget | is_count) & ~arrived;
  wire consume = ((is_word | is_byte_count) & ~phase_q[1]) | is_addressed | is_function;

  // What can be wrong with the request
  wire coil_value  = (byte_i == 8'h00) & (held_i == 8'h00 || held_i == 8'hFF);
  wire bad_value   = (is_quantity & phase_q[1] & ~in_limit_i)
                   | (is_coil & in_second & ~coil_value)
                   | (is_byte_count & in_second & count_i != {1'b0, held_i})
                   | (is_byte_count & phase_q[1] & ~bytes_fit_i)
                   | (is_end & count_i != 9'd0);
  wire bad_address = is_range & in_second & over_i;
  wire is_busy     = is_grant & done_i & busy_i;
  wire raise       = is_raise | bad_value | bad_address | is_busy | fail_i;

  // When a step is over
  wire two_clocks = is_address | is_coil | is_range | is_load;
  wire three_clocks = is_quantity | is_byte_count;
  wire until_done = is_grant | is_read | is_write;
  wire over = two_clocks ? phase_q[0] : three_clocks ? phase_q[1] : until_done ? done_i :
              (is_forget | is_count) ? arrived : 1'b1;

  wire quiet = (is_addressed & ~for_all & ~for_us) | (broadcast_q & (is_unicast | is_send));
  wire send  = is_send & ~broadcast_q;

  always @(posedge clk_i) begin
    fetched_q <= run_q;
    if (go) phase_q <= phase_q + {1'b0, ~phase_q[1]};
    if (is_addressed) broadcast_q <= for_all;
    if (raise) begin
      code_q <= is_raise             ? argument[3:0] :
                bad_value            ? `MB_EX_ILLEGAL_DATA_VALUE :
                bad_address          ? `MB_EX_ILLEGAL_DATA_ADDRESS :
                is_busy              ? `MB_EX_DEVICE_BUSY : fail_code_i;
    end
    if (go && (over || raise)) begin
      fetched_q <= 1'b0;
      phase_q   <= 2'd0;
      if (raise)            at_q <= EXCEPTION;
      else if (is_jump)     at_q <= argument[7:0];
      else if (is_function) at_q <= {TABLE_PAGE, (byte_i[7:5] == 3'd0) ? byte_i[4:0] : 5'd0};
      else                  at_q <= at_q + 8'd1;
    end
    if (!run_q) begin
      at_q    <= START;
      phase_q <= 2'd0;
      run_q   <= start_i;
    end else if (quiet || send) begin
      run_q     <= 1'b0;
      fetched_q <= 1'b0;
    end
    if (rst_i) begin
      run_q     <= 1'b0;
      fetched_q <= 1'b0;
    end
  end

  assign send_stb_o      = send;
  assign quiet_stb_o     = quiet;
  assign addressed_stb_o = is_addressed & (for_all | for_us);
  assign written_stb_o   = is_written;
  assign program_at_o    = at_q;

  assign point_o    = is_point | (is_load & in_first) | send;
  assign point_at_o = send ? 4'd0 : argument[3:0];
  assign clear_o    = is_point & argument[4];
  assign put_o      = is_put;
  assign step_o     = consume | walk | is_put;
  assign up_o       = (is_count & walk) | is_put;
  assign down_o     = consume | (is_forget & walk);

  assign hold_o     = (is_word | is_byte_count) & in_first;
  assign address_o  = is_address & in_second;
  assign quantity_o = is_quantity & in_second;
  assign single_o   = is_single;
  assign range_o    = is_range & in_first;
  assign load_o     = is_load & in_second;
  assign grant_o    = is_grant;
  assign burst_o    = is_read | is_write;
  assign write_o    = is_write | (is_grant & argument[0]);
  assign argument_o = argument;
  assign code_o     = code_q;

endmodule

`default_nettype wire
