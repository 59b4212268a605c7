// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_engine - a frame becomes an answer: everything between the line and the bank.
//
// Begins with a good frame for us that stands in the frame RAM.  Before the first access it asks the bank with
// grant_req_o for a range of items; the bank answers with grant_ack_i and 0, or an exception code.  Then follows one
// burst under wb_cyc_o (several under one: the halves of 16H and 17H, the groups of 14H and 15H, count and entries of
// 18H).  With CHECK_WRITES the burst of a write runs twice under one wb_cyc_o: first the bank checks the values, then it
// stores them.  At the end the line sends what stands in the frame RAM, or nothing.
//
// Promise, shown by the properties at the foot: no question, no access and no write without a good frame for us; no
// access without a grant; no write without a grant to write, with CHECK_WRITES none without a checking pass before it.

`default_nettype none
`include "modbus_defs.vh"
`include "modbus_steps.vh"

module modbus_engine #(
`include "modbus_config.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Line
  input  wire [`MB_FRAME_WIDTH-1:0]   frame_i,           // MB_FRAME_*
  input  wire [`MB_RAM_WIDTH-1:0]     ram_do_i,          // strobes, MB_RAM_*
  input  wire [7:0]  rx_byte_i,      // level : with MB_RAM_STORE
  input  wire        rx_active_i,    // level : a frame is being received
  output wire [7:0]  frame_byte_o,   // level : the byte that was under the cursor a clock ago
  output wire [8:0]  count_o,        // level : bytes received, or bytes to send
  output wire [`MB_VERDICT_WIDTH-1:0] verdict_o,         // strobes, MB_VERDICT_*
  input  wire        sending_i,      // level : an answer is on its way
  output wire        bank_waits_o,   // level : the bank or the user owes an answer
  input  wire        stall_i,        // level : for longer than the stall limit

`include "modbus_engine_ports.vh"
);

