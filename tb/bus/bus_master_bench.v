// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// bus_master_bench - the core as a master of a bus: AXI4-Lite by modbus_axil_master, or its own Wishbone with modbus_bank_guard.

`default_nettype none
`include "modbus_defs.vh"

module bus_master_bench #(
  parameter integer AXIL = 1,                    // 0: Wishbone
  parameter integer GUARD = 1,                   // 0: the grant question is answered outside the bridge
  parameter integer T15_MIN_US = 0,
  parameter integer T35_MIN_US = 0,
  parameter [31:0]  COIL_AT     = 32'h00000000,
  parameter [31:0]  DISCRETE_AT = 32'h00040000,
  parameter [31:0]  INPUT_AT    = 32'h00080000,
  parameter [31:0]  HOLDING_AT  = 32'h000C0000,
  parameter [31:0]  FILE_AT     = 32'h00100000,
  parameter [127:0] FUNCTION_CODES = `MB_ALL_FUNCTIONS,
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
  output wire         burst_o,
  output wire         hung_o,
  output wire         wb_cyc_o,
  output wire         wb_stb_o,
  output wire         wb_we_o,
  output wire [18:0]  wb_adr_o,
  output wire [15:0]  wb_dat_o,
  input  wire [15:0]  wb_dat_i,
  input  wire         wb_ack_i,
  input  wire         wb_err_i,
  output wire [31:0]  m_axil_awaddr,
  output wire [2:0]   m_axil_awprot,
  output wire         m_axil_awvalid,
  input  wire         m_axil_awready,
  output wire [31:0]  m_axil_wdata,
  output wire [3:0]   m_axil_wstrb,
  output wire         m_axil_wvalid,
  input  wire         m_axil_wready,
  input  wire [1:0]   m_axil_bresp,
  input  wire         m_axil_bvalid,
  output wire         m_axil_bready,
  output wire [31:0]  m_axil_araddr,
  output wire [2:0]   m_axil_arprot,
  output wire         m_axil_arvalid,
  input  wire         m_axil_arready,
  input  wire [31:0]  m_axil_rdata,
  input  wire [1:0]   m_axil_rresp,
  input  wire         m_axil_rvalid,
  output wire         m_axil_rready,
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

  wire        grant_req, grant_write, grant_ack, wb_ack, wb_err;
  wire [2:0]  grant_space;
  wire [3:0]  exception;
  wire [15:0] grant_first, grant_last, grant_file, wb_read;

  // A table of size 0 has no function codes.
`include "modbus_table_codes.vh"

  core_bench #(
    .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .FUNCTION_CODES(TABLE_CODES)
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .address_i(address_i),
    .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(broadcast_en_i),
    .gap_count_only_i(gap_count_only_i), .strict_turnaround_i(strict_turnaround_i), .drop_late_i(1'b0),
    .response_delay_i(response_delay_i), .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i), .de_tail_i(de_tail_i),
    .busy_i(busy_i), .failure_i(failure_i), .exception_status_i(exception_status_i),
    .run_indicator_i(run_indicator_i), .diagnostic_i(diagnostic_i), .listen_only_o(listen_only_o),  .status_stb_i(status_stb_i),
    .status_adr_i(status_adr_i), .status_dat_o(status_dat_o), .status_ack_o(status_ack_o),
    .write_stb_o(write_stb_o), .write_space_o(write_space_o), .write_first_o(write_first_o),
    .write_last_o(write_last_o), .write_file_o(write_file_o), .frame_stb_o(frame_stb_o), .err_parity_o(err_parity_o),
    .err_framing_o(err_framing_o), .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o),
    .err_long_o(err_long_o), .err_gap_o(err_gap_o), .grant_req_o(grant_req), .grant_space_o(grant_space),
    .grant_first_o(grant_first), .grant_last_o(grant_last), .grant_write_o(grant_write), .grant_file_o(grant_file),
    .grant_ack_i(grant_ack), .exception_i(exception), .wb_cyc_o(wb_cyc_o), .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o),
    .wb_adr_o(wb_adr_o), .wb_dat_o(wb_dat_o), .wb_dat_i(wb_read), .wb_ack_i(wb_ack), .wb_err_i(wb_err),
    .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(), .user_put_i(1'b0), .user_dat_i(8'd0),
    .user_done_i(1'b0), .user_pass_i(1'b0), .user_exception_i(4'd0), .alive_o(), .idle_o(), .rx_active_o()
  );

  // Where the bridge has no guard, and on Wishbone
  wire       guard_ack, bridge_ack;
  wire [3:0] guard_exception, bridge_exception;

  modbus_bank_guard #(
