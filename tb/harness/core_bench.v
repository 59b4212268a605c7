// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// core_bench - modbus_rtu_core with every field of its vectors on a port of its own, so that a test sets one by name.

`default_nettype none
`include "modbus_defs.vh"

module core_bench #(
`include "modbus_config.vh"
) (
`include "flat_ports.vh"
,
  // Bank
  output wire        grant_req_o,
  output wire [2:0]  grant_space_o,
  output wire [15:0] grant_first_o,
  output wire [15:0] grant_last_o,
  output wire        grant_write_o,
  output wire [15:0] grant_file_o,
  input  wire        grant_ack_i,
  input  wire [3:0]  exception_i,
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [18:0] wb_adr_o,
  output wire [15:0] wb_dat_o,
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i
);

  wire [`MB_SETTINGS_WIDTH-1:0]   settings;
  wire [`MB_HOST_STATE_WIDTH-1:0] host_state;
  wire [`MB_USER_REPLY_WIDTH-1:0] user_reply;
  wire [`MB_EVENTS_WIDTH-1:0]     events;
  wire [7:0]                      unit;
  wire                            unused = &{1'b0, diagnostic_i[0], unit[3:0]};

  assign settings[`MB_SET_ADDRESS]        = address_i;
  assign settings[`MB_SET_BIT_TIME]       = bit_time_i;
  assign settings[`MB_SET_FORMAT]         = format_i;
  assign settings[`MB_SET_BROADCAST]      = broadcast_en_i;
  assign settings[`MB_SET_GAP_COUNT_ONLY] = gap_count_only_i;
  assign settings[`MB_SET_STRICT]         = strict_turnaround_i;
  assign settings[`MB_SET_DROP_LATE]      = drop_late_i;
  assign settings[`MB_SET_RESPONSE_DELAY] = response_delay_i;
  assign settings[`MB_SET_STALL_LIMIT]    = stall_limit_i;
  assign settings[`MB_SET_DE_LEAD]        = de_lead_i;
  assign settings[`MB_SET_DE_TAIL]        = de_tail_i;
  assign settings[`MB_SET_BIT_FRACTION]   = bit_fraction_i;
  assign settings[`MB_SET_ASCII]          = ascii_i;
  assign settings[`MB_SET_EIGHT_BITS]     = eight_bits_i;
  assign settings[`MB_SET_ASCII_EXTRA]    = ascii_extra_i;

  assign host_state[`MB_HOST_BUSY]             = busy_i;
  assign host_state[`MB_HOST_RUN]              = run_indicator_i;
  assign host_state[`MB_HOST_FAILURE]          = failure_i;
  assign host_state[`MB_HOST_EXCEPTION_STATUS] = exception_status_i;
  assign host_state[`MB_HOST_DIAGNOSTIC]       = diagnostic_i[15:1];
  // With UNIT_PORT = 1 the host takes the units 192 to 207.
  assign host_state[`MB_HOST_UNIT_OURS]        = (unit[7:4] == 4'hC);

  assign user_reply[`MB_USER_PUT]       = user_put_i;
  assign user_reply[`MB_USER_DONE]      = user_done_i;
  assign user_reply[`MB_USER_PASS]      = user_pass_i;
  assign user_reply[`MB_USER_EXCEPTION] = user_exception_i;
  assign user_reply[`MB_USER_DATA]      = user_dat_i;

  assign frame_stb_o   = events[`MB_EVENT_FRAME];
  assign err_parity_o  = events[`MB_EVENT_PARITY];
  assign err_framing_o = events[`MB_EVENT_FRAMING];
  assign err_overrun_o = events[`MB_EVENT_OVERRUN];
  assign err_crc_o     = events[`MB_EVENT_CRC];
  assign err_short_o   = events[`MB_EVENT_SHORT];
  assign err_long_o    = events[`MB_EVENT_LONG];
  assign err_gap_o     = events[`MB_EVENT_GAP];

  assign write_space_o = grant_space_o;
  assign write_first_o = grant_first_o;
  assign write_last_o  = grant_last_o;
  assign write_file_o  = grant_file_o;

  modbus_rtu_core #(
    .FUNCTION_CODES(FUNCTION_CODES), .MAX_BIT_TIME(MAX_BIT_TIME),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .grant_req_o(grant_req_o), .grant_space_o(grant_space_o), .grant_first_o(grant_first_o),
    .grant_last_o(grant_last_o), .grant_write_o(grant_write_o), .grant_file_o(grant_file_o), .grant_ack_i(grant_ack_i),
    .exception_i(exception_i), .wb_cyc_o(wb_cyc_o), .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_adr_o(wb_adr_o),
    .wb_dat_o(wb_dat_o), .wb_dat_i(wb_dat_i), .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i), .user_req_o(user_req_o),
    .user_count_o(user_count_o), .user_adr_i(user_adr_i), .user_dat_o(user_dat_o), .user_reply_i(user_reply),
    .status_stb_i(status_stb_i), .status_adr_i(status_adr_i), .status_dat_o(status_dat_o), .status_ack_o(status_ack_o),
    .write_stb_o(write_stb_o), .events_o(events), .alive_o(alive_o), .rx_active_o(rx_active_o),
    .listen_only_o(listen_only_o), .unit_o(unit), .idle_o(idle_o)
  );

endmodule

`default_nettype wire
