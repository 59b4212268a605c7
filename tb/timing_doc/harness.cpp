// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// A verilated timing_top behind a few C functions: rxd_i toggles at given clocks, changes of watch_o are recorded.
//
// Clock k is the time between the rising edges k and k + 1.  Inputs hold for a whole clock; outputs are read at its end.

#include <cstdint>

#include "model.h"

namespace {

struct Device {
  VerilatedContext context;
  Vmodel top{&context};
  uint64_t now = 0;

  void settle() { top.clk_i = 0; top.eval(); }
  void edge() { top.clk_i = 1; top.eval(); ++now; }
};

}  // namespace

extern "C" {

struct Setup {
  uint32_t bit_time, format, response_delay, stall_limit, de_lead, de_tail, strict_turnaround;
};

struct Peek {
  uint32_t watch, grant_space, grant_first, grant_last, exception, wb_adr, wb_write, wb_read, host_dat;
};

void *device_new() {
  auto *d = new Device;
  d->top.rxd_i = 1;
  return d;
}

void device_free(void *h) { delete static_cast<Device *>(h); }

uint64_t device_now(void *h) { return static_cast<Device *>(h)->now; }

void device_setup(void *h, const Setup *s) {
  auto &t = static_cast<Device *>(h)->top;
  t.bit_time_i = s->bit_time;
  t.format_i = s->format;
  t.response_delay_i = s->response_delay;
  t.stall_limit_i = s->stall_limit;
  t.de_lead_i = s->de_lead;
  t.de_tail_i = s->de_tail;
  t.strict_turnaround_i = s->strict_turnaround;
}

void device_reset(void *h, int level) { static_cast<Device *>(h)->top.rst_i = level; }

void device_host(void *h, int cyc, int stb, int we, uint32_t address, uint32_t data) {
  auto &t = static_cast<Device *>(h)->top;
  t.host_cyc_i = cyc;
  t.host_stb_i = stb;
  t.host_we_i = we;
  t.host_adr_i = address;
  t.host_dat_i = data;
}

// All outputs in the clock that is now, without ending it.
void device_peek(void *h, Peek *p) {
  auto *d = static_cast<Device *>(h);
  d->settle();
  auto &t = d->top;
  *p = {t.watch_o, t.grant_space_o, t.grant_first_o, t.grant_last_o, t.exception_o,
        t.wb_adr_o, t.wb_write_o, t.wb_read_o, t.host_dat_o};
}

// Runs until clock `until`, or to the clock in which watch_o has a bit of `stop` (not ended, so a peek sees it).  rxd_i
// becomes levels[i] in clock times[i].  The first `room` changes of watch_o & mask are recorded; returns their number.
int64_t device_run(void *h, int64_t count, const int64_t *times, const uint8_t *levels, uint64_t until, uint32_t stop,
                   uint32_t mask, int64_t room, uint64_t *when, uint32_t *what) {
  auto *d = static_cast<Device *>(h);
  int64_t next = 0, found = 0;
  bool first = true;
  uint32_t before = 0;
  while (d->now < until) {
    while (next < count && uint64_t(times[next]) <= d->now) d->top.rxd_i = levels[next++];
    d->settle();
    const uint32_t watch = d->top.watch_o;
    if ((first || (watch ^ before) & mask) && found < room) {
      when[found] = d->now;
      what[found++] = watch;
    }
    before = watch;
    if (watch & stop) break;
    first = false;
    d->edge();
  }
  return found;
}

}  // extern "C"
