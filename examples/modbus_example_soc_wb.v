// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_soc_wb - a SoC whose Wishbone bus has two masters, the Modbus core and a CPU: a pattern to copy.
//
// The Wishbone port of the core is the master.  modbus_bank_guard, which knows the map, answers its grant question.
// The cpu_* port is that of the CPU; modbus_example_ram stands for everything on the bus.
//
// The arbiter is one flip-flop: a master that has the bus keeps it while its cyc is high.  So all that a request does on the
// bus is one piece for the CPU, and what the CPU does under one cpu_cyc_i is one piece for the line.  A CPU whose cyc
// never falls keeps the line waiting until the stall limit; one whose cyc falls between its accesses waits for one request
// at most.

`default_nettype none
`include "modbus_defs.vh"

module modbus_example_soc_wb #(
  parameter integer CLK_HZ     = 50000000,       // clk_i in hertz
  parameter integer T15_MIN_US = 750,            // floor of t1.5 in microseconds
  parameter integer T35_MIN_US = 1750,           // floor of t3.5 in microseconds
  parameter integer WORDS      = 128             // holding registers, and as many input registers
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,                 // clocks per bit
  input  wire [1:0]  format_i,                   // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  input  wire [15:0] stall_limit_i,              // bit times the bus may be silent: never 0 in a SoC

  // CPU: Wishbone B4 classic slave
  input  wire        cpu_cyc_i,
  input  wire        cpu_stb_i,
  input  wire        cpu_we_i,
  input  wire [18:0] cpu_adr_i,                  // {space, item}
  input  wire [15:0] cpu_dat_i,
  output wire [15:0] cpu_dat_o,
  output wire        cpu_ack_o,
  output wire        cpu_err_o,

  // Board
  input  wire [7:0]  switches_i,
  output wire [7:0]  lamps_o
);

  // The example has no use for some outputs of the core.
  // verilator lint_off PINCONNECTEMPTY

  // Every function code but those of files
  localparam [127:0] CODES = `MB_ALL_FUNCTIONS & ~`MB_FILE_FUNCTIONS;

`include "modbus_bank_wires.vh"

  wire [`MB_SETTINGS_WIDTH-1:0] usual = `MB_LINE_SETTINGS(address_i, bit_time_i, format_i);
  reg  [`MB_SETTINGS_WIDTH-1:0] settings;

  always @* begin
    settings = usual;
    settings[`MB_SET_STALL_LIMIT] = stall_limit_i;
  end

  modbus_rtu_core #(
    .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .FUNCTION_CODES(CODES)
  ) u_modbus (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(), .alive_o(), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );

  // What exists, for the line
  wire refused;
  wire unused = refused;                         // exception says it

  modbus_bank_guard #(
    .COIL_COUNT(8), .DISCRETE_COUNT(8), .INPUT_COUNT(WORDS), .HOLDING_COUNT(WORDS)
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .req_i(grant_req), .space_i(grant_space), .first_i(grant_first),
    .last_i(grant_last), .write_i(grant_write), .file_i(grant_file), .flat_i(1'b0), .other_i(1'b0), .wait_i(1'b0),
    .ack_o(grant_ack), .refused_o(refused), .exception_o(exception)
  );

  // Arbiter
  reg line_q = 1'b0;                             // the bus is the core's
  always @(posedge clk_i) line_q <= wb_cyc & (line_q | ~cpu_cyc_i) & ~rst_i;

  wire [15:0] ram_read;
  wire        ram_ack, ram_err;

  modbus_example_ram #(.WORDS(WORDS)) u_ram (
    .clk_i(clk_i), .rst_i(rst_i),
    .wb_cyc_i(line_q ? wb_cyc : cpu_cyc_i), .wb_stb_i(line_q ? wb_stb : cpu_stb_i), .wb_we_i(line_q ? wb_we : cpu_we_i),
    .wb_adr_i(line_q ? wb_adr : cpu_adr_i), .wb_dat_i(line_q ? wb_write : cpu_dat_i), .wb_dat_o(ram_read),
    .wb_ack_o(ram_ack), .wb_err_o(ram_err), .switches_i(switches_i), .lamps_o(lamps_o)
  );

  assign wb_read   = ram_read;
  assign wb_ack    = ram_ack & line_q;
  assign wb_err    = ram_err & line_q;
  assign cpu_dat_o = ram_read;
  assign cpu_ack_o = ram_ack & ~line_q;
  assign cpu_err_o = ram_err & ~line_q;

  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
