// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_core - Modbus RTU slave (server) without memory: line side, grant question, Wishbone master.
//
// Wiring only.  A request is received whole, judged, granted, carried out, answered; nothing outside is touched before
// t3.5 has passed and the frame is good.  Before the first access the core asks the bank with
// grant_req_o for a range of items; the bank answers with grant_ack_i and 0, or an exception code.
// Then follows one burst under wb_cyc_o (several under one: the halves of 16H and 17H, the groups of 14H and 15H, count
// and entries of 18H).
// modbus_bank_ram and modbus_bank_io are banks for this interface; so is whatever you write.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_rtu_core #(
  parameter integer CLK_HZ              = 50000000,      // clk_i in hertz
  parameter integer T15_MIN_US          = 750,           // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US          = 1750,          // floor of t3.5 in microseconds, 0: none
  parameter [63:0]  FUNCTION_CODES      = 64'h0000080001F399FE,  // bit n: function code n is built in
  parameter [127:0] USER_CODES          = 128'd0,        // bit n: function code n is offered to the user first
  parameter integer MAX_READ_BITS       = 2000,          // 1..2000
  parameter integer MAX_WRITE_BITS      = 1968,          // 1..1968
  parameter integer MAX_READ_REGISTERS  = 125,           // 1..125
  parameter integer MAX_WRITE_REGISTERS = 123,           // 1..123
  parameter integer RW_MAX_READ         = 125,           // 1..125, function code 17H
  parameter integer RW_MAX_WRITE        = 121,           // 1..121, function code 17H
  parameter [127:0] SERVER_ID           = 128'h09,       // function code 11H: its identifier, right-justified
  parameter integer SERVER_ID_BYTES     = 1,             // 1..16
  parameter [1999:0] ADDITIONAL_DATA    = 2000'd0,       // what follows the run indicator, right-justified
  parameter integer ADDITIONAL_DATA_BYTES = 0,           // 0..234
  parameter [1951:0] VENDOR_NAME        = "VENDOR",      // function code 2BH: objects 00, 01, 02
  parameter [1951:0] PRODUCT_CODE       = "PRODUCT",
  parameter [1951:0] REVISION           = "V1.0",
  parameter [1951:0] VENDOR_URL         = "",            // 03 to 06, not there if empty
  parameter [1951:0] PRODUCT_NAME       = "",
  parameter [1951:0] MODEL_NAME         = "",
  parameter [1951:0] USER_APPLICATION_NAME = "",
  parameter [4095:0] PRIVATE_OBJECTS    = 4096'd0,       // {object 80H.., length, value}..., right-justified
  parameter [7:0]   CONFORMITY          = 8'h81,         // 01 02 03 81 82 83
  parameter integer DEVICE_ID_LIMIT     = 253,           // largest PDU of its answers
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
  input  wire [3:0]  failure_i,                  // 0, or the exception code to give instead of execution
  input  wire [7:0]  exception_status_i,         // function code 07H
  input  wire        run_indicator_i,            // function code 11H: 1 FFH, 0 00H
  input  wire [15:0] diagnostic_i,               // bits 15..1 set those of the diagnostic register

  // Bank: grant
  output wire        grant_req_o,                // level until grant_ack_i or the stall limit; then forget the question
  output wire [2:0]  grant_space_o,
  output wire [15:0] grant_first_o,
  output wire [15:0] grant_last_o,
  output wire        grant_write_o,
  output wire [15:0] grant_file_o,               // space 4: file number, through the burst; the items are records
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

  // User functions, see docs/user_functions.md
  output wire        user_req_o,                 // level until user_done_i or the stall limit: a request for the user
  output wire [7:0]  user_count_o,               // its bytes, address included, check field not
  input  wire [7:0]  user_adr_i,                 // which of them
  output wire [7:0]  user_dat_o,                 // a clock later
  input  wire        user_put_i,                 // strobe: append a byte to the answer
  input  wire [7:0]  user_dat_i,
  input  wire        user_done_i,                // strobe: finished, and how:
  input  wire        user_pass_i,                //   1: not the user's after all
  input  wire [3:0]  user_exception_i,           //   0: the answer is complete, else the exception code

  // Diagnostics
  output wire        listen_only_o,
  output wire [15:0] diagnostic_register_o,
  output wire [6:0]  log_count_o,                // entries of the event log, 0..64
  input  wire        counter_stb_i,              // level until counter_ack_o
  input  wire [6:0]  counter_adr_i,              // 0AH event counter, 0BH..12H by sub-function, 40H + n log entry
  output wire [15:0] counter_dat_o,              // valid with counter_ack_o
  output wire        counter_ack_o,

  // Events: strobes of one clock, but alive_o and rx_active_o
  output wire        write_stb_o,                // a write is committed:
  output wire [2:0]  write_space_o,              //   valid with write_stb_o
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire [15:0] write_file_o,               //   space 4: file number
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

  localparam [127:0] CODES = {64'd0, FUNCTION_CODES};
  localparam HAS_DIAGNOSTICS = (FUNCTION_CODES & 64'h1900) != 0;

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

  wire t15, t35, restart;

  modbus_line_timer #(.T15_CLOCKS(T15_CLOCKS), .T35_CLOCKS(T35_CLOCKS)) u_line_timer (
    .clk_i(clk_i), .rst_i(rst_i), .format_i(format_i), .quarter_stb_i(quarter_stb),
    .busy_i(rx_busy | drive | restart), .t15_o(t15), .t35_o(t35)
  );

  // Frames
  wire       open_stb, store_stb, look_stb, good_stb, broadcast, foreign_stb, bad_stb, quiet_stb, sent_stb, crc_zero;
  wire [8:0] count;
  wire [7:0] frame_byte;

  modbus_frame_rx u_frame_rx (
    .clk_i(clk_i), .rst_i(rst_i), .gap_count_only_i(gap_count_only_i), .strict_i(strict_turnaround_i),
    .address_i(address_i), .broadcast_en_i(broadcast_en_i), .byte_i(frame_byte), .look_stb_o(look_stb),
    .start_stb_i(start_stb), .char_stb_i(char_stb), .parity_error_i(parity_error), .framing_error_i(framing_error),
    .crc_zero_i(crc_zero), .t15_i(t15), .t35_i(t35), .count_i(count), .open_stb_o(open_stb), .store_stb_o(store_stb),
    .good_stb_o(good_stb), .broadcast_o(broadcast), .foreign_stb_o(foreign_stb), .bad_stb_o(bad_stb), .restart_i(restart), .done_stb_i(quiet_stb | sent_stb), .answered_i(sent_stb),
    .active_o(rx_active_o), .err_parity_o(err_parity_o), .err_framing_o(err_framing_o),
    .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o),
    .err_gap_o(err_gap_o)
  );

  wire       tx_step, waiting, stall, tx_waits;

  wire tx_bit_stb, tx_bit, tx_feed, check_bit;

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(open_stb | tx_restart), .shift_i(rx_bit_stb | tx_bit_stb),
    .feed_i(drive ? tx_feed : 1'b1), .data_i(drive ? tx_bit : rx_bit), .bit_o(check_bit), .zero_o(crc_zero)
  );

  // Requests
  wire [`MB_VERDICT_WIDTH-1:0] verdict;
  wire [`MB_FRAME_WIDTH-1:0]   frame = {err_long_o, bad_stb, foreign_stb, broadcast, good_stb};
  wire [`MB_RAM_WIDTH-1:0]     ram_do = {tx_step, store_stb, look_stb, open_stb};

  modbus_engine #(
    .FUNCTION_CODES(CODES), .USER_CODES(USER_CODES), .MAX_READ_BITS(MAX_READ_BITS),
    .MAX_WRITE_BITS(MAX_WRITE_BITS), .MAX_READ_REGISTERS(MAX_READ_REGISTERS),
    .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS), .RW_MAX_READ(RW_MAX_READ), .RW_MAX_WRITE(RW_MAX_WRITE),
    .SERVER_ID(SERVER_ID), .SERVER_ID_BYTES(SERVER_ID_BYTES), .ADDITIONAL_DATA(ADDITIONAL_DATA),
    .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES), .VENDOR_NAME(VENDOR_NAME), .PRODUCT_CODE(PRODUCT_CODE),
    .REVISION(REVISION), .VENDOR_URL(VENDOR_URL), .PRODUCT_NAME(PRODUCT_NAME), .MODEL_NAME(MODEL_NAME),
    .USER_APPLICATION_NAME(USER_APPLICATION_NAME), .PRIVATE_OBJECTS(PRIVATE_OBJECTS), .CONFORMITY(CONFORMITY),
    .DEVICE_ID_LIMIT(DEVICE_ID_LIMIT)
  ) u_engine (
    .clk_i(clk_i), .rst_i(rst_i),
    .host_state_i({diagnostic_i[15:1], exception_status_i, failure_i, run_indicator_i, busy_i}),
    .write_stb_o(write_stb_o), .listen_only_o(listen_only_o), .frame_i(frame), .ram_do_i(ram_do), .rx_byte_i(rx_data),
    .rx_active_i(rx_active_o), .frame_byte_o(frame_byte), .count_o(count), .verdict_o(verdict), .sending_i(tx_waits),
    .bank_waits_o(waiting), .stall_i(stall), .grant_req_o(grant_req_o), .grant_space_o(grant_space_o),
    .grant_first_o(grant_first_o), .grant_last_o(grant_last_o), .grant_write_o(grant_write_o),
    .grant_file_o(grant_file_o), .grant_ack_i(grant_ack_i), .exception_i(exception_i), .wb_cyc_o(wb_cyc_o),
    .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_adr_o(wb_adr_o), .wb_dat_o(wb_dat_o), .wb_dat_i(wb_dat_i),
    .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i), .user_req_o(user_req_o), .user_count_o(user_count_o),
    .user_adr_i(user_adr_i), .user_dat_o(user_dat_o),
    .user_reply_i({user_dat_i, user_exception_i, user_pass_i, user_done_i, user_put_i}),
    .status_stb_i(counter_stb_i), .status_adr_i(counter_adr_i), .status_dat_o(counter_dat_o),
    .status_ack_o(counter_ack_o)
  );

  assign send_stb  = verdict[`MB_VERDICT_SEND];
  assign quiet_stb = verdict[`MB_VERDICT_QUIET];
  assign restart   = verdict[`MB_VERDICT_RESTART];

  // The ports of the register and the number of log entries look into the engine until the status port replaces them.
`ifdef YOSYS
  assign diagnostic_register_o = 16'd0;
  assign log_count_o = 7'd0;
`else
  generate
    if (HAS_DIAGNOSTICS) begin : gen_peek
      assign diagnostic_register_o = u_engine.gen_diagnostics.u_diagnostics.register_q;
      assign log_count_o = u_engine.gen_diagnostics.u_diagnostics.entries_q;
    end else begin : gen_no_peek
      assign diagnostic_register_o = 16'd0;
      assign log_count_o = 7'd0;
    end
  endgenerate
`endif

  wire unused_bit = diagnostic_i[0];                  // the overrun flag is the core's own

  assign write_space_o = grant_space_o;
  assign write_first_o = grant_first_o;
  assign write_last_o  = grant_last_o;
  assign write_file_o  = grant_file_o;
  assign frame_stb_o   = good_stb | foreign_stb;

  // Answers
  wire        tx_wait_clear, wait_over, tx_valid, tx_check, tx_ready;
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
    .clk_i(clk_i), .rst_i(rst_i), .frame_stb_i(good_stb), .alive_o(alive_o)
  );


endmodule

`default_nettype wire
