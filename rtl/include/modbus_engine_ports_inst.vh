// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_engine_ports_inst - connects the ports of modbus_engine_ports.vh by name.

    .host_state_i(host_state_i), .grant_req_o(grant_req_o), .grant_space_o(grant_space_o),
    .grant_first_o(grant_first_o), .grant_last_o(grant_last_o), .grant_write_o(grant_write_o),
    .grant_file_o(grant_file_o), .grant_ack_i(grant_ack_i), .exception_i(exception_i), .wb_cyc_o(wb_cyc_o),
    .wb_stb_o(wb_stb_o), .wb_we_o(wb_we_o), .wb_adr_o(wb_adr_o), .wb_dat_o(wb_dat_o), .wb_dat_i(wb_dat_i),
    .wb_ack_i(wb_ack_i), .wb_err_i(wb_err_i), .user_req_o(user_req_o), .user_count_o(user_count_o),
    .user_adr_i(user_adr_i), .user_dat_o(user_dat_o), .user_reply_i(user_reply_i),
    .status_stb_i(status_stb_i), .status_adr_i(status_adr_i), .status_dat_o(status_dat_o),
    .status_ack_o(status_ack_o), .write_stb_o(write_stb_o), .listen_only_o(listen_only_o)
