// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live_pdm - the PDM meter as the live device runs it (DEVICE=pdm), with the ports of modbus_live.
//
// Host port: space 0 the relays (read only), space 1 the inputs DI1.., space 3 the registers, space 4 an event (write
// only): items 0 to 5 are {group, code}, closed, ms, {minute, hour}, {day, month}, year; the last one reports it.

`default_nettype none
`include "modbus_defs.vh"

module modbus_live_pdm #(
  parameter CLK_HZ = 1843200
)
`include "modbus_live_ports.vh"

  localparam DI_COUNT = 4, DO_COUNT = 2;
  localparam [2:0]  SPACE_COILS = 3'd0, SPACE_DISCRETES = 3'd1, SPACE_HOLDINGS = 3'd3, SPACE_EVENT = 3'd4;
  localparam [15:0] LAST_FIELD = 16'd5;

  reg  [DI_COUNT-1:0] di_q = {DI_COUNT{1'b0}};
  reg  [15:0] kind_q, ms_q, clock_q, date_q;
  reg         closed_q;

  wire [2:0]  space = host_adr_q[18:16];
  wire [15:0] item  = host_adr_q[15:0];
  wire        stb   = host_cyc_q & host_stb_q;
  wire        relay_stb    = stb & ~host_we_q & (space == SPACE_COILS) & (item < DO_COUNT);
  wire        input_stb    = stb & (space == SPACE_DISCRETES) & (item < DI_COUNT);
  wire        register_stb = host_stb_q & (space == SPACE_HOLDINGS);
  wire        field_stb    = stb & host_we_q & (space == SPACE_EVENT) & (item < LAST_FIELD);
  wire        event_stb    = stb & host_we_q & (space == SPACE_EVENT) & (item == LAST_FIELD);
  wire        register_ack, register_err, event_ack;
  wire [15:0] register_read;
  wire [DO_COUNT-1:0] relays;

  assign host_ack_o = relay_stb | input_stb | register_ack | field_stb | event_ack;
  assign host_err_o = register_err | (stb & ~(relay_stb | input_stb | register_stb | field_stb | event_stb));
  assign host_dat_o = relay_stb ? {15'd0, relays[item[0]]} : input_stb ? {15'd0, di_q[item[1:0]]} : register_read;

  always @(posedge clk_i) begin
    if (input_stb && host_we_q) di_q[item[1:0]] <= host_dat_q[0];
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

  assign write_file_o  = 16'd0;
  assign idle_o        = u_meter.u_core.idle_o;
  assign listen_only_o = 1'b0;               // there is no function 08

  // verilator lint_off PINCONNECTEMPTY
  modbus_pdm_meter #(.CLK_HZ(CLK_HZ), .DI_COUNT(DI_COUNT), .DO_COUNT(DO_COUNT)) u_meter (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o), .address_i(address_q),
    .bit_time_i(bit_time_q), .format_i(format_q), .busy_i(busy_q), .di_i(di_q), .do_o(relays),
    .host_cyc_i(host_cyc_q), .host_stb_i(register_stb), .host_we_i(host_we_q), .host_adr_i(item),
    .host_dat_i(host_dat_q), .host_dat_o(register_read), .host_ack_o(register_ack), .host_err_o(register_err),
    .event_stb_i(event_stb), .event_group_i(kind_q[15:8]), .event_code_i(kind_q[7:0]), .event_closed_i(closed_q),
    .event_ms_i(ms_q), .event_minute_i(clock_q[15:8]), .event_hour_i(clock_q[7:0]), .event_day_i(date_q[15:8]),
    .event_month_i(date_q[7:0]), .event_year_i(host_dat_q[7:0]), .event_ack_o(event_ack), .write_stb_o(write_stb_o),
    .write_space_o(write_space_o), .write_first_o(write_first_o), .write_last_o(write_last_o), .alive_o(),
    .rx_active_o(rx_active_o), .frame_stb_o(events_o[`MB_EVENT_FRAME]), .err_parity_o(events_o[`MB_EVENT_PARITY]),
    .err_framing_o(events_o[`MB_EVENT_FRAMING]), .err_overrun_o(events_o[`MB_EVENT_OVERRUN]),
    .err_crc_o(events_o[`MB_EVENT_CRC]), .err_short_o(events_o[`MB_EVENT_SHORT]),
    .err_long_o(events_o[`MB_EVENT_LONG]), .err_gap_o(events_o[`MB_EVENT_GAP])
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
