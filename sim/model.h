// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// model - what every C++ file around a compiled model (tools/models.py) does with it: a clock, a host access, a word
// of the status port.

#pragma once

#include <cstdint>

#include "Vmodel.h"
#include "Vmodel___024root.h"
#include "verilated.h"

inline double sc_time_stamp() { return 0; }

constexpr int32_t kRefused = -1, kSilent = -2;  // of the ports below

// The level that Verilator has seen of the clock, under its name in Verilator 5.006 or in 5.048; nullptr in others.
template <class Root> auto seen_of(Root &root, int, int) -> decltype(&root.__Vtrigrprev__TOP__clk_i) {
  return &root.__Vtrigrprev__TOP__clk_i;
}
template <class Root> auto seen_of(Root &root, int, long) -> decltype(&root.__Vtrigprevexpr___TOP__clk_i__0) {
  return &root.__Vtrigprevexpr___TOP__clk_i__0;
}
template <class Root> CData *seen_of(Root &, long, long) { return nullptr; }

// One clock cycle; the outputs are then those behind the edge.  Nothing happens at the falling edge: where Verilator
// can be told that the clock was low, it need not be evaluated there, which saves a quarter of the time.
inline void cycle(Vmodel &top) {
  CData *const seen = seen_of(*top.rootp, 0, 0);
  if (seen) {
    *seen = 0;
  } else {
    top.clk_i = 0;
    top.eval();
  }
  top.clk_i = 1;
  top.eval();
}

// One access at the host port: the value read (0 for a write), kRefused for err, kSilent for no answer within
// `patience` clocks.  `clock` lets one pass.
template <class Top, class Clock>
int32_t host_access(Top &top, Clock clock, uint32_t address, bool write, uint32_t data, int patience) {
  top.host_cyc_i = top.host_stb_i = 1;
  top.host_we_i = write;
  top.host_adr_i = address;
  top.host_dat_i = data;
  int32_t result = kSilent;
  while (result == kSilent && patience-- > 0) {
    top.eval();
    if (top.host_err_o) result = kRefused;
    else if (top.host_ack_o) result = write ? 0 : int32_t(top.host_dat_o);
    clock();
  }
  top.host_cyc_i = top.host_stb_i = top.host_we_i = 0;
  clock();
  return result;
}

// One word of the status port, or kSilent.
template <class Top, class Clock>
int32_t status_word(Top &top, Clock clock, uint32_t address) {
  top.status_stb_i = 1;
  top.status_adr_i = address;
  int32_t result = kSilent;
  for (int patience = 1000; result == kSilent && patience-- > 0;) {
    clock();
    if (top.status_ack_o) result = top.status_dat_o;
  }
  top.status_stb_i = 0;
  clock();
  return result;
}

// {listen-only, entries of the log, diagnostic register}
template <class Top, class Clock>
uint32_t diagnostic_state(Top &top, Clock clock) {
  const uint32_t entries = uint32_t(status_word(top, clock, 2));
  return uint32_t(top.listen_only_o) << 23 | entries << 16 | uint32_t(status_word(top, clock, 0));
}
