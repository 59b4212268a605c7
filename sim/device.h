// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// device - the simulated line: bytes of clients and of the control server become bits on rxd, the slaves' bits become
// bytes.  Faults come between, a log is kept where somebody reads it.
//
// Cycle numbers are the only time of the line.  They follow the wall clock, with two exceptions: they stand still while
// nothing moves, and what the core works between a request and its answer takes cycles but no time, as in an FPGA with
// a fast clock.

#pragma once

#include <algorithm>
#include <cinttypes>
#include <deque>
#include <memory>
#include <vector>

#include "clients.h"
#include "control.h"
#include "faults.h"
#include "slave.h"
#include "wire.h"

constexpr double FLOOR_RATE = 19200;      // above, t1.5 and t3.5 are fixed: MODBUS over Serial Line V1.02 2.5.1.1
constexpr unsigned T15_FLOOR_US = 750, T35_FLOOR_US = 1750;
constexpr double GIVE_UP_S = 50e-3;       // further behind than this, lost time is not caught up
constexpr size_t LONGEST_FRAME = 256;
constexpr size_t LONGEST_ASCII = 513;
constexpr unsigned ASCII = 8;             // of a format code, beside those of line.h
constexpr size_t SENDS_LIMIT = 256;       // requests of the control server that wait
constexpr unsigned SETTLE_CLOCKS = 256;   // a core at rest may still clear its counters
constexpr unsigned JUDGE_CLOCKS = 8;      // the core may say a little late what it thinks of a frame
constexpr int FREE_CLOCKS = 500;          // that take no time, at most between two looks at clients: below half a millisecond
constexpr int TIMED_CLOCKS = 5000;        // the same of those that a late simulation catches up
constexpr double COLLECT_S = 3e-3;        // silence of a client that ends a frame which a fault wants whole
constexpr size_t MOST_EDGES = 50000;      // of a frame, for the log

struct Options {
  std::string link, trace, port;
  std::vector<unsigned> slaves;
  std::vector<std::string> faults;
  unsigned baud = 0, bit_time = 0, format = 0, init_fd = 0, control_fd = 0;  // descriptor 0: none
  unsigned t15_us = T15_FLOOR_US, t35_us = T35_FLOOR_US;                     // floors
  unsigned reply_bits = 0, real_work = 0;  // bit times before an answer; 1: the work of the core takes its time
  unsigned hold_ms = 0;                    // an answer is kept so long for its other bytes
  unsigned busy = 0, failure = 0, exception_status = 0, run_indicator = 1, diagnostic = 0;

  double clock_hz() const { return double(baud) * bit_time; }
};

class Device {
 public:
  Device(const Options &options, Clients &clients, Control &control)
      : options_(options), clients_(clients), control_(control), format_(options.format), bit_(options.bit_time),
        clock_hz_(options.clock_hz()), wave_(bit_), other_talker_(bit_), reply_(bit_), reply_talker_(bit_),
        line_receiver_(format_, bit_), client_receiver_(format_, bit_) {
    character_ = double(bit_) * format_.length();
    t15_ = uint64_t(std::max(1.5 * character_, options.baud > FLOOR_RATE ? options.t15_us * 1e-6 * clock_hz_ : 0.));
    t35_ = uint64_t(std::max(3.5 * character_, options.t35_us * 1e-6 * clock_hz_));
    hold_ = t35_ + bit_;  // the core may see t3.5 one bit late
    held_limit_ = uint64_t(options.hold_ms * 1e-3 * clock_hz_);
    for (const unsigned address : options.slaves)
      slaves_.push_back(std::make_unique<Slave>(address, format_, options.bit_time));
    shared_ = slaves_.size() > 1;
    if (!options.trace.empty()) open_trace();
    reset_slaves();
    if (options.init_fd) load(int(options.init_fd));
    last_activity_ = cycle_;
    while (!idle()) clock();
    rested_ = judged_ = true;
    anchor(wall_s());
    for (const auto &text : options.faults) add_fault(words(text));
    say_hello();
  }

  ~Device() {
    if (trace_) fclose(trace_);
  }

  // Nothing moves and nothing is left to do.
  bool idle() const {
    return queue_.empty() && sends_.empty() && !sending_ && jobs_.empty() && held_.empty() && !wave_.busy() &&
           !reply_.busy() && silence() >= hold_ + SETTLE_CLOCKS + t35_ && at_rest() && !receiving();
  }
  size_t waiting() const { return queue_.size(); }

  // What a client has sent, or a change of clients.
  void take(const News &news) {
    if (news.left) client_gone(news.client);
    if (news.opened) clients_changed("open", std::max(1, news.clients));  // and gone already, perhaps
    if (news.left && !(news.opened && news.clients)) clients_changed("closed", news.clients);
    const double clock_s = 1 / clock_hz_;
    for (const Character &character : news.characters) {
      last_byte_s_ = news.at;
      // A real line would have been silent for t1.5 before this byte: a frame of its own, even if the simulation lags.
      const bool first = news.at > carried_s_ + double(t15_) * clock_s;
      carried_s_ = std::max(carried_s_, news.at) + character_ * clock_s;
      queue_.push_back({character.data, character.bad, first, news.client, news.at});
    }
  }

