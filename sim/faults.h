// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// faults - what is done to frames on the line on purpose: which frame, which fault, and what becomes of its pieces.

#pragma once

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "wire.h"

// A frame that is about to go onto the line, and what a fault has made of it.
struct FaultyFrame {
  std::vector<uint8_t> bytes;
  std::vector<Wrong> wrong;     // of each byte
  bool lost = false, echo = false, collision = false;
  int collision_at = 0, collision_value = 0;
  double late_ms = 0;
  std::vector<std::string> injected;  // in words
};

enum class Direction { kRequest, kAnswer };

struct Fault {
  unsigned number = 0;
  Direction direction = Direction::kRequest;
  std::string kind;
  std::map<std::string, double> keys;
  double probability = 0;
  unsigned every = 0, count = 0;  // 0: not given
  unsigned seen = 0, done = 0;

  double key(const char *name) const { return keys.at(name); }
  bool spent() const { return count && done >= count; }

  // True if the fault is for the frame that comes now.
  bool fires(Dice &dice) {
    ++seen;
    if (spent()) return false;
    if (probability > 0 ? dice.roll() >= probability : every && seen % every) return false;
    ++done;
    return true;
  }

  std::string text() const {
    std::string out = kind;
    for (const auto &[name, value] : keys) {
      char number[32];
      snprintf(number, sizeof number, "%g", value);
      out += " " + name + " " + number;
    }
    return out;
  }
};

// What a number may be, and what it is if not given.
struct FaultKey {
  double value, least, most;
  bool whole;

  // What is wrong with a number, or "".
  std::string refuses(double given) const {
    if (given >= least && given <= most && (!whole || given == std::floor(given))) return "";
    char text[80];
    snprintf(text, sizeof text, ": must be a %snumber from %g to %g", whole ? "whole " : "", least, most);
    return text;
  }
};

struct FaultKind {
  bool request;  // it can be in this direction; every kind can be in an answer
  std::map<std::string, FaultKey> keys;
};

enum { ANSWER, BOTH, REAL = 0, WHOLE };
#define KEY(name, value, least, most, whole, meaning) {#name, {value, least, most, whole}},

inline const std::map<std::string, FaultKind> &fault_kinds() {
  static const std::map<std::string, FaultKind> kinds = {
#define KIND(name, direction, meaning, keys) {#name, {direction == BOTH, {keys}}},
#define WHEN(name, least, most, whole, meaning)
#include "fault_kinds.h"
#undef KIND
#undef WHEN
  };
  return kinds;
}

// The keys that every kind has: which frames.
inline const std::map<std::string, FaultKey> &fault_when() {
  static const std::map<std::string, FaultKey> when = {
#define KIND(name, direction, meaning, keys)
#define WHEN(name, least, most, whole, meaning) KEY(name, 0, least, most, whole, meaning)
#include "fault_kinds.h"
#undef KIND
#undef WHEN
  };
  return when;
}
#undef KEY

// "DIRECTION KIND key=value ..." as Fault; the text of what is wrong, or "".
inline std::string parse_fault(const std::vector<std::string> &words, Fault &fault) {
  if (words.size() < 2 || (words[0] != "request" && words[0] != "answer"))
    return "must be request or answer, and a kind";
  fault.direction = words[0] == "request" ? Direction::kRequest : Direction::kAnswer;
  fault.kind = words[1];
  const auto kind = fault_kinds().find(words[1]);
  if (kind == fault_kinds().end()) {
    std::string names;
    for (const auto &[name, unused] : fault_kinds()) names += (names.empty() ? "" : ", ") + name;
    return words[1] + ": no such kind; there are " + names;
  }
  if (fault.direction == Direction::kRequest && !kind->second.request) return words[1] + ": not in this direction";
  const std::map<std::string, FaultKey> &keys = kind->second.keys, &when = fault_when();
  for (const auto &[name, key] : keys) fault.keys[name] = key.value;
  for (size_t i = 2; i < words.size(); ++i) {
    const size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    char *end = nullptr;
    const std::string text = equals == std::string::npos ? "" : words[i].substr(equals + 1);
    const double value = strtod(text.c_str(), &end);
    if (text.empty() || *end || !std::isfinite(value)) return words[i] + ": must be key=number";
    const bool own = keys.count(name);
    if (!own && !when.count(name)) return words[i] + ": " + fault.kind + " has no such key";
    const std::string wrong = (own ? keys : when).at(name).refuses(value);
    if (!wrong.empty()) return words[i] + wrong;
    if (name == "every") fault.every = unsigned(value);
    else if (name == "count") fault.count = unsigned(value);
    else if (name == "probability") fault.probability = value;
    else fault.keys[name] = value;
  }
  if (fault.every && fault.probability > 0) return "every and probability exclude each other";
  if (!fault.every && !(fault.probability > 0)) {
    fault.every = 1;
    if (!fault.count) fault.count = 1;
  }
  return "";
}

