// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_rtu_core - Modbus RTU slave (server) without memory: line side, grant question, Wishbone master.
//
// Wiring only.  A request is received whole, judged, granted, carried out, answered; nothing outside is touched before
// t3.5 has passed and the frame is good.  Before the first access the core asks the bank with
// grant_req_o for a range of items; the bank answers with grant_ack_i and 0, or an exception code.
// Then follows one burst under wb_cyc_o (several under one: the halves of 16H and 17H, the groups of 14H and 15H, count
// and entries of 18H).
// modbus_bank_ram and modbus_bank_io are banks for this interface; so is whatever you write.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_rtu_core #(
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,                      // asynchronous, idle 1
  output wire        txd_o,                      // idle 1
  output wire        de_o,                       // driver enable, active high

  // Run-time settings and the host's state: fields MB_SET_* and MB_HOST_* of modbus_defs.vh.  Tie them to constants, or
  // change settings while idle_o is high.
  input  wire [`MB_SETTINGS_WIDTH-1:0]   settings_i,
  input  wire [`MB_HOST_STATE_WIDTH-1:0] host_state_i,

  // Bank: grant
  output wire        grant_req_o,                // level until grant_ack_i or the stall limit; then forget the question
  output wire [2:0]  grant_space_o,
  output wire [15:0] grant_first_o,
  output wire [15:0] grant_last_o,
  output wire        grant_write_o,
  output wire [15:0] grant_file_o,               // space 4: file number, through the burst; the items are records
  input  wire        grant_ack_i,
  input  wire [3:0]  exception_i,                // with grant_ack_i: 0 granted; with wb_err_i: 0 means 04

  // Bank: Wishbone B4 classic master
  output wire        wb_cyc_o,
  output wire        wb_stb_o,
  output wire        wb_we_o,
  output wire [18:0] wb_adr_o,                   // {space, item}
  output wire [15:0] wb_dat_o,                   // coils: bit 0, the others mean nothing
  input  wire [15:0] wb_dat_i,
  input  wire        wb_ack_i,
  input  wire        wb_err_i,

  // User functions, see docs/user_functions.md
  output wire        user_req_o,                 // level until user_done_i or the stall limit: a request for the user
  output wire [7:0]  user_count_o,               // its bytes, address included, check field not
  input  wire [7:0]  user_adr_i,                 // which of them
  output wire [7:0]  user_dat_o,                 // a clock later
  input  wire [`MB_USER_REPLY_WIDTH-1:0] user_reply_i,   // fields MB_USER_*

  // Status port: 00 diagnostic register, 01 bit 0 listen-only, 02 entries of the event log, 0AH event counter,
  // 0BH..12H counters by sub-function of 08H, 40H + n log entry n, the newest first
  input  wire        status_stb_i,               // level until status_ack_o
  input  wire [6:0]  status_adr_i,
  output wire [15:0] status_dat_o,               // valid with status_ack_o
  output wire        status_ack_o,

  // What happens
  output wire        write_stb_o,                // strobe: a write is committed: grant_space_o, _first_o, _last_o, _file_o
  output wire [`MB_EVENTS_WIDTH-1:0]     events_o,       // strobes MB_EVENT_*
  output wire        alive_o,                    // level : a master talks to us
  output wire        rx_active_o,                // level : a frame is being received
  output wire        listen_only_o,              // level : listen-only mode
  output wire        idle_o                      // level : nothing is received, worked on or sent
);

