// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// flat_inst - connects the ports of flat_ports.vh to those of a bench below.

    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .address_i(address_i),
    .bit_time_i(bit_time_i), .format_i(format_i), .broadcast_en_i(broadcast_en_i),
    .gap_count_only_i(gap_count_only_i), .strict_turnaround_i(strict_turnaround_i), .drop_late_i(drop_late_i),
    .response_delay_i(response_delay_i), .stall_limit_i(stall_limit_i), .de_lead_i(de_lead_i),
    .de_tail_i(de_tail_i), .bit_fraction_i(bit_fraction_i), .ascii_i(ascii_i),
    .eight_bits_i(eight_bits_i), .ascii_extra_i(ascii_extra_i), .busy_i(busy_i), .failure_i(failure_i),
    .exception_status_i(exception_status_i),
    .run_indicator_i(run_indicator_i), .diagnostic_i(diagnostic_i), .user_req_o(user_req_o),
    .user_count_o(user_count_o), .user_adr_i(user_adr_i), .user_dat_o(user_dat_o), .user_put_i(user_put_i),
    .user_dat_i(user_dat_i), .user_done_i(user_done_i), .user_pass_i(user_pass_i),
    .user_exception_i(user_exception_i), .status_stb_i(status_stb_i), .status_adr_i(status_adr_i),
    .status_dat_o(status_dat_o), .status_ack_o(status_ack_o), .write_stb_o(write_stb_o),
    .write_space_o(write_space_o), .write_first_o(write_first_o), .write_last_o(write_last_o),
    .write_file_o(write_file_o), .alive_o(alive_o), .rx_active_o(rx_active_o), .listen_only_o(listen_only_o),
    .idle_o(idle_o), .frame_stb_o(frame_stb_o), .err_parity_o(err_parity_o), .err_framing_o(err_framing_o),
    .err_overrun_o(err_overrun_o), .err_crc_o(err_crc_o), .err_short_o(err_short_o), .err_long_o(err_long_o),
    .err_gap_o(err_gap_o)
