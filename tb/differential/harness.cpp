// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// A verilated modbus_rtu_slave behind a few C functions: a bit-timed line, the host port, strobes.
//
// No protocol here: bytes become levels and levels become bytes.  The answer is read on the grid of bit times, so a
// bit of a wrong length, an idle bit between characters or de_o not covering the answer is an error, not an answer.

#include <cstdint>
#include <cstring>

#include "Vslave_bench.h"
#include "verilated.h"

double sc_time_stamp() { return 0; }

namespace {

constexpr int kStrobes = 8;   // parity framing overrun crc short long gap good, as in defs.py
constexpr int kMaxWrites = 40;     // a 15H request has up to 27 groups
constexpr int kMaxAnswer = 300;

enum Fault : uint8_t { kNoFault = 0, kParity = 1, kFraming = 2 };
enum LineFault : int { kOffGrid = -1, kGap = -2, kBadParity = -3, kBadStop = -4, kDeShort = -5, kTxdWithoutDe = -6 };

struct Device {
  VerilatedContext context;
  Vslave_bench top{&context};
  uint64_t now = 0;
  uint32_t bit_time = 8;
  int parity = 0;   // 0 even, 1 odd, -1 none
  int stops = 1;
  uint32_t strobes[kStrobes] = {};
  uint32_t writes[kMaxWrites] = {};   // {space, first}
  uint32_t write_last[kMaxWrites] = {}, write_file[kMaxWrites] = {};
  int write_count = 0;
  bool de = false, txd = true;
  // The answer being read
  uint8_t answer[kMaxAnswer];
  int count = 0, line_fault = 0;
  bool begun = false, finished = false;
  uint64_t first_start = 0, start = 0, de_rise = 0, de_fall = 0;
  int bit = -1, ones = 0;
  uint32_t byte = 0;

  int length() const { return 9 + (parity >= 0) + stops; }

  void fail(LineFault fault) { if (!line_fault) line_fault = fault; }

