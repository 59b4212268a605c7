#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# fusesoc.sh - runs the FuseSoC targets of modbus_rtu_slave.core, as its users would.
# The user's own FuseSoC configuration stays out of it.  lint and sim are run, the boards are set up only: that checks
# names, files and devices, and writes what the board's tools would be given.  Exits with 0 if every one passes.
set -u
cd "$(dirname -- "$0")/.." || exit 1
rm -rf build/fusesoc                   # a project of before must not speak for this one
mkdir -p build
: > build/fusesoc.conf
failed=

# $1 = target; further options of run
fusesoc() {
  target=$1
  shift
  echo "=== fusesoc $target"
  .venv/bin/fusesoc --config build/fusesoc.conf --cores-root=. run --build-root build/fusesoc \
    --target="$target" "$@" modbus_rtu_slave || failed="$failed $target"
}

# $1 = board, $2 = what its tools must be told.  FuseSoC passes over an option that it does not know.
board() {
  before=$failed
  fusesoc "$1" --setup
  [ "$failed" = "$before" ] || return
  if ! grep -rqFe "$2" build/fusesoc/modbus_rtu_slave_*/"$1"* --include=Makefile --include='*.tcl'; then
    echo "the project for $1 does not say $2" >&2
    failed="$before $1"
  fi
}

for target in lint sim; do fusesoc "$target"; done
board icebreaker "--up5k --package sg48 --pcf"
board hx8k "--hx8k --package ct256 --pcf"
board ulx3s "--85k --package CABGA381 --lpf"
board tangnano9k "--device GW1NR-LV9QN88PC6/I5 --vopt family=GW1N-9C --freq 27 --vopt cst="
board arty_a7 xc7a35ticsg324-1L
board de10_lite 10M50DAF484C7G

if [ -n "$failed" ]; then
  echo "failed:$failed" >&2
  exit 1
fi
echo "all targets passed"
