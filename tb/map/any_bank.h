// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// any_bank - a generated bank behind ports that all banks have, whatever its points are.
//
// The core and the banks are libraries of their own: the core is compiled once, and a clock costs one bank, not all
// that were compiled together.

#pragma once

#include <cstdint>
#include <cstring>

struct BankInput {
  uint8_t rst, grant_req, grant_space, grant_write, wb_cyc, wb_stb, wb_we, host_cyc, host_stb, host_we;
  uint16_t grant_first, grant_last, grant_file, wb_write, host_dat;
  uint32_t wb_adr, host_adr;
  bool operator==(const BankInput &o) const { return std::memcmp(this, &o, sizeof o) == 0; }
};
static_assert(sizeof(BankInput) == 10 + 5 * 2 + 2 * 4, "no padding, which memcmp would compare");

struct BankOutput {
  uint8_t grant_ack, exception, wb_ack, wb_err, host_ack, host_err;
  uint16_t wb_read, host_dat;
  bool operator==(const BankOutput &o) const {
    return grant_ack == o.grant_ack && exception == o.exception && wb_ack == o.wb_ack && wb_err == o.wb_err &&
           wb_read == o.wb_read && host_ack == o.host_ack && host_err == o.host_err && host_dat == o.host_dat;
  }
};

class AnyBank {
 public:
  virtual ~AnyBank() = default;
  virtual void eval(bool clock, const BankInput &in, BankOutput &out) = 0;
  virtual void points(const uint32_t *words) = 0;        // drives what the master reads
  virtual void outputs(uint32_t *words) const = 0;       // what the master has written, and the strobes
};
