// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// terminal - where clients are: a pseudo-terminal at which they come and go, or a serial port; and how the bridge ends
// on an error.

#pragma once

#include <asm/termbits.h>  // termios2: any speed; excludes <termios.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cstdint>
#include <fcntl.h>
#include <string>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

#include "line.h"

constexpr int EXIT_BAD_ARGUMENT = 2;

[[noreturn]] inline void fail(const std::string &what) {
  fprintf(stderr, "serve: %s\n", what.c_str());
  exit(EXIT_BAD_ARGUMENT);
}

[[noreturn]] inline void fail_errno(const std::string &what) { fail(what + ": " + strerror(errno)); }

// A byte that has come, and whether the line says that it is wrong.
struct Character {
  uint8_t data;
  bool bad;
};

// What has happened to the clients of a port.
struct Changes {
  bool opened = false;    // somebody has come
  bool left = false;      // the last one has gone
  bool returned = false;  // and there is one again
  int clients = 0;
};

// Where the bytes of masters come from and go to.
class Endpoint {
 public:
  virtual ~Endpoint() = default;
  virtual int bytes() const = 0;             // descriptor that is readable when bytes have come
  virtual int comings() const { return -1; } // descriptor that is readable when a client comes, goes or writes
  virtual Changes changes() { return {}; }
  virtual bool receive(std::vector<Character> &characters) = 0;  // false: nothing is there
  virtual void send(const std::vector<uint8_t> &data) = 0;       // what is not fetched is lost, as on a line
  virtual void drop_unread() {}              // answers that the last client has left
  virtual void reset(bool) {}                // the state a new client finds; true: nobody has opened it yet
  virtual bool lost() const { return false; }  // it will never have a byte again
};

// The pseudo-terminal. Its slave side stays open here, else reading fails whenever the last client leaves.
// Comings and goings of clients are seen through inotify; a write too, before the kernel has brought its bytes, which a
// read then waits for.
class Terminal : public Endpoint {
 public:
  explicit Terminal(unsigned baud) : baud_(baud) {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (master_ < 0 || grantpt(master_) || unlockpt(master_)) fail_errno("cannot open a pseudo-terminal");
    name_ = ptsname(master_);
    slave_ = open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (slave_ < 0) fail_errno(name_);
    make_raw();
    inotify_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (inotify_ < 0 || inotify_add_watch(inotify_, name_.c_str(), IN_OPEN | IN_CLOSE | IN_MODIFY) < 0) fail_errno(name_);
  }

  const std::string &name() const { return name_; }
  int bytes() const override { return master_; }
  int comings() const override { return inotify_; }

  // (Two openings at once look like one to inotify: the first of two clients to go then passes for the last.)
  Changes changes() override {
    alignas(inotify_event) char buffer[4096];
    Changes changes;
    for (ssize_t n; (n = read(inotify_, buffer, sizeof buffer)) > 0;) {
      for (char *p = buffer; p < buffer + n;) {
        auto *event = reinterpret_cast<inotify_event *>(p);
        if (event->mask & IN_OPEN) {
          ++clients_;
          changes.opened = true;
        }
        if (event->mask & IN_CLOSE && --clients_ <= 0) {
          clients_ = 0;
          changes.left = true;
        }
        p += sizeof *event + event->len;
      }
    }
    changes.clients = clients_;
    changes.returned = changes.left && clients_ > 0;
    if (clients_ < 2) warned_clients_ = false;
    warn_of_clients();  // a client that has opened and written since the last look is known only now
    heard_ = false;
    return changes;
  }

  bool receive(std::vector<Character> &characters) override {
    uint8_t data[4096];
    const ssize_t n = read(master_, data, sizeof data);
    if (n <= 0) return false;
    for (ssize_t i = 0; i < n; ++i) characters.push_back({data[i], false});
    warn_of_speed();
    heard_ = true;
    warn_of_clients();
    return true;
  }

  void send(const std::vector<uint8_t> &data) override {
    if (write(master_, data.data(), data.size()) < 0) return;
  }

