// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// Many generated banks behind one core, compiled: one of them is chosen and gets the traffic.
//
// While a request is under way the inputs change with every clock between two vectors, so that a value which is put
// together of two clocks shows.  Every change of the outputs is recorded.

#include <cstdint>
#include <cstring>
#include <vector>

#include "line.h"
#include "model.h"

namespace {

constexpr unsigned kBitTime = 8;
constexpr int kMaxAnswer = 300;

struct Device {
  VerilatedContext context;
  Vmodel top{&context};
  CharacterFormat format{3};
  LineMonitor monitor{format, kBitTime};
  std::vector<uint32_t> inputs[2] = {std::vector<uint32_t>(WORDS), std::vector<uint32_t>(WORDS)};
  std::vector<uint32_t> last = std::vector<uint32_t>(WORDS), changes;
  bool moving = false;
  uint32_t noise = 1;
  uint8_t answer[kMaxAnswer];
  int count = 0;

  void drive(int which) { for (int i = 0; i < WORDS; ++i) top.in_i[i] = inputs[which][i]; }

  void record() {
    bool same = true;
    for (int i = 0; i < WORDS; ++i) same &= top.out_o[i] == last[i];
    if (same) return;
    for (int i = 0; i < WORDS; ++i) last[i] = top.out_o[i];
    changes.insert(changes.end(), last.begin(), last.end());
  }

  void clock() {
    if (moving) {
      noise ^= noise << 13, noise ^= noise >> 17, noise ^= noise << 5;
      drive(noise & 1);
    }
    cycle(top);
    record();
    const bool began = top.de_o && !monitor.enabled();
    if (began) count = 0;
    const int data = monitor.clock(top.txd_o, top.de_o);
    if (data >= 0 && count < kMaxAnswer) answer[count++] = uint8_t(data);
  }
};

}  // namespace

extern "C" {

void *device_new() {
  auto *d = new Device;
  d->top.rxd_i = 1;
  return d;
}

void device_choose(void *h, uint32_t which) {
  auto *d = static_cast<Device *>(h);
  d->top.sel_i = which;
  d->top.rst_i = 1;
  for (int i = 0; i < 4; ++i) d->clock();
  d->top.rst_i = 0;
  for (int i = 0; i < 2000; ++i) d->clock();
  d->changes.clear();
}

void device_inputs(void *h, const uint32_t *a, const uint32_t *b) {
  auto *d = static_cast<Device *>(h);
  d->inputs[0].assign(a, a + WORDS);
  d->inputs[1].assign(b, b + WORDS);
  d->drive(0);
  d->clock();
}

// The outputs as they are.
void device_outputs(void *h, uint32_t *out) {
  auto *d = static_cast<Device *>(h);
  for (int i = 0; i < WORDS; ++i) out[i] = d->top.out_o[i];
}

int32_t device_host(void *h, uint32_t address, int write, uint32_t data) {
  auto *d = static_cast<Device *>(h);
  return host_access(d->top, [&] { d->clock(); }, address, write, data, 20000);
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
  while (!m.ended() && (m.enabled() || m.now() < end + patience)) d->clock();
  d->moving = false;
  d->drive(0);
  for (int i = 0; i < 40 * int(kBitTime); ++i) d->clock();
  std::memcpy(answer, d->answer, sizeof d->answer);
  return m.fault() != LineFault::kNone ? int(m.fault()) : m.ended() ? d->count : 0;
}

// How many vectors the outputs have been since the request began; the vectors.
int32_t device_changes(void *h, uint32_t *out, int32_t most) {
  auto *d = static_cast<Device *>(h);
  const int32_t count = int32_t(d->changes.size() / WORDS);
  std::memcpy(out, d->changes.data(), sizeof(uint32_t) * WORDS * (count < most ? count : most));
  return count;
}

}  // extern "C"