  void clock() {
    top.clk_i = 1;
    top.eval();
    top.clk_i = 0;
    top.eval();
    ++now;
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
    watch(top.txd_o, top.de_o);
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

  // One clock of the device's output.
  void watch(bool level, bool enable) {
    if (enable && !de) { de_rise = now; begun = false; count = 0; bit = -1; line_fault = 0; }
    if (level != txd) {
      if (!enable) fail(kTxdWithoutDe);
      if (bit < 0) {                                  // a start bit
        if (!begun) { begun = true; first_start = now; }
        else if (now != start + uint64_t(length()) * bit_time) fail(kGap);
        start = now; bit = 0; byte = 0; ones = 0;
      } else if ((now - start) % bit_time) {
        fail(kOffGrid);
      }
      txd = level;
    }
    if (bit >= 0 && now == start + uint64_t(bit) * bit_time + bit_time / 2) sample(level);
    if (!enable && de) {
      de_fall = now;
      finished = true;
      if (!begun || bit >= 0 || now < start + uint64_t(length()) * bit_time) fail(kDeShort);
    }
    de = enable;
  }

  void sample(bool level) {
    if (bit >= 1 && bit <= 8) { byte |= uint32_t(level) << (bit - 1); ones += level; }
    if (bit == 9 && parity >= 0 && ((ones + level) & 1) != parity) fail(kBadParity);
    if (bit >= length() - stops && !level) fail(kBadStop);
    if (++bit == length()) {
      if (count < kMaxAnswer) answer[count] = uint8_t(byte);
      ++count;
      bit = -1;
    }
  }

  void run_to(uint64_t time) { while (now < time) clock(); }
};

}  // namespace

extern "C" {

struct Setup {
  uint32_t address, bit_time, format, broadcast_en, gap_count_only, strict_turnaround, response_delay, stall_limit,
      de_lead, de_tail, busy, write_lock, failure, exception_status, run_indicator, diagnostic;
};

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
  auto &t = d->top;
  t.address_i = s->address;
  t.bit_time_i = s->bit_time;
  t.format_i = s->format;
  t.broadcast_en_i = s->broadcast_en;
  t.gap_count_only_i = s->gap_count_only;
  t.strict_turnaround_i = s->strict_turnaround;
  t.response_delay_i = s->response_delay;
  t.stall_limit_i = s->stall_limit;
  t.de_lead_i = s->de_lead;
  t.de_tail_i = s->de_tail;
  t.busy_i = s->busy;
  t.write_lock_i = s->write_lock;
  t.failure_i = s->failure;
  t.exception_status_i = s->exception_status;
  t.run_indicator_i = s->run_indicator;
  t.diagnostic_i = s->diagnostic;
  d->bit_time = s->bit_time;
  d->parity = s->format < 2 ? int(s->format) : -1;
  d->stops = s->format == 2 ? 2 : 1;
}

void device_idle(void *h, uint32_t clocks) {
  auto *d = static_cast<Device *>(h);
  d->run_to(d->now + clocks);
}

void device_reset(void *h) {
  auto *d = static_cast<Device *>(h);
  d->top.rst_i = 1;
  device_idle(h, 4);
  d->top.rst_i = 0;
}

// One host access; the value read (0 for a write), or -1 for err, -2 for no answer.
int32_t device_host(void *h, uint32_t address, int write, uint32_t data) {
  auto *d = static_cast<Device *>(h);
  auto &t = d->top;
  t.host_cyc_i = t.host_stb_i = 1;
  t.host_we_i = write;
  t.host_adr_i = address;
  t.host_dat_i = data;
  int32_t result = -2;
  for (int patience = 0; patience < 20000; ++patience) {
    t.eval();
    const bool ack = t.host_ack_o, err = t.host_err_o;
    const uint32_t value = t.host_dat_o;
    d->clock();
    if (ack || err) { result = err ? -1 : write ? 0 : int32_t(value); break; }
  }
  t.host_cyc_i = t.host_stb_i = t.host_we_i = 0;
  d->clock();
  return result;
}

// One word of the status port, or -2 for no answer.
int32_t device_counter(void *h, uint32_t address) {
  auto *d = static_cast<Device *>(h);
  auto &t = d->top;
  t.status_stb_i = 1;
  t.status_adr_i = address;
  int32_t result = -2;
  for (int patience = 0; patience < 1000 && result < 0; ++patience) {
    d->clock();
    if (t.status_ack_o) result = t.status_dat_o;
  }
  t.status_stb_i = 0;
  d->clock();
  return result;
}

// {listen-only, entries of the log, diagnostic register}
uint32_t device_state(void *h) {
  const uint32_t listen_only = static_cast<Device *>(h)->top.listen_only_o;
  return listen_only << 23 | uint32_t(device_counter(h, 2)) << 16 | uint32_t(device_counter(h, 0));
}

// Levels for given numbers of clocks, beginning with 0 and alternating: noise. Ends with 1.
void device_noise(void *h, int n, const uint32_t *clocks) {
  auto *d = static_cast<Device *>(h);
  for (int i = 0; i < n; ++i) {
    d->top.rxd_i = i & 1;
    d->run_to(d->now + clocks[i]);
  }
  d->top.rxd_i = 1;
}

// Send n characters (gaps: clocks of silence before each; faults: Fault), sender's bits longer by `offset`, then wait until
// an answer has ended or `patience` clocks have passed without one beginning.
void device_xfer(void *h, int n, const uint8_t *bytes, const uint32_t *gaps, const uint8_t *faults, double offset,
                 uint32_t patience, Outcome *out) {
  auto *d = static_cast<Device *>(h);
  std::memset(d->strobes, 0, sizeof d->strobes);
  d->write_count = d->count = d->line_fault = 0;
  d->finished = d->begun = false;
  const double bit = d->bit_time * (1 + offset);
  double time = double(d->now);
  auto hold = [&](bool level, double bits) {
    d->top.rxd_i = level;
    time += bits * bit;
    d->run_to(uint64_t(time + 0.5));
  };
  for (int i = 0; i < n; ++i) {
    time += gaps[i];
    d->run_to(uint64_t(time + 0.5));
    hold(false, 1);
    int ones = 0;
    for (int b = 0; b < 8; ++b) {
      const bool level = bytes[i] >> b & 1;
      ones += level;
      hold(level, 1);
    }
    if (d->parity >= 0) hold(((ones & 1) ^ d->parity) ^ (faults[i] == kParity), 1);
    if (faults[i] == kFraming) hold(false, 1);
    hold(true, d->stops);
  }
  const uint64_t end = d->now;
  while (!d->finished && (d->de || d->now < end + patience)) d->clock();
  out->answer_bytes = d->line_fault ? d->line_fault : d->finished ? d->count : 0;
  out->latency = int64_t(d->first_start) - int64_t(end);
  out->lead = int64_t(d->first_start) - int64_t(d->de_rise);
  out->tail = int64_t(d->de_fall) - int64_t(d->start) - int64_t(d->length()) * d->bit_time;
  std::memcpy(out->answer, d->answer, sizeof out->answer);
  std::memcpy(out->strobes, d->strobes, sizeof out->strobes);
  out->write_count = d->write_count;
  std::memcpy(out->writes, d->writes, sizeof out->writes);
  std::memcpy(out->write_last, d->write_last, sizeof out->write_last);
  std::memcpy(out->write_file, d->write_file, sizeof out->write_file);
}

}  // extern "C"
