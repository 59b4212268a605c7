// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_units - three slaves in one core: units 17, 18 and one that the host chooses, each with a bank of its own.
//
// The core shows the unit of a request at unit_o, and the bank of that unit is asked.  17 is the address of the settings,
// 18 stands in UNIT_SET, and third_i is taken by MB_HOST_UNIT_OURS, so it may change at run time.  A broadcast is one
// request: all three banks execute its write in the same clocks.  Counters and event log are shared.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 4
`define MB_WORDS_DEFAULT 4

module modbus_example_units #(
  parameter integer BIT_TIME = 434,              // clocks, 8..65535
  parameter integer FORMAT   = 0,                // MB_FORMAT_*
`include "modbus_tables.vh"
  ,
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high; 0 if there is no reset

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  input  wire [7:0]  third_i,                    // level : address of the third unit, 1..247
  output wire [7:0]  unit_o,                     // level : the unit of the request, 0 broadcast
  output wire [3*16*HOLDING_COUNT-1:0] holdings_o,     // of unit 17, 18, the third; the first lowest
  output wire        write_stb_o,                // strobe: the line has written to unit_o
  output wire [`MB_EVENTS_WIDTH-1:0] events_o    // strobes MB_EVENT_*
);

`include "modbus_bank_wires.vh"
`include "modbus_table_codes.vh"

  localparam [7:0] FIRST = 8'd17, SECOND = 8'd18;

  wire [`MB_HOST_STATE_WIDTH-1:0] unit_ours = {{`MB_HOST_STATE_WIDTH-1{1'b0}}, unit_o == third_i} << `MB_HOST_UNIT_OURS;

  // User port and status port are not used:
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES), .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US),
    .UNIT_SET(248'd1 << SECOND), .UNIT_PORT(1)
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o),
    .settings_i(`MB_LINE_SETTINGS(FIRST, BIT_TIME[15:0], FORMAT[1:0])), .host_state_i(`MB_HOST_AT_REST | unit_ours), .user_req_o(),
    .user_count_o(), .user_adr_i(8'd0), .user_dat_o(), .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0),
    .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(), .write_stb_o(write_stb_o), .events_o(events_o), .alive_o(),
    .rx_active_o(), .listen_only_o(), .unit_o(unit_o), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );

  // Which bank; all of them in a broadcast, which is a write
  wire       all = (unit_o == 8'd0);
  wire [2:0] hit = {(unit_o != FIRST) & (unit_o != SECOND), unit_o == SECOND, unit_o == FIRST} | {3{all}};
  wire [2:0] acks, granted, errs;
  wire [15:0] reads [0:2];
  wire [3:0]  codes [0:2];

  genvar n;
  generate
    for (n = 0; n < 3; n = n + 1) begin : gen_unit
      modbus_bank_io #(
`include "modbus_tables_inst.vh"
      ) u_bank (
        .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .coils_o(), .discretes_i({DISCRETE_COUNT{1'b0}}),
        .inputs_i({16*INPUT_COUNT{1'b0}}), .holdings_o(holdings_o[16*HOLDING_COUNT*n +: 16*HOLDING_COUNT]),
        .grant_req_i(grant_req & hit[n]), .grant_space_i(grant_space), .grant_first_i(grant_first),
        .grant_last_i(grant_last), .grant_write_i(grant_write), .grant_file_i(grant_file), .grant_ack_o(granted[n]),
        .exception_o(codes[n]), .wb_cyc_i(wb_cyc & hit[n]), .wb_stb_i(wb_stb & hit[n]), .wb_we_i(wb_we),
        .wb_adr_i(wb_adr), .wb_dat_i(wb_write), .wb_dat_o(reads[n]), .wb_ack_o(acks[n]), .wb_err_o(errs[n])
      );
    end
  endgenerate
  // verilator lint_on PINCONNECTEMPTY

  // The banks are alike, so in a broadcast they answer in the same clock, and the same.
  assign grant_ack = |granted;
  assign exception = hit[0] ? codes[0] : hit[1] ? codes[1] : codes[2];
  assign wb_read   = hit[0] ? reads[0] : hit[1] ? reads[1] : reads[2];
  assign wb_ack    = |acks;
  assign wb_err    = |errs;

endmodule

`default_nettype wire