// What the fault does to the frame.
inline void apply(const Fault &fault, CharacterFormat format, bool ascii, FaultyFrame &frame) {
  frame.injected.push_back(fault.text());
  const int size = int(frame.bytes.size());
  const int check = ascii ? size - 2 : size;  // behind the check field: CR LF
  const std::string &kind = fault.kind;
  int at = fault.keys.count("character") ? int(fault.key("character")) : 0;
  if (at < 0) at += size;
  const bool inside = at >= 0 && at < size;
  if (kind == "none") frame.lost = true;
  else if (kind == "echo") frame.echo = true;
  else if (kind == "late") frame.late_ms = fault.key("amount");
  else if (kind == "collision") {
    frame.collision = true;
    frame.collision_at = std::max(0, at);
    frame.collision_value = int(fault.key("value"));
  } else if (kind == "cut") {
    if (inside) {
      frame.bytes.resize(size_t(at));
      frame.wrong.resize(size_t(at));
    }
  } else if (kind == "extra") {
    frame.bytes.push_back(uint8_t(fault.key("value")));
    frame.wrong.push_back({});
  } else if (kind == "swapped_crc") {
    if (check >= 2) std::swap(frame.bytes[size_t(check) - 1], frame.bytes[size_t(check) - 2]);
  } else if (kind == "wrong_crc") {
    if (check >= 1) frame.bytes[size_t(check) - 1] ^= 1;
  } else if (kind == "jitter") {
    for (Wrong &wrong : frame.wrong) wrong.jitter = fault.key("amount");
  } else if (kind == "rate") {
    for (Wrong &wrong : frame.wrong) wrong.rate = 1 / (1 + fault.key("amount") / 100);
  } else if (inside) {
    Wrong &wrong = frame.wrong[size_t(at)];
    if (kind == "flip") wrong.flip = int(fault.key("bit"));
    if (kind == "parity") wrong.parity = true;
    if (kind == "stop") wrong.stop = true;
    if (kind == "break") wrong.low_bits = fault.key("bits");
    if (kind == "glitch") wrong.glitch = fault.key("width");
    if (kind == "gap") wrong.gap = fault.key("amount") * format.length();
  }
}

// The pieces of a frame, and of a second talker over it, if there is one.
inline std::vector<Piece> pieces_of(const FaultyFrame &frame, CharacterFormat format, Dice &dice,
                                    std::vector<Piece> &other) {
  std::vector<Piece> pieces;
  for (size_t i = 0; i < frame.bytes.size(); ++i) {
    if (frame.collision && int(i) == frame.collision_at) {
      double before = 0.4;  // its edges lie between those of the frame
      for (const Piece &piece : pieces) before += piece.bits;
      other.push_back({before, true});
      for (int n = 0; n < 2; ++n) append_character(other, format, unsigned(frame.collision_value), {}, dice);
    }
    append_character(pieces, format, frame.bytes[i], frame.wrong[i], dice);
  }
  return pieces;
}
