// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_inst - connects a bank to modbus_bank_wires.vh; included in its instance's port list.

  .grant_req_i(grant_req), .grant_space_i(grant_space), .grant_first_i(grant_first), .grant_last_i(grant_last),
  .grant_write_i(grant_write), .grant_file_i(grant_file), .grant_ack_o(grant_ack), .exception_o(exception),
  .wb_cyc_i(wb_cyc), .wb_stb_i(wb_stb), .wb_we_i(wb_we), .wb_adr_i(wb_adr), .wb_dat_i(wb_write), .wb_dat_o(wb_read),
  .wb_ack_o(wb_ack), .wb_err_o(wb_err)
