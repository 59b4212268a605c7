// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// control - the channel to a control server: commands in plain words, replies and events as JSON, a line each.
//
// The line never waits for the server.  What the server does not read is kept up to a limit; beyond it events are
// dropped and counted, and no command is taken until there is room.

#pragma once

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <deque>
#include <sstream>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

// A JSON object under construction.
class Json {
 public:
  Json &add(const char *name, const std::string &text) { return raw(name, quoted(text)); }
  Json &add(const char *name, const char *text) { return raw(name, quoted(text)); }
  Json &add(const char *name, uint64_t value) { return raw(name, std::to_string(value)); }
  Json &add(const char *name, unsigned value) { return raw(name, std::to_string(value)); }
  Json &add(const char *name, int value) { return raw(name, std::to_string(value)); }
  Json &add(const char *name, double value) {
    char text[40];
    snprintf(text, sizeof text, "%.6f", value);
    return raw(name, text);
  }
  Json &raw(const char *name, const std::string &json) {
    text_ += text_.empty() ? "{" : ",";
    text_ += quoted(name) + ":" + json;
    return *this;
  }
  std::string text() const { return text_.empty() ? "{}" : text_ + "}"; }

  static std::string quoted(const std::string &text) {
    std::string out = "\"";
    for (const char c : text) {
      char code[8];
      if (c == '"' || c == '\\') (out += '\\') += c;
      else if (uint8_t(c) < 0x20) snprintf(code, sizeof code, "\\u%04x", c), out += code;
      else out += c;
    }
    return out + "\"";
  }

  template <class List>
  static std::string list(const List &values) {
    std::string out = "[";
    for (const auto &value : values) out += (out.size() > 1 ? "," : "") + std::to_string(value);
    return out + "]";
  }

  static std::string texts(const std::vector<std::string> &values) {
    std::string out = "[";
    for (const auto &value : values) out += (out.size() > 1 ? "," : "") + quoted(value);
    return out + "]";
  }

 private:
  std::string text_;
};

inline std::string hex(const std::vector<uint8_t> &bytes) {
  static const char digits[] = "0123456789abcdef";
  std::string out;
  for (const uint8_t byte : bytes) (out += digits[byte >> 4]) += digits[byte & 15];
  return out;
}

class Control {
 public:
  explicit Control(int fd) : fd_(fd) {}
  bool open() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  bool wants_commands() const { return waiting_ < LIMIT; }
  bool wants_to_write() const { return !queue_.empty(); }
  uint64_t dropped() const { return dropped_; }

  void event(const Json &json) {
    if (!open()) return;
    if (waiting_ >= LIMIT) {
      ++dropped_;
      ++untold_;
      return;
    }
    if (untold_) {
      push(Json().add("event", "dropped").add("count", untold_).text());
      untold_ = 0;
    }
    push(json.text());
  }

  void reply(const Json &json) { if (open()) push(json.text()); }

  // Writes what goes without waiting.
  void flush() {
    while (open() && !queue_.empty()) {
      const std::string &front = queue_.front();
      const ssize_t n = send(fd_, front.data() + sent_, front.size() - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (n < 0 && (errno == EAGAIN || errno == EINTR)) return;
      if (n < 0) return end();
      sent_ += size_t(n);
      waiting_ -= size_t(n);
      if (sent_ == front.size()) {
        queue_.pop_front();
        sent_ = 0;
      }
    }
  }

  // Commands that have come, as words. Too long a line ends the channel.
  std::vector<std::vector<std::string>> commands() {
    std::vector<std::vector<std::string>> found;
    char data[16384];
    const ssize_t n = open() ? recv(fd_, data, sizeof data, MSG_DONTWAIT) : -1;
    if (n == 0 || (n < 0 && open() && errno != EAGAIN && errno != EINTR)) end();
    if (n <= 0) return found;
    for (ssize_t i = 0; i < n; ++i) {
      if (data[i] != '\n') {
        input_ += data[i];
        continue;
      }
      std::istringstream line(input_);
      std::vector<std::string> words;
      for (std::string word; line >> word;) words.push_back(word);
      if (!words.empty()) found.push_back(words);
      input_.clear();
    }
    if (input_.size() > LONGEST_COMMAND) end();
    return found;
  }

 private:
  static constexpr size_t LIMIT = 4 << 20, LONGEST_COMMAND = 64 << 10;

  void push(std::string text) {
    text += '\n';
    waiting_ += text.size();
    queue_.push_back(std::move(text));
  }

  void end() {
    close(fd_);
    fd_ = -1;
    queue_.clear();
    waiting_ = sent_ = 0;
  }

  int fd_;
  std::deque<std::string> queue_;
  size_t waiting_ = 0, sent_ = 0;  // bytes not yet written; written of the first
  uint64_t dropped_ = 0, untold_ = 0;
  std::string input_;
};