`include "modbus_tables_inst.vh"
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .req_i(grant_req),
    .space_i(grant_space), .first_i(grant_first), .last_i(grant_last), .write_i(grant_write), .file_i(grant_file),
    .flat_i(1'b0), .other_i(1'b0), .wait_i(1'b0), .ack_o(guard_ack), .exception_o(guard_exception)
  );

  assign grant_ack = (AXIL != 0 && GUARD != 0) ? bridge_ack : guard_ack;
  assign exception = (AXIL != 0 && GUARD != 0) ? bridge_exception : guard_exception & {4{guard_ack}};

  generate
    if (AXIL != 0) begin : gen_axil
      modbus_axil_master #(
        .COIL_AT(COIL_AT), .DISCRETE_AT(DISCRETE_AT), .INPUT_AT(INPUT_AT), .HOLDING_AT(HOLDING_AT), .FILE_AT(FILE_AT),
        .GUARD(GUARD),
`include "modbus_tables_inst.vh"
      ) u_bridge (
        .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .grant_req_i(grant_req),
        .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last),
        .grant_write_i(grant_write), .grant_file_i(grant_file), .grant_ack_o(bridge_ack),
        .exception_o(bridge_exception),
        .wb_cyc_i(wb_cyc_o), .wb_stb_i(wb_stb_o), .wb_we_i(wb_we_o), .wb_adr_i(wb_adr_o), .wb_dat_i(wb_dat_o),
        .wb_dat_o(wb_read), .wb_ack_o(wb_ack), .wb_err_o(wb_err), .burst_o(burst_o), .hung_o(hung_o),
        .m_axil_awaddr(m_axil_awaddr), .m_axil_awprot(m_axil_awprot), .m_axil_awvalid(m_axil_awvalid),
        .m_axil_awready(m_axil_awready), .m_axil_wdata(m_axil_wdata), .m_axil_wstrb(m_axil_wstrb),
        .m_axil_wvalid(m_axil_wvalid), .m_axil_wready(m_axil_wready), .m_axil_bresp(m_axil_bresp),
        .m_axil_bvalid(m_axil_bvalid), .m_axil_bready(m_axil_bready), .m_axil_araddr(m_axil_araddr),
        .m_axil_arprot(m_axil_arprot), .m_axil_arvalid(m_axil_arvalid), .m_axil_arready(m_axil_arready),
        .m_axil_rdata(m_axil_rdata), .m_axil_rresp(m_axil_rresp), .m_axil_rvalid(m_axil_rvalid),
        .m_axil_rready(m_axil_rready)
      );
    end else begin : gen_wishbone
      assign wb_read = wb_dat_i;
      assign wb_ack  = wb_ack_i;
      assign wb_err  = wb_err_i;
      assign burst_o = wb_cyc_o;
      assign hung_o  = 1'b0;
      assign bridge_ack       = 1'b0;
      assign bridge_exception = 4'd0;
      assign m_axil_awvalid = 1'b0;
      assign m_axil_wvalid  = 1'b0;
      assign m_axil_arvalid = 1'b0;
    end
  endgenerate

endmodule

`default_nettype wire