`include "modbus_features.vh"

  // TRANSITION
  wire        busy_i = host_state_i[`MB_HOST_BUSY];
  wire [3:0]  failure_i = host_state_i[`MB_HOST_FAILURE];
  wire [7:0]  exception_status_i = host_state_i[`MB_HOST_EXCEPTION_STATUS];
  wire        run_indicator_i = host_state_i[`MB_HOST_RUN];
  wire [15:0] diagnostic_i = {host_state_i[`MB_HOST_DIAGNOSTIC], 1'b0};
  wire        user_put_i = user_reply_i[`MB_USER_PUT];
  wire [7:0]  user_dat_i = user_reply_i[`MB_USER_DATA];
  wire        user_done_i = user_reply_i[`MB_USER_DONE];
  wire        user_pass_i = user_reply_i[`MB_USER_PASS];
  wire [3:0]  user_exception_i = user_reply_i[`MB_USER_EXCEPTION];
  wire        counter_stb_i = status_stb_i;
  wire [6:0]  counter_adr_i = status_adr_i;
  wire [15:0] counter_dat_o, diagnostic_register_o;
  wire [6:0]  log_count_o;
  wire        counter_ack_o;
  assign status_ack_o = counter_ack_o;
  assign status_dat_o = (status_adr_i == 7'd0) ? diagnostic_register_o : (status_adr_i == 7'd1) ? {15'd0, listen_only_o} :
                        (status_adr_i == 7'd2) ? {9'd0, log_count_o} : counter_dat_o;

  // Line
  wire [`MB_FRAME_WIDTH-1:0] frame;
  wire [`MB_RAM_WIDTH-1:0]   ram_do;
  wire [7:0] rx_byte, frame_byte, held;
  wire [8:0] count;
  wire [3:0] cursor;
  wire       send_stb, quiet_stb, restart, sending, waiting, stall;

  modbus_line #(.CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US)) u_line (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings_i),
    .frame_o(frame), .ram_do_o(ram_do), .rx_byte_o(rx_byte), .rx_active_o(rx_active_o), .frame_byte_i(frame_byte),
    .count_i(count), .verdict_i({restart, quiet_stb, send_stb}), .sending_o(sending),
    .bank_waits_i(waiting | user_req_o), .stall_o(stall), .events_o(events_o), .idle_o(idle_o)
  );

  wire good_stb  = frame[`MB_FRAME_GOOD];
  wire open_stb  = ram_do[`MB_RAM_OPEN];
  wire look_stb  = ram_do[`MB_RAM_LOOK];
  wire store_stb = ram_do[`MB_RAM_STORE];
  wire tx_step   = ram_do[`MB_RAM_NEXT];

  wire       do_point, do_clear, do_step, do_up, do_down, do_put, do_keep, do_recall, move_put, move_step;
  wire       user_put;
  wire [4:0] do_point_at;
  wire [7:0] move_data;
  wire [8:0] kept_count;

  modbus_frame_ram #(.HAS_UPPER(HAS_UPPER), .HAS_CONTEXT(HAS_CONTEXT)) u_frame_ram (
    .clk_i(clk_i),
    .point_i(open_stb | look_stb | do_point), .point_at_i((open_stb | look_stb) ? 5'd0 : do_point_at),
    .step_i(store_stb | do_step | move_put | move_step | user_put | tx_step),
    .clear_i(open_stb | do_clear), .up_i(store_stb | do_up | move_put | user_put), .down_i(do_down | move_step | tx_step),
    .keep_i(do_keep), .recall_i(do_recall), .look_i(user_req_o), .look_at_i(user_adr_i),
    .write_i(store_stb | do_put | move_put | user_put),
    .data_i(rx_active_o ? rx_byte : user_req_o ? user_dat_i : move_data),
    .byte_o(frame_byte), .cursor_o(cursor), .count_o(count), .kept_count_o(kept_count)
  );

  // Requests
  wire [8:0]  program_at, program_start, program_foreign, program_bad, program_exception, program_reset;
  wire [15:0] program_step;
  wire        do_hold, do_address, do_quantity, do_depth, do_single, do_set_first, do_set_less, do_file;
  wire        do_total_clear, do_total, do_range, do_load, do_literal, do_grant, do_burst, do_offer;
  wire        in_limit, bytes_fit, over, beyond, too_long, done, fail;
  wire [10:0] argument;
  wire [6:1]  mode;
  wire [2:0]  space;
  wire [1:0]  what;
  wire        do_write, keep, dry, mark, inner, user_done, user_fail;
  wire [3:0]  code, fail_code, user_code;
  wire [7:0]  length;
  wire [15:0] inner_data;
  wire        diag_count, diag_clear, diag_log, diag_now, diag_applies;
  wire [7:0]  diag_event;

  modbus_program #(
    .FUNCTION_CODES(FUNCTION_CODES), .USER_CODES(USER_CODES), .MAX_READ_BITS(MAX_READ_BITS),
    .MAX_WRITE_BITS(MAX_WRITE_BITS), .MAX_READ_REGISTERS(MAX_READ_REGISTERS),
    .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS), .RW_MAX_READ(RW_MAX_READ), .RW_MAX_WRITE(RW_MAX_WRITE),
    .SERVER_ID_BYTES(SERVER_ID_BYTES), .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES), .CONFORMITY(CONFORMITY)
  ) u_program (
    .clk_i(clk_i), .at_i(program_at), .step_o(program_step), .start_o(program_start),
    .foreign_o(program_foreign), .bad_o(program_bad), .exception_o(program_exception), .reset_o(program_reset)
  );

  modbus_dispatch #(.FUNCTION_CODES(FUNCTION_CODES), .USER_CODES(USER_CODES)) u_dispatch (
    .clk_i(clk_i), .rst_i(rst_i), .busy_i(busy_i), .failure_i(failure_i), .good_i(good_stb),
    .broadcast_i(frame[`MB_FRAME_BROADCAST]), .foreign_i(frame[`MB_FRAME_FOREIGN]), .bad_i(frame[`MB_FRAME_BAD]),
    .long_i(frame[`MB_FRAME_LONG]), .send_stb_o(send_stb),
    .quiet_stb_o(quiet_stb), .restart_stb_o(restart), .written_stb_o(write_stb_o),
    .sending_i(sending), .program_at_o(program_at), .program_step_i(program_step), .start_i(program_start),
    .foreign_at_i(program_foreign), .bad_at_i(program_bad), .exception_i(program_exception), .reset_i(program_reset), .byte_i(frame_byte),
    .cursor_i(cursor), .count_i(count), .point_o(do_point), .point_at_o(do_point_at), .clear_o(do_clear),
    .step_o(do_step), .up_o(do_up), .down_o(do_down), .put_o(do_put), .context_keep_o(do_keep),
    .context_recall_o(do_recall), .hold_o(do_hold), .address_o(do_address), .quantity_o(do_quantity),
    .depth_o(do_depth), .single_o(do_single), .set_first_o(do_set_first), .set_less_o(do_set_less),
    .file_o(do_file), .total_clear_o(do_total_clear), .total_o(do_total), .range_o(do_range), .load_o(do_load),
    .literal_o(do_literal), .grant_o(do_grant), .burst_o(do_burst), .argument_o(argument), .space_o(space),
    .write_o(do_write), .keep_o(keep), .dry_o(dry), .what_o(what), .mark_o(mark), .code_o(code),
    .in_limit_i(in_limit), .bytes_fit_i(bytes_fit), .over_i(over), .beyond_i(beyond), .too_long_i(too_long),
    .done_i(done), .fail_i(fail), .fail_code_i(fail_code), .held_i(held), .offer_o(do_offer),
    .user_done_i(user_done), .user_fail_i(user_fail), .user_pass_i(user_pass_i), .user_code_i(user_code),
    .diag_count_o(diag_count), .diag_clear_o(diag_clear), .diag_log_o(diag_log), .diag_event_o(diag_event),
    .diag_now_o(diag_now), .diag_applies_o(diag_applies), .mode_o(mode), .listen_only_i(listen_only_o)
  );

  modbus_data_access #(
    .HAS_BITS(HAS_BITS), .HAS_WORDS(HAS_WORDS), .HAS_MASK(HAS_MASK), .HAS_INTERNAL(HAS_INTERNAL),
    .HAS_LITERALS(HAS_LITERALS), .HAS_FILES(HAS_FILES)
  ) u_data_access (
    .clk_i(clk_i), .rst_i(rst_i), .hold_i(do_hold), .address_i(do_address), .quantity_i(do_quantity),
    .depth_i(do_depth), .single_i(do_single), .set_first_i(do_set_first), .set_less_i(do_set_less),
    .file_i(do_file), .total_clear_i(do_total_clear), .total_i(do_total), .range_i(do_range), .load_i(do_load),
    .load_what_i(what), .load_flag_i(mark), .literal_stb_i(do_literal), .literal_i(argument[7:0]),
    .grant_i(do_grant), .burst_i(do_burst), .write_i(do_write), .keep_i(keep), .dry_i(dry), .release_i(send_stb | quiet_stb),
    .space_i(space), .room_i(argument), .status_i(status), .in_limit_o(in_limit), .bytes_fit_o(bytes_fit),
    .over_o(over), .beyond_o(beyond), .too_long_o(too_long), .length_o(length), .done_o(done), .fail_o(fail),
    .fail_code_o(fail_code), .held_o(held), .first_o(grant_first_o), .last_o(grant_last_o), .file_o(grant_file_o),
    .inner_o(inner), .inner_i(inner_data), .byte_i(frame_byte), .count_i(count), .put_o(move_put),
    .data_o(move_data), .step_o(move_step), .waiting_o(waiting), .stall_i(stall), .grant_req_o(grant_req_o),
    .grant_write_o(grant_write_o), .grant_ack_i(grant_ack_i), .exception_i(exception_i), .wb_cyc_o(wb_cyc_o),
    .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_adr_o(wb_adr_o), .wb_dat_o(wb_dat_o), .wb_dat_i(wb_dat_i),
    .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i)
  );

  // What a LOAD step can ask for beside the frame; what is not built in gives the count.
  wire [7:0] flag = {8{argument[3] ? run_indicator_i : busy_i}};
  wire [63:0] statuses = {
    FUNCTION_CODES[20]     ? length : count[7:0],
    (HAS_DIAGNOSTICS != 0) ? {1'b0, log_count_o} : count[7:0],
    (HAS_DIAGNOSTICS != 0) ? diagnostic_register_o : {2{count[7:0]}},
    (HAS_DIAGNOSTICS != 0 || FUNCTION_CODES[17]) ? flag : count[7:0],
    FUNCTION_CODES[7]      ? exception_status_i : count[7:0],
    {4'd0, code},
    count[7:0]};
  wire [7:0] status = statuses[{argument[2:0], 3'd0} +: 8];

  // The user: he sees the request, appends to the answer, and cannot go beyond the longest PDU.
  generate
    if (HAS_USER != 0) begin : gen_user
      localparam [8:0] FULL = 9'd254;             // address, function code, 252 bytes
      reg  excess_q;
      wire full   = (count == FULL);
      wire excess = excess_q | (user_put_i & full);
      always @(posedge clk_i) excess_q <= do_offer & excess;
      assign user_put  = do_offer & user_put_i & ~full;
      assign user_fail = do_offer & (user_done_i ? ~user_pass_i & (user_exception_i != 4'd0 || excess) : stall);
      assign user_code = (user_done_i && !excess) ? user_exception_i : `MB_EX_DEVICE_FAILURE;
      assign user_done = user_done_i;
      assign user_req_o = do_offer;
      assign user_count_o = kept_count[7:0];
      assign user_dat_o = frame_byte;
      wire unused = kept_count[8];
    end else begin : gen_no_user
      wire unused = &{1'b0, user_put_i, user_done_i, user_exception_i, do_offer, kept_count};
      assign user_put = 1'b0;
      assign user_fail = 1'b0;
      assign user_code = 4'd0;
      assign user_done = 1'b0;
      assign user_req_o = 1'b0;
      assign user_count_o = 8'd0;
      assign user_dat_o = 8'd0;
    end
  endgenerate

  // Counters, log, modes
  wire [15:0] counters_data;
  wire [7:0]  texts_data;

  generate
    if (HAS_DIAGNOSTICS != 0) begin : gen_diagnostics
      modbus_diagnostics u_diagnostics (
        .clk_i(clk_i), .rst_i(rst_i), .count_i(diag_count), .which_i(argument[4:0]), .clear_i(diag_clear),
        .log_i(diag_log), .event_i(diag_event), .now_i(diag_now), .applies_i(diag_applies), .listen_i(mode[1]), .active_i(mode[2]),
        .empty_i(mode[3]), .clear_register_i(mode[4]), .no_overrun_i(mode[5]), .overrun_i(mode[6]),
        .listen_only_o(listen_only_o), .register_o(diagnostic_register_o), .log_count_o(log_count_o),
        .read_i(inner), .read_log_i(space[1]), .read_at_i(grant_first_o[5:0]), .data_o(counters_data),
        .diagnostic_i(diagnostic_i[15:1]), .counter_stb_i(counter_stb_i), .counter_adr_i(counter_adr_i),
        .counter_ack_o(counter_ack_o)
      );
    end else begin : gen_no_diagnostics
      wire unused = &{1'b0, diagnostic_i, counter_adr_i, mode, diag_count, diag_clear, diag_log, diag_now, diag_applies, diag_event, inner};
      reg ack_q = 1'b0;
      always @(posedge clk_i) ack_q <= counter_stb_i & ~ack_q & ~rst_i;
      assign listen_only_o = 1'b0;
      assign diagnostic_register_o = 16'd0;
      assign log_count_o = 7'd0;
      assign counters_data = 16'd0;
      assign counter_ack_o = ack_q;
    end
    if (HAS_IDENTITY != 0) begin : gen_identity
      modbus_identity #(
        .HAS_OBJECTS(FUNCTION_CODES[43]), .SERVER_ID(SERVER_ID), .SERVER_ID_BYTES(SERVER_ID_BYTES),
        .ADDITIONAL_DATA(ADDITIONAL_DATA), .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES),
        .VENDOR_NAME(VENDOR_NAME), .PRODUCT_CODE(PRODUCT_CODE), .REVISION(REVISION), .VENDOR_URL(VENDOR_URL),
        .PRODUCT_NAME(PRODUCT_NAME), .MODEL_NAME(MODEL_NAME), .USER_APPLICATION_NAME(USER_APPLICATION_NAME),
        .PRIVATE_OBJECTS(PRIVATE_OBJECTS), .CONFORMITY(CONFORMITY), .DEVICE_ID_LIMIT(DEVICE_ID_LIMIT)
      ) u_identity (.clk_i(clk_i), .at_i(grant_first_o[10:0]), .data_o(texts_data));
    end else begin : gen_no_identity
      assign texts_data = 8'd0;
    end
  endgenerate

  wire unused_bit = diagnostic_i[0];                  // the overrun flag is the core's own

  assign counter_dat_o = counters_data;
  assign inner_data   = (HAS_IDENTITY != 0 && space == `MB_SPACE_TEXTS) ? {8'd0, texts_data} : counters_data;

  assign grant_space_o = space;

  modbus_alive #(.CLK_HZ(CLK_HZ), .TIMEOUT_MS(ALIVE_TIMEOUT_MS)) u_alive (
    .clk_i(clk_i), .rst_i(rst_i), .frame_stb_i(good_stb), .alive_o(alive_o)
  );

`ifdef FORMAL
  // Above all: nothing is written, nor even looked at, without a complete good frame for us and a grant.
  reg f_past = 1'b0;
  reg f_good = 1'b0;                 // a frame of 4 bytes or more with zero remainder is being worked on
  reg f_ours = 1'b0;                 // its address byte is ours or 0
  reg f_write_granted = 1'b0;        // the bank agreed to a write in it
  reg f_granted = 1'b0;              // the bank agreed to an access

  always @(posedge clk_i) begin
    f_past <= 1'b1;
    if (grant_req_o && grant_ack_i && exception_i == 4'd0) begin
      f_granted <= 1'b1;
      if (grant_write_o) f_write_granted <= 1'b1;
    end
    if (rst_i || quiet_stb) {f_good, f_ours, f_granted, f_write_granted} <= 4'd0;
    if (look_stb) f_good <= $past(count >= 9'd4);
    if (good_stb) f_ours <= 1'b1;
  end

  always @* if (!f_past) assume (rst_i);

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (grant_req_o)           assert (f_good && f_ours);
    if (wb_stb_o)              assert (wb_cyc_o && f_good && f_ours && f_granted);
    if (wb_stb_o && wb_we_o)   assert (f_write_granted);
    if (write_stb_o)           assert (f_good && f_write_granted);
    if (de_o)                  assert (!wb_cyc_o);               // the bus is free before the answer
    // A beat is not withdrawn before the bank answers.
    if ($past(wb_stb_o) && !$past(wb_ack_i) && !$past(wb_err_i) && !$past(stall))
      assert (wb_stb_o && $stable(wb_adr_o) && $stable(wb_we_o));
    cover (wb_stb_o && wb_we_o && f_write_granted);
    cover (write_stb_o);
    cover (wb_stb_o && !wb_we_o);
  end
`endif

endmodule

`default_nettype wire
