// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_dispatch - carries out the steps of modbus_program on the frame in the RAM.
//
// Starts with start_i (a good frame, t3.5 over) and ends with send_stb_o (count bytes in the frame RAM are the
// answer) or with quiet_stb_o (not for us, or broadcast: nothing is sent).  A step takes two clocks to fetch and
// one or more to carry out; a step of several clocks has all its decisions in registers, for speed.  Whatever
// goes wrong becomes one exception code and the EXCEPTION routine, before the next step begins; in a
// broadcast that routine sends nothing either (V1.02, clause 2.2).

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
  output wire [10:0] limit_o,        // level : highest quantity
  output wire [2:0]  space_o,        // level : where the step works
  output wire        write_o,        // level : direction of grant and burst
  output wire        keep_o,         // level : hold the bus after the burst
  output wire [1:0]  what_o,         // level : what to load
  output wire        mark_o,
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

  wire [3:0]  step     = program_step_i[15:12];
  wire [11:0] argument = program_step_i[11:0];

  reg        run_q = 1'b0;           // a frame is worked on
  reg        fetched_q = 1'b0;       // program_step_i is the step at at_q
  reg [7:0]  at_q = START;
  reg [15:0] is_q = 16'd0;           // the step being carried out, one hot
  reg [1:0]  phase_q = 2'd0;         // its clock, 0 to 3
  reg        raise_q = 1'b0;         // the step before went wrong
  reg [3:0]  code_q;
  reg        broadcast_q;
  reg [2:0]  space_q;                // of the step, registered because much hangs on it
  reg        write_q;
  reg        arrived_q;              // the cursor was at the place a clock ago: a walk goes every other clock
  reg        finished_q;             // bank or burst ended a clock ago
  reg        count_held_q;           // count was the held byte a clock ago

  wire is_addressed  = is_q[`MB_STEP_ADDRESSED];
  wire is_function   = is_q[`MB_STEP_FUNCTION];
  wire is_jump       = is_q[`MB_STEP_JUMP];
  wire is_address    = is_q[`MB_STEP_ADDRESS];
  wire is_quantity   = is_q[`MB_STEP_QUANTITY];
  wire is_coil       = is_q[`MB_STEP_COIL];
  wire is_byte_count = is_q[`MB_STEP_BYTE_COUNT];
  wire is_end        = is_q[`MB_STEP_END];
  wire is_range      = is_q[`MB_STEP_RANGE];
  wire is_grant      = is_q[`MB_STEP_GRANT];
  wire is_burst      = is_q[`MB_STEP_BURST];
  wire is_point      = is_q[`MB_STEP_POINT];
  wire is_walk       = is_q[`MB_STEP_WALK];
  wire is_load       = is_q[`MB_STEP_LOAD];
  wire is_put        = is_q[`MB_STEP_PUT];
  wire is_send       = is_q[`MB_STEP_SEND];

  wire first  = (phase_q == 2'd0);
  wire second = (phase_q == 2'd1);
  wire third  = (phase_q == 2'd2);
  wire fourth = (phase_q == 2'd3);

  // Address byte: 1..247 can be ours, 0 is for all, 248..255 is reserved (V1.02, clause 2.2)
  reg  zero_q, match_q;              // about the byte a clock ago
  wire for_all = zero_q & broadcast_en_i;
  wire for_us  = match_q & ~zero_q & (address_i[7:3] != 5'h1F);

  always @(posedge clk_i) begin
    zero_q  <= (byte_i == 8'h00);
    match_q <= (byte_i == address_i);
  end

  wire coil_value = zero_q & (held_i == 8'h00 || held_i == 8'hFF);

  // What can be wrong with a request
  wire bad_value   = (is_quantity & fourth & ~in_limit_i)
                   | (is_coil & third & ~coil_value)
                   | (is_byte_count & third & ~count_held_q)
                   | (is_byte_count & fourth & ~bytes_fit_i)
                   | (is_end & count_i != 9'd0);
  wire bad_address = is_range & third & over_i;
  wire busy        = is_grant & done_i & argument[2] & busy_i;

  // A step that looks at fields or places takes four clocks, the others one or as long as it takes.
  wire fields = is_address | is_quantity | is_coil | is_byte_count;
  wire over   = ((is_addressed | fields | is_range | is_load | is_put) & fourth)
              | ((is_grant | is_burst) & finished_q) | (is_walk & phase_q[0] & arrived_q)
              | is_function | is_jump | is_end | is_point | is_send;
  wire quiet  = (is_addressed & second & ~for_all & ~for_us) | (broadcast_q & ((is_jump & argument[8]) | is_send));
  wire send   = is_send & ~broadcast_q;

  always @(posedge clk_i) begin
    fetched_q <= run_q & ~over & ~raise_q;
    is_q      <= 16'd1 << step;
    phase_q   <= phase_q + 2'd1;
    if (!fetched_q || over || raise_q) is_q <= 16'd0;
    if (is_q == 16'd0)      phase_q <= 2'd0;

    space_q      <= argument[10:8];
    write_q      <= argument[0];
    arrived_q    <= (cursor_i == argument[3:0]);
    finished_q   <= done_i | fail_i;
    count_held_q <= (count_i == {1'b0, held_i});
    if (is_addressed && second) broadcast_q <= for_all;

    raise_q <= bad_value | bad_address | busy | fail_i;
    if (!run_q)           code_q <= `MB_EX_ILLEGAL_FUNCTION;
    else if (fail_i)      code_q <= fail_code_i;
    else if (busy)        code_q <= `MB_EX_DEVICE_BUSY;
    else if (bad_address) code_q <= `MB_EX_ILLEGAL_DATA_ADDRESS;
    else if (bad_value)   code_q <= `MB_EX_ILLEGAL_DATA_VALUE;

    if (!run_q)           at_q <= START;
    else if (raise_q)     at_q <= EXCEPTION;
    else if (is_function) at_q <= {TABLE_PAGE, (byte_i[7:5] == 3'd0) ? byte_i[4:0] : 5'd0};
    else if (is_jump)     at_q <= argument[7:0];
    else if (over)        at_q <= at_q + 8'd1;

    run_q <= run_q ? ~(quiet | send) : start_i;
    if (rst_i) begin
      run_q     <= 1'b0;
      fetched_q <= 1'b0;
      is_q      <= 16'd0;
      raise_q   <= 1'b0;
    end
  end

  wire consume = (fields & ~phase_q[1]) | (is_addressed & first) | is_function;
  wire walk    = is_walk & phase_q[0] & ~arrived_q;
  wire placed  = is_put & second;

  assign send_stb_o      = send;
  assign quiet_stb_o     = quiet;
  assign addressed_stb_o = is_addressed & second & (for_all | for_us);
  assign written_stb_o   = is_address & third & argument[11];
  assign program_at_o    = at_q;

  assign point_o    = is_point | ((is_load | is_put) & first) | is_send;
  assign point_at_o = is_send ? 4'd0 : argument[3:0];
  assign clear_o    = is_point & argument[4];
  assign put_o      = placed;
  assign step_o     = consume | walk | placed;
  assign up_o       = (walk & argument[4]) | placed;
  assign down_o     = consume | (walk & ~argument[4]);

  assign hold_o     = fields & first;
  assign address_o  = is_address & second;
  assign quantity_o = is_quantity & second;
  assign single_o   = is_range & first & argument[0];
  assign range_o    = is_range & second;
  assign load_o     = is_load & second;
  assign grant_o    = is_grant & ~finished_q;
  assign burst_o    = is_burst & ~finished_q;
  assign limit_o    = argument[10:0];
  assign space_o    = space_q;
  assign write_o    = write_q;
  assign keep_o     = argument[1];
  assign what_o     = argument[5:4];
  assign mark_o     = argument[6];
  assign code_o     = code_q;

endmodule

`default_nettype wire
