// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_core - Modbus RTU slave (server) without memory: line side, grant question, Wishbone master.
//
// Wiring only.  A request is received whole, judged, granted, carried out, answered; nothing outside is touched before
// t3.5 has passed and the frame is good.  Before the first access the core asks the bank with
// grant_req_o for a range of items; the bank answers with grant_ack_i and 0, or an exception code.
// Then follows one burst under wb_cyc_o (read/write, function codes 16H and 17H: both halves under one).
// modbus_bank_ram and modbus_bank_io are banks for this interface; so is whatever you write.

`default_nettype none
`include "modbus_defs.vh"

module modbus_rtu_core #(
  parameter integer CLK_HZ              = 50000000,      // clk_i in hertz
  parameter integer T15_MIN_US          = 750,           // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US          = 1750,          // floor of t3.5 in microseconds, 0: none
  parameter [31:0]  FUNCTION_CODES      = 32'h00C1807E,  // bit n: function code n is built in
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
  parameter integer ALIVE_TIMEOUT_MS    = 0              // alive_o falls so long after the last frame for us, 0: never
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Configuration: tie to constants, or change while the line is idle
  input  wire [7:0]  address_i,                  // 1..247; other values: broadcast only
  input  wire [15:0] bit_time_i,                 // clocks per bit, 8..65535
  input  wire [1:0]  format_i,                   // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  input  wire        broadcast_en_i,             // 1: address 0 is obeyed
  input  wire        gap_count_only_i,           // 1: a gap above t1.5 is only reported, 0: spoils the frame
  input  wire        strict_turnaround_i,        // 1: t3.5 of silence behind the own answer
  input  wire [11:0] response_delay_i,           // bit times before the answer
  input  wire [15:0] stall_limit_i,              // bit times a bank may be silent, 0: for ever
  input  wire [3:0]  de_lead_i,                  // bit times from driver enable to the start bit
  input  wire [3:0]  de_tail_i,                  // bit times from the last stop bit to driver off
  input  wire        busy_i,                     // 1: exception 06 where nothing else is wrong

  // Bank: grant
  output wire        grant_req_o,                // level until grant_ack_i or the stall limit; then forget the question
  output wire [2:0]  grant_space_o,
  output wire [15:0] grant_first_o,
  output wire [15:0] grant_last_o,
  output wire        grant_write_o,
  input  wire        grant_ack_i,
  input  wire [3:0]  exception_i,                // with grant_ack_i: 0 granted; with wb_err_i: 0 means 04

  // Bank: Wishbone B4 classic master
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [18:0] wb_adr_o,                   // {space, item}
  output wire [15:0] wb_dat_o,                   // coils: bit 0, the others mean nothing
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i,

  // Events: strobes of one clock, but alive_o and rx_active_o
  output wire        write_stb_o,                // a write is committed:
  output wire [2:0]  write_space_o,              //   valid with write_stb_o
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire        alive_o,                    // level : a master talks to us
  output wire        rx_active_o,                // level : a frame is being received
  output wire        frame_stb_o,                // good frame, for whomever
  output wire        err_parity_o,               // bad frames, when they end
  output wire        err_framing_o,
  output wire        err_overrun_o,              // characters came while a request was worked on
  output wire        err_crc_o,                  // check field wrong and nothing else
  output wire        err_short_o,                // fewer than 4 bytes
  output wire        err_long_o,                 // more than 256 bytes
  output wire        err_gap_o                   // a gap above t1.5
);

  generate
    if (CLK_HZ < 1000 || CLK_HZ > 1000000000) begin : gen_clock
      ERROR_modbus_CLK_HZ_from_1000_to_1000000000 illegal_parameter ();
    end
    if (T15_MIN_US < 0 || T35_MIN_US < T15_MIN_US || T35_MIN_US > 100000) begin : gen_floors
      ERROR_modbus_T35_MIN_US_from_T15_MIN_US_to_100000 illegal_parameter ();
    end
  endgenerate

  // Microseconds to clocks, rounded up to the next kilohertz and clock; no term passes 32 bits.
  localparam integer KHZ = (CLK_HZ % 1000000 + 999) / 1000;
  localparam integer T15_CLOCKS = (CLK_HZ / 1000000) * T15_MIN_US + (KHZ * T15_MIN_US + 999) / 1000;
  localparam integer T35_CLOCKS = (CLK_HZ / 1000000) * T35_MIN_US + (KHZ * T35_MIN_US + 999) / 1000;

  localparam integer HAS_BITS = ((FUNCTION_CODES & 32'h00008026) != 0) ? 1 : 0;     // 01 02 05 0F
  localparam integer HAS_WORDS = ((FUNCTION_CODES & 32'h00C10058) != 0) ? 1 : 0;     // 03 04 06 10 16 17
  localparam integer HAS_MASK = ((FUNCTION_CODES & 32'h00400000) != 0) ? 1 : 0;     // 16

  // Bit clock
  wire       quarter_stb, bit_stb, rx_restart, tx_restart, send_stb;
  wire [1:0] quarter;

  modbus_bit_clock u_bit_clock (
    .clk_i(clk_i), .bit_time_i(bit_time_i), .restart_i(rst_i | rx_restart | tx_restart | send_stb),
    .quarter_stb_o(quarter_stb), .quarter_o(quarter), .bit_stb_o(bit_stb)
  );

  // Receiver
  wire       rxd, drive;
  wire       start_stb, char_stb, rx_bit_stb, rx_bit, parity_error, framing_error, rx_busy;
  wire [7:0] rx_data;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd));

  modbus_uart_rx u_uart_rx (
    .clk_i(clk_i), .rst_i(rst_i), .enable_i(~drive), .format_i(format_i), .rxd_i(rxd),
    .restart_o(rx_restart), .quarter_stb_i(quarter_stb), .quarter_i(quarter),
    .start_stb_o(start_stb), .bit_stb_o(rx_bit_stb), .bit_o(rx_bit), .char_stb_o(char_stb), .data_o(rx_data),
    .parity_error_o(parity_error), .framing_error_o(framing_error), .busy_o(rx_busy)
  );

  wire t15, t35;

  modbus_line_timer #(.T15_CLOCKS(T15_CLOCKS), .T35_CLOCKS(T35_CLOCKS)) u_line_timer (
    .clk_i(clk_i), .rst_i(rst_i), .format_i(format_i), .quarter_stb_i(quarter_stb),
    .busy_i(rx_busy | drive), .t15_o(t15), .t35_o(t35)
  );

  // Frames
  wire       open_stb, store_stb, good_stb, quiet_stb, sent_stb, crc_zero;
  wire [8:0] count;
  wire [3:0] cursor;
  wire [7:0] frame_byte, held;

  modbus_frame_rx u_frame_rx (
    .clk_i(clk_i), .rst_i(rst_i), .gap_count_only_i(gap_count_only_i), .strict_i(strict_turnaround_i),
    .start_stb_i(start_stb), .char_stb_i(char_stb), .parity_error_i(parity_error), .framing_error_i(framing_error),
    .crc_zero_i(crc_zero), .t15_i(t15), .t35_i(t35), .count_i(count), .open_stb_o(open_stb), .store_stb_o(store_stb),
    .good_stb_o(good_stb), .done_stb_i(quiet_stb | sent_stb), .answered_i(sent_stb),
    .active_o(rx_active_o), .err_parity_o(err_parity_o), .err_framing_o(err_framing_o),
    .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o),
    .err_gap_o(err_gap_o)
  );

  wire       do_point, do_clear, do_step, do_up, do_down, do_put, move_put, move_step, tx_step;
  wire [3:0] do_point_at;
  wire [7:0] move_data;

  modbus_frame_ram u_frame_ram (
    .clk_i(clk_i),
    .point_i(open_stb | do_point), .point_at_i(open_stb ? 4'd0 : do_point_at),
    .step_i(store_stb | do_step | move_put | move_step | tx_step),
    .clear_i(open_stb | do_clear), .up_i(store_stb | do_up | move_put), .down_i(do_down | tx_step),
    .write_i(store_stb | do_put | move_put), .data_i(rx_active_o ? rx_data : move_data),
    .byte_o(frame_byte), .cursor_o(cursor), .count_o(count)
  );

  wire tx_bit_stb, tx_bit, tx_feed, check_bit;

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(open_stb | tx_restart), .shift_i(rx_bit_stb | tx_bit_stb),
    .feed_i(drive ? tx_feed : 1'b1), .data_i(drive ? tx_bit : rx_bit), .bit_o(check_bit), .zero_o(crc_zero)
  );

  // Requests
  wire [7:0]  program_at;
  wire [15:0] program_step;
  wire        addressed_stb, do_hold, do_address, do_quantity, do_single, do_range, do_load, do_grant, do_burst;
  wire        in_limit, bytes_fit, over, done, fail, waiting, stall;
  wire [10:0] limit;
  wire [2:0]  space;
  wire [1:0]  what;
  wire        do_write, keep, mark;
  wire [3:0]  code, fail_code;

  modbus_program #(
    .FUNCTION_CODES(FUNCTION_CODES), .MAX_READ_BITS(MAX_READ_BITS), .MAX_WRITE_BITS(MAX_WRITE_BITS),
    .MAX_READ_REGISTERS(MAX_READ_REGISTERS), .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS),
    .RW_MAX_READ(RW_MAX_READ), .RW_MAX_WRITE(RW_MAX_WRITE)
  ) u_program (.clk_i(clk_i), .at_i(program_at), .step_o(program_step));

  modbus_dispatch u_dispatch (
    .clk_i(clk_i), .rst_i(rst_i), .address_i(address_i), .broadcast_en_i(broadcast_en_i), .busy_i(busy_i),
    .start_i(good_stb), .send_stb_o(send_stb), .quiet_stb_o(quiet_stb), .addressed_stb_o(addressed_stb),
    .written_stb_o(write_stb_o), .program_at_o(program_at), .program_step_i(program_step),
    .byte_i(frame_byte), .cursor_i(cursor), .count_i(count), .point_o(do_point), .point_at_o(do_point_at),
    .clear_o(do_clear), .step_o(do_step), .up_o(do_up), .down_o(do_down), .put_o(do_put),
    .hold_o(do_hold), .address_o(do_address), .quantity_o(do_quantity), .single_o(do_single), .range_o(do_range),
    .load_o(do_load), .grant_o(do_grant), .burst_o(do_burst), .limit_o(limit), .space_o(space), .write_o(do_write), .keep_o(keep), .what_o(what), .mark_o(mark),
    .code_o(code), .in_limit_i(in_limit), .bytes_fit_i(bytes_fit), .over_i(over), .done_i(done), .fail_i(fail),
    .fail_code_i(fail_code), .held_i(held)
  );

  modbus_data_access #(.HAS_BITS(HAS_BITS), .HAS_WORDS(HAS_WORDS), .HAS_MASK(HAS_MASK)) u_data_access (
    .clk_i(clk_i), .rst_i(rst_i), .hold_i(do_hold), .address_i(do_address), .quantity_i(do_quantity),
    .single_i(do_single), .range_i(do_range), .load_i(do_load), .load_what_i(what),
    .load_flag_i(mark), .grant_i(do_grant), .burst_i(do_burst), .write_i(do_write), .keep_i(keep), .release_i(send_stb),
    .space_i(space), .limit_i(limit), .code_i(code), .in_limit_o(in_limit), .bytes_fit_o(bytes_fit),
    .over_o(over), .done_o(done), .fail_o(fail), .fail_code_o(fail_code), .held_o(held), .first_o(grant_first_o),
    .last_o(grant_last_o), .byte_i(frame_byte), .count_i(count), .put_o(move_put), .data_o(move_data),
    .step_o(move_step), .waiting_o(waiting), .stall_i(stall), .grant_req_o(grant_req_o),
    .grant_write_o(grant_write_o), .grant_ack_i(grant_ack_i), .exception_i(exception_i), .wb_cyc_o(wb_cyc_o),
    .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_adr_o(wb_adr_o), .wb_dat_o(wb_dat_o), .wb_dat_i(wb_dat_i),
    .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i)
  );

  assign grant_space_o = space;
  assign write_space_o = space;
  assign write_first_o = grant_first_o;
  assign write_last_o  = grant_last_o;
  assign frame_stb_o   = good_stb;

  // Answers
  wire        tx_wait_clear, wait_over, tx_valid, tx_check, tx_ready, tx_waits;
  wire [11:0] tx_wait_limit;

  modbus_frame_tx u_frame_tx (
    .clk_i(clk_i), .rst_i(rst_i), .start_i(send_stb), .done_stb_o(sent_stb), .drive_o(drive),
    .response_delay_i(response_delay_i), .de_lead_i(de_lead_i), .de_tail_i(de_tail_i),
    .wait_clear_o(tx_wait_clear), .wait_limit_o(tx_wait_limit), .waits_o(tx_waits), .wait_over_i(wait_over),
    .count_i(count), .step_o(tx_step), .valid_o(tx_valid), .check_o(tx_check), .ready_i(tx_ready)
  );

  // A stall limit of 0 is no limit.
  modbus_wait u_wait (
    .clk_i(clk_i), .bit_stb_i(bit_stb), .clear_i(tx_waits ? tx_wait_clear : ~waiting),
    .limit_i(tx_waits ? {4'd0, tx_wait_limit} : stall_limit_i), .over_o(wait_over)
  );

  assign stall = wait_over & (stall_limit_i != 16'd0);

  modbus_uart_tx u_uart_tx (
    .clk_i(clk_i), .rst_i(rst_i), .format_i(format_i), .restart_o(tx_restart), .bit_stb_i(bit_stb),
    .valid_i(tx_valid), .data_i(frame_byte), .check_i(tx_check), .ready_o(tx_ready),
    .bit_stb_o(tx_bit_stb), .bit_o(tx_bit), .feed_o(tx_feed), .check_bit_i(check_bit), .txd_o(txd_o)
  );

  assign de_o = drive;

  modbus_alive #(.CLK_HZ(CLK_HZ), .TIMEOUT_MS(ALIVE_TIMEOUT_MS)) u_alive (
    .clk_i(clk_i), .rst_i(rst_i), .frame_stb_i(addressed_stb), .alive_o(alive_o)
  );

`ifdef FORMAL
  // Above all: nothing is written, nor even looked at, without a complete good frame for us and a grant.
  reg f_past = 1'b0;
  reg f_good = 1'b0;                 // a frame of 4 bytes or more with zero remainder is being worked on
  reg f_ours = 1'b0;                 // its address byte is ours or 0
  reg f_write_granted = 1'b0;        // the bank agreed to a write in it
  reg f_granted = 1'b0;              // the bank agreed to an access
  reg f_own = 1'b0, f_zero = 1'b0;   // about the byte under the cursor a clock ago

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    f_own  <= (frame_byte == address_i);
    f_zero <= (frame_byte == 8'd0);
    if (rst_i || quiet_stb || sent_stb) {f_good, f_ours, f_granted, f_write_granted} <= 4'd0;
    else begin
      if (good_stb) f_good <= crc_zero & (count >= 9'd4) & t35;
      if (addressed_stb) f_ours <= f_own | (f_zero & broadcast_en_i);
      if (grant_req_o && grant_ack_i && exception_i == 4'd0) begin
        f_granted <= 1'b1;
        if (grant_write_o) f_write_granted <= 1'b1;
      end
    end
  end

  always @* if (!f_past) assume (rst_i);

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (grant_req_o)           assert (f_good && f_ours);
    if (wb_stb_o)              assert (wb_cyc_o && f_good && f_ours && f_granted);
    if (wb_stb_o && wb_we_o)   assert (f_write_granted);
    if (write_stb_o)           assert (f_good && f_write_granted);
    if (de_o)                  assert (!rx_active_o);            // deaf while driving
    if (de_o)                  assert (!wb_cyc_o);               // the bus is free before the answer
    // A beat is not withdrawn before the bank answers.
    if ($past(wb_stb_o) && !$past(wb_ack_i) && !$past(wb_err_i) && !$past(stall))
      assert (wb_stb_o && $stable(wb_adr_o) && $stable(wb_we_o));
    cover (wb_stb_o && wb_we_o && f_write_granted);
    cover (write_stb_o);
    cover (wb_stb_o && !wb_we_o);
  end
`endif

endmodule

`default_nettype wire
