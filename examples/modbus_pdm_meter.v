// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_pdm_meter - the Modbus side of a PDM electric power meter: a whole device made of the parts of this core.
//
// | Master sees                 | Function codes | It is here                                                        |
// |-----------------------------|----------------|-------------------------------------------------------------------|
// | DI1.. from bit 0000         | 02             | di_i, any wires: synchronised here, looked at when read           |
// | DO1.. from bit 0000         | 01 05          | do_o: relays, open after reset                                    |
// | settings from register 0000 | 03 06 10       | RAM, also for the host                                            |
// | measured values behind them | 03             | RAM that the host fills; a write from the line is exception 02    |
// | event record at 0001        | 03, quantity 1 | modbus_pdm_record, fed by event_*; left out with EVENT_RECORD = 0 |
//
// At most 50 registers are read and 60 written at once; every other function code is exception 01.  A model without
// inputs or without relays (DI_COUNT, DO_COUNT 0) has not their function codes either.
//
// It shows three things to copy: two banks behind one core, live wires and RAM, chosen by the space of the access;
// a function of one's own in front of a built-in one; and inputs of the core that no switch sets, tied.
//
// The host reaches the registers by their address on the line, Wishbone B4 classic; see modbus_bank_ram.  A
// value of two registers, such as an energy, is never torn if both are written under one host_cyc_i.

`default_nettype none
`include "modbus_defs.vh"

module modbus_pdm_meter #(
  parameter integer CLK_HZ           = 50000000,  // clk_i in hertz
  parameter integer T15_MIN_US       = 750,       // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US       = 1750,      // floor of t3.5 in microseconds, 0: none
  parameter integer DI_COUNT         = 4,         // inputs, 0..65536
  parameter integer DO_COUNT         = 2,         // relays, 0..65536
  parameter integer SETTING_COUNT    = 256,       // registers from 0000 on that the line may write, 1 or more
  parameter integer MEASURED_COUNT   = 256,       // registers behind them, 0 or more; 65536 in all
  parameter integer EVENT_RECORD     = 1,         // 1: reading one register at 0001 answers an event record
  parameter integer EVENT_DEPTH      = 32,        // unread records, a power of 2 from 4 to 1024
  parameter integer ALIVE_TIMEOUT_MS = 0,         // alive_o falls so long after the last frame for us, 0: never
  parameter integer DI_WIDTH = (DI_COUNT > 0) ? DI_COUNT : 1,       // derived, leave alone
  parameter integer DO_WIDTH = (DO_COUNT > 0) ? DO_COUNT : 1
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Configuration: what the meter's menu sets, while the line is idle
  input  wire [7:0]  address_i,                  // 1..247
  input  wire [15:0] bit_time_i,                 // clocks per bit, 8..65535
  input  wire [1:0]  format_i,                   // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  input  wire        busy_i,                     // 1: exception 06 where nothing else is wrong

  // Inputs and relays
  input  wire [DI_WIDTH-1:0] di_i,               // asynchronous; bit 0 is DI1
  output wire [DO_WIDTH-1:0] do_o,               // bit 0 is DO1; 1 closed

  // Registers, for the measuring and the setting logic: Wishbone B4 classic slave
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [15:0] host_adr_i,                 // register, as on the line
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o,                 // no such register

  // Events: hold everything from event_stb_i to event_ack_o
  input  wire        event_stb_i,
  input  wire [7:0]  event_group_i,
  input  wire [7:0]  event_code_i,
  input  wire        event_closed_i,             // 1 closed, 0 open
  input  wire [15:0] event_ms_i,                 // within the minute, 0..59999
  input  wire [7:0]  event_minute_i,
  input  wire [7:0]  event_hour_i,
  input  wire [7:0]  event_day_i,
  input  wire [7:0]  event_month_i,
  input  wire [7:0]  event_year_i,               // since 2000
  output wire        event_ack_o,                // strobe: taken

  // What happened: strobes of one clock, but alive_o and rx_active_o
  output wire        write_stb_o,                // the line has written:
  output wire [2:0]  write_space_o,              //   0 relays, 3 settings, valid with write_stb_o
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire        alive_o,                    // level : a master talks to us
  output wire        rx_active_o,                // level : a frame is being received
  output wire        frame_stb_o,                // good frame, for whomever
  output wire        err_parity_o,               // bad frames, when they end
  output wire        err_framing_o,
  output wire        err_overrun_o,
  output wire        err_crc_o,
  output wire        err_short_o,
  output wire        err_long_o,
  output wire        err_gap_o
);

  generate
    if (SETTING_COUNT < 1 || MEASURED_COUNT < 0 || SETTING_COUNT + MEASURED_COUNT > 65536) begin : gen_registers
      ERROR_modbus_pdm_meter_SETTING_COUNT_from_1_and_65536_registers_in_all illegal_parameter ();
    end
    if (DI_COUNT < 0 || DI_COUNT > 65536 || DO_COUNT < 0 || DO_COUNT > 65536) begin : gen_bits
      ERROR_modbus_pdm_meter_DI_COUNT_and_DO_COUNT_from_0_to_65536 illegal_parameter ();
    end
  endgenerate

  // PDM meter protocol, 1.2 and 1.3
  localparam [127:0] CODES = `MB_BIT(`MB_FC_READ_HOLDING_REGISTERS) | `MB_BIT(`MB_FC_WRITE_SINGLE_REGISTER)
                           | `MB_BIT(`MB_FC_WRITE_MULTIPLE_REGISTERS)
                           | ((DO_COUNT > 0) ? `MB_BIT(`MB_FC_READ_COILS) | `MB_BIT(`MB_FC_WRITE_SINGLE_COIL) : 128'd0)
                           | ((DI_COUNT > 0) ? `MB_BIT(`MB_FC_READ_DISCRETE_INPUTS) : 128'd0);
  localparam [127:0] OFFERED = (EVENT_RECORD != 0) ? `MB_BIT(`MB_FC_READ_HOLDING_REGISTERS) : 128'd0;
  localparam integer MOST_READ = 50, MOST_WRITTEN = 60;
  // A host that never lets go of the registers does not silence the meter.
  localparam [15:0]  STALL_BITS = 16'd200;

