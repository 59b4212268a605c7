// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// slave - one compiled device on the line: its clock, its pins, accesses to its host port.

#pragma once

#include <array>
#include <string>
#include <vector>

#include "line.h"
#include "pins.h"

// Names of the strobes of events_o, from bit 0 on.
constexpr std::array<const char *, 8> kEvents = {"frame", "parity", "framing", "overrun",
                                                 "crc",   "short",  "long",    "gap"};
enum Event { kFrame, kParityError, kFramingError, kOverrun, kCrcError, kShort, kLong, kGap };

// Accesses to the host port that are one piece for the line: addresses are {space, item}.
struct HostAccess {
  bool write = false;
  std::vector<uint32_t> addresses;
  std::vector<uint16_t> values;  // to write, or read so far
  size_t done = 0;
  bool refused = false;
  unsigned waited = 0;

  bool finished() const { return refused || done == addresses.size(); }
};

class Slave {
 public:
  Slave(unsigned address, CharacterFormat format, unsigned bit_time)
      : address_(address), monitor_(format, bit_time) {}

  Pins &pins() { return *top_; }
  const Pins &pins() const { return *top_; }
  LineMonitor &monitor() { return monitor_; }
  unsigned address() const { return address_; }
  bool working() const { return !top_->idle_o && !receiving(); }
  // Inside a frame of ASCII mode, which may be silent for long
  bool receiving() const { return top_->ascii_i && top_->rx_active_o; }
  bool driving() const { return top_->de_o; }

  // Strobes since the last request was judged, and all of them counted.
  unsigned strobes = 0;
  std::array<uint64_t, 8> counts{};

  // One clock. True if something came at the ports that counts: a strobe of the core, a write.
  bool clock(bool rxd) {
    top_->rxd_i = rxd;
    top_->cycle();
    if (!top_->events_o) return top_->write_stb_o;
    strobes |= top_->events_o;
    for (unsigned i = 0; i < counts.size(); ++i) counts[i] += top_->events_o >> i & 1;
    return true;
  }

  // Shows the next beat of an access at the host port; takes the last one, which this clock has answered.
  void step(HostAccess &access) {
    if (top_->host_cyc_i && (top_->host_ack_o || top_->host_err_o)) {
      access.refused = top_->host_err_o;
      if (!access.refused) {
        if (!access.write) access.values.push_back(top_->host_dat_o);
        ++access.done;
      }
      access.waited = 0;
    } else if (top_->host_cyc_i && ++access.waited > LONGEST_WAIT) {
      access.refused = true;
    }
    const bool more = !access.finished();
    top_->host_cyc_i = top_->host_stb_i = more;
    top_->host_we_i = more && access.write;
    if (!more) return;
    top_->host_adr_i = access.addresses[access.done];
    if (access.write) top_->host_dat_i = access.values[access.done];
  }

 private:
  static constexpr unsigned LONGEST_WAIT = 100000;  // clocks
  unsigned address_;
  std::unique_ptr<Pins> top_ = new_device();
  LineMonitor monitor_;
};
