// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_core_inst - connects modbus_rtu_core to modbus_bank_wires.vh; included in its instance's port list.

  .grant_req_o(grant_req), .grant_space_o(grant_space), .grant_first_o(grant_first), .grant_last_o(grant_last),
  .grant_write_o(grant_write), .grant_file_o(grant_file), .grant_ack_i(grant_ack), .exception_i(exception),
  .wb_cyc_o(wb_cyc), .wb_stb_o(wb_stb), .wb_we_o(wb_we), .wb_adr_o(wb_adr), .wb_dat_o(wb_write), .wb_dat_i(wb_read),
  .wb_ack_i(wb_ack), .wb_err_i(wb_err)
