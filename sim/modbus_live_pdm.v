// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live_pdm - the PDM meter as the live device runs it (DEVICE=pdm), with the ports of modbus_live.
//
// What the bridge writes as initial contents: space 1 the inputs DI1.., space 3 the registers, space 4 an event:
// items 0 to 5 are {group, code}, closed, ms, {minute, hour}, {day, month}, year; the last one reports it.

`default_nettype none

module modbus_live_pdm #(
  parameter CLK_HZ = 1843200
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
  // The meter has nothing that would show these:
  // verilator lint_off UNUSED
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,
  // verilator lint_on UNUSED

  // Initial contents, written by the bridge
  input  wire        host_stb_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire        host_ack_o,
  output wire        host_err_o
);

  localparam DI_COUNT = 4, DO_COUNT = 2;
  localparam [2:0]  SPACE_DISCRETES = 3'd1, SPACE_HOLDINGS = 3'd3, SPACE_EVENT = 3'd4;
  localparam [15:0] LAST_FIELD = 16'd5;

  reg         rst_q = 1'b1;
  reg         rxd_q = 1'b1;
  reg  [7:0]  address_q  = 8'd0;
  reg  [15:0] bit_time_q = 16'd8;
  reg  [1:0]  format_q   = 2'd0;
  reg         busy_q     = 1'b0;
  reg         host_stb_q = 1'b0;
  reg  [18:0] host_adr_q = 19'd0;
  reg  [15:0] host_dat_q = 16'd0;

  reg  [DI_COUNT-1:0] di_q = {DI_COUNT{1'b0}};
  reg  [15:0] kind_q, ms_q, clock_q, date_q;
  reg         closed_q;

  wire [2:0]  space = host_adr_q[18:16];
  wire [15:0] item  = host_adr_q[15:0];
  wire        input_stb    = host_stb_q & (space == SPACE_DISCRETES) & (item < DI_COUNT);
  wire        register_stb = host_stb_q & (space == SPACE_HOLDINGS);
  wire        field_stb    = host_stb_q & (space == SPACE_EVENT) & (item < LAST_FIELD);
  wire        event_stb    = host_stb_q & (space == SPACE_EVENT) & (item == LAST_FIELD);
  wire        register_ack, register_err, event_ack;

  assign host_ack_o = input_stb | register_ack | field_stb | event_ack;
  assign host_err_o = register_err | (host_stb_q & ~(input_stb | register_stb | field_stb | event_stb));

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

    if (input_stb) di_q[item[1:0]] <= host_dat_q[0];
    if (field_stb) begin
      case (item[2:0])
        3'd0:    kind_q   <= host_dat_q;
        3'd1:    closed_q <= host_dat_q[0];
        3'd2:    ms_q     <= host_dat_q;
        3'd3:    clock_q  <= host_dat_q;
        default: date_q   <= host_dat_q;
      endcase
    end
  end

  // verilator lint_off PINCONNECTEMPTY
  // Outputs for a host are open: the device has none.
  modbus_pdm_meter #(.CLK_HZ(CLK_HZ), .DI_COUNT(DI_COUNT), .DO_COUNT(DO_COUNT)) u_meter (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o), .address_i(address_q),
    .bit_time_i(bit_time_q), .format_i(format_q), .busy_i(busy_q), .di_i(di_q), .do_o(),
    .host_cyc_i(register_stb), .host_stb_i(register_stb), .host_we_i(register_stb), .host_adr_i(item),
    .host_dat_i(host_dat_q), .host_dat_o(), .host_ack_o(register_ack), .host_err_o(register_err),
    .event_stb_i(event_stb), .event_group_i(kind_q[15:8]), .event_code_i(kind_q[7:0]), .event_closed_i(closed_q),
    .event_ms_i(ms_q), .event_minute_i(clock_q[15:8]), .event_hour_i(clock_q[7:0]), .event_day_i(date_q[15:8]),
    .event_month_i(date_q[7:0]), .event_year_i(host_dat_q[7:0]), .event_ack_o(event_ack), .write_stb_o(),
    .write_space_o(), .write_first_o(), .write_last_o(), .alive_o(), .rx_active_o(), .frame_stb_o(), .err_parity_o(),
    .err_framing_o(), .err_overrun_o(), .err_crc_o(), .err_short_o(), .err_long_o(), .err_gap_o()
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