  // Time passes up to `now` of the wall clock, or not quite, see pressed(); true if the line has fallen behind too far
  // to catch up.  A line that was asleep goes on at the moment at which its first byte came.
  bool run(double now, bool asleep) {
    if (asleep) {
      const double came = queue_.empty() ? now : std::max(queue_.front().at, now - GIVE_UP_S / 2);
      anchor(std::min(now, std::max(came, line_s())));
    }
    uint64_t due = anchor_cycle_ + uint64_t((now - anchor_s_) * clock_hz_);
    const bool late = due > cycle_ - free_ + uint64_t(GIVE_UP_S * clock_hz_);
    if (late) {
      anchor(now);
      due = anchor_cycle_;
    }
    late_ += late;
    if (collecting_ && (of_server(queue_.front().owner) || wall_s() > last_byte_s_ + collect_s())) play_faulty();
    int free_budget = FREE_CLOCKS, budget = TIMED_CLOCKS;
    behind_ = false;
    while (true) {
      if (!rested_ && silence() >= hold_ + JUDGE_CLOCKS && at_rest() && !wave_.busy() && !replying()) come_to_rest();
      if (free_time()) {
        if (free_budget-- == 0) break;
        ++free_;
      } else if (cycle_ - free_ >= due) {
        break;
      } else if (budget-- == 0) {
        behind_ = true;
        break;
      }
      clock();
    }
    if (trace_) fflush(trace_);
    return late;
  }

  // Something is to be done at once: do not sleep.
  bool pressed() const { return behind_ || free_time(); }

  // What can be done now takes no time.
  bool free_time() const {
    if (receiving()) return false;
    if (faulty_answer_ && driven_) return true;
    if (silence() < hold_ || wave_.busy() || reply_.busy()) return false;
    if (at_rest()) return !jobs_.empty() || (queue_.empty() && sends_.empty() && !idle());
    return !options_.real_work;
  }

  uint64_t late() const { return late_; }
  double lag_s(double now) const { return now - line_s(); }

  void command(const std::vector<std::string> &words) {
    const std::string id = words[0];
    if (words.size() < 2 || id.find_first_not_of("0123456789") != std::string::npos || id.size() > 18) return;
    const std::string wrong = execute(id, words[1], {words.begin() + 2, words.end()});
    if (!wrong.empty()) control_.reply(Json().raw("id", id).add("error", wrong));
  }

  void warn(const std::string &text) {
    fprintf(stderr, "serve: warning: %s\n", text.c_str());
    control_.event(Json().add("event", "warning").add("text", text).add("time", unix_s()));
  }

 private:
  using Owner = uint64_t;  // of bytes: number of a client, or SERVER and the number of a command
  static constexpr Owner SERVER = 1ull << 63;
  static bool of_server(Owner owner) { return owner & SERVER; }

  struct Byte {
    uint8_t data;
    bool bad, first;  // with wrong parity; of a burst
    Owner owner;
    double at;        // when it came
  };
  struct Job {
    std::string id;
    Slave *slave;
    HostAccess access;
    enum Kind { kRead, kWrite, kStatus } kind;
  };
  struct Send {
    std::string id;
    std::vector<uint8_t> bytes, answer;
    bool played = false;
    std::string verdict = "";
  };
  // A frame for the log.
  struct Logged {
    uint64_t number = 0, begin = 0;
    double time = 0;
    std::vector<uint8_t> bytes;
    std::vector<uint64_t> starts, edges;
    std::string faults;
    std::vector<std::string> injected;
    bool open = false;
  };

  // The last client has gone.  A frame it has sent is still played (a broadcast, say), more than a frame is rubbish;
  // answers to either are for nobody.
  void client_gone(Owner next) {
    held_.clear();
    client_ = next;
    const auto old = [this](const Byte &byte) { return byte.owner < client_; };  // not the server's
    if (size_t(std::count_if(queue_.begin(), queue_.end(), old)) > (ascii() ? LONGEST_ASCII : LONGEST_FRAME))
      queue_.erase(std::remove_if(queue_.begin(), queue_.end(), old), queue_.end());
    if (queue_.empty()) collecting_ = false;
  }

  void clients_changed(const char *state, int clients) {
    open_ = clients;
    control_.event(Json().add("event", "client").add("state", state).add("clients", clients).add("time", unix_s()));
  }

  uint64_t silence() const { return cycle_ - last_activity_; }
  // The wall clock's time at which this clock of the line is.
  double line_s() const { return anchor_s_ + double(cycle_ - free_ - anchor_cycle_) / clock_hz_; }
  double collect_s() const { return std::max(COLLECT_S, 2 * character_ / clock_hz_); }

  bool at_rest() const {
    for (const auto &slave : slaves_)
      if (slave->working() || slave->driving()) return false;
    return true;
  }

  // Inside a frame of ASCII mode.
  bool receiving() const {
    for (const auto &slave : slaves_)
      if (slave->receiving()) return true;
    return false;
  }
  bool ascii() const { return options_.format & ASCII; }

  void anchor(double now) {
    anchor_s_ = now;
    anchor_cycle_ = cycle_ - free_;
  }