  // A flush of an empty terminal is left out: while it lasts, the terminal of a new client looks readable.
  void drop_unread() override {
    int unread = 0;
    if (ioctl(slave_, TIOCINQ, &unread) == 0 && unread > 0) ioctl(slave_, TCFLSH, TCIFLUSH);
  }

  // No settings, no exclusive mode, output not stopped.  Settings of a client that is there already stay.
  void reset(bool nobody) override {
    ioctl(slave_, TIOCNXCL);
    ioctl(slave_, TCXONC, TCOON);
    if (!nobody) return;
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

  void warn_of_clients() {
    if (!heard_ || clients_ < 2 || warned_clients_) return;
    warned_clients_ = true;
    fprintf(stderr, "serve: warning: %d programs have the port open; each answer goes to the one that reads first\n",
            clients_);
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
  bool warned_clients_ = false, heard_ = false;
  int master_ = -1, slave_ = -1, inotify_ = -1, clients_ = 0;
  std::string name_;
};

// A real serial port: the core answers whatever master is at the other end of the cable.
class SerialPort : public Endpoint {
 public:
  SerialPort(const std::string &path, unsigned baud, CharacterFormat format) : path_(path) {
    fd_ = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0) fail_errno("PORT=" + path);
    termios2 t{};
    t.c_cflag = CREAD | CLOCAL | BOTHER | (format.data == 7 ? CS7 : CS8) | (format.parity ? PARENB : 0) |
                (format.odd ? PARODD : 0) | (format.stops == 2 ? CSTOPB : 0);
    t.c_iflag = INPCK | PARMRK;  // a byte with an error comes as FF 00 byte, FF as FF FF
    t.c_ispeed = t.c_ospeed = baud;
    t.c_cc[VMIN] = 1;
    const tcflag_t wanted = t.c_cflag & (CSIZE | PARENB | PARODD | CSTOPB);
    if (ioctl(fd_, TIOCEXCL) || ioctl(fd_, TCSETS2, &t) || ioctl(fd_, TCGETS2, &t)) fail_errno("PORT=" + path);
    unsigned pty;
    const bool emulated = ioctl(fd_, TIOCGPTN, &pty) == 0 || path_of_terminal();
    if (!emulated && ((t.c_cflag & (CSIZE | PARENB | PARODD | CSTOPB)) != wanted ||
                      t.c_ospeed < baud - baud / 33 || t.c_ospeed > baud + baud / 33))
      fail("PORT=" + path + ": the port does not take this rate or format");
    ioctl(fd_, TCFLSH, TCIOFLUSH);
  }
  ~SerialPort() override { close(fd_); }

  int bytes() const override { return fd_; }

  bool receive(std::vector<Character> &characters) override {
    uint8_t data[4096];
    const ssize_t n = read(fd_, data, sizeof data);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
      if (!lost_) fprintf(stderr, "serve: PORT=%s: the port has gone\n", path_.c_str());
      lost_ = true;
    }
    for (ssize_t i = 0; i < n; ++i) take(data[i], characters);
    return n > 0;
  }

  void send(const std::vector<uint8_t> &data) override {
    if (write(fd_, data.data(), data.size()) < 0) return;
  }

 private:
  // The slave side of a pseudo-terminal has neither parity nor rate.
  bool path_of_terminal() const {
    char name[256];
    return ttyname_r(fd_, name, sizeof name) == 0 && std::string(name).rfind("/dev/pts/", 0) == 0;
  }

  void take(uint8_t data, std::vector<Character> &characters) {
    if (marks_ == 0 && data == 0xFF) marks_ = 1;
    else if (marks_ == 1 && data == 0) marks_ = 2;
    else {
      characters.push_back({data, marks_ == 2});
      marks_ = 0;
    }
  }

  bool lost() const override { return lost_; }

  std::string path_;
  bool lost_ = false;
  int fd_ = -1, marks_ = 0;  // bytes of a mark seen
};
