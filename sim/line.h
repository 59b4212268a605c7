// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// line - characters on the UART pins, one clock at a time: start, data, parity, stop, and nothing of Modbus.
//
// The live device and the compiled models of the test bench share it.

#pragma once

#include <cstdint>

// Format codes of the core: 0 = 8E1, 1 = 8O1, 2 = 8N2, 3 = 8N1; SEVEN_BITS more for characters of 7 bits.
constexpr unsigned FORMAT_BITS = 3, SEVEN_BITS = 4;
struct CharacterFormat {
  bool parity, odd;
  int stops, data;  // bits
  explicit CharacterFormat(unsigned code)
      : parity((code & FORMAT_BITS) < 2), odd((code & FORMAT_BITS) == 1), stops((code & FORMAT_BITS) == 2 ? 2 : 1),
        data(code & SEVEN_BITS ? 7 : 8) {}
  int length() const { return 1 + data + parity + stops; }
  bool parity_bit(unsigned data) const { return __builtin_parity(data) ^ odd; }
};

// What a sender may do wrong on purpose; the codes are those of FAULTS in tb/differential/device.py.
enum class SentFault : uint8_t { kNone = 0, kParity = 1, kFraming = 2 };

// What the core may do wrong; the codes are those of LINE_FAULTS in tb/differential/device.py.
enum class LineFault : int {
  kNone = 0, kOffGrid = -1, kGap = -2, kParity = -3, kStop = -4, kDriverShort = -5, kWithoutDriver = -6
};

inline const char *text(LineFault fault) {
  switch (fault) {
    case LineFault::kNone: return "nothing";
    case LineFault::kOffGrid: return "an edge off the grid of bit times";
    case LineFault::kGap: return "a gap between two characters";
    case LineFault::kParity: return "wrong parity";
    case LineFault::kStop: return "a low stop bit";
    case LineFault::kDriverShort: return "the driver is off inside a character";
    case LineFault::kWithoutDriver: return "the line moves while the driver is off";
  }
  return "?";
}

// Puts characters on rxd, one level a clock.  A bit may last a fraction of a clock more or less than a whole number:
// each edge is rounded to a clock and the fractions add up, over characters that follow each other too.
class LineDriver {
 public:
  LineDriver(CharacterFormat format, double bit_clocks) : format_(format), bit_(bit_clocks) {}
  bool busy() const { return left_ > 0; }

  // The next character, after `gap` clocks of silence.
  void start(uint8_t data, unsigned gap = 0, SentFault fault = SentFault::kNone) {
    const int behind = 1 + format_.data;
    bits_ = ~0u << behind | unsigned(data) << 1;  // bit 0 is the start bit, ones are stop bits
    int length = format_.length();
    if (format_.parity && format_.parity_bit(data) == (fault == SentFault::kParity)) bits_ &= ~(1u << behind);
    if (fault == SentFault::kFraming) bits_ &= ~(1u << (length++ - format_.stops));  // a 0 before the stop bits
    left_ = length;
    end_ += gap;
    gap_ = uint64_t(end_ + 0.5);
    end_ += bit_;
  }

  // The level of this clock, which then ends.
  bool clock() {
    if (!busy()) return true;
    if (now_ < gap_) {
      ++now_;
      return true;
    }
    const bool level = bits_ & 1;
    if (++now_ >= uint64_t(end_ + 0.5)) {
      bits_ >>= 1;
      if (--left_) end_ += bit_;
    }
    return level;
  }

 private:
  CharacterFormat format_;
  double bit_, end_ = 0;  // end of the bit that is on the line, in clocks of this driver
  uint64_t now_ = 0, gap_ = 0;
  unsigned bits_ = ~0u;
  int left_ = 0;
};

// Takes characters off txd while the driver is enabled.  Every edge must lie on the grid of bit times and the
// characters must follow each other without an idle bit; each bit is sampled at its middle.
class LineMonitor {
 public:
  LineMonitor(CharacterFormat format, unsigned bit_time) : format_(format), bit_time_(bit_time) {}

  // Another format or rate, while the line is at rest.
  void set(CharacterFormat format, unsigned bit_time) {
    format_ = format;
    bit_time_ = bit_time;
  }

  // One clock; the character whose last stop bit has just been sampled, else -1.
  int clock(bool txd, bool enabled) {
    ++now_;
    if (enabled && !enabled_) {
      rise_ = now_;
      begun_ = false;
      bit_ = -1;
    }
    if (txd != level_) edge(txd, enabled);
    int character = -1;
    if (bit_ >= 0 && now_ == start_ + uint64_t(bit_) * bit_time_ + bit_time_ / 2) character = sample(txd);
    if (!enabled && enabled_) {
      fall_ = now_;
      ended_ = true;
      if (!begun_ || bit_ >= 0 || now_ < end()) fail(LineFault::kDriverShort);
      bit_ = -1;
    }
    enabled_ = enabled;
    return character;
  }

  // Forget that a transmission has ended, and what was wrong.
  void clear() {
    ended_ = begun_ = false;
    fault_ = LineFault::kNone;
  }

  bool enabled() const { return enabled_; }
  bool ended() const { return ended_; }            // a transmission has, since clear()
  LineFault fault() const { return fault_; }       // the first since clear()
  // In clocks since the beginning: of the driver, of the first start bit, and the end of the last stop bit
  uint64_t now() const { return now_; }
  uint64_t rise() const { return rise_; }
  uint64_t fall() const { return fall_; }
  uint64_t begin() const { return begin_; }
  uint64_t end() const { return start_ + uint64_t(format_.length()) * bit_time_; }

 private:
  void fail(LineFault fault) {
    if (fault_ == LineFault::kNone) fault_ = fault;
  }

  void edge(bool txd, bool enabled) {
    if (!enabled) fail(LineFault::kWithoutDriver);
    if (bit_ < 0) {  // a start bit
      if (!begun_) begin_ = now_;
      else if (now_ != end()) fail(LineFault::kGap);
      begun_ = true;
      start_ = now_;
      bit_ = 0;
      bits_ = 0;
    } else if ((now_ - start_) % bit_time_) {
      fail(LineFault::kOffGrid);
    }
    level_ = txd;
  }

  int sample(bool level) {
    bits_ |= unsigned(level) << bit_;
    if (++bit_ < format_.length()) return -1;
    bit_ = -1;
    const int behind = 1 + format_.data;
    const unsigned data = bits_ >> 1 & ((1u << format_.data) - 1);
    const unsigned stops = (1u << format_.stops) - 1;
    if (format_.parity && bool(bits_ >> behind & 1) != format_.parity_bit(data)) fail(LineFault::kParity);
    if ((bits_ >> (behind + format_.parity)) != stops) fail(LineFault::kStop);
    return int(data);
  }

  CharacterFormat format_;
  unsigned bit_time_, bits_ = 0;
  int bit_ = -1;  // of the character that is on the line
  bool level_ = true, enabled_ = false, begun_ = false, ended_ = false;
  LineFault fault_ = LineFault::kNone;
  uint64_t now_ = 0, start_ = 0, begin_ = 0, rise_ = 0, fall_ = 0;
};
