// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// clients - what masters have sent, with the time at which it came, and which of them has sent it.
//
// A thread reads: it sleeps until bytes come or a client comes or goes, so it gets a processor soon also where the
// simulation is late or waits for one.  The simulation takes the news in their order, and waits for bytes that have
// come before it lets time pass.  It never holds up the thread.  An answer reaches its own client or none: who the
// client is changes under the lock under which answers go.

#pragma once

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <poll.h>
#include <sys/eventfd.h>
#include <thread>
#include <utility>
#include <vector>

#include "terminal.h"

constexpr size_t QUEUE_LIMIT = 1026;      // a client that sends more than the line carries loses it
constexpr int READS_AT_ONCE = 16;         // of 4 KB: what the kernel keeps for one terminal
constexpr double SLICE_S = 0.5e-3;        // how often a moving line is brought up to the wall clock

inline double wall_s() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + t.tv_nsec * 1e-9;
}

// Something that has happened: bytes of a client, or a change of clients.
struct News {
  double at = 0;                      // when
  uint64_t client = 0;                // whose bytes; of a change: who is there now
  std::vector<Character> characters;  // empty: a change
  bool left = false, opened = false;
  int clients = 0;
};

class Clients {
 public:
  explicit Clients(Endpoint &endpoint) : endpoint_(endpoint) {
    news_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    stop_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (news_fd_ < 0 || stop_fd_ < 0) fail_errno("cannot make an eventfd");
  }
  ~Clients() {
    if (reader_.joinable()) {
      ring(stop_fd_);
      reader_.join();
    }
    close(news_fd_);
    close(stop_fd_);
  }

  // Lets the thread read; it first calls `prepare`.
  void start(void (*prepare)()) {
    reader_ = std::thread([this, prepare] {
      prepare();
      read_on();
    });
  }

  int fd() const { return news_fd_; }  // readable when there are news
  bool lost() const { return lost_; }  // the port has gone

  // What has happened since the last call; `waiting` bytes of earlier news are still to be played.
  std::vector<News> news(size_t waiting) {
    if (waiting < QUEUE_LIMIT) await_reader();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (rung_) {
      uint64_t count;
      if (read(news_fd_, &count, sizeof count) < 0) count = 0;
      rung_ = false;
    }
    waiting_ = waiting + kept_;
    kept_ = 0;
    return std::exchange(news_, {});
  }

  // An answer for a client, who may have gone meanwhile.
  void send(const std::vector<uint8_t> &data, uint64_t client) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (client == client_) endpoint_.send(data);
  }

 private:
  static void ring(int fd) {
    const uint64_t one = 1;
    if (write(fd, &one, sizeof one) < 0) return;
  }

  // Bytes that the kernel has: until the reader has them too, but not for long.
  void await_reader() {
    const timespec slice{0, long(SLICE_S * 1e9)};
    pollfd bytes{endpoint_.bytes(), POLLIN, 0}, told{news_fd_, POLLIN, 0};
    if (poll(&bytes, 1, 0) > 0) ppoll(&told, 1, &slice, nullptr);
  }

  // The thread: asleep until something happens, but not woken by a flood that finds no room.
  void read_on() {
    const timespec slice{0, long(SLICE_S * 1e9)};
    for (double woken_s = wall_s();; woken_s = wall_s()) {
      const bool full = look(woken_s);
      if (lost_) return;
      pollfd wait[] = {{stop_fd_, POLLIN, 0}, {endpoint_.comings(), POLLIN, 0}, {full ? -1 : endpoint_.bytes(), POLLIN, 0}};
      ppoll(wait, 3, full ? &slice : nullptr, nullptr);
      if (wait[0].revents) return;
    }
  }

  // Takes what there is, which has come by `now`; true if there is no room for more.  Bytes are taken before a client is
  // seen to come, so they are of the one before.
  bool look(double now) {
    std::vector<News> found;
    size_t last = take(now, found);
    Changes changes = endpoint_.changes();
    if (changes.left && !changes.returned) {  // what he wrote last
      last = take(now, found);
      const Changes more = endpoint_.changes();
      changes.opened |= more.opened;
      changes.clients = more.clients;
      changes.returned = more.clients > 0;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (changes.left) {
      endpoint_.drop_unread();
      ++client_;
      if (changes.returned)  // what was taken last is of the next one
        for (; last < found.size(); ++last) found[last].client = client_;
      endpoint_.reset(!changes.returned);
    }
    if (changes.left || changes.opened)
      found.push_back({now, client_, {}, changes.left, changes.opened, changes.clients});
    for (News &one : found) keep(std::move(one));
    lost_ = endpoint_.lost();
    if (!rung_ && (lost_ || !news_.empty())) {
      ring(news_fd_);
      rung_ = true;
    }
    return waiting_ + kept_ >= QUEUE_LIMIT;
  }

  // Reads; index of the news that it makes, if there are some.
  size_t take(double now, std::vector<News> &found) {
    std::vector<Character> characters;
    for (int i = 0; i < READS_AT_ONCE && endpoint_.receive(characters); ++i) {}
    if (characters.empty()) return found.size();
    found.push_back({now, client_, std::move(characters), false, false, 0});
    return found.size() - 1;
  }

  // What exceeds the queue is dropped, so a flood can neither grow it nor stop us.
  void keep(News one) {
    const size_t used = waiting_ + kept_, room = used < QUEUE_LIMIT ? QUEUE_LIMIT - used : 0;
    const bool change = one.characters.empty();
    if (one.characters.size() > room) one.characters.resize(room);
    kept_ += one.characters.size();
    if (change || !one.characters.empty()) news_.push_back(std::move(one));
  }

  Endpoint &endpoint_;
  std::thread reader_;
  std::mutex mutex_;
  int news_fd_ = -1, stop_fd_ = -1;
  std::atomic<bool> lost_{false};

  // Under the lock; client_ is changed by the thread alone
  std::vector<News> news_;
  uint64_t client_ = 1;          // who is there, or will be next
  size_t waiting_ = 0, kept_ = 0;  // bytes that the simulation has; those of the news
  bool rung_ = false;
};