  double unix_s() const {  // of this cycle
    timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    return t.tv_sec + t.tv_nsec * 1e-9 - std::max(0., lag_s(wall_s()));
  }

  // ------------------------------------------------------------------ one clock

  void clock() {
    if (!wave_.busy()) next_byte();
    const bool driving = wave_.busy() || other_talker_.busy();
    bool rxd = wave_.clock();
    if (other_talker_.busy()) rxd &= other_talker_.clock();
    if (driven_ && (shared_ || echo_answer_)) rxd &= txd_;
    if (logging() && driving && !request_.open) open_log(request_);
    bool txd = true, driven = false;
    for (auto &slave : slaves_) {
      if (slave->clock(rxd)) strobes(*slave);
      if (slave->driving()) {
        driven = true;
        txd &= slave->pins().txd_o;
      }
    }
    ++cycle_;
    if (driven != driven_) driver_changes(driven);
    txd_ = txd;
    for (auto &slave : slaves_) listen(*slave);
    if (!jobs_.empty()) step();
    if (logging()) log_pins(rxd);
    if (echo_request_ || logging()) hear_line(rxd);
    if (driving || driven) {
      last_activity_ = cycle_;
      inside_burst_ = driving;
      rested_ = false;
      if (driving) judged_ = false;
    } else {
      if (!judged_ && silence() == hold_ + JUDGE_CLOCKS) judge();
    }
    if (replying()) play_reply(driving);
    if (!held_.empty() && (cycle_ - held_since_ >= held_limit_ || cycle_ - held_last_ > uint64_t(2.6 * character_)))
      deliver_held();
    if (trace_) trace_pins(rxd);
  }

  // A burst begins after t3.5 of silence, since masters on a pseudo-terminal do not wait for it themselves, and when the
  // core has dealt with the last one.  No byte goes before it came, so a late simulation keeps the pauses of a burst.
  void next_byte() {
    if (queue_.empty() && !sends_.empty() && !sending_) load_send();
    if (queue_.empty() || collecting_) return;
    const Byte byte = queue_.front();
    const bool continues = inside_burst_ && byte.owner == playing_ && !byte.first && silence() < t15_;
    if (!continues) {
      if (!rested_) return;
      begin_request(byte.owner);
      if (collecting_) return;
    }
    if (byte.at > line_s()) return;
    std::vector<Piece> pieces;
    Wrong wrong;
    wrong.parity = byte.bad;
    append_character(pieces, format_, byte.data, wrong, dice_);
    wave_.append(pieces);
    queue_.pop_front();
  }

  void begin_request(Owner owner) {
    playing_ = owner;
    ++requests_;
    for (auto &slave : slaves_) slave->strobes = 0;
    pick(Direction::kRequest);
    collecting_ = !picked_.empty();
    request_ = {};
    answered_ = false;
  }

  // The faults for the frame that comes now.
  void pick(Direction direction) {
    picked_.clear();
    for (Fault &fault : faults_)
      if (fault.direction == direction && fault.fires(dice_)) picked_.push_back(fault);
  }

  // The frame that a fault has waited for is complete.
  void play_faulty() {
    FaultyFrame frame;
    const Owner owner = queue_.front().owner;
    while (!queue_.empty() && queue_.front().owner == owner && (frame.bytes.empty() || !queue_.front().first)) {
      frame.bytes.push_back(queue_.front().data);
      frame.wrong.push_back({});
      frame.wrong.back().parity = queue_.front().bad;
      queue_.pop_front();
    }
    for (const Fault &fault : picked_) apply(fault, format_, ascii(), frame);
    collecting_ = false;
    std::vector<Piece> other;
    if (!frame.lost) wave_.append(pieces_of(frame, format_, dice_, other));
    other_talker_.append(other);
    echo_request_ = frame.echo;
    pending_injected_ = frame.injected;
    rested_ = judged_ = false;
    if (wave_.busy()) return;
    last_activity_ = cycle_;  // nothing reaches the line
    judged_ = true;
    request_.number = requests_;
    control_.event(Json().add("event", "delivered").add("to", requests_).add("direction", "request").add("bytes", "")
                       .raw("injected", Json::texts(frame.injected)));
  }

  // ------------------------------------------------------------------ answers

  void driver_changes(bool driven) {
    driven_ = driven;
    if (driven) {
      if (!judged_) judge();
      answered_ = true;
      ++answers_;
      pick(Direction::kAnswer);
      echo_answer_ = false;
      for (const Fault &fault : picked_) echo_answer_ |= fault.kind == "echo";
      faulty_answer_ = size_t(std::count_if(picked_.begin(), picked_.end(),
                                            [](const Fault &f) { return f.kind != "echo"; }));
      answer_bytes_.clear();
      if (logging()) open_log(answer_);
      return;
    }
    close_answer();
    if (faulty_answer_) begin_reply();
    else deliver_held();
    faulty_answer_ = echo_answer_ = false;
  }

