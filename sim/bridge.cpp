// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// bridge - the compiled core as a serial device: UART pins on one side, a pseudo-terminal on the other.
//
// Knows characters (start, data, parity, stop) and silence, and nothing of Modbus: what a frame is, whose
// it is and what to answer is decided by the RTL alone.
//
//   client <-> pseudo-terminal <-> queue -> Wave        -> rxd_i  \  slaves: modbus_live,
//              or serial port  <-  bytes <- LineMonitor <- txd_o, de_o /  clocked here
//   control server <-> commands, events
//
// Simulated time follows the wall clock while anything moves on the line, and stands still, with the
// process asleep in poll, while nothing does.  Arguments come checked from serve.py.

#include <csignal>
#include <getopt.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>

#include "device.h"

namespace {

constexpr double SLICE_S = 0.5e-3;        // how often a moving line is brought up to the wall clock
constexpr double WITHOUT_PRIORITY_S = 1;  // a host that was too slow for the simulation has its way so long
constexpr double SAY_AGAIN_S = 60;

std::vector<unsigned> numbers(const char *text) {
  std::vector<unsigned> found;
  for (char *end = nullptr; *text; text = *end ? end + 1 : end) found.push_back(unsigned(strtoul(text, &end, 10)));
  return found;
}

Options parse(int argc, char **argv) {
  Options options;
  const struct {
    const char *name;
    unsigned *value;
  } numbered[] = {{"baud", &options.baud}, {"bit-time", &options.bit_time}, {"format", &options.format},
                  {"init-fd", &options.init_fd}, {"control-fd", &options.control_fd}, {"busy", &options.busy},
                  {"failure", &options.failure}, {"exception-status", &options.exception_status},
                  {"run-indicator", &options.run_indicator}, {"diagnostic", &options.diagnostic},
                  {"t15-us", &options.t15_us}, {"t35-us", &options.t35_us}, {"reply-bits", &options.reply_bits},
                  {"real-work", &options.real_work}, {"hold-ms", &options.hold_ms}};
  enum { LINK = 1000, TRACE, PORT, SLAVES, FAULT, DIE_WITH_PARENT };
  std::vector<option> names = {{"link", 1, nullptr, LINK},     {"trace", 1, nullptr, TRACE},
                               {"port", 1, nullptr, PORT},     {"slaves", 1, nullptr, SLAVES},
                               {"fault", 1, nullptr, FAULT},   {"die-with-parent", 0, nullptr, DIE_WITH_PARENT}};
  for (const auto &number : numbered) names.push_back({number.name, 1, nullptr, int(&number - numbered)});
  names.push_back({});

  for (int c; (c = getopt_long(argc, argv, "", names.data(), nullptr)) != -1;) {
    switch (c) {
      case LINK: options.link = optarg; break;
      case TRACE: options.trace = optarg; break;
      case PORT: options.port = optarg; break;
      case SLAVES: options.slaves = numbers(optarg); break;
      case FAULT: options.faults.push_back(optarg); break;
      case DIE_WITH_PARENT: prctl(PR_SET_PDEATHSIG, SIGTERM); break;
      case '?': exit(EXIT_BAD_ARGUMENT);
      default: *numbered[c].value = unsigned(strtoul(optarg, nullptr, 10));
    }
  }
  if (!options.baud || !options.bit_time || options.slaves.empty()) fail("bridge is started by serve.py");
  return options;
}

// The ending signals as a descriptor, so that they wake poll like everything else.
int open_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (int s : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, s);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGCHLD, SIG_IGN);  // the control server may end before us
  return signalfd(-1, &set, SFD_CLOEXEC);
}

// Real-time priority, where it is allowed, keeps answers in time on a busy machine (measured with three
// endless loops on two cores: 1 ms late instead of 20).  A host too slow for the simulation gets it back for a while.
class Priority {
 public:
  Priority() { ask(SCHED_RR); }

  // The simulation has fallen behind by so much.
  void fallen_behind(double now, double lag_s, Device &device) {
    const bool had_it = has_it_;
    if (has_it_) ask(SCHED_OTHER);
    again_at_ = now + WITHOUT_PRIORITY_S;
    if (now < say_at_) return;
    say_at_ = now + SAY_AGAIN_S;
    char text[160];
    snprintf(text, sizeof text, "answers came %.0f ms late: this machine is too busy (%s)", 1000 * lag_s,
             had_it     ? "real-time priority is given up for a second"
             : allowed_ ? "without real-time priority for the moment"
                        : "real-time priority needs root or CAP_SYS_NICE");
    device.warn(text);
  }

