// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// bridge - the compiled core as a serial device: UART pins on one side, a pseudo-terminal on the other.
//
// Knows characters (start, data, parity, stop) and silence, and nothing of Modbus: what a frame is, whose
// it is and what to answer is decided by the RTL alone.
//
//   client <-> pseudo-terminal <-> Clients -> queue -> Wave        -> rxd_i  \  slaves: modbus_live,
//              or serial port  <----  bytes <-  LineMonitor  <- txd_o, de_o /  clocked here
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
#include <sys/syscall.h>

#include "device.h"

namespace {

constexpr double WITHOUT_PRIORITY_S = 1;  // a host that was too slow for the simulation has its way so long
constexpr double SAY_AGAIN_S = 60;
constexpr uint64_t TURN_NS = 100'000;      // the shortest that Linux knows

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

// Asks for a way of getting the processor; true if it is allowed.  Without real-time priority a thread takes short
// turns, which Linux 6.12 and later then gives it sooner.
bool ask(int policy, unsigned priority = 0) {
  struct {  // sched_attr of the kernel
    uint32_t size, policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime, deadline, period;
  } wanted{sizeof wanted, uint32_t(policy), 0, 0, priority, policy == SCHED_OTHER ? TURN_NS : 0, 0, 0};
  return syscall(SYS_sched_setattr, 0, &wanted, 0) == 0;
}

// The reader of clients goes before all simulations, and keeps its priority.
void prepare_reader() {
  if (!ask(SCHED_RR, 2)) ask(SCHED_OTHER);
}

// Real-time priority, where it is allowed, keeps answers in time on a busy machine (measured with three
// endless loops on two cores: 1 ms late instead of 20).  A host too slow for the simulation gets it back for a while.
class Priority {
 public:
  Priority() {
    take();
    if (!has_it_) ask(SCHED_OTHER);
  }

  // The simulation has fallen behind by so much.
  void fallen_behind(double now, double lag_s, Device &device) {
    const bool had_it = has_it_;
    if (has_it_) give_up();
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
    if (!has_it_ && allowed_ && now > again_at_) take();
  }

 private:
  void take() { allowed_ = has_it_ = ask(SCHED_RR, 1); }
  void give_up() { has_it_ = !ask(SCHED_OTHER); }

  bool has_it_ = false, allowed_ = false;
  double again_at_ = 0, say_at_ = 0;
};

// Until a signal ends it, or the port has gone: the exit status.
int serve(Device &device, Clients &clients, Control &control, Priority &priority, int signals) {
  enum { SIGNALS, NEWS, CONTROL };
  pollfd wait[] = {{signals, POLLIN, 0}, {clients.fd(), POLLIN, 0}, {-1, 0, 0}};
  bool controlled = control.open();
  for (;;) {
    const bool asleep = device.idle();
    // Asleep until something happens; else a slice at a time.
    wait[CONTROL].fd = control.fd();
    wait[CONTROL].events = short((control.wants_commands() ? POLLIN : 0) | (control.wants_to_write() ? POLLOUT : 0));
    timespec slice{0, device.pressed() ? 0 : long(SLICE_S * 1e9)};
    ppoll(wait, 3, asleep ? nullptr : &slice, nullptr);
    if (wait[SIGNALS].revents) return EXIT_SUCCESS;
    if (clients.lost()) return EXIT_FAILURE;

    // Before time moves on: a late wake-up must not put a pause into a burst.
    for (const News &news : clients.news(device.waiting())) device.take(news);
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
  Clients clients(*endpoint);
  Device device(options, clients, control);

  // symlink() neither replaces anything nor leaves a moment without a target.
  if (terminal && symlink(terminal->name().c_str(), options.link.c_str())) fail_errno("LINK=" + options.link);
  clients.start(prepare_reader);
  printf("ready %s\n", terminal ? options.link.c_str() : options.port.c_str());
  fflush(stdout);
  const int status = serve(device, clients, control, priority, signals);

  char target[64];
  const ssize_t n = terminal ? readlink(options.link.c_str(), target, sizeof target) : 0;
  if (n > 0 && terminal->name() == std::string(target, size_t(n))) unlink(options.link.c_str());
  return status;
}
