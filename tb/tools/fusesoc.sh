#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# fusesoc.sh - runs the FuseSoC targets of modbus_rtu_slave.core, as its users would.
# The user's own FuseSoC configuration stays out of it.  lint and sim are run, the boards are set up only: that checks
# names, files and options, and writes what the board's tools would be given.  Exits with 0 if every one passes.
set -u
cd "$(dirname -- "$0")/../.." || exit 1
mkdir -p build
: > build/fusesoc.conf
failed=

# $1 = target; further options of run
fusesoc() {
  target=$1
  shift
  echo "=== fusesoc $target"
  .venv/bin/fusesoc --config build/fusesoc.conf --cores-root=. run --clean --build-root "build/fusesoc" \
    --target="$target" "$@" modbus_rtu_slave || failed="$failed $target"
}

for target in lint sim; do fusesoc "$target"; done
for target in icebreaker hx8k ulx3s tangnano9k arty_a7 de10_lite; do fusesoc "$target" --setup; done

if [ -n "$failed" ]; then
  echo "failed:$failed" >&2
  exit 1
fi
echo "all targets passed"
