// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_line - the line side of the core: from the pins to judged frames, and from an answer to the pins.
//
//   rxd_i -> modbus_sync -> modbus_glitch_filter -> modbus_uart -> modbus_frame_rx -> frame_o, ram_do_o, rx_byte_o
//   frame_byte_i, verdict_i -> modbus_frame_tx -> modbus_uart -> txd_o, de_o
//
// With ASCII_MODE = 1 modbus_ascii stands between modbus_uart and the two frame modules; in ASCII mode it makes bytes of
// characters and characters of bytes.
//
// modbus_line_timer measures silence and waits, modbus_crc16 sees each data bit that passes, either way.
//
// A frame for us (frame_o, MB_FRAME_GOOD) stays the engine's until it gives a verdict: SEND, then count_i bytes
// from the cursor on are the answer, or QUIET.  sending_o rises a clock behind SEND and falls when the last stop bit and
// the driver tail have passed; the engine may give QUIET before, it is then ignored.  With MB_SET_DROP_LATE an answer
// is given up if a character came since the request: sending_o falls before the driver is on.
// RESTART is obeyed while nothing is sent.  Nothing is received while de_o is high.

`default_nettype none
`include "modbus_defs.vh"

module modbus_line #(
  parameter integer CLK_HZ     = 50000000,   // clk_i in hertz
  parameter integer T15_MIN_US = 750,        // floor of t1.5 in microseconds, 0: none
  parameter integer T35_MIN_US = 1750,       // floor of t3.5 in microseconds, 0: none
  parameter integer MAX_BIT_TIME  = 65535,   // no MB_SET_BIT_TIME is above it
  parameter integer BIT_FRACTIONS = 0,       // 1: MB_SET_BIT_FRACTION counts
  parameter [247:0] UNIT_SET      = 248'd0,  // bit n: address n is ours too
  parameter integer UNIT_PORT     = 0,       // 1: so is one for which unit_ours_i is high
  parameter integer GLITCH_FILTER = 0,       // clocks: a pulse on rxd_i that is not longer is not seen, 0..255
  parameter integer ASCII_MODE    = 0,       // 1: MB_SET_ASCII counts
  parameter integer ASCII_TIMEOUT_MS = 1000  // longest silence inside a frame of ASCII mode, in milliseconds
) (
  input  wire        clk_i,
  input  wire        rst_i,                  // synchronous, active high

  // Line
  input  wire        rxd_i,                  // asynchronous, idle 1
  output wire        txd_o,                  // idle 1
  output wire        de_o,                   // driver enable, active high

  input  wire [`MB_SETTINGS_WIDTH-1:0] settings_i,   // fields MB_SET_*

  // Frames to the engine
  output wire [`MB_FRAME_WIDTH-1:0]   frame_o,       // bits MB_FRAME_*
  output wire [`MB_RAM_WIDTH-1:0]     ram_do_o,      // strobes MB_RAM_*
  output wire [7:0]  rx_byte_o,              // level : the received byte, with MB_RAM_STORE
  output wire        rx_active_o,            // level : a frame is being received

  output wire [7:0]  unit_o,                 // level : address of the request, 0 broadcast, with UNIT_SET or UNIT_PORT
  input  wire        unit_ours_i,            // level : unit_o is one of ours, with UNIT_PORT

  // Answers from the engine
  input  wire [7:0]  frame_byte_i,           // level : the byte that was under the cursor of the frame RAM a clock ago
  input  wire [8:0]  count_i,                // level : bytes of the frame, or left to send
  input  wire [`MB_VERDICT_WIDTH-1:0] verdict_i,     // strobes MB_VERDICT_*
  output wire        sending_o,              // level : an answer is on its way

  // A bank's time
  input  wire        bank_waits_i,           // level : the bank or the user owes an answer
  output wire        stall_o,                // level : for longer than the stall limit

  output wire [`MB_EVENTS_WIDTH-1:0]  events_o,      // strobes MB_EVENT_*
  output wire        idle_o                  // level : nothing is received, worked on or sent: settings may change
);

  generate
    if (CLK_HZ < 1000 || CLK_HZ > 1000000000) begin : gen_clock
      ERROR_modbus_CLK_HZ_from_1000_to_1000000000 illegal_parameter ();
    end
    if (MAX_BIT_TIME < 8 || MAX_BIT_TIME > 65535) begin : gen_bit_time
      ERROR_modbus_MAX_BIT_TIME_from_8_to_65535 illegal_parameter ();
    end
    if (BIT_FRACTIONS < 0 || BIT_FRACTIONS > 1) begin : gen_fractions
      ERROR_modbus_BIT_FRACTIONS_is_0_or_1 illegal_parameter ();
    end
    if (ASCII_MODE < 0 || ASCII_MODE > 1) begin : gen_ascii_mode
      ERROR_modbus_ASCII_MODE_is_0_or_1 illegal_parameter ();
    end
    if (ASCII_TIMEOUT_MS < 1 || ASCII_TIMEOUT_MS > 1073741823 / ((CLK_HZ + 999) / 1000)) begin : gen_ascii_timeout
      ERROR_modbus_ASCII_TIMEOUT_MS_from_1_to_1073741823_by_CLK_HZ_in_kilohertz illegal_parameter ();
    end
    if (T15_MIN_US < 0 || T35_MIN_US < T15_MIN_US || T35_MIN_US > 100000) begin : gen_floors
      ERROR_modbus_T35_MIN_US_from_T15_MIN_US_to_100000 illegal_parameter ();
    end
  endgenerate

  // Microseconds to clocks, rounded up to the next kilohertz and clock; no term passes 32 bits.
  localparam integer KHZ = (CLK_HZ % 1000000 + 999) / 1000;
  localparam integer T15_CLOCKS = (CLK_HZ / 1000000) * T15_MIN_US + (KHZ * T15_MIN_US + 999) / 1000;
  localparam integer T35_CLOCKS = (CLK_HZ / 1000000) * T35_MIN_US + (KHZ * T35_MIN_US + 999) / 1000;
  // The time-out of ASCII mode in ticks of 2^TICK_BITS clocks: it is never early, and late by less than a tick.
  localparam integer TIMEOUT     = ((CLK_HZ + 999) / 1000) * ASCII_TIMEOUT_MS;
  localparam integer MOST_TICKS  = 4095;
  localparam integer FEWEST_BITS = $clog2(TIMEOUT / MOST_TICKS + 1);
  localparam integer T35_BITS    = $clog2(T35_CLOCKS + 1);
  localparam integer TICK_BITS   = (FEWEST_BITS > T35_BITS) ? FEWEST_BITS : (T35_BITS > 0) ? T35_BITS : 1;
  localparam integer TICKS       = (TIMEOUT >> TICK_BITS) + 1;
  localparam integer EXTRA_AT    = $clog2(TICKS + 1);          // the further periods stand above the bits of TICKS

  wire [15:0] bit_time    = settings_i[`MB_SET_BIT_TIME];
  wire [3:0]  fraction    = settings_i[`MB_SET_BIT_FRACTION];
  wire [1:0]  format      = settings_i[`MB_SET_FORMAT];
  wire [15:0] stall_limit = settings_i[`MB_SET_STALL_LIMIT];
  wire        ascii       = (ASCII_MODE != 0) & settings_i[`MB_SET_ASCII];
  wire        seven       = ascii & ~settings_i[`MB_SET_EIGHT_BITS];

  // ------------------------------------------------------------------ characters

  wire       rxd_sync, rxd, uart_idle, receiving, start_stb, char_stb, parity_error, framing_error;
  wire       tx_valid, tx_check, tx_last, tx_ready, tx_sending, tx_begin, uart_check, uart_ready;
  wire [7:0] uart_received, uart_data;
  wire       data_stb, data_bit, feed, check_bit, crc_zero;

  modbus_sync u_sync (.clk_i(clk_i), .async_i(rxd_i), .sync_o(rxd_sync));

  modbus_glitch_filter #(.CLOCKS(GLITCH_FILTER)) u_filter (.clk_i(clk_i), .level_i(rxd_sync), .level_o(rxd));

  modbus_uart #(.MAX_BIT_TIME(MAX_BIT_TIME), .BIT_FRACTIONS(BIT_FRACTIONS)) u_uart (
    .clk_i(clk_i), .rst_i(rst_i), .bit_time_i(bit_time), .fraction_i(fraction), .format_i(format),
    .seven_i(seven), .enable_i(~de_o), .rxd_i(rxd), .txd_o(txd_o), .idle_o(uart_idle),
    .receiving_o(receiving), .start_stb_o(start_stb), .char_stb_o(char_stb), .data_o(uart_received),
    .parity_error_o(parity_error), .framing_error_o(framing_error),
    .valid_i(tx_valid), .data_i(uart_data), .check_i(uart_check), .ready_o(uart_ready),
    .sending_o(tx_sending), .begin_stb_o(tx_begin),
    .bit_stb_o(data_stb), .bit_o(data_bit), .feed_o(feed), .check_bit_i(check_bit)
  );

  modbus_crc16 u_crc16 (
    .clk_i(clk_i), .clear_i(ram_do_o[`MB_RAM_OPEN] | tx_begin), .shift_i(data_stb), .feed_i(feed),
    .data_i(data_bit), .bit_o(check_bit), .zero_o(crc_zero)
  );

  // ------------------------------------------------------------------ silence and waits

  wire        t15, t35, rest, send_stb, tx_wait_clear, tx_wait_short, wait_over;
  wire [11:0] tx_wait_limit;

  // One wait counter: the waits of an answer follow the bank's, and those the silences inside a frame of ASCII mode.
  wire        counts_silence = ascii & rx_active_o;
  wire [1:0]  extra          = settings_i[`MB_SET_ASCII_EXTRA];
  wire [15:0] timeout        = TICKS[15:0] | ({14'd0, extra} << EXTRA_AT);
  // The verdict itself begins the wait: what modbus_frame_rx makes of it would be a long way to the bit clock.
  modbus_line_timer #(
    .MAX_BIT_TIME(MAX_BIT_TIME), .BIT_FRACTIONS(BIT_FRACTIONS), .T15_CLOCKS(T15_CLOCKS), .T35_CLOCKS(T35_CLOCKS),
    .TICK_BITS((ASCII_MODE != 0) ? TICK_BITS : 0)
  ) u_line_timer (
    .clk_i(clk_i), .rst_i(rst_i), .bit_time_i(bit_time), .fraction_i(fraction), .format_i(format),
    .receiving_i(receiving), .sending_i(tx_sending), .restart_i(verdict_i[`MB_VERDICT_RESTART]),
    .t15_o(t15), .t35_o(t35), .rest_o(rest), .wait_stb_i(verdict_i[`MB_VERDICT_SEND]),
    .wait_clear_i(sending_o ? tx_wait_clear : counts_silence ? receiving : ~bank_waits_i),
    .wait_limit_i(sending_o ? {4'd0, tx_wait_limit} : stall_limit), .wait_short_i(sending_o & tx_wait_short),
    .wait_ticks_i(counts_silence), .tick_limit_i(timeout),
    .wait_over_o(wait_over)
  );

  // A stall limit of 0 is no limit.
  assign stall_o = wait_over & (stall_limit != 16'd0);

  // ------------------------------------------------------------------ ASCII mode

  wire frame_start, frame_t15, frame_t35, half, whole, check_ok;

  generate
    if (ASCII_MODE != 0) begin : gen_ascii
      modbus_ascii u_ascii (
        .clk_i(clk_i), .rst_i(rst_i), .ascii_i(ascii),
        .delimiter_stb_i(verdict_i[`MB_VERDICT_DELIMITER]), .restart_i(verdict_i[`MB_VERDICT_RESTART]),
        .receiving_i(rx_active_o), .open_stb_i(ram_do_o[`MB_RAM_OPEN]), .start_stb_i(start_stb), .char_stb_i(char_stb), .data_i(uart_received),
        .crc_zero_i(crc_zero), .t15_i(t15), .t35_i(t35), .over_i(wait_over), .rest_i(rest), .start_stb_o(frame_start), .half_o(half),
        .whole_o(whole), .byte_o(rx_byte_o), .up_stb_o(ram_do_o[`MB_RAM_UP]), .check_ok_o(check_ok),
        .t15_o(frame_t15), .t35_o(frame_t35), .valid_i(tx_valid), .check_i(tx_check), .last_i(tx_last),
        .frame_byte_i(frame_byte_i), .ready_o(tx_ready), .data_o(uart_data), .check_o(uart_check),
        .ready_i(uart_ready)
      );
    end else begin : gen_rtu
      wire unused = &{1'b0, verdict_i[`MB_VERDICT_DELIMITER], settings_i[`MB_SET_ASCII],
                      settings_i[`MB_SET_EIGHT_BITS], tx_last, rest};
      assign frame_start = start_stb;
      assign frame_t15   = t15;
      assign frame_t35   = t35;
      assign half        = 1'b1;
      assign whole       = 1'b1;
      assign check_ok    = crc_zero;
      assign rx_byte_o   = uart_received;
      assign uart_data   = frame_byte_i;
      assign uart_check  = tx_check;
      assign tx_ready    = uart_ready;
      assign ram_do_o[`MB_RAM_UP] = 1'b0;
    end
  endgenerate

  // ------------------------------------------------------------------ frames

  wire also, read_stb;

  modbus_units #(.UNIT_SET(UNIT_SET), .UNIT_PORT(UNIT_PORT)) u_units (
    .clk_i(clk_i), .look_i(read_stb), .byte_i(frame_byte_i), .ours_i(unit_ours_i), .unit_o(unit_o), .also_o(also)
  );

  wire frames_idle, drop, sent_stb, dropped_stb;

  modbus_frame_rx u_frame_rx (
    .clk_i(clk_i), .rst_i(rst_i), .gap_count_only_i(settings_i[`MB_SET_GAP_COUNT_ONLY]),
    .strict_i(settings_i[`MB_SET_STRICT]), .ascii_i(ascii), .drop_late_i(settings_i[`MB_SET_DROP_LATE]),
    .address_i(settings_i[`MB_SET_ADDRESS]), .broadcast_en_i(settings_i[`MB_SET_BROADCAST]), .also_i(also),
    .start_stb_i(frame_start), .char_stb_i(char_stb), .parity_error_i(parity_error),
    .framing_error_i(framing_error), .half_i(half), .whole_i(whole), .crc_zero_i(check_ok), .t15_i(frame_t15),
    .t35_i(frame_t35),
    .count_i(count_i), .byte_i(frame_byte_i), .open_stb_o(ram_do_o[`MB_RAM_OPEN]),
    .look_stb_o(ram_do_o[`MB_RAM_LOOK]), .read_stb_o(read_stb), .store_stb_o(ram_do_o[`MB_RAM_STORE]),
    .good_stb_o(frame_o[`MB_FRAME_GOOD]), .broadcast_o(frame_o[`MB_FRAME_BROADCAST]),
    .foreign_stb_o(frame_o[`MB_FRAME_FOREIGN]), .bad_stb_o(frame_o[`MB_FRAME_BAD]),
    .send_i(verdict_i[`MB_VERDICT_SEND]), .send_stb_o(send_stb), .drop_o(drop), .sending_i(sending_o),
    .sent_i(sent_stb), .dropped_i(dropped_stb), .quiet_i(verdict_i[`MB_VERDICT_QUIET]),
    .restart_i(verdict_i[`MB_VERDICT_RESTART]), .idle_o(frames_idle), .active_o(rx_active_o), .events_o(events_o)
  );

  modbus_frame_tx u_frame_tx (
    .clk_i(clk_i), .rst_i(rst_i), .start_i(send_stb), .drop_i(drop), .sending_o(sending_o),
    .sent_stb_o(sent_stb), .dropped_stb_o(dropped_stb), .de_o(de_o),
    .response_delay_i(settings_i[`MB_SET_RESPONSE_DELAY]), .de_lead_i(settings_i[`MB_SET_DE_LEAD]),
    .de_tail_i(settings_i[`MB_SET_DE_TAIL]), .wait_clear_o(tx_wait_clear), .wait_limit_o(tx_wait_limit),
    .wait_short_o(tx_wait_short), .wait_over_i(wait_over), .count_i(count_i), .next_stb_o(ram_do_o[`MB_RAM_NEXT]),
    .valid_o(tx_valid), .check_o(tx_check), .last_o(tx_last), .ready_i(tx_ready)
  );

  assign frame_o[`MB_FRAME_LONG] = events_o[`MB_EVENT_LONG];
  assign idle_o                  = frames_idle & uart_idle & ~sending_o;

`ifdef FORMAL
  // Whatever the engine, the frame RAM and the bit clocks do: nothing is received while we drive the line.
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (de_o) assert (!rx_active_o);
    if (sending_o) assert (!frames_idle && !rx_active_o);
    if (de_o) assert (sending_o && !ram_do_o[`MB_RAM_OPEN] && !ram_do_o[`MB_RAM_STORE]);
    if ($past(de_o)) assert (!receiving && !start_stb && !char_stb);
    if (!de_o) assert (txd_o);                                   // the line is left at 1
    if (idle_o) assert (!rx_active_o && !sending_o && !de_o);
    cover (de_o && !txd_o);
    cover (rx_active_o);
  end
`endif

endmodule

`default_nettype wire
