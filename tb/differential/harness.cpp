// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// A compiled slave_bench behind a few C functions: a bit-timed line, the host port, strobes.
//
// No protocol here: bytes become levels and levels become bytes (line.h).  A bit of a wrong length, an idle bit between
// characters or de_o not covering the answer is an error, not an answer.

#include <cstdint>
#include <cstring>

#include "line.h"
#include "model.h"

namespace {

constexpr int kStrobes = 8;   // parity framing overrun crc short long gap good, as in defs.py
constexpr int kMaxWrites = 40;     // a 15H request has up to 27 groups
constexpr int kMaxAnswer = 520;

struct Setup {
  uint32_t address, bit_time, format, broadcast_en, gap_count_only, strict_turnaround, response_delay, stall_limit,
      de_lead, de_tail, busy, write_lock, failure, exception_status, run_indicator, diagnostic,
      ascii, eight_bits, ascii_extra;
};

struct Device {
  VerilatedContext context;
  Vmodel top{&context};
  CharacterFormat format{0};
  uint32_t bit_time = 8;
  LineMonitor monitor{format, bit_time};
  uint32_t strobes[kStrobes] = {};
  uint32_t writes[kMaxWrites] = {};   // {space, first}
  uint32_t write_last[kMaxWrites] = {}, write_file[kMaxWrites] = {};
  int write_count = 0;
  uint8_t answer[kMaxAnswer];
  int count = 0;                       // of its bytes

  // Inputs that change behind the end of a line, if later_clocks is not negative, and when
  Setup later = {};
  int64_t later_clocks = -1, change_at = -1;

  uint64_t now() const { return monitor.now(); }

  void apply(const Setup &s) {
    top.address_i = s.address;
    top.bit_time_i = s.bit_time;
    top.format_i = s.format;
    top.broadcast_en_i = s.broadcast_en;
    top.gap_count_only_i = s.gap_count_only;
    top.strict_turnaround_i = s.strict_turnaround;
    top.response_delay_i = s.response_delay;
    top.stall_limit_i = s.stall_limit;
    top.de_lead_i = s.de_lead;
    top.de_tail_i = s.de_tail;
    top.busy_i = s.busy;
    top.write_lock_i = s.write_lock;
    top.failure_i = s.failure;
    top.exception_status_i = s.exception_status;
    top.run_indicator_i = s.run_indicator;
    top.diagnostic_i = s.diagnostic;
    top.ascii_i = s.ascii;
    top.eight_bits_i = s.eight_bits;
    top.ascii_extra_i = s.ascii_extra;
    bit_time = s.bit_time;
    format = CharacterFormat(s.format | (s.ascii && !s.eight_bits ? SEVEN_BITS : 0));
    monitor.set(format, bit_time);
  }

  void clock() {
    if (int64_t(now()) == change_at) apply(later);
    cycle(top);
    const bool seen[kStrobes] = {bool(top.err_parity_o), bool(top.err_framing_o), bool(top.err_overrun_o),
                                 bool(top.err_crc_o), bool(top.err_short_o), bool(top.err_long_o),
                                 bool(top.err_gap_o), bool(top.frame_stb_o)};
    for (int i = 0; i < kStrobes; ++i) strobes[i] += seen[i];
    if (top.write_stb_o && write_count < kMaxWrites) {
      writes[write_count] = uint32_t(top.write_space_o) << 16 | top.write_first_o;
      write_file[write_count] = top.write_file_o;
      write_last[write_count++] = top.write_last_o;
    }
    user();
    const bool began = top.de_o && !monitor.enabled();
    if (began) count = 0;
    const int data = monitor.clock(top.txd_o, top.de_o);
    if (data >= 0 && count < kMaxAnswer) answer[count++] = uint8_t(data);
  }

  // A user of the user port, as user_answer in device.py is one: it reads the request, waits, and what the first
  // data byte asks for is its answer.
  int user_phase = 0;
  uint8_t request[256];

  void user() {
    top.user_put_i = top.user_done_i = top.user_pass_i = top.user_exception_i = 0;
    if (!top.user_req_o) { user_phase = 0; return; }
    const int count = top.user_count_o, wait = count + 1 + count * 7 % 50;
    const int phase = user_phase++;
    if (phase <= count) {                             // a byte comes the clock after its place was shown
      if (phase) request[phase - 1] = top.user_dat_o;
      top.user_adr_i = phase;
    } else if (phase > wait) {
      const int put = phase - wait - 1, what = count > 2 ? request[2] : 0;
      int length = -1;
      if (what % 4 == 1) length = count - 2;                              // the data backwards
      if (what % 4 == 2) length = count > 3 ? request[3] : 0;             // so many bytes of a pattern
      if (put < length) {
        top.user_put_i = 1;
        top.user_dat_i = what % 4 == 1 ? request[count - 1 - put] : put ^ 0x5A;
      } else {
        top.user_done_i = 1;
        top.user_pass_i = what % 4 == 0;
        top.user_exception_i = what % 4 == 3 ? what >> 2 & 15 : 0;
      }
    }
  }

