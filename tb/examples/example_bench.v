// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// example_bench - modbus_example_user on the user port of a slave, as docs/user_functions.md wires it.

`default_nettype none

module example_bench #(
  parameter integer T15_MIN_US  = 0,
  parameter integer T35_MIN_US  = 0,
  parameter [127:0] USER_CODES  = 128'd0,
  parameter integer WORK_CLOCKS = 5000
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire [15:0] stall_limit_i,
  input  wire        busy_i,
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  output wire        listen_only_o,
  input  wire        status_stb_i,
  input  wire [6:0]  status_adr_i,
  output wire [15:0] status_dat_o,
  output wire        status_ack_o,
  output wire        frame_stb_o,
  output wire        err_parity_o,
  output wire        err_framing_o,
  output wire        err_overrun_o,
  output wire        err_crc_o,
  output wire        err_short_o,
  output wire        err_long_o,
  output wire        err_gap_o
);

  wire       user_req, user_put, user_done, user_pass;
  wire [7:0] user_count, user_adr, user_request, user_answer;
  wire [3:0] user_exception;

  io_bench #(
    .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .USER_CODES(USER_CODES)
  ) u_slave (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .address_i(address_i),
    .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(1'b1), .gap_count_only_i(1'b0),
    .strict_turnaround_i(1'b0), .drop_late_i(1'b0), .response_delay_i(12'd0), .stall_limit_i(stall_limit_i), .de_lead_i(4'd0),
    .de_tail_i(4'd0), .busy_i(busy_i), .failure_i(failure_i), .exception_status_i(exception_status_i),
    .run_indicator_i(1'b1), .diagnostic_i(16'd0), .write_lock_i(1'b0), .coils_o(), .discretes_i(16'd0),
    .inputs_i(128'd0), .holdings_o(), .user_req_o(user_req), .user_count_o(user_count), .user_adr_i(user_adr),
    .user_dat_o(user_request), .user_put_i(user_put), .user_dat_i(user_answer), .user_done_i(user_done),
    .user_pass_i(user_pass), .user_exception_i(user_exception), .listen_only_o(listen_only_o),  .status_stb_i(status_stb_i),
    .status_adr_i(status_adr_i), .status_dat_o(status_dat_o), .status_ack_o(status_ack_o), .write_stb_o(),
    .write_space_o(), .write_first_o(), .write_last_o(), .write_file_o(), .alive_o(), .idle_o(), .rx_active_o(),
    .frame_stb_o(frame_stb_o), .err_parity_o(err_parity_o), .err_framing_o(err_framing_o),
    .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o),
    .err_gap_o(err_gap_o)
  );

  modbus_example_user #(.WORK_CLOCKS(WORK_CLOCKS)) u_user (
    .clk_i(clk_i), .rst_i(rst_i), .user_req_i(user_req), .user_count_i(user_count), .user_adr_o(user_adr),
    .user_dat_i(user_request), .user_put_o(user_put), .user_dat_o(user_answer), .user_done_o(user_done),
    .user_pass_o(user_pass), .user_exception_o(user_exception)
  );

endmodule

`default_nettype wire
