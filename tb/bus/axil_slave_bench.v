// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// axil_slave_bench - the slave with its tables in RAM, a CPU on the host side by modbus_axil_slave.

`default_nettype none

module axil_slave_bench #(
  parameter integer T15_MIN_US = 0,
  parameter integer T35_MIN_US = 0,
  parameter integer HOLD = 1,
`include "modbus_tables.vh"
) (
  input  wire         clk_i,
  input  wire         rst_i,
  input  wire         rxd_i,
  output wire         txd_o,
  output wire         de_o,
  input  wire [7:0]   address_i,
  input  wire [15:0]  bit_time_i,
  input  wire [1:0]   format_i,
  input  wire         broadcast_en_i,
  input  wire         gap_count_only_i,
  input  wire         strict_turnaround_i,
  input  wire [11:0]  response_delay_i,
  input  wire [15:0]  stall_limit_i,
  input  wire [3:0]   de_lead_i,
  input  wire [3:0]   de_tail_i,
  input  wire         busy_i,
  input  wire [3:0]   failure_i,
  input  wire [7:0]   exception_status_i,
  input  wire         run_indicator_i,
  input  wire [15:0]  diagnostic_i,
  input  wire         write_lock_i,
  input  wire [20:0]  s_axil_awaddr,
  input  wire [2:0]   s_axil_awprot,
  input  wire         s_axil_awvalid,
  output wire         s_axil_awready,
  input  wire [31:0]  s_axil_wdata,
  input  wire [3:0]   s_axil_wstrb,
  input  wire         s_axil_wvalid,
  output wire         s_axil_wready,
  output wire [1:0]   s_axil_bresp,
  output wire         s_axil_bvalid,
  input  wire         s_axil_bready,
  input  wire [20:0]  s_axil_araddr,
  input  wire [2:0]   s_axil_arprot,
  input  wire         s_axil_arvalid,
  output wire         s_axil_arready,
  output wire [31:0]  s_axil_rdata,
  output wire [1:0]   s_axil_rresp,
  output wire         s_axil_rvalid,
  input  wire         s_axil_rready,
  output wire         listen_only_o,
  input  wire         status_stb_i,
  input  wire [6:0]   status_adr_i,
  output wire [15:0]  status_dat_o,
  output wire         status_ack_o,
  output wire         write_stb_o,
  output wire [2:0]   write_space_o,
  output wire [15:0]  write_first_o,
  output wire [15:0]  write_last_o,
  output wire [15:0]  write_file_o,
  output wire         frame_stb_o,
  output wire         err_parity_o,
  output wire         err_framing_o,
  output wire         err_overrun_o,
  output wire         err_crc_o,
  output wire         err_short_o,
  output wire         err_long_o,
  output wire         err_gap_o
);

  wire        cyc, stb, we, ack, err;
  wire [18:0] adr;
  wire [15:0] write, read;

  slave_bench #(
    .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US),
`include "modbus_tables_inst.vh"
  ) u_slave (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .address_i(address_i),
    .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(broadcast_en_i),
    .gap_count_only_i(gap_count_only_i), .strict_turnaround_i(strict_turnaround_i), .drop_late_i(1'b0),
    .response_delay_i(response_delay_i), .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i), .de_tail_i(de_tail_i),
    .busy_i(busy_i), .failure_i(failure_i), .exception_status_i(exception_status_i),
    .run_indicator_i(run_indicator_i), .diagnostic_i(diagnostic_i), .write_lock_i(write_lock_i),
    .listen_only_o(listen_only_o),
    .status_stb_i(status_stb_i), .status_adr_i(status_adr_i), .status_dat_o(status_dat_o),
    .status_ack_o(status_ack_o), .write_stb_o(write_stb_o), .write_space_o(write_space_o),
    .write_first_o(write_first_o), .write_last_o(write_last_o), .write_file_o(write_file_o),
    .frame_stb_o(frame_stb_o), .err_parity_o(err_parity_o), .err_framing_o(err_framing_o),
    .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o),
    .err_gap_o(err_gap_o), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(), .user_put_i(1'b0),
    .user_dat_i(8'd0), .user_done_i(1'b0), .user_pass_i(1'b0), .user_exception_i(4'd0), .alive_o(), .idle_o(), .rx_active_o(),
    .host_cyc_i(cyc), .host_stb_i(stb), .host_we_i(we), .host_adr_i(adr), .host_dat_i(write), .host_dat_o(read),
    .host_ack_o(ack), .host_err_o(err)
  );

  modbus_axil_slave #(.HOLD(HOLD)) u_bridge (
    .clk_i(clk_i), .rst_i(rst_i), .s_axil_awaddr(s_axil_awaddr), .s_axil_awprot(s_axil_awprot),
    .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready), .s_axil_wdata(s_axil_wdata),
    .s_axil_wstrb(s_axil_wstrb), .s_axil_wvalid(s_axil_wvalid), .s_axil_wready(s_axil_wready),
    .s_axil_bresp(s_axil_bresp), .s_axil_bvalid(s_axil_bvalid), .s_axil_bready(s_axil_bready),
    .s_axil_araddr(s_axil_araddr), .s_axil_arprot(s_axil_arprot), .s_axil_arvalid(s_axil_arvalid),
    .s_axil_arready(s_axil_arready), .s_axil_rdata(s_axil_rdata), .s_axil_rresp(s_axil_rresp),
    .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready), .host_cyc_o(cyc), .host_stb_o(stb), .host_we_o(we),
    .host_adr_o(adr), .host_dat_o(write), .host_dat_i(read), .host_ack_i(ack), .host_err_i(err)
  );

endmodule

`default_nettype wire
