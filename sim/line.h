// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// line - characters on the UART pins, one clock at a time: start, data, parity, stop, and nothing of Modbus.

#pragma once

#include <cstdint>
#include <cstdio>

// Format codes of the core: 0 = 8E1, 1 = 8O1, 2 = 8N2, 3 = 8N1.
struct CharacterFormat {
  bool parity, odd;
  int stops;
  explicit CharacterFormat(unsigned code) : parity(code < 2), odd(code == 1), stops(code == 2 ? 2 : 1) {}
  int length() const { return 1 + 8 + parity + stops; }
  bool parity_bit(unsigned data) const { return __builtin_parity(data) ^ odd; }
};

// Puts characters on rxd, one level a clock.
class LineDriver {
 public:
  LineDriver(CharacterFormat format, unsigned bit_time) : format_(format), bit_time_(bit_time) {}
  bool busy() const { return left_ > 0; }

  void start(uint8_t data) {
    unsigned tail = ~0u << 9;  // stop bits
    if (format_.parity) tail = ~0u << 10 | unsigned(format_.parity_bit(data)) << 9;
    bits_ = tail | unsigned(data) << 1;  // bit 0 is the start bit
    left_ = format_.length();
    phase_ = 0;
  }

  bool clock() {
    if (!busy()) return true;
    const bool level = bits_ & 1;
    if (++phase_ == bit_time_) {
      phase_ = 0;
      bits_ >>= 1;
      --left_;
    }
    return level;
  }

 private:
  CharacterFormat format_;
  unsigned bit_time_, bits_ = ~0u, phase_ = 0;
  int left_ = 0;
};

// Takes characters off txd while the driver is enabled, sampling each bit at its middle.
class LineMonitor {
 public:
  LineMonitor(CharacterFormat format, unsigned bit_time) : format_(format), bit_time_(bit_time) {}

  // One clock; the character when its last stop bit has been seen, else -1.
  int clock(bool txd, bool enabled) {
    if (!enabled) {
      if (inside_) complain("driver off inside a character");
      inside_ = false;
      return -1;
    }
    if (!inside_) {
      if (txd) return -1;
      inside_ = true;
      phase_ = 0;
      bit_ = 0;
      bits_ = 0;
    }
    if (phase_++ != bit_ * bit_time_ + bit_time_ / 2) return -1;
    bits_ |= unsigned(txd) << bit_;
    if (int(++bit_) < format_.length()) return -1;

    inside_ = false;
    const unsigned data = bits_ >> 1 & 0xFF;
    const unsigned stops = (1u << format_.stops) - 1;
    if (bits_ & 1) complain("start bit too short");
    if (format_.parity && bool(bits_ >> 9 & 1) != format_.parity_bit(data)) complain("wrong parity");
    if ((bits_ >> (9 + format_.parity)) != stops) complain("stop bit is 0");
    return int(data);
  }

 private:
  static void complain(const char *what) { fprintf(stderr, "serve: bad character from the core: %s\n", what); }

  CharacterFormat format_;
  unsigned bit_time_, phase_ = 0, bit_ = 0, bits_ = 0;
  bool inside_ = false;
};
