// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// The main program of a model of Verilator that cocotb plays (runner.py): the regions of a time step in the order of
// IEEE 1800-2012, clause 4.4, as in cocotb's own program, in a fraction of its time.
//
// Much of its time goes into looking for signals that have changed. Here that is done only where one can have changed.
// The clock is toggled here (own_clock.py calls bench_clock), and not by a callback of VPI for each half of its period.

#include <algorithm>
#include <cstdint>
#include <memory>

#include "Vtop.h"
#include "verilated.h"
#include "verilated_vpi.h"

extern "C" void vlog_startup_routines_bootstrap();   // of cocotb's library

namespace {

constexpr uint64_t kNever = ~uint64_t(0);
uint64_t now = 0;                                    // steps of the simulator's precision

// The clock: its pin, if the top has one, the next edge and the level that follows it
CData *pin = nullptr;
uint64_t half_period = 0, edge_at = kNever;
bool level = false;

template <class Top> auto clock_of(Top &top, int) -> decltype(&top.clk_i) { return &top.clk_i; }
template <class Top> CData *clock_of(Top &, long) { return nullptr; }

// The clock's edge, if it is due.
bool toggle() {
  if (now < edge_at) return false;
  *pin = level;
  level = !level;
  edge_at += half_period;
  return true;
}

// Calls back for signals that have changed, which may change others.
void settle() {
  while (VerilatedVpi::callValueCbs()) {}
}

// All that happens at one time. `timed`: a timer has ended, and whoever waited for it may have written to signals.
void step(Vtop &top, bool timed) {
  bool changed = timed;
  if (!timed && toggle()) {
    settle();
    changed = true;
  }
  do {
    do {
      if (changed) top.eval_step();
      VerilatedVpi::clearEvalNeeded();
      VerilatedVpi::doInertialPuts();
      changed = toggle();                            // together with what was written, as if VPI had written it
      settle();
      changed |= VerilatedVpi::evalNeeded();
    } while (changed);
    if (VerilatedVpi::callCbs(cbReadWriteSynch)) {
      VerilatedVpi::doInertialPuts();
      settle();
      changed = VerilatedVpi::evalNeeded();
    }
  } while (changed);
  top.eval_end_step();
  VerilatedVpi::callCbs(cbReadOnlySynch);
}

}  // namespace

double sc_time_stamp() { return double(now); }

// Starts the clock with a rising edge now, or stops it if `period` is 0; 0 if the top has no clk_i.
extern "C" int bench_clock(uint64_t period) {
  half_period = period / 2;
  edge_at = pin && period ? now : kNever;
  level = true;
  return pin != nullptr;
}

int main(int argc, char **argv) {
  Verilated::commandArgs(argc, argv);
  const auto top = std::make_unique<Vtop>("");
  pin = clock_of(*top, 0);
  Verilated::fatalOnVpiError(false);
  vlog_startup_routines_bootstrap();
  Verilated::addExitCb([](void *) { VerilatedVpi::callCbs(cbEndOfSimulation); }, nullptr);
  VerilatedVpi::callCbs(cbStartOfSimulation);
  settle();
  bool timed = true;
  while (!Verilated::gotFinish()) {
    step(*top, timed);
    uint64_t next = VerilatedVpi::cbNextDeadline();
    if (top->eventsPending()) next = std::min(next, top->nextTimeSlot());
    timed = next <= edge_at;
    now = std::min(next, edge_at);
    if (now == kNever) break;                        // nobody waits for anything
    if (VerilatedVpi::callCbs(cbNextSimTime)) settle();
    if (timed) {
      VerilatedVpi::callTimedCbs();
      settle();
    }
  }
  top->final();
  VerilatedVpi::callCbs(cbEndOfSimulation);
  return Verilated::threadContextp()->errorCount() > 0;
}
