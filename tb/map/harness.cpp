// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// The core, compiled, and a generated bank beside it, which is chosen and gets the traffic.
//
// While a request is under way the inputs change with every clock between two vectors, so that a value which is put
// together of two clocks shows.  Every change of the outputs is recorded.

#include <cstdint>
#include <cstring>
#include <vector>

#include "any_bank.h"
#include "line.h"
#include "model.h"

namespace {

constexpr unsigned kBitTime = 8;
constexpr unsigned kT35 = 39 * kBitTime, kIdle = 100;  // clocks
constexpr int kMaxAnswer = 300, kMaxSettle = 8, kUnstable = -100;

struct Device {
  VerilatedContext context;
  Vmodel top{&context};
  AnyBank *bank = nullptr;
  BankInput to{};      // what the bank gets
  BankOutput from{};   // what it says
  int words = 0;       // of its points
  CharacterFormat format{3};
  LineMonitor monitor{format, kBitTime};
  std::vector<uint32_t> inputs[2], last, now, changes;
  bool moving = false, unstable = false;
  uint32_t noise = 1;
  uint8_t answer[kMaxAnswer];
  int count = 0;

  void drive(int which) { bank->points(inputs[which].data()); }

  // The wires between core and bank, until neither changes them.
  void settle() {
    for (int round = 0; round < kMaxSettle; ++round) {
      const BankInput before = to;
      to.rst = top.rst_i;
      to.grant_req = top.grant_req_o, to.grant_space = top.grant_space_o, to.grant_write = top.grant_write_o;
      to.grant_first = top.grant_first_o, to.grant_last = top.grant_last_o, to.grant_file = top.grant_file_o;
      to.wb_cyc = top.wb_cyc_o, to.wb_stb = top.wb_stb_o, to.wb_we = top.wb_we_o;
      to.wb_adr = top.wb_adr_o, to.wb_write = top.wb_dat_o;
      if (round && before == to) return;  // the bank would say the same again
      bank->eval(false, to, from);
      top.grant_ack_i = from.grant_ack, top.exception_i = from.exception;
      top.wb_ack_i = from.wb_ack, top.wb_err_i = from.wb_err, top.wb_dat_i = from.wb_read;
      top.clk_i = 0;
      top.eval();
    }
    unstable = true;
  }

  void record() {
    bank->outputs(now.data());
    if (now == last) return;
    last = now;
    changes.insert(changes.end(), last.begin(), last.end());
  }

  void clock() {
    if (moving) {
      noise ^= noise << 13, noise ^= noise >> 17, noise ^= noise << 5;
      drive(noise & 1);
    }
    bank->eval(true, to, from);  // both see what was there before the edge
    top.clk_i = 1;
    top.eval();
    settle();
    record();
    const bool began = top.de_o && !monitor.enabled();
    if (began) count = 0;
    const int data = monitor.clock(top.txd_o, top.de_o);
    if (data >= 0 && count < kMaxAnswer) answer[count++] = uint8_t(data);
  }
};

// The host port of the bank as host_access() of model.h takes it.
struct HostPort {
  Device &d;
  uint8_t &host_cyc_i = d.to.host_cyc, &host_stb_i = d.to.host_stb, &host_we_i = d.to.host_we;
  uint8_t &host_ack_o = d.from.host_ack, &host_err_o = d.from.host_err;
  uint32_t &host_adr_i = d.to.host_adr;
  uint16_t &host_dat_i = d.to.host_dat, &host_dat_o = d.from.host_dat;
  void eval() { d.settle(); }
};

}  // namespace

extern "C" {

void *device_new() {
  auto *d = new Device;
  d->top.rxd_i = 1;
  return d;
}

// Another bank, whose points are so many words wide.
void device_choose(void *h, AnyBank *bank, int words) {
  auto *d = static_cast<Device *>(h);
  d->bank = bank;
  d->words = words;
  for (auto *vector : {&d->inputs[0], &d->inputs[1], &d->last, &d->now}) vector->assign(words, 0);
  d->to = {};
  d->drive(0);
}

// Reset of core and bank.
void device_reset(void *h) {
  auto *d = static_cast<Device *>(h);
  d->top.rst_i = 1;
  for (int i = 0; i < 4; ++i) d->clock();
  d->top.rst_i = 0;
  for (unsigned i = 0; i < 2 * kT35; ++i) d->clock();  // the core waits for a silence of t3.5 first
  d->changes.clear();
}

void device_inputs(void *h, const uint32_t *a, const uint32_t *b) {
  auto *d = static_cast<Device *>(h);
  d->inputs[0].assign(a, a + d->words);
  d->inputs[1].assign(b, b + d->words);
  d->drive(0);
  d->clock();
}

// The outputs as they are.
void device_outputs(void *h, uint32_t *out) {
  static_cast<Device *>(h)->bank->outputs(out);
}

int32_t device_host(void *h, uint32_t address, int write, uint32_t data) {
  auto *d = static_cast<Device *>(h);
  HostPort port{*d};
  return host_access(port, [&] { d->clock(); }, address, write, data, 20000);
}

// Send a frame; the bytes of the answer, 0 for silence, < 0 for a fault on the line.
int32_t device_xfer(void *h, int n, const uint8_t *bytes, uint32_t patience, uint8_t *answer) {
  auto *d = static_cast<Device *>(h);
  auto &m = d->monitor;
  d->count = 0;
  d->changes.clear();
  m.clear();
  LineDriver driver(d->format, kBitTime);
  for (int i = 0; i < n; ++i) {
    driver.start(bytes[i]);
    while (driver.busy()) {
      d->top.rxd_i = driver.clock();
      d->clock();
    }
  }
  d->top.rxd_i = 1;
  d->moving = true;
  const uint64_t end = m.now();
  // Without an answer: until the core has been idle for a while, which it is not before t3.5 has passed.
  for (unsigned idle = 0; !m.ended() && (m.enabled() || (m.now() < end + patience && idle < kIdle));) {
    d->clock();
    idle = d->top.idle_o && m.now() > end + kT35 ? idle + 1 : 0;
  }
  d->moving = false;
  d->drive(0);
  for (int i = 0; i < 40 * int(kBitTime); ++i) d->clock();
  std::memcpy(answer, d->answer, sizeof d->answer);
  if (d->unstable) return kUnstable;
  return m.fault() != LineFault::kNone ? int(m.fault()) : m.ended() ? d->count : 0;
}

// How many vectors the outputs have been since the request began; the vectors.
int32_t device_changes(void *h, uint32_t *out, int32_t most) {
  auto *d = static_cast<Device *>(h);
  const int32_t count = int32_t(d->changes.size() / d->words);
  std::memcpy(out, d->changes.data(), sizeof(uint32_t) * d->words * (count < most ? count : most));
  return count;
}

}  // extern "C"
