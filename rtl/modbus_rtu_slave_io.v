// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_slave_io - drop-in Modbus RTU slave with flat vectors: LEDs, relays, switches, sensors.
//
// Connect it between an RS-485 transceiver and your signals.  Coils and holding registers come out, discrete inputs
// and input registers go in; register k is [16*k +: 16], k counted from the table's base.  The settings are
// parameters.  See modbus_bank_io for when outputs change, modbus_rtu_core for settings that change at run time.
// A table of size 0 does not exist: its function codes answer exception 01 and cost nothing; leave its port open, or
// tie it to 0 if it is an input.
// With LINE_HEALTH = 1 the last eight input registers are the words of modbus_line_health, the first of them word 0, and
// their bits of inputs_i do not count.  They are 0 again when coil HEALTH_COIL, an address of the line, turns 1.

`default_nettype none
`include "modbus_defs.vh"

`define MB_BITS_DEFAULT 16
`define MB_WORDS_DEFAULT 8

module modbus_rtu_slave_io #(
  parameter integer LINE_HEALTH = 0,             // 1: the last eight input registers tell how the line is
  parameter integer HEALTH_COIL = 65536,         // the coil that clears them; 65536: none
`include "modbus_settings.vh"
  ,
`include "modbus_tables.vh"
  ,
`include "modbus_read_back.vh"
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

  // Tables
  output wire [COIL_WIDTH-1:0]     coils_o,
  input  wire [DISCRETE_WIDTH-1:0] discretes_i,  // synchronous to clk_i, like inputs_i
  input  wire [INPUT_WIDTH-1:0]    inputs_i,
  output wire [HOLDING_WIDTH-1:0]  holdings_o,

  output wire        alive_o                     // level : a master talks to us
);

  generate
    if (LINE_HEALTH < 0 || LINE_HEALTH > 1) begin : gen_line_health
      ERROR_modbus_rtu_slave_io_LINE_HEALTH_is_0_or_1 illegal_parameter ();
    end
    if (LINE_HEALTH != 0 && (INPUT_COUNT < 8 || OVERLAY != 0)) begin : gen_registers
      ERROR_modbus_rtu_slave_io_LINE_HEALTH_needs_8_input_registers_and_OVERLAY_0 illegal_parameter ();
    end
    if (LINE_HEALTH != 0 && HEALTH_COIL != 65536 &&
        (HEALTH_COIL < COIL_BASE || HEALTH_COIL >= COIL_BASE + COIL_COUNT)) begin : gen_coil
      ERROR_modbus_rtu_slave_io_HEALTH_COIL_is_a_coil_of_the_table_or_65536 illegal_parameter ();
    end
  endgenerate

`include "modbus_settings_value.vh"
`include "modbus_bank_wires.vh"

  wire [`MB_EVENTS_WIDTH-1:0] events;
  wire rx_active;

  // The function codes of a table that does not exist are left out: they answer exception 01 and cost nothing.
`include "modbus_table_codes.vh"

  // The drop-in leaves the user port and the status port alone.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .FUNCTION_CODES(TABLE_CODES), .MAX_BIT_TIME(BIT_TIME),
`include "modbus_config_inst.vh"
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(SETTINGS),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(events), .alive_o(alive_o), .rx_active_o(rx_active), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );
  // verilator lint_on PINCONNECTEMPTY

  // ------------------------------------------------------------------ line health

  localparam integer FIRST_WORD = INPUT_BASE + INPUT_COUNT - 8;
  localparam integer GIVEN_UP   = (LINE_HEALTH != 0) ? 128 : 0;  // bits of inputs_i that nobody reads any more

  wire [15:0] item, word;
  wire        item_ack, word_ack;
  wire [15:0] place     = wb_adr[15:0] - FIRST_WORD[15:0];
  wire        of_health = (LINE_HEALTH != 0) & (wb_adr[18:16] == `MB_SPACE_INPUTS) & (place[15:3] == 13'd0);

  generate
    if (LINE_HEALTH != 0) begin : gen_health
      wire coil, clear;

      if (HEALTH_COIL != 65536) begin : gen_clear
        reg coil_q = 1'b0;
        always @(posedge clk_i) coil_q <= coil & ~rst_i;
        assign coil  = coils_o[HEALTH_COIL - COIL_BASE];
        assign clear = coil & ~coil_q;
      end else begin : gen_never
        assign coil  = 1'b0;
        assign clear = coil;
      end

      modbus_line_health #(.MAX_BIT_TIME(BIT_TIME)) u_health (
        .clk_i(clk_i), .rst_i(rst_i), .clear_i(clear), .rxd_i(rxd_i), .de_i(de_o), .rx_active_i(rx_active),
        .events_i(events), .settings_i(SETTINGS), .stb_i(wb_stb & of_health), .adr_i(place[2:0]), .dat_o(word),
        .ack_o(word_ack)
      );
    end else begin : gen_no_health
      wire unused = &{1'b0, events, rx_active, place};
      assign word     = 16'd0;
      assign word_ack = 1'b0;
    end
  endgenerate

  assign wb_ack  = of_health ? wb_stb & word_ack : item_ack;
  assign wb_read = of_health ? word : item;

  // ------------------------------------------------------------------ bank

  modbus_bank_io #(
    .BITS_PER_BEAT(BITS_PER_BEAT), .READ_BACK_RAM(READ_BACK_RAM),
`include "modbus_tables_inst.vh"
  ) u_bank (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .coils_o(coils_o), .discretes_i(discretes_i),
    .inputs_i(inputs_i << GIVEN_UP >> GIVEN_UP), .holdings_o(holdings_o),
    .grant_req_i(grant_req), .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last),
    .grant_write_i(grant_write), .grant_file_i(grant_file), .grant_ack_o(grant_ack), .exception_o(exception),
    .wb_cyc_i(wb_cyc), .wb_stb_i(wb_stb & ~of_health), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write),
    .wb_dat_o(item), .wb_ack_o(item_ack), .wb_err_o(wb_err)
  );

endmodule

`default_nettype wire