  void listen(Slave &slave) {
    const int data = slave.monitor().clock(slave.pins().txd_o, slave.pins().de_o);
    if (slave.monitor().fault() != LineFault::kNone) {
      warn("bad character from the core: " + std::string(text(slave.monitor().fault())));
      slave.monitor().clear();
    }
    if (data < 0) return;
    answer_slave_ = &slave;
    if (faulty_answer_) answer_bytes_.push_back(uint8_t(data));
    else deliver(uint8_t(data), playing_);
    if (answer_.open) {
      answer_.bytes.push_back(uint8_t(data));
      answer_.starts.push_back(cycle_ - uint64_t(bit_ * (format_.length() - 0.5)) - answer_.begin);
    }
  }

  // A faulty answer is known as a whole; now it goes to the client.
  void begin_reply() {
    FaultyFrame frame;
    frame.bytes = answer_bytes_;
    frame.wrong.resize(frame.bytes.size());
    for (const Fault &fault : picked_)
      if (fault.kind != "echo") apply(fault, format_, ascii(), frame);
    reply_injected_ = frame.injected;
    reply_bytes_.clear();
    reply_faults_.clear();
    reply_to_ = requests_;
    reply_owner_ = playing_;
    reply_at_ = cycle_ + uint64_t(frame.late_ms * 1e-3 * clock_hz_);
    std::vector<Piece> other;
    client_receiver_ = Receiver(format_, bit_);
    if (!frame.lost) {
      reply_.append(pieces_of(frame, format_, dice_, other));
      reply_.append({{double(format_.length()), true}});  // what the receiver took for a character ends
    }
    reply_talker_.append(other);
    if (!reply_.busy()) end_reply();
  }

  bool replying() const { return reply_.busy() && cycle_ >= reply_at_; }

  // Also into a request, where the answer is late.
  void play_reply(bool driving) {
    bool level = reply_.clock();
    if (reply_talker_.busy()) level &= reply_talker_.clock();
    Received got;
    if (client_receiver_.clock(level, cycle_, got)) {
      reply_faults_ += fault_of(got, reply_bytes_.size(), reply_faults_);
      reply_bytes_.push_back(got.data);
      deliver(got.data, reply_owner_);
    }
    if (!driving) {
      last_activity_ = cycle_;
      inside_burst_ = false;
    }
    rested_ = false;
    if (!reply_.busy()) end_reply();
  }

  void end_reply() {
    deliver_held();
    control_.event(Json().add("event", "delivered").add("to", reply_to_).add("direction", "answer")
                       .add("bytes", hex(reply_bytes_)).raw("faults", "[" + reply_faults_ + "]")
                       .raw("injected", Json::texts(reply_injected_)));
  }

  // A byte for whoever has asked.
  void deliver(uint8_t data, Owner owner) {
    if (of_server(owner)) {
      if (sending_ && owner == (SERVER | send_number_)) sending_->answer.push_back(data);
      return;
    }
    if (owner != client_) return;
    if (held_.empty()) held_since_ = cycle_;
    held_last_ = cycle_;
    held_.push_back(data);
    if (!held_limit_) deliver_held();
  }

  void deliver_held() {
    if (!held_.empty()) clients_.send(held_, client_);
    held_.clear();
  }

  // ------------------------------------------------------------------ what the core says

  void strobes(Slave &slave) {
    const Pins &pins = slave.pins();
    if (!pins.write_stb_o || !logging()) return;
    control_.event(Json().add("event", "write").add("slave", slave.address()).add("space", unsigned(pins.write_space_o))
                       .add("first", unsigned(pins.write_first_o)).add("last", unsigned(pins.write_last_o))
                       .add("file", unsigned(pins.write_file_o)).add("time", unix_s()).add("to", requests_));
  }

  // The request has ended and the core has said what it thinks of it.
  void judge() {
    judged_ = true;
    echo_request_ = false;
    request_.number = requests_;
    if (request_.open) write_log(request_, "request", nullptr);
    request_.open = false;
  }

  std::string verdict(const Slave &slave) const {
    const unsigned strobes = slave.strobes;
    const struct {
      Event event;
      const char *text;
    } errors[] = {{kLong, "too long"}, {kShort, "too short"}, {kParityError, "parity"}, {kFramingError, "framing"},
                  {kGap, "gap"}, {kOverrun, "overrun"}, {kCrcError, "crc"}};
    for (const auto &error : errors)
      if (strobes >> error.event & 1) return error.text;
    if (!(strobes >> kFrame & 1)) return "not heard";
    const unsigned address = ascii() ? ascii_address() : request_.bytes.empty() ? 0 : request_.bytes[0];
    if (address && address != slave.address()) return "other address";
    if (slave.pins().listen_only_o) return "listen-only";
    return address ? "no answer" : "broadcast";
  }

  // The address of a good frame in ASCII mode
  unsigned ascii_address() const {
    const auto colon = std::find(request_.bytes.rbegin(), request_.bytes.rend(), uint8_t(':'));
    if (colon - request_.bytes.rbegin() < 2) return 0;
    const std::string digits(colon.base(), colon.base() + 2);
    return unsigned(strtoul(digits.c_str(), nullptr, 16));
  }

