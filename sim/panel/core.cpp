// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// core - the RTL as WebAssembly, for docs/try.html: the same slave_bench as in the tests, compiled by Yosys CXXRTL.
//
// Knows levels and clocks, and nothing of characters or of Modbus: what goes onto rxd_i is a list of runs of a level,
// what leaves is the list of the pins' changes and of the core's strobes.  Everything else is panel/wasm.js.

#include <cstdint>

#include CORE_MODEL  // made by write_cxxrtl

namespace {

constexpr uint32_t kRuns = 1 << 14, kChanges = 1 << 14, kEvents = 1 << 10;

// A level on rxd_i for so many clocks; what the page fills in before run().
struct Run {
  uint32_t level, clocks;
};
Run runs[kRuns];

// {cycle, rxd << 2 | txd << 1 | de}: one for each change.
struct Change {
  uint32_t cycle, pins;
};
Change changes[kChanges];

// What the core has told in a cycle: its strobes, or a write by the master.
struct Event {
  uint32_t cycle, strobes, space_first, last_file;
};
Event events[kEvents];

cxxrtl_design::p_slave__bench top;
uint32_t cycle, change_count, event_count, pins = ~0u;
bool driven = true, echo = false;  // what the master drives; the slave hears its own answer

void tick() {
  if (echo) top.p_rxd__i.set<bool>(driven && (!top.p_de__o.get<bool>() || top.p_txd__o.get<bool>()));
  top.p_clk__i.set<bool>(true);
  top.step();
  top.p_clk__i.set<bool>(false);
  top.step();
  ++cycle;
  const uint32_t now = top.p_rxd__i.get<uint32_t>() << 2 | top.p_txd__o.get<uint32_t>() << 1 | top.p_de__o.get<uint32_t>();
  if (now != pins && change_count < kChanges) changes[change_count++] = {cycle, pins = now};
  const uint32_t strobes =
      top.p_frame__stb__o.get<uint32_t>() | top.p_err__parity__o.get<uint32_t>() << 1 |
      top.p_err__framing__o.get<uint32_t>() << 2 | top.p_err__overrun__o.get<uint32_t>() << 3 |
      top.p_err__crc__o.get<uint32_t>() << 4 | top.p_err__short__o.get<uint32_t>() << 5 |
      top.p_err__long__o.get<uint32_t>() << 6 | top.p_err__gap__o.get<uint32_t>() << 7 |
      top.p_write__stb__o.get<uint32_t>() << 8;
  if (strobes && event_count < kEvents)
    events[event_count++] = {cycle, strobes, top.p_write__space__o.get<uint32_t>() << 16 | top.p_write__first__o.get<uint32_t>(),
                             top.p_write__file__o.get<uint32_t>() << 16 | top.p_write__last__o.get<uint32_t>()};
}

}  // namespace

#define EXPORT(name) __attribute__((export_name(#name))) extern "C"

EXPORT(runs_at) Run *runs_at() { return runs; }
EXPORT(changes_at) Change *changes_at() { return changes; }
EXPORT(events_at) Event *events_at() { return events; }
EXPORT(run_limit) uint32_t run_limit() { return kRuns; }
EXPORT(change_total) uint32_t change_total() { return change_count; }
EXPORT(event_total) uint32_t event_total() { return event_count; }
EXPORT(now) uint32_t now() { return cycle; }
EXPORT(at_rest) uint32_t at_rest() { return top.p_idle__o.get<bool>() && !top.p_de__o.get<bool>(); }

// The line's settings and the host's state; flags: 0 busy, 1 run indicator, 2 write lock, 3 gap only counted,
// 4 the slave hears its own answer.
EXPORT(setup) void setup(uint32_t address, uint32_t bit_time, uint32_t format, uint32_t flags, uint32_t failure, uint32_t status,
                         uint32_t diagnostic) {
  echo = flags >> 4 & 1;
  top.p_address__i.set<uint32_t>(address);
  top.p_bit__time__i.set<uint32_t>(bit_time);
  top.p_format__i.set<uint32_t>(format);
  top.p_broadcast__en__i.set<bool>(true);
  top.p_gap__count__only__i.set<bool>(flags >> 3 & 1);
  top.p_busy__i.set<bool>(flags & 1);
  top.p_run__indicator__i.set<bool>(flags >> 1 & 1);
  top.p_write__lock__i.set<bool>(flags >> 2 & 1);
  top.p_failure__i.set<uint32_t>(failure);
  top.p_exception__status__i.set<uint32_t>(status);
  top.p_diagnostic__i.set<uint32_t>(diagnostic);
}

// The first `count` runs, one after the other; changes and events are those of this call.
EXPORT(run) void run(uint32_t count) {
  change_count = event_count = 0;
  pins = ~0u;
  for (uint32_t i = 0; i < count; ++i) {
    top.p_rxd__i.set<bool>(driven = runs[i].level);
    for (uint32_t k = runs[i].clocks; k; --k) tick();
  }
}

// Configuration is done: power up, and clear what reset does not.
EXPORT(power_up) void power_up() {
  top.reset();
  cycle = 0;
  top.p_rxd__i.set<bool>(true);
  top.p_rst__i.set<bool>(true);
  for (int i = 0; i < 16; ++i) tick();
  top.p_rst__i.set<bool>(false);
}

// One access at the host port: the value read, 0 for a write, -1 if refused.
EXPORT(host) int32_t host(uint32_t address, uint32_t write, uint32_t data) {
  top.p_host__adr__i.set<uint32_t>(address);
  top.p_host__we__i.set<bool>(write);
  top.p_host__dat__i.set<uint32_t>(data);
  top.p_host__cyc__i.set<bool>(true);
  top.p_host__stb__i.set<bool>(true);
  int32_t result = -2;
  for (int patience = 100000; result == -2 && patience; --patience) {
    top.step();
    if (top.p_host__err__o.get<bool>()) result = -1;
    else if (top.p_host__ack__o.get<bool>()) result = write ? 0 : int32_t(top.p_host__dat__o.get<uint32_t>());
    tick();
  }
  top.p_host__cyc__i.set<bool>(false);
  top.p_host__stb__i.set<bool>(false);
  tick();
  return result;
}

// One word of the status port, or -2.
EXPORT(status) int32_t status(uint32_t address) {
  top.p_status__adr__i.set<uint32_t>(address);
  top.p_status__stb__i.set<bool>(true);
  int32_t result = -2;
  for (int patience = 1000; result == -2 && patience; --patience) {
    tick();
    if (top.p_status__ack__o.get<bool>()) result = int32_t(top.p_status__dat__o.get<uint32_t>());
  }
  top.p_status__stb__i.set<bool>(false);
  tick();
  return result;
}