  void look(double now) {
    if (!has_it_ && allowed_ && now > again_at_) ask(SCHED_RR);
  }

 private:
  void ask(int policy) {
    const sched_param lowest{policy == SCHED_RR ? 1 : 0};
    const bool done = sched_setscheduler(0, policy, &lowest) == 0;
    if (policy == SCHED_RR) allowed_ = has_it_ = done;
    else has_it_ = has_it_ && !done;
  }

  bool has_it_ = false, allowed_ = false;
  double again_at_ = 0, say_at_ = 0;
};

// Bytes are taken before a client is seen to come, so they are of the one before.
void look_at_clients(Device &device, Endpoint &endpoint) {
  device.take_bytes();
  Changes changes = endpoint.changes();
  if (changes.left && !changes.returned) {  // what he wrote last
    device.take_bytes();
    const Changes more = endpoint.changes();
    changes.opened |= more.opened;
    changes.clients = more.clients;
    changes.returned = more.clients > 0;
  }
  if (changes.left) device.client_gone(changes.returned);
  if (changes.left || changes.opened) device.clients_changed(changes.clients, changes.opened);
}

void serve(Device &device, Endpoint &endpoint, Control &control, Priority &priority, int signals) {
  enum { SIGNALS, COMINGS, BYTES, CONTROL };
  pollfd wait[] = {{signals, POLLIN, 0}, {endpoint.comings(), POLLIN, 0}, {-1, POLLIN, 0}, {-1, 0, 0}};
  bool controlled = control.open();
  for (;;) {
    const bool asleep = device.idle();
    // Asleep until something happens; else a slice at a time, and not woken by a flood that finds no room.
    wait[BYTES].fd = device.full() ? -1 : endpoint.bytes();
    wait[CONTROL].fd = control.fd();
    wait[CONTROL].events = short((control.wants_commands() ? POLLIN : 0) | (control.wants_to_write() ? POLLOUT : 0));
    timespec slice{0, device.free_time() ? 0 : long(SLICE_S * 1e9)};
    ppoll(wait, 4, asleep ? nullptr : &slice, nullptr);
    if (wait[SIGNALS].revents) return;

    look_at_clients(device, endpoint);  // before time moves on: a late wake-up must not put a pause into a burst
    if (wait[CONTROL].fd >= 0 && wait[CONTROL].revents & ~POLLOUT)
      for (const auto &words : control.commands()) device.command(words);
    if (!device.idle()) {
      const double now = wall_s(), lag_s = device.lag_s(now);
      if (device.run(now, asleep)) priority.fallen_behind(now, lag_s, device);
      priority.look(now);
    }
    control.flush();
    if (controlled && !control.open()) {
      controlled = false;
      fprintf(stderr, "serve: warning: the control server has ended; the line goes on\n");
    }
  }
}

}  // namespace

int main(int argc, char **argv) {
  const Options options = parse(argc, argv);
  const int signals = open_signals();
  Priority priority;
  Control control(options.control_fd ? int(options.control_fd) : -1);
  std::unique_ptr<Endpoint> endpoint;
  Terminal *terminal = nullptr;
  if (options.port.empty()) endpoint.reset(terminal = new Terminal(options.baud));
  else endpoint = std::make_unique<SerialPort>(options.port, options.baud, CharacterFormat(options.format));
  Device device(options, *endpoint, control);

  // symlink() neither replaces anything nor leaves a moment without a target.
  if (terminal && symlink(terminal->name().c_str(), options.link.c_str())) fail_errno("LINK=" + options.link);
  printf("ready %s\n", terminal ? options.link.c_str() : options.port.c_str());
  fflush(stdout);
  serve(device, *endpoint, control, priority, signals);

  char target[64];
  const ssize_t n = terminal ? readlink(options.link.c_str(), target, sizeof target) : 0;
  if (n > 0 && terminal->name() == std::string(target, size_t(n))) unlink(options.link.c_str());
  return 0;
}