`include "modbus_features.vh"

  wire [8:0]  at;
  wire [15:0] step;
  wire        fetch;
  wire [`MB_ENTRIES_WIDTH-1:0]  entries;
  wire [`MB_RAM_DO_WIDTH-1:0]   ram_do;
  wire [`MB_RANGE_DO_WIDTH-1:0] range_do;
  wire [`MB_BURST_DO_WIDTH-1:0] burst_do;
  wire [`MB_DIAG_DO_WIDTH-1:0]  diag_do;
  wire [`MB_FOUND_WIDTH-1:0]    found;
  wire [10:0] argument;
  wire [2:0]  space;
  wire [3:0]  code, fail_code, user_code, cursor;
  wire [7:0]  held, length, event_byte, frame_byte, late_byte, status_byte, burst_data;
  wire [8:0]  count, kept_count;
  wire        done, fail, past_end, at_last, moving, next, burst_put, burst_step, waiting;
  wire        offer, user_put, user_done, user_fail;
  wire        inner;
  wire [15:0] first, inner_data, words_data;

  // ------------------------------------------------------------------ the program and what carries it out

  modbus_program #(
    .FUNCTION_CODES(FUNCTION_CODES), .USER_CODES(USER_CODES), .MAX_READ_BITS(MAX_READ_BITS),
    .MAX_WRITE_BITS(MAX_WRITE_BITS), .MAX_READ_REGISTERS(MAX_READ_REGISTERS),
    .MAX_WRITE_REGISTERS(MAX_WRITE_REGISTERS), .RW_MAX_READ(RW_MAX_READ), .RW_MAX_WRITE(RW_MAX_WRITE),
    .CHECK_WRITES(CHECK_WRITES), .ASCII_MODE(ASCII_MODE), .SERVER_ID_BYTES(SERVER_ID_BYTES),
    .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES), .CONFORMITY(CONFORMITY)
  ) u_program (.clk_i(clk_i), .at_i(at), .fetch_i(fetch), .step_o(step), .entries_o(entries));

  modbus_sequencer #(.FUNCTION_CODES(FUNCTION_CODES), .USER_CODES(USER_CODES)) u_sequencer (
    .clk_i(clk_i), .rst_i(rst_i), .busy_i(host_state_i[`MB_HOST_BUSY]), .failure_i(host_state_i[`MB_HOST_FAILURE]),
    .write_stb_o(write_stb_o), .frame_i(frame_i), .verdict_o(verdict_o), .sending_i(sending_i), .at_o(at),
    .fetch_o(fetch), .step_i(step), .entries_i(entries), .byte_i(late_byte), .cursor_i(cursor), .count_i(count),
    .ram_do_o(ram_do), .range_do_o(range_do), .burst_do_o(burst_do), .argument_o(argument), .space_o(space), .code_o(code),
    .found_i(found), .done_i(done), .fail_i(fail), .fail_code_i(fail_code), .held_i(held), .offer_o(offer),
    .user_done_i(user_done), .user_fail_i(user_fail), .user_pass_i(user_reply_i[`MB_USER_PASS]),
    .user_code_i(user_code), .diag_do_o(diag_do), .event_o(event_byte), .listen_only_i(listen_only_o)
  );

  modbus_range #(
    .HAS_BITS(HAS_BITS), .HAS_WORDS(HAS_WORDS), .HAS_LITERALS(HAS_LITERALS), .HAS_FILES(HAS_FILES),
    .BITS_PER_BEAT(BITS_PER_BEAT)
  ) u_range (
    .clk_i(clk_i), .do_i(range_do), .argument_i(argument), .space_i(space), .byte_i(late_byte), .count_i(count),
    .found_o(found), .past_end_o(past_end), .length_o(length), .moving_i(moving), .next_i(next),
    .at_last_o(at_last), .first_o(first), .last_o(grant_last_o), .file_o(grant_file_o)
  );

  modbus_burst #(
    .HAS_BITS(HAS_BITS), .HAS_WORDS(HAS_WORDS), .HAS_MASK(HAS_MASK), .HAS_INTERNAL(HAS_INTERNAL),
    .HAS_LITERALS(HAS_LITERALS), .HAS_FILES(HAS_FILES), .BITS_PER_BEAT(BITS_PER_BEAT)
  ) u_burst (
    .clk_i(clk_i), .rst_i(rst_i), .do_i(burst_do), .argument_i(argument[9:0]), .space_i(space),
    .status_i(status_byte), .held_o(held), .done_o(done), .fail_o(fail), .fail_code_o(fail_code),
    .past_end_i(past_end), .at_last_i(at_last), .first_i(first[3:0]), .last_i(grant_last_o[3:0]),
    .fit_i(found[`MB_FOUND_FIT]), .moving_o(moving), .next_o(next), .byte_i(frame_byte), .late_o(late_byte),
    .put_o(burst_put), .data_o(burst_data), .step_o(burst_step), .inner_o(inner), .inner_i(inner_data),
    .waiting_o(waiting), .stall_i(stall_i), .grant_req_o(grant_req_o), .grant_ack_i(grant_ack_i),
    .exception_i(exception_i), .wb_cyc_o(wb_cyc_o), .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_dat_o(wb_dat_o),
    .wb_dat_i(wb_dat_i), .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i)
  );

  // A checking pass is the burst of a write with another space.
  wire checks = (CHECK_WRITES != 0) & burst_do[`MB_DO_BURST] & argument[`MB_ARG_CHECK];

  assign grant_space_o = space;
  assign grant_first_o = first;
  assign grant_write_o = argument[`MB_ARG_WRITE];
  assign wb_adr_o      = {checks ? `MB_CHECK_OF(space) : space, first};
  assign bank_waits_o  = waiting | user_req_o;

  // What PUT can take beside the held byte; what is not built in gives the count.
  wire [7:0] busy_byte = {8{host_state_i[`MB_HOST_BUSY]}};
  wire [7:0] run_byte  = {8{host_state_i[`MB_HOST_RUN]}};
  wire [7:0] exception_status = host_state_i[`MB_HOST_EXCEPTION_STATUS];
  reg  [7:0] chosen;
  always @* begin
    chosen = count[7:0];
    case (argument[`MB_ARG_WHICH])
      `MB_STATUS_CODE:      chosen = {4'd0, code};
      `MB_STATUS_EXCEPTION: if (FUNCTION_CODES[`MB_FC_READ_EXCEPTION_STATUS]) chosen = exception_status;
      `MB_STATUS_BUSY:      if (HAS_DIAGNOSTICS != 0) chosen = busy_byte;
      `MB_STATUS_RUN:       if (FUNCTION_CODES[`MB_FC_REPORT_SERVER_ID]) chosen = run_byte;
      `MB_STATUS_LENGTH:    if (FUNCTION_CODES[`MB_FC_READ_FILE_RECORD]) chosen = length;
      default: ;
    endcase
  end
  assign status_byte = chosen;

  wire unused_unit = host_state_i[`MB_HOST_UNIT_OURS];             // the line has it

  // ------------------------------------------------------------------ the frame RAM and its users

  wire store  = ram_do_i[`MB_RAM_STORE];
  wire line_points = ram_do_i[`MB_RAM_OPEN] | ram_do_i[`MB_RAM_LOOK];

  modbus_frame_ram #(.HAS_UPPER(HAS_UPPER), .HAS_CONTEXT(HAS_CONTEXT)) u_frame_ram (
    .clk_i(clk_i),
    .point_i(line_points | ram_do[`MB_DO_POINT]), .point_at_i(line_points ? 5'd0 : argument[`MB_ARG_PLACE]),
    .step_i(store | ram_do_i[`MB_RAM_NEXT] | ram_do[`MB_DO_STEP] | burst_put | burst_step | user_put),
    .clear_i(ram_do_i[`MB_RAM_OPEN] | ram_do[`MB_DO_CLEAR]),
    .up_i(store | ram_do_i[`MB_RAM_UP] | ram_do[`MB_DO_UP] | burst_put | user_put),
    .down_i(ram_do_i[`MB_RAM_NEXT] | ram_do[`MB_DO_DOWN] | burst_step),
    .keep_i(ram_do[`MB_DO_SAVE]), .recall_i(ram_do[`MB_DO_RECALL]), .peek_i(user_req_o), .peek_at_i(user_adr_i),
    .write_i(store | ram_do[`MB_DO_PUT] | burst_put | user_put),
    .data_i(rx_active_i ? rx_byte_i : user_req_o ? user_reply_i[`MB_USER_DATA] : burst_data),
    .byte_o(frame_byte), .cursor_o(cursor), .count_o(count), .kept_count_o(kept_count)
  );

  assign frame_byte_o = late_byte;
  assign count_o      = count;

  // The user sees the request, appends to the answer, and cannot go beyond the longest PDU.
  generate
    if (HAS_USER != 0) begin : gen_user
      localparam [8:0] FULL = 9'd254;             // address, function code, 252 bytes
      reg  excess_q;
      wire full   = (count == FULL);
      wire wants  = user_reply_i[`MB_USER_PUT];
      wire excess = excess_q | (wants & full);
      wire refuses = (user_reply_i[`MB_USER_EXCEPTION] != 4'd0);
      always @(posedge clk_i) excess_q <= offer & excess;
      assign user_done = user_reply_i[`MB_USER_DONE];
      assign user_put  = offer & wants & ~full;
      assign user_fail = offer & (user_done ? ~user_reply_i[`MB_USER_PASS] & (refuses | excess) : stall_i);
      assign user_code = (user_done && !excess) ? user_reply_i[`MB_USER_EXCEPTION] : `MB_EX_DEVICE_FAILURE;
      assign user_req_o   = offer;
      assign user_count_o = kept_count[7:0];
      assign user_dat_o   = frame_byte;
      wire unused = kept_count[8];
    end else begin : gen_no_user
      wire unused = &{1'b0, user_reply_i, offer, kept_count};
      assign user_put  = 1'b0;
      assign user_fail = 1'b0;
      assign user_code = 4'd0;
      assign user_done = 1'b0;
      assign user_req_o   = 1'b0;
      assign user_count_o = 8'd0;
      assign user_dat_o   = 8'd0;
    end
  endgenerate

  // ------------------------------------------------------------------ memories inside the core

  wire [7:0] texts_data;

  generate
    if (HAS_DIAGNOSTICS != 0) begin : gen_diagnostics
      modbus_diagnostics u_diagnostics (
        .clk_i(clk_i), .rst_i(rst_i), .do_i(diag_do), .argument_i(argument[5:0]), .event_i(event_byte),
        .cleared_i(verdict_o[`MB_VERDICT_QUIET]), .listen_only_o(listen_only_o), .read_i(inner),
        .read_log_i(space[1]), .read_at_i(first[5:0]), .data_o(words_data),
        .diagnostic_i(host_state_i[`MB_HOST_DIAGNOSTIC]), .status_stb_i(status_stb_i), .status_adr_i(status_adr_i),
        .status_ack_o(status_ack_o)
      );
    end else begin : gen_no_diagnostics
      wire unused = &{1'b0, host_state_i[`MB_HOST_DIAGNOSTIC], status_adr_i, diag_do, event_byte, inner};
      reg ack_q = 1'b0;
      always @(posedge clk_i) ack_q <= status_stb_i & ~ack_q & ~rst_i;
      assign listen_only_o = 1'b0;
      assign words_data    = 16'd0;
      assign status_ack_o  = ack_q;
    end
    if (HAS_IDENTITY != 0) begin : gen_identity
      modbus_identity #(
        .HAS_OBJECTS(FUNCTION_CODES[`MB_FC_ENCAPSULATED]), .SERVER_ID(SERVER_ID), .SERVER_ID_BYTES(SERVER_ID_BYTES),
        .ADDITIONAL_DATA(ADDITIONAL_DATA), .ADDITIONAL_DATA_BYTES(ADDITIONAL_DATA_BYTES),
        .VENDOR_NAME(VENDOR_NAME), .PRODUCT_CODE(PRODUCT_CODE), .REVISION(REVISION), .VENDOR_URL(VENDOR_URL),
        .PRODUCT_NAME(PRODUCT_NAME), .MODEL_NAME(MODEL_NAME), .USER_APPLICATION_NAME(USER_APPLICATION_NAME),
        .PRIVATE_OBJECTS(PRIVATE_OBJECTS), .CONFORMITY(CONFORMITY), .DEVICE_ID_LIMIT(DEVICE_ID_LIMIT)
      ) u_identity (.clk_i(clk_i), .at_i(first[10:0]), .data_o(texts_data));
    end else begin : gen_no_identity
      assign texts_data = 8'd0;
    end
  endgenerate

  assign status_dat_o = words_data;
  wire texts = (HAS_IDENTITY != 0) & (space == `MB_SPACE_TEXTS);
  assign inner_data   = ({16{inner & ~texts}} & words_data) | {8'd0, {8{inner & texts}} & texts_data};

`ifdef FORMAL
  // The line: one frame at a time, the next not before the one before is dealt with; an answer ends some time.
  reg f_past = 1'b0;
  reg f_work = 1'b1;                 // a frame, or the clearing after a reset, is worked on
  reg f_sending = 1'b0;              // an answer is on its way
  reg f_good = 1'b0;                 // it is a good frame for us, and no answer has been sent
  reg f_granted = 1'b0;              // the bank agreed to an access in it,
  reg f_write_granted = 1'b0;        // to a write

  reg [1:0]  f_still = 2'd0;         // first address and quantity stand still for so many clocks, see modbus_range
  reg        f_checked = 1'b0;       // a checking pass has ended without an error, and no burst has followed
  reg [2:0]  f_checked_space;        // the table that was checked

  wire f_frame = frame_i[`MB_FRAME_GOOD] | frame_i[`MB_FRAME_FOREIGN] | frame_i[`MB_FRAME_BAD];
  wire f_sent  = f_sending & ~sending_i;
  wire f_ended = verdict_o[`MB_VERDICT_QUIET] | f_sent;

  always @(posedge clk_i) begin
    f_past    <= 1'b1;
    f_still   <= (range_do[`MB_DO_ADDRESS] | range_do[`MB_DO_ONE] | range_do[`MB_DO_QUANTITY] | range_do[`MB_DO_FIRST] |
                  range_do[`MB_DO_LESS] | next) ? 2'd0 : (f_still == 2'd3) ? 2'd3 : f_still + 2'd1;
    f_sending <= (sending_i | verdict_o[`MB_VERDICT_SEND]) & ~rst_i;
    f_work    <= rst_i ? (HAS_DIAGNOSTICS != 0) : (f_work & ~f_ended) | f_frame;
    if (grant_req_o && grant_ack_i && exception_i == 4'd0) begin
      f_granted <= 1'b1;
      if (grant_write_o) f_write_granted <= 1'b1;
    end
    if (burst_do[`MB_DO_BURST] && done) {f_checked, f_checked_space} <= {checks, space};
    if (frame_i[`MB_FRAME_GOOD] || fail || rst_i) f_checked <= 1'b0;
    if (frame_i[`MB_FRAME_GOOD]) {f_good, f_granted, f_write_granted} <= 3'b100;
    if (rst_i || f_ended)        {f_good, f_granted, f_write_granted} <= 3'b000;
  end

  always @* begin
    if (!f_past)  assume (rst_i);
    if (f_work)   assume (!f_frame);
    if (sending_i) assume (f_sending);
    assume (!frame_i[`MB_FRAME_FOREIGN] || !frame_i[`MB_FRAME_GOOD]);
    assume (!frame_i[`MB_FRAME_BAD] || !(frame_i[`MB_FRAME_GOOD] | frame_i[`MB_FRAME_FOREIGN]));
  end

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (grant_req_o)         assert (f_good);
    if (grant_req_o)         assert (f_still >= ((space == `MB_SPACE_FILES) ? 2'd3 : 2'd2));
    if (user_req_o)          assert (f_good);
    if (wb_stb_o)            assert (wb_cyc_o && f_good && f_granted);
    if (wb_stb_o && wb_we_o) assert (f_write_granted);
    if (write_stb_o)         assert (f_good && f_write_granted);
    if (CHECK_WRITES != 0 && wb_stb_o && wb_we_o && wb_adr_o[18:17] != 2'b11 && space != `MB_SPACE_FILES)
      assert (f_checked && f_checked_space == wb_adr_o[18:16]);
    if (wb_stb_o && wb_adr_o[18:17] == 2'b11) assert (CHECK_WRITES != 0 && wb_we_o);
    if (f_sending)           assert (!wb_cyc_o);             // the bus is free before the answer
    if (!inner)              assert (inner_data == 16'd0);
    if (verdict_o[`MB_VERDICT_SEND]) assert (f_good);
    // A beat is not withdrawn before the bank answers.
    if ($past(wb_stb_o) && !$past(wb_ack_i) && !$past(wb_err_i) && !$past(stall_i))
      assert (wb_stb_o && $stable(wb_adr_o) && $stable(wb_we_o));
    cover (wb_stb_o && wb_we_o && f_write_granted);
    cover (write_stb_o);
    cover (wb_stb_o && !wb_we_o);
    cover (CHECK_WRITES == 0 || (f_checked && wb_stb_o && wb_we_o));
  end
`endif

endmodule

`default_nettype wire
