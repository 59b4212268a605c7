// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// clients_check - sim/clients.h without a simulation: a master writes while nobody asks for news.
//
// Each line of output is a round: {milliseconds between first and last news, of how many news, bytes in them}. With an
// argument: what is said of a second client whose bytes are seen before its coming.

#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

#include "clients.h"

namespace {

void sleep_ms(int ms) { usleep(useconds_t(ms) * 1000); }

void say(const char *what, const std::vector<News> &news) {
  size_t bytes = 0;
  for (const News &one : news) bytes += one.characters.size();
  const double apart = news.empty() ? 0 : news.back().at - news.front().at;
  printf("%s %.3f %zu %zu\n", what, 1000 * apart, news.size(), bytes);
}

// A second client opens the port and writes before the first look behind both: the bytes are read, then its coming.
int two_at_once() {
  Terminal terminal(19200);
  const int first = open(terminal.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  terminal.changes();
  const int second = open(terminal.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (write(second, "1", 1) != 1) return 1;
  sleep_ms(50);
  std::vector<Character> characters;
  printf("read %d\n", int(terminal.receive(characters)));
  terminal.changes();
  close(second);
  close(first);
  return 0;
}

}  // namespace

int main(int count, char **) {
  if (count > 1) return two_at_once();
  Terminal terminal(19200);
  Clients clients(terminal);
  clients.start([] {});
  const int master = open(terminal.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  sleep_ms(100);
  clients.news(0);  // it has come
  for (int round = 0; round < 20; ++round) {
    for (int burst = 0; burst < 2; ++burst) {
      if (write(master, "12345678", 8) != 8) return 1;
      sleep_ms(10);
    }
    sleep_ms(40);
    say("bursts", clients.news(0));
  }
  clients.news(0);
  for (int n = 0; n < 1000; ++n)
    if (write(master, "0123456789012345678901234567890123456789", 40) < 0) sleep_ms(1);
  sleep_ms(50);
  say("flood", clients.news(0));
  sleep_ms(50);
  clients.news(0);
  clients.news(QUEUE_LIMIT - 3);
  if (write(master, "12345678", 8) != 8) return 1;
  sleep_ms(50);
  say("full", clients.news(0));
  close(master);
  return 0;
}