  // The line is silent and no core is at work: nothing more will come of the last request.
  void come_to_rest() {
    rested_ = true;
    if (!judged_) judge();
    std::string told;
    if (!answered_ && request_.number == requests_) {
      ++silent_;
      std::string each;
      for (const auto &slave : slaves_) {
        const std::string one = verdict(*slave);
        if (told.empty() || told == "other address") told = one;
        each += (each.empty() ? "{" : ",") + Json::quoted(std::to_string(slave->address())) + ":" + Json::quoted(one);
      }
      control_.event(Json().add("event", "silence").add("to", requests_).add("verdict", told).raw("slaves", each + "}")
                         .add("time", unix_s()));
      answered_ = true;
    }
    const Owner sender = SERVER | send_number_;
    if (sending_ && playing_ == sender) {
      sending_->played = true;
      sending_->verdict = told;
    }
    if (sending_ && sending_->played && !(reply_.busy() && reply_owner_ == sender)) {
      control_.reply(Json().raw("id", sending_->id).add("answer", hex(sending_->answer))
                         .add("verdict", sending_->verdict));
      sending_.reset();
    }
  }

  // ------------------------------------------------------------------ log

  bool logging() const { return control_.open(); }

  void open_log(Logged &frame) {
    const uint64_t number = requests_;
    frame = {};
    frame.open = true;
    frame.number = number;
    frame.begin = cycle_;
    frame.time = unix_s();
    if (&frame == &request_) frame.injected = pending_injected_, pending_injected_.clear();
    pins_ = -1;
  }

  void log_pins(bool rxd) {
    const int pins = rxd << 2 | txd_ << 1 | driven_;
    if (pins == pins_) return;
    pins_ = pins;
    Logged &frame = driven_ || answer_.open ? answer_ : request_;
    if (!frame.open || !with_edges_ || frame.edges.size() > 2 * MOST_EDGES) return;
    frame.edges.push_back(cycle_ - frame.begin);
    frame.edges.push_back(uint64_t(pins));
  }

  // [index,"what is wrong"] for a list that is empty or not; nothing for a good character.
  static std::string fault_of(const Received &got, size_t index, const std::string &before) {
    if (!got.parity_error && !got.framing_error) return "";
    return (before.empty() ? "[" : ",[") + std::to_string(index) + "," +
           (got.framing_error ? "\"framing\"]" : "\"parity\"]");
  }

  // What a UART makes of the line that the slaves hear.
  void hear_line(bool rxd) {
    if (driven_) return;
    Received got;
    if (!line_receiver_.clock(rxd, cycle_, got)) return;
    if (echo_request_) deliver(got.data, playing_);
    if (!request_.open) return;
    request_.faults += fault_of(got, request_.bytes.size(), request_.faults);
    request_.bytes.push_back(got.data);
    request_.starts.push_back(got.start - request_.begin);
  }

  void close_answer() {
    if (answer_.open) write_log(answer_, "answer", answer_slave_);
    answer_.open = false;
  }

  void write_log(const Logged &frame, const char *direction, const Slave *slave) {
    Json json;
    json.add("event", "frame").add("n", frame.number).add("direction", direction).add("time", frame.time)
        .add("cycle", frame.begin).add("end", slave ? cycle_ : last_activity_).add("bytes", hex(frame.bytes))
        .raw("starts", Json::list(frame.starts)).raw("faults", "[" + frame.faults + "]")
        .raw("injected", Json::texts(frame.injected)).add("source", of_server(playing_) ? "send" : "client");
    if (slave) json.add("slave", slave->address()).add("to", frame.number).add("late_ms", 1000 * lag_s(wall_s()));
    if (with_edges_) json.raw("edges", Json::list(frame.edges));
    control_.event(json);
  }

  void say_hello() {
    std::vector<unsigned> addresses;
    for (const auto &slave : slaves_) addresses.push_back(slave->address());
    control_.event(Json().add("event", "hello").add("protocol", 1).add("clock_hz", uint64_t(clock_hz_))
                       .add("bit_time", options_.bit_time).add("baud", options_.baud)
                       .add("format", options_.format & FORMAT_BITS).add("data_bits", unsigned(format_.data))
                       .add("mode", ascii() ? "ascii" : "rtu").add("t15", t15_).add("t35", t35_)
                       .raw("slaves", Json::list(addresses))
                       .add("link", options_.port.empty() ? options_.link : options_.port));
  }

  // ------------------------------------------------------------------ commands

  static std::vector<std::string> words(const std::string &text) {
    std::istringstream line(text);
    std::vector<std::string> found;
    for (std::string word; line >> word;) found.push_back(word);
    return found;
  }

  static bool number(const std::string &text, uint64_t most, uint64_t &value) {
    if (text.empty() || text.size() > 10 || text.find_first_not_of("0123456789") != std::string::npos) return false;
    value = strtoull(text.c_str(), nullptr, 10);
    return value <= most;
  }

  Slave *slave_of(uint64_t address) {
    if (!address) return slaves_[0].get();
    for (auto &slave : slaves_)
      if (slave->address() == address) return slave.get();
    return nullptr;
  }

