// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// A verilated modbus_example_auto with a master whose rate and format are its own: times are in clocks, not whole ones.

#include <cmath>
#include <cstdint>
#include <vector>

#include "model.h"

namespace {

struct Edge {
  double time;
  int level;
};

struct Device {
  VerilatedContext context;
  Vmodel top{&context};
  double now = 0;
  std::vector<Edge> heard;  // of txd_o, while de_o is high
  int txd = 1, drove = 0;
  uint64_t frames = 0, locks = 0, locked = 0;

  bool echo = false;  // what is sent is heard
  int line = 1;       // what the master puts on the line

  void clock() {
    top.rxd_i = echo && top.de_o ? top.txd_o : line;
    cycle(top);
    now += 1;
    if (top.txd_o != txd) heard.push_back({now, txd = top.txd_o});
    drove |= top.de_o;
    frames += top.events_o & 1;
    locks += top.locked_o && !locked;
    locked = top.locked_o;
  }
  void until(double time) {
    while (now < time) clock();
  }
  void level(double time, int value) {
    until(time);
    line = value;
  }
};

int parity_of(int byte, int format) { return __builtin_parity(byte) ^ (format == 1); }

// Bits of a character behind its start bit: 9 to 10.
int bits_of(int byte, int format, int *bits) {
  int n = 0;
  for (int i = 0; i < 8; ++i) bits[n++] = byte >> i & 1;
  if (format < 2) bits[n++] = parity_of(byte, format);
  bits[n++] = 1;
  if (format == 2) bits[n++] = 1;
  return n;
}

}  // namespace

extern "C" {

void *auto_new() {
  auto *d = new Device;
  d->top.rxd_i = 1;
  d->top.rst_i = 0;
  return d;
}

void auto_free(void *h) { delete static_cast<Device *>(h); }

double auto_now(void *h) { return static_cast<Device *>(h)->now; }

void auto_reset(void *h) {
  auto *d = static_cast<Device *>(h);
  d->top.rst_i = 1;
  d->clock();
  d->top.rst_i = 0;
}

void auto_echo(void *h, int on) { static_cast<Device *>(h)->echo = on; }

// The line has this level for so many clocks.
void auto_rest(void *h, double clocks, int level) {
  auto *d = static_cast<Device *>(h);
  d->line = level;
  d->until(d->now + clocks);
}

// Sends bytes: bits of `bit` clocks, begin `phase` clocks from now, `gap` bits of silence behind each character.  The
// first `skip` clocks are not on the line (the device was switched on in the middle).  `skew`: clocks by which a rising
// edge is late.  `jitter`: up to so many clocks by which any edge is late.
void auto_send(void *h, const uint8_t *data, int count, double bit, int format, double phase, double gap, double skip,
               double skew, double jitter, uint32_t seed) {
  auto *d = static_cast<Device *>(h);
  double time = d->now + phase;
  const double from = time + skip, shift = -skip;
  int level = 1;
  for (int n = 0; n < count; ++n) {
    int bits[11] = {0}, many = 1 + bits_of(data[n], format, bits + 1);
    for (int i = 0; i < many; ++i, time += bit) {
      if (bits[i] == level) continue;
      level = bits[i];
      seed = seed * 1664525u + 1013904223u;
      const double late = (level ? skew : 0) + jitter * (seed >> 8) / double(1 << 24);
      if (time >= from) d->level(time + shift + late, level);
      else d->line = level;
    }
    time += gap * bit;
  }
  d->until(time + shift);
}

// Waits for an answer that is sent with this bit time and format; of two stop bits the first is looked at, as UARTs do.
// Returns its bytes, 0 for none within `patience`
// clocks, -1 if what came is not this format.  `begin`: clock of its first start bit.
int auto_answer(void *h, double bit, int format, double patience, uint8_t *data, int room, double *begin) {
  auto *d = static_cast<Device *>(h);
  if (format == 2) format = 3;
  d->heard.clear();
  d->drove = 0;
  const double end = d->now + patience;
  while (d->now < end && !d->top.de_o) d->clock();
  if (!d->top.de_o) return 0;
  while (d->top.de_o) d->clock();
  const auto &edges = d->heard;
  if (edges.empty() || edges[0].level) return -1;
  *begin = edges[0].time;
  size_t place = 0;
  int count = 0;
  while (place < edges.size()) {
    const double start = edges[place].time;
    auto at = [&](double time) {
      size_t p = place;
      while (p + 1 < edges.size() && edges[p + 1].time <= time) ++p;
      return edges[p].level;
    };
    int bits[11], many = bits_of(0, format, bits);
    if (at(start + bit / 2)) return -1;
    int byte = 0;
    for (int i = 0; i < 8; ++i) byte |= at(start + bit * (1.5 + i)) << i;
    many = bits_of(byte, format, bits);
    for (int i = 8; i < many; ++i)
      if (at(start + bit * (1.5 + i)) != bits[i]) return -1;
    if (count < room) data[count++] = uint8_t(byte);
    const double behind = start + bit * (0.5 + many);
    while (place < edges.size() && (edges[place].time <= behind || edges[place].level)) ++place;
  }
  return count;
}

// Random levels for so many clocks: runs of `shortest` to `longest` clocks, now and then a silence.
void auto_noise(void *h, double clocks, double shortest, double longest, double silence, uint32_t seed) {
  auto *d = static_cast<Device *>(h);
  const double end = d->now + clocks;
  int level = 1;
  while (d->now < end) {
    seed = seed * 1664525u + 1013904223u;
    const double share = (seed >> 8) / double(1 << 24);
    level ^= 1;
    d->line = level;
    seed = seed * 1664525u + 1013904223u;
    const bool rests = level && (seed >> 8) % 64 == 0;
    d->until(d->now + (rests ? silence : shortest * std::pow(longest / shortest, share)));
  }
  d->line = 1;
  d->until(d->now + silence);
}

// {locked, format, bit time in clocks, good frames, times locked}
void auto_state(void *h, uint64_t *state) {
  auto *d = static_cast<Device *>(h);
  state[0] = d->top.locked_o;
  state[1] = d->top.format_o;
  state[2] = d->top.bit_time_o;
  state[3] = d->frames;
  state[4] = d->locks;
}

}  // extern "C"
