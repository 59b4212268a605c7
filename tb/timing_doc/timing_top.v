// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// timing_top - one of the two drop-ins with the signals between core and bank brought out, to be measured.
//
// The user (MORE) is done a clock after it is asked: 65 is answered with no data, 66 is passed on.

`default_nettype none

module timing_top #(
  parameter IO = 0,                  // 0 slave_bench, 1 io_bench
  parameter FLOORS = 1,              // 0: t1.5 and t3.5 without floors
  parameter FULL = 1,                // 0: function codes 01 to 06, 0F and 10 only
  parameter MORE = 0,                // 1: user functions 65 and 66, a server identification as long as can be
  parameter WIDE = 0,                // 1: sixteen bits a beat
  parameter BITS = 2000,             // coils, and discrete inputs
  parameter WORDS = 125              // input registers, and holding registers
) (
  input  wire        clk_i, rst_i, rxd_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire [11:0] response_delay_i,
  input  wire [15:0] stall_limit_i,
  input  wire [3:0]  de_lead_i, de_tail_i,
  input  wire        strict_turnaround_i,
  input  wire        host_cyc_i, host_stb_i, host_we_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire [31:0] watch_o,        // named in device.py
  output wire [2:0]  grant_space_o,
  output wire [15:0] grant_first_o, grant_last_o,
  output wire [3:0]  exception_o,
  output wire [18:0] wb_adr_o,
  output wire [15:0] wb_write_o, wb_read_o, host_dat_o
);

  localparam T15 = (FLOORS != 0) ? 750 : 0, T35 = (FLOORS != 0) ? 1750 : 0;
  localparam [63:0]  CODES = (FULL != 0) ? 64'h0000080001F399FE : 64'h000000000001807E;
  localparam [127:0] USERS = (MORE != 0) ? 128'd3 << 65 : 128'd0;
  localparam NAME_BYTES = (MORE != 0) ? 16 : 1, MORE_BYTES = (MORE != 0) ? 234 : 0;

  wire       asked;
  wire [7:0] code;                   // of the request that the user is asked for
  reg        done_q = 1'b0;
  always @(posedge clk_i) done_q <= asked & ~done_q;

  wire txd, de, rx_active, frame, write, parity, framing, overrun, crc, short, long, gap, host_ack, host_err;

  generate
    if (IO == 0) begin : gen_ram
      slave_bench #(
        .BITS_PER_BEAT((WIDE != 0) ? 16 : 1), .CLK_HZ(50000000), .T15_MIN_US(T15), .T35_MIN_US(T35), .FUNCTION_CODES(CODES), .USER_CODES(USERS),
        .COIL_COUNT(BITS), .DISCRETE_COUNT(BITS), .INPUT_COUNT(WORDS), .HOLDING_COUNT(WORDS), .FILE_COUNT(2),
        .FILE_RECORDS(256),
        .SERVER_ID_BYTES(NAME_BYTES), .ADDITIONAL_DATA_BYTES(MORE_BYTES)
      ) u_slave (
        .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd), .de_o(de), .address_i(8'd17),
        .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(1'b1), .gap_count_only_i(1'b0),
        .strict_turnaround_i(strict_turnaround_i), .drop_late_i(1'b0), .response_delay_i(response_delay_i),
        .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i), .de_tail_i(de_tail_i), .bit_fraction_i(4'd0), .ascii_i(1'b0), .eight_bits_i(1'b0), .ascii_extra_i(2'd0), .busy_i(1'b0),
        .failure_i(4'd0), .exception_status_i(8'd0), .run_indicator_i(1'b1), .diagnostic_i(16'd0),
        .user_req_o(asked), .user_count_o(), .user_adr_i(8'd1), .user_dat_o(code), .user_put_i(1'b0), .user_dat_i(8'd0),
        .user_done_i(done_q), .user_pass_i(code[1]), .user_exception_i(4'd0), .listen_only_o(),  .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(),
        .status_ack_o(), .write_lock_i(1'b0), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i), .host_we_i(host_we_i),
        .host_adr_i(host_adr_i), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o), .host_ack_o(host_ack),
        .host_err_o(host_err), .write_stb_o(write), .write_space_o(), .write_first_o(), .write_last_o(), .write_file_o(),
        .alive_o(), .idle_o(), .rx_active_o(rx_active), .frame_stb_o(frame), .err_parity_o(parity),
        .err_framing_o(framing), .err_overrun_o(overrun), .err_crc_o(crc), .err_short_o(short),
        .err_long_o(long), .err_gap_o(gap)
      );
      assign watch_o = {11'd0, u_slave.grant_write, gap, long, short, crc, overrun, framing, parity, host_err,
                        host_ack, u_slave.wb_ack, u_slave.wb_we, u_slave.wb_stb, u_slave.wb_cyc,
                        u_slave.grant_ack, u_slave.grant_req, write, frame, rx_active, de, txd};
      assign grant_space_o = u_slave.grant_space;
      assign grant_first_o = u_slave.grant_first;
      assign grant_last_o  = u_slave.grant_last;
      assign exception_o   = u_slave.exception;
      assign wb_adr_o      = u_slave.wb_adr;
      assign wb_write_o    = u_slave.wb_write;
      assign wb_read_o     = u_slave.wb_read;
    end else begin : gen_io
      io_bench #(
        .BITS_PER_BEAT((WIDE != 0) ? 16 : 1), .CLK_HZ(50000000), .T15_MIN_US(T15), .T35_MIN_US(T35), .FUNCTION_CODES(CODES), .USER_CODES(USERS),
        .COIL_COUNT(BITS), .DISCRETE_COUNT(BITS), .INPUT_COUNT(WORDS), .HOLDING_COUNT(WORDS),
        .SERVER_ID_BYTES(NAME_BYTES), .ADDITIONAL_DATA_BYTES(MORE_BYTES)
      ) u_slave (
        .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd), .de_o(de), .address_i(8'd17),
        .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(1'b1), .gap_count_only_i(1'b0),
        .strict_turnaround_i(strict_turnaround_i), .drop_late_i(1'b0), .response_delay_i(response_delay_i),
        .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i), .de_tail_i(de_tail_i), .bit_fraction_i(4'd0), .ascii_i(1'b0), .eight_bits_i(1'b0), .ascii_extra_i(2'd0), .busy_i(1'b0),
        .failure_i(4'd0), .exception_status_i(8'd0), .run_indicator_i(1'b1), .diagnostic_i(16'd0),
        .user_req_o(asked), .user_count_o(), .user_adr_i(8'd1), .user_dat_o(code), .user_put_i(1'b0), .user_dat_i(8'd0),
        .user_done_i(done_q), .user_pass_i(code[1]), .user_exception_i(4'd0), .listen_only_o(),  .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(),
        .status_ack_o(), .write_lock_i(1'b0), .coils_o(), .discretes_i({BITS{1'b0}}), .inputs_i({16*WORDS{1'b0}}),
        .holdings_o(), .write_stb_o(write), .write_space_o(), .write_first_o(), .write_last_o(), .write_file_o(),
        .alive_o(), .idle_o(), .rx_active_o(rx_active), .frame_stb_o(frame), .err_parity_o(parity),
        .err_framing_o(framing), .err_overrun_o(overrun), .err_crc_o(crc), .err_short_o(short),
        .err_long_o(long), .err_gap_o(gap)
      );
      assign host_ack = 1'b0;
      assign host_err = 1'b0;
      assign host_dat_o = 16'd0;
      assign watch_o = {11'd0, u_slave.grant_write, gap, long, short, crc, overrun, framing, parity, host_err,
                        host_ack, u_slave.wb_ack, u_slave.wb_we, u_slave.wb_stb, u_slave.wb_cyc,
                        u_slave.grant_ack, u_slave.grant_req, write, frame, rx_active, de, txd};
      assign grant_space_o = u_slave.grant_space;
      assign grant_first_o = u_slave.grant_first;
      assign grant_last_o  = u_slave.grant_last;
      assign exception_o   = u_slave.exception;
      assign wb_adr_o      = u_slave.wb_adr;
      assign wb_write_o    = u_slave.wb_write;
      assign wb_read_o     = u_slave.wb_read;
    end
  endgenerate

endmodule

`default_nettype wire
