// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// bridge - the compiled core as a serial device: UART pins on one side, a pseudo-terminal on the other.
//
// Knows characters (start, data, parity, stop) and silence, and nothing of Modbus: what a frame is, whose
// it is and what to answer is decided by the RTL alone.
//
//   client <-> pseudo-terminal <-> queue -> LineDriver  -> rxd_i  \  modbus_live,
//                              <-  bytes <- LineMonitor <- txd_o, de_o /  clocked here
//
// Simulated time follows the wall clock while anything moves on the line, and stands still, with the
// process asleep in poll, while nothing does.  Arguments come checked from serve.py.

#include <algorithm>
#include <cinttypes>
#include <csignal>
#include <ctime>
#include <deque>
#include <getopt.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <vector>

#include "line.h"
#include "model.h"
#include "terminal.h"

namespace {

constexpr double T35_FLOOR_S = 1750e-6;   // t3.5 above 19200 baud, MODBUS over Serial Line V1.02 2.5.1.1
constexpr double SLICE_S = 0.5e-3;        // how often a moving line is brought up to the wall clock
constexpr double GIVE_UP_S = 50e-3;       // further behind than this, lost time is not caught up
constexpr double LINGER_S = 20e-3;        // silence after which nothing more can come from the core
constexpr double WORK_S = 5e-3;           // longest work of the core on a request: 1968 coils, four clocks each
constexpr size_t LONGEST_FRAME = 256;
constexpr size_t QUEUE_LIMIT = 512;       // a client that sends more than the line carries loses it
constexpr int READS_AT_ONCE = 16;         // of 4 KB: what the kernel keeps for one terminal
constexpr int HOST_WAIT_CLOCKS = 100000;

double wall_s() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + t.tv_nsec * 1e-9;
}

struct Options {
  std::string link, trace;
  unsigned baud = 0, bit_time = 0, format = 0, address = 0, init_fd = 0;  // init_fd 0: nothing to load
  unsigned t35_us = 0, reply_bits = 0;  // of a map: floor of t3.5, bit times before an answer
  unsigned busy = 0, failure = 0, exception_status = 0, run_indicator = 1, diagnostic = 0;
};

// The core and its line. Cycle numbers are the only time it knows.
class Device {
 public:
  Device(const Options &options, Terminal &terminal)
      : terminal_(terminal), format_(options.format), driver_(format_, options.bit_time),
        monitor_(format_, options.bit_time) {
    character_ = double(options.bit_time) * format_.length();
    t15_ = uint64_t(1.5 * character_);
    t35_ = uint64_t(std::max(3.5 * character_, std::max(T35_FLOOR_S, options.t35_us * 1e-6) * CLOCK_HZ));
    hold_ = t35_ + options.bit_time;  // the core may see t3.5 one bit late
    linger_ = t35_ + uint64_t(LINGER_S * CLOCK_HZ) + uint64_t(options.reply_bits) * options.bit_time;
    if (!options.trace.empty()) open_trace(options);

    dut_.rxd_i = 1;
    dut_.address_i = options.address;
    dut_.bit_time_i = options.bit_time;
    dut_.format_i = options.format;
    dut_.busy_i = options.busy;
    dut_.failure_i = options.failure;
    dut_.exception_status_i = options.exception_status;
    dut_.run_indicator_i = options.run_indicator;
    dut_.rst_i = 1;
    for (int i = 0; i < 16; ++i) clock();
    dut_.rst_i = 0;
    for (int i = 0; i < 16; ++i) clock();
    dut_.diagnostic_i = options.diagnostic;  // once: the register keeps them until a master clears it
    clock();
    dut_.diagnostic_i = 0;
    if (options.init_fd) load(int(options.init_fd));
    last_activity_ = cycle_;
    while (!idle()) clock();
  }

  ~Device() {
    if (trace_) fclose(trace_);
    dut_.final();
  }

  uint64_t now() const { return cycle_; }
  bool full() const { return queue_.size() >= QUEUE_LIMIT; }
  bool idle() const { return queue_.empty() && cycle_ - last_activity_ >= linger_; }

  // Takes what clients have sent. What exceeds the queue is dropped, so a flood can neither grow it nor stop us.
  void take_bytes() {
    uint8_t data[4096];
    const double now = wall_s(), clock_s = 1.0 / CLOCK_HZ;
    for (int i = 0; i < READS_AT_ONCE; ++i) {
      const ssize_t n = terminal_.receive(data, sizeof data);
      if (n <= 0) return;
      for (ssize_t k = 0; k < n && !full(); ++k) {
        // A real line would have been silent before this byte: a frame of its own, even if the simulation lags.
        const bool first = now > carried_s_ + double(t35_) * clock_s;
        carried_s_ = std::max(carried_s_, now) + character_ * clock_s;
        queue_.push_back({data[k], first, client_});
      }
    }
  }