  // Carries out a command, or begins to; what is wrong with it, or "".
  std::string execute(const std::string &id, const std::string &verb, const std::vector<std::string> &words) {
    const bool of_slave = verb == "read" || verb == "write" || verb == "set" || verb == "get" || verb == "status";
    uint64_t address = 0;
    if (of_slave && (words.empty() || !number(words[0], 255, address) || !slave_of(address)))
      return words.empty() ? "which slave?" : words[0] + ": no such slave";
    Slave *slave = of_slave ? slave_of(address) : nullptr;
    if (verb == "read" || verb == "write") return host(id, verb == "write", *slave, words);
    if (verb == "set") return set(id, address ? slave : nullptr, words);
    if (verb == "get") return get(id, *slave);
    if (verb == "status") return status(id, *slave);
    if (verb == "stats") return stats(id);
    if (verb == "send") return send(id, words);
    if (verb == "pins") {
      if (words.size() != 1 || (words[0] != "on" && words[0] != "off")) return "pins: must be on or off";
      with_edges_ = words[0] == "on";
      control_.reply(Json().raw("id", id).add("pins", words[0]));
      return "";
    }
    if (verb == "fault") {
      const std::string wrong = add_fault(words);
      if (wrong.empty()) control_.reply(Json().raw("id", id).add("fault", faults_.back().number));
      return wrong;
    }
    if (verb == "faults") return list_faults(id);
    if (verb == "unfault") return remove_fault(id, words);
    return verb + ": no such command";
  }

  std::string host(const std::string &id, bool write, Slave &slave, const std::vector<std::string> &words) {
    constexpr uint64_t MOST = 2048;
    uint64_t space, item, value;
    if (words.size() < 4 || !number(words[1], 7, space) || !number(words[2], 65535, item))
      return "must be slave, space, item and " + std::string(write ? "values" : "count");
    Job job{id, &slave, {}, write ? Job::kWrite : Job::kRead};
    job.access.write = write;
    uint64_t count = words.size() - 3;
    if (!write && (words.size() != 4 || !number(words[3], MOST, count) || !count)) return "count must be 1 to 2048";
    if (count > MOST || item + count > 65536) return "goes beyond item 65535, or more than 2048 items";
    for (uint64_t i = 0; i < count; ++i) job.access.addresses.push_back(uint32_t(space << 16 | (item + i)));
    for (size_t i = 3; write && i < words.size(); ++i) {
      if (!number(words[i], 65535, value)) return words[i] + ": must be a number from 0 to 65535";
      job.access.values.push_back(uint16_t(value));
    }
    jobs_.push_back(std::move(job));
    return "";
  }

  std::string set(const std::string &id, Slave *only, const std::vector<std::string> &words) {
    static const std::map<std::string, uint64_t> most = {{"exception_status", 255}, {"busy", 1},
                                                         {"failure", 15},           {"run_indicator", 1},
                                                         {"write_lock", 1},         {"diagnostic", 65535}};
    uint64_t value;
    if (words.size() != 3 || !most.count(words[1])) return "must be slave, name of an input, value";
    const std::string &name = words[1];
    if (!number(words[2], most.at(name), value))
      return name + ": must be a number from 0 to " + std::to_string(most.at(name));
    for (auto &slave : slaves_) {
      if (only && slave.get() != only) continue;
      Pins &pins = slave->pins();
      if (name == "exception_status") pins.exception_status_i = value;
      if (name == "busy") pins.busy_i = value;
      if (name == "failure") pins.failure_i = value;
      if (name == "run_indicator") pins.run_indicator_i = value;
      if (name == "write_lock") pins.write_lock_i = value;
      if (name == "diagnostic") pins.diagnostic_i = value;
    }
    // The input passes a register. Bits of the diagnostic register are set once.
    ++free_, clock();
    if (name == "diagnostic") {
      for (auto &slave : slaves_) slave->pins().diagnostic_i = 0;
      ++free_, clock();
    }
    control_.reply(Json().raw("id", id).add("set", 1));
    return "";
  }

  std::string get(const std::string &id, Slave &slave) {
    const Pins &pins = slave.pins();
    control_.reply(Json().raw("id", id).add("exception_status", unsigned(pins.exception_status_i))
                       .add("busy", unsigned(pins.busy_i)).add("failure", unsigned(pins.failure_i))
                       .add("run_indicator", unsigned(pins.run_indicator_i))
                       .add("write_lock", unsigned(pins.write_lock_i))
                       .add("listen_only", unsigned(pins.listen_only_o)).add("idle", unsigned(pins.idle_o)));
    return "";
  }

  std::string status(const std::string &id, Slave &slave) {
    Job job{id, &slave, {}, Job::kStatus};
    for (const unsigned item : STATUS_ITEMS) job.access.addresses.push_back(CORE_SPACE << 16 | item);
    for (unsigned entry = 0; entry < LOG_ENTRIES; ++entry)
      job.access.addresses.push_back(CORE_SPACE << 16 | (FIRST_LOG_ITEM + entry));
    jobs_.push_back(std::move(job));
    return "";
  }

  std::string stats(const std::string &id) {
    control_.reply(Json().raw("id", id).add("requests", requests_).add("answers", answers_).add("silent", silent_)
                       .add("dropped", control_.dropped()).add("late", late_).add("clients", open_)
                       .add("cycle", cycle_).add("uptime", wall_s() - begun_s_));
    return "";
  }

