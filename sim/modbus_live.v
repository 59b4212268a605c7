// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live - core and block RAM as the live device runs them; switches it does not offer are tied off.
//
// With bits 41H, 42H, 64H in USER_CODES modbus_example_user is on the user port.
//
// Behind the host port are the tables, and as space 5 counters and event log: see modbus_host_map.

`default_nettype none
`include "modbus_defs.vh"

module modbus_live #(
`include "modbus_tables.vh"
  ,
`include "modbus_config.vh"
)
`include "modbus_live_ports.vh"

  // Some user functions work so long:
  localparam integer WORK_CLOCKS = CLK_HZ / 100;

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
    settings[`MB_SET_ASCII]   = ascii_q;
    settings[`MB_SET_EIGHT_BITS] = eight_bits_q;
  end

  assign host_state[`MB_HOST_BUSY]             = busy_q;
  assign host_state[`MB_HOST_RUN]              = run_indicator_q;
  assign host_state[`MB_HOST_FAILURE]          = failure_q;
  assign host_state[`MB_HOST_EXCEPTION_STATUS] = exception_status_q;
  assign host_state[`MB_HOST_DIAGNOSTIC]       = diagnostic_q[15:1];
  assign host_state[`MB_HOST_UNIT_OURS]        = 1'b0;

`include "modbus_bank_wires.vh"

`include "modbus_table_codes.vh"

  wire        status_stb, status_ack;
  wire [6:0]  status_adr;
  wire [15:0] status_read, bank_write, bank_read;
  wire        bank_cyc, bank_stb, bank_we, bank_ack, bank_err;
  wire [18:0] bank_adr;

  // Settings and state come from the bridge as they are.
  // verilator lint_off PINCONNECTEMPTY
  modbus_host_map #(.HOST_SETTINGS(0), .BIT_FRACTIONS(BIT_FRACTIONS), .ASCII_MODE(ASCII_MODE)) u_host_map (
    .clk_i(clk_i), .rst_i(rst_q), .host_cyc_i(host_cyc_q), .host_stb_i(host_stb_q), .host_we_i(host_we_q),
    .host_adr_i(host_adr_q), .host_dat_i(host_dat_q), .host_dat_o(host_dat_o), .host_ack_o(host_ack_o),
    .host_err_o(host_err_o), .bank_cyc_o(bank_cyc), .bank_stb_o(bank_stb), .bank_we_o(bank_we), .bank_adr_o(bank_adr),
    .bank_dat_o(bank_write), .bank_dat_i(bank_read), .bank_ack_i(bank_ack), .bank_err_i(bank_err),
    .status_stb_o(status_stb), .status_adr_o(status_adr), .status_dat_i(status_read), .status_ack_i(status_ack),
    .health_stb_o(), .health_adr_o(), .health_dat_i(16'd0), .health_ack_i(1'b0), .health_clear_o(),
    .settings_i(settings), .host_state_i(host_state), .write_lock_i(write_lock_q), .idle_i(idle_o), .settings_o(),
    .host_state_o(), .write_lock_o()
  );

  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .user_req_o(user_req), .user_count_o(user_count), .user_adr_i(user_adr),
    .user_dat_o(user_request), .user_reply_i(user_reply), .status_stb_i(status_stb), .status_adr_i(status_adr),
    .status_dat_o(status_read), .status_ack_o(status_ack), .write_stb_o(write_stb_o), .events_o(events_o), .alive_o(),
    .rx_active_o(rx_active_o), .listen_only_o(listen_only_o), .unit_o(), .idle_o(idle_o),
`include "modbus_bank_core_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

  assign write_space_o = grant_space;
  assign write_first_o = grant_first;
  assign write_last_o  = grant_last;
  assign write_file_o  = grant_file;

  modbus_bank_ram #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_q), .write_lock_i(write_lock_q), .host_cyc_i(bank_cyc), .host_stb_i(bank_stb),
    .host_we_i(bank_we), .host_adr_i(bank_adr), .host_dat_i(bank_write), .host_dat_o(bank_read), .host_ack_o(bank_ack),
    .host_err_o(bank_err),
`include "modbus_bank_inst.vh"
  );

endmodule

`default_nettype wire
