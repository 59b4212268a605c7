// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live - core and block RAM as the live device runs them; switches it does not offer are tied off.
//
// With bits 41H, 42H, 64H in USER_CODES modbus_example_user is on the user port.
//
// Every input passes a register. That changes nothing on the line but one clock of delay, and lets the
// compiled model evaluate the logic behind the inputs once a clock instead of twice.

`default_nettype none
`include "modbus_defs.vh"

module modbus_live #(
`include "modbus_tables.vh"
  ,
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Line
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,

  // Configuration and the host's state
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        busy_i,
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,

  // Initial contents, written by the bridge
  input  wire        host_stb_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire        host_ack_o,
  output wire        host_err_o
);

  // Time stands still once the line has been idle for 20 ms: a job must be done before.
  localparam integer WORK_CLOCKS = CLK_HZ / 100;

  reg         rst_q = 1'b1;
  reg         rxd_q = 1'b1;
  reg  [7:0]  address_q  = 8'd0;
  reg  [15:0] bit_time_q = 16'd8;
  reg  [1:0]  format_q   = 2'd0;
  reg         busy_q     = 1'b0;
  reg  [3:0]  failure_q  = 4'd0;
  reg  [7:0]  exception_status_q = 8'd0;
  reg         run_indicator_q    = 1'b0;
  // Bit 0 is the core's own:
  // verilator lint_off UNUSED
  reg  [15:0] diagnostic_q       = 16'd0;
  // verilator lint_on UNUSED
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
    failure_q  <= failure_i;
    exception_status_q <= exception_status_i;
    run_indicator_q    <= run_indicator_i;
    diagnostic_q       <= diagnostic_i;
    host_stb_q <= host_stb_i;
    host_adr_q <= host_adr_i;
    host_dat_q <= host_dat_i;
  end

  wire                            user_req;
  wire [7:0]                      user_count, user_adr, user_request;
  wire [`MB_USER_REPLY_WIDTH-1:0] user_reply;

  generate
    if (USER_CODES != 128'd0) begin : gen_user
      modbus_example_user #(.WORK_CLOCKS(WORK_CLOCKS)) u_user (
        .clk_i(clk_i), .rst_i(rst_q), .user_req_i(user_req), .user_count_i(user_count), .user_adr_o(user_adr),
        .user_dat_i(user_request), .user_put_o(user_reply[`MB_USER_PUT]), .user_dat_o(user_reply[`MB_USER_DATA]),
        .user_done_o(user_reply[`MB_USER_DONE]), .user_pass_o(user_reply[`MB_USER_PASS]),
        .user_exception_o(user_reply[`MB_USER_EXCEPTION])
      );
    end else begin : gen_no_user
      assign user_adr   = 8'd0;
      assign user_reply = `MB_NO_USER;
      // Nothing is offered without a bit in USER_CODES:
      // verilator lint_off UNUSED
      wire [16:0] no_user = {user_req, user_count, user_request};
      // verilator lint_on UNUSED
    end
  endgenerate

  // The driver needs no lead: the line is simulated.
  reg  [`MB_SETTINGS_WIDTH-1:0]   settings;
  wire [`MB_HOST_STATE_WIDTH-1:0] host_state;

  always @* begin
    settings = `MB_LINE_SETTINGS(address_q, bit_time_q, format_q);
    settings[`MB_SET_DE_LEAD] = 4'd0;
  end

  assign host_state[`MB_HOST_BUSY]             = busy_q;
  assign host_state[`MB_HOST_RUN]              = run_indicator_q;
  assign host_state[`MB_HOST_FAILURE]          = failure_q;
  assign host_state[`MB_HOST_EXCEPTION_STATUS] = exception_status_q;
  assign host_state[`MB_HOST_DIAGNOSTIC]       = diagnostic_q[15:1];
  assign host_state[`MB_HOST_UNIT_OURS]        = 1'b0;

`include "modbus_bank_wires.vh"

`include "modbus_table_codes.vh"

  // The device has no host: its outputs are open.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .user_req_o(user_req), .user_count_o(user_count), .user_adr_i(user_adr),
    .user_dat_o(user_request), .user_reply_i(user_reply), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(),
    .status_ack_o(), .write_stb_o(), .events_o(), .alive_o(), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );

  modbus_bank_ram #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_q), .write_lock_i(1'b0), .host_cyc_i(host_stb_q), .host_stb_i(host_stb_q),
    .host_we_i(host_stb_q), .host_adr_i(host_adr_q), .host_dat_i(host_dat_q), .host_dat_o(), .host_ack_o(host_ack_o),
    .host_err_o(host_err_o),
`include "modbus_bank_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
