// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// host_map_bench - core, tables in RAM and modbus_host_map, with a CPU by modbus_axil_slave or at the Wishbone host side.

`default_nettype none
`include "modbus_defs.vh"

module host_map_bench #(
  parameter integer AXIL = 1,                    // 0: Wishbone
  parameter integer HOST_MAP = 1,
  parameter integer HOST_SETTINGS = 1,
  parameter integer BIT_FRACTIONS = 0,
  parameter integer ASCII_MODE = 0,
  parameter integer LINE_HEALTH = 0,
  parameter integer T15_MIN_US = 0,
  parameter integer T35_MIN_US = 0,
  parameter [127:0] FUNCTION_CODES = `MB_ALL_FUNCTIONS,
`include "modbus_tables.vh"
) (
  input  wire         clk_i,
  input  wire         rst_i,
  input  wire         rxd_i,
  output wire         txd_o,
  output wire         de_o,
  input  wire         host_cyc_i,
  input  wire         host_stb_i,
  input  wire         host_we_i,
  input  wire [18:0]  host_adr_i,
  input  wire [15:0]  host_dat_i,
  output wire [15:0]  host_dat_o,
  output wire         host_ack_o,
  output wire         host_err_o,
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
  output wire         write_stb_o,
  output wire [2:0]   write_space_o,
  output wire [15:0]  write_first_o,
  output wire [15:0]  write_last_o,
  output wire [15:0]  write_file_o,
  output wire         listen_only_o,
  output wire         idle_o,
  output wire         frame_stb_o,
  output wire         err_parity_o,
  output wire         err_framing_o,
  output wire         err_overrun_o,
  output wire         err_crc_o,
  output wire         err_short_o,
  output wire         err_long_o,
  output wire         err_gap_o
);

  // 8 clocks a bit, 8E1, address 17: what the bench begins with
  localparam [`MB_SETTINGS_WIDTH-1:0] SETTINGS = `MB_LINE_SETTINGS(8'd17, 16'd8, 2'd0) & ~(74'hF << 58);

`include "modbus_table_codes.vh"
`include "modbus_bank_wires.vh"

  wire [`MB_SETTINGS_WIDTH-1:0]   settings;
  wire [`MB_HOST_STATE_WIDTH-1:0] host_state;
  wire                            write_lock, status_stb, status_ack;
  wire [6:0]                      status_adr;
  wire [15:0]                     status_dat;
  wire                            cyc, stb, we, ack, err, bank_cyc, bank_stb, bank_we, bank_ack, bank_err;
  wire [18:0]                     adr, bank_adr;
  wire [15:0]                     to_map, from_map, to_bank, from_bank;
  wire                            rx_active, health_stb, health_ack, health_clear;
  wire [2:0]                      health_adr;
  wire [15:0]                     health_dat;

  wire [`MB_EVENTS_WIDTH-1:0] events;
  assign {err_gap_o, err_long_o, err_short_o, err_crc_o, err_overrun_o, err_framing_o, err_parity_o, frame_stb_o} = events;

  modbus_rtu_core #(
    .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .BIT_FRACTIONS(BIT_FRACTIONS), .ASCII_MODE(ASCII_MODE),
    .FUNCTION_CODES(TABLE_CODES)
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(status_stb), .status_adr_i(status_adr), .status_dat_o(status_dat),
    .status_ack_o(status_ack), .write_stb_o(write_stb_o),
    .events_o(events),
    .alive_o(), .rx_active_o(rx_active), .listen_only_o(listen_only_o), .unit_o(), .idle_o(idle_o),
`include "modbus_bank_core_inst.vh"
  );

  assign write_space_o = grant_space;
  assign write_first_o = grant_first;
  assign write_last_o  = grant_last;
  assign write_file_o  = grant_file;

  modbus_host_map #(
    .HOST_MAP(HOST_MAP), .HOST_SETTINGS(HOST_SETTINGS), .BIT_FRACTIONS(BIT_FRACTIONS), .ASCII_MODE(ASCII_MODE),
    .LINE_HEALTH(LINE_HEALTH), .INITIAL_SETTINGS(SETTINGS), .INITIAL_STATE(`MB_HOST_AT_REST)
  ) u_map (
    .clk_i(clk_i), .rst_i(rst_i), .host_cyc_i(cyc), .host_stb_i(stb), .host_we_i(we), .host_adr_i(adr),
    .host_dat_i(to_map), .host_dat_o(from_map), .host_ack_o(ack), .host_err_o(err), .bank_cyc_o(bank_cyc),
    .bank_stb_o(bank_stb), .bank_we_o(bank_we), .bank_adr_o(bank_adr), .bank_dat_o(to_bank), .bank_dat_i(from_bank),
    .bank_ack_i(bank_ack), .bank_err_i(bank_err), .status_stb_o(status_stb), .status_adr_o(status_adr),
    .status_dat_i(status_dat), .status_ack_i(status_ack), .health_stb_o(health_stb),
    .health_adr_o(health_adr), .health_dat_i(health_dat), .health_ack_i(health_ack), .health_clear_o(health_clear),
    .settings_i(SETTINGS), .host_state_i(`MB_HOST_AT_REST),
    .write_lock_i(1'b0), .idle_i(idle_o), .settings_o(settings), .host_state_o(host_state), .write_lock_o(write_lock)
  );

  generate
    if (LINE_HEALTH != 0) begin : gen_health
      modbus_line_health u_health (
        .clk_i(clk_i), .rst_i(rst_i), .clear_i(health_clear), .rxd_i(rxd_i), .de_i(de_o), .rx_active_i(rx_active),
        .events_i(events),
        .settings_i(settings), .stb_i(health_stb), .adr_i(health_adr), .dat_o(health_dat), .ack_o(health_ack)
      );
    end else begin : gen_no_health
      assign {health_dat, health_ack} = 17'd0;
    end
  endgenerate

  modbus_bank_ram #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock), .host_cyc_i(bank_cyc), .host_stb_i(bank_stb),
    .host_we_i(bank_we), .host_adr_i(bank_adr), .host_dat_i(to_bank), .host_dat_o(from_bank), .host_ack_o(bank_ack),
    .host_err_o(bank_err),
`include "modbus_bank_inst.vh"
  );

  generate
    if (AXIL != 0) begin : gen_axil
      modbus_axil_slave u_bridge (
        .clk_i(clk_i), .rst_i(rst_i), .s_axil_awaddr(s_axil_awaddr), .s_axil_awprot(s_axil_awprot),
        .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready), .s_axil_wdata(s_axil_wdata),
        .s_axil_wstrb(s_axil_wstrb), .s_axil_wvalid(s_axil_wvalid), .s_axil_wready(s_axil_wready),
        .s_axil_bresp(s_axil_bresp), .s_axil_bvalid(s_axil_bvalid), .s_axil_bready(s_axil_bready),
        .s_axil_araddr(s_axil_araddr), .s_axil_arprot(s_axil_arprot), .s_axil_arvalid(s_axil_arvalid),
        .s_axil_arready(s_axil_arready), .s_axil_rdata(s_axil_rdata), .s_axil_rresp(s_axil_rresp),
        .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready), .host_cyc_o(cyc), .host_stb_o(stb), .host_we_o(we),
        .host_adr_o(adr), .host_dat_o(to_map), .host_dat_i(from_map), .host_ack_i(ack), .host_err_i(err)
      );
      assign {host_dat_o, host_ack_o, host_err_o} = 18'd0;
    end else begin : gen_wishbone
      assign {cyc, stb, we, adr, to_map} = {host_cyc_i, host_stb_i, host_we_i, host_adr_i, host_dat_i};
      assign {host_dat_o, host_ack_o, host_err_o} = {from_map, ack, err};
      assign {s_axil_awready, s_axil_wready, s_axil_bresp, s_axil_bvalid, s_axil_arready, s_axil_rresp, s_axil_rvalid} = 9'd0;
      assign s_axil_rdata = 32'd0;
    end
  endgenerate

endmodule

`default_nettype wire
