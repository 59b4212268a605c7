// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live_ports - ports of every top of the live device, and the registers behind its inputs.
//
// Included between the parameters and the body of a module.  The bridge knows these ports only.  Every input passes a
// register.  That changes nothing on the line but one clock of delay, and lets the compiled model evaluate the logic
// behind the inputs once a clock instead of twice.

(
  input  wire        clk_i,
  input  wire        rst_i,

  // Line
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,

  // A device need not have all of these:
  // verilator lint_off UNUSED
  // Configuration and the host's state
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        ascii_i,
  input  wire        eight_bits_i,
  input  wire        busy_i,
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,
  input  wire        write_lock_i,

  // Host: Wishbone B4 classic slave, {space, item}
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o,

  // What happens, see modbus_rtu_core
  output wire [`MB_EVENTS_WIDTH-1:0] events_o,
  output wire        write_stb_o,
  output wire [2:0]  write_space_o,
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire [15:0] write_file_o,
  output wire        listen_only_o,
  output wire        rx_active_o,
  output wire        idle_o
);

  reg         rst_q = 1'b1;
  reg         rxd_q = 1'b1;
  reg  [7:0]  address_q  = 8'd0;
  reg  [15:0] bit_time_q = 16'd8;
  reg  [1:0]  format_q   = 2'd0;
  reg         ascii_q    = 1'b0;
  reg         eight_bits_q = 1'b0;
  reg         busy_q     = 1'b0;
  reg  [3:0]  failure_q  = 4'd0;
  reg  [7:0]  exception_status_q = 8'd0;
  reg         run_indicator_q    = 1'b0;
  reg  [15:0] diagnostic_q       = 16'd0;
  reg         write_lock_q       = 1'b0;
  reg         host_cyc_q = 1'b0;
  reg         host_stb_q = 1'b0;
  reg         host_we_q  = 1'b0;
  reg  [18:0] host_adr_q = 19'd0;
  reg  [15:0] host_dat_q = 16'd0;
  // verilator lint_on UNUSED

  always @(posedge clk_i) begin
    rst_q      <= rst_i;
    rxd_q      <= rxd_i;
    address_q  <= address_i;
    bit_time_q <= bit_time_i;
    format_q   <= format_i;
    ascii_q    <= ascii_i;
    eight_bits_q <= eight_bits_i;
    busy_q     <= busy_i;
    failure_q  <= failure_i;
    exception_status_q <= exception_status_i;
    run_indicator_q    <= run_indicator_i;
    diagnostic_q       <= diagnostic_i;
    write_lock_q       <= write_lock_i;
    host_cyc_q <= host_cyc_i;
    host_stb_q <= host_stb_i;
    host_we_q  <= host_we_i;
    host_adr_q <= host_adr_i;
    host_dat_q <= host_dat_i;
  end
