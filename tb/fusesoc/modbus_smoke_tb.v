// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_smoke_tb - one write and one read at the pins of the drop-in, answers checked.
//
// A smoke test in plain Verilog for whoever has no Python: write 1234H to holding register 3 (function
// code 06), read registers 2 to 4 (03), compare every byte of both answers.  115200 baud, 8E1.
// Not a regression: that is tb/ with cocotb.

`default_nettype none
`timescale 1ns / 1ps

module modbus_smoke_tb;

  localparam CLK_HZ   = 1843200;
  localparam BIT_TIME = 16;                  // clocks a bit: 115200 baud
  localparam ADDRESS  = 8'h11;
  localparam SILENCE  = 300 * BIT_TIME;      // more than t3.5, which is 1750 us here
  localparam PATIENCE = 400 * BIT_TIME;      // clocks without a start bit until an answer counts as missing

  reg clk = 1'b0;
  reg rst = 1'b1;
  reg rxd = 1'b1;
  wire txd, de;
  always #271 clk = !clk;

  modbus_rtu_slave #(.CLK_HZ(CLK_HZ), .BAUD(CLK_HZ / BIT_TIME), .ADDRESS(ADDRESS)) u_dut (
    .clk_i(clk), .rst_i(rst), .rxd_i(rxd), .txd_o(txd), .de_o(de), .host_cyc_i(1'b0), .host_stb_i(1'b0),
    .host_we_i(1'b0), .host_adr_i(19'd0), .host_dat_i(16'd0), .host_dat_o(), .host_ack_o(), .host_err_o(),
    .write_stb_o(), .write_space_o(), .write_first_o(), .write_last_o(), .write_file_o(), .alive_o()
  );

  integer failures = 0;
  reg [7:0]  expected [0:15];                // the answer without its CRC
  reg [15:0] crc;

  // CRC-16 of MODBUS over Serial Line V1.02, clause 6.2.2.
  task crc_add(input [7:0] value);
    integer k;
    begin
      crc = crc ^ {8'h00, value};
      for (k = 0; k < 8; k = k + 1) crc = crc[0] ? (crc >> 1) ^ 16'hA001 : crc >> 1;
    end
  endtask

  task send(input [7:0] value);
    integer k;
    reg [10:0] character;                    // start, eight data, even parity, stop; bit 0 first
    begin
      character = {1'b1, ^value, value, 1'b0};
      for (k = 0; k < 11; k = k + 1) begin
        rxd = character[k];
        repeat (BIT_TIME) @(posedge clk);
      end
    end
  endtask

  // The six bytes of a request, first one in the top bits, and its CRC.
  task request(input [47:0] bytes);
    integer k;
    begin
      crc = 16'hFFFF;
      for (k = 5; k >= 0; k = k - 1) begin
        crc_add(bytes[8 * k +: 8]);
        send(bytes[8 * k +: 8]);
      end
      send(crc[7:0]);
      send(crc[15:8]);
    end
  endtask

  task receive(output [7:0] value);
    integer k;
    begin
      k = 0;
      while (txd && k < PATIENCE) begin
        @(posedge clk);
        k = k + 1;
      end
      if (txd) begin
        $display("FAIL: no answer");
        $finish_and_return(1);               // Icarus only: Verilog-2005 has no exit status
      end
      if (!de) begin
        $display("FAIL: driver off while sending");
        failures = failures + 1;
      end
      repeat (BIT_TIME / 2) @(posedge clk);
      for (k = 0; k < 8; k = k + 1) begin
        repeat (BIT_TIME) @(posedge clk);
        value[k] = txd;
      end
      repeat (BIT_TIME) @(posedge clk);
      if (txd != ^value) begin
        $display("FAIL: parity of %h", value);
        failures = failures + 1;
      end
      repeat (BIT_TIME) @(posedge clk);
      if (!txd) begin
        $display("FAIL: stop bit after %h", value);
        failures = failures + 1;
      end
    end
  endtask

  task receive_and_compare(input [7:0] value);
    reg [7:0] got;
    begin
      receive(got);
      if (got !== value) begin
        $display("FAIL: answer has %h where %h was expected", got, value);
        failures = failures + 1;
      end
    end
  endtask

  task answer(input integer length);
    integer k;
    begin
      crc = 16'hFFFF;
      for (k = 0; k < length; k = k + 1) begin
        crc_add(expected[k]);
        receive_and_compare(expected[k]);
      end
      receive_and_compare(crc[7:0]);
      receive_and_compare(crc[15:8]);
      repeat (SILENCE) @(posedge clk);            // the line rests
    end
  endtask

  initial begin
    repeat (4) @(posedge clk);
    rst = 1'b0;
    repeat (SILENCE) @(posedge clk);            // the slave wants to see the line silent first

    request({ADDRESS, 8'h06, 16'h0003, 16'h1234});
    {expected[0], expected[1], expected[2], expected[3], expected[4], expected[5]} =
      {ADDRESS, 8'h06, 16'h0003, 16'h1234};
    answer(6);

    request({ADDRESS, 8'h03, 16'h0002, 16'h0003});
    {expected[0], expected[1], expected[2]} = {ADDRESS, 8'h03, 8'h06};
    {expected[3], expected[4], expected[5], expected[6], expected[7], expected[8]} = 48'h0000_1234_0000;
    answer(9);

    if (failures != 0) begin
      $display("FAIL: %0d differences", failures);
      $finish_and_return(1);
    end
    $display("PASS: one write and one read answered as expected");
    $finish;
  end

endmodule

`default_nettype wire
