// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// Many compiled slave_bench on one two-wire line behind a few C functions.
//
// Time is counted in clocks of the master.  A node's own clock may be faster or slower: it then gets two edges or none
// in some of them.  A driver that is enabled drives; nobody driving is 1; two driving are counted, and the line is then
// the AND of them.  No protocol here.

#include <cstdint>
#include <memory>
#include <vector>

#include "model.h"

namespace {

enum Count { kDrives, kFrames, kErrors, kWrites, kCounts };

struct Node {
  std::unique_ptr<Vmodel> top;
  double rate = 1, phase = 0;      // clocks in one of the master's
  uint64_t ticks = 0;              // of its own
  uint32_t counts[kCounts] = {};
  bool de = false;

  void tick(bool line) {
    top->rxd_i = line;
    cycle(*top);
    ++ticks;
    counts[kFrames] += top->frame_stb_o;
    counts[kWrites] += top->write_stb_o;
    counts[kErrors] += top->err_parity_o | top->err_framing_o | top->err_overrun_o | top->err_crc_o | top->err_short_o |
                       top->err_long_o | top->err_gap_o;
    if (top->de_o && !de) ++counts[kDrives];
    de = top->de_o;
  }
};

struct Edge { int64_t ticks; int32_t level; };

struct Bus {
  VerilatedContext context;
  std::vector<Node> nodes;
  uint64_t now = 0, collisions = 0;
  bool master_level = true, master_de = false;
  // The transmission of the node that drove last
  int speaker = -1;
  bool driving = false, finished = false, level = true;
  int64_t rise = 0, fall = 0, rise_ticks = 0, fall_ticks = 0;
  std::vector<Edge> edges;

  void clock() {
    int drivers = master_de;
    bool line = !master_de || master_level;
    for (auto &n : nodes) {
      if (!n.de) continue;
      ++drivers;
      line = line && n.top->txd_o;
    }
    if (drivers > 1) ++collisions;
    for (auto &n : nodes) {
      n.phase += n.rate;
      while (n.phase >= 1) {
        n.phase -= 1;
        n.tick(line);
        watch(n);
      }
    }
    ++now;
  }

  void watch(Node &n) {
    const int index = int(&n - nodes.data());
    if (n.de && (speaker != index || !driving)) {
      speaker = index;
      driving = true;
      level = true;
      rise = int64_t(now);
      rise_ticks = int64_t(n.ticks);
      edges.clear();
    }
    if (index != speaker || !driving) return;
    if (bool(n.top->txd_o) != level) {
      level = n.top->txd_o;
      edges.push_back({int64_t(n.ticks), level});
    }
    if (!n.de) {
      driving = false;
      finished = true;
      fall = int64_t(now);
      fall_ticks = int64_t(n.ticks);
    }
  }
};

Bus &bus(void *h) { return *static_cast<Bus *>(h); }

}  // namespace

extern "C" {

struct Answer {
  int32_t speaker, edges;                        // -1: nobody has driven
  int64_t rise, fall, rise_ticks, fall_ticks;    // in clocks of the master and of the speaker
};

void *bus_new(int nodes) {
  auto *b = new Bus;
  b->nodes.resize(nodes);
  for (auto &n : b->nodes) {
    n.top.reset(new Vmodel{&b->context});
    n.top->rxd_i = 1;
    n.top->broadcast_en_i = 1;
    n.top->run_indicator_i = 1;
  }
  return b;
}

void bus_free(void *h) { delete static_cast<Bus *>(h); }

void bus_setup(void *h, int node, double rate, uint32_t address, uint32_t bit_time, uint32_t format, uint32_t lead,
               uint32_t tail) {
  auto &n = bus(h).nodes[node];
  n.rate = rate;
  n.top->address_i = address;
  n.top->bit_time_i = bit_time;
  n.top->format_i = format;
  n.top->de_lead_i = lead;
  n.top->de_tail_i = tail;
}

void bus_run(void *h, uint64_t clocks) {
  for (uint64_t i = 0; i < clocks; ++i) bus(h).clock();
}

void bus_reset(void *h) {
  for (auto &n : bus(h).nodes) n.top->rst_i = 1;
  bus_run(h, 8);
  for (auto &n : bus(h).nodes) n.top->rst_i = 0;
}

uint64_t bus_now(void *h) { return bus(h).now; }
uint64_t bus_collisions(void *h) { return bus(h).collisions; }

// The master drives levels from given times on (clocks from now), and lets go at `end`.
void bus_play(void *h, int n, const uint64_t *times, const uint8_t *levels, uint64_t end) {
  auto &b = bus(h);
  const uint64_t begin = b.now;
  b.finished = false;
  b.master_de = true;
  for (int i = 0; i < n; ++i) {
    while (b.now < begin + times[i]) b.clock();
    b.master_level = levels[i];
  }
  while (b.now < begin + end) b.clock();
  b.master_level = true;
  b.master_de = false;
}

// Until a node has driven and let go, or `patience` clocks have passed without one that drives.
void bus_answer(void *h, uint64_t patience, Answer *out) {
  auto &b = bus(h);
  const uint64_t limit = b.now + patience;
  while (!b.finished && (b.driving || b.now < limit)) b.clock();
  out->speaker = b.finished ? b.speaker : -1;
  out->edges = int32_t(b.edges.size());
  out->rise = b.rise;
  out->fall = b.fall;
  out->rise_ticks = b.rise_ticks;
  out->fall_ticks = b.fall_ticks;
  b.finished = false;
}

int64_t bus_edge(void *h, int i, int32_t *level) {
  *level = bus(h).edges[i].level;
  return bus(h).edges[i].ticks;
}

uint32_t bus_count(void *h, int node, int which) { return bus(h).nodes[node].counts[which]; }

// A host access or a word of the status port: this node's clock runs alone, on a line at rest.
int32_t bus_host(void *h, int node, uint32_t address, int write, uint32_t data) {
  auto &n = bus(h).nodes[node];
  return host_access(*n.top, [&] { n.tick(true); }, address, write, data, 2000);
}

int32_t bus_counter(void *h, int node, uint32_t address) {
  auto &n = bus(h).nodes[node];
  return status_word(*n.top, [&] { n.tick(true); }, address);
}

uint32_t bus_state(void *h, int node) {
  auto &n = bus(h).nodes[node];
  return diagnostic_state(*n.top, [&] { n.tick(true); });
}

}  // extern "C"
