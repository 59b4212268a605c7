// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// exec_into - a function for GNU make: $(exec_into program,argument,...) replaces make by the program.
//
// make that is sent SIGTERM or SIGINT passes it on, waits, and then dies of it: its exit status can not be 0,
// whatever the recipe does.  `make serve` is to end with 0 then, so its last act is to become the device.
// As in a recipe's last line, nothing after it runs; if the program cannot be started, the recipe goes on.

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

int plugin_is_GPL_compatible;

void gmk_add_function(const char *name, char *(*function)(const char *, unsigned int, char **),
                      unsigned int min_args, unsigned int max_args, unsigned int flags);

static char *exec_into(const char *name, unsigned int argc, char **argv) {
  sigset_t none;
  (void)argc;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  fflush(NULL);
  execvp(argv[0], argv);
  perror(name);
  return NULL;
}

int exec_into_gmk_setup(void) {
  gmk_add_function("exec_into", exec_into, 1, 0, 0);
  return 1;
}