  std::string send(const std::string &id, const std::vector<std::string> &words) {
    Send send;
    send.id = id;
    const std::string text = words.empty() ? "" : words[0];
    if (text.empty() || text.size() % 2 || text.size() > 2 * QUEUE_LIMIT ||
        text.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
      return "send: must be 1 to 1026 bytes in hexadecimal";
    if (sends_.size() >= SENDS_LIMIT) return "send: 256 requests wait already";
    for (size_t i = 0; i < text.size(); i += 2)
      send.bytes.push_back(uint8_t(strtoul(text.substr(i, 2).c_str(), nullptr, 16)));
    sends_.push_back(std::move(send));
    return "";
  }

  void load_send() {
    sending_ = std::make_unique<Send>(std::move(sends_.front()));
    sends_.pop_front();
    ++send_number_;
    bool first = true;
    for (const uint8_t data : sending_->bytes) {
      queue_.push_back({data, false, first, SERVER | send_number_, 0});
      first = false;
    }
  }

  std::string add_fault(const std::vector<std::string> &words) {
    Fault fault;
    std::string wrong = parse_fault(words, fault);
    if (wrong.empty() && fault.kind == "parity" && !format_.parity) wrong = "parity: the line has no parity";
    if (!wrong.empty()) return "fault: " + wrong;
    faults_.erase(std::remove_if(faults_.begin(), faults_.end(), [](const Fault &f) { return f.spent(); }),
                  faults_.end());
    if (faults_.size() >= MOST_FAULTS) return "fault: there are 100 already";
    fault.number = ++fault_number_;
    faults_.push_back(fault);
    return "";
  }

  std::string list_faults(const std::string &id) {
    std::string all;
    for (const Fault &fault : faults_) {
      Json one;
      one.add("fault", fault.number).add("direction", fault.direction == Direction::kRequest ? "request" : "answer")
          .add("kind", fault.kind).add("every", fault.every).add("probability", fault.probability)
          .add("count", fault.count).add("done", fault.done);
      for (const auto &[name, value] : fault.keys) one.add(name.c_str(), value);
      all += (all.empty() ? "" : ",") + one.text();
    }
    control_.reply(Json().raw("id", id).raw("faults", "[" + all + "]"));
    return "";
  }

  std::string remove_fault(const std::string &id, const std::vector<std::string> &words) {
    uint64_t which = 0;
    const bool all = words.size() == 1 && words[0] == "all";
    if (!all && (words.size() != 1 || !number(words[0], UINT32_MAX, which))) return "unfault: must be a number or all";
    const size_t before = faults_.size();
    faults_.erase(std::remove_if(faults_.begin(), faults_.end(),
                                 [&](const Fault &fault) { return all || fault.number == which; }),
                  faults_.end());
    control_.reply(Json().raw("id", id).add("removed", uint64_t(before - faults_.size())));
    return "";
  }

  // One clock of the first access to a host port.
  void step() {
    Job &job = jobs_.front();
    job.slave->step(job.access);
    if (!job.access.finished()) return;
    answer(job);
    jobs_.pop_front();
  }

  void answer(const Job &job) {
    const HostAccess &access = job.access;
    Json json;
    json.raw("id", job.id);
    if (job.kind == Job::kStatus) {
      status_values(json, *job.slave, access);
    } else if (access.refused) {
      const uint32_t at = access.addresses[access.done];
      json.add("error", "slave " + std::to_string(job.slave->address()) + ": space " + std::to_string(at >> 16) +
                            " item " + std::to_string(at & 0xFFFF) +
                            (access.write ? ": cannot be written" : ": no such item"));
    } else if (access.write) {
      json.add("written", uint64_t(access.done));
    } else {
      json.raw("values", Json::list(access.values));
    }
    control_.reply(json);
  }

  void status_values(Json &json, const Slave &slave, const HostAccess &access) const {
    std::vector<uint16_t> log;
    if (access.refused) {
      json.raw("counters", "null");
    } else {
      Json counters;
      for (size_t i = 0; i < STATUS_ITEMS.size(); ++i)
        if (COUNTER_NAMES[i]) counters.add(COUNTER_NAMES[i], unsigned(access.values[i]));
      json.raw("counters", counters.text());
      const size_t entries = std::min<size_t>(access.values[ENTRIES_AT], LOG_ENTRIES);
      log.assign(access.values.begin() + STATUS_ITEMS.size(), access.values.begin() + STATUS_ITEMS.size() + entries);
    }
    Json errors;
    for (size_t i = 0; i < kEvents.size(); ++i) errors.add(kEvents[i], slave.counts[i]);
    json.add("listen_only", unsigned(slave.pins().listen_only_o)).raw("log", Json::list(log))
        .raw("errors", errors.text());
  }

  // ------------------------------------------------------------------ start

  void reset_slaves() {
    for (auto &slave : slaves_) {
      Pins &pins = slave->pins();
      pins.rxd_i = 1;
      pins.address_i = slave->address();
      pins.bit_time_i = options_.bit_time;
      pins.format_i = options_.format & FORMAT_BITS;
      pins.ascii_i = ascii();
      pins.eight_bits_i = !(options_.format & SEVEN_BITS);
      pins.busy_i = options_.busy;
      pins.failure_i = options_.failure;
      pins.exception_status_i = options_.exception_status;
      pins.run_indicator_i = options_.run_indicator;
      pins.rst_i = 1;
    }
    for (int i = 0; i < 16; ++i) clock();
    for (auto &slave : slaves_) slave->pins().rst_i = 0;
    for (int i = 0; i < 16; ++i) clock();
    // Once: the register keeps them until a master clears it.
    for (auto &slave : slaves_) slave->pins().diagnostic_i = options_.diagnostic;
    clock();
    for (auto &slave : slaves_) slave->pins().diagnostic_i = 0;
  }

  // Initial contents: lines of "space item value", written through the host port of every slave.
  void load(int fd) {
    FILE *file = fdopen(fd, "r");
    HostAccess access;
    access.write = true;
    unsigned space, item, value;
    while (file && fscanf(file, "%u %u %u", &space, &item, &value) == 3) {
      access.addresses.push_back(space << 16 | item);
      access.values.push_back(uint16_t(value));
    }
    if (file) fclose(file);
    for (auto &slave : slaves_) {
      HostAccess own = access;
      while (!own.finished() || slave->pins().host_cyc_i) {
        slave->step(own);
        clock();
      }
      if (own.refused)
        fail("the core refused space " + std::to_string(own.addresses[own.done] >> 16) + " item " +
             std::to_string(own.addresses[own.done] & 0xFFFF));
    }
  }

  void open_trace() {
    trace_ = fopen(options_.trace.c_str(), "w");
    if (!trace_) fail_errno(options_.trace);
    fprintf(trace_, "# clock_hz %" PRIu64 " bit_time %u format %u t35 %" PRIu64 "\n# cycle rxd txd de\n",
            uint64_t(clock_hz_), options_.bit_time, options_.format & FORMAT_BITS, t35_);
  }

  void trace_pins(bool rxd) {
    const int pins = rxd << 2 | txd_ << 1 | driven_;
    if (pins == traced_) return;
    traced_ = pins;
    fprintf(trace_, "%" PRIu64 " %d %d %d\n", cycle_, rxd, txd_, driven_);
  }

  // Of the host port, see modbus_host_map
  static constexpr unsigned CORE_SPACE = 5, LOG_ENTRIES = 64, FIRST_LOG_ITEM = 0x40, ENTRIES_AT = 2;
  static constexpr std::array<unsigned, 12> STATUS_ITEMS = {0, 1, 2, 0xA, 0xB, 0xC, 0xD, 0xE, 0xF, 0x10, 0x11, 0x12};
  static constexpr std::array<const char *, 12> COUNTER_NAMES = {
      "register", nullptr, nullptr, "event", "bus_message", "comm_error", "exception", "slave_message", "no_response",
      "nak", "busy", "overrun"};
  static constexpr size_t MOST_FAULTS = 100;

  const Options options_;
  Clients &clients_;
  Control &control_;
  CharacterFormat format_;
  double bit_, clock_hz_, character_ = 0;  // clocks of a bit, a second, a character
  std::vector<std::unique_ptr<Slave>> slaves_;
  bool shared_ = false;  // slaves hear each other, and themselves

  // The line
  Wave wave_, other_talker_, reply_, reply_talker_;
  Receiver line_receiver_, client_receiver_;
  uint64_t cycle_ = 0, free_ = 0;  // free: those that took no time
  uint64_t last_activity_ = 0, t15_ = 0, t35_ = 0, hold_ = 0;
  bool driven_ = false, txd_ = true, inside_burst_ = false, rested_ = false, judged_ = false, answered_ = true;
  bool behind_ = false;  // the last run did not reach the wall clock
  double anchor_s_ = 0;
  uint64_t anchor_cycle_ = 0;
  const double begun_s_ = wall_s();

  // Clients and their bytes
  std::deque<Byte> queue_;
  Owner client_ = 1, playing_ = 0;  // who is connected; who sent what was last on the line
  double carried_s_ = 0, last_byte_s_ = 0;  // when a real line would have carried all bytes
  std::vector<uint8_t> held_;
  uint64_t held_since_ = 0, held_last_ = 0, held_limit_ = 0;
  int open_ = 0;  // clients

  // The control server
  std::deque<Job> jobs_;
  std::deque<Send> sends_;
  std::unique_ptr<Send> sending_;
  uint64_t send_number_ = 0, requests_ = 0, answers_ = 0, silent_ = 0, late_ = 0;

  // Faults
  Dice dice_;
  std::vector<Fault> faults_, picked_;
  unsigned fault_number_ = 0;
  bool collecting_ = false, faulty_answer_ = false, echo_answer_ = false, echo_request_ = false;
  std::vector<uint8_t> answer_bytes_, reply_bytes_;
  std::vector<std::string> pending_injected_, reply_injected_;
  std::string reply_faults_;
  uint64_t reply_at_ = 0, reply_to_ = 0;
  Owner reply_owner_ = 0;

  // Log
  Logged request_, answer_;
  const Slave *answer_slave_ = nullptr;
  int pins_ = -1;
  bool with_edges_ = true;
  FILE *trace_ = nullptr;
  int traced_ = -1;
};
