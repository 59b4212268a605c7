// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live - the drop-in slave as the live device runs it: switches it does not offer are tied off.
//
// Every input passes a register. That changes nothing on the line but one clock of delay, and lets the
// compiled model evaluate the logic behind the inputs once a clock instead of twice.

`default_nettype none

module modbus_live #(
  parameter CLK_HZ = 1843200,
  parameter MAX_READ_REGISTERS = 125, MAX_WRITE_REGISTERS = 123,
  parameter COIL_BASE = 0,     COIL_COUNT = 1024,
  parameter DISCRETE_BASE = 0, DISCRETE_COUNT = 2048,
  parameter INPUT_BASE = 0,    INPUT_COUNT = 1024,
  parameter HOLDING_BASE = 0,  HOLDING_COUNT = 2048
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Line
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,

  // Configuration
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        busy_i,

  // Initial contents, written by the bridge
  input  wire        host_stb_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire        host_ack_o,
  output wire        host_err_o
);

  reg         rst_q = 1'b1;
  reg         rxd_q = 1'b1;
  reg  [7:0]  address_q  = 8'd0;
  reg  [15:0] bit_time_q = 16'd8;
  reg  [1:0]  format_q   = 2'd0;
  reg         busy_q     = 1'b0;
  reg         host_stb_q = 1'b0;
  reg  [18:0] host_adr_q = 19'd0;
  reg  [15:0] host_dat_q = 16'd0;

  always @(posedge clk_i) begin
    rst_q      <= rst_i;
    rxd_q      <= rxd_i;
    address_q  <= address_i;
    bit_time_q <= bit_time_i;
    format_q   <= format_i;
    busy_q     <= busy_i;
    host_stb_q <= host_stb_i;
    host_adr_q <= host_adr_i;
    host_dat_q <= host_dat_i;
  end

  // verilator lint_off PINCONNECTEMPTY
  // Outputs for a host are open: the device has none.
  modbus_rtu_slave #(
    .CLK_HZ(CLK_HZ), .MAX_READ_REGISTERS(MAX_READ_REGISTERS), .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS),
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
    .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT)
  ) u_slave (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o),
    .address_i(address_q), .bit_time_i(bit_time_q), .format_i(format_q), .broadcast_en_i(1'b1),
    .gap_count_only_i(1'b0), .strict_turnaround_i(1'b0), .response_delay_i(12'd0), .stall_limit_i(16'd0),
    .de_lead_i(4'd0), .de_tail_i(4'd0), .busy_i(busy_q), .write_lock_i(1'b0),
    .host_cyc_i(host_stb_q), .host_stb_i(host_stb_q), .host_we_i(host_stb_q), .host_adr_i(host_adr_q),
    .host_dat_i(host_dat_q), .host_dat_o(), .host_ack_o(host_ack_o), .host_err_o(host_err_o),
    .write_stb_o(), .write_space_o(), .write_first_o(), .write_last_o(), .alive_o(), .rx_active_o(), .frame_stb_o(),
    .err_parity_o(), .err_framing_o(), .err_overrun_o(), .err_crc_o(), .err_short_o(), .err_long_o(), .err_gap_o()
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