  // The last client has gone. A frame it has sent is still played (a broadcast, say), more than a frame is
  // rubbish; answers to either are for nobody. If somebody else has come meanwhile, bytes not yet taken are his.
  void client_gone(bool others) {
    terminal_.drop_unread();
    if (!others) {
      take_bytes();
      terminal_.reset();
    }
    if (queue_.size() > LONGEST_FRAME) queue_.clear();
    ++client_;
  }

  void run_to(uint64_t cycle) {
    while (cycle_ < cycle) clock();
    if (trace_) fflush(trace_);
  }

 private:
  struct Byte {
    uint8_t data;
    bool first;  // of a burst
    unsigned client;
  };

  void clock() {
    if (!driver_.busy() && !queue_.empty() && may_start(queue_.front())) {
      driver_.start(queue_.front().data);
      playing_ = queue_.front().client;
      queue_.pop_front();
    }
    const bool driving = driver_.busy();
    dut_.rxd_i = driver_.clock();
    cycle(dut_);
    ++cycle_;

    const int data = monitor_.clock(dut_.txd_o, dut_.de_o);
    if (monitor_.fault() != LineFault::kNone) {
      fprintf(stderr, "serve: bad character from the core: %s\n", text(monitor_.fault()));
      monitor_.clear();
    }
    if (data >= 0 && playing_ == client_) terminal_.send(uint8_t(data));
    if (driving || dut_.de_o) {
      last_activity_ = cycle_;
      inside_burst_ = driving;
    }
    if (trace_) trace_pins();
  }

  // A burst begins after t3.5 of silence, since masters on a pseudo-terminal do not wait for it themselves;
  // within a burst there is no pause. Another client's burst waits until the core has answered the last one.
  bool may_start(const Byte &byte) const {
    const uint64_t silence = cycle_ - last_activity_;
    if (byte.client != playing_) return silence >= linger_;
    // No answer has come: the core may still be at work, on a broadcast say, and deaf.
    if (inside_burst_) return (silence < t15_ && !byte.first) || silence >= hold_ + uint64_t(WORK_S * CLOCK_HZ);
    return silence >= hold_;
  }

  // Initial contents: lines of "space item value", written through the host port.
  void load(int fd) {
    FILE *file = fdopen(fd, "r");
    unsigned space, item, value;
    while (file && fscanf(file, "%u %u %u", &space, &item, &value) == 3) {
      dut_.host_stb_i = 1;
      dut_.host_adr_i = space << 16 | item;
      dut_.host_dat_i = value;
      int waited = 0;
      do clock();
      while (!dut_.host_ack_o && !dut_.host_err_o && ++waited < HOST_WAIT_CLOCKS);
      const bool written = dut_.host_ack_o;
      dut_.host_stb_i = 0;
      clock();  // the edge at which the acknowledge counts, and the strobe's register
      clock();
      if (!written) fail("the core refused space " + std::to_string(space) + " item " + std::to_string(item));
    }
    if (file) fclose(file);
  }

  void open_trace(const Options &options) {
    trace_ = fopen(options.trace.c_str(), "w");
    if (!trace_) fail_errno(options.trace);
    fprintf(trace_, "# clock_hz %u bit_time %u format %u t35 %" PRIu64 "\n# cycle rxd txd de\n", unsigned(CLOCK_HZ),
            options.bit_time, options.format, t35_);
  }

  void trace_pins() {
    const int pins = dut_.rxd_i << 2 | dut_.txd_o << 1 | dut_.de_o;
    if (pins == traced_) return;
    traced_ = pins;
    fprintf(trace_, "%" PRIu64 " %d %d %d\n", cycle_, dut_.rxd_i, dut_.txd_o, dut_.de_o);
  }

  Terminal &terminal_;
  Vmodel dut_;
  CharacterFormat format_;
  LineDriver driver_;
  LineMonitor monitor_;
  std::deque<Byte> queue_;
  unsigned client_ = 0, playing_ = 0;  // who is connected; who sent what was last on the line
  uint64_t cycle_ = 0, last_activity_ = 0, t15_ = 0, t35_ = 0, hold_ = 0, linger_ = 0;
  double character_ = 0, carried_s_ = 0;  // clocks of a character; when a real line would have carried all bytes
  bool inside_burst_ = false;
  FILE *trace_ = nullptr;
  int traced_ = -1;
};

