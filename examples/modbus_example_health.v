// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_health - a slave whose input registers 0 to 7 are the words of modbus_line_health.
//
// A master reads with function code 04 how the line is; rtl/line/modbus_line_health.v says what each word holds.  Each 1
// that is written to coil 0 sets the words to 0.  The holding registers come out and are free for any use.
// The beats of input registers go to modbus_line_health, all others to modbus_bank_io, which also judges the ranges.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 1
`define MB_WORDS_DEFAULT 8

module modbus_example_health #(
`include "modbus_settings.vh"
  ,
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
  output wire        alive_o
);

  generate
    if (INPUT_COUNT != 8 || INPUT_BASE != 0 || COIL_COUNT < 1 || COIL_BASE != 0 || OVERLAY != 0) begin : gen_tables
      ERROR_modbus_example_health_has_coil_0_and_the_input_registers_0_to_7 illegal_parameter ();
    end
  endgenerate

`include "modbus_settings_value.vh"
`include "modbus_bank_wires.vh"
`include "modbus_table_codes.vh"

  wire [`MB_EVENTS_WIDTH-1:0] events;
  wire rx_active;

  // The user port, the status port and write_stb_o are left alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(SETTINGS),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(events), .alive_o(alive_o), .rx_active_o(rx_active), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );

  // Input registers are the words, a 1 to coil 0 clears them.
  wire        of_health = (wb_adr[18:16] == `MB_SPACE_INPUTS);
  wire        clear     = wb_stb & wb_we & wb_ack & (wb_adr == {`MB_SPACE_COILS, 16'd0}) & wb_write[0];
  wire [15:0] word, item;
  wire        word_ack, item_ack;

  modbus_line_health u_health (
    .clk_i(clk_i), .rst_i(rst_i), .clear_i(clear), .rxd_i(rxd_i), .de_i(de_o), .rx_active_i(rx_active),
    .events_i(events), .settings_i(SETTINGS), .stb_i(wb_stb & of_health), .adr_i(wb_adr[2:0]), .dat_o(word),
    .ack_o(word_ack)
  );

  modbus_bank_io #(
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .coils_o(coils_o), .discretes_i({DISCRETE_WIDTH{1'b0}}),
    .inputs_i({INPUT_WIDTH{1'b0}}), .holdings_o(holdings_o),
    .grant_req_i(grant_req), .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last),
    .grant_write_i(grant_write), .grant_file_i(grant_file), .grant_ack_o(grant_ack), .exception_o(exception),
    .wb_cyc_i(wb_cyc), .wb_stb_i(wb_stb & ~of_health), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write),
    .wb_dat_o(item), .wb_ack_o(item_ack), .wb_err_o(wb_err)
  );
  // verilator lint_on PINCONNECTEMPTY

  assign wb_ack  = of_health ? wb_stb & word_ack : item_ack;
  assign wb_read = of_health ? word : item;

endmodule

`default_nettype wire
