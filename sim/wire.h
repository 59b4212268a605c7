// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// wire - levels over time: characters as they should be or with faults, and a receiver that takes them as a UART does.

#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "line.h"

// A level for a number of bit times.
struct Piece {
  double bits;
  bool level;
};

// What is wrong with one character.
struct Wrong {
  int flip = -1;           // data bit that is inverted
  bool parity = false, stop = false;
  double low_bits = 0;     // a break so long instead of the character
  double glitch = 0;       // a low pulse of so many bits before the start bit
  double jitter = 0;       // each edge moves by up to so many bits
  double rate = 1;         // bits last so many times as long
  double gap = 0;          // silence before it, in bits
};

// Random numbers that are the same in every run (xorshift).
class Dice {
 public:
  double roll() {  // 0 up to 1
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return double(state_ >> 11) / double(1ull << 53);
  }

 private:
  uint64_t state_ = 0x9E3779B97F4A7C15ull;
};

// The pieces of a character, appended to `pieces`.
inline void append_character(std::vector<Piece> &pieces, CharacterFormat format, unsigned data, const Wrong &wrong,
                             Dice &dice) {
  if (wrong.gap > 0) pieces.push_back({wrong.gap, true});
  if (wrong.glitch > 0) {
    pieces.push_back({wrong.glitch, false});
    pieces.push_back({1, true});
  }
  if (wrong.low_bits > 0) {
    pieces.push_back({wrong.low_bits, false});
    pieces.push_back({double(format.stops), true});
    return;
  }
  std::vector<bool> bits{false};
  for (int i = 0; i < format.data; ++i) bits.push_back((data >> i & 1) != (i == wrong.flip));
  if (format.parity) bits.push_back(format.parity_bit(data) != wrong.parity);
  if (wrong.stop) bits.push_back(false);
  for (int i = 0; i < format.stops; ++i) bits.push_back(true);
  double shift = 0;  // of the edge before the piece
  for (size_t i = 0; i < bits.size();) {
    size_t run = i;
    while (run < bits.size() && bits[run] == bits[i]) ++run;
    const double next = run < bits.size() ? wrong.jitter * (2 * dice.roll() - 1) : 0;
    pieces.push_back({(double(run - i) - shift + next) * wrong.rate, bits[i]});
    shift = next;
    i = run;
  }
}

// Plays pieces, one level a clock.  Edges are rounded to a clock and the fractions add up.
class Wave {
 public:
  explicit Wave(double bit_clocks) : bit_(bit_clocks) {}
  bool busy() const { return !parts_.empty(); }

  void append(const std::vector<Piece> &pieces) {
    if (!busy() && end_ < double(now_)) end_ = double(now_);
    for (const Piece &piece : pieces) {
      end_ += piece.bits * bit_;
      const uint64_t until = uint64_t(std::llround(end_));
      if (until > (busy() ? parts_.back().until : now_)) parts_.push_back({until, piece.level});
    }
  }

  bool clock() {
    if (parts_.empty()) return true;
    const bool level = parts_.front().level;
    if (++now_ >= parts_.front().until) parts_.pop_front();
    return level;
  }

 private:
  struct Part {
    uint64_t until;
    bool level;
  };
  double bit_, end_ = 0;  // when all parts have been played, in clocks of this wave
  uint64_t now_ = 0;
  std::deque<Part> parts_;
};

// A character as a UART takes it.
struct Received {
  uint8_t data;
  bool parity_error, framing_error;
  uint64_t start;  // clock of its start bit
};

// Takes characters off a line: start bit confirmed in its middle, bits sampled in theirs, behind a low stop bit it
// waits for a high line.
class Receiver {
 public:
  Receiver(CharacterFormat format, double bit_clocks) : format_(format), bit_(bit_clocks) {}

  // One clock of the line; true if a character is complete, in the middle of its first stop bit.
  bool clock(bool level, uint64_t now, Received &got) {
    if (bit_number_ < 0) {
      if (level) armed_ = true;
      else if (armed_) begin(now);
      return false;
    }
    if (now < sample_at_) return false;
    return sample(level, now, got);
  }

  bool busy() const { return bit_number_ >= 0; }

 private:
  void begin(uint64_t now) {
    armed_ = false;
    start_ = now;
    bits_ = 0;
    bit_number_ = 0;
    sample_at_ = now + uint64_t(bit_ / 2);
  }

  bool sample(bool level, uint64_t, Received &got) {
    if (bit_number_ == 0 && level) {  // a glitch
      bit_number_ = -1;
      armed_ = true;
      return false;
    }
    bits_ |= unsigned(level) << bit_number_;
    ++bit_number_;
    sample_at_ = start_ + uint64_t(bit_ * (bit_number_ + 0.5));
    if (bit_number_ < 1 + format_.data + format_.parity + 1) return false;
    const unsigned data = bits_ >> 1 & ((1u << format_.data) - 1);
    got = {uint8_t(data), format_.parity && bool(bits_ >> (1 + format_.data) & 1) != format_.parity_bit(data), !level,
           start_};
    bit_number_ = -1;
    armed_ = level;
    return true;
  }

  CharacterFormat format_;
  double bit_;
  bool armed_ = true;
  int bit_number_ = -1;
  unsigned bits_ = 0;
  uint64_t start_ = 0, sample_at_ = 0;
};