`include "modbus_bank_wires.vh"

  wire        user_req, user_put, user_done, user_pass;
  wire [7:0]  user_count, user_adr, user_request, user_answer;
  wire [3:0]  user_exception;
  wire [`MB_USER_REPLY_WIDTH-1:0] user_reply;
  wire [`MB_HOST_STATE_WIDTH-1:0] host_state;
  wire [`MB_EVENTS_WIDTH-1:0]     events;
  reg  [`MB_SETTINGS_WIDTH-1:0]   settings;

  assign user_reply[`MB_USER_PUT]       = user_put;
  assign user_reply[`MB_USER_DATA]      = user_answer;
  assign user_reply[`MB_USER_DONE]      = user_done;
  assign user_reply[`MB_USER_PASS]      = user_pass;
  assign user_reply[`MB_USER_EXCEPTION] = user_exception;

  assign host_state[`MB_HOST_BUSY]             = busy_i;
  assign host_state[`MB_HOST_RUN]              = 1'b1;
  assign host_state[`MB_HOST_FAILURE]          = 4'd0;
  assign host_state[`MB_HOST_EXCEPTION_STATUS] = 8'd0;
  assign host_state[`MB_HOST_DIAGNOSTIC]       = 15'd0;
  assign host_state[`MB_HOST_UNIT_OURS]        = 1'b0;

  always @* begin
    settings = `MB_LINE_SETTINGS(address_i, bit_time_i, format_i);
    settings[`MB_SET_STALL_LIMIT] = STALL_BITS;
    settings[`MB_SET_DE_LEAD]     = 4'd0;
  end

  assign frame_stb_o   = events[`MB_EVENT_FRAME];
  assign err_parity_o  = events[`MB_EVENT_PARITY];
  assign err_framing_o = events[`MB_EVENT_FRAMING];
  assign err_overrun_o = events[`MB_EVENT_OVERRUN];
  assign err_crc_o     = events[`MB_EVENT_CRC];
  assign err_short_o   = events[`MB_EVENT_SHORT];
  assign err_long_o    = events[`MB_EVENT_LONG];
  assign err_gap_o     = events[`MB_EVENT_GAP];

  assign write_space_o = grant_space;
  assign write_first_o = grant_first;
  assign write_last_o  = grant_last;

  // Diagnostics, identity and files are not in FUNCTION_CODES: nothing of them is built, and their ports stay open.
  // verilator lint_off PINCONNECTEMPTY
  modbus_rtu_core #(
    .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .FUNCTION_CODES(CODES), .USER_CODES(OFFERED),
    .MAX_READ_REGISTERS(MOST_READ), .MAX_WRITE_REGISTERS(MOST_WRITTEN), .ALIVE_TIMEOUT_MS(ALIVE_TIMEOUT_MS)
  ) u_core (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(host_state), .user_req_o(user_req), .user_count_o(user_count), .user_adr_i(user_adr),
    .user_dat_o(user_request), .user_reply_i(user_reply), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(),
    .status_ack_o(),
`include "modbus_bank_core_inst.vh"
    , .write_stb_o(write_stb_o),
    .events_o(events), .alive_o(alive_o), .rx_active_o(rx_active_o), .listen_only_o(), .unit_o(), .idle_o()
  );
  // verilator lint_on PINCONNECTEMPTY

  wire unused = &{1'b0, grant_file};             // there are no files

  // Two banks.  Each is asked, and sees a bus cycle, only for its own spaces; the other is silent meanwhile.
  wire        ask_bits = (grant_space[2:1] == 2'b00);       // coils and discrete inputs
  wire        use_bits = (wb_adr[18:17] == 2'b00);
  wire        bits_grant_ack, bits_wb_ack, bits_wb_err, words_grant_ack, words_wb_ack, words_wb_err;
  wire [3:0]  bits_exception, words_exception;
  wire [15:0] bits_read, words_read;

  assign grant_ack = bits_grant_ack | words_grant_ack;
  assign exception = ask_bits ? bits_exception : words_exception;
  assign wb_ack    = bits_wb_ack | words_wb_ack;
  assign wb_err    = bits_wb_err | words_wb_err;
  assign wb_read   = use_bits ? bits_read : words_read;

  generate
    if (DI_COUNT + DO_COUNT > 0) begin : gen_bits_bank
      // As modbus_sync, for all inputs at once: thousands of instances elaborate slowly.
      (* ASYNC_REG = "TRUE" *) reg [DI_WIDTH-1:0] meta_q = 0;
      (* ASYNC_REG = "TRUE" *) reg [DI_WIDTH-1:0] di_q = 0;

      always @(posedge clk_i) begin
        meta_q <= di_i;
        di_q   <= meta_q;
      end

      modbus_bank_io #(
        .COIL_COUNT(DO_COUNT), .DISCRETE_COUNT(DI_COUNT), .INPUT_COUNT(0), .HOLDING_COUNT(0)
      ) u_bits (
        .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .grant_req_i(grant_req & ask_bits),
        .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last),
        .grant_write_i(grant_write), .grant_file_i(16'd0), .grant_ack_o(bits_grant_ack), .exception_o(bits_exception),
        .wb_cyc_i(wb_cyc & use_bits), .wb_stb_i(wb_stb), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write),
        .wb_dat_o(bits_read), .wb_ack_o(bits_wb_ack), .wb_err_o(bits_wb_err), .coils_o(do_o), .discretes_i(di_q), .inputs_i(16'd0),
        // It has no registers:
        // verilator lint_off PINCONNECTEMPTY
        .holdings_o()
        // verilator lint_on PINCONNECTEMPTY
      );
    end else begin : gen_no_bits_bank
      assign {bits_grant_ack, bits_exception, bits_wb_ack, bits_wb_err, bits_read} = 23'd0;
      assign do_o = {DO_WIDTH{1'b0}};
      // There is no input to read:
      // verilator lint_off UNUSED
      wire [DI_WIDTH-1:0] no_di = di_i;
      // verilator lint_on UNUSED
    end
  endgenerate

  modbus_bank_ram #(
    .COIL_COUNT(0), .DISCRETE_COUNT(0), .INPUT_COUNT(0), .HOLDING_COUNT(SETTING_COUNT + MEASURED_COUNT),
    .READ_ONLY_BASE((MEASURED_COUNT > 0) ? SETTING_COUNT : 0), .READ_ONLY_COUNT(MEASURED_COUNT)
  ) u_words (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0), .grant_req_i(grant_req & ~ask_bits),
    .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last), .grant_file_i(16'd0),
    .grant_write_i(grant_write), .grant_ack_o(words_grant_ack), .exception_o(words_exception),
    .wb_cyc_i(wb_cyc & ~use_bits), .wb_stb_i(wb_stb), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write),
    .wb_dat_o(words_read), .wb_ack_o(words_wb_ack), .wb_err_o(words_wb_err), .host_cyc_i(host_cyc_i), .host_stb_i(host_stb_i), .host_we_i(host_we_i),
    .host_adr_i({`MB_SPACE_HOLDINGS, host_adr_i}), .host_dat_i(host_dat_i), .host_dat_o(host_dat_o),
    .host_ack_o(host_ack_o), .host_err_o(host_err_o)
  );

  generate
    if (EVENT_RECORD != 0) begin : gen_record
      modbus_pdm_record #(.DEPTH(EVENT_DEPTH)) u_record (
        .clk_i(clk_i), .rst_i(rst_i), .busy_i(busy_i), .failure_i(4'd0), .event_stb_i(event_stb_i),
        .event_group_i(event_group_i), .event_code_i(event_code_i), .event_closed_i(event_closed_i),
        .event_ms_i(event_ms_i), .event_minute_i(event_minute_i), .event_hour_i(event_hour_i),
        .event_day_i(event_day_i), .event_month_i(event_month_i), .event_year_i(event_year_i),
        .event_ack_o(event_ack_o), .user_req_i(user_req), .user_count_i(user_count), .user_adr_o(user_adr),
        .user_dat_i(user_request), .user_put_o(user_put), .user_dat_o(user_answer), .user_done_o(user_done),
        .user_pass_o(user_pass), .user_exception_o(user_exception)
      );
    end else begin : gen_no_record
      assign {user_adr, user_put, user_answer, user_done, user_pass, user_exception} = 23'd0;
      assign event_ack_o = event_stb_i;          // taken, and forgotten
      // Nobody asks for a record:
      // verilator lint_off UNUSED
      wire [81:0] no_record = {user_req, user_count, user_request, event_group_i, event_code_i, event_closed_i,
                               event_ms_i, event_minute_i, event_hour_i, event_day_i, event_month_i};
      wire [7:0]  no_year = event_year_i;
      // verilator lint_on UNUSED
    end
  endgenerate

endmodule

`default_nettype wire
