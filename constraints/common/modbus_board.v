// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_board - the demonstration that every board runs: a slave with LEDs on coils and buttons on discrete inputs.
//
// Address 17, 8E1, all function codes.  Works from power-up; there is no reset.
//
// | Table             | Items | What they are                                                                     |
// |-------------------|-------|-----------------------------------------------------------------------------------|
// | coils             | 0..15 | the first LEDS light LEDs, the others only remember                               |
// | discrete inputs   | 0..15 | the first BUTTONS are buttons, 1 while pressed; the others 0                      |
// | input registers   | 0, 1  | seconds and milliseconds since power-up, each modulo 65536                        |
// | holding registers | 0..7  | memory                                                                            |
//
// The two receivers are both heard: the one that is not connected must read 1, so give both a pull-up.  Only one may
// be used at a time.  The answer goes to both transmitters; de_o is for the RS-485 transceiver.

`default_nettype none

module modbus_board #(
  parameter integer CLK_HZ  = 12000000,      // clk_i in hertz, a multiple of 1000
  parameter integer BAUD    = 19200,         // CLK_HZ / 65535 to CLK_HZ / 8
  parameter integer LEDS    = 8,             // 1..15
  parameter integer BUTTONS = 2              // 1..15
) (
  input  wire               clk_i,

  // Line: asynchronous, idle 1
  input  wire               usb_rxd_i,
  input  wire               rs485_rxd_i,
  output wire               txd_o,
  output wire               de_o,            // driver enable, active high

  // Board, active high
  output wire [LEDS-1:0]    leds_o,
  input  wire [BUTTONS-1:0] buttons_i,       // asynchronous
  output wire               alive_o          // a master talked to us in the last second
);

  localparam integer TICK_CLOCKS = CLK_HZ / 1000;

  generate
    if (LEDS < 1 || LEDS > 15) begin : gen_illegal_leds
      ERROR_modbus_board_LEDS_from_1_to_15 illegal_parameter ();
    end
    if (BUTTONS < 1 || BUTTONS > 15) begin : gen_illegal_buttons
      ERROR_modbus_board_BUTTONS_from_1_to_15 illegal_parameter ();
    end
    if (TICK_CLOCKS < 2 || TICK_CLOCKS > 1048575) begin : gen_illegal_clock
      ERROR_modbus_board_CLK_HZ_from_2000_to_1048575000 illegal_parameter ();
    end
  endgenerate

  // Time since power-up
  reg [19:0] clocks_q       = 20'd0;
  reg [9:0]  thousandths_q  = 10'd0;         // of the second that runs
  reg [15:0] milliseconds_q = 16'd0;
  reg [15:0] seconds_q      = 16'd0;

  localparam [19:0] LAST_CLOCK = TICK_CLOCKS[19:0] - 20'd1;

  always @(posedge clk_i) begin
    clocks_q <= clocks_q + 20'd1;
    if (clocks_q == LAST_CLOCK) begin
      clocks_q       <= 20'd0;
      milliseconds_q <= milliseconds_q + 16'd1;
      thousandths_q  <= thousandths_q + 10'd1;
      if (thousandths_q == 10'd999) begin
        thousandths_q <= 10'd0;
        seconds_q     <= seconds_q + 16'd1;
      end
    end
  end

  // Buttons; the synchroniser starts at 1, so it is given the inverse: nothing is pressed at power-up.
  wire [BUTTONS-1:0] released;

  genvar g;
  generate
    for (g = 0; g < BUTTONS; g = g + 1) begin : gen_button
      modbus_sync u_sync (.clk_i(clk_i), .async_i(~buttons_i[g]), .sync_o(released[g]));
    end
  endgenerate

  // verilator lint_off UNUSED
  wire [15:0] coils;                         // more coils than LEDs
  // verilator lint_on UNUSED
  assign leds_o = coils[LEDS-1:0];

  // Nothing shows the holding registers.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_slave_io #(
    .CLK_HZ(CLK_HZ), .BAUD(BAUD), .ADDRESS(17), .COIL_COUNT(16), .DISCRETE_COUNT(16), .INPUT_COUNT(2), .HOLDING_COUNT(8),
    .GAP_COUNT_ONLY(1),                      // USB adapters leave gaps inside a frame
    .ALIVE_TIMEOUT_MS(1000), .PRODUCT_CODE("BOARD")
  ) u_modbus (
    .clk_i(clk_i), .rst_i(1'b0), .rxd_i(usb_rxd_i & rs485_rxd_i), .txd_o(txd_o), .de_o(de_o),
    .coils_o(coils), .discretes_i({{(16 - BUTTONS){1'b0}}, ~released}), .inputs_i({milliseconds_q, seconds_q}),
    .holdings_o(), .alive_o(alive_o)
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