Options parse(int argc, char **argv) {
  Options options;
  const struct {
    const char *name;
    unsigned *value;
  } numbers[] = {{"baud", &options.baud}, {"bit-time", &options.bit_time}, {"format", &options.format},
                 {"address", &options.address}, {"init-fd", &options.init_fd}, {"busy", &options.busy},
                 {"failure", &options.failure}, {"exception-status", &options.exception_status},
                 {"run-indicator", &options.run_indicator}, {"diagnostic", &options.diagnostic},
                 {"t35-us", &options.t35_us}, {"reply-bits", &options.reply_bits}};
  enum { LINK = 1000, TRACE, DIE_WITH_PARENT };
  std::vector<option> names = {
      {"link", 1, nullptr, LINK}, {"trace", 1, nullptr, TRACE}, {"die-with-parent", 0, nullptr, DIE_WITH_PARENT}};
  for (const auto &number : numbers) names.push_back({number.name, 1, nullptr, int(&number - numbers)});
  names.push_back({});

  for (int c; (c = getopt_long(argc, argv, "", names.data(), nullptr)) != -1;) {
    switch (c) {
      case LINK: options.link = optarg; break;
      case TRACE: options.trace = optarg; break;
      case DIE_WITH_PARENT: prctl(PR_SET_PDEATHSIG, SIGTERM); break;
      case '?': exit(EXIT_BAD_ARGUMENT);
      default: *numbers[c].value = unsigned(strtoul(optarg, nullptr, 10));
    }
  }
  if (options.link.empty() || !options.baud || !options.bit_time) fail("bridge is started by serve.py");
  return options;
}

// The ending signals as a descriptor, so that they wake poll like everything else.
int open_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (int s : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, s);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  signal(SIGPIPE, SIG_IGN);
  return signalfd(-1, &set, SFD_CLOEXEC);
}

// Real-time priority, where it is allowed, keeps answers in time on a busy machine (measured with three
// endless loops on two cores: 1 ms late instead of 20). A host too slow for the simulation gets it back.
void ask_for(int policy) {
  const sched_param lowest{policy == SCHED_RR ? 1 : 0};
  if (sched_setscheduler(0, policy, &lowest)) return;
}

void serve(Device &device, Terminal &terminal, int signals) {
  enum { SIGNALS, CLIENTS, BYTES };
  pollfd wait[] = {{signals, POLLIN, 0}, {terminal.inotify(), POLLIN, 0}, {terminal.master(), POLLIN, 0}};
  double anchor_s = wall_s();
  uint64_t anchor_cycle = device.now();
  for (;;) {
    const bool asleep = device.idle();
    // Asleep until something happens; else a slice at a time, and not woken by a flood that finds no room.
    wait[BYTES].fd = device.full() ? -1 : terminal.master();
    timespec slice{0, long(SLICE_S * 1e9)};
    ppoll(wait, 3, asleep ? nullptr : &slice, nullptr);
    if (wait[SIGNALS].revents) return;

    bool others = false;
    if (terminal.clients_left(others)) device.client_gone(others);
    device.take_bytes();  // before time moves on: a late wake-up must not put a pause into a burst
    if (device.idle()) continue;

    const double now = wall_s();
    uint64_t due = anchor_cycle + uint64_t((now - anchor_s) * CLOCK_HZ);
    const bool too_late = !asleep && due > device.now() + uint64_t(GIVE_UP_S * CLOCK_HZ);
    if (too_late) ask_for(SCHED_OTHER);
    if (asleep || too_late) {
      anchor_s = now;
      due = anchor_cycle = device.now();
    }
    device.run_to(due);
  }
}

}  // namespace

int main(int argc, char **argv) {
  const Options options = parse(argc, argv);
  const int signals = open_signals();
  ask_for(SCHED_RR);
  Terminal terminal(options.baud);
  Device device(options, terminal);

  // symlink() neither replaces anything nor leaves a moment without a target.
  if (symlink(terminal.name().c_str(), options.link.c_str())) fail_errno("LINK=" + options.link);
  printf("ready %s\n", options.link.c_str());
  fflush(stdout);
  serve(device, terminal, signals);

  char target[64];
  const ssize_t n = readlink(options.link.c_str(), target, sizeof target);
  if (n > 0 && terminal.name() == std::string(target, size_t(n))) unlink(options.link.c_str());
  return 0;
}
