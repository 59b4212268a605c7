// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// flat_ports - the ports of core_bench, slave_bench and io_bench: every field of the core's vectors on a port of its own.

  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,

  // settings_i
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,
  input  wire [1:0]  format_i,
  input  wire        broadcast_en_i,
  input  wire        gap_count_only_i,
  input  wire        strict_turnaround_i,
  input  wire        drop_late_i,
  input  wire [11:0] response_delay_i,
  input  wire [15:0] stall_limit_i,
  input  wire [3:0]  de_lead_i,
  input  wire [3:0]  de_tail_i,
  input  wire [3:0]  bit_fraction_i,
  input  wire        ascii_i,
  input  wire        eight_bits_i,
  input  wire [1:0]  ascii_extra_i,

  // host_state_i
  input  wire        busy_i,
  input  wire [3:0]  failure_i,
  input  wire [7:0]  exception_status_i,
  input  wire        run_indicator_i,
  input  wire [15:0] diagnostic_i,               // bit 0 goes nowhere

  // User port
  output wire        user_req_o,
  output wire [7:0]  user_count_o,
  input  wire [7:0]  user_adr_i,
  output wire [7:0]  user_dat_o,
  input  wire        user_put_i,
  input  wire [7:0]  user_dat_i,
  input  wire        user_done_i,
  input  wire        user_pass_i,
  input  wire [3:0]  user_exception_i,

  // Status port
  input  wire        status_stb_i,
  input  wire [6:0]  status_adr_i,
  output wire [15:0] status_dat_o,
  output wire        status_ack_o,

  // What happens; the range of a write
  output wire        write_stb_o,
  output wire [2:0]  write_space_o,
  output wire [15:0] write_first_o,
  output wire [15:0] write_last_o,
  output wire [15:0] write_file_o,
  output wire        alive_o,
  output wire        rx_active_o,
  output wire        listen_only_o,
  output wire        idle_o,
  output wire        frame_stb_o,
  output wire        err_parity_o,
  output wire        err_framing_o,
  output wire        err_overrun_o,
  output wire        err_crc_o,
  output wire        err_short_o,
  output wire        err_long_o,
  output wire        err_gap_o