  void run_to(uint64_t time) { while (now() < time) clock(); }
};

}  // namespace

extern "C" {

struct Outcome {
  int32_t answer_bytes;          // < 0: a LineFault
  uint32_t strobes[kStrobes];
  int32_t write_count;
  uint32_t writes[kMaxWrites], write_last[kMaxWrites], write_file[kMaxWrites];
  int64_t latency, lead, tail;   // clocks: end of request to first start bit; of de_o
  uint8_t answer[kMaxAnswer];
};

void *device_new() {
  auto *d = new Device;
  d->top.rxd_i = 1;
  return d;
}

void device_free(void *h) { delete static_cast<Device *>(h); }

void device_setup(void *h, const Setup *s) {
  auto *d = static_cast<Device *>(h);
  d->apply(*s);
}

// The inputs as they shall be `clocks` behind the end of the next line that device_xfer sends.
void device_later(void *h, uint32_t clocks, const Setup *s) {
  auto *d = static_cast<Device *>(h);
  d->later = *s;
  d->later_clocks = int64_t(clocks);
}

void device_idle(void *h, uint32_t clocks) {
  auto *d = static_cast<Device *>(h);
  d->run_to(d->now() + clocks);
}

void device_reset(void *h) {
  auto *d = static_cast<Device *>(h);
  d->top.rst_i = 1;
  device_idle(h, 4);
  d->top.rst_i = 0;
}

int32_t device_host(void *h, uint32_t address, int write, uint32_t data) {
  auto *d = static_cast<Device *>(h);
  return host_access(d->top, [&] { d->clock(); }, address, write, data, 20000);
}

int32_t device_counter(void *h, uint32_t address) {
  auto *d = static_cast<Device *>(h);
  return status_word(d->top, [&] { d->clock(); }, address);
}

uint32_t device_state(void *h) {
  auto *d = static_cast<Device *>(h);
  return diagnostic_state(d->top, [&] { d->clock(); });
}

// Levels for given numbers of clocks, beginning with 0 and alternating: noise. Ends with 1.
void device_noise(void *h, int n, const uint32_t *clocks) {
  auto *d = static_cast<Device *>(h);
  for (int i = 0; i < n; ++i) {
    d->top.rxd_i = i & 1;
    d->run_to(d->now() + clocks[i]);
  }
  d->top.rxd_i = 1;
}

// Send n characters (gaps: clocks of silence before each; faults: SentFault), sender's bits longer by `offset`, then wait
// until an answer has ended or `patience` clocks have passed without one beginning.
void device_xfer(void *h, int n, const uint8_t *bytes, const uint32_t *gaps, const uint8_t *faults, double offset,
                 uint32_t patience, Outcome *out) {
  auto *d = static_cast<Device *>(h);
  auto &m = d->monitor;
  std::memset(d->strobes, 0, sizeof d->strobes);
  d->write_count = d->count = 0;
  m.clear();
  LineDriver driver(d->format, d->bit_time * (1 + offset));
  for (int i = 0; i < n; ++i) {
    driver.start(bytes[i], gaps[i], SentFault(faults[i]));
    while (driver.busy()) {
      d->top.rxd_i = driver.clock();
      d->clock();
    }
  }
  d->top.rxd_i = 1;
  const uint64_t end = d->now();
  if (d->later_clocks >= 0) d->change_at = int64_t(end) + d->later_clocks;
  d->later_clocks = -1;
  while (!m.ended() && (m.enabled() || d->now() < end + patience)) d->clock();
  out->answer_bytes = m.fault() != LineFault::kNone ? int(m.fault()) : m.ended() ? d->count : 0;
  out->latency = int64_t(m.begin()) - int64_t(end);
  out->lead = int64_t(m.begin()) - int64_t(m.rise());
  out->tail = int64_t(m.fall()) - int64_t(m.end());
  std::memcpy(out->answer, d->answer, sizeof out->answer);
  std::memcpy(out->strobes, d->strobes, sizeof out->strobes);
  out->write_count = d->write_count;
  std::memcpy(out->writes, d->writes, sizeof out->writes);
  std::memcpy(out->write_last, d->write_last, sizeof out->write_last);
  std::memcpy(out->write_file, d->write_file, sizeof out->write_file);
}

}  // extern "C"
