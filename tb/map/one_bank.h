// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// one_bank - a compiled bank as AnyBank; the file that names the banks of a batch is written by batch.py.

#pragma once

#include "any_bank.h"

inline double sc_time_stamp() { return 0; }

template <class Model>
class OneBank : public AnyBank {
 public:
  void eval(bool clock, const BankInput &in, BankOutput &out) override {
    top_.clk_i = clock;
    top_.rst_i = in.rst;
    top_.grant_req_i = in.grant_req, top_.grant_space_i = in.grant_space, top_.grant_write_i = in.grant_write;
    top_.grant_first_i = in.grant_first, top_.grant_last_i = in.grant_last, top_.grant_file_i = in.grant_file;
    top_.wb_cyc_i = in.wb_cyc, top_.wb_stb_i = in.wb_stb, top_.wb_we_i = in.wb_we;
    top_.wb_adr_i = in.wb_adr, top_.wb_dat_i = in.wb_write;
    top_.host_cyc_i = in.host_cyc, top_.host_stb_i = in.host_stb, top_.host_we_i = in.host_we;
    top_.host_adr_i = in.host_adr, top_.host_dat_i = in.host_dat;
    top_.eval();
    out = {top_.grant_ack_o, top_.exception_o, top_.wb_ack_o, top_.wb_err_o, top_.host_ack_o, top_.host_err_o,
           top_.wb_dat_o, top_.host_dat_o};
  }
  void points(const uint32_t *words) override {
    for (int i = 0; i < WORDS; ++i) top_.in_i[i] = words[i];
  }
  void outputs(uint32_t *words) const override {
    for (int i = 0; i < WORDS; ++i) words[i] = top_.out_o[i];
  }

 private:
  VerilatedContext context_;
  Model top_{&context_};
};
