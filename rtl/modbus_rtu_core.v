// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_core - Modbus RTU slave (server) without memory: a line, a grant question, a Wishbone master.
//
// modbus_line turns the pins into frames and back, modbus_engine turns a frame into an answer.  A request is received
// whole, judged, granted, executed, answered.  Nothing outside is touched before t3.5 has passed and the frame is
// good.  Before the first access the core asks the bank for a range of items; the bank grants it or answers with an
// exception code.  Then follows one burst under wb_cyc_o: several under one for 14H to 18H, see docs/parameters.md.
// modbus_bank_ram and modbus_bank_io are banks for this interface; your own bank has the same ports.

`default_nettype none
`include "modbus_defs.vh"

module modbus_rtu_core #(
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high
  input  wire [`MB_SETTINGS_WIDTH-1:0] settings_i,       // fields MB_SET_*; constants, or changed while idle_o is high
  output wire [`MB_EVENTS_WIDTH-1:0]   events_o,         // strobes MB_EVENT_*
  output wire        rx_active_o,                // level : a frame is being received
  output wire        alive_o,                    // level : a master talks to us
  output wire        idle_o,                     // level : nothing is received, worked on or sent
  output wire [7:0]  unit_o,                     // level : address of the request, 0 broadcast, with UNIT_SET or UNIT_PORT

`include "modbus_engine_ports.vh"
);

  wire [`MB_FRAME_WIDTH-1:0]   frame;
  wire [`MB_RAM_WIDTH-1:0]     ram_do;
  wire [`MB_VERDICT_WIDTH-1:0] verdict;
  wire [7:0]                   rx_byte, frame_byte;
  wire [8:0]                   count;
  wire                         sending, bank_waits, stall;

  modbus_line #(
    .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .MAX_BIT_TIME(MAX_BIT_TIME),
    .BIT_FRACTIONS(BIT_FRACTIONS), .GLITCH_FILTER(GLITCH_FILTER), .UNIT_SET(UNIT_SET), .UNIT_PORT(UNIT_PORT),
    .ASCII_MODE(ASCII_MODE), .ASCII_TIMEOUT_MS(ASCII_TIMEOUT_MS)
  ) u_line (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings_i),
    .frame_o(frame), .ram_do_o(ram_do), .rx_byte_o(rx_byte), .unit_o(unit_o),
    .unit_ours_i(host_state_i[`MB_HOST_UNIT_OURS]), .rx_active_o(rx_active_o), .frame_byte_i(frame_byte),
    .count_i(count), .verdict_i(verdict), .sending_o(sending), .bank_waits_i(bank_waits), .stall_o(stall),
    .events_o(events_o), .idle_o(idle_o)
  );

  modbus_engine #(
    .FUNCTION_CODES(FUNCTION_CODES),
`include "modbus_config_inst.vh"
  ) u_engine (
    .clk_i(clk_i), .rst_i(rst_i), .frame_i(frame), .ram_do_i(ram_do), .rx_byte_i(rx_byte), .rx_active_i(rx_active_o),
    .frame_byte_o(frame_byte), .count_o(count), .verdict_o(verdict), .sending_i(sending), .bank_waits_o(bank_waits),
    .stall_i(stall),
`include "modbus_engine_ports_inst.vh"
  );

  modbus_alive #(.CLK_HZ(CLK_HZ), .TIMEOUT_MS(ALIVE_TIMEOUT_MS)) u_alive (
    .clk_i(clk_i), .rst_i(rst_i), .frame_stb_i(frame[`MB_FRAME_GOOD]), .alive_o(alive_o)
  );

endmodule

`default_nettype wire
