// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_live - the drop-in slave as the live device runs it: switches it does not offer are tied off.
//
// USER_FUNCTIONS = 1 puts modbus_example_user on the user port: function codes 41H, 42H, 64H.
//
// Every input passes a register. That changes nothing on the line but one clock of delay, and lets the
// compiled model evaluate the logic behind the inputs once a clock instead of twice.

`default_nettype none

module modbus_live #(
  parameter CLK_HZ = 1843200,
  parameter MAX_READ_REGISTERS = 125, MAX_WRITE_REGISTERS = 123,
  parameter COIL_BASE = 0,     COIL_COUNT = 1024,
  parameter DISCRETE_BASE = 0, DISCRETE_COUNT = 2048,
  parameter INPUT_BASE = 0,    INPUT_COUNT = 1024,
  parameter HOLDING_BASE = 0,  HOLDING_COUNT = 2048,
  parameter FILE_COUNT = 4,    FILE_RECORDS = 256,
  parameter USER_FUNCTIONS = 0,
  parameter [127:0]  SERVER_ID = 128'h09,
  parameter          SERVER_ID_BYTES = 1,
  parameter [1999:0] ADDITIONAL_DATA = 2000'd0,
  parameter          ADDITIONAL_DATA_BYTES = 0,
  parameter [1951:0] VENDOR_NAME = "VENDOR",
  parameter [1951:0] PRODUCT_CODE = "PRODUCT",
  parameter [1951:0] REVISION = "V1.0",
  parameter [1951:0] VENDOR_URL = "",
  parameter [1951:0] PRODUCT_NAME = "",
  parameter [1951:0] MODEL_NAME = "",
  parameter [1951:0] USER_APPLICATION_NAME = "",
  parameter [4095:0] PRIVATE_OBJECTS = 4096'd0,
  parameter [7:0]    CONFORMITY = 8'h81,
  parameter          DEVICE_ID_LIMIT = 253
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
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,

  // Initial contents, written by the bridge
  input  wire        host_stb_i,
  input  wire [18:0] host_adr_i,
  input  wire [15:0] host_dat_i,
  output wire        host_ack_o,
  output wire        host_err_o
);

  localparam [127:0] USER_CODES = (USER_FUNCTIONS != 0) ? 128'h00000010_00000006_00000000_00000000 : 128'd0;
  // Time stands still once the line has been idle for 20 ms: a job must be done before.
  localparam integer WORK_CLOCKS = CLK_HZ / 100;

  reg         rst_q = 1'b1;
  reg         rxd_q = 1'b1;
  reg  [7:0]  address_q  = 8'd0;
  reg  [15:0] bit_time_q = 16'd8;
  reg  [1:0]  format_q   = 2'd0;
  reg         busy_q     = 1'b0;
  reg  [3:0]  failure_q  = 4'd0;
  reg  [7:0]  exception_status_q = 8'd0;
  reg         run_indicator_q    = 1'b0;
  reg  [15:0] diagnostic_q       = 16'd0;
  reg         host_stb_q = 1'b0;
  reg  [18:0] host_adr_q = 19'd0;
  reg  [15:0] host_dat_q = 16'd0;

  always @(posedge clk_i) begin
    rst_q      <= rst_i;
    rxd_q      <= rxd_i;
    address_q  <= address_i;
    bit_time_q <= bit_time_i;
    format_q   <= format_i;
    busy_q     <= busy_i;
    failure_q  <= failure_i;
    exception_status_q <= exception_status_i;
    run_indicator_q    <= run_indicator_i;
    diagnostic_q       <= diagnostic_i;
    host_stb_q <= host_stb_i;
    host_adr_q <= host_adr_i;
    host_dat_q <= host_dat_i;
  end

  wire       user_req, user_put, user_done, user_pass;
  wire [7:0] user_count, user_adr, user_request, user_answer;
  wire [3:0] user_exception;

  generate
    if (USER_FUNCTIONS != 0) begin : gen_user
      modbus_example_user #(.WORK_CLOCKS(WORK_CLOCKS)) u_user (
        .clk_i(clk_i), .rst_i(rst_q), .user_req_i(user_req), .user_count_i(user_count), .user_adr_o(user_adr),
        .user_dat_i(user_request), .user_put_o(user_put), .user_dat_o(user_answer), .user_done_o(user_done),
        .user_pass_o(user_pass), .user_exception_o(user_exception)
      );
    end else begin : gen_no_user
      assign {user_adr, user_put, user_answer, user_done, user_pass, user_exception} = 23'd0;
      // Nothing is offered without a bit in USER_CODES:
      // verilator lint_off UNUSED
      wire [16:0] no_user = {user_req, user_count, user_request};
      // verilator lint_on UNUSED
    end
  endgenerate

  // verilator lint_off PINCONNECTEMPTY
  // Outputs for a host are open: the device has none.
  modbus_rtu_slave #(
    .CLK_HZ(CLK_HZ), .USER_CODES(USER_CODES),
    .MAX_READ_REGISTERS(MAX_READ_REGISTERS), .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS),
    .COIL_BASE(COIL_BASE), .COIL_COUNT(COIL_COUNT), .DISCRETE_BASE(DISCRETE_BASE), .DISCRETE_COUNT(DISCRETE_COUNT),
    .INPUT_BASE(INPUT_BASE), .INPUT_COUNT(INPUT_COUNT), .HOLDING_BASE(HOLDING_BASE), .HOLDING_COUNT(HOLDING_COUNT),
    .FILE_COUNT(FILE_COUNT), .FILE_RECORDS(FILE_RECORDS), .SERVER_ID(SERVER_ID), .SERVER_ID_BYTES(SERVER_ID_BYTES),
    .ADDITIONAL_DATA(ADDITIONAL_DATA), .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES), .VENDOR_NAME(VENDOR_NAME),
    .PRODUCT_CODE(PRODUCT_CODE), .REVISION(REVISION), .VENDOR_URL(VENDOR_URL), .PRODUCT_NAME(PRODUCT_NAME),
    .MODEL_NAME(MODEL_NAME), .USER_APPLICATION_NAME(USER_APPLICATION_NAME), .PRIVATE_OBJECTS(PRIVATE_OBJECTS),
    .CONFORMITY(CONFORMITY), .DEVICE_ID_LIMIT(DEVICE_ID_LIMIT)
  ) u_slave (
    .clk_i(clk_i), .rst_i(rst_q), .rxd_i(rxd_q), .txd_o(txd_o), .de_o(de_o),
    .address_i(address_q), .bit_time_i(bit_time_q), .format_i(format_q), .broadcast_en_i(1'b1),
    .gap_count_only_i(1'b0), .strict_turnaround_i(1'b0), .response_delay_i(12'd0), .stall_limit_i(16'd0),
    .de_lead_i(4'd0), .de_tail_i(4'd0), .busy_i(busy_q), .failure_i(failure_q),
    .exception_status_i(exception_status_q), .run_indicator_i(run_indicator_q), .diagnostic_i(diagnostic_q),
    .write_lock_i(1'b0), .host_cyc_i(host_stb_q), .host_stb_i(host_stb_q), .host_we_i(host_stb_q),
    .host_adr_i(host_adr_q), .host_dat_i(host_dat_q), .host_dat_o(), .host_ack_o(host_ack_o), .host_err_o(host_err_o),
    .user_req_o(user_req), .user_count_o(user_count), .user_adr_i(user_adr), .user_dat_o(user_request),
    .user_put_i(user_put), .user_dat_i(user_answer), .user_done_i(user_done), .user_pass_i(user_pass),
    .user_exception_i(user_exception), .listen_only_o(), .diagnostic_register_o(), .log_count_o(),
    .counter_stb_i(1'b0), .counter_adr_i(7'd0), .counter_dat_o(), .counter_ack_o(), .write_stb_o(), .write_space_o(),
    .write_first_o(), .write_last_o(), .write_file_o(), .alive_o(), .rx_active_o(), .frame_stb_o(), .err_parity_o(),
    .err_framing_o(), .err_overrun_o(), .err_crc_o(), .err_short_o(), .err_long_o(), .err_gap_o()
  );
  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
