// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_auto - a slave that finds rate and format of its line by itself: modbus_auto_line beside the core.
//
// Connect it to a transceiver; nothing of the line is set but the address.  Holding registers come out, input registers
// 0 to 2 say what was found:
//
// | Input register | Holds                                              |
// |----------------|----------------------------------------------------|
// | 0              | bit time in clocks                                 |
// | 1              | format: 0 8E1, 1 8O1, 2 8N2, 3 8N1                 |
// | 2              | 1 locked, 0 several formats fit (no answer before) |

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 0
`define MB_WORDS_DEFAULT 3

module modbus_example_auto #(
  parameter integer ADDRESS  = 1,                // 1..247
  parameter integer MIN_BAUD = 1200,             // the slowest rate that can be found
  parameter integer RUN_BITS = 8,                // 2^RUN_BITS words for the runs of a frame
  parameter integer SNAP     = 1,                // 1: a rate within 2 % of a standard one is taken for that
  parameter integer BAD_FRAMES = 1,              // bad frames in a row that end the lock, 1..255
`include "modbus_tables.vh"
  ,
`include "modbus_table_widths.vh"
  ,
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high; 0 if there is no reset

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  output wire [COIL_WIDTH-1:0]    coils_o,
  output wire [HOLDING_WIDTH-1:0] holdings_o,
  output wire [15:0] bit_time_o,
  output wire [1:0]  format_o,
  output wire        locked_o,
  output wire        alive_o,
  output wire [`MB_EVENTS_WIDTH-1:0] events_o    // strobes MB_EVENT_*
);

  generate
    if (ADDRESS < 1 || ADDRESS > 247) begin : gen_address
      ERROR_modbus_ADDRESS_from_1_to_247 illegal_parameter ();
    end
    if (INPUT_COUNT != 3 || INPUT_BASE != 0) begin : gen_inputs
      ERROR_modbus_example_auto_has_the_input_registers_0_to_2 illegal_parameter ();
    end
  endgenerate

`include "modbus_bank_wires.vh"
`include "modbus_table_codes.vh"

  wire rxd, idle;
  wire [INPUT_WIDTH-1:0] found = {15'd0, locked_o, 14'd0, format_o, bit_time_o};

  modbus_auto_line #(
    .CLK_HZ(CLK_HZ), .MIN_BAUD(MIN_BAUD), .RUN_BITS(RUN_BITS), .BAD_FRAMES(BAD_FRAMES), .GLITCH_FILTER(GLITCH_FILTER)
  ) u_auto_line (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .rxd_o(rxd), .de_i(de_o), .idle_i(idle),
    .frame_stb_i(events_o[`MB_EVENT_FRAME]), .bit_time_o(bit_time_o), .format_o(format_o),
    .snap_i(SNAP != 0), .address_i(ADDRESS[7:0]), .mask_i(8'd0), .locked_o(locked_o)
  );

  // The user port, the status port and write_stb_o are left alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd), .txd_o(txd_o), .de_o(de_o), .settings_i(`MB_LINE_SETTINGS(ADDRESS[7:0], bit_time_o, format_o)),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(events_o), .alive_o(alive_o), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(idle),
`include "modbus_bank_core_inst.vh"
  );

  modbus_bank_io #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .coils_o(coils_o), .discretes_i({DISCRETE_WIDTH{1'b0}}),
    .inputs_i(found), .holdings_o(holdings_o),
`include "modbus_bank_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
