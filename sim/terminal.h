// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// terminal - the pseudo-terminal at which clients come and go, and how the bridge ends on an error.

#pragma once

#include <asm/termbits.h>  // termios2: any speed; excludes <termios.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <unistd.h>

constexpr int EXIT_BAD_ARGUMENT = 2;

[[noreturn]] inline void fail(const std::string &what) {
  fprintf(stderr, "serve: %s\n", what.c_str());
  exit(EXIT_BAD_ARGUMENT);
}

[[noreturn]] inline void fail_errno(const std::string &what) { fail(what + ": " + strerror(errno)); }

// The pseudo-terminal. Its slave side stays open here, else reading fails whenever the last client leaves.
// Comings and goings of clients are seen through inotify.
class Terminal {
 public:
  explicit Terminal(unsigned baud) : baud_(baud) {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (master_ < 0 || grantpt(master_) || unlockpt(master_)) fail_errno("cannot open a pseudo-terminal");
    name_ = ptsname(master_);
    slave_ = open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (slave_ < 0) fail_errno(name_);
    make_raw();
    inotify_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (inotify_ < 0 || inotify_add_watch(inotify_, name_.c_str(), IN_OPEN | IN_CLOSE) < 0) fail_errno(name_);
  }

  const std::string &name() const { return name_; }
  int master() const { return master_; }
  int inotify() const { return inotify_; }

  // True if the last client has gone since the last call; `others` tells whether a new one is there already.
  // (Two openings at once look like one to inotify: the first of two clients to go then passes for the last.)
  bool clients_left(bool &others) {
    alignas(inotify_event) char buffer[4096];
    bool left = false;
    for (ssize_t n; (n = read(inotify_, buffer, sizeof buffer)) > 0;) {
      for (char *p = buffer; p < buffer + n;) {
        auto *event = reinterpret_cast<inotify_event *>(p);
        if (event->mask & IN_OPEN) ++clients_;
        if (event->mask & IN_CLOSE && --clients_ <= 0) {
          clients_ = 0;
          left = true;
        }
        p += sizeof *event + event->len;
      }
    }
    others = clients_ > 0;
    return left;
  }

  ssize_t receive(void *data, size_t size) {
    const ssize_t n = read(master_, data, size);
    if (n > 0) warn_of_speed();
    return n;
  }

  // What the client does not fetch is lost, as on a line.
  void send(uint8_t data) {
    if (write(master_, &data, 1) < 0) return;
  }

  // Answers that the last client has left unread.
  void drop_unread() { ioctl(slave_, TCFLSH, TCIFLUSH); }

  // The state a new client finds: no settings, no exclusive mode.
  void reset() {
    ioctl(slave_, TIOCNXCL);
    make_raw();
    warned_speed_ = baud_;
  }

 private:
  void make_raw() {
    termios2 t{};
    t.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
    t.c_ispeed = t.c_ospeed = baud_;
    t.c_cc[VMIN] = 1;
    if (ioctl(slave_, TCSETS2, &t)) fail_errno(name_);
  }

  void warn_of_speed() {
    termios2 t;
    if (ioctl(slave_, TCGETS2, &t) || t.c_ospeed == warned_speed_) return;
    warned_speed_ = t.c_ospeed;
    if (warned_speed_ == baud_) return;
    fprintf(stderr, "serve: warning: the client has set %u baud; the line runs at %u (variable BAUD)\n",
            warned_speed_, baud_);
  }

  unsigned baud_, warned_speed_ = baud_;
  int master_ = -1, slave_ = -1, inotify_ = -1, clients_ = 0;
  std::string name_;
};
